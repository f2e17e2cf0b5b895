#!/usr/bin/python3
"""Two bodies tied, beside CalculiX: scripts/studies/tie_study.py [--output folder] [--bin build/release/bin]

An aluminium plate stands on a steel base; both are free. Elastic frequencies of
  conforming   10-node tetrahedra that share their nodes on the joint: what the others should find
  *TIE         tetrahedra of either body on their own, joined by CalculiX's multiple point constraints
  igasolve     a model of either body in its own grid, joined by [[ties]]
Needs Gmsh and CalculiX; half a minute. The table goes to stdout and to tie_study.md in --output.
"""
import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from compare_fem import ComparisonError, program  # noqa: E402
from igatools import ROOT, calculix, tet_mesh  # noqa: E402
from igatools.measured_run import RunError, measured_report, measured_run  # noqa: E402
from igatools.stl import write_stl  # noqa: E402

BOXES = {"base": ((0, 0, 0), (40, 20, 5)), "plate": ((16, 0, 5), (20, 20, 35))}  # mm
MATERIALS = {"base": (210, 0.3, 7.8e-6), "plate": (70, 0.33, 2.7e-6)}  # GPa, kg/mm³: frequencies in 1/ms
JOINT = 5.0  # height of the joint
MODES = 8
FACES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))  # S1 … S4 of a tetrahedron
BOX_FACES = ((0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6),
             (1, 3, 5), (3, 7, 5))


def geometry(sizes, conforming):
    """Text of a .geo file: the two boxes, meshed together or each on its own."""
    lines = ['SetFactory("OpenCASCADE");']
    for number, (low, high) in enumerate(BOXES.values(), 1):
        edges = ", ".join(str(b - a) for a, b in zip(low, high))
        lines.append(f"Box({number}) = {{{', '.join(map(str, low))}, {edges}}};")
    if conforming:
        lines.append("BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }")
    for number, (name, size) in enumerate(zip(BOXES, sizes), 1):
        lines.append(f'Physical Volume("{name}") = {{{number}}};')
        lines.append(f"MeshSize{{ PointsOf{{ Volume{{{number}}}; }} }} = {size};")
    return "\n".join([*lines, "Mesh.ElementOrder = 2;", "Mesh.SaveGroupsOfNodes = 0;", ""])


def joint_faces(nodes, elements, first, low, high):
    """"element, Sk" of the faces on the joint whose centroid lies above the plate's foot, or near it; elements from number
    `first` on."""
    found = []
    for k, face in enumerate(FACES):
        x = nodes[elements[:, face]]
        middle = x.mean(axis=1)[:, :2]
        on_joint = (np.abs(x[..., 2] - JOINT) < 1e-6).all(1) & (middle >= low).all(1) & (middle <= high).all(1)
        found += [f"{first + element}, S{k + 1}" for element in np.flatnonzero(on_joint)]
    return found


def write_deck(path, nodes, bodies, tied):
    lines, first = calculix.node_lines(nodes), {}
    for name, elements in bodies.items():
        first[name] = 1 + sum(len(bodies[other]) for other in first)
        lines += calculix.element_lines(elements, "C3D10", dict(zip(("E", "nu", "rho"), MATERIALS[name])), name.upper(), first[name])
    if tied:
        low, high = (np.array(corner[:2]) for corner in BOXES["plate"])
        faces = lambda name, *corners: joint_faces(nodes, bodies[name], first[name], *corners)  # noqa: E731
        lines += ["*SURFACE, NAME=FOOT", *faces("plate", low, high), "*SURFACE, NAME=GROUND", *faces("base", low - 4, high + 4),
                  "*TIE, NAME=JOINT, POSITION TOLERANCE=0.01, ADJUST=NO", "FOOT, GROUND"]
    lines += ["*STEP", "*FREQUENCY, SOLVER=SPOOLES", str(calculix.RIGID_MODES + MODES), "*END STEP", ""]
    path.write_text("\n".join(lines))


def run(command, folder, log):
    measured = measured_run(command, folder / log, folder)
    if measured["exit_code"] != 0:
        raise RunError(f"{command[0]} ended with exit code {measured['exit_code']}; see {folder / log}")


def by_calculix(folder, name, sizes, conforming):
    (folder / f"{name}.geo").write_text(geometry(sizes, conforming))
    run([program("gmsh", "gmsh"), "-3", f"{name}.geo", "-format", "inp", "-o", f"{name}_mesh.inp"], folder, f"{name}_gmsh.log")
    nodes, sets = tet_mesh.read_tets(folder / f"{name}_mesh.inp", "C3D10")
    write_deck(folder / f"{name}.inp", nodes, dict(zip(BOXES, sets.values())), not conforming)
    run([program("ccx", "calculix-ccx"), name], folder, f"{name}_ccx.log")
    return 3 * len(nodes), calculix.read_frequencies(folder / f"{name}.dat")[calculix.RIGID_MODES:]


def by_igasolve(folder, name, programs, sizes, degree):
    text = ""
    for (body, (low, high)), size in zip(BOXES.items(), sizes):
        corners = np.array([[(low, high)[(k >> d) & 1][d] for d in range(3)] for k in range(8)], float)
        write_stl(folder / f"{body}.stl", corners[np.array(BOX_FACES)])
        measured_report([programs / "igaprep", folder / f"{body}.stl", "--span-size", size, "--degree", degree, "-o",
                         folder / f"{name}_{body}.h5", "--force", "--json"], folder / f"{name}_{body}.log")
        E, nu, rho = MATERIALS[body]
        text += (f'[[bodies]]\nname = "{body}"\nmodel = "{name}_{body}.h5"\n'
                 f"material = {{ E = {E}, nu = {nu}, rho = {rho} }}\n")
    (folder / f"{name}.toml").write_text(text + '[[ties]]\nname = "joint"\n')
    _, report = measured_report([programs / "igasolve", "eigen", folder / f"{name}.toml", "--modes", MODES, "--json"],
                                folder / f"{name}.log")
    return report["unknowns"], report["frequencies"][report["rigid_modes"]:]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=ROOT / "build/tie_study", help="folder [build/tie_study]")
    parser.add_argument("--bin", type=Path, default=ROOT / "build/release/bin", help="folder of igaprep and igasolve")
    arguments = parser.parse_args()
    folder, programs = arguments.output.resolve(), arguments.bin.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    try:
        reference = by_calculix(folder, "conforming", (1.2, 1.2), True)
        rows = {f"*TIE, {size} and {0.7 * size:g} mm": by_calculix(folder, f"tie_{size}", (size, 0.7 * size), False)
                for size in (4, 2)}
        for degree, size in ((2, 4), (2, 2), (3, 4)):
            rows[f"igasolve, p = {degree}, {size} and {0.85 * size:g} mm"] = by_igasolve(
                folder, f"iga_{degree}_{size}", programs, (size, 0.85 * size), degree)
    except (ComparisonError, RunError) as error:
        sys.exit(f"tie_study.py: {error}")
    lines = ["| | unknowns | " + " | ".join(f"f{m + 1}" for m in range(MODES)) + " |", "|---|---:|" + "---:|" * MODES,
             f"| conforming, 1.2 mm | {reference[0]:,} | " + " | ".join(f"{f:.5f}" for f in reference[1]) + " |"]
    for label, (unknowns, found) in rows.items():
        errors = [f"{100 * (f / e - 1):+.2f} %" for f, e in zip(found, reference[1])]
        lines.append(f"| {label} | {unknowns:,} | " + " | ".join(errors) + " |")
    (folder / "tie_study.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
