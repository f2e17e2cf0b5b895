"""Pictures of an explicit run for render.py: deformed bodies at six times, cut in half or whole."""
import sys
import xml.etree.ElementTree as ElementTree

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPlane, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkClipPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from igatools import sections
from igatools.drawing import actor_of, picture, save, triangle_mesh, with_normals

COLOURS = plt.get_cmap("turbo")
FRAMES, COLUMNS = 6, 3
TILE = (860, 720)
RIGID_COLOUR = (0.72, 0.74, 0.77)
SECTION_COLOUR, RIGID_SECTION_COLOUR = (0.90, 0.87, 0.80), (0.55, 0.57, 0.60)  # files hold fields of the surface alone
FARTHEST = 1.5  # rigid bodies are drawn as far as this much more than half the size of the deformable ones
QUANTITIES = {"displacement": "|u|", "von_mises": "von Mises stress", "plastic_strain": "equivalent plastic strain"}


def read_times(file):
    """Times and the files of each, from the list beside the results."""
    listed = file.with_suffix(".pvd")
    if not listed.is_file():
        sys.exit(f"render.py: {listed}: no such file; the run must write files for ParaView (viewer = true)")
    times = {}
    for item in ElementTree.parse(listed).getroot().iter("DataSet"):
        times.setdefault(float(item.get("timestep")), []).append(file.parent / item.get("file"))
    return sorted(times.items())


def read_part(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    poly = vtkPolyData()
    poly.ShallowCopy(reader.GetOutput())
    return poly


def quantity(poly, colour):
    """Values at the points, None for rigid bodies: they have no stress."""
    data = poly.GetPointData().GetArray(colour)
    if data is None or poly.GetPointData().GetArray("von_mises") is None:
        return None
    values = vtk_to_numpy(data)
    return np.linalg.norm(values, axis=1) if values.ndim == 2 else values


def points_of(poly):
    return vtk_to_numpy(poly.GetPoints().GetData())


def half_of(poly, place, direction):
    plane = vtkPlane()
    plane.SetOrigin(*place)
    plane.SetNormal(*direction)
    clip = vtkClipPolyData()
    clip.SetInputData(poly)
    clip.SetClipFunction(plane)
    clip.Update()
    return clip.GetOutput()


def is_closed(triangles):
    """Every edge belongs to two triangles, once in each direction."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    numbers = edges[:, 0] * (triangles.max() + 1) + edges[:, 1]
    reverse = edges[:, 1] * (triangles.max() + 1) + edges[:, 0]
    return bool(np.array_equal(np.sort(numbers), np.sort(reverse)))


def section_of(poly, place, direction):
    """What the plane cuts of a closed surface, filled; None for open surfaces and where it cuts nothing."""
    triangles = vtk_to_numpy(poly.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    if not is_closed(triangles):
        return None
    vertices, filled = sections.section(points_of(poly).astype(float), triangles, np.asarray(place), direction)
    return triangle_mesh(vertices, filled) if len(filled) > 0 else None


def is_near(poly, place, reach):
    return bool((np.abs(points_of(poly) - place) <= reach).all())


def near_part(poly, place, reach):
    """Planes reach far beyond what is looked at; None where nothing is left."""
    for direction in np.vstack([np.eye(3), -np.eye(3)]):
        poly = half_of(poly, place - reach * direction, direction)
    return poly if poly.GetNumberOfPoints() > 0 else None


def coloured(poly, values, norm):
    colours = (255 * COLOURS(norm(values))[:, :3]).astype(np.uint8)
    poly.GetPointData().SetScalars(numpy_to_vtk(colours, deep=True))
    return poly


def draw(arguments, folder):
    file, colour = arguments.file, arguments.colour or "von_mises"
    if colour not in QUANTITIES:
        sys.exit(f"render.py: {file}: safety factors and errors of stress are drawn of statics only; use --colour {', '.join(QUANTITIES)}")
    times = read_times(file)
    chosen = [times[i] for i in np.unique(np.linspace(0, len(times) - 1, FRAMES).round().astype(int))]
    frames = [(time, [read_part(path) for path in paths]) for time, paths in chosen]
    bodies = [[part for part in parts if quantity(part, colour) is not None] for _, parts in frames]
    if not bodies[0]:
        sys.exit(f"render.py: {file}: holds no {QUANTITIES[colour]} to draw")
    rest = np.concatenate([points_of(part) for part in bodies[0]])
    place, half = 0.5 * (rest.min(axis=0) + rest.max(axis=0)), 0.5 * np.ptp(rest, axis=0)
    reach = (1 + FARTHEST) * half.max()
    top = max(np.percentile(quantity(part, colour), 99.8) for parts in bodies for part in parts) or 1.0
    norm = Normalize(0, top)
    cut, sight = (0.0, 1.0, 0.0), np.array([0.18, 1.0, -0.22])
    shown = (lambda part: part) if arguments.whole else (lambda part: half_of(part, place, cut))  # noqa: E731
    everything = np.concatenate([points_of(part) for parts in bodies for part in parts])
    everything = np.concatenate([everything] + [points_of(part) for _, parts in frames for part in parts
                                                if quantity(part, colour) is None and is_near(part, place, reach)])
    low, high = np.minimum(everything.min(axis=0), place - half), np.maximum(everything.max(axis=0), place + half)

    rows = -(-len(frames) // COLUMNS)
    head, foot, caption = 100, 110, 46
    width, height = COLUMNS * TILE[0], head + foot + rows * (TILE[1] + caption)
    figure = plt.figure(figsize=(width / 100, height / 100), dpi=100, facecolor="white")
    for number, (time, parts) in enumerate(frames):
        actors = []
        for part in parts:
            values = quantity(part, colour)
            if values is None:
                if (near := near_part(part, place, reach)) is not None:
                    actors.append(actor_of(with_normals(shown(near)), colour=RIGID_COLOUR))
            else:
                actors.append(actor_of(with_normals(shown(coloured(part, values, norm)))))
                actors[-1].GetMapper().SetScalarVisibility(True)
            if arguments.whole:
                continue
            filled = section_of(part, place, cut)
            if filled is not None and (filled := near_part(filled, place, reach)) is not None:
                actors.append(actor_of(filled, colour=RIGID_SECTION_COLOUR if values is None else SECTION_COLOUR, flat=True))
        pixels = picture(actors, sight, (0, 0, 1), np.stack([low, high]), TILE)
        row, column = divmod(number, COLUMNS)
        bottom = height - head - (row + 1) * (TILE[1] + caption)
        axes = figure.add_axes([column * TILE[0] / width, (bottom + caption) / height, TILE[0] / width, TILE[1] / height])
        axes.imshow(pixels, interpolation="nearest", aspect="auto")
        axes.axis("off")
        figure.text((column + 0.5) * TILE[0] / width, (bottom + 0.55 * caption) / height, f"t = {time:.4g}", fontsize=19,
                    color="#20242a", ha="center", va="center")
    title = f"{file.stem}: {'bodies' if arguments.whole else 'bodies cut in half,'} in their true places"
    figure.text(36 / width, 1 - 50 / height, title, fontsize=26, weight="bold", color="#20242a", va="center")
    bar_axes = figure.add_axes([0.32, 70 / height, 0.36, 20 / height])
    bar = figure.colorbar(plt.cm.ScalarMappable(norm, COLOURS), cax=bar_axes, orientation="horizontal", extend="max")
    bar.set_label(QUANTITIES[colour], fontsize=15, color="#20242a")
    bar.ax.tick_params(labelsize=13)
    save(figure, folder / f"{file.stem}_frames.png")
