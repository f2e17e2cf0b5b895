"""Several bodies: ties between unlike grids and materials."""
from functools import cache

import numpy as np

from book import case, exact, parts, shapes
from book.run import elastic

STEEL, ALUMINIUM = {"E": 210e9, "nu": 0.0, "rho": 7850.0}, {"E": 70e9, "nu": 0.0, "rho": 2700.0}
LENGTHS, WIDTH = (1.2, 1.8), 0.5


@cache
def two_materials():
    """u = A cos(k1 x) and B cos(k2 (L - x)) meet with the same displacement and force."""
    c1, c2 = (np.sqrt(m["E"] / m["rho"]) for m in (STEEL, ALUMINIUM))

    def force(w):
        one, two = w / c1 * LENGTHS[0], w / c2 * LENGTHS[1]
        return STEEL["E"] / c1 * np.sin(one) * np.cos(two) + ALUMINIUM["E"] / c2 * np.sin(two) * np.cos(one)
    return {name: w / (2 * np.pi) for name, w in zip(("first", "second"), exact.roots(force, 10, 2e4))}


@case(id="bar_of_two", title="Free bar of two materials, stretching", quick=True,
      geometry="Steel bar 1.2 m and aluminium bar 1.8 m long, 0.5 × 0.5 m, tied; each in a grid of its own; modes along the axis by their shape",
      material="E = 210 and 70 GPa, ν = 0, ρ = 7850 and 2700 kg/m³", source="waves in two rods, exact in three dimensions for ν = 0", unit="Hz",
      exact=two_materials, grids=(0.4, 0.27, 0.18), tolerance=1e-4)
def bar_of_two(run, span):
    boxes = {"steel": ((0, 0, 0), (LENGTHS[0], WIDTH, WIDTH)), "aluminium": ((LENGTHS[0], 0, 0), (sum(LENGTHS), WIDTH, WIDTH))}
    for (name, box), size in zip(boxes.items(), (span, 0.85 * span)):
        run.model(parts.box(*box), size, name=name)
    report, file = run.solve("eigen", {
        "bodies": [{"name": "steel", "model": "steel.h5", "material": STEEL}, {"name": "aluminium", "model": "aluminium.h5", "material": ALUMINIUM}],
        "ties": [{"name": "joint"}], "eigen": {"modes": 14}}, results=True)
    at = np.array([[0.0, y, z] for y in (0.1, 0.4) for z in (0.1, 0.4)])
    return dict(zip(("first", "second"), shapes.modes_like(report, file, at, np.tile([1.0, 0, 0], (4, 1)), body="steel")))


CUBE, G = {"E": 200e9, "nu": 0.3, "rho": 8000.0}, 200e9 / 2.6


@case(id="cube_of_two", title="Free cube cut in two and tied", geometry="Cube of 1 m cut at a slant, halves of different grids, tied; means of multiplets",
      material="E = 200 GPa, ν = 0.3, ρ = 8000 kg/m³", source="as free_cube", unit="Hz",
      exact=lambda: {name: value * np.sqrt(G / 8000) / (2 * np.pi) for name, value in (
          ("1, 2: torsion", 2.85605), ("3 … 5", 3.84597), ("6 … 8", 3.91125), ("9 … 11: Lamé", 2**0.5 * np.pi))},
      grids=(0.35, 0.24, 0.17), tolerance=1e-3,
      notes="The cut runs from 0.3 to 0.7 of the height: no plane of symmetry of the cube, no plane of either grid")
def cube_of_two(run, span):
    cut = lambda x: 0.3 + 0.4 * x[:, 0]  # noqa: E731
    low = lambda x: np.stack([x[:, 0], x[:, 1], x[:, 2] * cut(x)], 1)  # noqa: E731
    high = lambda x: np.stack([x[:, 0], x[:, 1], cut(x) + x[:, 2] * (1 - cut(x))], 1)  # noqa: E731
    run.model(parts.block(low, (1, 1, 1)), span, name="low")
    run.model(parts.block(high, (1, 1, 1)), 0.87 * span, name="high")
    report = run.solve("eigen", {"material": CUBE, "bodies": [{"name": name, "model": f"{name}.h5"} for name in ("low", "high")],
                                 "ties": [{"name": "cut"}], "eigen": {"modes": 11}})
    found = elastic(report)
    return {name: np.mean(found[a:b]) for name, a, b in (("1, 2: torsion", 0, 2), ("3 … 5", 2, 5), ("6 … 8", 5, 8), ("9 … 11: Lamé", 8, 11))}
