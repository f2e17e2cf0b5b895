"""An independent reader of LS-DYNA decks with generalized solids, written from the keywords' card descriptions: it
shares no code with the writer, cuts every line by its columns, refuses what it does not know, and rebuilds mass,
stiffness and contact nodes.
"""

from types import SimpleNamespace

import numpy as np
from scipy import sparse

TEN = [10] * 8
# Cards of keywords with a fixed number of cards: (widths, types); i integer, f real, s text.
FIXED = {
    "SECTION_SOLID": [(TEN, "ii")],
    "SECTION_SHELL": [(TEN, "iffff"), (TEN, "ffff")],
    "MAT_ELASTIC": [(TEN, "ifff")],
    "MAT_NULL": [(TEN, "ifffffff")],
    "MAT_CRUSHABLE_FOAM": [(TEN, "ifffiffi")],
    "MAT_PIECEWISE_LINEAR_PLASTICITY": [(TEN, "ifffffff"), (TEN, "ffiif"), (TEN, "ffffffff"), (TEN, "ffffffff")],
    "MAT_RIGID": [(TEN, "ifff"), (TEN, "fii"), (TEN, "ffffff")],
    "PART": [([80], "s"), (TEN, "iii")],
    "PART_INERTIA": [([80], "s"), (TEN, "iii"), (TEN, "ffffi"), (TEN, "ffffff"), (TEN, "ffffff")],
    "CONTACT_AUTOMATIC_SURFACE_TO_SURFACE_ID": [
        ([10, 70], "is"),
        (TEN, "iiiiiiii"),
        (TEN, "fffffiff"),
        (TEN, "ffffffff"),
        (TEN, "if"),
    ],
    "CONTACT_AUTOMATIC_SINGLE_SURFACE_ID": [
        ([10, 70], "is"),
        (TEN, "iiiiiiii"),
        (TEN, "fffffiff"),
        (TEN, "ffffffff"),
        (TEN, "if"),
    ],
    "BOUNDARY_PRESCRIBED_MOTION_RIGID": [(TEN, "iiiif")],
    "LOAD_BODY_X": [(TEN, "if")],
    "LOAD_BODY_Y": [(TEN, "if")],
    "LOAD_BODY_Z": [(TEN, "if")],
    "CONTROL_TERMINATION": [(TEN, "f")],
    "CONTROL_TIMESTEP": [(TEN, "ffiffi")],
    "CONTROL_ENERGY": [(TEN, "iiii")],
    "CONTROL_BULK_VISCOSITY": [(TEN, "ffi")],
    "CONTROL_CONTACT": [(TEN, "ffiiiiii"), (TEN, "iiiif")],
    "TITLE": [([80], "s")],
    **{
        "DATABASE_" + name: [(TEN, "f")] for name in ("GLSTAT", "MATSUM", "RCFORC", "RBDOUT", "SLEOUT", "BINARY_D3PLOT")
    },
}
# Keywords whose single card is repeated.
REPEATED = {
    "NODE": ([8, 16, 16, 16, 8, 8], "ifffii"),
    "ELEMENT_SHELL": ([8] * 6, "iiiiii"),
    "INITIAL_VELOCITY_NODE": (TEN, "ifff"),
    "LOAD_NODE_POINT": (TEN, "iiif"),
}


def fields(line, widths, types):
    """Values of a line by its columns; None where a field is blank. Text beyond the known fields is refused."""
    if "," in line:
        raise ValueError(f"a comma makes a card free format: {line!r}")
    values, start = [], 0
    for width, kind in zip(widths, types):
        text = line[start : start + width].strip()
        start += width
        values.append(None if not text else text if kind == "s" else int(text) if kind == "i" else float(text))
    if line[start:].strip():
        raise ValueError(f"unexpected text behind column {start}: {line!r}")
    return values


class Deck:
    """nodes {id: (x, tc, rc)}, forms {elform: (w, N, dN)}, solids {eid: (pid, nodes)}, shells {eid: (pid, nodes)},
    interpolations {nid: {master: weight}}, parts, sections, materials, curves, sets, and cards {keyword: [cards, ...]}.
    """

    def __init__(self, path):
        self.nodes, self.forms, self.solids, self.shells, self.interpolations = {}, {}, {}, {}, {}
        self.parts, self.sections, self.materials, self.curves, self.sets, self.velocities = {}, {}, {}, {}, {}, {}
        self.cards, self.remarks, self.loads = {}, [], []
        blocks = []
        for line in path.read_text().splitlines():
            if len(line) > 80:
                raise ValueError(f"{len(line)} columns: {line!r}")
            if line.startswith("$"):
                self.remarks.append(line[1:].strip())
            elif line.startswith("*"):
                blocks.append((line[1:], []))
            else:
                blocks[-1][1].append(line)
        assert blocks[0] == ("KEYWORD", []) and blocks[-1] == ("END", []), "a deck is from *KEYWORD to *END"
        for keyword, lines in blocks[1:-1]:
            self._take(keyword, lines)
        self._check_references()

    def _add(self, table, key, value, what):
        if key in table or key is None or key < 1:
            raise ValueError(f"{what} {key}: twice, or not a number from 1")
        table[key] = value

    def _take(self, keyword, lines):
        if keyword in REPEATED:
            rows = [fields(line, *REPEATED[keyword]) for line in lines]
            for row in rows:
                if keyword == "NODE":
                    self._add(self.nodes, row[0], (np.array(row[1:4]), row[4] or 0, row[5] or 0), "node")
                elif keyword == "LOAD_NODE_POINT":
                    self.loads.append(row)
                elif keyword == "ELEMENT_SHELL":
                    self._element(self.shells, row[0], (row[1], row[2:]))
                else:
                    self.velocities[row[0]] = np.array(row[1:])
        elif keyword in FIXED:
            cards = FIXED[keyword]
            if len(lines) != len(cards):
                raise ValueError(f"*{keyword}: {len(lines)} cards, expected {len(cards)}")
            self._fixed(keyword, [fields(line, *card) for line, card in zip(lines, cards)])
        else:
            getattr(self, "_" + keyword.lower(), self._unknown(keyword))(lines)

    @staticmethod
    def _unknown(keyword):
        def refuse(lines):
            raise ValueError(f"unknown keyword *{keyword}")

        return refuse

    def _fixed(self, keyword, cards):
        self.cards.setdefault(keyword, []).append(cards)
        first = cards[0][0]
        if keyword.startswith("SECTION"):
            self._add(self.sections, first, (keyword, cards), "section")
        elif keyword.startswith("MAT"):
            self._add(self.materials, first, (keyword, cards), "material")
        elif keyword.startswith("PART"):
            self._add(
                self.parts, cards[1][0], SimpleNamespace(section=cards[1][1], material=cards[1][2], cards=cards), "part"
            )

    def _element(self, table, number, value):
        if number in self.solids or number in self.shells:
            raise ValueError(f"element {number} twice")
        table[number] = value

    def _define_element_generalized_solid(self, lines):
        form, points, count, lumping = fields(lines[0], TEN, "iiii")
        assert form > 1000 and lumping == 0, "a formulation above 1000, mass by row sums"
        assert len(lines) == 1 + points * (1 + count), f"formulation {form}: {len(lines)} cards"
        weights, tables = [], []
        for first in range(1, len(lines), 1 + count):
            weights += fields(lines[first], [20], "f")
            tables.append([fields(line, [20] * 4, "ffff") for line in lines[first + 1 : first + 1 + count]])
        rows = np.array(tables)
        self._add(self.forms, form, (np.array(weights), rows[:, :, 0], rows[:, :, 1:]), "formulation")

    def _element_generalized_solid(self, lines):
        number, part, count = fields(lines[0], TEN, "iii")
        nodes = [n for line in lines[1:] for n in fields(line, TEN, "iiiiiiii") if n is not None]
        assert len(nodes) == count and len(lines) == 1 + -(
            -count // 8
        ), f"element {number}: {len(nodes)} nodes of {count}"
        self._element(self.solids, number, (part, nodes))

    def _constrained_node_interpolation(self, lines):
        number, count = fields(lines[0], TEN, "ii")
        values = [v for line in lines[1:] for v in fields(line, TEN, "ifififif") if v is not None]
        assert len(values) == 2 * count and len(lines) == 1 + -(
            -count // 4
        ), f"interpolation node {number}: {len(values)} values"
        self._add(self.interpolations, number, dict(zip(values[::2], values[1::2])), "interpolation node")

    def _define_curve_title(self, lines):
        fields(lines[0], [80], "s")
        number = fields(lines[1], TEN, "iiffffi")[0]
        self._add(self.curves, number, np.array([fields(line, [20, 20], "ff") for line in lines[2:]]), "curve")

    def _set_part_list(self, lines):
        number = fields(lines[0], TEN, "i")[0]
        self._add(
            self.sets, number, [p for line in lines[1:] for p in fields(line, TEN, "iiiiiiii") if p is not None], "set"
        )

    def _check_references(self):
        for number, part in self.parts.items():
            assert part.section in self.sections and part.material in self.materials, f"part {number}"
        for number, (part, nodes) in [*self.solids.items(), *self.shells.items()]:
            assert part in self.parts and all(n in self.nodes for n in nodes), f"element {number}"
        for number, (part, nodes) in self.solids.items():
            keyword, cards = self.sections[self.parts[part].section]
            form = cards[0][1]
            assert keyword == "SECTION_SOLID" and self.forms[form][1].shape[1] == len(nodes), f"element {number}"
        for number, masters in self.interpolations.items():
            assert self.nodes[number][1:] == (7, 7), f"interpolation node {number}: TC and RC must be 7"
            assert all(
                m in self.nodes and m not in self.interpolations for m in masters
            ), f"interpolation node {number}"
        for keyword, kinds in (
            ("CONTACT_AUTOMATIC_SURFACE_TO_SURFACE_ID", 2),
            ("CONTACT_AUTOMATIC_SINGLE_SURFACE_ID", 1),
        ):
            for cards in self.cards.get(keyword, []):
                assert all(
                    cards[1][k] in self.sets and cards[1][2 + k] == 2 for k in range(kinds)
                ), "part sets of contacts"
        assert all(p in self.parts for parts in self.sets.values() for p in parts)

    def resultant(self, curve):
        """Force and moment about the origin of the nodal forces that follow a curve."""
        force = {}
        for node, direction, number, value in self.loads:
            assert node in self.nodes and number in self.curves and direction in (1, 2, 3)
            if number == curve:
                force.setdefault(node, np.zeros(3))[direction - 1] += value
        return sum(force.values()), sum(np.cross(self.nodes[node][0], f) for node, f in force.items())

    def elements(self):
        """(material cards, nodes, dV (q), N (q, n), dN/dx (q, n, 3)) of every generalized solid, from its nodes'
        positions."""
        for part, nodes in self.solids.values():
            form = self.sections[self.parts[part].section][1][0][1]
            w, N, local = self.forms[form]
            x = np.array([self.nodes[n][0] for n in nodes])
            J = np.einsum("qna,nd->qda", local, x)  # dx_d / dr_a
            yield self.materials[self.parts[part].material], nodes, w * np.linalg.det(J), N, local @ np.linalg.inv(J)

    def system(self):
        """Node numbers of the solids, K (3n, 3n) sparse of *MAT_ELASTIC, row sums of the mass (n)."""
        numbers = sorted({n for _, nodes in self.solids.values() for n in nodes})
        index = {n: k for k, n in enumerate(numbers)}
        mass, rows, columns, values = np.zeros(len(numbers)), [], [], []
        for (keyword, cards), nodes, dV, N, g in self.elements():
            rho, E, nu = cards[0][1:4]
            place = np.array([index[n] for n in nodes])
            np.add.at(mass, place, rho * dV @ N)
            if keyword != "MAT_ELASTIC":
                continue
            mu, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
            A = np.einsum("q,qia,qjb->iajb", dV, g, g)  # lame A_ia,jb + mu (A_ib,ja + delta_ab A_ic,jc)
            k = lame * A + mu * (
                A.transpose(0, 3, 2, 1) + np.einsum("ij,ab->iajb", np.einsum("icjc->ij", A), np.eye(3))
            )
            dof = (3 * place[:, None] + np.arange(3)).ravel()
            rows.append(np.repeat(dof, len(dof)))
            columns.append(np.tile(dof, len(dof)))
            values.append(k.ravel())
        shape = (3 * len(numbers),) * 2
        K = (
            sparse.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape)
            if values
            else None
        )
        return numbers, K, mass

    def contact_nodes(self):
        """Positions (n, 3) of interpolation nodes from their masters, those in *NODE, and the sums of their weights."""
        made = np.array(
            [sum(w * self.nodes[m][0] for m, w in masters.items()) for masters in self.interpolations.values()]
        )
        given = np.array([self.nodes[n][0] for n in self.interpolations])
        return made, given, np.array([sum(masters.values()) for masters in self.interpolations.values()])

    def shell_triangles(self, part):
        """Corners (n, 3 or 4, 3) of the shells of a part."""
        return np.array([[self.nodes[n][0] for n in nodes] for p, nodes in self.shells.values() if p == part])
