#!/usr/bin/python3
"""What a plane cuts of closed surfaces, as triangles: numpy and scipy alone.

Outlines of crushed bodies touch and cross one another a little, which polygon triangulations do not forgive. Here the outline is
only a cloud of points, dense enough to be seen as a line, whose Delaunay triangles are kept where the oriented outline winds
around them: overlaps count as inside, cavities as outside.
"""
import numpy as np
from scipy.spatial import Delaunay, QhullError

FINENESS = 400  # points of the outline along the section's longest side, at least
BLOCK = 2_000_000  # pairs of triangle and segment that are looked at together


def plane_axes(normal):
    """Two unit vectors that span the plane, right-handed with the normal."""
    normal = np.asarray(normal, float) / np.linalg.norm(normal)
    first = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    first /= np.linalg.norm(first)
    return first, np.cross(normal, first)


def outline(vertices, triangles, place, normal):
    """Oriented segments (n, 2, 3) in which outward-oriented triangles cross the plane; closed surfaces give closed loops.

    A vertex in the plane counts as above it, so that every edge is crossed once or not at all.
    """
    height = (vertices - place) @ np.asarray(normal, float)
    above = height[triangles] >= 0
    crossing = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    corners, above = triangles[crossing], above[crossing]
    ends = np.zeros((len(crossing), 2, 3))
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        for side, chosen in enumerate((above[:, k] & ~above[:, (k + 1) % 3], ~above[:, k] & above[:, (k + 1) % 3])):
            low, high = np.minimum(a, b)[chosen], np.maximum(a, b)[chosen]  # the same point from both triangles of the edge
            share = height[low] / (height[low] - height[high])
            ends[chosen, side] = vertices[low] + share[:, None] * (vertices[high] - vertices[low])
    return ends


def winding(points, segments):
    """How often closed loops of oriented segments (m, 2, 2) wind around points (n, 2)."""
    a, b = segments[:, 0], segments[:, 1]
    total = np.empty(len(points), dtype=int)
    step = max(1, BLOCK // max(1, len(segments)))
    for first in range(0, len(points), step):
        x, y = points[first:first + step, 0, None], points[first:first + step, 1, None]
        side = (b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (x - a[:, 0]) * (b[:, 1] - a[:, 1])
        up, down = (a[:, 1] <= y) & (b[:, 1] > y), (a[:, 1] > y) & (b[:, 1] <= y)
        total[first:first + step] = (up & (side > 0)).sum(axis=1) - (down & (side < 0)).sum(axis=1)
    return total


def section(vertices, triangles, place, normal):
    """Vertices (n, 3) and triangles (m, 3) that fill the plane's cut of a closed, outward-oriented surface; both empty where
    it cuts nothing."""
    nothing = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    segments = outline(vertices, triangles, place, normal)
    if len(segments) == 0:
        return nothing
    axes = np.stack(plane_axes(normal), axis=1)
    flat = (segments - place) @ axes
    spacing = np.ptp(flat, axis=(0, 1)).max() / FINENESS
    parts = np.maximum(1, np.ceil(np.linalg.norm(flat[:, 1] - flat[:, 0], axis=1) / spacing)).astype(int)
    owner = np.repeat(np.arange(len(flat)), parts)
    share = (np.arange(len(owner)) - np.repeat(np.cumsum(parts) - parts, parts)) / np.repeat(parts, parts)
    cloud = flat[owner, 0] + share[:, None] * (flat[owner, 1] - flat[owner, 0])
    try:
        filled = Delaunay(cloud).simplices
    except QhullError:  # a cut without area
        return nothing
    filled = filled[np.abs(winding(cloud[filled].mean(axis=1), flat)) > 0]
    return np.asarray(place) + cloud @ axes.T, filled.astype(np.int64)


def area(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
