"""Results for programs of your own: igatools.Results("modes.h5")."""
from functools import cached_property
from pathlib import Path

import numpy as np

from igatools import iga_results, vtk_files
from igatools.labels import Labels
from igatools.model import Model
from igatools.result_tables import result_tables
from igatools.tables import write_tables


def von_mises(stress):
    """Von Mises stress (n) of stresses (n, 6) in the order xx yy zz xy yz zx."""
    xx, yy, zz, xy, yz, zx = np.asarray(stress).T
    return np.sqrt(0.5 * ((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2) + 3 * (xy**2 + yz**2 + zx**2))


class Results(Labels, iga_results.Results):
    """Results of igasolve: modes, statics, or an explicit run.

        results = igatools.Results("modes.h5")
        results.frequencies                                 # cycles per time
        results.displacement([[1, 2, 3]], mode=6)           # of mode 6, counted from 0
        igatools.Results("static.h5").stress([[1, 2, 3]])   # xx yy zz xy yz zx
        igatools.Results("impact.h5").displacement(points, step=-1)
        results.to_vtk("mode.vtp", mode=6)                  # for ParaView

    Every dataset of the file is there under its path, as schema/README.md describes it: results["/static/probes/stress"]. Units
    are those of the analysis; lengths are in `length_unit`. Fields at points need the model: the file beside the results that
    they name, or `model`, a path or a Model (for several bodies a dictionary by their names).
    """

    def __init__(self, path, model=None):
        super().__init__(path)
        self._given = model

    @property
    def bodies(self):
        """Names of the bodies: list of str; empty where the run had one body without a name."""
        return self.texts("/body_names") if "/body_names" in self.data else []

    @property
    def frequencies(self):
        """Frequencies of all modes, rigid ones first: (n_modes), cycles per time."""
        self._expect("eigen", "frequencies")
        return self["/frequencies"]

    @property
    def times(self):
        """Times of the fields of an explicit run, or load factors of a nonlinear one, which `step` counts: (n_steps)."""
        if not self._has_steps():
            self._expect("explicit", "times")
        return self["/fields/time"] if self.num_fields() else np.zeros(0)

    @property
    def factors(self):
        """Factors on the loads at which the part buckles: (n_factors); positive ones, then negative ones, ascending in size."""
        self._expect("buckling", "buckling factors")
        return self["/buckling/factor"]

    @property
    def _shapes(self):
        return "/buckling/modes" if self.analysis == "buckling" else "/modes"

    def _has_steps(self):
        return self.analysis in ("explicit", "nonlinear")

    def _expect(self, analysis, what):
        if self.analysis != analysis:
            raise ValueError(f"{self.path}: holds the results of an analysis '{self.analysis}'; only '{analysis}' has {what}")

    @cached_property
    def _models(self):
        return {}

    def model(self, body=None):
        """The Model that the results, or those of one of several bodies, were computed on."""
        body = self._body(body)
        if body not in self._models:
            given = self._given.get(body) if isinstance(self._given, dict) else self._given
            if not isinstance(given, Model):
                name = self.attribute(f"/bodies/{body}" if body else "/model", "file")
                path = Path(given) if given else self.path.parent / name
                if not path.exists():
                    raise FileNotFoundError(f"{path}: no such file; {self.path} holds results of the model {name}: put it beside "
                                            "them, or say where it is: Results(path, model=...)")
                given = Model(path)
            self._models[body] = given
        return self._models[body]

    def _body(self, body):
        names = self.bodies
        if body is None and len(names) > 1 or body is not None and body not in names:
            raise ValueError(f"{self.path}: body is {body!r}, expected one of: {', '.join(names) or 'None (there is one body)'}")
        return names[0] if body is None and names else body

    def coefficients(self, mode=None, step=None, body=None):
        """Coefficients of the displacement, those of the model's functions: (n_functions, 3), length. `mode` counts the modes of
        an analysis 'eigen' or 'buckling' from 0, `step` the fields of an explicit run, from 0 or, below 0, from the last one."""
        return self._field(mode, step, body)[1]

    def _number(self, mode, step):
        """Number of the field that mode or step ask for; the one that belongs to another analysis must be left out."""
        asked = {"mode": mode, "step": step}
        wanted = {"eigen": "mode", "buckling": "mode", "explicit": "step", "nonlinear": "step"}.get(self.analysis)
        if {name for name, number in asked.items() if number is not None} != ({wanted} if wanted else set()):
            raise ValueError(f"{self.path}: results of an analysis '{self.analysis}', expected "
                             + (f"{wanted}=<number> and nothing else" if wanted else "neither mode nor step"))
        if self._has_steps() and not self.num_fields():
            raise ValueError(f"{self.path}: the run wrote no fields; set field_interval in [output] of the run file")
        count = self.num_fields() or (len(self[self._shapes]) if wanted else 1)
        number = asked[wanted] if wanted else 0
        if not -count <= number < count:
            raise IndexError(f"{self.path}: {wanted} is {number}, expected one of 0 … {count - 1}")
        return number

    def _field(self, mode, step, body):
        """Numbers of the functions, and their coefficients."""
        number, body = self._number(mode, step), self._body(body)
        if self.num_fields():
            fields = self.fields(number)
            return fields.mesh[f"{body}/active_functions"], fields[f"{body}/coefficients"]
        if self.analysis == "heat":
            raise ValueError(f"{self.path}: results of an analysis 'heat' hold temperatures, no displacements")
        return self["/functions/active"], self["/static/displacement"] if self.analysis == "static" else self[self._shapes][number]

    def displacement(self, points, mode=None, step=None, body=None):
        """Displacements at points of the undeformed solid: (n, 3), length; nan where a point lies outside it.

        points: (n, 3), length. Results of several bodies need the name of one, `body`; its points are in the frame of its model.
        The size of a mode means nothing.
        """
        cells, parameters = self.model(body).locate(points)
        found = np.full((len(cells), 3), np.nan)
        inside = cells >= 0
        found[inside] = self.displacement_in(cells[inside], parameters[inside], mode, step, body)
        return found

    def displacement_in(self, cells, parameters, mode=None, step=None, body=None):
        """Displacements (n, 3), length, in cells (n) of the model at parameters (n, 3)."""
        return self.field_of(self.model(body), *self._field(mode, step, body), cells, parameters)

    def strain(self, points, mode=None, body=None):
        """Small strains at points, (n, 6): xx yy zz xy yz zx, shear as angles (twice the tensor's); nan outside. Not of explicit
        runs, whose deformations are large: their fields hold strains on the surface, results.fields(step)."""
        if self._has_steps():
            raise ValueError(f"{self.path}: strains and stresses of explicit and nonlinear runs depend on what happened before; they are "
                             "stored, not evaluated: see results.fields(step)")
        model = self.model(body)
        cells, parameters = model.locate(points)
        active, coefficients = self._field(mode, None, body)
        self.expect_model(model, active)
        inside = cells >= 0
        gradient = self.gradient_of(model, coefficients, cells[inside], parameters[inside])
        found = np.full((len(cells), 6), np.nan)
        found[inside] = np.stack([gradient[:, a, b] + (gradient[:, b, a] if a != b else 0)
                                  for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))], 1)
        return found

    def stress(self, points, mode=None, body=None):
        """Stresses at points, (n, 6): xx yy zz xy yz zx, force/length^2; nan outside. Of statics and modes with one body.
        They are those of the displacements; at probes and on the surface of statics files hold recovered ones, which are better."""
        if len(self.bodies) > 1:
            raise ValueError(f"{self.path}: the file holds the material of one body only; stresses of several are not evaluated")
        if self.analysis == "static" and "initial_strain_work" in self.attributes["/static"]:
            raise ValueError(f"{self.path}: the file does not hold the thermal strain at any point; stresses at probes, quadrature points "
                             "and on the surface have it: results[\"/static/points/stress\"], results.surface()")
        return self.strain(points, mode, body) @ self.attribute("/material", "C").T

    def von_mises(self, points, mode=None, body=None):
        """Von Mises stresses at points: (n), force/length^2; as stress()."""
        return von_mises(self.stress(points, mode, body))

    def surface(self, mode=None, step=None, body=None):
        """The surface of the results: vertices (n, 3), length, triangles (m, 3), and a dictionary of its fields: displacement
        (n, 3), von_mises (n) and, where the file has them, strain (n, 6), stress (n, 6), von_mises_error and safety_factor (n)."""
        number, body = self._number(mode, step), self._body(body)
        if self.num_fields():
            fields = self.fields(number)
            found = {name: fields[f"{body}/{name}"] for name in ("displacement", "von_mises", "strain", "plastic_strain")
                     if f"{body}/{name}" in fields}
            return fields.mesh[f"{body}/vertices"], fields.mesh[f"{body}/triangles"], found
        if "/surface" not in self:
            raise ValueError(f"{self.path}: the analysis wrote no surface")
        found = {name: self[f"/surface/{name}"][number] for name in ("displacement", "von_mises", "strain", "stress", "temperature", "heat_flux",
                                                                     "von_mises_error", "safety_factor") if f"/surface/{name}" in self.data}
        return self["/surface/vertices"], self["/surface/triangles"], found

    def to_csv(self, folder, table=None):
        """Writes tables into a folder, as igasolve export does (frequencies.csv; reactions.csv, loads.csv, probes.csv,
        points.csv; energy.csv, contact_NAME.csv, body_NAME.csv, …); with `table` that one alone. Returns their paths."""
        return write_tables(result_tables(self), folder, table)

    def to_vtk(self, path, mode=None, step=None, body=None):
        """Writes a file for ParaView. "modes.vtp": the surface at rest with the fields of surface() on its vertices. "static.vtu":
        the quadrature points of an analysis 'static' with displacement, strain, stress and von_mises."""
        path = Path(path)
        if path.suffix == ".vtp":
            vertices, triangles, fields = self.surface(mode, step, body)
            vtk_files.write_surface(path, vertices, triangles, fields)
        elif path.suffix == ".vtu":
            self._expect("static", "fields at quadrature points")
            fields = {name: self[f"/static/points/{name}"] for name in ("displacement", "strain", "stress", "von_mises")
                      if f"/static/points/{name}" in self.data}
            points = self["/static/points/position"]
            vtk_files.write_cells(path, vtk_files.VERTEX, points, np.arange(len(points))[:, None], fields)
        else:
            raise ValueError(f"{path}: expected a name that ends with .vtp (surface) or .vtu (quadrature points)")

    def __repr__(self):
        lines = [f"Results({str(self.path)!r}): {self.analysis}, {self.title!r}, lengths in {self.length_unit}"]
        files = [self.attribute(f"/bodies/{name}", "file") for name in self.bodies] or [self.attribute("/model", "file")]
        lines.append(f"  model      {', '.join(files)}")
        if self.analysis == "eigen":
            elastic = self.frequencies[self.elastic()]
            lines.append(f"  modes      {len(self.frequencies)}, of which {len(elastic)} elastic: "
                         + ", ".join(f"{f:.6g}" for f in elastic[:4]) + (", …" if len(elastic) > 4 else ""))
        elif self.analysis == "buckling":
            lines.append(f"  buckling   under {', '.join(self.texts('/buckling/growing'))}; factors "
                         + ", ".join(f"{factor:.6g}" for factor in self.factors[:4]) + (", …" if len(self.factors) > 4 else ""))
        elif self.analysis == "static":
            lines.append(f"  static     supports {', '.join(self.texts('/static/supports/name'))}; "
                         f"loads {', '.join(self.texts('/static/loads/name'))}; strain energy "
                         f"{float(self.attribute('/static', 'strain_energy')):.6g}")
        else:
            time = self["/time_series/time"]
            lines.append(f"  series     {len(time)} times up to {time[-1] if len(time) else 0:g}; contacts "
                         f"{', '.join(self.texts('/time_series/contact_names')) or 'none'}")
            lines.append(f"  fields     {self.num_fields()} steps")
        return "\n".join(lines)
