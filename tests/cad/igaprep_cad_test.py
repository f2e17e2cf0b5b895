#!/usr/bin/python3
"""igaprep on CAD files: lists, models with their faces, edges and vertices, assemblies, refusals.

igaprep_cad_test.py ROOT IGAPREP IGASOLVE MAKE_CAD_PARTS"""
import json
import math
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

ROOT, IGAPREP, IGASOLVE, MAKE_CAD_PARTS = sys.argv[1:5]
sys.path[:0] = [str(Path(ROOT) / "scripts"), str(Path(ROOT) / "tests/scripts")]
import parts  # noqa: E402
from igatools.iga_model import read  # noqa: E402


class CadFiles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.holder.name)
        subprocess.run([MAKE_CAD_PARTS, cls.holder.name], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def igaprep(self, *words, code=0, program=IGAPREP):
        run = subprocess.run([program, *map(str, words)], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(run.returncode, code, run.stderr)
        return run

    def refused(self, *words):
        return self.igaprep(*words, code=2).stderr

    def test_lists_faces(self):
        listed = json.loads(self.igaprep("named_box.step", "--list-edges", "--json").stdout)
        box = listed["solids"][0]
        top = next(face for face in box["faces"] if face["name"] == "top")
        self.assertEqual((top["type"], top["normal"], top["colour"]), ("plane", [0, 0, 1], "#FF0000"))
        self.assertAlmostEqual(top["area"], 600)
        self.assertEqual((len(box["faces"]), len(box["edges"]), len(box["vertices"])), (6, 12, 8))
        text = self.igaprep("crossing_bores.step", "--list").stdout
        self.assertIn("bore", text)
        self.assertIn("radius 5, axis (1, 0, 0)", text)
        self.assertNotIn("vertex", text)

    def test_model_of_a_solid(self):
        report = json.loads(self.igaprep("crossing_bores.step", "-o", "bores.h5", "--span-size", 4, "--json").stdout)
        self.assertEqual(report["length_unit"], "mm")
        model = read(self.folder / "bores.h5")
        listed = json.loads(self.igaprep("crossing_bores.step", "--list-edges", "--json").stdout)["solids"][0]
        self.assertEqual([name.decode() if isinstance(name, bytes) else name for name in model.data["/surface/regions"]], [face["name"] for face in listed["faces"]])
        self.assertLess(abs(report["volume"] / listed["volume"] - 1), 2e-3)
        self.assertEqual(len(model.curves()), len(listed["edges"]))
        for edge in listed["edges"]:
            points = model.curves()[edge["name"]]
            length = sum(math.dist(a, b) for a, b in zip(points, points[1:]))
            self.assertAlmostEqual(length / edge["length"], 1, places=2)
        self.assertEqual(len(model.markers()), len(listed["vertices"]))
        # The chord follows from the spans: half of it, a quarter of the facets' error.
        self.assertIn("chord of 0.004 mm", report["findings"][-1])
        subprocess.run([IGASOLVE, "check", "bores.h5"], check=True, cwd=self.folder, capture_output=True)
        info = subprocess.run([IGASOLVE, "info", "bores.h5"], check=True, cwd=self.folder, capture_output=True, text=True)
        self.assertIn("face 1", info.stdout)

    def test_units(self):
        report = json.loads(self.igaprep("inches.step", "-o", "inches.h5", "--json").stdout)
        self.assertEqual(report["length_unit"], "in")
        inches = report["volume"]
        report = json.loads(self.igaprep("inches.step", "-o", "mm.h5", "--length-unit", "mm", "--json").stdout)
        self.assertAlmostEqual(report["volume"] / inches / 25.4**3, 1, places=9)
        self.assertIn("expected one of mm", self.refused("inches.step", "-o", "x.h5", "--length-unit", "yard"))

    def test_assembly(self):
        self.igaprep("assembly.step", "-o", "models/", "--span-size", 2)
        folder = self.folder / "models"
        self.assertEqual(sorted(f.name for f in folder.iterdir()), ["bolt_left.h5", "plate.h5", "run.toml"])
        with open(folder / "run.toml", "rb") as file:
            bodies = tomllib.load(file)["bodies"]
        self.assertEqual([b["name"] for b in bodies], ["plate", "bolt left", "bolt right"])
        self.assertEqual([b["model"] for b in bodies], ["plate.h5", "bolt_left.h5", "bolt_left.h5"])
        self.assertAlmostEqual(bodies[2]["place"]["degrees"], 30)
        self.assertEqual(bodies[2]["place"]["axis"], [0, 0, 1])
        # A run file that may have been filled in stays; models that stand already are not made again.
        (folder / "run.toml").write_text("# mine\n")
        again = self.igaprep("assembly.step", "-o", "models/", "--span-size", 2)
        self.assertIn("nothing to do", again.stdout)
        self.assertEqual((folder / "run.toml").read_text(), "# mine\n")
        # One model needs a choice.
        message = self.refused("assembly.step", "-o", "one.h5")
        for word in ("--solid", "--merge", "folder/", '"plate"'):
            self.assertIn(word, message)
        self.assertIn('it holds "plate", "bolt left"', self.refused("assembly.step", "-o", "one.h5", "--solid", "nut"))
        self.igaprep("assembly.step", "-o", "one.h5", "--solid", "plate", "--span-size", 4)
        report = json.loads(self.igaprep("assembly.step", "-o", "all.h5", "--merge", "--span-size", 4, "--json").stdout)
        self.assertEqual(report["components"], 1)

    def test_overlap_is_told(self):
        run = self.igaprep("overlap.step", "-o", "overlapping/", "--span-size", 3)
        self.assertIn('"plate" and "bolt" share a volume of 12.57', run.stderr)
        solved = subprocess.run([IGASOLVE, "check", "overlapping/bolt.h5"], capture_output=True, text=True, cwd=self.folder)
        self.assertIn("share a volume of 12.57", solved.stdout)

    def test_bodies_of_an_stl(self):
        stl = self.folder / "two.stl"
        parts.write_boxes(stl, [((x, 0, 0), (x + 10, 10, 10)) for x in (0, 15)])
        self.igaprep(stl, "-o", "two/", "--span-size", 3)
        for body in ("body_1", "body_2"):
            model = read(self.folder / "two" / f"{body}.h5")
            self.assertAlmostEqual(sum(model.data["/quadrature/weights"]), 1000, places=6)
        for words in (("--chord", 0.1), ("--solid", "x"), ("--merge",), ("--sew", 0.1)):
            self.assertIn("are for CAD files", self.refused(stl, "-o", "x.h5", *words))
        self.assertIn("--list is for CAD files", self.refused(stl, "--list"))

    def test_damaged_files_leave_nothing(self):
        whole = (self.folder / "thread.step").read_bytes()
        damaged = self.folder / "damaged.step"
        for share in (0.1, 0.5, 0.9):
            damaged.write_bytes(whole[: int(share * len(whole))])
            message = self.refused("damaged.step", "-o", "damaged.h5")
            self.assertIn("damaged.step: the STEP file cannot be read", message)
            self.assertFalse((self.folder / "damaged.h5").exists())
        self.assertIn("no such file", self.refused("missing.step"))

    def test_without_the_reader(self):
        alone = self.folder / "alone"
        alone.mkdir()
        program = shutil.copy(IGAPREP, alone)
        run = self.igaprep("box.step", "--list", code=2, program=program)
        self.assertIn("built without OpenCASCADE", run.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
