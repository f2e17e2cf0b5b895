"""Membranes and thin plates of NAFEMS, as solids."""
from functools import cache

import numpy as np

from book import case, exact, fem, parts
from book.run import elastic, probe

STEEL = {"E": 200e9, "nu": 0.3, "rho": 8000.0}
STEEL_WORDS = "E = 200 GPa, ν = 0.3, ρ = 8000 kg/m³"
MIDDLE = {"name": "middle", "fixed": "normal", "plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}
STANDARD = "NAFEMS, The Standard NAFEMS Benchmarks (1990), "


def modes(first, *values):
    return {f"mode {first + k}": f for k, f in enumerate(values)}


# ------------------------------------------------------------------------------------------------------------------ LE1

THICKNESS = 0.1


def elliptic(x):
    """Quarter of the elliptic membrane, upper half of its thickness."""
    t = np.pi / 2 * x[:, 1]
    a, b = 2 + 1.25 * x[:, 0], 1 + 1.75 * x[:, 0]
    return np.stack([a * np.cos(t), b * np.sin(t), THICKNESS / 2 * x[:, 2]], 1)


def on_rim(x):
    return np.abs(np.hypot(x[:, 0] / 3.25, x[:, 1] / 2.75) - 1) < 1e-6


def le1_in_bricks(run):
    mesh = fem.bricks(elliptic, (8, 14, 1))
    held = [(mesh.at(lambda x, d=d: np.abs(x[:, d]) < 1e-9), "xyz"[d]) for d in range(3)]
    forces = mesh.forces(on_rim, lambda x, n: 10 * n)
    return fem.static(run, mesh, {"E": 210e3, "nu": 0.3}, held, forces)[1][mesh.nearest((2, 0, 0)), 1]


@case(id="le1", title="NAFEMS LE1: elliptic membrane",
      geometry="Quarter of a membrane 0.1 m thick between the ellipses 2 × 1 and 3.25 × 2.75 m, upper half of its thickness; 10 MPa outwards "
               "on the outer face. σ_yy at the end of the hole's long axis", material="E = 210 GPa, ν = 0.3", source=STANDARD + "LE1",
      unit="MPa", exact=92.7, grids=(0.22, 0.17, 0.13), tolerance=0.015, calculix=le1_in_bricks,
      calculix_mesh="C3D20, 8 × 14 × 1, stresses averaged at nodes",
      notes="Splines of degree 3; with degree 2 and spans of 0.17, 0.12 and 0.08 m the errors are 4, 3 and 0.1 %. A stress at a corner that two "
            "planes of symmetry and a free face cut out of a span is where splines do worst beside elements with nodes there")
def le1(run, span):
    membrane = parts.block(elliptic, (1, 96, 1))
    run.surface("outer", parts.where(membrane, on_rim))
    run.model(membrane, (span, span, THICKNESS), 3)
    plane = lambda name, d: {"name": name, "fixed": name, "plane": {"point": [0, 0, 0], "normal": np.eye(3)[d].tolist()}}  # noqa: E731
    report = run.solve("static", {
        "material": {"E": 210e3, "nu": 0.3}, "support": [plane("x", 0), plane("y", 1), MIDDLE],
        "load": [{"name": "tension", "pressure": -10.0, "patch": "outer.stl"}], "probe": [{"name": "D", "position": [2, 0, 0]}]})
    return probe(report, "D")["stress"][1]


# ----------------------------------------------------------------------------------------------------------------- FV32

FV32 = modes(1, 44.623, 130.03, 162.70, 246.05, 379.90, 391.44)


def tapered(x):
    half = 2.5 - 2 * x[:, 0]
    return np.stack([10 * x[:, 0], half * (2 * x[:, 1] - 1), 0.025 * x[:, 2]], 1)


def fv32_in_bricks(run):
    mesh = fem.bricks(tapered, (16, 6, 1))
    held = [(mesh.at(lambda x: np.abs(x[:, 0]) < 1e-9), "xy"), (mesh.at(lambda x: np.abs(x[:, 2]) < 1e-9), "z")]
    return dict(zip(FV32, fem.frequencies(run, mesh, STEEL, held, 6)))


@case(id="fv32", title="NAFEMS FV32: cantilevered tapered membrane", quick=True,
      geometry="Membrane 10 m long, 5 m wide at the clamped end, 1 m at the other, 0.05 m thick, upper half of its thickness", material=STEEL_WORDS,
      source="NAFEMS, Selected Benchmarks for Natural Frequency Analysis (1987), FV32", unit="Hz", exact=FV32, grids=(1.1, 0.7, 0.45),
      tolerance=4e-4, known=5e-4, calculix=fv32_in_bricks, calculix_mesh="C3D20, 16 × 6 × 1",
      notes="The published values are not quite the limit: 48 × 20 bricks give -0.011, -0.013, -0.006, -0.024, -0.047 and -0.008 %")
def fv32(run, span):
    run.model(parts.block(tapered, (1, 1, 1)), (span, span, 0.05))
    root = {"name": "root", "fixed": "xy", "plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}
    return dict(zip(FV32, elastic(run.solve("eigen", {"material": STEEL, "support": [root, MIDDLE], "eigen": {"modes": 6}}))))


# ---------------------------------------------------------------------------------------------------------- FV12 and FV16

SQUARE = (10.0, 10.0, 0.05)


@cache
def thin_plate(clamped):
    first = 1 if clamped else 7
    return modes(first, *exact.square_plate(SQUARE[0], SQUARE[2], **STEEL, clamped=clamped, count=6))


def square_in_bricks(run, clamped):
    mesh = fem.bricks(lambda x: x * SQUARE, (10, 10, 1))
    held = [(mesh.at(lambda x: np.abs(x[:, 0]) < 1e-9), "xyz")] if clamped else []
    return dict(zip(thin_plate(clamped), fem.frequencies(run, mesh, STEEL, held, 6 if clamped else 12)[0 if clamped else 6:]))


def square(run, span, clamped):
    run.model(parts.box((0, 0, 0), SQUARE), (span, span, SQUARE[2]), 3)
    root = {"name": "root", "fixed": "xyz", "plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}
    report = run.solve("eigen", {"material": STEEL, "support": [root] if clamped else [], "eigen": {"modes": 6}})
    return dict(zip(thin_plate(clamped), elastic(report)))


RITZ = "Kirchhoff's plate by Ritz's method, degree 14 (as Leissa 1973); NAFEMS, Selected Benchmarks for Natural Frequency Analysis (1987), "


@case(id="fv12", title="NAFEMS FV12: free thin square plate", geometry="Plate 10 × 10 × 0.05 m, free", material=STEEL_WORDS,
      source=RITZ + "FV12, gives 1.622, 2.360, 2.922, 4.233 (twice) and 7.416, up to 1 % from it", unit="Hz", exact=lambda: thin_plate(False),
      grids=(1.8, 1.25, 0.85), tolerance=0.01, calculix=lambda run: square_in_bricks(run, False), calculix_mesh="C3D20, 10 × 10 × 1",
      notes="Splines of degree 3, spans of 0.05 m through the thickness")
def fv12(run, span):
    return square(run, span, False)


@case(id="fv16", title="NAFEMS FV16: cantilevered thin square plate", geometry="Plate 10 × 10 × 0.05 m, clamped along one side",
      material=STEEL_WORDS, source=RITZ + "FV16, gives 0.421, 1.029, 2.582, 3.306, 3.753 and 6.555, up to 0.7 % from it", unit="Hz",
      exact=lambda: thin_plate(True), grids=(1.8, 1.25, 0.85), tolerance=5e-3, calculix=lambda run: square_in_bricks(run, True),
      calculix_mesh="C3D20, 10 × 10 × 1", notes="Splines of degree 3, spans of 0.05 m through the thickness")
def fv16(run, span):
    return square(run, span, True)


# --------------------------------------------------------------------------------------------------------- Scordelis and Lo

ROOF = {"E": 4.32e8, "nu": 0.0, "rho": 1.0}
ROOF_LENGTH, ROOF_RADIUS, ROOF_THICKNESS, ROOF_ANGLE = 50.0, 25.0, 0.25, np.radians(40)
WEIGHT = 90 / ROOF_THICKNESS
ROOF_EDGE = [ROOF_RADIUS * np.sin(ROOF_ANGLE), 0, ROOF_RADIUS * np.cos(ROOF_ANGLE)]


def roof(x):
    """Quarter of the roof: along the arc from its top, along its length from the middle, across its thickness."""
    r, angle = ROOF_RADIUS + ROOF_THICKNESS * (x[:, 2] - 0.5), ROOF_ANGLE * x[:, 0]
    return np.stack([r * np.sin(angle), ROOF_LENGTH / 2 * x[:, 1], r * np.cos(angle)], 1)


def roof_in_bricks(run):
    mesh = fem.bricks(roof, (8, 8, 1))
    held = [(mesh.at(lambda x: np.abs(x[:, 0]) < 1e-9), "x"), (mesh.at(lambda x: np.abs(x[:, 1]) < 1e-9), "y")]
    diaphragm = mesh.at(lambda x: np.abs(x[:, 1] - ROOF_LENGTH / 2) < 1e-9)
    held += [(np.setdiff1d(diaphragm, held[0][0]), "x"), (diaphragm, "z")]
    u, _ = fem.static(run, mesh, ROOF, held, np.zeros_like(mesh.nodes), ["*DLOAD", f"SOLID, GRAV, {WEIGHT}, 0., 0., -1."])
    return u[mesh.nearest(ROOF_EDGE), 2]


@case(id="scordelis_lo", title="Scordelis and Lo: barrel vault under its weight", quick=True,
      geometry="Roof 50 long, radius 25, 0.25 thick, 80 degrees, on diaphragms at its ends, free along its sides; a quarter. Deflection at the "
               "middle of a free side", material="E = 4.32e8, ν = 0, weight 90 per area", unit="", exact=-0.3013, known=5e-4,
      source="the solid: C3D20, 32 × 32 × 1, give -0.3012; shells: -0.3024 (MacNeal & Harder 1985, Finite Elements in Analysis and Design 1), "
             "-0.3006 in later work", grids=(2.5, 1.7, 1.2), tolerance=5e-3, calculix=roof_in_bricks, calculix_mesh="C3D20, 8 × 8 × 1",
      notes="Five to ten times as long as thick, spans lie across the wall as they happen to. Degree 2: at degree 3 functions of so thin a wall are "
            "dependent to rounding, and igasolve refuses")
def scordelis_lo(run, span):
    run.model(parts.block(roof, (64, 1, 1)), span)
    held = [{"name": name, "fixed": fixed, "plane": {"point": [0, at, 0], "normal": normal}} for name, fixed, at, normal in (
        ("top", "x", 0, [1, 0, 0]), ("middle", "y", 0, [0, 1, 0]), ("diaphragm", "xz", ROOF_LENGTH / 2, [0, 1, 0]))]
    report = run.solve("static", {"material": {"E": ROOF["E"], "nu": 0.0}, "support": held, "probe": [{"name": "edge", "position": ROOF_EDGE}],
                                  "load": [{"name": "weight", "body_force": [0, 0, -WEIGHT]}]})
    return probe(report, "edge")["displacement"][2]
