"""What the 3-D view shows: the part's surface, its spans, and how the surface moves."""
import numpy as np

from igatools import iga_model, iga_results, iga_schema
from igatools.report import arrays, spans, thinning, units
from igatools.report.files import located

BUDGET = 5_000_000      # bytes of arrays in a page; a third more as base64
MOST_VERTICES = 50_000  # of a surface: what a small computer turns without delay
MOST_FRAMES = 60        # of a run over time
KINDS = {"eigen": "swing", "buckling": "swing", "explicit": "time"}  # of motion, by analysis; else "load"


class Scene:
    """Arrays for the page, and what was left out of them, in words."""

    def __init__(self, report, folder, budget=BUDGET):
        self.report, self.folder, self.budget = report, folder, budget
        self.units = units.of_report(report)
        self.notes = []
        self.model = self._read(report.get("model"), iga_model.read, "model")
        self.results = self._read(report.get("results"), iga_results.read, "results")

    def _read(self, name, reader, what):
        path = located(self.folder, name)
        if path is None:
            self.notes.append(f"The {what} file {name or ''} was not found: the view lacks what it holds." if name else
                              f"The report names no {what} file: the view lacks what it holds.")
            return None
        try:
            return reader(path)
        except (OSError, iga_schema.FormatError) as error:
            self.notes.append(f"The {what} file {path} cannot be read ({error}): the view lacks what it holds.")
            return None

    def data(self):
        """For the page; None where there is no surface."""
        surface = self._surface()
        if surface is None:
            return None
        steps = self._steps(surface)
        kept, triangles = self._thinned(surface, steps)
        vertices = surface["vertices"][kept]
        low, high = self._box(vertices, surface, kept, steps)
        centre = 0.5 * (low + high)
        return {"kind": KINDS.get(self.results.analysis, "load") if self.results else "load", "units": self.units,
                "centre": centre.tolist(), "half": (0.5 * (high - low)).tolist(),
                "vertices": arrays.reals(vertices - centre), "triangles": arrays.integers(triangles),
                "steps": [self._step(surface, kept, *step) for step in steps], "spans": self._spans(surface),
                "notes": self.notes}

    def _surface(self):
        """As iga_results' joined_surface(); where the results hold no fields, the model's with the modes' displacements."""
        found = self.results.joined_surface() if self.results else None
        if found is not None and "displacement" in found:
            return found
        if self.model is None:
            return None
        found = {"vertices": self.model["/surface/vertices"], "triangles": self.model["/surface/triangles"],
                 "steps": np.zeros(0)}
        if self.results and "/modes" in self.results:
            found |= self._modes_at(self.model["/surface/vertex_cell"], self.model["/surface/vertex_parameters"])
        return found

    def _modes_at(self, cells, parameters):
        try:
            shapes = [self.results.field(self.model, mode, cells, parameters) for mode in self.results["/modes"]]
        except ValueError as error:
            self.notes.append(f"Modes are not drawn: {error}.")
            return {}
        return {"displacement": np.array(shapes), "steps": np.arange(len(shapes)) + 1.0}

    def _steps(self, surface):
        """(row of the fields, label) of what can be chosen."""
        if "displacement" not in surface:
            return []
        if self.results.analysis == "eigen":
            return self._modes(surface)
        count = len(surface["steps"])
        if self.results.analysis == "buckling":
            return [(row, f"Factor {factor:.5g}") for row, factor in enumerate(self.results["/buckling/factor"])]
        if self.results.analysis == "static" and "/static/cases/name" in self.results:
            return [(row, f"Case {name}") for row, name in enumerate(self.results.texts("/static/cases/name"))]
        if self.results.analysis in ("harmonic", "random"):
            return [(row, f"Field {row + 1}") for row in range(count)]
        if self.results.analysis == "static":
            return [(row, f"Load step {surface['steps'][row]:g}" if count > 1 else "Under load") for row in range(count)]
        if "/time_series/rigid_names" in self.results and (rigid := self.results.texts("/time_series/rigid_names")):
            self.notes.append(f"Rigid bodies are not drawn: {', '.join(rigid)}.")
        rows = np.unique(np.linspace(0, count - 1, min(count, MOST_FRAMES)).round().astype(int))
        if len(rows) < count:
            self.notes.append(f"{len(rows)} of {count} stored times are shown.")
        return [(int(row), units.with_unit(f"Time {surface['steps'][row]:.4g}", self.units["time"])) for row in rows]

    def _modes(self, surface):
        row_of = {int(round(number)): row for row, number in enumerate(surface["steps"])}
        frequencies = self.results["/frequencies"]
        chosen = [mode for mode in self.results.elastic() if mode + 1 in row_of][:len(self.report.get("frequencies", []))]
        return [(row_of[mode + 1], f"Mode {mode + 1}: " + units.with_unit(f"{frequencies[mode]:.5g}", self.units["frequency"]))
                for mode in chosen]

    def _box(self, vertices, surface, kept, steps):
        """Corners of what the picture must hold: a run over time moves the part through space."""
        places = [vertices]
        if self.results and self.results.analysis == "explicit":
            places += [vertices + surface["displacement"][row][kept] for row, _ in steps]
        return np.min([x.min(0) for x in places], axis=0), np.max([x.max(0) for x in places], axis=0)

    def _thinned(self, surface, steps):
        per_step = 6 + (2 if "von_mises" in surface else 0)
        # A vertex has three coordinates of two bytes, and comes with two triangles of three two-byte numbers.
        most = min(MOST_VERTICES, self.budget // (6 + 12 + per_step * len(steps)))
        kept, triangles = thinning.thinned(surface["vertices"], surface["triangles"], most)
        if len(kept) < len(surface["vertices"]):
            self.notes.append(f"To keep the page small the surface is drawn with {len(kept):,} of its "
                              f"{len(surface['vertices']):,} vertices; the results file has all.")
        return kept, triangles

    def _step(self, surface, kept, row, label):
        displacement = surface["displacement"][row]
        step = {"label": label, "displacement": arrays.reals(displacement[kept]),
                "largest": float(np.linalg.norm(displacement, axis=1).max())}
        if "von_mises" in surface and self.results.analysis not in ("eigen", "buckling"):  # the size of a mode means nothing
            stress = surface["von_mises"][row]
            step["von_mises"] = arrays.reals(stress[kept])
            step["largest_stress"] = float(stress.max())
            step["usual_stress"] = float(np.quantile(stress, 0.995))
        return step

    def _spans(self, surface):
        if self.model is None:
            return None
        own = self.model["/surface/vertices"]
        moved = np.abs([own.min(0) - surface["vertices"].min(0), own.max(0) - surface["vertices"].max(0)]).max()
        if moved > 1e-6 * np.ptp(own, axis=0).max():
            self.notes.append("Spans are not drawn: the run put the part in another place than its model, or has several parts.")
            return None
        patch = self.model.attributes["/patch"]
        low, high = np.asarray(patch["A"], float), np.asarray(patch["B"], float)
        interior, trimmed = spans.lines(self.model)
        state = np.asarray(self.model["/spans/state"])
        return {"low": low.tolist(), "high": high.tolist(), "size": ((high - low) / self.model.spans).tolist(),
                "rotation": np.asarray(patch["rotation"], float).reshape(3, 3).tolist(),
                "interior": arrays.integers(interior), "trimmed": arrays.integers(trimmed),
                "counts": [int((state == kind).sum()) for kind in (spans.INTERIOR, spans.TRIMMED)]}
