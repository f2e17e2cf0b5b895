"""What drop and impact share: a run of explicit dynamics on each grid, and what is read off its results."""
import json

import numpy as np

from igatools import iga_results
from igatools.driver import quantities, units
from igatools.driver.grids import GridRun
from igatools.whole_file import write_text
from igatools.driver.programs import Failed
from igatools.driver.quantities import Quantity

# That of contact, which begins and ends at single places of the surface; a lumped mass alone would give two.
ORDER = 1.0
LARGEST_ERROR = 0.5  # an estimate above it tells nothing but that the grids are too coarse


class ExplicitRun(GridRun):
    ANALYSIS = "explicit"
    PREP = ("--quadrature", "ggq-reduced", "--trimmed", "minimal", "--gap-ends", "glued")
    TIME_POWER, MEMORY_POWER = 4.0, 3.0
    MOST_FIRST = 1500

    def __init__(self, programs, options):
        super().__init__(programs, options)
        self.entries = []

    def refuse_beyond_memory(self, name):
        """Nothing is factorised: a run needs little more than its model file."""

    def explicit(self, name, text, inputs):
        """The report of igasolve for a run file of this text, which stays beside the results, and its command line."""
        words = self.words_for(name)
        write_text(words[1], text)
        try:
            report = self.files.made(name, "igasolve", words, [text, *inputs])
        except (KeyboardInterrupt, Failed):  # stopped from here
            self.remove(name)
            raise
        return report, self.files.command("igasolve", words, name)

    def holds(self, name, text, inputs):
        """Are the results of such a run there?"""
        return self.files.holds(name, "igasolve", self.words_for(name), [text, *inputs])

    def words_for(self, name):
        return ["explicit", self.options.output / name.replace(".h5", ".toml")]

    def remove(self, name):
        """Results of a run that was stopped half-way."""
        stem = name.removesuffix(".h5")
        for path in self.options.output.glob(f"{stem}*"):
            if path.is_file() and path.suffix in (".h5", ".pvd"):
                path.unlink()
        for folder in (f"{stem}_fields", f"{stem}_vtp"):
            for path in (self.options.output / folder).glob("*"):
                path.unlink()

    def unknowns(self, grid):
        return sum(body["unknowns"] for body in grid.report["bodies"])

    def quantity(self, name, measure, value, **more):
        """With the estimate of explicit runs."""
        unit = units.symbol(self.unit_system(), measure, self.first["length_unit"]) if measure else ""
        return Quantity(name, unit, float(value), ORDER, largest_error=LARGEST_ERROR, must_settle=True, **more)

    def unit_system(self):
        raise NotImplementedError

    def fields_of(self, results, body):
        """What the fields of a body say at most: deformation, displacement, von Mises, plastic strain."""
        most = {}
        for step in range(results.num_fields()):
            fields = results.fields(step)
            rest, u = fields.mesh[f"{body}/vertices"], fields[f"{body}/displacement"]
            found = {"deformation": np.linalg.norm(rest + u - moved_rigidly(rest, rest + u), axis=1).max(),
                     "displacement": np.linalg.norm(u, axis=1).max(), "von_mises": fields[f"{body}/von_mises"].max()}
            if f"{body}/plastic_strain" in fields:
                found["plastic_strain"] = fields[f"{body}/plastic_strain"].max()
            most = {key: max(value, most.get(key, 0.0)) for key, value in found.items()}
        return most

    def material_quantities(self, most):
        """Stress waits for a third grid: under an edge that hits the floor it has no limit, which two grids do not show."""
        found = [self.quantity("largest von Mises", "stress", most["von_mises"], fewest_grids=3, counts=False)]
        if "plastic_strain" in most:
            found.append(self.quantity("largest plastic strain", None, most["plastic_strain"], fewest_grids=3, counts=False))
        return found

    def estimate(self):
        self.entries = quantities.follow(self.grids)

    def errors(self):
        return quantities.errors_that_count(self.entries)

    def order_relied_on(self):
        return ORDER

    def findings(self):
        grid = self.grids[-1]
        results = iga_results.read(grid.results)
        table = self.options.output / f"{self.COMMAND}_energy.csv"
        self.programs.run("igasolve", "export", grid.results, "--csv", "--table", "energy", "-o", table, "--force")
        return {"quantities": self.entries, "energies": table.name,
                "energy_error": float(np.abs(results["/time_series/energy_error"]).max()),
                "ended_at": float(results["/time_series/time"][-1]), "run_file": grid.results.with_suffix(".toml").name}


def moved_rigidly(rest, now):
    """Where the vertices would be if the part had moved as a rigid body: the best fit (Kabsch 1976)."""
    centre, there = rest.mean(axis=0), now.mean(axis=0)
    left, _, right = np.linalg.svd((rest - centre).T @ (now - there))
    mirror = np.diag([1, 1, np.sign(np.linalg.det(left @ right))])
    return there + (rest - centre) @ left @ mirror @ right


def toml(header, /, **entries):
    """A table of a run file."""
    return "\n".join([header, *(f"{key} = {value_text(value)}" for key, value in entries.items())]) + "\n"


def value_text(value):
    """Of numbers with all their digits, texts, and lists."""
    if isinstance(value, (list, tuple, np.ndarray)):
        return "[" + ", ".join(value_text(entry) for entry in value) + "]"
    return json.dumps(value) if isinstance(value, (str, bool)) else f"{float(value):.15g}"
