#!/usr/bin/python3
"""An elastic wave by explicit dynamics: trimmed splines beside CalculiX, figures side by side in one run.

  scripts/studies/compare_wave.py                   all sizes, minutes; table, CSV and plot in build/compare_wave
  scripts/studies/compare_wave.py --quick           the coarsest size alone, in seconds
  scripts/studies/compare_wave.py --sizes 5 2.5 --methods C3D8 p2 p2-two-pass

A free square bar, 100 × 10 × 10 mm, gets a smooth pressure pulse on one end (bar_wave.py); no contact. CalculiX runs
*DYNAMIC, EXPLICIT with bricks (C3D8: full integration, C3D8R: one point), igasolve explicit runs splines of degree p on a
grid whose planes miss every face by 0.37 of a span (`aligned`: lie in the faces), with the lumped mass or two passes.
Looked at: mean displacement of the far end, displacement of the middle, over time. nu = 0: against the exact solution.
nu = 0.3: there is none; the reference is the finest C3D8 run, whose own error stands in the nu = 0 table.
"""
import argparse
import csv
import shutil
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import bar_wave  # noqa: E402
from igatools import ROOT, calculix, iga_model, iga_results  # noqa: E402
from igatools.measured_run import RunError, measured_report, measured_run  # noqa: E402

OFFSET = 0.37  # of a span: no face of the bar lies in a plane of the grid
OUTPUTS = 250  # fields of a run of igasolve
METHODS = {  # degree, mass, offset of the grid; CalculiX for the others
    "p1-aligned": (1, "lumped", 0.0), "p2": (2, "lumped", OFFSET), "p2-two-pass": (2, "two-pass", OFFSET),
    "p2-three-pass": (2, "three-pass", OFFSET), "p3-two-pass": (3, "two-pass", OFFSET)}
BRICKS = ("C3D8", "C3D8R")
COLUMNS = ("nu", "method", "size", "points", "unknowns", "steps", "first_step", "cpu_s", "error_end", "error_middle")


def parse_arguments(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", type=float, nargs="+", default=[5.0, 2.5, 1.25], help="edges of bricks and spans, mm")
    parser.add_argument("--methods", nargs="+", choices=(*BRICKS, *METHODS), default=[*BRICKS, *METHODS])
    parser.add_argument("--nu", type=float, nargs="+", default=[0.0, 0.3])
    parser.add_argument("--quick", action="store_true", help="the coarsest size alone")
    parser.add_argument("--output", type=Path, default=ROOT / "build" / "compare_wave")
    parser.add_argument("--bin", type=Path, default=ROOT / "build" / "release" / "bin", help="folder of igaprep and igasolve")
    parser.add_argument("--threads", type=int, default=1, help="threads of igasolve; CalculiX's explicit steps use one")
    options = parser.parse_args(words)
    if options.quick:
        options.sizes = options.sizes[:1]
    return options


def calculix_run(options, method, size, nu):
    ccx = shutil.which("ccx")
    if ccx is None:
        raise calculix.CalculixError("ccx is missing; install it: apt-get install calculix-ccx")
    mesh = bar_wave.hexahedra(size)
    nodes, bricks, _ = mesh
    times = np.linspace(0, bar_wave.PULSE, bar_wave.PULSE_SAMPLES + 1)
    probes = bar_wave.nodes_at(nodes, bar_wave.probe_points())
    t, u, measured = calculix.solve_pulse(ccx, options.output, f"{method}_{size:g}_{nu:g}", mesh, method,
                                          {"E": bar_wave.E, "nu": nu, "rho": bar_wave.RHO},
                                          np.column_stack([times, bar_wave.pressure(times)]), bar_wave.END, probes, measured_run)
    row = {"points": len(bricks) * (8 if method == "C3D8" else 1), "unknowns": 3 * len(nodes), "steps": len(t),
           "first_step": t[0], "cpu_s": measured["cpu_s"]}
    return row, t, bar_wave.observed(u[:, :, 0])


def displacements_at(model_file, results, points):
    """x components at points (n, 3) of the bar at all times of the fields: times (k), (k, n)."""
    model = iga_model.read(model_file)
    low, spans = model.attribute("/patch", "A"), model.attribute("/patch", "spans")
    size = (model.attribute("/patch", "B") - low) / spans
    cells = {tuple(index): cell for cell, index in enumerate(model.cell_spans())}  # a bar: one a span
    places = []
    for point in points:  # a probe on the surface may lie in a plane of the grid: the span with material owns it
        place = (point - low) / size
        around = [(i, j, k) for i in _spans_at(place[0]) for j in _spans_at(place[1]) for k in _spans_at(place[2])]
        places.append(next(index for index in around if index in cells))
    values = model.functions_at(np.array(places), points)[1]
    fields = [results.fields(step) for step in range(results.num_fields())]
    rows = model["/cells/functions"][[cells[index] for index in places]]
    u = [np.einsum("ni,ni->n", values, field["bar/coefficients"][rows, 0]) for field in fields]
    return np.array([field.time for field in fields]), np.array(u)


def _spans_at(place, tolerance=1e-9):
    return sorted({int(np.floor(place - tolerance)), int(np.floor(place + tolerance))})


def igasolve_run(options, method, size, nu):
    degree, mass, offset = METHODS[method]
    name = f"{method}_{size:g}_{nu:g}"
    model, results = options.output / f"{name}_model.h5", options.output / f"{name}.h5"
    low, high, spans = bar_wave.grid(size, offset, degree)
    text = options.output / f"{name}.toml"
    bar_wave.write_stl(options.output / "bar.stl")
    bar_wave.write_pulse(options.output / "pulse.csv")
    text.write_text(bar_wave.run_file(model.name, nu, mass, OUTPUTS))
    threads = ["--threads", options.threads]
    _, prepared = measured_report([options.bin / "igaprep", options.output / "bar.stl", "-o", model, "--degree", degree,
                                   "--box", *low, *high, "--spans", *spans, "--quadrature", "ggq-reduced", "--trimmed",
                                   "minimal" if degree < 3 else "nnls", "--length-unit", "mm", "--force", "--json", *threads],
                                  options.output / f"{name}.igaprep.log", options.threads)
    measured, _ = measured_report([options.bin / "igasolve", "explicit", text, "-o", results, "--force", "--quiet", "--json",
                                   *threads], options.output / f"{name}.igasolve.log", options.threads)
    found = iga_results.read(results)
    t, u = displacements_at(model, found, bar_wave.probe_points())
    dt = found["/time_series/dt"]
    first = float(dt[dt > 0][0])
    row = {"points": prepared["points"], "unknowns": 3 * (prepared["functions"] - prepared["light_functions"]),
           "steps": round(bar_wave.END / first), "first_step": first, "cpu_s": measured["cpu_s"]}
    return row, t, bar_wave.observed(u)


def all_runs(options, nu):
    """Rows and curves of one Poisson's ratio, coarse to fine; a run that fails is told and left out."""
    rows, curves, failed = [], {}, 0
    for method in options.methods:
        for size in options.sizes:
            print(f"nu {nu:g}  {method:14} size {size:g} …", file=sys.stderr, flush=True)
            try:
                row, t, u = (calculix_run if method in BRICKS else igasolve_run)(options, method, size, nu)
            except (calculix.CalculixError, RunError) as error:
                print(f"compare_wave.py: {method}, size {size:g}: {error}", file=sys.stderr)
                failed += 1
                continue
            rows.append({"nu": nu, "method": method, "size": size} | row)
            curves[method, size] = t, u
    return rows, curves, failed


def reference_of(nu, curves):
    """Observed displacements as a function of time, and the key of the run that they are from (None: exact)."""
    if nu == 0:
        return bar_wave.exact_observed, None
    bricks = [key for key in curves if key[0] == "C3D8"]
    if not bricks:
        return None, None
    key = min(bricks, key=lambda one: one[1])
    t, u = curves[key]
    return lambda times: np.column_stack([np.interp(times, t, column) for column in u.T]), key


def add_errors(rows, curves, nu):
    reference, own = reference_of(nu, curves)
    for row in rows:
        key = row["method"], row["size"]
        errors = bar_wave.relative_error(*curves[key], reference) if reference and key != own else (None, None)
        row["error_end"], row["error_middle"] = errors


def table(rows):
    lines = ["| nu | method | size, mm | points | unknowns | steps | time step, ms | CPU s | error of the end, % | of the middle, % |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    for row in rows:
        errors = ["reference" if row[key] is None else f"{100 * row[key]:.2f}" for key in ("error_end", "error_middle")]
        lines.append(f"| {row['nu']:g} | {row['method']} | {row['size']:g} | {row['points']} | {row['unknowns']} | "
                     f"{row['steps']} | {row['first_step']:.3g} | {row['cpu_s']:.1f} | {errors[0]} | {errors[1]} |")
    return "\n".join(lines) + "\n"


def draw(path, every, sizes):
    """Above: the middle of the bar over time for the coarsest size; below: errors of the end over CPU time."""
    figure, axes = plt.subplots(2, len(every), figsize=(8 * len(every), 11), dpi=110, constrained_layout=True, squeeze=False)
    for column, (nu, (rows, curves)) in enumerate(every.items()):
        above, below = axes[0, column], axes[1, column]
        reference, own = reference_of(nu, curves)
        times = np.linspace(0, bar_wave.END, 1000)
        if reference:
            above.plot(times, 1e3 * reference(times)[:, 1], color="#20242a", linewidth=2.4, alpha=0.55,
                       label="exact" if own is None else f"{own[0]}, {own[1]:g} mm")
        for method in dict.fromkeys(row["method"] for row in rows):
            if (method, sizes[0]) in curves:
                t, u = curves[method, sizes[0]]
                above.plot(t, 1e3 * u[:, 1], linewidth=1.3, label=f"{method}, {sizes[0]:g} mm")
            known = [row for row in rows if row["method"] == method and row["error_end"] is not None]
            below.loglog([row["cpu_s"] for row in known], [row["error_end"] for row in known], marker="o", label=method)
        above.set_title(f"nu = {nu:g}: middle of the bar, size {sizes[0]:g} mm", loc="left", weight="bold")
        above.set_xlabel("time, ms")
        above.set_ylabel("displacement, µm")
        below.set_title(f"nu = {nu:g}: end face, " + ", ".join(f"{size:g}" for size in sizes) + " mm", loc="left", weight="bold")
        below.set_xlabel("CPU seconds of the solver")
        below.set_ylabel("relative L2 error over time")
        for one in (above, below):
            one.grid(True, which="both", color="#e4e7ea", linewidth=0.7)
            one.legend(frameon=False, fontsize=9)
    figure.savefig(path)
    plt.close(figure)


def main(words=None):
    options = parse_arguments(words)
    options.output.mkdir(parents=True, exist_ok=True)
    options.output = options.output.resolve()
    every, failed = {}, 0
    for nu in options.nu:
        rows, curves, missed = all_runs(options, nu)
        failed += missed
        add_errors(rows, curves, nu)
        every[nu] = rows, curves
    rows = [row for part, _ in every.values() for row in part]
    if not rows:
        sys.exit("compare_wave.py: no run ended")
    print(table(rows), end="")
    with open(options.output / "wave.csv", "w", newline="") as file:
        out = csv.DictWriter(file, COLUMNS)
        out.writeheader()
        out.writerows(rows)
    draw(options.output / "wave.png", every, options.sizes)
    print(f"compare_wave.py: wrote {options.output / 'wave.csv'} and wave.png")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
