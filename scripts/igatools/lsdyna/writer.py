"""The deck of a run: bodies, tools, contacts, control and output, with what it says about itself at the top."""

import numpy as np

from igatools import iga_model
from igatools.lsdyna.body import Body, Placement
from igatools.lsdyna.cards import Deck, DeckError, card, comment_lines, heading
from igatools.lsdyna.laws import bulk_viscosity, write_material
from igatools.lsdyna.run import Run
from igatools.lsdyna.tools import write_tool
from igatools.run_files import kind_of_load

SKIN_MASS = 1e-6  # of the bodies' density: null shells need a density, and their mass counts
THICKNESS = 0.05  # of the smallest span: how thick contact takes surfaces to be


def placement(table):
    """Of a body: turn by degrees about an axis through a point, then a shift."""
    unknown = set(table) - {"shift", "degrees", "axis", "about"}
    if unknown:
        raise DeckError(f"place: unknown key '{sorted(unknown)[0]}'; expected shift, degrees, axis, about")
    shift, rotation = np.array(table.get("shift", (0, 0, 0)), float), np.eye(3)
    if "degrees" in table:
        k = np.array(table["axis"], float) / np.linalg.norm(table["axis"])
        angle, K = np.radians(table["degrees"]), np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
        rotation = np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K
        about = np.array(table.get("about", (0, 0, 0)), float)
        shift = shift + about - rotation @ about
    return Placement(rotation, shift)


def read_model(path):
    """iga_model.read(); FormatError names the file."""
    try:
        return iga_model.read(path)
    except FileNotFoundError as error:
        raise DeckError(f"{path}: no such file; igaprep makes models") from error
    except (iga_model.FormatError, OSError) as error:
        raise iga_model.FormatError(f"{path}: {error}") from error


class Writer:
    """`text` is the deck, `report` what a user should know about it."""

    def __init__(self, run_path, model=None, thickness=None):
        self.run = run = Run(run_path, model)
        self.deck, self.notes = Deck(), []
        tables = run.bodies
        models = [read_model(table["model"]) for table in tables]
        labels = {m.attribute("/", "length_unit") for m in models}
        if "units" in run.table and labels - {run.table["units"]}:
            raise DeckError(
                f"{run.path}: units = \"{run.table['units']}\", but a model's length unit is "
                f"{(labels - {run.table['units']}).pop()!r}"
            )
        self.span = min(m.span_size().min() for m in models)
        self.thickness = THICKNESS * self.span if thickness is None else thickness
        if not self.thickness > 0:
            raise DeckError(f"contact thickness {self.thickness:g}: expected a positive length")
        self.bodies = [self._body(table, model) for table, model in zip(tables, models)]
        self._tools_and_contacts()
        self._gravity()
        for number, load in enumerate(self.run.table.get("loads", []), 1):
            self._load(load, f"load '{load.get('name', number)}'")
        self._control()
        remarks = [piece for line in self._header() for piece in comment_lines(line)]
        title = heading(models[0].attribute("/", "title") or run.path.name)
        self.text = "\n".join(["*KEYWORD", *remarks, "*TITLE", title, *self.deck.lines, "*END", ""])

    def _body(self, table, model):
        deck, name = self.deck, table["name"]
        material = write_material(deck, name, table["material"], self.run.yield_curve, self.notes)
        body = Body(
            deck,
            name,
            model,
            float(table["material"]["rho"]),
            placement(table.get("place", {})),
            table.get("light_functions", "linear"),
            float(table.get("light_threshold", 0.01)),
        )
        if body.spared:
            self.notes.append(
                f"{name}: {body.spared} light functions bring their lumped mass to their nearest master alone in "
                "igasolve; the deck's elements spread it over all masters"
            )
        for cells, threshold in body.lowered:
            self.notes.append(
                f"{name}: a part of {cells} cells is thin for its spans; there functions are light below the threshold "
                f"{threshold:.3g}, as in igasolve"
            )
        body.write_nodes()
        body.write_cells(material)
        body.write_velocities(table.get("velocity", (0, 0, 0)), table.get("spin", (0, 0, 0)), table.get("spin_centre"))
        skin = deck.next("materials")
        deck.keyword(
            "MAT_NULL",
            card(
                skin,
                SKIN_MASS * float(table["material"]["rho"]),
                0.0,
                0.0,
                0.0,
                0.0,
                float(table["material"]["E"]),
                float(table["material"]["nu"]),
            ),
        )
        body.write_skin(float(table.get("edge_length", model.span_size().min() / 2)), skin, self.thickness)
        return body

    def _tools_and_contacts(self):
        deck, run = self.deck, self.run
        x = np.concatenate([body.positions for body in self.bodies])
        centre = (x.min(0) + x.max(0)) / 2
        reach = centre, float(np.linalg.norm(x - centre, axis=1).max())
        stiff = max(float(t["material"]["E"]) for t in run.bodies), max(float(t["material"]["rho"]) for t in run.bodies)
        parts = {body.name: body.skin_parts for body in self.bodies}
        for tool in run.tools:
            exact = tool["shape"] != "stl"
            number = write_tool(deck, tool, reach, self.thickness, self.thickness if exact else 0.0, stiff, run.curve)
            parts[tool["name"]] = {"": number}
            if not exact:
                self.notes.append(
                    f"rigid body '{tool['name']}': facets of its file as they are; contact begins {self.thickness:.3g}"
                    " early"
                )
            if tool["shape"] == "plane":
                self.notes.append(
                    f"rigid body '{tool['name']}': a square of {8 * reach[1]:.4g} across stands for the plane"
                )
            if tool["shape"] in ("sphere", "cylinder"):
                self.notes.append(
                    f"rigid body '{tool['name']}': facets with their corners on the {tool['shape']}, up to 0.12 % of"
                    " its radius inside"
                )
        for table in run.table.get("contacts", []):
            self._contact(table, parts)

    def _contact(self, table, parts):
        deck = self.deck
        names = [table["self"]] if "self" in table else list(table.get("bodies", []))
        if len(names) != (1 if "self" in table else 2) or any(name not in parts for name in names):
            raise DeckError(f"{self.run.path}: contact of {names}: expected two of {sorted(parts)}, or one under self")
        sets = []
        for name, key in zip(names, ("first_regions", "second_regions")):
            chosen = parts[name]
            if key in table:
                lacking = set(table[key]) - set(chosen)
                if lacking:
                    raise DeckError(
                        f"{self.run.path}: {key}: {name} has no region '{sorted(lacking)[0]}'; it has"
                        f" {', '.join(chosen)}"
                    )
                chosen = {region: chosen[region] for region in table[key]}
            number = deck.next("sets")
            ids = list(chosen.values())
            deck.keyword("SET_PART_LIST", card(number), *(card(*ids[k : k + 8]) for k in range(0, len(ids), 8)))
            sets.append(number)
        static = float(table.get("friction", 0))
        damping = 100 * float(table.get("damping", 0.03))
        kind = "CONTACT_AUTOMATIC_SINGLE_SURFACE" if len(sets) == 1 else "CONTACT_AUTOMATIC_SURFACE_TO_SURFACE"
        title = table.get("name", "-".join(names if len(names) == 2 else names * 2))
        second = (None, 0) if len(sets) == 1 else (sets[1], 2)
        deck.keyword(
            kind + "_ID",
            card(deck.next("contacts"), heading(title).ljust(70), widths=(10, 70)),
            card(sets[0], second[0], 2, second[1], None, None, 1, 1),
            card(
                static,
                float(table.get("friction_dynamic", static)),
                float(table.get("friction_decay", 0)),
                0.0,
                damping,
                0,
                0.0,
                1e20,
            ),
            card(1.0, 1.0, self.thickness, self.thickness, 1.0, 1.0, 1.0, 1.0),
            card(1, 0.1),
        )

    def _gravity(self):
        g = self.run.table.get("gravity", 0)
        g = [0.0, 0.0, 0.0] if g == 0 else list(map(float, g))
        if any(g):
            number = self.deck.curve(self.run.curve(1.0), "gravity")
            for axis, value in zip("XYZ", g):
                if value:  # the card gives the frame an acceleration: bodies feel the opposite
                    self.deck.keyword(f"LOAD_BODY_{axis}", card(number, -value))

    def _load(self, load, what):
        bodies = {body.name: body for body in self.bodies}
        name = load.get("body", self.bodies[0].name if len(bodies) == 1 else None)
        if name not in bodies:
            raise DeckError(f"{self.run.path}: {what}: body {name!r}: expected one of {', '.join(bodies)}")
        body = bodies[name]
        try:
            kind = kind_of_load(load)
        except ValueError as error:
            raise DeckError(f"{self.run.path}: {what}: {error}") from error
        value = np.array(load[kind], float)
        if kind in ("body_force", "acceleration"):
            forces = body.masses[:, None] * (value if kind == "acceleration" else value / body.density)
        else:
            regions = self._regions(body, load, what)
            if kind == "pressure":
                forces, area = body.surface_forces(regions, lambda normals: -value * normals)
            else:
                forces, area = body.surface_forces(regions, lambda normals: np.broadcast_to(value, normals.shape))
            if body.model.attributes["/quadrature"].get("surface_rule") in ("reduced", b"reduced"):
                self.notes.append(f"{what}: points of the reduced surface rule, exact for resultants on flat facets alone")
            if not area > 0:
                raise DeckError(f"{self.run.path}: {what}: its regions have no area")
            forces = forces / area if kind == "force" else forces
        if np.any(forces):
            curve = self.run.curve(load.get("factor", 1.0), load.get("smooth", False))
            body.write_forces(forces, self.deck.curve(curve, f"{what}: factor"))

    def _regions(self, body, load, what):
        """Numbers of the regions of the body's surface that a load acts on."""
        names = body.model.texts("/surface/regions")
        if "region" not in load:
            if not load.get("whole_surface"):
                raise DeckError(f"{self.run.path}: {what}: expected region or whole_surface = true")
            return list(range(len(names)))
        given = load["region"] if isinstance(load["region"], list) else [load["region"]]
        found = [r for r, name in enumerate(names) if name in given or r in given]
        if len(found) < len(given):
            raise DeckError(f"{self.run.path}: {what}: region {given}: {body.name} has {', '.join(names)}")
        return found

    def _control(self):
        deck, time, output = self.deck, self.run.table["time"], self.run.table.get("output", {})
        end = float(time["end"])
        deck.keyword("CONTROL_TERMINATION", card(end))
        limit = deck.curve(self.run.curve(float(time["dt_max"])), "longest time step") if "dt_max" in time else 0
        deck.keyword("CONTROL_TIMESTEP", card(0.0, float(time.get("safety", 0.9)), 0, 0.0, 0.0, limit))
        deck.keyword("CONTROL_ENERGY", card(1, 2, 2, 2))
        deck.keyword("CONTROL_BULK_VISCOSITY", card(*bulk_viscosity(t["material"] for t in self.run.bodies), 1))
        deck.keyword("CONTROL_CONTACT", card(0.1, None, 1, 1, 1, 0, 1, 0), card(0, 0, 10, 0, 4.0))
        interval, fields = float(output.get("interval", end / 1000)), float(output.get("field_interval", end / 50))
        for name in ("GLSTAT", "MATSUM", "RCFORC", "RBDOUT", "SLEOUT"):
            deck.keyword("DATABASE_" + name, card(interval))
        deck.keyword("DATABASE_BINARY_D3PLOT", card(fields))

    def _header(self):
        """What the deck is, in which units, and what it is not."""
        run, used = self.run, self.deck.used
        units = (
            run.table.get("unit_system")
            or f"length {run.table.get('units', 'as in the model')}; mass and time as below"
        )
        yield "Deck of generalized solids for LS-DYNA, written by scripts/export_lsdyna.py of iga-trimmed-solids"
        yield "LS-DYNA itself has not run this deck: it was checked by a reader of its cards alone"
        yield f"run file: {run.path.name}; units: {units}; nothing is converted"
        if run.remark:
            yield f"its first remark: {run.remark}"
        for body in self.bodies:
            yield (
                f"{body.name}: mass {body.mass():.10g}, {len(body.numbers)} control points, {body.element_count}"
                f" elements of {len(body.parts)} formulations, {body.extended} with extended functions, at most"
                f" {body.most_nodes} nodes and {body.most_points} points, {len(body.skin.vertices)} interpolation nodes"
            )
        yield ", ".join(f"{count} {kind}" for kind, count in used.items())
        yield (
            f"contact: shells of thickness {self.thickness:.6g} ({SKIN_MASS:g} of the bodies' density); tools are set"
            " back so that contact begins where surfaces meet; in self-contact it begins that much early"
        )
        for line in self.notes:
            yield "differs: " + line
        for line in self.run.left_out:
            yield "left out: " + line

    @property
    def report(self):
        """Lines for the user."""
        return list(self._header())
