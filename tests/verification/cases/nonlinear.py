"""Large displacement and large strain.

`igasolve nonlinear`: Newton's method in load steps, the laws of explicit runs.
"""
import numpy as np
from scipy.integrate import solve_bvp, trapezoid
from scipy.optimize import brentq

from book import case, fem, parts
from book.mixed import Body
from book.run import probe
from igatools import iga_results

plane = lambda name, fixed, point, normal, **more: {  # noqa: E731
    "name": name, "fixed": fixed, "plane": {"point": point, "normal": normal}, **more}


def lame(E, nu):
    return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))


# Cantilever under an end force that keeps its direction. Slender, nu = 0: a beam that neither shears nor stretches, to 1e-3.

LENGTH, DEPTH, BEAM_E = 100.0, 1.0, 12e4   # mm, MPa: E I = 1e4 N mm²
BEND = BEAM_E * DEPTH**4 / 12 / LENGTH**2  # N of P L² / (E I) = 1


def elastica(load):
    """Tip of an inextensible cantilever under P L² / (E I) = load: (w / L, u / L)."""
    def slopes(s, y):
        return np.vstack([y[1], -load * np.cos(y[0])])
    s = np.linspace(0, 1, 201)
    found = solve_bvp(slopes, lambda a, b: np.array([a[0], b[1]]), s, np.vstack([np.arctan(load / 3 * s), 0.5 * (1 - s)]), tol=1e-10,
                      max_nodes=100000)
    t = np.linspace(0, 1, 20001)
    angle = found.sol(t)[0]
    return trapezoid(np.sin(angle), t), 1 - trapezoid(np.cos(angle), t)


def elastica_values():
    (w1, u1), (w10, u10) = elastica(1.0), elastica(10.0)
    return {"w/L, PL²/EI = 1": w1, "w/L, PL²/EI = 10": w10, "u/L, PL²/EI = 10": u10}


def tip_values(first, last):
    """Of the tip's displacements at a tenth of the load and at all of it."""
    return {"w/L, PL²/EI = 1": -first[2] / LENGTH, "w/L, PL²/EI = 10": -last[2] / LENGTH, "u/L, PL²/EI = 10": -last[0] / LENGTH}


@case(id="elastica", title="Cantilever bent far by a force at its end", quick=True,
      geometry="Bar 100 × 1 × 1 mm, clamped, a force across its end that keeps its direction, ten load steps", material="E = 120 GPa, ν = 0, "
      "St. Venant–Kirchhoff",
      source="Euler's elastica, integrated; Mattiasson, Int. J. Numer. Meth. Eng. 17 (1981) 145: 0.30172, 0.81061, 0.55500",
      unit={"w/L, PL²/EI = 1": "1", "w/L, PL²/EI = 10": "1", "u/L, PL²/EI = 10": "1"}, exact=elastica_values, grids=(10.0, 6.0, 4.0),
      tolerance=2e-3, notes="Degree 3; spans of the given length along the bar, one across it.")
def elastica_beam(run, span):
    run.model(parts.box((0, 0, 0), (LENGTH, DEPTH, DEPTH)), (span, DEPTH, DEPTH), 3)
    _, file = run.solve("nonlinear", {
        "material": {"law": "st-venant-kirchhoff", "E": BEAM_E, "nu": 0.0},
        "support": [plane("root", "xyz", [0, 0, 0], [1, 0, 0])],
        "load": [{"name": "tip", "force": [0, 0, -10 * BEND], "plane": {"point": [LENGTH, 0, 0], "normal": [1, 0, 0]}}],
        "probe": [{"name": "tip", "position": [LENGTH, DEPTH / 2, DEPTH / 2]}],
        "nonlinear": {"steps": 10}}, results=True)
    steps = iga_results.read(file)["/time_series/probe/tip/displacement"]
    return tip_values(steps[0], steps[9])


# Uniaxial tension of rubber.

RUBBER_E, RUBBER_NU = 3.0, 0.45


def uniaxial(stretch, E, nu):
    """Nominal stress and the stretch across of the compressible neo-Hookean law."""
    lam, mu = lame(E, nu)
    stress = lambda along, J, other: mu * along + (lam * np.log(J) - mu) / along  # noqa: E731
    across = brentq(lambda b: stress(b, stretch * b * b, stretch), 0.3, 1.5, xtol=1e-14)
    return stress(stretch, stretch * across**2, across), across


@case(id="rubber_bar", title="Rubber bar drawn to twice its length", quick=True,
      geometry="Bar 20 × 10 × 10 mm between three planes of symmetry, dead traction on its end", material="E = 3 MPa, ν = 0.45, neo-Hookean",
      source="the law itself (Bonet & Wood 2008, 6.4.3), its uniaxial state solved for", unit={"u at the end": "mm", "u across": "mm"},
      exact=lambda: {"u at the end": 20.0, "u across": 10 * (uniaxial(2.0, RUBBER_E, RUBBER_NU)[1] - 1)}, grids=(8.0, 5.0, 3.5),
      tolerance=1e-3, notes="A uniform state: the error is what the supports, held by penalty, give way.")
def rubber_bar(run, span):
    run.model(parts.box((0, 0, 0), (20, 10, 10)), span)
    report = run.solve("nonlinear", {
        "material": {"law": "neo-hookean", "E": RUBBER_E, "nu": RUBBER_NU},
        "support": [plane("x", "normal", [0, 0, 0], [1, 0, 0]), plane("y", "normal", [0, 0, 0], [0, 1, 0]),
                    plane("z", "normal", [0, 0, 0], [0, 0, 1])],
        "load": [{"name": "pull", "traction": [uniaxial(2.0, RUBBER_E, RUBBER_NU)[0], 0, 0],
                  "plane": {"point": [20, 0, 0], "normal": [1, 0, 0]}}],
        "probe": [{"name": "end", "position": [20, 5, 5]}, {"name": "side", "position": [10, 10, 5]}],
        "nonlinear": {"steps": 5}})
    return {"u at the end": probe(report, "end")["displacement"][0], "u across": probe(report, "side")["displacement"][1]}


# A thick sphere of rubber inflated by pressure that follows its bore.

BALL_INNER, BALL_OUTER, BALL_PRESSURE = 10.0, 20.0, 0.8


def inflated_sphere(pressure):
    """Radial displacement u(R) of the compressible neo-Hookean sphere: P_rr' + 2 (P_rr - P_tt) / R = 0 in R, r and r'."""
    lam, mu = lame(RUBBER_E, RUBBER_NU)

    def stresses(a, b):  # stretches along and across the radius
        log = np.log(a * b * b)
        return mu * a + (lam * log - mu) / a, mu * b + (lam * log - mu) / b

    def slopes(R, y):
        r, a = y
        b, db = r / R, (a - r / R) / R
        along, across = stresses(a, b)
        by_a, by_b = mu + (lam + mu - lam * np.log(a * b * b)) / a**2, 2 * lam / (a * b)
        return np.vstack([a, (-2 / R * (along - across) - by_b * db) / by_a])

    def ends(low, high):
        inside = stresses(low[1], low[0] / BALL_INNER)[0] + step * (low[0] / BALL_INNER) ** 2  # P_rr = -p (r / R)²
        return np.array([inside, stresses(high[1], high[0] / BALL_OUTER)[0]])

    R = np.linspace(BALL_INNER, BALL_OUTER, 101)
    y = np.vstack([R, np.ones_like(R)])
    for step in np.linspace(0, pressure, 9)[1:]:
        found = solve_bvp(slopes, ends, R, y, tol=1e-9, max_nodes=100000)
        R, y = found.x, found.y
    return found.sol


def sphere_values():
    found = inflated_sphere(BALL_PRESSURE)
    return {"u of the bore": found(BALL_INNER)[0] - BALL_INNER, "u outside": found(BALL_OUTER)[0] - BALL_OUTER}


@case(id="rubber_sphere", title="Thick rubber sphere inflated by pressure",
      geometry="Eighth of a hollow sphere, radii 10 and 20 mm, between planes of symmetry; 0.8 MPa on the bore follow it",
      material="E = 3 MPa, ν = 0.45, neo-Hookean", source="radial equilibrium, a boundary value problem solved to 1e-9",
      unit={"u of the bore": "mm", "u outside": "mm"}, exact=sphere_values, grids=(6.0, 4.5, 3.5),
      tolerance=1e-2)
def rubber_sphere(run, span):
    shell = parts.octant(BALL_INNER, BALL_OUTER, 24)
    run.surface("bore", parts.where(shell, lambda x: np.linalg.norm(x, axis=1) < BALL_INNER * (1 + 1e-6)))
    run.model(shell, span)
    along = np.ones(3) / np.sqrt(3)
    report = run.solve("nonlinear", {
        "material": {"law": "neo-hookean", "E": RUBBER_E, "nu": RUBBER_NU},
        "support": [plane(axis, "normal", [0, 0, 0], list(np.eye(3)[k])) for k, axis in enumerate("xyz")],
        "load": [{"name": "pressure", "pressure": BALL_PRESSURE, "patch": "bore.stl"}],
        "probe": [{"name": "bore", "position": list(BALL_INNER * along)}, {"name": "outside", "position": list(BALL_OUTER * along)}],
        "nonlinear": {"steps": 4}})
    return {"u of the bore": float(along @ probe(report, "bore")["displacement"]),
            "u outside": float(along @ probe(report, "outside")["displacement"])}


# A cylinder between two rigid plates that do not hold it across: a quarter of it, plane strain.

ROLL_RADIUS, ROLL_E, ROLL_NU, APPROACH = 10.0, 200.0, 0.3, 0.2  # mm, MPa; of each plate towards the axis
ROLL_STIFF = ROLL_E / (1 - ROLL_NU**2)


def roll_force():
    """Line force P of the approach P / (π E*) (2 ln(4 R / b) - 1), b² = 4 P R / (π E*)."""
    half_width = lambda P: np.sqrt(4 * P * ROLL_RADIUS / (np.pi * ROLL_STIFF))  # noqa: E731
    approach = lambda P: P / (np.pi * ROLL_STIFF) * (2 * np.log(4 * ROLL_RADIUS / half_width(P)) - 1)  # noqa: E731
    return brentq(lambda P: approach(P) - APPROACH, 1e-3, 1e3)


def quarter_roll(facets):
    """x, z >= 0, y = 0 … 1; facets on its round side."""
    t = np.linspace(0, np.pi / 2, facets + 1)
    low = np.round(ROLL_RADIUS * np.column_stack([np.sin(t), np.zeros_like(t), np.cos(t)]), 12) + 0.0
    high, middle, above = low + [0, 1, 0], np.zeros(3), np.array([0.0, 1.0, 0.0])
    a, b, c, d = low[:-1], low[1:], high[1:], high[:-1]
    m, n = np.broadcast_to(middle, a.shape), np.broadcast_to(above, a.shape)
    return np.concatenate([np.stack([m, a, b], 1), np.stack([n, c, d], 1), np.stack([a, c, b], 1), np.stack([a, d, c], 1),
                           [[middle, high[0], low[0]], [middle, above, high[0]], [middle, low[-1], high[-1]], [middle, high[-1], above]]])


def hertz_by_calculix(run):
    """Half the thickness of ours is of no matter: plane strain. The plate is one brick, a thousand times as stiff."""
    fine = lambda q: 0.8 * q * q + 0.2 * q  # noqa: E731  towards the place of contact

    def mapping(x):
        a, b = fine(x[:, 0]), 1 - fine(1 - x[:, 2])
        return np.column_stack([ROLL_RADIUS * a * np.sqrt(1 - b * b / 2), x[:, 1], ROLL_RADIUS * b * np.sqrt(1 - a * a / 2)])
    mesh = fem.bricks(mapping, (10, 1, 10), "C3D20R")
    x, count, small = mesh.nodes, len(mesh.nodes), 1e-6
    held = [(np.flatnonzero(x[:, 0] < small), "x"), (np.flatnonzero(x[:, 2] < small), "z"), (np.arange(count), "y")]
    rim = (np.hypot(x[:, 0], x[:, 2]) > ROLL_RADIUS - small) & (x[:, 0] < 0.4 * ROLL_RADIUS)
    plate = [(a, b, ROLL_RADIUS + c) for c in (0, 2) for a, b in ((-1, -1), (9, -1), (9, 2), (-1, 2))]
    number = len(mesh.elements) + 1
    corners = {1: (0, 1, 2, 3), 2: (4, 7, 6, 5), 3: (0, 4, 5, 1), 4: (1, 5, 6, 2), 5: (2, 6, 7, 3), 6: (3, 7, 4, 0)}
    fem.solve(run, mesh, [
        *fem.deck(mesh, {"E": ROLL_E, "nu": ROLL_NU}, held),
        "*NODE, NSET=PLATE", *(f"{count + k + 1}, {a:g}, {b:g}, {c:g}" for k, (a, b, c) in enumerate(plate)),
        "*ELEMENT, TYPE=C3D8, ELSET=STIFF", ", ".join(map(str, [number, *range(count + 1, count + 9)])),
        "*MATERIAL, NAME=P", "*ELASTIC", f"{1000 * ROLL_E:g}, 0.", "*SOLID SECTION, ELSET=STIFF, MATERIAL=P",
        "*SURFACE, NAME=RIM, TYPE=ELEMENT",
        *(f"{k + 1}, S{face}" for k, row in enumerate(mesh.elements) for face, at in corners.items() if rim[row[list(at)]].all()),
        "*SURFACE, NAME=FLAT, TYPE=ELEMENT", f"{number}, S1", "*SURFACE INTERACTION, NAME=I",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{500 * ROLL_E:g}", "*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE", "RIM, FLAT",
        "*BOUNDARY", "PLATE, 1, 2", "*STEP, INC=1000", "*STATIC, SOLVER=SPOOLES", "0.25, 1., 1e-4, 0.25", "*BOUNDARY",
        f"PLATE, 3, 3, {-APPROACH:g}", "*NODE PRINT, NSET=PLATE, TOTALS=ONLY", "RF", "*END STEP"])
    return -2 * fem.total_forces(run)[-1][1][2]


@case(id="hertz_cylinder", title="Elastic cylinder pressed by a rigid plate",
      geometry="Quarter of a cylinder, radius 10 mm, plane strain, between planes of symmetry; a plane without friction comes down by 0.2 mm",
      material="E = 200 MPa, ν = 0.3, linear elastic",
      source="Hertz; approach of a plate and the axis after Johnson, Contact Mechanics (1985), 5.6: P / (π E*) (2 ln(4 R / b) − 1), b = 1.14 mm",
      unit="N/mm", exact=roll_force, grids=(1.0, 0.7, 0.5), tolerance=0.01,
      calculix=hertz_by_calculix, calculix_mesh="C3D20R, 10 × 10, finer towards the contact",
      notes="At the coarse grid the half-width of contact is one span. Exact for b ≪ R; here b/R = 0.11.")
def hertz_cylinder(run, span):
    run.model(quarter_roll(100), (span, 1, span))
    report = run.solve("nonlinear", {
        "material": {"law": "linear-elastic", "E": ROLL_E, "nu": ROLL_NU},
        "support": [plane("x", "normal", [0, 0, 0], [1, 0, 0]), plane("y", "normal", [0, 0, 0], [0, 1, 0]),
                    plane("far", "normal", [0, 1, 0], [0, 1, 0]), plane("z", "normal", [0, 0, 0], [0, 0, 1])],
        "rigid_bodies": [{"name": "plate", "shape": "plane", "normal": [0, 0, -1], "centre": [0, 0, ROLL_RADIUS],
                          "drive": {"z": [[0, 0], [1, -APPROACH]]}}],
        "contacts": [{"bodies": ["part", "plate"]}], "nonlinear": {"steps": 1}})
    return -2 * report["contacts"][0]["force"][2]


# A block that one plate presses on a floor and pulls along it.

@case(id="pulled_block", title="Rubber block pressed on a floor and pulled along it", quick=True,
      geometry="Block 10 × 10 × 5 mm on a fixed plane; a plate to which it sticks comes down by 0.5 mm, then moves 1.5 mm sideways",
      material="E = 3 MPa, ν = 0, neo-Hookean, μ = 0.2", source="Coulomb: the pull is μ times the normal force",
      unit={"pull / normal force": "1", "sideways / all loads": "1"}, exact={"pull / normal force": 0.2, "sideways / all loads": 1.0},
      grids=(5.0, 3.5, 2.5), tolerance=1e-3, notes="The second number is the plate's force over the floor's: equilibrium without supports.")
def pulled_block(run, span):
    run.model(parts.box((0, 0, 0), (10, 10, 5)), span)
    report = run.solve("nonlinear", {
        "material": {"law": "neo-hookean", "E": RUBBER_E, "nu": 0.0},
        "rigid_bodies": [{"name": "floor", "shape": "plane", "normal": [0, 0, 1], "centre": [0, 0, 0]},
                         {"name": "plate", "shape": "plane", "normal": [0, 0, -1], "centre": [0, 0, 5],
                          "drive": {"z": [[0, 0], [0.25, -0.5]], "x": [[0.25, 0], [1, 1.5]]}}],
        "contacts": [{"name": "floor", "bodies": ["part", "floor"], "friction": 0.2},
                     {"name": "plate", "bodies": ["part", "plate"], "rough": True}], "nonlinear": {"steps": 8}})
    floor, plate = (contact["force"] for contact in report["contacts"])
    return {"pull / normal force": -floor[0] / floor[2], "sideways / all loads": -plate[0] / floor[0]}


# Steel pressed flat between smooth plates.

BILLET_E, BILLET_NU, YIELD, HARDENING, BILLET_RADIUS, BILLET_HEIGHT = 200e3, 0.3, 700.0, 300.0, 10.0, 15.0  # MPa, mm
BILLET = {"law": "j2", "E": BILLET_E, "nu": BILLET_NU, "yield_stress": YIELD, "hardening_modulus": HARDENING}


def upset_values():
    """The height is 0.4 of what it was: σ = σ_y + H ε_p, ε_p = ln 2.5 - σ/E, area A J / 0.4 with J = exp(-(1 - 2 ν) σ/E)."""
    strain = np.log(2.5)
    stress = (YIELD + HARDENING * strain) / (1 + HARDENING / BILLET_E)
    J = np.exp(-(1 - 2 * BILLET_NU) * stress / BILLET_E)
    return {"force": 1e-3 * stress * np.pi * BILLET_RADIUS**2 * J / 0.4, "u of the side": BILLET_RADIUS * (np.sqrt(J / 0.4) - 1)}


def quarter_cylinder(radius, height):
    """x, y, z >= 0; 24 facets on its round side whose section has the area of the circle."""
    radius = radius * np.sqrt(np.pi / 4 / (12 * np.sin(np.pi / 48)))
    t = np.linspace(0, np.pi / 2, 25)
    low = np.round(radius * np.column_stack([np.cos(t), np.sin(t), np.zeros_like(t)]), 12) + 0.0
    top, axis, above = low + [0, 0, height], np.zeros(3), np.array([0, 0, height])
    a, b, c, d = low[:-1], low[1:], top[1:], top[:-1]
    m, n = np.broadcast_to(axis, a.shape), np.broadcast_to(above, a.shape)
    return np.concatenate([np.stack([m, b, a], 1), np.stack([n, d, c], 1), np.stack([a, b, c], 1), np.stack([a, c, d], 1),
                           [[axis, low[0], top[0]], [axis, top[0], above], [axis, top[-1], low[-1]], [axis, above, top[-1]]]])


def pressed(height, way, **more):
    """Run file of a quarter cylinder on planes of symmetry: `way` is the drive of the plate on it, over the load factor."""
    return {"support": [plane(axis, "normal", [0, 0, 0], list(np.eye(3)[k])) for k, axis in enumerate("xyz")],
            "rigid_bodies": [{"name": "plate", "shape": "plane", "normal": [0, 0, -1], "centre": [0, 0, height], "drive": {"z": way}}],
            "results": {"viewer": False}, **more}


@case(id="upset_billet", title="Billet pressed to 40 % of its height between smooth plates",
      geometry="Cylinder, radius 10, height 15 mm: an eighth between planes of symmetry; a plane without friction comes down in 40 steps",
      material="J2, E = 200 GPa, ν = 0.3, yield stress 700 MPa, hardening 300 MPa",
      source="the law itself: a uniform state, σ = σ_y + H ε_p in true stress and logarithmic strain",
      unit={"force": "kN", "u of the side": "mm"}, exact=upset_values, grids=(6.0, 5.0, 4.0), tolerance=5e-3,
      notes="The billet of the benchmark with rough plates (Lippmann 1979), without friction.")
def upset_billet(run, span):
    part = quarter_cylinder(BILLET_RADIUS, BILLET_HEIGHT / 2)
    run.model(part, span)
    report = run.solve("nonlinear", pressed(
        BILLET_HEIGHT / 2, [[0, 0], [1, -0.6 * BILLET_HEIGHT / 2]], material=BILLET, contacts=[{"bodies": ["part", "plate"]}],
        nonlinear={"steps": 40}, probe=[{"name": "side", "position": [float(part.max()), 0, 0]}]))
    return {"force": -4e-3 * report["contacts"][0]["force"][2], "u of the side": probe(report, "side")["displacement"][0]}


def forces_on_the_plate(file):
    """Of the whole section, at each load step."""
    return -4 * iga_results.read(file)["/time_series/contact/plate/force"][:, 2]


# The same between rough plates, where metal of degree 2 locks.

def rough_billet_by_calculix(run):
    found = fem.pressed_cylinder(run, BILLET_RADIUS, BILLET_HEIGHT / 2, (10, 8),
                                 ["*ELASTIC", f"{BILLET_E}, {BILLET_NU}", "*PLASTIC", f"{YIELD}, 0.", f"{YIELD + 3 * HARDENING}, 3."],
                                 0.3 * BILLET_HEIGHT / 2, 30)
    return {name: 1e-3 * found(share / 0.3) for name, share in ROUGH_SHARES.items()}


ROUGH_SHARES = {"force at 10 %": 0.1, "force at 20 %": 0.2, "force at 30 %": 0.3}


@case(id="rough_billet", title="Billet pressed by 30 % between rough plates",
      geometry="Cylinder, radius 10, height 15 mm: an eighth between planes of symmetry; its end sticks to a plane that comes down in 30 steps",
      material="J2, E = 200 GPa, ν = 0.3, yield stress 700 MPa, hardening 300 MPa; locking = \"fbar\"",
      source="CalculiX 2.20, axisymmetric CAX8R, 10 × 8, 20 × 16 and 30 × 24 elements (30 %: 399, 380 and 375 kN), extrapolated in 1/n: "
      "no exact value is known",
      unit="kN", exact={"force at 10 %": 276.0, "force at 20 %": 319.0, "force at 30 %": 362.0},
      grids=(5.0, 4.0, 3.0), tolerance={"force at 10 %": 0.01, "force at 20 %": 0.04, "force at 30 %": 0.1}, known=0.01, calculix=rough_billet_by_calculix, calculix_mesh="CAX8R, 10 × 8",
      notes="Only the end touches the plate, as in CalculiX, where the side goes on through it: the more so the smaller the elements at the rim are, and "
      "forces fall with them. Without F-bar the run stalls at some 10 % (p = 2).")
def rough_billet(run, span):
    run.model(quarter_cylinder(BILLET_RADIUS, BILLET_HEIGHT / 2), span, 2, "--region-angle", "30")
    _, file = run.solve("nonlinear", pressed(
        BILLET_HEIGHT / 2, [[0, 0], [1, -0.3 * BILLET_HEIGHT / 2]], material=BILLET, locking="fbar", nonlinear={"steps": 30},
        contacts=[{"name": "plate", "bodies": ["part", "plate"], "rough": True, "first_regions": ["part/2"]}]), results=True)
    forces = forces_on_the_plate(file)
    return {name: 1e-3 * forces[round(100 * share) - 1] for name, share in ROUGH_SHARES.items()}


# A rubber disc bonded to plates.

DISC_RADIUS, DISC_HEIGHT, DISC_E, DISC_NU = 10.0, 10.0, 3.0, 0.4999
DISC_UNITS = {"force / (A ε), ε = 0.1 %": "MPa", "force at 5 %": "N", "force at 10 %": "N"}


def disc_values():
    """Mixed elements that follow the disc, finer towards the rim of the bonded face."""
    lam, mu = lame(DISC_E, DISC_NU)
    half = DISC_HEIGHT / 2
    body = Body(lambda x: np.column_stack([DISC_RADIUS * (1 - (1 - x[:, 0]) ** 1.5), half * (1 - (1 - x[:, 1]) ** 1.5)]), (10, 10), mu, lam, True)
    axis, low, top = body.unit[:, 0] == 0, body.unit[:, 1] == 0, body.unit[:, 1] == 1
    force = lambda share: -body.solve([(axis, 0, 0), (low, 1, 0), (top, 0, 0), (top, 1, -share * half)])[top, 1].sum()  # noqa: E731
    forces = [force(share) for share in (0.001, 0.025, 0.05, 0.075, 0.1)]
    return dict(zip(DISC_UNITS, (forces[0] / (np.pi * DISC_RADIUS**2 * 0.001), forces[2], forces[4])))


def disc_by_calculix(run):
    lam, mu = lame(DISC_E, DISC_NU)
    rubber = ["*HYPERELASTIC, NEO HOOKE", f"{mu / 2:.12g}, {2 / (lam + 2 * mu / 3):.12g}"]
    found = fem.pressed_cylinder(run, DISC_RADIUS, DISC_HEIGHT / 2, (12, 6), rubber, 0.1 * DISC_HEIGHT / 2, 20)
    return dict(zip(DISC_UNITS, (found(0.05) / (np.pi * DISC_RADIUS**2 * 0.005), found(0.5), found(1.0))))


@case(id="rubber_disc", title="Rubber disc pressed between plates to which it is bonded",
      geometry="Disc, radius 10, height 10 mm: an eighth between planes of symmetry; a rough plane comes down by 10 %",
      material="E = 3 MPa, ν = 0.4999, neo-Hookean", unit=DISC_UNITS, exact=disc_values, grids=(5.0, 2.5, 5 / 3), tolerance=0.02, known=2e-3,
      source="axisymmetric mixed elements (Q2/P1, `book/mixed.py`) of the same law, converged to 0.2 %; Gent and Lindley (1959), who take the pressure "
      "for a parabola: E (1 + 2 S²) = 4.5 MPa, S = 0.5", calculix=disc_by_calculix, calculix_mesh="CAX8R, 12 × 6, secant at 0.5 %",
      notes="The rim of the bonded face is singular. Without F-bar the errors of the first row are +11, +14 and +14 %.")
def rubber_disc(run, span):
    half = DISC_HEIGHT / 2
    run.model(quarter_cylinder(DISC_RADIUS, half), span)
    _, file = run.solve("nonlinear", pressed(
        half, [[0, 0], [0.25, -0.001 * half], [0.5, -0.05 * half], [1, -0.1 * half]],
        material={"law": "neo-hookean", "E": DISC_E, "nu": DISC_NU}, nonlinear={"steps": 4},
        contacts=[{"name": "plate", "bodies": ["part", "plate"], "rough": True, "stiffness": 1000}]), results=True)
    forces = forces_on_the_plate(file)
    return dict(zip(DISC_UNITS, (forces[0] / (np.pi * DISC_RADIUS**2 * 0.001), forces[1], forces[3])))


# Cook's membrane, nearly incompressible.

COOK_UNITS = {"w, F = 1": "mm", "w, F = 100": "mm"}


@case(id="cook", title="Cook's membrane of rubber", quick=True,
      geometry="Trapezoid of corners (0, 0), (48, 44), (48, 60), (0, 44) mm, plane strain, 1 mm thick; clamped at x = 0, shear 1 and 100 N over the other "
      "end; deflection at its middle", material="ν = 0.4999, neo-Hookean, E = 250 MPa for 1 N and 240.565 MPa for 100 N",
      source="mixed elements (Q2/P1, `book/mixed.py`), converged to 5e-4. They give 7.73 … 7.77 mm (100 times the first load) for the upper corner, where 7.769 is "
      "published", unit=COOK_UNITS, exact={"w, F = 1": 0.07406, "w, F = 100": 6.9593}, grids=(8.0, 5.0, 3.5), tolerance=0.01, known=5e-4,
      notes="The upper corner itself, where traction meets a free edge, converges slowly in both.")
def cook(run, span):
    def mapping(x):
        return np.column_stack([48 * x[:, 0], 44 * x[:, 0] * (1 - x[:, 1]) + (44 + 16 * x[:, 0]) * x[:, 1], x[:, 2]])
    run.model(parts.block(mapping, (1, 1, 1)), (span, span, 1.0))
    found = {}
    for name, E, force, steps in (("w, F = 1", 250.0, 1.0, 1), ("w, F = 100", 240.565, 100.0, 2)):
        report = run.solve("nonlinear", {
            "material": {"law": "neo-hookean", "E": E, "nu": 0.4999},
            "support": [plane("root", "xyz", [0, 0, 0], [1, 0, 0]), plane("front", "z", [0, 0, 0], [0, 0, 1]),
                        plane("back", "z", [0, 0, 1], [0, 0, 1])],
            "load": [{"name": "end", "traction": [0, force / 16, 0], "plane": {"point": [48, 0, 0], "normal": [1, 0, 0]}}],
            "probe": [{"name": "middle", "position": [48, 52, 0.5]}], "nonlinear": {"steps": steps}})
        found[name] = probe(report, "middle")["displacement"][1]
    return found
