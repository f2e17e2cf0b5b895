#!/usr/bin/python3
"""Solves a run file of igasolve with Kratos Multiphysics, on the same model:

  scripts/solve_kratos.py part.h5 run.toml -o results        writes results/run_kratos.h5
  scripts/render.py results/run_kratos.h5                    draws it, as igasolve's own
  scripts/render.py ours.h5 --minus results/run_kratos.h5    draws the difference

Geometry, elements, laws, supports in all three directions, loads and the assembly are those of Kratos; quadrature points, weights and
copies of functions are the model's. Supports of single directions are added to Kratos' matrix, and systems are solved by scipy.

  static     (default)        linear elastic, penalty supports, traction, pressure, force, body_force, acceleration
  eigen      ([eigen])        consistent mass, free or held
  nonlinear  ([nonlinear])    law = "st-venant-kirchhoff" or "neo-hookean", Newton's method, loads that keep their direction
  explicit   ([[bodies]])     one free body of these laws, start velocity and spin, gravity, loads over time; Kratos' central differences
                              in equal steps of [time] dt_max; the results hold the end, a table `energies` the way there

A key that Kratos cannot follow is refused with its line. Nothing is done about light functions: run igasolve with
--light-functions none to get the same numbers. Exit codes: 2 input that you can mend (Kratos missing as well), 3 a damaged model, 4 no
convergence. Needs `scripts/setup --kratos`, which makes build/kratos; IGA_KRATOS=folder names another virtual environment.
"""

import argparse
import json
import os
import sys
import time
from importlib import metadata, util
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def need_kratos():
    """Starts the script again in the virtual environment that has Kratos."""
    if util.find_spec("KratosMultiphysics") and util.find_spec("h5py") and util.find_spec("scipy"):
        return
    python = Path(os.environ.get("IGA_KRATOS", ROOT / "build" / "kratos")) / "bin" / "python"
    if not python.exists() or "IGA_KRATOS_STARTED" in os.environ:
        print(
            f"solve_kratos.py: Kratos Multiphysics is not installed in {python.parents[1]}; run scripts/setup --kratos, or name a virtual "
            "environment that has it by IGA_KRATOS",
            file=sys.stderr,
        )
        sys.exit(2)
    os.environ["IGA_KRATOS_STARTED"] = "1"
    os.execv(python, [str(python), *sys.argv])


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=Path, help="model file made by igaprep")
    parser.add_argument("run", type=Path, help="run file of igasolve; its `model` is not used")
    parser.add_argument("-o", "--output", type=Path, default=Path("."), help="folder of the results (default: here)")
    parser.add_argument(
        "--analysis", choices=("static", "eigen", "nonlinear", "explicit"), help="default: by the run file's tables"
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    return parser.parse_args()


def plain(value):
    """For JSON: arrays as lists."""
    return value.tolist() if hasattr(value, "tolist") else str(value)


def keep_kratos_quiet():
    """Kratos writes banners to standard output from C++: our own text goes to a copy of it, theirs nowhere. Errors are exceptions."""
    sys.stdout = os.fdopen(os.dup(1), "w", encoding="utf-8", buffering=1)
    with open(os.devnull, "w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 1)


def main():
    arguments = parse_arguments()
    keep_kratos_quiet()
    from igatools.kratos.explicit_run import open_run
    from igatools.kratos.run_file import RunError
    from igatools import FormatError, Model

    try:
        run = open_run(arguments.run, arguments.analysis)
        model = Model(arguments.model)
        solve(arguments, run, model)
    except RunError as error:
        fail(2, error)
    except FileNotFoundError:
        fail(2, f"{arguments.model}: no such file")
    except FormatError as error:
        fail(3, f"{arguments.model}: {error}")
    except OSError as error:
        fail(3, f"{arguments.model}: {error}")


def fail(code, error):
    print(f"solve_kratos.py: {error}", file=sys.stderr)
    sys.exit(code)


def solve(arguments, run, model):
    from igatools import foreign_results
    from igatools.kratos import analysis, explicit, stored_energy
    from igatools.kratos.body import Body

    version = metadata.version("KratosMultiphysics")
    say = (lambda text: None) if arguments.json else print
    start = time.perf_counter()
    body = Body(model, run.E, run.nu, run.law, steps=run.analysis == "explicit")
    try:
        if run.analysis == "explicit":
            fields = explicit.explicit(body, run, say)
        elif run.analysis == "nonlinear":
            fields = analysis.nonlinear(body, run, say)
        else:
            fields = {"static": analysis.static, "eigen": analysis.modes}[run.analysis](body, run)
    except (analysis.SolverError, analysis.reference.NumericalError) as error:
        fail(4, error)
    except analysis.reference.InputError as error:
        fail(2, error)
    seconds = time.perf_counter() - start
    C = analysis.reference.isotropic(run.E, run.nu)  # the order of shears does not matter
    law = None if run.law == "linear-elastic" else stored_energy.cauchy(run.law, run.E, run.nu)
    at = f", t = {run.steps * run.dt:.6g}" if run.analysis == "explicit" else ""
    title = f"{model.title} (Kratos{', ' + run.law if law else ''}{at})"
    arguments.output.mkdir(parents=True, exist_ok=True)
    path = arguments.output / f"{arguments.run.stem}_kratos.h5"
    foreign_results.write_results(
        path,
        model,
        fields,
        solver="Kratos Multiphysics",
        version=version,
        material=(C, run.rho),
        title=title,
        stress=law,
    )
    report(
        arguments,
        run,
        model,
        fields,
        {"solver": f"Kratos Multiphysics {version}", "seconds": seconds, "output": str(path)},
    )


def report(arguments, run, model, fields, about):
    if arguments.json:
        arrays = {"displacement", "modes"}
        print(json.dumps(about | {key: value for key, value in fields.items() if key not in arrays}, default=plain))
        return
    print(
        f"{about['solver']}: {run.analysis} of {model.title}, {3 * model.coefficients_from_unknowns().shape[1]} unknowns, "
        f"{about['seconds']:.1f} s; nothing done about light functions (igasolve --light-functions none)"
    )
    if run.analysis == "eigen":
        if run.loads:
            print(f"  loads are left out: {', '.join(run.name('load', k) for k in range(len(run.loads)))}")
        print(
            f"  {fields['rigid']} rigid modes; frequencies "
            + ", ".join(f"{value**0.5 / 6.283185307179586:.8g}" for value in fields["omega_squared"][fields["rigid"] :])
        )
    else:
        print(f"  strain energy {fields['strain_energy']:.12g}, external work {fields['external_work']:.12g}")
        for support in fields["supports"]:
            print(f"  support '{support['name']}': force {', '.join(f'{f:.8g}' for f in support['force'])}")
        for probe in fields["probes"]:
            print(f"  probe '{probe['name']}': displacement {', '.join(f'{u:.10g}' for u in probe['displacement'])}")
    print(f"wrote {about['output']}")


if __name__ == "__main__":
    if not {"-h", "--help"} & set(sys.argv):
        need_kratos()
    main()
