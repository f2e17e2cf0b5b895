"""Meshes of quadratic finite elements: nodes, elements, faces on the boundary, forces that are consistent with tractions."""
from functools import cached_property

import numpy as np

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
BRICK_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
BRICK_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]  # outwards
TET_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
TET_FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]


def with_mid_nodes(faces, edges, corners):
    """Faces of quadratic elements: corners, then the nodes between them."""
    number = {frozenset(edge): corners + k for k, edge in enumerate(edges)}
    return np.array([[*face, *(number[frozenset(pair)] for pair in zip(face, face[1:] + face[:1]))] for face in faces])


class Mesh:
    """nodes (n, 3); elements (m, 20) of C3D20 or (m, 10) of C3D10, numbers of nodes in Abaqus' order. kind: of CalculiX."""

    def __init__(self, nodes, elements, kind):
        self.nodes, self.elements, self.kind = np.asarray(nodes, float), np.asarray(elements), kind

    def at(self, condition):
        """Numbers of the nodes that meet the condition, points (n, 3) -> (n) of bool."""
        return np.flatnonzero(condition(self.nodes))

    def nearest(self, point):
        return int(np.argmin(np.linalg.norm(self.nodes - np.asarray(point, float), axis=1)))

    @cached_property
    def boundary(self):
        """Faces of one element alone: (k, 8) or (k, 6) numbers of nodes, outwards."""
        bricks = self.elements.shape[1] == 20
        faces = with_mid_nodes(BRICK_FACES, BRICK_EDGES, 8) if bricks else with_mid_nodes(TET_FACES, TET_EDGES, 4)
        found = self.elements[:, faces].reshape(-1, faces.shape[1])
        _, first, counts = np.unique(np.sort(found[:, :len(BRICK_FACES[0]) if bricks else 3], axis=1), axis=0, return_index=True,
                                     return_counts=True)
        return found[first[counts == 1]]

    def forces(self, condition, traction):
        """face_forces() of the boundary's faces whose nodes all meet the condition, points (n, 3) -> (n) of bool."""
        faces = self.boundary
        return self.face_forces(faces[np.asarray(condition(self.nodes))[faces].all(1)], traction)

    def face_forces(self, faces, traction):
        """Forces at the nodes (n, 3), consistent with a traction on faces (rows of boundary): a vector, or
        function(points (q, 3), outward normals (q, 3)) -> (q, 3)."""
        given = traction if callable(traction) else lambda x, normal: np.broadcast_to(np.asarray(traction, float), x.shape)
        total = np.zeros_like(self.nodes)
        for shape, weight, x, normal in self._face_points(faces):
            area = np.linalg.norm(normal, axis=1)
            t = given(x, normal / area[:, None])
            np.add.at(total, faces, weight * area[:, None, None] * shape[None, :, None] * t[:, None, :])
        return total

    def face_areas(self, faces):
        """Areas (k) of faces (rows of boundary)."""
        return sum(weight * np.linalg.norm(normal, axis=1) for _, weight, _, normal in self._face_points(faces))

    def _face_points(self, faces):
        """Values (8 or 6), weight, places (k, 3) and normals with the length of the Jacobian (k, 3) of a rule's points."""
        for at, weight in zip(*(quad_rule() if faces.shape[1] == 8 else triangle_rule())):
            shape, slopes = (quad_shapes if faces.shape[1] == 8 else triangle_shapes)(at)
            x = self.nodes[faces]
            tangents = np.einsum("an,fnd->afd", slopes, x)
            yield shape, weight, np.einsum("n,fnd->fd", shape, x), np.cross(tangents[0], tangents[1])


def quad_rule():
    x, w = np.polynomial.legendre.leggauss(3)
    return [(a, b) for a in x for b in x], [u * v for u in w for v in w]


def quad_shapes(at):
    """Values (8) and slopes (2, 8) of the 8-node square -1 … 1."""
    r, s = at
    corner = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)
    a, b = corner.T
    values = (1 + a * r) * (1 + b * s) * (a * r + b * s - 1) / 4
    by_r = a * (1 + b * s) * (2 * a * r + b * s) / 4
    by_s = b * (1 + a * r) * (2 * b * s + a * r) / 4
    middle = [((1 - r * r) * (1 - s) / 2, -r * (1 - s), -(1 - r * r) / 2), ((1 + r) * (1 - s * s) / 2, (1 - s * s) / 2, -s * (1 + r)),
              ((1 - r * r) * (1 + s) / 2, -r * (1 + s), (1 - r * r) / 2), ((1 - r) * (1 - s * s) / 2, -(1 - s * s) / 2, -s * (1 - r))]
    return (np.concatenate([values, [m[0] for m in middle]]),
            np.array([np.concatenate([by_r, [m[1] for m in middle]]), np.concatenate([by_s, [m[2] for m in middle]])]))


def triangle_rule():
    """Seven points, exact to degree 5; weights of the triangle of area 1/2."""
    a, b = (6 - 15**0.5) / 21, (6 + 15**0.5) / 21
    points, weights = [(1 / 3, 1 / 3)], [9 / 80]
    for c, w in ((a, (155 - 15**0.5) / 2400), (b, (155 + 15**0.5) / 2400)):
        points += [(c, c), (1 - 2 * c, c), (c, 1 - 2 * c)]
        weights += [w] * 3
    return points, weights


def triangle_shapes(at):
    """Values (6) and slopes (2, 6) of the 6-node triangle."""
    r, s = at
    t = 1 - r - s
    values = np.array([t * (2 * t - 1), r * (2 * r - 1), s * (2 * s - 1), 4 * t * r, 4 * r * s, 4 * s * t])
    return values, np.array([[1 - 4 * t, 4 * r - 1, 0, 4 * (t - r), 4 * s, -4 * s], [1 - 4 * t, 0, 4 * s - 1, -4 * r, 4 * r, 4 * (t - s)]])
