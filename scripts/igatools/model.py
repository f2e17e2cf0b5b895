"""Models for programs of your own: igatools.Model("part.h5")."""
from functools import cached_property
from pathlib import Path

import numpy as np

from igatools import iga_model, vtk_files
from igatools.labels import Labels
from igatools.locate import Locator
from igatools.tables import Table, write_tables

# Corners of a span in the order of VTK's hexahedron.
CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
STATES = {iga_model.INTERIOR: "interior", iga_model.TRIMMED: "trimmed"}


class Model(Labels, iga_model.Model):
    """A model made by igaprep: a solid in a grid of B-splines, with quadrature points in it and its surface.

        model = igatools.Model("part.h5")
        model.volume, model.points, model.weights          # integrate over the solid: (f(model.points) * model.weights).sum()
        cells, parameters = model.locate([[1, 2, 3]])      # which cell a point in space belongs to
        model.to_vtk("part.vtu")                           # for ParaView

    Every dataset of the file is there under its path, as schema/README.md describes it: model["/cells/functions"]. Lengths are
    in `length_unit`. Raises igatools.FormatError for a file that breaks the schema, FileNotFoundError where there is none.
    """

    def __init__(self, path):
        self.path = Path(path)
        super().__init__(self.path)

    @cached_property
    def points(self):
        """Positions of the quadrature points: (n, 3), length."""
        return self.positions()

    @property
    def weights(self):
        """Weights of the quadrature points: (n), length^3. Their sum is the volume."""
        return self["/quadrature/weights"]

    @property
    def volume(self):
        """Volume of the solid: float, length^3."""
        return float(self.weights.sum())

    @property
    def vertices(self):
        """Vertices of the surface: (n, 3), length."""
        return self["/surface/vertices"]

    @property
    def triangles(self):
        """Triangles of the surface: (m, 3), numbers of vertices, anticlockwise seen from outside."""
        return self["/surface/triangles"]

    @property
    def regions(self):
        """Names of the parts of the surface: list of str; model["/surface/region"] (m) says to which each triangle belongs."""
        return self.texts("/surface/regions")

    @property
    def num_cells(self):
        """Number of cells: pieces of spans, which an analysis loops over."""
        return len(self["/cells/span"])

    @cached_property
    def locator(self):
        return Locator(self)

    def locate(self, points):
        """Cells that points in space belong to.

        points: (n, 3), length. Returns cells (n), -1 where a point lies outside the solid, and parameters (n, 3), length: the
        points in the frame of the grid. Up to a twentieth of a span outside the triangles counts as inside: a point on a round
        face lies off the flat triangles.
        """
        points = np.asarray(points, float)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points have the shape {points.shape}, expected (n, 3)")
        return self.locator.locate(points)

    def span_corners(self):
        """Corners of the spans that hold material: (k, 8, 3), length, in the order of VTK's hexahedron; and their numbers (k)."""
        numbers = np.unique(self["/cells/span"])
        u = self.attribute("/patch", "A") + (self.split_numbers(numbers, self.spans)[:, None] + CORNERS) * self.span_size()
        return self.positions_of(u.reshape(-1, 3)).reshape(-1, 8, 3), numbers

    def tables(self):
        """What to_csv() writes: points, surface_points, cells, functions."""
        def of(name):
            return Table(name, self, iga_model.SCHEMA)

        spans, regions = self["/cells/span"], np.array(self.regions)
        parameters = "(point; u v w)"
        yield (of("points").plain("span", spans[self.point_cells()])
               .numbers("position", "length", self.points, "(point; x y z)")
               .numbers("parameter", "parameter", self["/quadrature/parameters"], parameters)
               .numbers("weight", "length^3", self.weights))
        group = "/surface/quadrature"
        triangle = self[group + "/triangle"]
        yield (of("surface_points").plain("span", spans[self.point_cells(group)])
               .numbers("position", "length", self.positions(group), "(point; x y z)")
               .numbers("normal", "1", self[group + "/normals"], "(point; x y z)")
               .numbers("weight", "length^2", self[group + "/weights"]).plain("triangle", triangle)
               .plain("region", regions[self["/surface/region"][triangle]]))
        yield (of("cells").plain("span", spans).plain("state", [STATES[state] for state in self["/cells/state"]])
               .add("/cells/volume_fraction"))
        yield of("functions").plain("function", self["/functions/number"]).add("/functions/mass_fraction")

    def to_csv(self, folder, table=None):
        """Writes tables into a folder, as igasolve export does: points.csv, surface_points.csv, cells.csv, functions.csv; with
        `table` that one alone. Returns their paths."""
        return write_tables(self.tables(), folder, table)

    def to_vtk(self, path):
        """Writes a file for ParaView. "part.vtu": the spans that hold material, with their state (1 interior, 2 trimmed), the
        number of cells in each and the share of it that is filled; "part.vtp": the surface, with the number of the region."""
        path = Path(path)
        if path.suffix == ".vtp":
            vtk_files.write_surface(path, self.vertices, self.triangles,
                                    on_triangles={"region": self["/surface/region"].astype(np.int32)})
        elif path.suffix == ".vtu":
            corners, numbers = self.span_corners()
            span = np.searchsorted(numbers, self["/cells/span"])
            data = {"state": np.asarray(self["/spans/state"]).ravel()[numbers].astype(np.uint8),
                    "cells": np.bincount(span).astype(np.int32),
                    "volume_fraction": np.bincount(span, self["/cells/volume_fraction"])}
            vtk_files.write_cells(path, vtk_files.HEXAHEDRON, corners.reshape(-1, 3),
                                  np.arange(8 * len(numbers)).reshape(-1, 8), on_cells=data)
        else:
            raise ValueError(f"{path}: expected a name that ends with .vtu (spans) or .vtp (surface)")

    def __repr__(self):
        state, regions = np.asarray(self["/spans/state"]), self.regions
        return (f"Model({str(self.path)!r}): {self.title!r}, lengths in {self.length_unit}\n"
                f"  grid       {' x '.join(map(str, self.spans))} spans of degree {', '.join(map(str, self.degree))}: "
                f"{(state == 1).sum()} interior, {(state == 2).sum()} trimmed\n"
                f"  solid      volume {self.volume:.6g}, {self.num_cells} cells, {len(self['/functions/number'])} functions, "
                f"{len(self.weights)} quadrature points\n"
                f"  surface    {len(self.triangles)} triangles, {len(regions)} regions: {', '.join(regions[:6])}"
                f"{', …' if len(regions) > 6 else ''}")
