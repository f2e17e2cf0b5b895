#!/usr/bin/python3
"""Walls that the spans are too coarse for: warned of by igaprep, in the model file, beside the results of igasolve; and the
span sizes in the warnings do. Gaps are no reason to warn.   usage: coarse_spans_test.py IGAPREP IGASOLVE"""
import json
import math
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))
from parts import box_facets, write_stl  # noqa: E402

IGAPREP, IGASOLVE = sys.argv[1:3]


def ring(outer, inner, length, corners=48):
    """Facets of a tube."""
    def point(radius, i, z):
        angle = 2 * math.pi * i / corners
        return radius * math.cos(angle), radius * math.sin(angle), z

    for i in range(corners):
        o, n = [[point(r, k, z) for r in (outer, inner) for z in (0, length)] for k in (i, i + 1)]
        for a, b, c, d in ((o[0], n[0], n[1], o[1]), (n[2], o[2], o[3], n[3]), (o[0], o[2], n[2], n[0]), (o[1], n[1], n[3], o[3])):
            yield from ((a, b, c), (a, c, d))


class CoarseSpans(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def part(self, *bodies):
        write_stl(self.path / "part.stl", bodies)

    def prepare(self, *options):
        done = subprocess.run([IGAPREP, self.path / "part.stl", "-o", self.path / "part.h5", "--force", "--json", *options],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_a_tube_thinner_than_its_spans(self):
        self.part(ring(30, 28, 60))
        report = self.prepare("--span-size", "10")
        self.assertAlmostEqual(report["thinnest_wall"]["spans"], 0.2, delta=0.002)
        self.assertAlmostEqual(report["thinnest_wall"]["thickness"], 2, delta=0.02)
        self.assertGreater(report["thin_wall_volume_share"], 0.95)
        self.assertIsNone(report["narrowest_gap"])
        warnings = [w for w in report["warnings"] if "walls too thin" in w]
        self.assertEqual(len(warnings), 1, report["warnings"])
        # The same from the file that stands there, and beside every result.
        again = json.loads(subprocess.run([IGAPREP, self.path / "part.stl", "-o", self.path / "part.h5", "--json", "--span-size",
                                           "10"], capture_output=True, text=True).stdout)
        self.assertTrue(again["reused"])
        for key in ("thinnest_wall", "thin_wall_volume_share", "narrowest_gap", "warnings"):
            self.assertEqual(again[key], report[key])
        solved = subprocess.run([IGASOLVE, "eigen", self.path / "part.h5", "--E", "210", "--nu", "0.3", "--rho", "7.8e-6",
                                 "--modes", "1", "--json"], capture_output=True, text=True)
        self.assertEqual(solved.returncode, 0, solved.stderr)
        self.assertTrue(any(w.endswith(warnings[0]) for w in json.loads(solved.stdout)["warnings"]), solved.stdout)
        self.assertIn("walls too thin", solved.stderr)
        size = re.search(r"spans of at most ([\d.e-]+) would do", warnings[0])[1]
        self.assertAlmostEqual(float(size), 1, delta=0.02)
        fine = self.prepare("--span-size", size)
        self.assertIsNone(fine["thinnest_wall"])
        self.assertEqual(fine["warnings"], [])

    def test_a_gap_within_a_span_is_no_reason_to_warn(self):
        """The walls move on their own; the gap is told all the same."""
        self.part(box_facets((0, 0, 0), (9, 6, 3)), box_facets((0, 0, 3.6), (9, 6, 6.6)))
        report = self.prepare("--span-size", "1")
        self.assertAlmostEqual(report["narrowest_gap"]["width"], 0.6, delta=1e-9)
        self.assertAlmostEqual(report["narrowest_gap"]["spans"], 0.6, delta=1e-9)
        self.assertIsNone(report["thinnest_wall"])
        self.assertEqual(report["warnings"], [])

    def test_thick_parts_are_silent(self):
        self.part(box_facets((0, 0, 0), (10, 10, 10)))
        report = self.prepare("--spans", "4")
        self.assertEqual((report["thinnest_wall"], report["thin_wall_volume_share"], report["narrowest_gap"], report["warnings"]),
                         (None, 0, None, []))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
