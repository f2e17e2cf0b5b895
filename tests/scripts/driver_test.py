#!/usr/bin/python3
"""scripts/iga: estimates of errors from grids, pairing of modes, and the pieces of the driver; no program runs.

driver_test.py ROOT"""
import io
import json
import sys
import tempfile
import time
import unittest
from pathlib import Path
from types import SimpleNamespace

import numpy as np

ROOT = sys.argv[1]
sys.path.insert(0, str(Path(ROOT) / "scripts"))
from igatools.driver import estimate, kept, loads, options, part, quantities, run_file, singular, units  # noqa: E402
from igatools.driver.explicit import moved_rigidly  # noqa: E402
from igatools.driver.grids import Grid, GridRun  # noqa: E402
from igatools.driver.programs import Failed, Programs, RunError  # noqa: E402
from igatools.driver.progress import Progress  # noqa: E402


def sequence(order, first=1.0, factor=0.1, grids=4, ratio=1.5):
    sizes = first / ratio ** np.arange(grids)
    return sizes, 1 + factor * sizes**order


def prism(outline):
    """Vertices and triangles of an outline, counter-clockwise, with a fan from its first corner, extruded by 1."""
    n = len(outline)
    vertices = np.array([(x, y, z) for z in (0, 1) for x, y in outline], float)
    facets = [(0, k + 1, k) for k in range(1, n - 1)] + [(n, n + k, n + k + 1) for k in range(1, n - 1)]
    for k in range(n):
        m = (k + 1) % n
        facets += [(k, m, n + m), (k, n + m, n + k)]
    return vertices, np.array(facets)


# Order that may be relied on, ratio of span sizes, limits, frequencies from coarse to fine.
MEASURED = [
    (estimate.REENTRANT_ORDER, 1.5, [3149.8, 5041.7, 5783.0, 7160.7],
     [[3491.05, 3321.10, 3247.01, 3215.53, 3180.79, 3166.93], [5600.33, 5317.39, 5196.21, 5112.74, 5080.00, 5063.06],
      [6119.09, 5932.22, 5842.34, 5808.42, 5795.38, 5789.89], [7522.78, 7317.86, 7241.99, 7215.15, 7185.47, 7174.25]]),
    (3, 1.5, [23576.345, 27928.84, 35942.6, 55304.15],
     [[23581.42, 23577.4, 23576.58, 23576.4, 23576.36], [27934.56, 27929.71, 27929.03, 27928.88, 27928.85],
      [36002.18, 35951.5, 35945.05, 35943.43, 35942.89], [55352.57, 55313.85, 55306.3, 55304.67, 55304.3]])]


class Estimates(unittest.TestCase):
    def test_known_orders(self):
        """Values 1 + c h^q: with that order the estimate is the error times the safety; with a lower one it is above it."""
        for order in (0.6, 1.0, 1.5, 2.2, 3.0):
            sizes, values = sequence(order)
            true = values[-1] - 1
            told = estimate.relative_error(sizes, values, order)
            self.assertAlmostEqual(told.order, order, places=6)
            self.assertAlmostEqual(told.error * values[-1] / true, estimate.SAFETY, places=6)
            self.assertGreater(estimate.relative_error(sizes, values, 0.9 * order).error, told.error)

    def test_a_change_that_is_small_by_chance(self):
        told = estimate.relative_error([1, 1 / 1.5, 1 / 2.25], [1.1, 1.03, 1.03], 1.09)
        self.assertGreater(told.error, 0.05)
        self.assertIsNone(told.order)

    def test_measured_sequences(self):
        """Frequencies of a bracket with sharp edges and of a bar, p = 2, beside their limits (tetrahedra, much finer grids): the
        estimate holds on 95 % of all grids and modes, and is below five times the error in the median."""
        for order, ratio, limits, histories in MEASURED:
            quotients = []
            for limit, values in zip(limits, histories):
                for n in range(2, len(values) + 1):
                    sizes = ratio ** -np.arange(n)
                    told = estimate.relative_error(sizes, values[:n], order).error
                    quotients.append(told / abs(values[n - 1] / limit - 1))
            self.assertGreater((np.array(quotients) > 1).mean(), 0.9)
            self.assertLess(np.median(quotients), 5)

    def test_reentrant_edges(self):
        """An L has one, a box and an open fillet of fine facets have none."""
        self.assertEqual(len(singular.reentrant_edges(*prism([(0, 0), (2, 0), (2, 1), (0, 1)]))), 0)
        found = singular.reentrant_edges(*prism([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]))
        self.assertEqual(sorted(map(tuple, found[0])), [(1, 1, 0), (1, 1, 1)])
        self.assertEqual(len(found), 1)
        turn = np.linspace(-np.pi / 2, -np.pi, 12)
        fillet = [(2 + np.cos(t), 2 + np.sin(t)) for t in turn]
        self.assertEqual(len(singular.reentrant_edges(*prism([(0, 0), (2, 0), *fillet, (0, 2)]))), 0)

    def test_two_grids_and_one(self):
        sizes, values = sequence(1.5, grids=2)
        self.assertAlmostEqual(estimate.relative_error(sizes, values, 2.0).error, (values[-1] - 1) / values[-1], places=12)
        self.assertIsNone(estimate.relative_error(sizes[:1], values[:1], 2.0).error)


class Pairing(unittest.TestCase):
    def setUp(self):
        rng = np.random.default_rng(7)
        self.weights = rng.uniform(0.5, 2, 200)
        base = np.linalg.qr(rng.normal(size=(600, 6)))[0].T.reshape(6, 200, 3)
        self.shapes = base / np.sqrt(self.weights)[None, :, None]

    def test_modes_that_change_places(self):
        order = [0, 2, 1, 3, 5, 4]
        partner, agreement = estimate.pair_modes(np.arange(6) + 10.0, self.shapes[order], np.arange(6) + 10.0, -self.shapes,
                                                 self.weights)
        self.assertEqual(partner.tolist(), np.argsort(order).tolist())
        self.assertGreater(agreement.min(), 0.99)

    def test_turned_multiplets(self):
        """Two modes of one frequency may come in any combination."""
        turned = self.shapes.copy()
        c, s = np.cos(0.8), np.sin(0.8)
        turned[2], turned[3] = c * self.shapes[2] + s * self.shapes[3], c * self.shapes[3] - s * self.shapes[2]
        frequencies = np.array([10, 12, 15, 15.001, 18, 21])
        partner, agreement = estimate.pair_modes(frequencies, self.shapes, frequencies, turned, self.weights)
        self.assertEqual(partner.tolist(), list(range(6)))
        self.assertGreater(agreement.min(), 0.99)

    def test_neighbours_that_change_places(self):
        frequencies = np.array([10, 11, 12, 12.1, 14, 15])
        partner, _ = estimate.pair_modes(frequencies, self.shapes, frequencies, self.shapes[[0, 1, 3, 2, 4, 5]], self.weights)
        self.assertEqual(partner.tolist(), [0, 1, 3, 2, 4, 5])

    def test_a_new_mode_has_no_partner(self):
        frequencies = np.arange(5) + 10.0
        coarse, fine = self.shapes[[0, 1, 2, 3, 5]], self.shapes[[0, 1, 4, 2, 3]]
        partner, _ = estimate.pair_modes(frequencies, coarse, frequencies, fine, self.weights)
        self.assertEqual(partner.tolist(), [0, 1, -1, 2, 3])


class Quantities(unittest.TestCase):
    """What the report says of a quantity from its values on grids."""
    SIZES = [1.0, 1 / 1.5, 1 / 2.25]

    def told(self, values, **more):
        return quantities.told(self.SIZES[:len(values)], list(values), quantities.Quantity("q", "N", values[-1], 1.0, **more))

    def test_the_larger_of_two_estimates_counts(self):
        values = sequence(1.0, grids=3)[1]
        own = self.told(values)["error"]
        safety = estimate.SOLUTION_SAFETY
        self.assertEqual(self.told(values, from_solution=own / 2 / safety)["error"], own)
        self.assertAlmostEqual(self.told(values, from_solution=2 * own / safety)["error"], 2 * own)

    def test_an_estimate_of_one_solution_alone_counts_double(self):
        self.assertAlmostEqual(estimate.error_of([1.0], [1.0], 3.0, 0.01).error, 0.01 * estimate.SOLUTION_SAFETY * estimate.ALONE)

    def test_no_limit(self):
        entry = self.told([1.0, 1.3, 1.7], no_limit="why", kind="stress")
        self.assertEqual((entry["value"], entry["error"], entry["counts"], entry["note"]), (None, None, False, "why"))
        self.assertEqual(entry["history"], [1.0, 1.3, 1.7])
        self.assertEqual(self.told([1.0, 1.3], no_limit="why")["value"], 1.3)

    def test_unknown_is_said(self):
        self.assertIn("needs 3 grids", self.told([1.0, 1.1], fewest_grids=3)["note"])
        self.assertIn("one direction", self.told([1.0, 1.2, 1.1], must_settle=True)["note"])
        self.assertIn("50 %", self.told([1.0, 2.0], largest_error=0.5)["note"])
        self.assertIsNotNone(self.told([1.0, 1.2, 1.25], must_settle=True)["error"])

    def test_small_beside_others(self):
        """The displacement of a held place has no relative error, and does not keep the tolerance from being reached."""
        values = {"tip": [1.0, 1.1, 1.11], "clamp": [1e-6, 3e-6, 1e-6]}
        grids = [Grid(size, None, None, {}, {}, [], {"quantities": [quantities.Quantity(name, "mm", history[k], 1.0, kind="displacement")
                                                                   for name, history in values.items()]})
                 for k, size in enumerate(self.SIZES)]
        tip, clamp = quantities.follow(grids)
        self.assertEqual(tip["history"], values["tip"])
        self.assertIsNone(clamp["error"])
        self.assertEqual(quantities.errors_that_count([tip, clamp]), [tip["error"]])

    def test_what_a_tolerance_would_want(self):
        """Ten times the accuracy at order one: a tenth of the span, a thousand times the time at power three."""
        run = object.__new__(GridRun)
        run.options, run.programs = SimpleNamespace(tolerance=0.01), SimpleNamespace(peak_memory_mib=1.0)
        run.grids = [Grid(2.0, None, None, {"wall_seconds": 1.0}, {"wall_seconds": 2.0}, [])]
        run.worst, run.TIME_POWER = lambda: 0.1, 3.0
        self.assertIn("spans of about 0.2, about 50 min and 9.8 GiB", run.needed(1.0))
        run.worst = lambda: 100.0
        self.assertIn("more than machines have", run.needed(1.0))
        run.worst = lambda: None
        self.assertIsNone(run.needed(1.0))

    def test_orders(self):
        for degree in (1, 2, 3):
            self.assertEqual(estimate.stress_order(degree, False), 1)
            self.assertEqual(estimate.displacement_order(degree, False), degree + 1)
            self.assertLessEqual(estimate.largest_order(degree, False), 2)
            for order in (estimate.stress_order, estimate.displacement_order, estimate.largest_order):
                self.assertLessEqual(order(degree, True), estimate.REENTRANT_ORDER)


class Lines(unittest.TestCase):
    """Where stress has no limit."""

    class Block(dict):
        """Model of a block 2 x 1 x 1 whose faces x = 0 and x = 2 are regions."""

        def __init__(self):
            vertices, triangles = prism([(0, 0), (2, 0), (2, 1), (0, 1)])
            x = vertices[triangles][:, :, 0]
            region = np.where((x == 0).all(1), 1, np.where((x == 2).all(1), 2, 0))
            super().__init__({"/surface/vertices": vertices, "/surface/triangles": triangles, "/surface/region": region})

        def texts(self, path):
            return ["sides", "left", "right"]

        def attribute(self, owner, name):
            return {"A": np.zeros(3), "B": np.ones(3), "spans": np.full(3, 4), "sliver_tolerance": 2e-5}[name]

    def test_support_ends(self):
        ends = singular.support_ends([{"region": "left", "fixed": "xyz"}], self.Block())
        self.assertEqual(len(ends), 4)
        self.assertTrue((ends[:, :, 0] == 0).all())
        # A face that may slide, with square edges: the part goes on by symmetry.
        self.assertEqual(len(singular.support_ends([{"region": "left", "fixed": "normal"}], self.Block())), 0)
        # It ends in the middle of a face.
        table = {"region": "left", "fixed": "normal", "box": [-1, -1, -1, 1, 0.5, 2]}
        ends = singular.support_ends([table], self.Block())
        self.assertTrue(len(ends) > 0 and (ends[:, :, 1] == 0.5).all(), ends)
        self.assertEqual(len(singular.support_ends([{"curve": "edge 1", "fixed": "xyz"}], self.Block())), 0)

    def test_distance(self):
        lines = np.array([[[0, 0, 0], [1, 0, 0]], [[5, 0, 0], [5, 1, 0]]], float)
        self.assertAlmostEqual(singular.distance(np.array([0.5, 0.3, 0.4]), lines), 0.5)
        self.assertAlmostEqual(singular.distance(np.array([2, 0, 0]), lines), 1)
        self.assertEqual(singular.distance(np.zeros(3), lines[:0]), np.inf)


class Words(unittest.TestCase):
    """What a user types."""

    def test_units(self):
        length = units.typed("1.2m", "length")
        self.assertEqual(length.within(units.SYSTEMS["t-mm-s"]), [1200])
        self.assertEqual(units.typed("1e1 in", "length").within(units.SYSTEMS["SI"]), [0.254])
        self.assertTrue(np.allclose(units.typed("0,0,-1 g", "acceleration", 3).within(units.SYSTEMS["kg-mm-ms"]), [0, 0, -9.80665e-3]))
        self.assertTrue(np.allclose(units.typed("36km/h", "speed").within(units.SYSTEMS["kg-mm-ms"]), [10]))
        self.assertTrue(np.allclose(units.typed("2,3,4kN", "force", 3).within(units.SYSTEMS["t-mm-s"]), [2000, 3000, 4000]))
        self.assertTrue(np.allclose(units.typed("1GPa", "stress").within(units.SYSTEMS["t-mm-s"]), [1000]))
        self.assertEqual(units.typed("7", "force").within(None), [7])
        with self.assertRaisesRegex(Failed, "--unit-system"):
            units.typed("7N", "force").within(None)
        for words, measure, count in (("1.2 furlong", "length", 1), ("abc", "length", 1), ("1,2", "force", 3), ("", "length", 1),
                                      ("1.2.3", "length", 1), ("1N,2N", "force", 2)):
            with self.assertRaises(ValueError):
                units.typed(words, measure, count)
        with self.assertRaisesRegex(ValueError, "without a unit"):
            units.typed("1.2", "length", must_have_unit=True)

    def test_negative_numbers(self):
        o = options.parse(["drop", "part.stl", "--material", "steel", "--height", "1m", "--direction", "-1,0,0"], "")
        self.assertEqual(o.direction.numbers, (-1, 0, 0))
        self.assertEqual(options.joined(["--probe", "-.5,0,1", "-o", "-1"]), ["--probe=-.5,0,1", "-o", "-1"])

    def test_supports_and_loads(self):
        self.assertEqual(loads.fix("face 12"), loads.Placed("face 12", "xyz"))
        self.assertEqual(loads.fix("bore=pinned"), loads.Placed("bore", "pinned"))
        with self.assertRaisesRegex(ValueError, "normal, pinned"):
            loads.fix("bore=glued")
        self.assertEqual(loads.placed("a=b=0,0,-1", "force", 3).place, "a=b")
        for words in ("face 3", "=0,0,1", "face 3=0,0"):
            with self.assertRaises(ValueError):
                loads.placed(words, "force", 3)
        self.assertEqual(loads.probe("tip=1,2,3"), ("tip", (1, 2, 3)))
        self.assertEqual(loads.probe("1,2,3"), ("1,2,3", (1, 2, 3)))

    def test_names_that_were_meant(self):
        names = ["wall side", "face 2", "face 30", "pin hole"]
        for typed, meant in (("wall", "wall side"), ("pin hle", "pin hole"), ("Face 2", "face 2"), ("face 4", None), ("bolt", None)):
            self.assertEqual(loads.nearest(typed, names), meant, typed)

    def test_flags_of_igaprep(self):
        o = options.parse(["modes", "a.stl", "--material", "steel", "--repair", "--wrap", "--region-angle", "30"], "")
        self.assertEqual(o.igaprep, ["--repair", "--wrap", "--region-angle", 30.0])

    def test_output_folder(self):
        for words, folder in (((), "box_modes"), (("--solid", "lid/upper 1"), "box_lid_upper_1_modes"), (("-o", "out"), "out")):
            o = options.parse(["modes", "box.step", "--material", "steel", *words], "")
            self.assertEqual(str(o.output), folder)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_kept(self):
        (self.folder / "model.h5").write_text("model")
        kept.Kept(self.folder).keep("model.h5", "key", {"points": 3}, asked=5)
        self.assertEqual(kept.Kept(self.folder).find("model.h5", "key", 5), {"points": 3})
        self.assertIsNone(kept.Kept(self.folder).find("model.h5", "other"))
        self.assertIsNone(kept.Kept(self.folder).find("model.h5", "key", 6))
        self.assertIsNone(kept.Kept(self.folder, may_reuse=False).find("model.h5", "key"))
        (self.folder / "model.h5").write_text("changed")
        self.assertIsNone(kept.Kept(self.folder).find("model.h5", "key"))
        (self.folder / "kept.json").write_text("{ half")
        self.assertEqual(kept.Kept(self.folder).entries, {})
        self.assertEqual([path.name for path in self.folder.glob("*.new")], [])

    def test_run_file_elsewhere(self):
        run, other = self.folder / "run.toml", self.folder / "elsewhere.h5"
        (self.folder / "curve.csv").write_text("0, 1\n")
        (self.folder / "sphere.h5").write_text("")
        run.write_text('# a comment\n[[bodies]]\nname = "cube"\nmodel = "cube.h5"\n'
                       "material = { yield_curve = 'curve.csv' }\n[[bodies]]\nname = \"sphere\"\nmodel = \"sphere.h5\"\n")
        settings = run_file.read(run)
        text = run_file.elsewhere(run, settings, {"cube.h5": other})
        lines = text.splitlines()
        self.assertEqual(lines[3], f"model = {json.dumps(str(other.resolve()))}")
        self.assertIn(json.dumps(str((self.folder / "curve.csv").resolve())), lines[4])
        self.assertEqual(lines[7], f"model = {json.dumps(str((self.folder / 'sphere.h5').resolve()))}")
        self.assertEqual(len(lines), len(run.read_text().splitlines()))
        before = run_file.content(run, settings)
        (self.folder / "curve.csv").write_text("0, 2\n")
        self.assertNotEqual(run_file.content(run, settings), before)


class Started(unittest.TestCase):
    """Programs that the driver starts."""

    def programs(self, script):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        for name in ("igaprep", "igasolve"):
            path = Path(folder.name) / name
            path.write_text("#!/bin/sh\n" + script)
            path.chmod(0o755)
        made = Programs(Path(folder.name), Progress(quiet=True), folder.name)
        self.addCleanup(made.log.close)
        return made

    def test_words_of_a_program_that_fails(self):
        with self.assertRaisesRegex(RunError, "^igaprep: part.stl: no such file\nmake it$") as caught:
            self.programs("echo reading >&2; echo 'igaprep: error: part.stl: no such file' >&2; echo 'make it' >&2; exit 2").run("igaprep")
        self.assertEqual(caught.exception.code, 2)
        with self.assertRaisesRegex(RunError, "igasolve ended with exit code 9: no output"):
            self.programs("exit 9").run("igasolve")
        self.assertEqual(self.programs("echo '{\"points\": 3}'").run("igaprep")["points"], 3)

    def test_deadline(self):
        """A program that runs beyond it is stopped."""
        programs = self.programs("echo $$ > \"$0.pid\"; exec sleep 60")
        programs.deadline = time.monotonic() + 0.5
        begin = time.monotonic()
        with self.assertRaisesRegex(Failed, "--max-time"):
            programs.run("igaprep")
        self.assertLess(time.monotonic() - begin, 30)
        number = (programs.binaries / "igaprep.pid").read_text().strip()
        self.assertFalse(Path(f"/proc/{number}").exists())

    def test_binaries_that_are_not_there(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(Failed, "has no igaprep"):
            Programs(Path(folder), Progress(quiet=True), folder)


class Pieces(unittest.TestCase):
    def test_first_span(self):
        prep = {"grid": {"span_size": [1.0, 1.0, 1.0]}, "volume": 500.0, "area": 500.0, "thinnest_wall": None,
                "thin_wall_volume_share": 0.0, "narrowest_gap": None}
        self.assertEqual(part.size(prep, 2, 6000), (1.0, None))
        wall = {"thickness": 1.6, "span_size": 0.8}
        self.assertEqual(part.size(prep | {"thinnest_wall": wall, "thin_wall_volume_share": 0.5}, 2, 6000)[0], 0.8)
        self.assertEqual(part.size(prep | {"thinnest_wall": wall, "thin_wall_volume_share": 0.1}, 2, 6000)[0], 1.0)
        self.assertEqual(part.size(prep | {"narrowest_gap": {"width": 0.7}}, 2, 6000)[0], 0.7)
        self.assertEqual(part.size(prep | {"narrowest_gap": {"width": 0.01}}, 2, 10000)[0], 0.5)
        size, note = part.size(prep | {"thinnest_wall": {"thickness": 0.02, "span_size": 0.01}, "thin_wall_volume_share": 1.0}, 2, 6000)
        self.assertAlmostEqual(part.functions(500, 500, 2, size), 6000, delta=1)
        self.assertIn("want spans of 0.01", note)

    def test_progress(self):
        """Plain lines where there is no terminal; one line in place, with the time left, where there is one."""
        stream = io.StringIO()
        progress = Progress(stream=stream)
        progress.begin("grid 1", 30)
        progress.say("done")
        self.assertEqual(stream.getvalue(), "done\n")
        stream = io.StringIO()
        stream.isatty = lambda: True
        progress = Progress(stream=stream)
        progress.begin("grid 2", 30)
        progress.stage("solving")
        self.assertIn("\rgrid 2: solving, 0 s, about 30 s left", stream.getvalue().replace("\x1b[K", ""))
        stream = io.StringIO()
        stream.isatty = lambda: True
        Progress(quiet=True, stream=stream).say("nothing")
        self.assertEqual(stream.getvalue(), "")

    def test_rigid_motion(self):
        rest = np.random.default_rng(3).normal(size=(50, 3))
        turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
        turn *= np.sign(np.linalg.det(turn))
        now = rest @ turn.T + [1, 2, 3]
        self.assertLess(np.abs(moved_rigidly(rest, now) - now).max(), 1e-12)
        now[0] += 0.5
        self.assertGreater(np.linalg.norm(moved_rigidly(rest, now) - now, axis=1).max(), 0.4)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
