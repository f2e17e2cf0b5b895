"""Statics, modes and statics at large displacement of a run file: Kratos' elements, conditions and assembly, systems solved by scipy."""

import sys

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from igatools import ROOT
from igatools.foreign_results import displacement_gradients
from igatools.kratos import stored_energy
from igatools.kratos.run_file import RunError

sys.path.append(str(ROOT / "scripts" / "studies"))
import iga_reference_solver as reference  # noqa: E402

GROUP = "/surface/quadrature"
KINDS = {
    "traction": "traction",
    "pressure": "pressure",
    "force": "total force",
    "body_force": "body force",
    "acceleration": "acceleration",
}


class SolverError(Exception):
    """The method did not reach its tolerance."""


class Factor:
    """Of a symmetric matrix scaled to a unit diagonal, which takes the size of cut functions out; solutions are refined."""

    def __init__(self, K):
        if (K.diagonal() <= 0).any():
            raise SolverError(
                "the stiffness has a row without stiffness: the part is not held, or a function has no material"
            )
        self.K, self.scale = K, 1 / np.sqrt(K.diagonal())
        D = sparse.diags(self.scale)
        self.lu = splu(
            (D @ K @ D).tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=1e-3, options={"SymmetricMode": True}
        )

    def solve(self, b):
        x = np.zeros_like(b)
        for _ in range(4):
            x += self.scale * self.lu.solve(self.scale * (b - self.K @ x))
        return x


class System:
    """The parts of a run on a body: K (3 n, 3 n) of supports with its right-hand side, forces of loads, C from unknowns to functions."""

    def __init__(self, body, run):
        self.body, self.run, self.model = body, run, body.model
        self.components = sparse.kron(self.model.coefficients_from_unknowns(), sparse.identity(3), format="csr")
        self.by_us = {}  # supports of single directions, (matrix, right-hand side)
        self.supports, self.loads = [], []
        for k in range(len(run.supports)):
            self._add_support(k)
        for k in range(len(run.loads) if run.analysis != "eigen" else 0):  # modes know no loads
            self._add_load(k)

    def _surface(self, kind, k):
        points = self.run.points(kind, k, self.model)
        w, x = self.model[GROUP + "/weights"][points], self.model.positions(GROUP)[points]
        return points, w, x, {"name": self.run.name(kind, k), "area": float(w.sum()), "centroid": w @ x / w.sum()}

    def _add_support(self, k):
        support, frame = self.run.supports[k], self.run.frame("support", k)
        points, w, x, told = self._surface("support", k)
        beta = support.get("penalty_factor", 1e3) * self.run.E / np.cbrt(np.prod(self.model.span_size()))
        fixed = support.get("fixed", "xyz")
        gradient = np.array(support.get("gradient", np.zeros(9)), float).reshape(3, 3)
        if fixed == "normal":
            value = np.ravel(support.get("value", 0.0))[0]
            directions = [(self.model[GROUP + "/normals"][points], np.full(len(points), value))]
        else:
            along = np.array(support.get("value", np.zeros(3)), float) + x @ gradient.T
            directions = [
                (np.broadcast_to(frame[:, "xyz".index(d)], x.shape), along[:, "xyz".index(d)])
                for d in sorted(set(fixed))
            ]
        told |= {
            "method": "penalty",
            "part": f"support {k}",
            "points": points,
            "w": w,
            "x": x,
            "beta": beta,
            "directions": directions,
        }
        if len(directions) == 3:
            self.body.add_support(told["part"], points, beta, sum(e * value[:, None] for e, value in directions))
        else:
            self.by_us[told["part"]] = self._directions(points, w, beta, directions)
        self.supports.append(told)

    def shapes(self, points):
        """Sparse (points, functions): values of the functions at surface points."""
        cells = self.model.point_cells(GROUP)[points]
        N = self.model.functions_at(self.model.cell_spans(cells), self.model[GROUP + "/parameters"][points])[1]
        functions = self.model["/cells/functions"][cells]
        rows = np.repeat(np.arange(len(points)), functions.shape[1])
        return sparse.csr_matrix(
            (N.ravel(), (rows, functions.ravel())), (len(points), len(self.model["/functions/number"]))
        )

    def _directions(self, points, w, beta, directions):
        """Penalty along single directions, which Kratos 10.4's condition cannot: it fixes all three whatever its flags say."""
        n = 3 * len(self.model["/functions/number"])
        K, b, N = sparse.csr_matrix((n, n)), np.zeros(n), self.shapes(points)
        for e, value in directions:
            trace = sum(sparse.kron(sparse.diags(e[:, d]) @ N, np.eye(3)[d : d + 1]) for d in range(3)).tocsr()
            K, b = K + trace.T @ sparse.diags(beta * w) @ trace, b + trace.T @ (beta * w * value)
        return K, b

    def _add_load(self, k):
        load, frame = self.run.loads[k], self.run.frame("load", k)
        kind = next(key for key in KINDS if key in load)
        told = {
            "name": self.run.name("load", k),
            "kind": KINDS[kind],
            "part": f"load {k}",
            "area": 0.0,
            "density": None,
        }
        if kind in ("body_force", "acceleration"):
            force = frame @ np.array(load[kind], float) * (self.run.rho if kind == "acceleration" else 1)
            told["density"] = force
            w, x, t = self.model.weights, self.model.points, np.broadcast_to(force, (len(self.model.weights), 3))
            told["centroid"] = w @ x / w.sum()
        else:
            points, w, x, more = self._surface("load", k)
            told |= more
            if kind == "pressure":
                t = -float(load[kind]) * self.model[GROUP + "/normals"][points]
            else:
                t = np.broadcast_to(
                    frame @ np.array(load[kind], float) / (w.sum() if kind == "force" else 1), (len(points), 3)
                )
            self.body.add_traction(self.body.part(told["part"]), points, t)
        told |= {"force": w @ t, "moment": w @ np.cross(x - told["centroid"], t)}
        self.loads.append(told)

    def gather(self):
        """Assembles what does not change: stiffness and right-hand side of supports, forces of loads."""
        n = 3 * len(self.model["/functions/number"])
        self.K_s, self.b_s, self.forces = sparse.csr_matrix((n, n)), np.zeros(n), []
        for support in self.supports:
            K, b = self.by_us.get(support["part"]) or self.body.assemble(support["part"])
            self.K_s, self.b_s = self.K_s + K, self.b_s + b
        for load in self.loads:
            inside = load["density"] is not None
            force = self.body.body_force(load["density"]) if inside else self.body.assemble(load["part"])[1]
            if np.abs(force.reshape(-1, 3).sum(0) - load["force"]).max() > 1e-9 * max(np.abs(force).sum(), 1e-300):
                raise SolverError(
                    f"load '{load['name']}': Kratos' forces add up to {force.reshape(-1, 3).sum(0)}, expected {load['force']}"
                )
            self.forces.append(force)
        self.f = sum(self.forces, np.zeros(n))

    def solve(self, K, b):
        """Coefficients of functions from K and b of functions."""
        C = self.components
        return C @ Factor((C.T @ K @ C).tocsr()).solve(C.T @ b)

    def reactions(self, u):
        """Of supports on the part: name, method, area, centroid, force, moment about that centroid; and their penalty energy."""
        rows, energy = [], 0.0
        for support in self.supports:
            at = self.shapes(support["points"]) @ u
            t = np.zeros_like(at)
            for e, value in support["directions"]:
                gap = (at * e).sum(1) - value
                t -= support["beta"] * gap[:, None] * e
                energy += 0.5 * support["beta"] * support["w"] @ gap**2
            rows.append(
                {key: support[key] for key in ("name", "method", "area", "centroid")}
                | {"force": support["w"] @ t, "moment": support["w"] @ np.cross(support["x"] - support["centroid"], t)}
            )
        return rows, energy

    def probes(self, u):
        positions = np.array([probe["position"] for probe in self.run.probes], float).reshape(-1, 3)
        cells, parameters = self.model.locate(positions)
        for k in np.flatnonzero(cells < 0):
            self.run.refuse("probe", int(k), "position", "lies outside the solid")
        N = self.model.functions_at(self.model.cell_spans(cells), parameters)[1]
        found = np.einsum("qi,qia->qa", N, u[self.model["/cells/functions"][cells]])
        return [
            {"name": self.run.name("probe", k), "position": x, "displacement": d}
            for k, (x, d) in enumerate(zip(positions, found))
        ]

    def report(self, u, strain_energy, external_work):
        supports, penalty = self.reactions(u)
        return {
            "displacement": u,
            "strain_energy": strain_energy,
            "external_work": external_work,
            "penalty_energy": penalty,
            "supports": supports,
            "loads": self.loads,
            "probes": self.probes(u),
        }


def need_support(run):
    if not run.supports:
        raise RunError(
            f"{run.path}: no [[support]] holds the part; igasolve knows inertia_relief for free parts, this script does not"
        )


def refuse_gap_ends(model, runs):
    if "/unknowns/offsets" in model.data:
        raise RunError(
            f"{model.path}: gaps end inside the part; igasolve glues their ends in {runs} runs, so the two would not be the "
            "same model: make it with igaprep --gap-ends glued"
        )


def static(body, run):
    """Fields of write_results()."""
    need_support(run)
    system = System(body, run)
    body.start()
    system.gather()
    K = body.assemble("stiffness")[0]
    u = system.solve(K + system.K_s, system.f + system.b_s)
    return system.report(u.reshape(-1, 3), float(0.5 * u @ (K @ u)), float(0.5 * system.f @ u))


def modes(body, run):
    """Fields of write_results(); K and M are Kratos', the eigenvalues scipy's."""
    system = System(body, run)
    body.add_mass(run.rho)
    body.start()
    system.gather()
    C = system.components
    K, M = (C.T @ A @ C for A in (body.assemble("stiffness")[0] + system.K_s, body.assemble("mass")[0]))
    speed = np.sqrt(run.E / (2 * (1 + run.nu)) / run.rho)
    values, vectors, rigid, residual = reference.lowest_pairs(
        (K + K.T) / 2, (M + M.T) / 2, run.modes, (np.pi * speed / reference.length_scale(body.model)) ** 2
    )
    shapes = (C @ vectors).T.reshape(len(values), -1, 3)
    return {"omega_squared": values, "modes": shapes, "residual": residual, "rigid": rigid}


def nonlinear(body, run, say=print):
    """Fields of write_results() at the full load: Newton's method over equal load steps on the total Lagrangian elements."""
    need_support(run)
    refuse_gap_ends(body.model, "nonlinear")
    system = System(body, run)
    body.start()
    system.gather()
    u, work = np.zeros(system.f.size), 0.0
    for step in range(1, run.steps + 1):
        factor, before = step / run.steps, u
        for iteration in range(run.max_iterations + 1):
            body.displace(u.reshape(-1, 3))
            K, inner = body.assemble("stiffness")
            held = factor * system.b_s - system.K_s @ u
            outer = factor * system.f
            residual = inner + outer + held
            if not np.isfinite(residual).all():
                raise SolverError(f"load step {step}: the displacements run away; take more steps")
            if iteration and np.linalg.norm(residual) <= run.tolerance * max(
                np.linalg.norm(outer), np.linalg.norm(held)
            ):
                break
            u = u + system.solve(K + system.K_s, residual)
        else:
            raise SolverError(
                f"load step {step}: Newton's method did not converge in {run.max_iterations} iterations; take more steps"
            )
        work += float((factor - 0.5 / run.steps) * system.f @ (u - before))
        say(f"  load factor {factor:.4g}: {iteration} iterations")
    model = body.model
    gradients = displacement_gradients(model, u.reshape(-1, 3), model.point_cells(), model["/quadrature/parameters"])[1]
    energy = float(model.weights @ stored_energy.density(run.law, run.E, run.nu, gradients))
    return system.report(u.reshape(-1, 3), energy, work)
