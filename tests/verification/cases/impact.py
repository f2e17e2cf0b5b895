"""Explicit dynamics: waves and contact in one direction."""
import numpy as np

import igatools
from book import case, parts

# kg, mm, ms: kN, GPa
E, RHO, LENGTH, WIDTH, SPEED = 210.0, 7.8e-6, 100.0, 10.0, 1.0
WAVE = np.sqrt(E / RHO)
TOUCH = 2 * LENGTH / WAVE
STEEL = {"law": "linear-elastic", "E": E, "nu": 0.0, "rho": RHO}


@case(id="rod_on_wall", title="Rod hits a rigid wall", quick=True,
      geometry="Rod 100 × 10 × 10 mm at 1 m/s against a fixed plane; force in the middle half of the contact, impulse of all of it",
      material="E = 210 GPa, ν = 0, ρ = 7800 kg/m³", source="Saint-Venant: force ρ c v A while the wave runs to the end and back, impulse 2 m v",
      unit={"force": "kN", "impulse": "kN ms"}, exact={"force": RHO * WAVE * SPEED * WIDTH**2, "impulse": 2 * RHO * WIDTH**2 * LENGTH * SPEED},
      grids=(6.0, 4.0, 2.7), tolerance={"force": 0.01, "impulse": 0.02}, notes="The step of the force is smoothed over a span or two")
def rod_on_wall(run, span):
    model = run.model(parts.box((0, 0, 0), (LENGTH, WIDTH, WIDTH)), span, 2, "--length-unit", "mm")
    run.unknowns = 3 * model["functions"]
    report, file = run.solve("explicit", {
        "bodies": [{"name": "rod", "model": "part.h5", "velocity": [-SPEED, 0, 0], "material": STEEL}],
        "rigid_bodies": [{"name": "wall", "shape": "plane", "normal": [1, 0, 0], "centre": [0, 0, 0]}],
        "contacts": [{"name": "hit", "bodies": ["rod", "wall"]}], "time": {"end": 1.3 * TOUCH}, "output": {"interval": TOUCH / 400, "viewer": False}},
        results=True)
    results = igatools.Results(file)
    time, force = results["/time_series/time"], results["/time_series/contact/hit/force"][:, 0]
    middle = (time > 0.25 * TOUCH) & (time < 0.75 * TOUCH)
    return {"force": force[middle].mean(), "impulse": results["/time_series/contact/hit/impulse"][-1, 0]}
