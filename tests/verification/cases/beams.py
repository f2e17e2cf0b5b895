"""Beams and bars under static loads."""
import numpy as np

from book import case, exact, fem, parts
from book.run import probe


def clamp(plane):
    return {"name": "root", "fixed": "xyz", "plane": plane}


# ------------------------------------------------------------------------------------------------------ pure bending: patch

STEEL = {"E": 210e3, "nu": 0.3}
STEEL_WORDS = "E = 210 GPa, ν = 0.3"
LENGTH, WIDTH, HEIGHT, MOMENT = 100.0, 8.0, 12.0, 50e3


def bending():
    """Saint-Venant: u = κ x z, v = -ν κ y z, w = -κ (x² + ν (z² - y²)) / 2 with z and y from the axis; quadratic."""
    kappa = MOMENT / (STEEL["E"] * WIDTH * HEIGHT**3 / 12)
    return {"w at the tip": -kappa * LENGTH**2 / 2, "stress at the root": STEEL["E"] * kappa * HEIGHT / 2}


@case(id="pure_bending", title="Bar in pure bending", quick=True,
      geometry="Bar 100 × 8 × 12 mm turned by 25 degrees about (1, 2, 3) against the grid; one end kept plane, 50 Nm on the other as linear "
               "traction", material=STEEL_WORDS, source="Saint-Venant; Timoshenko & Goodier, Theory of Elasticity, 3rd ed. (1970), art. 102",
      unit={"w at the tip": "mm", "stress at the root": "MPa"}, exact=bending, grids=(9.0, 6.0, 4.0),
      tolerance={"w at the tip": 1e-7, "stress at the root": 1e-5},
      notes="The solution is quadratic, so that splines of degree 2 hold it on any grid, if rules of cut spans keep moments of degree 2p "
            "(--moment-degree 2p): a patch test of cut spans, supports and loads. Rules of the default degree p keep linear "
            "solutions, and are 0.04 % off here at the finest grid")
def pure_bending(run, span):
    run.model(parts.box((0, -WIDTH / 2, -HEIGHT / 2), (LENGTH, WIDTH / 2, HEIGHT / 2)), span, 2, "--rotate-axis-angle", 1, 2, 3, 25,
              "--moment-degree", "2p")
    root = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    report = run.solve("static", {
        "material": STEEL,
        "support": [{"name": "plane", "fixed": "x", "plane": root},
                    {"name": "axis", "fixed": "yz", "at": [0, 0, 0], "method": "penalty"},
                    {"name": "no roll", "fixed": "y", "at": [LENGTH, 0, 0], "method": "penalty"},
                    {"name": "no turn", "fixed": "y", "at": [0, 0, HEIGHT / 2], "method": "penalty"}],
        "load": [{"name": "moment", "moment": [0, MOMENT, 0], "plane": {"point": [LENGTH, 0, 0], "normal": [1, 0, 0]}}],
        "probe": [{"name": "tip", "position": [LENGTH, 0, 0]}, {"name": "root", "position": [0, 0, HEIGHT / 2]}]})
    return {"w at the tip": probe(report, "tip")["displacement"][2], "stress at the root": probe(report, "root")["stress"][0]}


# -------------------------------------------------------------------------------------------------------- Timoshenko beam

SLENDER = 10.0  # length over height
UNIT = {"E": 1000.0, "nu": 0.0}


def timoshenko():
    """Tip of a cantilever of height and width 1 under a shear force 1; κ = 5/6 for ν = 0 (Cowper 1966)."""
    return SLENDER**3 / (3 * UNIT["E"] / 12) + SLENDER / (5 / 6 * UNIT["E"] / 2)


def cantilever_in_bricks(run):
    mesh = fem.bricks(lambda x: x * [SLENDER, 1, 1], (12, 2, 2))
    root = mesh.at(lambda x: np.abs(x[:, 0]) < 1e-9)
    forces = mesh.forces(lambda x: np.abs(x[:, 0] - SLENDER) < 1e-9, [0, 0, 1.0])
    return fem.static(run, mesh, UNIT, [(root, "xyz")], forces)[0][mesh.nearest((SLENDER, 0.5, 0.5)), 2]


@case(id="cantilever", title="Cantilever with shear", geometry="10 × 1 × 1, clamped at one end, a force of 1 spread over the other",
      material="E = 1000, ν = 0", source="Timoshenko's beam; shear coefficient 5/6 (Cowper 1966)", unit="", exact=timoshenko,
      grids=(0.7, 0.45, 0.3), tolerance=5e-4, calculix=cantilever_in_bricks, calculix_mesh="C3D20, 12 × 2 × 2",
      notes="Beam theory leaves out what the clamped end keeps from warping, some 1e-4")
def cantilever(run, span):
    run.model(parts.box((0, 0, 0), (SLENDER, 1, 1)), span)
    report = run.solve("static", {
        "material": UNIT, "support": [clamp({"point": [0, 0, 0], "normal": [1, 0, 0]})],
        "load": [{"name": "shear", "force": [0, 0, 1], "plane": {"point": [SLENDER, 0, 0], "normal": [1, 0, 0]}}],
        "probe": [{"name": "tip", "position": [SLENDER, 0.5, 0.5]}]})
    return probe(report, "tip")["displacement"][2]


# ----------------------------------------------------------------------------------------------------- torsion, rectangle

BAR, TORQUE, LOW, HIGH = (20.0, 10.0, 120.0), 1e5, 40.0, 80.0


def twist_per_length():
    return TORQUE / (STEEL["E"] / (2 * (1 + STEEL["nu"])) * exact.torsion_constant(*BAR[:2]))


def torsion_in_bricks(run):
    mesh = fem.bricks(lambda x: x * BAR - np.array([BAR[0] / 2, BAR[1] / 2, 0]), (4, 4, 12))
    root = mesh.at(lambda x: np.abs(x[:, 2]) < 1e-9)
    polar = BAR[0] * BAR[1] * (BAR[0]**2 + BAR[1]**2) / 12
    forces = mesh.forces(lambda x: np.abs(x[:, 2] - BAR[2]) < 1e-9,
                         lambda x, n: TORQUE / polar * np.stack([-x[:, 1], x[:, 0], 0 * x[:, 0]], 1))
    u = fem.static(run, mesh, STEEL, [(root, "xyz")], forces)[0]
    turn = lambda z: u[mesh.nearest((BAR[0] / 2, 0, z)), 1] / (BAR[0] / 2)  # noqa: E731
    return (turn(HIGH) - turn(LOW)) / (HIGH - LOW)


@case(id="bar_torsion", title="Twist of a rectangular bar", quick=True,
      geometry="Bar 20 × 10 × 120 mm, clamped at one end, 100 Nm on the other; twist between 40 and 80 mm, away from the ends",
      material=STEEL_WORDS, source="Saint-Venant's series; Timoshenko & Goodier, Theory of Elasticity, 3rd ed. (1970), art. 109", unit="1/mm",
      exact=twist_per_length, grids=(7.0, 4.7, 3.2), tolerance=1e-3, calculix=torsion_in_bricks, calculix_mesh="C3D20, 4 × 4 × 12")
def bar_torsion(run, span):
    half = np.array([BAR[0] / 2, BAR[1] / 2, 0])
    run.model(parts.box(-half, np.array(BAR) - half), span)
    at = {name: [BAR[0] / 2, 0, z] for name, z in (("low", LOW), ("high", HIGH))}
    report = run.solve("static", {
        "material": STEEL, "support": [clamp({"point": [0, 0, 0], "normal": [0, 0, 1]})],
        "load": [{"name": "torque", "moment": [0, 0, TORQUE], "plane": {"point": [0, 0, BAR[2]], "normal": [0, 0, 1]}}],
        "probe": [{"name": name, "position": x} for name, x in at.items()]})
    turn = {name: probe(report, name)["displacement"][1] / (BAR[0] / 2) for name in at}
    return (turn["high"] - turn["low"]) / (HIGH - LOW)


# ------------------------------------------------------------------------------------------------------------ curved beam

CURVED_IN, CURVED_OUT, THICK = 4.12, 4.32, 0.1
CURVED = {"E": 1e7, "nu": 0.25}


def curved_exact():
    """In the plane: elasticity of the curved bar; out of it: bending and torsion of a thin curved beam with the bar's torsion constant."""
    a, b, E, G = CURVED_IN, CURVED_OUT, CURVED["E"], CURVED["E"] / (2 * (1 + CURVED["nu"]))
    inside = np.pi * (a**2 + b**2) / (E * THICK * (a**2 - b**2 + (a**2 + b**2) * np.log(b / a)))
    R, bending, torsion = (a + b) / 2, E * (b - a) * THICK**3 / 12, G * exact.torsion_constant(b - a, THICK)
    return {"in the plane": inside, "out of the plane": R**3 * (np.pi / 4 / bending + (3 * np.pi / 4 - 2) / torsion)}


def curved(x):
    """Along the arc from the root at θ = 90 degrees to the tip on the x axis."""
    r, t = CURVED_IN + (CURVED_OUT - CURVED_IN) * x[:, 1], np.pi / 2 * (1 - x[:, 0])
    return np.stack([r * np.cos(t), r * np.sin(t), THICK * x[:, 2]], 1)


TIP = ((CURVED_IN + CURVED_OUT) / 2, 0, THICK / 2)


def curved_forces():
    return {"in the plane": (0, [1.0, 0, 0]), "out of the plane": (2, [0, 0, 1.0])}


def curved_by_bricks(run):
    mesh = fem.bricks(curved, (32, 2, 2))
    root, tip = mesh.at(lambda x: np.abs(x[:, 0]) < 1e-9), lambda x: np.abs(x[:, 1]) < 1e-9
    found = {}
    for name, (axis, force) in curved_forces().items():
        forces = mesh.forces(tip, np.array(force) / ((CURVED_OUT - CURVED_IN) * THICK))
        found[name] = fem.static(run, mesh, CURVED, [(root, "xyz")], forces)[0][mesh.nearest(TIP), axis]
    return found


@case(id="curved_beam", title="MacNeal and Harder: curved beam",
      geometry="Quarter of a ring, radii 4.12 and 4.32, 0.1 thick, clamped at one end; a force of 1 at the other, outwards and across",
      material="E = 1e7, ν = 0.25", source="in the plane: Timoshenko & Goodier, art. 33 (published, MacNeal & Harder 1985: 0.08734); out of it: "
      "curved beam with bending and torsion (published 0.5022)", unit="", exact=curved_exact, grids=(0.13, 0.09, 0.065),
      tolerance={"in the plane": 2e-3, "out of the plane": 0.012},
      calculix=curved_by_bricks, calculix_mesh="C3D20, 32 × 2 × 2",
      notes="Theory lets the root warp, which the clamp does not: twist begins a width later, and the solid is stiffer")
def curved_beam(run, span):
    run.model(parts.block(curved, (96, 1, 1)), span)
    found = {}
    for name, (axis, force) in curved_forces().items():
        report = run.solve("static", {
            "material": CURVED, "support": [clamp({"point": [0, 0, 0], "normal": [1, 0, 0]})],
            "load": [{"name": "tip", "force": force, "plane": {"point": [0, 0, 0], "normal": [0, 1, 0]}}],
            "probe": [{"name": "tip", "position": list(TIP)}]})
        found[name] = probe(report, "tip")["displacement"][axis]
    return found


# ----------------------------------------------------------------------------------------------------------- twisted beam

TWISTED_LENGTH, TWISTED = 12.0, {"E": 29e6, "nu": 0.22}
TWISTED_SECTION = (1.1, 0.32)


def twisted(x):
    """Width along y at the root, along z at the tip."""
    t = np.pi / 2 * x[:, 0]
    y, z = TWISTED_SECTION[0] * (x[:, 1] - 0.5), TWISTED_SECTION[1] * (x[:, 2] - 0.5)
    return np.stack([TWISTED_LENGTH * x[:, 0], np.cos(t) * y - np.sin(t) * z, np.sin(t) * y + np.cos(t) * z], 1)


PUBLISHED = {"along the width of the root": 0.001754, "across it": 0.005424}
ACROSS = {"along the width of the root": (1, [0, 1.0, 0]), "across it": (2, [0, 0, 1.0])}


def twisted_in_bricks(run):
    mesh = fem.bricks(twisted, (16, 3, 2))
    root, tip = mesh.at(lambda x: np.abs(x[:, 0]) < 1e-9), lambda x: np.abs(x[:, 0] - TWISTED_LENGTH) < 1e-9
    found = {}
    for name, (axis, force) in ACROSS.items():
        forces = mesh.forces(tip, np.array(force) / np.prod(TWISTED_SECTION))
        found[name] = fem.static(run, mesh, TWISTED, [(root, "xyz")], forces)[0][mesh.nearest((TWISTED_LENGTH, 0, 0)), axis]
    return found


@case(id="twisted_beam", title="MacNeal and Harder: twisted beam",
      geometry="Beam 12 × 1.1 × 0.32, twisted by 90 degrees, clamped at one end; a force of 1 at the other, along the width of the root and "
               "across it", material="E = 29e6, ν = 0.22", source="MacNeal & Harder, Finite Elements in Analysis and Design 1 (1985): beam theory",
      unit="", exact=PUBLISHED, grids=(0.4, 0.28, 0.2), tolerance=2e-3, calculix=twisted_in_bricks, calculix_mesh="C3D20, 16 × 3 × 2")
def twisted_beam(run, span):
    run.model(parts.block(twisted, (72, 6, 2)), span)
    found = {}
    for name, (axis, force) in ACROSS.items():
        report = run.solve("static", {
            "material": TWISTED, "support": [clamp({"point": [0, 0, 0], "normal": [1, 0, 0]})],
            "load": [{"name": "tip", "force": force, "plane": {"point": [TWISTED_LENGTH, 0, 0], "normal": [1, 0, 0]}}],
            "probe": [{"name": "tip", "position": [TWISTED_LENGTH, 0, 0]}]})
        found[name] = probe(report, "tip")["displacement"][axis]
    return found
