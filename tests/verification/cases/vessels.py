"""Thick vessels under pressure.

Lamé's solutions; a sector between planes of symmetry stands for the whole.
"""
import numpy as np

from book import case, parts
from book.run import probe

E, NU = 200e3, 0.3          # MPa
INNER, OUTER, PRESSURE = 50.0, 100.0, 100.0
MATERIAL = "E = 200 GPa, ν = 0.3"
FACETS = 96                 # over 90°: chords 3e-5 of the radius


def lame_cylinder():
    """Plane strain: u_r and σ_θ at the bore."""
    a, b, p = INNER, OUTER, PRESSURE
    share = p * a**2 / (b**2 - a**2)
    return {"u at the bore": (1 + NU) / E * share * ((1 - 2 * NU) * a + b**2 / a), "u outside": (1 + NU) / E * share * (2 - 2 * NU) * b,
            "hoop stress at the bore": share * (1 + b**2 / a**2)}


@case(id="thick_cylinder", title="Thick cylinder under internal pressure, plane strain", quick=True,
      geometry="Quarter of a tube, radii 50 and 100 mm, 20 mm long; planes of symmetry on both sides and both ends. 100 MPa in the bore",
      material=MATERIAL, source="Lamé; Timoshenko & Goodier, Theory of Elasticity, 3rd ed., art. 28", 
      unit={"u at the bore": "mm", "u outside": "mm", "hoop stress at the bore": "MPa"},
      exact=lame_cylinder, grids=(16.0, 11.0, 7.5), tolerance={"u at the bore": 1e-3, "u outside": 1e-3, "hoop stress at the bore": 0.02})
def thick_cylinder(run, span):
    tube = parts.wedge(INNER, OUTER, 20.0, np.pi / 2, FACETS)
    run.surface("bore", parts.where(tube, lambda x: np.hypot(x[:, 0], x[:, 1]) < INNER * (1 + 1e-9)))
    run.model(tube, span)
    plane = lambda name, point, normal: {"name": name, "fixed": "normal", "plane": {"point": point, "normal": normal}}  # noqa: E731
    report = run.solve("static", {
        "material": {"E": E, "nu": NU},
        "support": [plane("y", [0, 0, 0], [0, 1, 0]), plane("x", [0, 0, 0], [1, 0, 0]), plane("low", [0, 0, 0], [0, 0, 1]),
                    plane("high", [0, 0, 20], [0, 0, 1])],
        "load": [{"name": "pressure", "pressure": PRESSURE, "patch": "bore.stl"}],
        "probe": [{"name": "bore", "position": [INNER, 0, 10]}, {"name": "outside", "position": [OUTER, 0, 10]}]})
    return {"u at the bore": probe(report, "bore")["displacement"][0], "u outside": probe(report, "outside")["displacement"][0],
            "hoop stress at the bore": probe(report, "bore")["stress"][1]}
