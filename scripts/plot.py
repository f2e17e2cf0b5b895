#!/usr/bin/python3
"""Plots of numbers:

  scripts/plot.py spectrum modes.h5 [more.h5 ...] [-o spectrum.png]    frequencies over mode numbers, rigid modes marked
  scripts/plot.py convergence errors.csv [-o errors.png] [--fit 3]     errors over span sizes, log-log, with fitted rates
  scripts/plot.py force run.h5 [more.h5 ...] [--contact NAME] [--mean 0.2]   contact force over time, means of a window
  scripts/plot.py energy run.h5                                        energies of an explicit run over time
  scripts/plot.py response run.h5 [--table probe_tip] [--columns acceleration_z von_mises]   harmonic, random, transient runs

A CSV file of errors has a header; its first column is the span size (or a number of unknowns), every other one a series of
errors, named by its header. Empty entries are left out. The rate is fitted to the last entries of a series in the order of
the file's lines, --fit of them.
"""
import argparse
import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from igatools import iga_results  # noqa: E402

MARKERS = "osD^vP*X"
TEXT_COLOUR = "#20242a"


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = parser.add_subparsers(dest="kind", required=True)
    spectrum = kinds.add_parser("spectrum", help="frequencies of results files")
    spectrum.add_argument("files", type=Path, nargs="+", help="results files of igasolve eigen")
    spectrum.add_argument("--labels", nargs="+", help="names of the files in the plot (default: the files' own)")
    convergence = kinds.add_parser("convergence", help="errors over span sizes, from a CSV file")
    convergence.add_argument("files", type=Path, nargs=1, help="CSV file")
    convergence.add_argument("--fit", type=int, default=3, help="number of last entries that the rate is fitted to")
    force = kinds.add_parser("force", help="contact force of explicit runs over time")
    force.add_argument("files", type=Path, nargs="+", help="results files of igasolve explicit")
    force.add_argument("--contact", help="name of the contact (default: the first one)")
    force.add_argument("--mean", type=float, help="length of the windows that the force is averaged over (default: end / 40)")
    force.add_argument("--labels", nargs="+", help="names of the files in the plot (default: the files' own)")
    energy = kinds.add_parser("energy", help="energies of an explicit run over time")
    energy.add_argument("files", type=Path, nargs=1, help="results file of igasolve explicit")
    response = kinds.add_parser("response", help="probes and supports of harmonic, random and transient runs")
    response.add_argument("files", type=Path, nargs=1, help="results file of igasolve harmonic, random or transient")
    response.add_argument("--table", help="table of the results, such as probe_tip, psd_tip, support_base (default: the first one)")
    response.add_argument("--columns", nargs="+", help="columns of the table (default: the largest acceleration or force)")
    for kind in (spectrum, convergence, force, energy, response):
        kind.add_argument("-o", "--output", type=Path, help="picture (.png, .svg, .pdf); default: beside the first file")
        kind.add_argument("--title", help="title of the plot")
    return parser.parse_args()


def new_plot(title):
    figure, axes = plt.subplots(figsize=(10, 6.4), dpi=120, constrained_layout=True)
    axes.set_title(title, fontsize=15, weight="bold", color=TEXT_COLOUR, loc="left", pad=14)
    axes.grid(True, color="#dfe2e6", linewidth=0.8)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure, axes


# ------------------------------------------------------------------------------------------------------------- spectrum

def read_spectrum(path):
    results = iga_results.read(path)
    if "/eigen" not in results:
        raise iga_results.FormatError("holds no modes; run igasolve eigen")
    return results


def bars(axes, results):
    """One spectrum as bars, each kind of mode in its colour, frequencies written above where there is room."""
    f, kinds = results["/frequencies"], np.array(results.kinds())
    number = np.arange(1, len(f) + 1)
    top = f.max(initial=0) or 1.0
    elastic = kinds == "ELASTIC"
    axes.bar(number[elastic], f[elastic], width=0.72, color="#2a6ba8", label="elastic")
    for kind, colour, marker, label in (("RIGID", "#f0a33f", "s", "rigid"), ("MECHANISM", "#c0392b", "X", "mechanism")):
        chosen = kinds == kind
        if chosen.any():
            axes.plot(number[chosen], f[chosen], linestyle="none", marker=marker, markersize=9, color=colour,
                      label=f"{label} ({chosen.sum()})", clip_on=False, zorder=3)
    if len(f) <= 24:
        axes.set_xticks(number)
        for n, value in zip(number[elastic], f[elastic]):
            axes.annotate(f"{value:.4g}", (n, value), xytext=(0, 4), textcoords="offset points", ha="center", fontsize=9,
                          color=TEXT_COLOUR)
    axes.set_ylim(0, 1.1 * top)
    axes.set_xlim(0.3, len(f) + 0.7)
    axes.grid(False, axis="x")


def steps(axes, results, label, marker):
    """Elastic frequencies of one of several files, counted from the first elastic one."""
    f = results["/frequencies"][results.elastic()]
    axes.plot(np.arange(1, len(f) + 1), f, drawstyle="steps-mid", linewidth=1.6, marker=marker, markersize=5, label=label)


def plot_spectrum(arguments):
    every = [read_checked(path, read_spectrum) for path in arguments.files]
    labels = arguments.labels or [path.stem for path in arguments.files]
    if len(labels) != len(every):
        sys.exit(f"plot.py: {len(labels)} labels for {len(every)} files")
    title = every[0].attribute("/", "title") or arguments.files[0].stem
    figure, axes = new_plot(arguments.title or f"{title}: natural frequencies")
    if len(every) == 1:
        bars(axes, every[0])
        axes.set_xlabel("mode")
    else:
        for results, label, marker in zip(every, labels, MARKERS * len(every)):
            rigid = results.kinds().count("RIGID")
            steps(axes, results, f"{label} ({rigid} rigid)", marker)
        axes.set_xlabel("elastic mode")
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.set_ylim(bottom=0)
    axes.set_ylabel("frequency, cycles per unit of time")
    axes.legend(frameon=False, loc="upper left")
    return figure


# ---------------------------------------------------------------------------------------------------------- convergence

def read_table(path):
    """Name of the first column, its numbers (n), and the other columns by name, NaN where an entry is empty."""
    with open(path, newline="") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    if len(rows) < 3 or len(rows[0]) < 2:
        raise iga_results.FormatError("expected a header, a first column and a column of errors, and two lines at least")
    header = [name.strip() for name in rows[0]]
    table = np.full((len(rows) - 1, len(header)), np.nan)
    for line, row in enumerate(rows[1:]):
        if len(row) != len(header):
            raise iga_results.FormatError(f"line {line + 2} has {len(row)} entries, expected {len(header)}")
        for column, entry in enumerate(row):
            if entry.strip():
                try:
                    table[line, column] = float(entry)
                except ValueError:
                    raise iga_results.FormatError(f"line {line + 2}: '{entry}' is not a number") from None
    if not (table[:, 0] > 0).all():
        raise iga_results.FormatError(f"column '{header[0]}' must hold positive numbers")
    return header[0], table[:, 0], {name: table[:, 1 + i] for i, name in enumerate(header[1:])}


def fitted_rate(x, errors, count):
    """Slope of log |error| over log x through the last `count` entries, NaN where there are fewer than two."""
    good = np.flatnonzero(np.isfinite(errors) & (errors != 0))[-count:]
    if len(good) < 2:
        return np.nan
    return float(np.polyfit(np.log(x[good]), np.log(np.abs(errors[good])), 1)[0])


def plot_convergence(arguments):
    name, x, series = read_checked(arguments.files[0], read_table)
    figure, axes = new_plot(arguments.title or arguments.files[0].stem)
    for (label, errors), marker in zip(series.items(), MARKERS * len(series)):
        rate = fitted_rate(x, errors, arguments.fit)
        good = np.isfinite(errors) & (errors != 0)
        shown = f"{label}: rate {rate:.2f}" if np.isfinite(rate) else label
        line, = axes.loglog(x[good], np.abs(errors[good]), marker=marker, linewidth=1.6, label=shown)
        last = np.flatnonzero(good)[-arguments.fit:]
        if len(last) > 1:
            middle = np.exp(np.log(np.abs(errors[last])).mean()), np.exp(np.log(x[last]).mean())
            axes.loglog(x[last], middle[0] * (x[last] / middle[1]) ** rate, linestyle=":", color=line.get_color())
        print(f"plot.py: {shown}")
    axes.set_xlabel(name)
    if len(x) <= 10:
        axes.set_xticks(x, [f"{value:g}" for value in x])
        axes.set_xticks([], minor=True)
    axes.set_ylabel("|error|")
    axes.grid(True, which="minor", color="#eef0f2", linewidth=0.5)
    axes.legend(frameon=False)
    return figure


# --------------------------------------------------------------------------------------------------------- explicit runs

def read_series(path):
    results = iga_results.read(path)
    if "/time_series/time" not in results:
        raise iga_results.FormatError("holds no time series; run igasolve explicit")
    return results


def plot_force(arguments):
    every = [read_checked(path, read_series) for path in arguments.files]
    labels = arguments.labels or [path.stem for path in arguments.files]
    if len(labels) != len(every):
        sys.exit(f"plot.py: {len(labels)} labels for {len(every)} files")
    names = every[0].texts("/time_series/contact_names") if "/time_series/contact_names" in every[0] else []
    contact = arguments.contact or (names[0] if names else None)
    if contact not in names:
        sys.exit(f"plot.py: contact '{contact}' is not in {arguments.files[0]}; it holds {', '.join(names) or 'none'}")
    window = arguments.mean or every[0]["/time_series/time"][-1] / 40
    figure, axes = new_plot(arguments.title or f"Contact {contact}: force, means over {window:g}")
    curves = []
    for results, label in zip(every, labels):
        time, force = results.mean_force(contact, window)
        curves.append(force)
        impulse = np.linalg.norm(results.series(f"contact/{contact}")["impulse"][-1])
        axes.plot(time, force, linewidth=1.8, label=f"{label}: peak {force.max():.4g}, impulse {impulse:.4g}")
    for force, label in zip(curves[:-1], labels):
        if len(force) == len(curves[-1]):
            difference = np.linalg.norm(force - curves[-1]) / np.linalg.norm(curves[-1])
            print(f"plot.py: {label}: relative L2 difference to {labels[-1]}: {difference:.4f}")
    axes.set_xlabel("time")
    axes.set_ylabel("force")
    axes.set_ylim(bottom=0)
    axes.legend(frameon=False)
    return figure


def plot_energy(arguments):
    results = read_checked(arguments.files[0], read_series)
    title = results.attribute("/", "title") or arguments.files[0].stem
    figure, axes = new_plot(arguments.title or f"{title}: energies")
    total = 0
    for name, values in results.series("energy").items():
        if np.abs(values).max(initial=0) > 0:
            axes.plot(results["/time_series/time"], values, linewidth=1.6, label=name)
        total = total + (-values if name == "external" else values)
    axes.plot(results["/time_series/time"], total, color=TEXT_COLOUR, linestyle="--", linewidth=1.2,
              label="sum less external work")
    axes.set_xlabel("time")
    axes.set_ylabel("energy")
    axes.legend(frameon=False)
    return figure


# ------------------------------------------------------------------------------------------------------------- responses

def read_response(path):
    results = iga_results.read(path)
    if "/tables" not in results:
        raise iga_results.FormatError("holds no tables; run igasolve harmonic, random or transient")
    return results


def curves_of(results):
    """Tables that are curves: over frequency or time."""
    names = results.texts("/table_names")
    return [name for name in names if results.texts(f"/tables/{name}/columns")[0] in ("frequency", "time")]


def usual_columns(columns):
    """The component of the acceleration that moves most; forces of supports alike."""
    for start in ("acceleration_", "force_"):
        components = [name for name in columns if name.startswith(start) and not name.endswith("_phase")]
        if components:
            return [max(components, key=lambda name: np.abs(columns[name]).max())]
    return [list(columns)[1]]


def plot_response(arguments):
    results = read_checked(arguments.files[0], read_response)
    curves = curves_of(results)
    name = arguments.table or (curves[0] if curves else None)
    if name not in curves:
        sys.exit(f"plot.py: table '{name}' is not in {arguments.files[0]}; it holds {', '.join(curves) or 'no curves: give a probe'}")
    columns, units = results.table(name), dict(zip(results.texts(f"/tables/{name}/columns"), results.texts(f"/tables/{name}/units")))
    chosen = arguments.columns or usual_columns(columns)
    for column in chosen:
        if column not in columns:
            sys.exit(f"plot.py: column '{column}' is not in {name}; it holds {', '.join(columns)}")
    title = results.attribute("/", "title") or arguments.files[0].stem
    figure, axes = new_plot(arguments.title or f"{title}: {name}")
    over, x = next(iter(columns.items()))
    phases = [column for column in chosen if f"{column}_phase" in columns]
    if phases:
        axes.remove()
        axes, below = figure.subplots(2, 1, sharex=True, height_ratios=(2.2, 1))
        for one in (axes, below):
            one.grid(True, color="#dfe2e6", linewidth=0.8)
            one.set_axisbelow(True)
            for side in ("top", "right"):
                one.spines[side].set_visible(False)
        axes.set_title(arguments.title or f"{title}: {name}", fontsize=15, weight="bold", color=TEXT_COLOUR, loc="left", pad=14)
        for column in phases:
            below.plot(x, columns[f"{column}_phase"], linewidth=1.4)
        below.set(ylabel="phase, degrees", ylim=(-190, 190), yticks=(-180, -90, 0, 90, 180))
    for column in chosen:
        y, label = np.abs(columns[column]) if over == "frequency" else columns[column], column
        if over == "frequency":
            peak = int(np.argmax(y))
            label = f"{column}: {y[peak]:.4g} at {x[peak]:.5g}"
            if results.analysis == "random":
                label = f"{column}: 1 sigma {np.sqrt(np.trapezoid(y, x) if hasattr(np, 'trapezoid') else np.trapz(y, x)):.4g}"
        axes.plot(x, y, linewidth=1.6, label=label)
    if over == "frequency":
        axes.set_yscale("log")
        if x[0] > 0 and x[-1] >= 10 * x[0]:
            axes.set_xscale("log")
        axes.grid(True, which="minor", color="#eef0f2", linewidth=0.5)
    length = results.attribute("/", "length_unit")
    shown = sorted({units[column].replace("length", length if length != "unspecified" else "length", 1) for column in chosen})
    axes.set_ylabel("  |  ".join(shown) if over == "time" else ("density, " if results.analysis == "random" else "amplitude, ") + "  |  ".join(shown))
    figure.axes[-1].set_xlabel("time" if over == "time" else "frequency, cycles per unit of time")
    axes.legend(frameon=False)
    return figure


def read_checked(path, reader):
    try:
        return reader(path)
    except (OSError, iga_results.FormatError) as error:
        sys.exit(f"plot.py: {path}: {error}")


def main():
    arguments = parse_arguments()
    first = arguments.files[0]
    output = arguments.output or first.with_name(f"{first.stem}_{arguments.kind}.png")
    figure = {"spectrum": plot_spectrum, "convergence": plot_convergence, "force": plot_force,
              "energy": plot_energy, "response": plot_response}[arguments.kind](arguments)
    figure.savefig(output)
    print(f"plot.py: wrote {output}")


if __name__ == "__main__":
    main()
