#!/usr/bin/python3
"""Independent reader of the interchange file: h5py, numpy and scipy alone, held against schema/model.toml.

As a command:  scripts/igatools/iga_model.py part.h5 [--json]     validates the file and prints what its points say
As a module:   model = iga_model.read("part.h5");  model.positions(), model.volume_integrals(), model.mass_fractions()

A cell is one connected piece of one span; model["/cells/functions"] tells which functions it sees, one copy of each B-spline
that reaches its span.
"""
import sys
from pathlib import Path

import h5py
import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

if not __package__:  # run by its path
    sys.path[0] = str(Path(__file__).resolve().parents[1])
from igatools import iga_schema  # noqa: E402
from igatools.iga_schema import FormatError, text_of as _text  # noqa: E402

SCHEMA = iga_schema.load("model")
INTERIOR, TRIMMED = (SCHEMA["enum"]["state"][name] for name in ("INTERIOR", "TRIMMED"))  # in /spans/state
BLOCK = 100_000  # points whose basis values are held at a time


# ------------------------------------------------------------------------------------------------------------- the basis

def basis(knots, degree, span, u):
    """Values of the degree + 1 functions that live on `span` (array) at `u` (array): (n, degree + 1).

    Cox-de Boor recursion written from its definition, N_{i,0} = 1 on its knot interval; function span + a in column a.
    """
    span, u = np.asarray(span), np.asarray(u, float)
    k = span + degree  # knots[k] <= u <= knots[k + 1]
    values = np.zeros((len(u), degree + 1))
    values[:, degree] = 1.0  # N_{k,0}; column degree + i - k holds N_i
    for q in range(1, degree + 1):
        raised = np.zeros_like(values)
        for column in range(degree - q, degree + 1):
            i = k - degree + column
            left = knots[i + q] - knots[i]
            raised[:, column] += np.where(left > 0, (u - knots[i]) / np.where(left > 0, left, 1), 0) * values[:, column]
            if column < degree:
                right = knots[i + q + 1] - knots[i + 1]
                raised[:, column] += (np.where(right > 0, (knots[i + q + 1] - u) / np.where(right > 0, right, 1), 0)
                                      * values[:, column + 1])
        values = raised
    return values


def basis_derivatives(knots, degree, span, u):
    """First derivatives of the functions of basis(): (n, degree + 1), per length of the parameter.

    N'_{i,p} = p N_{i,p-1} / (knots[i+p] - knots[i]) - p N_{i+1,p-1} / (knots[i+p+1] - knots[i+1]), terms without length 0.
    """
    span = np.asarray(span)
    k = span + degree
    lower = np.zeros((len(span), degree + 2))  # column 1 + j holds N_{span+1+j, degree-1}; both ends are zero
    lower[:, 1:-1] = basis(knots[1:-1], degree - 1, span, u)
    derivatives = np.empty((len(span), degree + 1))
    for column in range(degree + 1):
        i = k - degree + column
        left, right = knots[i + degree] - knots[i], knots[i + degree + 1] - knots[i + 1]
        derivatives[:, column] = degree * (np.where(left > 0, lower[:, column] / np.where(left > 0, left, 1), 0)
                                           - np.where(right > 0, lower[:, column + 1] / np.where(right > 0, right, 1), 0))
    return derivatives


class Model:
    """A file's arrays under the names of their datasets: model["/quadrature/weights"]; attributes by model.attribute()."""

    def __init__(self, path):
        with h5py.File(path, "r") as file:
            self.symbols = iga_schema.validate(file, SCHEMA, made_by="igaprep")
            self.attributes = {("/" + name): dict(file[name].attrs) for name in ("patch", "quadrature", "surface")}
            self.attributes["/"] = dict(file.attrs)
            self.data = {}
            file.visititems(lambda name, item: self.data.update({"/" + name: item[()]})
                            if isinstance(item, h5py.Dataset) else None)
        patch = self.attributes["/patch"]
        self.degree = [int(p) for p in patch["degree"]]
        self.spans = [int(n) for n in patch["spans"]]
        self.functions = [n + p for n, p in zip(self.spans, self.degree)]
        self.knots = [self["/patch/knots_" + d] for d in "uvw"]
        self._check_cells()
        self._check_places()

    def _check_cells(self):
        """What the cells' tables promise, as far as all else here stands on it."""
        span, functions, number = self["/cells/span"], self["/cells/functions"], self["/functions/number"]
        state = np.asarray(self["/spans/state"]).ravel()
        if not np.array_equal(np.unique(span), np.flatnonzero(state)) or (np.diff(span) < 0).any():
            raise FormatError("/cells/span: names other spans than those that are not EXTERIOR, or is not ascending")
        wrong = self["/cells/state"] != state[span]
        if wrong.any():
            raise FormatError(f"/cells/state: that of cell {np.argmax(wrong)} is not its span's in /spans/state")
        if len(functions) and not 0 <= functions.min() <= functions.max() < len(number):
            raise FormatError(f"/cells/functions: names functions {functions.min()} ... {functions.max()} of {len(number)}")
        wrong = (number[functions] != self.numbers_at(self.split_numbers(span, self.spans))).any(1)
        if wrong.any():
            raise FormatError(f"/cells/functions: cell {np.argmax(wrong)} sees other functions than copies of the B-splines "
                              "of its span")
        if (np.diff(number) < 0).any() or len(np.unique(functions)) < len(number):
            raise FormatError("/functions/number: falls, or holds functions that no cell sees")
        self._check_unknowns()
        links = self["/links/cells"]
        if links.size and not (0 <= links.min() and links.max() < len(span) and (links[:, 0] < links[:, 1]).all()):
            raise FormatError(f"/links/cells: expected pairs of a lower and a higher one of {len(span)} cells")

    def _check_unknowns(self):
        """The coefficients from unknowns keep constant and linear fields."""
        if "/unknowns/offsets" not in self.data:
            return
        offsets, terms = self["/unknowns/offsets"], self["/unknowns/terms"]
        if offsets[0] != 0 or offsets[-1] != len(terms) or (np.diff(offsets) < 0).any():
            raise FormatError("/unknowns/offsets: do not start at 0, fall, or do not end at the number of terms")
        n = len(self["/unknowns/function"])
        if len(terms) and not 0 <= terms.min() <= terms.max() < n:
            raise FormatError(f"/unknowns/terms: names unknowns {terms.min()} ... {terms.max()} of {n}")
        rows = self.coefficients_from_unknowns()
        size = abs(rows) @ np.ones(n)
        greville = self.greville_points(self.split_numbers(self["/functions/number"], self.functions))
        for d in range(3):
            scale = size * max(abs(self.knots[d][0]), abs(self.knots[d][-1]), self.knots[d][-1] - self.knots[d][0])
            wrong = abs(rows @ self["/unknowns/parameters"][:, d] - greville[:, d]) > 1e-12 * scale
            wrong |= abs(rows @ np.ones(n) - 1) > 1e-12 * size
            if wrong.any():
                raise FormatError(f"/unknowns: the factors of function {np.argmax(wrong)} do not keep linear fields")

    def _check_places(self):
        """Names and numbers of curves and markers."""
        for group, points in (("/curves", "/points"), ("/markers", "/positions")):
            names = [_text(name) for name in self.data.get(group + "/names", ())]
            if "" in names or len(set(names)) < len(names):
                raise FormatError(f"{group}/names: holds an empty name, or one twice")
            if not np.isfinite(self.data.get(group + points, 0.0)).all():
                raise FormatError(f"{group}{points}: holds other than finite numbers")
        offsets = self.data.get("/curves/offsets", np.zeros(1, int))
        if offsets[0] != 0 or offsets[-1] != len(self.data.get("/curves/points", ())) or (np.diff(offsets) < 2).any():
            raise FormatError("/curves/offsets: do not start at 0, do not end at the number of points, or leave a curve fewer "
                              "than two points")
        for name, points in self.curves().items():
            if not self.length_of(points) > 0:
                raise FormatError(f"/curves: '{name}' has no length")

    def curves(self):
        """Named curves: {name: points (n, 3) in order along it}."""
        if "/curves/names" not in self.data:
            return {}
        return {_text(name): self["/curves/points"][first:last] for name, first, last in
                zip(self["/curves/names"], self["/curves/offsets"], self["/curves/offsets"][1:])}

    @staticmethod
    def length_of(points):
        """Length of the straight pieces between the points (n, 3) of a curve."""
        return float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())

    def markers(self):
        """Named points: {name: position (3)}."""
        return {_text(name): x for name, x in zip(self.data.get("/markers/names", ()), self.data.get("/markers/positions", ()))}

    def coefficients_from_unknowns(self):
        """Sparse C (n_f, n_u): coefficients of functions = C @ unknowns; the identity where every function is an unknown.
        A matrix of the functions becomes C.T @ K @ C for the unknowns."""
        n = len(self["/functions/number"])
        if "/unknowns/offsets" not in self.data:
            return sparse.identity(n, format="csr")
        return sparse.csr_matrix((self["/unknowns/weights"], self["/unknowns/terms"], self["/unknowns/offsets"]),
                                 (n, len(self["/unknowns/function"])))

    def gap_end_cells(self):
        """Which cells have B-splines of their own, because a gap ends nearby: (n_cells), bool."""
        if "/unknowns/offsets" not in self.data:
            return np.zeros(len(self["/cells/span"]), bool)
        own = np.ones(len(self["/functions/number"]), bool)
        function = self["/unknowns/function"]
        own[function[function >= 0]] = False
        return own[self["/cells/functions"][:, 0]]

    def copied_functions(self):
        """Number of B-splines with several copies, those of cells at gap ends not counted."""
        shared = np.ones(len(self["/functions/number"]), bool)
        shared[self["/cells/functions"][self.gap_end_cells()]] = False
        return int((np.unique(self["/functions/number"][shared], return_counts=True)[1] > 1).sum())

    def __getitem__(self, path):
        return self.data[path]

    def attribute(self, owner, name):
        value = self.attributes[owner][name]
        return _text(value) if isinstance(value, (bytes, str)) else value

    def texts(self, path):
        return [_text(value) for value in self[path]]

    def cell_spans(self, cells=slice(None)):
        """Index triples (i, j, k) of the spans that cells are pieces of: (n, 3); all cells by default."""
        return self.split_numbers(self["/cells/span"][cells], self.spans)

    def point_cells(self, group="/quadrature"):
        """Cells that own the points of a group: (n)."""
        offsets = self[group + "/offsets"]
        return np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))

    def point_spans(self, group="/quadrature"):
        """Index triples (i, j, k) of the spans that own the points of a group: (n, 3)."""
        return self.cell_spans(self.point_cells(group))

    def components(self):
        """Number of the mechanically separate body that each cell belongs to, from 0, and how many there are.

        Cells hang together where they see an unknown in common, which is the same as by links: an unknown's cells are linked.
        """
        functions = self["/cells/functions"]
        cells = np.repeat(np.arange(len(functions)), functions.shape[1])
        seen = sparse.csr_matrix((np.ones(functions.size), (cells, functions.ravel())),
                                 (len(functions), len(self["/functions/number"]))) @ abs(self.coefficients_from_unknowns())
        count, component = csgraph.connected_components(sparse.bmat([[None, seen], [seen.T, None]]), directed=False)
        return component[:len(functions)], count

    def span_size(self):
        """Size of the spans in the three directions of the grid: (3), length."""
        patch = self.attributes["/patch"]
        return (patch["B"] - patch["A"]) / self.spans

    def parameters_of(self, x):
        """Parameters (n, 3) of positions (n, 3): the grid's frame, turned about its centre."""
        patch = self.attributes["/patch"]
        centre = (patch["A"] + patch["B"]) / 2
        return centre + (np.asarray(x, float) - centre) @ patch["rotation"]

    def positions_of(self, u):
        """Positions (n, 3) of parameters (n, 3): the inverse of parameters_of()."""
        patch = self.attributes["/patch"]
        centre = (patch["A"] + patch["B"]) / 2
        return centre + (u - centre) @ patch["rotation"].T

    @staticmethod
    def split_numbers(numbers, extents):
        """Index triples (n, 3) of linear numbers (n) in a grid of `extents`, u fastest."""
        return np.stack([numbers % extents[0], numbers // extents[0] % extents[1], numbers // (extents[0] * extents[1])], 1)

    def greville_points(self, ijk):
        """Greville parameters (n, 3) of B-splines (i, j, k) (n, 3)."""
        return np.stack([sum(self.knots[d][ijk[:, d] + a] for a in range(1, self.degree[d] + 1)) / self.degree[d]
                         for d in range(3)], 1)

    def control_points(self, numbers):
        """Control points of functions by number: numbers.shape + (3,). A very fine grid's file leaves the table out; its
        rows are the positions of the Greville parameters."""
        if "/patch/control_points" in self.data:
            return self["/patch/control_points"][numbers]
        ijk = self.split_numbers(numbers.ravel(), self.functions)
        return self.positions_of(self.greville_points(ijk)).reshape(*numbers.shape, 3)

    def shape_functions(self, group="/quadrature"):
        """Blocks (slice, functions (n, m), values (n, m)) of the m = product of (p + 1) functions that each of a group's
        points sees, as entries of /functions."""
        cells, spans, parameters = self.point_cells(group), self.point_spans(group), self[group + "/parameters"]
        for first in range(0, len(spans), BLOCK):
            block = slice(first, min(first + BLOCK, len(spans)))
            yield block, self["/cells/functions"][cells[block]], self.functions_at(spans[block], parameters[block])[1]

    def functions_at(self, spans, parameters):
        """Numbers (n, m) and values (n, m) of the B-splines of given spans (n, 3) at given parameters (n, 3)."""
        values = [basis(self.knots[d], self.degree[d], spans[:, d], parameters[:, d]) for d in range(3)]
        return self.numbers_at(spans), self._products(values)

    def numbers_at(self, spans):
        """Numbers (n, m) of the B-splines of spans (n, 3), in the order of functions_at() and of /cells/functions."""
        i, j, k = (spans[:, d, None] + np.arange(self.degree[d] + 1) for d in range(3))
        n_u, n_v, _ = self.functions
        return (i[:, None, None, :] + n_u * (j[:, None, :, None] + n_v * k[:, :, None, None])).reshape(
            len(spans), np.prod(np.add(self.degree, 1)))

    @staticmethod
    def _products(factors):
        """Tensor products (n, m) of univariate factors in u, v, w; u runs fastest."""
        return np.einsum("qc,qb,qa->qcba", factors[2], factors[1], factors[0]).reshape(
            len(factors[0]), np.prod([factor.shape[1] for factor in factors]))

    def gradients_at(self, spans, parameters):
        """Gradients (n, m, 3) in space of the functions of functions_at(): those in the grid's frame, rotated."""
        arguments = [(self.knots[d], self.degree[d], spans[:, d], parameters[:, d]) for d in range(3)]
        values, slopes = [basis(*a) for a in arguments], [basis_derivatives(*a) for a in arguments]
        in_grid = np.stack([self._products([slopes[d] if d == along else values[d] for d in range(3)])
                            for along in range(3)], 2)
        return in_grid @ self.attributes["/patch"]["rotation"].T

    def positions(self, group="/quadrature"):
        """Positions of a group's points from x(u) = sum N_i(u) P_i: (n, 3)."""
        x = np.empty_like(self[group + "/parameters"])
        for block, functions, N in self.shape_functions(group):
            x[block] = np.einsum("qi,qid->qd", N, self.control_points(self["/functions/number"][functions]))
        return x

    def vertex_positions(self):
        """Positions of the surface's vertices from their parameters: (n, 3)."""
        spans = self.cell_spans(self["/surface/vertex_cell"])
        numbers, N = self.functions_at(spans, self["/surface/vertex_parameters"])
        return np.einsum("qi,qid->qd", N, self.control_points(numbers))

    def volume_integrals(self):
        """Volume, centroid (3) and second moments about the centroid (3, 3), from the points alone."""
        x, w = self.positions(), self["/quadrature/weights"]
        volume = w.sum()
        origin = x[0]  # far from the coordinates' origin no digits are lost
        centroid = origin + (w[:, None] * (x - origin)).sum(0) / volume
        r = x - centroid
        return volume, centroid, np.einsum("q,qa,qb->ab", w, r, r)

    def surface_integrals(self):
        """Area per region, the vector integral of n, and the enclosed volume from the integral of x.n / 3."""
        group = "/surface/quadrature"
        w, n = self[group + "/weights"], self[group + "/normals"]
        x = self.positions(group)
        region = self["/surface/region"][self[group + "/triangle"]]
        area = np.bincount(region, w, len(self["/surface/regions"]))
        return area, (w[:, None] * n).sum(0), (w * ((x - x[0]) * n).sum(1)).sum() / 3

    def mass_fractions(self):
        """Integral of N over the cells that see it, divided by its integral over the grid, of all functions: (n_f)."""
        total = np.zeros(len(self["/functions/number"]))
        for block, functions, N in self.shape_functions():
            np.add.at(total, functions.ravel(), (N * self["/quadrature/weights"][block, None]).ravel())
        whole = np.ones(len(total))
        for d, index in enumerate(self.split_numbers(self["/functions/number"], self.functions).T):
            p = self.degree[d]
            whole *= (self.knots[d][index + p + 1] - self.knots[d][index]) / (p + 1)
        return total / whole


def read(path):
    """Model of a file that obeys schema/model.toml. Raises FormatError naming the path, what was found and expected."""
    return Model(path)


def summary(model):
    volume, centroid, second = model.volume_integrals()
    area, normal, enclosed = model.surface_integrals()
    state = model["/spans/state"]
    inertia = np.trace(second) * np.eye(3) - second
    return {
        "title": model.attribute("/", "title"),
        "length_unit": model.attribute("/", "length_unit"),
        "degree": model.degree,
        "spans": {"total": int(state.size), "interior": int((state == 1).sum()), "trimmed": int((state == 2).sum())},
        "cells": len(model["/cells/span"]),
        "split_spans": int((np.unique(model["/cells/span"], return_counts=True)[1] > 1).sum()),
        "functions": len(model["/functions/number"]),
        "copied_functions": model.copied_functions(),
        "gap_end_cells": int(model.gap_end_cells().sum()),
        "unknowns": model.coefficients_from_unknowns().shape[1],
        "components": model.components()[1],
        "points": len(model["/quadrature/weights"]),
        "volume": volume,
        "part_volume": float(model.attribute("/quadrature", "part_volume")),
        "centroid": centroid.tolist(),
        "inertia": inertia.tolist(),
        "mass_fraction_error": float(np.abs(model.mass_fractions() - model["/functions/mass_fraction"]).max()),
        "vertex_position_error": float(np.abs(model.vertex_positions() - model["/surface/vertices"]).max()),
        "regions": {_text(name): a for name, a in zip(model["/surface/regions"], area.tolist())},
        "curves": {name: model.length_of(points) for name, points in model.curves().items()},
        "markers": {name: x.tolist() for name, x in model.markers().items()},
        "surface_normal_integral": normal.tolist(),
        "enclosed_volume": enclosed,
    }


if __name__ == "__main__":
    sys.exit(iga_schema.report(__doc__, "model", "model file made by igaprep", lambda path: summary(read(path))))
