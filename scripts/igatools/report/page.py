"""Puts the page together: texts and tables, scripts, styles, arrays."""
import json
from html import escape
from pathlib import Path

from igatools.report import answer, convergence, energies, scene, tables, threed

HERE = Path(__file__).parent
SCRIPTS = ["tabs", "plots", "arrays", "colours", "surface", "camera", "view", "picture", "controls", "start"]  # in this order
TITLES = {"modes": "Vibration modes", "static": "Static analysis", "drop": "Drop test", "impact": "Impact",
          "buckling": "Buckling", "heat": "Steady temperatures", "harmonic": "Frequency response", "random": "Random vibration",
          "transient": "Transient response"}


def html(report, folder):
    """Text of the page of a report (the object of report.json) whose files lie in or below `folder`."""
    library = threed.library()
    shown = scene.Scene(report, folder)
    data = shown.data() if library else None
    panels = [("answer", "Answer", answer.html(report)), ("view", "3-D view", view(library, data, shown.notes)),
              ("convergence", "Convergence", convergence.html(report)), ("energies", "Energies", energies.html(report, folder)),
              ("warnings", remarks_in_words(report), warnings(report)), ("repeat", "Repeat", repeat(report))]
    panels = [panel for panel in panels if panel[2] is not None]
    part = Path(report.get("part") or "").name
    texts = {"title": escape(f"{title(report)}: {part}"), "heading": escape(title(report)), "part": escape(part),
             "verdict": verdict(report), "style": (HERE / "page.css").read_text(), "tabs": tab_buttons(panels),
             "panels": "".join(panel_html(*panel) for panel in panels), "data": embedded(data),
             "library": f"<script>{library}</script>" if data else "",
             "licence": licence() if data else "",
             "script": "\n".join((HERE / "js" / f"{name}.js").read_text() for name in SCRIPTS)}
    return filled((HERE / "page.html").read_text(), texts)


def filled(template, texts):
    """{{name}} replaced once, so that nothing inside the texts is looked at."""
    pieces = template.split("{{")
    return pieces[0] + "".join(texts[name] + rest for name, rest in (piece.split("}}", 1) for piece in pieces[1:]))


def embedded(data):
    """JSON that is safe inside a script element."""
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")


def title(report):
    return TITLES.get(report.get("command"), "Vibration modes" if "frequencies" in report else "Analysis")


def tab_buttons(panels):
    return "".join(f'<button type="button" role="tab" id="tab-{key}" aria-controls="panel-{key}" aria-selected="false" '
                   f'tabindex="-1">{escape(name)}</button>' for key, name, _ in panels)


def panel_html(key, name, content):
    return (f'<section role="tabpanel" id="panel-{key}" aria-labelledby="tab-{key}" tabindex="0">'
            f"<h2>{escape(name)}</h2>{content}</section>")


def verdict(report):
    """One line: was the tolerance reached?"""
    tolerance = report.get("tolerance")
    if tolerance is None:
        return '<p class="verdict">No tolerance was asked for; errors are estimated.</p>'
    asked = tables.percent(tolerance)
    if report.get("reached"):
        is_for_all = all(q.get("counts", True) for q in report.get("quantities") or [])
        words = "all estimated errors are below it" if is_for_all else "all errors that it applies to are below it"
        return f'<p class="verdict good"><span aria-hidden="true">✓</span> Tolerance of {asked} reached: {words}.</p>'
    words = "the run was interrupted" if report.get("interrupted") else "see the errors and the warnings"
    return f'<p class="verdict bad"><span aria-hidden="true">✗</span> Tolerance of {asked} not reached: {words}.</p>'


def view(library, data, notes):
    remarks = tables.listed(notes) if notes else ""
    if library is None:
        return f'<p class="note">{escape(threed.ABSENT)}</p>'
    if data is None:
        return f'<p class="note">There is no surface to draw.</p>{remarks}'
    return (HERE / "view.html").read_text() + remarks


REMARKS = [("warnings", "Warnings", "What may make the numbers wrong."),
           ("notes", "Notes of this run", "Why the run stopped where it did, and what was left out."),
           ("findings", "What was found about the part", "Properties of the surface and of the model that are worth knowing.")]


def remarks_in_words(report):
    """Name of the tab: warnings are told apart from what is merely worth knowing."""
    warned, others = len(report.get("warnings") or []), sum(len(report.get(key) or []) for key in ("notes", "findings"))
    return ", ".join(f"{name} ({count})" for name, count in (("Warnings", warned), ("Notes", others)) if count) or "Notes (0)"


def warnings(report):
    parts = [f"<h3>{heading}</h3><p>{meaning}</p>{tables.listed(report[key])}"
             for key, heading, meaning in REMARKS if report.get(key)]
    if not report.get("reached", True):
        parts.insert(0, f"<h3>Tolerance</h3><p>The tolerance of {tables.percent(report.get('tolerance'))} was not reached.</p>")
    return "".join(parts) or "<p>There are no warnings, notes or findings.</p>"


def repeat(report):
    commands = report.get("commands") or []
    listing = "\n".join(commands)
    shown = ('<p>These commands repeat the run on the finest grid:</p><pre id="commands" tabindex="0" aria-label="Commands">'
             f'{escape(listing)}</pre><button type="button" id="copy">Copy the commands</button>'
             '<span role="status" id="copied"></span>'
             if commands else "<p>The report holds no commands; log.txt beside it lists all that ran.</p>")
    versions = report.get("versions") or {}
    return shown + "<h3>Files and versions</h3>" + tables.facts(
        [("Model", report.get("model")), ("Results", report.get("results")), ("Energies", report.get("energies")),
         *((name, version) for name, version in versions.items())])


def licence():
    text = escape(threed.LICENCE.read_text())
    return f"<details><summary>Licence of three.js, which draws the 3-D view</summary><pre>{text}</pre></details>"
