"""Picture of how two results files differ, for render.py --minus: of igasolve and another program, of two grids or settings."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Normalize

from igatools import iga_results, render_results
from igatools.drawing import page
from igatools.results import Results

SHAPES = ("eigen", "buckling")  # of any size
STATES = ("static", "nonlinear", "explicit")
SAME_TIME = 1e-6  # of the time of a state


class OneFile(render_results.Shapes):
    """Shapes of a file that holds them itself, and `places`: cells and parameters of the vertices, None where the file has no cells."""

    when = ""

    def __init__(self, path):
        super().__init__(path)
        names = ("/surface/vertex_cell", "/surface/vertex_parameters")
        self.places = tuple(self.results[name] for name in names) if names[0] in self.results else None


class OneState(render_results.Shapes):
    """The same of one state of an explicit or nonlinear run: the field written at a step."""

    def __init__(self, path, step):
        self.results, self.told, self.stem, self.step = Results(path), {}, path.stem, step
        self.title = self.results.attribute("/", "title") or path.stem
        try:
            self.vertices, self.triangles, fields = self.results.surface(step=step)
        except (ValueError, IndexError) as error:
            sys.exit(f"render.py: {error}")
        self.surface = {"displacement": fields["displacement"][None], "steps": np.ones(1)}
        self.diagonal = float(np.linalg.norm(np.ptp(self.vertices, axis=0)))
        unit = self.results.attribute("/", "length_unit")
        self.unit = "" if unit == "unspecified" else f" {unit}"
        self.when = f", {'t' if self.results.analysis == 'explicit' else 'load factor'} = {self.results.times[step]:.5g}"
        mesh, body = self.results.fields(step).mesh, self.results.bodies[0]
        self.places = mesh[f"{body}/vertex_cell"], mesh[f"{body}/vertex_parameters"]


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


def step_of(results, mode, step):
    """Arguments of Results.displacement()."""
    if results.analysis in SHAPES:
        return {"mode": mode}
    return {} if results.analysis == "static" else {"step": step}


def displacement_of(other, shapes, mode, step, folders):
    """Displacements (n, 3) of the other file at the vertices of the first: the same functions at the same parameters where both have one
    model, else through places in space, nan where the other has no material."""
    same = other.attribute("/model", "sha256") == shapes.results.attribute("/model", "sha256")
    other = Results(other.path, model=model_path(other, folders))
    if same and shapes.places is not None:
        return other.displacement_in(*shapes.places, **step_of(other, mode, step))
    return other.displacement(shapes.vertices, **step_of(other, mode, step))


def bodies_of(results):
    names = results.texts("/body_names") if "/body_names" in results.data else []
    return len(names)


def check(first, other, arguments):
    for results in (first, other):
        if results.analysis not in SHAPES + STATES or bodies_of(results) > 1:
            sys.exit(
                f"render.py: {results.path}: --minus compares states and modes of one body, found an analysis '{results.analysis}'"
                + (" of several bodies" if bodies_of(results) > 1 else "")
            )
    if (first.analysis in SHAPES or other.analysis in SHAPES) and first.analysis != other.analysis:
        sys.exit(
            f"render.py: {first.path} holds an analysis '{first.analysis}', {other.path} '{other.analysis}'; --minus needs two alike"
        )
    if "/static/cases/name" in first or "/static/cases/name" in other:
        sys.exit("render.py: --minus compares files with one load case")
    if first.analysis in STATES and arguments.mode:
        sys.exit(f"render.py: {first.path}: holds no modes; leave out --mode")
    if first.analysis in SHAPES and not arguments.mode:
        sys.exit("render.py: --minus needs --mode N … for files of modes")
    if arguments.step is not None and "static" in (first.analysis, other.analysis):
        sys.exit("render.py: --step chooses a field of two explicit or nonlinear runs; a static file has one state, which is compared with "
                 "the last")
    if arguments.colour not in (None, "displacement"):
        sys.exit("render.py: --minus compares displacements; leave out --colour")


def check_times(first, other, step):
    """Fields of two series are compared at one time, or load factor."""
    times = [results.times[step] for results in (first, other) if results.analysis != "static"]
    if len(times) == 2 and abs(times[0] - times[1]) > SAME_TIME * max(map(abs, times)):
        sys.exit(
            f"render.py: field {step} of {first.path} is at {times[0]:.6g}, of {other.path} at {times[1]:.6g}; --minus needs one time: choose "
            "it by --step, or write fields at the same times (field_interval)"
        )


def draw(arguments, folder):
    try:
        first, other = Results(arguments.file), Results(arguments.minus)
    except (OSError, iga_results.FormatError) as error:
        sys.exit(f"render.py: {arguments.file} or {arguments.minus}: {error}")
    check(first, other, arguments)
    step = -1 if arguments.step is None else arguments.step
    series = first.analysis in ("explicit", "nonlinear")
    shapes = OneState(arguments.file, step) if series else OneFile(arguments.file)
    if other.analysis in ("explicit", "nonlinear") and not -other.num_fields() <= step < other.num_fields():
        sys.exit(f"render.py: {other.path} holds {other.num_fields()} fields; --step {step} is not among them")
    check_times(first, other, step)
    folders = [arguments.minus.parent, arguments.file.parent, Path(".")]
    for mode in [number - 1 for number in arguments.mode] or [0]:
        if (
            not 0
            <= mode
            < min(len(shapes.surface["steps"]), len(other.data.get("/frequencies", shapes.surface["steps"])))
        ):
            sys.exit(f"render.py: mode {mode + 1} is not in both files")
        theirs = displacement_of(other, shapes, mode, step, folders)
        draw_difference(arguments, shapes, other, mode, theirs, folder)


def draw_difference(arguments, shapes, other, mode, theirs, folder):
    ours, known = shapes.displacement(mode), np.isfinite(theirs).all(1)
    if not known.any():
        sys.exit(f"render.py: {other.path} has no material where {arguments.file} has its surface")
    is_mode = other.analysis in SHAPES
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
        f"{shapes.title}{shapes.when}" + (f", mode {mode + 1}" if is_mode else ""),
        f"{maker(shapes.results)} minus {maker(other)}: {text}",
        folder / f"{name}.png",
        colour_bar=(
            plt.cm.ScalarMappable(norm, render_results.COLOURS),
            f"|difference of u|{' in' + shapes.unit if shapes.unit else ''}",
        ),
        extend="neither",
    )
