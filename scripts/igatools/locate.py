"""Which cell of a model a point in space belongs to: numpy alone."""
import numpy as np

from igatools.iga_model import INTERIOR, TRIMMED

ROUNDING = 1e-9  # distances of no more than this, in spans, are rounding
ALLOWANCE = 0.05  # spans: how far outside the flat triangles a point on a round face may lie
BLOCK = 4_000_000  # pairs of point and triangle that are looked at together


def cut_to_span(polygon, low, high):
    """What of a convex polygon (n, 3) lies in the box: (m, 3), m = 0 where nothing does."""
    for axis in range(3):
        for sign, bound in ((1, low[axis]), (-1, -high[axis])):
            height = sign * polygon[:, axis] - bound
            kept = []
            for here, there, a, b in zip(polygon, np.roll(polygon, -1, 0), height, np.roll(height, -1)):
                if a >= 0:
                    kept.append(here)
                if (a > 0 > b) or (a < 0 < b):
                    kept.append(here + a / (a - b) * (there - here))
            polygon = np.array(kept).reshape(-1, 3)
            if len(polygon) < 3:
                return np.zeros((0, 3))
    return polygon


def patches(model, vertices, split):
    """Parts of the surface in spans that hold several cells: polygons (n, 3), and the cell of each.

    In a span a triangle is one convex polygon, so it belongs to one cell: that of its surface points there.
    """
    group = "/surface/quadrature"
    cells, triangles = model.point_cells(group), model[group + "/triangle"]
    chosen = np.isin(model["/cells/span"][cells], split)
    pairs = np.unique(np.stack([cells[chosen], triangles[chosen]], 1), axis=0)
    A, h = model.attribute("/patch", "A"), model.span_size()
    polygons, owners = [], []
    for (cell, triangle), ijk in zip(pairs, model.cell_spans(pairs[:, 0])):
        polygon = cut_to_span(vertices[model["/surface/triangles"][triangle]], A + ijk * h, A + (ijk + 1) * h)
        if len(polygon):
            polygons.append(polygon)
            owners.append(cell)
    return polygons, np.array(owners, int)


def fan(polygons):
    """Vertices and triangles of convex polygons."""
    starts = np.cumsum([0] + [len(p) for p in polygons])
    return np.concatenate(polygons), np.array([(s, s + k, s + k + 1) for s, p in zip(starts, polygons)
                                               for k in range(1, len(p) - 1)])


def windings(points, vertices, triangles):
    """How often a closed surface of oriented triangles (m, 3) winds around points (n, 3): 1 inside, 0 outside.

    Counts the triangles that a ray along +x crosses. An edge is judged from its lower vertex number to the higher one, so both
    of its triangles judge alike and a ray through it is counted once.
    """
    total = np.zeros(len(points), int)
    step = max(1, BLOCK // max(1, len(triangles)))
    for first in range(0, len(points), step):
        x = points[first:first + step, None]
        left = []
        for k in range(3):
            start, end = triangles[:, k], triangles[:, (k + 1) % 3]
            low, high = vertices[np.minimum(start, end)], vertices[np.maximum(start, end)]
            side = (high - low)[:, 1] * (x - low)[..., 2] - (high - low)[:, 2] * (x - low)[..., 1]
            left.append((side >= 0) == (start < end))
        forward, backward = left[0] & left[1] & left[2], ~(left[0] | left[1] | left[2])
        point, triangle = np.nonzero(forward | backward)
        ahead = crossing(points[first + point], vertices[triangles[triangle]]) > points[first + point, 0]
        np.add.at(total, first + point[ahead], np.where(forward[point, triangle], 1, -1)[ahead])
    return total


def crossing(points, corners):
    """Where lines along x through points (n, 3) meet the planes of triangles (n, 3, 3): x, within the triangle's."""
    a = corners[:, 0]
    normal = np.cross(corners[:, 1] - a, corners[:, 2] - a)
    rise = ((points - a)[:, 1:] * normal[:, 1:]).sum(1)
    x = a[:, 0] - rise / np.where(normal[:, 0] == 0, np.inf, normal[:, 0])
    return np.clip(x, corners[:, :, 0].min(1), corners[:, :, 0].max(1))


def nearest_on_segment(points, a, b):
    """Nearest points of segments a-b to points, entry by entry: (n, 3)."""
    along = b - a
    length = np.einsum("nd,nd->n", along, along)
    share = np.einsum("nd,nd->n", points - a, along) / np.where(length > 0, length, 1)
    return a + np.clip(share, 0, 1)[:, None] * along


def distance_to_triangles(points, corners):
    """Distances of points (n, 3) from triangles (n, 3, 3), entry by entry."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = np.cross(b - a, c - a)
    area = np.einsum("nd,nd->n", normal, normal)
    height = np.einsum("nd,nd->n", points - a, normal) / np.sqrt(np.where(area > 0, area, 1))
    above = area > 0
    for start, end in ((a, b), (b, c), (c, a)):
        above &= np.einsum("nd,nd->n", np.cross(end - start, points - start), normal) >= 0
    edges = [np.linalg.norm(points - nearest_on_segment(points, start, end), axis=1)
             for start, end in ((a, b), (b, c), (c, a))]
    return np.where(above, np.abs(height), np.min(edges, axis=0))


def nearest_triangle(points, corners):
    """Distance (n) of points (n, 3) from a set of triangles (m, 3, 3), and the nearest one (n)."""
    distance, nearest = np.full(len(points), np.inf), np.zeros(len(points), int)
    step = max(1, BLOCK // 20 // max(1, len(corners)))
    for first in range(0, len(points), step):
        block = points[first:first + step]
        pairs = distance_to_triangles(np.repeat(block, len(corners), 0), np.tile(corners, (len(block), 1, 1)))
        pairs = pairs.reshape(len(block), -1)
        nearest[first:first + step], distance[first:first + step] = pairs.argmin(1), pairs.min(1)
    return distance, nearest


class Locator:
    """The cells that points belong to. Inside is decided by how often the surface winds around a point, not by its span: a
    trimmed span holds space without material too. Where a span holds several cells, or a point lies between spans that do not
    hang together, the nearest surface in them tells which: nothing but the solid lies between."""

    def __init__(self, model):
        self.model = model
        self.origin, self.h = model.attribute("/patch", "A"), model.span_size()
        self.vertices, self.triangles = model.parameters_of(model["/surface/vertices"]), model["/surface/triangles"]
        corners = self.vertices[self.triangles]
        self.low, self.high = corners.min(1), corners.max(1)
        number, self.first_cell, self.count = np.unique(model["/cells/span"], return_index=True, return_counts=True)
        self.state = np.asarray(model["/spans/state"]).ravel()
        self.entry = np.full(self.state.size, -1)
        self.entry[number] = np.arange(len(number))
        self.links = {tuple(pair) for pair in model["/links/cells"].tolist()}

    def locate(self, points):
        """Cells (n), -1 outside the solid, and parameters (n, 3) of points (n, 3)."""
        u = self.model.parameters_of(points)
        spans = self._spans(u)
        cells = np.full(len(u), -1)
        known = np.flatnonzero(spans[:, 0] >= 0)
        trimmed = known[self.state[spans[known, 0]] == TRIMMED]
        outside = trimmed[~self._is_inside(u[trimmed], spans[trimmed, 0])]
        known = np.setdiff1d(known, outside, assume_unique=True)
        sets, member = np.unique(spans[known], axis=0, return_inverse=True)
        for which, here in groups(member):
            numbers = sets[which][sets[which] >= 0]
            cells[known[here]] = self._cells_in(numbers, u[known[here]])
        return cells, u

    def _spans(self, u):
        """Numbers of the spans with material whose closed boxes hold each of the points: (n, 8), filled up with -1; where one of
        them is interior, that one alone."""
        xi = (u - self.origin) / self.h
        strides = np.array([1, self.model.spans[0], self.model.spans[0] * self.model.spans[1]])
        found = np.full((len(u), 8), -1)
        for k, corner in enumerate(np.ndindex(2, 2, 2)):
            ijk = np.floor(xi + ROUNDING * (2 * np.array(corner) - 1)).astype(int)
            held = np.flatnonzero(((ijk >= 0) & (ijk < self.model.spans)).all(1))
            number = ijk[held] @ strides
            found[held, k] = np.where(self.entry[number] >= 0, number, -1)
        found = -np.sort(-found, axis=1)  # -1 at the end
        found[:, 1:][found[:, 1:] == found[:, :-1]] = -1
        found = -np.sort(-found, axis=1)
        interior = (found >= 0) & (self.state[np.maximum(found, 0)] == INTERIOR)
        filled = np.flatnonzero(interior.any(1))
        found[filled, 0] = found[filled, interior[filled].argmax(1)]
        found[filled, 1:] = -1
        return found

    def _cells_in(self, spans, u):
        """Cells of points in the solid that all lie in the same spans."""
        entry = self.entry[spans]
        first = self.first_cell[entry]
        if (self.count[entry] == 1).all() and self._hang_together(first):
            return first[0]  # the functions of all of them are the same on their common face
        polygons, owners = patches(self.model, self.vertices, spans)
        if not polygons:
            return first[0]
        vertices, triangles = fan(polygons)
        owner = np.repeat(owners, [len(polygon) - 2 for polygon in polygons])
        return owner[nearest_triangle(u, vertices[triangles])[1]]

    def _hang_together(self, cells):
        return all(any((min(a, b), max(a, b)) in self.links for b in cells[:k]) for k, a in enumerate(cells) if k > 0)

    def _is_inside(self, u, span):
        inside = np.zeros(len(u), bool)
        for _, here in groups(span // self.model.spans[0]):  # a row of spans along x
            inside[here] = windings(u[here], self.vertices, self._triangles_near(u[here], 0.0, rays=True)) > 0
        beside = np.flatnonzero(~inside)
        allowance = ALLOWANCE * self.h.min()
        for _, here in groups(span[beside]):
            points = u[beside[here]]
            near = self._triangles_near(points, allowance)
            if len(near):
                inside[beside[here]] = nearest_triangle(points, self.vertices[near])[0] <= allowance
        return inside

    def _triangles_near(self, points, distance, rays=False):
        """Those (m, 3) whose box meets that of the points, widened; of rays along x all that lie ahead."""
        low, high = points.min(0) - distance, points.max(0) + distance
        if rays:
            high[0] = np.inf
        return self.triangles[((self.high >= low) & (self.low <= high)).all(1)]


def groups(numbers):
    """(number, places where it stands) for each number in an array."""
    order = np.argsort(numbers, kind="stable")
    found, first = np.unique(numbers[order], return_index=True)
    return zip(found, np.split(order, first[1:]))
