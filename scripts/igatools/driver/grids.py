"""What all commands of iga share: finer and finer grids of one part, until the estimated errors are below the tolerance, or until
memory or time would not do; files of earlier calls that still hold; the report."""
import time
from dataclasses import dataclass, field
from pathlib import Path

from igatools import iga_model
from igatools.driver import part, run_file, singular
from igatools.driver.output_files import OutputFiles
from igatools.driver.programs import RunError, Failed, free_memory_gib
from igatools.report.tables import percent

FEWEST = 2            # grids: no number counts that a second one does not bear out
REFINEMENT = 1.5      # span size over that of the next grid
MEMORY_SHARE = 0.8    # of what is free
HARD_LIMIT = 1.5      # of --max-time: a grid that was expected to fit in is stopped there; the first one always ends
LEAST_SECONDS, LEAST_MEMORY = 1.0, 200.0  # s, MiB: below them what every start costs counts too
GIB = 2**30
WORDS = {"in": "inches", "ft": "feet"}
MOST_MEMORY = 1024  # GiB: beyond it nobody wants to know how much


@dataclass
class Grid:
    """One grid and what was found on it."""
    span_size: float
    model: Path
    results: Path
    prep: dict    # report of igaprep
    report: dict  # of igasolve
    commands: list
    found: dict = field(default_factory=dict)  # the command's own

    @property
    def seconds(self):
        return self.prep["wall_seconds"] + self.report["wall_seconds"]


class GridRun:
    """A command; options: see `iga <command> --help`. Commands say how to solve() one grid, how to estimate(), what to report."""
    COMMAND = ANALYSIS = ""
    MEMORY = ""  # whose memory igasolve info tells for it; default: its analysis' own
    PREP = ("--trimmed", "nnls")
    # Time and memory go with powers of the number of spans along a side: those of a factor are 6 and 4 in the limit; that of the time
    # is 2.6 … 3.2 at 10 000 … 160 000 unknowns.
    TIME_POWER, MEMORY_POWER = 3.5, 4.0
    MOST_FIRST = 6000  # functions of the first grid, where thin walls want small spans: some seconds

    def __init__(self, programs, options):
        self.programs, self.options, self.progress = programs, options, programs.progress
        self.files = OutputFiles(programs, options)
        self.grids, self.notes = [], []
        self.settings = run_file.read(options.run) if options.run else {}
        self.interrupted = False
        self.started = time.monotonic()
        self.singular_lines = None

    # ------------------------------------------------------------------------------------------------ what commands bring

    def solve(self, number, model, prep):
        """Name of the results file, report of igasolve and its command line."""
        raise NotImplementedError

    def measure(self, grid):
        """Fills grid.found."""
        raise NotImplementedError

    def estimate(self):
        """Errors on the finest grid."""
        raise NotImplementedError

    def errors(self):
        """Relative errors that the tolerance is held against; None: not known."""
        raise NotImplementedError

    def findings(self):
        """Entries of the report that belong to the command."""
        raise NotImplementedError

    def begin(self):
        """Before the first grid, the coarse model "model_first.h5" is there."""

    # ------------------------------------------------------------------------------------------------------- the sequence

    def run(self):
        try:
            self.refine()
        except KeyboardInterrupt:
            if not self.grids:
                raise
            self.estimate()  # of what is done
            self.interrupted = True
            self.notes.append(f"interrupted: what stands here is that of the first {len(self.grids)} grids"
                              if len(self.grids) > 1 else "interrupted: what stands here is that of the first grid alone")
        self.programs.deadline = float("inf")  # what the report wants is not held against it
        return self.report()

    def refine(self):
        self.progress.begin("first look at the part")
        self.first = self.first_look()
        self.begin()
        size = self.first_size()
        chord = self.chord(size)
        while True:
            try:
                self.grids.append(self.next_grid(size, chord))
            except RunError as failure:
                if not self.grids or failure.code not in (2, 4):
                    raise
                self.notes.append(f"spans of {size:.4g} failed: {' '.join(str(failure).split())}")
                return
            self.programs.deadline = self.started + HARD_LIMIT * self.options.max_time
            self.estimate()
            self.tell()
            if self.is_good_enough():
                return
            size /= REFINEMENT
            if reason := self.no_room_for(size):
                self.notes.append(reason)
                return

    def first_size(self):
        side = longest_side(self.first)
        if self.options.span_size:
            if self.options.span_size > side:
                raise Failed(f"--span-size {self.options.span_size:g} is more than the longest side of {self.options.part}, {side:.4g}", 2)
            return self.options.span_size
        size, note = part.size(self.first, self.options.degree, self.MOST_FIRST)
        self.notes += [note] if note else []
        return size

    def first_look(self):
        """Report of a coarse model, in units that a material by name can have."""
        o, look = self.options, lambda: self.prepare("model_first.h5", "--spans", part.ALONG)
        found = look()
        unit = found["length_unit"]
        if not (o.material_name or self.ANALYSIS == "explicit" and not o.run) or unit in ("mm", "m"):
            return found
        if unit == "unspecified":
            raise Failed(f"{o.part} does not say its length unit, which a material by name, gravity and speeds need; give "
                         f"--length-unit mm (or m); its longest side is {longest_side(found):.4g}", 2)
        if not part.is_cad(o.part) or o.run or getattr(o, "probe", None) or o.length_unit or o.span_size:
            raise Failed(f"{o.part} is in {WORDS.get(unit, unit)}, in which no material has a name; give --length-unit mm and all "
                         "positions and sizes in mm (CAD files are converted; of other files --scale makes millimetres)", 2)
        o.length_unit = "mm"
        self.notes.append(f"{o.part} is in {WORDS.get(unit, unit)}; all lengths here are in mm")
        return look()

    def next_grid(self, size, chord):
        number = len(self.grids) + 1
        self.progress.begin(f"grid {number}, spans of {size:.4g}", self.expected_seconds(size))
        self.progress.stage("model")
        name = f"model_{number}.h5"
        words = ["--span-size", f"{size:.12g}", *chord]
        prep = self.prepare(name, *words)
        commands = [self.files.command("igaprep", self.files.prepare_words(*self.PREP, *words), name)]
        self.refuse_beyond_memory(name)
        self.progress.stage("solving")
        results, report, command = self.solve(number, self.options.output / name, prep)
        grid = Grid(size, self.options.output / name, self.options.output / results, prep, report, [*commands, command])
        self.progress.stage("reading results")
        self.measure(grid)
        return grid

    # -------------------------------------------------------------------------------------------------------------- limits

    def prepare(self, name, *words):
        return self.files.prepare(name, *self.PREP, *words)

    def chord(self, size):
        """One surface for all grids, the finer the smaller the tolerance: a thousandth of the first span at one per cent."""
        finer = min(1.0, max(0.1, (self.options.tolerance or 0.01) / 0.01))
        return ["--chord", f"{1e-3 * size * finer:.12g}"] if part.is_cad(self.options.part) else []

    def read_model(self, name):
        return iga_model.read(self.options.output / name)

    def refuse_beyond_memory(self, name):
        found = self.programs.run("igasolve", "info", self.options.output / name)
        need = found["memory_estimate"][f"{self.MEMORY or self.ANALYSIS}_bytes"] / GIB
        limit = self.options.memory or MEMORY_SHARE * free_memory_gib()
        if need > limit:
            raise Failed(f"igasolve would need {need:.2g} GiB, {limit:.2g} GiB may be used (--memory)", 2)

    def seen_power(self, values, least, usual, low, high):
        """The power of the number of spans along a side with which a cost went on the last two grids, within reason; the usual one where
        these are too cheap to tell."""
        if len(values) < 2 or min(values[-2:]) < least:
            return usual
        before, last = self.grids[-2:]
        return min(max(part.power(values[-1] / values[-2], before.span_size / last.span_size), usual - low), usual + high)

    def time_power(self):
        return self.seen_power([grid.seconds for grid in self.grids], LEAST_SECONDS, self.TIME_POWER, 1, 2)

    def memory_power(self):
        memory = [grid.report.get("peak_memory_mib", 0.0) for grid in self.grids]
        return self.seen_power(memory, LEAST_MEMORY, self.MEMORY_POWER, 1, 0)

    def expected_seconds(self, size):
        return self.grids[-1].seconds * (self.grids[-1].span_size / size) ** self.time_power() if self.grids else None

    def no_room_for(self, size):
        spent, more = time.monotonic() - self.started, self.expected_seconds(size)
        if spent + more <= self.options.max_time:
            return None
        return (f"spans of {size:.4g} would take about {more:.0f} s more, beyond --max-time {self.options.max_time:.0f} s "
                f"({spent:.0f} s are spent)")

    # ------------------------------------------------------------------------------------------------------- what came out

    def is_singular(self, model):
        """Has the part lines on which stress has no limit? Found once, on the surface that all grids share."""
        if self.singular_lines is None:
            self.singular_lines = {
                "a sharp re-entrant edge": singular.reentrant_edges(model["/surface/vertices"], model["/surface/triangles"]),
                "the end of a support": singular.support_ends(self.supports(), model)}
        return any(len(lines) for lines in self.singular_lines.values())

    def supports(self):
        return self.settings.get("support", [])

    def worst(self):
        errors = self.errors()
        return None if not errors or None in errors else max(errors)

    def is_good_enough(self):
        if len(self.grids) < FEWEST:
            return False
        if self.options.tolerance is None:
            return True
        worst = self.worst()
        return worst is not None and worst <= self.options.tolerance

    def reached(self):
        return not self.interrupted and (self.options.tolerance is None or self.is_good_enough())

    def tell(self):
        errors, grid = self.errors(), self.grids[-1]
        known = [error for error in errors if error is not None]
        words = percent(max(known)) if known else "not known yet" if len(self.grids) < 2 else "not known"
        if known and len(known) < len(errors):
            words += f" (of {len(errors) - len(known)} numbers not known)"
        self.progress.say(f"grid {len(self.grids)}: spans of {grid.span_size:.4g}, {self.unknowns(grid)} unknowns, "
                          f"{grid.seconds:.1f} s, largest estimated error {words}")

    def unknowns(self, grid):
        return grid.report["unknowns"]

    def needed(self, order):
        """What the tolerance would want, where it was not reached: a sentence, or None where nothing can be told."""
        worst = self.worst()
        if self.options.tolerance is None or not worst or worst <= self.options.tolerance:
            return None
        finer = (worst / self.options.tolerance) ** (1 / order)
        last, memory = self.grids[-1], self.peak_memory() / 1024 * finer ** self.memory_power()
        time_words = f"about {words_for_seconds(last.seconds * finer ** self.time_power())} and {memory:.2g} GiB for that grid alone"
        return (f"reached is an error of {percent(worst)}; {percent(self.options.tolerance)} would want spans of about "
                f"{last.span_size / finer:.2g}, " + (time_words if memory < MOST_MEMORY else "more than machines have"))

    def report(self):
        finest = self.grids[-1]
        if not self.reached() and (words := self.needed(self.order_relied_on())):
            self.notes.append(words)
        common = {
            "command": self.COMMAND, "part": str(self.options.part), "material": self.material(),
            "tolerance": self.options.tolerance, "reached": self.reached(), "interrupted": self.interrupted,
            "length_unit": finest.prep["length_unit"], "mass": self.mass(),
            "span_sizes": [grid.span_size for grid in self.grids], "unknowns": [self.unknowns(grid) for grid in self.grids],
            "grids": [{"span_size": grid.span_size, "unknowns": self.unknowns(grid), "seconds": grid.seconds,
                       "model": grid.model.name, "results": grid.results.name} for grid in self.grids],
            "seconds": time.monotonic() - self.started, "peak_memory": self.peak_memory(), "notes": self.notes,
            "findings": finest.report["findings"], "warnings": finest.report["warnings"],
            "model": finest.model.name, "results": finest.results.name, "commands": finest.commands,
            "order_relied_on": self.order_relied_on(), "reused_files": self.files.reused,
            "versions": {name: self.programs.version(name) for name in ("igaprep", "igasolve")}}
        return common | self.findings()

    def peak_memory(self):
        return max([self.programs.peak_memory_mib] + [grid.report.get("peak_memory_mib", 0.0) for grid in self.grids])

    def order_relied_on(self):
        raise NotImplementedError

    def material(self):
        return self.grids[-1].report.get("material")

    def mass(self):
        return self.grids[-1].report.get("mass")


def longest_side(first_look):
    return part.ALONG * min(first_look["grid"]["span_size"])


def words_for_seconds(seconds):
    if seconds < 120:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 7200 else f"{seconds / 3600:.0f} h"
