"""Free and symmetric vibration of solids: exact frequencies."""
from functools import cache

import numpy as np

from book import case, exact, fem, parts, shapes
from book.run import elastic

STEEL = {"E": 200e9, "nu": 0.3, "rho": 8000.0}
STEEL_WORDS = "E = 200 GPa, ν = 0.3, ρ = 8000 kg/m³"
G = STEEL["E"] / (2 * (1 + STEEL["nu"]))


def guided(name, normal, point=(0, 0, 0)):
    """A support on a plane of symmetry."""
    return {"name": name, "fixed": "normal", "plane": {"point": list(point), "normal": list(normal)}}


# ---------------------------------------------------------------------------------------------------------- free sphere

RADIUS = 1.0


def sphere_frequencies():
    scale = np.sqrt(G / STEEL["rho"]) / (2 * np.pi * RADIUS)
    return {"torsion, l = 2 (5 modes)": scale * exact.sphere_torsional(2, 1)[0],
            "spheroidal, l = 2 (5 modes)": scale * exact.sphere_spheroidal(2, STEEL["nu"], 1)[0],
            "spheroidal, l = 1 (3 modes)": scale * exact.sphere_spheroidal(1, STEEL["nu"], 1)[0],
            "torsion, l = 3 (7 modes)": scale * exact.sphere_torsional(3, 1)[0]}


def by_multiplets(found):
    """Means of the multiplets, in the order of frequency."""
    ends = np.cumsum([0, 5, 5, 3, 7])
    return dict(zip(sphere_frequencies(), (np.mean(found[a:b]) for a, b in zip(ends, ends[1:]))))


def sphere_in_tetrahedra(run):
    mesh = fem.tetrahedra(run, f"Sphere(1) = {{0, 0, 0, {RADIUS}}};", 0.34)
    return by_multiplets(fem.frequencies(run, mesh, STEEL, [], 26)[6:])


@case(id="free_sphere", title="Free solid sphere", quick=True, geometry="Sphere of radius 1 m, free; means of multiplets", material=STEEL_WORDS,
      source="Lamb (1882); frequency equations of Eringen & Suhubi, Elastodynamics II (1975)", unit="Hz", exact=sphere_frequencies,
      grids=(0.5, 0.34, 0.24), tolerance=6e-4, calculix=sphere_in_tetrahedra, calculix_mesh="C3D10 of 0.34 m, mid-edge nodes on the sphere")
def free_sphere(run, span):
    run.model(parts.ball(RADIUS, 24), span)
    return by_multiplets(elastic(run.solve("eigen", {"material": STEEL, "eigen": {"modes": 20}})))


# -------------------------------------------------------------------------------------------------------- hollow sphere

INNER, OUTER, ANGLE, MODES = 1.8, 6.0, np.radians(12), 4


def sphere_planes():
    """Outward normals of the four planes of symmetry of the pyramid."""
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    return {"x low": (-1, 0, 0), "x high": (c, 0, -s), "y low": (0, -1, 0), "y high": (0, c, -s)}


@cache
def radial_frequencies():
    return {f"radial mode {k + 1}": f for k, f in enumerate(exact.hollow_sphere_radial(INNER, OUTER, count=MODES, **STEEL))}


def first_of(found):
    return {name: f for name, f in zip(radial_frequencies(), found)}


OUTSIDE = np.array([np.array([np.tan(a), np.tan(b), 1]) / np.linalg.norm([np.tan(a), np.tan(b), 1])
                    for a in (0.01, 0.1, 0.2) for b in (0.01, 0.1, 0.2)])  # directions of points on the outer face


def hollow_in_bricks(run):
    mesh = fem.bricks(parts.pyramid_mapping(INNER, OUTER, ANGLE), (2, 2, 12))
    held = [(mesh.at(lambda x, n=np.array(n): np.abs(x @ n) < 1e-9), np.array(n)) for n in sphere_planes().values()]
    outer = mesh.at(lambda x: np.abs(np.linalg.norm(x, axis=1) - OUTER) < 1e-9)
    found, displacement = fem.frequencies(run, mesh, STEEL, held, 30, shapes=True)
    return first_of(shapes.fem_modes_like(found, displacement, outer, mesh.nodes[outer] / OUTER))


@case(id="fv42", title="NAFEMS FV42: thick hollow sphere, radial vibration",
      geometry="Hollow sphere, radii 1.8 and 6 m: a pyramid of 12 × 12 degrees between planes of symmetry; radial modes by their shape",
      material=STEEL_WORDS, source="NAFEMS, Selected Benchmarks for Natural Frequency Analysis (1987), FV42; exact equation evaluated here",
      unit="Hz", exact=radial_frequencies, grids=(0.6, 0.42, 0.3), tolerance=8e-4, calculix=hollow_in_bricks,
      calculix_mesh="C3D20, 2 × 2 × 12")
def fv42(run, span):
    run.model(parts.pyramid(INNER, OUTER, ANGLE, 12), span)
    report, file = run.solve("eigen", {"material": STEEL, "support": [guided(name, n) for name, n in sphere_planes().items()],
                                       "eigen": {"modes": 30, "sturm": False, "errors": False}}, results=True)
    return first_of(shapes.modes_like(report, file, 0.999 * OUTER * OUTSIDE, OUTSIDE))


# -------------------------------------------------------------------------------------------------------- free cylinder

FV41 = dict(zip((f"mode {k}" for k in range(2, 7)), (243.53, 377.41, 394.11, 397.72, 405.28)))
SECTOR = np.radians(15)


def sector_planes():
    c, s = np.cos(SECTOR), np.sin(SECTOR)
    return {"low": (0, -1, 0), "high": (-s, c, 0)}


def fv41_in_bricks(run):
    mesh = fem.bricks(parts.wedge_mapping(1.8, 2.2, 10, SECTOR), (2, 1, 20))
    held = [(mesh.at(lambda x, n=np.array(n): np.abs(x @ n) < 1e-9), np.array(n)) for n in sector_planes().values()]
    return dict(zip(FV41, fem.frequencies(run, mesh, STEEL, held, 6)[1:]))


@case(id="fv41", title="NAFEMS FV41: free cylinder, axisymmetric vibration",
      geometry="Tube of radii 1.8 and 2.2 m, 10 m long, free: a sector of 15 degrees between planes of symmetry; one rigid motion",
      material=STEEL_WORDS, source="NAFEMS, Selected Benchmarks for Natural Frequency Analysis (1987), FV41: values of a fine finite element "
      "mesh", unit="Hz", exact=FV41, grids=(0.8, 0.55, 0.4), tolerance=6e-4, known=4e-4, calculix=fv41_in_bricks, calculix_mesh="C3D20, 2 × 1 × 20",
      notes="Splines and bricks agree to 2e-5; what is left is the distance of the published values from the limit")
def fv41(run, span):
    run.model(parts.wedge(1.8, 2.2, 10.0, SECTOR, 12), span)
    report = run.solve("eigen", {"material": STEEL, "support": [guided(name, n) for name, n in sector_planes().items()],
                                 "eigen": {"modes": 5}})
    return dict(zip(FV41, elastic(report)))


# ----------------------------------------------------------------------------------------------------------------- bars

def rod_in_tetrahedra(run):
    mesh = fem.tetrahedra(run, "Cylinder(1) = {0, 0, 0, 0, 0, 4, 0.5};", 0.3)
    rim = mesh.at(lambda x: (np.abs(np.hypot(x[:, 0], x[:, 1]) - 0.5) < 1e-6) & (np.abs(x[:, 2]) < 1e-6))
    found, displacement = fem.frequencies(run, mesh, STEEL, [], 20, shapes=True)
    x = mesh.nodes[rim]
    around = np.stack([-x[:, 1], x[:, 0], 0 * x[:, 0]], 1)
    return dict(zip(("first", "second"), shapes.fem_modes_like(found, displacement, rim, around)))


@case(id="rod_torsion", title="Free round rod, torsion", geometry="Rod of radius 0.5 m, 4 m long, free; modes of torsion by their shape",
      material=STEEL_WORDS, source="n c_s / (2 L), exact in three dimensions (Love, 1927, art. 200)", unit="Hz",
      exact=lambda: {name: n * np.sqrt(G / STEEL["rho"]) / 8 for n, name in ((1, "first"), (2, "second"))}, grids=(0.45, 0.3, 0.21),
      tolerance=3e-4, calculix=rod_in_tetrahedra, calculix_mesh="C3D10 of 0.3 m, mid-edge nodes on the cylinder",
      notes="What is left comes from the rules of cut spans, which keep moments of degree 2; with igaprep --moment-degree 2p the error of the "
            "first mode is 5e-7 at the finest grid")
def rod_torsion(run, span):
    run.model(parts.cylinder(0.5, 4.0, 64), span)
    report, file = run.solve("eigen", {"material": STEEL, "eigen": {"modes": 14}}, results=True)
    angle = np.arange(8) * np.pi / 4 + 0.1
    around = np.stack([-np.sin(angle), np.cos(angle), 0 * angle], 1)
    at = np.stack([0.49 * np.cos(angle), 0.49 * np.sin(angle), 0 * angle + 0.01], 1)
    return dict(zip(("first", "second"), shapes.modes_like(report, file, at, around)))


CUBE = 1.0


@case(id="free_cube", title="Free cube: Lamé's modes and the lowest ones",
      geometry="Cube of 1 m, free, turned by 30 degrees about (1, 1, 0) against the grid; means of multiplets", material=STEEL_WORDS,
      source="lowest: Ritz series of degree 18 (digits known to 5e-6), as Demarest (1971); Lamé's equivoluminal modes: ω = √2 π c_s / L, exact",
      unit="Hz", exact=lambda: {name: value * np.sqrt(G / STEEL["rho"]) / (2 * np.pi * CUBE) for name, value in (
          ("1, 2: torsion", 2.85605), ("3 … 5", 3.84597), ("6 … 8", 3.91125), ("9 … 11: Lamé", 2**0.5 * np.pi))},
      grids=(0.35, 0.24, 0.17), tolerance=5e-4)
def free_cube(run, span):
    run.model(parts.box((0, 0, 0), (CUBE,) * 3), span, 2, "--rotate-axis-angle", 1, 1, 0, 30)
    found = elastic(run.solve("eigen", {"material": STEEL, "eigen": {"modes": 11}}))
    return {name: np.mean(found[a:b]) for name, a, b in (("1, 2: torsion", 0, 2), ("3 … 5", 2, 5), ("6 … 8", 5, 8), ("9 … 11: Lamé", 8, 11))}


BAR = {"E": 200e9, "nu": 0.0, "rho": 8000.0}


@case(id="bar_stretching", title="Free bar without Poisson effect, stretching", quick=True,
      geometry="Bar 4 × 1 × 1 m, free, in spans that do not fit it; modes along the axis by their shape",
      material="E = 200 GPa, ν = 0, ρ = 8000 kg/m³", source="n √(E/ρ) / (2 L), exact in three dimensions for ν = 0", unit="Hz",
      exact=lambda: {name: n * np.sqrt(BAR["E"] / BAR["rho"]) / 8 for n, name in ((1, "first"), (2, "second"))},
      grids=(0.7, 0.45, 0.3), tolerance=2e-4)
def bar_stretching(run, span):
    run.model(parts.box((0, 0, 0), (4, 1, 1)), span)
    report, file = run.solve("eigen", {"material": BAR, "eigen": {"modes": 16}}, results=True)
    at = np.array([[0.0, y, z] for y in (0.1, 0.9) for z in (0.1, 0.9)])
    return dict(zip(("first", "second"), shapes.modes_like(report, file, at, np.tile([1.0, 0, 0], (4, 1)))))
