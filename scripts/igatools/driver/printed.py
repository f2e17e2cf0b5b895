"""The report for people."""
import textwrap

from igatools.driver.estimate import REENTRANT_ORDER
from igatools.report import units
from igatools.report.tables import percent

WIDTH, MARGIN = 120, 13


def head(report):
    unit = "" if report["length_unit"] == "unspecified" else " " + report["length_unit"]
    material = report["material"] or {}
    lines = [f"part         {report['part']}"]
    if material.get("name"):
        lines.append(f"material     {material['name']}"
                     + units_in_words(report)
                     + (f", {material['mass_in_kg']:.4g} kg" if material.get("mass_in_kg") else ""))
    grids = ", ".join(f"{h:.4g}" for h in report["span_sizes"])
    return lines + [f"grids        spans of {grids}{unit}; {', '.join(map(str, report['unknowns']))} unknowns"]


def units_in_words(report):
    """", units t-mm-s (Hz, N, MPa)"; nothing where the run does not know."""
    unit, name = units.of_report(report), report["material"].get("unit_system")
    return f", units {name} ({unit['frequency']}, {unit['force']}, {unit['stress']})" if unit["frequency"] else ""


def tail(report):
    lines = [f"note         {note}" for note in report["notes"]]
    lines += [f"found        {finding}" for finding in report["findings"]]
    lines += [f"warning      {warning}" for warning in report["warnings"]]
    if not report["reached"] and report["tolerance"] is not None:
        lines.append(f"NOT REACHED  the tolerance of {100 * report['tolerance']:.3g} %")
    reused = f", {report['reused_files']} files of earlier calls used again" if report["reused_files"] else ""
    lines.append(f"time         {report['seconds']:.1f} s, {report['peak_memory']:.0f} MiB{reused}")
    lines.append(f"written      {report['folder']}: report.json, {report['model']}, {report['results']}")
    return lines


def modes(report):
    frequency = units.headed("frequency", units.of_report(report)["frequency"])
    lines = [f"modes        {report['rigid_modes']} rigid, {len(report['frequencies'])} elastic"
             + (", none missing (Sturm count)" if report["complete"] else ""), "",
             f"{'mode':>6}  {frequency:>14}  {'error':>9}  {'computed':>14}  {'order':>6}  {'shape':>6}"]
    columns = zip(report["frequencies"], report["errors"], report["computed"], report["orders"], report["agreements"])
    for number, (f, e, computed, q, a) in enumerate(columns):
        lines.append(f"{number + 1 + report['rigid_modes']:>6}  {f:>14.6g}  {percent(e):>9}  {computed:>14.6g}  "
                     f"{'' if q is None else f'{q:.1f}':>6}  {'' if a is None else f'{a:.2f}':>6}".rstrip())
    about = wrapped("computed", "on the finest grid, as a rule too high; the frequency given is that less its error as the mode itself "
                                "tells it, by what it leaves of the equations")
    return lines + ["", *about_errors(report, "the frequency"), *about, *wrapped("order", "as observed on three grids"),
                    *wrapped("shape", "how much of the mode is that of the grid before")]


def quantities(report):
    entries = report["quantities"]
    width = max(len(entry["name"]) for entry in entries)
    lines = ["", f"  {'':<{width}}  {'value':>12} {'':<5}  {'error':>9}  {'order':>6}"]
    for entry in entries:
        order = "" if entry["order"] is None else f"{entry['order']:.1f}"
        value = "" if entry["value"] is None else f"{entry['value']:.5g}"
        error = percent(entry["error"]) if entry["has_limit"] else "no limit"
        lines.append(f"  {entry['name']:<{width}}  {value:>12} {entry['unit']:<5}  {error:>9}  {order:>6}".rstrip())
        if entry["note"]:
            lines.append(f"  {'':<{width}}    {entry['note']}")
    return lines + ["", *about_errors(report, "the value"), *wrapped("order", "as observed on three grids")]


def about_errors(report, what):
    order = report["order_relied_on"]
    why = " (sharp re-entrant edges, or ends of supports)" if report["command"] not in ("drop", "impact") and order <= REENTRANT_ORDER else ""
    solution = ", and from what the solution leaves of the equations; the larger counts" if report["command"] in ("modes", "static") else ""
    return wrapped("error", f"estimated distance from the limit of smaller and smaller spans, relative: from how {what} changes from grid "
                            f"to grid, with order {order:.3g} relied on at most{why}{solution}. Not in it: facets instead of the exact "
                            "part, the material, the supports.")


def wrapped(word, text):
    return textwrap.wrap(text, WIDTH, initial_indent=f"{word:<{MARGIN - 1}} ", subsequent_indent=MARGIN * " ")


def text(report):
    body = modes(report) if report["command"] == "modes" else quantities(report)
    return "\n".join([*head(report), *body, "", *tail(report)]) + "\n"
