#!/usr/bin/python3
"""The impact sample beside the finite element program of its own: a table of the runs named.

  scripts/studies/compare_impact.py REFERENCE RUN...     series of scripts/studies/hex_reference.py (.npz) or results of igasolve (.h5)

Of the force on the sphere along z: at 0.5 ms (that instant, and the mean from 0.4 to 0.6 ms), the largest mean over 0.2 ms,
the relative L2 difference of its means over 0.2 ms to the first file, the impulse beside the sphere's change of momentum; the
velocity of the rebound; internal, kinetic (the sphere's included) and friction energy at 2, 4, 6 and 8 ms.
"""
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from igatools import iga_results  # noqa: E402

MASS, WINDOW, TIMES = 1.0, 0.2, (2, 4, 6, 8)


def series_of(path):
    """time, force, impulse, velocity (upwards positive), internal, kinetic, friction of a run."""
    if Path(path).suffix == ".npz":
        with np.load(path) as file:
            return {name: file[name] for name in ("time", "force", "impulse", "velocity", "internal", "kinetic", "friction")}
    results = iga_results.read(path)
    touch = results.series("contact/cube-sphere")
    energy = {name: results[f"/time_series/energy/{name}"] for name in ("internal", "kinetic", "friction")}
    return {"time": results["/time_series/time"], "force": -touch["force"][:, 2], "impulse": -touch["impulse"][:, 2],
            "velocity": results["/time_series/rigid/sphere/velocity"][:, 2], **energy}


def figures(run):
    def at(name, t):
        return np.interp(t, run["time"], run[name])
    edges = np.arange(round(run["time"][-1] / WINDOW) + 1) * WINDOW
    return {"early": at("force", 0.5), "early_mean": (at("impulse", 0.6) - at("impulse", 0.4)) / 0.2,
            "means": np.diff(at("impulse", edges)) / WINDOW, "impulse": run["impulse"][-1],
            "momentum": MASS * (run["velocity"][-1] - run["velocity"][0]), "rebound": run["velocity"][-1],
            "energies": [[at(name, t) for t in TIMES] for name in ("internal", "kinetic", "friction")]}


def main():
    if len(sys.argv) < 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    runs = {Path(path).stem: figures(series_of(path)) for path in sys.argv[1:]}
    reference = next(iter(runs.values()))["means"]
    print("| run | at 0.5 ms | 0.4 … 0.6 ms | peak | L2 | impulse | momentum | rebound |\n|---|---|---|---|---|---|---|---|")
    for name, f in runs.items():
        difference = np.linalg.norm(f["means"] - reference) / np.linalg.norm(reference)
        print(f"| {name} | {f['early']:.3f} | {f['early_mean']:.3f} | {f['means'].max():.3f} | {100 * difference:.1f} % | "
              f"{f['impulse']:.3f} | {f['momentum']:.3f} | {f['rebound']:.3f} |")
    print("\n| run | internal | kinetic | friction |\n|---|---|---|---|")
    for name, f in runs.items():
        print(f"| {name} | " + " | ".join(", ".join(f"{value:.2f}" for value in row) for row in f["energies"]) + " |")


if __name__ == "__main__":
    main()
