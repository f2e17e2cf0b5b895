#!/usr/bin/python3
"""Heat, load cases, turning and bolts from the command line: reports, results files, tables; mistakes are refused.
usage: loads_run_test.py SOURCE_DIR IGAPREP IGASOLVE"""
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
from igatools import Results, iga_results  # noqa: E402
from parts import write_boxes  # noqa: E402

HEAT = """
model = "bar.h5"
material = "steel"
[[heat]]
name = "hot"
temperature = 100
normal = { direction = [-1, 0, 0] }
[[heat]]
name = "cold"
temperature = 20
normal = { direction = [1, 0, 0] }
[[probe]]
name = "middle"
position = [20, 5, 5]
"""

STATIC = """
model = "bar.h5"
material = "steel"
[[support]]
name = "end"
fixed = "x"
normal = { direction = [-1, 0, 0] }
[[support]]
name = "side"
fixed = "y"
normal = { direction = [0, -1, 0] }
[[support]]
name = "low"
fixed = "z"
normal = { direction = [0, 0, -1] }
[[load]]
name = "turning"
centrifugal = { axis = [0, 0, 1], point = [0, 5, 5], rpm = 6000 }
[[load]]
name = "pull"
force = [1000, 0, 0]
normal = { direction = [1, 0, 0] }
[temperature]
results = "heat.h5"
reference = 20
[[case]]
name = "hot"
loads = { temperature = 1 }
[[case]]
name = "all"
loads = { turning = 1, pull = 2, temperature = 1 }
[[probe]]
name = "tip"
position = [40, 5, 5]
"""


class Loads(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        write_boxes(cls.path / "bar.stl", [((0, 0, 0), (40, 10, 10))])
        subprocess.run([IGAPREP, cls.path / "bar.stl", "--span-size", "4.3", "--length-unit", "mm", "-o", cls.path / "bar.h5",
                        "--quiet"], check=True)
        cls.heat = cls.solve("heat", HEAT, "-o", cls.path / "heat.h5")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def run_file(cls, analysis, text, *options):
        (cls.path / "run.toml").write_text(text)
        return subprocess.run([IGASOLVE, analysis, cls.path / "run.toml", *options], capture_output=True, text=True)

    @classmethod
    def solve(cls, analysis, text, *options):
        done = cls.run_file(analysis, text, "--json", "--force", *options)
        if done.returncode:
            raise AssertionError(done.stderr)
        return json.loads(done.stdout)

    def expect_refused(self, analysis, text, *words):
        done = self.run_file(analysis, text)
        self.assertEqual(done.returncode, 2, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_heat(self):
        heat = self.heat["heat"]
        self.assertAlmostEqual(heat["boundaries"][0]["power"], 53.3 * 100 * 80 / 40, places=6)  # mW, in t mm s
        self.assertAlmostEqual(heat["probes"][0]["temperature"], 60, places=8)
        np.testing.assert_allclose(heat["probes"][0]["heat_flux"], (53.3 * 2, 0, 0), atol=1e-6)
        self.assertLess(abs(heat["balance"]), 1e-6)
        results = iga_results.read(self.path / "heat.h5")
        x = results["/surface/vertices"][:, 0]
        np.testing.assert_allclose(results["/surface/temperature"][0], 100 - 2 * x, atol=1e-8)
        self.assertEqual(results.texts("/heat/boundaries/kind"), ["temperature", "temperature"])
        self.assertTrue((self.path / "heat.pvd").exists())
        text = self.run_file("heat", HEAT).stdout
        self.assertIn("heat 'hot' (temperature): area 100", text)

    def test_cases(self):
        report = self.solve("static", STATIC, "-o", self.path / "static.h5")
        hot, both = report["cases"]
        self.assertEqual([hot["case"], both["case"]], ["hot", "all"])
        # T = 100 - 2 x over 20: the tip moves by α ∫ (80 - 2 x) dx; the flat end that is held keeps it from warping by α (y² + z²).
        self.assertAlmostEqual(hot["probes"][0]["displacement"][0] / (12e-6 * (80 * 40 - 40**2)), 1, delta=0.02)
        np.testing.assert_allclose([s["force"] for s in hot["supports"]], 0, atol=1e-6)  # none holds the other
        self.assertLess(hot["energy_defect"], 1e-8)
        speed = 6000 / 60 * 2 * np.pi
        self.assertAlmostEqual(both["loads"][0]["force"][0], 7.85e-9 * 4000 * speed**2 * 20, places=6)
        self.assertAlmostEqual(both["loads"][1]["force"][0], 2000, places=8)
        self.assertLess(both["energy_defect"], 1e-8)
        self.assertEqual(report["envelope"]["largest_von_mises_case"], "all")
        self.assertEqual(report["envelope"]["largest_surface_von_mises_case"], "all")
        results = iga_results.read(self.path / "static.h5")
        self.assertEqual(results.texts("/static/cases/name"), ["hot", "all"])
        np.testing.assert_array_equal(results["/static/cases/factor"], [[0, 0], [1, 2]])
        np.testing.assert_array_equal(results["/static/cases/displacement"][0], results["/static/displacement"])
        np.testing.assert_array_equal(results["/surface/steps"], [1, 2])
        self.assertAlmostEqual(results["/surface/von_mises"][0].max() / hot["largest_von_mises"], 1, delta=0.1)
        self.assertGreater(results["/surface/von_mises"][1].max(), 20)  # 2000 N on 100 mm²
        with self.assertRaisesRegex(ValueError, "thermal strain"):
            Results(self.path / "static.h5").stress([[20, 5, 5]])
        subprocess.run([IGASOLVE, "export", self.path / "static.h5", "--csv", "--table", "cases", "-o", self.path / "cases.csv",
                        "--force"], check=True, capture_output=True)
        with open(self.path / "cases.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(rows[1]["factor of pull [1]"], "2")
        mises = results["/surface/von_mises"]
        self.assertTrue((self.path / "static_vtp/static_envelope.vtp").exists())
        subprocess.run([IGASOLVE, "export", self.path / "static.h5", "--csv", "--table", "envelope", "-o", self.path / "envelope.csv",
                        "--force"], check=True, capture_output=True)
        with open(self.path / "envelope.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        column = next(name for name in rows[0] if name.startswith("von_mises ["))
        np.testing.assert_array_equal([float(row[column]) for row in rows], mises.max(axis=0))
        self.assertEqual([row["von_mises_case"] for row in rows], [("hot", "all")[k] for k in mises.argmax(axis=0)])
        most = results.envelope()
        np.testing.assert_array_equal(most["von_mises"], mises.max(axis=0))
        np.testing.assert_array_equal(most["von_mises_case"], mises.argmax(axis=0))
        np.testing.assert_array_equal(most["displacement"], np.linalg.norm(results["/surface/displacement"], axis=2).max(axis=0))
        text = self.run_file("static", STATIC).stdout
        for words in ("case 'hot'", "temperature (heat.h5): 20 … 100", "load 'pull' (total force) × 2", "all cases:"):
            self.assertIn(words, text)

    def test_temperatures_from_points(self):
        """Linear between points as from conduction; points in another unit are refused."""
        grid = np.stack(np.meshgrid(np.linspace(0, 40, 9), *2 * [np.linspace(0, 10, 3)], indexing="ij"), -1).reshape(-1, 3)
        rows = "".join(f"{x:g}, {y:g}, {z:g}, {100 - 2 * x:g}\n" for x, y, z in grid)
        (self.path / "points.csv").write_text("# measured\nx, y, z, T\n" + rows)
        by_points = STATIC.replace('results = "heat.h5"', 'file = "points.csv"')
        found, expected = (self.solve("static", text)["cases"][0] for text in (by_points, STATIC))
        np.testing.assert_allclose(found["probes"][0]["displacement"], expected["probes"][0]["displacement"], atol=1e-10)
        self.assertEqual(found["temperatures"][0]["source"], "81 points of points.csv")
        (self.path / "far.csv").write_text("".join(f"{x / 1000:g} {y / 1000:g} {z / 1000:g} 20\n" for x, y, z in grid))
        self.expect_refused("static", STATIC.replace('results = "heat.h5"', 'file = "far.csv"'), "far.csv", "length unit")
        (self.path / "bad.csv").write_text("0, 0, 0, 20\n1, 2, 3\n")
        self.expect_refused("static", STATIC.replace('results = "heat.h5"', 'file = "bad.csv"'), "bad.csv:2", "four finite numbers")

    def test_a_bolt_between_walls(self):
        bolt = HEAT[:HEAT.index("[[heat]]")] + '''
[[support]]
name = "left"
normal = { direction = [-1, 0, 0] }
[[support]]
name = "right"
normal = { direction = [1, 0, 0] }
[[bolt]]
name = "shank"
plane = { point = [20, 5, 5], normal = [1, 0, 0] }
force = 5000
'''
        found = self.solve("static", bolt)["statics"]
        self.assertAlmostEqual(found["bolts"][0]["force"], 5000, places=5)
        self.assertAlmostEqual(found["bolts"][0]["section"], 100, places=6)
        self.assertAlmostEqual(found["supports"][0]["force"][0], -5000, delta=1)
        self.expect_refused("static", bolt.replace("[20, 5, 5]", "[20, 5, 5, 1]"), "run.toml")
        self.expect_refused("static", bolt.replace("force = 5000", ""), "force", "missing")

    def test_mistakes(self):
        self.expect_refused("heat", HEAT.replace('material = "steel"', ""), "conductivity")
        self.expect_refused("heat", HEAT.replace("temperature = 100", "temperatur = 100"), "did you mean", "run.toml:6")
        self.expect_refused("heat", HEAT.replace("temperature = 100", ""), "no value")
        self.expect_refused("static", STATIC.replace("loads = { temperature = 1 }", "loads = { pul = 1 }"), "did you mean 'pull'")
        self.expect_refused("static", STATIC.replace('"heat.h5"', '"none.h5"'), "none.h5")
        self.expect_refused("static", STATIC.replace("[temperature]", "inertia_relief = true\n[temperature]"), "run.toml")
        self.expect_refused("static", "inertia_relief = true\n" + STATIC, "nothing holds")
        self.expect_refused("static", STATIC.replace('material = "steel"', "[material]\nE = 1\nnu = 0.3\nrho = 1\nexpansion = 1"),
                            "rpm needs a unit of time")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
