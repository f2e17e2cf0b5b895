"""Buckling and vibration of loaded parts.

Columns, a plate and a bar whose loads are known from Euler, Bryan and Timoshenko, with the shear that solid parts have.
"""
import numpy as np

from book import case, fem, parts
from book.run import elastic

E, RHO = 210e3, 7.85e-9          # MPa, t/mm³
THICK, WIDE, LONG = 6.0, 10.0, 120.0
SHEAR = 5 / 6                    # of a rectangle
STEEL = "E = 210 GPa, ν = 0"
STRAIN = "Euler leaves out the work of the stress on the strains of bending: 1 less σ/E, 5e-4 here, which solid models have"


def face(name, point, normal, fixed="xyz", **more):
    return {"name": name, "fixed": fixed, "plane": {"point": point, "normal": normal}, **more}


def on_plane(point, normal, **load):
    return {"plane": {"point": point, "normal": normal}, **load}


def euler(length, thick, wide, nu=0.0):
    """Buckling force between hinges, less what shear takes (Engesser)."""
    straight = np.pi**2 * E * wide * thick**3 / 12 / length**2
    return straight / (1 + straight / (SHEAR * E / (2 * (1 + nu)) * wide * thick))


def buckling_factors(run, mesh, material, held, forces, count=1):
    """CalculiX: the first factors on the forces."""
    loaded = np.argwhere(np.abs(forces) > 1e-12 * np.abs(forces).max())
    fem.solve(run, mesh, [*fem.deck(mesh, material, held), "*STEP", "*BUCKLE, SOLVER=SPOOLES", f"{count}, 1e-6", "*CLOAD",
                          *(f"{n + 1}, {d + 1}, {forces[n, d]:.12g}" for n, d in loaded), "*END STEP"])
    lines = (run.folder / "fem.dat").read_text().splitlines()
    words = [line.split() for line in lines]
    return [float(row[1]) for row in words if len(row) == 2 and row[0].isdigit()][:count]


def clamped_column_fem(run):
    mesh = fem.bricks(lambda x: x * [WIDE, THICK, LONG], (2, 1, 14))
    top = lambda x: np.isclose(x[:, 2], LONG)  # noqa: E731
    return buckling_factors(run, mesh, {"E": E, "nu": 0}, [(mesh.at(lambda x: np.isclose(x[:, 2], 0)), "xyz")],
                            mesh.forces(top, [0, 0, -1 / (WIDE * THICK)]))[0]


@case(id="column_clamped_free", title="Column, clamped and free", quick=True,
      geometry="Bar 10 × 6 × 120 mm, foot clamped, head pressed along its axis", material=STEEL,
      source="Euler: π² E I / 4 L²; shear: Engesser (1891)", unit="N", exact=lambda: euler(2 * LONG, THICK, WIDE),
      grids=(12.0, 8.0, 5.0), tolerance=1e-3, calculix=clamped_column_fem, calculix_mesh="C3D20, 2 × 1 × 14",
      notes=STRAIN)
def clamped_column(run, span):
    run.model(parts.box((0, 0, 0), (WIDE, THICK, LONG)), span)
    report = run.solve("buckling", {
        "material": {"E": E, "nu": 0.0}, "support": [face("foot", [0, 0, 0], [0, 0, 1])],
        "load": [on_plane([0, 0, LONG], [0, 0, 1], name="press", force=[0, 0, -1.0])], "buckling": {"factors": 2}})
    return report["factors"][0]


def hinged(force, **more):
    """Upper half of a bar between hinges: its middle is a plane of symmetry, its end is held sideways."""
    return {"material": {"E": E, "nu": 0.0, "rho": RHO},
            "support": [face("middle", [0, 0, 0], [0, 0, 1], "normal"), face("end", [0, 0, LONG], [0, 0, 1], "xy")],
            "load": [on_plane([0, 0, LONG], [0, 0, 1], name="axial", force=[0, 0, force])], **more}


@case(id="column_hinged", title="Column between hinges",
      geometry="Bar 10 × 6 × 240 mm between hinges, its upper half: middle on a plane of symmetry, end held sideways", material=STEEL,
      source="Euler: π² E I / L²; shear: Engesser (1891)", unit="N", exact=lambda: euler(2 * LONG, THICK, WIDE),
      grids=(12.0, 8.0, 5.0), tolerance=1e-3, notes=STRAIN)
def hinged_column(run, span):
    run.model(parts.box((0, 0, 0), (WIDE, THICK, LONG)), span)
    return run.solve("buckling", hinged(-1.0, buckling={"factors": 1}))["factors"][0]


PLATE, PLATE_THICK, NU = 300.0, 10.0, 0.3


def plate_stress():
    """Hard simple supports, uniaxial: k = 4, with Mindlin's shear."""
    D = E * PLATE_THICK**3 / (12 * (1 - NU**2))
    shear = D * 2 * (np.pi / PLATE)**2 / (SHEAR * E / (2 * (1 + NU)) * PLATE_THICK)
    return 4 * np.pi**2 * D / (PLATE**2 * PLATE_THICK) / (1 + shear)


@case(id="plate_buckling", title="Square plate under uniaxial compression, hard simple supports", quick=True,
      geometry="Plate 300 × 300 × 10 mm; a quarter between planes of symmetry. Edges held across the plate and along themselves, "
               "but for the displacements of the uniform compression", material="E = 210 GPa, ν = 0.3",
      source="Bryan: k = 4; shear: Mindlin, k_s = 5/6", unit="MPa", exact=plate_stress, grids=(50.0, 30.0, 20.0), tolerance=2e-3,
      notes="The exact value is that of plate theory; solid plates differ by (t/a)² in the mean, 2e-3 here")
def plate(run, span):
    a, half = PLATE / 2, PLATE_THICK / 2
    run.model(parts.box((0, 0, -half), (a, a, half)), span)
    strain = -1 / E  # 1 MPa
    field = {"gradient": [strain, 0, 0, 0, -NU * strain, 0, 0, 0, -NU * strain]}
    report = run.solve("buckling", {
        "material": {"E": E, "nu": NU},
        "support": [face("x middle", [0, 0, 0], [1, 0, 0], "normal"), face("y middle", [0, 0, 0], [0, 1, 0], "normal"),
                    face("loaded edge", [a, 0, 0], [1, 0, 0], "yz", **field), face("side", [0, a, 0], [0, 1, 0], "xz", **field)],
        "load": [on_plane([a, 0, 0], [1, 0, 0], name="press", traction=[-1.0, 0, 0])], "buckling": {"factors": 1}})
    return report["factors"][0]


def tensioned_frequencies():
    """Simply supported Timoshenko beam under an axial force; to first order in (t/L)²."""
    area, inertia, k = WIDE * THICK, WIDE * THICK**3 / 12, np.pi / (2 * LONG)
    thickness = 1 + k**2 * inertia / area * (1 + 2 / SHEAR)
    bending = k**4 * E * inertia / (RHO * area) / thickness
    force = np.pi**2 * E * inertia / (2 * LONG)**2
    return {f"at {name}": np.sqrt(bending + share * force * k**2 / (RHO * area)) / (2 * np.pi) for name, share in SHARES.items()}


SHARES = {"half the buckling load": -0.5, "rest": 0.0, "a pull of twice that": 2.0}


@case(id="bar_under_tension", title="Bending frequency of a bar under an axial force", quick=True,
      geometry="Bar 10 × 6 × 240 mm between hinges, its upper half, as above; forces -½, 0 and 2 times π² E I / L²",
      material=STEEL + ", ρ = 7850 kg/m³", source="Timoshenko & Young, Vibration Problems in Engineering: ω² = (π/L)⁴ E I/ρ A · (1 + P L²/π² E I)",
      unit="Hz", exact=tensioned_frequencies, grids=(12.0, 8.0, 5.0), tolerance=5e-4)
def bar_under_tension(run, span):
    run.model(parts.box((0, 0, 0), (WIDE, THICK, LONG)), span)
    force = np.pi**2 * E * WIDE * THICK**3 / 12 / (2 * LONG)**2
    return {f"at {name}": elastic(run.solve("eigen", hinged(share * force or 1e-9, eigen={"modes": 1, "prestress": True})))[0]
            for name, share in SHARES.items()}


ARM, SIDE, TURNS = 180.0, 6.0, 6.0  # length and side of a square bar; speed over sqrt(E I / ρ A L⁴)


def speed():
    return TURNS * SIDE / np.sqrt(12) * np.sqrt(E / RHO) / ARM**2


def turning_frequencies(terms=9):
    """Bernoulli beam, its root on the axis of rotation, by polynomials x² … : out of the plane of rotation and in it."""
    k = np.arange(terms) + 2.0
    i, j = k[:, None], k[None, :]
    bending = i * (i - 1) * j * (j - 1) / (i + j - 3)
    pull = TURNS**2 / 2 * i * j * (1 / (i + j - 1) - 1 / (i + j + 1))  # tension ρ A Ω² (L² - x²) / 2
    mass = 1 / (i + j + 1)
    flap = np.linalg.eigvals(np.linalg.solve(mass, bending + pull)).real.min()
    return {name: np.sqrt(value) * speed() / TURNS / (2 * np.pi)
            for name, value in (("out of the plane", flap), ("in the plane", flap - TURNS**2))}


@case(id="turning_bar", title="Bar that turns about an axis through its root", quick=True,
      geometry="Bar 180 × 6 × 6 mm, root clamped, turning about an axis across it at 6 √(E I/ρ A L⁴)", material=STEEL + ", ρ = 7850 kg/m³",
      source="Bernoulli beam under ρ A Ω² (L² - x²)/2, by polynomials; out of the plane 7.3604 √(E I/ρ A L⁴): Wright et al. (1982)", unit="Hz",
      exact=turning_frequencies, grids=(18.0, 12.0, 6.0), tolerance=3e-3,
      notes="In the plane spin softening takes Ω² from ω². Coriolis forces are left out, as they are in the formula")
def turning_bar(run, span):
    run.model(parts.box((0, -SIDE / 2, -SIDE / 2), (ARM, SIDE / 2, SIDE / 2)), span)
    report = run.solve("eigen", {
        "material": {"E": E, "nu": 0.0, "rho": RHO}, "support": [face("root", [0, 0, 0], [1, 0, 0])],
        "load": [{"name": "spin", "centrifugal": {"axis": [0, 0, 1], "point": [0, 0, 0], "speed": speed()}}],
        "eigen": {"modes": 2, "prestress": True}})
    in_plane, out_of_plane = elastic(report)
    return {"out of the plane": out_of_plane, "in the plane": in_plane}


# ------------------------------------------------------------------------------------------------ springs and added masses

BEDDED = 480.0                                          # mm, between guided ends
BED = E * WIDE * THICK**3 / 12 * (2.4 * np.pi / BEDDED)**4  # N/mm²: waves of a fifth of the length and shorter buckle first


def bedded_column():
    """Guided ends, n half waves cos(n π z / L): E I q² (with shear, Engesser) + k / q²."""
    q = np.array([2, 3]) * np.pi / BEDDED
    bending = E * WIDE * THICK**3 / 12 * q**2
    return dict(zip(("two half waves", "three half waves"),
                    bending / (1 + bending / (SHEAR * E / 2 * WIDE * THICK)) + BED / q**2))


@case(id="column_on_foundation", title="Column on an elastic foundation", quick=True,
      geometry="Bar 10 × 6 × 480 mm between rigid plates that slide sideways, on a bed of springs along both wide sides; the upper plate moves down",
      material=STEEL, source="Engesser (1884), Hetényi (1946): P = E I q² + k / q², q = n π / L; shear: Engesser (1891)", unit="N", exact=bedded_column,
      grids=(16.0, 11.0, 8.0), tolerance=2e-3, notes=STRAIN.replace("5e-4", "1.6e-3") + ". Waves adapt to the bed: 2 √(k E I) is the bound")
def column_on_foundation(run, span):
    run.model(parts.box((0, 0, 0), (WIDE / 2, THICK, BEDDED)), span)
    sink = 0.01
    bed = {"normal_stiffness": BED / (2 * WIDE)}
    report = run.solve("buckling", {
        "material": {"E": E, "nu": 0.0},
        "support": [face("foot", [0, 0, 0], [0, 0, 1], "normal"), face("middle", [0, 0, 0], [1, 0, 0], "normal"),
                    face("plate", [0, 0, BEDDED], [0, 0, 1], "normal", value=-sink)],
        "spring": [on_plane([0, 0, 0], [0, 1, 0], name="left", **bed), on_plane([0, THICK, 0], [0, 1, 0], name="right", **bed)],
        "buckling": {"factors": 2}})
    return dict(zip(bedded_column(), np.array(report["factors"]) * E * WIDE * THICK * sink / BEDDED))


MAST, HEAD = 240.0, 1e-3                                # mm, t


def mast_frequencies():
    """A mass on a beam without mass under its weight: lateral stiffness P / (tan κL / κ - L), κ² = P / E I; with shear to first order."""
    bending = E * WIDE * THICK**3 / 12
    euler = np.pi**2 * bending / (4 * MAST**2)
    found = {}
    for name, share in MAST_SHARES.items():
        force = share * euler
        kappa = np.sqrt(force / bending)
        give = (np.tan(kappa * MAST) / kappa - MAST) / force + MAST / (SHEAR * E / 2 * WIDE * THICK)
        found[name] = np.sqrt(1 / (give * HEAD)) / (2 * np.pi)
    return found


MAST_SHARES = {"0.3 of the buckling load": 0.3, "0.6 of it": 0.6, "0.9 of it": 0.9}


@case(id="mast_under_weight", title="Mast under the weight of the mass on it", quick=True,
      geometry="Bar 10 × 6 × 240 mm of hardly any mass (0.01 %), foot clamped, 1 kg on its head; weight of 0.3, 0.6 and 0.9 times π² E I / 4 L²", material=STEEL,
      source="Timoshenko & Gere, Theory of Elastic Stability (1961): beam-column, k = P / (tan κL / κ - L), κ² = P / E I", unit="Hz",
      exact=mast_frequencies, grids=(16.0, 11.0, 8.0), tolerance=3e-3, notes=STRAIN.replace("5e-4", "1e-4"))
def mast_under_weight(run, span):
    run.model(parts.box((0, 0, 0), (WIDE, THICK, MAST)), span)
    found = {}
    for name, share in MAST_SHARES.items():
        weight = share * np.pi**2 * E * WIDE * THICK**3 / 12 / (4 * MAST**2)
        report = run.solve("eigen", {
            "material": {"E": E, "nu": 0.0, "rho": 1e-11},
            "support": [face("foot", [0, 0, 0], [0, 0, 1])],
            "added_mass": [on_plane([0, 0, MAST], [0, 0, 1], name="head", mass=HEAD)],
            "load": [{"name": "weight", "acceleration": [0, 0, -weight / HEAD]}], "eigen": {"modes": 1, "prestress": True}})
        found[name] = elastic(report)[0]
    return found
