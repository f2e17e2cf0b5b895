#!/usr/bin/python3
"""Parts with gaps and holes: their surfaces; copies of functions in a perforated sheet against connectivity by sampling; and
frequencies of the sheet and of the slotted bracket beside tetrahedra.  usage: gap_study_test.py SOURCE_DIR BIN_DIR"""
import json
import subprocess
import sys
import tempfile
import unittest
from collections import Counter
from pathlib import Path

import numpy as np
from scipy import ndimage

SOURCE, BIN = Path(sys.argv[1]), Path(sys.argv[2])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "scripts" / "studies")]
import gap_parts  # noqa: E402
import gap_study  # noqa: E402
from igatools import iga_model  # noqa: E402
from igatools.extrusion import Prism, circle  # noqa: E402
from igatools.stl import read_stl, surface_figures, write_stl  # noqa: E402


class Surfaces(unittest.TestCase):
    def test_are_closed_and_enclose_the_prism(self):
        for make in gap_parts.PARTS.values():
            part = make()
            with self.subTest(part.name), tempfile.TemporaryDirectory() as folder:
                triangles = part.triangles()
                write_stl(Path(folder) / "part.stl", triangles)
                np.testing.assert_array_equal(read_stl(Path(folder) / "part.stl"), triangles)
                edges = Counter((tuple(triangle[k]), tuple(triangle[k - 2])) for triangle in triangles for k in range(3))
                self.assertEqual(set(edges.values()), {1})
                self.assertTrue(all((b, a) in edges for a, b in edges))
                self.assertAlmostEqual(surface_figures(triangles)[0] / part.prism.volume(), 1, delta=1e-12)

    def test_long_edges_beside_close_points_are_halved(self):
        """The hole's corners lie within the circle over the outline's long edge, so that Delaunay would cut across it."""
        prism = Prism([(0, 0), (10, 0), (10, 4), (0, 4)], 2, [circle((5, 0.6), 0.5, 8)])
        volume, centroid, _ = surface_figures(prism.triangles())
        self.assertAlmostEqual(volume, prism.volume(), delta=1e-12)
        self.assertAlmostEqual(volume, 2 * (40 - 4 * 0.5**2 * np.sin(np.pi / 4)), delta=1e-12)
        self.assertAlmostEqual(centroid[2], 1, delta=1e-12)

    def test_an_outline_the_wrong_way_round_is_refused(self):
        with self.assertRaisesRegex(ValueError, "anticlockwise"):
            Prism([(0, 0), (0, 1), (1, 1), (1, 0)], 1)


STEP = {True: 0.1, False: 0.25}  # mm, of the lattice, for B-splines with copies and for those without


class Lattice:
    """Points in and around the part of the perforated sheet that lies in a box of the grid, in steps along the sheet's own axes.
    `inner`: steps between two such points stay in the part; any path within the part runs through cells around `outer`."""

    def __init__(self, prism, low, high, step):
        corners = np.array([(low, high)[n >> d & 1][d] for n in range(8) for d in range(3)]).reshape(8, 3) @ gap_parts.TURN
        size = np.append(prism.loops[0].max(0), prism.height)
        first = np.maximum(corners.min(0), 0) - step
        axes = [np.arange(a, b + 2 * step, step) for a, b in zip(first, np.minimum(corners.max(0), size))]
        x, y, z = np.meshgrid(*axes, indexing="ij", sparse=True)
        self.points = np.stack(np.broadcast_arrays(x, y, z), -1) @ gap_parts.TURN.T
        half = step * 3**0.5 / 2
        self.inner = ((self.points > low) & (self.points < high)).all(-1)
        self.outer = ((self.points > low - half) & (self.points < high + half)).all(-1)
        for own, length in zip((x, y, z), size):
            self.inner &= (own > 0) & (own < length)
            self.outer &= (own > -half) & (own < length + half)
        for hole in prism.loops[1:]:
            centre, radius = hole.mean(0), np.linalg.norm(hole[0] - hole.mean(0))
            distance = np.hypot(x - centre[0], y - centre[1])
            self.inner &= distance**2 > radius**2 + step**2 / 4
            self.outer &= distance > radius * np.cos(np.pi / len(hole)) - half


def table(rows, columns, count):
    """Whether each pair of a row and one of `count` columns occurs: (rows, count)."""
    return np.bincount(rows * count + columns, minlength=count * (rows.max(initial=0) + 1)).reshape(-1, count) > 0


class Copies(unittest.TestCase):
    def test_of_a_perforated_sheet_are_those_of_its_connected_parts(self):
        part = gap_parts.perforated_sheet()
        with tempfile.TemporaryDirectory() as folder:
            stl, path = Path(folder) / "sheet.stl", Path(folder) / "sheet.h5"
            write_stl(stl, part.triangles())
            for degree, size in ((1, 2.2), (2, 1.7), (2, 3.5)):
                with self.subTest(f"p = {degree}, spans of {size} mm"):
                    subprocess.run([BIN / "igaprep", stl, "-o", path, "--degree", str(degree), "--span-size", str(size),
                                    "--gap-ends", "glued", "--force", "--quiet"], check=True, capture_output=True)
                    model = iga_model.read(path)
                    self.assertEqual(model.components()[1], 1)
                    self.compare(model, part.prism, degree)

    def compare(self, model, prism, degree):
        knots = [np.unique(model[f"/patch/knots_{d}"]) for d in "uvw"]
        counts = np.array(model.spans)
        cells = np.bincount(model["/cells/span"], minlength=counts.prod())
        first = np.searchsorted(model["/cells/span"], np.arange(counts.prod()))
        number, functions = model["/functions/number"], model["/cells/functions"]
        copies = np.bincount(number)
        self.assertGreater((copies > 1).sum(), 40)
        copied, single = (every[::len(every) // 40 + 1] for every in (np.flatnonzero(copies > 1), np.flatnonzero(copies == 1)))
        apart_for_sure = 0
        for f in [*copied, *single]:
            ijk = model.split_numbers(np.array([f]), model.functions)[0]
            low, high = np.maximum(ijk - degree, 0), np.minimum(ijk, counts - 1) + 1
            lattice = Lattice(prism, *(np.array([k[n] for k, n in zip(knots, at)]) for at in (low, high)),
                              STEP[copies[f] > 1])
            inner, parts = ndimage.label(lattice.inner)
            outer, blocks = ndimage.label(lattice.outer)
            span = [np.searchsorted(k, x, side="right") - 1 for k, x in zip(knots, lattice.points[lattice.inner].T)]
            span = span[0] + counts[0] * (span[1] + counts[1] * span[2])
            known = cells[span] == 1  # where a span holds several cells a point could be in any
            seen = functions[first[span[known]]]
            copy = seen[np.arange(len(seen)), np.argmax(number[seen] == f, axis=1)] - np.searchsorted(number, f)
            joined, apart = (table(label[lattice.inner][known], copy, copies[f]) for label in (inner, outer))
            self.assertLessEqual(joined.sum(1).max(), 1, f"function {f}: one connected part, several copies")
            self.assertLessEqual(apart.sum(0).max(), 1, f"function {f}: one copy of separate parts")
            apart_for_sure += apart.any(1).sum() > 1
        self.assertGreater(apart_for_sure, len(copied) / 6)


class Frequencies(unittest.TestCase):
    """Against the finer tetrahedra of gap_study.py, rad/ms: their own errors are some tenths of a per cent."""
    BRACKET = [4.5679, 6.1986, 8.7584, 16.886, 20.413, 21.431]
    SHEET = [10.245, 10.952, 24.960, 25.594, 31.856, 35.440]

    def errors(self, part, size):
        with tempfile.TemporaryDirectory() as folder:
            stl = Path(folder) / "part.stl"
            write_stl(stl, part.triangles())
            run = gap_study.splines(part, stl, 2, size, gap_study.parse(["--output", folder, "--bin", str(BIN)]))
        self.assertEqual(run["components"], 1)  # splines() insists on six rigid modes
        self.assertGreater(run["copied_functions"], 0)
        return np.array(run["omega"]) / (self.SHEET if part.name == "sheet" else self.BRACKET) - 1

    def compare(self, part, bounds):
        errors = [self.errors(part, size) for size in bounds]
        for size, error in zip(bounds, errors):
            self.assertLess(np.sqrt(np.mean(error**2)), bounds[size], f"{part.name}, spans of {size} mm")
            self.assertGreater(error.min(), -0.005)
        self.assertTrue((errors[1] < errors[0]).all(), f"{part.name}: {errors}")

    def test_of_the_bracket_fall_towards_those_of_tetrahedra(self):
        self.compare(gap_parts.bracket(), {20: 0.075, 14: 0.045})

    def test_of_the_perforated_sheet_fall_towards_those_of_tetrahedra(self):
        self.compare(gap_parts.perforated_sheet(), {5: 0.175, 2.5: 0.085})


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
