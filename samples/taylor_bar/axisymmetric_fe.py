#!/usr/bin/python3
"""The Taylor bar by a second method, independent of this project's code: an axisymmetric finite-element program in numpy.

  samples/taylor_bar/axisymmetric_fe.py                5 × 50 elements, a minute
  samples/taylor_bar/axisymmetric_fe.py 10             10 elements along the radius, ten times as many along the axis

Bilinear quadrilaterals with four Gauss points; the dilatation is the element's mean (no volumetric locking; Nagtegaal, Parks
and Rice 1974). Updated Lagrangian, Jaumann rate by the half-step rotation of Hughes and Winget 1980, radial return, lumped
mass, central differences. The wall stops nodes and lets them go. Units: kg, mm, ms (GPa).
"""
import sys

import numpy as np

RADIUS, LENGTH, SPEED, END = 3.2, 32.4, 227.0, 0.08
E, NU, RHO, YIELD, HARDENING = 117.0, 0.35, 8.93e-6, 0.4, 0.1
MU, LAMBDA = E / 2 / (1 + NU), E * NU / ((1 + NU) * (1 - 2 * NU))
COURANT = 0.6
_G = 3**-0.5
GAUSS = [(-_G, -_G), (_G, -_G), (_G, _G), (-_G, _G)]


def shapes(a, b):
    values = 0.25 * np.array([(1 - a) * (1 - b), (1 + a) * (1 - b), (1 + a) * (1 + b), (1 - a) * (1 + b)])
    slopes = 0.25 * np.array([[b - 1, 1 - b, 1 + b, -1 - b], [a - 1, -1 - a, 1 + a, 1 - a]])
    return values, slopes


SHAPES = [shapes(*point) for point in GAUSS]


def mesh(across):
    along = 10 * across
    r, z = np.linspace(0, RADIUS, across + 1), np.linspace(0, LENGTH, along + 1)
    nodes = np.stack(np.meshgrid(r, z), -1).reshape(-1, 2)
    number = np.arange(len(nodes)).reshape(along + 1, across + 1)
    corners = [number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]]
    return nodes, np.stack(corners, -1).reshape(-1, 4)


def points_of(x, elements):
    """Per Gauss point: shape values (4), gradients (elements, 2, 4), radius, volume per radian."""
    corners, found = x[elements], []
    for values, slopes in SHAPES:
        J = np.einsum("an,enk->eak", slopes, corners)
        determinant = J[:, 0, 0] * J[:, 1, 1] - J[:, 0, 1] * J[:, 1, 0]
        inverse = np.stack([J[:, 1, 1], -J[:, 0, 1], -J[:, 1, 0], J[:, 0, 0]], -1).reshape(-1, 2, 2) / determinant[:, None, None]
        radius = corners[:, :, 0] @ values
        found.append((values, inverse @ slopes, radius, determinant * radius))
    return found


def stable_step(x, elements):
    a, b, c, d = (x[elements[:, i]] for i in range(4))
    p, q = c - a, d - b
    area = 0.5 * np.abs(p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0])
    longest = np.max([np.linalg.norm(side, axis=1) for side in (b - a, c - b, d - c, a - d)], axis=0)
    return COURANT * (area / longest).min() / np.sqrt((LAMBDA + 2 * MU) / RHO)


def advance_stress(points, velocity, elements, dt, stress, plastic):
    """Stress (4, elements, rr zz tt rz) and plastic strain (4, elements) go on by dt with the geometry of the half step."""
    v = velocity[elements]
    rates = []
    for values, gradients, radius, _ in points:
        L = np.einsum("eni,ekn->eik", v, gradients)
        rates.append((L, (v[:, :, 0] @ values) / radius))
    volumes = [point[3] for point in points]
    mean = sum(w * (L[:, 0, 0] + L[:, 1, 1] + hoop) for w, (L, hoop) in zip(volumes, rates)) / sum(volumes)
    for q, (L, hoop) in enumerate(rates):
        D = np.stack([L[:, 0, 0], L[:, 1, 1], hoop, 0.5 * (L[:, 0, 1] + L[:, 1, 0])], 1)
        D[:, :3] += ((mean - D[:, :3].sum(1)) / 3)[:, None]
        angle = 2 * np.arctan(0.25 * (L[:, 0, 1] - L[:, 1, 0]) * dt)
        c, s = np.cos(angle), np.sin(angle)
        rr, zz, tt, rz = stress[q].T
        trial = np.stack([c * c * rr + 2 * c * s * rz + s * s * zz, s * s * rr - 2 * c * s * rz + c * c * zz, tt,
                          c * s * (zz - rr) + (c * c - s * s) * rz], 1) + 2 * MU * dt * D
        trial[:, :3] += (LAMBDA * dt * mean)[:, None]
        pressure = trial[:, :3].mean(1)
        trial[:, :3] -= pressure[:, None]
        equivalent = np.sqrt(1.5 * ((trial[:, :3] ** 2).sum(1) + 2 * trial[:, 3] ** 2)) + 1e-300
        flow = np.maximum((equivalent - YIELD - HARDENING * plastic[q]) / (3 * MU + HARDENING), 0)
        trial *= (1 - 3 * MU * flow / equivalent)[:, None]
        trial[:, :3] += pressure[:, None]
        stress[q], plastic[q] = trial, plastic[q] + flow


def forces(points, elements, stress, count):
    volumes = [point[3] for point in points]
    mean = sum(w * s[:, :3].mean(1) for w, s in zip(volumes, stress)) / sum(volumes)
    total = np.zeros((count, 2))
    for (values, gradients, radius, w), s in zip(points, stress):
        s = s + np.append(np.ones(3), 0) * (mean - s[:, :3].mean(1))[:, None]
        along_r = s[:, 0, None] * gradients[:, 0] + s[:, 3, None] * gradients[:, 1] + (s[:, 2] / radius)[:, None] * values
        along_z = s[:, 3, None] * gradients[:, 0] + s[:, 1, None] * gradients[:, 1]
        for d, part in enumerate((along_r, along_z)):
            total[:, d] -= np.bincount(elements.ravel(), (w[:, None] * part).ravel(), count)
    return total


def run(across):
    start, elements = mesh(across)
    x, velocity = start.copy(), np.zeros_like(start)
    velocity[:, 1] = -SPEED
    stress, plastic = np.zeros((4, len(elements), 4)), np.zeros((4, len(elements)))
    points, mass = points_of(x, elements), np.zeros(len(x))
    for values, _, _, w in points:
        mass += np.bincount(elements.ravel(), (RHO * w[:, None] * values).ravel(), len(x))
    time, steps = 0.0, 0
    while time < END:
        dt = min(stable_step(x, elements), END - time)
        velocity += dt * forces(points_of(x, elements), elements, stress, len(x)) / mass[:, None]
        velocity[start[:, 0] == 0, 0] = 0
        into = x[:, 1] + dt * velocity[:, 1] < 0
        velocity[into, 1] = -x[into, 1] / dt
        advance_stress(points_of(x + 0.5 * dt * velocity, elements), velocity, elements, dt, stress, plastic)
        x, time, steps = x + dt * velocity, time + dt, steps + 1
    weights = np.array([point[3] for point in points_of(x, elements)])
    return {"steps": steps, "length": np.ptp(x[:, 1]), "radius": x[:, 0].max(), "largest_plastic_strain": plastic.max(),
            "mean_of_its_element": ((plastic * weights).sum(0) / weights.sum(0)).max()}


if __name__ == "__main__":
    for name, value in run(int(sys.argv[1]) if len(sys.argv) > 1 else 5).items():
        print(f"{name:<24}{value:.6g}")
