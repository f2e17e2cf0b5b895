"""Parts on which error_study.py holds estimated errors of modes against true ones. Lengths in mm, or as the file has them."""
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from igatools.extrusion import Prism, circle, rotation
from igatools.stl import write_stl

import gap_parts

TURN = rotation(13, 9)  # general position: no face in a plane of the grid


@dataclass
class Part:
    name: str
    kind: str   # slot, thin wall, lattice, fillet, smooth, block, free form
    file: Path


def turned(triangles):
    return np.einsum("nij,kj->nik", triangles, TURN)


def rectangle(x, y, width, height):
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def hole(loop):
    return loop[::-1]


def grille():
    """A plate with a lattice of square windows."""
    windows = [hole(rectangle(4 + 14 * i, 4 + 14 * j, 10, 10)) for i in range(5) for j in range(3)]
    return Prism(rectangle(0, 0, 74, 46), 5, windows)


def comb():
    """Four teeth of 6 mm, 4 mm apart, on a back of 8 mm."""
    outline = [(0, 0)]
    for k in range(4):
        x = 10 * k
        outline += [(x + 6, 0), (x + 6, 30)] + ([(x + 10, 30), (x + 10, 0)] if k < 3 else [])
    outline += [(36, 38), (0, 38)]
    return Prism(outline, 6)


def slotted_disc():
    slots = [hole(rectangle(-18, -2, 12, 4)), hole(rectangle(6, -2, 12, 4))]
    return Prism(hole(circle((0, 0), 25, 96)), 6, slots)


PRISMS = {
    "bar": ("block", lambda: Prism(rectangle(0, 0, 100, 14), 10), False),
    "turned_bar": ("block", lambda: Prism(rectangle(0, 0, 100, 14), 10), True),
    "angle": ("block", lambda: Prism([(0, 0), (60, 0), (60, 15), (15, 15), (15, 50), (0, 50)], 20), True),
    "plate": ("thin wall", lambda: Prism(rectangle(0, 0, 80, 60), 3), True),
    "channel": ("thin wall", lambda: Prism([(0, 0), (30, 0), (30, 20), (27, 20), (27, 3), (3, 3), (3, 20), (0, 20)], 80), True),
    "tube": ("thin wall", lambda: Prism(hole(circle((0, 0), 15, 96)), 60, [circle((0, 0), 12, 96)]), True),
    "plate_with_hole": ("smooth", lambda: Prism(rectangle(0, 0, 60, 60), 8, [circle((30, 30), 12, 96)]), True),
    "grille": ("lattice", grille, True),
    "comb": ("slot", comb, True),
    "slotted_disc": ("slot", slotted_disc, True),
    "fork": ("slot", lambda: gap_parts.fork().prism, True),
    "slotted_bracket": ("slot", lambda: gap_parts.bracket().prism, True),
    "slit_block": ("slot", lambda: gap_parts.slit_block().prism, True),
}

# Of ../shared/stl and ../shared/cases: file, kind.
GIVEN = {
    "angle_block": ("stl/valid/angle_block.STL", "block"), "octagonal_pocket": ("stl/valid/octagonal_pocket.STL", "block"),
    "plate_holes": ("stl/valid/plate_holes.STL", "smooth"), "cylinder": ("stl/valid/cyl_r40_h100.stl", "smooth"),
    "torus": ("stl/valid/torus.STL", "smooth"), "sphere": ("stl/valid/unit_sphere.STL", "smooth"),
    "spool_holder": ("stl/valid/Spool_Holder_x1.STL", "free form"), "x_carriage": ("stl/valid/X_Carriage_x1.stl", "free form"),
    "bed_mount": ("stl/valid/Rear_Bed_Mount_Right_x1.stl", "free form"), "idler": ("stl/valid/idler_riser.STL", "free form"),
    "housing": ("stl/valid/ADIS16480.STL", "free form"), "feature_type": ("stl/valid/featuretype.STL", "free form"),
    "lattice": ("cases/bcc16.stl", "lattice"), "turned_cube": ("stl/valid/cube_rot.stl", "block"),
    "tray": ("stl/valid/1002_tray_bottom.STL", "thin wall"), "elephant": ("stl/valid/elephant.stl", "free form"),
}

# Written by make_cad_parts (tests/cad).
CAD = {"filleted_box": "fillet", "thread": "fillet", "loft": "smooth", "bent_sheet": "thin wall", "crossing_bores": "smooth",
       "perforated_plate": "lattice", "cone": "smooth", "hollow_sphere": "smooth"}


def make_parts(folder, shared, make_cad_parts):
    """All parts, their files written into `folder` or found in `shared`; those that are not there are left out."""
    parts = []
    for name, (kind, make, is_turned) in PRISMS.items():
        file = folder / f"{name}.stl"
        triangles = make().triangles()
        write_stl(file, turned(triangles) if is_turned else triangles)
        parts.append(Part(name, kind, file))
    for name, (file, kind) in GIVEN.items():
        if shared and (shared / file).exists():
            parts.append(Part(name, kind, shared / file))
    if make_cad_parts:
        cad = folder / "cad"
        cad.mkdir(exist_ok=True)
        subprocess.run([make_cad_parts, cad], check=True, stdout=subprocess.DEVNULL)
        parts += [Part(name, kind, cad / f"{name}.step") for name, kind in CAD.items() if (cad / f"{name}.step").exists()]
    return parts
