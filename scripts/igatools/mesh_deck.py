"""A run file of igasolve static or eigen on a mesh of 10-node tetrahedra, as a deck for CalculiX."""

import tomllib
from pathlib import Path

import numpy as np

from igatools import calculix, choices, iga_model, tet_mesh
from igatools.fe_mesh import Mesh
from igatools.run_files import kind_of_load
from igatools.stl import read_stl, write_stl

CHOICE = {"region", "box", "plane", "normal", "whole_surface"}
KEYS = {
    "support": {"name", "fixed", *CHOICE},
    "load": {"name", "traction", "pressure", "force", "body_force", "acceleration", *CHOICE},
    "probe": {"name", "position"},
    "material": {"E", "nu", "rho"},
    "eigen": {"modes"},
}
NUMERICS = {
    "support": {"method", "penalty_factor"},
    "load": set(),
    "probe": set(),
    "material": set(),
    "eigen": {"sturm"},
}
TOP = {"model", "output", "units", "unit_system", "material", "support", "load", "probe", "eigen"}
SAMPLES_PER_SIZE = 6  # spacing of the surface's samples in a search for closest points, per target size
TOLERANCE = 1e-6  # of the part's size: nodes so near to a plane or a box lie in it
AREA_NOTE = 0.01  # a choice whose area on the mesh differs by more is pointed out


class ExportError(Exception):
    """What the deck cannot hold, or cannot be made."""


class MeshRun:
    """Surface, run file and, after mesh(), the mesh; lines() is the deck. `notes`: what a user should know."""

    def __init__(self, part, run):
        self.run, self.notes = Path(run), []
        try:
            self.table = tomllib.loads(self.run.read_text(encoding="utf-8"))
        except tomllib.TOMLDecodeError as error:
            raise ExportError(f"{run}: {error}") from error
        self._check_keys()
        path = Path(part) if part else self.run.parent / self._needed(self.table, "model", "")
        self._read_surface(path)
        self.size = float(np.ptp(self.vertices, 0).max())

    def _needed(self, table, key, where):
        if key not in table:
            raise ExportError(f"{self.run}: {where}has no {key}")
        return table[key]

    def _check_keys(self):
        for key in self.table:
            if key not in TOP:
                raise ExportError(
                    f"{self.run}: {key}: is not exported; expected no others than {', '.join(sorted(TOP))}"
                )
        if not isinstance(self.table.get("material"), dict) or not {"E", "nu"} <= set(self.table["material"]):
            raise ExportError(
                f"{self.run}: material: expected E and nu as numbers, and rho where mass counts; names are not exported"
            )
        for kind, known in KEYS.items():
            found = self.table.get(kind, [])
            for entry in [found] if isinstance(found, dict) else found:
                unknown = sorted(set(entry) - known - NUMERICS[kind])
                if unknown:
                    raise ExportError(
                        f"{self.run}: {kind} {entry.get('name', '')}: {unknown[0]}: is not exported; expected no others"
                        f" than {', '.join(sorted(known))}"
                    )

    def _read_surface(self, path):
        if path.suffix == ".stl":
            corners = read_stl(path)
            self.vertices, index = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
            self.triangles = index.reshape(-1, 3)
            self.region, self.regions, self.span = np.zeros(len(corners), int), ["surface"], None
            return
        model = iga_model.read(path)
        self.vertices, self.triangles = model["/surface/vertices"], model["/surface/triangles"].astype(np.int64)
        self.region, self.regions = model["/surface/region"], model.texts("/surface/regions")
        self.span = float(model.span_size().mean())

    def surface_lines(self):
        """The surface as triangles, one element set for each region."""
        yield from ("** surface of the part; element sets are its regions", "*NODE, NSET=ALL")
        yield from (f"{k + 1}, " + ", ".join(f"{c:.12g}" for c in x) for k, x in enumerate(self.vertices))
        for number, name in enumerate(self.regions):
            chosen = np.flatnonzero(self.region == number)
            if len(chosen):
                yield from (f"** region {name}", f"*ELEMENT, TYPE=S3, ELSET=REGION{number}")
                yield from (f"{t + 1}, " + ", ".join(str(v + 1) for v in self.triangles[t]) for t in chosen)

    def make_mesh(self, gmsh, size, folder, run):
        """10-node tetrahedra of a target size (None: on the surface's own triangles) whose mid-edge nodes follow the
        surface."""
        stl = Path(folder) / "surface.stl"
        corners = self.vertices[self.triangles]
        write_stl(stl, corners)
        try:
            nodes, tets, _ = tet_mesh.run_gmsh(gmsh, stl, size, folder, "mesh", run)
        except tet_mesh.MeshError as error:
            raise ExportError(str(error)) from error
        surface = None if size is None else tet_mesh.Surface(corners, size / SAMPLES_PER_SIZE)
        self.mesh = Mesh(*tet_mesh.quadratic_tets(nodes, tets, surface), "C3D10")
        self.volume = tet_mesh.curved_volume(self.mesh.nodes, self.mesh.elements)
        finder = tet_mesh.Surface(corners, (size or self.size / 50) / SAMPLES_PER_SIZE)
        middle = self.mesh.nodes[self.mesh.boundary[:, 3:]].mean(1)
        self.place, triangle = finder.nearest(middle)  # of each face on the part's surface
        self.face_region = self.region[triangle]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[triangle]
        self.normals = normal / np.linalg.norm(normal, axis=1)[:, None]

    def faces_of(self, table, what):
        """Faces of the mesh (mask) whose middle lies in a choice of surface, their area, and the exact one of the
        choice on the part's own triangles."""
        faces = self.mesh.boundary
        kept = np.ones(len(faces), bool)
        if "region" in table:
            given = table["region"] if isinstance(table["region"], list) else [table["region"]]
            wanted = [r for r, name in enumerate(self.regions) if name in given or r in given]
            if len(wanted) < len(given):
                raise ExportError(f"{self.run}: {what}: region {given}: the part has {', '.join(self.regions)}")
            kept &= np.isin(self.face_region, wanted)
        for normal, offset in choices.half_spaces(table):
            kept &= self.place @ normal <= offset + TOLERANCE * self.size
        if "normal" in table:
            direction = np.array(table["normal"]["direction"], float)
            kept &= (
                self.normals @ direction
                >= np.cos(np.radians(table["normal"].get("angle", 1))) * np.linalg.norm(direction) - 1e-12
            )
        if not CHOICE & set(table):
            raise ExportError(
                f"{self.run}: {what}: has no choice of surface; expected one of {', '.join(sorted(CHOICE))}"
            )
        polygons = choices.chosen_polygons(
            table, self.vertices, self.triangles, self.region, self.regions, TOLERANCE * self.size
        )
        exact = sum(np.linalg.norm(np.cross(p[1:-1] - p[0], p[2:] - p[0]).sum(0)) / 2 for p in polygons)
        area = float(self.mesh.face_areas(faces[kept]).sum()) if kept.any() else 0.0
        if not area > 0:
            raise ExportError(
                f"{self.run}: {what}: no face of the mesh lies in its choice of surface (area on the part {exact:.6g});"
                " expected a smaller --size"
            )
        if abs(area - exact) > AREA_NOTE * exact:
            self.notes.append(
                f"{what}: acts on an area of {area:.6g} of the mesh, {exact:.6g} on the part; a smaller --size is"
                " nearer"
            )
        return kept, area, exact

    def held(self):
        """(numbers of nodes, axes) of the supports."""
        found = []
        for support in self.table.get("support", []):
            what = f"support '{support.get('name', '')}'"
            kept, *_ = self.faces_of(support, what)
            axes = self._needed(support, "fixed", what + ": ")
            if axes == "normal":
                normals = self.normals[kept]
                along = np.abs(normals).mean(0).argmax()
                if (np.abs(normals[:, along]) < 1 - 1e-6).any():
                    raise ExportError(
                        f"{self.run}: {what}: fixed = \"normal\" on faces that do not look along one of the axes x, y,"
                        " z is not exported"
                    )
                axes = "xyz"[along]
            if not axes or set(axes) - set("xyz"):
                raise ExportError(
                    f"{self.run}: {what}: fixed = \"{axes}\" is not exported; expected letters out of x, y, z, or"
                    " normal"
                )
            found.append((np.unique(self.mesh.boundary[kept]), axes))
        return found

    def loads(self):
        """Forces at the nodes (n, 3), consistent with all loads."""
        total = np.zeros_like(self.mesh.nodes)
        rho = self.table["material"].get("rho")
        for load in self.table.get("load", []):
            what = f"load '{load.get('name', '')}'"
            try:
                kind = kind_of_load(load)
            except ValueError as error:
                raise ExportError(f"{self.run}: {what}: {error}") from error
            value = np.array(load[kind], float)
            if kind in ("body_force", "acceleration"):
                if kind == "acceleration" and rho is None:
                    raise ExportError(f"{self.run}: {what}: an acceleration needs rho in the material")
                per_volume = value * rho if kind == "acceleration" else value
                total += tet_mesh.nodal_volumes(self.mesh.nodes, self.mesh.elements)[:, None] * per_volume
                continue
            kept, area, _ = self.faces_of(load, what)
            faces = self.mesh.boundary[kept]
            if kind == "pressure":
                total += self.mesh.face_forces(faces, lambda x, normal, p=float(value): -p * normal)
            else:
                total += self.mesh.face_forces(faces, value / area if kind == "force" else value)
        return total

    def lines(self, modes=None):
        """The deck: a static step, or with `modes` the lowest modes of the held part."""
        material = self.table["material"]
        if modes and "rho" not in material:
            raise ExportError(f"{self.run}: material: modes need rho")
        held = self.held()
        yield from (
            (
                f"** {self.run.name} on {len(self.mesh.elements)} tetrahedra of 10 nodes, written by"
                " scripts/export_mesh.py"
            ),
            "** units are those of the run file; supports hold nodes exactly where igasolve holds the surface weakly",
        )
        yield from calculix.deck(self.mesh, material, held)
        for number, (nodes, _) in enumerate(held):
            yield f"*NSET, NSET=SUPPORT{number + 1}"
            yield from (f"{n + 1}," for n in nodes)
        if modes:
            yield from ("*STEP", "*FREQUENCY, SOLVER=SPOOLES", str(modes), "*NODE FILE", "U", "*END STEP")
            return
        forces = self.loads()
        yield from ("*STEP", "*STATIC, SOLVER=SPOOLES")
        if forces.any():
            yield "*CLOAD"
            yield from (f"{n + 1}, {d + 1}, {forces[n, d]:.12g}" for n, d in np.argwhere(forces))
        yield from ("*NODE FILE", "U, RF", "*EL FILE", "S", "*END STEP")

    def reactions(self, forces):
        """{name: force of a support on the part} from the nodal forces (n, 3) of CalculiX, which hold the loads at held
        nodes too; what two supports hold counts for the first one."""
        forces = forces - self.loads()
        found, counted = {}, np.zeros(forces.shape, bool)
        for number, (support, (nodes, axes)) in enumerate(zip(self.table.get("support", []), self.held()), 1):
            total = np.zeros(3)
            for d in map("xyz".index, axes):
                total[d] = forces[nodes[~counted[nodes, d]], d].sum()
                counted[nodes, d] = True
            found[support.get("name", f"support {number}")] = total
        return found

    def at_probes(self, field):
        """{name: value} of a nodal field (n, c) at the probes, by the shape functions of the element that holds each
        (as if its edges were straight)."""
        corners = self.mesh.nodes[self.mesh.elements[:, :4]]
        edges = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
        found = {}
        for number, probe in enumerate(self.table.get("probe", []), 1):
            local = np.linalg.solve(edges, (np.array(probe["position"], float) - corners[:, 0])[:, :, None])[:, :, 0]
            shares = np.column_stack([1 - local.sum(1), local])
            element = shares.min(1).argmax()
            s = shares[element]
            if s.min() < -0.5:
                raise ExportError(
                    f"{self.run}: probe '{probe.get('name', number)}' at {probe['position']} lies outside of the mesh"
                )
            found[probe.get("name", f"probe {number}")] = tet_mesh.shape_values(s) @ field[self.mesh.elements[element]]
        return found
