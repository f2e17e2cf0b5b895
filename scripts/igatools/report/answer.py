"""The answer tab: the numbers with their estimated errors, what acted on the part, what was asked."""
from html import escape

from igatools.report import convergence, tables, units
from igatools.report.tables import number, percent


def html(report):
    if "frequencies" in report:
        body = f"<p>{escape(modes_in_words(report))}</p>{modes(report)}<p>{MODE_COLUMNS}</p>"
    else:
        body = quantities(report)
    return (f"{body}<p>{escape(convergence.explanation(report))}</p>{forces(report)}"
            f"<h3>What was asked, and what it took</h3>{asked(report)}")


MODE_COLUMNS = ("Computed: on the finest grid, as a rule too high; the frequency is that less its error as the mode itself tells "
                "it, by what it leaves of the equations. Interval: frequency less and plus the estimated error. Observed order: how fast the changes between the last "
                "three grids fell; it is only shown, the estimate does not use it. Same shape: how much of the mode is in the "
                "shapes of the grid before.")


def modes_in_words(report):
    rigid, unit = report.get("rigid_modes") or 0, units.of_report(report)["frequency"]
    words = f"{len(report['frequencies'])} elastic modes" + (f" after {rigid} rigid-body modes" if rigid else "")
    words += "; none is missing below the highest (Sturm count)." if report.get("complete") else "."
    if not report["frequencies"]:
        return words
    lowest = units.with_unit(number(report["frequencies"][0]), unit)
    return f"{words} The lowest elastic frequency is {lowest}, with {error_text(report['errors'][0])}."


def error_text(error):
    return "an unknown error" if error is None else f"an estimated error of {percent(error)}"


def modes(report):
    unit = units.of_report(report)["frequency"]
    errors, tolerance = report["errors"], report.get("tolerance")
    widest = widest_of(errors, tolerance)
    rigid = report.get("rigid_modes") or 0
    rows = []
    columns = zip(report["frequencies"], errors, report.get("computed") or report["frequencies"], report["orders"],
                  report["agreements"])
    for k, (f, e, computed, q, a) in enumerate(columns):
        rows.append([str(rigid + k + 1), number(f), plus_minus(e), interval(f, e), error_bar(e, tolerance, widest), number(computed),
                     "" if q is None else f"{q:.1f}", "" if a is None else f"{100 * a:.0f} %"])
    headings = ["Mode", units.headed("Frequency", unit), "Estimated error", units.headed("Interval", unit),
                bar_heading(widest, tolerance), units.headed("Computed", unit), "Observed order",
                "Same shape as on the grid before"]
    return tables.table("Elastic modes with their estimated errors", headings, rows)


def quantities(report):
    found, tolerance = report.get("quantities") or [], report.get("tolerance")
    widest = widest_of([q.get("error") for q in found], tolerance)
    rows = []
    for q in found:
        value, error, order = q.get("value"), q.get("error"), q.get("order")
        has_limit = q.get("has_limit", True)
        words = [q["note"]] if q.get("note") else []
        words += ["the tolerance does not apply"] if tolerance and not q.get("counts", True) else []
        remark = f'<span class="remark">{escape("; ".join(words))}</span>' if words else ""
        rows.append([escape(q["name"]) + remark, "none" if value is None else number(value), escape(q.get("unit") or ""),
                     plus_minus(error) if has_limit else "has no limit", interval(value, error),
                     error_bar(error, tolerance, widest), "" if order is None else f"{order:.1f}"])
    headings = ["Quantity", "Value", "Unit", "Estimated error", "Interval", bar_heading(widest, tolerance), "Observed order"]
    return tables.table("Results with their estimated errors", headings, rows)


def forces(report):
    """Supports and loads of a static run; nothing of others."""
    unit = units.of_report(report)
    entries = [(kind, entry) for kind, key in (("Support", "supports"), ("Load", "loads")) for entry in report.get(key) or []]
    if not entries:
        return ""
    round_off = 1e-9 * max(abs(c) for _, entry in entries for c in entry["force"])
    rows = [[escape(f"{kind} {entry['name']}"), *(number(c if abs(c) > round_off else 0.0, 4) for c in entry["force"]),
             number(entry["area"], 4) if entry.get("area") else ""] for kind, entry in entries]
    headings = ["Acts by", *(units.headed(f"Force {axis}", unit["force"]) for axis in "xyz"),
                units.headed("Area", unit["length"] and f"{unit['length']}²")]
    return tables.table("Forces on the part: of the loads, and of the supports that hold it", headings, rows)


def asked(report):
    unit, sizes = units.of_report(report), report.get("span_sizes") or []
    mass = report.get("mass")
    return tables.facts([
        ("Part", report.get("part")), ("Material", material(report, unit)), ("Run file", report.get("run_file")),
        ("Tolerance", None if report.get("tolerance") is None else percent(report["tolerance"])),
        ("Mass", None if mass is None else mass_in_words(mass, unit["mass"])),
        ("Length unit", unit["length"]),
        ("Span sizes", units.with_unit(", ".join(f"{h:.4g}" for h in sizes), unit["length"]) if sizes else None),
        ("Unknowns", ", ".join(f"{n:,}" for n in report.get("unknowns") or [])),
        ("Computing time", None if report.get("seconds") is None else f"{report['seconds']:.1f} s"),
        ("Memory", None if not report.get("peak_memory") else f"{report['peak_memory']:.0f} MiB")])


def material(report, unit):
    found = report.get("material") or {}
    words = [units.with_unit(f"{name} = {found[key]:g}", unit.get(of, ""))
             for key, name, of in (("E", "E", "stress"), ("nu", "ν", ""), ("rho", "ρ", "density")) if found.get(key) is not None]
    return ", ".join(word for word in [found.get("name"), *words] if word)


def mass_in_words(mass, unit):
    """Tonnes, which go with mm and s, are too large for most parts."""
    return f"{number(1000 * mass)} kg" if unit == "t" else units.with_unit(number(mass), unit)


def plus_minus(error):
    return "unknown" if error is None else f"± {percent(error)}"


def interval(value, error):
    if value is None or error is None:
        return "unknown"
    reach = abs(value) * error
    digits = 5 if error > 1e-4 else 7  # as many as tell both ends apart
    return f"{number(value - reach, digits)} … {number(value + reach, digits)}"


def widest_of(errors, tolerance):
    """Half the width of the pictures of errors."""
    return max([e for e in errors if e is not None] + [tolerance or 0, 1e-12])


def bar_heading(widest, tolerance):
    return f"Error bars, full width ± {percent(widest)}" + (", tolerance dashed" if tolerance else "")


def error_bar(error, tolerance, widest):
    """Picture of ± error within ± widest; the row's text says the same."""
    if error is None:
        return ""
    low, high = 60 - 54 * error / widest, 60 + 54 * error / widest
    limit = ""
    if tolerance:
        reach = 54 * tolerance / widest
        limit = f'<path class="limit" d="M{60 - reach:.1f} 0V20M{60 + reach:.1f} 0V20"/>'
    return ('<svg class="error" viewBox="0 0 120 20" aria-hidden="true"><path class="axis" d="M60 2V18"/>'
            f'<path class="bar" d="M{low:.1f} 10H{high:.1f}M{low:.1f} 5V15M{high:.1f} 5V15"/>{limit}'
            '<circle class="dot" cx="60" cy="10" r="2.5"/></svg>')
