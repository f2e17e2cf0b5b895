"""Prisms over an outline with holes: the triangles of their surface, and tetrahedra of Gmsh that are fine where asked."""
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay

from igatools import tet_mesh

GEOMETRY = """{entities}
Field[1] = Distance;
Field[1].PointsList = {{{fine}}};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = {least};
Field[2].SizeMax = {size};
Field[2].DistMin = {near};
Field[2].DistMax = {far};
Background Field = 2;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
solid[] = Extrude {{0, 0, {height}}} {{ Surface{{1}}; Layers{{{layers}}}; }};
Physical Volume("solid") = {{solid[1]}};
"""


def inside(loops, points):
    """Whether points (n, 2) lie within loops of points (k, 2), by the number of edges to the right of them: odd is within."""
    crossings = np.zeros(len(points), int)
    x, y = points.T
    for loop in loops:
        for a, b in zip(loop, np.roll(loop, -1, axis=0)):
            between = (a[1] > y) != (b[1] > y)
            with np.errstate(divide="ignore", invalid="ignore"):
                crossings += between & (x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
    return crossings % 2 == 1


def area(loop):
    """Signed: positive where the loop (k, 2) runs anticlockwise."""
    x, y = np.asarray(loop, float).T
    return (x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


class Prism:
    """Outline (k, 2) anticlockwise, holes (k, 2) clockwise, from z = 0 to the height. `fine`: corners (number of the loop,
    of the point) around which tetrahedra are smaller. Raises ValueError where a loop runs the wrong way round."""

    def __init__(self, outline, height, holes=(), fine=()):
        self.loops = [np.asarray(loop, float) for loop in (outline, *holes)]
        self.height, self.fine = float(height), list(fine)
        if any((area(loop) > 0) != (k == 0) for k, loop in enumerate(self.loops)):
            raise ValueError("the outline must run anticlockwise, holes clockwise")

    def volume(self):
        return self.height * sum(area(loop) for loop in self.loops)

    def contains(self, points):
        """Whether points (n, 3) lie inside."""
        return (points[:, 2] > 0) & (points[:, 2] < self.height) & inside(self.loops, points[:, :2])

    def triangles(self):
        """Closed surface (n, 3, 3), outwards. Edges of loops are halved until Delaunay's triangulation holds them all."""
        loops = [loop.tolist() for loop in self.loops]
        while True:
            points = np.array([point for loop in loops for point in loop])
            first = np.cumsum([0] + [len(loop) for loop in loops])
            edges = [(a, a + 1 if a + 1 < end else start)
                     for start, end in zip(first, first[1:]) for a in range(start, end)]
            faces = Delaunay(points).simplices
            held = {frozenset(pair) for face in faces.tolist() for pair in zip(face, face[1:] + face[:1])}
            missing = [k for k, edge in enumerate(edges) if frozenset(edge) not in held]
            if not missing:
                break
            for k in reversed(missing):
                loop = np.searchsorted(first, k, side="right") - 1
                a, b = edges[k]
                loops[loop].insert(k - first[loop] + 1, ((points[a] + points[b]) / 2).tolist())
        faces = faces[inside(self.loops, points[faces].mean(1))]
        a, b, c = np.moveaxis(points[faces], 1, 0)
        turned = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) < (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
        faces[turned] = faces[turned][:, ::-1]
        at = lambda index, z: np.concatenate([points[index], np.full((*np.shape(index), 1), z)], -1)  # noqa: E731
        low, high = (at(np.array(edges), z) for z in (0.0, self.height))
        walls = [np.stack([low[:, 0], low[:, 1], high[:, 1]], 1), np.stack([low[:, 0], high[:, 1], high[:, 0]], 1)]
        return np.concatenate([at(faces[:, ::-1], 0.0), at(faces, self.height), *walls])

    def tetrahedra(self, gmsh, size, layers, folder, name, run, least=None):
        """Nodes (n, 3), 10-node tetrahedra (m, 10) and the measured run of Gmsh: `layers` of them over the height, of a size
        in the plane that falls to `least` around the fine corners; `run(command, log)` starts a program and measures it.
        Raises MeshError where Gmsh makes no mesh of the prism."""
        entities, number, curves = [], 0, []
        for loop in self.loops:
            n = len(loop)
            entities += [f"Point({number + k + 1}) = {{{x:.17g}, {y:.17g}, 0}};" for k, (x, y) in enumerate(loop)]
            entities += [f"Line({number + k + 1}) = {{{number + k + 1}, {number + (k + 1) % n + 1}}};" for k in range(n)]
            curves.append(f"Curve Loop({len(curves) + 1}) = {{{number + 1}:{number + n}}};")
            number += n
        boundary = ", ".join(str(k + 1) for k in range(len(curves)))
        entities += [*curves, f"Plane Surface(1) = {{{boundary}}};"]
        first = np.cumsum([0] + [len(loop) for loop in self.loops])
        fine = ", ".join(str(first[loop] + point + 1) for loop, point in self.fine) or "1"
        least = least if self.fine and least else size
        script, mesh, log = (Path(folder) / f"{name}.{end}" for end in ("geo", "inp", "gmsh.log"))
        script.write_text(GEOMETRY.format(entities="\n".join(entities), fine=fine, least=least, size=size, near=2 * least,
                                          far=2 * least + 5 * size, height=self.height, layers=layers))
        measured = run([gmsh, "-3", "-nt", "1", "-format", "inp", "-o", mesh, script], log)
        if measured["exit_code"] != 0 or not mesh.exists():
            raise tet_mesh.MeshError(f"{gmsh} ended with exit code {measured['exit_code']} and no mesh; see {log}")
        nodes, tets = tet_mesh.read_linear_tets(mesh)
        volumes = tet_mesh.volumes(nodes, tets)
        if volumes.min() <= 0 or abs(volumes.sum() - self.volume()) > 1e-9 * self.volume():
            raise tet_mesh.MeshError(f"{mesh}: has inverted tetrahedra or another volume than the prism")
        return *tet_mesh.quadratic_tets(nodes, tets), measured


def circle(centre, radius, corners):
    """A hole: regular polygon (corners, 2), clockwise."""
    angle = -2 * np.pi * np.arange(corners) / corners
    return np.asarray(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], 1)


def rotation(about_z, about_y):
    """Matrix (3, 3) of a turn about z, then y, in degrees."""
    a, b = np.radians([about_z, about_y])
    z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    return y @ z
