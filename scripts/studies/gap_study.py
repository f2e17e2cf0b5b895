#!/usr/bin/python3
"""Parts with gaps narrower than the functions reach: their first free frequencies beside 10-node tetrahedra.

  scripts/studies/gap_study.py                              all parts, p = 2, all span sizes: a quarter of an hour of one core
  scripts/studies/gap_study.py bracket --spans 20 14        one part, these span sizes
  scripts/studies/gap_study.py fork --degrees 1 2 3         other degrees
  scripts/studies/gap_study.py --stl-only                   writes the parts and ends

Parts: fork, bracket, slit, sheet (gap_parts.py). Every part is turned into a general position. Tetrahedra: Gmsh meshes the
outline, finer around the ends of slots, and extrudes it; CalculiX; two meshes tell how far the finer one, the reference, is
from its limit. Steel in kg, mm, ms: E = 210, nu = 0.3, rho = 7.85e-6; frequencies are angular, rad/ms. Errors are relative to
the reference: of each mode, and root mean square over all of them.

Writes into --output: each part as STL, study.json and every program's log; the tables are printed.
"""
import argparse
import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import gap_parts  # noqa: E402
from compare_fem import ComparisonError, program  # noqa: E402
from igatools import ROOT, calculix, tet_mesh  # noqa: E402
from igatools.measured_run import RunError, measured_report, measured_run  # noqa: E402
from igatools.stl import write_stl  # noqa: E402

MATERIAL = {"E": 210.0, "nu": 0.3, "rho": 7.85e-6}


def reference(part, options):
    """Runs of both meshes of tetrahedra, coarse to fine."""
    gmsh, ccx = program("gmsh", "gmsh"), program("ccx", "calculix-ccx")
    measure = lambda command, log, folder=None: measured_run(command, log, folder, 1)  # noqa: E731
    for number, (size, least, layers) in enumerate(part.meshes):
        name = f"{part.name}_tets_{number + 1}"
        nodes, tets, _ = part.prism.tetrahedra(gmsh, size, layers, options.output, f"{name}_mesh", measure, least)
        found, solving = calculix.solve(ccx, options.output, name, nodes, tets, MATERIAL, options.modes, measure)
        yield {"part": part.name, "method": "C3D10", "size": size, "least": least or size, "layers": layers,
               "unknowns": 3 * len(nodes), "omega": (2 * np.pi * np.array(found)).tolist(), "cpu_s": solving["cpu_s"]}


def splines(part, stl, degree, span, options):
    """One run of igaprep and igasolve eigen."""
    model = options.output / f"{part.name}_p{degree}_{span:g}.h5"
    quiet = ["--json", "--threads", 1]
    material = [word for key, value in MATERIAL.items() for word in (f"--{key}", value)]
    _, prepared = measured_report([options.bin / "igaprep", stl, "-o", model, "--degree", degree, "--span-size", span,
                                   "--force", *quiet], model.with_suffix(".igaprep.log"))
    solving, solved = measured_report([options.bin / "igasolve", "eigen", model, "--modes", options.modes, *quiet,
                                       *material], model.with_suffix(".igasolve.log"))
    if solved["rigid_modes"] != calculix.RIGID_MODES:
        raise RunError(f"{model.name}: {solved['rigid_modes']} rigid modes, expected {calculix.RIGID_MODES}")
    elastic = solved["frequencies"][calculix.RIGID_MODES:][:options.modes]
    return {"part": part.name, "method": f"p{degree}", "size": span, "unknowns": solved["unknowns"],
            "omega": (2 * np.pi * np.array(elastic)).tolist(), "cpu_s": solving["cpu_s"],
            **{key: prepared[key] for key in ("cells", "split_spans", "copied_functions", "components")}}


def table(part, runs, modes):
    """Markdown: the reference's frequencies, errors of all other runs."""
    best = np.array([run for run in runs if run["method"] == "C3D10"][-1]["omega"])
    lines = [f"## {part.name}: {part.what}", "",
             "| | unknowns | split spans | copied | " + " | ".join(str(k + 1) for k in range(modes)) + " | rms |",
             "|---|---|---|---|" + "---|" * (modes + 1)]
    for run in runs:
        omega = np.array(run["omega"])
        error = 100 * (omega / best - 1)
        label = f"{run['method']}, {run['size']:g} mm"
        copies = [str(run.get(key, "")) for key in ("split_spans", "copied_functions")]
        cells = [f"{w:.5g}" for w in omega] + [""] if (omega == best).all() else \
            [f"{e:+.2f} %" for e in error] + [f"{np.sqrt((error**2).mean()):.2f} %"]
        lines.append("| " + " | ".join([label, str(run["unknowns"]), *copies, *cells]) + " |")
    return "\n".join(lines) + "\n"


def parse(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"of {', '.join(gap_parts.PARTS)} [all]")
    parser.add_argument("--spans", type=float, nargs="+", metavar="H", help="span sizes [the part's own]")
    parser.add_argument("--degrees", type=int, nargs="+", default=[2], metavar="P", help="degrees of the splines [2]")
    parser.add_argument("--modes", type=int, default=6, help="elastic modes [6]")
    parser.add_argument("--output", type=Path, default=ROOT / "build/gap_study", help="folder [build/gap_study]")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of igaprep and igasolve")
    parser.add_argument("--reuse", action="store_true", help="take results that an earlier run left in --output")
    parser.add_argument("--stl-only", action="store_true", help="write the parts and end")
    options = parser.parse_args(words)
    if unknown := set(options.parts) - set(gap_parts.PARTS):
        parser.error(f"no part is called {', '.join(sorted(unknown))}; there are: {', '.join(gap_parts.PARTS)}")
    if options.modes < 1 or any(span <= 0 for span in options.spans or ()):
        parser.error("--modes and --spans must be positive")
    return options


def main(words=None):
    options = parse(words)
    options.output.mkdir(parents=True, exist_ok=True)
    options.output = options.output.resolve()
    store = options.output / "study.json"
    runs = json.loads(store.read_text()) if options.reuse and store.exists() else []

    def keep(run):
        runs.append(run)
        store.write_text(json.dumps(runs, indent=1))
        print(f"{run['part']:8} {run['method']:6} {run['size']:g} mm: {run['unknowns']} unknowns, {run['cpu_s']:.1f} s",
              file=sys.stderr, flush=True)

    try:
        for name in options.parts or gap_parts.PARTS:
            part = gap_parts.PARTS[name]()
            stl = options.output / f"{name}.stl"
            write_stl(stl, part.triangles())
            if options.stl_only:
                continue
            own = lambda: [run for run in runs if run["part"] == name and len(run["omega"]) == options.modes]  # noqa: E731
            if sum(run["method"] == "C3D10" for run in own()) < len(part.meshes):
                runs[:] = [run for run in runs if (run["part"], run["method"]) != (name, "C3D10")]
                for run in reference(part, options):
                    keep(run)
            for degree in options.degrees:
                for span in options.spans or part.spans:
                    if (f"p{degree}", span) not in [(run["method"], run["size"]) for run in own()]:
                        keep(splines(part, stl, degree, span, options))
            print(table(part, own(), options.modes), flush=True)
    except (ComparisonError, RunError, tet_mesh.MeshError, calculix.CalculixError) as error:
        print(f"gap_study.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
