#!/usr/bin/python3
"""Parts, grids and rules that rule_study.py runs."""
import os
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

INTERIOR = {2: ("gauss", "ggq", "ggq-reduced"), 3: ("gauss", "ggq", "ggq-reduced", "ggq-reduced2")}
TRIMMED = {"nnls": ["--trimmed", "nnls"], "minimal": ["--trimmed", "minimal"],
           "minimal+rank": ["--trimmed", "minimal", "--rank-bound"]}
OFFERED = (("gauss", "nnls"), ("ggq", "minimal"), ("ggq-reduced", "minimal"))

# Free cube, ω L √(ρ/E) at ν = 0.3: Ritz with polynomials of degree 18.
CUBE = (1.771244,) * 2 + (2.385170,) * 3 + (2.425655,) * 3
# 10-node tetrahedra with 702 444 unknowns on the STL's own triangles: samples/11_foam_modes_vs_fem, their own error about
# 3e-4. Hz.
FOAM = (101.74, 129.62, 204.90, 214.27, 283.78, 348.65, 362.58, 374.30, 391.75, 419.50)
UNIT = {"E": 1.0, "nu": 0.3, "rho": 1.0}
FOAM_MATERIAL = {"E": 20.0, "nu": 0.3, "rho": 6e-11}

SPEED_PARTS = ("cube_rot.stl", "busted.STL", "X_Carriage_x1.stl", "A_Drive_Frame_Upper_x1.stl", "elephant.stl")


def every_rule(degree):
    """All combinations of interior and trimmed rules of a degree."""
    return tuple((interior, trimmed) for interior in INTERIOR.get(degree, INTERIOR[3]) for trimmed in TRIMMED)


@dataclass(frozen=True)
class Case:
    """One part on one grid. `exact`: elastic frequencies, cycles per time; without them errors are changes against
    gauss × nnls. `analyses`: of eigen, timestep; `sturm`: with a proof that no mode is missing."""
    part: str
    stl: Path
    degree: int
    grid: str
    words: tuple
    rules: tuple
    material: dict = field(default_factory=lambda: UNIT)
    exact: tuple = ()
    modes: int = 1
    analyses: tuple = ()
    sturm: bool = True


def cube_frequencies(edge):
    """Of the free cube with the material UNIT, cycles per time."""
    return tuple(value / (2 * 3.141592653589793 * edge) for value in CUBE)


def span_size(h):
    return ("--span-size", f"{h:.17g}")


def foam(options, degree, grid, words, rules, analyses=(), **more):
    return Case("foam part", options.samples / "foam_part.stl", degree, grid, words, rules, FOAM_MATERIAL, FOAM, len(FOAM),
                analyses, **more)


def errors(options):
    """Points, cost and accuracy of all combinations: the turned cube and the foam part."""
    both = ("eigen", "timestep")
    cases = [Case("turned cube", options.shared / "cube_rot.stl", p, f"L/{n}", span_size(70 / n), every_rule(p), UNIT,
                  cube_frequencies(70), len(CUBE), both) for p in (2, 3) for n in (6, 9, 13)]
    return cases + [foam(options, p, f"{h} mm", span_size(h), every_rule(p), both)
                    for p, sizes in ((2, (14, 10, 7)), (3, (14, 10))) for h in sizes]


def paper(options):
    """Totals beside Messmer et al. (2021): a cube of 100 mm whose faces lie across the spans, and the foam part."""
    stl = options.output / "cube_100" / "trimmed_cube.stl"  # from 10 to 110 mm
    if not stl.exists():
        subprocess.run([options.bin / "make_parts", stl.parent, "--only", "trimmed_cube", "--theta", "10"], check=True,
                       stdout=subprocess.DEVNULL)
    cases = []
    for h in (4, 16):
        for share in (0.37, 0.12, 0.8):
            low, spans = 10 - (2 + share) * h, 5 + int(100 / h + share)
            box = ("--box", *[f"{low:.17g}"] * 3, *[f"{low + spans * h:.17g}"] * 3, "--spans", str(spans))
            cases.append((f"{h} mm, faces at {share} h", box, share == 0.37))
        turn = ("--rotate-axis-angle", "3", "1", "2", "25")
        cases.append((f"{h} mm, turned by 25°", (*span_size(h), *turn), True))
    return [Case("cube of 100 mm", stl, 2, grid, words, every_rule(2), UNIT, cube_frequencies(100), len(CUBE),
                 ("eigen",) if solved else (), sturm=not grid.startswith("4 ")) for grid, words, solved in cases] \
        + [foam(options, 2, "10 mm", span_size(10), every_rule(2), ("eigen",))]


def large(options):
    """Time and memory of fine grids of the foam part."""
    return [foam(options, p, f"{n} spans", ("--spans", str(n)), OFFERED) for p, n in ((2, 80), (3, 80), (2, 160))]


def speed(options):
    """CPU time of the reduction."""
    rules = (("gauss", "nnls"), ("gauss", "minimal"))
    cases = [Case(Path(name).stem, options.shared / name, p, "20 spans", ("--spans", "20"), rules)
             for name in SPEED_PARTS for p in (2, 3, 4)]
    return cases + [foam(options, p, "20 spans", ("--spans", "20"), rules) for p in (2, 3, 4)]


def rigid(options):
    """Rigid modes of all shared parts."""
    return [Case(stl.stem, stl, p, f"{n} spans", ("--spans", str(n)), OFFERED, analyses=("eigen",))
            for p, n in ((2, 20), (3, 10)) for stl in sorted(options.shared.glob("*.[sS][tT][lL]"))]


def own(options):
    """A part of the user's."""
    words = span_size(options.span_size) if options.span_size else ("--spans", str(options.spans))
    grid = f"{options.span_size:g}" if options.span_size else f"{options.spans} spans"
    material = {"E": options.E, "nu": options.nu, "rho": options.rho}
    return [Case(options.part.stem, options.part, p, grid, words, every_rule(p), material, (), options.modes,
                 ("eigen", "timestep")) for p in options.degrees or (2, 3)]


STUDIES = {"errors": errors, "paper": paper, "large": large, "speed": speed, "rigid": rigid, "own": own}


def shared_parts():
    """Folder of the shared test parts, as the tests are told it."""
    return Path(os.environ.get("IGA_SHARED_DIR", "shared")) / "stl/valid"
