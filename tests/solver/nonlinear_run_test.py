#!/usr/bin/python3
"""Runs of igasolve nonlinear: reports, results, restart, failure; mistakes are refused with their line.
usage: nonlinear_run_test.py SOURCE_DIR IGAPREP IGASOLVE"""
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "tests/scripts")]
from igatools import iga_results  # noqa: E402
from parts import write_boxes  # noqa: E402

RUN = """
model = "beam.h5"
units = "mm"
material = { law = "j2", E = 200, nu = 0.3, yield_stress = 0.5, hardening_modulus = 5 }
[[support]]
name = "root"
plane = { point = [0, 0, 0], normal = [1, 0, 0] }
[[load]]
name = "tip"
plane = { point = [20, 0, 0], normal = [1, 0, 0] }
force = [0, 0, -0.5]
[[probe]]
name = "tip"
position = [20, 2, 2]
[nonlinear]
steps = 4
"""
PRESS = """
model = "beam.h5"
material = { law = "neo-hookean", E = 200, nu = 0.3 }
[[rigid_bodies]]
name = "floor"
shape = "plane"
normal = [0, 0, 1]
centre = [0, 0, 0]
[[rigid_bodies]]
name = "ball"
shape = "sphere"
radius = 12
centre = [10, 2, 16]
drive = { z = [[0, 0], [1, -0.2]], x = [[0, 0], [0.5, 0], [1, 0.1]] }
[[contacts]]
bodies = ["ball", "part"]
friction = 0.3
[[contacts]]
bodies = ["part", "floor"]
rough = true
[nonlinear]
steps = 4
"""
BILLET = 'law = "j2", E = 200, nu = 0.3, yield_stress = 0.5, hardening_modulus = 5'


class Nonlinear(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        write_boxes(cls.path / "beam.stl", [((0, 0, 0), (20, 4, 4))])
        subprocess.run([IGAPREP, cls.path / "beam.stl", "--span-size", "4", "--length-unit", "mm", "-o", cls.path / "beam.h5", "--quiet"],
                       check=True)
        (cls.path / "run.toml").write_text(RUN)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def solve(self, *words, code=0):
        done = subprocess.run([IGASOLVE, "nonlinear", *words], cwd=self.path, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def refused(self, change, *expected):
        text = change(RUN)
        self.assertNotEqual(text, RUN)
        (self.path / "wrong.toml").write_text(text)
        message = self.solve("wrong.toml", code=2).stderr
        for words in expected:
            self.assertIn(words, message)

    def test_report_and_results(self):
        report = json.loads(self.solve("run.toml", "-o", "whole.h5", "--json", "--force").stdout)
        self.assertEqual([step["factor"] for step in report["steps"]], [0.25, 0.5, 0.75, 1])
        self.assertTrue(all(step["residual"] < 1e-8 for step in report["steps"]))
        np.testing.assert_allclose(report["supports"][0]["force"], [0, 0, 0.5], atol=1e-7)
        results = iga_results.read(self.path / "whole.h5")
        np.testing.assert_array_equal(results["/time_series/time"], [0.25, 0.5, 0.75, 1])
        tip = results["/time_series/probe/tip/displacement"]
        np.testing.assert_allclose(tip[-1], report["probes"][0]["displacement"])
        self.assertGreater(-tip[-1, 2], 4 * -tip[0, 2])  # it yields
        fields = results.fields(-1)
        self.assertGreater(fields["part/plastic_strain"].max(), 1e-3)
        self.assertIn("whole_vtp/", (self.path / "whole.pvd").read_text())
        self.assertFalse((self.path / "whole_restart.h5").exists())
        subprocess.run([IGASOLVE, "export", "whole.h5", "--csv", "--quiet", "--force"], cwd=self.path, check=True)
        header, *rows = (self.path / "whole_csv/probe_tip.csv").read_text().splitlines()
        self.assertIn("displacement", header)
        self.assertEqual(len(rows), 4)
        text = self.solve("run.toml").stdout
        for words in ("load factor", "support      root: reaction", "probe        tip: displacement"):
            self.assertIn(words, text)

    def test_failure_keeps_steps_and_restart_goes_on(self):
        (self.path / "stuck.toml").write_text(RUN.replace("steps = 4", "steps = 4\nmax_iterations = 5\nsmallest_step = 0.6"))
        done = self.solve("stuck.toml", "-o", "stuck.h5", "--force", code=4)
        self.assertIn("--restart", done.stderr)
        kept = len(iga_results.read(self.path / "stuck.h5")["/time_series/time"])
        self.assertLess(kept, 4)
        self.assertGreater(kept, 0)
        (self.path / "stuck.toml").write_text(RUN)
        self.solve("stuck.toml", "-o", "stuck.h5", "--restart")
        self.solve("run.toml", "-o", "through.h5", "--force")
        for name in ("/time_series/probe/tip/displacement", "/time_series/energy/internal", "/time_series/support/root/force"):
            np.testing.assert_array_equal(iga_results.read(self.path / "stuck.h5")[name], iga_results.read(self.path / "through.h5")[name])
        self.assertFalse((self.path / "stuck_restart.h5").exists())

    def test_restart_of_another_run_is_refused(self):
        (self.path / "other.toml").write_text(RUN.replace("steps = 4", "steps = 4\nmax_iterations = 5\nsmallest_step = 0.6"))
        self.solve("other.toml", "-o", "other.h5", "--force", code=4)
        (self.path / "other.toml").write_text(RUN.replace("-0.5]", "-0.6]"))
        self.assertIn("load[1].force", self.solve("other.toml", "-o", "other.h5", "--restart", code=2).stderr)

    def test_contact(self):
        (self.path / "press.toml").write_text(PRESS)
        report = json.loads(self.solve("press.toml", "-o", "press.h5", "--json", "--force").stdout)
        ball, floor = report["contacts"]
        self.assertGreater(floor["force"][2], 0)
        np.testing.assert_allclose(np.add(ball["force"], floor["force"]), 0, atol=1e-6 * floor["force"][2])
        self.assertGreater(ball["area"], 0)
        self.assertLess(ball["depth_in_spans"], 0.02)
        balance = re.search(r"balance +loads \+ reactions \+ contacts \((.*)\)", self.solve("press.toml").stdout)
        np.testing.assert_allclose([float(x) for x in balance[1].split(",")], 0, atol=1e-6 * floor["force"][2])
        results = iga_results.read(self.path / "press.h5")
        on_ball = results["/time_series/contact/ball-part/force"]  # on the first-named
        np.testing.assert_allclose(on_ball[-1], np.negative(ball["force"]))
        np.testing.assert_allclose(results["/time_series/rigid/ball/force"], on_ball)
        np.testing.assert_allclose(results["/time_series/rigid/ball/position"][-1], [10.1, 2, 15.8])
        self.assertGreater(on_ball[-1, 2], on_ball[0, 2])
        for word, change in (("free", lambda text: text.replace('name = "ball"', 'name = "ball"\nmotion = "free"\nmass = 1')),
                             ("self", lambda text: text.replace('bodies = ["ball", "part"]', 'self = "part"')),
                             ("rough", lambda text: text.replace("friction = 0.3", "friction = 0.3\nrough = true")),
                             ("damping", lambda text: text.replace("friction = 0.3", "damping = 0.3")),
                             ("nor do the tools", lambda text: text.replace("rough = true", "friction = 0").replace("0.3", "0")),
                             ("deep", lambda text: text.replace("centre = [10, 2, 16]", "centre = [10, 2, 12]"))):
            (self.path / "wrong.toml").write_text(change(PRESS))
            self.assertIn(word, self.solve("wrong.toml", code=2).stderr)

    def test_locking(self):
        rubber = RUN.replace('law = "j2"', 'law = "neo-hookean"').replace(", yield_stress = 0.5, hardening_modulus = 5", "")
        tip = {}
        for nu, locking, expected in (("0.3", "", "none"), ("0.4999", "", "fbar"), ("0.4999", "none", "none")):
            text = rubber.replace("nu = 0.3", f"nu = {nu}").replace("units =", f'locking = "{locking}"\nunits =' if locking else "units =")
            (self.path / "rubber.toml").write_text(text)
            done = self.solve("rubber.toml", "--json")
            report = json.loads(done.stdout)
            self.assertEqual(report["locking"], expected)
            self.assertEqual("near 0.5" in done.stderr, locking == "none")
            tip[expected] = report["probes"][0]["displacement"][2]
        self.assertLess(tip["fbar"], 1.3 * tip["none"])  # downwards: what locks is too stiff
        (self.path / "rubber.toml").write_text(rubber.replace("nu = 0.3", "nu = 0.4999"))
        self.assertIn("F-bar", self.solve("rubber.toml").stdout)
        for nu, warned in (("0.48", False), ("0.49", True)):
            done = subprocess.run([IGASOLVE, "eigen", "beam.h5", "--E", "200", "--nu", nu, "--rho", "1e-6", "--modes", "1"], cwd=self.path,
                                  capture_output=True, text=True)
            self.assertEqual("fbar" in done.stderr, warned, done.stderr)

    def test_contact_goes_on_bit_for_bit(self):
        hasty = PRESS.replace("steps = 4", "steps = 4\nmax_iterations = 7\nsmallest_step = 0.9")
        (self.path / "pressed.toml").write_text(hasty.replace('law = "neo-hookean", E = 200, nu = 0.3', BILLET))
        self.solve("pressed.toml", "-o", "pressed.h5", "--force", code=4)
        kept = len(iga_results.read(self.path / "pressed.h5")["/time_series/time"])
        self.assertIn(kept, (1, 2, 3))
        (self.path / "pressed.toml").write_text(PRESS.replace('law = "neo-hookean", E = 200, nu = 0.3', BILLET))
        self.solve("pressed.toml", "-o", "pressed.h5", "--restart")
        self.solve("pressed.toml", "-o", "through.h5", "--force")
        found, expected = (iga_results.read(self.path / name) for name in ("pressed.h5", "through.h5"))
        for name in ("contact/ball-part/force", "contact/part-floor/force", "contact/ball-part/area", "rigid/ball/moment", "energy/internal",
                     "energy/friction", "energy/external"):
            np.testing.assert_array_equal(found[f"/time_series/{name}"], expected[f"/time_series/{name}"], name)
        for name in ("coefficients", "von_mises", "plastic_strain"):
            np.testing.assert_array_equal(found.fields(-1)[f"part/{name}"], expected.fields(-1)[f"part/{name}"], name)

    def test_mistakes(self):
        self.refused(lambda text: text.replace("units =", 'locking = "bbar"\nunits ='), "locking", "fbar")
        self.refused(lambda text: text.replace("units =", 'locking = "fbar"\nunits =').replace('law = "j2"', 'law = "linear-elastic"')
                     .replace(", yield_stress = 0.5, hardening_modulus = 5", ""), "wrong.toml:3", "neo-hookean")
        self.refused(lambda text: text.replace("steps = 4", "step = 4"), "wrong.toml:16", "steps")
        self.refused(lambda text: text.replace("force = [0, 0, -0.5]", "moment = [0, 1, 0]"), "wrong.toml:11", "moment")
        self.refused(lambda text: text.replace("force = [0, 0, -0.5]", "traction = [0, 0, -1]\nfollower = true"), "follower", "pressure")
        self.refused(lambda text: text.replace('name = "root"', 'name = "root"\nmethod = "nitsche"'), "penalty")
        self.refused(lambda text: text.replace('name = "root"', 'name = "root"\nfixed = "pinned"'), "fix components")
        self.refused(lambda text: text.replace('name = "root"', 'name = "root"\nfixed = "x"'), "the supports do not hold the part")
        self.refused(lambda text: text.replace('model = "beam.h5"', '[[bodies]]\nname = "a"'), "one body")
        self.refused(lambda text: text.replace("force = [0, 0, -0.5]", "acceleration = [0, 0, -1]"), "wrong.toml")
        self.refused(lambda text: text.replace("nu = 0.3,", "nu = 0.3, inversion = \"erode\","), "clamp")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
