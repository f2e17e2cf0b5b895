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
SAFETY = 1.25           # on errors from three grids and more (Roache 1994)
SAME_MODE = 0.6         # least agreement of shapes of one and the same mode
CLUSTER = 0.02          # modes so near in frequency may mix from one grid to the next
SHARP = np.deg2rad(25)  # angle between facets from which on their edge counts as one; facets of CAD faces turn by 20 at most


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
        return Estimate(change[-1] / (ratio[-1] ** min(order, TWO_GRIDS_ORDER) - 1))
    last = max(change[-1], change[-2] / ratio[-1] ** (order + 1))
    return Estimate(SAFETY * last / (ratio[-1] ** order - 1), observed_order(sizes[-3:], np.diff(values)[-2:]))


def reliable_order(degree, vertices, triangles, is_supported=False):
    """Order of eigenvalues and energies: p + 1 on smooth solids (2 p is seen later, if ever, on trimmed grids), that of the
    singularity where edges of the surface are sharp and re-entrant, or where supports end."""
    return min(degree + 1, REENTRANT_ORDER) if is_supported or has_reentrant_edges(vertices, triangles) else degree + 1


def has_reentrant_edges(vertices, triangles):
    """Has a closed, outward-oriented surface edges that are sharper than SHARP and where the solid takes more than half a turn?"""
    corners = vertices[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    normal = normal / np.where(size > 0, size, 1)[:, None]
    directed = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    facet = np.tile(np.arange(len(triangles)), 3)
    key = directed[:, 0].astype(np.int64) * len(vertices) + directed[:, 1]
    order = np.argsort(key)
    place = np.searchsorted(key[order], directed[:, 1].astype(np.int64) * len(vertices) + directed[:, 0])
    place = np.minimum(place, len(order) - 1)
    other = facet[order[place]]
    paired = key[order[place]] == directed[:, 1].astype(np.int64) * len(vertices) + directed[:, 0]
    along = vertices[directed[:, 1]] - vertices[directed[:, 0]]
    length = np.linalg.norm(along, axis=1)
    sine = np.einsum("ij,ij->i", np.cross(normal[facet], normal[other]), along / np.where(length > 0, length, 1)[:, None])
    cosine = np.einsum("ij,ij->i", normal[facet], normal[other])
    sharp = (np.arctan2(sine, cosine) < -SHARP) & paired & (size[facet] > 0) & (size[other] > 0)
    # Needles have no normal to rely on: what counts is an edge of some length.
    return bool(length[sharp].sum() > 1e-3 * np.sqrt(size.sum()))


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
    # Shape decides: first that of the cluster, then the mode's own, so that modes of one cluster that change places are
    # told apart; of equal shapes the order of frequencies.
    n, m = shared.shape
    order = np.abs(np.arange(n)[:, None] - np.arange(m)[None, :])
    own = np.array([span_share(shape[None], fine, weights) for shape in coarse])
    rows, columns = linear_sum_assignment(1 - shared + 1e-2 * (1 - own) + 1e-3 * order / max(n, m))
    partner, agreement = np.full(m, -1), np.zeros(m)
    for row, column in zip(rows, columns):
        agreement[column] = shared[row, column]
        if shared[row, column] >= SAME_MODE:
            partner[column] = row
    return partner, agreement


def span_share(basis, shapes, weights):
    """Share of each shape that lies in the span of `basis`."""
    root = np.sqrt(weights)[None, :, None]
    a = (basis * root).reshape(len(basis), -1)
    b = (shapes * root).reshape(len(shapes), -1)
    q = np.linalg.qr(a.T)[0]
    return ((b @ q) ** 2).sum(1) / (b**2).sum(1)
