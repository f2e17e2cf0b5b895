"""Parts with known answers for the tests of the scripts, and how these run."""
import sys
import unittest

import numpy as np

# Free cube, omega L sqrt(rho / mu) at nu = 0.3: Ritz with polynomials of degree 18, the first known to 5e-6 only; the fourth
# group, sqrt(2) pi, are Lamé's modes.
CUBE_FREQUENCIES = np.repeat([2.85605, 3.84597, 3.91125, 2**0.5 * np.pi, 4.57278], [2, 3, 3, 3, 3])


def write_boxes(path, boxes):
    """Text STL of boxes (lower corner, upper corner) with 17 digits."""
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    with open(path, "w") as file:
        for box in boxes:
            corners = [[box[n >> d & 1][d] for d in range(3)] for n in range(8)]
            file.write("solid box\n")
            for a, b, c, d in quads:
                for triangle in ((a, b, c), (a, c, d)):
                    lines = ["vertex " + " ".join(f"{x:.17g}" for x in corners[v]) for v in triangle]
                    file.write("\n".join(["facet normal 0 0 0", "outer loop", *lines, "endloop", "endfacet", ""]))
            file.write("endsolid box\n")


def run_tests(missing):
    """All tests of the calling script. Exit code 1 where one failed, else 77 (skipped) where something was missing: what."""
    if not unittest.main(argv=sys.argv[:1], exit=False).result.wasSuccessful():
        sys.exit(1)
    if missing:
        print(f"skipped: {missing}")
        sys.exit(77)
