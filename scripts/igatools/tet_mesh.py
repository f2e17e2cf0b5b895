#!/usr/bin/python3
"""Tetrahedra in a closed STL, made by Gmsh: the standard finite-element mesh that compare_fem.py measures against.

Gmsh classifies the surface, parametrises it, meshes it anew with a target size and fills it; without a size the STL's own
triangles are filled. The mid-edge nodes of 10-node tetrahedra are set here: on the STL where the edge lies on the surface,
so that curved faces stay curved (Gmsh's own high-order nodes on discrete surfaces stray, and untangling them takes minutes).
"""
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

EDGES = np.array([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)])  # order of the mid-edge nodes in C3D10
FACES = np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
FEATURE_ANGLE = 40  # degrees; sharper edges stay edges of the mesh
MIN_DISTORTION = 0.2  # smallest Jacobian over that of the straight tetrahedron; below it the edges are straightened
CANDIDATES = 12  # nearest samples of the STL whose triangles are tried for the closest point

GEOMETRY = """Merge "{stl}";
{classify}
faces() = Surface{{:}};
Surface Loop(1) = faces();
Volume(1) = {{1}};
Physical Volume("solid") = {{1}};
Mesh.Algorithm3D = 10;
Mesh.Optimize = 1;
{sizes}
"""


class MeshError(Exception):
    """Gmsh did not deliver a mesh of the solid."""


def gmsh_script(stl, size):
    """Text of a .geo file: remeshed to a target size, or filled as it is where size is None."""
    if size is None:
        return GEOMETRY.format(stl=stl, classify="", sizes="Mesh.MeshSizeExtendFromBoundary = 1;")
    classify = f"ClassifySurfaces{{{FEATURE_ANGLE} * Pi / 180, 1, 1, Pi}};\nCreateGeometry;"
    return GEOMETRY.format(stl=stl, classify=classify, sizes=f"Mesh.MeshSizeMin = {size};\nMesh.MeshSizeMax = {size};")


def read_tets(path, kind):
    """Nodes (n, 3) and {element set: (m, k)} of the tetrahedra (kind C3D4: k = 4, C3D10: k = 10), zero-based, of a mesh that
    Gmsh wrote in Abaqus format; nodes of no such element are left out."""
    size = int(kind.removeprefix("C3D")) + 1
    nodes, sets, target = [], {}, None
    with open(path, encoding="utf-8") as file:
        for line in file:
            if line.startswith("*"):
                key = line.upper()
                target = nodes if key.startswith("*NODE") else None
                if key.startswith("*ELEMENT") and f"TYPE={kind}" in key.replace(" ", "").strip().split(","):
                    target = sets.setdefault(line.split("=")[-1].strip(), [])
            elif target is not None and line.strip():
                target.append(line.strip().rstrip(","))
    if not nodes or not any(sets.values()):
        raise MeshError(f"{path}: has no tetrahedra; see Gmsh's log beside it")
    nodes = np.array([line.split(",") for line in nodes], dtype=float)
    rows = {name: np.array(",".join(lines).split(","), dtype=np.int64).reshape(-1, size)[:, 1:] for name, lines in sets.items()}
    used = np.unique(np.concatenate([numbers.ravel() for numbers in rows.values()]))
    order = np.argsort(nodes[:, 0])
    at = order[np.searchsorted(nodes[order, 0].astype(np.int64), used)]
    return nodes[at, 1:], {name: np.searchsorted(used, numbers) for name, numbers in rows.items()}


def read_linear_tets(path):
    """Nodes (n, 3) and 4-node tetrahedra (m, 4), zero-based, of all element sets of a mesh that Gmsh wrote in Abaqus format."""
    nodes, sets = read_tets(path, "C3D4")
    return nodes, np.concatenate(list(sets.values()))


def volumes(nodes, tets):
    a, b, c, d = (nodes[tets[:, i]] for i in range(4))
    return np.einsum("ti,ti->t", b - a, np.cross(c - a, d - a)) / 6


def closest_on_triangles(points, triangles):
    """Closest points of triangles (n, 3, 3) to points (n, 3), row by row. Ericson, Real-Time Collision Detection, 5.1.5."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    ab, ac = b - a, c - a
    dot = lambda u, v: np.einsum("ni,ni->n", u, v)  # noqa: E731
    d1, d2 = dot(ab, points - a), dot(ac, points - a)
    d3, d4 = dot(ab, points - b), dot(ac, points - b)
    d5, d6 = dot(ab, points - c), dot(ac, points - c)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    ratio = lambda u, v: np.divide(u, v, out=np.zeros_like(u), where=v != 0)  # noqa: E731
    cases = [  # (where, weight of b, weight of c)
        ((d1 <= 0) & (d2 <= 0), 0 * d1, 0 * d1),
        ((d3 >= 0) & (d4 <= d3), 0 * d1 + 1, 0 * d1),
        ((d6 >= 0) & (d5 <= d6), 0 * d1, 0 * d1 + 1),
        ((vc <= 0) & (d1 >= 0) & (d3 <= 0), ratio(d1, d1 - d3), 0 * d1),
        ((vb <= 0) & (d2 >= 0) & (d6 <= 0), 0 * d1, ratio(d2, d2 - d6)),
        ((va <= 0) & (d4 >= d3) & (d5 >= d6), 1 - ratio(d4 - d3, (d4 - d3) + (d5 - d6)),
         ratio(d4 - d3, (d4 - d3) + (d5 - d6))),
    ]
    total = va + vb + vc
    v = np.select([case[0] for case in cases], [case[1] for case in cases], ratio(vb, total))
    w = np.select([case[0] for case in cases], [case[2] for case in cases], ratio(vc, total))
    return a + v[:, None] * ab + w[:, None] * ac


class Surface:
    """Closest points on a triangle surface, found among triangles whose samples are nearest."""

    def __init__(self, triangles, spacing):
        longest = np.max([np.linalg.norm(triangles[:, i] - triangles[:, i - 1], axis=1) for i in range(3)], axis=0)
        parts = np.clip(np.ceil(longest / spacing).astype(int), 1, 200)
        samples, owners = [], []
        for n in np.unique(parts):
            rows = np.flatnonzero(parts == n)
            i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
            inside = (i + j) < n
            u, v = (i[inside] + 1 / 3) / n, (j[inside] + 1 / 3) / n
            weights = np.stack([1 - u - v, u, v], 1)
            samples.append(np.einsum("sk,tki->tsi", weights, triangles[rows]).reshape(-1, 3))
            owners.append(np.repeat(rows, len(u)))
        self.triangles, self.owners = triangles, np.concatenate(owners)
        self.tree = cKDTree(np.concatenate(samples))

    def closest(self, points):
        """Closest points (n, 3) of points (n, 3)."""
        return self.nearest(points)[0]

    def nearest(self, points):
        """Closest points (n, 3) of points (n, 3), and the numbers (n) of the triangles that hold them."""
        count = min(CANDIDATES, self.tree.n)
        _, near = self.tree.query(points, k=count)
        near = self.owners[near.reshape(len(points), count)]
        found = np.stack([closest_on_triangles(points, self.triangles[near[:, k]]) for k in range(count)], 1)
        best = np.argmin(np.linalg.norm(found - points[:, None], axis=2), axis=1)
        rows = np.arange(len(points))
        return found[rows, best], near[rows, best]


def shape_values(barycentric):
    """Values (10) of the quadratic tetrahedron's shape functions at barycentric coordinates (4)."""
    s = np.asarray(barycentric)
    return np.concatenate([s * (2 * s - 1), [4 * s[a] * s[b] for a, b in EDGES]])


def _shape_gradients(u):
    """Gradients (10, 3) of the quadratic tetrahedron's shape functions at u."""
    barycentric = np.array([1 - sum(u), *u])
    gradients = np.array([(-1, -1, -1), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
    corners = (4 * barycentric - 1)[:, None] * gradients
    return np.vstack([corners, [4 * (barycentric[a] * gradients[b] + barycentric[b] * gradients[a]) for a, b in EDGES]])


def _jacobians(nodes, tets, u):
    return np.linalg.det(np.einsum("eni,nj->eij", nodes[tets], _shape_gradients(u)))


_CORNERS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
_LOW = (5 - 5**0.5) / 20
GAUSS_POINTS = [_LOW + (1 - 4 * _LOW) * corner for corner in _CORNERS]
CHECK_POINTS = [*_CORNERS, *[(_CORNERS[a] + _CORNERS[b]) / 2 for a, b in EDGES], *GAUSS_POINTS]


def curved_volume(nodes, tets):
    return sum(_jacobians(nodes, tets, u).sum() for u in GAUSS_POINTS) / 24


def quadratic_tets(nodes, tets, surface=None):
    """10-node tetrahedra: nodes (n, 3), tets (m, 10). Mid-edge nodes of edges on the boundary move to the closest points of
    `surface`, unless that distorts a tetrahedron; without a surface all edges are straight."""
    pairs = np.sort(tets[:, EDGES], axis=2).reshape(-1, 2)
    edges, index = np.unique(pairs, axis=0, return_inverse=True)
    middle = nodes[edges].mean(1)
    quadratic = np.hstack([tets, len(nodes) + index.reshape(-1, 6)])
    if surface is None:
        return np.vstack([nodes, middle]), quadratic
    faces = np.sort(tets[:, FACES], axis=2).reshape(-1, 3)
    faces, times = np.unique(faces, axis=0, return_counts=True)
    rim = np.unique(faces[times == 1][:, [(0, 1), (1, 2), (0, 2)]].reshape(-1, 2), axis=0)
    on_surface = np.searchsorted(edges[:, 0] * len(nodes) + edges[:, 1], rim[:, 0] * len(nodes) + rim[:, 1])
    curved = middle.copy()
    curved[on_surface] = surface.closest(middle[on_surface])
    straight_jacobian = 6 * volumes(nodes, tets)
    while True:
        placed = np.vstack([nodes, curved])
        worst = np.min([_jacobians(placed, quadratic, u) for u in CHECK_POINTS], axis=0) / straight_jacobian
        bent = quadratic[worst < MIN_DISTORTION, 4:].ravel() - len(nodes)
        bent = bent[(curved[bent] != middle[bent]).any(1)]
        if len(bent) == 0:
            return placed, quadratic
        curved[bent] = middle[bent]


def nodal_volumes(nodes, tets):
    """Integrals of the shape functions of 10-node tetrahedra, added up at the nodes: (n)."""
    total = np.zeros(len(nodes))
    for u in GAUSS_POINTS:
        np.add.at(total, tets, _jacobians(nodes, tets, u)[:, None] / 24 * shape_values([1 - sum(u), *u]))
    return total


def run_gmsh(gmsh, stl, size, folder, name, run):
    """Nodes, tets and the measured run of Gmsh; `run(command, log)` starts a program and measures it."""
    script, mesh, log = (Path(folder) / f"{name}.{end}" for end in ("geo", "inp", "gmsh.log"))
    script.write_text(gmsh_script(Path(stl).resolve(), size))
    measured = run([gmsh, "-3", "-nt", "1", "-format", "inp", "-o", mesh, script], log)
    if measured["exit_code"] != 0 or not mesh.exists():
        raise MeshError(f"{gmsh} ended with exit code {measured['exit_code']} and no mesh for size {size}; see {log}")
    nodes, tets = read_linear_tets(mesh)
    if (volumes(nodes, tets) <= 0).any():
        raise MeshError(f"{mesh}: has inverted tetrahedra for size {size}; try another size")
    return nodes, tets, measured
