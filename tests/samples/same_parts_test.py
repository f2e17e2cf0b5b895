#!/usr/bin/python3
"""The generator writes the same solids on a second run: same boxes, volumes and areas to the rounding of float32.

(CGAL's corefinement orders its sets by address, so that facets of one plane may be cut otherwise each time.)
Parts kept in a third folder are those solids too; another compiler may have placed their triangles otherwise.
usage: same_parts_test.py MAKE_PARTS FIRST SECOND KEPT"""
import subprocess
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
from igatools.stl import read_stl, surface_figures  # noqa: E402

make_parts, first, second, kept = map(Path, sys.argv[1:])
subprocess.run([make_parts, second], check=True, stdout=subprocess.DEVNULL)


def difference(one, other):
    """Largest difference of boxes, centroids (over the size), volumes and areas (relative)."""
    a, b = read_stl(one), read_stl(other)
    size = np.ptp(a, axis=(0, 1)).max()
    (volume_a, centroid_a, area_a), (volume_b, centroid_b, area_b) = surface_figures(a), surface_figures(b)
    found = max(np.abs(a.min(axis=(0, 1)) - b.min(axis=(0, 1))).max() / size,
                np.abs(a.max(axis=(0, 1)) - b.max(axis=(0, 1))).max() / size,
                abs(volume_a / volume_b - 1), abs(area_a / area_b - 1), np.abs(centroid_a - centroid_b).max() / size)
    print(f"{one}: {len(a)} and {len(b)} facets, largest difference {found:.1e}")
    return found


parts = sorted(second.glob("*.stl"))
wrong = [part.name for part in parts if not difference(first / part.name, part) < 1e-7]
wrong += [part.name for part in kept.glob("*.stl") if not difference(part, second / part.name) < 1e-3]
sys.exit(f"differ between two runs: {', '.join(wrong)}" if wrong or not parts else 0)
