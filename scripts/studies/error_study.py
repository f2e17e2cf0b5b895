#!/usr/bin/python3
"""Estimated errors of free vibration modes held against true ones, on 37 parts.

  scripts/studies/error_study.py                          all parts: an hour of one core
  scripts/studies/error_study.py comb grille --modes 6    these parts
  scripts/studies/error_study.py --tables FOLDER          prints the tables of an earlier run

Every part is computed on grids of falling span size at p = 2, as `scripts/iga modes` does, and once at p = 3 with exact points on
a grid finer than the finest: the reference. Two estimates are held against it, and the larger of both:
  grids     from how the frequency changes from grid to grid (igatools.driver.estimate)
  residual  from what the mode leaves of the equations (igasolve eigen --errors), times a safety
Modes are paired with the reference's by shape. A true error counts where it is three times what the reference itself is
estimated to be off. Effectivity: estimated over true error. Writes study.json and the tables into --output.
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
from igatools.measured_run import RunError, report  # noqa: E402

MATERIAL = ["--E", 210, "--nu", 0.3, "--rho", 7.85e-6]
REFINEMENT = 1.5
SPARE = 4  # modes beyond those that are judged


def vertex_weights(model):
    corners = model["/surface/vertices"][model["/surface/triangles"]]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return np.bincount(model["/surface/triangles"].ravel(), np.repeat(area / 3, 3), len(model["/surface/vertices"]))


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
        prepared = self.prepare("model.h5", "--span-size", size, "--degree", degree, *self.chord, *words)
        results = self.folder / "modes.h5"
        solved = report([self.o.bin / "igasolve", "eigen", model, "--modes", self.o.modes + SPARE, "-o", results, "--force",
                         "--errors", *MATERIAL, "--json"])
        file, found = iga_model.read(model), iga_results.read(results)
        elastic = found.elastic()
        shapes = np.array([found.field(file, found["/modes"][mode], file["/surface/vertex_cell"],
                                       file["/surface/vertex_parameters"]) for mode in elastic])
        return {"size": size, "unknowns": solved["unknowns"], "frequencies": found["/frequencies"][elastic], "shapes": shapes,
                "residual": np.array(solved["error_estimate"])[elastic], "weights": vertex_weights(file), "file": file,
                "seconds": dict(solved["timings"]), "spans": prepared["grid"]["spans"]}

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
        chains = [[m] for m in range(len(finest["frequencies"]))]
        for level in range(len(grids) - 1, 0, -1):
            to_coarse, _ = estimate.pair_modes(grids[level - 1]["frequencies"], grids[level - 1]["shapes"],
                                               grids[level]["frequencies"], grids[level]["shapes"], grids[level]["weights"])
            for chain in chains:
                if len(chain) == len(grids) - level and to_coarse[chain[-1]] >= 0:
                    chain.append(to_coarse[chain[-1]])
        for m, chain in enumerate(chains[:self.o.modes]):
            if partner[m] < 0:
                continue
            values = [grids[-1 - k]["frequencies"][number] for k, number in enumerate(chain)][::-1]
            residuals = [grids[-1 - k]["residual"][number] for k, number in enumerate(chain)][::-1]
            sizes = [grid["size"] for grid in grids[len(grids) - len(chain):]]
            exact = reference["frequencies"][partner[m]]
            told = estimate.relative_error(sizes, values, order).error
            yield {"level": len(grids), "mode": m, "frequency": values[-1], "true": values[-1] / exact - 1,
                   "reference_error": reference["residual"][partner[m]], "grids": told, "residual": finest["residual"][m],
                   "sizes": sizes, "values": values, "residuals": residuals}


def effectivity(rows, key):
    """Coverage and the quartiles of estimated over true error, with the number of rows."""
    pairs = [(row[key], abs(row["true"])) for row in rows if row[key] is not None]
    if not pairs:
        return None
    told, true = np.array(pairs).T
    ratio = told / true
    return {"modes": len(ratio), "covered": float((ratio >= 1).mean()), "quartiles": np.quantile(ratio, (0.05, 0.25, 0.5, 0.75)).tolist()}


def table(studies):
    lines = ["part              kind        grids      order  modes  covered by grids / residual / larger, median effectivity of each"]
    everything = []
    for study in studies:
        rows = [dict(row) for row in study["modes"] if abs(row["true"]) > 3 * row["reference_error"]]
        for row in rows:
            row["larger"] = None if row["grids"] is None else max(row["grids"], row["residual"])
        everything += rows
        figures = [effectivity(rows, key) for key in ("grids", "residual", "larger")]
        cell = "  ".join("      -     " if f is None else f"{100 * f['covered']:4.0f} % {f['quartiles'][2]:5.2f}" for f in figures)
        lines.append(f"{study['part']:<17} {study['kind']:<11} {len(study['grids'])} to {study['grids'][-1]['unknowns']:<6} {study['order']:4.2f} {len(rows):5d}   {cell}")
    for key in ("grids", "residual", "larger"):
        f = effectivity(everything, key)
        if f:
            lines.append(f"all, {key:<9} {f['modes']:5d} modes, true error below the estimate in {100 * f['covered']:.1f} %, "
                         f"effectivity 5 % / quarter / median / three quarters: {' / '.join(f'{q:.2f}' for q in f['quartiles'])}")
    return "\n".join(lines) + "\n"


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", help="names (error_parts.py); default: all")
    parser.add_argument("--modes", type=int, default=10)
    parser.add_argument("--grids", type=int, default=4)
    parser.add_argument("--most-unknowns", type=int, default=10000, metavar="N", help="no finer grid beyond these at p = 2 [10000]")
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
        print(table(studies[-1:]).splitlines()[1], flush=True)
    print(table(studies), end="")


if __name__ == "__main__":
    main()
