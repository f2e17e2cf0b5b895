#!/usr/bin/python3
"""igasolve harmonic, random, transient from run file to report, results, tables and plot; mistakes are refused with their line.
usage: response_run_test.py SOURCE_DIR IGAPREP IGASOLVE"""
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
from igatools import iga_results  # noqa: E402
from parts import write_boxes  # noqa: E402

# A cantilever, 40 long, 4 wide, 2 high (mm, t, s): first bending mode at about 1 kHz.
RUN = """
model = "bar.h5"
material = "steel"
[[support]]
name = "clamp"
normal = { direction = [-1, 0, 0] }
[[load]]
name = "shaker"
force = [0, 0, 1]
normal = { direction = [1, 0, 0] }
[[probe]]
name = "tip"
position = [40, 2, 1]
[[probe]]
name = "root/top"
position = [3, 2, 2]
[damping]
ratio = 0.02
[harmonic]
from = 100
to = 3000
points = 50
"""
BASE = """
[base]
direction = [0, 0, 1]
unit = "g"
"""


class Responses(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        write_boxes(cls.path / "bar.stl", [((0, 0, 0), (40, 4, 2))])
        subprocess.run([IGAPREP, cls.path / "bar.stl", "--span-size", "4", "4", "2", "--length-unit", "mm", "-o", cls.path / "bar.h5",
                        "--quiet"], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def command(self, analysis, *changes, text=RUN, more=()):
        for before, after in changes:
            self.assertIn(before, text)
            text = text.replace(before, after)
        (self.path / "run.toml").write_text(text)
        return subprocess.run([IGASOLVE, analysis, self.path / "run.toml", *more], capture_output=True, text=True)

    def report(self, analysis, *changes, text=RUN, more=()):
        done = self.command(analysis, *changes, text=text, more=("--json", *more))
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def refused(self, analysis, *words, changes=(), text=RUN):
        done = self.command(analysis, *changes, text=text)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_harmonic(self):
        file = self.path / "harmonic.h5"
        report = self.report("harmonic", more=("-o", file, "--force"))
        first = report["frequencies"][0]
        tip = report["probes"][0]
        self.assertAlmostEqual(tip["relative"]["frequency"], first, delta=0.002 * first)
        # One mode: resonance is 1 / (2 zeta) times what that mode has statically.
        static = self.report("static", ("[harmonic]\nfrom = 100\nto = 3000\npoints = 50\n", ""))["statics"]["probes"][0]
        self.assertAlmostEqual(tip["relative"]["value"] / static["displacement"][2], 25, delta=1)
        results = iga_results.read(file)
        self.assertEqual(results.analysis, "harmonic")
        self.assertEqual(results.texts("/table_names"), ["probe_tip", "probe_root_top", "support_clamp", "modes", "fields"])
        table = results.table("probe_tip")
        f, u, a = table["frequency"], table["displacement_z"], table["acceleration_z"]
        np.testing.assert_allclose(a, (2 * np.pi * f)**2 * u, rtol=1e-9)
        self.assertAlmostEqual(table["displacement_z_phase"][np.argmax(u)], -90, delta=2)
        self.assertEqual(results["/surface/displacement"].shape[0], 2)
        step = results.table("fields")
        np.testing.assert_array_equal(step["phase"], [0, 90])
        peak = np.hypot(*np.abs(results["/surface/displacement"][:, :, 2]).max(axis=1))
        self.assertAlmostEqual(peak, tip["relative"]["value"], delta=0.02 * peak)
        done = subprocess.run([IGASOLVE, "export", file, "--csv", "-o", self.path / "csv", "--force"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.path / "csv" / "probe_tip.csv", newline="") as text:
            rows = list(csv.reader(text))
        self.assertEqual(rows[0][:2], ["frequency [1/time]", "displacement_x [mm]"])
        self.assertEqual(len(rows) - 1, len(f))
        self.assertEqual(float(rows[5][0]), f[4])
        done = subprocess.run([sys.executable, SOURCE / "scripts/plot.py", "response", file, "-o", self.path / "plot.png"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_shaken_base_at_low_frequency_moves_the_part_with_it(self):
        text = RUN[:RUN.index("[[load]]")] + RUN[RUN.index("[[probe]]"):] + BASE + "spectrum = [[1, 2], [100, 2]]\n"
        report = self.report("harmonic", ("from = 100\nto = 3000", "from = 1\nto = 10"), text=text, more=("-o", self.path / "base.h5", "--force"))
        self.assertAlmostEqual(report["probes"][0]["acceleration"]["value"], 2 * 9806.65, delta=5)
        results = iga_results.read(self.path / "base.h5")
        table = results.table("probe_tip")
        np.testing.assert_allclose(table["transmissibility"], 1, atol=2e-4)
        force = results.table("support_clamp")["force_z"]
        np.testing.assert_allclose(force, report["mass"] * 2 * 9806.65, rtol=3e-4)
        self.refused("harmonic", "the spectrum holds 1 … 100", "run goes from", text=text)

    def test_random(self):
        text = RUN[:RUN.index("[[load]]")] + RUN[RUN.index("[[probe]]"):] + BASE + "psd = [[20, 0.01], [3000, 0.01]]\n"
        file = self.path / "random.h5"
        report = self.report("random", text=text, more=("-o", file, "--force"))
        g = 9806.65
        self.assertAlmostEqual(report["base_acceleration"] / g, np.sqrt(0.01 * 2980), delta=1e-6)
        # The beam's first mode after Miles, times what its shape makes of the base (1.566), and the base beside it.
        first = report["frequencies"][0]
        miles = np.sqrt(np.pi / 2 * first * 25 * 0.01)
        self.assertAlmostEqual(report["probes"][0]["acceleration"][2] / g / miles, 1.566, delta=0.3)
        self.assertAlmostEqual(report["probes"][0]["relative_frequency"][2], first, delta=0.02 * first)
        results = iga_results.read(file)
        rms = results.table("rms_tip")
        np.testing.assert_allclose(rms["von_mises"][0], report["probes"][0]["von_mises"])
        psd = results.table("psd_tip")
        from_curve = np.sqrt(np.trapz(psd["acceleration_z"], psd["frequency"]))
        self.assertAlmostEqual(from_curve / rms["acceleration_z"][0], 1, delta=0.02)
        self.assertEqual(results["/surface/von_mises"].shape[0], 1)
        largest = results["/surface/displacement"][0, :, 2].max()
        self.assertAlmostEqual(largest / report["probes"][0]["relative"][2], 1, delta=0.01)
        text_report = self.command("random", text=text).stdout
        for words in ("1 sigma", "3 sigma", "effective mass of the modes", "residual"):
            self.assertIn(words, text_report)

    def test_transient(self):
        file = self.path / "transient.h5"
        (self.path / "shock.csv").write_text("time, factor\n0, 0\n0.05, 1\n0.2, 1\n")
        text = RUN.replace("force = [0, 0, 1]", 'force = [0, 0, 1]\nhistory = "shock.csv"') + "[transient]\nend = 0.2\nfields = [0.05, 0.2]\n"
        report = self.report("transient", text=text, more=("-o", file, "--force"))
        static = self.report("static", ("[harmonic]\nfrom = 100\nto = 3000\npoints = 50\n", ""))["statics"]["probes"][0]
        table = iga_results.read(file).table("probe_tip")
        self.assertAlmostEqual(table["displacement_z"][-1] / static["displacement"][2], 1, delta=1e-5)
        self.assertEqual(report["fields"], [0.05, 0.2])
        np.testing.assert_array_equal(iga_results.read(file)["/surface/steps"], [0.05, 0.2])
        support = iga_results.read(file).table("support_clamp")
        self.assertAlmostEqual(support["force_z"][-1], -1, delta=1e-5)

    def test_what_makes_no_sense_is_refused(self):
        self.refused("harmonic", "damping", "missing", changes=[("[damping]\nratio = 0.02", "")])
        self.refused("harmonic", "run.toml:", "given together with ratio", changes=[("ratio = 0.02", "ratio = 0.02\nstructural = 0.1")])
        self.refused("harmonic", "run.toml:", "'ratio' in [damping]", changes=[("ratio = 0.02", "ratio = 2")])
        self.refused("harmonic", "did you mean", "ratio", changes=[("ratio = 0.02", "ratoi = 0.02")])
        self.refused("random", "no power spectral density")
        self.refused("transient", "end is missing")
        self.refused("transient", "has no history", text=RUN + "[transient]\nend = 1\n")
        self.refused("static", "spectrum, phase, psd or history", changes=[("force = [0, 0, 1]", "force = [0, 0, 1]\nphase = 90")])
        self.refused("harmonic", "direction", "missing", text=RUN + "[base]\nspectrum = 1\n")
        self.refused("harmonic", "no range of frequencies", changes=[("from = 100\nto = 3000\n", "")])
        self.refused("transient", "structural damping belongs to harmonic motion",
                     changes=[("ratio = 0.02", "structural = 0.02"), ("force = [0, 0, 1]", "force = [0, 0, 1]\nhistory = 1")],
                     text=RUN + "[transient]\nend = 1\n")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
