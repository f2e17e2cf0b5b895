#!/usr/bin/python3
"""Trimmed splines against standard finite elements: the first elastic frequencies of the same free part, side by side.

  scripts/studies/compare_fem.py                            the foam part, all sizes: takes a quarter of an hour on one core
  scripts/studies/compare_fem.py --quick                    coarse sizes alone, in seconds
  scripts/studies/compare_fem.py part.stl --spans 5 3 --linear-sizes 4 2 --quadratic-sizes 6 4 stl --E 210e3 --nu 0.3 --rho 7.85e-9
  scripts/studies/compare_fem.py --only fem; scripts/studies/compare_fem.py --reuse fem      in two parts: the second reads the first

Finite elements: Gmsh meshes the STL (classified, parametrised, meshed anew with each target size; the size `stl` keeps the
STL's own triangles, so that the mesh is exactly the STL's polyhedron), CalculiX solves 4-node (C3D4) and 10-node (C3D10)
tetrahedra with SPOOLES and ARPACK. Trimmed splines: igaprep and igasolve eigen, as computed and less the errors that the modes
themselves tell (methods p2c, p3c …). Every program runs on --threads cores.
Errors are relative to the finest 10-node solution. Units are the user's; the defaults are a rigid polypropylene foam of
60 g/l in t-mm-s units: E = 20 N/mm^2, nu = 0.3, rho = 6e-11 t/mm^3, frequencies in Hz.

Writes into --output: frequencies.csv, comparison.json, comparison.png (as Fig. 12 of the paper), and every program's log.
"""
import argparse
import hashlib
import json
import platform
import shlex
import shutil
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import comparison_report  # noqa: E402
from igatools import ROOT, calculix, tet_mesh  # noqa: E402
from igatools.measured_run import RunError, measured_report, measured_run  # noqa: E402
from igatools.stl import read_stl  # noqa: E402
from igatools.whole_file import write_text  # noqa: E402

QUICK = {"linear_sizes": ["28", "20"], "quadratic_sizes": ["28", "20"], "spans": [28.0], "degrees": [2]}
SAMPLES_PER_SIZE = 6  # spacing of the STL's samples in a search for closest points, per target size


class ComparisonError(Exception):
    """A program is missing, or was asked for what it cannot do."""


def program(name, package, hint=None):
    path = shutil.which(name)
    if path is None:
        raise ComparisonError(f"{name} is missing; " + (f"install it: apt-get install {package}" if package else hint))
    return path


# ---------------------------------------------------------------------------------------------------------- the two ways

class FiniteElements:
    """Runs with Gmsh and CalculiX; both element types of one size share the mesh and the time of meshing."""

    def __init__(self, options):
        self.options = options
        self.gmsh, self.ccx = program("gmsh", "gmsh"), program("ccx", "calculix-ccx")
        self.triangles, self.meshes = read_stl(options.stl), {}

    def run(self, kind, size):
        options, name = self.options, f"{kind}_{size}"
        measure = lambda command, log, folder=None: measured_run(command, log, folder, options.threads)  # noqa: E731
        if size not in self.meshes:
            self.meshes[size] = tet_mesh.run_gmsh(self.gmsh, options.stl, None if size == "stl" else float(size),
                                                  options.output, f"mesh_{size}", measure)
        nodes, tets, meshing = self.meshes[size]
        start = time.perf_counter(), time.process_time()
        if kind == "C3D10":
            surface = None if size == "stl" else tet_mesh.Surface(self.triangles, float(size) / SAMPLES_PER_SIZE)
            nodes, tets = tet_mesh.quadratic_tets(nodes, tets, surface)
        volume = tet_mesh.curved_volume(nodes, tets) if kind == "C3D10" else tet_mesh.volumes(nodes, tets).sum()
        wall, cpu = time.perf_counter() - start[0], time.process_time() - start[1]
        frequencies, solving = calculix.solve(self.ccx, options.output, name, nodes, tets, options.material, options.modes,
                                              measure)
        return {"method": kind, "size": size, "points": len(tets) * calculix.POINTS_PER_TET[tets.shape[1]],
                "elements": len(tets), "unknowns": 3 * len(nodes), "volume": volume, "frequencies": frequencies,
                "prep_wall_s": meshing["wall_s"] + wall, "solve_wall_s": solving["wall_s"],
                "prep_cpu_s": meshing["cpu_s"] + cpu, "solve_cpu_s": solving["cpu_s"],
                "prep_memory_mib": meshing["memory_mib"], "solve_memory_mib": solving["memory_mib"]}


class TrimmedSplines:
    """Runs with igaprep and igasolve."""

    def __init__(self, options):
        self.options = options
        built = "build it: cmake --build --preset release --target igaprep igasolve"
        self.igaprep, self.igasolve = (program(options.bin / tool, None, built) for tool in ("igaprep", "igasolve"))

    def run(self, degree, span):
        options, name = self.options, f"p{degree}_{span:g}"
        model, material = options.output / f"{name}.h5", options.material
        threads = ["--threads", options.threads]
        preparing, prepared = self._report([self.igaprep, options.stl, "-o", model, "--degree", degree, "--span-size", span,
                                            "--force", "--json", *threads, *options.igaprep], f"{name}.igaprep")
        solving, solved = self._report([self.igasolve, "eigen", model, "--E", material["E"], "--nu", material["nu"], "--rho",
                                        material["rho"], "--modes", options.modes, "--json", *threads, *options.igasolve],
                                       f"{name}.igasolve")
        elastic = solved["frequencies"][solved["rigid_modes"]:][:options.modes]
        if solved["rigid_modes"] != calculix.RIGID_MODES or len(elastic) != options.modes:
            raise RunError(f"igasolve found {solved['rigid_modes']} rigid and {len(elastic)} elastic modes, expected "
                           f"{calculix.RIGID_MODES} and {options.modes}")
        return {"method": f"p{degree}", "size": f"{span:g}", "points": prepared["points"],
                "elements": prepared["spans"]["interior"] + prepared["spans"]["trimmed"],
                "unknowns": solved.get("unknowns", 3 * prepared["functions"]), "volume": prepared["volume"],
                "frequencies": elastic, "corrected": self._corrected(solved), "prep_wall_s": preparing["wall_s"], "solve_wall_s": solving["wall_s"],
                "prep_cpu_s": preparing["cpu_s"], "solve_cpu_s": solving["cpu_s"],
                "prep_memory_mib": preparing["memory_mib"], "solve_memory_mib": solving["memory_mib"]}

    def _corrected(self, solved):
        """Frequencies less the errors that the modes themselves tell; None where igasolve tells none (degree 1)."""
        found = solved.get("corrected_frequencies")
        return found[solved["rigid_modes"]:][:self.options.modes] if found else None

    def _report(self, command, name):
        return measured_report(command, self.options.output / f"{name}.log", self.options.threads)


def with_corrected(results):
    """All runs, those of splines once more with their corrected frequencies, at the same cost: the methods p2c, p3c …"""
    both = []
    for run in results:
        both.append(run)
        if run.get("corrected"):
            both.append(run | {"method": run["method"] + "c", "frequencies": run["corrected"], "corrected": None})
    return both


def all_runs(options, stored):
    """Runs of both ways, coarse to fine, and how many failed; a result that may be reused is taken from `stored`."""
    results, failed = [], 0
    plan = [("fem", "C3D4", size) for size in options.linear_sizes]
    plan += [("fem", "C3D10", size) for size in options.quadratic_sizes]
    plan += [("iga", degree, span) for degree in options.degrees for span in options.spans]
    plan = [(way, kind, size, (kind if way == "fem" else f"p{kind}", size if way == "fem" else f"{size:g}"))
            for way, kind, size in plan if options.only in (None, way)]
    reused = {key for way, _, _, key in plan if options.reuse in (way, "all") and key in stored}
    makers = {way: (FiniteElements if way == "fem" else TrimmedSplines)(options)
              for way in {way for way, _, _, key in plan if key not in reused}}
    for way, kind, size, key in plan:
        if key in reused:
            results.append(stored[key] | {"reused": True})
            continue
        print(f"{key[0]:6} size {key[1]:>4} …", file=sys.stderr, flush=True)
        try:
            results.append(makers[way].run(kind, size) | {"reused": False})
        except (tet_mesh.MeshError, calculix.CalculixError, RunError) as error:
            failed += 1
            print(f"  left out: {error}", file=sys.stderr)
        write_json(options, results)
    return results, failed


# --------------------------------------------------------------------------------------------------- what is kept on disk

def conditions(options):
    """What two runs must share to stand in one table."""
    return {"stl_sha256": hashlib.sha256(options.stl.read_bytes()).hexdigest(), "material": options.material,
            "modes": options.modes, "threads": options.threads}


def stored_results(options):
    """Results of an earlier run with the same part, material, modes and threads, by method and size."""
    path = options.output / "comparison.json"
    if options.reuse is None or not path.exists():
        return {}
    earlier = json.loads(path.read_text())
    if earlier["conditions"] != conditions(options):
        raise ComparisonError(f"{path}: holds results for another part, material, number of modes or threads; "
                              "run without --reuse or choose another --output")
    return {(run["method"], run["size"]): run for run in earlier["runs"]}


def machine():
    """Processor's name as Linux tells it."""
    info = Path("/proc/cpuinfo")
    names = [line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")] \
        if info.exists() else []
    return names[0] if names else platform.processor() or platform.machine()


def write_json(options, results):
    write_text(options.output / "comparison.json",
               json.dumps({"conditions": conditions(options), "machine": machine(), "runs": results}, indent=1))


# ------------------------------------------------------------------------------------------------------ the command line

def parse(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("stl", type=Path, nargs="?", default=ROOT / "build/release/samples/foam_part.stl",
                        help="closed surface of one body [the foam part from the target sample_parts]")
    parser.add_argument("--output", type=Path, default=ROOT / "build/compare_fem", help="folder [build/compare_fem]")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of igaprep and igasolve")
    parser.add_argument("--linear-sizes", nargs="*", default=["14", "10", "7", "5", "stl"], metavar="H",
                        help="target sizes of 4-node tetrahedra, or stl")
    parser.add_argument("--quadratic-sizes", nargs="*", default=["28", "20", "14", "10", "7", "stl"], metavar="H",
                        help="target sizes of 10-node tetrahedra, or stl; the finest mesh is the reference")
    parser.add_argument("--spans", type=float, nargs="*", default=[20.0, 14.0, 10.0, 7.0], metavar="H", help="span sizes")
    parser.add_argument("--degrees", type=int, nargs="*", default=[2, 3], metavar="P", help="degrees of the splines")
    parser.add_argument("--modes", type=int, default=10, help="elastic modes [10]")
    parser.add_argument("--E", type=float, default=20.0, help="Young's modulus [20]")
    parser.add_argument("--nu", type=float, default=0.3, help="Poisson's ratio [0.3]")
    parser.add_argument("--rho", type=float, default=6e-11, help="density [6e-11]")
    parser.add_argument("--threads", type=int, default=1, help="threads of every program [1]")
    parser.add_argument("--igaprep", type=shlex.split, default=["--trimmed", "nnls", "--surface-rule", "reduced"], metavar="WORDS",
                        help="more words for igaprep, after a = [--trimmed nnls --surface-rule reduced, as iga modes: what one "
                             "solution of a free part wants]")
    parser.add_argument("--igasolve", type=shlex.split, default=["--no-sturm"], metavar="WORDS",
                        help="more words for igasolve eigen, after a = [--no-sturm: CalculiX proves no completeness either]")
    parser.add_argument("--only", choices=("fem", "iga"), help="one of the two ways alone")
    parser.add_argument("--reuse", choices=("fem", "iga", "all"), help="take these results from an earlier run's file")
    parser.add_argument("--quick", action="store_true", help="coarse sizes alone")
    options = parser.parse_args(words)
    if options.quick:
        vars(options).update(QUICK)
    options.material = {"E": options.E, "nu": options.nu, "rho": options.rho}
    for size in options.linear_sizes + options.quadratic_sizes:
        if size != "stl" and not (size.replace(".", "", 1).isdigit() and float(size) > 0):
            parser.error(f"size {size!r}: expected a positive length or stl")
    if options.modes < 1 or options.threads < 1 or any(span <= 0 for span in options.spans):
        parser.error("--modes, --threads and --spans must be positive")
    return options


def main(words=None):
    options = parse(words)
    try:
        if not options.stl.exists():
            raise ComparisonError(f"{options.stl}: no such file; the foam part comes from the target sample_parts")
        options.output.mkdir(parents=True, exist_ok=True)
        options.output = options.output.resolve()
        measured, failed = all_runs(options, stored_results(options))
        write_json(options, measured)
        results = with_corrected(measured)
        reference = comparison_report.finest_quadratic(results)
        if reference is None:
            print("no 10-node solution to compare with: frequencies alone are in comparison.json", file=sys.stderr)
            return 1 if failed else 0
        comparison_report.add_errors(results, reference)
        text = f"{options.stl.name}, {options.threads} thread(s) per program, {machine()}\n\n" \
            + comparison_report.tables(results, reference, comparison_report.richardson(results))
        print(text, end="")
        (options.output / "comparison.txt").write_text(text)
        comparison_report.write_csv(options.output / "frequencies.csv", results)
        comparison_report.draw(options.output / "comparison.png", results, reference)
        write_json(options, measured)
        return 1 if failed else 0
    except ComparisonError as error:
        print(f"compare_fem.py: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
