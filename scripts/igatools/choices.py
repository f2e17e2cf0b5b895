"""Choices of surface of a run file, cut out of a model's triangles.

They follow solver/space/surface_cut.cpp: whole triangles by region and normal, cut exactly by boxes and planes.
"""
import math

import numpy as np


def clip(polygon, normal, offset, snap):
    """The part of a convex polygon with normal · x <= offset; corners within `snap` count as in the plane."""
    heights = polygon @ normal - offset
    heights[np.abs(heights) <= snap] = 0
    if (heights <= 0).all():
        return polygon
    out = []
    for k in range(len(polygon)):
        p, q, hp, hq = polygon[k], polygon[k - len(polygon) + 1], heights[k], heights[k - len(polygon) + 1]
        if hp <= 0:
            out.append(p)
        if hp * hq < 0:
            out.append(p + hp / (hp - hq) * (q - p))
    return np.array(out).reshape(-1, 3)


def half_spaces(table):
    sides = []
    if "plane" in table:
        normal = np.array(table["plane"]["normal"], float)
        normal /= np.linalg.norm(normal)
        place, tolerance = normal @ np.array(table["plane"]["point"], float), table["plane"].get("tolerance", 0)
        sides += [(normal, place + tolerance), (-normal, -place + tolerance)]
    if "box" in table:
        for d in range(3):
            axis = np.eye(3)[d]
            sides += [(axis, table["box"][3 + d]), (-axis, -table["box"][d])]
    return sides


def chosen_polygons(table, vertices, triangles, region, names, snap):
    """Polygons (k × 3) of a choice of surface."""
    return [polygon for _, polygon, _ in chosen_pieces(table, vertices, triangles, region, names, snap)]


def chosen_pieces(table, vertices, triangles, region, names, snap):
    """Of a choice of surface, triangle by triangle: its number, the polygon (k × 3) of it that is chosen, whether that is all of it."""
    wanted = None
    if "region" in table:
        given = table["region"] if isinstance(table["region"], list) else [table["region"]]
        wanted = {r for r, name in enumerate(names) if name in given or r in given}
    sides = half_spaces(table)
    for t, corners in enumerate(vertices[triangles]):
        if wanted is not None and region[t] not in wanted:
            continue
        if "normal" in table:
            n, direction = np.cross(corners[1] - corners[0], corners[2] - corners[0]), np.array(table["normal"]["direction"], float)
            cosine = n @ direction / max(np.linalg.norm(n) * np.linalg.norm(direction), 1e-300)
            if cosine < math.cos(math.radians(table["normal"].get("angle", 1))) - 1e-12:
                continue
        polygon = corners
        for normal, offset in sides:
            polygon = clip(polygon, normal, offset, snap)
            if len(polygon) < 3:
                break
        if len(polygon) >= 3:
            yield t, polygon, polygon is corners


def snap_length(model):
    """Corners closer to a plane than this lie in it: as surface_depth() of format/model/trimmed_model.hpp, but for rounding."""
    h = (np.array(model.attribute("/patch", "B")) - model.attribute("/patch", "A")) / model.attribute("/patch", "spans")
    return float(np.linalg.norm(h) * (model.attribute("/quadrature", "sliver_tolerance") + 1e-9))
