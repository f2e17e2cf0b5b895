"""Picture of how two results files differ, for render.py --minus: of igasolve and another program, of two grids or settings."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize

from igatools import iga_results, render_results
from igatools.drawing import page
from igatools.results import Results

DRAWN = ("static", "eigen", "buckling")


def model_path(results, folders):
    """The model of a results file, beside one of the files or here."""
    name = results.attribute("/model", "file")
    for folder in folders:
        if (folder / name).is_file():
            return folder / name
    sys.exit(
        f"render.py: {name}: no such file in {', '.join(str(folder) for folder in folders)}; {results.path} needs its model"
    )


def maker(results):
    """Who computed a file."""
    if "/provenance" in results and "producer" in results.attributes["/provenance"]:
        return results.attribute("/provenance", "producer")
    return results.path.name


def step_of(results, mode):
    """Arguments of Results.displacement()."""
    return {"mode": mode} if results.analysis != "static" else {}


def displacement_of(other, shapes, mode, folders):
    """Displacements (n, 3) of the other file at the vertices of the first: the same functions at the same parameters where both have one
    model, else through places in space, nan where the other has no material."""
    same = other.attribute("/model", "sha256") == shapes.results.attribute("/model", "sha256")
    other = Results(other.path, model=model_path(other, folders))
    if same and "/surface/vertex_cell" in shapes.results:
        return other.field(
            other.model(),
            other.coefficients(**step_of(other, mode)),
            shapes.results["/surface/vertex_cell"],
            shapes.results["/surface/vertex_parameters"],
        )
    return other.displacement(shapes.vertices, **step_of(other, mode))


def check(first, other, arguments):
    for results in (first, other):
        if results.analysis not in DRAWN or "/bodies" in results:
            sys.exit(
                f"render.py: {results.path}: --minus compares statics and modes of one body, found an analysis '{results.analysis}'"
                + (" of several bodies" if "/bodies" in results else "")
            )
    if first.analysis != other.analysis:
        sys.exit(
            f"render.py: {first.path} holds an analysis '{first.analysis}', {other.path} '{other.analysis}'; --minus needs two alike"
        )
    if "/static/cases/name" in first or "/static/cases/name" in other:
        sys.exit("render.py: --minus compares files with one load case")
    if first.analysis == "static" and arguments.mode:
        sys.exit(f"render.py: {first.path}: holds no modes; leave out --mode")
    if first.analysis != "static" and not arguments.mode:
        sys.exit("render.py: --minus needs --mode N … for files of modes")
    if arguments.colour not in (None, "displacement"):
        sys.exit("render.py: --minus compares displacements; leave out --colour")


def draw(arguments, folder):
    try:
        shapes, other = render_results.Shapes(arguments.file), iga_results.read(arguments.minus)
    except (OSError, iga_results.FormatError) as error:
        sys.exit(f"render.py: {arguments.file} or {arguments.minus}: {error}")
    check(shapes.results, other, arguments)
    folders = [arguments.minus.parent, arguments.file.parent, Path(".")]
    for mode in [number - 1 for number in arguments.mode] or [0]:
        if (
            not 0
            <= mode
            < min(len(shapes.surface["steps"]), len(other.data.get("/frequencies", shapes.surface["steps"])))
        ):
            sys.exit(f"render.py: mode {mode + 1} is not in both files")
        draw_difference(arguments, shapes, other, mode, displacement_of(other, shapes, mode, folders), folder)


def draw_difference(arguments, shapes, other, mode, theirs, folder):
    ours, known = shapes.displacement(mode), np.isfinite(theirs).all(1)
    if not known.any():
        sys.exit(f"render.py: {other.path} has no material where {arguments.file} has its surface")
    is_mode = other.analysis != "static"
    if is_mode:  # the size of a mode means nothing
        theirs = theirs * ((ours[known] * theirs[known]).sum() / (theirs[known] ** 2).sum())
    values = np.where(known, np.linalg.norm(ours - theirs, axis=1), 0.0)
    largest, size = values.max(), np.linalg.norm(ours, axis=1).max(initial=0)
    norm = Normalize(0, largest if largest > 0 else 1)
    factor = arguments.scale or shapes.factor(
        mode, render_results.MODE_SHARE if is_mode else render_results.STATIC_SHARE
    )
    sight = arguments.sight
    pixels = render_results.draw_shape(
        shapes, mode, factor, values, norm, sight, render_results.extent(shapes, [mode], [factor])
    )
    text = f"largest difference {largest:.3g}{shapes.unit}" if not is_mode else "modes scaled to each other"
    text += f", {largest / size:.2g} of the largest displacement" if size > 0 else ""
    if not known.all():
        text += f"; {(~known).sum()} of {len(known)} vertices lie outside the other's solid and are left out"
    name = f"{shapes.stem}_minus_{other.path.stem}" + (f"_mode_{mode + 1}" if is_mode else "")
    page(
        pixels,
        f"{shapes.title}" + (f", mode {mode + 1}" if is_mode else ""),
        f"{maker(shapes.results)} minus {maker(other)}: {text}",
        folder / f"{name}.png",
        colour_bar=(
            plt.cm.ScalarMappable(norm, render_results.COLOURS),
            f"|difference of u|{' in' + shapes.unit if shapes.unit else ''}",
        ),
        extend="neither",
    )
