#!/usr/bin/python3
"""Estimated errors of free vibration modes held against true ones, on 37 parts.

  scripts/studies/error_study.py                          all parts: half an hour of one core
  scripts/studies/error_study.py comb grille --modes 6    these parts
  scripts/studies/error_study.py --tables FOLDER          prints the tables of an earlier run

Every part is computed on grids of falling span size at p = 2, as `scripts/iga modes` does, and once at p = 3 (at p = 2 on half the
spans where edges are sharp and re-entrant), with more moments: the reference. Held against it:
  grids     the computed frequency, its error from how it changes from grid to grid (igatools.driver.estimate)
  solution  the computed frequency, its error from what the mode leaves of the equations (igasolve eigen --errors), as it is
  given     what `scripts/iga modes` gives: the frequency less the solution's error, its own from both; where two grids know the mode
Modes are paired with the reference's by shape. A true error counts where the computed frequency is off by more than three times
what the reference is estimated to be off. Effectivity: estimated over true error. Writes study.json of every part into --output.
"""
import argparse
import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import error_parts  # noqa: E402
from igatools import ROOT, iga_model, iga_results  # noqa: E402
from igatools.driver import estimate, singular  # noqa: E402
from igatools.driver.modes import modes_on_surface  # noqa: E402
from igatools.measured_run import RunError, report  # noqa: E402

MATERIAL = ["--E", 210, "--nu", 0.3, "--rho", 7.85e-6]
REFINEMENT = 1.5
SPARE = 4  # modes beyond those that are judged


class PartStudy:
    def __init__(self, part, options):
        self.part, self.o = part, options
        self.folder = options.output / part.name
        self.folder.mkdir(parents=True, exist_ok=True)

    def prepare(self, name, *words):
        return report([self.o.bin / "igaprep", self.part.file, "-o", self.folder / name, "--trimmed", "nnls", "--repair",
                       "--length-unit", "mm", "--force", *words, "--json"])

    def solve(self, size, degree, *words):
        model = self.folder / "model.h5"
        self.prepare("model.h5", "--span-size", size, "--degree", degree, *self.chord, *words)
        results = self.folder / "modes.h5"
        solved = report([self.o.bin / "igasolve", "eigen", model, "--modes", self.o.modes + SPARE, "-o", results, "--force",
                         "--errors", *MATERIAL, "--json"])
        file = iga_model.read(model)
        return {"size": size, "unknowns": solved["unknowns"], "file": file, "seconds": dict(solved["timings"]),
                **modes_on_surface(file, iga_results.read(results), solved, self.o.modes + SPARE)}

    def run(self):
        self.chord = []
        first = min(self.prepare("model.h5", "--spans", 12)["grid"]["span_size"])
        self.chord = ["--chord", 1e-3 * first] if self.part.file.suffix == ".step" else []
        grids = []
        size = first
        while len(grids) < self.o.grids:
            grid = self.solve(size, 2)
            if grid["unknowns"] > self.o.most_unknowns and len(grids) >= 2:
                break
            grids.append(grid)
            if grid["unknowns"] > self.o.most_unknowns:
                break
            size /= REFINEMENT
        surface = grids[0]["file"]
        edges = singular.reentrant_edges(surface["/surface/vertices"], surface["/surface/triangles"])
        order = estimate.reliable_order(2, len(edges) > 0)
        # Where edges are sharp and re-entrant the degree does not help: a finer grid does.
        reference = self.solve(grids[-1]["size"] / 1.25, 3, "--moment-degree", 4) if order > 2 else \
            self.solve(grids[-1]["size"] / 2, 2, "--moment-degree", 4)
        return {"part": self.part.name, "kind": self.part.kind, "order": order, "reference_unknowns": reference["unknowns"],
                "reference_size": reference["size"],
                "grids": [{"size": g["size"], "unknowns": g["unknowns"], "seconds": g["seconds"]} for g in grids],
                "modes": [row for level in range(len(grids)) for row in self.judge(grids[:level + 1], reference, order)]}

    def judge(self, grids, reference, order):
        """The modes of the last grid, with the two estimates and the true error."""
        finest = grids[-1]
        partner, _ = estimate.pair_modes(reference["frequencies"], reference["shapes"], finest["frequencies"], finest["shapes"],
                                         finest["weights"])
        numbers, _ = estimate.follow_modes(grids)
        for m, own_numbers in enumerate(numbers[:self.o.modes]):
            if partner[m] < 0:
                continue
            along = list(zip(grids[len(grids) - len(own_numbers):], own_numbers))
            values, residuals = ([grid[key][number] for grid, number in along] for key in ("frequencies", "own_errors"))
            sizes = [grid["size"] for grid, _ in along]
            exact = reference["frequencies"][partner[m]]
            told = estimate.relative_error(sizes, values, order).error
            yield {"level": len(grids), "mode": m, "frequency": values[-1], "true": values[-1] / exact - 1,
                   "reference_error": reference["own_errors"][partner[m]], "grids": told, "residual": finest["own_errors"][m],
                   "sizes": sizes, "values": values, "residuals": residuals}


def estimates(row, order):
    """(estimated, true) errors of a mode on its finest grid, by the names of the docstring; relative, without sign."""
    found = {"solution": (row["residual"], abs(row["true"]))}
    if row["grids"] is not None:
        values = [value * (1 - own) for value, own in zip(row["values"], row["residuals"])]
        exact = row["frequency"] / (1 + row["true"])
        found["grids"] = row["grids"], abs(row["true"])
        found["given"] = estimate.error_of(row["sizes"], values, order, row["residual"]).error, abs(values[-1] / exact - 1)
    return found


def effectivity(rows, name):
    """Numbers of modes, share of covered ones, quartiles of estimated over true error, means of the true error; None without modes."""
    pairs = [row[name] for row in rows if name in row]
    if not pairs:
        return None
    told, true = np.array(pairs).T
    ratio = told / true
    return len(ratio), float((ratio >= 1).mean()), np.quantile(ratio, (0.05, 0.25, 0.5, 0.75)), true.mean()


NAMES = ("grids", "solution", "given")


def table(studies):
    lines = [f"{'part':<17} {'kind':<11} grids, unknowns  order  modes" + "".join(f"  {name:>13}" for name in NAMES),
             f"{'':<55}" + "  covered   med." * len(NAMES)]
    everything = {"smooth": [], "sharp re-entrant edges": []}
    for study in studies:
        rows = [estimates(row, study["order"]) for row in study["modes"] if abs(row["true"]) > 3 * row["reference_error"]]
        everything["smooth" if study["order"] > 2 else "sharp re-entrant edges"] += rows
        figures = [effectivity(rows, name) for name in NAMES]
        cells = "".join(f"  {'-':>13}" if f is None else f"  {100 * f[1]:4.0f} % {f[2][2]:6.2f}" for f in figures)
        grid = study["grids"][-1]
        lines.append(f"{study['part']:<17} {study['kind']:<11} {len(study['grids'])} to {grid['unknowns']:<10} {study['order']:5.2f} {len(rows):6d}{cells}")
    everything["all"] = [row for rows in everything.values() for row in rows]
    for kind, rows in everything.items():
        for name in NAMES:
            if f := effectivity(rows, name):
                lines.append(f"{kind}, {name}: {f[0]} modes, true error below the estimate in {100 * f[1]:.1f} %, effectivity 5 % / quarter / "
                             f"median / three quarters {' / '.join(f'{q:.2f}' for q in f[2])}, mean true error {100 * f[3]:.3f} %")
    return "\n".join(lines) + "\n"


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", help="names (error_parts.py); default: all")
    parser.add_argument("--modes", type=int, default=10)
    parser.add_argument("--grids", type=int, default=3)
    parser.add_argument("--most-unknowns", type=int, default=6000, metavar="N", help="no finer grid beyond these at p = 2 [6000]")
    parser.add_argument("--shared", type=Path, help="folder with stl/ and cases/ of given parts")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "build/error_study")
    parser.add_argument("--tables", type=Path, metavar="FOLDER")
    return parser.parse_args()


def main():
    o = parse()
    if o.tables:
        print(table([json.loads(file.read_text()) for file in sorted(o.tables.glob("*/study.json"))]), end="")
        return
    o.output.mkdir(parents=True, exist_ok=True)
    maker = o.bin / "make_cad_parts"
    parts = error_parts.make_parts(o.output, o.shared, maker if maker.exists() else None)
    unknown = set(o.parts) - {part.name for part in parts}
    if unknown:
        sys.exit(f"error_study: no part {', '.join(sorted(unknown))}; there are {', '.join(part.name for part in parts)}")
    studies = []
    for part in parts:
        if o.parts and part.name not in o.parts:
            continue
        try:
            studies.append(PartStudy(part, o).run())
        except RunError as error:
            print(f"{part.name}: {error}", file=sys.stderr, flush=True)
            continue
        (o.output / part.name / "study.json").write_text(json.dumps(studies[-1]))
        print(table(studies[-1:]).splitlines()[2], flush=True)
    print(table(studies), end="")


if __name__ == "__main__":
    main()
