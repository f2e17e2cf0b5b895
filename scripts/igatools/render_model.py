"""Pictures of an interchange file for render.py: the part in its grid, and one layer of its quadrature points."""
import sys
from types import SimpleNamespace

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPlane, vtkPlaneCollection, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkCommonTransforms import vtkTransform
from vtkmodules.vtkFiltersCore import vtkCutter, vtkThreshold
from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface, vtkVertexGlyphFilter
from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

from igatools.drawing import (PIXELS, actor_of, corners, grid_lines, moved, page, picture, text, triangle_mesh,
                              two_colours, with_normals)
from igatools.iga_model import INTERIOR, TRIMMED

INTERIOR_COLOUR, TRIMMED_COLOUR = (0.16, 0.42, 0.66), (0.96, 0.65, 0.26)
SURFACE_COLOUR, SECTION_COLOUR, LINE_COLOUR = (0.80, 0.82, 0.85), (0.64, 0.67, 0.71), (0.18, 0.20, 0.23)


def read_model(path):
    """What the pictures need, as numpy arrays; the names are those of the file."""
    with h5py.File(path, "r") as file:
        patch = file["patch"].attrs
        model = SimpleNamespace(
            title=text(file.attrs.get("title", "")) or path.stem,
            unit=text(file.attrs.get("length_unit", "unspecified")),
            A=np.array(patch["A"]), B=np.array(patch["B"]), R=np.array(patch["rotation"]).reshape(3, 3),
            n=np.array(patch["spans"], dtype=np.int64), degree=np.array(patch["degree"]),
            state=file["spans/state"][()], cell_span=file["cells/span"][()],
            offsets=file["quadrature/offsets"][()], parameters=file["quadrature/parameters"][()],
            weights=file["quadrature/weights"][()],
            vertices=file["surface/vertices"][()], triangles=file["surface/triangles"][()])
    model.h = (model.B - model.A) / model.n
    model.C = (model.A + model.B) / 2
    return model


# ---------------------------------------------------------------------------------------------------- geometry

def to_space(model):
    """x = C + R (u - C) as a VTK transform."""
    matrix = vtkMatrix4x4()
    shift = model.C - model.R @ model.C
    for i in range(3):
        for j in range(3):
            matrix.SetElement(i, j, model.R[i, j])
        matrix.SetElement(i, 3, shift[i])
    transform = vtkTransform()
    transform.SetMatrix(matrix)
    return transform


def surface_in_grid(model):
    """The triangles in the grid's frame, where every cut is along an axis."""
    return triangle_mesh(model.C + (model.vertices - model.C) @ model.R, model.triangles)


def clipped(poly, origin, normal):
    """The side that `normal` points to, its section closed; cell scalars: 0 surface, 1 section."""
    plane = vtkPlane()
    plane.SetOrigin(origin)
    plane.SetNormal(normal)
    planes = vtkPlaneCollection()
    planes.AddItem(plane)
    clip = vtkClipClosedSurface()
    clip.SetInputData(poly)
    clip.SetClippingPlanes(planes)
    clip.SetScalarModeToLabels()
    clip.Update()
    return clip.GetOutput()


def span_faces(model, keep):
    """Outer faces of the kept spans, with the state of the span behind each face."""
    image = vtkImageData()
    image.SetDimensions(*(int(c) + 1 for c in model.n))
    image.SetOrigin(*model.A)
    image.SetSpacing(*model.h)
    shown = numpy_to_vtk(np.where(keep, model.state, 0).ravel(), deep=True)
    shown.SetName("state")
    image.GetCellData().SetScalars(shown)
    threshold = vtkThreshold()
    threshold.SetInputData(image)
    threshold.SetInputArrayToProcess(0, 0, 0, 1, "state")
    threshold.SetLowerThreshold(INTERIOR)
    threshold.SetUpperThreshold(TRIMMED)
    threshold.SetThresholdFunction(vtkThreshold.THRESHOLD_BETWEEN)
    faces = vtkDataSetSurfaceFilter()
    faces.SetInputConnection(threshold.GetOutputPort())
    faces.Update()
    return faces.GetOutput()


def wall_lines(model, axis, at, low, high, most=90):
    """Knot lines of the plane `axis` = at, between the corners low and high; thinned where they would merge to grey."""
    lines = []
    for along in range(3):
        if along == axis:
            continue
        across = 3 - axis - along
        knots = model.A[across] + model.h[across] * np.arange(model.n[across] + 1)
        knots = knots[(knots >= low[across] - 1e-9 * model.h[across]) & (knots <= high[across] + 1e-9 * model.h[across])]
        knots = knots[:: int(np.ceil(len(knots) / most))]
        segment = np.empty((len(knots), 2, 3))
        segment[:, :, axis] = at
        segment[:, :, across] = knots[:, None]
        segment[:, 0, along], segment[:, 1, along] = low[along], high[along]
        lines.append(segment)
    return np.concatenate(lines)


def in_space(model, points):
    return model.C + (np.asarray(points) - model.C) @ model.R.T


# ---------------------------------------------------------------------------------------------------- the two pictures

def material_box(model):
    """Corners of the box of all spans with material, in span numbers: low inclusive, high exclusive, order u v w."""
    n = model.n
    ijk = np.stack([model.cell_span % n[0], model.cell_span // n[0] % n[1], model.cell_span // (n[0] * n[1])])
    return ijk.min(axis=1), ijk.max(axis=1) + 1


def draw_spans(model, file):
    direction = np.array([0.62, 1.0, -0.62])  # of sight, in space
    sight, top = model.R.T @ direction, int(np.argmax(np.abs(model.R[2])))  # in the grid; its axis nearest to z
    low, high = material_box(model)
    sides = (high - low) * model.h
    long = max((axis for axis in range(3) if axis != top), key=lambda axis: sides[axis])
    middle = int(np.round((low[long] + high[long]) / 2))
    index = np.indices(model.state.shape)[::-1]  # u, v, w
    near = index[long] < middle if sight[long] > 0 else index[long] >= middle
    share = np.round(0.58 * (high[top] - low[top]))
    below = index[top] < low[top] + share if model.R[2, top] > 0 else index[top] >= high[top] - share

    # Near half: spans up to a ceiling. Far half: the surface itself, closed where it is cut.
    spans = span_faces(model, near & below)
    cut = model.A + model.h * np.where(np.arange(3) == long, middle, 0)
    surface = clipped(surface_in_grid(model), cut, np.sign(sight[long]) * np.eye(3)[long])
    walls = np.concatenate([wall_lines(model, axis, (model.A, model.B)[int(sight[axis] > 0)][axis], model.A, model.B)
                            for axis in range(3)])
    transform = to_space(model)
    edge = (0.25, 0.22, 0.20) if np.max(high - low) <= 90 else None
    states = two_colours(INTERIOR_COLOUR, TRIMMED_COLOUR, INTERIOR, TRIMMED)
    section = two_colours(SURFACE_COLOUR, SECTION_COLOUR, 0, 1)
    actors = [actor_of(moved(grid_lines(walls), transform), colour=(0.86, 0.87, 0.89), flat=True),
              actor_of(moved(with_normals(surface), transform), table=section),
              actor_of(moved(spans, transform), table=states, edges=edge)]
    pixels = picture(actors, direction, (0, 0, 1), in_space(model, corners(model.A, model.B)))
    interior, trimmed = int((model.state == INTERIOR).sum()), int((model.state == TRIMMED).sum())
    unit = "" if model.unit == "unspecified" else f" {model.unit}"
    sizes = " × ".join(f"{h:.4g}" for h in model.h)
    counts = " × ".join(str(c) for c in model.n)
    degrees = ", ".join(str(p) for p in model.degree)
    same = len(set(model.degree)) == 1
    page(pixels, f"{model.title} in its B-spline grid",
         f"{counts} spans of {sizes}{unit}, degree {model.degree[0] if same else degrees}", file,
         legend=[(INTERIOR_COLOUR, f"interior spans ({interior:,})"), (TRIMMED_COLOUR, f"trimmed spans ({trimmed:,})"),
                 (SURFACE_COLOUR, f"surface as given ({len(model.triangles):,} triangles)")])


def draw_points(model, file, axis, at):
    low, high = material_box(model)
    n = model.n
    axis = int(np.argmin((high - low) * model.h)) if axis is None else "uvw".index(axis)
    layer = int(np.clip(low[axis] + np.floor(at * (high[axis] - low[axis])), low[axis], high[axis] - 1))
    stride = np.array([1, n[0], n[0] * n[1]])
    owner = np.repeat(model.cell_span, np.diff(model.offsets))
    chosen = (owner // stride[axis]) % n[axis] == layer
    if not chosen.any():
        sys.exit("render.py: this layer holds no quadrature point; choose another --at")
    points, ratio = model.parameters[chosen], model.weights[chosen] / np.prod(model.h)

    # Seen from the low side of `axis`: everything in front of the layer is taken away, the part behind it stays.
    transform = to_space(model)
    front, back = model.A[axis] + model.h[axis] * layer, model.A[axis] + model.h[axis] * (layer + 1)
    behind = clipped(surface_in_grid(model), np.where(np.arange(3) == axis, back, model.C), np.eye(3)[axis])
    box_low, box_high = model.A + (low - 1) * model.h, model.A + (high + 1) * model.h
    just_before = back - 2e-3 * model.h[axis]  # so that lines are seen on the section
    lines = wall_lines(model, axis, just_before, box_low, box_high, most=200)
    plane = vtkPlane()
    plane.SetOrigin(*np.where(np.arange(3) == axis, just_before, model.C))
    plane.SetNormal(*np.eye(3)[axis])
    cutter = vtkCutter()
    cutter.SetInputData(surface_in_grid(model))
    cutter.SetCutFunction(plane)
    cutter.Update()

    norm = LogNorm(max(1e-4, float(np.percentile(ratio, 1))), float(ratio.max()))
    colours = plt.get_cmap("plasma_r")(norm(np.clip(ratio, norm.vmin, norm.vmax)))
    cloud = vtkPolyData()
    positions = vtkPoints()
    positions.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    cloud.SetPoints(positions)
    rgb = numpy_to_vtk((255 * colours[:, :3]).astype(np.uint8), deep=True)
    cloud.GetPointData().SetScalars(rgb)
    vertices = vtkVertexGlyphFilter()
    vertices.SetInputData(cloud)
    vertices.Update()
    dots = actor_of(moved(vertices.GetOutput(), transform))
    dots.GetMapper().SetScalarVisibility(True)
    dots.GetProperty().SetRenderPointsAsSpheres(True)

    section = two_colours(SURFACE_COLOUR, (0.90, 0.91, 0.93), 0, 1)
    actors = [actor_of(moved(with_normals(behind), transform), table=section),
              actor_of(moved(grid_lines(lines), transform), colour=(0.66, 0.68, 0.71), flat=True),
              actor_of(moved(cutter.GetOutput(), transform), colour=LINE_COLOUR, lines=2.5, flat=True), dots]
    direction, up = np.eye(3)[axis].copy(), np.eye(3)[(2, 2, 1)[axis]]
    direction += 0.06 * np.eye(3)[(1, 0, 0)[axis]] - 0.10 * up
    fit = corners(np.where(np.arange(3) == axis, front, box_low), np.where(np.arange(3) == axis, back, box_high))
    pixel = PIXELS[1] / np.max((box_high - box_low)[np.arange(3) != axis])
    spacing = np.cbrt(np.prod(model.h) / np.diff(model.offsets)[np.diff(model.offsets) > 0].mean())
    dots.GetProperty().SetPointSize(float(np.clip(0.42 * spacing * pixel, 2.5, 26)))
    pixels = picture(actors, model.R @ direction, model.R @ up, in_space(model, fit))
    page(pixels, f"{model.title}: quadrature points",
         f"one layer of spans, {'uvw'[axis]} = {front:.5g} … {back:.5g}; {len(points):,} of {len(model.weights):,} points", file,
         legend=[(SURFACE_COLOUR, "part behind the layer")],
         colour_bar=(plt.cm.ScalarMappable(norm, "plasma_r"), "weight / span volume"))


def draw(arguments, folder):
    """Both pictures of the part."""
    try:
        model = read_model(arguments.file)
    except (OSError, KeyError) as error:
        sys.exit(f"render.py: {arguments.file}: not a readable interchange file ({error}); try igasolve check")
    draw_spans(model, folder / f"{arguments.file.stem}_spans.png")
    draw_points(model, folder / f"{arguments.file.stem}_points.png", arguments.axis, arguments.at)
