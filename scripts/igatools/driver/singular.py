"""Lines on which stress has no limit as spans shrink: sharp re-entrant edges of the part, and the ends of supports."""
import numpy as np

from igatools.choices import chosen_polygons, snap_length

SHARP = np.deg2rad(25)   # turn between facets from which on their edge counts as one; facets of CAD faces turn by 20 at most
# Where a support that lets its face slide ends at a convex edge with a turn of 90 degrees or more, the part goes on beyond it by
# symmetry without a re-entrant edge; facets of round faces turn by up to 20 less.
SLIDING_END = np.deg2rad(70)
NEAR_SPANS = 2.0         # nearer than this stress depends on the span size


def edges_of(vertices, triangles):
    """Edges of a closed, outward-oriented surface, each once: ends (n, 2), turn between its two facets (n; positive where the solid
    takes less than half a turn, 0 where a facet has no area or there is no single partner), and the triangle (n) on its left."""
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
    return directed[once], np.where(known, np.arctan2(sine, cosine), 0)[once], facet[once]


def reentrant_edges(vertices, triangles):
    """Ends (n, 2, 3) of the edges that are sharp and where the solid takes more than half a turn."""
    edges, turn, _ = edges_of(vertices, triangles)
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
    edges, turn, _ = edges_of(vertices, triangles)
    slides = {frozenset(map(tuple, vertices[edge])) for edge in edges[turn > SLIDING_END]}
    found = []
    for table in supports:
        if not {"region", "box", "plane", "normal"} & set(table):
            continue  # lines, points, patches and the whole surface
        ends = outline(chosen_polygons(table, vertices, triangles, region, names, snap_length(model)))
        if table.get("fixed") == "normal":
            ends = [end for end in ends if frozenset(end) not in slides]
        found += ends
    return np.array(found, float).reshape(-1, 2, 3)


def outline(polygons):
    """Edges that belong to one polygon alone, as pairs of tuples."""
    count = {}
    for polygon in polygons:
        corners = [tuple(corner) for corner in polygon]
        for k, corner in enumerate(corners):
            key = frozenset((corner, corners[k - 1]))
            count[key] = count.get(key, 0) + 1
    return [tuple(key) for key, number in count.items() if number == 1 and len(key) == 2]


def distance(place, lines):
    """From a place to the nearest of lines (n, 2, 3)."""
    if not len(lines):
        return np.inf
    start, along = lines[:, 0], lines[:, 1] - lines[:, 0]
    share = np.einsum("ij,ij->i", place - start, along) / np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    return np.linalg.norm(start + np.clip(share, 0, 1)[:, None] * along - place, axis=1).min()
