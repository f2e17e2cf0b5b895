#!/usr/bin/python3
"""Cells, links and copies of version 2.0 of the model file: the Python reader, the second solver and the lines printed in
schema/README.md on files whose right content is known in closed form.  usage: cells_test.py SOURCE_DIR"""
import re
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

SOURCE = Path(sys.argv[1])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "scripts" / "studies"), str(Path(__file__).resolve().parent)]
import boxes_model  # noqa: E402
import iga_reference_solver as reference  # noqa: E402
from igatools import iga_model  # noqa: E402

LOW, HIGH, SPANS = (0, 0, 0), (8, 6, 7.5), (4, 3, 3)
LOWER, UPPER = ((0.5, 0.5, 0.3), (7.5, 5.5, 3.2)), ((0.5, 0.5, 3.4), (7.5, 5.5, 7.1))  # a gap within a span
C, RHO = reference.isotropic(2.6, 0.3), 2.0


def readme_namespace():
    """What the lines about a mass matrix in schema/README.md define."""
    blocks = re.findall(r"```python\n(.*?)```", (SOURCE / "schema" / "README.md").read_text(), re.S)
    namespace = {}
    exec(next(block for block in blocks if "def mass_matrix" in block), namespace)
    return namespace


class Cells(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = Path(folder.name)
        for degree in (1, 2, 3):
            for name, boxes in (("both", [LOWER, UPPER]), ("lower", [LOWER]), ("upper", [UPPER])):
                boxes_model.write(cls.path / f"{name}{degree}.h5", boxes, LOW, HIGH, SPANS, (degree,) * 3)

    def test_two_plates_share_a_span_and_no_function(self):
        for degree in (1, 2, 3):
            model, alone = (iga_model.read(self.path / f"{name}{degree}.h5") for name in ("both", "lower"))
            report = iga_model.summary(model)
            self.assertEqual((report["split_spans"], report["components"]), (12, 2))
            self.assertEqual(iga_model.summary(alone)["components"], 1)
            self.assertEqual(iga_model.summary(alone)["copied_functions"], 0)
            component, _ = model.components()
            lower, upper = (np.unique(model["/cells/functions"][component == c]) for c in (0, 1))
            self.assertEqual(np.intersect1d(lower, upper).size, 0)
            self.assertLess(report["mass_fraction_error"], 1e-12)
            self.assertLess(report["vertex_position_error"], 1e-12)
            self.assertAlmostEqual(report["volume"], 7 * 5 * (2.9 + 3.7), delta=1e-11)

    def test_copies_add_up_to_the_spline(self):
        """Each copy is the function of its plate alone; together they are the B-spline on the solid."""
        for degree in (1, 2, 3):
            both, lower, upper = (iga_model.read(self.path / f"{name}{degree}.h5") for name in ("both", "lower", "upper"))
            found = sorted(zip(both["/functions/number"], both["/functions/mass_fraction"]))
            expected = sorted(pair for model in (lower, upper)
                              for pair in zip(model["/functions/number"], model["/functions/mass_fraction"]))
            np.testing.assert_array_equal([number for number, _ in found], [number for number, _ in expected])
            np.testing.assert_allclose([m for _, m in found], [m for _, m in expected], rtol=1e-12)
            for _, _, N in both.shape_functions():
                np.testing.assert_allclose(N.sum(1), 1, rtol=1e-13)

    def test_each_plate_vibrates_by_itself(self):
        for degree in (1, 2):
            values = {}
            for name in ("both", "lower", "upper"):
                report = reference.solve(self.path / f"{name}{degree}.h5", C, RHO, 6)
                self.assertEqual(report["rigid_modes"], 12 if name == "both" else 6)
                values[name] = np.square(report["frequencies"][report["rigid_modes"]:])
            expected = np.sort(np.concatenate([values["lower"], values["upper"]]))[:6]
            np.testing.assert_allclose(values["both"], expected, rtol=1e-8)

    def test_the_lines_in_the_readme(self):
        mass_matrix = readme_namespace()["mass_matrix"]
        for degree in (1, 2, 3):
            path = self.path / f"both{degree}.h5"
            model, M = iga_model.read(path), mass_matrix(path, RHO)
            self.assertAlmostEqual(M.sum() / (RHO * model["/quadrature/weights"].sum()), 1, delta=1e-13)
            np.testing.assert_allclose(M, reference.assemble(model, C, RHO)[1].toarray(), rtol=0, atol=1e-13 * M.max())

    def test_a_slit_that_ends(self):
        """A fork of three boxes: one body; copies only where the slit runs through the whole support."""
        root, tines = ((0, 0, 0), (3, 1, 5)), [((3, 0, 0), (12, 1, 2.4)), ((3, 0, 2.6), (12, 1, 5))]
        found = boxes_model.cells_of([root, *tines], (0, 0, 0), (12, 1, 5), (12, 1, 5), (2, 1, 2))
        self.assertEqual(len(found.span) - 60, 9)  # the middle layer of spans beyond the root
        self.assertEqual(boxes_model.components(len(found.span), found.links).max(), 0)
        numbers, copies = np.unique(found.number, return_counts=True)
        u, w = numbers % 14, numbers // (14 * 2)
        # Function (i, ., k) lives on the spans i - 2 … i along u and k - 2 … k along w.
        np.testing.assert_array_equal(copies > 1, (u - 2 >= 3) & (w >= 2) & (w <= 4))
        self.assertAlmostEqual(sum(found.area), 4 * 12 + (5 * 2 + 4.8 * 9), delta=1e-12)

    def test_what_the_reader_refuses(self):
        def put(path, index, value):
            def change(file):
                file[path][index] = value
            return change

        def version(file):
            file.attrs["format_version"] = "1.1"

        cases = [(put("/cells/span", 0, 1), "/cells/span"), (put("/cells/state", 0, 1), "/cells/state"),
                 (put("/cells/functions", (2, 3), 10**6), "/cells/functions"),
                 (put("/cells/functions", (2, 3), 0), "/cells/functions"),
                 (put("/functions/number", 5, 0), "/functions/number|/cells/functions"), (put("/links/cells", (0, 0), -1), "/links"),
                 (version, "1.x.*make the model again with igaprep")]
        for change, words in cases:
            with self.subTest(words):
                shutil.copyfile(self.path / "both2.h5", self.path / "changed.h5")
                with h5py.File(self.path / "changed.h5", "r+") as file:
                    change(file)
                with self.assertRaisesRegex(iga_model.FormatError, words):
                    iga_model.read(self.path / "changed.h5")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
