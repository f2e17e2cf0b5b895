"""Finite elements beside ours: 20-node bricks of mapped blocks or 10-node tetrahedra of Gmsh, solved by CalculiX."""
from functools import cached_property

import numpy as np

from igatools import calculix
from igatools.measured_run import RunError

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
BRICK_EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
BRICK_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]  # outwards
TET_EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
TET_FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
# CalculiX reads 20 characters of a number: 12 digits, an exponent and signs fit.


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
        """Forces at the nodes (n, 3), consistent with a traction on the boundary's faces whose nodes all meet the condition.
        traction: a vector, or function(points (q, 3), outward normals (q, 3)) -> (q, 3)."""
        given = traction if callable(traction) else lambda x, normal: np.broadcast_to(np.asarray(traction, float), x.shape)
        total = np.zeros_like(self.nodes)
        faces = self.boundary
        faces = faces[np.asarray(condition(self.nodes))[faces].all(1)]
        for at, weight in zip(*(quad_rule() if faces.shape[1] == 8 else triangle_rule())):
            shape, slopes = (quad_shapes if faces.shape[1] == 8 else triangle_shapes)(at)
            x = self.nodes[faces]
            tangents = np.einsum("an,fnd->afd", slopes, x)
            normal = np.cross(tangents[0], tangents[1])
            area = np.linalg.norm(normal, axis=1)
            t = given(np.einsum("n,fnd->fd", shape, x), normal / area[:, None])
            np.add.at(total, faces, weight * area[:, None, None] * shape[None, :, None] * t[:, None, :])
        return total


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


def bricks(mapping, divisions, kind="C3D20"):
    """20-node bricks (C3D20, or C3D20R) of a mapped unit cube, as parts.block: mid-edge nodes lie on the mapped edges."""
    n = np.asarray(divisions)
    index = np.stack(np.meshgrid(*(np.arange(2 * m + 1) for m in n), indexing="ij"), -1).reshape(-1, 3)
    used = (index % 2).sum(1) <= 1
    number = np.full(2 * n + 1, -1)
    number[tuple(index[used].T)] = np.arange(used.sum())
    nodes = np.asarray(mapping(index[used] / (2 * n)), float)
    first = 2 * np.stack(np.meshgrid(*(np.arange(m) for m in n), indexing="ij"), -1).reshape(-1, 1, 3)
    local = np.concatenate([2 * CORNERS, [CORNERS[a] + CORNERS[b] for a, b in BRICK_EDGES]])
    at = first + local
    return Mesh(nodes, number[at[..., 0], at[..., 1], at[..., 2]], kind)


def tetrahedra(run, geometry, size):
    """10-node tetrahedra by Gmsh of a geometry: lines of a .geo file with the OpenCASCADE kernel that make one volume."""
    script = run.folder / "mesh.geo"
    script.write_text("\n".join(['SetFactory("OpenCASCADE");', geometry, 'Physical Volume("solid") = Volume{:};', "Mesh.ElementOrder = 2;",
                                 f"Mesh.MeshSizeMin = {size};", f"Mesh.MeshSizeMax = {size};", "Mesh.SaveGroupsOfNodes = 0;", ""]))
    run.program("gmsh", "-3", "-nt", "1", "-format", "inp", "-o", "mesh.inp", "mesh.geo", log="gmsh")
    nodes, words, target = {}, [], None
    for line in (run.folder / "mesh.inp").read_text().splitlines():
        if line.startswith("*"):
            key = line.upper()
            target = nodes if key.startswith("*NODE") else words if "C3D10" in key else None
        elif target is nodes:
            number, *x = line.split(",")
            nodes[int(number)] = [float(value) for value in x]
        elif target is words:
            words += [int(word) for word in line.split(",") if word.strip()]
    if not words:
        raise RunError(f"Gmsh made no tetrahedra; see {run.folder / 'gmsh.log'}")
    used, elements = np.unique(np.array(words).reshape(-1, 11)[:, 1:], return_inverse=True)
    return Mesh([nodes[number] for number in used], elements.reshape(-1, 10), "C3D10")


def held_lines(held):
    """*BOUNDARY and *EQUATION of pairs (numbers of nodes, direction): a direction is "xyz" and the like, or a vector."""
    lines = []
    for numbers, direction in held:
        if isinstance(direction, str):
            lines.append("*BOUNDARY")
            lines += [f"{n + 1}, {'xyz'.index(axis) + 1}, {'xyz'.index(axis) + 1}" for n in numbers for axis in direction]
        else:
            order = np.argsort(-np.abs(direction))
            terms = [(d, direction[d]) for d in order if abs(direction[d]) > 1e-12]
            for n in numbers:
                lines += ["*EQUATION", str(len(terms)), ", ".join(f"{n + 1}, {d + 1}, {c:.12g}" for d, c in terms)]
    return lines


def deck(mesh, material, held):
    """material: {"E", "nu"} and, for frequencies, "rho"."""
    lines = ["*NODE, NSET=ALL", *(f"{k + 1}, " + ", ".join(f"{c:.12g}" for c in x) for k, x in enumerate(mesh.nodes)),
             f"*ELEMENT, TYPE={mesh.kind}, ELSET=SOLID"]
    for k, row in enumerate(mesh.elements):
        words = [str(n + 1) for n in row]
        lines += [", ".join([str(k + 1), *words[:10]]) + ("," if len(words) > 10 else ""), *([", ".join(words[10:])] if words[10:] else [])]
    lines += ["*MATERIAL, NAME=M", "*ELASTIC", f"{material['E']:.12g}, {material['nu']:.12g}"]
    if "rho" in material:
        lines += ["*DENSITY", f"{material['rho']:.12g}"]
    return [*lines, "*SOLID SECTION, ELSET=SOLID, MATERIAL=M", *held_lines(held)]


def solve(run, mesh, lines):
    (run.folder / "fem.inp").write_text("\n".join([*lines, ""]))
    run.program("ccx", "fem", log="ccx")
    run.unknowns = mesh.nodes.size


def frequencies(run, mesh, material, held, modes, shapes=False):
    """The lowest `modes` frequencies, rigid ones included; with `shapes` also the displacements (modes, n, 3)."""
    solve(run, mesh, [*deck(mesh, material, held), "*STEP", "*FREQUENCY, SOLVER=SPOOLES", str(modes),
                      *(["*NODE FILE", "U"] if shapes else []), "*END STEP"])
    found = calculix.read_frequencies(run.folder / "fem.dat")
    if len(found) < modes:
        raise RunError(f"CalculiX gave {len(found)} of {modes} frequencies; see {run.folder / 'ccx.log'}")
    return (found, np.array(read_fields(run.folder / "fem.frd", "DISP", len(mesh.nodes)))) if shapes else found


def static(run, mesh, material, held, forces, extra=()):
    """Displacements (n, 3) and stresses (n, 6: xx yy zz xy yz zx) at the nodes, averaged over elements. extra: more lines of the step."""
    loaded = np.argwhere(np.abs(forces) > 1e-12 * np.abs(forces).max(initial=0))
    solve(run, mesh, [*deck(mesh, material, held), "*STEP", "*STATIC, SOLVER=SPOOLES", *(["*CLOAD"] if len(loaded) else []),
                      *(f"{n + 1}, {d + 1}, {forces[n, d]:.12g}" for n, d in loaded), *extra, "*NODE FILE", "U", "*EL FILE", "S",
                      "*END STEP"])
    file = run.folder / "fem.frd"
    displacement, stress = (read_fields(file, name, len(mesh.nodes)) for name in ("DISP", "STRESS"))
    if not displacement or not stress:
        raise RunError(f"CalculiX gave no displacements; see {run.folder / 'ccx.log'}")
    return displacement[-1], stress[-1]


def read_fields(path, name, count):
    """All fields of a name in a .frd file: a list of (count, components)."""
    found, rows, reading = [], None, False
    for line in path.read_text().splitlines():
        if line.startswith(" -4"):
            reading = line.split()[1] == name
            if reading:
                rows = {}
        elif reading and line.startswith(" -1"):
            values = line[13:]
            rows[int(line[3:13])] = [float(values[k:k + 12]) for k in range(0, len(values.rstrip()), 12)]
        elif reading and line.startswith(" -3"):
            found.append(np.array([rows[n + 1] for n in range(count)]))
            reading = False
    return found
