"""The part in a run file of explicit dynamics: its model on finer and finer grids, all else as the user wrote it."""
import numpy as np

from igatools import iga_results
from igatools.driver import run_file, units
from igatools.driver.explicit import ExplicitRun
from igatools.driver.programs import Failed

WINDOWS = 60  # of the run: forces are averaged over one


class ImpactRun(ExplicitRun):
    COMMAND = "impact"

    def __init__(self, programs, options):
        super().__init__(programs, options)
        if options.material or options.friction is not None or options.yield_stress or options.end:
            raise Failed(f"material, friction and end stand in the run file ({options.run}); leave out what the command line says of "
                         "them", 2)
        self.body = chosen_body(options, self.settings)
        if not self.settings.get("time", {}).get("end"):
            raise Failed(f"{options.run}: has no [time] with an end", 2)
        if not self.settings.get("contacts") and not self.settings.get("loads") and not self.settings.get("supports"):
            raise Failed(f"{options.run}: has neither [[contacts]] nor [[loads]] nor [[supports]], so nothing acts on the part", 2)

    def unit_system(self):
        return units.SYSTEMS.get(self.settings.get("unit_system"))

    def solve(self, number, model, prep):
        name = f"impact_{number}.h5"
        text = run_file.elsewhere(self.options.run, self.settings, {self.body["model"]: model})
        report, command = self.explicit(name, text, [self.files.key_of(model.name), *run_file.content(self.options.run, self.settings)])
        return name, report, command

    def measure(self, grid):
        results = iga_results.read(grid.results)
        end, found = results["/time_series/time"][-1], []
        for contact in results.texts("/time_series/contact_names"):
            _, means = results.mean_force(contact, end / WINDOWS)
            found.append(self.quantity(f"peak force of {contact}", "force", means.max(initial=0),
                                       note=f"largest mean over {end / WINDOWS:.3g}"))
            depth = results.series(f"contact/{contact}")["depth"].max(initial=0)
            found.append(self.quantity(f"largest penetration of {contact}", "length", depth, counts=False,
                                       note="by which the surfaces overlap where they touch; small beside a span in a sound run"))
        name = self.body["name"]
        most = self.fields_of(results, name)
        series = results.series(f"body/{name}")
        found.append(self.quantity("largest displacement", "length", most["displacement"]))
        found.append(self.quantity("largest deformation", "length", most["deformation"],
                                   note="of a place of the surface against the part moved rigidly"))
        if "min_volume_ratio" in series:
            found.append(self.quantity("largest loss of volume", None, 1 - np.min(series["min_volume_ratio"]), counts=False,
                                       fewest_grids=3, note="share, at one point of the part"))
        grid.found = {"quantities": found + self.material_quantities(most)}

    def material(self):
        return None

    def mass(self):
        return next((body["mass"] for body in self.grids[-1].report["bodies"] if body["name"] == self.body["name"]), None)


def chosen_body(options, settings):
    """The [[bodies]] table whose model the part replaces."""
    bodies = settings.get("bodies", [])
    if not bodies:
        raise Failed(f"{options.run}: has no [[bodies]]; a run file of igasolve explicit has one for each deformable body", 2)
    names = [body.get("name", "") for body in bodies]
    if options.body is None and len(bodies) > 1:
        raise Failed(f"{options.run}: has the bodies {', '.join(names)}; say with --body which one {options.part} is", 2)
    if options.body is not None and options.body not in names:
        raise Failed(f"{options.run}: has no body '{options.body}'; it has {', '.join(names)}", 2)
    body = bodies[names.index(options.body) if options.body is not None else 0]
    if "model" not in body or "name" not in body:
        raise Failed(f"{options.run}: a [[bodies]] table wants name and model", 2)
    return body
