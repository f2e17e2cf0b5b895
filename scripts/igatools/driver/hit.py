"""A part that hits a rigid wall: after a fall (drop) or with a given speed (impact --speed)."""
import time

import numpy as np

from igatools import iga_model, iga_results
from igatools.driver import run_file, units
from igatools.driver.explicit import ExplicitRun, toml
from igatools.driver.grids import REFINEMENT
from igatools.driver.programs import Failed

GAP = 0.01            # of a span, between part and wall at the start
FIRST_TRANSITS = 10   # times that a wave takes through the part: the first guess of what contact lasts
MOST_DOUBLINGS = 8
FREE_SHARE = 0.15     # of the run at its end without contact: the part has left
AFTER_CONTACT = 1.25  # of the time at which contact ended, for the later grids
FRICTION = 0.3
ROWS, FIELDS = 8, 30  # rows in the time over which forces are averaged; steps of fields


class HitRun(ExplicitRun):
    def __init__(self, programs, options):
        super().__init__(programs, options)
        self.COMMAND = options.command
        direction = np.array(options.direction.numbers)
        if not np.linalg.norm(direction) > 0:
            raise Failed("--direction 0,0,0 has no direction; give one such as 0,0,-1", 2)
        self.direction = direction / np.linalg.norm(direction)
        self.end = None  # of the run: as given, or known after the first grid
        self.has_left = False  # the wall until then

    def begin(self):
        unit, model = self.first["length_unit"], self.options.output / "model_first.h5"
        self.system = self.known_units(unit)
        self.found_material = self.programs.run("igasolve", "timestep", model, *self.options.material)["material"]
        E, rho = self.found_material["E"], self.found_material["rho"]
        vertices = iga_model.read(model)["/surface/vertices"]
        along, wave = vertices @ self.direction, np.sqrt(E / rho)
        self.transit, self.window = float(np.ptp(vertices, axis=0).max() / wave), float(np.ptp(along) / wave)
        sideways = vertices.mean(axis=0) - self.direction * vertices.mean(axis=0).dot(self.direction)
        self.touching = sideways + self.direction * along.max()
        self.gravity = units.STANDARD_GRAVITY / self.system.unit("acceleration") if self.options.command == "drop" else 0.0
        if self.options.command == "drop":
            self.speed = float(np.sqrt(2 * self.gravity * self.options.height.within(self.system)[0]))
        else:
            self.speed = self.options.speed.within(self.system)[0]
        self.end = self.options.end.within(self.system)[0] if self.options.end else None
        if not self.speed > 0:
            raise Failed("the part does not move; give a height or a speed above 0", 2)
        if not self.options.yield_stress:
            self.notes.append("the material stays elastic however large the stress; --yield-stress lets it yield")

    def known_units(self, length_unit):
        """Gravity and speeds need units."""
        o = self.options
        system = units.of_run(o, length_unit)
        if system is None:
            raise Failed("--E, --nu and --rho alone do not tell their units, which gravity and speed need; give --unit-system "
                         + ("t-mm-s (MPa, t/mm³) or kg-mm-ms (GPa, kg/mm³)" if length_unit == "mm" else "SI (Pa, kg/m³)"), 2)
        if system.symbol("length") != length_unit:
            raise Failed(f"--unit-system {system.name} has lengths in {system.symbol('length')}, {o.part} is in {length_unit}", 2)
        return system

    def unit_system(self):
        return self.system

    def run_text(self, model, size):
        m, d, o = self.found_material, self.direction, self.options
        law = {"law": "neo-hookean"}
        if o.yield_stress:
            hardening = o.hardening.within(self.system)[0] if o.hardening else 0.0
            law = {"law": "j2", "yield_stress": o.yield_stress.within(self.system)[0], "hardening_modulus": hardening}
        start = [f"# iga {o.command} {o.part.name}; units {self.system.name}: {self.system.symbol('length')}, "
                 f"{self.system.symbol('time')}, {self.system.symbol('force')}, {self.system.symbol('stress')}\n"]
        start += [f"gravity = [{', '.join(f'{x:.15g}' for x in self.gravity * d)}]\n"] if self.gravity else []
        friction = FRICTION if o.friction is None else o.friction
        return "\n".join([
            *start, toml("[[bodies]]", name="part", model=str(model.resolve()), velocity=self.speed * d),
            toml("[bodies.material]", **law, E=m["E"], nu=m["nu"], rho=m["rho"]),
            toml("[[rigid_bodies]]", name="floor", shape="plane", normal=0.0 - d, centre=self.touching + GAP * size * d),
            toml("[[contacts]]", bodies=["part", "floor"], friction=friction), toml("[time]", end=self.end),
            toml("[output]", interval=self.window / ROWS, field_interval=self.end / FIELDS,
                             viewer=o.viewer)])

    def solve(self, number, model, prep):
        name, size = f"{self.COMMAND}_{number}.h5", min(prep["grid"]["span_size"])
        if self.grids:
            report, command = self.hit(name, model, size)
        elif self.options.end:
            report, command = self.hit(name, model, size)
            self.has_left = self.released(name) is not None
        else:
            report, command = self.first_hit(name, model, size)
        return name, report, command

    def hit(self, name, model, size):
        return self.explicit(name, self.run_text(model, size), [self.files.key_of(model.name)])

    def first_hit(self, name, model, size):
        """Runs until the part has left the wall, each twice as long as the one before; then once until shortly after it, with the rows
        and fields that the later grids will have."""
        if self.kept_hit(name, model, size):
            return self.hit(name, model, size)
        self.end = FIRST_TRANSITS * self.transit
        for doublings in range(MOST_DOUBLINGS + 1):
            report, command = self.hit(name, model, size)
            released = self.released(name)
            if released is not None:
                self.has_left, self.end = True, AFTER_CONTACT * released
                return self.hit(name, model, size)
            if doublings == MOST_DOUBLINGS or self.no_time_for_double(report):
                break
            self.end *= 2
            self.progress.stage(f"still in contact, on to {self.end:.3g} {self.system.symbol('time')}")
        self.notes.append(f"the part has not left the floor at {self.end:.4g} {self.system.symbol('time')}, where the run ends; a larger "
                          "--max-time may follow it further, --end says how far")
        return report, command

    def kept_hit(self, name, model, size):
        """Does the run of an earlier call hold, which ended where the part had left?"""
        path = self.options.output / name.replace(".h5", ".toml")
        if not path.exists():
            return False
        self.end = run_file.read(path).get("time", {}).get("end", 0.0)
        if not self.holds(name, self.run_text(model, size), [self.files.key_of(model.name)]):
            return False
        self.has_left = self.released(name) is not None
        return self.has_left

    def no_time_for_double(self, report):
        """Twice the run, and then that on the next grid."""
        more = 2 * report["wall_seconds"] * (1 + REFINEMENT**self.TIME_POWER)
        return time.monotonic() - self.started + more > self.options.max_time

    def released(self, name):
        """Time of the last touch, where the part then moves away for good; None while it touches."""
        results = iga_results.read(self.options.output / name)
        moments = results["/time_series/time"]
        touching = np.flatnonzero(np.linalg.norm(results.series("contact/part-floor")["force"], axis=1) > 0)
        if not len(touching) or touching[-1] + 1 >= len(moments) or moments[touching[-1]] > (1 - FREE_SHARE) * moments[-1]:
            return None
        leaves = results.series("body/part")["momentum"][-1] @ self.direction < 0
        return float(moments[touching[-1] + 1]) if leaves else None

    def measure(self, grid):
        results = iga_results.read(grid.results)
        moments = results["/time_series/time"]
        contact, momentum = results.series("contact/part-floor"), results.series("body/part")["momentum"] @ self.direction
        touching = np.flatnonzero(np.linalg.norm(contact["force"], axis=1) > 0)
        if not len(touching):
            raise Failed(f"the part did not touch the floor until {moments[-1]:.4g} {self.system.symbol('time')}", 4)
        first, last = touching[0], touching[-1]
        _, means = results.mean_force("part-floor", self.window)
        mass = grid.report["bodies"][0]["mass"]
        speed = momentum / mass
        way = np.concatenate([[0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(moments))])
        most = self.fields_of(results, "part")
        symbol = self.system.symbol("time")
        found = [self.quantity("peak contact force", "force", means.max(),
                               note=f"largest mean over {self.window:.3g} {symbol}, in which a wave passes the part along its flight"),
                 self.quantity("stopping distance", "length", way.max() - GAP * min(grid.prep["grid"]["span_size"]),
                               note="of the centre of mass, from the first touch on"),
                 self.quantity("largest deformation", "length", most["deformation"],
                               note="of a place of the surface against the part moved rigidly")]
        if self.has_left:
            found += [self.quantity("first to last touch", "time", moments[last] - moments[first], counts=False),
                      self.quantity("rebound speed", "speed", -speed[-1], counts=False,
                                    note=f"of the centre of mass; {self.speed:.4g} {self.system.symbol('speed')} before")]
        grid.found = {"quantities": found + self.material_quantities(most)}

    def material(self):
        return self.found_material

    def mass(self):
        return self.grids[-1].report["bodies"][0]["mass"]

    def findings(self):
        return super().findings() | {"speed": self.speed, "direction": list(self.direction), "gravity": self.gravity}
