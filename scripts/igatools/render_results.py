"""Pictures of a results file for render.py: modes and deformed shapes, coloured by |u| or von Mises stress."""
import json
import sys

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm, Normalize
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkFiltersHybrid import vtkPolyDataSilhouette

from igatools import iga_results
from igatools.drawing import PIXELS, actor_of, page, picture, save, triangle_mesh, with_normals
from igatools.report import tables, units

COLOURS, SAFETY = plt.get_cmap("turbo"), plt.get_cmap("turbo_r")
SHEET = 6  # modes
COLUMNS = 3
TILE = (860, 640)
MODE_SHARE = 0.08  # largest displacement of a mode over the diagonal of the part's box: clearly seen, still the part
STATIC_SHARE = 0.05
SPIKES = 99.8  # percentile that ends the scale of stresses: a few points of a sharp corner would make all else dark blue
REST_COLOUR = (0.55, 0.57, 0.60)
LABELS = {"displacement": "|u|", "von_mises": "von Mises stress", "temperature": "temperature",
          "safety_factor": "safety factor: yield strength over von Mises stress", "von_mises_error": "estimated error of the von Mises stress"}


class Shapes:
    """What the pictures need of a results file."""

    def __init__(self, path):
        self.results = iga_results.read(path)
        self.surface = self.results.joined_surface()
        if self.surface is not None and self.results.analysis == "heat":
            self.surface["displacement"] = np.zeros((len(self.surface["steps"]), *self.surface["vertices"].shape))
        if self.surface is None or "displacement" not in self.surface:
            sys.exit(f"render.py: {path}: holds no displacements of the surface to draw")
        self.stem = path.stem
        self.title = self.results.attribute("/", "title") or path.stem
        self.vertices, self.triangles = self.surface["vertices"], self.surface["triangles"]
        self.diagonal = float(np.linalg.norm(np.ptp(self.vertices, axis=0)))
        unit = self.results.attribute("/", "length_unit")
        self.unit = "" if unit == "unspecified" else f" {unit}"
        self.told = told_beside(path, self.results)

    def displacement(self, step):
        return self.surface["displacement"][step]

    def values(self, step, colour):
        """What the colour shows at every vertex."""
        if colour not in LABELS:
            sys.exit("render.py: only explicit runs have a plastic strain; use --colour displacement or von_mises")
        if colour == "safety_factor" and colour not in self.surface:
            sys.exit("render.py: the file holds no safety factors; statics of one body have them where the material has a yield strength "
                     "([material] yield = …)")
        if colour == "von_mises_error" and colour not in self.surface:
            sys.exit("render.py: the file holds no errors of the stress; statics of one body have them where stress is recovered")
        if colour == "displacement":
            return np.linalg.norm(self.displacement(step), axis=1)
        if colour not in self.surface:
            sys.exit(f"render.py: the file holds no {LABELS[colour]} on the surface; use --colour "
                     + ("temperature" if self.results.analysis == "heat" else "displacement"))
        return self.surface[colour][step]

    def factor(self, step, share):
        """Exaggeration that makes the largest displacement this share of the part's diagonal."""
        largest = np.linalg.norm(self.displacement(step), axis=1).max(initial=0)
        return share * self.diagonal / largest if largest > 0 else 1.0


def told_beside(path, results):
    """{step: frequency with its error, as text}, from the report that scripts/iga has left beside its finest results; else nothing."""
    try:
        report = json.loads((path.parent / "report.json").read_text())
    except (OSError, ValueError):
        return {}
    if report.get("results") != path.name or "frequencies" not in report:
        return {}
    unit = units.of_report(report)["frequency"]
    texts = [f"f = {units.with_unit(tables.number(frequency), unit)}" + (", error unknown" if error is None else f" ± {tables.percent(error)}")
             for frequency, error in zip(report["frequencies"], report["errors"])]
    return dict(zip(results.elastic(), texts))


def outline(shapes, sight):
    """Sharp edges and silhouette of the part at rest."""
    lines = vtkPolyDataSilhouette()
    lines.SetInputData(triangle_mesh(shapes.vertices, shapes.triangles))
    lines.SetDirectionToSpecifiedVector()
    lines.SetVector(*(-np.asarray(sight)))
    lines.SetEnableFeatureAngle(1)
    lines.SetFeatureAngle(40)
    lines.Update()
    return actor_of(lines.GetOutput(), colour=REST_COLOUR, lines=1.2, flat=True)


def deformed(shapes, step, factor, values, norm, colours=COLOURS):
    poly = triangle_mesh(shapes.vertices + factor * shapes.displacement(step), shapes.triangles)
    shades = (255 * colours(norm(values))[:, :3]).astype(np.uint8)
    poly.GetPointData().SetScalars(numpy_to_vtk(shades, deep=True))
    actor = actor_of(with_normals(poly))
    actor.GetMapper().SetScalarVisibility(True)
    return actor


def extent(shapes, steps, factors):
    """Points that a picture must hold: the part at rest and deformed."""
    return np.concatenate([shapes.vertices] + [shapes.vertices + factor * shapes.displacement(step)
                                               for step, factor in zip(steps, factors)])


def draw_shape(shapes, step, factor, values, norm, sight, fit, pixels=PIXELS, colours=COLOURS):
    up = (0, 0, 1) if abs(sight[2]) < 0.99 * np.linalg.norm(sight) else (0, 1, 0)
    return picture([deformed(shapes, step, factor, values, norm, colours), outline(shapes, sight)], sight, up, fit, pixels)


def normalised(values, colour):
    """Values over their largest, which means nothing in a mode; stresses over nearly the largest."""
    top = np.percentile(values, SPIKES) if colour == "von_mises" else values.max(initial=0)
    return values / top if top > 0 else values


def frequency_text(shapes, step):
    if shapes.results.analysis == "buckling":
        return f"factor {shapes.results['/buckling/factor'][step]:.5g}"
    if step in shapes.told:
        return shapes.told[step]
    kind = shapes.results.kinds()[step]
    frequency = f"f = {shapes.results['/frequencies'][step]:.5g}"
    return {"RIGID": "rigid", "ELASTIC": frequency, "MECHANISM": f"{frequency} (mechanism)"}[kind]


def draw_sheet(shapes, colour, scale, sight, file):
    buckling = shapes.results.analysis == "buckling"
    steps = (list(range(len(shapes.surface["steps"]))) if buckling else shapes.results.elastic())[:SHEET]
    if not steps:
        sys.exit("render.py: the file holds no buckling mode" if buckling else
                 "render.py: the file holds no elastic mode; ask igasolve for more with --modes")
    columns = min(COLUMNS, len(steps))
    rows = -(-len(steps) // columns)
    head, foot, caption = 130, 110, 46
    width, height = columns * TILE[0], head + foot + rows * (TILE[1] + caption)
    figure = plt.figure(figsize=(width / 100, height / 100), dpi=100, facecolor="white")
    factors = [scale or shapes.factor(step, MODE_SHARE) for step in steps]
    fit = extent(shapes, steps, factors)  # all in the same size
    for place, (step, factor) in enumerate(zip(steps, factors)):
        row, column = divmod(place, columns)
        values = normalised(shapes.values(step, colour), colour)
        pixels = draw_shape(shapes, step, factor, values, Normalize(0, 1), sight, fit, TILE)
        bottom = height - head - (row + 1) * (TILE[1] + caption)
        axes = figure.add_axes([column * TILE[0] / width, (bottom + caption) / height, TILE[0] / width, TILE[1] / height])
        axes.imshow(pixels, interpolation="nearest", aspect="auto")
        axes.axis("off")
        figure.text((column + 0.5) * TILE[0] / width, (bottom + 0.55 * caption) / height,
                    f"mode {step + 1}:  {frequency_text(shapes, step)}", fontsize=19, color="#20242a", ha="center",
                    va="center")
    figure.text(36 / width, 1 - 46 / height, f"{shapes.title}: the first {len(steps)} {'buckling' if buckling else 'elastic'} modes", fontsize=26,
                weight="bold", color="#20242a", va="center")
    figure.text(36 / width, 1 - 96 / height, describe(shapes), fontsize=17, color="#4a5058", va="center")
    bar_axes = figure.add_axes([0.32, 70 / height, 0.36, 20 / height])
    bar = figure.colorbar(plt.cm.ScalarMappable(Normalize(0, 1), COLOURS), cax=bar_axes, orientation="horizontal")
    bar.set_label(f"{LABELS[colour]} over its largest value in each mode", fontsize=15, color="#20242a")
    bar.ax.tick_params(labelsize=13)
    save(figure, file)


def describe(shapes):
    unknowns = f"{int(shapes.results.attribute('/functions', 'unknowns')):,} unknowns"
    if shapes.results.analysis == "buckling":
        constant = shapes.results.texts("/buckling/constant")
        return (f"{unknowns}; factors on: {', '.join(shapes.results.texts('/buckling/growing')) or 'prescribed displacements'}"
                + (f"; constant: {', '.join(constant)}" if constant else ""))
    rigid = shapes.results.kinds().count("RIGID")
    found = f"{rigid} rigid modes" if rigid != 1 else "1 rigid mode"
    mass = shapes.results.attribute("/eigen", "mass")
    unit = "" if shapes.told else "; frequencies in cycles per unit of time"
    return f"{unknowns}, {mass} mass, {found}{unit}"


def draw_mode(shapes, step, colour, scale, sight, file):
    factor = scale or shapes.factor(step, MODE_SHARE)
    values = normalised(shapes.values(step, colour), colour)
    pixels = draw_shape(shapes, step, factor, values, Normalize(0, 1), sight, extent(shapes, [step], [factor]))
    page(pixels, f"{shapes.title}: mode {step + 1}", f"{frequency_text(shapes, step)}; {describe(shapes)}",
         file, colour_bar=(plt.cm.ScalarMappable(Normalize(0, 1), COLOURS), f"{LABELS[colour]} over its largest value"),
         extend="neither" if colour == "displacement" else "max")


def draw_heat(shapes, sight, file):
    values = shapes.values(0, "temperature")
    norm = Normalize(values.min(initial=np.inf), values.max(initial=-np.inf))
    pixels = draw_shape(shapes, 0, 0.0, values, norm, sight, shapes.vertices)
    page(pixels, shapes.title, f"temperature {norm.vmin:.4g} … {norm.vmax:.4g} on the surface", file,
         colour_bar=(plt.cm.ScalarMappable(norm, COLOURS), LABELS["temperature"]), extend="neither")


def draw_static(shapes, step, colour, scale, sight, file, case=""):
    factor = scale or shapes.factor(step, STATIC_SHARE)
    values = shapes.values(step, colour)
    if colour == "safety_factor":  # what matters is where it is small: below 1 all is as bad, far above all as good
        least = values.min(initial=np.inf)
        norm, map_name, extend = LogNorm(min(1.0, least), max(10 * least, 10.0)), SAFETY, "max"
    else:
        top = float(np.percentile(values, SPIKES) if colour.startswith("von_mises") else values.max(initial=0))
        norm, map_name = Normalize(0, top if top > 0 else 1), COLOURS
        extend = "max" if values.max(initial=0) > top else "neither"
    pixels = draw_shape(shapes, step, factor, values, norm, sight, extent(shapes, [step], [factor]), colours=map_name)
    largest = np.linalg.norm(shapes.displacement(step), axis=1).max(initial=0)
    label = f"|u|{' in' + shapes.unit if shapes.unit else ''}" if colour == "displacement" else LABELS[colour]
    page(pixels, f"{shapes.title}: {case}" if case else shapes.title, f"largest displacement {largest:.4g}{shapes.unit}, drawn {factor:.3g} times as large; "
         f"largest von Mises stress {shapes.values(step, 'von_mises').max(initial=0):.4g}"
         + (f", least safety factor {values.min(initial=np.inf):.4g}" if colour == "safety_factor" else ""),
         file, colour_bar=(plt.cm.ScalarMappable(norm, map_name), label), extend=extend)


def draw_envelope(shapes, cases, sight, file):
    """The largest stress of all load cases at each place, and how much of the surface belongs to which case."""
    most = shapes.results.envelope()
    top = float(np.percentile(most["von_mises"], SPIKES))
    norm = Normalize(0, top if top > 0 else 1)
    pixels = draw_shape(shapes, 0, 0.0, most["von_mises"], norm, sight, shapes.vertices)
    corners = shapes.vertices[shapes.triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    shares = [area @ (most["von_mises_case"][shapes.triangles] == k).mean(axis=1) / area.sum() for k in range(len(cases))]
    worst = most["von_mises"].argmax()
    page(pixels, f"{shapes.title}: all load cases",
         f"largest von Mises stress {most['von_mises'][worst]:.4g} in case {cases[most['von_mises_case'][worst]]}; largest on "
         + ", ".join(f"{100 * share:.3g} % of the surface: {case}" for case, share in zip(cases, shares) if share > 0),
         file, colour_bar=(plt.cm.ScalarMappable(norm, COLOURS), f"largest {LABELS['von_mises']} of all load cases"),
         extend="max" if most["von_mises"].max(initial=0) > top else "neither")


def draw(arguments, folder):
    """The pictures that the command line asks for."""
    try:
        shapes = Shapes(arguments.file)
    except (OSError, iga_results.FormatError) as error:
        sys.exit(f"render.py: {arguments.file}: {error}")
    if shapes.results.analysis not in ("eigen", "buckling"):
        if arguments.mode:
            sys.exit(f"render.py: {arguments.file}: holds no modes; leave out --mode")
        if shapes.results.analysis == "heat":
            draw_heat(shapes, arguments.sight, folder / f"{shapes.stem}_heat.png")
            return
        colour = arguments.colour or "von_mises"
        cases = shapes.results.texts("/static/cases/name") if "/static/cases/name" in shapes.results else [""]
        for step, case in enumerate(cases):
            of_case, what = (f"_case_{step + 1}" if case else ""), (f"_{colour}" if colour in ("safety_factor", "von_mises_error") else "")
            file = folder / f"{shapes.stem}{of_case + what or '_static'}.png"
            draw_static(shapes, step, colour, arguments.scale, arguments.sight, file, f"case {case}" if case else "")
        if len(cases) > 1:
            draw_envelope(shapes, cases, arguments.sight, folder / f"{shapes.stem}_envelope.png")
        return
    colour, count = arguments.colour or "displacement", len(shapes.surface["steps"])
    for number in arguments.mode:
        if not 1 <= number <= count:
            sys.exit(f"render.py: mode {number} is not in the file; it holds 1 … {count}")
        draw_mode(shapes, number - 1, colour, arguments.scale, arguments.sight, folder / f"{shapes.stem}_mode_{number}.png")
    if not arguments.mode:
        draw_sheet(shapes, colour, arguments.scale, arguments.sight, folder / f"{shapes.stem}_modes.png")
