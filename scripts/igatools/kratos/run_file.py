"""What of igasolve's run file Kratos can do here. Everything else is refused with the line where it stands."""

import re
import tomllib
from pathlib import Path

import numpy as np

from igatools.choices import chosen_pieces, snap_length
from igatools.run_files import LOAD_KINDS

LARGE = ("nonlinear", "explicit")  # analyses at large displacement
LAWS = ("st-venant-kirchhoff", "neo-hookean")
SURFACE = {"region", "box", "plane", "normal", "whole_surface"}
HARMLESS = {"", "output", "units", "unit_system", "results"}  # no number depends on them
ROOT = {"model", "material", "support", "load", "probe", "light_functions", "mass"} | HARMLESS
KEYS = {
    "material": {"E", "nu", "rho", "yield", "expansion", "conductivity"},
    "support": {"name", "fixed", "value", "gradient", "rotation", "rotate_axis_angle", "method", "penalty_factor"}
    | SURFACE,
    "load": {"name", "traction", "pressure", "force", "body_force", "acceleration", "rotation", "rotate_axis_angle"}
    | SURFACE,
    "probe": {"name", "position"},
}
OWN = {
    "static": {},
    "eigen": {"eigen": {"modes"}},
    "nonlinear": {"nonlinear": {"steps", "tolerance", "max_iterations", "smallest_step"}},
}
NUMBERS = {
    "traction": 3,
    "force": 3,
    "body_force": 3,
    "acceleration": 3,
    "rotation": 9,
    "rotate_axis_angle": 4,
    "gradient": 9,
    "position": 3,
    "box": 6,
    "pressure": 0,
    "penalty_factor": 0,
    "modes": 0,
    "steps": 0,
    "tolerance": 0,
    "max_iterations": 0,
}  # 0: one alone


class RunError(Exception):
    """The user can mend it."""


def read_toml(path):
    """Text and tables of a run file. Raises RunError."""
    try:
        text = Path(path).read_text(encoding="utf-8")
        return text, tomllib.loads(text)
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise RunError(f"{path}: cannot be read as a run file ({error})") from error


class RunFile:
    """A run file read for one analysis: model (path), E, nu, rho, law, supports, loads, probes (the file's tables), modes,
    steps, tolerance, max_iterations. Raises RunError naming the line."""

    heads = {}  # heads that tables have in the file, where they are not the names of `data`

    def __init__(self, path, analysis=None):
        self.path, (self.text, self.data) = Path(path), read_toml(path)
        self.analysis = analysis or next((name for name in ("nonlinear", "eigen") if name in self.data), "static")
        self._check_keys()
        self._read_material()
        for key, only in (("light_functions", "none"), ("mass", "consistent")):
            if self.data.get(key, only) != only and (key != "mass" or self.analysis == "eigen"):
                self.refuse("", 0, key, f'found "{self.data[key]}", expected "{only}": the others are igasolve\'s own')
        self.model = self.path.parent / self.data["model"] if "model" in self.data else None
        self.supports, self.loads, self.probes = (self.data.get(kind, []) for kind in ("support", "load", "probe"))
        self._check_numbers()
        for k, support in enumerate(self.supports):
            self._check_support(k, support)
        for k, load in enumerate(self.loads):
            self._check_load(k, load)
        own = self.data.get(self.analysis, {})
        self.modes, self.steps = int(own.get("modes", 10)), int(own.get("steps", 10))
        self.tolerance, self.max_iterations = float(own.get("tolerance", 1e-8)), int(own.get("max_iterations", 20))

    def line(self, table, number, key):
        """Number, from 1, of the line that holds a key of the `number`-th table of a name; of the table's head where the key stands
        in it in one line, or nowhere."""
        current, count, head, table = "", {}, 1, self.heads.get(table, table)
        for at, text in enumerate(self.text.splitlines(), 1):
            found = re.match(r"\s*\[\[?\s*([^\]\s]+)\s*\]", text)
            if found:
                current = found[1].strip('"')
                count[current] = count.get(current, -1) + 1
            here = current == table and count.get(current, 0) == number
            if here and found or not current and table and re.match(rf'\s*"?{re.escape(table)}"?\s*[=.]', text):
                head = at
            if here and key and re.match(rf'\s*"?{re.escape(key)}"?\s*[=.]', text):
                return at
            if not table and found and found[1].strip('"').split(".")[0] == key:
                return at
        return head

    def refuse(self, table, number, key, why):
        where = (
            f"[{self.heads.get(table, table)}]: "
            if table in self.data and isinstance(self.data[table], dict)
            else f"[[{self.heads.get(table, table)}]]: " if table else ""
        )
        raise RunError(f"{self.path}, line {self.line(table, number, key)}: {where}{key}: {why}")

    def name(self, kind, number):
        return self.data[kind][number].get("name", f"{kind} {number + 1}")

    def _check_keys(self):
        known = ROOT | OWN[self.analysis].keys() | {"eigen", "nonlinear"} | ({"locking"} if self.analysis == "nonlinear" else set())
        for key in self.data.keys() - known:
            self.refuse("", 0, key, "Kratos is not given this here; igasolve can do it")
        for table, keys in (KEYS | OWN[self.analysis]).items():
            if table == "material" and self.analysis == "nonlinear":
                keys = keys | {"law"}
            if table == "load" and self.analysis == "nonlinear":
                keys = keys | {"follower"}
            found = self.data.get(table, {} if table == "material" or table in OWN[self.analysis] else [])
            if isinstance(found, str):
                self.refuse("", 0, table, f'found the name "{found}"; write its numbers, {{ E = …, nu = …, rho = … }}')
            for number, one in enumerate(found if isinstance(found, list) else [found]):
                for key in one.keys() - keys:
                    self.refuse(
                        table,
                        number,
                        key,
                        f"Kratos is not given this here, only {', '.join(sorted(keys))}; igasolve can do it",
                    )

    def _check_numbers(self):
        for table in ("support", "load", "probe", self.analysis):
            found = self.data.get(table, [])
            for number, one in enumerate(found if isinstance(found, list) else [found]):
                for key, count in NUMBERS.items():
                    values = one.get(key, [0.0] * count if count else 1)
                    each = values if isinstance(values, list) else [values]
                    if (
                        isinstance(values, list) != (count > 0)
                        or len(each) != max(count, 1)
                        or not all(type(v) in (int, float) for v in each)
                    ):
                        self.refuse(
                            table,
                            number,
                            key,
                            f"found {values!r}, expected {count or 'a'} number{'s' if count else ''}",
                        )
                if table == "probe" and "position" not in one:
                    self.refuse(table, number, "position", "is missing")

    def _number(self, table, key, default=None):
        value = self.data.get(table, {}).get(key, default)
        if not isinstance(value, (int, float)) or isinstance(value, bool) or not np.isfinite(value):
            self.refuse(table, 0, key, f"found {value!r}, expected a number")
        return float(value)

    def _read_material(self):
        self.E, self.nu = self._number("material", "E"), self._number("material", "nu")
        self.rho = self._number("material", "rho", 0.0)
        self.law = self.data["material"].get("law", "neo-hookean") if self.analysis in LARGE else "linear-elastic"
        if not (self.E > 0 and -1 < self.nu < 0.5):
            self.refuse("material", 0, "E", f"E = {self.E:g}, nu = {self.nu:g}: expected E > 0 and -1 < nu < 0.5")
        if self.analysis in LARGE and self.law not in LAWS:
            self.refuse("material", 0, "law", f'found "{self.law}", expected one of {", ".join(LAWS)}')
        if self.analysis == "nonlinear" and self.data.get("locking", "fbar" if self.nu >= 0.49 else "none") != "none":
            self.refuse("material", 0, "nu", 'igasolve takes F-bar here, which Kratos has not; write locking = "none" at the top')
        if self.analysis in ("eigen", "explicit") and not self.rho > 0:
            self.refuse("material", 0, "rho", "modes and motion need a density above 0")

    def _check_support(self, k, support):
        method = support.get("method", "penalty" if self.analysis == "nonlinear" else "nitsche")
        if method != "penalty":
            self.refuse(
                "support",
                k,
                "method",
                f'found "{method}"'
                + ("" if "method" in support else ", which is what igasolve does without it")
                + ', expected method = "penalty": Kratos has no Nitsche support for solids and is given no multipliers',
            )
        fixed = support.get("fixed", "xyz")
        if not isinstance(fixed, str) or fixed != "normal" and not (fixed and set(fixed) <= set("xyz")):
            self.refuse("support", k, "fixed", f'found {fixed!r}, expected some of x y z, or "normal"')
        if fixed == "normal" and self.analysis == "nonlinear":
            self.refuse("support", k, "fixed", 'found "normal", expected some of x y z in a nonlinear run')
        value = support.get("value", 0 if fixed == "normal" else [0, 0, 0])
        if np.shape(value) not in (((), (1,), (3,)) if fixed == "normal" else ((3,),)) or not np.issubdtype(
            np.array(value).dtype, np.number
        ):
            self.refuse(
                "support", k, "value", f"found {value!r}, expected {'a number' if fixed == 'normal' else '3 numbers'}"
            )
        if not SURFACE & support.keys():
            self.refuse("support", k, "name", f"no choice of surface; expected some of {', '.join(sorted(SURFACE))}")

    def _check_load(self, k, load):
        actions = [key for key in LOAD_KINDS if key in load]
        if len(actions) != 1:
            self.refuse(
                "load",
                k,
                actions[1] if actions else "name",
                f"found {len(actions)} of {', '.join(LOAD_KINDS)}, expected one",
            )
        inside = actions[0] in ("body_force", "acceleration")
        if inside == bool(SURFACE & load.keys()):
            self.refuse(
                "load",
                k,
                actions[0],
                (
                    "takes no choice of surface"
                    if inside
                    else f"no choice of surface; expected some of {', '.join(sorted(SURFACE))}"
                ),
            )
        if actions[0] == "acceleration" and not self.rho > 0:
            self.refuse("load", k, "acceleration", "needs rho in [material]")
        if actions[0] == "pressure" and self.analysis == "nonlinear" and load.get("follower", True):
            self.refuse(
                "load",
                k,
                "follower" if "follower" in load else "pressure",
                "a pressure that follows the surface: Kratos' load "
                "condition keeps its direction; write follower = false, or run igasolve",
            )

    def frame(self, kind, number):
        """Columns: the axes of a table's frame."""
        table = self.data[kind][number]
        if "rotation" in table:
            frame = np.array(table["rotation"], float).reshape(3, 3)
            if not np.allclose(frame.T @ frame, np.eye(3), atol=1e-9) or np.linalg.det(frame) < 0:
                self.refuse(kind, number, "rotation", "is no rotation matrix")
            return frame
        if "rotate_axis_angle" in table:
            *axis, degrees = np.array(table["rotate_axis_angle"], float)
            x, y, z = np.array(axis) / np.linalg.norm(axis)
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            angle = np.radians(degrees)
            return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
        return np.eye(3)

    def points(self, kind, number, model):
        """Numbers of the model's surface points that a table's choice of surface holds."""
        table, names = self.data[kind][number], model.regions
        for region in (
            table["region"] if isinstance(table.get("region"), list) else [table["region"]] if "region" in table else []
        ):
            if region not in names and not (isinstance(region, int) and 0 <= region < len(names)):
                self.refuse(
                    kind,
                    number,
                    "region",
                    f"found {region!r}, expected one of {', '.join(names)} or a number below {len(names)}",
                )
        chosen = np.zeros(len(model.triangles), bool)
        for triangle, _, whole in chosen_pieces(
            table, model.vertices, model.triangles, model["/surface/region"], names, snap_length(model)
        ):
            if not whole:
                self.refuse(
                    kind,
                    number,
                    "box" if "box" in table else "plane",
                    f"cuts triangle {triangle} of the surface, whose part would need "
                    "quadrature points that the model does not have; choose by region (igaprep --region-angle), or let the "
                    "box or plane follow the surface's edges",
                )
            chosen[triangle] = True
        points = np.flatnonzero(chosen[model["/surface/quadrature/triangle"]])
        if not len(points):
            self.refuse(
                kind, number, next(iter(SURFACE & table.keys())), f"holds no surface; regions: {', '.join(names)}"
            )
        return points

