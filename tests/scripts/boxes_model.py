"""Model files of boxes, made without the programs: cells, links, copies and points from closed forms, for tests of the
readers, and an independent answer to what igaprep finds."""
import itertools
from types import SimpleNamespace

import h5py
import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from parts import box_facets

STATES = {"EXTERIOR": 0, "INTERIOR": 1, "TRIMMED": 2}


def components(count, pairs):
    """Number of the connected component of each of `count` nodes, in the order of their first nodes."""
    pairs = np.asarray(pairs, int).reshape(-1, 2)
    label = csgraph.connected_components(sparse.coo_matrix((np.ones(len(pairs)), pairs.T), (count, count)), directed=False)[1]
    first = np.unique(label, return_index=True)[1]
    return np.argsort(np.argsort(first))[label]


def cells_of(boxes, low, high, spans, degree):
    """Cells, links and copies of the union of boxes (lower, upper) without common volume, in `spans` spans from low to high;
    boxes that share a part of a face are one body. Function copies are numbered as in the file."""
    low, spans = np.asarray(low, float), np.asarray(spans)
    h = (np.asarray(high, float) - low) / spans
    parts = []  # (span, box, lower, upper) of every box in every span, ascending in the span
    for number in range(spans.prod()):
        ijk = np.array([number % spans[0], number // spans[0] % spans[1], number // (spans[0] * spans[1])])
        for box, (lower, upper) in enumerate(boxes):
            a, b = np.maximum(lower, low + ijk * h), np.minimum(upper, low + (ijk + 1) * h)
            if (b > a).all():
                parts.append(SimpleNamespace(span=number, ijk=ijk, box=box, lower=a, upper=b, volume=(b - a).prod()))

    def area(a, b):  # of the common face of two parts
        overlap = np.minimum(a.upper, b.upper) - np.maximum(a.lower, b.lower)
        flat = np.abs(overlap) < 1e-12
        return overlap[~flat].prod() if flat.sum() == 1 and (overlap[~flat] > 0).all() else 0.0

    touching = [(i, j) for i, j in itertools.combinations(range(len(parts)), 2) if area(parts[i], parts[j]) > 0]
    cell = components(len(parts), [(i, j) for i, j in touching if parts[i].span == parts[j].span])
    count = cell.max() + 1
    span = np.array([parts[np.argmax(cell == c)].span for c in range(count)])
    links = {}
    for i, j in touching:
        pair = tuple(sorted((cell[i], cell[j])))
        if pair[0] != pair[1]:
            links[pair] = links.get(pair, 0) + area(parts[i], parts[j])
    n = spans + np.asarray(degree)
    own = np.array([[a + ijk[0] + n[0] * (b + ijk[1] + n[1] * (c + ijk[2])) for c in range(degree[2] + 1)
                     for b in range(degree[1] + 1) for a in range(degree[0] + 1)]
                    for ijk in (parts[np.argmax(cell == c)].ijk for c in range(count))])
    functions, numbers = np.zeros_like(own), []
    for number in np.unique(own):
        cells = np.flatnonzero((own == number).any(1))
        inside = [(np.searchsorted(cells, a), np.searchsorted(cells, b)) for a, b in links if {a, b} <= set(cells)]
        copy = components(len(cells), inside)
        for c, k in zip(cells, copy):
            functions[c, own[c] == number] = len(numbers) + k
        numbers += [number] * (copy.max() + 1)
    pairs = sorted(links)
    return SimpleNamespace(parts=parts, cell=cell, span=span, functions=functions, number=np.array(numbers), links=pairs,
                           area=[links[pair] for pair in pairs], h=h, low=low, spans=spans, degree=list(degree),
                           volume=np.bincount(cell, [part.volume for part in parts]))


def rule(part, along):
    """Gauss points (n, 3) and weights (n) on a box; `along` points per direction."""
    x, w = zip(*(np.polynomial.legendre.leggauss(m) for m in along))
    size = part.upper - part.lower
    grid = np.stack(np.meshgrid(*x, indexing="ij"), -1).reshape(-1, 3)
    return part.lower + (grid + 1) / 2 * size, np.einsum("i,j,k->ijk", *w).ravel() * size.prod() / 8


def write(path, boxes, low, high, spans, degree=(2, 2, 2)):
    """The model file of boxes that do not touch; returns what cells_of() finds."""
    c = cells_of(boxes, low, high, spans, degree)
    count = len(c.span)
    owner = {(part.box, part.span): cell for part, cell in zip(c.parts, c.cell)}
    volume_points = [[] for _ in range(count)]
    for part, cell in zip(c.parts, c.cell):
        volume_points[cell].append(rule(part, [p + 1 for p in degree]))
    vertices, triangles, surface_points = [], [], [[] for _ in range(count)]
    vertex_cells = []
    for box, (lower, upper) in enumerate(boxes):
        of_box = [part for part in c.parts if part.box == box]
        corners = sorted({corner for facet in box_facets(lower, upper) for corner in facet})
        place = {corner: len(vertices) + k for k, corner in enumerate(corners)}
        vertices += corners
        for corner in corners:
            part = next(part for part in of_box if (part.lower <= corner).all() and (corner <= part.upper).all())
            vertex_cells.append(owner[box, part.span])
        for facet in box_facets(lower, upper):
            a, b, d = (np.array(corner, float) for corner in facet)
            normal = np.cross(b - a, d - a) / np.linalg.norm(np.cross(b - a, d - a))
            axis = np.argmax(np.abs(normal))
            for part in of_box:
                if part.upper[axis] < a[axis] or part.lower[axis] > a[axis]:
                    continue
                flat = SimpleNamespace(lower=part.lower.copy(), upper=part.upper.copy())
                flat.lower[axis], flat.upper[axis] = a[axis] - 0.5, a[axis] + 0.5
                x, w = rule(flat, [1 if d == axis else 2 for d in range(3)])
                shares = np.linalg.lstsq(np.stack([b - a, d - a], 1), (x - a).T, rcond=None)[0]
                on = (shares >= -1e-12).all(0) & (shares.sum(0) < 1 - 1e-12)
                surface_points[owner[box, part.span]].append((x[on], w[on], np.tile(normal, (on.sum(), 1)),
                                                              np.full(on.sum(), len(triangles))))
            triangles.append([place[corner] for corner in facet])
    knots = [np.concatenate([[low[d]] * p, low[d] + c.h[d] * np.arange(c.spans[d] + 1), [high[d]] * p])
             for d, p in enumerate(degree)]
    n = c.spans + np.asarray(degree)
    greville = [np.array([knots[d][i + 1:i + p + 1].mean() for i in range(n[d])]) for d, p in enumerate(degree)]
    whole = [np.array([(knots[d][i + p + 1] - knots[d][i]) / (p + 1) for i in range(n[d])]) for d, p in enumerate(degree)]
    state = np.zeros(c.spans.prod(), np.uint8)
    full = np.isclose(c.volume, c.h.prod(), rtol=1e-12)
    state[c.span] = np.where(full, 1, 2)
    enum = h5py.enum_dtype(STATES, "u1")

    def points(group, lists, names):
        file[f"{group}/offsets"] = np.concatenate([[0], np.cumsum([sum(len(w) for _, w, *_ in own) for own in lists])])
        for k, (name, dtype) in enumerate(names):
            file[f"{group}/{name}"] = np.concatenate([entry[k] for own in lists for entry in own]).astype(dtype)

    with h5py.File(path, "w", libver="latest") as file:
        file.attrs.update({"format": "iga-trimmed-solid", "format_version": "2.0", "length_unit": "mm", "title": "boxes"})
        patch = file.create_group("patch")
        patch.attrs.update({"degree": np.array(degree, "i4"), "spans": np.array(spans, "i8"), "A": np.array(low, float),
                            "B": np.array(high, float), "rotation": np.eye(3)})
        for d in range(3):
            patch["knots_" + "uvw"[d]] = knots[d]
        patch["control_points"] = np.stack([g.ravel() for g in np.meshgrid(*greville, indexing="ij")], 1).reshape(
            *n, 3).transpose(2, 1, 0, 3).reshape(-1, 3)
        file.create_dataset("spans/state", data=state.reshape(c.spans[::-1]), dtype=enum)
        file["cells/span"] = c.span
        file.create_dataset("cells/state", data=state[c.span], dtype=enum)
        file["cells/volume_fraction"] = np.minimum(c.volume / c.h.prod(), 1)
        file["cells/functions"] = c.functions.astype("i4")
        file["functions/number"] = c.number
        file["links/cells"] = np.array(c.links, "i4").reshape(-1, 2)
        file["links/area"] = np.array(c.area, float)
        points("quadrature", volume_points, (("parameters", "f8"), ("weights", "f8")))
        file["quadrature/residual"] = np.zeros(count)
        file["quadrature"].attrs.update({
            "interior_rule": "gauss", "trimmed_rule": "nnls", "moment_degree": np.array(degree, "i4"), "tolerance": 1e-12,
            "max_residual": 0.0, "sliver_tolerance": 1e-6, "min_fraction": 0.0, "part_volume": c.volume.sum(),
            "snapped_volume": 0.0, "dropped_volume": 0.0, "snapped_spans": np.int64(0), "dropped_spans": np.int64(0)})
        points("surface/quadrature", surface_points,
               (("parameters", "f8"), ("weights", "f8"), ("normals", "f8"), ("triangle", "i4")))
        surface = file["surface"]
        surface.attrs.update({"accepted_leak": 0.0, "bodies": np.int64(len(boxes))})
        surface["vertices"] = surface["vertex_parameters"] = np.array(vertices, float)
        surface["vertex_cell"] = np.array(vertex_cells, "i8")
        surface["triangles"] = np.array(triangles, "i4")
        surface["region"] = np.zeros(len(triangles), "i4")
        surface["regions"] = np.array([b"boxes"])
        file["functions/mass_fraction"] = _mass_fractions(file, knots, n, whole)
    return c


def _mass_fractions(file, knots, n, whole):
    """By de Boor's recursion of scipy, span by span: another code than the readers'."""
    from scipy.interpolate import BSpline

    number, functions = file["functions/number"][()], file["cells/functions"][()]
    u, w, offsets = (file["quadrature/" + name][()] for name in ("parameters", "weights", "offsets"))
    degree = file["patch"].attrs["degree"]
    dense = [BSpline.design_matrix(u[:, d], knots[d], degree[d]).toarray() for d in range(3)]
    total = np.zeros(len(number))
    for cell in range(len(functions)):
        own = slice(offsets[cell], offsets[cell + 1])
        for f in functions[cell]:
            i = number[f]
            ijk = i % n[0], i // n[0] % n[1], i // (n[0] * n[1])
            total[f] += (w[own] * np.prod([dense[d][own, ijk[d]] for d in range(3)], axis=0)).sum()
    return total / np.prod([whole[d][index] for d, index in
                            enumerate((number % n[0], number // n[0] % n[1], number // (n[0] * n[1])))], axis=0)
