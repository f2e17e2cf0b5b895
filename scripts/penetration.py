#!/usr/bin/python3
"""How deep does a deformed body lie in itself?  scripts/penetration.py RUN.h5 [--body NAME] [--steps N N …]

For each step of fields of an explicit run (default: the last one): how many vertices of the body's surface lie inside the
deformed body, how deep the deepest is, and where. A vertex, moved outwards by a thousandth of an edge, is inside where the
surface winds around it: rays in two directions leave the body more often than they enter it. Its depth is the distance to
the nearest face that looks against one of the vertex's own faces. This looks at the results alone and knows nothing of the
solver's contact.
As a module: deepest(rest, triangles, now) of arrays (vertices, 3), (triangles, 3), (vertices, 3).
Needs h5py and numpy.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

from igatools import iga_results

OFFSET = 1e-3   # outwards, in mean edges
FACING = -0.1   # faces look against each other below this cosine


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=1, keepdims=True), 1e-300)


def winding(points, corners, random):
    """Winding numbers of a closed surface around points: crossings of rays along a random axis, outwards less inwards."""
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    p, t = points @ turn, corners @ turn
    low, high = t[:, :, :2].min(axis=1), t[:, :, :2].max(axis=1)
    bin_size = 0.5 * np.median(high - low)
    origin = low.min(axis=0)
    columns = int((high.max(axis=0)[1] - origin[1]) / bin_size) + 2
    first, last = ((low - origin) // bin_size).astype(int), ((high - origin) // bin_size).astype(int)
    spread = last - first + 1
    count = spread.prod(axis=1)  # bins of each triangle
    triangle = np.repeat(np.arange(len(t)), count)
    place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    bins = (first[triangle, 0] + place // spread[triangle, 1]) * columns + first[triangle, 1] + place % spread[triangle, 1]
    order = np.argsort(bins, kind="stable")
    bins, triangle = bins[order], triangle[order]
    cell = ((p[:, :2] - origin) // bin_size).astype(int)
    cell = cell[:, 0] * columns + cell[:, 1]
    winds = [crossings(part, t, triangle, np.searchsorted(bins, at), np.searchsorted(bins, at, side="right"))
             for part, at in zip(np.array_split(p, 16), np.array_split(cell, 16))]
    return np.rint(np.sign(np.linalg.det(turn)) * np.concatenate(winds)).astype(int)


def crossings(p, t, triangle, begin, end):
    """Signed crossings of rays upwards from points p with the triangles t[triangle[begin … end]] of each."""
    count = end - begin
    point = np.repeat(np.arange(len(p)), count)
    place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    q, tri = p[point], t[triangle[begin[point] + place]]

    def side(u, v):  # twice the area seen along the ray, with the point
        return (u[:, 0] - q[:, 0]) * (v[:, 1] - q[:, 1]) - (u[:, 1] - q[:, 1]) * (v[:, 0] - q[:, 0])

    weights = np.stack([side(tri[:, 1], tri[:, 2]), side(tri[:, 2], tri[:, 0]), side(tri[:, 0], tri[:, 1])])
    area = weights.sum(axis=0)
    hit = (weights > 0).all(axis=0) | (weights < 0).all(axis=0)
    hit &= (weights * tri[:, :, 2].T).sum(axis=0) / np.where(hit, area, 1) > q[:, 2]
    return np.bincount(point[hit], np.sign(area[hit]), len(p))


def distances(p, a, b, c):
    """Of one point to many triangles."""
    normal = np.cross(b - a, c - a)
    length2 = np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)
    height = np.einsum("ij,ij->i", p - a, normal)
    foot = p - (height / length2)[:, None] * normal
    within = np.ones(len(a), bool)
    best = np.full(len(a), np.inf)
    for u, v in ((a, b), (b, c), (c, a)):
        edge = v - u
        within &= np.einsum("ij,ij->i", np.cross(edge, foot - u), normal) >= 0
        along = np.clip(np.einsum("ij,ij->i", p - u, edge) / np.maximum(np.einsum("ij,ij->i", edge, edge), 1e-300), 0, 1)
        best = np.minimum(best, np.linalg.norm(p - u - along[:, None] * edge, axis=1))
    return np.where(within, np.abs(height) / np.sqrt(length2), best)


def deepest(rest, triangles, now):
    """Vertices inside, ascending by number, and their depths. @return two arrays of equal length"""
    same, first, number = np.unique(rest, axis=0, return_index=True, return_inverse=True)
    triangles = number.ravel()[triangles]  # one vertex for each place, or the surface would not be closed
    triangles = triangles[(triangles != np.roll(triangles, 1, axis=1)).all(axis=1)]
    x = now[first]
    corners = x[triangles]
    face = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal = np.zeros_like(same)
    for corner in range(3):
        np.add.at(normal, triangles[:, corner], face)
    normal, face = unit(normal), unit(face)
    edge = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1).mean()
    outside = x + OFFSET * edge * normal
    random = np.random.default_rng(1)
    winds = [winding(outside, corners, random) for _ in range(2)]
    inside = np.flatnonzero((winds[0] > 0) & (winds[1] > 0))
    centre = corners.mean(axis=1)
    radius = np.linalg.norm(corners - centre[:, None], axis=2).max(axis=1)
    depths = []
    for v in inside:
        own = (triangles == v).any(axis=1)
        faces = np.flatnonzero(((face @ face[own].T).min(axis=1) < FACING) & ~own)
        away = np.linalg.norm(centre[faces] - x[v], axis=1)
        faces = faces[away - radius[faces] <= away.min(initial=np.inf)]  # only these may be nearest
        depths.append(distances(x[v], *(corners[faces, k] for k in range(3))).min(initial=np.inf))
    order = np.argsort(first[inside])
    return first[inside][order], np.array(depths)[order] if len(inside) else np.zeros(0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--body", help="default: the first one")
    parser.add_argument("--steps", type=int, nargs="+", help="numbers of the steps of fields, the first is 0")
    arguments = parser.parse_args()
    results = iga_results.read(arguments.file)
    body = arguments.body or results.texts("/body_names")[0]
    for step in arguments.steps or [len(results["/fields/time"]) - 1]:
        fields = results.fields(step)
        rest = fields.mesh[f"{body}/vertices"]
        now = rest + fields[f"{body}/displacement"]
        inside, depths = deepest(rest, fields.mesh[f"{body}/triangles"], now)
        print(f"t = {fields.time:.6g}: {len(inside)} of {len(rest)} vertices inside '{body}'", end="")
        if len(inside):
            v = inside[depths.argmax()]
            print(f"; deepest {depths.max():.4g} at {now[v].round(2).tolist()}, at rest {rest[v].round(2).tolist()}", end="")
        print()


if __name__ == "__main__":
    sys.exit(main())
