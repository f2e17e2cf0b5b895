"""Surfaces with fewer vertices for the page: vertices that lie together and face the same way become one of them.

Rossignac and Borrel (1993), with a vertex of the surface itself for each cluster, the one where the surface bends most, so that
edges stay sharp and what is known at vertices (displacements, stresses) needs no averaging.
"""
import numpy as np

MOST_CELLS = 4096  # along the longest side


def thinned(vertices, triangles, most):
    """Numbers of at most about `most` kept vertices, and triangles between them (numbers among the kept ones)."""
    if len(vertices) <= most:
        return np.arange(len(vertices)), triangles
    normals, bend = vertex_normals(vertices, triangles)
    low, high = 1, MOST_CELLS  # cells along the longest side: enough vertices, too many
    while high - low > max(1, low // 50):
        middle = (low + high) // 2
        if clusters(vertices, normals, middle)[1] <= most:
            low = middle
        else:
            high = middle
    member, count = clusters(vertices, normals, low)
    kept = representatives(vertices, bend, member, count)
    mapped = member[triangles]
    proper = (mapped[:, 0] != mapped[:, 1]) & (mapped[:, 1] != mapped[:, 2]) & (mapped[:, 2] != mapped[:, 0])
    return kept, without_folds(vertices[kept], normals[kept], without_copies(mapped[proper]))


def vertex_normals(vertices, triangles):
    """Sums of the area vectors around each vertex (n, 3); how much they differ in direction: 0 flat … 1 (n)."""
    corners = vertices[triangles]
    area = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros_like(vertices)
    size = np.zeros(len(vertices))
    for k in range(3):
        np.add.at(total, triangles[:, k], area)
        np.add.at(size, triangles[:, k], np.linalg.norm(area, axis=1))
    return total, 1 - np.linalg.norm(total, axis=1) / np.where(size > 0, size, 1)


def clusters(vertices, normals, cells):
    """Number of the cluster of each vertex, and how many there are: same cell of a grid, same main direction."""
    low = vertices.min(0)
    size = np.ptp(vertices, axis=0).max() / cells or 1.0
    cell = np.minimum((vertices - low) / size, cells).astype(np.int64)
    axis = np.abs(normals).argmax(1)
    side = 2 * axis + (normals[np.arange(len(normals)), axis] < 0)
    key = ((cell[:, 0] * (cells + 1) + cell[:, 1]) * (cells + 1) + cell[:, 2]) * 6 + side
    names, member = np.unique(key, return_inverse=True)
    return member, len(names)


def representatives(vertices, bend, member, count):
    """One vertex of each cluster: where the surface bends most, of equal ones that next to the middle."""
    size = np.bincount(member, minlength=count)
    middle = np.stack([np.bincount(member, vertices[:, d], count) / size for d in range(3)], 1)
    distance = np.linalg.norm(vertices - middle[member], axis=1)
    order = np.lexsort((distance, -np.round(bend, 3), member))
    first = np.concatenate([[0], np.cumsum(size)[:-1]])
    return order[first]


def without_folds(vertices, normals, triangles):
    """Without the triangles that moving their corners turned over: they lie on others, which cover their place as well."""
    corners = vertices[triangles]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return triangles[np.einsum("ij,ij->i", area, normals[triangles].sum(1)) > 0]


def without_copies(triangles):
    """Each set of three corners once."""
    first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)[1]
    return triangles[np.sort(first)]
