"""Light functions follow others by linear extrapolation: what solver/space/light_functions.cpp does, in numpy and
scipy.

For models whose functions are the unknowns (without /unknowns).
"""

import numpy as np
from scipy import sparse

LOWEST_THRESHOLD = 1e-9  # a part without a good cell above it would need fictitious material
RINGS = 2  # of cells that are looked at beyond the first good one


class ThinPart(Exception):
    """A part that is too thin for its grid: no function of it has enough material."""


def linear_weights(knots, degree, span, greville):
    """Weights (degree + 1) of a span's coefficients at a Greville abscissa, by the line through the two next to it."""
    points = np.array([knots[span + a + 1 : span + a + degree + 1].mean() for a in range(degree + 1)])
    a = 0
    while a < degree - 1 and points[a + 1] <= greville:
        a += 1
    weights = np.zeros(degree + 1)
    weights[a + 1] = (greville - points[a]) / (points[a + 1] - points[a])
    weights[a] = 1 - weights[a + 1]
    return weights


class _Planner:
    def __init__(self, model, threshold):
        self.model, self.threshold = model, threshold
        self.functions, self.fraction = model["/cells/functions"], model["/functions/mass_fraction"]
        self.light = self.fraction < threshold
        self.spans = model.cell_spans()
        n = len(self.functions)
        links = model["/links/cells"].reshape(-1, 2)
        self.links = sparse.csr_matrix(
            (np.ones(2 * len(links)), (np.r_[links[:, 0], links[:, 1]], np.r_[links[:, 1], links[:, 0]])), (n, n)
        )
        cells = np.repeat(np.arange(n), self.functions.shape[1])
        self.owners = sparse.csr_matrix(
            (np.ones(self.functions.size), (self.functions.ravel(), cells)), (len(self.fraction), n)
        )
        self.good = ~self.light[self.functions].any(1)
        self.thresholds = []  # (number of cells, threshold) of parts where it had to fall
        self._lower_thresholds()

    def _lower_thresholds(self):
        """By factors of ten in each connected part without a good cell."""
        count, part = sparse.csgraph.connected_components(self.links, directed=False)
        for lacking in np.setdiff1d(np.arange(count), part[self.good]):
            cells = np.flatnonzero(part == lacking)
            seen, threshold = np.unique(self.functions[cells]), self.threshold
            while threshold > LOWEST_THRESHOLD and not self.good[cells].any():
                threshold /= 10
                self.light[seen] = self.fraction[seen] < threshold
                self.good[cells] = ~self.light[self.functions[cells]].any(1)
            self.thresholds.append((len(cells), threshold))
            if not self.good[cells].any():
                raise ThinPart(
                    f"a part of {len(cells)} cells is too thin for its grid: no cell has all its functions above a "
                    f"mass fraction of {LOWEST_THRESHOLD:g}; expected smaller spans (igaprep --span-size)"
                )

    def _neighbours(self, cell):
        return self.links.indices[self.links.indptr[cell] : self.links.indptr[cell + 1]]

    def nearest_good_cell(self, function):
        """That whose span is nearest to the function's centre, the lowest one of several; -1 where none is
        connected."""
        model = self.model
        ijk = model.split_numbers(model["/functions/number"][function : function + 1], model.functions)[0]
        centre = ijk - 0.5 * np.array(model.degree)
        ring = sorted(self.owners.indices[self.owners.indptr[function] : self.owners.indptr[function + 1]])
        seen, best, left = set(ring), None, -1
        while ring and left != 0:
            for cell in ring:
                if self.good[cell]:
                    found = (((centre - self.spans[cell]) ** 2).sum(), cell)
                    best = found if best is None else min(best, found)
            if best is not None:
                left = RINGS if left < 0 else left - 1
            after = []
            for cell in ring:
                for other in self._neighbours(cell):
                    if other not in seen:
                        seen.add(other)
                        after.append(other)
            ring = after
        return -1 if best is None else best[1]


def linear_extension(model, threshold):
    """Sparse E (n_f, n_f): coefficients of functions = E @ those of functions that are not light, whose rows are the
    identity; and (number of cells, threshold) of the parts without a good cell, where the threshold fell.

    A function is light where its mass fraction is below the threshold; it takes the values of the nearest cell without
    light functions that links connect with its own cells. Rows keep constant and linear fields. Raises ThinPart.
    """
    plan = _Planner(model, threshold)
    light = np.flatnonzero(plan.light)
    rows, columns = [np.flatnonzero(~plan.light)], [np.flatnonzero(~plan.light)]
    values = [np.ones(len(rows[0]))]
    ijk = model.split_numbers(model["/functions/number"], model.functions)
    greville = model.greville_points(ijk)
    for function in light:
        cell = plan.nearest_good_cell(function)
        if cell < 0:
            raise ThinPart(f"light function {function}: no good cell is connected with its support")
        w = [
            linear_weights(model.knots[d], model.degree[d], plan.spans[cell, d], greville[function, d])
            for d in range(3)
        ]
        weights = np.einsum("c,b,a->cba", w[2], w[1], w[0]).ravel()
        chosen = np.flatnonzero(weights)
        rows.append(np.full(len(chosen), function))
        columns.append(plan.functions[cell][chosen])
        values.append(weights[chosen])
    n = len(plan.light)
    E = sparse.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), (n, n))
    return E, plan.thresholds


def spared_functions(extension, own, kept=0.2):
    """How many light functions `igasolve` would let bring their lumped mass to their nearest master alone, since one of
    their masters would keep no more than `kept` of its own: as spare_masses() of solver/mechanics/mass_operator.cpp.
    `own` (n_f) are the functions' own masses."""
    masses, moved, nodes = extension.T @ own, np.zeros(len(own), bool), extension.diagonal() == 1
    again = True
    while again:
        again = False
        poor = nodes & (masses <= kept * own)
        for f in np.flatnonzero(~nodes & ~moved):
            row = slice(extension.indptr[f], extension.indptr[f + 1])
            columns, values = extension.indices[row], extension.data[row]
            if not (poor[columns] & (values < 0)).any():
                continue
            masses[columns] -= values * own[f]
            masses[columns[values.argmax()]] += own[f]
            moved[f] = again = True
    return int(moved.sum())
