"""Energy and Cauchy stress of the laws at large displacement, by their formulas (solver/explicit/laws/README.md): for figures, not for the
solution, which takes Kratos' laws."""

import numpy as np

from igatools.foreign_results import VOIGT


def lame(E, nu):
    return E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))


def density(law, E, nu, gradients):
    """Energy per undeformed volume (n) of displacement gradients (n, 3, 3)."""
    lam, mu = lame(E, nu)
    F = np.eye(3) + gradients
    if law == "neo-hookean":
        log_J = np.log(np.linalg.det(F))
        return mu / 2 * ((F**2).sum((1, 2)) - 3) - mu * log_J + lam / 2 * log_J**2
    strain = (F.transpose(0, 2, 1) @ F - np.eye(3)) / 2
    return lam / 2 * np.trace(strain, axis1=1, axis2=2) ** 2 + mu * (strain**2).sum((1, 2))


def cauchy(law, E, nu):
    """A function from displacement gradients (n, 3, 3) to Cauchy stresses (n, 6): xx yy zz xy yz zx."""
    lam, mu = lame(E, nu)

    def stress(gradients):
        F = np.eye(3) + gradients
        J = np.linalg.det(F)[:, None, None]
        if law == "neo-hookean":
            sigma = (mu * (F @ F.transpose(0, 2, 1) - np.eye(3)) + lam * np.log(J) * np.eye(3)) / J
        else:
            strain = (F.transpose(0, 2, 1) @ F - np.eye(3)) / 2
            S = lam * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(3) + 2 * mu * strain
            sigma = F @ S @ F.transpose(0, 2, 1) / J
        return np.stack([sigma[:, a, b] for a, b in VOIGT], 1)

    return stress
