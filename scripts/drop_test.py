#!/usr/bin/python3
"""Drops a part on a rigid plane: from an STL to forces, energies and rebound.

  scripts/drop_test.py part.stl                              1 m, ABS, the part's -z axis nearly downwards
  scripts/drop_test.py part.stl --toward 1 0.3 -0.2 --span 2 --height 1500

The part is turned so that the chosen direction points downwards, and starts just above the plane z = 0 with the speed of the
fall. Units: kg, mm, ms (kN, GPa); --scale makes millimetres of the STL's lengths. The default material is ABS by J2
plasticity. Written into --work: model, run file, results, and the files for ParaView; run scripts/plot.py and
scripts/render.py on the results for pictures. Printed: what is asked of a drop (force, time of contact, rebound, what is left
of the energy), and the balances that must hold.
"""
import argparse
import json
import sys
from pathlib import Path

import numpy as np

from igatools import ROOT, iga_results
from igatools.measured_run import RunError, report
from igatools.stl import read_stl

GRAVITY = 9.81e-3  # mm/ms²
GAP = 0.01  # of a span, between the lowest point and the plane at the start
WINDOWS = 60  # of the run: forces are averaged over one

RUN = """units = "mm"
gravity = [0, 0, {gravity}]
[[bodies]]
name = "part"
model = "{model}"
velocity = [0, 0, {velocity}]
place = {{ axis = {axis}, degrees = {degrees}, shift = {shift} }}
[bodies.material]
law = "j2"
E = {o.E}
nu = {o.nu}
rho = {o.rho}
yield_stress = {o.yield_stress}
hardening_modulus = {o.hardening}
[[rigid_bodies]]
name = "ground"
shape = "plane"
normal = [0, 0, 1]
centre = [0, 0, 0]
[[contacts]]
bodies = ["part", "ground"]
friction = {o.friction}
[time]
end = {o.end}
[output]
interval = {interval}
field_interval = {field_interval}
"""


def parse_arguments(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stl", type=Path)
    parser.add_argument("--scale", type=float, default=1.0, help="factor that makes millimetres of the STL's lengths [1]")
    parser.add_argument("--toward", type=float, nargs=3, default=(0.3, 0.2, -1.0), metavar=("X", "Y", "Z"),
                        help="direction of the STL that points downwards [0.3 0.2 -1]")
    parser.add_argument("--height", type=float, default=1000.0, help="of the fall, mm [1000]")
    parser.add_argument("--span", type=float, help="span size, mm [longest side / 25]")
    parser.add_argument("--degree", type=int, default=2)
    parser.add_argument("--E", type=float, default=2.2, help="GPa [2.2]")
    parser.add_argument("--nu", type=float, default=0.35)
    parser.add_argument("--rho", type=float, default=1.05e-6, help="kg/mm^3 [1.05e-6]")
    parser.add_argument("--yield-stress", type=float, default=0.04, help="GPa [0.04]")
    parser.add_argument("--hardening", type=float, default=0.05, help="GPa of stress per plastic strain [0.05]")
    parser.add_argument("--friction", type=float, default=0.3)
    parser.add_argument("--end", type=float, default=3.0, help="ms after the first touch [3]")
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "drop_test")
    parser.add_argument("--bin", type=Path, default=ROOT / "build" / "release" / "bin", help="folder of igaprep and igasolve")
    parser.add_argument("--threads", type=int, default=1)
    return parser.parse_args(words)


def numbers(values):
    return "[" + ", ".join(f"{value:.12g}" for value in values) + "]"


def turn_downwards(direction):
    """Axis, angle in degrees and matrix of the shortest turn that brings `direction` onto -z."""
    down = np.array(direction) / np.linalg.norm(direction)
    axis = np.cross(down, (0.0, 0.0, -1.0))
    sine, cosine = np.linalg.norm(axis), -down[2]
    axis = axis / sine if sine > 0 else np.array([1.0, 0.0, 0.0])
    across = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return axis, np.degrees(np.arctan2(sine, cosine)), np.eye(3) + sine * across + (1 - cosine) * across @ across


def run(o):
    """Results of the drop, the reports of igaprep and igasolve, the speed at the start, the span size."""
    o.work.mkdir(parents=True, exist_ok=True)
    vertices = o.scale * read_stl(o.stl).reshape(-1, 3)
    span = o.span or np.ptp(vertices, axis=0).max() / 25
    axis, degrees, turn = turn_downwards(o.toward)
    turned = vertices @ turn.T
    low, high = turned.min(axis=0), turned.max(axis=0)
    above_origin = [-0.5 * (low[0] + high[0]), -0.5 * (low[1] + high[1]), GAP * span - low[2]]
    speed = np.sqrt(2 * GRAVITY * o.height)
    model, settings, results = (o.work / f"{o.stl.stem}{end}" for end in ("_model.h5", "_drop.toml", "_drop.h5"))
    prep = report([o.bin / "igaprep", o.stl, "-o", model, "--scale", o.scale, "--gap-ends", "glued", "--degree",
                   o.degree, "--span-size", span, "--quadrature", "ggq-reduced", "--length-unit", "mm", "--force",
                   "--json", "--threads", o.threads])
    settings.write_text(RUN.format(o=o, model=model.name, gravity=-GRAVITY, velocity=-speed, axis=numbers(axis),
                                   degrees=f"{degrees:.12g}", shift=numbers(above_origin), interval=o.end / 600,
                                   field_interval=o.end / 30))
    solved = report([o.bin / "igasolve", "explicit", settings, "-o", results, "--force", "--json", "--quiet", "--threads",
                     o.threads])
    return iga_results.read(results), prep, solved, speed, span


def figures(results, prep, solved, speed, span, friction):
    time, contact = results["/time_series/time"], results.series("contact/part-ground")
    body, energy = results.series("body/part"), results.series("energy")
    mass = solved["bodies"][0]["mass"]
    _, means = results.mean_force("part-ground", time[-1] / WINDOWS)
    force = contact["force"]
    touching = time[np.linalg.norm(force, axis=1) > 0]
    if len(touching) == 0:
        raise RunError(f"the part did not touch the ground until {time[-1]:.6g} ms; choose a later --end")
    after = body["momentum"][-1] / mass
    gained = body["momentum"][-1] - body["momentum"][0]
    pushed = contact["impulse"][-1] - [0, 0, mass * GRAVITY * time[-1]]
    steps = [results.fields(step) for step in range(results.num_fields())]
    heights = [(step.mesh["part/vertices"] + step["part/displacement"])[:, 2].min() for step in steps]
    return {
        "span": float(span), "points": prep["points"], "functions": prep["functions"], "steps": solved["steps"], "mass": mass,
        "speed": float(speed), "peak_force": float(means.max()), "impulse": float(np.linalg.norm(contact["impulse"][-1])),
        "touches_from": float(touching[0]), "touches_until": float(touching[-1]), "end": float(time[-1]),
        "rebound_speed": float(after[2]), "restitution": float(after[2] / speed),
        "sideways_speed": float(np.hypot(after[0], after[1])),
        "kinetic_at_start": float(energy["kinetic"][0]), "kinetic_at_end": float(energy["kinetic"][-1]),
        "internal_at_end": float(energy["internal"][-1]), "friction_at_end": float(energy["friction"][-1]),
        "largest_plastic_strain": float(steps[-1]["part/plastic_strain"].max()),
        "largest_friction": float((np.hypot(force[:, 0], force[:, 1]) - friction * force[:, 2]).max()),
        "deepest_point": float(min(heights)),
        "energy_error": float(np.abs(results["/time_series/energy_error"]).max()),
        "momentum_error": float(np.linalg.norm(gained - pushed) / (mass * speed))}


def main(words=None):
    o = parse_arguments(words)
    try:
        found = figures(*run(o), o.friction)
    except (OSError, RunError, iga_results.FormatError) as error:
        sys.exit(f"drop_test.py: {error}")
    for name, value in found.items():
        print(f"{name:<24}{value:.6g}")
    (o.work / f"{o.stl.stem}_drop.json").write_text(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
