#!/usr/bin/python3
"""A pressure pulse in a free square bar: the problem that compare_wave.py gives to both programs.

The bar lies along x from 0 to LENGTH. A pressure PEAK sin^2(pi t / PULSE) acts on the face x = 0 until t = PULSE, nothing
else does. Units: kg, mm, ms (kN, GPa). Without Poisson's ratio the motion is one-dimensional and known exactly.
"""
import numpy as np

LENGTH, WIDTH = 100.0, 10.0
E, RHO = 210.0, 7.8e-6
PEAK, PULSE, END = 0.1, 0.01, 0.05  # the pulse is 52 mm long and passes the bar two and a half times
PULSE_SAMPLES = 200

# Nine points of a cross-section and Simpson's weights: its mean is exact for cubic fields.
_LINE = np.array([0.0, 0.5 * WIDTH, WIDTH])
SECTION = np.array([(y, z) for y in _LINE for z in _LINE])
SECTION_WEIGHTS = np.outer([1, 4, 1], [1, 4, 1]).ravel() / 36


def probe_points():
    """Nine points of the far end face, then the middle of the bar: (10, 3)."""
    end = np.column_stack([np.full(len(SECTION), LENGTH), SECTION])
    return np.vstack([end, [0.5 * LENGTH, 0.5 * WIDTH, 0.5 * WIDTH]])


def observed(displacements):
    """Displacements along x at probe_points(), (times, 10) → mean of the end face and the middle, (times, 2)."""
    return np.column_stack([displacements[:, :-1] @ SECTION_WEIGHTS, displacements[:, -1]])


def pressure(t):
    return PEAK * np.sin(np.pi * np.clip(t, 0, PULSE) / PULSE) ** 2


def impulse(t):
    """Integral of the pressure from 0 to t."""
    s = np.clip(t, 0, PULSE)
    return PEAK * (0.5 * s - PULSE / (4 * np.pi) * np.sin(2 * np.pi * s / PULSE))


def exact(x, t):
    """Displacement without Poisson's ratio: waves that run from both ends, reflected with the same sign (d'Alembert)."""
    c = np.sqrt(E / RHO)
    total = np.zeros_like(np.asarray(t, float))
    for k in range(int(END * c / (2 * LENGTH)) + 1):
        total = total + impulse(t - (2 * k * LENGTH + x) / c) + impulse(t - (2 * (k + 1) * LENGTH - x) / c)
    return total / (RHO * c)


def exact_observed(t):
    return np.column_stack([exact(LENGTH, t), exact(0.5 * LENGTH, t)])


def relative_error(t, found, reference):
    """L2 norm over time of found - reference, over that of the reference, for each column; `reference` is a function."""
    wanted = reference(t)
    return np.sqrt(np.trapz((found - wanted) ** 2, t, axis=0) / np.trapz(wanted**2, t, axis=0))


# ------------------------------------------------------------------------------------------------------ input of the tools

_QUADS = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]  # corners numbered x fastest


def write_stl(path):
    corners = [(x, y, z) for z in (0, WIDTH) for y in (0, WIDTH) for x in (0, LENGTH)]
    with open(path, "w") as file:
        file.write("solid bar\n")
        for a, b, c, d in _QUADS:
            for triangle in ((a, b, c), (a, c, d)):
                lines = ["vertex {} {} {}".format(*corners[i]) for i in triangle]
                file.write("\n".join(["facet normal 0 0 0", "outer loop", *lines, "endloop", "endfacet", ""]))
        file.write("endsolid bar\n")


def write_pulse(path):
    times = np.linspace(0, PULSE, PULSE_SAMPLES + 1)
    np.savetxt(path, np.column_stack([times, pressure(times) / PEAK]), fmt="%.12g", delimiter=", ")


def grid(span, offset, degree):
    """Corners of the box and spans of a grid whose planes lie `offset` spans below the bar's faces, with a margin of
    `degree` spans; (A, B, spans)."""
    size = np.array([LENGTH, WIDTH, WIDTH])
    inside = np.ceil(size / span + offset - 1e-9).astype(int)
    low = -(degree + offset) * span
    spans = inside + 2 * degree
    return np.full(3, low), low + spans * span, spans


def run_file(model, nu, mass, outputs):
    return f"""units = "mm"
[[bodies]]
name = "bar"
model = "{model}"
mass = "{mass}"
material = {{ law = "linear-elastic", E = {E}, nu = {nu}, rho = {RHO} }}
[[loads]]
pressure = {PEAK}
factor = "pulse.csv"
plane = {{ point = [0, 0, 0], normal = [-1, 0, 0] }}
[time]
end = {END}
[output]
interval = {END / outputs}
field_interval = {END / outputs}
subdivide = 1
viewer = false
"""


def hexahedra(size):
    """Nodes (n, 3), 8-node bricks (m, 8) from 0 in Abaqus' order, and the bricks at x = 0, for edges of about `size`."""
    count = np.maximum(np.round(np.array([LENGTH, WIDTH, WIDTH]) / size / 2).astype(int), 1) * 2  # even: probes are nodes
    lines = [np.linspace(0, length, n + 1) for length, n in zip((LENGTH, WIDTH, WIDTH), count)]
    nodes = np.stack(np.meshgrid(*lines, indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(len(nodes)).reshape(count + 1)
    low, high = slice(None, -1), slice(1, None)
    corner = [(low, low, low), (high, low, low), (high, high, low), (low, high, low),
              (low, low, high), (high, low, high), (high, high, high), (low, high, high)]
    bricks = np.stack([number[place] for place in corner], -1).reshape(-1, 8)
    return nodes, bricks, np.flatnonzero(nodes[bricks[:, 0], 0] == 0)


def nodes_at(nodes, points):
    """Numbers of the nodes that lie at the points."""
    distance = np.linalg.norm(nodes[None] - points[:, None], axis=2)
    nearest = distance.argmin(axis=1)
    assert distance[np.arange(len(points)), nearest].max() < 1e-9 * LENGTH
    return nearest
