#!/usr/bin/python3
"""A second solver over the same file: free vibration of a model from h5py, numpy and scipy alone, without C++.

  scripts/studies/iga_reference_solver.py part.h5 --E 210e3 --nu 0.3 --rho 7.8e-9 --modes 10 [--json]
  scripts/studies/iga_reference_solver.py part.h5 --E 210 --nu 0.3 --rho 7.85e-6 --mass lumped --largest

It assembles the stiffness and the consistent mass of a linear elastic solid from the quadrature points of the interchange
file, without any treatment of light functions, and finds the lowest eigenpairs of K x = omega^2 M x by Lanczos with shift
and inversion. Its answers are to be those of `igasolve eigen --light-functions none`. Any consistent set of units;
frequencies are in cycles per time. It is written to be read, not to be fast.
"""
import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np
from scipy import linalg, sparse
from scipy.sparse import csgraph
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from igatools import iga_model  # noqa: E402

ENTRIES_PER_BLOCK = 20_000_000  # entries of cell matrices held at a time: about 0.6 GB
BAND_LIMIT = 8 * 2**30  # bytes; a wider factor is refused
RIGID = 1e-8  # an eigenvalue below this part of (pi c / L)^2 belongs to a rigid mode; round-off leaves about 1e-12
CONVERGED = 1e-8  # bound on the residual |K x - l M x| / (l |M x|)
VOIGT = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]  # order of strains; shear strains are doubled


class InputError(Exception):
    """The user can mend it."""


class NumericalError(Exception):
    """The method did not reach its tolerance."""


def isotropic(E, nu):
    """Elasticity matrix (6, 6) in Voigt's notation, order xx yy zz yz xz xy."""
    if not (E > 0 and -1 < nu < 0.5):
        raise InputError(f"E = {E:g}, nu = {nu:g}: expected E > 0 and -1 < nu < 0.5")
    shear, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    C = np.diag([2 * shear] * 3 + [shear] * 3)
    C[:3, :3] += lame
    return C


def checked_elasticity(C):
    """C (6, 6) if it is symmetric and positive definite."""
    C = np.asarray(C, float).reshape(6, 6)
    if not np.allclose(C, C.T, rtol=1e-12, atol=0) or np.linalg.eigvalsh(C)[0] <= 0:
        raise InputError(f"the elasticity matrix must be symmetric and positive definite; its smallest eigenvalue is "
                         f"{np.linalg.eigvalsh((C + C.T) / 2)[0]:g}")
    return C


def strain_operator(gradients):
    """B (n, 6, 3 m) from gradients (n, m, 3): strains of displacement coefficients, the component runs fastest."""
    n, m, _ = gradients.shape
    B = np.zeros((n, 6, m, 3))
    for row, (i, j) in enumerate(VOIGT):
        B[:, row, :, i] += gradients[:, :, j]
        if i != j:
            B[:, row, :, j] += gradients[:, :, i]
    return B.reshape(n, 6, 3 * m)


def gauss_points(model, span):
    """Parameters (n, 3) and weights (n) of the Gauss rule with p + 1 points a direction on a whole span."""
    rules = []
    for d, p in enumerate(model.degree):
        x, w = np.polynomial.legendre.leggauss(p + 1)
        low, high = model.knots[d][span[d] + p], model.knots[d][span[d] + p + 1]
        rules.append((low + (x + 1) / 2 * (high - low), w / 2 * (high - low)))
    u = np.stack(np.meshgrid(*(x for x, _ in rules), indexing="ij"), 3).reshape(-1, 3)
    return u, np.einsum("i,j,k->ijk", *(w for _, w in rules)).ravel()


def assemble(model, C, rho):
    """Sparse K (3 n, 3 n) and M (n, n), the consistent mass of one component; n unknowns in the file's order.

    Cell by cell: /cells/functions tells the rows that each one adds to.

    Rules on runs of interior spans need not integrate products of functions: there the mass takes Gauss points.
    """
    offsets, weights, parameters = (model["/quadrature/" + name] for name in ("offsets", "weights", "parameters"))
    functions, state, spans = model["/cells/functions"], model["/cells/state"], model.cell_spans()
    runs = model.attributes["/quadrature"]["interior_rule"] != "gauss"
    n, m = len(model["/functions/number"]), functions.shape[1]
    K, M = sparse.csr_matrix((3 * n, 3 * n)), sparse.csr_matrix((n, n))
    step = max(1, ENTRIES_PER_BLOCK // (9 * m * m))
    for first in range(0, len(spans), step):
        block = range(first, min(first + step, len(spans)))
        k, mass = np.zeros((len(block), m, 3, m, 3)), np.zeros((len(block), m, m))
        for row, cell in enumerate(block):
            points = slice(offsets[cell], offsets[cell + 1])
            u, w = parameters[points], weights[points]
            owners = np.repeat(spans[cell:cell + 1], len(w), axis=0)
            B = strain_operator(model.gradients_at(owners, u))
            k[row] = (B.reshape(-1, 3 * m).T @ (w[:, None, None] * (C @ B)).reshape(-1, 3 * m)).reshape(m, 3, m, 3)
            if runs and state[cell] == iga_model.INTERIOR:
                u, w = gauss_points(model, spans[cell])
                owners = np.repeat(spans[cell:cell + 1], len(w), axis=0)
            N = model.functions_at(owners, u)[1]
            mass[row] = N.T @ (rho * w[:, None] * N)
        rows = functions[block.start:block.stop].astype(np.int64)
        pairs, place = np.unique(rows[:, :, None] * n + rows[:, None, :], return_inverse=True)
        place = place.ravel()
        gathered = lambda values: np.bincount(place, values.ravel(), len(pairs))  # noqa: E731
        i, j = pairs // n, pairs % n
        M = M + sparse.csr_matrix((gathered(mass), (i, j)), (n, n))
        entries = np.stack([gathered(k[:, :, a, :, b]) for a in range(3) for b in range(3)], 1)
        i, j = 3 * i[:, None] + np.repeat(np.arange(3), 3), 3 * j[:, None] + np.tile(np.arange(3), 3)
        K = K + sparse.csr_matrix((entries.ravel(), (i.ravel(), j.ravel())), (3 * n, 3 * n))
    rows = model.coefficients_from_unknowns()  # the identity where no gap ends
    components = sparse.kron(rows, sparse.identity(3), format="csr")
    K, M = components.T @ K @ components, rows.T @ M @ rows
    return (K + K.T) / 2, (M + M.T) / 2


def length_scale(model):
    """Largest extent of the spans that hold material."""
    ijk = model.cell_spans()
    ends = [(model.knots[d][ijk[:, d].min() + p], model.knots[d][ijk[:, d].max() + p + 1])
            for d, p in enumerate(model.degree)]
    return max(high - low for low, high in ends)


class BandCholesky:
    """Cholesky factors of a sparse symmetric positive definite matrix in a band, after reverse Cuthill-McKee."""

    def __init__(self, matrix):
        self.order = csgraph.reverse_cuthill_mckee(matrix.tocsr(), symmetric_mode=True)
        lower = sparse.tril(matrix[self.order][:, self.order], format="coo")
        width = int((lower.row - lower.col).max()) + 1
        size = 8 * width * matrix.shape[0]
        if size > BAND_LIMIT:
            raise InputError(f"{matrix.shape[0]} unknowns need {size / 2**30:.1f} GiB for the factors, at most "
                             f"{BAND_LIMIT / 2**30:.0f} GiB are used; this solver is for small models, use igasolve")
        band = np.zeros((width, matrix.shape[0]))
        band[lower.row - lower.col, lower.col] = lower.data
        try:
            self.factor = linalg.cholesky_banded(band, lower=True, overwrite_ab=True, check_finite=False)
        except linalg.LinAlgError as error:
            raise NumericalError(f"the shifted stiffness is not positive definite ({error}): functions with next to no "
                                 "material depend on each other; use a coarser or shifted grid, exact moments "
                                 "(igaprep --moment-degree 2p), or igasolve's --light-functions") from error

    def solve(self, right):
        x = np.empty_like(right)
        x[self.order] = linalg.cho_solve_banded((self.factor, True), right[self.order], check_finite=False)
        return x


def lowest(K, M, modes, scale):
    """Eigenvalues, how many are rigid, largest residual: lowest_pairs() without the vectors."""
    values, _, rigid, residuals = lowest_pairs(K, M, modes, scale)
    return values, rigid, float(residuals[rigid:].max())


def lowest_pairs(K, M, modes, scale):
    """The rigid modes and the first `modes` elastic ones: eigenvalues (ascending) and vectors (unknowns, n), how many are rigid,
    residuals |K x - l M x| / (l |M x|) in the scaled pencil (n), those of rigid modes over `scale` for l.

    `scale` is an eigenvalue's order of magnitude: (pi c / L)^2. The pencil is scaled by D = diag(M)^(-1/2), which takes the
    size of light functions out of it, and K - shift M is factored with shift = -scale / 10. A single start vector can miss
    copies of multiple eigenvalues: further runs in the complement of what is found go on until it holds nothing lower.
    """
    unknowns = K.shape[0]
    if modes < 1 or modes + 10 > unknowns:
        raise InputError(f"--modes {modes}: expected 1 ... {unknowns - 10} for this model's {unknowns} unknowns")
    D = sparse.diags(1 / np.sqrt(M.diagonal()))
    K, M = D @ K @ D, D @ M @ D
    shift = -scale / 10
    factors = BandCholesky(K - shift * M)
    random = np.random.default_rng(1)
    vectors, wanted = np.zeros((unknowns, 0)), modes + 6
    while True:
        values, found = _in_complement(K, M, shift, factors, vectors, max(wanted - vectors.shape[1], 0) + 2, random)
        limit = _quotients(K, M, vectors)[wanted - 1] if vectors.shape[1] >= wanted else np.inf
        vectors = np.hstack([vectors, found])
        order = np.argsort(_quotients(K, M, vectors))
        vectors = vectors[:, order]
        all_values = _quotients(K, M, vectors)
        rigid = int((all_values < RIGID * scale).sum())
        if rigid + modes > wanted:
            wanted = rigid + modes
            if wanted + 4 > unknowns:
                raise InputError(f"--modes {modes}: the model has {unknowns} unknowns and {rigid} rigid modes or more; ask "
                                 "for fewer")
        elif values.min() >= limit * (1 - 1e-12):
            break
    wanted = rigid + modes
    values, vectors = all_values[:wanted], vectors[:, :wanted]
    mass = M @ vectors
    residuals = np.linalg.norm(K @ vectors - mass * values, axis=0) / np.linalg.norm(mass, axis=0)
    residuals /= np.where(np.arange(wanted) < rigid, scale, values)
    worst = float(residuals[rigid:].max())
    if worst > CONVERGED:
        raise NumericalError(f"an eigenpair has the residual {worst:.1e}, expected {CONVERGED:.0e}: the model is badly "
                             "conditioned; use igasolve's --light-functions")
    return values, D @ vectors, rigid, residuals


def _quotients(K, M, vectors):
    return np.einsum("ij,ij->j", vectors, K @ vectors) / np.einsum("ij,ij->j", vectors, M @ vectors)


def _in_complement(K, M, shift, factors, known, count, random):
    """Lowest `count` eigenpairs whose vectors are M-orthogonal to the `known` ones."""
    weighted = M @ known

    def inverse(b):
        y = factors.solve(b - weighted @ (known.T @ b))
        return y - known @ (weighted.T @ y)

    start = inverse(M @ random.standard_normal(K.shape[0]))
    try:
        return eigsh(K, count, M, sigma=shift, which="LM", tol=0, v0=start,
                     OPinv=LinearOperator(K.shape, inverse, dtype=float))
    except ArpackError as error:
        raise NumericalError(f"Lanczos did not converge: {error}") from error


def largest(K, lumped):
    """Largest eigenvalue of K x = l M x with a diagonal M."""
    if (lumped <= 0).any():
        raise NumericalError(f"{(lumped <= 0).sum()} row sums of the mass are not positive")
    D = sparse.diags(1 / np.sqrt(lumped))
    start = np.random.default_rng(1).standard_normal(K.shape[0])
    return float(eigsh(D @ K @ D, 1, which="LA", tol=1e-12, v0=start, ncv=40, return_eigenvectors=False)[0])


def solve(path, C, rho, modes=10, only_largest=False):
    """Report of a run, under the names that igasolve uses."""
    times = {"read": time.perf_counter()}
    model = iga_model.read(path)
    times["assembly"] = time.perf_counter()
    K, M = assemble(model, C, rho)
    times["solve"] = time.perf_counter()
    report = {"model": str(path), "degree": model.degree, "points": len(model["/quadrature/weights"]),
              "functions": M.shape[0], "unknowns": K.shape[0], "mass": float(M.sum())}
    if only_largest:
        omega = np.sqrt(largest(K, np.repeat(np.asarray(M.sum(axis=1)).ravel(), 3)))
        report |= {"omega_max": omega, "dt_crit": 2 / omega}
    else:
        speed = np.sqrt(np.diag(C)[3:].mean() / rho)
        values, rigid, residual = lowest(K, sparse.kron(M, sparse.eye(3), format="csr"), modes,
                                         (np.pi * speed / length_scale(model))**2)
        report |= {"frequencies": (np.sqrt(np.maximum(values, 0)) / (2 * np.pi)).tolist(), "rigid_modes": rigid,
                   "max_residual": residual}
    times["end"] = time.perf_counter()
    names = list(times)
    report["timings"] = {name: times[after] - times[name] for name, after in zip(names, names[1:])}
    return report


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", help="model file made by igaprep")
    parser.add_argument("--E", type=float, help="Young's modulus")
    parser.add_argument("--nu", type=float, help="Poisson's ratio")
    parser.add_argument("--elasticity", type=float, nargs=36, metavar="C", help="in place of --E and --nu: the 6x6 matrix, "
                        "row by row, in the order xx yy zz yz xz xy with doubled shear strains")
    parser.add_argument("--rho", type=float, required=True, help="density")
    parser.add_argument("--modes", type=int, default=10, help="number of elastic modes [10]")
    parser.add_argument("--mass", choices=("consistent", "lumped"), default="consistent",
                        help="consistent for the lowest modes, lumped (row sums) with --largest")
    parser.add_argument("--largest", action="store_true", help="the largest eigenfrequency instead (with --mass lumped)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    try:
        if arguments.largest != (arguments.mass == "lumped"):
            raise InputError("--largest and --mass lumped belong together here; igasolve knows the other combinations")
        if (arguments.elasticity is None) == (arguments.E is None or arguments.nu is None):
            raise InputError("give either --E and --nu, or --elasticity")
        if not arguments.rho > 0:
            raise InputError(f"--rho {arguments.rho:g}: expected a positive density")
        C = (isotropic(arguments.E, arguments.nu) if arguments.elasticity is None
             else checked_elasticity(arguments.elasticity))
        report = solve(arguments.model, C, arguments.rho, arguments.modes, arguments.largest)
    except InputError as error:
        return _failed(f"{error}", 2)
    except NumericalError as error:
        return _failed(f"{arguments.model}: {error}", 4)
    except iga_model.FormatError as error:
        return _failed(f"{arguments.model}: {error}", 3)
    except OSError as error:
        return _failed(f"{arguments.model}: {error}", 2 if isinstance(error, FileNotFoundError) else 3)
    if arguments.json:
        print(json.dumps(report))
    else:
        for key, value in report.items():
            if key != "frequencies":
                print(f"{key:12} {value}")
        for number, frequency in enumerate(report.get("frequencies", []), 1):
            print(f"mode {number:3} {frequency:.10g}" + (" rigid" if number <= report["rigid_modes"] else ""))
    return 0


def _failed(text, code):
    print(f"iga_reference_solver.py: {text}", file=sys.stderr)
    return code


if __name__ == "__main__":
    sys.exit(main())
