"""The convergence tab: by how much each number changed from grid to grid, over the span size."""
from html import escape

from igatools.report import plots, tables, units


ONE_CHANGE = " Two grids show one change only; with a third it is seen how fast the changes fall."


def histories(report):
    """(name, unit, values on the last grids, estimated error) of every number."""
    if "frequencies" in report:
        unit, rigid = units.of_report(report)["frequency"], report.get("rigid_modes") or 0
        return [(f"Mode {rigid + k + 1}", unit, values, error)
                for k, (values, error) in enumerate(zip(report["histories"], report["errors"]))]
    return [(q["name"], q.get("unit") or "", q.get("history") or [], q.get("error")) for q in report.get("quantities") or []]


def curves(report):
    """Relative changes at the finer span size of each pair of grids; the error estimate at the finest."""
    sizes, found = report["span_sizes"], []
    for name, _, values, error in histories(report):
        own = sizes[len(sizes) - len(values):]
        scale = abs(values[-1]) if values and values[-1] else 1.0
        points = [(h, abs(b - a) / scale) for h, a, b in zip(own[1:], values, values[1:]) if b != a]
        estimate = (sizes[-1], error) if error else None
        if points or estimate:
            found.append(plots.Curve(name, points, estimate))
    return found


def html(report):
    """None where there is only one grid."""
    sizes = report.get("span_sizes") or []
    found = curves(report) if len(sizes) > 1 else []
    if not found:
        return None
    unit = units.of_report(report)["length"]
    points = [p for curve in found for p in [*curve.points, *([curve.estimate] if curve.estimate else [])]]
    tolerance = report.get("tolerance")
    x_axis = plots.log_axis(units.headed("Span size, finer to the right", unit), sizes[1:], is_reversed=True)
    x_axis.ticks = sizes[1:]
    y_axis = plots.log_axis("Relative change from the grid before", [p[1] for p in points] + ([tolerance] if tolerance else []))
    extra = plots.level(x_axis, y_axis, tolerance, f"tolerance {tables.percent(tolerance)}") if tolerance else ""
    order = report.get("order_relied_on")
    if order and len(sizes) > 2:
        start = max((c.points[0] for c in found if c.points), key=lambda p: p[1])
        extra += plots.slope(x_axis, y_axis, order, start, f"order {order:.3g}, relied on")
    label = ("Relative change of each number from grid to grid over the span size, both logarithmic; the table below has the "
             "numbers.")
    return (f"<p>A filled marker is the change from the grid before; the hollow one beside the last is the estimated error on "
            f"the finest grid. Choose a name to bring its curve to the front.{'' if len(sizes) > 2 else ONE_CHANGE}</p>"
            + plots.figure(label, found, x_axis, y_axis, with_markers=True, extra=extra) + history_table(report)
            + f"<p>{escape(explanation(report))}</p>")


def history_table(report):
    sizes = report["span_sizes"]
    rows = []
    for name, unit, values, error in histories(report):
        absent = [""] * (len(sizes) - len(values))
        rows.append([escape(units.headed(name, unit)), *absent, *(tables.number(v, 6) for v in values), tables.percent(error)])
    length = units.of_report(report)["length"]
    headings = ["Number", *(units.with_unit(f"spans of {h:.4g}", length) for h in sizes), "estimated error"]
    return tables.table("Values on all grids", headings, rows)


def explanation(report):
    order = report.get("order_relied_on")
    relied = f", relying on convergence of order {order:.3g}" if order else ""
    is_singular = order and order < 2 and report.get("command") not in ("drop", "impact")
    reason = " (sharp re-entrant edges or supports make it low)" if is_singular else ""
    solution = ", and from what the solution leaves of the equations; the larger counts" if \
        report.get("command") in ("modes", "static") else ""
    return (f"The error is the estimated distance from the limit of smaller and smaller spans, told from how the numbers change "
            f"from grid to grid{relied}{reason}{solution}. It does not cover what the material data, the supports, the loads and the flat "
            "facets of the surface leave open.")
