"""Stress concentrations and stress along lines through walls.

Largest von Mises stress at the surface as `igasolve static` recovers it, and linearised stress.
"""
import math

import numpy as np

from book import case, fem, parts

E, NU = 210e3, 0.3  # MPa
MATERIAL = "E = 210 GPa, ν = 0.3"
AXES = np.eye(3)


def plane(name, normal, point=(0, 0, 0)):
    return {"name": name, "fixed": "normal", "plane": {"point": list(point), "normal": normal.tolist()}}


# ------------------------------------------------------------------------------------------------------ plate with a hole

HOLE, WIDTH, LENGTH, THICK = 10.0, 50.0, 120.0, 8.0  # radius, halves


def plate_mapping(x):
    """Along the radius, around the hole, through the thickness; the corner lies in the middle of the way round."""
    corner = math.atan2(WIDTH, LENGTH)
    angle = np.where(x[:, 1] <= 0.5, 2 * x[:, 1] * corner, corner + (2 * x[:, 1] - 1) * (np.pi / 2 - corner))
    direction = np.column_stack([np.cos(angle), np.sin(angle)])
    reach = np.minimum(LENGTH / np.maximum(direction[:, 0], 1e-12), WIDTH / np.maximum(direction[:, 1], 1e-12))
    radius = HOLE + (reach - HOLE) * x[:, 0]
    return np.column_stack([radius[:, None] * direction, THICK * x[:, 2]])


def plate_in_bricks(run):
    mesh = fem.bricks(lambda x: plate_mapping(np.column_stack([x[:, 0]**2, x[:, 1:]])), (8, 12, 1))
    at = lambda axis, value: mesh.at(lambda x: np.abs(x[:, axis] - value) < 1e-6)  # noqa: E731
    held = [(at(0, 0), "x"), (at(1, 0), "y"), (at(2, 0), "z"), (at(2, THICK), "z")]
    _, stress = fem.static(run, mesh, {"E": E, "nu": NU}, held,
                           mesh.forces(lambda x: np.abs(x[:, 0] - LENGTH) < 1e-6, lambda x, n: 100.0 * n))
    return stress[mesh.nearest((0, HOLE, 0)), 0] / 100


@case(id="plate_with_hole", title="Plate with a hole under tension, plane strain", quick=True,
      geometry="Quarter of a plate 240 × 100 mm with a hole of 20 mm, 8 mm thick between planes of symmetry; 100 MPa at its ends. First "
               "principal stress where von Mises' is largest, over 100 MPa", material=MATERIAL,
      source="Howland (1930) for a strip: 3.14 (in an endless plate 3, Kirsch 1898)", unit="", exact=3.14, grids=(6.0, 4.5, 3.3),
      tolerance=0.015, calculix=plate_in_bricks, calculix_mesh="C3D20, 8 × 12 × 1, finer at the hole, stresses averaged at nodes")
def plate_with_hole(run, span):
    plate = parts.block(plate_mapping, (1, 80, 1))
    run.model(plate, span)
    report = run.solve("static", {
        "material": {"E": E, "nu": NU},
        "support": [plane("x", AXES[0]), plane("y", AXES[1]), plane("low", AXES[2]), plane("high", AXES[2], (0, 0, THICK))],
        "load": [{"name": "pull", "traction": [100.0, 0, 0], "plane": {"point": [LENGTH, 0, 0], "normal": [1, 0, 0]}}]})
    return report["stress"]["largest"]["principal"][0] / 100


# ------------------------------------------------------------------------------------------------------------- cavity

CAVITY, BLOCKS = 10.0, (30.0, 50.0)  # radius, half edges


@case(id="spherical_cavity", title="Spherical cavity under tension",
      geometry="Eighth of cubes of 60 and 100 mm with a cavity of radius 10 mm, planes of symmetry; 100 MPa along z. First principal stress "
               "where von Mises' is largest, over 100 MPa", material=MATERIAL,
      source="Goodier (1933), endless body: (27 - 15 ν) / (2 (7 - 5 ν))", unit="", exact=(27 - 15 * NU) / (2 * (7 - 5 * NU)),
      grids=(6.5, 5.0, 3.4), tolerance=0.015,
      notes="The sides of a cube raise the stress by (radius / half edge)³, 2 % in the larger one: two sizes give that of an endless body")
def spherical_cavity(run, span):
    small, large = (cavity_in_cube(run, span, half) for half in BLOCKS)
    return large + (large - small) / ((BLOCKS[1] / BLOCKS[0])**3 - 1)


def cavity_in_cube(run, span, half):
    solid = parts.octant(CAVITY, 2 * CAVITY, 12)
    outside = np.linalg.norm(solid, axis=-1) > 1.5 * CAVITY
    solid[outside] *= (half / solid[outside].max(-1))[:, None]
    run.model(np.round(solid, 11), span)
    report = run.solve("static", {
        "material": {"E": E, "nu": NU}, "support": [plane(name, AXES[d]) for d, name in enumerate("xyz")],
        "load": [{"name": "pull", "traction": [0, 0, 100.0], "plane": {"point": [0, 0, half], "normal": [0, 0, 1]}}]})
    return report["stress"]["largest"]["principal"][0] / 100


# --------------------------------------------------------------------------------------------------- linearised stress

INNER, OUTER, PRESSURE = 50.0, 100.0, 100.0


def linearised_hoop():
    """Mean of σ_θ = s (1 + b² / r²), and 6 / t² ∫ σ_θ (r_m - r) dr."""
    a, b, t = INNER, OUTER, OUTER - INNER
    share, middle = PRESSURE * a**2 / (b**2 - a**2), 0.5 * (a + b)
    bending = 6 / t**2 * share * b**2 * (middle * (1 / a - 1 / b) - math.log(b / a))
    return {"membrane": PRESSURE * a / t, "bending": bending, "peak at the bore": share * (1 + b**2 / a**2) - PRESSURE * a / t - bending}


@case(id="stress_through_wall", title="Linearised hoop stress of a thick cylinder", quick=True,
      geometry="Quarter of a tube, radii 50 and 100 mm, 30 mm long; planes of symmetry, 100 MPa in the bore; a line through the wall at "
               "45 degrees", material=MATERIAL, source="Lamé, with ASME BPVC VIII-2, annex 5-A.4.1", unit="MPa", exact=linearised_hoop,
      grids=(20.0, 16.0, 12.0), tolerance={"membrane": 2e-3, "bending": 5e-3, "peak at the bore": 0.03})
def stress_through_wall(run, span):
    on_bore = lambda x: np.hypot(x[:, 0], x[:, 1]) < INNER * (1 + 1e-9)  # noqa: E731
    tube = parts.wedge(INNER, OUTER, 30.0, np.pi / 2, 96)
    run.surface("bore", parts.where(tube, on_bore))
    run.model(tube, span)
    way = np.array([math.sqrt(0.5), math.sqrt(0.5), 0])
    report = run.solve("static", {
        "material": {"E": E, "nu": NU},
        "support": [plane("x", AXES[0]), plane("y", AXES[1]), plane("low", AXES[2]), plane("high", AXES[2], (0, 0, 30.0))],
        "load": [{"name": "pressure", "pressure": PRESSURE, "patch": "bore.stl"}],
        "line": [{"name": "wall", "from": (INNER * way + [0, 0, 15]).tolist(), "to": (OUTER * way + [0, 0, 15]).tolist()}]})
    wall = report["stress"]["lines"][0]
    hoop = lambda s: 0.5 * (s[0] + s[1]) - s[3]  # noqa: E731
    return {"membrane": hoop(wall["membrane"]), "bending": hoop(wall["bending"]), "peak at the bore": hoop(wall["peak_from"])}
