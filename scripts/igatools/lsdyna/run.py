"""A run file of igasolve explicit as the deck's writer needs it: known keys, curves as points, paths made whole."""

import tomllib
from pathlib import Path

from igatools.lsdyna.cards import DeckError
from igatools.run_files import read_curve, smooth_pieces

# Keys that the deck holds; those of LEFT_OUT are named in the deck, all others refused.
KEYS = {
    "": {"units", "unit_system", "gravity", "bodies", "rigid_bodies", "contacts", "loads", "time", "output"},
    "bodies": {
        "model",
        "name",
        "place",
        "material",
        "velocity",
        "spin",
        "spin_centre",
        "mass",
        "light_functions",
        "light_threshold",
        "edge_length",
    },
    "rigid_bodies": {
        "name",
        "shape",
        "centre",
        "motion",
        "drive",
        "mass",
        "inertia",
        "velocity",
        "spin",
        "guided",
        "rotates",
        "radius",
        "normal",
        "axis",
        "height",
        "size",
        "file",
        "scale",
        "density",
    },
    "contacts": {
        "bodies",
        "self",
        "name",
        "friction",
        "friction_dynamic",
        "friction_decay",
        "damping",
        "first_regions",
        "second_regions",
    },
    "loads": {
        "name",
        "body",
        "region",
        "whole_surface",
        "factor",
        "smooth",
        "traction",
        "pressure",
        "force",
        "body_force",
        "acceleration",
    },
    "time": {"end", "safety", "dt_max"},
    "output": {"interval", "field_interval"},
}
LEFT_OUT = {
    "": {"contact": "search skin", "energy": "energy balance watch", "watch": "watch", "stop": "stop"},
    "bodies": {
        "damping": None,
        "erosion_volume_ratio": None,
        "locking": "the deck's elements see the volume ratio of each point",
    },
    "rigid_bodies": {},
    "contacts": {"stiffness": "the contact card has LS-DYNA's own stiffness, SOFT 1", "edges": "edges of surfaces"},
    "loads": {"follows": None},
    "time": {
        "start_share": "first steps",
        "dt_min": "smallest step",
        "hold": "step control",
        "growth": "step control",
        "max_steps": "number of steps",
    },
    "output": {
        "file": "file of results",
        "restart_interval": "restarts",
        "subdivide": "field surface",
        "points": "fields at points",
        "viewer": "ParaView",
    },
}
HINTS = {
    "supports": "springs of supports are not exported; rigid bodies and contacts hold a body in the deck",
    "ties": "ties are not exported",
    "model": "this is not a run file of igasolve explicit, which has [[bodies]] and [time]",
}
SMOOTH = 20  # straight pieces of a smooth curve between two of its points


class Run:
    """`table` as read; `left_out` lines about what the deck leaves out."""

    def __init__(self, path, model=None):
        self.path, self.left_out = Path(path), []
        try:
            text = self.path.read_text(encoding="utf-8")
            self.table = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise DeckError(f"{path}: {error}") from error
        self.remark = next((line.lstrip("# ").rstrip() for line in text.splitlines() if line.startswith("#")), "")
        self._check("", self.table)
        for section in ("time", "output"):
            self._check(section, self.table.get(section, {}))
        for section in ("bodies", "rigid_bodies", "contacts", "loads"):
            for entry in self.table.get(section, []):
                self._check(section, entry)
        if not self.table.get("bodies") or "end" not in self.table.get("time", {}):
            raise DeckError(f"{path}: expected a run file of igasolve explicit, with [[bodies]] and [time] end")
        self.bodies, self.tools = self.table["bodies"], self.table.get("rigid_bodies", [])
        if model is not None:
            if len(self.bodies) != 1:
                raise DeckError(
                    f"{path}: lists {len(self.bodies)} bodies; a model on the command line stands for the only one"
                )
            self.bodies[0]["model"] = str(Path(model).resolve())
        self._complete_bodies()
        for number, tool in enumerate(self.tools, 1):
            tool.setdefault("name", f"rigid {number}")
            self._check_tool(tool)
        names = [entry["name"] for entry in (*self.bodies, *self.tools)]
        if len(set(names)) < len(names):
            raise DeckError(f"{path}: a name stands for two bodies: {', '.join(sorted(names))}; expected each once")

    def _check(self, section, table):
        where = f"[{section}] " if section else ""
        for key, value in table.items():
            if key in KEYS[section]:
                continue
            if key not in LEFT_OUT[section]:
                raise DeckError(
                    f"{self.path}: {where}{key}: "
                    + (HINTS.get(key, "is not exported") if not section else "is not exported")
                    + f"; expected no others than {', '.join(sorted(KEYS[section]))}"
                )
            if LEFT_OUT[section][key] is None:
                if value:
                    raise DeckError(f"{self.path}: {where}{key} = {value}: is not exported; expected 0 or no such key")
                continue
            self.left_out.append(f"{where}{key}: {LEFT_OUT[section][key]}")

    def _complete_bodies(self):
        for body in self.bodies:
            body["model"] = str((self.path.parent / body["model"]).resolve())
            body.setdefault("name", Path(body["model"]).stem)
            if body.get("mass", "lumped") != "lumped":
                raise DeckError(
                    f"{self.path}: {body['name']}: mass = \"{body['mass']}\"; expected \"lumped\": generalized elements"
                    " have row sums"
                )
            if body.get("light_functions", "linear") not in ("linear", "none"):
                raise DeckError(
                    f"{self.path}: {body['name']}: light_functions = \"{body['light_functions']}\"; expected \"linear\""
                    " or \"none\""
                )
            if "material" not in body:
                raise DeckError(f"{self.path}: {body['name']}: has no material")

    def _check_tool(self, tool):
        needs = {
            "sphere": ("radius", "centre"),
            "plane": ("normal", "centre"),
            "cylinder": ("radius", "axis", "height", "centre"),
            "box": ("size", "centre"),
            "stl": ("file",),
        }
        if tool.get("shape") not in needs:
            raise DeckError(
                f"{self.path}: rigid body '{tool['name']}': shape {tool.get('shape')!r}; expected one of"
                f" {', '.join(needs)}"
            )
        for key in needs[tool["shape"]]:
            if key not in tool:
                raise DeckError(f"{self.path}: rigid body '{tool['name']}': has no {key}")
        lacking = set(tool.get("drive", {})) - {"kind", "smooth", "x", "y", "z", "rotation", "axis"}
        if lacking:
            raise DeckError(f"{self.path}: rigid body '{tool['name']}': drive: unknown key '{sorted(lacking)[0]}'")
        if "file" in tool:
            tool["file"] = self.path.parent / tool["file"]

    def curve(self, value, smooth=False):
        """Points (x, y) of a curve: a number, a list of pairs, or a file of two columns; smooth ones in straight
        pieces."""
        end = float(self.table["time"]["end"])
        if isinstance(value, (int, float)):
            return [(0.0, float(value)), (2 * end, float(value))]
        points = [tuple(map(float, pair)) for pair in value] if isinstance(value, list) else self._read_curve(value)
        if smooth:
            points = smooth_pieces(points, SMOOTH)
        if points[0][0] > 0:
            points = [(0.0, points[0][1]), *points]
        return [*points, (points[-1][0] + 2 * end, points[-1][1])]

    def yield_curve(self, value):
        """Points of a curve as given: it goes on in its own way at both ends."""
        return [tuple(map(float, pair)) for pair in value] if isinstance(value, list) else self._read_curve(value)

    def _read_curve(self, name):
        try:
            return read_curve(self.path.parent / name)
        except ValueError as error:
            raise DeckError(error) from error
