#!/usr/bin/python3
"""Runs the samples and compares what comes out with each one's expected.toml.

  scripts/run_samples.py                      all samples, with the Release build
  scripts/run_samples.py 03_sphere 04_torus   these ones
  scripts/run_samples.py --bin DIR --parts DIR --work DIR …

A sample with run files is run through igasolve too: heat.toml by `igasolve heat`, run.toml by `igasolve static`, random.toml, buckling.toml
and nonlinear.toml by the analyses of their names, in this order. Besides the figures of expected.toml, every model of an STL is held
against it: volume, centroid and area of the surface are computed here from the file's triangles, without any of the project's C++
code.
"""
import argparse
import json
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np

from igatools import ROOT
from igatools.stl import read_stl, surface_figures

SURFACE_TOLERANCE = 1e-11   # same triangles, summed in another order
POINTS_TOLERANCE = 1e-9     # the program's own bound on the volume of all points
RESIDUAL_TOLERANCE = 1e-10  # the default bound on every span's moments
RUN_FILES = (("heat", "heat"), ("static", "run"), ("random", "random"), ("buckling", "buckling"), ("nonlinear", "nonlinear"))


def run(command, work):
    """Standard output of a program that has to succeed quietly."""
    done = subprocess.run([str(word) for word in command], cwd=work, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{Path(command[0]).name} ended with {done.returncode}: {done.stderr.strip() or done.stdout.strip()}")
    if "HDF5-DIAG" in done.stderr:
        raise AssertionError(f"{Path(command[0]).name} printed an HDF5 error stack:\n{done.stderr}")
    return done.stdout


def look_up(report, key):
    if key == "spans.active":
        return report["spans"]["interior"] + report["spans"]["trimmed"]
    if key == "spans.total":
        return sum(report["spans"].values())
    value = report
    for name in key.split("."):
        value = value[int(name) if isinstance(value, list) else name]
    return value


def compare(figure, found):
    """One line about a figure; None where it is as expected."""
    if "range" in figure:
        low, high = figure["range"]
        return None if low <= found <= high else f"{figure['key']}: found {found}, expected {low} … {high}"
    expected = figure["value"]
    error = np.max(np.abs(np.asarray(found, float) - np.asarray(expected, float)))
    allowed = figure.get("absolute", 0.0) + figure.get("relative", 0.0) * np.max(np.abs(expected))
    if error <= allowed:
        return None
    return f"{figure['key']}: found {found}, expected {expected} to {allowed:.3g} ({figure['origin']})"


def run_sample(folder, arguments):
    """All deviations of one sample, one line each."""
    with open(folder / "prep.toml", "rb") as file:
        settings = tomllib.load(file)
    part = folder / settings["input"]  # a CAD file of the sample; else a part made by make_parts
    if not part.is_file():
        part = arguments.parts / part.name
    model = arguments.work / Path(settings["output"]).name
    with open(folder / "expected.toml", "rb") as file:
        figures = tomllib.load(file)["figure"]
    report = json.loads(run([arguments.bin / "igaprep", folder / "prep.toml", "--input", part, "-o", model, "--force",
                             "--json"], arguments.work))
    run([arguments.bin / "igasolve", "check", model], arguments.work)
    for analysis, name in RUN_FILES:
        if (folder / f"{name}.toml").exists():
            run_file = arguments.work / f"{folder.name}_{name}.toml"  # files beside it, in place of those in the build folder
            run_file.write_text((folder / f"{name}.toml").read_text().replace("../../build/release/samples/", ""))
            report[name] = json.loads(run([arguments.bin / "igasolve", analysis, run_file, "--force", "--json"], arguments.work))

    figures.append({"key": "max_residual", "range": [0.0, RESIDUAL_TOLERANCE]})
    volume = report["mesh_volume"]
    if part.suffix.lower() == ".stl":
        volume, centroid, area = surface_figures(read_stl(part))
        from_stl = "from the STL's triangles"
        figures += [
            {"key": "mesh_volume", "value": volume, "relative": SURFACE_TOLERANCE, "origin": from_stl},
            {"key": "area", "value": area, "relative": SURFACE_TOLERANCE, "origin": from_stl},
            {"key": "centroid", "value": centroid.tolist(), "absolute": 1e-6 * np.cbrt(volume), "origin": from_stl}]
    wrong = [line for figure in figures if (line := compare(figure, look_up(report, figure["key"])))]
    whole = report["volume"] - report.get("snapped_volume", 0.0) + report.get("dropped_volume", 0.0)
    if abs(whole - volume) > POINTS_TOLERANCE * volume:
        wrong.append(f"volume of all points, without snapping: found {whole}, expected {volume}")
    spans = report["spans"]
    print(f"{folder.name:<24} {spans['interior']:>7} {spans['trimmed']:>7} {report['points']:>8} "
          f"{report['max_residual']:>9.1e} {report['volume'] / volume - 1:>10.1e}  {'differs' if wrong else 'as expected'}")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("samples", nargs="*", help="names of folders in samples/ (default: all)")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of igaprep and igasolve")
    parser.add_argument("--parts", type=Path, default=ROOT / "build/release/samples", help="folder of the STL files")
    parser.add_argument("--work", type=Path, default=ROOT / "build/release/samples", help="folder of the models")
    arguments = parser.parse_args()
    arguments.bin, arguments.parts = arguments.bin.resolve(), arguments.parts.resolve()
    arguments.work = arguments.work.resolve()
    arguments.work.mkdir(parents=True, exist_ok=True)

    known = sorted(folder.parent.name for folder in ROOT.glob("samples/*/expected.toml"))
    if unknown := set(arguments.samples) - set(known):
        sys.exit(f"run_samples.py: no sample is called {', '.join(sorted(unknown))}; there are: {', '.join(known)}")
    print(f"{'sample':<24} interior trimmed   points  residual     volume")
    failures = 0
    for name in arguments.samples or known:
        try:
            wrong = run_sample(ROOT / "samples" / name, arguments)
        except (AssertionError, OSError, KeyError, ValueError) as error:
            wrong = [f"{type(error).__name__}: {error}"]
        for line in wrong:
            print(f"  {name}: {line}", file=sys.stderr)
        failures += bool(wrong)
    if failures:
        sys.exit(f"run_samples.py: {failures} sample(s) differ from what is expected")


if __name__ == "__main__":
    main()
