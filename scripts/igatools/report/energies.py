"""The energies tab of runs over time, from the table that igasolve wrote."""
import csv
import math
from html import escape

from igatools.report import plots, tables, units
from igatools.report.files import located

MOST_POINTS = 600  # of a curve


class TableError(Exception):
    """What is wrong with the table, in words."""


def read(path):
    """Names of the columns and rows of numbers."""
    with open(path, newline="") as file:
        lines = list(csv.reader(file))
    if not lines or len(lines[0]) < 2:
        raise TableError(f"{path}: line 1: expected the names of at least two columns, the first one time")
    rows = []
    for number, line in enumerate(lines[1:], 2):
        try:
            values = [float(word) for word in line]
        except ValueError as error:
            raise TableError(f"{path}: line {number}: {error}, expected numbers") from None
        if len(values) != len(lines[0]):
            raise TableError(f"{path}: line {number}: found {len(values)} numbers, expected {len(lines[0])}")
        rows.append(values)
    if len(rows) < 2:
        raise TableError(f"{path}: found {len(rows)} rows of numbers, expected at least two")
    return lines[0], rows


def html(report, folder):
    """None where the run has no energies."""
    if not report.get("energies"):
        return None
    path = located(folder, report["energies"])
    if path is None:
        return f"<p>The table of energies {escape(str(report['energies']))} was not found.</p>"
    try:
        names, rows = read(path)
    except (OSError, TableError) as error:
        return f"<p>The table of energies cannot be shown: {escape(str(error))}.</p>"
    return drawn(names, rows, units.of_report(report)) + balance(report)


def balance(report):
    error = report.get("energy_error")
    return "" if error is None else f"<p>Largest relative error of the energy balance: {tables.percent(error)}.</p>"


def is_energy(heading):
    """Headings end with a unit in brackets; that of an energy has a force in it."""
    return "[force*" in heading


def drawn(names, rows, unit):
    energies = [k for k, name in enumerate(names) if is_energy(name)]
    plain = [name.split(" [")[0] for name in names]
    step = math.ceil(len(rows) / MOST_POINTS)
    shown = rows[::step] + ([rows[-1]] if (len(rows) - 1) % step else [])
    columns = list(zip(*rows))
    curves = [plots.Curve(plain[k], [(row[0], row[k]) for row in shown]) for k in energies if any(columns[k])]
    values = [y for curve in curves for _, y in curve.points] or [0.0]
    x_axis = plots.linear_axis(units.headed("Time", unit["time"]), columns[0], ends_at_ticks=False)
    y_axis = plots.linear_axis(units.headed("Energy", unit["energy"]), values)
    lines = [[escape(plain[k]), *(tables.number(v) for v in (columns[k][0], min(columns[k]), max(columns[k]), columns[k][-1]))]
             for k in energies]
    headings = ["Energy", "at the start", "smallest", "largest", "at the end"]
    thinned = f"<p>The curves are drawn with {len(shown):,} of {len(rows):,} times; the table has all.</p>" if step > 1 else ""
    return (plots.figure("Energies over time; the table below has starts, ends and extremes.", curves, x_axis, y_axis,
                         with_markers=False) + thinned
            + tables.table(units.headed("Energies", unit["energy"]), headings, lines))
