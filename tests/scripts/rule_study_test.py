#!/usr/bin/python3
"""The study of quadrature rules on a turned cube: all rules of one grid, errors, tables, and what may be asked of it.
usage: rule_study_test.py SOURCE_DIR BIN_DIR"""
import csv
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, BIN = Path(sys.argv[1]), Path(sys.argv[2])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "scripts" / "studies"), str(Path(__file__).resolve().parent)]
import rule_cases  # noqa: E402
import rule_report  # noqa: E402
from parts import CUBE_FREQUENCIES, write_boxes  # noqa: E402

SCRIPT = SOURCE / "scripts" / "studies" / "rule_study.py"


class RuleStudyTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.out = Path(self.scratch.name) / "out"
        self.cube = Path(self.scratch.name) / "cube.stl"
        write_boxes(self.cube, [((0.03, 0.05, 0.07), (1.03, 1.05, 1.07))])

    def study(self, *words):
        return subprocess.run([SCRIPT, *words, "--output", self.out, "--bin", BIN], capture_output=True, text=True)

    def test_all_rules_of_a_cube(self):
        words = ["own", "--part", self.cube, "--span-size", "0.22", "--degrees", "2", "--modes", "8", "--E", "2.6"]
        done = self.study(*words)
        self.assertEqual(done.returncode, 0, done.stderr)
        runs = json.loads((self.out / "study.json").read_text())["runs"]
        self.assertEqual([(run["interior"], run["trimmed"]) for run in runs], list(rule_cases.every_rule(2)))
        found = {(run["interior"], run["trimmed"]): run for run in runs}
        for key, run in found.items():
            self.assertTrue(rule_report.is_rigid(run), key)
            self.assertEqual(run["points"], run["points_interior"] + run["points_trimmed"])
            error = 2 * np.pi * np.array(run["frequencies"]) / CUBE_FREQUENCIES[:8] - 1
            self.assertLess(abs(error).max(), 3e-3, key)
            self.assertGreater(run["dt_crit"], 0)
        exact = np.array(found["gauss", "nnls"]["frequencies"])
        np.testing.assert_allclose(found["ggq", "nnls"]["frequencies"], exact, rtol=1e-9)
        for trimmed in rule_cases.TRIMMED:
            inside = [found[interior, trimmed]["points_interior"] for interior in rule_cases.INTERIOR[2]]
            self.assertEqual(sorted(inside, reverse=True), inside)
            self.assertEqual(len({found[interior, trimmed]["points_trimmed"] for interior in rule_cases.INTERIOR[2]}), 1)
        rows = list(csv.DictReader((self.out / "study.csv").read_text().splitlines()))
        self.assertEqual(len(rows), len(runs))
        self.assertEqual(float(rows[0]["mean_error"]), 0)
        self.assertIn("| ggq-reduced | minimal |", (self.out / "study.md").read_text())
        again = self.study(*words, "--reuse")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertNotIn("…", again.stderr)
        self.assertEqual(again.stdout, done.stdout)

    def test_what_fails_is_told_and_does_not_end_the_study(self):
        self.cube.write_text("solid nothing\nendsolid nothing\n")
        done = self.study("own", "--part", self.cube, "--degrees", "2", "--rules", "gauss:nnls", "ggq:minimal")
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr.count("igaprep ended with exit code 2"), 2)
        self.assertEqual(done.stdout.count("igaprep ended with exit code 2"), 2)

    def test_wrong_words(self):
        self.assertIn("expected some of gauss:minimal", self.study("own", "--part", self.cube, "--rules", "ggq").stderr)
        self.assertEqual(self.study("own").returncode, 2)
        done = self.study("speed", "--shared", self.scratch.name)
        self.assertEqual(done.returncode, 2)
        self.assertIn("cube_rot.stl: no such file", done.stderr)

    def test_motions_without_stiffness_stand_out(self):
        run = {"rigid_modes": 6, "bodies": 1, "mechanisms": 0, "sturm_expected": 7, "sturm_found": 7}
        self.assertEqual(rule_report.rigid_words(run), "6")
        self.assertIn("**6**, 1 mechanisms", rule_report.rigid_words(run | {"mechanisms": 1}))
        self.assertIn("8 of 7", rule_report.rigid_words(run | {"sturm_found": 8}))
        self.assertIn("**6**", rule_report.rigid_words(run | {"bodies": 2}))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
