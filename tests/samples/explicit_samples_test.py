#!/usr/bin/python3
"""The explicit samples, coarse: what comes out is held against physics and the literature, with the reason for each bound.
usage: explicit_samples_test.py SOURCE_DIR BIN_DIR PARTS_DIR SHARED_DIR impact|taylor|drop|drop-shared
Exit code 77 (skipped) for drop-shared where the folder of shared parts is absent."""
import json
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import numpy as np

SOURCE, BIN, PARTS, SHARED = (Path(word) for word in sys.argv[1:5])
CASE = sys.argv[5]
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "samples" / "taylor_bar")]
from igatools import iga_results  # noqa: E402
from igatools.run_files import moved_run  # noqa: E402


def run(*command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"{Path(command[0]).name} ended with {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)


def solve_sample(sample, prep, settings, part, work):
    """igaprep and igasolve explicit as the sample's README has them, with every file in `work`."""
    source = SOURCE / "samples" / sample
    model = work / "model.h5"
    (work / "run.toml").write_text(moved_run(source / settings, model))
    run(BIN / "igaprep", source / prep, "--input", part, "-o", model, "--json")
    report = run(BIN / "igasolve", "explicit", work / "run.toml", "-o", work / "run.h5", "--json", "--quiet")
    return iga_results.read(work / "run.h5"), report


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = Path(folder.name)

    def within(self, what, value, low, high):
        print(f"{what}: {value:.5g}, expected {low:.5g} … {high:.5g}", flush=True)
        self.assertTrue(low <= value <= high, f"{what}: found {value:.6g}, expected {low:.6g} … {high:.6g}")


@unittest.skipUnless(CASE == "impact", "another case was asked for")
class ImpactTest(Case):
    MASS, SPEED, GRAIN = 1.0, 8.0, 16.0

    def test_sphere_on_foam_cube_at_16_mm(self):
        cube = SOURCE / "samples" / "impact_cube" / "cube.stl"
        results, report = solve_sample("impact_cube", "prep_16mm.toml", "impact_16mm.toml", cube, self.work)
        time, sphere = results["/time_series/time"], results.series("rigid/sphere")
        contact, energy = results.series("contact/cube-sphere"), results.series("energy")
        self.within("end", time[-1], 8, 8)
        self.within("energy error", np.abs(results["/time_series/energy_error"]).max(), 0, 0.01)
        # Momentum: what the cube got from the sphere the sphere lost; nothing else acts on it. The velocity of a row stands half
        # a step later than its impulse.
        lost = self.MASS * (sphere["velocity"][0] - sphere["velocity"][-1])
        step = np.linalg.norm(contact["force"][-1]) * results["/time_series/dt"][-1] / 2
        self.within("momentum of the sphere and impulse differ by", np.linalg.norm(lost - contact["impulse"][-1]), 0,
                    1.01 * step + 1e-9)
        # The foam stops the sphere (m v) and cannot return more than it got (2 m v); crushing is plastic, so that what it
        # returns is little: a rebound below a quarter of the speed.
        impulse = np.linalg.norm(contact["impulse"][-1])
        self.within("impulse", impulse, self.MASS * self.SPEED, 1.25 * self.MASS * self.SPEED)
        # The yield stress 3.0e-4 … 3.5e-4 under the sphere's own section at the depth reached bounds what the foam's columns
        # carry: 0.232 kN at 0.5 ms with independent elastic-plastic columns. A span of 16 mm is as wide as the print is
        # then, and rounds it up; a quarter more is allowed, and as much less.
        early = np.linalg.norm([np.interp(0.6, time, part) - np.interp(0.4, time, part) for part in contact["impulse"].T]) / 0.2
        self.within("mean force from 0.4 to 0.6 ms", early, 0.75 * 0.232, 1.25 * 0.232)
        # Peak of the means over 0.2 ms: 2.51 kN with spans of 4 mm; spans of 16 mm may miss it by 6 %.
        edges = np.arange(0, 8.1, 0.2)
        means = np.linalg.norm(np.diff([np.interp(edges, time, part) for part in contact["impulse"].T], axis=1), axis=0) / 0.2
        self.within("peak of the mean force", means.max(), 0.94 * 2.51, 1.06 * 2.51)
        self.within("time of the peak", edges[means.argmax()] + 0.1, 4, 6)
        # Energy: all of the 32 J is the sphere's at first; foam and friction keep what it does not get back.
        self.within("kinetic energy at the start", energy["kinetic"][0], 32 - 1e-9, 32 + 1e-9)
        self.within("share left as motion", energy["kinetic"][-1] / 32, 0, 0.0625)
        self.within("friction", energy["friction"][-1], 0, 0.1 * 32)
        self.within("contact's own energy", np.abs(energy["contact"]).max(), 0, 0.02 * 32)
        for name in ("cube-sphere", "cube-plane"):
            self.within(f"depth of {name}, spans", results.series(f"contact/{name}")["depth"].max() / self.GRAIN, 0, 0.05)
        self.within("inverted points", report["bodies"][0]["inverted"], 0, 0)
        # Nothing passes through the plate.
        last = results.fields(-1)
        self.within("lowest point of the cube", (last.mesh["cube/vertices"] + last["cube/displacement"])[:, 2].min(), -0.5, 1)


@unittest.skipUnless(CASE == "taylor", "another case was asked for")
class TaylorTest(Case):
    def test_copper_bar_with_four_spans_across(self):
        from figures import figures
        results, report = solve_sample("taylor_bar", "prep_1.6mm.toml", "taylor_1.6mm.toml",
                                       PARTS / "taylor_bar.stl", self.work)
        found = figures(results)
        self.within("end", found["end"], 0.08, 0.08)
        self.within("energy error", found["energy_error"], 0, 0.01)
        # A prism of 96 facets at 227 m/s: ½ ρ V v², to the digits of the STL (float32).
        area = 48 * 3.2**2 * np.sin(2 * np.pi / 96)
        start = 0.5 * 8.93e-6 * area * 32.4 * 227**2
        self.within("kinetic energy at the start", found["kinetic_at_start"] / start, 1 - 1e-6, 1 + 1e-6)
        # Literature: 21.42 … 21.66 mm, perhaps from 21.26 (Kamoulakos 1990, Zhu and Cescotto 1995, Camacho and Ortiz 1997).
        self.within("final length", found["length"], 21.26, 21.66)
        # Literature: 6.9 … 7.24 mm; axisymmetric_fe.py with 5 and 10 elements along the radius: 7.23 and 7.32. Four spans
        # across the bar carry the rim outwards: 5 % above the latter are allowed, to the point of the rim farthest out.
        self.within("radius of the mushroom", found["radius"], 6.9, 1.05 * 7.32)
        self.within("smallest radius of the rim", found["smallest_rim_radius"], 6.9, found["radius"])
        # Literature: 2.47 … 3.25.
        self.within("largest plastic strain", found["largest_plastic_strain"], 2.47, 3.25)
        # Metal flows without change of volume. Behind the shock, which runs at the speed of bulk waves √(K / ρ), it is pressed
        # by v / c = 6 %; behind a front on a grid, without bulk viscosity, twice that for a moment.
        bulk_speed = np.sqrt(117 / (3 * (1 - 2 * 0.35)) / 8.93e-6)
        self.within("least volume ratio", found["least_volume_ratio"], 1 - 2 * 227 / bulk_speed, 1)
        # All motion ends as plastic work, but for elastic waves and a slow rebound.
        self.within("internal over first energy", found["internal_over_start"], 0.98, 1)
        self.within("lowest point", found["lowest_point"], -0.05 * 1.6, 0.05 * 1.6)
        # Without friction the wall pushes straight; it takes the bar's momentum and gives a little back.
        impulse = results.series("contact/bar-wall")["impulse"][-1]
        momentum = 2 * start / 227
        self.within("impulse over momentum", impulse[2] / momentum, 1, 1.1)
        self.within("sideways impulse over momentum", np.abs(impulse[:2]).max() / momentum, 0, 1e-9)
        self.within("inverted points", report["bodies"][0]["inverted"], 0, 0)


class DropCase(Case):
    DIRECTION = np.array([0.3, 0.2, -1]) / np.linalg.norm([0.3, 0.2, -1])
    FRICTION, GRAIN = 0.3, 4.0

    def drop(self, part, end):
        """One grid of `iga drop`, as the sample's README has it; what comes out is held against mechanics."""
        found = run(SOURCE / "scripts" / "iga", "drop", part, "--length-unit", "mm", "--material", "ABS", "--unit-system", "kg-mm-ms",
                    "--yield-stress", "40MPa", "--hardening", "50MPa", "--height", "1m", "--direction", "0.3,0.2,-1", "--friction",
                    self.FRICTION, "--span-size", self.GRAIN, "--end", end, "--max-time", 1, "-o", self.work, "--bin", BIN, "--json")
        self.within("speed over that of the fall", found["speed"] / np.sqrt(2 * 9.80665e-3 * 1000), 1 - 1e-9, 1 + 1e-9)
        self.within("energy error", found["energy_error"], 0, 0.01)
        results = iga_results.read(self.work / found["results"])
        time, momentum = results["/time_series/time"], results.series("body/part")["momentum"]
        contact, energy = results.series("contact/part-floor"), results.series("energy")
        start, weight = found["mass"] * found["speed"], found["mass"] * found["gravity"] * self.DIRECTION
        gained, pushed = momentum[-1] - momentum[0], contact["impulse"][-1] + weight * time[-1]
        self.within("momentum against impulse and weight", np.linalg.norm(gained - pushed) / start, 0, 1e-9)
        normal = -contact["force"] @ self.DIRECTION
        across = np.linalg.norm(contact["force"] + normal[:, None] * self.DIRECTION, axis=1)
        self.within("friction above its limit, of the peak force", (across - self.FRICTION * normal).max() / normal.max(), -1, 1e-9)
        # The floor only pushes: at least what stops the corner, at most what throws the whole part back.
        self.within("impulse over momentum", np.linalg.norm(contact["impulse"][-1]) / start, 0.05, 2 * np.hypot(1, 0.3))
        self.within("restitution", -momentum[-1] @ self.DIRECTION / start, -1, 1)
        kept = energy["kinetic"][-1] + energy["internal"][-1] + energy["friction"][-1]
        self.within("energies at the end over the first", kept / energy["kinetic"][0], 0.98, 1.02)
        self.within("deepest point, spans", self.depth(results) / self.GRAIN, -0.02, 0.1)

    def depth(self, results):
        """The largest way of a vertex into the floor."""
        floor = tomllib.loads((self.work / "drop_1.toml").read_text())["rigid_bodies"][0]["centre"] @ self.DIRECTION
        steps = [results.fields(step) for step in range(results.num_fields())]
        return max(((step.mesh["part/vertices"] + step["part/displacement"]) @ self.DIRECTION).max() - floor for step in steps)


@unittest.skipUnless(CASE == "drop", "another case was asked for")
class DropTest(DropCase):
    def test_bracket_falls_on_its_edge(self):
        self.drop(PARTS / "bracket_with_ribs.stl", "1.2ms")


@unittest.skipUnless(CASE == "drop-shared", "another case was asked for")
class SharedDropTest(DropCase):
    def test_printed_part_falls_on_its_corner(self):
        self.drop(SHARED / "stl" / "valid" / "Rear_Bed_Mount_Right_x1.stl", "0.6ms")


if __name__ == "__main__":
    if CASE == "drop-shared" and not (SHARED / "stl" / "valid").is_dir():
        print(f"skipped: {SHARED / 'stl' / 'valid'} is absent; configure with IGA_SHARED_DIR")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1])
