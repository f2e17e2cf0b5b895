"""Small pictures of parts and of convergence, as data URLs; none where matplotlib is missing."""
import base64
import io

import numpy as np

try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import matplotlib.ticker
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection
except ImportError:
    plt = None

MOST = 20000  # triangles drawn
TICKS = [c * 10.0**k for k in range(-9, 9) for c in (1, 2, 5)]
LIGHT = np.array([0.35, -0.55, 0.76])


def data_url(figure):
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=110, transparent=True)
    plt.close(figure)
    return "data:image/png;base64," + base64.b64encode(buffer.getvalue()).decode()


def halved(triangles, longest):
    """Triangles whose edges are at most this long: those that are longer are cut in two (drawn in order of depth, long ones mislead)."""
    done = []
    while len(triangles):
        edges = np.roll(triangles, -1, axis=1) - triangles
        length = np.linalg.norm(edges, axis=2)
        long = length.max(1) > longest
        done.append(triangles[~long])
        triangles, first = triangles[long], length[long].argmax(1)
        a, b, c = (triangles[np.arange(len(triangles)), (first + k) % 3] for k in range(3))
        middle = (a + b) / 2
        triangles = np.concatenate([np.stack([a, middle, c], 1), np.stack([middle, b, c], 1)])
    return np.concatenate(done)


def part(triangles):
    """Of the surface's triangles (n, 3, 3), shaded by their direction."""
    if plt is None:
        return ""
    triangles = halved(triangles, np.ptp(triangles, axis=(0, 1)).max() / 14)
    if len(triangles) > MOST:  # fine facets: any of them, painted larger, show the shape
        triangles = triangles[np.linspace(0, len(triangles) - 1, MOST).astype(int)]
    a, b, c = np.moveaxis(triangles, 1, 0)
    normal = np.cross(b - a, c - a)
    shade = 0.62 + 0.38 * (normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]) @ LIGHT
    colours = np.clip(shade, 0.25, 1)[:, None] * np.array([0.47, 0.64, 0.82])
    figure = plt.figure(figsize=(2.6, 2.2))
    axes = figure.add_axes([-0.12, -0.12, 1.24, 1.24], projection="3d", proj_type="ortho")
    axes.add_collection3d(Poly3DCollection(triangles, facecolors=colours, edgecolors=colours, linewidths=0.3))
    low, high = triangles.min((0, 1)), triangles.max((0, 1))
    for k, name in enumerate("xyz"):
        getattr(axes, f"set_{name}lim")(low[k], high[k])
    size = np.maximum(high - low, 0.02 * (high - low).max())
    axes.set_box_aspect(size, zoom=0.72 if size[2] > 1.2 * size[:2].max() else 1)
    axes.set_axis_off()
    axes.view_init(24, -58)
    return data_url(figure)


def convergence(outcome):
    """Largest error of all quantities over unknowns: ours at the three grids, CalculiX's."""
    case, runs = outcome.case, [found for found in outcome.grids if found is not None and found.unknowns > 0]
    if plt is None or not runs:
        return ""
    largest = lambda found: max(100 * abs(case.error(q, v)) for q, v in found.values.items())  # noqa: E731
    if min(map(largest, runs)) < 1e-10:
        return ""
    figure, axes = plt.subplots(figsize=(2.6, 1.7))
    axes.loglog([found.unknowns for found in runs], [largest(found) for found in runs], "o-", color="#2a6fb0", ms=4, label="igasolve")
    if outcome.calculix is not None and outcome.calculix.unknowns > 0 and largest(outcome.calculix) > 0:
        axes.loglog([outcome.calculix.unknowns], [largest(outcome.calculix)], "s", color="#b3541e", ms=5, label="CalculiX")
        axes.legend(fontsize=6, frameon=False)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(matplotlib.ticker.FixedLocator(TICKS))
        axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(matplotlib.ticker.NullLocator())
    axes.set_xlabel("unknowns", fontsize=7)
    axes.set_ylabel("largest error, %", fontsize=7)
    axes.tick_params(labelsize=6)
    axes.grid(True, which="both", lw=0.3)
    figure.tight_layout(pad=0.3)
    return data_url(figure)
