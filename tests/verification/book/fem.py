"""Finite elements beside ours: 20-node bricks of mapped blocks or 10-node tetrahedra of Gmsh, solved by CalculiX."""
import numpy as np

from igatools import calculix, tet_mesh
from igatools.calculix import deck, read_fields
from igatools.fe_mesh import BRICK_EDGES, CORNERS, Mesh, quad_rule, quad_shapes, triangle_rule, triangle_shapes  # noqa: F401
from igatools.measured_run import RunError


def bricks(mapping, divisions, kind="C3D20"):
    """20-node bricks (C3D20, or C3D20R) of a mapped unit cube, as parts.block: mid-edge nodes lie on the mapped edges."""
    n = np.asarray(divisions)
    index = np.stack(np.meshgrid(*(np.arange(2 * m + 1) for m in n), indexing="ij"), -1).reshape(-1, 3)
    used = (index % 2).sum(1) <= 1
    number = np.full(2 * n + 1, -1)
    number[tuple(index[used].T)] = np.arange(used.sum())
    nodes = np.asarray(mapping(index[used] / (2 * n)), float)
    first = 2 * np.stack(np.meshgrid(*(np.arange(m) for m in n), indexing="ij"), -1).reshape(-1, 1, 3)
    local = np.concatenate([2 * CORNERS, [CORNERS[a] + CORNERS[b] for a, b in BRICK_EDGES]])
    at = first + local
    return Mesh(nodes, number[at[..., 0], at[..., 1], at[..., 2]], kind)


def tetrahedra(run, geometry, size):
    """10-node tetrahedra by Gmsh of a geometry: lines of a .geo file with the OpenCASCADE kernel that make one volume."""
    script = run.folder / "mesh.geo"
    script.write_text("\n".join(['SetFactory("OpenCASCADE");', geometry, 'Physical Volume("solid") = Volume{:};', "Mesh.ElementOrder = 2;",
                                 f"Mesh.MeshSizeMin = {size};", f"Mesh.MeshSizeMax = {size};", "Mesh.SaveGroupsOfNodes = 0;", ""]))
    run.program("gmsh", "-3", "-nt", "1", "-format", "inp", "-o", "mesh.inp", "mesh.geo", log="gmsh")
    try:
        nodes, sets = tet_mesh.read_tets(run.folder / "mesh.inp", "C3D10")
    except tet_mesh.MeshError as error:
        raise RunError(str(error)) from error
    return Mesh(nodes, np.concatenate(list(sets.values())), "C3D10")


def solve(run, mesh, lines):
    (run.folder / "fem.inp").write_text("\n".join([*lines, ""]))
    run.program("ccx", "fem", log="ccx")
    run.unknowns = mesh.nodes.size


def frequencies(run, mesh, material, held, modes, shapes=False):
    """The lowest `modes` frequencies, rigid ones included; with `shapes` also the displacements (modes, n, 3)."""
    solve(run, mesh, [*deck(mesh, material, held), "*STEP", "*FREQUENCY, SOLVER=SPOOLES", str(modes),
                      *(["*NODE FILE", "U"] if shapes else []), "*END STEP"])
    found = calculix.read_frequencies(run.folder / "fem.dat")
    if len(found) < modes:
        raise RunError(f"CalculiX gave {len(found)} of {modes} frequencies; see {run.folder / 'ccx.log'}")
    return (found, np.array(read_fields(run.folder / "fem.frd", "DISP", len(mesh.nodes)))) if shapes else found


def static(run, mesh, material, held, forces, extra=()):
    """Displacements (n, 3) and stresses (n, 6: xx yy zz xy yz zx) at the nodes, averaged over elements. extra: more lines of the step."""
    loaded = np.argwhere(np.abs(forces) > 1e-12 * np.abs(forces).max(initial=0))
    solve(run, mesh, [*deck(mesh, material, held), "*STEP", "*STATIC, SOLVER=SPOOLES", *(["*CLOAD"] if len(loaded) else []),
                      *(f"{n + 1}, {d + 1}, {forces[n, d]:.12g}" for n, d in loaded), *extra, "*NODE FILE", "U", "*EL FILE", "S",
                      "*END STEP"])
    file = run.folder / "fem.frd"
    displacement, stress = (read_fields(file, name, len(mesh.nodes)) for name in ("DISP", "STRESS"))
    if not displacement or not stress:
        raise RunError(f"CalculiX gave no displacements; see {run.folder / 'ccx.log'}")
    return displacement[-1], stress[-1]


def total_forces(run):
    """[(share of the step, (x, y, z))] that *NODE PRINT, TOTALS=ONLY printed."""
    rows = (run.folder / "fem.dat").read_text().splitlines()
    return [(float(line.split()[-1]), tuple(float(word) for word in rows[k + 2].split()))
            for k, line in enumerate(rows) if line.strip().startswith("total force")]


def pressed_cylinder(run, radius, height, divisions, material, way, increments, kind="CAX8R"):
    """A cylinder 0 … radius, 0 … height on its plane of symmetry, its upper end pressed down by `way` and held across, at large
    displacement, in axisymmetric elements. material: lines of the deck. Returns share of the way -> force of the whole section."""
    n = np.asarray(divisions)
    index = np.stack(np.meshgrid(*(np.arange(2 * m + 1) for m in n), indexing="ij"), -1).reshape(-1, 2)
    used = (index % 2).sum(1) <= 1
    number = np.full(2 * n + 1, -1)
    number[tuple(index[used].T)] = np.arange(used.sum())
    nodes = index[used] / (2 * n) * (radius, height)
    first = 2 * np.stack(np.meshgrid(*(np.arange(m) for m in n), indexing="ij"), -1).reshape(-1, 1, 2)
    at = first + [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]]
    elements = number[at[..., 0], at[..., 1]]
    small = 1e-9 * (radius + height)
    sets = {"TOP": nodes[:, 1] > height - small, "LOW": nodes[:, 1] < small, "AXIS": nodes[:, 0] < small}
    lines = ["*NODE, NSET=ALL", *(f"{k + 1}, {x:.12g}, {z:.12g}, 0" for k, (x, z) in enumerate(nodes)),
             f"*ELEMENT, TYPE={kind}, ELSET=SOLID", *(", ".join(map(str, [k + 1, *(row + 1)])) for k, row in enumerate(elements))]
    for name, of in sets.items():
        lines += [f"*NSET, NSET={name}", *(f"{k + 1}," for k in np.flatnonzero(of))]
    lines += ["*MATERIAL, NAME=M", *material, "*SOLID SECTION, ELSET=SOLID, MATERIAL=M", "*BOUNDARY", "AXIS, 1, 1", "LOW, 2, 2", "TOP, 1, 1",
              "*STEP, NLGEOM, INC=10000", "*STATIC, SOLVER=SPOOLES", f"{1 / increments:.12g}, 1., 1e-6, {1 / increments:.12g}", "*BOUNDARY",
              f"TOP, 2, 2, {-way:.12g}", "*NODE PRINT, NSET=TOP, TOTALS=ONLY", "RF", "*END STEP"]
    solve(run, Mesh(nodes, elements, kind), lines)
    found = [(0.0, 0.0), *((at, -180 * force[1]) for at, force in total_forces(run))]  # CalculiX prints those of a wedge of two degrees
    share, force = np.array(found).T
    if share[-1] < 1 - 1e-6:
        raise RunError(f"CalculiX ended at {share[-1]:.3g} of the way; see {run.folder / 'ccx.log'}")
    return lambda at: float(np.interp(at, share, force))
