#!/usr/bin/python3
"""Which quadrature rules, when: points, preprocessing time, accuracy and rigid modes of igaprep's interior and trimmed rules.

  scripts/studies/rule_study.py errors                       turned cube and foam part, all rules, p = 2 and 3: an hour of one core
  scripts/studies/rule_study.py paper                        beside the paper's cube of 100 mm and foam part
  scripts/studies/rule_study.py large --rules ggq:minimal    80 and 160 spans along the foam part: time and memory
  scripts/studies/rule_study.py speed                        CPU time of the reduction a span, p = 2, 3, 4
  scripts/studies/rule_study.py rigid                        rigid modes of all shared test parts
  scripts/studies/rule_study.py own --part part.stl --spans 12 --degrees 2      all rules on a part of your own
  scripts/studies/rule_study.py errors --cases foam --grids '14 mm' --rules gauss:nnls ggq-reduced:minimal --reuse

Results are added to those in --output: study.json, study.csv and study.md with one table for each study, part and degree.
Errors are relative to exact frequencies (cube), to 10-node tetrahedra (foam part, samples/11_foam_modes_vs_fem), or, for a
part of your own, to gauss × nnls on the same grid. They hold for the consistent mass and igasolve's defaults; Δt for the
lumped one. Rigid modes are proved by igasolve's Sturm count, "not proved" where that was left out. The reduction's time is
the CPU time of igaprep less that of the same run with nnls: points taken out, rigidity shown. Frequencies in cycles per time.
The shared test parts are found by --shared or the variable IGA_SHARED_DIR.
"""
import argparse
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import rule_cases  # noqa: E402
import rule_report  # noqa: E402
from compare_fem import ComparisonError, machine, program  # noqa: E402
from igatools import ROOT  # noqa: E402
from igatools.measured_run import RunError, measured_report  # noqa: E402

KEY = ("study", "part", "degree", "grid", "interior", "trimmed")


class Runner:
    """igaprep, and igasolve where the case asks for it, on one rule at a time."""

    def __init__(self, options):
        self.options = options
        built = "build it: cmake --build --preset release --target igaprep igasolve make_parts sample_parts"
        self.igaprep, self.igasolve = (program(options.bin / tool, None, built) for tool in ("igaprep", "igasolve"))

    def run(self, case, interior, trimmed):
        """Figures of one run; under "failure" what went wrong."""
        found = {"part": case.part, "degree": case.degree, "grid": case.grid, "interior": interior, "trimmed": trimmed,
                 "exact": list(case.exact), "modes": case.modes}
        try:
            self._prepare(case, interior, trimmed, found)
            for analysis in case.analyses:
                getattr(self, "_" + analysis)(case, found)
        except RunError as error:
            found["failure"] = str(error)
        return found

    def _tool(self, name, *command):
        return measured_report([*command, "--json", "--threads", self.options.threads], self.options.output / f"{name}.log",
                               self.options.threads)

    def _prepare(self, case, interior, trimmed, found):
        measured, report = self._tool("igaprep", self.igaprep, case.stl, "-o", self.options.output / "model.h5", "--force",
                                      "--degree", case.degree, *case.words, "--quadrature", interior,
                                      *rule_cases.TRIMMED[trimmed])
        spans, timings = report["spans"], report["timings"]
        found |= {"spans_interior": spans["interior"], "spans_trimmed": spans["trimmed"], "points": report["points"],
                  "points_interior": report["points_interior"], "points_trimmed": report["points_trimmed"],
                  "points_per_trimmed_span": report["points_trimmed"] / max(spans["trimmed"], 1),
                  "stabilised_spans": report["stabilised_spans"], "max_residual": report["max_residual"],
                  "prep_cpu_s": measured["cpu_s"], "prep_wall_s": measured["wall_s"],
                  "prep_memory_mib": measured["memory_mib"]}
        found |= {f"stage_{stage.replace(' ', '_')}_s": seconds for stage, seconds in timings.items()}

    def _eigen(self, case, found):
        measured, report = self._tool("igasolve_eigen", self.igasolve, "eigen", self.options.output / "model.h5", *_words(case),
                                      "--modes", case.modes, *([] if case.sturm else ["--no-sturm"]))
        rigid = report["rigid_modes"] + report["mechanisms"]
        found |= {"bodies": report["bodies"], "rigid_modes": report["rigid_modes"], "mechanisms": report["mechanisms"],
                  "unknowns": report["unknowns"],
                  "frequencies": report["frequencies"][rigid:][:case.modes], "solve_cpu_s": measured["cpu_s"],
                  "solve_memory_mib": measured["memory_mib"]}
        if "sturm" in report:
            found |= {"sturm_expected": report["sturm"]["expected"], "sturm_found": report["sturm"]["found"]}

    def _timestep(self, case, found):
        _, report = self._tool("igasolve_timestep", self.igasolve, "timestep", self.options.output / "model.h5", *_words(case))
        found |= {"omega_max": report["omega_max"], "dt_crit": report["dt_crit"]}


def _words(case):
    return [word for name, value in case.material.items() for word in ("--" + name, value)]


def wanted(options):
    """(case, interior, trimmed) of the study, less what the options leave out."""
    for case in rule_cases.STUDIES[options.study](options):
        if not case.stl.exists():
            raise ComparisonError(f"{case.stl}: no such file; samples come from the target sample_parts, shared parts from "
                                  "--shared or IGA_SHARED_DIR")
        if (options.degrees and case.degree not in options.degrees) or (options.cases and not any(
                word in case.part for word in options.cases)) or (options.grids and case.grid not in options.grids):
            continue
        for interior, trimmed in case.rules:
            if not options.rules or f"{interior}:{trimmed}" in options.rules:
                yield case, interior, trimmed


def study(options):
    """All runs in the folder, the new ones included; how many of the new ones failed."""
    path, failed = options.output / "study.json", 0
    runs = {tuple(run[name] for name in KEY): run for run in json.loads(path.read_text())["runs"]} if path.exists() else {}
    runner = Runner(options)
    for case, interior, trimmed in wanted(options):
        key = (options.study, case.part, case.degree, case.grid, interior, trimmed)
        if options.reuse and key in runs:
            continue
        print(", ".join(map(str, key)) + " …", file=sys.stderr, flush=True)
        runs[key] = {"study": options.study} | runner.run(case, interior, trimmed)
        if "failure" in runs[key]:
            failed += 1
            print(f"  {runs[key]['failure']}", file=sys.stderr)
        path.write_text(json.dumps({"machine": machine(), "threads": options.threads, "runs": list(runs.values())}, indent=1))
    return list(runs.values()), failed


def parse(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("study", choices=rule_cases.STUDIES, help="what to run")
    parser.add_argument("--output", type=Path, default=ROOT / "build/rule_study", help="folder [build/rule_study]")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of igaprep, igasolve, make_parts")
    parser.add_argument("--samples", type=Path, default=ROOT / "build/release/samples", help="folder of the sample parts")
    parser.add_argument("--shared", type=Path, default=rule_cases.shared_parts(), help="folder of the shared test parts")
    parser.add_argument("--cases", nargs="+", metavar="WORD", help="only parts whose name has one of these words")
    parser.add_argument("--grids", nargs="+", metavar="GRID", help="only these grids, as the tables name them")
    parser.add_argument("--degrees", type=int, nargs="+", metavar="P", help="only these degrees [own: 2 3]")
    parser.add_argument("--rules", nargs="+", metavar="IN:TRIMMED",
                        help="only these, e.g. ggq:minimal gauss:nnls ggq-reduced:minimal+rank")
    parser.add_argument("--reuse", action="store_true", help="leave out runs that the folder holds")
    parser.add_argument("--threads", type=int, default=1, help="threads of every program [1]")
    part = parser.add_argument_group("own")
    part.add_argument("--part", type=Path, help="closed surface")
    part.add_argument("--spans", type=int, default=20, help="along the longest side [20]")
    part.add_argument("--span-size", type=float, help="length, in place of --spans")
    part.add_argument("--modes", type=int, default=10, help="elastic modes [10]")
    part.add_argument("--E", type=float, default=1.0, help="Young's modulus [1]")
    part.add_argument("--nu", type=float, default=0.3, help="Poisson's ratio [0.3]")
    part.add_argument("--rho", type=float, default=1.0, help="density [1]")
    options = parser.parse_args(words)
    if options.study == "own" and options.part is None:
        parser.error("own needs --part FILE")
    if options.threads < 1 or options.spans < 1 or options.modes < 2 or (options.span_size or 1) <= 0:
        parser.error("--threads, --spans and --span-size must be positive, --modes at least 2")
    known = {f"{interior}:{trimmed}" for interior, trimmed in rule_cases.every_rule(3)}
    if unknown := set(options.rules or []) - known:
        parser.error(f"--rules {' '.join(sorted(unknown))}: expected some of {' '.join(sorted(known))}")
    return options


def main(words=None):
    options = parse(words)
    try:
        options.output.mkdir(parents=True, exist_ok=True)
        options.output = options.output.resolve()
        runs, failed = study(options)
    except ComparisonError as error:
        print(f"rule_study.py: {error}", file=sys.stderr)
        return 2
    rule_report.complete(runs)
    rule_report.write_csv(options.output / "study.csv", runs)
    text = rule_report.markdown(runs)
    (options.output / "study.md").write_text(f"{machine()}, {options.threads} thread(s) per program\n\n{text}")
    print(rule_report.markdown([run for run in runs if run["study"] == options.study]))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
