#!/usr/bin/python3
"""Errors, tables and the plot of compare_fem.py's runs."""
import csv
import math

MARKS = {"C3D4": ("4-node tetrahedra", "C3", "^"), "C3D10": ("10-node tetrahedra", "C0", "s"),
         "p1": ("splines p = 1", "C4", "v"), "p2": ("splines p = 2", "C1", "o"), "p3": ("splines p = 3", "C2", "D"),
         "p4": ("splines p = 4", "C5", "P"), "p2c": ("p = 2, corrected", "C6", "*"), "p3c": ("p = 3, corrected", "C7", "X"),
         "p4c": ("p = 4, corrected", "C8", "h")}
TO_ERRORS = (0.01, 0.003, 0.001)
RATES = (0.5, 8.0)  # convergence rates in the mesh size that an extrapolation believes


def finest_quadratic(results):
    """The 10-node run with most unknowns, or None."""
    return max((run for run in results if run["method"] == "C3D10"), key=lambda run: run["unknowns"], default=None)


def add_errors(results, reference):
    """Relative errors of all frequencies, their mean and largest absolute values, and total times, written into each run."""
    for run in results:
        run["errors"] = [f / r - 1 for f, r in zip(run["frequencies"], reference["frequencies"])]
        run["mean_error"] = sum(map(abs, run["errors"])) / len(run["errors"])
        run["max_error"] = max(map(abs, run["errors"]))
        run["total_wall_s"] = run["prep_wall_s"] + run["solve_wall_s"]
        run["total_cpu_s"] = run["prep_cpu_s"] + run["solve_cpu_s"]
        run["memory_mib"] = max(run["prep_memory_mib"], run["solve_memory_mib"])


def richardson(results):
    """Extrapolated frequencies from the three finest 10-node runs, None where a frequency is not monotone or has no
    believable rate: f(h) = f + c h^q with h the mean edge of a tetrahedron of the same volume."""
    runs = sorted((run for run in results if run["method"] == "C3D10"), key=lambda run: run["unknowns"])[-3:]
    if len(runs) < 3:
        return []
    h = [(run["volume"] / run["elements"])**(1 / 3) for run in runs]
    extrapolated = []
    for f1, f2, f3 in zip(*(run["frequencies"] for run in runs)):
        found = None
        if (f1 - f2) * (f2 - f3) > 0:
            ratio = (f1 - f2) / (f2 - f3)
            excess = lambda q: (h[0]**q - h[1]**q) / (h[1]**q - h[2]**q) - ratio  # noqa: E731, grows with q
            low, high = RATES
            if excess(low) < 0 < excess(high):
                for _ in range(60):
                    q = (low + high) / 2
                    low, high = (q, high) if excess(q) < 0 else (low, q)
                found = f3 - (f2 - f3) * h[2]**low / (h[1]**low - h[2]**low)
        extrapolated.append(found)
    return extrapolated


def time_at_error(runs, error, key):
    """Shortest time of a method to a mean error, by straight lines between its runs in a doubly logarithmic plot; None outside."""
    points = sorted((run[key], run["mean_error"]) for run in runs if run["mean_error"] > 0)
    for (t1, e1), (t2, e2) in zip(points, points[1:]):
        if e2 <= error <= e1:
            share = math.log(error / e1) / math.log(e2 / e1)
            return math.exp((1 - share) * math.log(t1) + share * math.log(t2))
    return None


def speed_lines(results, reference):
    """CalculiX's solve time beside preparation and solution with splines at the same mean error, as text lines: at the error
    of every spline run and of every 10-node run but the reference, the other side interpolated. CPU seconds."""
    lines = []
    runs_of = {method: [run for run in results if run["method"] == method and run is not reference] for method in MARKS}

    def line(run, tets, solve, splines, both):
        lines.append(f"{run['method']:6} {run['size']:>5}  mean error {100 * run['mean_error']:7.3f} %   {tets} solve "
                     f"{solve:7.1f} s   {splines} prep + solve {both:6.1f} s   ratio {solve / both:5.1f}")

    for method in ("p1", "p2", "p3", "p4"):
        for run in runs_of[method]:
            for tets in ("C3D10", "C3D4"):
                solve = time_at_error(runs_of[tets], run["mean_error"], "solve_cpu_s")
                if solve is not None:
                    line(run, tets, solve, method, run["total_cpu_s"])
    for run in runs_of["C3D10"]:
        for method in ("p1", "p2", "p3", "p4"):
            both = time_at_error(runs_of[method], run["mean_error"], "total_cpu_s")
            if both is not None:
                line(run, "C3D10", run["solve_cpu_s"], method, both)
    return lines


def time_lines(results, reference):
    """Times from the STL to the frequencies at mean errors, by method, and 10-node tetrahedra's over them, as text lines."""
    lines = []
    for error in TO_ERRORS:
        times = {method: time_at_error([run for run in results if run["method"] == method and run is not reference], error, "total_cpu_s")
                 for method in MARKS}
        tets = times["C3D10"]
        found = [f"{method} {seconds:.2f} s" + (f" ({tets / seconds:.1f} times faster)" if tets and method != "C3D10" else "")
                 for method, seconds in times.items() if seconds is not None and method != "C3D4"]
        if found:
            lines.append(f"{100 * error:5.2g} %   " + ", ".join(found))
    return lines


def tables(results, reference, extrapolated):
    """Text of all tables."""
    count = len(reference["frequencies"])
    title = f"{'method':6} {'size':>5} {'points':>8} {'unknowns':>9} {'prep s':>8} {'solve s':>8} {'CPU s':>8} {'MiB':>7} " \
            f"{'mean %':>8} {'max %':>8}"
    lines = ["Cost and error (wall times in s; CPU s and peak MiB of preparation and solution together)", title]
    for run in results:
        lines.append(f"{run['method']:6} {run['size']:>5} {run['points']:8d} {run['unknowns']:9d} {run['prep_wall_s']:8.2f} "
                     f"{run['solve_wall_s']:8.2f} {run['total_cpu_s']:8.2f} {run['memory_mib']:7.0f} "
                     f"{100 * run['mean_error']:8.3f} {100 * run['max_error']:8.3f}"
                     + ("  reference" if run is reference else "") + ("  (reused)" if run.get("reused") else ""))
    lines += ["", "Frequencies", f"{'method':6} {'size':>5}" + "".join(f" {i + 1:>9}" for i in range(count))]
    for run in results:
        lines.append(f"{run['method']:6} {run['size']:>5}" + "".join(f" {f:9.4f}" for f in run["frequencies"]))
    if any(extrapolated):
        lines.append(f"{'C3D10':6} {'h→0':>5}" + "".join(f" {f:9.4f}" if f else f" {'-':>9}" for f in extrapolated)
                     + "  extrapolated where monotone")
    lines += ["", "Errors in %", f"{'method':6} {'size':>5}" + "".join(f" {i + 1:>9}" for i in range(count))]
    for run in results:
        lines.append(f"{run['method']:6} {run['size']:>5}" + "".join(f" {100 * e:9.3f}" for e in run["errors"]))
    speed = speed_lines(results, reference)
    to_error = time_lines(results, reference)
    if to_error:
        lines += ["", "CPU seconds to a mean error, meshing or trimming included (interpolated)", *to_error]
    if speed:
        lines += ["", "CPU seconds at the same mean error (the run at the left measured, the other side interpolated)", *speed]
    return "\n".join(lines) + "\n"


def write_csv(path, results):
    names = ["method", "size", "points", "elements", "unknowns", "volume", "prep_wall_s", "solve_wall_s", "prep_cpu_s",
             "solve_cpu_s", "memory_mib", "mean_error", "max_error"]
    count = len(results[0]["frequencies"])
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(names + [f"{what}_{i + 1}" for what in ("frequency", "error") for i in range(count)])
        for run in results:
            writer.writerow([run[name] for name in names] + run["frequencies"] + run["errors"])


def draw(path, results, reference):
    """Mean error against integration points and against time (preparation and solution)."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), sharey=True)
    for method, (label, colour, mark) in MARKS.items():
        runs = sorted((run for run in results if run["method"] == method and run is not reference),
                      key=lambda run: run["points"])
        if runs:
            errors = [100 * run["mean_error"] for run in runs]
            left.loglog([run["points"] for run in runs], errors, mark + "-", color=colour, label=label)
            right.loglog([run["total_cpu_s"] for run in runs], errors, mark + "-", color=colour, label=label)
    left.set_xlabel("integration points")
    right.set_xlabel("CPU time of meshing or trimming, and solution [s]")
    left.set_ylabel(f"mean error of the first {len(reference['frequencies'])} frequencies [%]")
    for axes in (left, right):
        axes.grid(True, which="both", alpha=0.3)
    left.legend()
    figure.suptitle(f"Against 10-node tetrahedra with {reference['unknowns']} unknowns", fontsize=11)
    figure.tight_layout()
    figure.savefig(path, dpi=150)
    plt.close(figure)
