#!/usr/bin/python3
"""Every part has exactly six rigid modes per mechanically separate body, and no other motion without stiffness.

  rigid_modes_test.py IGAPREP IGASOLVE PARTS

Proved by the Sturm count: the number of eigenvalues below the first elastic ones is the number found.
"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

SKIPPED = 77
BODIES = {"two_objects_mixed_case_names": 2}  # all others are one body
SPANS = 10  # along the longest side


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{Path(command[0]).name} ended with {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def main():
    igaprep, igasolve, parts = map(Path, sys.argv[1:])
    files = sorted(path for path in parts.glob("*") if path.suffix.lower() == ".stl")
    if not files:
        print(f"skipped: no parts in {parts} (CMake option IGA_SHARED_DIR)")
        return SKIPPED
    wrong = 0
    for path in files:
        with tempfile.TemporaryDirectory() as folder:
            model = Path(folder) / "part.h5"
            try:
                run(igaprep, path, "-o", model, "--spans", SPANS, "--quiet")
                report = json.loads(run(igasolve, "eigen", model, "--E", 1, "--nu", 0.3, "--rho", 1, "--modes", 1, "--json"))
            except RuntimeError as error:
                print(f"{path.name:36} {error}")
                wrong += 1
                continue
        bodies = BODIES.get(path.stem, 1)
        sturm = report["sturm"]
        fine = (report["bodies"] == bodies and report["rigid_modes"] == 6 * bodies and report["mechanisms"] == 0
                and sturm["expected"] == sturm["found"] >= 6 * bodies)
        wrong += not fine
        print(f"{path.name:36} bodies {report['bodies']}, rigid {report['rigid_modes']}, mechanisms {report['mechanisms']}, "
              f"Sturm count {sturm['expected']} of {sturm['found']}, unknowns {report['unknowns']}"
              f"{'' if fine else '  differs'}", flush=True)
    print(f"{len(files)} parts, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
