"""Results that another program computed on a model of igaprep, written as a results file: scripts/render.py, igatools.Results and
igasolve's own files then stand side by side.

    write_results("kratos.h5", model, {"displacement": u, "strain_energy": U, "external_work": W}, solver="Kratos Multiphysics",
                  material=(C, density))
    write_results("modes.h5", model, {"omega_squared": l, "modes": shapes, "residual": r, "rigid": 6}, solver=…, material=…)

Coefficients are those of the model's functions, entry by entry of /functions (copies too), as /cells/functions counts them.
"""

import hashlib
import os
from pathlib import Path

import h5py
import numpy as np
from scipy.spatial import cKDTree

from igatools import iga_schema
from igatools.results import von_mises

SCHEMA = iga_schema.load("results")
VOIGT = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # order of strains and stresses in files: xx yy zz xy yz zx


def refined_surface(vertices, triangles, longest):
    """Triangles whose edges above `longest` (length) are halved until none is left. Whether an edge is halved depends on that edge
    alone: no crack opens. Returns vertices (the given ones first), triangles, and for each triangle the one that it is a piece of.
    """
    vertices, triangles, source = (
        np.asarray(vertices, float),
        np.asarray(triangles, np.int64),
        np.arange(len(triangles)),
    )
    while True:
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
        split = np.linalg.norm(np.subtract(*vertices[edges.transpose(2, 0, 1)]), axis=2) > longest
        if not split.any():
            return vertices, triangles, source
        pairs, place = np.unique(edges[split], axis=0, return_inverse=True)
        middle = np.full(split.shape, -1)
        middle[split] = len(vertices) + place.ravel()
        vertices = np.concatenate([vertices, vertices[pairs].mean(axis=1)])
        pieces, parents = [triangles[~split.any(1)]], [source[~split.any(1)]]
        for turn in range(3):  # each pattern of halved edges, turned so that it starts at the triangle's first corner
            a, b, c = (triangles[:, (turn + k) % 3] for k in range(3))
            ab, bc, ca = (middle[:, (turn + k) % 3] for k in range(3))
            for pattern, parts in (
                ((1, 0, 0), ((a, ab, c), (ab, b, c))),
                ((1, 1, 0), ((b, bc, ab), (a, ab, bc), (a, bc, c))),
                ((1, 1, 1), ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))),
            ):
                here = (split[:, [turn, (turn + 1) % 3, (turn + 2) % 3]] == pattern).all(1)
                if pattern != (1, 1, 1) or turn == 0:
                    pieces += [np.stack(part, 1)[here] for part in parts]
                    parents += [source[here]] * len(parts)
        triangles, source = np.concatenate(pieces), np.concatenate(parents)


def surface_of(model, subdivide=2):
    """The model's surface fine enough to show smooth fields: the datasets of /surface that do not depend on results."""
    longest = float(np.min(model.span_size())) / subdivide
    vertices, triangles, source = refined_surface(model.vertices, model.triangles, longest)
    given = len(model.vertices)
    cells, parameters = np.empty(len(vertices), np.int64), model.parameters_of(vertices)
    cells[:given] = model["/surface/vertex_cell"]
    parameters[:given] = model["/surface/vertex_parameters"]
    cells[given:], _ = model.locate(vertices[given:])
    lost = np.flatnonzero(cells < 0)
    if len(lost):  # on the surface, by rounding outside: the cell of the nearest surface point
        nearest = cKDTree(model.positions("/surface/quadrature")).query(vertices[lost])[1]
        cells[lost] = model.point_cells("/surface/quadrature")[nearest]
    return {
        "vertices": vertices,
        "vertex_parameters": parameters,
        "vertex_span": model["/cells/span"][cells].astype(np.int64),
        "vertex_cell": cells,
        "triangles": triangles.astype(np.int32),
        "region": model["/surface/region"][source].astype(np.int32),
        "regions": model.regions,
    }


def displacement_gradients(model, coefficients, cells, parameters):
    """Displacements (n, 3) and du_a/dx_b (n, 3, 3) at parameters (n, 3) of cells (n)."""
    spans, here = model.cell_spans(cells), coefficients[model["/cells/functions"][cells]]
    N, dN = model.functions_at(spans, parameters)[1], model.gradients_at(spans, parameters)
    return np.einsum("qi,qia->qa", N, here), np.einsum("qib,qia->qab", dN, here)


def linear_stress(C):
    """Stresses (n, 6) of displacement gradients (n, 3, 3) by an elasticity matrix (6, 6) in the files' order."""

    def stress(gradients):
        strain = np.stack([gradients[:, a, b] + (gradients[:, b, a] if a != b else 0) for a, b in VOIGT], 1)
        return strain @ np.asarray(C).T

    return stress


def write_results(path, model, fields, *, solver, version="", material, title=None, stress=None):
    """Writes the results file of a static analysis or of modes that another program computed.

    model       igatools.Model
    fields      statics: "displacement" (n_f, 3), length, with "strain_energy", "external_work" and, where known, "penalty_energy";
                "probes", "supports", "loads": lists of dictionaries, keys as the datasets of their group.
                Modes: "omega_squared" (n), "modes" (n, n_f, 3), "residual" (n), "rigid": how many come first; "complete_below".
                Both: "tables": {name: (what it holds, {heading: (unit, values)})}, columns of one length each.
    solver      name of the program, and its version: `producer` and `version` of /provenance
    material    C (6, 6) in the order xx yy zz xy yz zx, force/length^2, and the density, 0 where none is known
    stress      from displacement gradients (n, 3, 3) to Cauchy stresses (n, 6); default: C times the small strain
    Raises ValueError where shapes do not fit the model.
    """
    C, density = np.asarray(material[0], float), float(material[1])
    shapes = np.asarray(fields["modes"] if "modes" in fields else [fields["displacement"]], float)
    n_f = len(model["/functions/number"])
    if shapes.shape[1:] != (n_f, 3) or not np.isfinite(shapes).all():
        raise ValueError(
            f"{path}: coefficients have the shape {shapes.shape[1:]}, expected finite numbers ({n_f}, 3), "
            "one row for each entry of /functions of the model"
        )
    path = Path(path)
    beside = path.with_name(path.name + ".new")
    try:
        with h5py.File(f"{beside}.plain", "w", driver="core", backing_store=False) as plain:
            _write_head(plain, model, "eigen" if "modes" in fields else "static", title, solver, version, C, density)
            (_write_modes if "modes" in fields else _write_static)(plain, model, fields, shapes)
            _write_surface(plain, model, shapes, stress or linear_stress(C))
            _write_tables(plain, fields.get("tables", {}))
            with h5py.File(beside, "w", libver=("v110", "v110")) as file:
                _store(plain, file)
                iga_schema.validate(file, SCHEMA)
                iga_schema.validate_storage(file, SCHEMA)
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def _store(plain, file):
    """Copies a file as the schema asks for it: chunks with checksums, packed where large, texts on everything."""
    table = iga_schema.entries(SCHEMA, plain)
    listed = {entry["path"]: entry for entry in table["dataset"]}
    file.attrs.update(plain.attrs)

    def copy(name, item):
        words = name.replace("/", " ").replace("_", " ")
        if isinstance(item, h5py.Group):
            target = file.create_group(name)
        else:
            large = item.size * item.dtype.itemsize > iga_schema.COMPRESS_ABOVE
            packed = {"compression": "gzip", "compression_opts": 1, "shuffle": True} if large else {}
            rows = max(1, 2**17 // max(1, int(np.prod(item.shape[1:]))))
            chunks = (min(max(item.shape[0], 1), rows), *(max(extent, 1) for extent in item.shape[1:]))
            target = file.create_dataset(
                name,
                item.shape,
                item.dtype,
                chunks=chunks,
                fletcher32=True,
                **packed,
                maxshape=item.shape if item.size else (None, *item.shape[1:]),
            )
            if item.size:
                target[()] = item[()]
            target.attrs.update({key: listed["/" + name][key] for key in ("unit", "order")})
        target.attrs.update(item.attrs)
        target.attrs["description"] = f"{words}, of another program"

    plain.visititems(copy)


def _write_texts(group, name, texts):
    """Of fixed length: checksums hold no others."""
    encoded = [text.encode() for text in texts]
    dtype = h5py.string_dtype("utf-8", max([1, *map(len, encoded)]))
    group.create_dataset(name, data=np.array(encoded, dtype=dtype))


def _write_head(file, model, analysis, title, solver, version, C, density):
    file.attrs.update(
        {
            "format": SCHEMA["format"],
            "format_version": SCHEMA["format_version"],
            "analysis": analysis,
            "length_unit": model.length_unit,
            "title": title or f"{model.title} ({solver})",
        }
    )
    file.create_group("model").attrs.update(
        {"file": model.path.name, "sha256": hashlib.sha256(model.path.read_bytes()).hexdigest()}
    )
    file.create_group("material").attrs.update({"C": C, "density": density})
    functions = file.create_group("functions")
    functions.attrs.update(
        {
            "light_functions": "none",
            "light_threshold": 0.0,
            "unknowns": np.int64(3 * model.coefficients_from_unknowns().shape[1]),
        }
    )
    functions["active"] = model["/functions/number"].astype(np.int64)
    file.create_group("provenance").attrs.update({"producer": solver, "version": version})


def _write_static(file, model, fields, shapes):
    static = file.create_group("static")
    for name in ("strain_energy", "external_work", "penalty_energy"):
        if name in fields:
            static.attrs[name] = float(fields[name])
    static["displacement"] = shapes[0]
    static.create_group("points")["position"] = model.points
    resultant = ("centroid", "force", "moment")
    for group, texts, vectors in (
        ("probes", ("name",), ("position", "displacement")),
        ("supports", ("name", "method"), resultant),
        ("loads", ("name", "kind"), resultant),
    ):
        rows = fields.get(group, ())
        below = static.create_group(group)
        for name in texts:
            _write_texts(below, name, [row[name] for row in rows])
        for name in vectors:
            below[name] = np.array([row[name] for row in rows], float).reshape(-1, 3)
        if group != "probes":
            below["area"] = np.array([row["area"] for row in rows], float)


def _write_modes(file, model, fields, shapes):
    values, rigid = np.asarray(fields["omega_squared"], float), int(fields["rigid"])
    eigen = file.create_group("eigen")
    eigen.attrs.update({"mass": "consistent", "complete_below": float(fields.get("complete_below", 0.0))})
    file["frequencies"] = np.sqrt(np.maximum(values, 0)) / (2 * np.pi)
    file["modes"] = shapes
    eigen["omega_squared"], eigen["residual"] = values, np.asarray(fields["residual"], float)
    kinds = SCHEMA["enum"]["kind"]
    kind = np.where(np.arange(len(values)) < rigid, kinds["RIGID"], kinds["ELASTIC"]).astype("u1")
    eigen.create_dataset("kind", data=kind, dtype=h5py.enum_dtype(kinds, basetype="u1"))


def _write_surface(file, model, shapes, stress):
    parts = surface_of(model)
    surface = file.create_group("surface")
    for name, values in parts.items():
        if name != "regions":
            surface[name] = values
    _write_texts(surface, "regions", parts["regions"])
    surface["steps"] = np.arange(1.0, len(shapes) + 1)
    found = [displacement_gradients(model, u, parts["vertex_cell"], parts["vertex_parameters"]) for u in shapes]
    stresses = np.stack([stress(gradient) for _, gradient in found])
    surface["displacement"] = np.stack([u for u, _ in found])
    surface["stress"], surface["von_mises"] = stresses, np.stack([von_mises(s) for s in stresses])


def _write_tables(file, tables):
    if not tables:
        return
    _write_texts(file, "table_names", list(tables))
    for name, (content, columns) in tables.items():
        table = file.create_group(f"tables/{name}")
        table.attrs["content"] = content
        _write_texts(table, "columns", list(columns))
        _write_texts(table, "units", [unit for unit, _ in columns.values()])
        table["values"] = np.column_stack([np.asarray(values, float) for _, values in columns.values()])
