"""Frequency response, random vibration, shocks.

Rods without Poisson's effect have closed forms for any damping that goes with the stiffness: E becomes E (1 + iη) or E (1 + iωβ).
"""
import numpy as np

from book import case, fem, parts
from igatools import calculix, iga_results

E, RHO = 210e3, 7.8e-9                                  # MPa, t/mm³; mm, s, Hz
LENGTH, WIDTH = 100.0, 10.0
SPEED = np.sqrt(E / RHO)
FIRST = SPEED / (4 * LENGTH)                            # Hz, clamped – free
ETA = 0.05
MATERIAL = "E = 210 GPa, ν = 0, ρ = 7.8e-9 t/mm³"
ROD_KEYS = {
    "material": {"E": E, "nu": 0, "rho": RHO},
    "support": [{"name": "base", "normal": {"direction": [-1, 0, 0]}},
                *({"name": f"guide {d}", "fixed": "normal", "normal": {"direction": d}}
                  for d in ([0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]))],
    "probe": [{"name": "tip", "position": [LENGTH, WIDTH / 2, WIDTH / 2]}, {"name": "root", "position": [0, WIDTH / 2, WIDTH / 2]}]}
ROD = f"Bar {LENGTH:g} × {WIDTH:g} × {WIDTH:g} mm on a base at one end, guided along its sides so that it moves as a rod"


def rod(run, span):
    run.model(parts.box((0, 0, 0), (LENGTH, WIDTH, WIDTH)), (span, WIDTH, WIDTH))


def wave_number(frequency):
    return 2 * np.pi * frequency / (SPEED * np.sqrt(1 + 1j * ETA))


def transmissibility(frequency):
    return abs(1 / np.cos(wave_number(frequency) * LENGTH))


def root_stress(frequency, acceleration):
    """Amplitude of E u' where the base moves by -acceleration / omega²: u = u0 (cos kx + tan kL sin kx)."""
    k = wave_number(frequency)
    return abs(E * k * np.tan(k * LENGTH)) * acceleration / (2 * np.pi * frequency)**2


@case(id="rod_harmonic", title="Rod on a shaking base: transmissibility and stress", quick=True,
      geometry=f"{ROD}; the base accelerates with an amplitude of 10 m/s², structural damping η = {ETA}",
      material=MATERIAL, source="Wave equation: u(L) / u(0) = 1 / cos kL, k = ω / √(E (1 + iη) / ρ)",
      unit={"at half the first resonance": "1", "at the first resonance": "1", "at the second resonance": "1",
            "stress at the root, first resonance": "MPa"},
      exact=lambda: {"at half the first resonance": transmissibility(FIRST / 2), "at the first resonance": transmissibility(FIRST),
                     "at the second resonance": transmissibility(3 * FIRST),
                     "stress at the root, first resonance": root_stress(FIRST, 1e4)},
      grids=(33.0, 25.0, 16.0), tolerance={"at half the first resonance": 1e-5, "at the first resonance": 1e-4,
                                           "at the second resonance": 2e-3, "stress at the root, first resonance": 2e-3})
def rod_harmonic(run, span):
    rod(run, span)
    _, file = run.solve("harmonic", {**ROD_KEYS, "eigen": {"modes": 4}, "damping": {"structural": ETA},
                                     "base": {"direction": [1, 0, 0], "spectrum": 1e4},
                                     "harmonic": {"frequencies": [FIRST / 2, FIRST, 3 * FIRST]}}, results=True)
    results = iga_results.read(file)
    tip, root = results.table("probe_tip"), results.table("probe_root")
    at = lambda table, name, f: table[name][np.argmin(abs(table["frequency"] - f))]  # noqa: E731
    return {"at half the first resonance": at(tip, "transmissibility", FIRST / 2),
            "at the first resonance": at(tip, "transmissibility", FIRST),
            "at the second resonance": at(tip, "transmissibility", 3 * FIRST),
            "stress at the root, first resonance": at(root, "stress_xx", FIRST)}


DENSITY, FROM, TO = 1e6, FIRST / 20, 5 * FIRST          # (mm/s²)²/Hz


def rod_rms():
    """Integrals of the closed form over the band, converged to eight digits."""
    f = np.linspace(FROM, TO, 200_001)
    return {"acceleration of the tip": np.sqrt(np.trapz(DENSITY * transmissibility(f)**2, f)),
            "stress at the root": np.sqrt(np.trapz(DENSITY * root_stress(f, 1)**2, f))}


@case(id="rod_random", title="Rod on a base under random vibration", quick=True,
      geometry=f"{ROD}; white noise of 1 (m/s²)²/Hz from {FROM:.0f} to {TO:.0f} Hz, η = {ETA}", material=MATERIAL,
      source="|1 / cos kL|² integrated over the band", unit={"acceleration of the tip": "mm/s²", "stress at the root": "MPa"},
      exact=rod_rms, grids=(25.0, 16.0, 10.0), tolerance={"acceleration of the tip": 5e-4, "stress at the root": 5e-3},
      notes="Root mean squares (1 sigma) of all that the band excites.")
def rod_random(run, span):
    rod(run, span)
    report = run.solve("random", {**ROD_KEYS, "eigen": {"modes": 8}, "damping": {"structural": ETA},
                                  "base": {"direction": [1, 0, 0], "psd": DENSITY}, "random": {"from": FROM, "to": TO, "points": 2}})
    tip, root = report["probes"]
    return {"acceleration of the tip": tip["acceleration"][0], "stress at the root": root["stress"][0]}


PULL, TURN = 100.0, LENGTH / SPEED                      # MPa; time that a wave takes along the rod
DURATION = 3 * TURN


def wave(t):
    """f'(t) of u = f(t - (L - x) / c) - f(t - (L + x) / c), over c / E: the half sine and its echoes from the base."""
    t = np.asarray(t, float)
    pulse = np.where((t > 0) & (t < DURATION), PULL * np.sin(np.pi * t / DURATION), 0)
    return np.where(t > 0, pulse - (wave(t - 2 * TURN) if np.any(t > 2 * TURN) else 0), 0)


def shock():
    t = np.linspace(0, 8 * TURN, 400_001)
    velocity = wave(t) - wave(t - 2 * TURN)
    tip = SPEED / E * np.concatenate([[0], np.cumsum((velocity[1:] + velocity[:-1]) / 2)]) * (t[1] - t[0])
    return {"largest displacement of the tip": abs(tip).max(), "largest stress at the root": abs(2 * wave(t - TURN)).max()}


@case(id="rod_shock", title="Half-sine shock at the end of a rod", quick=True,
      geometry=f"{ROD}; half a sine of 100 MPa on the other end, as long as a wave takes for three lengths; no damping",
      material=MATERIAL, source="d'Alembert's waves with their echoes", unit={"largest displacement of the tip": "mm",
                                                                              "largest stress at the root": "MPa"},
      exact=shock, grids=(16.0, 10.0, 7.0), tolerance={"largest displacement of the tip": 1e-3, "largest stress at the root": 0.01})
def rod_shock(run, span):
    rod(run, span)
    times = np.linspace(0, DURATION, 101)
    _, file = run.solve("transient", {
        **ROD_KEYS, "eigen": {"modes": 12}, "damping": {"ratio": 0.0},
        "load": [{"name": "pull", "traction": [PULL, 0, 0], "normal": {"direction": [1, 0, 0]},
                  "history": np.column_stack([times, np.sin(np.pi * times / DURATION)])}],
        "transient": {"end": 8 * TURN, "step": TURN / 100}}, results=True)
    results = iga_results.read(file)
    return {"largest displacement of the tip": abs(results.table("probe_tip")["displacement_x"]).max(),
            "largest stress at the root": abs(results.table("probe_root")["stress_xx"]).max()}


BEAM, HEIGHT, BETA, FORCE = 200.0, 10.0, 2e-6, 10.0     # mm, mm, s, N


def beam(frequency):
    """Amplitude of the tip of a Timoshenko cantilever under a force there, E and G times 1 + iωβ."""
    omega = 2 * np.pi * frequency
    complex_E = E * (1 + 1j * omega * BETA)
    area, inertia, shear = HEIGHT**2, HEIGHT**4 / 12, 5 / 6 * complex_E / 2 * HEIGHT**2
    bending, mass, turning = complex_E * inertia, RHO * area * omega**2, RHO * inertia * omega**2
    # w = e^(sx), ψ = a e^(sx): shear (s² w - s ψ) + mass w = 0; bending s² ψ + shear (s w - ψ) + turning ψ = 0.
    roots = np.roots([shear * bending, 0, shear * turning + bending * mass, 0, mass * turning - shear * mass])
    ratio = (shear * roots**2 + mass) / (shear * roots)
    edge = np.exp(roots * BEAM)
    system = np.array([np.ones(4), ratio, ratio * roots * edge, shear * (roots - ratio) * edge])
    return abs(edge @ np.linalg.solve(system, [0, 0, 0, FORCE]))


POINTS = {"at 100 Hz": 100.0, "at 250 Hz": 250.0, "at 800 Hz": 800.0}


def beam_by_elements(run):
    mesh = fem.bricks(lambda x: x * np.array([BEAM, HEIGHT, HEIGHT]), (20, 2, 2), "C3D20R")
    forces = mesh.forces(lambda x: x[:, 0] > BEAM - 1e-6, (0, 0, FORCE / HEIGHT**2))
    loaded = np.argwhere(np.abs(forces) > 1e-12)
    tip = mesh.nearest((BEAM, HEIGHT / 2, HEIGHT / 2))
    load = ["*CLOAD", *(f"{n + 1}, {d + 1}, {forces[n, d]:.12g}" for n, d in loaded)]
    held = [(mesh.at(lambda x: x[:, 0] < 1e-6), "xyz")]
    steps = ["*STEP", "*FREQUENCY, SOLVER=SPOOLES, STORAGE=YES", "20", "*END STEP"]
    for frequency in POINTS.values():
        steps += ["*STEP", "*STEADY STATE DYNAMICS", f"{frequency}, {frequency * 1.0001}, 2, 1.", "*MODAL DAMPING, RAYLEIGH",
                  f",, 0., {BETA}", *load, "*NODE FILE", "U", "*END STEP"]
    fem.solve(run, mesh, [*fem.deck(mesh, {"E": E, "nu": 0, "rho": RHO}, held), *steps])
    real, imaginary = (fem.read_fields(run.folder / "fem.frd", name, len(mesh.nodes)) for name in ("DISP", "DISPI"))
    return {name: float(np.hypot(a[tip, 2], b[tip, 2])) for name, a, b in zip(POINTS, real[::2], imaginary[::2])}


@case(id="beam_harmonic", title="Cantilever under a harmonic force",
      geometry=f"Beam {BEAM:g} × {HEIGHT:g} × {HEIGHT:g} mm, one end held, 10 N across the other; C = βK, β = 2 µs. First resonance 208 Hz",
      material=MATERIAL, source="Timoshenko's beam, shear factor 5/6", unit="mm",
      exact=lambda: {name: beam(f) for name, f in POINTS.items()},
      grids=(25.0, 16.0, 10.0), tolerance={"at 100 Hz": 1e-3, "at 250 Hz": 2e-3, "at 800 Hz": 8e-3}, calculix=beam_by_elements, calculix_mesh="C3D20R 20 × 2 × 2, modal, 20 modes",
      notes="Between resonances. At 800 Hz two large parts nearly cancel, and the beam's theory itself is off by half a per cent.")
def beam_harmonic(run, span):
    run.model(parts.box((0, 0, 0), (BEAM, HEIGHT, HEIGHT)), (span, HEIGHT, HEIGHT))
    _, file = run.solve("harmonic", {
        "material": {"E": E, "nu": 0, "rho": RHO}, "support": [{"name": "wall", "normal": {"direction": [-1, 0, 0]}}],
        "load": [{"name": "shaker", "force": [0, 0, FORCE], "normal": {"direction": [1, 0, 0]}}],
        "probe": [{"name": "tip", "position": [BEAM, HEIGHT / 2, HEIGHT / 2]}], "eigen": {"modes": 10},
        "damping": {"rayleigh": [0, BETA]}, "harmonic": {"frequencies": list(POINTS.values())}}, results=True)
    table = iga_results.read(file).table("probe_tip")
    return {name: table["displacement_z"][np.argmin(abs(table["frequency"] - f))] for name, f in POINTS.items()}


# ---------------------------------------------------------------------------------------------- deep beam, step of load

DEEP, STEEL, STEP = (10.0, 1.0, 2.0), {"E": 200e9, "nu": 0.3, "rho": 8000.0}, 1e6  # m (half of the width), N/m of the whole beam
RATIO, END = 0.02, 0.1
DEEP_FORCE = STEP / (2 * DEEP[1] * DEEP[2])             # N/m³


def deep_beam():
    """Timoshenko's beam between hinges: sine waves, each with its two frequencies."""
    area, inertia = 2 * DEEP[1] * DEEP[2], 2 * DEEP[1] * DEEP[2]**3 / 12
    shear = 5 / 6 * STEEL["E"] / 2.6 * area
    t = np.linspace(0, END, 20001)
    middle = np.zeros_like(t)
    for n in range(1, 40, 2):
        k = n * np.pi / DEEP[0]
        K = np.array([[shear * k * k, -shear * k], [-shear * k, STEEL["E"] * inertia * k * k + shear]])
        M = STEEL["rho"] * np.array([area, inertia])
        squares, shapes = np.linalg.eigh(K / np.sqrt(np.outer(M, M)))
        shapes = shapes / np.sqrt(M)[:, None]
        for square, w in zip(squares, shapes[0]):
            omega = np.sqrt(square)
            damped = omega * np.sqrt(1 - RATIO**2)
            step = 1 - np.exp(-RATIO * omega * t) * (np.cos(damped * t) + RATIO * omega / damped * np.sin(damped * t))
            middle += np.sin(n * np.pi / 2) * w * w * 4 * STEP / (n * np.pi) / square * step
    return of_history(t, middle)


def of_history(t, u):
    peak = np.argmax(u)
    return {"largest deflection": 1e3 * u[peak], "at the time": 1e3 * t[peak], "mean deflection": 1e3 * np.trapz(u, t) / END}


def deep_beam_in_bricks(run):
    mesh = fem.bricks(lambda x: x * DEEP, (10, 1, 2))
    ends = mesh.at(lambda x: np.abs(x[:, 0] * (x[:, 0] - DEEP[0])) < 1e-9)
    middle = mesh.at(lambda x: np.abs(x[:, 1]) < 1e-9)
    # Along the axis one line at a place where it does not bend: CalculiX' modal steps take no rigid motion.
    still = mesh.at(lambda x: (np.abs(x[:, 0] - DEEP[0] / 2) < 1e-9) & (np.abs(x[:, 2] - DEEP[2] / 2) < 1e-9))
    held = [(ends, "z"), (middle, "y"), (np.setdiff1d(ends, middle), "y"), (still, "x")]
    probe = mesh.nearest((DEEP[0] / 2, 0, DEEP[2] / 2))
    fem.solve(run, mesh, [*fem.deck(mesh, STEEL, held), "*NSET, NSET=PROBE", f"{probe + 1},",
                          "*STEP", "*FREQUENCY, SOLVER=SPOOLES, STORAGE=YES", "16", "*END STEP",
                          "*STEP, INC=100000", "*MODAL DYNAMIC", f"1e-4, {END}", "*MODAL DAMPING", f"1, 16, {RATIO}",
                          "*DLOAD", f"SOLID, GRAV, {DEEP_FORCE / STEEL['rho']:.12g}, 0., 0., 1.",
                          "*NODE PRINT, NSET=PROBE, FREQUENCY=1", "U", "*END STEP"])
    t, u = calculix.read_displacements(run.folder / "fem.dat", [probe])
    return of_history(t, u[:, 0, 2])


@case(id="deep_beam_step", title="Deep beam under a step of load", quick=True,
      geometry="Beam 10 × 2 × 2 m, ends held in their plane, free along its axis; half of the width. 1 MN/m from time 0 on, ratio 0.02; middle of the span",
      material="E = 200 GPa, ν = 0.3, ρ = 8000 kg/m³", source="Timoshenko's beam by its modes; NAFEMS, Selected Benchmarks for Forced Vibration "
      "(1993), 5T, gives 1.043 mm after 11.7 ms", unit={"largest deflection": "mm", "at the time": "ms", "mean deflection": "mm"},
      exact=deep_beam, grids=(1.3, 0.9, 0.6), tolerance=0.01, calculix=deep_beam_in_bricks, calculix_mesh="C3D20, 10 × 1 × 2, *MODAL DYNAMIC, 16 modes")
def deep_beam_step(run, span):
    run.model(parts.box((0, 0, 0), DEEP), span)
    held = [{"name": name, "fixed": fixed, "plane": {"point": point, "normal": normal}} for name, fixed, point, normal in (
        ("middle", "normal", [0, 0, 0], [0, 1, 0]), ("left", "yz", [0, 0, 0], [1, 0, 0]), ("right", "yz", [DEEP[0], 0, 0], [1, 0, 0]))]
    _, file = run.solve("transient", {
        "material": STEEL, "support": held, "load": [{"name": "step", "body_force": [0, 0, DEEP_FORCE], "history": 1}],
        "probe": [{"name": "middle", "position": [DEEP[0] / 2, 0, DEEP[2] / 2]}], "eigen": {"modes": 12}, "damping": {"ratio": RATIO},
        "transient": {"end": END, "step": 1e-4}}, results=True)
    table = iga_results.read(file).table("probe_middle")
    return of_history(table["time"], table["displacement_z"])


# --------------------------------------------------------------------------------------------------------- machine on mounts

MACHINE, MOUNT, MACHINE_RATIO = 120.0, 4e5, 0.05        # kg of block and motor, N/m in all, of critical damping
BLOCK, BLOCK_STEEL = (0.4, 0.3, 0.05), {"E": 210e12, "nu": 0.3, "rho": 7850.0}
NATURAL = np.sqrt(MOUNT / MACHINE) / (2 * np.pi)
MACHINE_POINTS = {"below its frequency": 0.5, "near it": 0.95, "above it": 3.0}


def machine():
    return {name: abs(1 / (1 - r * r + 2j * MACHINE_RATIO * r)) * 1e3 * 100 / MOUNT for name, r in MACHINE_POINTS.items()}


@case(id="machine_on_mounts", title="Machine on its mounts, a harmonic force", quick=True,
      geometry="Stiff plate 0.4 × 0.3 × 0.05 m on a foundation of 400 kN/m in all, a motor joined to its upper side, 120 kg together; 100 N in the motor's "
               f"direction, ratio {MACHINE_RATIO}", material="E = 210 TPa (rigid to 1e-7), ν = 0.3, ρ = 7850 kg/m³", source="single oscillator", unit="mm",
      exact=machine, grids=(0.1, 0.07, 0.05), tolerance=1e-5)
def machine_on_mounts(run, span):
    run.model(parts.box((0, 0, 0), BLOCK), span)
    area = BLOCK[0] * BLOCK[1]
    _, file = run.solve("harmonic", {
        "material": BLOCK_STEEL, "spring": [{"name": "mounts", "plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}, "normal_stiffness": MOUNT / area,
                                             "tangential_stiffness": 0.5 * MOUNT / area}],
        "added_mass": [{"name": "motor", "mass": MACHINE - BLOCK_STEEL["rho"] * np.prod(BLOCK), "inertia": [1.0, 1.0, 1.0],
                        "at": [BLOCK[0] / 2, BLOCK[1] / 2, 0.25], "plane": {"point": [0, 0, BLOCK[2]], "normal": [0, 0, 1]}}],
        "load": [{"name": "shaker", "force": [0, 0, 100.0], "plane": {"point": [0, 0, BLOCK[2]], "normal": [0, 0, 1]}}],
        "probe": [{"name": "middle", "position": [BLOCK[0] / 2, BLOCK[1] / 2, BLOCK[2] / 2]}], "eigen": {"modes": 6},
        "damping": {"ratio": MACHINE_RATIO}, "harmonic": {"frequencies": [r * NATURAL for r in MACHINE_POINTS.values()]}}, results=True)
    table = iga_results.read(file).table("probe_middle")
    return {name: 1e3 * table["displacement_z"][np.argmin(abs(table["frequency"] - r * NATURAL))] for name, r in MACHINE_POINTS.items()}
