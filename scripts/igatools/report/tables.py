"""Tables and lists of the page, as HTML."""
from html import escape

from igatools.report import units


def number(value, digits=5):
    return "unknown" if value is None else f"{value:.{digits}g}"


def percent(share):
    return "unknown" if share is None else f"{100 * share:.2g} %"


def row(cells, heading=False):
    """Cells are HTML; the first one of a row that is no heading names the row."""
    if heading:
        return "<tr>" + "".join(f'<th scope="col">{cell}</th>' for cell in cells) + "</tr>"
    return f'<tr><th scope="row">{cells[0]}</th>' + "".join(f"<td>{cell}</td>" for cell in cells[1:]) + "</tr>"


def table(caption, headings, rows):
    return (f'<div class="wide" role="region" tabindex="0" aria-label="{escape(caption)}"><table><caption>{escape(caption)}</caption>'
            f"<thead>{row(map(escape, headings), heading=True)}</thead><tbody>{''.join(row(r) for r in rows)}</tbody></table></div>")


def facts(pairs):
    """Names with what belongs to them; pairs without it are left out."""
    rows = "".join(f"<div><dt>{escape(name)}</dt><dd>{escape(str(value))}</dd></div>" for name, value in pairs if value)
    return f'<dl class="facts">{rows}</dl>'


def listed(texts):
    return "<ul>" + "".join(f"<li>{escape(str(text))}</li>" for text in texts) + "</ul>"


def error_bar(error, tolerance, widest):
    """Picture of ±error within ±widest, the tolerance as two thin lines; the row's text says the same."""
    if error is None:
        return ""
    place = lambda share: 60 + 54 * max(-1.0, min(1.0, share / widest))  # noqa: E731
    lines = [f'<path class="axis" d="M60 2V18"/>',
             f'<path class="bar" d="M{place(-error):.1f} 10H{place(error):.1f}M{place(-error):.1f} 5V15M{place(error):.1f} 5V15"/>']
    if tolerance and tolerance <= widest:
        lines.append(f'<path class="limit" d="M{place(-tolerance):.1f} 0V20M{place(tolerance):.1f} 0V20"/>')
    return f'<svg class="error" viewBox="0 0 120 20" aria-hidden="true">{"".join(lines)}<circle class="dot" cx="60" cy="10" r="2.5"/></svg>'


def interval(value, error):
    if value is None or error is None:
        return "unknown"
    reach = abs(value) * error
    # As many digits as tell both ends apart.
    digits = 5 if error > 1e-4 else 7
    return f"{value - reach:.{digits}g} … {value + reach:.{digits}g}"


def modes(report):
    unit = units.of_report(report)["frequency"]
    errors, tolerance = report["errors"], report.get("tolerance")
    widest = max([e for e in errors if e is not None] + [tolerance or 0, 1e-12])
    rigid = report.get("rigid_modes") or 0
    rows = []
    for k, (f, e, q, a) in enumerate(zip(report["frequencies"], errors, report["orders"], report["agreements"])):
        rows.append([str(rigid + k + 1), number(f), f"± {percent(e)}" if e is not None else "unknown", interval(f, e),
                     error_bar(e, tolerance, widest), "" if q is None else f"{q:.1f}", "" if a is None else f"{100 * a:.0f} %"])
    headings = ["Mode", units.headed("Frequency", unit), "Estimated error", units.headed("Interval", unit),
                f"Error bars, full width ± {percent(widest)}", "Observed order", "Same shape as on the grid before"]
    return table("Elastic modes with their estimated errors", headings, rows)


def quantities(report):
    found, tolerance = report.get("quantities") or [], report.get("tolerance")
    widest = max([q["error"] for q in found if q.get("error") is not None] + [tolerance or 0, 1e-12])
    rows = []
    for q in found:
        e = q.get("error")
        order = q.get("order")
        rows.append([escape(q["name"]), number(q.get("value")), escape(q.get("unit") or ""),
                     f"± {percent(e)}" if e is not None else "unknown", interval(q.get("value"), e),
                     error_bar(e, tolerance, widest), "" if order is None else f"{order:.1f}"])
    headings = ["Quantity", "Value", "Unit", "Estimated error", "Interval", f"Error bars, full width ± {percent(widest)}",
                "Observed order"]
    return table("Results with their estimated errors", headings, rows)
