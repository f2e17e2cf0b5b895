"""Vibration modes on finer and finer grids, until the estimated errors of their frequencies are below the tolerance.

A frequency that is computed lies above that of the solid in its facets. What the mode leaves of the equations tells by how much
(igasolve eigen): the frequency given is the computed one less that, and its error what the correction may leave."""
from dataclasses import dataclass, field

import numpy as np

from igatools import iga_model, iga_results
from igatools.driver import estimate, run_file
from igatools.driver.grids import GridRun

SPARE_MODES = 4       # beyond those asked for: modes may change places between grids


@dataclass
class Mode:
    frequency: float         # less its estimated error where the solution tells one
    computed: float          # on the finest grid
    error: float | None      # of `frequency`, relative
    order: float | None
    agreement: float | None  # with the mode of the grid before, 0 ... 1
    history: list = field(default_factory=list)  # frequencies on all grids on which it was recognised
    computed_history: list = field(default_factory=list)


def vertex_weights(model):
    """A third of the area of the triangles around each vertex."""
    corners = model["/surface/vertices"][model["/surface/triangles"]]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return np.bincount(model["/surface/triangles"].ravel(), np.repeat(area / 3, 3), len(model["/surface/vertices"]))


def modes_on_surface(model, results, report, count):
    """The first elastic modes of a grid at the vertices of the surface: frequencies as computed, errors that the modes themselves tell
    (None without), shapes (modes, vertices, 3), areas of the vertices."""
    elastic = results.elastic()[:count]
    shapes = np.array([results.field(model, results["/modes"][mode], model["/surface/vertex_cell"],
                                     model["/surface/vertex_parameters"]) for mode in elastic])
    own = np.array(report["error_estimate"])[elastic] if "error_estimate" in report else None
    return {"frequencies": results["/frequencies"][elastic], "own_errors": own, "shapes": shapes, "weights": vertex_weights(model)}


class ModesRun(GridRun):
    COMMAND, ANALYSIS = "modes", "eigen"
    PREP = (*GridRun.PREP, "--surface-rule", "reduced")  # igasolve makes it exact where supports act

    def __init__(self, programs, options):
        super().__init__(programs, options)
        self.modes, self.order = [], None
        if options.run:
            run_file.refuse_bodies(options.run, self.settings)
            run_file.refuse_without_material(options.run, self.settings, options.material)

    def solve(self, number, model, prep):
        o, name = self.options, f"modes_{number}.h5"
        words = ["eigen", *([o.run, "--model", model] if o.run else [model]), *o.material]
        inputs = [self.files.key_of(model.name), *(run_file.content(o.run, self.settings) if o.run else [])]
        count = ["--modes", o.modes + SPARE_MODES]
        report = self.files.made(name, "igasolve", words, inputs, o.modes, count)
        return name, report, self.files.command("igasolve", [*words, *count], name)

    def measure(self, grid):
        """Elastic modes at the vertices of the surface."""
        model, results = iga_model.read(grid.model), iga_results.read(grid.results)
        if self.order is None:
            self.order = estimate.reliable_order(self.options.degree, self.is_singular(model))
        grid.found = modes_on_surface(model, results, grid.report, self.options.modes + SPARE_MODES)

    def estimate(self):
        """Modes of the finest grid with their histories and errors."""
        grids = self.grids
        numbers, agreement = estimate.follow_modes([grid.found for grid in grids])
        self.modes = []
        for m, own_numbers in enumerate(numbers[:self.options.modes]):
            along = list(zip(grids[len(grids) - len(own_numbers):], own_numbers))
            sizes = [grid.span_size for grid, _ in along]
            computed = [float(grid.found["frequencies"][number]) for grid, number in along]
            own = grids[-1].found["own_errors"]
            values = computed if own is None else [value * (1 - float(grid.found["own_errors"][number]))
                                                   for value, (grid, number) in zip(computed, along)]
            told = estimate.error_of(sizes, values, self.order, None if own is None else float(own[m]))
            self.modes.append(Mode(values[-1], computed[-1], told.error, told.order,
                                   None if np.isnan(agreement[m]) else float(agreement[m]), values, computed))

    def errors(self):
        return [mode.error for mode in self.modes]

    def order_relied_on(self):
        return self.order

    def findings(self):
        report = self.grids[-1].report
        return {
            "frequencies": [mode.frequency for mode in self.modes], "errors": self.errors(),
            "computed": [mode.computed for mode in self.modes], "computed_histories": [mode.computed_history for mode in self.modes],
            "orders": [mode.order for mode in self.modes], "agreements": [mode.agreement for mode in self.modes],
            "histories": [mode.history for mode in self.modes], "rigid_modes": report["rigid_modes"],
            "complete": bool(report.get("sturm")) and report["sturm"]["expected"] == report["sturm"]["found"]}
