#!/usr/bin/python3
"""scripts/export_mesh.py: a bar on tetrahedra by CalculiX beside igasolve and beside what is known of it; what is
refused. usage: export_mesh_test.py SOURCE_DIR IGAPREP IGASOLVE      Exit code 77 (skipped) where Gmsh or CalculiX are
not installed.
"""

import json
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, IGAPREP, IGASOLVE = Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]
sys.path[:0] = [str(SOURCE / "scripts"), str(Path(__file__).resolve().parent)]
from igatools.mesh_deck import ExportError, MeshRun  # noqa: E402
from parts import run_tests, write_boxes  # noqa: E402

MISSING = [name for name in ("gmsh", "ccx") if shutil.which(name) is None]
BAR = """model = "bar.h5"
material = { E = 1000, nu = 0.3, rho = 2e-3 }
[[support]]
name = "wall"
fixed = "xyz"
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
[[load]]
name = "end"
force = [0, 0, -3]
plane = { point = [8, 0, 0], normal = [1, 0, 0] }
[[load]]
name = "top"
pressure = 0.1
region = "body"
normal = { direction = [0, 0, 1] }
[[load]]
name = "weight"
acceleration = [0, -10, 0]
[[probe]]
name = "tip"
position = [7.5, 1, 1]
"""


class ExportMesh(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = Path(folder.name)
        write_boxes(cls.path / "bar.stl", [((0, 0, 0), (8, 2, 2))])
        subprocess.run(
            [IGAPREP, cls.path / "bar.stl", "-o", cls.path / "bar.h5", "--quiet", "--span-size", "1", "--degree", "3"],
            check=True,
            capture_output=True,
        )
        (cls.path / "run.toml").write_text(BAR)

    def export(self, *words):
        done = subprocess.run(
            [SOURCE / "scripts" / "export_mesh.py", *words, "-o", self.path / "deck.inp", "--force"],
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    @staticmethod
    def numbers(text, line):
        """Numbers behind the colon of the line that begins so."""
        found = next(row for row in text.splitlines() if row.startswith(line))
        return np.array([float(word) for word in re.findall(r"-?\d+\.?\d*(?:e[-+]?\d+)?", found.partition(":")[2])])

    def ours(self, *words):
        done = subprocess.run(
            [IGASOLVE, *words, self.path / "run.toml", "--json", "-o", self.path / "ours.h5", "--force"],
            check=True,
            capture_output=True,
            text=True,
        )
        return json.loads(done.stdout)

    @unittest.skipIf(MISSING, f"missing: {MISSING}")
    def test_static_answers_agree(self):
        said = self.export(self.path / "run.toml", "--size", "0.8", "--run")
        probe = self.numbers(said, "probe tip")
        ours = self.ours("static")["statics"]["probes"][0]["displacement"]
        np.testing.assert_allclose(probe, ours, atol=0.01 * np.linalg.norm(ours))
        # 3 at the end, a pressure of 0.1 on 8 × 2, a weight of 2e-3 · 32 · 10
        np.testing.assert_allclose(self.numbers(said, "support wall"), [0, 0.64, 3 + 1.6], atol=2e-4)
        self.assertNotIn("note:", said)

    @unittest.skipIf(MISSING, f"missing: {MISSING}")
    def test_modes_agree(self):
        said = self.export(self.path / "bar.stl", self.path / "run.toml", "--size", "0.7", "--modes", "3", "--run")
        found = [float(line.split()[2]) for line in said.splitlines() if line.startswith("mode")]
        np.testing.assert_allclose(found, self.ours("eigen", "--modes", "3")["frequencies"][:3], rtol=0.01)

    def test_surface_alone(self):
        self.assertIn("12 triangles, 8 nodes", self.export(self.path / "run.toml", "--surface"))
        lines = (self.path / "deck.inp").read_text().splitlines()
        self.assertEqual(sum(line.startswith("*ELEMENT, TYPE=S3") for line in lines), 1)

    def test_refusals(self):
        for change, expected in [
            (("pressure = 0.1", "bearing = [1, 0, 0]"), "bearing"),
            (('fixed = "xyz"', 'fixed = "xyz"\nvalue = [1, 0, 0]'), "value"),
            (("{ E = 1000, nu = 0.3, rho = 2e-3 }", '"steel"'), "E and nu as numbers"),
            (("[[probe]]", "[temperature]\nuniform = 3\n[[probe]]"), "temperature"),
            (('model = "bar.h5"', ""), "no model"),
        ]:
            with self.subTest(expected):
                (self.path / "refused.toml").write_text(BAR.replace(*change))
                with self.assertRaises(ExportError) as caught:
                    MeshRun(None, self.path / "refused.toml")
                self.assertIn(expected, str(caught.exception))


if __name__ == "__main__":
    run_tests(" and ".join(MISSING))
