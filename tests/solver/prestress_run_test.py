#!/usr/bin/python3
"""Runs of igasolve buckling and of eigen with prestress: reports, results files, tables; mistakes are refused with their line.
usage: prestress_run_test.py SOURCE_DIR IGAPREP IGASOLVE"""
import csv
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "tests/scripts")]
import igatools  # noqa: E402
from igatools import iga_results  # noqa: E402
from parts import write_boxes  # noqa: E402

# A column 10 × 6 × 120 mm, its foot clamped, its head pressed down.
RUN = """
model = "column.h5"
units = "mm"
[material]
E = 210e3
nu = 0
rho = 7.8e-9
[[support]]
name = "foot"
plane = { point = [0, 0, 0], normal = [0, 0, 1] }
[[load]]
name = "press"
force = [0, 0, -1000]
plane = { point = [0, 0, 120], normal = [0, 0, 1] }
"""
EULER = np.pi**2 * 210e3 * (10 * 6**3 / 12) / (4 * 120**2)


class Prestress(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        write_boxes(cls.path / "column.stl", [((0, 0, 0), (10, 6, 120))])
        subprocess.run([IGAPREP, cls.path / "column.stl", "--span-size", "6", "--length-unit", "mm", "-o", cls.path / "column.h5",
                        "--quiet"], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def command(self, analysis, *changes, more=()):
        text = RUN
        for before, after in changes:
            self.assertIn(before, text)
            text = text.replace(before, after)
        (self.path / "run.toml").write_text(text)
        return subprocess.run([IGASOLVE, analysis, self.path / "run.toml", *more], capture_output=True, text=True)

    def report(self, analysis, *changes, more=()):
        done = self.command(analysis, *changes, more=("--json", *more))
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def refused(self, analysis, words, *changes, code=2):
        done = self.command(analysis, *changes)
        self.assertEqual(done.returncode, code, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_a_column_buckles_at_eulers_load(self):
        report = self.report("buckling", ("[[support]]", "[buckling]\nfactors = 3\n[[support]]"))
        force = 1000 * np.array(report["factors"])
        self.assertEqual(len(force), 3)
        self.assertAlmostEqual(force[0] / EULER, 1, delta=0.01)          # about the weak axis
        self.assertAlmostEqual(force[1] / EULER, (10 / 6)**2, delta=0.05)  # about the strong one
        self.assertEqual(report["sturm"]["expected"], report["sturm"]["found"])
        self.assertEqual(report["growing"], ["press"])
        np.testing.assert_allclose(report["preload"]["largest_von_mises"], 1000 / 60, rtol=0.05)
        self.assertLess(max(report["residuals"]), 1e-8)

    def test_reversed_loads_have_the_same_factors_with_the_other_sign(self):
        one = self.report("buckling", more=("--factors", "2"))
        other = self.report("buckling", ("-1000", "1000"), more=("--factors", "2", "--negative"))
        np.testing.assert_allclose(other["factors"][-2:], -np.array(one["factors"]), rtol=1e-8)

    def test_results_hold_the_shapes(self):
        file = self.path / "buckling.h5"
        self.report("buckling", more=("--factors", "2", "-o", file, "--force"))
        results = igatools.Results(file)
        self.assertEqual(results.analysis, "buckling")
        self.assertEqual(results["/buckling/modes"].shape[0], 2)
        head = results.displacement([[5, 3, 119.9]], mode=0)[0]  # the weak axis is y
        self.assertGreater(abs(head[1]), 0.9)
        self.assertLess(np.hypot(head[0], head[2]), 0.01)
        x = np.array([[5, 3, z] for z in (20, 60, 100)])
        np.testing.assert_allclose(results.displacement(x, mode=0)[:, 1] / head[1], 1 - np.cos(np.pi * x[:, 2] / 240), atol=0.02)
        self.assertTrue((self.path / "buckling.pvd").exists())
        iga_results.read(file)
        subprocess.run([IGASOLVE, "export", file, "--csv", "-o", self.path / "tables", "--force", "--quiet"], check=True)
        with open(self.path / "tables/factors.csv", newline="") as table:
            rows = list(csv.DictReader(table))
        self.assertEqual([float(row["factor"]) for row in rows], list(results.factors))
        results.to_csv(self.path / "ours")
        self.assertEqual((self.path / "ours/factors.csv").read_text(), (self.path / "tables/factors.csv").read_text())

    def test_constant_loads_do_not_grow(self):
        alone = self.report("buckling", more=("--factors", "1"))["factors"][0]
        weight = ("[[load]]", f"[buckling]\nconstant = \"weight\"\n[[load]]\nname = \"weight\"\nforce = [0, 0, {-500 * alone}]\n"
                              "plane = { point = [0, 0, 120], normal = [0, 0, 1] }\n[[load]]")
        report = self.report("buckling", weight, more=("--factors", "1"))
        self.assertEqual((report["growing"], report["constant"]), (["press"], ["weight"]))
        self.assertAlmostEqual(report["factors"][0] / alone, 0.5, places=6)

    def test_frequencies_fall_and_rise_with_the_load(self):
        rest, pressed, pulled = (self.report("eigen", ("-1000", str(force)), more=("--prestress", "--modes", "1"))
                                 for force in (-1e-3, -0.5 * EULER, 0.5 * EULER))
        ratio = [(one["frequencies"][0] / rest["frequencies"][0])**2 for one in (pressed, pulled)]
        # omega^2 of the load is concave, 0 at the buckling load and 1 at rest: above the straight line between, below it outside.
        self.assertTrue(0.5 < ratio[0] < 0.55 and 1.4 < ratio[1] < 1.5, ratio)
        self.assertTrue(rest["prestress"])
        self.assertEqual(rest["rigid_modes"], 0)
        self.assertNotIn("error_estimate", rest)
        self.assertAlmostEqual(pulled["preload"]["loads"][0]["force"][2], 0.5 * EULER, places=6)
        self.assertTrue(any("small" in note for note in pulled["preload"]["notes"]))

    def test_a_column_between_walls_buckles_when_it_is_heated(self):
        """Both ends held along the axis, the head free to move sideways: E alpha T A is the force."""
        force = RUN[RUN.index("[[load]]"):]
        wall = ("[[support]]\nname = \"wall\"\nfixed = \"z\"\nplane = { point = [0, 0, 120], normal = [0, 0, 1] }\n"
                "[temperature]\nuniform = 1\nreference = 0\n")
        report = self.report("buckling", (force, wall), ("nu = 0\n", "nu = 0\nexpansion = 1e-5\n"), more=("--factors", "1"))
        clamped = 4 * EULER  # the head may shift but not turn: half a wave between clamped ends
        self.assertAlmostEqual(report["factors"][0] * 210e3 * 1e-5 * 60 / clamped, 1, delta=0.02)

    def test_what_turns_is_softer_in_its_plane(self):
        axis = ("force = [0, 0, -1000]\nplane = { point = [0, 0, 120], normal = [0, 0, 1] }",
                "centrifugal = { axis = [0, 1, 0], point = [5, 3, 0], speed = 500 }")
        rest = self.report("eigen", more=("--modes", "1"))["frequencies"][0]
        along = self.report("eigen", axis, more=("--prestress", "--modes", "1"))
        across = self.report("eigen", axis, ("axis = [0, 1, 0]", "axis = [1, 0, 0]"), more=("--prestress", "--modes", "1"))
        squares = [(2 * np.pi * f)**2 for f in (rest, along["frequencies"][0], across["frequencies"][0])]
        self.assertGreater(squares[1], squares[0])  # the weak axis is y: first out of the plane of rotation, then in it
        self.assertAlmostEqual((squares[1] - squares[2]) / 500**2, 1, delta=0.01)
        self.assertTrue(any("Coriolis" in note for note in across["preload"]["notes"]))

    def test_eigen_says_that_it_leaves_loads_out(self):
        done = self.command("eigen", more=("--modes", "1"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("not in these modes", done.stdout)
        self.assertIn("prestress = true", done.stdout)
        self.assertFalse(self.report("eigen", more=("--modes", "1"))["prestress"])
        without = self.command("eigen", (RUN[RUN.index("[[load]]"):], ""), more=("--modes", "1"))
        self.assertNotIn("not in these modes", without.stdout)

    def test_a_part_that_buckles_has_no_modes(self):
        prestress = ("[[support]]", "[eigen]\nprestress = true\n[[support]]")
        self.refused("eigen", ["buckles at 0.49", "igasolve buckling"], prestress, ("-1000", f"{-2 * EULER}"))

    def test_mistakes_are_refused(self):
        no_load = (RUN[RUN.index("[[load]]"):], "")
        self.refused("buckling", ["needs loads"], no_load)
        self.refused("eigen", ["has no loads"], no_load, ("[[support]]", "[eigen]\nprestress = true\n[[support]]"))
        self.refused("buckling", ["run.toml:", "constant", "pres", "did you mean press?"],
                     ("[[support]]", "[buckling]\nconstant = [\"pres\"]\n[[support]]"))
        self.refused("buckling", ["none is left to grow"], ("[[support]]", "[buckling]\nconstant = [\"press\"]\n[[support]]"))
        self.refused("buckling", ["run.toml:", "factor", "factors"], ("[[support]]", "[buckling]\nfactor = 2\n[[support]]"))
        self.refused("buckling", ["factors: found 0"], ("[[support]]", "[buckling]\nfactors = 0\n[[support]]"))
        self.refused("buckling", ["spread = \"rigid\"", "'press'"], ("force =", "spread = \"rigid\"\nforce ="))
        self.refused("buckling", ["supports"], (RUN[RUN.index("[[support]]"):RUN.index("[[load]]")], ""))
        self.refused("buckling", ["[[case]]"], ("[[support]]", "[[case]]\nname = \"one\"\nloads = { press = 1 }\n[[support]]"))
        self.refused("buckling", ["inertia_relief"], ("units = ", "inertia_relief = true\nunits = "))
        self.refused("eigen", ["prestress", "largest"],
                     ("[[support]]", "[eigen]\nprestress = true\nlargest = true\n[[support]]"))

    def test_two_tied_bodies_buckle_as_one(self):
        write_boxes(self.path / "half.stl", [((0, 0, 0), (10, 6, 60))])
        subprocess.run([IGAPREP, self.path / "half.stl", "--span-size", "6", "--length-unit", "mm", "-o", self.path / "half.h5",
                        "--quiet", "--force"], check=True)
        whole = self.report("buckling", more=("--factors", "1"))["factors"][0]
        bodies = ("model = \"column.h5\"\n", "")
        tied = ("[[support]]\n", "[[bodies]]\nname = \"low\"\nmodel = \"half.h5\"\n[[bodies]]\nname = \"high\"\nmodel = \"half.h5\"\n"
                                 "place = { shift = [0, 0, 60] }\n[[ties]]\nbodies = [\"low\", \"high\"]\n[[support]]\n")
        file = self.path / "tied.h5"
        report = self.report("buckling", bodies, tied, more=("--factors", "1", "-o", file, "--force"))
        self.assertAlmostEqual(report["factors"][0] / whole, 1, delta=2e-3)
        self.assertEqual(igatools.Results(file).num_fields(), 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
