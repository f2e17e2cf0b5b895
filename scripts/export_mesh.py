#!/usr/bin/python3
"""Writes a run of igasolve static or eigen on a mesh of tetrahedra as a deck for CalculiX, and solves it: our answer
beside another's.

  scripts/export_mesh.py run.toml -o deck.inp --run              # static: displacement at the probes, reactions
  scripts/export_mesh.py part.h5 run.toml -o deck.inp --size 4 --modes 6 --run
  scripts/export_mesh.py part.stl run.toml -o deck.inp --size 4
  scripts/export_mesh.py run.toml -o surface.inp --surface       # the surface alone, for another mesher

run.toml is the run file of one part; its model (or part.h5, part.stl) gives the surface, which Gmsh fills with 10-node
tetrahedra that follow it. Exported are E, nu, rho, [[support]] with fixed = letters out of xyz, or "normal" on faces
along the axes, [[load]] with traction, pressure, force, body_force, acceleration, choices of surface by region, box,
plane, normal, whole_surface, [[probe]], [eigen] modes. All else is refused. Supports hold the nodes of the chosen
faces; forces are consistent with the loads.

Exit codes: 0 done, 2 run file, options or a missing program, 3 a model file, 4 the mesher or the solver failed.
"""

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from igatools import calculix  # noqa: E402
from igatools.iga_schema import FormatError  # noqa: E402
from igatools.measured_run import RunError, measured_run  # noqa: E402
from igatools.mesh_deck import ExportError, MeshRun  # noqa: E402
from igatools.whole_file import write_text  # noqa: E402


def program(name, package):
    path = shutil.which(name)
    if path is None:
        raise ExportError(f"{name} is missing; install it: apt-get install {package}")
    return path


def options_of(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE", help="[part.h5 | part.stl] run.toml")
    parser.add_argument("-o", "--output", type=Path, required=True, help="deck to be written (.inp)")
    parser.add_argument(
        "--size", metavar="H", help="size of the tetrahedra, or stl: on the surface's own triangles [span size]"
    )
    parser.add_argument(
        "--modes", type=int, metavar="N", help="the lowest N modes of the held part in place of the static answer"
    )
    parser.add_argument(
        "--surface", action="store_true", help="the surface alone: triangles, an element set for each region"
    )
    parser.add_argument("--run", action="store_true", help="solve the deck by CalculiX and print what it finds")
    parser.add_argument("--threads", type=int, default=1, help="threads of CalculiX [1]")
    parser.add_argument("--force", action="store_true", help="overwrite the deck")
    options = parser.parse_args(words)
    if len(options.files) > 2:
        parser.error(f"{len(options.files)} files; expected [part.h5 | part.stl] run.toml")
    if options.output.suffix != ".inp":
        parser.error(f"-o {options.output}: expected a name that ends with .inp")
    if options.output.exists() and not options.force:
        parser.error(f"{options.output} exists; give --force to overwrite it")
    if options.modes is not None and options.modes < 1:
        parser.error("--modes must be positive")
    return options


def mesh_size(options, run):
    """Target size of the tetrahedra; None for the surface's own triangles."""
    if options.size == "stl":
        return None
    try:
        size = float(options.size) if options.size else run.span
    except ValueError:
        size = 0.0
    if size is None:
        raise ExportError("a surface has no span size; expected --size")
    if not size > 0:
        raise ExportError(f"--size {options.size}: expected a positive length or stl")
    return size


def solved(options, run, modes):
    """Lines about CalculiX's answer; its files stay beside the deck."""
    folder, name = options.output.resolve().parent, options.output.stem
    measured = measured_run([program("ccx", "calculix-ccx"), name], folder / f"{name}.log", folder, options.threads)
    frd = folder / f"{name}.frd"
    if measured["exit_code"] != 0 or not frd.exists():
        raise RunError(f"CalculiX ended with exit code {measured['exit_code']}; see {folder / name}.log")
    if modes:
        frequencies = calculix.read_frequencies(folder / f"{name}.dat")
        if len(frequencies) < modes:
            raise RunError(f"CalculiX gave {len(frequencies)} of {modes} frequencies; see {folder / name}.log")
        yield from (f"mode {k:3}  {frequency:.8g}" for k, frequency in enumerate(frequencies, 1))
        return
    count = len(run.mesh.nodes)
    displacement, forces = (calculix.read_fields(frd, field, count) for field in ("DISP", "FORC"))
    if not displacement or not forces:
        raise RunError(f"CalculiX gave no displacements; see {folder / name}.log")
    u, reaction = displacement[-1], forces[-1]
    for probe, value in run.at_probes(u).items():
        yield f"probe {probe}: displacement {value[0]:.6g} {value[1]:.6g} {value[2]:.6g}"
    for support, total in run.reactions(reaction).items():
        yield f"support {support}: force on the part {total[0]:.6g} {total[1]:.6g} {total[2]:.6g}"
    yield f"largest displacement {np.linalg.norm(u, axis=1).max():.6g}"


def export(options):
    run = MeshRun(options.files[0] if len(options.files) == 2 else None, options.files[-1])
    if options.surface:
        write_text(options.output, "\n".join([*run.surface_lines(), ""]))
        print(f"{options.output}: {len(run.triangles)} triangles, {len(run.vertices)} nodes")
        return
    modes = options.modes or run.table.get("eigen", {}).get("modes")
    size = mesh_size(options, run)
    with tempfile.TemporaryDirectory() as folder:
        run.make_mesh(
            program("gmsh", "gmsh"),
            size,
            folder,
            lambda command, log: measured_run(command, log, None, options.threads),
        )
        write_text(options.output, "\n".join([*run.lines(modes), ""]))
    print(
        f"{options.output}: {len(run.mesh.elements)} tetrahedra, {run.mesh.nodes.size} unknowns, volume"
        f" {run.volume:.8g}"
    )
    for note in dict.fromkeys(run.notes):
        print(f"note: {note}")
    if options.run:
        for line in solved(options, run, modes):
            print(line)


def main():
    options = options_of(sys.argv[1:])
    try:
        export(options)
        return 0
    except FormatError as error:
        return _failed(error, 3)
    except (ExportError, OSError) as error:
        return _failed(error, 2)
    except RunError as error:
        return _failed(error, 4)


def _failed(error, code):
    print(f"export_mesh.py: {error}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
