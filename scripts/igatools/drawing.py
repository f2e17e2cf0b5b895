"""What all pictures share: meshes for VTK, a view on them, a page with title, legend and colour bar.

Needs a screen, as the distribution's VTK draws through X: see render.py.
"""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
import vtkmodules.vtkRenderingOpenGL2  # noqa: E402, F401 registers the OpenGL implementation
from matplotlib.patches import Patch  # noqa: E402
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy  # noqa: E402
from vtkmodules.vtkCommonCore import vtkLogger, vtkLookupTable, vtkPoints  # noqa: E402
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData  # noqa: E402
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals  # noqa: E402
from vtkmodules.vtkFiltersGeneral import vtkTransformPolyDataFilter  # noqa: E402
from vtkmodules.vtkRenderingCore import (vtkActor, vtkLightKit, vtkPolyDataMapper, vtkRenderer,  # noqa: E402
                                         vtkRenderWindow, vtkWindowToImageFilter)

vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_WARNING)

PIXELS = (1600, 1080)


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def triangle_mesh(vertices, triangles):
    """Polydata of vertices (n, 3) and triangles (m, 3)."""
    points = vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices, float), deep=True))
    cells = vtkCellArray()
    count = len(triangles)
    cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, 3 * count + 1, 3, dtype=np.int64), deep=True),
                  numpy_to_vtkIdTypeArray(triangles.astype(np.int64).ravel(), deep=True))
    poly = vtkPolyData()
    poly.SetPoints(points)
    poly.SetPolys(cells)
    return poly


def grid_lines(lines):
    """Line segments (k, 2, 3) → polydata."""
    ends = np.asarray(lines, dtype=float).reshape(-1, 3)
    points = vtkPoints()
    points.SetData(numpy_to_vtk(ends, deep=True))
    cells = vtkCellArray()
    cells.SetData(numpy_to_vtkIdTypeArray(np.arange(0, len(ends) + 1, 2, dtype=np.int64), deep=True),
                  numpy_to_vtkIdTypeArray(np.arange(len(ends), dtype=np.int64), deep=True))
    poly = vtkPolyData()
    poly.SetPoints(points)
    poly.SetLines(cells)
    return poly


def moved(poly, transform):
    change = vtkTransformPolyDataFilter()
    change.SetInputData(poly)
    change.SetTransform(transform)
    change.Update()
    return change.GetOutput()


def with_normals(poly):
    normals = vtkPolyDataNormals()
    normals.SetInputData(poly)
    normals.SetFeatureAngle(35)
    normals.ConsistencyOff()
    normals.Update()
    return normals.GetOutput()


def actor_of(poly, colour=None, table=None, edges=None, lines=1.0, opacity=1.0, flat=False):
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(poly)
    mapper.SetScalarVisibility(table is not None)
    if table is not None:
        mapper.SetScalarModeToUseCellData()
        mapper.SetColorModeToMapScalars()
        mapper.SetLookupTable(table)
        mapper.UseLookupTableScalarRangeOn()
    actor = vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    if colour:
        look.SetColor(*colour)
    look.SetOpacity(opacity)
    look.SetLineWidth(lines)
    look.SetAmbient(0.36)
    look.SetDiffuse(0.72)
    look.SetSpecular(0.06 if not flat else 0.0)
    if flat:
        look.LightingOff()
    if edges:
        look.EdgeVisibilityOn()
        look.SetEdgeColor(*edges)
    return actor


def on_top(actor):
    """The actor, drawn over what lies in the same place."""
    mapper = actor.GetMapper()
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(-1, -4)
    return actor


def two_colours(first, second, low, high):
    table = vtkLookupTable()
    table.SetNumberOfTableValues(2)
    table.SetTableRange(low, high)
    table.SetTableValue(0, *first, 1)
    table.SetTableValue(1, *second, 1)
    table.Build()
    return table


def picture(actors, direction, up, fit_points, pixels=PIXELS):
    """Parallel projection of the actors along `direction`, filled by `fit_points`; everything in space."""
    renderer = vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    for actor in actors:
        renderer.AddActor(actor)
    lights = vtkLightKit()
    lights.SetKeyLightWarmth(0.5)
    lights.SetFillLightWarmth(0.5)
    lights.SetKeyToFillRatio(2.0)
    lights.AddLightsToRenderer(renderer)
    forward = np.asarray(direction, float) / np.linalg.norm(direction)
    side = np.cross(forward, up)
    side /= np.linalg.norm(side)
    upward = np.cross(side, forward)
    across, height = fit_points @ side, fit_points @ upward
    centre = fit_points.mean(axis=0)
    centre = centre + side * ((across.min() + across.max()) / 2 - centre @ side)
    centre = centre + upward * ((height.min() + height.max()) / 2 - centre @ upward)
    size = np.ptp(fit_points, axis=0).max()
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*centre)
    camera.SetPosition(*(centre - forward * 4 * size))
    camera.SetViewUp(*upward)
    camera.SetParallelScale(0.52 * max(np.ptp(height), np.ptp(across) * pixels[1] / pixels[0]))
    renderer.ResetCameraClippingRange()

    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(8)
    window.SetSize(*pixels)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    grab.Update()
    image = grab.GetOutput()
    columns, rows, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, -1)[::-1]


def corners(low, high):
    return np.array([[(low, high)[(c >> d) & 1][d] for d in range(3)] for c in range(8)])


def page(pixels, title, subtitle, file, legend=(), colour_bar=None, extend="both"):
    """Picture with a title above and a legend below, as a PNG."""
    width, height, head, foot = PIXELS[0], PIXELS[1], 130, 110
    figure = plt.figure(figsize=(width / 100, (height + head + foot) / 100), dpi=100, facecolor="white")
    total = height + head + foot
    axes = figure.add_axes([0, foot / total, 1, height / total])
    axes.imshow(pixels, interpolation="nearest", aspect="auto")
    axes.axis("off")
    figure.text(0.03, 1 - 48 / total, title, fontsize=24, weight="bold", color="#20242a", va="center")
    figure.text(0.03, 1 - 94 / total, subtitle, fontsize=15, color="#4a5058", va="center")
    if legend:
        patches = [Patch(facecolor=colour, edgecolor="#30343a", linewidth=0.6, label=label) for colour, label in legend]
        figure.legend(handles=patches, loc="lower left", bbox_to_anchor=(0.022, 20 / total), ncol=len(patches),
                      frameon=False, fontsize=15, handlelength=1.3, handleheight=1.3, columnspacing=2.2)
    if colour_bar:
        mappable, label = colour_bar
        bar_axes = figure.add_axes([0.56, 66 / total, 0.40, 20 / total])
        bar = figure.colorbar(mappable, cax=bar_axes, orientation="horizontal", extend=extend)
        bar.set_label(label, fontsize=13, color="#20242a")
        bar.ax.tick_params(labelsize=12)
    save(figure, file)


def save(figure, file):
    figure.savefig(file)
    plt.close(figure)
    print(f"render.py: wrote {file}")
