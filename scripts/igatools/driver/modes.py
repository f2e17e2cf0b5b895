"""iga modes: vibration modes on finer and finer grids, until the estimated errors are below the tolerance."""
import json
import time
from dataclasses import dataclass, field

import numpy as np

from igatools import iga_model, iga_results
from igatools.driver import estimate
from igatools.driver.programs import Failed, free_memory_gib

REFINEMENT = 1.5      # span size over that of the next grid
FIRST_SPANS = 12      # along the longest side
SPARE_MODES = 4       # beyond those asked for: modes may change places between grids
MEMORY_SHARE = 0.8    # of what is free
# Time of the next grid over that of the last: the factor's work grows like the sixth power of the number of spans along a side.
TIME_GROWTH = REFINEMENT**5


@dataclass
class Grid:
    """One grid with its elastic modes, at the vertices of the surface."""
    span_size: float
    model: object
    report: dict
    frequencies: np.ndarray
    shapes: np.ndarray  # (modes, vertices, 3)
    weights: np.ndarray  # (vertices), area
    seconds: float


@dataclass
class Mode:
    frequency: float
    error: float | None
    order: float | None
    agreement: float | None  # with the mode of the grid before, 0 ... 1
    history: list = field(default_factory=list)  # frequencies on all grids on which it was recognised


def vertex_weights(model):
    """A third of the area of the triangles around each vertex."""
    corners = model["/surface/vertices"][model["/surface/triangles"]]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return np.bincount(model["/surface/triangles"].ravel(), np.repeat(area / 3, 3), len(model["/surface/vertices"]))


class ModesRun:
    """Options: see `iga modes --help`."""

    def __init__(self, programs, options):
        self.programs, self.options = programs, options
        self.grids, self.modes, self.notes = [], [], []
        self.order = None  # that estimates rely on
        self.started = time.monotonic()

    def run(self):
        size = self.options.span_size or self.first_size()
        chord = self.chord(size)
        while True:
            try:
                self.grids.append(self.solve(size, chord))
            except Failed as failure:
                if not self.grids or failure.code not in (2, 4):
                    raise
                self.notes.append(f"spans of {size:.4g} failed: {failure}")
                break
            self.estimate()
            self.tell()
            if self.is_good_enough():
                break
            size /= REFINEMENT
            if reason := self.no_room_for(size):
                self.notes.append(reason)
                break
        return self.report()

    def prepare(self, name, *words):
        o = self.options
        unit = ["--length-unit", o.length_unit] if o.length_unit else []
        return self.programs.run("igaprep", o.part, "-o", o.output / name, "--degree", o.degree, "--trimmed", "nnls", *unit,
                                 *o.igaprep, *words)

    def first_size(self):
        """Spans for the first grid: a twelfth of the longest side, smaller where walls are thin."""
        report = self.prepare("model_first.h5", "--spans", FIRST_SPANS)
        size = min(report["grid"]["span_size"])
        wall = report.get("thinnest_wall")
        if wall and report["thin_wall_volume_share"] > 0.2:
            # Half as many spans as a thin wall wants across, if that is not too many in all.
            size = max(wall["thickness"], size / 2)
        return size

    def chord(self, size):
        """One surface for all grids, the finer the smaller the tolerance: a thousandth of the first span at one per cent."""
        name = str(self.options.part).lower()
        is_cad = name.endswith((".step", ".stp", ".iges", ".igs", ".brep", ".brp"))
        finer = min(1.0, max(0.1, (self.options.tolerance or 0.01) / 0.01))
        return ["--chord", 1e-3 * size * finer] if is_cad else []

    def solve(self, size, chord):
        o, number = self.options, len(self.grids) + 1
        begin = time.monotonic()
        name = o.output / f"model_{number}.h5"
        self.programs.say(f"grid {number}: spans of {size:.4g} …")
        self.prepare(name.name, "--span-size", size, *chord)
        self.refuse_beyond_memory(name)
        results = o.output / f"modes_{number}.h5"
        report = self.programs.run("igasolve", "eigen", *self.what_to_solve(name, number), "--modes", o.modes + SPARE_MODES,
                                   "-o", results, "--force", *o.material)
        model, found = iga_model.read(name), iga_results.read(results)
        if self.order is None:
            self.order = estimate.reliable_order(o.degree, model["/surface/vertices"], model["/surface/triangles"],
                                                 bool(report["supports"]))
        elastic = found.elastic()
        shapes = np.array([found.field(model, found["/modes"][mode], model["/surface/vertex_cell"],
                                       model["/surface/vertex_parameters"]) for mode in elastic])
        return Grid(size, name, report, found["/frequencies"][elastic], shapes, vertex_weights(model),
                    time.monotonic() - begin)

    def what_to_solve(self, model, number):
        """The model, or the user's run file with this model in the place of its own."""
        if not self.options.run:
            return [model]
        lines = [line for line in self.options.run.read_text().splitlines() if not line.startswith(("model =", "output ="))]
        run = self.options.output / f"run_{number}.toml"
        run.write_text("\n".join([f"model = {json.dumps(str(model.resolve()))}", *lines]) + "\n")
        return [run]

    def refuse_beyond_memory(self, model):
        need = self.programs.run("igasolve", "info", model)["memory_estimate"]["eigen_bytes"] / 2**30
        limit = self.options.memory or MEMORY_SHARE * free_memory_gib()
        if need > limit:
            raise Failed(f"igasolve would need {need:.2g} GiB, {limit:.2g} GiB may be used", 2)

    def estimate(self):
        """Modes of the finest grid with their histories and errors."""
        grids = self.grids
        chains = [[m] for m in range(len(grids[-1].frequencies))]  # mode numbers, finest first
        agreement = np.full(len(chains), np.nan)
        for level in range(len(grids) - 1, 0, -1):
            fine, coarse = grids[level], grids[level - 1]
            partner, likeness = estimate.pair_modes(coarse.frequencies, coarse.shapes, fine.frequencies, fine.shapes,
                                                    fine.weights)
            if level == len(grids) - 1:
                agreement = likeness
            for chain in chains:
                if len(chain) == len(grids) - level and partner[chain[-1]] >= 0:
                    chain.append(partner[chain[-1]])
        self.modes = []
        for m, chain in enumerate(chains[:self.options.modes]):
            values = [grids[-1 - k].frequencies[number] for k, number in enumerate(chain)][::-1]
            sizes = [grid.span_size for grid in grids[len(grids) - len(chain):]]
            told = estimate.relative_error(sizes, values, self.order)
            self.modes.append(Mode(values[-1], told.error, told.order, None if np.isnan(agreement[m]) else agreement[m], values))

    def worst(self):
        errors = [mode.error for mode in self.modes]
        return None if not errors or None in errors else max(errors)

    def is_good_enough(self):
        if self.options.tolerance is None:
            return len(self.grids) >= 2
        worst = self.worst()
        return worst is not None and worst <= self.options.tolerance

    def no_room_for(self, size):
        spent = time.monotonic() - self.started
        next_grid = TIME_GROWTH * self.grids[-1].seconds
        if spent + next_grid > self.options.max_time:
            return (f"spans of {size:.4g} would take about {next_grid:.0f} s more, beyond --max-time "
                    f"{self.options.max_time:.0f} s ({spent:.0f} s are spent)")
        return None

    def tell(self):
        worst = self.worst()
        grid = self.grids[-1]
        self.programs.say(f"  {grid.report['unknowns']} unknowns, {grid.seconds:.1f} s, largest estimated error "
                          + ("not known yet" if worst is None else f"{100 * worst:.2g} %"))

    def report(self):
        finest = self.grids[-1]
        return {
            "part": str(self.options.part), "frequencies": [mode.frequency for mode in self.modes],
            "errors": [mode.error for mode in self.modes], "orders": [mode.order for mode in self.modes],
            "agreements": [mode.agreement for mode in self.modes],
            "histories": [mode.history for mode in self.modes],
            "order_relied_on": self.order, "tolerance": self.options.tolerance,
            "reached": bool(self.options.tolerance is None or self.is_good_enough()),
            "rigid_modes": finest.report["rigid_modes"], "mass": finest.report["mass"],
            "length_unit": finest.report["length_unit"],
            "complete": bool(finest.report.get("sturm")) and
            finest.report["sturm"]["expected"] == finest.report["sturm"]["found"],
            "span_sizes": [grid.span_size for grid in self.grids],
            "unknowns": [grid.report["unknowns"] for grid in self.grids],
            "seconds": time.monotonic() - self.started, "peak_memory": self.programs.peak_memory_mib,
            "notes": self.notes, "findings": finest.report["findings"], "warnings": finest.report["warnings"],
            "model": str(finest.model), "results": str(self.options.output / f"modes_{len(self.grids)}.h5")}


def text(report):
    """For people."""
    lines = [f"part         {report['part']}",
             f"grids        spans of {', '.join(f'{h:.4g}' for h in report['span_sizes'])}; "
             f"{', '.join(map(str, report['unknowns']))} unknowns",
             f"modes        {report['rigid_modes']} rigid, {len(report['frequencies'])} elastic"
             + (", none missing (Sturm count)" if report["complete"] else ""), "",
             f"{'mode':>6}  {'frequency':>14}  {'error':>9}  {'order':>6}  {'shape':>6}"]
    for number, (f, e, q, a) in enumerate(zip(report["frequencies"], report["errors"], report["orders"],
                                              report["agreements"])):
        lines.append(f"{number + 1 + report['rigid_modes']:>6}  {f:>14.6g}  {'unknown' if e is None else f'{100 * e:.2g} %':>9}  "
                     f"{'' if q is None else f'{q:.1f}':>6}  {'' if a is None else f'{a:.2f}':>6}")
    lines += ["", "error   estimated distance from the limit of smaller and smaller spans, relative: from how the frequency",
              f"        changes from grid to grid, with order {report['order_relied_on']:.3g} relied on"
              + (" (sharp re-entrant edges or supports)" if report["order_relied_on"] < 2 else "") + ".",
              "        order: as observed; shape: how much of the mode is that of the grid before. Not in it: facets instead of the exact part, the material, the supports."]
    lines += [f"note         {note}" for note in report["notes"]]
    lines += [f"found        {finding}" for finding in report["findings"]]
    lines += [f"warning      {warning}" for warning in report["warnings"]]
    if not report["reached"]:
        lines.append(f"NOT REACHED  the tolerance of {100 * report['tolerance']:.3g} %")
    lines.append(f"time         {report['seconds']:.1f} s, {report['peak_memory']:.0f} MiB")
    lines.append(f"written      {report['results']}")
    return "\n".join(lines) + "\n"
