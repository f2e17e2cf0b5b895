"""Turning, heat and inertia.

Loads of the whole part: centrifugal force, thermal strain, steady conduction, inertia relief.
"""
import numpy as np

from book import case, fem, parts
from book.run import probe

QUARTER = np.pi / 2
FACETS = 96  # over 90°: chords 3e-5 of the radius


def plane(name, point, normal, **more):
    return {"name": name, "fixed": "normal", "plane": {"point": point, "normal": normal}, **more}


def symmetry(*axes, **more):
    """Planes through the origin."""
    return [plane(axis, [0, 0, 0], [float(axis == other) for other in "xyz"], **more) for axis in axes]


# ------------------------------------------------------------------------------------------------------- turning disc

DISC = {"E": 210e3, "nu": 0.3, "rho": 7.85e-9}
BORE, RIM, HALF, SPEED = 20.0, 100.0, 2.0, 1000.0


def turning_disc_exact():
    E, nu, a, b = DISC["E"], DISC["nu"], BORE, RIM
    force = DISC["rho"] * SPEED**2
    return {"hoop stress at the bore": force / 4 * ((3 + nu) * b**2 + (1 - nu) * a**2),
            "radial stress at r = 45 mm": (3 + nu) / 8 * force * (a**2 + b**2 - a**2 * b**2 / 45**2 - 45**2),
            "u at the rim": force * b / (4 * E) * ((1 - nu) * b**2 + (3 + nu) * a**2)}


@case(id="turning_disc", title="Thin disc with a bore, turning", quick=True,
      geometry="Radii 20 and 100 mm, 4 mm thick; a quarter of one half. 1000 rad/s about its axis", material="E = 210 GPa, ν = 0.3, ρ = 7850 kg/m³",
      source="Timoshenko & Goodier, Theory of Elasticity, 3rd ed., art. 32, plane stress",
      unit={"hoop stress at the bore": "MPa", "radial stress at r = 45 mm": "MPa", "u at the rim": "mm"}, exact=turning_disc_exact,
      grids=((11, 11, 4), (7, 7, 4), (3.5, 3.5, 4)),
      tolerance={"hoop stress at the bore": 0.015, "radial stress at r = 45 mm": 5e-3, "u at the rim": 2e-4},
      notes="The disc of finite thickness differs from plane stress by 5e-5 of the stress.")
def turning_disc(run, spans):
    run.model(parts.wedge(BORE, RIM, HALF, QUARTER, FACETS), spans)
    report = run.solve("static", {
        "material": DISC, "support": symmetry("x", "y", "z"), "load": [{"name": "turning", "centrifugal": {"axis": [0, 0, 1], "speed": SPEED}}],
        "probe": [{"name": "bore", "position": [BORE, 0, 0]}, {"name": "mid", "position": [45, 0, 0]}, {"name": "rim", "position": [RIM, 0, 0]}]})
    return {"hoop stress at the bore": probe(report, "bore")["stress"][1], "radial stress at r = 45 mm": probe(report, "mid")["stress"][0],
            "u at the rim": probe(report, "rim")["displacement"][0]}


BLADES = 0.15e-3  # t on the whole rim


def bladed_disc_exact():
    """The disc, and Lamé's ring under the pull of the masses on its rim."""
    E, nu, a, b = DISC["E"], DISC["nu"], BORE, RIM
    pull = BLADES * SPEED**2 * b / (2 * np.pi * b * 2 * HALF)
    bare = turning_disc_exact()
    return {"hoop stress at the bore": bare["hoop stress at the bore"] + 2 * pull * b**2 / (b**2 - a**2),
            "u at the rim": bare["u at the rim"] + pull * b / E * ((b**2 + a**2) / (b**2 - a**2) - nu)}


@case(id="bladed_disc", title="Disc with blades on its rim, turning",
      geometry="The disc above with 0.15 kg spread along its rim", material="E = 210 GPa, ν = 0.3, ρ = 7850 kg/m³",
      source="Timoshenko & Goodier, art. 28 and 32, plane stress", unit={"hoop stress at the bore": "MPa", "u at the rim": "mm"},
      exact=bladed_disc_exact, grids=((11, 11, 4), (7, 7, 4), (3.5, 3.5, 4)),
      tolerance={"hoop stress at the bore": 0.015, "u at the rim": 3e-4})
def bladed_disc(run, spans):
    disc = parts.wedge(BORE, RIM, HALF, QUARTER, FACETS)
    run.surface("rim", parts.where(disc, lambda x: np.abs(np.hypot(x[:, 0], x[:, 1]) - RIM) < 1e-6))
    run.model(disc, spans)
    report = run.solve("static", {
        "material": DISC, "support": symmetry("x", "y", "z"), "load": [{"name": "turning", "centrifugal": {"axis": [0, 0, 1], "speed": SPEED}}],
        "added_mass": [{"name": "blades", "mass": BLADES / 8, "patch": "rim.stl"}],
        "probe": [{"name": "bore", "position": [BORE, 0, 0]}, {"name": "rim", "position": [RIM, 0, 0]}]})
    return {"hoop stress at the bore": probe(report, "bore")["stress"][1], "u at the rim": probe(report, "rim")["displacement"][0]}


# ------------------------------------------------------------------------------------------------------------- heat

HEATED = {"E": 210e3, "nu": 0.3, "expansion": 12e-6}


@case(id="heated_bar", title="Heated bar between two walls", quick=True,
      geometry="Bar 100 × 10 × 10 mm, both ends held along its axis, heated from 20 to 100 °C", material="E = 210 GPa, ν = 0.3, α = 12e-6/K",
      source="σ = -E α ΔT", unit="MPa", exact=lambda: -HEATED["E"] * HEATED["expansion"] * 80, grids=(8.0, 5.0, 3.0), tolerance=1e-8)
def heated_bar(run, span):
    run.model(parts.box((0, 0, 0), (100, 10, 10)), span)
    report = run.solve("static", {
        "material": HEATED, "temperature": {"uniform": 100, "reference": 20},
        "support": [*symmetry("x", "y", "z"), plane("end", [100, 0, 0], [1, 0, 0])], "probe": [{"name": "somewhere", "position": [31, 4, 7]}]})
    return probe(report, "somewhere")["stress"][0]


STRIP = {"low": {"E": 100e3, "nu": 0.0, "expansion": 10e-6}, "high": {"E": 200e3, "nu": 0.0, "expansion": 20e-6}}
THICK, LENGTH, WIDTH = {"low": 4.0, "high": 2.0}, 100.0, 4.0


def bimetal_curvature():
    m, n = THICK["low"] / THICK["high"], STRIP["low"]["E"] / STRIP["high"]["E"]
    h = THICK["low"] + THICK["high"]
    misfit = (STRIP["high"]["expansion"] - STRIP["low"]["expansion"]) * 100
    return 6 * misfit * (1 + m)**2 / (h * (3 * (1 + m)**2 + (1 + m * n) * (m**2 + 1 / (m * n))))


@case(id="bimetal", title="Bimetal strip", quick=True,
      geometry="Strips 4 and 2 mm thick, 200 × 8 mm (a quarter), tied to each other, heated by 100 K; curvature between x = 20 and 60 mm",
      material="E = 100 and 200 GPa, ν = 0, α = 10e-6 and 20e-6/K",
      source="S. Timoshenko, Analysis of bi-metal thermostats, J. Opt. Soc. Am. 11 (1925), eq. 4", unit="1/m",
      exact=lambda: 1e3 * bimetal_curvature(), grids=((10, 4, 2), (6, 4, 1), (4, 3, 0.7)), tolerance=2e-3)
def bimetal(run, spans):
    low = parts.box((0, 0, 0), (LENGTH, WIDTH, THICK["low"]))
    high = parts.box((0, 0, THICK["low"]), (LENGTH, WIDTH, THICK["low"] + THICK["high"]))
    run.model(low, spans, name="low")
    run.model(high, np.multiply(spans, (1.1, 1.0, 0.7)), name="high")
    report = run.solve("static", {
        "bodies": [{"name": name, "model": f"{name}.h5", "material": material} for name, material in STRIP.items()],
        "ties": [{"name": "bond", "bodies": ["low", "high"]}], "temperature": {"uniform": 120, "reference": 20},
        "support": [*(one | {"name": f"{one['name']} {body}"} for body in STRIP for one in symmetry("x", "y", body=body)),
                    {"name": "rest", "body": "low", "at": [0, 0, 0], "fixed": "z"}],
        "probe": [{"name": str(x), "body": "low", "position": [x, 0, 0]} for x in (20, 60)]})
    fall = probe(report, "20")["displacement"][2] - probe(report, "60")["displacement"][2]
    return 1e3 * 2 * fall / (60**2 - 20**2)


SHELLS = {"inner": {"E": 100e3, "nu": 0.25, "expansion": 24e-6}, "outer": {"E": 200e3, "nu": 0.3, "expansion": 10e-6}}
RADII = 20.0, 40.0, 60.0


def shells_exact():
    """Two concentric spheres under the pressure p between them: Lamé's u_r at the interface from both sides."""
    c, a, b = RADII
    inner, outer = SHELLS.values()
    give_in = a / inner["E"] * ((1 - 2 * inner["nu"]) * a**3 + (1 + inner["nu"]) * c**3 / 2) / (a**3 - c**3)
    give_out = a / outer["E"] * ((1 - 2 * outer["nu"]) * a**3 + (1 + outer["nu"]) * b**3 / 2) / (b**3 - a**3)
    p = (inner["expansion"] - outer["expansion"]) * 100 * a / (give_in + give_out)
    return {"u between them": outer["expansion"] * 100 * a + give_out * p, "hoop stress outside": 1.5 * p * a**3 / (b**3 - a**3)}


@case(id="composite_sphere", title="Sphere of two shells, heated",
      geometry="Concentric shells, radii 20, 40 and 60 mm, tied; an eighth, heated by 100 K", material="E = 100 and 200 GPa, ν = 0.25 and 0.3, α = 24e-6 and 10e-6/K",
      source="Lamé's spheres under the pressure that makes them fit; Timoshenko & Goodier, 3rd ed., art. 152", 
      unit={"u between them": "mm", "hoop stress outside": "MPa"}, exact=shells_exact, grids=(14.0, 10.0, 7.0),
      tolerance={"u between them": 2e-3, "hoop stress outside": 0.02})
def composite_sphere(run, span):
    c, a, b = RADII
    for name, (low, high) in {"inner": (c, a), "outer": (a, b)}.items():
        run.model(parts.octant(low, high, 16), span, name=name)
    at = np.ones(3) / 3**0.5
    report = run.solve("static", {
        "bodies": [{"name": name, "model": f"{name}.h5", "material": material} for name, material in SHELLS.items()],
        "ties": [{"name": "fit", "bodies": ["inner", "outer"]}], "temperature": {"uniform": 100, "reference": 0},
        "support": [one | {"name": f"{one['name']} {body}"} for body in SHELLS for one in symmetry("x", "y", "z", body=body)],
        "probe": [{"name": "fit", "body": "outer", "position": [a, 0, 0]}, {"name": "outside", "body": "outer", "position": list(0.999 * b * at)}]})
    stress = probe(report, "outside")["stress"]
    tensor = np.array([[stress[0], stress[3], stress[5]], [stress[3], stress[1], stress[4]], [stress[5], stress[4], stress[2]]])
    across = np.array([1, -1, 0]) / 2**0.5
    return {"u between them": probe(report, "fit")["displacement"][0], "hoop stress outside": across @ tensor @ across}


LE11 = {"E": 210e3, "nu": 0.3, "expansion": 2.3e-4}  # MPa, m
HEIGHT = 1.79


def le11_lines(s):
    """Inner and outer line of the meridian, (r, z) at s = 0 (bottom) … 1 (top): corners at 0.5 and 0.75."""
    s = np.asarray(s)[:, None]
    turn = lambda radius, angle: radius * np.concatenate([np.cos(angle), np.sin(angle)], 1)  # noqa: E731
    line = lambda a, b, t: np.array(a) + t * (np.array(b) - np.array(a))  # noqa: E731
    edge = np.array([0.5, 0.5])**0.5
    inner = np.where(s <= 0.5, turn(1.0, np.pi / 2 * s), line(edge, (edge[0], HEIGHT), 2 * s - 1))
    outer = np.where(s <= 0.5, turn(1.4, np.pi / 3 * s),
                     np.where(s <= 0.75, line((1.4 * 0.75**0.5, 0.7), (1.0, 1.39), 4 * s - 2), line((1.0, 1.39), (1.0, HEIGHT), 4 * s - 3)))
    return inner, outer


def le11_mapping(x):
    inner, outer = le11_lines(x[:, 2])
    rz = inner + x[:, :1] * (outer - inner)
    angle = QUARTER * x[:, 1]
    return np.stack([rz[:, 0] * np.cos(angle), rz[:, 0] * np.sin(angle), rz[:, 1]], 1)


def le11_calculix(run):
    mesh = fem.bricks(le11_mapping, (5, 10, 16))
    held = [(mesh.at(lambda x: np.abs(x[:, axis] - value) < 1e-9), "xyz"[axis]) for axis, value in ((0, 0), (1, 0), (2, 0), (2, HEIGHT))]
    lines = fem.deck(mesh, LE11, held)
    at = lines.index("*ELASTIC")
    lines[at + 2:at + 2] = ["*EXPANSION", f"{LE11['expansion']:.12g}"]
    heat = np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1]) + mesh.nodes[:, 2]
    fem.solve(run, mesh, [*lines, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 0.", "*STEP", "*STATIC, SOLVER=SPOOLES", "*TEMPERATURE",
                          *(f"{k + 1}, {value:.12g}" for k, value in enumerate(heat)), "*NODE FILE", "U", "*EL FILE", "S", "*END STEP"])
    stress = fem.read_fields(run.folder / "fem.frd", "STRESS", len(mesh.nodes))[-1]
    return stress[mesh.nearest([1, 0, 0])][2]


@case(id="le11", title="NAFEMS LE11: solid cylinder, taper, sphere under temperature",
      geometry="Solid of revolution between a sphere of radius 1 m with a bore above it and a sphere, a cone and a cylinder outside; a quarter, "
               "ends held along the axis. T = √(x² + y²) + z", material="E = 210 GPa, ν = 0.3, α = 2.3e-4/K",
      source="NAFEMS, The Standard Benchmarks, rev. 3 (1990), LE11: σ_zz at A = (1, 0, 0)", unit="MPa", exact=-105.0, grids=(0.14, 0.1, 0.06),
      tolerance=0.015, calculix=le11_calculix, calculix_mesh="5 × 10 × 16 C3D20")
def le11(run, span):
    run.model(parts.block(le11_mapping, (1, 64, 64)), span)
    report = run.solve("static", {
        "material": LE11, "temperature": {"formula": "sqrt(x^2 + y^2) + z", "reference": 0},
        "support": [*symmetry("x", "y", "z"), plane("top", [0, 0, HEIGHT], [0, 0, 1])], "probe": [{"name": "A", "position": [1, 0, 0]}]})
    return probe(report, "A")["stress"][2]


# -------------------------------------------------------------------------------------------------------- conduction

def heat_probe(report, name):
    return next(one for one in report["heat"]["probes"] if one["name"] == name)


@case(id="hot_pipe", title="Heat through the wall of a pipe", quick=True,
      geometry="Quarter of a pipe, radii 50 and 100 mm, 20 mm long, 200 °C inside, 20 °C outside", material="k = 50 W/(m K)",
      source="T = T_a + (T_b - T_a) ln(r/a) / ln(b/a)", unit={"T at r = 70 mm": "°C", "power": "W"},
      exact=lambda: {"T at r = 70 mm": 200 - 180 * np.log(1.4) / np.log(2), "power": 50e-3 * 180 * QUARTER * 20 / np.log(2)},
      grids=(16.0, 11.0, 7.5), tolerance={"T at r = 70 mm": 2e-4, "power": 1e-3})
def hot_pipe(run, span):
    tube = parts.wedge(50.0, 100.0, 20.0, QUARTER, FACETS)
    near = lambda r: parts.where(tube, lambda x: np.abs(np.hypot(x[:, 0], x[:, 1]) - r) < 1e-6)  # noqa: E731
    run.surface("inside", near(50.0))
    run.surface("outside", near(100.0))
    run.model(tube, span)
    report = run.solve("heat", {
        "material": {"conductivity": 50e-3}, "heat": [{"name": "inside", "patch": "inside.stl", "temperature": 200},
                                                      {"name": "outside", "patch": "outside.stl", "temperature": 20}],
        "probe": [{"name": "middle", "position": [70 * 0.5**0.5, 70 * 0.5**0.5, 9]}]})
    return {"T at r = 70 mm": heat_probe(report, "middle")["temperature"], "power": report["heat"]["boundaries"][0]["power"]}


@case(id="pipe_stress", title="Pipe under its own heat",
      geometry="The pipe of hot_pipe between two planes, free of stress at 20 °C; temperatures from igasolve heat", material="E = 200 GPa, ν = 0.3, α = 12e-6/K",
      source="Timoshenko & Goodier, 3rd ed., art. 151 (plane strain)", unit={"hoop stress inside": "MPa", "hoop stress outside": "MPa"},
      exact=lambda: {"hoop stress inside": pipe_hoop(50.0), "hoop stress outside": pipe_hoop(100.0)}, grids=(16.0, 11.0, 7.5),
      tolerance={"hoop stress inside": 0.02, "hoop stress outside": 0.02})
def pipe_stress(run, span):
    tube = parts.wedge(50.0, 100.0, 20.0, QUARTER, FACETS)
    near = lambda r: parts.where(tube, lambda x: np.abs(np.hypot(x[:, 0], x[:, 1]) - r) < 1e-6)  # noqa: E731
    run.surface("inside", near(50.0))
    run.surface("outside", near(100.0))
    run.model(tube, span)
    _, file = run.solve("heat", {"material": {"conductivity": 50e-3}, "heat": [
        {"name": "inside", "patch": "inside.stl", "temperature": 200}, {"name": "outside", "patch": "outside.stl", "temperature": 20}]},
        name="heat", results=True)
    report = run.solve("static", {
        "material": {"E": 200e3, "nu": 0.3, "expansion": 12e-6}, "temperature": {"results": file.name, "reference": 20},
        "support": [*symmetry("x", "y", "z"), plane("far", [0, 0, 20], [0, 0, 1])],
        "probe": [{"name": "inside", "position": [50, 0, 10]}, {"name": "outside", "position": [100, 0, 10]}]})
    return {f"hoop stress {side}": probe(report, side)["stress"][1] for side in ("inside", "outside")}


def pipe_hoop(r, a=50.0, b=100.0, E=200e3, nu=0.3, alpha=12e-6):
    log = np.log(b / a)
    return E * alpha * 180 / (2 * (1 - nu) * log) * (1 - np.log(b / r) - a**2 / (b**2 - a**2) * (1 + b**2 / r**2) * log)


# ------------------------------------------------------------------------------------------------------------ a bolt

SHANK, PLATES, PRELOAD, PULL = 100.0, 200.0, 5000.0, 2000.0  # mm², N


@case(id="bolted_joint", title="Tightened bolt between two clamped bars", quick=True,
      geometry="Bars 60 × 10 × 10 mm side by side, clamped at one end, their other ends one rigid face: the one in the middle is tightened to "
               "5000 N, then the face is pulled with 2000 N", material="E = 210 GPa, ν = 0",
      source="Springs side by side: the bolt takes 100 / 300 of the pull (VDI 2230's load factor)",
      unit={"tension of the bolt": "N", "stress in the bars": "MPa"}, grids=(8.0, 5.0, 3.5),
      exact=lambda: {"tension of the bolt": PRELOAD + PULL * SHANK / (SHANK + PLATES),
                     "stress in the bars": -PRELOAD / PLATES + PULL / (SHANK + PLATES)},
      tolerance=1e-4)
def bolted_joint(run, span):
    run.model(np.concatenate([parts.box((0, y - 5, -5), (60, y + 5, 5)) for y in (0, -15, 15)]), span)
    report = run.solve("static", {
        "material": {"E": 210e3, "nu": 0.0}, "support": [{"name": "clamp", "plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}],
        "bolt": [{"name": "bolt", "plane": {"point": [30, 0, 0], "normal": [1, 0, 0]}, "force": PRELOAD, "box": [0, -7, -7, 60, 7, 7]}],
        "load": [{"name": "pull", "force": [PULL, 0, 0], "moment": [0, 0, 0], "spread": "rigid", "plane": {"point": [60, 0, 0], "normal": [1, 0, 0]}}],
        "probe": [{"name": "bar", "position": [31, 16, 1]}]})
    return {"tension of the bolt": report["statics"]["bolts"][0]["force"], "stress in the bars": probe(report, "bar")["stress"][0]}


# ----------------------------------------------------------------------------------------------------- inertia relief

@case(id="pulled_free_bar", title="Free bar pulled at one end", quick=True,
      geometry="Bar 100 × 10 × 10 mm that nothing holds, 1000 N on one end: it accelerates", material="E = 210 GPa, ν = 0, ρ = 7850 kg/m³",
      source="σ = F x / (A L) from the free end", unit="MPa", exact=2.5, grids=(8.0, 5.0, 3.0), tolerance=1e-6,
      notes="The stress a quarter from the free end; the displacement is quadratic, which the splines hold.")
def pulled_free_bar(run, span):
    run.model(parts.box((0, 0, 0), (100, 10, 10)), span)
    report = run.solve("static", {
        "material": {"E": 210e3, "nu": 0.0, "rho": 7.85e-9}, "inertia_relief": True,
        "load": [{"name": "pull", "force": [1000, 0, 0], "plane": {"point": [100, 0, 0], "normal": [1, 0, 0]}}],
        "probe": [{"name": "quarter", "position": [25, 4, 7]}]})
    return probe(report, "quarter")["stress"][0]
