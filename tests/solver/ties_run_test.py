#!/usr/bin/python3
"""Runs of several bodies with ties: reports, results and viewer files name the bodies; mistakes are refused with their line.
usage: ties_run_test.py SOURCE_DIR IGAPREP IGASOLVE"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

SOURCE, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "tests/scripts")]
from igatools import iga_model, iga_results  # noqa: E402
from parts import write_boxes  # noqa: E402

# An upright plate stands on a base: its model lies, and is turned up about the y axis.
RUN = """
units = "mm"
[material]
E = 210
nu = 0.3
rho = 7.8e-6
[[bodies]]
name = "base"
model = "base.h5"
[[bodies]]
name = "plate"
model = "plate.h5"
material = { law = "linear-elastic", E = 70, nu = 0.3, rho = 2.7e-6 }
place = { axis = [0, 1, 0], degrees = -90, shift = [20, 0, 5] }
[[ties]]
name = "weld"
bodies = ["plate", "base"]
first = { normal = { direction = [0, 0, -1] } }
tolerance = 0.01
[[support]]
name = "ground"
body = "base"
normal = { direction = [0, 0, -1] }
[[load]]
name = "wind"
body = "plate"
pressure = 1e-3
normal = { direction = [-1, 0, 0] }
[[load]]
name = "weight"
acceleration = [0, 0, -9.81e-3]
[[probe]]
name = "top"
position = [20, 10, 35]
"""


class SeveralBodies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        for name, box, spans in (("base", ((0, 0, 0), (40, 20, 5)), "4"), ("plate", ((0, 0, 0), (30, 20, 4)), "3.3")):
            write_boxes(cls.path / f"{name}.stl", [box])
            subprocess.run([IGAPREP, cls.path / f"{name}.stl", "--span-size", spans, "--length-unit", "mm", "-o",
                            cls.path / f"{name}.h5", "--quiet"], check=True)

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

    def refused(self, analysis, *changes):
        done = self.command(analysis, *changes)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        return done.stderr

    def viewer_parts(self, results):
        return [(float(item.get("timestep")), item.get("part"), (self.path / item.get("file")).is_file())
                for item in ElementTree.parse(results.with_suffix(".pvd")).getroot().iter("DataSet")]

    def test_static(self):
        out = self.path / "static.h5"
        report = self.report("static", more=("-o", out))
        self.assertEqual([model["name"] for model in report["models"]], ["base", "plate"])
        statics = report["statics"]
        self.assertLess(statics["energy_defect"], 1e-9)
        np.testing.assert_allclose(statics["force_balance"], 0, atol=1e-9)
        weight = 9.81e-3 * (7.8e-6 * 40 * 20 * 5 + 2.7e-6 * 30 * 20 * 4)
        loads = {load["name"]: load["force"] for load in statics["loads"]}
        np.testing.assert_allclose(loads["weight"], [0, 0, -weight], atol=1e-12)
        np.testing.assert_allclose(loads["wind"], [0.6, 0, 0], atol=1e-12)
        tie = statics["ties"][0]
        self.assertEqual(tie["bodies"], ["base", "plate"])
        self.assertAlmostEqual(tie["area"], 80, places=9)
        np.testing.assert_allclose(tie["force"], [0.6, 0, -9.81e-3 * 2.7e-6 * 30 * 20 * 4], atol=1e-9)
        self.assertGreater(statics["probes"][0]["displacement"][0], 0)

        results = iga_results.read(out)
        self.assertEqual(results.texts("/body_names"), ["base", "plate"])
        self.assertEqual(results.attribute("/bodies/plate", "file"), "plate.h5")
        fields = results.fields(0)
        for name in ("base", "plate"):
            model = iga_model.read(self.path / f"{name}.h5")
            np.testing.assert_array_equal(fields.mesh[f"{name}/active_functions"], model["/functions/number"])
            self.assertEqual(len(fields[f"{name}/point_stress"]), len(model["/quadrature/weights"]))
        vertices, moved = fields.mesh["plate/vertices"], fields["plate/displacement"]
        np.testing.assert_allclose([vertices.min(axis=0), vertices.max(axis=0)], [[16, 0, 5], [20, 20, 35]], atol=1e-9)
        top = np.abs(vertices - [20, 0, 35]).sum(axis=1).argmin()
        self.assertGreater(moved[top, 0], 0)
        self.assertEqual(self.viewer_parts(out), [(1.0, "0", True), (1.0, "1", True)])
        tables = subprocess.run([IGASOLVE, "export", out, "--csv", "--json"], capture_output=True, text=True)
        self.assertEqual(tables.returncode, 0, tables.stderr)
        self.assertIn("surface_plate_0001", tables.stdout)

    def test_eigen(self):
        free = (RUN[RUN.index("[[support]]"):], "")
        out = self.path / "modes.h5"
        report = self.report("eigen", free, more=("-o", out, "--modes", "3"))
        self.assertEqual((report["bodies"], report["rigid_modes"]), (1, 6))
        results = iga_results.read(out)
        self.assertEqual(results.num_fields(), 9)
        self.assertEqual(results["/modes"].shape, (9, 0, 3))
        np.testing.assert_allclose(results["/frequencies"], report["frequencies"])
        self.assertEqual(len(self.viewer_parts(out)), 18)
        text = self.command("eigen", free, more=("--modes", "1")).stdout
        self.assertIn("tie          weld: 'base' and 'plate': area 80 of ", text)
        untied = self.report("eigen", free, (RUN[RUN.index("[[ties]]"):RUN.index("[[support]]")], ""), more=("--modes", "1"))
        self.assertEqual((untied["bodies"], untied["rigid_modes"]), (2, 12))

    def test_timestep(self):
        tied = self.report("timestep")
        self.assertGreater(tied["dt_crit"], 0)
        bare = (RUN[RUN.index("[[ties]]"):], "")
        untied = self.report("timestep", bare)
        self.assertGreater(untied["dt_crit"], tied["dt_crit"])

    def test_automatic_ties(self):
        statics = self.report("static", ('bodies = ["plate", "base"]\nfirst = { normal = { direction = [0, 0, -1] } }\n', ""))
        self.assertAlmostEqual(statics["statics"]["ties"][0]["area"], 80, places=9)

    def test_materials_by_name(self):
        changes = [("[material]\nE = 210\nnu = 0.3\nrho = 7.8e-6", 'unit_system = "kg-mm-ms"\n[material]\nname = "steel"'),
                   ("E = 70, nu = 0.3, rho = 2.7e-6", 'name = "aluminium"')]
        models = self.report("static", *changes)["models"]
        self.assertEqual([model["material"]["name"] for model in models], ["steel", "aluminium"])
        np.testing.assert_allclose([model["material"]["E"] for model in models], [210, 70], rtol=1e-12)
        self.assertAlmostEqual(models[0]["material"]["mass_in_kg"], 7.85e-6 * 40 * 20 * 5, places=9)
        self.assertAlmostEqual(models[1]["material"]["mass_in_kg"], 2.7e-6 * 30 * 20 * 4, places=9)
        self.assertIn('did you mean "aluminium"', self.refused("static", ("E = 70, nu = 0.3, rho = 2.7e-6", 'name = "alumnium"')))

    def test_mistakes(self):
        too_far = self.refused("static", ("shift = [20, 0, 5]", "shift = [20, 0, 6]"))
        self.assertIn("run.toml:16: tie 'weld': nothing is tied", too_far)
        self.assertIn("within the tolerance of 0.01; the smallest distance found is 1;", too_far)
        self.assertIn("the bodies 'base' and 'plate' all have", self.refused("static", ('body = "base"\n', "")))
        self.assertIn("did you mean 'plate'", self.refused("static", ('body = "plate"', 'body = "palte"')))
        self.assertIn("there is another body 'base'", self.refused("static", ('name = "plate"\n', 'name = "base"\n')))
        self.assertIn("leave one of them out", self.refused("static", ('units = "mm"', 'model = "base.h5"')))
        self.assertIn("'linear-elastic' or none".replace("'", '"', 2), self.refused("static", ("linear-elastic", "neo-hookean")))
        self.assertIn("found 1 names", self.refused("static", ('bodies = ["plate", "base"]', 'bodies = ["plate"]')))
        self.assertIn("a choice of surface belongs to a body", self.refused("static", ('bodies = ["plate", "base"]\n', "")))
        unheld = self.refused("static", (RUN[RUN.index("[[ties]]"):RUN.index("[[support]]")], ""))
        self.assertIn("body 2 of 2, 'plate'", unheld)
        no_density = self.refused("eigen", ("E = 70, nu = 0.3, rho = 2.7e-6", "E = 70, nu = 0.3"))
        self.assertIn("material of body 'plate': the density is missing", no_density)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
