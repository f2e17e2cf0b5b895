#!/usr/bin/python3
"""Free vibration of tetrahedra with CalculiX (Debian's calculix-ccx: SPOOLES for the factors, ARPACK for the modes)."""
from pathlib import Path

import numpy as np

RIGID_MODES = 6
POINTS_PER_TET = {4: 1, 10: 4}  # integration points of C3D4 and C3D10, stiffness


class CalculixError(Exception):
    """CalculiX did not deliver the frequencies."""


def write_deck(path, nodes, tets, material, modes):
    """A *FREQUENCY run of a free body: `modes` elastic ones after the six rigid ones."""
    numbers = np.arange(1, len(nodes) + 1)
    with open(path, "w") as file:
        file.write("*NODE, NSET=ALL\n")
        np.savetxt(file, np.column_stack([numbers, nodes]), fmt="%d, %.12g, %.12g, %.12g")
        file.write(f"*ELEMENT, TYPE=C3D{tets.shape[1]}, ELSET=SOLID\n")
        np.savetxt(file, np.column_stack([np.arange(1, len(tets) + 1), tets + 1]), fmt="%d", delimiter=", ")
        file.write(f"*MATERIAL, NAME=FOAM\n*ELASTIC\n{material['E']:.12g}, {material['nu']:.12g}\n"
                   f"*DENSITY\n{material['rho']:.12g}\n*SOLID SECTION, ELSET=SOLID, MATERIAL=FOAM\n"
                   f"*STEP\n*FREQUENCY, SOLVER=SPOOLES\n{RIGID_MODES + modes}\n*END STEP\n")


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
