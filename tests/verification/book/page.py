"""The book as text for the terminal, as tables of the README, and as one HTML page."""
import html as markup
import re
from pathlib import Path

from book import pictures
from igatools.whole_file import write_text

README = Path(__file__).resolve().parents[1] / "README.md"
TABLES = "<!-- tables: written by scripts/verify --write -->", "<!-- end of tables -->"
HEADER = ("case", "quantity", "exact", "coarse", "middle", "fine", "order", "claimed", "CalculiX", "ours / CalculiX", "CPU s")


def percent(share):
    """A signed error with two digits, in per cent."""
    size = abs(100 * share)
    if size < 5e-6:
        return "0 %"
    return f"{100 * share:+.2g} %" if size < 10 else f"{100 * share:+.0f} %"


def number(value):
    return f"{value:.6g}"


def thousands(count):
    return f"{count:,}".replace(",", " ")


def rows(outcome):
    """A row for each quantity of a case, in the order of HEADER."""
    case, found = outcome.case, outcome.grids
    for quantity, exact in case.exact_values().items():
        def cell(run):
            return f"{number(run.values[quantity])} ({percent(case.error(quantity, run.values[quantity]))})" if run else "–"
        order, ratio = outcome.order(quantity), outcome.beside_calculix(quantity)
        yield (case.id, quantity, f"{number(exact)} {case.unit_of(quantity)}".strip(), *map(cell, found),
               "–" if order is None else f"{order:.1f}", f"{100 * case.claimed(quantity):.2g} %", cell(outcome.calculix),
               "–" if ratio is None else f"{ratio:.2g}", "–" if found[-1] is None else f"{found[-1].seconds:.1f}")


def unknowns(outcome):
    """Numbers of unknowns of the three grids and of CalculiX, in the order of HEADER."""
    counts = [thousands(run.unknowns) if run and run.unknowns else "" for run in (*outcome.grids, outcome.calculix)]
    return ("", "unknowns", "", *counts[:3], "", "", counts[3], "", "")


def text_table(outcomes):
    lines = [HEADER]
    for outcome in outcomes:
        lines += [*rows(outcome), unknowns(outcome)]
    widths = [max(len(line[k]) for line in lines) for k in range(len(HEADER))]
    return "\n".join("  ".join(cell.ljust(width) if k < 2 else cell.rjust(width)
                               for k, (cell, width) in enumerate(zip(line, widths))).rstrip() for line in lines)


def by_topic(topics, outcomes):
    for topic, (heading, _) in topics.items():
        of_topic = [outcome for outcome in outcomes if outcome.case.topic == topic]
        if of_topic:
            yield topic, heading, of_topic


def verdicts(outcomes):
    """Numbers of quantities whose error is below 0.8 times, like, and above 1.25 times CalculiX's, and the last ones' rows."""
    better, like, worse = 0, 0, []
    for outcome in outcomes:
        for quantity in outcome.case.exact_values():
            ratio = outcome.beside_calculix(quantity)
            if ratio is None:
                continue
            better, like = better + (ratio < 0.8), like + (0.8 <= ratio <= 1.25)
            if ratio > 1.25:
                worse.append((outcome.case, quantity, ratio))
    return better, like, worse


def sentences(*parts):
    return " ".join(part if part.endswith((".", ")")) else part + "." for part in parts if part)


# --------------------------------------------------------------------------------------------------------------- markdown

def markdown_topic(topic, heading, outcomes):
    lines = [f"<!-- topic {topic} -->", f"### {heading}", "", "| " + " | ".join(HEADER) + " |",
             "|---|---|" + "---:|" * (len(HEADER) - 2)]
    for outcome in outcomes:
        for k, row in enumerate([*rows(outcome), unknowns(outcome)]):
            lines.append("| " + " | ".join((f"`{row[0]}`" if k == 0 else "", *row[1:])) + " |")
    lines.append("")
    for outcome in outcomes:
        case = outcome.case
        spans = ", ".join(map(str, case.grids))
        mesh = f"CalculiX: {case.calculix_mesh}" if case.calculix_mesh else ""
        lines.append(f"- **{case.title}** (`{case.id}`). "
                     + sentences(case.geometry, case.material, f"Grids {spans}", mesh, f"Source: {case.source}", case.notes))
    return "\n".join([*lines, f"<!-- end of {topic} -->"])


def write_readme(topics, outcomes, path=README):
    """Replaces the tables of the topics that ran whole and without faults; those of other topics stay, of topics that are gone go.
    Returns words about topics whose tables stay."""
    text = path.read_text(encoding="utf-8")
    begin, end = (text.index(marker) for marker in TABLES)
    old = dict(re.findall(r"<!-- topic (\w+) -->\n(.*?)<!-- end of \1 -->", text[begin:end], re.S))
    new = {topic: f"<!-- topic {topic} -->\n{body}<!-- end of {topic} -->" for topic, body in old.items() if topic in topics}
    kept = []
    for topic, heading, of_topic in by_topic(topics, outcomes):
        if len(of_topic) == len(topics[topic][1]) and not any(outcome.faults for outcome in of_topic):
            new[topic] = markdown_topic(topic, heading, of_topic)
        else:
            kept.append(f"--write: topic '{topic}' did not run whole and without faults; its table in {path} stays as it was")
    tables = "\n\n".join(new[topic] for topic in topics if topic in new)
    write_text(path, f"{text[:begin]}{TABLES[0]}\n\n{tables}\n\n{text[end:]}")
    return kept


# ------------------------------------------------------------------------------------------------------------------- html

STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #1d2733; max-width: 1500px; margin: 2em auto; padding: 0 1.5em; }
h1 { font-size: 1.7em; } h2 { margin-top: 2.2em; border-bottom: 2px solid #d5dde6; } h3 { margin: 1.6em 0 .3em; }
table { border-collapse: collapse; font-size: 12.5px; margin: .6em 0; } td, th { padding: .25em .4em; text-align: right; white-space: nowrap; }
th { background: #eef2f6; font-weight: 600; } td:first-child, th:first-child { text-align: left; } tr + tr td { border-top: 1px solid #e3e8ee; }
.unknowns td { color: #66727f; } .missed td, .fault { background: #fde7e4; } .worse { color: #b3541e; } .better { color: #1c7a3e; }
.case { display: grid; grid-template-columns: 200px minmax(0, 1fr); gap: 0 1em; margin-bottom: 1.6em; } .case img { width: 200px; }
.case > div { overflow-x: auto; } .case p { margin: .25em 0; } .small { color: #55606c; font-size: 13px; } code { background: #eef2f6; padding: 0 .25em; }
"""


def html_table(outcome):
    case, many = outcome.case, len(outcome.case.exact_values()) > 1
    keep = [k for k in range(1, len(HEADER)) if k != 1 or many]
    lines = ["<table><tr>" + "".join(f"<th>{HEADER[k]}</th>" for k in keep) + "</tr>"]
    for quantity, row in zip(case.exact_values(), rows(outcome)):
        found, ratio = outcome.grids[-1], outcome.beside_calculix(quantity)
        held = found is not None and abs(case.error(quantity, found.values[quantity])) <= case.claimed(quantity)
        cells = [markup.escape(row[k]) for k in keep]
        if ratio is not None:
            kind = "better" if ratio < 0.8 else "worse" if ratio > 1.25 else "like"
            cells[-2] = f'<span class="{kind}">{cells[-2]}</span>'
        lines.append(f"<tr{'' if held else ' class=missed'}>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    row = unknowns(outcome)
    cells = [row[k] if k != 2 or many else "unknowns" for k in keep]
    return "\n".join([*lines, '<tr class="unknowns">' + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr></table>"])


def html_case(outcome):
    case = outcome.case
    say = lambda word, text: f"<p><b>{word}</b> {markup.escape(text)}</p>" if text else ""  # noqa: E731
    picture = pictures.part(outcome.triangles) if outcome.triangles is not None else ""
    image = f'<img alt="{markup.escape(case.title)}" src="{picture}">' if picture else ""
    chart = pictures.convergence(outcome)
    faults = "".join(f'<p class="fault">{markup.escape(words)}</p>' for words in outcome.faults)
    return "\n".join([
        f'<h3 id="{case.id}">{markup.escape(case.title)} <code>{case.id}</code></h3>', '<div class="case"><div>' + image
        + (f'<img alt="errors over unknowns" src="{chart}">' if chart else "") + "</div><div>",
        say("Part.", case.geometry), say("Material.", case.material), say("Source.", case.source), html_table(outcome),
        f'<p class="small">Grids: {markup.escape(", ".join(map(str, case.grids)))}. '
        + (f"CalculiX: {markup.escape(case.calculix_mesh)}." if case.calculix_mesh else "") + "</p>", say("", case.notes), faults,
        "</div></div>"])


def html(topics, outcomes, seconds):
    """The whole page."""
    better, like, worse = verdicts(outcomes)
    held = sum(not outcome.missed() and not outcome.faults for outcome in outcomes)
    summary = (f"<p>{held} of {len(outcomes)} cases hold what they claim at their finest grid. All took {seconds:.0f} s, each program on one "
               "thread. <i>Order</i>: slope of the error between the two finest grids over the span size. <i>ours / CalculiX</i>: our error "
               "over that of CalculiX, at the grid whose unknowns are nearest to its own (within a factor of two). <i>CPU s</i>: igaprep and "
               "igasolve at the finest grid.</p>")
    if better or like or worse:
        summary += (f"<p>Beside CalculiX with like numbers of unknowns: <span class=better>{better} quantities have a smaller error</span>, "
                    f"{like} a like one, <span class=worse>{len(worse)} a larger one</span>"
                    + (": " + ", ".join(f'<a href="#{case.id}">{markup.escape(case.id + (", " + quantity if quantity else ""))}</a> '
                                        f"({ratio:.2g} times)" for case, quantity, ratio in worse) if worse else "") + ".</p>")
    parts = ["<!doctype html><html lang=en><head><meta charset=utf-8><title>Verification book</title>", f"<style>{STYLE}</style></head>",
             "<body><h1>Verification book</h1>", summary]
    for topic, heading, of_topic in by_topic(topics, outcomes):
        parts += [f'<h2 id="{topic}">{markup.escape(heading)}</h2>', *map(html_case, of_topic)]
    return "\n".join([*parts, "</body></html>\n"])
