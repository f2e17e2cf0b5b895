#!/usr/bin/python3
"""Draws an interchange file, a results file or the choices of a run file: scripts/render.py FILE.h5 [--output folder]

Of a part (igaprep part.stl -o part.h5):
  <part>_spans.png      the part in its grid, interior and trimmed spans in two colours, partly cut away
  <part>_points.png     one layer of spans with its quadrature points, coloured by weight over span volume

  <part>_pieces.png     with --pieces instead: spans that hold several walls, coloured by cell, separate bodies in colours of
                        their own; the numbers of such spans and of functions with copies

Of results (igasolve eigen part.h5 … -o modes.h5, igasolve static …):
  <modes>_modes.png     the first six elastic (or buckling) modes on one sheet
  <modes>_mode_<n>.png  one mode each, for --mode n (numbers of the results file, the first is 1)
  <static>_static.png   the deformed part, or several bodies; <static>_safety_factor.png and <static>_von_mises_error.png with
                        --colour of that name (load cases: <static>_case_<n>…, and <static>_envelope.png, their largest stress)
  <explicit>_frames.png six times of an explicit run, cut in half, in their true places (--whole: not cut)
  <a>_minus_<b>.png     with --minus b.h5: where and by how much the displacements of two files differ (statics, and with --mode modes),
                        such as igasolve's and Kratos' (scripts/solve_kratos.py), or of two grids; of explicit and nonlinear runs the
                        last field, or --step n

Of a run file (scripts/render.py --choices run.toml; igasolve static and eigen):
  <run>_choices.png     the part from both sides, the surface that each support and load has chosen in a colour

Beside a report.json of scripts/iga frequencies are given with their estimated errors.

Deformations are exaggerated so that the largest displacement is some per cent of the part, or by --scale; the part at rest
is outlined. Needs h5py, matplotlib and the VTK that python3-paraview brings; without a screen it starts itself again under
xvfb-run. Lengths and axes are those of the part; a rotated grid is drawn rotated.
"""
import argparse
import os
import shutil
import sys
from pathlib import Path

RESULTS = ("iga-trimmed-solid-results", b"iga-trimmed-solid-results")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, nargs="?", help="interchange or results file (.h5)")
    parser.add_argument("--choices", type=Path, metavar="RUN.toml", help="draw the surface that a run file's supports and "
                        "loads have chosen")
    parser.add_argument("-o", "--output", type=Path, help="folder of the pictures (default: the file's); with --pieces also "
                        "the picture's own name, *.png")
    model = parser.add_argument_group("parts")
    model.add_argument("--pieces", action="store_true", help="draw cells and separate bodies instead")
    model.add_argument("--axis", choices="uvw", help="grid axis across the layer of points (default: the part's thinnest)")
    model.add_argument("--at", type=float, default=0.5, help="place of the layer along that axis of the part, 0 … 1")
    results = parser.add_argument_group("results")
    results.add_argument("--colour", choices=("displacement", "von_mises", "plastic_strain", "safety_factor", "von_mises_error"),
                         help="colour by |u|, von Mises stress, (explicit runs) equivalent plastic strain or (statics of one body) "
                              "safety factor against yield or estimated error of the von Mises stress (default: |u| for modes, von "
                              "Mises stress otherwise)")
    results.add_argument("--whole", action="store_true", help="explicit runs: do not cut the bodies in half")
    results.add_argument("--scale", type=float, help="factor on displacements (default: chosen for each picture)")
    results.add_argument("--mode", type=int, nargs="+", default=[], metavar="N", help="draw these modes, one picture each")
    results.add_argument("--minus", type=Path, metavar="OTHER.h5", help="draw the difference to another results file")
    results.add_argument("--step", type=int, metavar="N", help="with --minus: field of explicit and nonlinear runs, from 0 (default: the "
                         "last, -1)")
    results.add_argument("--sight", type=float, nargs=3, metavar=("X", "Y", "Z"), default=(0.62, 1.0, -0.62),
                         help="direction of sight (default: 0.62 1 -0.62)")
    arguments = parser.parse_args()
    if (arguments.file is None) == (arguments.choices is None):
        parser.error("give an interchange or results file (.h5), or --choices run.toml")
    return arguments


def need_a_screen():
    """VTK from the distribution draws through X; xvfb-run gives a machine without a screen one."""
    if os.environ.get("DISPLAY"):
        return
    if not shutil.which("xvfb-run"):
        sys.exit("render.py: no screen and no xvfb-run; install xvfb and xauth (or run scripts/setup)")
    os.environ["LIBGL_ALWAYS_SOFTWARE"] = "1"
    os.execvp("xvfb-run", ["xvfb-run", "-a", "-s", "-screen 0 1920x1200x24", sys.executable, *sys.argv])


def main():
    arguments = parse_arguments()
    file = arguments.file or arguments.choices
    if not file.is_file():
        sys.exit(f"render.py: {file}: no such file")
    need_a_screen()
    if arguments.choices:
        from igatools import render_choices
        render_choices.draw(arguments)
        return
    import h5py  # only after the screen is there

    try:
        with h5py.File(arguments.file) as file:
            format_name = file.attrs.get("format", "")
    except OSError as error:
        sys.exit(f"render.py: {arguments.file}: cannot be read ({error})")
    output = arguments.output or arguments.file.parent
    is_picture = arguments.pieces and output.suffix == ".png"
    folder = output.parent if is_picture else output
    folder.mkdir(parents=True, exist_ok=True)
    if arguments.pieces:
        from igatools import render_pieces
        render_pieces.draw(arguments, output if is_picture else folder / f"{arguments.file.stem}_pieces.png")
    elif arguments.minus:
        if not arguments.minus.is_file():
            sys.exit(f"render.py: {arguments.minus}: no such file")
        if format_name not in RESULTS:
            sys.exit(f"render.py: {arguments.file}: no results file, which --minus needs")
        from igatools import render_difference
        render_difference.draw(arguments, folder)
    elif format_name in RESULTS:
        with h5py.File(arguments.file) as file:
            explicit = "time_series" in file
        if explicit:
            from igatools import render_frames
            render_frames.draw(arguments, folder)
        else:
            from igatools import render_results
            render_results.draw(arguments, folder)
    else:
        from igatools import render_model
        render_model.draw(arguments, folder)


if __name__ == "__main__":
    main()
