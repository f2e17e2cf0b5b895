#!/usr/bin/python3
"""The report page: how arrays are packed, which lines and vertices it holds, what its tabs say.

usage: report_test.py SOURCE_DIR"""
import json
import re
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

SOURCE = Path(sys.argv[1])
sys.path.insert(0, str(SOURCE / "scripts"))
from igatools import report  # noqa: E402
from igatools.report import answer, arrays, convergence, energies, files, page, plots, spans, tables, thinning, threed, units  # noqa: E402

MATERIAL = {"name": "steel", "unit_system": "t-mm-s", "E": 210e3, "nu": 0.3, "rho": 7.85e-9}
COMMON = {"part": "bar.step", "material": MATERIAL, "tolerance": 0.01, "reached": True, "length_unit": "mm", "mass": 1e-3,
          "span_sizes": [9, 6, 4], "unknowns": [100, 300, 900], "seconds": 2.5, "peak_memory": 100.0, "notes": [], "findings": [],
          "warnings": [], "model": "model_3.h5", "results": "results_3.h5", "commands": ["igaprep bar.step -o model_3.h5"],
          "order_relied_on": 1.09, "versions": {"igaprep": "1.0", "igasolve": "1.0"}}
MODES = COMMON | {"command": "modes", "frequencies": [100.0, 200.0], "errors": [0.005, None], "orders": [2.0, None],
                  "agreements": [1.0, None], "histories": [[110.0, 102.0, 100.0], [200.0]], "rigid_modes": 6, "complete": True}
STATIC = COMMON | {"command": "static", "quantities": [
    {"name": "strain energy", "unit": "mJ", "value": 2.0, "error": 0.004, "order": 1.5, "history": [1.8, 1.95, 2.0]},
    {"name": "von Mises at tip", "unit": "MPa", "value": None, "error": None, "order": None, "history": [1.0, 2.0, 4.0],
     "note": "grows <without> bound", "has_limit": False, "counts": False}],
    "supports": [{"name": "wall", "force": [0.0, 1e-14, 100.0], "area": 50.0}],
    "loads": [{"name": "pin", "force": [0.0, 0.0, -100.0], "area": 0}]}


def written(entries, folder=None):
    """Text of the page of a report."""
    with tempfile.TemporaryDirectory() as empty:
        return page.html(entries, Path(folder or empty))


def sphere(count):
    """Vertices and triangles of a unit sphere, outward."""
    turn, rise = np.meshgrid(2 * np.pi * np.arange(count) / count, np.pi * (np.arange(count - 1) + 1) / count, indexing="ij")
    ring = np.stack([np.sin(rise) * np.cos(turn), np.sin(rise) * np.sin(turn), np.cos(rise)], -1).reshape(-1, 3)
    number = np.arange(len(ring)).reshape(count, count - 1)
    a, b = number, np.roll(number, -1, axis=0)
    quads = [np.stack([a[:, :-1], a[:, 1:], b[:, 1:]], -1), np.stack([a[:, :-1], b[:, 1:], b[:, :-1]], -1)]
    top, bottom = np.full(count, len(ring)), np.full(count, len(ring) + 1)
    caps = [np.stack([top, a[:, 0], b[:, 0]], -1), np.stack([bottom, b[:, -1], a[:, -1]], -1)]
    return np.concatenate([ring, [[0, 0, 1], [0, 0, -1]]]), np.concatenate([q.reshape(-1, 3) for q in quads + caps])


def volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6


class Arrays(unittest.TestCase):
    def test_integers_come_back(self):
        for largest in (0, 5, 65535, 65536, 2**31):
            values = np.array([[0, largest], [largest // 2, 1]])
            packed = json.loads(json.dumps(arrays.integers(values)))
            self.assertEqual(packed["kind"], "uint16" if largest < 65536 else "uint32")
            self.assertTrue((arrays.unpacked(packed) == values).all())

    def test_reals_come_back_to_their_scale(self):
        values = np.random.default_rng(3).normal(size=(200, 3)) * 1e-5
        found = arrays.unpacked(arrays.reals(values))
        self.assertLess(np.abs(found - values).max(), np.abs(values).max() / 65000)
        self.assertTrue((arrays.unpacked(arrays.reals(np.zeros((4, 3)))) == 0).all())
        self.assertEqual(arrays.unpacked(arrays.reals(np.zeros((0, 3)))).shape, (0, 3))

    def test_refusals(self):
        with self.assertRaisesRegex(ValueError, "finite"):
            arrays.reals([1.0, np.nan])
        with self.assertRaisesRegex(ValueError, "-2"):
            arrays.integers([1, -2])


class Spans(unittest.TestCase):
    def lines(self, state):
        """Of states by u, v, w."""
        class Model(dict):
            spans = list(state.shape)
        return spans.lines(Model({"/spans/state": state.transpose().ravel()}))

    def length(self, lines):
        return np.abs(lines[:, 1] - lines[:, 0]).sum()

    def test_one_span_has_twelve_edges(self):
        state = np.zeros((3, 4, 5), int)
        state[1, 2, 3] = spans.INTERIOR
        interior, trimmed = self.lines(state)
        self.assertEqual((len(interior), len(trimmed)), (12, 0))
        self.assertEqual(interior.reshape(-1, 3).min(0).tolist(), [1, 2, 3])
        self.assertEqual(interior.reshape(-1, 3).max(0).tolist(), [2, 3, 4])

    def test_rows_become_one_line_and_trimmed_spans_own_shared_edges(self):
        state = np.full((4, 1, 1), spans.INTERIOR)
        interior, _ = self.lines(state)
        self.assertEqual((len(interior), self.length(interior)), (4 + 5 * 4, 4 * 4 + 5 * 4))
        state[3] = spans.TRIMMED
        interior, trimmed = self.lines(state)
        self.assertEqual((self.length(interior), self.length(trimmed)), (4 * 3 + 3 * 4, 12))


class Thinning(unittest.TestCase):
    def test_small_surfaces_stay(self):
        vertices, triangles = sphere(12)
        kept, same = thinning.thinned(vertices, triangles, 10_000)
        self.assertTrue((kept == np.arange(len(vertices))).all() and (same == triangles).all())

    def test_sphere(self):
        vertices, triangles = sphere(150)
        kept, fewer = thinning.thinned(vertices, triangles, 3000)
        self.assertLessEqual(len(kept), 3000)
        self.assertGreater(len(kept), 2000)
        self.assertEqual(len(np.unique(kept)), len(kept))
        self.assertEqual((fewer.min(), fewer.max()), (0, len(kept) - 1))
        self.assertAlmostEqual(volume(vertices[kept], fewer) / volume(vertices, triangles), 1, delta=0.02)

    def test_sharp_edges_and_thin_walls_stay(self):
        """A plate of 1 x 1 x 0.01, far thinner than the cells: both sides and all corners are kept."""
        n = 80
        x, y = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
        number = np.arange(n * n).reshape(n, n)
        a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
        top = np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
        rim = np.concatenate([number[0, :], number[1:, -1], number[-1, -2::-1], number[-2:0:-1, 0]])
        after = np.roll(rim, -1)
        sides = np.concatenate([np.stack([rim, after, after + n * n], -1), np.stack([rim, after + n * n, rim + n * n], -1)])
        vertices = np.concatenate([np.stack([x, y, np.full_like(x, z)], -1).reshape(-1, 3) for z in (0.01, 0.0)])
        triangles = np.concatenate([top, top[:, ::-1] + n * n, sides])
        self.assertAlmostEqual(volume(vertices, triangles), 0.01)
        kept, fewer = thinning.thinned(vertices, triangles, 1000)
        self.assertAlmostEqual(volume(vertices[kept], fewer), 0.01, delta=1e-4)
        self.assertEqual(np.ptp(vertices[kept], axis=0).tolist(), [1, 1, 0.01])


class Texts(unittest.TestCase):
    def test_modes(self):
        text = answer.html(MODES)
        for words in ("Frequency [Hz]", "± 0.5 %", "99.5 … 100.5", "unknown", "none is missing", "E = 210000 MPa", "9, 6, 4 mm"):
            self.assertIn(words, text)

    def test_static(self):
        text = answer.html(STATIC)
        for words in ("grows &lt;without&gt; bound", "has no limit", "the tolerance does not apply", "Force z [N]", "Support wall"):
            self.assertIn(words, text)
        self.assertNotIn("e-14", text)

    def test_units_only_where_known(self):
        self.assertEqual(units.of_report({"length_unit": "unspecified"})["length"], "")
        self.assertNotIn("[", answer.modes(MODES | {"material": None}))
        self.assertIn("[kHz]", answer.modes(MODES | {"material": {"unit_system": "kg-mm-ms"}}))

    def test_convergence(self):
        curves = convergence.curves(MODES)
        self.assertEqual([curve.name for curve in curves], ["Mode 7"])
        np.testing.assert_allclose(curves[0].points, [(6, 0.08), (4, 0.02)])
        self.assertEqual(curves[0].estimate, (4, 0.005))
        self.assertIsNone(convergence.html(MODES | {"span_sizes": [4]}))
        self.assertIn("has", convergence.html(STATIC))

    def test_what_comes_from_files_is_no_markup(self):
        evil = '<script>alert("1")</script>{{data}}'
        text = written(MODES | {"part": evil, "warnings": [evil], "commands": [evil], "notes": [evil]})
        self.assertNotIn(evil, text)
        self.assertGreaterEqual(text.count("&lt;script&gt;"), 4)

    def test_tabs(self):
        tabs = lambda entries: re.findall(r'role="tab" id="tab-(\w+)"', written(entries))  # noqa: E731
        self.assertEqual(tabs(MODES), ["answer", "view", "convergence", "warnings", "repeat"])
        self.assertEqual(tabs(MODES | {"span_sizes": [4]}), ["answer", "view", "warnings", "repeat"])
        self.assertEqual(tabs(STATIC | {"energies": "missing.csv"})[3], "energies")

    def test_warnings_are_told_from_notes(self):
        for more, name in (({}, "Notes (0)"), ({"findings": ["a"], "notes": ["b"]}, "Notes (2)"), ({"warnings": ["a"]}, "Warnings (1)"),
                           ({"warnings": ["a"], "notes": ["b"]}, "Warnings (1), Notes (1)")):
            self.assertIn(f">{name}</button>", written(MODES | more))

    def test_numbers(self):
        for value, text in ((120270.4, "120270"), (1234567.0, "1234600"), (61495.2, "61495"), (2.3303e-5, "2.3303e-05"), (1e9, "1e+09")):
            self.assertEqual(tables.number(value), text)
        self.assertEqual([tables.percent(share) for share in (2.0, 0.0272, None)], ["200 %", "2.7 %", "unknown"])
        self.assertIn("<dd>1.4952 kg</dd>", answer.asked(MODES | {"mass": 0.0014952}))

    def test_verdicts(self):
        self.assertIn("Tolerance of 1 % reached", page.verdict(MODES))
        self.assertIn("not reached", page.verdict(MODES | {"reached": False}))
        self.assertIn("No tolerance", page.verdict(MODES | {"tolerance": None}))

    def test_a_report_with_little_in_it(self):
        """Of what older versions wrote."""
        old = {key: MODES[key] for key in ("part", "frequencies", "errors", "orders", "agreements", "histories", "span_sizes")}
        self.assertIn("100", written(old))

    def test_nothing_is_fetched(self):
        text = written(MODES)
        self.assertEqual(re.findall(r'(?:src|href)="(?!data:)[^"]*"|url\([^)]*\)|@import', text), [])


class MissingFiles(unittest.TestCase):
    def test_model_and_results(self):
        self.assertIn("The model file model_3.h5 was not found", written(MODES))

    def test_library(self):
        self.assertIsNone(threed.library([Path("/nowhere/three.js")]))
        with mock.patch.object(threed, "PLACES", []):
            text = written(MODES)
        self.assertIn("apt-get install libjs-three", text)
        self.assertIn("100", text)

    def test_files_are_found_where_the_folder_went(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "model.h5").touch()
            for name in ("model.h5", "elsewhere/model.h5", "/elsewhere/model.h5"):
                self.assertEqual(files.located(Path(folder), name), Path(folder) / "model.h5")
            self.assertIsNone(files.located(Path(folder), "results.h5"))

    def test_rewriting(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(report.NoReport, "report.json: no such file"):
                report.rewrite_page(folder)
            (Path(folder) / "report.json").write_text("{")
            with self.assertRaisesRegex(report.NoReport, "is not JSON"):
                report.rewrite_page(folder)
            (Path(folder) / "report.json").write_text(json.dumps(STATIC))
            self.assertIn("strain energy", report.rewrite_page(folder).read_text())


class Energies(unittest.TestCase):
    HEADING = "time [time],dt [time],energy_error,internal [force*mm],kinetic [force*mm],eroded [force*mm]\n"

    def page_of(self, table):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "energy.csv").write_text(table)
            return energies.html({"energies": "energy.csv", "energy_error": 1e-4, "material": MATERIAL}, Path(folder))

    def test_curves(self):
        rows = "".join(f"{0.01 * k},0.01,0,{k},{2000 - k},0\n" for k in range(2000))
        text = self.page_of(self.HEADING + rows)
        self.assertEqual(re.findall(r'<g class="curve c\d" data-curve="\d"><title>(\w+)', text), ["internal", "kinetic"])
        for words in ("Energy [mJ]", "Time [s]", "of 2,000 times", "1999", "balance: 0.01 %"):
            self.assertIn(words, text)

    def test_refusals(self):
        self.assertIn("line 3: could not convert", self.page_of(self.HEADING + "0,0,0,0,0,0\n0,0,0,x,0,0\n"))
        self.assertIn("line 2: found 2 numbers, expected 6", self.page_of(self.HEADING + "0,0\n"))
        self.assertIn("found 0 rows", self.page_of(self.HEADING))
        self.assertIn("line 1: expected the names", self.page_of(""))


class Plots(unittest.TestCase):
    def test_axes(self):
        axis = plots.log_axis("", [0.011, 0.9])
        self.assertEqual([round(t, 6) for t in axis.ticks], [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1])
        self.assertAlmostEqual(axis.share(np.sqrt(axis.low * axis.high)), 0.5)
        axis = plots.linear_axis("", [-1e-9, 31])
        self.assertEqual((axis.low, axis.high, axis.ticks[:2]), (0, 35, [0, 5]))
        self.assertLess(plots.linear_axis("", [3.0, 3.0]).low, 3)
        axis = plots.linear_axis("", [0, 4.4e-5], ends_at_ticks=False)
        self.assertEqual((axis.high, len(axis.ticks)), (4.4e-5, 5))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
