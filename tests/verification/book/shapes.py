"""Modes told by their shape."""
import numpy as np

import igatools


def modes_like(report, file, points, wanted, least=0.9, body=None):
    """Frequencies of the elastic modes whose displacements at points (n, 3) are those wanted (n, 3) but for a factor: with a
    correlation (u·w)² / (u·u w·w) above `least`. body: the one of several in which the points lie."""
    results = igatools.Results(file)
    found = []
    for mode in range(report["rigid_modes"], len(report["frequencies"])):
        u = results.displacement(points, mode=mode, body=body)
        if correlation(u, wanted) > least:
            found.append(report["frequencies"][mode])
    return found


def correlation(u, wanted):
    return (u * wanted).sum()**2 / max((u * u).sum() * (wanted * wanted).sum(), 1e-300)


def fem_modes_like(frequencies, shapes, numbers, wanted, least=0.9):
    """The same of CalculiX's shapes (modes, n, 3) at nodes of these numbers."""
    return [f for f, u in zip(frequencies, shapes) if f > 1e-3 * max(frequencies) and correlation(u[numbers], wanted) > least]
