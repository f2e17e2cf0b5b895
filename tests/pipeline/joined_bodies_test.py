#!/usr/bin/python3
"""Bodies that the surface has apart stay apart in every analysis, however coarse the spans are.
usage: joined_bodies_test.py IGAPREP IGASOLVE"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))
from parts import write_boxes  # noqa: E402

IGAPREP, IGASOLVE = sys.argv[1:3]
MATERIAL = ("--E", "210", "--nu", "0.3", "--rho", "7.8e-6")
BODIES = [((0, 0, 0), (12, 8, 2)), ((0, 0, 2.6), (12, 8, 4.6)), ((12.001, 0, 0), (15, 8, 4))]


class JoinedBodies(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def prepare(self, name, boxes, size, degree="2", *grid):
        write_boxes(self.path / "part.stl", boxes)
        model = self.path / f"{name}.h5"
        subprocess.run([IGAPREP, self.path / "part.stl", "-o", model, *(grid or ("--span-size", str(size))), "--degree", degree,
                        "--length-unit", "mm", "--quiet", "--force"], check=True, capture_output=True)
        return model

    def solve(self, *command):
        done = subprocess.run([IGASOLVE, *map(str, command), "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        report = json.loads(done.stdout)
        self.assertEqual([warning for warning in report["warnings"] if "joins them" in warning], [])
        return report

    def test_bodies_closer_than_a_span_are_apart(self):
        for degree in ("1", "2", "3"):
            for size in (1.5, 5, 8):
                with self.subTest(degree=degree, size=size):
                    report = self.solve("eigen", self.prepare("part", BODIES, size, degree), *MATERIAL, "--modes", "2")
                    self.assertEqual(report["bodies"], 3)
                    self.assertEqual(report["rigid_modes"], 18)

    def test_each_has_the_frequencies_of_itself_alone(self):
        grid = ("--box", -1, -1, -1, 17, 9, 6, "--spans", 6, 3, 3)
        options = (*MATERIAL, "--light-functions", "none", "--modes")
        alone = []
        for number, box in enumerate(BODIES):
            alone += self.solve("eigen", self.prepare(f"alone{number}", [box], 0, "2", *map(str, grid)), *options,
                                "6")["frequencies"][6:]
        together = self.solve("eigen", self.prepare("together", BODIES, 0, "2", *map(str, grid)), *options, "6")
        for found, expected in zip(together["frequencies"][18:], sorted(alone)):
            self.assertAlmostEqual(found / expected, 1, delta=1e-8)

    def test_no_analysis_joins_them(self):
        model = self.prepare("part", BODIES[:2], 1.5)
        head = f"model = '{model}'\n[material]\nE = 210\nnu = 0.3\nrho = 7.8e-6\n"
        (self.path / "held.toml").write_text(head + "[[support]]\nwhole_surface = true\n[[load]]\nbody_force = [0, 0, 1]\n")
        (self.path / "flight.toml").write_text(
            f"[[bodies]]\nname = 'plates'\nmodel = '{model}'\nmaterial = {{ law = 'neo-hookean', E = 210, nu = 0.3, "
            "rho = 7.8e-6 }\n[time]\nend = 1e-5\n[output]\ninterval = 1e-5\n")
        for command in (["eigen", model, *MATERIAL, "--modes", "1"], ["timestep", model, *MATERIAL],
                        ["static", self.path / "held.toml"],
                        ["explicit", self.path / "flight.toml", "-o", self.path / "flight.h5"]):
            with self.subTest(command=command[0]):
                self.solve(*command)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
