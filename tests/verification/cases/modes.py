"""Effective masses, springs, added masses.

Rods and blocks whose frequencies follow from one transcendental equation or none; modes are told by the mass that they move.
"""
import numpy as np

from book import case, exact, fem, parts

ROD = {"E": 200e9, "nu": 0.0, "rho": 8000.0}
ROD_WORDS = "E = 200 GPa, ν = 0, ρ = 8000 kg/m³"
LENGTH, SIDE = 2.0, 0.2
AREA, SPEED = SIDE**2, np.sqrt(ROD["E"] / ROD["rho"])
ROD_MASS = ROD["rho"] * AREA * LENGTH
LOW = {"point": [0, 0, 0], "normal": [1, 0, 0]}
HIGH = {"point": [LENGTH, 0, 0], "normal": [1, 0, 0]}


def plane(name, normal, fixed="normal"):
    return {"name": name, "fixed": fixed, "plane": {"point": [0, 0, 0], "normal": normal}}


GUIDES = [plane("y", [0, 1, 0]), plane("z", [0, 0, 1])]
CLAMP = plane("end", [1, 0, 0])


def moving(report, direction, least=1e-3):
    """Frequencies and effective masses, as shares of the total, of the modes that move mass in a direction: 0 … 2 translations along
    x, y, z, 3 … 5 rotations about them."""
    found = report["participation"]
    shares = np.array(found["effective_masses"])[:, direction] / found["total"][direction]
    return [(f, share) for f, share in zip(report["frequencies"], shares) if share > least]


def rod(span, run):
    run.model(parts.box((0, 0, 0), (LENGTH, SIDE, SIDE)), span, 3)


def named(values):
    return dict(zip(("first", "second", "third"), values))


@case(id="effective_masses", title="Effective masses of a clamped rod, stretching", quick=True,
      geometry="Rod 2 × 0.2 × 0.2 m, one end held along its axis, two sides guided; shares of the mass of its first modes along the axis",
      material=ROD_WORDS, source="8 / (π (2 n - 1))², from u = sin((2 n - 1) π x / 2 L)", unit="1",
      exact=lambda: named(8 / (np.pi * (2 * n - 1))**2 for n in (1, 2, 3)), grids=(0.45, 0.3, 0.2), tolerance=5e-5)
def effective_masses(run, span):
    rod(span, run)
    report = run.solve("eigen", {"material": ROD, "support": [CLAMP, *GUIDES], "eigen": {"modes_below": 1.45 * SPEED / LENGTH}})
    return named(share for _, share in moving(report, 0)[:3])


def frequencies_of(equation):
    """The first two of a rod, from the roots x = ω L / c."""
    return named(x * SPEED / (2 * np.pi * LENGTH) for x in exact.roots(equation, 1e-6, 6)[:2])


SPRING = 0.5 * ROD["E"] * AREA / LENGTH


@case(id="rod_on_spring", title="Rod on an end spring, stretching", quick=True,
      geometry="Rod 2 × 0.2 × 0.2 m, two sides guided, one end on a spring of half its own stiffness, spread over the face",
      material=ROD_WORDS, source="x tan x = k L / (E A), x = ω L / c", unit="Hz",
      exact=lambda: frequencies_of(lambda x: x * np.sin(x) - 0.5 * np.cos(x)), grids=(0.45, 0.3, 0.2), tolerance=2e-6)
def rod_on_spring(run, span):
    rod(span, run)
    report = run.solve("eigen", {"material": ROD, "support": GUIDES, "eigen": {"modes_below": 0.7 * SPEED / LENGTH},
                                 "spring": [{"name": "end", "plane": LOW, "stiffness": [SPRING, 0, 0]}]})
    return named(f for f, _ in moving(report, 0)[:2])


@case(id="rod_with_mass", title="Rod with a mass at its end, stretching", quick=True,
      geometry="Rod 2 × 0.2 × 0.2 m, one end held along its axis, two sides guided, a rigid body of half its mass on the other end",
      material=ROD_WORDS, source="x tan x = m / M, x = ω L / c", unit="Hz",
      exact=lambda: frequencies_of(lambda x: x * np.sin(x) - 2 * np.cos(x)), grids=(0.45, 0.3, 0.2), tolerance=2e-6)
def rod_with_mass(run, span):
    rod(span, run)
    report = run.solve("eigen", {"material": ROD, "support": [CLAMP, *GUIDES], "eigen": {"modes_below": 0.8 * SPEED / LENGTH},
                                 "added_mass": [{"name": "load", "mass": 0.5 * ROD_MASS, "at": [LENGTH, SIDE / 2, SIDE / 2], "plane": HIGH}]})
    return named(f for f, _ in moving(report, 0)[:2])


BLOCK, BED = (0.3, 0.4, 0.2), 1e6  # N/m³


def block_frequencies():
    x, y, z = BLOCK
    mass = STIFF["rho"] * x * y * z
    rock = lambda long, inertia: BED * (x * y * long**2 / 12) / inertia  # noqa: E731
    squares = {"hopping": BED * x * y / mass, "rocking about x": rock(y, mass * (y * y + z * z) / 12),
               "rocking about y": rock(x, mass * (x * x + z * z) / 12)}
    return {name: np.sqrt(value) / (2 * np.pi) for name, value in squares.items()}


STIFF = {"E": 200e12, "nu": 0.3, "rho": 8000.0}


@case(id="block_on_foundation", title="Stiff block on an elastic foundation", quick=True,
      geometry="Block 0.3 × 0.4 × 0.2 m on a bed of 1 MN/m³ along its normal, free to slide; three rigid motions stay free",
      material="E = 200 TPa (rigid to 1e-9), ν = 0.3, ρ = 8000 kg/m³",
      source="rigid body: ω² = k A / m, and k ∫ y² dA over the moment of inertia about the centre of mass", unit="Hz", exact=block_frequencies,
      grids=(0.2, 0.13, 0.09), tolerance=1e-6)
def block_on_foundation(run, span):
    run.model(parts.box((0, 0, 0), BLOCK), span)
    report = run.solve("eigen", {"material": STIFF, "eigen": {"modes": 3}, "spring": [
        {"name": "bed", "plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}, "normal_stiffness": BED}]})
    by_motion = {"hopping": 2, "rocking about x": 3, "rocking about y": 4}
    elastic = report["frequencies"][report["rigid_modes"]:]
    shares = np.array(report["participation"]["effective_masses"])[report["rigid_modes"]:] / report["participation"]["total"]
    return {name: elastic[int(np.argmax(shares[:, d]))] for name, d in by_motion.items()}


BEAM_LENGTH, TIP_SHARE = 4.0, 0.5
BEAM_MASS = ROD["rho"] * AREA * BEAM_LENGTH


def cantilever_frequencies():
    """Timoshenko's beam: (w, φ, M, Q)' = A (w, φ, M, Q), clamped at 0; a mass at the other end has Q = ω² M w, M = 0."""
    from scipy.linalg import expm
    EI, GA, rho = ROD["E"] * SIDE**4 / 12, 5 / 6 * ROD["E"] / 2 * AREA, ROD["rho"]

    def end(omega):
        A = np.array([[0, 1, 0, 1 / GA], [0, 0, 1 / EI, 0], [0, -rho * SIDE**4 / 12 * omega**2, 0, -1], [-rho * AREA * omega**2, 0, 0, 0]])
        scale = np.array([BEAM_LENGTH, 1, EI / BEAM_LENGTH, EI / BEAM_LENGTH**2])
        T = expm(A * BEAM_LENGTH) * scale[None, :] / scale[:, None]
        tip = TIP_SHARE * BEAM_MASS * omega**2 * scale[0] / scale[3]
        return np.linalg.det([T[2, 2:], T[3, 2:] - tip * T[0, 2:]])
    unit = np.sqrt(EI / (rho * AREA)) / BEAM_LENGTH**2
    return named(omega / (2 * np.pi) for omega in exact.roots(end, 0.1 * unit, 60 * unit)[:2])


def cantilever_in_bricks(run):
    mesh = fem.bricks(lambda x: x * (BEAM_LENGTH, SIDE, SIDE), (16, 2, 2))
    tip = mesh.at(lambda x: np.abs(x[:, 0] - BEAM_LENGTH) < 1e-9)
    count = len(mesh.nodes)
    held = [(mesh.at(lambda x: np.abs(x[:, 0]) < 1e-9), "xyz"), (mesh.at(lambda x: np.abs(x[:, 2] - SIDE / 2) < 1e-9), "z")]
    lines = fem.deck(mesh, ROD, held)
    centre = f"{BEAM_LENGTH}, {SIDE / 2}, {SIDE / 2}"
    body = ["*NODE", f"{count + 1}, {centre}", f"{count + 2}, {centre}", "*NSET, NSET=TIP", *(f"{n + 1}," for n in tip),
            "*ELEMENT, TYPE=MASS, ELSET=LOAD", f"{len(mesh.elements) + 1}, {count + 1}", "*MASS, ELSET=LOAD", f"{TIP_SHARE * BEAM_MASS:.12g}",
            f"*RIGID BODY, NSET=TIP, REF NODE={count + 1}, ROT NODE={count + 2}"]
    first = next(k for k, line in enumerate(lines) if line.startswith("*BOUNDARY"))
    fem.solve(run, mesh, [*lines[:first], *body, *lines[first:], "*STEP", "*FREQUENCY, SOLVER=SPOOLES", "2", "*END STEP"])
    from igatools import calculix
    return named(calculix.read_frequencies(run.folder / "fem.dat"))


@case(id="cantilever_with_mass", title="Cantilever with a mass at its tip, bending", quick=True,
      geometry="Beam 4 × 0.2 × 0.2 m, one end clamped, bending in one plane, a rigid body of half its mass without inertia on the other end",
      material=ROD_WORDS, source="Timoshenko beam, shear factor 5/6, end mass; transfer matrix evaluated here", unit="Hz",
      exact=cantilever_frequencies, grids=(0.55, 0.4, 0.28), tolerance=1e-3)
def cantilever_with_mass(run, span):
    run.model(parts.box((0, 0, 0), (BEAM_LENGTH, SIDE, SIDE)), span, 3)
    report = run.solve("eigen", {
        "material": ROD, "support": [plane("clamp", [1, 0, 0], "xyz"), {"name": "middle", "fixed": "normal", "plane": {"point": [0, 0, 0],
                                                                                                                "normal": [0, 0, 1]}}],
        "eigen": {"modes": 2},
        "added_mass": [{"name": "load", "mass": TIP_SHARE * BEAM_MASS, "at": [BEAM_LENGTH, SIDE / 2, SIDE / 2],
                        "plane": {"point": [BEAM_LENGTH, 0, 0], "normal": [1, 0, 0]}}]})
    return named(report["frequencies"][:2])


SHAFT = {"E": 200e9, "nu": 0.3, "rho": 8000.0}
RADIUS, SHAFT_LENGTH = 0.25, 2.0
SHAFT_INERTIA = SHAFT["rho"] * np.pi * RADIUS**4 / 2 * SHAFT_LENGTH


@case(id="shaft_with_disc", title="Shaft with a disc at its end, torsion",
      geometry="Round shaft of radius 0.25 m, 2 m long, one end clamped, on the other a rigid disc with the moment of inertia of the whole shaft",
      material="E = 200 GPa, ν = 0.3, ρ = 8000 kg/m³", source="x tan x = J_shaft / J_disc, x = ω L / c_s, exact in three dimensions", unit="Hz",
      exact=lambda: exact.roots(lambda x: x * np.sin(x) - np.cos(x), 0.1, 1.5)[0] * np.sqrt(SHAFT["E"] / 2.6 / SHAFT["rho"])
      / (2 * np.pi * SHAFT_LENGTH), grids=(0.25, 0.18, 0.13), tolerance=1e-3)
def shaft_with_disc(run, span):
    run.model(parts.cylinder(RADIUS, SHAFT_LENGTH, 128), span)
    J = SHAFT_INERTIA
    report = run.solve("eigen", {"material": SHAFT, "support": [plane("clamp", [0, 0, 1], "xyz")], "eigen": {"modes": 6}, "added_mass": [
        {"name": "disc", "mass": 1000.0, "inertia": [J / 2, J / 2, J], "at": [0, 0, SHAFT_LENGTH],
         "plane": {"point": [0, 0, SHAFT_LENGTH], "normal": [0, 0, 1]}}]})
    return moving(report, 5, 0.3)[0][0]


@case(id="blocks_on_spring", title="Two stiff blocks joined by a spring", quick=True,
      geometry="Blocks 0.3 × 0.4 × 0.2 m and 0.2 × 0.4 × 0.2 m, 0.1 m apart, free; an axial spring between the facing sides; 11 rigid motions",
      material="E = 200 TPa (rigid to 1e-9), ν = 0.3, ρ = 8000 kg/m³", source="ω² = k (1 / m₁ + 1 / m₂)", unit="Hz",
      exact=lambda: np.sqrt(1e6 * (1 / (8000 * 0.024) + 1 / (8000 * 0.016))) / (2 * np.pi), grids=(0.2, 0.13, 0.09), tolerance=1e-6)
def blocks_on_spring(run, span):
    run.model(parts.box((0, 0, 0), BLOCK), span, name="first")
    run.model(parts.box((0.4, 0, 0), (0.6, 0.4, 0.2)), span, name="second")
    report = run.solve("eigen", {
        "material": STIFF, "bodies": [{"name": "first", "model": "first.h5"}, {"name": "second", "model": "second.h5"}],
        "eigen": {"modes": 1}, "spring": [{"name": "coil", "body": "first", "plane": {"point": [0.3, 0, 0], "normal": [1, 0, 0]}, "axial": 1e6,
                                           "to": {"body": "second", "plane": {"point": [0.4, 0, 0], "normal": [1, 0, 0]}}}]})
    if report["rigid_modes"] != 11:
        raise ValueError(f"{report['rigid_modes']} rigid modes, expected 11")
    return report["frequencies"][11]
