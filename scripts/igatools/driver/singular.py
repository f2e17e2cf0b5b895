"""Lines on which stress has no limit as spans shrink: sharp re-entrant edges of the part, and the ends of supports."""
import numpy as np

from igatools.choices import chosen_polygons, snap_length

SHARP = np.deg2rad(25)   # turn between facets from which on their edge counts as one; facets of CAD faces turn by 20 at most
# Where a support that lets its face slide ends at a convex edge with a turn of 90 degrees or more, the part goes on beyond it by
# symmetry without a re-entrant edge; facets of round faces turn by up to 20 less.
SLIDING_END = np.deg2rad(70)
NEAR_SPANS = 2.0         # nearer than this stress depends on the span size


def edges_of(vertices, triangles):
    """Edges of a closed, outward-oriented surface, each once: ends (n, 2), and the turn between its two facets (n), positive where the
    solid takes less than half a turn, 0 where a facet has no area or the edge no partner."""
    corners = vertices[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    normal = normal / np.where(size > 0, size, 1)[:, None]
    directed = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    facet = np.tile(np.arange(len(triangles)), 3)
    key = directed[:, 0].astype(np.int64) * len(vertices) + directed[:, 1]
    back = directed[:, 1].astype(np.int64) * len(vertices) + directed[:, 0]
    order = np.argsort(key)
    place = np.minimum(np.searchsorted(key[order], back), len(order) - 1)
    other = facet[order[place]]
    along = vertices[directed[:, 1]] - vertices[directed[:, 0]]
    length = np.linalg.norm(along, axis=1)
    sine = np.einsum("ij,ij->i", np.cross(normal[facet], normal[other]), along / np.where(length > 0, length, 1)[:, None])
    cosine = np.einsum("ij,ij->i", normal[facet], normal[other])
    known = (key[order[place]] == back) & (size[facet] > 0) & (size[other] > 0)
    once = directed[:, 0] < directed[:, 1]
    return directed[once], np.where(known, np.arctan2(sine, cosine), 0)[once]


def reentrant_edges(vertices, triangles):
    """Ends (n, 2, 3) of the edges that are sharp and where the solid takes more than half a turn."""
    edges, turn = edges_of(vertices, triangles)
    found = vertices[edges[turn < -SHARP]]
    corners = vertices[triangles]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
    # Needles have no normal to rely on: what counts is an edge of some length.
    is_edge = np.linalg.norm(found[:, 1] - found[:, 0], axis=1).sum() > 0.5e-3 * np.sqrt(area)
    return found if is_edge else np.zeros((0, 2, 3))


def support_ends(supports, model):
    """Ends (n, 2, 3) of the lines on the surface at which supports ([[support]] tables of a run file) end."""
    vertices, triangles = model["/surface/vertices"], model["/surface/triangles"]
    region, names = model["/surface/region"], model.texts("/surface/regions")
    edges, turn = edges_of(vertices, triangles)
    sliding, snap = vertices[edges[turn > SLIDING_END]], snap_length(model)
    found = []
    for table in supports:
        if not {"region", "box", "plane", "normal"} & set(table):
            continue  # lines, points, patches and the whole surface
        ends = outline(chosen_polygons(table, vertices, triangles, region, names, snap), snap)
        if table.get("fixed") == "normal":
            ends = [end for end in ends if not lies_on(end, sliding, snap)]
        found += ends
    return np.array(found, float).reshape(-1, 2, 3)


def outline(polygons, snap):
    """Edges (2, 3) that belong to one polygon alone; corners nearer than about `snap` are one."""
    seen = {}
    for polygon in polygons:
        numbers = [tuple(corner) for corner in np.rint(polygon / snap).astype(np.int64)]
        for k, number in enumerate(numbers):
            seen.setdefault(frozenset((number, numbers[k - 1])), []).append(polygon[[k - 1, k]])
    return [ends[0] for key, ends in seen.items() if len(ends) == 1 and len(key) == 2]


def lies_on(edge, lines, snap):
    """Is an edge a part of one of the lines?"""
    return bool(len(lines)) and bool((np.maximum(distances(edge[0], lines), distances(edge[1], lines)) < snap).any())


def distances(place, lines):
    """From a place to each of lines (n, 2, 3)."""
    start, along = lines[:, 0], lines[:, 1] - lines[:, 0]
    share = np.einsum("ij,ij->i", place - start, along) / np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    return np.linalg.norm(start + np.clip(share, 0, 1)[:, None] * along - place, axis=1)


def distance(place, lines):
    """From a place to the nearest of lines."""
    return distances(place, lines).min(initial=np.inf)
