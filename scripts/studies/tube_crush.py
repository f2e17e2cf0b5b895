#!/usr/bin/python3
"""A square tube of aluminium (50 x 50 x 2 mm, 150 long) crushed by a plate at 5 m/s: mean force, with and without F-bar.

  scripts/studies/tube_crush.py                             p = 2, spans of 8 and 5 mm, 50 mm of crushing: half an hour of one core
  scripts/studies/tube_crush.py --spans 8 --degrees 2 3     other spans, other degrees
  scripts/studies/tube_crush.py --locking none --crush 20   one treatment, less crushing

The tube stands on a rigid plane; both planes and the folds among themselves touch with friction 0.2. J2 with hardening by a curve: 0.17 GPa
at first, 0.2 at 5 %, 0.25 at 50 %. Beside it the mean force for symmetric folds of Abramowicz and Jones (1984), 13.06 s b^(1/3) t^(5/3) with
b = 50, t = 2 and s = 0.2 GPa, about the stress in the folds. Units: kg, mm, ms, kN.

Writes into --output: the part, each run with its results and log, study.json; the table is printed.
"""
import argparse
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from igatools import ROOT, Results  # noqa: E402
from igatools.stl import write_stl  # noqa: E402

WIDTH, WALL, LENGTH = 50.0, 2.0, 150.0
SPEED, RAMP, FLOW_STRESS = 5.0, 0.2, 0.2
RUN = """units = "mm"
[[bodies]]
model = "{model}"
name = "tube"
locking = "{locking}"
[bodies.material]
law = "j2"
E = 70.0
nu = 0.3
rho = 2.7e-6
yield_curve = [[0, 0.17], [0.05, 0.2], [0.15, 0.22], [0.5, 0.25], [1.5, 0.28]]
[[rigid_bodies]]
name = "base"
shape = "plane"
centre = [0, 0, 0]
normal = [0, 0, 1]
[[rigid_bodies]]
name = "ram"
shape = "plane"
centre = [0, 0, {length}]
normal = [0, 0, -1]
motion = "driven"
drive = {{ z = [[0, 0], [{ramp}, -{speed}], [1000, -{speed}]], kind = "velocity" }}
[[contacts]]
bodies = ["tube", "base"]
friction = 0.2
[[contacts]]
bodies = ["tube", "ram"]
friction = 0.2
[[contacts]]
self = "tube"
friction = 0.2
[time]
end = {end}
safety = 0.67
[output]
interval = 0.05
field_interval = 1
"""


def tube():
    """Triangles (32, 3, 3)."""
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2
    rings = [(size, z) for size in (WIDTH, WIDTH - 2 * WALL) for z in (0.0, LENGTH)]  # outer below, above, inner below, above
    vertices = np.array([[*(size * corner), z] for size, z in rings for corner in corners])
    triangles = []
    for k in range(4):
        n = (k + 1) % 4
        for a, b, c, d in ((k, n, 4 + n, 4 + k), (8 + n, 8 + k, 12 + k, 12 + n), (n, k, 8 + k, 8 + n), (4 + k, 4 + n, 12 + n, 12 + k)):
            triangles += [(a, b, c), (a, c, d)]
    return vertices[np.array(triangles)]


def crush(options, degree, span, locking):
    """Mean forces (kN) over each 10 mm and over all; what went wrong as text."""
    name = f"tube_p{degree}_{span:g}mm_{locking}"
    model, run, output = (options.output / f"{name}{ending}" for ending in ("_model.h5", ".toml", ".h5"))
    subprocess.run([ROOT / options.build / "igaprep", options.output / "tube.stl", "-o", model, "--degree", str(degree), "--span-size", str(span),
                    "--length-unit", "mm", "--quiet", "--force"], check=True, stderr=subprocess.DEVNULL)
    end = options.crush / SPEED + RAMP / 2
    run.write_text(RUN.format(model=model.name, locking=locking, length=LENGTH, ramp=RAMP, speed=SPEED, end=end))
    with open(options.output / f"{name}.log", "w", encoding="utf-8") as log:
        done = subprocess.run([ROOT / options.build / "igasolve", "explicit", run, "-o", output, "--force", "--threads", str(options.threads)],
                              stdout=log, stderr=log)
    results = Results(output)
    time, impulse = results["/time_series/time"], -results["/time_series/contact/tube-ram/impulse"][:, 2]
    way = np.where(time < RAMP, SPEED * time**2 / (2 * RAMP), SPEED * (time - RAMP / 2))
    work = np.concatenate([[0], np.cumsum(np.diff(impulse) / np.diff(time) * np.diff(way))])
    marks = np.arange(0, way[-1] + 1e-9, 10.0)
    return {"degree": degree, "span": span, "locking": locking, "exit_code": done.returncode, "crushed": float(way[-1]),
            "mean": float(work[-1] / way[-1]), "per_10mm": (np.diff(np.interp(marks, way, work)) / 10).tolist()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spans", type=float, nargs="+", default=[8.0, 5.0], metavar="MM")
    parser.add_argument("--degrees", type=int, nargs="+", default=[2], choices=(1, 2, 3, 4))
    parser.add_argument("--locking", nargs="+", default=["none", "fbar"], choices=("none", "fbar"))
    parser.add_argument("--crush", type=float, default=50.0, metavar="MM", help="how far the plate goes (default: 50)")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--build", type=Path, default=Path("build/release/bin"), help="folder of igaprep and igasolve")
    parser.add_argument("-o", "--output", type=Path, default=Path("tube_crush"))
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    write_stl(options.output / "tube.stl", tube())
    theory = 13.06 * FLOW_STRESS * WIDTH ** (1 / 3) * WALL ** (5 / 3)
    print(f"mean force of symmetric folds (Abramowicz and Jones 1984, flow stress {FLOW_STRESS} GPa): {theory:.1f} kN")
    rows = []
    for degree in options.degrees:
        for span in options.spans:
            for locking in options.locking:
                row = crush(options, degree, span, locking)
                rows.append(row)
                print(f"p = {degree}, {span:g} mm, {locking:5}: mean {row['mean']:.1f} kN over {row['crushed']:.1f} mm; each 10 mm "
                      + ", ".join(f"{force:.1f}" for force in row["per_10mm"])
                      + (f"; ended with exit code {row['exit_code']}" if row["exit_code"] else ""), flush=True)
                (options.output / "study.json").write_text(json.dumps({"theory": theory, "runs": rows}, indent=1))


if __name__ == "__main__":
    main()
