#!/usr/bin/python3
"""Sections of closed surfaces: their areas are known.  usage: sections_test.py SOURCE_DIR"""
import sys
import unittest
from pathlib import Path

import numpy as np

SOURCE = Path(sys.argv[1])
sys.path.insert(0, str(SOURCE / "scripts"))
from igatools import sections  # noqa: E402

QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]  # corners numbered x fastest


def boxes(*corners):
    """Vertices and triangles of boxes (low, high); one whose corners are swapped is turned inside out: a cavity."""
    vertices, triangles = [], []
    for low, high in corners:
        for a, b, c, d in QUADS:
            triangles += [[len(vertices) + i for i in triple] for triple in ((a, b, c), (a, c, d))]
        vertices += [[(low, high)[n >> axis & 1][axis] for axis in range(3)] for n in range(8)]
    return np.array(vertices, float), np.array(triangles)


def torus(ring, tube, count):
    a, b = np.meshgrid(2 * np.pi * np.arange(count) / count, 2 * np.pi * np.arange(count) / count, indexing="ij")
    vertices = np.stack([(ring + tube * np.cos(b)) * np.cos(a), (ring + tube * np.cos(b)) * np.sin(a), tube * np.sin(b)], -1)
    number = np.arange(count * count).reshape(count, count)
    p, q = number, np.roll(number, -1, axis=0)
    r, s = np.roll(q, -1, axis=1), np.roll(p, -1, axis=1)
    return vertices.reshape(-1, 3), np.concatenate([np.stack([p, q, r], -1).reshape(-1, 3), np.stack([p, r, s], -1).reshape(-1, 3)])


class SectionsTest(unittest.TestCase):
    def area(self, surface, place, normal):
        vertices, triangles = sections.section(*surface, np.array(place, float), normal)
        self.assertLess(np.abs((vertices - place) @ np.asarray(normal, float)).max(initial=0), 1e-12)
        return sections.area(vertices, triangles)

    def test_box_straight_and_oblique(self):
        cube = boxes(((0, 0, 0), (1, 1, 1)))
        self.assertAlmostEqual(self.area(cube, (0.3, 0.4, 0.6), (0, 0, 1)), 1, delta=1e-9)
        self.assertAlmostEqual(self.area(cube, (0.5, 0.5, 0.5), (1, 1, 0)), 2**0.5, delta=1e-9)
        self.assertAlmostEqual(self.area(cube, (0.5, 0.5, 0.5), (1, 1, 1)), 0.75 * 3**0.5, delta=1e-9)  # a hexagon

    def test_overlaps_are_inside_and_cavities_outside(self):
        two = boxes(((0, 0, 0), (1, 1, 1)), ((0.9, 0.25, 0), (2, 0.75, 1)))
        self.assertAlmostEqual(self.area(two, (0, 0, 0.5), (0, 0, 1)), 1 + 0.5, delta=2e-3)
        hollow = boxes(((0, 0, 0), (1, 1, 1)), ((0.75, 0.25, 0.25), (0.25, 0.75, 0.75)))  # mirrored: its faces point inwards
        self.assertAlmostEqual(self.area(hollow, (0, 0, 0.5), (0, 0, 1)), 0.75, delta=1e-9)
        touching = boxes(((0, 0, 0), (1, 1, 1)), ((1, 0, 0), (2, 1, 1)))
        self.assertAlmostEqual(self.area(touching, (0, 0, 0.5), (0, 0, 1)), 2, delta=1e-9)

    def test_torus_has_two_discs_or_a_ring(self):
        shape = torus(3, 1, 200)
        self.assertAlmostEqual(self.area(shape, (0, 0, 0), (0, 1, 0)), 2 * np.pi, delta=0.01)
        self.assertAlmostEqual(self.area(shape, (0, 0, 0), (0, 0, 1)), np.pi * (16 - 4), delta=0.1)

    def test_nothing_where_the_plane_misses(self):
        self.assertEqual(self.area(boxes(((0, 0, 0), (1, 1, 1))), (0, 0, 2), (0, 0, 1)), 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
