#!/usr/bin/python3
"""Cells, links and copies that igaprep finds, against those of an independent computation for boxes; its picture of pieces.
usage: cells_of_igaprep_test.py SOURCE_DIR IGAPREP"""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import matplotlib.image
import numpy as np

SOURCE, IGAPREP = Path(sys.argv[1]), sys.argv[2]
sys.path[:0] = [str(SOURCE / "scripts"), str(Path(__file__).resolve().parent)]
import boxes_model  # noqa: E402
from igatools import iga_model  # noqa: E402
from parts import write_boxes  # noqa: E402

PLATES = [((0.5, 0.5, 0.3), (7.5, 5.5, 3.2)), ((0.5, 0.5, 3.4), (7.5, 5.5, 7.1))]
FORK = [((0.3, 0.2, 0.4), (3.1, 1.8, 5.2)), ((3.1, 0.2, 0.4), (11.7, 1.8, 2.35)), ((3.1, 0.2, 2.7), (11.7, 1.8, 5.2))]
RACK = [((0.3, 0.3, 0.2), (1.4, 2.8, 6.3))] + [((1.4, 0.3, z), (5.6, 2.8, z + 0.3)) for z in (0.2, 0.7, 1.2, 2.9, 4.3, 5.1, 6.0)]
CASES = [("plates", PLATES, (8, 6, 7.5), (4, 3, 3)), ("fork", FORK, (12, 2, 6), (12, 2, 6)),
         ("rack", RACK, (6, 3, 7), (4, 2, 4)),  # four shelves in one span
         ("crumbs", [((x, y, 0.2), (x + 0.3, y + 0.3, 1.7)) for x in (0.1, 0.6, 1.1) for y in (0.1, 0.6, 1.1)],
          (2, 2, 2), (1, 1, 2))]


class CellsOfIgaprep(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = Path(folder.name)

    def model(self, name, boxes, high, spans, degree):
        write_boxes(self.path / f"{name}.stl", boxes)
        touching = ["--repair"] if name in ("fork", "rack") else []  # boxes that share faces become one body
        subprocess.run([IGAPREP, self.path / f"{name}.stl", "-o", self.path / f"{name}.h5", "--force", "--quiet", *touching, "--gap-ends", "glued",
                        "--degree", str(degree), "--box", *map(str, (0, 0, 0, *high)), "--spans", *map(str, spans)],
                       check=True, capture_output=True)
        return iga_model.read(self.path / f"{name}.h5")

    def test_cells_links_and_copies(self):
        for name, boxes, high, spans in CASES:
            for degree in (1, 2, 3):
                with self.subTest(f"{name}, p = {degree}"):
                    model = self.model(name, boxes, high, spans, degree)
                    expected = boxes_model.cells_of(boxes, (0, 0, 0), high, spans, (degree,) * 3)
                    weights, N = model["/quadrature/weights"], len(model["/cells/span"])
                    volume = model["/cells/volume_fraction"] * expected.h.prod()
                    np.testing.assert_allclose(np.bincount(model.point_cells(), weights, N)[model["/cells/state"] == 2],
                                               volume[model["/cells/state"] == 2], rtol=1e-10)
                    self.same(model, volume, expected)

    def same(self, model, volume, expected):
        """Pieces that see the same functions may be one cell: both are told by the functions that they see."""
        found = self.by_copy(model["/cells/span"], model["/cells/functions"], model["/functions/number"], volume)
        known = self.by_copy(expected.span, expected.functions, expected.number, expected.volume)
        self.assertEqual([key for key, _ in found], [key for key, _ in known])
        np.testing.assert_allclose([v for _, v in found], [v for _, v in known], rtol=1e-9)
        self.assertEqual(model.components()[1], boxes_model.components(len(expected.span), expected.links).max() + 1)

    @staticmethod
    def by_copy(span, functions, number, volume):
        """(B-spline, spans of the copy), volume of the copy's cells in them: sorted."""
        cells = [np.flatnonzero((functions == f).any(1)) for f in range(len(number))]
        return sorted(((int(number[f]), tuple(np.unique(span[own]).tolist())), round(volume[own].sum(), 9))
                      for f, own in enumerate(cells))

    def test_the_picture_of_pieces(self):
        self.model("fork", *CASES[1][1:], 2)
        picture = self.path / "pieces.png"
        done = subprocess.run([sys.executable, SOURCE / "scripts" / "render.py", "--pieces", self.path / "fork.h5", "-o", picture],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        pixels = matplotlib.image.imread(picture)[150:-150, :, :3]
        r, g, b = (pixels[..., c] for c in range(3))
        for words, share in (("one side, red", (r > b + 0.25) & (r > g + 0.25)), ("other side, blue", b > r + 0.25),
                             ("the rest, grey", (np.abs(r - b) < 0.1) & (r > 0.3) & (r < 0.9))):
            self.assertGreater(np.mean(share), 0.005, words)

    def test_bodies_have_colours_of_their_own(self):
        self.model("plates", *CASES[0][1:], 2)
        subprocess.run([sys.executable, SOURCE / "scripts" / "render.py", "--pieces", self.path / "plates.h5"], check=True,
                       capture_output=True)
        pixels = matplotlib.image.imread(self.path / "plates_pieces.png")[150:-150, :, :3]
        pale_blue = (pixels[..., 2] > pixels[..., 0] + 0.1) & (pixels[..., 2] < pixels[..., 0] + 0.25) & (pixels[..., 0] > 0.4)
        self.assertGreater(np.mean(pale_blue), 0.02)

    def test_what_cannot_be_drawn_is_said_in_one_line(self):
        (self.path / "text.h5").write_text("no HDF5")
        done = subprocess.run([sys.executable, SOURCE / "scripts" / "render.py", "--pieces", self.path / "text.h5"],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
