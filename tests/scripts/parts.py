"""Parts with known answers for the tests of the scripts, and how these run."""
import sys
import unittest

import numpy as np

# Free cube, omega L sqrt(rho / mu) at nu = 0.3: Ritz with polynomials of degree 18, the first known to 5e-6 only; the fourth
# group, sqrt(2) pi, are Lamé's modes.
CUBE_FREQUENCIES = np.repeat([2.85605, 3.84597, 3.91125, 2**0.5 * np.pi, 4.57278], [2, 3, 3, 3, 3])


def box_facets(lower, upper):
    """The twelve facets of a box, three corners each."""
    x = [tuple((lower, upper)[n >> d & 1][d] for d in range(3)) for n in range(8)]
    for a, b, c, d in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)):
        yield from ((x[a], x[b], x[c]), (x[a], x[c], x[d]))


def write_stl(path, bodies):
    """Text STL of bodies, each a sequence of facets, with 17 digits."""
    with open(path, "w") as file:
        for body in bodies:
            file.write("solid body\n")
            for facet in body:
                lines = ["vertex " + " ".join(f"{x:.17g}" for x in corner) for corner in facet]
                file.write("\n".join(["facet normal 0 0 0", "outer loop", *lines, "endloop", "endfacet", ""]))
            file.write("endsolid body\n")


def write_boxes(path, boxes):
    """Text STL of boxes (lower corner, upper corner)."""
    write_stl(path, [box_facets(*box) for box in boxes])


def run_tests(missing):
    """All tests of the calling script. Exit code 1 where one failed, else 77 (skipped) where something was missing: what."""
    if not unittest.main(argv=sys.argv[:1], exit=False).result.wasSuccessful():
        sys.exit(1)
    if missing:
        print(f"skipped: {missing}")
        sys.exit(77)
