"""Rigid bodies of a deck: meshes of their surfaces as rigid shells, their mass, motion and start."""

import numpy as np

from igatools.lsdyna.cards import DeckError, NODE, SHELL, card, heading
from igatools.stl import read_stl

ROUND = 16  # facets along a quarter of a circle: 0.12 % of the radius between chord and arc
PLANE = 20  # facets along a side of a plane's patch


def quads(points, shape):
    """Quadrilaterals of a grid of points with `shape` rows and columns, numbered row by row."""
    index = np.arange(shape[0] * shape[1]).reshape(shape)
    return points, np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], 2).reshape(-1, 4)


def joined(pieces):
    """One mesh of several; points that coincide become one."""
    points = np.concatenate([p for p, _ in pieces])
    starts = np.cumsum([0] + [len(p) for p, _ in pieces[:-1]])
    faces = np.concatenate([f + s for (_, f), s in zip(pieces, starts)])
    size = np.ptp(points, 0).max()
    _, first, inverse = np.unique(np.round(points / size, 9) + 0.0, axis=0, return_index=True, return_inverse=True)
    return points[first], inverse.ravel()[faces]


def frame_of(axis):
    """Three unit vectors (3, 3 as columns), the third along the axis."""
    w = np.asarray(axis, float) / np.linalg.norm(axis)
    u = np.cross(np.eye(3)[np.argmin(abs(w))], w)
    u /= np.linalg.norm(u)
    return np.stack([u, np.cross(w, u), w], 1)


def cube_faces(n, placed):
    """The six faces of the cube -1 ... 1 with n facets along a side, each point moved by `placed`."""
    t = np.tan(np.linspace(-1, 1, n + 1) * np.pi / 4)
    pieces = []
    for d in range(3):
        for sign in (-1, 1):
            a, b = np.meshgrid(t, t, indexing="ij")
            x = np.zeros((n + 1, n + 1, 3))
            x[..., d], x[..., (d + 1) % 3], x[..., (d + 2) % 3] = sign, a, b
            pieces.append(quads(placed(x.reshape(-1, 3)), (n + 1, n + 1)))
    return joined(pieces)


def mesh_of(table, inset, reach):
    """Points (n, 3) and faces (m, 4) of a tool whose surface is set back by `inset`. `reach`: centre and radius of all
    bodies, which a plane's patch covers four times."""
    shape, centre = table["shape"], np.array(table.get("centre", np.zeros(3)), float)
    if shape == "sphere":
        return cube_faces(
            2 * ROUND, lambda x: centre + (table["radius"] - inset) * x / np.linalg.norm(x, axis=1)[:, None]
        )
    if shape == "box":
        half = np.array(table["size"], float) / 2 - inset
        return cube_faces(ROUND, lambda x: centre + half * 4 / np.pi * np.arctan(x))
    if shape == "plane":
        frame = frame_of(table["normal"])
        middle = reach[0] - ((reach[0] - centre) @ frame[:, 2] + inset) * frame[:, 2]
        a, b = np.meshgrid(*[np.linspace(-4 * reach[1], 4 * reach[1], PLANE + 1)] * 2, indexing="ij")
        return quads(middle + a.reshape(-1, 1) * frame[:, 0] + b.reshape(-1, 1) * frame[:, 1], (PLANE + 1, PLANE + 1))
    if shape == "cylinder":
        frame, r, h = frame_of(table["axis"]), table["radius"] - inset, table["height"] / 2 - inset
        turn = np.linspace(0, 2 * np.pi, 4 * ROUND + 1)
        rows = np.array([(0.0, -h), (r / 2, -h), (r, -h), (r, -h / 3), (r, h / 3), (r, h), (r / 2, h), (0.0, h)])
        x = np.stack([rows[:, :1] * np.cos(turn), rows[:, :1] * np.sin(turn), np.repeat(rows[:, 1:], len(turn), 1)], 2)
        points, faces = joined([quads(centre + x.reshape(-1, 3) @ frame.T, x.shape[:2])])
        return points, np.array([_triangle_last(face) for face in faces.tolist()])
    triangles = read_stl(table["file"]) * table.get("scale", 1)
    triangles = triangles + (centre - _centre_of_volume(triangles) if "centre" in table else 0)
    points, faces = joined([(triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3))])
    return points, np.concatenate([faces, faces[:, 2:]], 1)


def _triangle_last(face):
    """A quadrilateral with a doubled corner as LS-DYNA wants a triangle: the last corner twice."""
    corners = list(dict.fromkeys(face))
    return corners + corners[-1:] * (4 - len(corners))


def _centre_of_volume(triangles):
    six = np.einsum("ij,ij->i", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2]))
    return (triangles.sum(1) * six[:, None]).sum(0) / (4 * six.sum())


def held(directions):
    """CON1 or CON2 of *MAT_RIGID for a set of held axes (subset of "xyz")."""
    return {"": 0, "x": 1, "y": 2, "z": 3, "xy": 4, "yz": 5, "xz": 6, "xyz": 7}["".join(sorted(directions))]


def inertia_of(value):
    """xx, xy, xz, yy, yz, zz from 1, 3, 6 (xx yy zz xy yz zx) or 9 numbers."""
    v = np.ravel(np.asarray(value, float))
    if len(v) == 9:
        v = v.reshape(3, 3)
        return v[0, 0], v[0, 1], v[0, 2], v[1, 1], v[1, 2], v[2, 2]
    if len(v) == 6:
        return v[0], v[3], v[5], v[1], v[4], v[2]
    xx, yy, zz = np.broadcast_to(v, 3)
    return xx, 0.0, 0.0, yy, 0.0, zz


def write_tool(deck, table, reach, thickness, inset, stiffness, curve_of):
    """Cards of one entry of [[rigid_bodies]]; the number of its part. `curve_of(value, smooth)` gives points of a
    curve."""
    name = table["name"]
    points, faces = mesh_of(table, inset, reach)
    motion = table.get("motion", "driven" if "drive" in table else "fixed")
    drive = table.get("drive", {})
    moved = {axis for axis in "xyz" if axis in drive}
    turned, turns = _turned(name, drive), table.get("rotates", True)
    if motion == "free":
        held_ways, held_turns = set(table.get("guided", "")), set() if turns else set("xyz")
    else:
        held_ways, held_turns = set("xyz") - moved, set("xyz") - turned
    if motion == "free" and ("mass" not in table or (turns and "inertia" not in table)):
        raise DeckError(
            f"rigid body '{name}': a free body needs mass and inertia as numbers; a density is not exported"
        )
    mass = float(table["mass"]) if motion == "free" else 1.0
    inertia = inertia_of(table.get("inertia", mass * reach[1] ** 2) if motion == "free" else mass * reach[1] ** 2)
    centre = np.array(table["centre"], float) if "centre" in table else points.mean(0) if motion != "free" else None
    if centre is None:
        centre = _centre_of_volume(points[faces[:, :3]])
    first, element, part = deck.next("nodes", len(points)), deck.next("elements", len(faces)), deck.next("parts")
    material, section = deck.next("materials"), deck.next("sections")
    deck.comment(f"rigid body {name}: {table['shape']}, {motion}; its surface is set back by {inset:.6g}")
    deck.keyword("NODE", *(card(first + k, *map(float, x), widths=NODE) for k, x in enumerate(points)))
    deck.keyword(
        "ELEMENT_SHELL",
        *(card(element + k, part, *(first + face).tolist(), widths=SHELL) for k, face in enumerate(faces)),
    )
    deck.keyword("SECTION_SHELL", card(section, 2, 1.0, 2, 1.0), card(*[float(thickness)] * 4))
    young, density = stiffness
    deck.keyword(
        "MAT_RIGID",
        card(material, float(density), float(young), 0.3),
        card(1.0, held(held_ways), held(held_turns)),
        card(*[0.0] * 6),
    )
    velocity, spin = (
        np.broadcast_to(np.asarray(table.get(key, 0.0), float), 3) if motion == "free" else np.zeros(3)
        for key in ("velocity", "spin")
    )
    deck.keyword(
        "PART_INERTIA",
        heading(f"rigid body {name}"),
        card(part, section, material),
        card(*map(float, centre), mass, 0),
        card(*map(float, inertia)),
        card(*map(float, velocity), *map(float, spin)),
    )
    if motion == "driven":
        given = 2 if drive.get("kind", "displacement") == "displacement" else 0  # VAD
        for value, dof in [(drive[axis], "xyz".index(axis) + 1) for axis in sorted(moved)] + [
            (drive["rotation"], "xyz".index(axis) + 5) for axis in turned
        ]:
            number = deck.curve(curve_of(value, drive.get("smooth", False)), f"drive of {name}")
            deck.keyword("BOUNDARY_PRESCRIBED_MOTION_RIGID", card(part, dof, given, number, 1.0))
    return part


def _turned(name, drive):
    """The axis that a driven body turns about, as a set."""
    if "rotation" not in drive:
        return set()
    axis = np.array(drive.get("axis", (0, 0, 1)), float)
    along = np.flatnonzero(abs(axis) > 1e-12 * abs(axis).max())
    if len(along) != 1 or axis[along[0]] < 0:
        raise DeckError(
            f"rigid body '{name}': turns about {axis.tolist()}; expected one of the axes x, y, z, the only ones that"
            " the deck prescribes a rotation about"
        )
    return {"xyz"[along[0]]}
