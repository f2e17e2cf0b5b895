"""Surfaces of parts as triangles (n, 3, 3), outwards. Curved faces have flat facets: take enough of them that their chord, which falls
with the square of their number, changes the numbers less than the spans do."""
import numpy as np


def block_nodes(mapping, divisions):
    """Nodes of a unit cube with `divisions` intervals in each direction, mapped: (nx + 1, ny + 1, nz + 1, 3). Nodes that the mapping
    brings together to 1e-12 of the part become equal to the bit."""
    axes = [np.linspace(0, 1, n + 1) for n in divisions]
    at = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    mapped = np.asarray(mapping(at.reshape(-1, 3)), float)
    size = np.ptp(mapped, axis=0).max()
    return (np.round(mapped / size, 12) * size + 0.0).reshape(at.shape)


def block(mapping, divisions):
    """Surface of a mapped unit cube. mapping: points (m, 3) of the cube -> points (m, 3), without turning it inside out. A face that
    shrinks to a line or a point has no triangles."""
    nodes = block_nodes(mapping, divisions)
    found = []
    for axis in range(3):
        turned = np.moveaxis(nodes, [axis, (axis + 1) % 3, (axis + 2) % 3], [0, 1, 2])
        for side, face in ((0, turned[0]), (1, turned[-1])):
            a, b, c, d = face[:-1, :-1], face[1:, :-1], face[1:, 1:], face[:-1, 1:]
            triangles = np.concatenate([np.stack([a, b, c], -2).reshape(-1, 3, 3), np.stack([a, c, d], -2).reshape(-1, 3, 3)])
            found.append(triangles if side else triangles[:, ::-1])
    found = np.concatenate(found)
    a, b, c = np.moveaxis(found, 1, 0)
    return found[np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-14 * np.ptp(found, axis=(0, 1)).max()**2]


def box(low, high):
    """Between two corners."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    return block(lambda x: low + x * (high - low), (1, 1, 1))


def ball(radius, facets):
    """A sphere about the origin: the surface of a cube with `facets` by `facets` squares on each side, at equal angles. It is enlarged
    until it has the sphere's volume, so that facets matter to second order."""
    def mapping(x):
        y = np.tan(np.pi / 4 * (2 * x - 1))
        return radius * y / np.linalg.norm(y, axis=1)[:, None]
    found = block_surface_only(mapping, facets)
    return found * (4 / 3 * np.pi * radius**3 / volume(found))**(1 / 3)


def pyramid(inner, outer, angle, facets):
    """Part of a hollow sphere between the planes x = 0 and y = 0 and those turned by `angle` (radians) from them about the centre."""
    return block(pyramid_mapping(inner, outer, angle), (facets, facets, 1))


def pyramid_mapping(inner, outer, angle):
    def mapping(x):
        t = np.tan(angle * x[:, :2])
        direction = np.column_stack([t, np.ones(len(x))])
        return (inner + (outer - inner) * x[:, 2:]) * direction / np.linalg.norm(direction, axis=1)[:, None]
    return mapping


def block_surface_only(mapping, n):
    """As block(), for mappings that the middle of the cube does not have."""
    def shifted(x):
        inner = (np.abs(x - 0.5) < 0.5 - 1e-9).all(1)
        return mapping(np.where(inner[:, None], 0.0, x))
    return block(shifted, (n, n, n))


def wedge(inner, outer, height, angle, facets, layers=1):
    """Sector of a tube about the z axis from angle 0 to `angle` (radians), z = 0 … height; `facets` along either arc. inner = 0: of a
    cylinder."""
    return block(wedge_mapping(inner, outer, height, angle), (1, facets, layers))


def wedge_mapping(inner, outer, height, angle):
    def mapping(x):
        r, t = inner + (outer - inner) * x[:, 0], angle * x[:, 1]
        return np.stack([r * np.cos(t), r * np.sin(t), height * x[:, 2]], 1)
    return mapping


def cylinder(radius, height, facets):
    """About the z axis, z = 0 … height, of a regular prism with the cylinder's volume."""
    t = 2 * np.pi * np.arange(facets) / facets
    at = radius * np.sqrt(2 * np.pi / (facets * np.sin(2 * np.pi / facets))) * np.stack([np.cos(t), np.sin(t)], 1)
    a, b = np.column_stack([at, np.zeros(facets)]), np.column_stack([np.roll(at, -1, 0), np.zeros(facets)])
    up, middle = np.array([0, 0, float(height)]), np.zeros_like(a)
    return np.concatenate([np.stack([middle, b, a], 1), np.stack([middle + up, a + up, b + up], 1), np.stack([a, b, b + up], 1),
                           np.stack([a, b + up, a + up], 1)])


def octant(inner, outer, facets):
    """An eighth of a hollow sphere, x, y, z >= 0; facets of about 90 / (2 facets) degrees, fine enough where they meet in the middle."""
    corner = np.eye(3)
    middle = (corner + np.roll(corner, -1, axis=0)) / 2  # of the edges 0-1, 1-2, 2-0
    centre = np.full(3, 1 / 3)
    shells = []
    grid = np.linspace(0, 1, facets + 1)
    for k in range(3):
        quad = np.array([corner[k], middle[k], centre, middle[k - 1]])
        u, v = (axis[..., None] for axis in np.meshgrid(grid, grid, indexing="ij"))
        flat = (1 - u) * (1 - v) * quad[0] + u * (1 - v) * quad[1] + u * v * quad[2] + (1 - u) * v * quad[3]
        unit = flat / np.linalg.norm(flat, axis=-1)[..., None]
        shells.append(np.round(unit, 13) + 0.0)
    found = []
    for unit in shells:
        a, b, c, d = unit[:-1, :-1], unit[1:, :-1], unit[1:, 1:], unit[:-1, 1:]
        triangles = np.concatenate([np.stack([a, b, c], -2).reshape(-1, 3, 3), np.stack([a, c, d], -2).reshape(-1, 3, 3)])
        found += [outer * triangles, inner * triangles[:, ::-1]]
        for edge in (unit[:, 0], unit[0, :][::-1]):  # from the corner outwards, and back to it: along two planes of symmetry
            a, b = edge[:-1], edge[1:]
            found += [np.stack([inner * a, inner * b, outer * b], 1), np.stack([inner * a, outer * b, outer * a], 1)]
    return np.concatenate(found)


def where(triangles, condition):
    """The triangles all of whose corners meet the condition, points (m, 3) -> (m) of bool."""
    held = np.asarray(condition(triangles.reshape(-1, 3))).reshape(-1, 3).all(1)
    return triangles[held]


def volume(triangles):
    a, b, c = np.moveaxis(triangles, 1, 0)
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6
