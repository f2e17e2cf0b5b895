"""What of a run file of igasolve explicit Kratos can do here: one free body, elastic laws, loads over time."""

from pathlib import Path

import numpy as np

from igatools.kratos.run_file import KEYS, RunError, RunFile, read_toml
from igatools.run_files import read_curve

ROOT = {"units", "unit_system", "gravity", "bodies", "loads", "time", "output"}
OF_BODY = {"model", "name", "material", "velocity", "spin", "spin_centre", "mass", "light_functions"}
OF_MATERIAL = {"law", "E", "nu", "rho"}
OF_LOADS = KEYS["load"] | {"body", "factor", "smooth"}
OF_TIME = {"end", "dt_max", "safety", "dt_min", "start_share", "hold", "growth"}  # with equal steps only the first two count


class ExplicitRun(RunFile):
    """As RunFile; velocity, spin (3), spin_centre (3) or None, dt, steps, rows (how many of the series). Gravity is the last load."""

    heads = {"material": "bodies.material", "load": "loads"}

    def __init__(self, path):
        self.path, (self.text, self.data) = Path(path), read_toml(path)
        self.analysis, self.supports, self.probes = "explicit", [], []
        self._only("", self.data, ROOT)
        self._read_body()
        self._read_material()
        self.loads = self.data["load"] = list(self.data.get("loads", []))
        self._check_numbers()
        self.factors = []
        for k, load in enumerate(self.loads):
            self._only("load", load, OF_LOADS, k)
            self._check_load(k, load)
            self.factors.append(self._curve(k, load))
        if "gravity" in self.data:
            self.loads.append({"name": "gravity", "acceleration": self._vector("", self.data, "gravity").tolist()})
            self.factors.append(([0.0], [1.0], False))
        self._read_time()

    def _only(self, table, found, keys, number=0):
        for key in found.keys() - keys:
            self.refuse(table, number, key, f"Kratos is not given this here, only {', '.join(sorted(keys))}; igasolve can do it")

    def _vector(self, table, found, key):
        value = np.array(found.get(key, np.zeros(3)))
        if value.shape != (3,) or value.dtype.kind not in "if":
            self.refuse(table, 0, key, f"found {found[key]!r}, expected 3 numbers")
        return value.astype(float)

    def _read_body(self):
        bodies = self.data.get("bodies", [])
        if len(bodies) != 1:
            raise RunError(f"{self.path}: lists {len(bodies)} bodies, expected one")
        body = bodies[0]
        self._only("bodies", body, OF_BODY)
        for key, only in (("light_functions", "none"), ("mass", "lumped")):
            if body.get(key, only) != only:
                self.refuse("bodies", 0, key, f'found "{body[key]}", expected "{only}": the others are igasolve\'s own')
        material = body.get("material")
        if not isinstance(material, dict):
            self.refuse("bodies", 0, "material", "expected a table with E, nu, rho")
        self.data["material"] = material
        self._only("material", material, OF_MATERIAL)
        self.model = self.path.parent / body["model"] if "model" in body else None
        self.velocity, self.spin = (self._vector("bodies", body, key) for key in ("velocity", "spin"))
        self.spin_centre = self._vector("bodies", body, "spin_centre") if "spin_centre" in body else None

    def _curve(self, k, load):
        """Times, factors, and whether smooth pieces join them."""
        factor = load.get("factor", 1.0)
        try:
            points = [(0.0, float(factor))] if isinstance(factor, (int, float)) else factor
            if isinstance(points, str):
                points = read_curve(self.path.parent / points)
            times, values = np.array(points, float).T
            if (np.diff(times) <= 0).any():
                raise ValueError("times do not ascend")
        except (ValueError, OSError) as error:
            self.refuse("load", k, "factor", f"is no curve of pairs [time, value]: {error}")
        return times, values, bool(load.get("smooth", False))

    def factor(self, k, time):
        """On the k-th load at a time; a curve keeps its end values."""
        times, values, smooth = self.factors[k]
        at = int(np.searchsorted(times, time, side="right")) - 1
        if at < 0 or at == len(times) - 1:
            return float(values[max(at, 0)])
        s = (time - times[at]) / (times[at + 1] - times[at])
        return float(values[at] + (s * s * (3 - 2 * s) if smooth else s) * (values[at + 1] - values[at]))

    def _read_time(self):
        time = self.data.get("time", {})
        self._only("time", time, OF_TIME)
        for key in ("end", "dt_max"):
            if not isinstance(time.get(key), (int, float)) or not time[key] > 0:
                self.refuse("time", 0, key, "expected a number above 0" + ("" if key == "end" else ": Kratos takes equal steps of this length"))
        interval = self.data.get("output", {}).get("interval", time["end"] / 1000)
        if not isinstance(interval, (int, float)) or not interval > 0:
            self.refuse("output", 0, "interval", f"found {interval!r}, expected a number above 0")
        self.steps = int(np.ceil(time["end"] / time["dt_max"] * (1 - 1e-9)))
        self.dt, self.rows = time["end"] / self.steps, max(1, round(time["end"] / interval))


def open_run(path, analysis=None):
    """RunFile, or ExplicitRun where that is asked for or the file lists bodies."""
    if analysis is None and "bodies" in read_toml(path)[1]:
        analysis = "explicit"
    return ExplicitRun(path) if analysis == "explicit" else RunFile(path, analysis)
