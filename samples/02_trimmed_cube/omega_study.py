#!/usr/bin/python3
"""Largest eigenfrequency of the paper's trimmed cube over the trim θ: what decides the time step of explicit dynamics.

  samples/02_trimmed_cube/omega_study.py                          p = 1 … 4, θ = 0 … 40 mm; table, CSV and plot
  samples/02_trimmed_cube/omega_study.py --reference omega.csv    compares with columns p, theta_mm, omega_max_rad_per_ms
  samples/02_trimmed_cube/omega_study.py --reference omega.csv --only-reference --degrees 1 2

A B-spline cube of 120 mm in 12 spans per direction, trimmed by θ on every side; row-sum lumped mass, exact quadrature
(moment degree 2p), no treatment of light functions. kg-mm-ms units: E = 210 kN/mm², nu = 0.33, rho = 7.8e-6 kg/mm³,
angular frequency in rad/ms. The FE reference line is p = 1 at θ = 0: trilinear elements of 10 mm. After the paper's
Fig. 4 (whose table mixes units).
"""
import argparse
import csv
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
EDGE, SPANS = 120.0, 12
MATERIAL = ["--E", "210", "--nu", "0.33", "--rho", "7.8e-6"]
TOLERANCE = 1e-6        # of every value against the reference
NEAR_A_PLANE = 1e-4     # for p = 1 where the trim comes close to a knot plane and the frequency has no bound
NEAR = 0.2              # mm
SKIPPED = 77            # exit code by which ctest knows a skipped test

# The corners of a cube and its twelve triangles, outward.
CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
TRIANGLES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4),
             (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5)]


def write_cube(path, theta):
    """ASCII STL with 17 digits: the trim is met to the last bit."""
    side = (theta, EDGE - theta)
    with open(path, "w") as file:
        file.write("solid cube\n")
        for triangle in TRIANGLES:
            file.write("facet normal 0 0 0\nouter loop\n")
            for corner in triangle:
                file.write("vertex " + " ".join(f"{side[i]:.17g}" for i in CORNERS[corner]) + "\n")
            file.write("endloop\nendfacet\n")
        file.write("endsolid cube\n")


def run(command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"omega_study.py: {' '.join(map(str, command))} ended with {done.returncode}:\n{done.stderr}")
    return json.loads(done.stdout)


def omega_max(arguments, degree, theta):
    name = f"cube_p{degree}_{theta:.6g}"
    surface, model = arguments.output / f"{name}.stl", arguments.output / f"{name}.h5"
    write_cube(surface, theta)
    run([arguments.bin / "igaprep", surface, "-o", model, "--box", 0, 0, 0, *[f"{EDGE}"] * 3, "--spans", SPANS,
         "--degree", degree, "--moment-degree", "2p", "--force", "--json"])
    report = run([arguments.bin / "igasolve", "eigen", model, *MATERIAL, "--largest", "--mass", "lumped",
                  "--light-functions", "none", "--json"])
    surface.unlink()
    model.unlink()
    return report["omega_max"]


def default_trims():
    """Every millimetre, and closer where p = 1 has its poles."""
    trims = set(range(0, 41))
    for plane in (10, 20, 30, 40):
        trims |= {plane - 0.5, plane - 0.1} | ({plane + 0.1, plane + 0.5} if plane < 40 else set())
    return sorted(float(t) for t in trims)


def read_reference(path):
    with open(path, newline="") as file:
        return {(int(row["p"]), float(row["theta_mm"])): float(row["omega_max_rad_per_ms"]) for row in csv.DictReader(file)}


def allowed(degree, theta):
    near = degree == 1 and any(abs(theta - plane) <= NEAR for plane in (10, 20, 30))
    return NEAR_A_PLANE if near else TOLERANCE


def plot(values, reference_line, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(7.5, 5))
    for degree in sorted({p for p, _ in values}):
        points = sorted((theta, omega) for (p, theta), omega in values.items() if p == degree)
        axes.plot(*zip(*points), marker=".", label=f"p = {degree}")
    axes.axhline(reference_line, color="black", linestyle="--", label="linear finite elements, 10 mm")
    axes.set(xlabel="trim θ, mm", ylabel="largest eigenfrequency, rad/ms", xlim=(0, 40), ylim=(800, 3000))
    axes.legend()
    axes.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(path, dpi=150)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of igaprep and igasolve")
    parser.add_argument("--output", type=Path, default=ROOT / "build/release/omega_study", help="folder of table and plot")
    parser.add_argument("--degrees", type=int, nargs="+", default=[1, 2, 3, 4])
    parser.add_argument("--trims", type=float, nargs="+", help="θ in mm (default: 0 … 40)")
    parser.add_argument("--reference", type=Path, help="CSV with columns p, theta_mm, omega_max_rad_per_ms")
    parser.add_argument("--only-reference", action="store_true", help="only the reference's own pairs of p and θ")
    arguments = parser.parse_args()
    if arguments.reference and not arguments.reference.exists():
        print(f"skipped: {arguments.reference} is absent (CMake option IGA_SHARED_DIR)")
        return SKIPPED
    arguments.output.mkdir(parents=True, exist_ok=True)

    reference = read_reference(arguments.reference) if arguments.reference else {}
    if arguments.only_reference:
        if not reference:
            parser.error("--only-reference needs --reference")
        pairs = sorted(reference)
    else:
        pairs = sorted({(p, t) for p in arguments.degrees for t in arguments.trims or default_trims()} | set(reference))
    pairs = [(p, t) for p, t in pairs if p in arguments.degrees and (not arguments.trims or t in arguments.trims)]

    print(" p  θ, mm   omega_max, rad/ms    reference      difference")
    values, wrong = {}, 0
    for degree, theta in pairs:
        omega = values[degree, theta] = omega_max(arguments, degree, theta)
        line = f"{degree:2}  {theta:6.6g}  {omega:16.7f}"
        if (degree, theta) in reference:
            difference = omega / reference[degree, theta] - 1
            fine = abs(difference) <= allowed(degree, theta)
            wrong += not fine
            line += f"  {reference[degree, theta]:14.4f}  {difference:13.2e}{'' if fine else '  differs'}"
        print(line, flush=True)
    with open(arguments.output / "omega_max.csv", "w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["p", "theta_mm", "omega_max_rad_per_ms"])
        rows.writerows([p, t, f"{omega:.10g}"] for (p, t), omega in values.items())
    if not arguments.only_reference:
        line = values.get((1, 0.0)) or omega_max(arguments, 1, 0.0)
        plot(values, line, arguments.output / "omega_max.png")
        print(f"table and plot: {arguments.output}/omega_max.csv, omega_max.png")
    if reference:
        compared = sum(pair in reference for pair in values)
        print(f"{compared} values compared, {wrong} differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
