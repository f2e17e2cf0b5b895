"""Parts with gaps that gap_study.py runs and the tests use. Lengths in mm."""
from dataclasses import dataclass

import numpy as np

from igatools.extrusion import Prism, circle, rotation

TURN = rotation(13, 9)  # general position: no face in a plane of the grid


@dataclass
class GapPart:
    name: str
    what: str          # one line
    prism: Prism
    spans: tuple       # sizes
    meshes: tuple      # of tetrahedra, coarse to fine: (size in the plane, size around the fine corners, layers)

    def triangles(self):
        """The surface (n, 3, 3), turned; equal corners stay equal to the bit."""
        x, y, z = np.moveaxis(self.prism.triangles(), -1, 0)[..., None]
        return x * TURN[:, 0] + y * TURN[:, 1] + z * TURN[:, 2]


def fork(gap=2.5):
    """Two tines of 85 × 10 × 10 on a root of 15."""
    outline = [(0, 0), (100, 0), (100, 10), (15, 10), (15, 10 + gap), (100, 10 + gap), (100, 20 + gap), (0, 20 + gap)]
    return GapPart("fork", f"two tines of 10 mm, {gap:g} mm apart", Prism(outline, 10, fine=[(0, 3), (0, 4)]),
                   (10, 5, 4, 2.5), ((5, 1, 2), (2.5, 0.5, 4)))


def bracket():
    """An angle of 300 × 200 × 60 with legs of 100; a slot of 20 parts the long one into two arms of 40."""
    outline = [(0, 0), (300, 0), (300, 40), (110, 40), (110, 60), (300, 60), (300, 100), (100, 100), (100, 200), (0, 200)]
    return GapPart("bracket", "an angle of 300 mm with a slot of 20 mm, 190 mm long",
                   Prism(outline, 60, fine=[(0, 3), (0, 4)]), (20, 14, 10), ((20, 5, 3), (10, 2, 6)))


def slit_block(gap=0.05):
    """A block of 20 × 40 × 10; a slit from its edge to its middle."""
    outline = [(0, 0), (9, 0), (9, 20), (9 + gap, 20), (9 + gap, 0), (20, 0), (20, 40), (0, 40)]
    return GapPart("slit", f"a block of 40 mm with a slit of {gap:g} mm that ends in its middle",
                   Prism(outline, 10, fine=[(0, 2), (0, 3)]), (4, 2.5, 1.6), ((4, 1, 3), (2.5, 0.25, 4)))


def perforated_sheet():
    """A sheet of 60 × 40 × 1.5 with holes as large as a span of 5 in one half and a fifth of it in the other."""
    large = [circle((x, y), 2.5, 24) for x in np.arange(5, 30, 6) for y in np.arange(5, 36, 6)]
    small = [circle((x, y), 0.5, 12) for x in np.arange(35, 57, 3) for y in np.arange(5, 36, 3)]
    return GapPart("sheet", "a sheet of 1.5 mm with holes of 5 mm, 6 mm apart, and of 1 mm, 3 mm apart",
                   Prism([(0, 0), (60, 0), (60, 40), (0, 40)], 1.5, large + small), (5, 3.5, 2.5),
                   ((2, None, 1), (1, None, 2)))


PARTS = {make().name: make for make in (fork, bracket, slit_block, perforated_sheet)}
