"""A deformable body of a deck: control points as nodes, cells as generalized elements, its surface as a contact
skin."""

from dataclasses import dataclass

import numpy as np

from igatools.light_functions import ThinPart, linear_extension, spared_functions
from igatools.lsdyna.cards import (
    DeckError,
    NODE,
    SHELL,
    card,
    heading,
    number_lines,
    pair_lines,
    rounded_weights,
    wide_rows,
)
from igatools.lsdyna.skin import Skin

FIRST_ELFORM = 1001  # *SECTION_SOLID: formulations above 1000 are those of *DEFINE_ELEMENT_GENERALIZED_SOLID
CELLS_PER_BLOCK = 1000  # whose values are held at a time
ALIKE = 11  # decimals of weights, N and derivatives: cells that agree so far share one formulation
CONSTRAINED = 7  # of an interpolation node in *NODE: its motion is that of its controlling nodes


@dataclass
class Placement:
    """Where a body lies: x -> R x + shift."""

    rotation: np.ndarray
    shift: np.ndarray

    def __call__(self, x):
        return x @ self.rotation.T + self.shift


def extension_of(model, remedy, threshold):
    """linear_extension() of a run's light functions; the identity without remedy."""
    try:
        return linear_extension(model, threshold if remedy == "linear" else 0.0)
    except ThinPart as error:
        raise DeckError(f"{error}") from error


class Body:
    """`deck` gives out numbers; write_*() add cards to it."""

    def __init__(self, deck, name, model, density, placement, remedy, threshold):
        self.deck, self.name, self.model, self.place = deck, name, model, placement
        if "/unknowns/offsets" in model.data:
            raise DeckError(
                f"{name}: its model has functions that follow others where gaps end (/unknowns), which explicit runs "
                "with contact replace by those of `igaprep --gap-ends glued`; expected a model made so"
            )
        self.extension, self.lowered = extension_of(model, remedy, threshold)
        self.is_node = self.extension.diagonal() == 1
        seen = np.flatnonzero(self.is_node)
        self.node = np.zeros(len(self.is_node), np.int64)  # number of each function's node
        self.node[seen] = deck.next("nodes", len(seen)) + np.arange(len(seen))
        self.positions = placement(model.control_points(model["/functions/number"][seen]))
        self.numbers = self.node[seen]
        own = np.zeros(len(self.is_node))
        for block, functions, N in model.shape_functions():
            np.add.at(own, functions.ravel(), (N * model["/quadrature/weights"][block, None]).ravel())
        self.density = density
        self.masses = density * (self.extension.T @ own)[seen]
        if (self.masses <= 0).any():
            raise DeckError(
                f"{name}: row sums of the mass of {(self.masses <= 0).sum()} nodes are not positive, since light"
                " functions take mass from them; expected another grid, or a lower light_threshold"
            )
        self.spared = spared_functions(self.extension, own)
        self.element_count = self.extended = 0
        self.parts, self.most_nodes, self.most_points = [], 0, 0

    def mass(self):
        return float(self.masses.sum())

    def write_nodes(self):
        self.deck.comment(f"control points of {self.name}; copies of a function are nodes at the same place")
        self.deck.keyword("NODE", *(card(int(n), *x, widths=NODE) for n, x in zip(self.numbers, self.positions)))

    def _cells(self):
        """(cell, nodes (n), values and derivatives (q, n, 4), weights (q)) of cells with points, in the reference cube
        -1 ... 1."""
        model, h = self.model, self.model.span_size()
        offsets, parameters, weights = (model["/quadrature/" + name] for name in ("offsets", "parameters", "weights"))
        functions, turn = model["/cells/functions"], model.attribute("/patch", "rotation")
        owner = model.point_cells()
        filled = np.flatnonzero(np.diff(offsets))
        for cells in np.array_split(filled, 1 + len(filled) // CELLS_PER_BLOCK):
            first, last = offsets[cells[0]], offsets[cells[-1] + 1]
            spans = model.cell_spans(owner[first:last])
            N = model.functions_at(spans, parameters[first:last])[1]
            slopes = (
                model.gradients_at(spans, parameters[first:last]) @ turn * (h / 2)
            )  # along the grid's axes, per half span
            rows = np.concatenate([N[:, :, None], slopes], 2)
            w = weights[first:last] * 8 / h.prod()
            for cell in cells:
                points = slice(offsets[cell] - first, offsets[cell + 1] - first)
                nodes, E = self._masters(functions[cell])
                self.extended += E is not None
                yield cell, nodes, rows[points] if E is None else np.einsum("qfd,fn->qnd", rows[points], E), w[points]

    def _masters(self, functions):
        """Functions (n) that are nodes and what those of a cell (m) are of them, (m, n); None where they are nodes
        themselves."""
        if self.is_node[functions].all():
            return functions, None
        rows = self.extension[functions]
        nodes = np.unique(rows.indices)
        return nodes, rows[:, nodes].toarray()

    def write_cells(self, material):
        """Formulations, sections, parts and elements."""
        classes, members = {}, []
        for cell, nodes, rows, w in self._cells():
            key = (rows.shape, (np.round(rows, ALIKE) + 0.0).tobytes(), (np.round(w, ALIKE) + 0.0).tobytes())
            if key not in classes:
                classes[key] = self._write_class(cell, rows, w, material)
            members.append((classes[key], nodes))
            self.most_nodes, self.most_points = max(self.most_nodes, len(nodes)), max(self.most_points, len(w))
        first = self.deck.next("elements", len(members))
        for element, (part, nodes) in enumerate(members, first):
            self.deck.keyword(
                "ELEMENT_GENERALIZED_SOLID", card(element, part, len(nodes)), *number_lines(self.node[nodes].tolist())
            )
        self.element_count = len(members)

    def _write_class(self, cell, rows, weights, material):
        """Cards of one formulation; the number of the part that uses it."""
        form = FIRST_ELFORM - 1 + self.deck.next("formulations")
        q, n, _ = rows.shape
        lines = [card(form, q, n, 0)]
        for w, values in zip(weights, rows):
            lines += [f"{w:20.13e}", wide_rows(values)]
        self.deck.keyword("DEFINE_ELEMENT_GENERALIZED_SOLID", *lines)
        section, part = self.deck.next("sections"), self.deck.next("parts")
        self.deck.keyword("SECTION_SOLID", card(section, form))
        self.deck.keyword(
            "PART",
            heading(f"{self.name}: cells of formulation {form}; first cell {cell}"),
            card(part, section, material),
        )
        self.parts.append(part)
        return part

    def write_velocities(self, velocity, spin, centre):
        """The field v + spin x (x - centre), which the nodes hold exactly."""
        if not (np.any(velocity) or np.any(spin)):
            return
        if centre is None:
            centre = (self.masses @ self.positions) / self.masses.sum()
        v = np.asarray(velocity) + np.cross(np.broadcast_to(spin, self.positions.shape), self.positions - centre)
        self.deck.keyword("INITIAL_VELOCITY_NODE", *(card(int(n), *map(float, row)) for n, row in zip(self.numbers, v)))

    def surface_forces(self, regions, traction):
        """Forces at the nodes (n, 3) of a traction on regions (numbers): function(normals in space (q, 3)) -> (q, 3);
        and the area."""
        model, group = self.model, "/surface/quadrature"
        w, normals = model[group + "/weights"], model[group + "/normals"] @ self.place.rotation.T
        w = np.where(np.isin(model["/surface/region"][model[group + "/triangle"]], regions), w, 0)
        total = np.zeros((len(self.is_node), 3))
        for block, functions, N in model.shape_functions(group):
            held = np.flatnonzero(w[block])
            t = traction(normals[block][held]) * w[block][held, None]
            np.add.at(total, functions[held], N[held][:, :, None] * t[:, None, :])
        return (self.extension.T @ total)[self.is_node], float(w.sum())

    def write_forces(self, forces, curve):
        """Forces at the nodes (n, 3) that keep their directions, times a curve."""
        least = 1e-12 * np.abs(forces).max()
        places = np.argwhere(np.abs(forces) > least)
        lines = (card(int(self.numbers[k]), int(d) + 1, curve, float(forces[k, d])) for k, d in places)
        self.deck.keyword("LOAD_NODE_POINT", *lines)

    def write_skin(self, edge_length, material, thickness):
        """Null shells over interpolation nodes; parts by the names of the surface's regions."""
        skin = Skin(self.model, edge_length)
        self.skin_parts = {}
        nodes, weights, positions = [], [], []
        place = np.zeros((len(self.is_node), 3))
        place[self.is_node] = self.positions
        known = {}  # masters by the cell
        for cell, functions, N in zip(skin.cells.tolist(), *skin.shape_functions()):
            if cell not in known:
                known[cell] = self._masters(functions)
            masters, E = known[cell]
            units = rounded_weights(N if E is None else N @ E)
            kept = units != 0
            nodes.append(self.node[masters[kept]].tolist())
            weights.append(units[kept])
            positions.append(units[kept] * 1e-9 @ place[masters[kept]])
        first = self.deck.next("nodes", len(nodes))
        self.deck.comment(f"surface of {self.name}: interpolation nodes")
        self.deck.keyword(
            "NODE", *(card(first + k, *x, CONSTRAINED, CONSTRAINED, widths=NODE) for k, x in enumerate(positions))
        )
        for k, (masters, units) in enumerate(zip(nodes, weights)):
            self.deck.keyword(
                "CONSTRAINED_NODE_INTERPOLATION", card(first + k, len(masters)), *pair_lines(masters, units)
            )
        section = self.deck.next("sections")
        self.deck.keyword("SECTION_SHELL", card(section, 2, 1.0, 2, 1.0), card(*[float(thickness)] * 4))
        names = self.model.texts("/surface/regions")
        for region in np.unique(skin.region):
            part, chosen = self.deck.next("parts"), skin.triangles[skin.region == region]
            self.deck.keyword(
                "PART", heading(f"{self.name}: surface; region {names[region]}"), card(part, section, material)
            )
            element = self.deck.next("elements", len(chosen))
            self.deck.keyword(
                "ELEMENT_SHELL",
                *(
                    card(element + k, part, *(first + t).tolist(), int(first + t[2]), widths=SHELL)
                    for k, t in enumerate(chosen)
                ),
            )
            self.skin_parts[names[region]] = part
        self.skin = skin
