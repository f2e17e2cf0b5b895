#!/usr/bin/python3
"""Every part has exactly six rigid modes per mechanically separate body, and no other motion without stiffness.

  rigid_modes_test.py IGAPREP IGASOLVE PARTS

Proved by the Sturm count: the number of eigenvalues below the first elastic ones is the number found. Rules with few
points are tried on coarse grids, where spans have the fewest rigid neighbours to lean on.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77
BODIES = {"X_Carriage_x1": 2, "two_objects_mixed_case_names": 2}  # all others are one body
RULES = (("gauss", "nnls", 10), ("ggq", "minimal", 7), ("ggq-reduced", "minimal", 7))  # and spans along the longest side


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{Path(command[0]).name} ended with {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def is_rigid(igaprep, igasolve, path, *words):
    """Six rigid modes a body and nothing else; prints what was found."""
    with tempfile.TemporaryDirectory() as folder:
        model = Path(folder) / "part.h5"
        try:
            run(igaprep, path, "-o", model, *words, "--quiet")
            report = json.loads(run(igasolve, "eigen", model, "--E", 1, "--nu", 0.3, "--rho", 1, "--modes", 1, "--json"))
        except RuntimeError as error:
            print(f"{path.name:36} {error}")
            return False
    bodies = BODIES.get(path.stem, 1)
    sturm = report["sturm"]
    fine = (report["bodies"] == bodies and report["rigid_modes"] == 6 * bodies and report["mechanisms"] == 0
            and sturm["expected"] == sturm["found"] >= 6 * bodies)
    print(f"{path.name:36} bodies {report['bodies']}, rigid {report['rigid_modes']}, mechanisms {report['mechanisms']}, "
          f"Sturm count {sturm['expected']} of {sturm['found']}, unknowns {report['unknowns']}"
          f"{'' if fine else '  differs'}", flush=True)
    return fine


def main():
    igaprep, igasolve, parts = map(Path, sys.argv[1:])
    files = sorted(path for path in parts.glob("*") if path.suffix.lower() == ".stl")
    if not files:
        print(f"skipped: no parts in {parts} (CMake option IGA_SHARED_DIR)")
        return SKIPPED
    wrong = 0
    for interior, trimmed, spans in RULES:
        print(f"{interior} and {trimmed}, {spans} spans")
        wrong += sum(not is_rigid(igaprep, igasolve, path, "--spans", spans, "--quadrature", interior, "--trimmed", trimmed)
                     for path in files)
    print(f"{len(files)} parts, {len(RULES)} rules, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
