"""Analyses of a run file on finer and finer grids: buckling, heat, frequency response, random vibration, transients.

Their numbers are those of igasolve's report: buckling factors; temperatures at probes and power through surfaces; largest answers at
probes."""
import numpy as np

from igatools.driver import estimate, quantities, run_file, units
from igatools.driver.grids import GridRun
from igatools.driver.programs import Failed
from igatools.driver.quantities import Quantity

NEEDED = {"buckling": ("[[support]]", "support"), "heat": ("[[heat]]", "heat"), "harmonic": ("[damping]", "damping"),
          "random": ("[damping]", "damping"), "transient": ("[damping]", "damping")}


class AnalysisRun(GridRun):
    """A command of its analysis' name; `measured` says what is read off a report."""

    def __init__(self, programs, options):
        super().__init__(programs, options)
        self.COMMAND = self.ANALYSIS = options.command
        self.MEMORY = "static" if self.COMMAND == "heat" else "eigen"  # a bound on theirs
        self.entries, self.singular = [], False
        run_file.refuse_bodies(options.run, self.settings)
        run_file.refuse_without_material(options.run, self.settings, options.material)
        words, key = NEEDED[self.COMMAND]
        if key not in self.settings and not (self.COMMAND == "buckling" and self.settings.get("spring")):
            raise Failed(f"{options.run}: has no {words}, which igasolve {self.COMMAND} needs", 2)
        if self.COMMAND not in ("buckling", "heat") and not self.settings.get("probe"):
            raise Failed(f"{options.run}: has no [[probe]], so there is no number to follow; add one, such as [[probe]] with name = \"tip\" "
                         "and position = [40, 5, 8]", 2)

    def solve(self, number, model, prep):
        name, o = f"{self.COMMAND}_{number}.h5", self.options
        words = [self.COMMAND, o.run, "--model", model, *o.material]
        report = self.files.made(name, "igasolve", words, [self.files.key_of(model.name), *run_file.content(o.run, self.settings)])
        return name, report, self.files.command("igasolve", words, name)

    def measure(self, grid):
        self.singular = self.is_singular(self.read_model(grid.model.name))
        system = units.SYSTEMS.get((grid.report.get("material") or {}).get("unit_system"))
        unit = lambda measure: units.symbol(system, measure, grid.prep["length_unit"])  # noqa: E731
        order = (self.options.degree, self.singular)
        if self.COMMAND == "buckling":
            found = [Quantity(f"factor {k}", "", value, estimate.reliable_order(*order)) for k, value in enumerate(grid.report["factors"], 1)]
            if not found:
                raise Failed(f"{self.options.run}: igasolve finds no buckling factor up to {grid.report['searched_within']:.4g}; are its loads "
                             "large enough, and do they press?", 4)
        elif self.COMMAND == "heat":
            found = list(heat_quantities(grid.report["heat"], estimate.displacement_order(*order), estimate.reliable_order(*order)))
        else:
            found = [quantity for probe in grid.report["probes"] for quantity in self.answers(probe, unit, order)]
        grid.found = {"quantities": found}

    def answers(self, probe, unit, order):
        """Of a probe: the largest motion relative to the base, acceleration and von Mises stress; root mean squares of noise."""
        rms = self.COMMAND == "random"
        size = (lambda key: float(np.linalg.norm(probe[key]))) if rms else lambda key: probe[key]["value"]
        what = "rms" if rms else "largest"
        moving, stress = estimate.displacement_order(*order), estimate.stress_order(*order)
        yield Quantity(f"{what} displacement at {probe['name']}", unit("length"), size("relative"), moving, kind="displacement")
        yield Quantity(f"{what} acceleration at {probe['name']}", unit("acceleration"), size("acceleration"), moving)
        yield Quantity(f"{what} von Mises at {probe['name']}", unit("stress"), probe["von_mises"] if rms else size("von_mises"), stress,
                       kind="stress")

    def estimate(self):
        self.entries = quantities.follow(self.grids)

    def errors(self):
        return quantities.errors_that_count(self.entries)

    def order_relied_on(self):
        return estimate.reliable_order(self.options.degree, self.singular)

    def findings(self):
        return {"quantities": self.entries, "run_file": str(self.options.run)}


def heat_quantities(heat, at_probe, of_power):
    """Errors of temperatures are relative to their number, whatever the zero of the scale."""
    for boundary in heat["boundaries"]:
        if boundary["kind"] in ("temperature", "convection"):
            yield Quantity(f"power through {boundary['name']}", "", boundary["power"], of_power)
        if boundary["kind"] != "temperature":
            yield Quantity(f"mean temperature of {boundary['name']}", "", boundary["temperature"], at_probe)
    for probe in heat["probes"]:
        yield Quantity(f"temperature at {probe['name']}", "", probe["temperature"], at_probe)
