#!/usr/bin/python3
"""Bodies that the surface has apart and a coarse model joins are warned of, with a span size that keeps them apart.
usage: joined_bodies_test.py IGAPREP IGASOLVE"""
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))
from parts import write_boxes  # noqa: E402

IGAPREP, IGASOLVE = sys.argv[1:3]
MATERIAL = ("--E", "210", "--nu", "0.3", "--rho", "7.8e-6")


class JoinedBodies(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def prepare(self, size, degree="2"):
        model = self.path / f"part_{size}.h5"
        subprocess.run([IGAPREP, self.path / "part.stl", "-o", model, "--span-size", str(size), "--degree", degree,
                        "--length-unit", "mm", "--quiet", "--force"], check=True, capture_output=True)
        return model

    def solve(self, *command):
        done = subprocess.run([IGASOLVE, *map(str, command), "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)
        return report, [warning for warning in report["warnings"] if "joins them into" in warning]

    def test_the_span_size_in_the_warning_keeps_bodies_apart(self):
        write_boxes(self.path / "part.stl", [((0, 0, 0), (12, 8, 2)), ((0, 0, 2.6), (12, 8, 4.6)), ((13, 0, 0), (15, 8, 4))])
        for degree in ("1", "2"):
            with self.subTest(degree=degree):
                coarse, warnings = self.solve("eigen", self.prepare(1.5, degree), *MATERIAL, "--modes", "1")
                self.assertLess(coarse["bodies"], 3)
                self.assertEqual(len(warnings), 1, warnings)
                self.assertIn(f"the surface has 3 bodies, this model joins them into {coarse['bodies']}", warnings[0])
                size = float(re.search(r"spans of at most ([\d.e-]+)", warnings[0])[1])
                self.assertAlmostEqual(size, 0.6 / (int(degree) + 1), delta=1e-6)
                fine, warnings = self.solve("timestep", self.prepare(size, degree), *MATERIAL)
                self.assertEqual(warnings, [])

    def test_every_analysis_warns(self):
        write_boxes(self.path / "part.stl", [((0, 0, 0), (6, 4, 2)), ((0, 0, 2.6), (6, 4, 4.6))])
        model = self.prepare(1.5)
        head = f"model = '{model}'\n[material]\nE = 210\nnu = 0.3\nrho = 7.8e-6\n"
        (self.path / "held.toml").write_text(head + "[[support]]\nwhole_surface = true\n[[load]]\nbody_force = [0, 0, 1]\n")
        (self.path / "flight.toml").write_text(
            f"[[bodies]]\nname = 'plates'\nmodel = '{model}'\nmaterial = {{ law = 'neo-hookean', E = 210, nu = 0.3, "
            "rho = 7.8e-6 }\n[time]\nend = 1e-5\n[output]\ninterval = 1e-5\n")
        for command in (["eigen", model, *MATERIAL, "--modes", "1"], ["timestep", model, *MATERIAL],
                        ["static", self.path / "held.toml"],
                        ["explicit", self.path / "flight.toml", "-o", self.path / "flight.h5"]):
            with self.subTest(command=command[0]):
                self.assertEqual(len(self.solve(*command)[1]), 1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
