"""Tables and lists of the page, as HTML."""
from html import escape


MOST_WRITTEN_OUT = 1e8  # beyond it an exponent is easier to read


def number(value, digits=5):
    """With so many digits that count; a large one without exponent, rounded likewise."""
    if value is None:
        return "unknown"
    rounded = f"{value:.{digits}g}"
    return f"{float(rounded):.0f}" if 1 <= abs(value) < MOST_WRITTEN_OUT and "e" in rounded else rounded


def percent(share):
    return "unknown" if share is None else f"{number(100 * share, 2)} %"


def row(cells, heading=False):
    """Cells are HTML; the first one of a row that is no heading names the row."""
    if heading:
        return "<tr>" + "".join(f'<th scope="col">{cell}</th>' for cell in cells) + "</tr>"
    return f'<tr><th scope="row">{cells[0]}</th>' + "".join(f"<td>{cell}</td>" for cell in cells[1:]) + "</tr>"


def table(caption, headings, rows):
    """Headings are text, cells of the rows HTML."""
    name = escape(caption)
    return (f'<div class="wide" role="region" tabindex="0" aria-label="{name}"><table><caption>{name}</caption>'
            f"<thead>{row(map(escape, headings), heading=True)}</thead>"
            f"<tbody>{''.join(row(cells) for cells in rows)}</tbody></table></div>")


def facts(pairs):
    """Names with what belongs to them; pairs without it are left out."""
    rows = "".join(f"<div><dt>{escape(name)}</dt><dd>{escape(str(value))}</dd></div>" for name, value in pairs if value)
    return f'<dl class="facts">{rows}</dl>'


def listed(texts):
    return "<ul>" + "".join(f"<li>{escape(str(text))}</li>" for text in texts) + "</ul>"
