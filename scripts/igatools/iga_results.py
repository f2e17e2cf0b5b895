#!/usr/bin/python3
"""Independent reader of results files: h5py and numpy alone, held against schema/results.toml.

As a command:  scripts/igatools/iga_results.py modes.h5 [--json]   validates the file and prints what it says
As a module:   results = iga_results.read("modes.h5");  results["/frequencies"], results.elastic()
               results.field(model, coefficients, cells, parameters) with model = iga_model.read("part.h5")
               series = results.series("contact/plate")   the time series below that name
               step = results.fields(3);  step["cube/displacement"], step.mesh["cube/vertices"]   explicit runs
"""
import sys
from pathlib import Path

import h5py
import numpy as np

if not __package__:  # run by its path
    sys.path[0] = str(Path(__file__).resolve().parents[1])
from igatools import iga_schema  # noqa: E402
from igatools.iga_schema import FormatError, text_of  # noqa: E402

SCHEMA = iga_schema.load("results")
FIELDS = iga_schema.load("fields")
KINDS = {number: name for name, number in SCHEMA["enum"]["kind"].items()}
PARTS = {"eigen": "/eigen", "static": "/static", "buckling": "/buckling", "explicit": "/time_series", "heat": "/heat",
         "nonlinear": "/time_series", "harmonic": "/tables", "random": "/tables", "transient": "/tables"}


class Fields:
    """Fields of an explicit run at one time, or of several bodies in one mode or load step, by "<body>/<name>": displacement
    (vertices, 3), von_mises, strain (vertices), coefficients (functions, 3), plastic_strain (vertices) of laws that have it, point_stress (points, 6), point_plastic_strain (points) where asked for; `mesh` has vertices, triangles, …"""

    def __init__(self, path, mesh=None):
        with h5py.File(path, "r") as file:
            iga_schema.validate(file, FIELDS)
            self.time = float(file.attrs["time"]) if "time" in file.attrs else None
            self.data = {f"{name}/{key}": item[()] for name, group in file["bodies"].items() for key, item in group.items()}
        self.mesh = mesh

    def __getitem__(self, name):
        return self.data[name]

    def __contains__(self, name):
        return name in self.data


class Results:
    """A file's arrays under the names of their datasets: results["/frequencies"]; attributes by results.attribute()."""

    def __init__(self, path):
        self.path = Path(path)
        with h5py.File(path, "r") as file:
            self.symbols = iga_schema.validate(file, SCHEMA)
            self.analysis = text_of(file.attrs["analysis"])
            if PARTS.get(self.analysis) not in file:
                raise FormatError(f"/ attribute analysis: is {self.analysis!r}, expected one of {sorted(PARTS)} "
                                  "and the group that goes with it")
            self.attributes = {"/": dict(file.attrs)}
            self.data = {}
            file.visititems(self._keep)
        for names, group in (("/time_series/contact_names", "/time_series/contact"), ("/body_names", "/bodies"),
                             ("/table_names", "/tables"),
                             ("/time_series/body_names", "/time_series/body"),
                             ("/time_series/rigid_names", "/time_series/rigid"),
                             ("/time_series/support_names", "/time_series/support"),
                             ("/time_series/probe_names", "/time_series/probe")):
            for name in self.texts(names) if group in self else []:
                if f"{group}/{name}" not in self:
                    raise FormatError(f"{group}/{name}: is missing; expected a group")

    def _keep(self, name, item):
        if isinstance(item, h5py.Dataset):
            self.data["/" + name] = item[()]
        else:
            self.attributes["/" + name] = dict(item.attrs)

    def __getitem__(self, path):
        return self.data[path]

    def __contains__(self, path):
        return path in self.data or path in self.attributes

    def attribute(self, owner, name):
        value = self.attributes[owner][name]
        return text_of(value) if isinstance(value, (bytes, str)) else value

    def kinds(self):
        """RIGID, ELASTIC or MECHANISM for every mode."""
        return [KINDS[number] for number in self["/eigen/kind"]]

    def elastic(self):
        """Numbers (from 0) of the elastic modes, ascending in frequency."""
        return [mode for mode, kind in enumerate(self.kinds()) if kind == "ELASTIC"]

    def texts(self, path):
        return [text_of(value) for value in self[path]]

    def series(self, below):
        """Time series below /time_series/<below>, by name: series("rigid/sphere")["velocity"]."""
        start = f"/time_series/{below}/"
        return {path[len(start):]: values for path, values in self.data.items() if path.startswith(start)}

    def table(self, name):
        """A table of /tables as columns by name: table("probe tip")["displacement_x"]."""
        return dict(zip(self.texts(f"/tables/{name}/columns"), self[f"/tables/{name}/values"].T))

    def mean_force(self, contact, window):
        """Middles of the windows and the magnitude of a contact's mean force in each, from the impulse: no output rate
        matters."""
        time, impulse = self["/time_series/time"], self.series(f"contact/{contact}")["impulse"]
        edges = np.arange(0, time[-1] + 0.5 * window, window)
        means = np.diff([np.interp(edges, time, component) for component in impulse.T], axis=1) / window
        return 0.5 * (edges[1:] + edges[:-1]), np.linalg.norm(means, axis=0)

    def num_fields(self):
        return len(self["/fields/time"]) if "/fields/time" in self else 0

    def fields(self, step):
        """Fields of an explicit run, or of several bodies, at a step (from 0; -1 is the last one)."""
        folder = self.path.parent
        mesh = Fields(folder / self.attribute("/fields", "bodies_file"))
        return Fields(folder / self.texts("/fields/file")[step], mesh)

    def joined_surface(self):
        """Fields on the surface as one mesh, whether the file has one body or several: vertices (n, 3), triangles (m, 3), steps,
        displacement (steps, n, 3) and von_mises (steps, n), of one body von_mises_error and safety_factor too, each where it was asked for. None where there are no fields."""
        if "/surface" in self:
            names = ("vertices", "triangles", "steps", "displacement", "von_mises", "temperature", "von_mises_error", "safety_factor")
            return {name: self[f"/surface/{name}"] for name in names if f"/surface/{name}" in self}
        if not self.num_fields():
            return None
        bodies, steps = self.texts("/body_names"), [self.fields(step) for step in range(self.num_fields())]
        mesh = steps[0].mesh
        first = np.cumsum([0] + [len(mesh[f"{body}/vertices"]) for body in bodies])
        joined = {"vertices": np.concatenate([mesh[f"{body}/vertices"] for body in bodies]),
                  "triangles": np.concatenate([mesh[f"{body}/triangles"] + at for body, at in zip(bodies, first)]),
                  "steps": self["/fields/time"]}
        for name in ("displacement", "von_mises"):
            joined[name] = np.stack([np.concatenate([step[f"{body}/{name}"] for body in bodies]) for step in steps])
        return joined

    def envelope(self):
        """What several load cases do at most at each vertex of joined_surface(): displacement (n) and von_mises (n), and the numbers
        of the cases that they belong to, from 0: displacement_case, von_mises_case; of equal ones the first. None without cases."""
        if "/static/cases" not in self:
            return None
        surface = self.joined_surface()
        size = {"displacement": np.linalg.norm(surface["displacement"], axis=2), "von_mises": surface["von_mises"]}
        return {**{name: values.max(axis=0) for name, values in size.items()},
                **{f"{name}_case": values.argmax(axis=0) for name, values in size.items()}}

    def field(self, model, coefficients, cells, parameters):
        """u = sum N_i c_i at parameters (n, 3) of given cells (n): coefficients (n_f, 3) of this file, of the functions of the
        model that it was made from. Vertices of the surface lie in the cells "/surface/vertex_cell"."""
        return self.field_of(model, self["/functions/active"], coefficients, cells, parameters)

    def expect_model(self, model, active):
        if not np.array_equal(active, model["/functions/number"]):
            raise ValueError(f"{self.path}: these are results of another model")

    def field_of(self, model, active, coefficients, cells, parameters):
        """The same for one of several bodies; `active`: numbers of its functions, as the results have them."""
        self.expect_model(model, active)
        N = model.functions_at(model.cell_spans(cells), parameters)[1]
        return np.einsum("qi,qid->qd", N, coefficients[model["/cells/functions"][cells]])

    def gradient_of(self, model, coefficients, cells, parameters):
        """du_a / dx_b at parameters (n, 3) of cells (n): (n, 3, 3)."""
        dN = model.gradients_at(model.cell_spans(cells), parameters)
        return np.einsum("qib,qia->qab", dN, coefficients[model["/cells/functions"][cells]])


def read(path):
    """Results of a file that obeys schema/results.toml. Raises FormatError naming the path, what was found and expected."""
    return Results(path)


def summary(results):
    report = {"analysis": results.analysis, "title": results.attribute("/", "title"),
              "length_unit": results.attribute("/", "length_unit"), "model": results.attribute("/model", "file"),
              "functions": results.symbols["n_f"], "unknowns": int(results.attribute("/functions", "unknowns"))}
    if "/eigen" in results:
        report["frequencies"] = results["/frequencies"].tolist()
        report["kinds"] = results.kinds()
        report["largest_residual"] = float(results["/eigen/residual"].max(initial=0))
    if "/buckling" in results:
        report["factors"] = results["/buckling/factor"].tolist()
    if "/static" in results:
        report["strain_energy"] = float(results.attribute("/static", "strain_energy"))
        report["reactions"] = dict(zip(results.texts("/static/supports/name"),
                                       results["/static/supports/force"].tolist()))
        report["loads"] = dict(zip(results.texts("/static/loads/name"), results["/static/loads/force"].tolist()))
    if "/static/cases" in results:
        report["cases"] = results.texts("/static/cases/name")
    if "/heat" in results:
        report["powers"] = dict(zip(results.texts("/heat/boundaries/name"), results["/heat/boundaries/power"].tolist()))
    if "/time_series" in results:
        report["times"] = results["/time_series/time"].tolist()
        for name in results.texts("/time_series/contact_names"):
            force = np.linalg.norm(results[f"/time_series/contact/{name}/force"], axis=1)
            report.setdefault("peak_forces", {})[name] = float(force.max(initial=0))
    if "/tables" in results:
        report["tables"] = {name: len(results[f"/tables/{name}/values"]) for name in results.texts("/table_names")}
    if results.num_fields():
        report["fields"] = results.num_fields()
    if "/surface" in results:
        report["surface"] = {"vertices": results.symbols["n_vertices"], "steps": results.symbols["n_steps"]}
    return report


if __name__ == "__main__":
    sys.exit(iga_schema.report(__doc__, "results", "results file made by igasolve", lambda path: summary(read(path))))
