"""Supports and materials of other kinds, stress concentration."""
import numpy as np

from book import case, parts
from book.run import probe

AXES = np.eye(3)


def plane(name, normal, point=(0, 0, 0)):
    return {"name": name, "fixed": "normal", "plane": {"point": list(point), "normal": list(normal)}}


# ------------------------------------------------------------------------------------------------------------ press fit

E, NU, INNER, OUTER, LENGTH, OVER = 210e3, 0.3, 20.0, 40.0, 12.0, 0.02


def pressed():
    """Plane strain, u = A r + B / r with u(INNER) = OVER and no stress outside."""
    B = OVER / ((1 - 2 * NU) * INNER / OUTER**2 + 1 / INNER)
    A = (1 - 2 * NU) * B / OUTER**2
    return {"u outside": A * OUTER + B / OUTER, "hoop stress outside": E / (1 + NU) * (A / (1 - 2 * NU) + B / OUTER**2)}


@case(id="press_fit", title="Hub on a shaft that is too thick",
      geometry="Whole ring, radii 20 and 40 mm, 12 mm long, between guided planes; its bore is moved outwards by 0.02 mm (fixed = \"radial\")",
      material="E = 210 GPa, ν = 0.3", source="Lamé; Timoshenko & Goodier, Theory of Elasticity, 3rd ed. (1970), art. 28",
      unit={"u outside": "mm", "hoop stress outside": "MPa"}, exact=pressed, grids=(7.0, 5.0, 3.5),
      tolerance={"u outside": 2e-3, "hoop stress outside": 0.015})
def press_fit(run, span):
    quarters = [parts.wedge(INNER, OUTER, LENGTH, np.pi / 2, 32)]
    sides = np.abs(quarters[0][:, :, :2]).min(2).max(1) < 1e-9  # the two cuts
    open_quarter = quarters[0][~sides]
    turn = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    ring = [open_quarter]
    for _ in range(3):
        ring.append(ring[-1] @ turn.T)
    ring = np.concatenate(ring) + 0.0
    run.surface("bore", parts.where(ring, lambda x: np.abs(np.hypot(x[:, 0], x[:, 1]) - INNER) < 1e-6 * INNER))
    run.model(ring, span)
    report = run.solve("static", {
        "material": {"E": E, "nu": NU},
        "support": [{"name": "shaft", "fixed": "radial", "value": OVER, "patch": "bore.stl"}, plane("low", AXES[2]),
                    plane("high", AXES[2], (0, 0, LENGTH)),
                    {"name": "no turn", "fixed": "y", "at": [OUTER, 0, LENGTH / 2], "method": "penalty"}],
        "probe": [{"name": "outside", "position": [0, OUTER, LENGTH / 2]}]})
    outside = probe(report, "outside")
    return {"u outside": outside["displacement"][1], "hoop stress outside": outside["stress"][0]}


# ---------------------------------------------------------------------------------------------------------- anisotropy

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
WOOD = {"E": (12000.0, 900.0, 500.0), "nu": (0.4, 0.3, 0.45), "G": (700.0, 60.0, 800.0)}  # along L, R, T; nu and G of LR, RT, LT
ANGLES, STRESS, SIZE = (25.0, 40.0), 10.0, (60.0, 30.0, 20.0)


def turned_compliance():
    """Compliance 6 × 6 (shear strains as angles) of spruce-like wood turned about z, then x."""
    e, nu, g = WOOD["E"], WOOD["nu"], WOOD["G"]
    S = np.diag([1 / e[0], 1 / e[1], 1 / e[2], 1 / g[0], 1 / g[1], 1 / g[2]])
    S[0, 1] = S[1, 0] = -nu[0] / e[0]
    S[1, 2] = S[2, 1] = -nu[1] / e[1]
    S[2, 0] = S[0, 2] = -nu[2] / e[0]
    full = np.zeros((3, 3, 3, 3))
    for i, (a, b) in enumerate(PAIRS):
        for j, (c, d) in enumerate(PAIRS):
            share = (1 if i < 3 else 2) * (1 if j < 3 else 2)
            for p, q in {(a, b), (b, a)}:
                for r, s in {(c, d), (d, c)}:
                    full[p, q, r, s] = S[i, j] / share
    a, b = np.radians(ANGLES)
    turn = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]]) @ np.array(
        [[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    full = np.einsum("pi,qj,rk,sl,ijkl->pqrs", turn, turn, turn, turn, full)
    return np.array([[full[p, q, r, s] * (1 if i < 3 else 2) * (1 if j < 3 else 2) for j, (r, s) in enumerate(PAIRS)]
                     for i, (p, q) in enumerate(PAIRS)])


def pulled_wood():
    """Strains of a pull along x; the corner at the origin does not move, the edges to x and y turn as the supports let them."""
    S = turned_compliance()
    strain = STRESS * S[:, 0]
    return {"u along the pull": strain[0] * SIZE[0], "u at the side": strain[3] * SIZE[1], "w on top": strain[2] * SIZE[2]}


@case(id="anisotropic_pull", title="Pull on wood whose grain runs askew", quick=True,
      geometry="Block 60 × 30 × 20 mm turned by 20 degrees about (1, 1, 1) against the grid, pulled along x by 10 MPa; held at three corners",
      material="orthotropic, 12, 0.9 and 0.5 GPa, turned by 25 and 40 degrees: a full 6 × 6 matrix", source="homogeneous strain: compliance times stress",
      unit="mm", exact=pulled_wood, grids=(18.0, 12.0, 8.0), tolerance=1e-7, notes="Splines hold the solution: a patch test")
def anisotropic_pull(run, span):
    run.model(parts.box((0, 0, 0), SIZE), span, 2, "--rotate-axis-angle", 1, 1, 1, 20)
    corners = {"origin": ([0, 0, 0], "xyz"), "x": ([SIZE[0], 0, 0], "yz"), "y": ([0, SIZE[1], 0], "z")}
    report = run.solve("static", {
        "material": {"C": np.linalg.inv(turned_compliance()).ravel()},
        "support": [{"name": name, "fixed": fixed, "at": at, "method": "penalty"} for name, (at, fixed) in corners.items()],
        "load": [{"name": "pull", "traction": [STRESS, 0, 0], "plane": {"point": [SIZE[0], 0, 0], "normal": [1, 0, 0]}},
                 {"name": "pull back", "traction": [-STRESS, 0, 0], "plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}],
        "probe": [{"name": "x", "position": [SIZE[0], 0, 0]}, {"name": "y", "position": [0, SIZE[1], 0]},
                  {"name": "z", "position": [0, 0, SIZE[2]]}]})
    u = {name: probe(report, name)["displacement"] for name in "xyz"}
    return {"u along the pull": u["x"][0], "u at the side": u["y"][0], "w on top": u["z"][2]}


# ----------------------------------------------------------------------------------------------------- hole in a strip

RADIUS, HALF_WIDTH, HALF_LENGTH, THICK = 10.0, 50.0, 90.0, 4.0


def strip_with_hole(x):
    """Quarter: from the hole outwards to the rectangle, along the angle with a node on the corner, upwards."""
    corner = np.arctan2(HALF_WIDTH, HALF_LENGTH)
    t = np.where(x[:, 1] < 0.5, 2 * x[:, 1] * corner, corner + (2 * x[:, 1] - 1) * (np.pi / 2 - corner))
    inner = RADIUS * np.stack([np.cos(t), np.sin(t)], 1)
    scale = np.minimum(HALF_LENGTH / np.maximum(np.cos(t), 1e-300), HALF_WIDTH / np.maximum(np.sin(t), 1e-300))
    outer = scale[:, None] * np.stack([np.cos(t), np.sin(t)], 1)
    return np.column_stack([inner + x[:, :1] * (outer - inner), THICK * x[:, 2]])


@case(id="hole_in_a_strip", title="Stress concentration at a hole",
      geometry="Quarter of a strip 180 × 100 × 4 mm with a hole of 20 mm, pulled along x by 100 MPa; stress along x at the hole's side",
      material="E = 210 GPa, ν = 0: the plane problem is exact in three dimensions", source="Howland (1930): 3.14 for a hole of a fifth of the width; "
      "Pilkey & Pilkey, Peterson's Stress Concentration Factors, chart 4.1", unit="MPa", exact=314.0, grids=(3.4, 2.3, 1.6), tolerance=0.02)
def hole_in_a_strip(run, span):
    run.model(parts.block(strip_with_hole, (1, 96, 1)), (span, span, THICK))
    report = run.solve("static", {
        "material": {"E": 210e3, "nu": 0.0}, "support": [plane("x", AXES[0]), plane("y", AXES[1]), plane("z", AXES[2])],
        "load": [{"name": "pull", "traction": [100.0, 0, 0], "plane": {"point": [HALF_LENGTH, 0, 0], "normal": [1, 0, 0]}}],
        "probe": [{"name": "side", "position": [0, RADIUS, THICK / 2]}]})
    return probe(report, "side")["stress"][0]
