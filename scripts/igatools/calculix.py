#!/usr/bin/python3
"""CalculiX (Debian's calculix-ccx): free vibration of tetrahedra (SPOOLES for the factors, ARPACK for the modes), and a
pressure pulse on bricks by explicit dynamics."""
from pathlib import Path

import numpy as np

from igatools.fe_mesh import Mesh

RIGID_MODES = 6
POINTS_PER_TET = {4: 1, 10: 4}  # integration points of C3D4 and C3D10, stiffness


class CalculixError(Exception):
    """CalculiX did not deliver the frequencies."""


# CalculiX reads 20 characters of a number: 12 digits, an exponent and signs fit.


def held_lines(held):
    """*BOUNDARY and *EQUATION of pairs (numbers of nodes, direction): a direction is "xyz" and the like, or a vector."""
    lines = []
    for numbers, direction in held:
        if isinstance(direction, str):
            lines.append("*BOUNDARY")
            lines += [f"{n + 1}, {'xyz'.index(axis) + 1}, {'xyz'.index(axis) + 1}" for n in numbers for axis in direction]
        else:
            order = np.argsort(-np.abs(direction))
            terms = [(d, direction[d]) for d in order if abs(direction[d]) > 1e-12]
            for n in numbers:
                lines += ["*EQUATION", str(len(terms)), ", ".join(f"{n + 1}, {d + 1}, {c:.12g}" for d, c in terms)]
    return lines


def node_lines(nodes):
    return ["*NODE, NSET=ALL", *(f"{k + 1}, " + ", ".join(f"{c:.12g}" for c in x) for k, x in enumerate(nodes))]


def element_lines(elements, kind, material, name="SOLID", first=1):
    """Elements (zero-based numbers of nodes) from number `first` on as the set `name`, with their material: {"E", "nu"} and, for
    frequencies, "rho"."""
    lines = [f"*ELEMENT, TYPE={kind}, ELSET={name}"]
    for k, row in enumerate(elements, first):
        words = [str(n + 1) for n in row]
        lines += [", ".join([str(k), *words[:10]]) + ("," if len(words) > 10 else ""), *([", ".join(words[10:])] if words[10:] else [])]
    lines += [f"*MATERIAL, NAME=M{name}", "*ELASTIC", f"{material['E']:.12g}, {material['nu']:.12g}"]
    if "rho" in material:
        lines += ["*DENSITY", f"{material['rho']:.12g}"]
    return [*lines, f"*SOLID SECTION, ELSET={name}, MATERIAL=M{name}"]


def deck(mesh, material, held):
    """Mesh, material (as element_lines) and what is held (held_lines); elements are the set SOLID."""
    return [*node_lines(mesh.nodes), *element_lines(mesh.elements, mesh.kind, material), *held_lines(held)]


def write_deck(path, nodes, tets, material, modes):
    """A *FREQUENCY run of a free body: `modes` elastic ones after the six rigid ones."""
    mesh = Mesh(nodes, tets, f"C3D{tets.shape[1]}")
    lines = [*deck(mesh, material, ()), "*STEP", "*FREQUENCY, SOLVER=SPOOLES", str(RIGID_MODES + modes), "*END STEP", ""]
    Path(path).write_text("\n".join(lines))


def read_frequencies(path):
    """All frequencies in cycles per time (0 for negative eigenvalues) of a .dat file."""
    frequencies, in_table = [], False
    for line in Path(path).read_text().splitlines():
        if "E I G E N V A L U E" in line:
            in_table = True
        elif "P A R T I C I P A T I O N" in line:
            break
        elif in_table and len(words := line.split()) == 5 and words[0].isdigit():
            frequencies.append(float(words[3]))
    return frequencies


def solve(ccx, folder, name, nodes, tets, material, modes, run):
    """The first elastic frequencies and the measured run of CalculiX."""
    folder = Path(folder)
    write_deck(folder / f"{name}.inp", nodes, tets, material, modes)
    log = folder / f"{name}.log"
    measured = run([ccx, name], log, folder)
    data = folder / f"{name}.dat"
    found = read_frequencies(data) if data.exists() else []
    if measured["exit_code"] != 0 or len(found) != RIGID_MODES + modes:
        raise CalculixError(f"{ccx} ended with exit code {measured['exit_code']} and {len(found)} of {RIGID_MODES + modes} "
                            f"frequencies; see {log}")
    elastic = found[RIGID_MODES:]
    if found[RIGID_MODES - 1] > 1e-3 * elastic[0]:
        raise CalculixError(f"{data}: sixth frequency {found[RIGID_MODES - 1]:.6g} is not rigid beside {elastic[0]:.6g}; "
                            "is the part one connected body?")
    return elastic, measured


def read_fields(path, name, count):
    """All fields of a name in a .frd file: a list of (count, components)."""
    found, rows, reading = [], None, False
    for line in path.read_text().splitlines():
        if line.startswith(" -4"):
            reading = line.split()[1] == name
            if reading:
                rows = {}
        elif reading and line.startswith(" -1"):
            values = line[13:]
            rows[int(line[3:13])] = [float(values[k:k + 12]) for k in range(0, len(values.rstrip()), 12)]
        elif reading and line.startswith(" -3"):
            found.append(np.array([rows[n + 1] for n in range(count)]))
            reading = False
    return found


# ------------------------------------------------------------------------------------------------------ explicit dynamics

def write_pulse_deck(path, mesh, kind, material, pulse, end, probes):
    """An explicit run of a free body of bricks under a pressure on their x = 0 faces.

    mesh: nodes (n, 3), bricks (m, 8), loaded bricks; kind: C3D8 or C3D8R; pulse: lines (time, pressure), zero after the last
    one; probes: nodes whose displacement is printed in every increment. CalculiX chooses the increment itself; with DIRECT it
    would hang.
    """
    nodes, bricks, loaded = mesh
    first_step = 1e-3 * end
    with open(path, "w") as file:
        file.write("*NODE, NSET=ALL\n")
        np.savetxt(file, np.column_stack([np.arange(1, len(nodes) + 1), nodes]), fmt="%d, %.12g, %.12g, %.12g")
        file.write(f"*ELEMENT, TYPE={kind}, ELSET=SOLID\n")
        np.savetxt(file, np.column_stack([np.arange(1, len(bricks) + 1), bricks + 1]), fmt="%d", delimiter=", ")
        for name, numbers in (("ELSET, ELSET=LOADED", loaded), ("NSET, NSET=PROBES", probes)):
            file.write(f"*{name}\n" + "".join(f"{number + 1},\n" for number in numbers))
        file.write("*AMPLITUDE, NAME=PULSE\n")
        np.savetxt(file, np.vstack([pulse, [2 * end, 0]]), fmt="%.12g", delimiter=", ")
        file.write(f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{material['E']:.12g}, {material['nu']:.12g}\n"
                   f"*DENSITY\n{material['rho']:.12g}\n*SOLID SECTION, ELSET=SOLID, MATERIAL=SOLID\n"
                   f"*STEP, INC=10000000\n*DYNAMIC, EXPLICIT\n{first_step:.12g}, {end:.12g}\n"
                   "*DLOAD, AMPLITUDE=PULSE\nLOADED, P6, 1.\n"  # face 6 of a brick: nodes 4-1-5-8, where x is least
                   "*NODE PRINT, NSET=PROBES, FREQUENCY=1\nU\n*END STEP\n")


def read_displacements(path, probes):
    """Times (k) and displacements (k, len(probes), 3) of a .dat file, in the order of `probes`."""
    times, rows = [], []
    for line in Path(path).read_text().splitlines():
        words = line.split()
        if "time" in words:
            times.append(float(words[-1]))
        elif len(words) == 4 and words[0].isdigit():
            rows.append([float(word) for word in words])
    table = np.array(rows).reshape(len(times), -1, 4)
    order = np.searchsorted(table[0, :, 0].astype(int), np.asarray(probes) + 1, sorter=np.argsort(table[0, :, 0]))
    return np.array(times), table[:, np.argsort(table[0, :, 0])[order], 1:]


def solve_pulse(ccx, folder, name, mesh, kind, material, pulse, end, probes, run):
    """Times, displacements of the probes (times, probes, 3) and the measured run of CalculiX."""
    folder = Path(folder)
    write_pulse_deck(folder / f"{name}.inp", mesh, kind, material, pulse, end, probes)
    log, data = folder / f"{name}.log", folder / f"{name}.dat"
    data.unlink(missing_ok=True)
    measured = run([ccx, name], log, folder)
    if measured["exit_code"] != 0 or not data.exists():
        raise CalculixError(f"{ccx} ended with exit code {measured['exit_code']} and no displacements; see {log}")
    times, found = read_displacements(data, probes)
    if len(times) == 0 or abs(times[-1] - end) > 1e-6 * end:
        raise CalculixError(f"{data}: the run stopped at {times[-1] if len(times) else 0:.6g} of {end:.6g}; see {log}")
    return times, found, measured
