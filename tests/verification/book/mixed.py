"""Plane and axisymmetric rubber by mixed finite elements, independent of igasolve: answers of bodies without formulas.

Nine-node quadrilaterals with pressures that are linear in each and do not meet their neighbours' (Q2/P1, stable for any bulk modulus);
the compressible neo-Hookean law of igasolve, ψ = μ/2 (F:F - 3) - μ ln J + p ln J - p²/(2 λ), so that p = λ ln J where it is smooth.
"""
import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

GAUSS = np.array([-np.sqrt(0.6), 0, np.sqrt(0.6)]), np.array([5, 8, 5]) / 9


def shapes(t):
    """Values and derivatives of the three quadratic functions of -1 … 1."""
    return np.array([t * (t - 1) / 2, 1 - t * t, t * (t + 1) / 2]), np.array([t - 0.5, -2 * t, t + 0.5])


class Body:
    """A mapped unit square of divisions (m, n) elements.

    mapping: (k, 2) of the unit square to (k, 2) places; axisymmetric: they are (r, z), and forces are those of the whole turn.
    """

    def __init__(self, mapping, divisions, mu, lam, axisymmetric=False):
        m, n = divisions
        self.mu, self.lam, self.axisymmetric = mu, lam, axisymmetric
        grid = np.stack(np.meshgrid(np.arange(2 * m + 1), np.arange(2 * n + 1), indexing="ij"), -1).reshape(-1, 2)
        self.unit = grid / (2 * m, 2 * n)
        self.places = np.asarray(mapping(self.unit), float)
        first = np.stack(np.meshgrid(2 * np.arange(m), 2 * np.arange(n), indexing="ij"), -1).reshape(-1, 1, 2)
        local = np.stack(np.meshgrid(np.arange(3), np.arange(3), indexing="ij"), -1).reshape(1, 9, 2)
        self.elements = (first + local) @ (2 * n + 1, 1)
        self.u = np.zeros(2 * len(self.places))
        self.p = np.zeros(3 * len(self.elements))
        self._points()

    def _points(self):
        x = self.places[self.elements]
        B, N, w, q = [], [], [], []
        for s, ws in zip(*GAUSS):
            for t, wt in zip(*GAUSS):
                (f, df), (g, dg) = shapes(s), shapes(t)
                value, slope = np.outer(f, g).ravel(), np.stack([np.outer(df, g).ravel(), np.outer(f, dg).ravel()], 1)
                jacobian = np.einsum("eia,ib->eab", x, slope)
                gradient = np.einsum("ib,eba->eia", slope, np.linalg.inv(jacobian))
                radius = x[..., 0] @ value
                rows = np.zeros((len(x), 5, 18))  # F_rr, F_rz, F_zr, F_zz, F_tt over the element's unknowns
                rows[:, 0, 0::2], rows[:, 1, 0::2] = gradient[..., 0], gradient[..., 1]
                rows[:, 2, 1::2], rows[:, 3, 1::2] = gradient[..., 0], gradient[..., 1]
                if self.axisymmetric:
                    rows[:, 4, 0::2] = value / radius[:, None]
                B.append(rows)
                w.append(ws * wt * np.linalg.det(jacobian) * (2 * np.pi * radius if self.axisymmetric else 1))
                q.append([1, s, t])
        self.B, self.w, self.q = np.array(B), np.array(w), np.array(q)
        self.of_u = (2 * self.elements[..., None] + np.arange(2)).reshape(-1, 18)

    def _system(self):
        """Residual and tangent of displacements and pressures."""
        size = len(self.u)
        F = np.einsum("gekj,ej->gek", self.B, self.u[self.of_u]) + [1, 0, 0, 1, 1]
        p = np.einsum("gm,em->ge", self.q, self.p.reshape(-1, 3))
        plane = F[..., 0] * F[..., 3] - F[..., 1] * F[..., 2]
        inverse = np.stack([F[..., 3], -F[..., 2], -F[..., 1], F[..., 0], plane / F[..., 4]], -1) / plane[..., None]  # F^-T
        J = plane * F[..., 4]
        P = self.mu * F + (p - self.mu)[..., None] * inverse
        A = np.zeros((*F.shape, 5))
        for k in range(4):
            for j in range(4):  # ∂F^-T_aA / ∂F_bB = -F^-T_aB F^-T_bA
                A[..., k, j] = -(p - self.mu) * inverse[..., k // 2 * 2 + j % 2] * inverse[..., j // 2 * 2 + k % 2]
        A[..., 4, 4] = -(p - self.mu) * inverse[..., 4] ** 2
        A += self.mu * np.eye(5)
        r = np.concatenate([np.zeros(size), np.einsum("ge,gm,ge->em", self.w, self.q, np.log(J) - p / self.lam).ravel()])
        np.add.at(r, self.of_u, np.einsum("ge,gek,gekj->ej", self.w, P, self.B))
        K = np.einsum("ge,geki,gekl,gelj->eij", self.w, self.B, A, self.B, optimize=True)
        C = np.einsum("ge,geki,gek,gm->eim", self.w, self.B, inverse, self.q, optimize=True)
        M = -np.einsum("ge,gm,gn->emn", self.w, self.q, self.q) / self.lam
        block = np.concatenate([np.concatenate([K, C], 2), np.concatenate([C.transpose(0, 2, 1), M], 2)], 1)
        of_p = size + np.arange(len(self.p)).reshape(-1, 3)
        unknowns = np.concatenate([self.of_u, of_p], 1)
        rows, columns = np.repeat(unknowns, 21, 1), np.tile(unknowns, 21)
        return r, csc_matrix((block.ravel(), (rows.ravel(), columns.ravel())), shape=(len(r), len(r)))

    def solve(self, held, load=None, iterations=25):
        """Equilibrium under nodal loads (n, 2) with displacements held: [(nodes, component, value)]. @returns reactions (n, 2)."""
        size = len(self.u)
        free, moved = np.ones(size + len(self.p), bool), np.zeros(size + len(self.p))
        for nodes, component, value in held:
            at = 2 * np.flatnonzero(nodes) + component
            free[at], moved[at] = False, value - self.u[at]
        force = np.zeros(len(free))
        if load is not None:
            force[:size] = np.ravel(load)
        for _ in range(iterations):
            r, K = self._system()
            step, r = moved, r - force
            step[free] = splu(K[free][:, free]).solve(-(r + K @ (moved * ~free))[free])
            self.u, self.p, moved = self.u + step[:size], self.p + step[size:], np.zeros_like(step)
            if np.abs(step[:size]).max() <= 1e-9 * np.abs(self.u).max():
                return (self._system()[0] - force)[:size].reshape(-1, 2)
        raise ArithmeticError("the mixed elements found no equilibrium: take smaller steps")
