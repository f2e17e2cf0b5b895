"""The surface of a model for contact: triangles whose edges are not longer than asked for, and the cell of every
vertex."""

import numpy as np

NEAR = 1e-7  # spans: a vertex so near to a span's face may belong to either side


def split_long_edges(x, triangles, region, length):
    """Vertices, triangles, their regions and the triangle each descends from; edges are halved until none is longer
    than `length`. Neighbours share the new vertices, so a closed surface stays closed."""
    origin = np.arange(len(triangles))
    while True:
        edges = np.sort(np.stack([triangles, np.roll(triangles, -1, 1)], 2), 2)  # (n, 3, 2): corner k to corner k + 1
        pairs, which = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
        which = which.reshape(-1, 3)
        long = np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1) > length * (1 + 1e-12)
        if not long.any():
            return x, triangles, region, origin
        middle = np.full(len(pairs), -1)
        middle[long] = len(x) + np.arange(long.sum())
        x = np.concatenate([x, x[pairs[long]].mean(1)])
        halves = middle[which]
        made, parents = [], []
        for triangle, half, parent in zip(triangles.tolist(), halves.tolist(), range(len(triangles))):
            new = _pieces(triangle, half, x)
            made += new
            parents += [parent] * len(new)
        triangles, parents = np.array(made), np.array(parents)
        region, origin = region[parents], origin[parents]


def _pieces(t, half, x):
    """A triangle cut at the middles of its long edges (-1: not cut)."""
    cut = [k for k in range(3) if half[k] >= 0]
    if not cut:
        return [t]
    if len(cut) == 3:
        return [[t[0], half[0], half[2]], [half[0], t[1], half[1]], [half[2], half[1], t[2]], half]
    if len(cut) == 1:
        k = cut[0]
        return [[t[k], half[k], t[k - 1]], [half[k], t[(k + 1) % 3], t[k - 1]]]
    # edge k to k + 1 stays whole; the corner opposite lies between the cut ones
    k = next(k for k in range(3) if half[k] < 0)
    a, b, c, bc, ca = t[k], t[(k + 1) % 3], t[(k + 2) % 3], half[(k + 1) % 3], half[(k + 2) % 3]
    short_a = np.sum((x[a] - x[bc]) ** 2) <= np.sum((x[b] - x[ca]) ** 2)
    across = [[a, b, bc], [a, bc, ca]] if short_a else [[a, b, ca], [b, bc, ca]]
    return [[ca, bc, c], *across]


class Skin:
    """vertices (n, 3), triangles (m, 3), region (m), cells (n) and parameters (n, 3) of the vertices."""

    def __init__(self, model, length):
        self.model = model
        x, triangles, region = (
            model["/surface/vertices"],
            model["/surface/triangles"].astype(np.int64),
            model["/surface/region"],
        )
        self.vertices, self.triangles, self.region, origin = split_long_edges(x, triangles, region, length)
        count = len(x)
        self.cells = np.concatenate([model["/surface/vertex_cell"], np.full(len(self.vertices) - count, -1)])
        self.parameters = model.parameters_of(self.vertices)
        self.parameters[:count] = model["/surface/vertex_parameters"]
        source = np.full(len(self.vertices), -1)  # a triangle that each vertex lies on
        source[self.triangles] = origin[:, None]
        self._find_cells(count, source)

    def _find_cells(self, first, source):
        """Cells of new vertices: one that owns a part of the vertex's triangle and whose closed span holds it, the
        nearest where a sliver has none. Of a triangle every span holds one convex piece, which belongs to one cell."""
        model, group = self.model, "/surface/quadrature"
        pairs = np.unique(np.stack([model[group + "/triangle"].astype(np.int64), model.point_cells(group)], 1), axis=0)
        starts = np.searchsorted(pairs[:, 0], np.arange(len(model["/surface/triangles"]) + 1))
        A, h = np.asarray(model.attribute("/patch", "A")), model.span_size()
        spans = model.cell_spans()
        xi = (self.parameters - A) / h
        order = first + np.argsort(source[first:], kind="stable")
        for new in np.split(order, np.flatnonzero(np.diff(source[order])) + 1):
            if not len(new):
                continue
            candidates = pairs[starts[source[new[0]]] : starts[source[new[0]] + 1], 1]
            if not len(candidates):
                candidates = np.unique(self.cells[model["/surface/triangles"][source[new[0]]]])
            low = spans[candidates]
            for part in np.array_split(new, 1 + len(new) * len(candidates) // 1_000_000):
                outside = np.maximum(np.maximum(low[None] - xi[part, None], xi[part, None] - low[None] - 1), 0).max(2)
                self.cells[part] = candidates[np.where(outside < NEAR, 0, outside).argmin(1)]
        low = spans[self.cells]
        self.parameters = A + np.clip(xi, low, low + 1) * h

    def shape_functions(self):
        """Functions (n, m) that each vertex sees, as entries of /functions, and their values (n, m)."""
        values = self.model.functions_at(self.model.cell_spans(self.cells), self.parameters)[1]
        return self.model["/cells/functions"][self.cells], values
