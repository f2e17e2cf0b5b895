"""Displacements and stresses under loads on finer and finer grids, until their estimated errors are below the tolerance."""
import numpy as np

from igatools import iga_model, iga_results
from igatools.driver import estimate, loads, quantities, run_file, singular, units
from igatools.driver.grids import GridRun
from igatools.whole_file import write_text
from igatools.driver.programs import Failed
from igatools.driver.quantities import Quantity

NO_FORCE = 1e-6  # of the largest force: what a line or a point carries below it is not felt


class StaticRun(GridRun):
    COMMAND = ANALYSIS = "static"

    def __init__(self, programs, options):
        super().__init__(programs, options)
        self.run_path, self.entries, self.singular = options.run, [], False
        if options.run:
            run_file.refuse_bodies(options.run, self.settings)
            run_file.refuse_without_material(options.run, self.settings, options.material)
            run_file.refuse_without_loads(options.run, self.settings)

    def begin(self):
        """The run file of supports and loads that the command line gives."""
        if self.options.run:
            return
        model = self.read_model("model_first.h5")
        system = units.of_run(self.options, model.attribute("/", "length_unit"))
        self.run_path = self.options.output / "loads.toml"
        write_text(self.run_path, loads.run_text(self.options, model, system))
        self.settings = run_file.read(self.run_path)

    def solve(self, number, model, prep):
        name = f"static_{number}.h5"
        words = ["static", self.run_path, "--model", model, *self.options.material]
        report = self.files.made(name, "igasolve", words, [self.files.key_of(model.name), *run_file.content(self.run_path, self.settings)])
        return name, report, self.files.command("igasolve", words, name)

    def measure(self, grid):
        model, results = iga_model.read(grid.model), iga_results.read(grid.results)
        self.singular = self.is_singular(model)
        grid.found = {"quantities": [quantity for step, statics in enumerate(cases_of(grid.report))
                                     for quantity in self.quantities_of(grid, results, step, statics)]}

    def quantities_of(self, grid, results, step, statics):
        """Of one load case; their names begin with its own where there are several."""
        system = self.system(grid)
        unit = lambda measure: units.symbol(system, measure, grid.prep["length_unit"])  # noqa: E731
        named = lambda what: f"{statics['case']}: {what}" if statics.get("case") else what  # noqa: E731
        order = (self.options.degree, self.singular)
        concentrated = concentrated_force(statics)
        surface, displacement = results["/surface/vertices"], results["/surface/displacement"][step]
        size = np.linalg.norm(displacement, axis=1)
        mises = results["/surface/von_mises"][step]
        yield Quantity(named("strain energy"), unit("energy"), statics["strain_energy"], estimate.reliable_order(*order),
                       no_limit=concentrated, from_solution=statics.get("error_estimate", {}).get("strain_energy"))
        yield Quantity(named("largest displacement"), unit("length"), float(size.max()), estimate.largest_order(*order),
                       kind="displacement", no_limit=concentrated, note=f"at {loads.in_words(surface[size.argmax()])}")
        yield Quantity(named("largest von Mises"), unit("stress"), float(mises.max()), estimate.stress_order(*order), kind="stress",
                       no_limit=self.no_stress_at(surface[mises.argmax()], grid, statics.get("no_limit_beside")),
                       note=f"at {loads.in_words(surface[mises.argmax()])}")
        for probe in statics["probes"]:
            at = np.array(probe["position"])
            beside = probe.get("no_limit_beside")
            yield Quantity(named(f"displacement at {probe['name']}"), unit("length"), float(np.linalg.norm(probe["displacement"])),
                           estimate.displacement_order(*order), kind="displacement",
                           no_limit=f"{beside} acts on a line or at a point nearby" if beside else None)
            yield Quantity(named(f"von Mises at {probe['name']}"), unit("stress"), probe["von_mises"], estimate.stress_order(*order),
                           kind="stress", no_limit=self.no_stress_at(at, grid, beside))

    def no_stress_at(self, at, grid, beside):
        """Why a stress there depends on the span size, if it does."""
        if beside:
            return f"{beside} acts on a line or at a point nearby"
        for what, lines in self.singular_lines.items():
            far = singular.distance(at, lines)
            if far < singular.NEAR_SPANS * grid.span_size:
                where = f"at {what}" if far < 1e-6 * grid.span_size else f"{far:.3g} from {what}, within two spans"
                return f"{loads.in_words(at)} lies {where}; stress rises there as spans shrink"
        return None

    def system(self, grid):
        """Unit system of the report, where it is known."""
        return units.SYSTEMS.get((grid.report.get("material") or {}).get("unit_system"))

    def estimate(self):
        self.entries = quantities.follow(self.grids)

    def errors(self):
        return quantities.errors_that_count(self.entries)

    def order_relied_on(self):
        return estimate.reliable_order(self.options.degree, self.singular)

    def mass(self):
        density = (self.material() or {}).get("rho")
        return density * self.grids[-1].prep["volume"] if density else None

    def findings(self):
        cases = cases_of(self.grids[-1].report)
        forces = lambda kind: [entry | ({"name": f"{statics['case']}: {entry['name']}"} if statics.get("case") else {})  # noqa: E731
                               for statics in cases for entry in statics[kind]]
        balance = max((statics["force_balance"] for statics in cases), key=np.linalg.norm)
        return {"quantities": self.entries, "run_file": str(self.run_path), "supports": forces("supports"), "loads": forces("loads"),
                "force_balance": balance}


def cases_of(report):
    """The load cases of a report of igasolve static; of a run without [[case]] the one that there is."""
    return report.get("cases") or [report["statics"]]


def concentrated_force(statics):
    """Why energy and displacement have no limit: a force along a line or at a point gives way without bound."""
    everything = statics["supports"] + statics["loads"]
    largest = max(np.linalg.norm(entry["force"]) for entry in everything)
    for kind, entries in (("support", statics["supports"]), ("load", statics["loads"])):
        for entry in entries:
            if (entry["area"] == 0 and entry.get("kind") not in ("body force", "acceleration")
                    and np.linalg.norm(entry["force"]) > NO_FORCE * largest):
                return f"{kind} '{entry['name']}' acts on a line or at a point, where the part gives way without bound as spans shrink"
    return None


def refuse_doubled(options):
    """A run file, or supports and loads on the command line."""
    typed = [f"--{name}" for name in ("fix", "force", "pressure", "gravity", "probe") if getattr(options, name)]
    if options.run and typed:
        raise Failed(f"--run and {', '.join(typed)} are both given; put all into the run file", 2)
    if options.run:
        return
    if not options.fix:
        raise Failed(f'no support; give --fix "face 12" or a run file with [[support]] tables (--run); '
                     f"{loads.where_names(options.part)}", 2)
    if not (options.force or options.pressure or options.gravity):
        raise Failed('no load; give --force "face 3=0,0,-1000", --pressure "face 3=0.5", --gravity "0,0,-1 g" or a run file (--run)', 2)
