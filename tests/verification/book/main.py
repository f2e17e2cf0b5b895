"""The command line of scripts/verify."""
import argparse
import os
import shutil
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from book import page
from book.case import BookError, chosen, read_cases
from book.run import Run
from igatools import ROOT
from igatools.measured_run import RunError
from igatools.whole_file import write_text

MISSED, USAGE, BROKEN, SKIPPED = 1, 2, 3, 77


@dataclass
class Outcome:
    """What the runs of a case gave; None where there was none."""
    case: object
    grids: list = field(default_factory=lambda: [None, None, None])  # of Found
    calculix: object = None
    faults: list = field(default_factory=list)                       # words of runs that failed
    triangles: object = None

    def missed(self):
        """Words for every quantity whose error at the finest grid is larger than claimed."""
        found = self.grids[-1]
        if found is None:
            return []
        return [f"{self.case.id}{', ' + q if q else ''}: error {100 * abs(self.case.error(q, v)):.3g} %, claimed "
                f"{100 * self.case.claimed(q):.3g} %" for q, v in found.values.items()
                if not abs(self.case.error(q, v)) <= self.case.claimed(q)]

    def order(self, quantity):
        """Slope of the error between the two finest grids over the span size; None where it cannot be told."""
        if None in self.grids[1:]:
            return None
        sizes = [np.atleast_1d(np.asarray(grid, object))[0] for grid in self.case.grids[1:]]
        errors = [abs(self.case.error(quantity, found.values[quantity])) for found in self.grids[1:]]
        if not all(isinstance(size, (int, float)) for size in sizes) or sizes[0] == sizes[1] or min(errors) < 1e-12:
            return None
        return float(np.log(errors[0] / errors[1]) / np.log(sizes[0] / sizes[1]))

    def beside_calculix(self, quantity):
        """Our error over CalculiX's at the number of unknowns nearest to its own, if within a factor of two; else None. Errors smaller
        than that of the exact value count as that."""
        if self.calculix is None:
            return None
        near = [found for found in self.grids if found is not None
                and 0.5 <= found.unknowns / max(1, self.calculix.unknowns) <= 2]
        if not near:
            return None
        ours = min(near, key=lambda found: abs(np.log(found.unknowns / self.calculix.unknowns)))
        found, theirs = (max(self.case.known, abs(self.case.error(quantity, run.values[quantity]))) for run in (ours, self.calculix))
        return found / theirs if theirs > 0 else None


@dataclass
class Found:
    values: dict
    unknowns: int
    seconds: float


def run_one(outcome, index, folder, programs):
    """A grid of a case, or CalculiX's run where index is None."""
    case = outcome.case
    run = Run(folder / case.id / ("calculix" if index is None else f"grid_{index + 1}"), programs)
    try:
        values = case.calculix(run) if index is None else case.function(run, case.grids[index])
        found = Found(case.checked(values), run.unknowns, run.seconds)
    except (RunError, BookError, OSError, ValueError, KeyError, IndexError, StopIteration) as error:
        words = f"{case.id}, {'CalculiX' if index is None else f'grid {index + 1}'}: {type(error).__name__}: {error}"
        outcome.faults.append(words)
        return words
    if index is None:
        outcome.calculix = found
    else:
        outcome.grids[index] = found
        outcome.triangles = run.triangles if outcome.triangles is None else outcome.triangles
    return None


def arguments_of(words, description):
    parser = argparse.ArgumentParser(prog="scripts/verify", description=description,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="cases or topics; none: all")
    parser.add_argument("--quick", action="store_true", help="only the cases that continuous integration runs")
    parser.add_argument("--calculix", choices=("with", "without", "only"), default="with",
                        help="runs by finite elements beside ours [with]; only: those alone, 77 where ccx or gmsh is missing")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of igaprep and igasolve")
    parser.add_argument("--output", type=Path, default=ROOT / "build/verification", help="folder of runs and page")
    parser.add_argument("--write", action="store_true", help="tables of whole topics into tests/verification/README.md")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="runs at a time, each on one thread [all cores]")
    parser.add_argument("--list", action="store_true", help="names of topics and cases; runs nothing")
    return parser.parse_args(words)


def run_all(outcomes, with_calculix, folder, programs, jobs):
    tasks = []
    for outcome in outcomes:
        if with_calculix != "only":
            tasks += [(outcome, index) for index in (2, 1, 0)]
        if with_calculix != "without" and outcome.case.calculix is not None:
            tasks.append((outcome, None))
    tasks.sort(key=lambda task: task[1] != 2 and task[1] is not None)  # long ones first
    with ThreadPoolExecutor(max(1, jobs)) as pool:
        for words in pool.map(lambda task: run_one(*task, folder, programs), tasks):
            if words:
                print(words, file=sys.stderr, flush=True)


def main(words, description):
    arguments = arguments_of(words, description)
    try:
        topics = read_cases()
        cases = chosen(topics, arguments.names, arguments.quick)
        if arguments.list:
            for topic, (heading, of_topic) in topics.items():
                print(f"{topic}: {heading}")
                for one in of_topic:
                    print(f"    {one.id:<28} {'quick  ' if one.quick else '       '}{one.title}")
            return 0
        if not cases:
            print(f"verify: none of the cases of {', '.join(arguments.names)} is a quick one; leave --quick out", file=sys.stderr)
            return SKIPPED
        if arguments.write and (arguments.quick or arguments.calculix == "only"):
            raise BookError("--write wants all cases of a topic with their own runs; leave --quick and --calculix only out")
    except BookError as error:
        print(f"verify: {error}", file=sys.stderr)
        return USAGE
    missing = [name for name in ("ccx", "gmsh") if shutil.which(name) is None]
    if missing and arguments.calculix != "without":
        print(f"verify: {' and '.join(missing)} missing (apt-get install calculix-ccx gmsh): no comparison with finite elements",
              file=sys.stderr)
        if arguments.calculix == "only":
            return SKIPPED
        arguments.calculix = "without"
    if arguments.calculix != "only":
        for tool in ("igaprep", "igasolve"):
            if shutil.which(arguments.bin / tool) is None:
                print(f"verify: {arguments.bin / tool} is missing; build it: cmake --build --preset release --target igaprep "
                      "igasolve, or give --bin", file=sys.stderr)
                return USAGE

    start = time.perf_counter()
    outcomes = [Outcome(one) for one in cases]
    run_all(outcomes, arguments.calculix, arguments.output / "runs", arguments.bin, arguments.jobs)
    print(page.text_table(outcomes))
    seconds = time.perf_counter() - start
    if arguments.calculix == "only":
        missed = [f"{outcome.case.id}: CalculiX's error in {q or 'its value'} is {100 * outcome.case.error(q, v):.3g} %"
                  for outcome in outcomes if outcome.calculix for q, v in outcome.calculix.values.items()
                  if abs(outcome.case.error(q, v)) > max(0.05, outcome.case.claimed(q))]
    else:
        missed = [line for outcome in outcomes for line in outcome.missed()]
        html = arguments.output / "index.html"
        write_text(html, page.html(topics, outcomes, seconds))
        print(f"\n{len(outcomes)} cases in {seconds:.0f} s; page: {html}")
        if arguments.write:
            for words in page.write_readme(topics, outcomes):
                print(words, file=sys.stderr)
    for line in missed:
        print(f"missed: {line}")
    if any(outcome.faults for outcome in outcomes):
        return BROKEN
    return MISSED if missed else 0
