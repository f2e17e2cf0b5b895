#!/usr/bin/python3
"""scripts/iga: whole runs on small parts, reuse of files, interrupts, refusals.

driver_runs_test.py ROOT BIN SHARED      the fork of SHARED/stl/fork is skipped where it is absent"""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

ROOT, BIN, SHARED = (Path(word).resolve() for word in sys.argv[1:4])
sys.path.insert(0, str(ROOT / "scripts"))
import parts  # noqa: E402
from igatools import iga_results  # noqa: E402

BRACKET = ROOT / "samples" / "14_bracket_from_step" / "bracket.step"
STEEL = ("--material", "steel", "--length-unit", "mm")
BAR = (40.0, 10.0, 8.0)
LEFT, RIGHT, UPPER = "body/5", "body/6", "body/2"  # faces of the bar at x = 0, at x = 40, at z = 8


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.bar = self.folder / "bar.stl"
        parts.write_boxes(self.bar, [((0, 0, 0), BAR)])

    def iga(self, *words, code=0, output="out"):
        """Report and process of a call."""
        command = [ROOT / "scripts" / "iga", *map(str, words), "-o", self.folder / output, "--bin", BIN, "--quiet"]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder)
        self.assertEqual(done.returncode, code, done.stderr)
        report = self.folder / output / "report.json"
        return (json.loads(report.read_text()) if report.exists() else None), done

    def quantity(self, report, name):
        return next(entry for entry in report["quantities"] if entry["name"] == name)


class Modes(Case):
    def test_a_bar(self):
        """Free bar: estimates hold beside a fine grid, the tolerance is reached; what is not reached is said with what it wants."""
        material = ("--E", 210e3, "--nu", 0.3, "--rho", 7.85e-9, "--length-unit", "mm")
        report, _ = self.iga("modes", self.bar, *material, "--modes", 4, "--tolerance", "0.1%")
        self.assertTrue(report["reached"])
        self.assertEqual(report["command"], "modes")
        self.assertLessEqual(max(report["errors"]), 1e-3)
        for key in ("material", "grids", "commands", "versions", "histories", "mass", "rigid_modes", "peak_memory"):
            self.assertIn(key, report)
        self.assertAlmostEqual(report["mass"], np.prod(BAR) * 7.85e-9, places=12)
        fine, _ = self.iga("modes", self.bar, *material, "--modes", 4, "--span-size", 1.5, output="fine")
        true = np.array(report["frequencies"]) / fine["frequencies"] - 1
        self.assertTrue((true < np.array(report["errors"]) + 1e-6).all(), (true, report["errors"]))
        report, done = self.iga("modes", self.bar, *material, "--modes", 2, "--tolerance", "0.0001%", "--max-time", 1, code=4)
        self.assertFalse(report["reached"])
        self.assertIn("NOT REACHED", done.stdout)
        self.assertIn("--max-time", done.stdout)

    def test_symmetry_is_no_singularity(self):
        """A support that lets a square face slide leaves the full order; a clamped face does not."""
        run = self.folder / "run.toml"
        for fixed, order in (("normal", 3), ("xyz", 1.09)):
            run.write_text(f'material = "steel"\n[[support]]\nregion = "{LEFT}"\nfixed = "{fixed}"\n')
            report, _ = self.iga("modes", self.bar, "--length-unit", "mm", "--region-angle", 30, "--run", run, "--modes", 2,
                                 "--span-size", 6)
            self.assertAlmostEqual(report["order_relied_on"], order)


class RunFiles(Case):
    """Analyses of a run file: numbers of igasolve's report followed over the grids, and a page."""

    HELD = f'''material = "steel"
[[support]]
name = "clamp"
region = "{LEFT}"
[[load]]
name = "end"
force = [-100, 0, 1]
region = "{RIGHT}"
history = [[0, 0], [1e-3, 1]]
[[probe]]
name = "tip"
position = [40, 5, 4]
'''

    def follow(self, command, text, *words, **more):
        run = self.folder / "run.toml"
        run.write_text(text)
        report, done = self.iga(command, self.bar, "--length-unit", "mm", "--region-angle", 30, "--span-size", 8, "--run", run, *words,
                                output=command, **more)
        if report:
            self.assertTrue((self.folder / command / "report.html").exists())
        return report, done

    def test_buckling(self):
        report, _ = self.follow("buckling", self.HELD + "[buckling]\nfactors = 1\n")
        factor = self.quantity(report, "factor 1")
        euler = np.pi**2 * 210e3 * 10 * 8**3 / 12 / (4 * 40**2)
        exact = euler / (1 + euler / (5 / 6 * 210e3 / 2.6 * 80)) / 100
        self.assertLess(abs(factor["value"] / exact - 1), factor["error"] + 0.03)  # ν, and a stocky bar

    def test_heat(self):
        report, _ = self.follow("heat", f'''material = "steel"
[[heat]]
name = "cold"
temperature = 20
region = "{LEFT}"
[[heat]]
name = "flame"
power = 100
region = "{RIGHT}"
[[probe]]
name = "middle"
position = [20, 5, 4]
''')
        self.assertAlmostEqual(self.quantity(report, "temperature at middle")["value"], 20 + 100 * 20 / (53.3 * 80), places=6)
        self.assertAlmostEqual(self.quantity(report, "power through cold")["value"], -100, places=6)

    def test_transient(self):
        report, _ = self.follow("transient", self.HELD + "[damping]\nratio = 0.05\n[transient]\nend = 2e-3\n[eigen]\nmodes = 3\n")
        for what in ("displacement", "acceleration", "von Mises"):
            self.assertGreater(self.quantity(report, f"largest {what} at tip")["value"], 0)

    def test_load_cases(self):
        report, _ = self.follow("static", self.HELD.replace("history = [[0, 0], [1e-3, 1]]\n", "") +
                                '[[case]]\nname = "once"\nloads = { end = 1 }\n[[case]]\nname = "twice"\nloads = { end = 2 }\n')
        once, twice = (self.quantity(report, f"{case}: displacement at tip") for case in ("once", "twice"))
        self.assertAlmostEqual(twice["value"] / once["value"], 2, places=9)
        self.assertAlmostEqual(twice["error"], once["error"], places=9)
        self.assertEqual([load["name"] for load in report["loads"]], ["once: end", "twice: end"])

    def test_what_is_missing(self):
        for command, text, words in (("harmonic", self.HELD, "has no [damping]"), ("heat", self.HELD, "has no [[heat]]"),
                                     ("random", "material = \"steel\"\n[damping]\nratio = 0.1\n", "has no [[probe]]")):
            _, done = self.follow(command, text, code=2)
            self.assertIn(words, done.stderr)


class FirstSpans(Case):
    def first(self, part):
        report, _ = self.iga("modes", part, *STEEL, "--modes", 1, "--max-time", 0.1)
        return report

    def test_thin_sheet(self):
        """Of thickness 1: a twelfth of its side would be 8; as small as some thousand functions allow, and it says what walls want."""
        parts.write_boxes(self.bar, [((0, 0, 0), (100, 80, 1.0))])
        report = self.first(self.bar)
        self.assertTrue(1 < report["span_sizes"][0] < 3, report["span_sizes"])
        self.assertLess(report["unknowns"][0], 25000)
        self.assertTrue(any("want spans of 0.5" in note for note in report["notes"]), report["notes"])

    def test_fork(self):
        fork = SHARED / "stl" / "fork" / "fork_gap_0.5.stl"
        if not fork.exists():
            self.skipTest(f"{fork} is absent")
        report = self.first(fork)
        # The usual span is half the smaller, as its gap asks for.
        self.assertTrue(3 < report["span_sizes"][0] < 5, report["span_sizes"])


class Static(Case):
    def test_a_cantilever(self):
        """Estimates hold beside finer grids; stress at the clamp has no limit, in the middle it is that of the beam."""
        words = ("static", self.bar, *STEEL, "--region-angle", 30, "--fix", LEFT, "--force", f"{RIGHT}=0,0,-100 N",
                 "--probe", "middle=20,5,7", "--probe", "clamp=0,5,8")
        report, done = self.iga(*words, "--tolerance", "2%")
        self.assertTrue(report["reached"])
        fine, _ = self.iga(*words, "--span-size", 1.8, output="fine")
        for name in ("strain energy", "largest displacement", "displacement at middle", "von Mises at middle"):
            told, truth = self.quantity(report, name), self.quantity(fine, name)["value"]
            self.assertLess(abs(told["value"] / truth - 1), told["error"] + 1e-4, name)
            self.assertLessEqual(told["error"], 0.02)
        # Bending moment 100 · 20, 3 above the middle.
        self.assertAlmostEqual(self.quantity(report, "von Mises at middle")["value"], 2000 * 3 / (10 * 8**3 / 12), delta=0.3)
        for name in ("von Mises at clamp", "largest von Mises"):
            entry = self.quantity(report, name)
            self.assertEqual((entry["value"], entry["error"]), (None, None))
            self.assertIn("the end of a support", entry["note"])
        self.assertIn("no limit", done.stdout)
        run = (self.folder / "out" / "loads.toml").read_text()
        self.assertIn("[0.0, 0.0, -100.0]", run)
        self.assertEqual(self.quantity(report, "strain energy")["unit"], "mJ")

    def test_names_of_cad(self):
        if not (BIN / "igaprep-cad").exists():
            self.skipTest("igaprep was built without OpenCASCADE, so that it reads no CAD files")
        report, _ = self.iga("static", BRACKET, "--material", "steel", "--fix", "wall side", "--pressure", "pin hole=1MPa", "--gravity",
                             "0,0,-1 g", "--force", "edge 19=0,0,-1", "--span-size", 6, "--max-time", 0.1)
        self.assertEqual([load["name"] for load in report["loads"]], ["force on edge 19", "pressure on pin hole", "gravity"])
        weight = report["loads"][2]["force"]
        self.assertAlmostEqual(weight[2] / (-28372.57 * 7.85e-9 * 9806.65), 1, delta=1e-3)
        self.assertAlmostEqual(report["mass"] / (28372.57 * 7.85e-9), 1, delta=1e-3)

    def test_run_file_with_a_line_load(self):
        """Energy under a force along a line has no limit, and the run file's own folder counts."""
        run = self.folder / "runs" / "line.toml"
        run.parent.mkdir()
        run.write_text('units = "mm"\nmaterials = "own.toml"\nmaterial = "putty"\n[[support]]\nplane = { point = [0, 0, 0], normal = '
                       '[1, 0, 0] }\nfixed = "xyz"\n[[load]]\nname = "edge"\nline = [[40, 0, 8], [40, 10, 8]]\nforce = [0, 0, -1]\n')
        (run.parent / "own.toml").write_text('[putty]\nE = 1e9\nnu = 0.3\nrho = 1000\nsource = "made up"\n')
        report, _ = self.iga("static", self.bar, "--length-unit", "mm", "--run", run, "--span-size", 6)
        entry = self.quantity(report, "strain energy")
        self.assertFalse(entry["has_limit"])
        self.assertIsNone(entry["error"])
        self.assertIn("'edge'", entry["note"])
        # A change of a file that the run file names is noticed.
        (run.parent / "own.toml").write_text('[putty]\nE = 2e9\nnu = 0.3\nrho = 1000\nsource = "made up"\n')
        stiffer, _ = self.iga("static", self.bar, "--length-unit", "mm", "--run", run, "--span-size", 6)
        self.assertAlmostEqual(self.quantity(stiffer, "strain energy")["value"] / entry["value"], 0.5, places=6)


class Hits(Case):
    def test_a_bar_falls_on_its_end(self):
        """Elastic bar, short enough to be checked by the wave that runs through it: force ρ c v A, contact 2 L / c, the
        centre of mass stopped after v L / (2 c)."""
        parts.write_boxes(self.bar, [((0, 0, 0), (10, 10, 40))])
        report, done = self.iga("drop", self.bar, *STEEL, "--height", "1m", "--span-size", 4, "--friction", 0)
        speed, wave = np.sqrt(2 * 9806.65 * 1000), np.sqrt(210e3 / 7.85e-9)
        self.assertAlmostEqual(report["speed"], speed, places=6)
        force, contact = self.quantity(report, "peak contact force"), self.quantity(report, "first to last touch")
        self.assertAlmostEqual(force["value"] / (7.85e-9 * wave * speed * 100), 1, delta=0.05)
        self.assertAlmostEqual(contact["value"] / (2 * 40 / wave), 1, delta=0.12)  # rows are 1/16 of it apart
        self.assertAlmostEqual(self.quantity(report, "stopping distance")["value"] / (speed * 40 / wave / 2), 1, delta=0.05)
        self.assertLess(report["energy_error"], 0.01)
        self.assertEqual(force["unit"], "N")
        self.assertEqual(len(report["grids"]), 2)
        self.assertIsNone(self.quantity(report, "largest von Mises")["error"])
        self.assertIn("stays elastic", done.stdout)
        self.assertTrue((self.folder / "out" / report["energies"]).read_text().startswith("time"))
        again, _ = self.iga("drop", self.bar, *STEEL, "--height", "1m", "--span-size", 4, "--friction", 0)
        self.assertEqual(again["quantities"], report["quantities"])
        self.assertEqual(again["reused_files"], 5)

    def test_direction_and_plasticity(self):
        report, _ = self.iga("impact", self.bar, *STEEL, "--speed", "60m/s", "--direction", "1,1,0", "--span-size", 5, "--max-time", 0.1,
                             "--yield-stress", "235MPa", "--end", "20us")
        self.assertGreater(self.quantity(report, "largest plastic strain")["value"], 0)
        results = iga_results.read(self.folder / "out" / report["results"])
        force = results.series("contact/part-floor")["force"]
        push = force[np.linalg.norm(force, axis=1).argmax()]
        self.assertLess(push @ [1, 1, 0], 0)

    def test_run_file(self):
        run = self.folder / "run.toml"
        run.write_text('[[bodies]]\nname = "bar"\nmodel = "nowhere.h5"\nvelocity = [0, 0, -5]\nmaterial = { law = "neo-hookean", E = 2, '
                       'nu = 0.3, rho = 1e-6 }\n[[rigid_bodies]]\nname = "table"\nshape = "plane"\nnormal = [0, 0, 1]\n'
                       'centre = [0, 0, -0.1]\n[[contacts]]\nbodies = ["bar", "table"]\n[time]\nend = 0.05\n')
        report, _ = self.iga("impact", self.bar, "--length-unit", "mm", "--run", run, "--span-size", 5)
        force = self.quantity(report, "peak force of bar-table")
        self.assertGreater(force["value"], 0)
        self.assertEqual(len(force["history"]), 2)
        self.assertIsNone(report["material"])
        _, done = self.iga("impact", self.bar, "--length-unit", "mm", "--run", run, "--body", "box", code=2)
        self.assertIn("no body 'box'; it has bar", done.stderr)


class Reuse(Case):
    def test_second_calls(self):
        """A second call uses what holds; a changed part, another option, or fewer modes than asked for are noticed."""
        words = ("modes", self.bar, *STEEL, "--span-size", 6, "--modes", 3)
        first, _ = self.iga(*words)
        self.assertEqual(first["reused_files"], 0)
        second, _ = self.iga(*words[:-1], 2)
        self.assertEqual(second["reused_files"], 5)
        self.assertEqual(second["frequencies"], first["frequencies"][:2])
        more, _ = self.iga(*words[:-1], 5)
        self.assertEqual(more["reused_files"], 3)  # the models
        other, _ = self.iga(*words, "--nu", 0.2)
        self.assertEqual(other["reused_files"], 3)
        fresh, _ = self.iga(*words, "--fresh")
        self.assertEqual(fresh["reused_files"], 0)
        parts.write_boxes(self.bar, [((0, 0, 0), (40, 10, 8.5))])
        changed, _ = self.iga(*words)
        self.assertEqual(changed["reused_files"], 0)
        self.assertNotEqual(changed["frequencies"][0], first["frequencies"][0])

    def test_interrupt(self):
        """Signals leave whole files and no process; what was done is told, and used by the next call."""
        command = [ROOT / "scripts" / "iga", "modes", self.bar, *STEEL, "--modes", "4", "--tolerance", "0.0001%", "-o", "out", "--bin",
                   BIN]
        for number in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen(list(map(str, command)), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.folder)
            while "grid 2:" not in (line := process.stderr.readline()):
                self.assertTrue(line, "the call ended before it was interrupted")
            time.sleep(0.2)
            process.send_signal(number)
            out, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 130, err)
            self.assertIn("interrupted", err)
            report = json.loads((self.folder / "out" / "report.json").read_text())
            self.assertTrue(report["interrupted"])
            self.assertGreaterEqual(len(report["grids"]), 2)
            self.assertIn("interrupted", " ".join(report["notes"]))
            for path in Path("/proc").glob("[0-9]*/cmdline"):
                try:
                    self.assertNotIn(f"{self.folder}".encode(), path.read_bytes() if int(path.parent.name) != os.getpid() else b"")
                except OSError:
                    continue  # it has ended
            self.assertEqual([path.name for path in (self.folder / "out").iterdir() if path.suffix in (".new", ".tmp")], [])
        self.assertGreaterEqual(report["reused_files"], 5)


class Refusals(Case):
    def refused(self, expected, *words):
        _, done = self.iga(*words, code=2)
        for text in expected:
            self.assertIn(text, done.stderr)
        self.assertNotIn("Traceback", done.stderr)

    def run_file(self, text):
        path = self.folder / "run.toml"
        path.write_text(text)
        return path

    def test_words(self):
        self.refused(["missing.stl: no such file"], "modes", "missing.stl", *STEEL)
        self.refused(["is a folder, expected a file"], "modes", self.folder, *STEEL)
        self.refused(["--material NAME"], "modes", self.bar)
        self.refused(["found abc, expected a share"], "modes", self.bar, *STEEL, "--tolerance", "abc")
        self.refused(["found 150%, expected a share"], "modes", self.bar, *STEEL, "--tolerance", "150%")
        self.refused(["found 0, expected a share"], "modes", self.bar, *STEEL, "--tolerance", "0")
        self.refused(["found -1, expected a number above 0"], "modes", self.bar, *STEEL, "--max-time=-1")
        self.refused(["length unit", "--length-unit mm", "longest side is 40"], "modes", self.bar, "--material", "steel")
        self.refused(['did you mean "steel"'], "modes", self.bar, "--material", "steal", "--length-unit", "mm")
        self.refused(["longest side", "40"], "modes", self.bar, *STEEL, "--span-size", 1000)

    def test_static(self):
        self.refused(["no support"], "static", self.bar, *STEEL)
        self.refused(["no load"], "static", self.bar, *STEEL, "--fix", LEFT)
        # Faces of an STL file are listed with where they lie; how to get more of them.
        self.refused(["no face, edge or vertex 'face 99'", "body/6  area 80, around (40, 5, 4), flat, normal (1, 0, 0)"], "static", self.bar, *STEEL, "--region-angle", 30, "--fix", "face 99",
                     "--force", f"{RIGHT}=0,0,1")
        self.refused(["body  area", "--region-angle 30"], "static", self.bar, *STEEL, "--fix", "face 1", "--gravity", "0,0,-1 g")
        self.refused(["supports do not hold the part", "translation along (0, 1, 0)"], "static", self.bar, *STEEL, "--region-angle", 30,
                     "--fix", f"{LEFT}=x", "--force", f"{RIGHT}=1,0,0")
        self.refused(["found 2 numbers"], "static", self.bar, *STEEL, "--fix", LEFT, "--force", f"{RIGHT}=0,1")
        self.refused(["run.toml", "[[load]]"], "static", self.bar, *STEEL, "--run",
                     self.run_file('[[support]]\nwhole_surface = true\nfixed = "xyz"\n'))
        self.refused(["run.toml", "material"], "static", self.bar, "--run", self.run_file("[[load]]\nwhole_surface = true\n"))
        self.refused(["run.toml", "line 2"], "static", self.bar, "--run", self.run_file('material = "steel"\n[[load]\n'))
        self.refused(["both given", "--fix"], "static", self.bar, *STEEL, "--run", self.run_file(""), "--fix", LEFT)
        self.refused(["[[bodies]]"], "static", self.bar, *STEEL, "--run", self.run_file('[[bodies]]\nmodel = "a.h5"\n'))
        (self.folder / "taken").write_text("")
        done = subprocess.run([ROOT / "scripts" / "iga", "modes", self.bar, *STEEL, "-o", self.folder / "taken" / "out", "--bin", BIN],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("cannot be made", done.stderr)
        # What igasolve finds in the run file is told with its line.
        self.refused(["run.toml:3", "colour"], "static", self.bar, *STEEL, "--run",
                     self.run_file("[[load]]\nforce = [0, 0, 1]\ncolour = 1\nwhole_surface = true\n"))

    def test_hits(self):
        self.refused(["found '1.2' without a unit"], "drop", self.bar, *STEEL, "--height", "1.2")
        self.refused(["furlong"], "drop", self.bar, *STEEL, "--height", "1furlong")
        self.refused(["no direction"], "drop", self.bar, *STEEL, "--height", "1m", "--direction", "0,0,0")
        self.refused(["--unit-system"], "drop", self.bar, "--E", 1, "--nu", 0.3, "--rho", 1, "--length-unit", "mm", "--height", "1m")
        self.refused(["--run", "--speed"], "impact", self.bar, *STEEL)
        self.refused(["run.toml", "[[bodies]]"], "impact", self.bar, "--run", self.run_file("[time]\nend = 1\n"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
