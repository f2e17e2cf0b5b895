"""How far a number is from its limit, told from a sequence of grids; and which mode of one grid is which of the next.

The limit is that of the discretised solid under refinement of the spans: what the surface (facets), the material and the
supports leave open is not in it.
"""
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

LEAST_ORDER, MOST_ORDER = 0.2, 10.0  # of what is observed
REENTRANT_ORDER = 1.09  # of energies where the solid has sharp re-entrant edges: 2 x 0.545 for a right angle (Williams 1952)
TWO_GRIDS_ORDER = 1.5   # at most, where only two grids are known
STRESS_ORDER = 1.0
SAFETY = 1.25           # on errors from three grids and more (Roache 1994)
SOLUTION_SAFETY = 1.5   # on errors that the solution itself tells, for what their correction leaves (scripts/studies/error_study.py)
ALONE = 2.0             # on these, where no other grid bears them out
SAME_MODE = 0.6         # least agreement of shapes of one and the same mode
WHOLE = 0.9             # agreement of the shapes of two modes that are one, whatever their neighbours
CLUSTER = 0.02          # modes so near in frequency may mix from one grid to the next


@dataclass
class Estimate:
    """Of one quantity on the finest grid."""
    error: float | None      # relative, without sign; None: not told (no partner on the grid before)
    order: float | None = None  # observed, from three grids; only shown


def relative_error(sizes, values, order):
    """Estimate of |values[-1] - limit| / |values[-1]| from values on grids of span sizes that fall.

    order: what may be relied on (`reliable_order`). The observed one is not used: between coarse grids it is often higher
    than what follows, where singularities take over (a bracket with sharp edges, p = 2: 2.1, 2.1, then 1.1), and since grids
    do not lie in each other single changes come out too small by chance; the change before bounds them.
    """
    sizes, values = np.asarray(sizes, float), np.asarray(values, float)
    if len(values) < 2:
        return Estimate(None)
    change = np.abs(np.diff(values)) / (abs(values[-1]) or 1.0)
    ratio = sizes[:-1] / sizes[1:]
    if len(values) == 2:
        return Estimate(float(change[-1] / (ratio[-1] ** min(order, TWO_GRIDS_ORDER) - 1)))
    last = max(change[-1], change[-2] / ratio[-1] ** (order + 1))
    return Estimate(float(SAFETY * last / (ratio[-1] ** order - 1)), observed_order(sizes[-3:], np.diff(values)[-2:]))


def reliable_order(degree, is_singular):
    """Order of eigenvalues and energies: p + 1 on smooth solids (2 p is seen later, if ever, on trimmed grids), that of the
    singularity where edges of the surface are sharp and re-entrant, or where supports end (singular.py finds both)."""
    return min(degree + 1, REENTRANT_ORDER) if is_singular else degree + 1


def displacement_order(degree, is_singular):
    """Of the displacement at a place. Its error is the product, in energy, of the solution's error and that of the field of a unit
    force there: p + 1 on smooth solids; singular edges spoil both, and with them the displacement everywhere, like an energy."""
    return reliable_order(degree, is_singular)


def largest_order(degree, is_singular):
    """Of the largest displacement of the surface: that of a displacement, but not above two, since the largest is taken among
    places of the surface that move with the grid, half a span apart."""
    return min(displacement_order(degree, is_singular), 2)


def stress_order(degree, is_singular):
    """Of a stress at a place away from singular edges. Strains are derivatives, of order p on average; but at single places of a surface
    that cuts through spans they fall hardly faster than the spans themselves, whatever the degree (at the rim of a hole, p = 2, spans of
    0.6 … 0.12 radii: 3.71, 3.54, 3.52, 3.40, 3.32, still falling). What singular edges spoil everywhere falls like an energy."""
    return min(STRESS_ORDER, reliable_order(degree, is_singular))


def error_of(sizes, values, order, from_solution=None):
    """The error of a quantity on the finest grid: what its values on all grids tell and, where there is one, the estimate from the
    finest solution itself (relative, from what it leaves of the equations), with its safety; the larger of the two counts. All
    commands form their errors here."""
    told = relative_error(sizes, values, order)
    if from_solution is not None:
        safe = SOLUTION_SAFETY * from_solution
        told.error = ALONE * safe if told.error is None else max(told.error, safe)
    return told


def observed_order(sizes, changes):
    """Order q with changes in the ratio (h1^q - h2^q) : (h2^q - h3^q); None where they grow or alternate."""
    first, last = changes
    if last == 0 or first * last < 0 or abs(first) <= abs(last):
        return None
    h1, h2, h3 = sizes / sizes[-1]
    quotient = lambda q: (h1**q - h2**q) / (h2**q - h3**q)  # noqa: E731
    low, high = LEAST_ORDER, MOST_ORDER
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if quotient(middle) < first / last else (low, middle)
    return 0.5 * (low + high)


def clusters(frequencies):
    """Number of the cluster of each mode: neighbours within CLUSTER of each other are one."""
    apart = np.diff(frequencies) > CLUSTER * np.asarray(frequencies)[1:]
    return np.concatenate([[0], np.cumsum(apart)])


def pair_modes(coarse_frequencies, coarse, fine_frequencies, fine, weights):
    """For each mode of the finer grid the coarse one that it comes from, -1 where none looks like it; and how well they agree.

    Modes of one cluster may turn into each other within it: what counts is how much of a shape lies in the other cluster's
    span. Within a cluster modes are paired in the order of their frequencies, which is that of their eigenvalues' limits.
    """
    coarse_cluster, fine_cluster = clusters(coarse_frequencies), clusters(fine_frequencies)
    shared = np.zeros((len(coarse), len(fine)))
    for k in range(coarse_cluster[-1] + 1):
        own = coarse_cluster == k
        shared[own] = span_share(coarse[own], fine, weights)
    for k in range(fine_cluster[-1] + 1):
        own = fine_cluster == k
        shared[:, own] = np.maximum(shared[:, own], span_share(fine[own], coarse, weights)[:, None])
    # Shape decides: first that of the cluster, then the mode's own where it is found again nearly whole, so that modes of one
    # cluster that change places are told apart; else the order of frequencies.
    n, m = shared.shape
    order = np.abs(np.arange(n)[:, None] - np.arange(m)[None, :])
    own = np.array([span_share(shape[None], fine, weights) for shape in coarse])
    rows, columns = linear_sum_assignment(1 - shared - 1e-2 * (own > WHOLE) + 1e-3 * order / max(n, m))
    partner, agreement = np.full(m, -1), np.zeros(m)
    for row, column in zip(rows, columns):
        agreement[column] = shared[row, column]
        if shared[row, column] >= SAME_MODE:
            partner[column] = row
    return partner, agreement


def follow_modes(grids):
    """For each mode of the finest grid its numbers on the last grids that know it, coarse to fine, and how well its shape agrees with
    that of the grid before, nan where there is one grid. Grids, coarse to fine: "frequencies", "shapes", "weights" as in pair_modes."""
    numbers = [[m] for m in range(len(grids[-1]["frequencies"]))]
    agreement = np.full(len(numbers), np.nan)
    for level in range(len(grids) - 1, 0, -1):
        fine, coarse = grids[level], grids[level - 1]
        partner, likeness = pair_modes(coarse["frequencies"], coarse["shapes"], fine["frequencies"], fine["shapes"], fine["weights"])
        if level == len(grids) - 1:
            agreement = likeness
        for own in numbers:
            if len(own) == len(grids) - level and partner[own[0]] >= 0:
                own.insert(0, partner[own[0]])
    return numbers, agreement


def span_share(basis, shapes, weights):
    """Share of each shape that lies in the span of `basis`."""
    root = np.sqrt(weights)[None, :, None]
    a = (basis * root).reshape(len(basis), -1)
    b = (shapes * root).reshape(len(shapes), -1)
    q = np.linalg.qr(a.T)[0]
    return ((b @ q) ** 2).sum(1) / (b**2).sum(1)
