#!/usr/bin/python3
"""Tables of rule_study.py's runs."""
import csv

STAGES = ("trim", "winding", "quadrature", "reduction", "rigidity", "points", "functions", "surface points", "check", "write")
NAMES = ("study", "part", "degree", "grid", "interior", "trimmed", "spans_interior", "spans_trimmed", "points_interior",
         "points_trimmed", "points_per_trimmed_span", "points", "stabilised_spans", "max_residual", "prep_cpu_s",
         "prep_memory_mib", "reduction_ms_per_span", "unknowns", "solve_cpu_s", "solve_memory_mib", "mean_error",
         "lowest_error", "highest_error", "dt_crit", "rigid_modes", "bodies", "mechanisms", "sturm_expected", "sturm_found",
         "failure", *(f"stage_{name.replace(' ', '_')}_s" for name in STAGES))
# Title, key and format of the columns; those that no run of a table fills are left out.
COLUMNS = (("grid", "grid", ""), ("inside", "interior", ""), ("trimmed", "trimmed", ""),
           ("interior / trimmed spans", "spans", ""), ("points inside", "points_interior", "d"),
           ("per trimmed span", "points_per_trimmed_span", ".2f"), ("points", "points", "d"),
           ("stabilised", "stabilised_spans", "d"), ("prep., CPU s", "prep_cpu_s", ".2f"), ("MiB", "prep_memory_mib", ".0f"),
           ("reduction, ms a span", "reduction_ms_per_span", ".2f"), ("solution, CPU s", "solve_cpu_s", ".1f"),
           ("mean error", "mean_error", ".2e"), ("errors from", "lowest_error", "+.2e"), ("to", "highest_error", "+.2e"),
           ("Δt", "dt_crit", ".4g"), ("rigid modes", "rigid", ""), ("failure", "failure", ""))


def is_rigid(run):
    """Six rigid modes a body, no other motion without stiffness, and no mode missing where that was counted."""
    return run["rigid_modes"] == 6 * run["bodies"] and run["mechanisms"] == 0 \
        and run.get("sturm_found") == run.get("sturm_expected")


def complete(runs):
    """Adds what follows from several runs: errors, and the reduction's CPU time against the same grid with nnls."""
    same_grid = {}
    for run in runs:
        same_grid.setdefault((run["study"], run["part"], run["degree"], run["grid"]), {})[run["interior"], run["trimmed"]] = run
    for group in same_grid.values():
        for (interior, trimmed), run in group.items():
            fitted = group.get((interior, "nnls"))
            if trimmed != "nnls" and fitted and "prep_cpu_s" in run and "prep_cpu_s" in fitted and run["spans_trimmed"]:
                run["reduction_ms_per_span"] = 1e3 * (run["prep_cpu_s"] - fitted["prep_cpu_s"]) / run["spans_trimmed"]
            against = run["exact"] or group.get(("gauss", "nnls"), {}).get("frequencies", [])
            if run.get("frequencies") and run["modes"] > 1 and against:
                wrong = [f / r - 1 for f, r in zip(run["frequencies"], against)]
                run |= {"mean_error": sum(map(abs, wrong)) / len(wrong), "lowest_error": min(wrong),
                        "highest_error": max(wrong)}
            run["rigid"] = rigid_words(run)
            run["spans"] = f"{run['spans_interior']} / {run['spans_trimmed']}" if "spans_trimmed" in run else ""


def rigid_words(run):
    if "rigid_modes" not in run:
        return ""
    proof = "" if "sturm_found" in run else ", not proved"
    return f"{run['rigid_modes']}{proof}" if is_rigid(run) else \
        f"**{run['rigid_modes']}**, {run['mechanisms']} mechanisms, {run.get('sturm_found')} of {run.get('sturm_expected')}"


def markdown(runs):
    """One table for each study, part and degree; the part stands in the table where there are many."""
    text, groups = [], {}
    for run in runs:
        one_row = run["study"] in ("rigid", "speed")
        groups.setdefault((run["study"], "all parts" if one_row else run["part"], run["degree"]), []).append(run)
    for (study, part, degree), rows in groups.items():
        columns = [(title, key, form) for title, key, form in COLUMNS if any(row.get(key) not in (None, "") for row in rows)]
        if part == "all parts":
            columns.insert(0, ("part", "part", ""))
        text += [f"### {study}: {part}, p = {degree}", "", "| " + " | ".join(title for title, _, _ in columns) + " |",
                 "|---" * len(columns) + "|"]
        for row in rows:
            cells = [format(row[key], form) if row.get(key) not in (None, "") else "" for _, key, form in columns]
            text.append("| " + " | ".join(cells) + " |")
        text.append("")
    return "\n".join(text)


def write_csv(path, runs):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, NAMES, extrasaction="ignore", restval="")
        writer.writeheader()
        writer.writerows(runs)
