"""Tables of a results file: frequencies; factors; reactions, loads, probes, points; series of explicit runs; surfaces with fields."""
import numpy as np

from igatools.iga_results import SCHEMA
from igatools.tables import Table

FIELD_NAMES = ("displacement", "strain", "stress", "von_mises")
FORCES = ("area", "centroid", "force", "moment")
SERIES = {"contact": ("force", "impulse", "normal_force", "friction_force", "depth", "area"),
          "body": ("momentum", "angular_momentum", "impulse", "angular_impulse", "min_volume_ratio", "inverted", "eroded"),
          "rigid": ("position", "rotation", "velocity", "force", "moment"),
          "support": ("force",)}
ENERGIES = ("internal", "kinetic", "contact", "friction", "damping", "external", "eroded")


def added(table, group, names):
    for name in names:
        table.add(f"{group}/{name}")
    return table


def with_principal(table, results, path):
    """Principal stresses, the largest first."""
    if path in results.data:
        xx, yy, zz, xy, yz, zx = results[path].reshape(-1, 6).T
        values = np.linalg.eigvalsh(np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]).transpose(2, 0, 1))[:, ::-1]
        table.numbers("principal_stress", "force/length^2", values, "(point; 1 2 3)")
    return table


def result_tables(results):
    def of(name):
        return Table(name, results, SCHEMA)

    if results.analysis == "eigen":
        yield (of("frequencies").plain("mode", np.arange(1, len(results.frequencies) + 1)).add("/frequencies", "frequency")
               .add("/eigen/omega_squared").plain("kind", [kind.lower() for kind in results.kinds()]).add("/eigen/residual"))
        if "/eigen/participation" in results:
            yield participation_table(results, of("participation"))
    elif results.analysis == "buckling":
        yield (of("factors").plain("mode", np.arange(1, len(results["/buckling/factor"]) + 1)).add("/buckling/factor")
               .add("/buckling/residual"))
    elif results.analysis == "static":
        yield added(of("reactions"), "/static/supports", ("name", "method", *FORCES))
        if "/static/springs" in results:
            yield added(of("springs"), "/static/springs", ("name", *FORCES, "energy"))
        yield added(of("loads"), "/static/loads", ("name", "kind", *FORCES))
        if "/static/cases/name" in results.data:
            yield added(of("cases"), "/static/cases", ("name", "strain_energy", "largest_displacement", "largest_von_mises"))
        yield with_principal(added(of("probes"), "/static/probes", ("name", "position", *FIELD_NAMES)), results, "/static/probes/stress")
        yield with_principal(added(of("points"), "/static/points", ("position", *FIELD_NAMES)), results, "/static/points/stress")
    elif results.analysis == "heat":
        yield added(of("heat"), "/heat/boundaries", ("name", "kind", "area", "centroid", "temperature", "power"))
        yield added(of("probes"), "/heat/probes", ("name", "position", "temperature", "heat_flux"))
    elif "/table_names" not in results.data:
        yield from series_tables(results, of)
    for name in results.texts("/table_names") if "/table_names" in results.data else ():
        table, units = of(name), results.texts(f"/tables/{name}/units")
        for (heading, values), unit in zip(results.table(name).items(), units):
            table.numbers(heading, unit, values)
        yield table
    if "/surface" in results:
        yield surface_table(results, of("surface"))
        if "/static/cases" in results:
            yield envelope_table(results, of("envelope"))


def participation_table(results, table):
    """Participation factors, effective masses, and their sums from the first mode on as shares of the whole part's."""
    order = "(mode; x y z)"
    table.plain("mode", np.arange(1, len(results.frequencies) + 1)).add("/frequencies", "frequency")
    table.add("/eigen/participation").add("/eigen/rotation_participation")
    masses, inertias = (results[f"/eigen/{name}"]**2 for name in ("participation", "rotation_participation"))
    table.numbers("effective_mass", "mass", masses, order).numbers("effective_inertia", "mass*length^2", inertias, order)
    for heading, values, total in (("mass_sum", masses, np.repeat(results.attribute("/eigen", "total_mass"), 3)),
                                   ("inertia_sum", inertias, results.attribute("/eigen", "total_inertia"))):
        sums = np.cumsum(values, axis=0)
        table.numbers(heading, "1", np.divide(sums, total, out=np.zeros_like(sums), where=total > 0), order)
    return table


def series_tables(results, of):
    yield added(added(of("energy"), "/time_series", ("time", "dt", "energy_error")), "/time_series/energy", ENERGIES)
    for kind, columns in SERIES.items():
        if f"/time_series/{kind}_names" in results.data:
            for name in results.texts(f"/time_series/{kind}_names"):
                yield added(of(f"{kind}_{name}").add("/time_series/time"), f"/time_series/{kind}/{name}", columns)


def envelope_table(results, table):
    """The largest values of all load cases at each vertex, and the names of these."""
    vertices, most, cases = results["/surface/vertices"], results.envelope(), np.array(results.texts("/static/cases/name"))
    table.plain("vertex", np.arange(len(vertices)))
    for axis, column in zip("xyz", vertices.T):
        table.numbers(axis, "length", column)
    for name, unit in (("displacement", "length"), ("von_mises", "force/length^2")):
        table.numbers(name, unit, most[name]).plain(f"{name}_case", cases[most[f"{name}_case"]])
    return table


def surface_table(results, table):
    """All steps, one below the other."""
    vertices, steps = results["/surface/vertices"], results["/surface/steps"]
    n = len(vertices)
    table.plain("step", np.repeat(steps, n)).plain("vertex", np.tile(np.arange(n), len(steps)))
    for axis, column in zip("xyz", vertices.T):
        table.numbers(axis, "length", np.tile(column, len(steps)))
    for name in FIELD_NAMES:
        table.add(f"/surface/{name}")
    with_principal(table, results, "/surface/stress")
    return table.add("/surface/von_mises_error").add("/surface/safety_factor")
