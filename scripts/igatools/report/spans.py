"""Lines of the spans that hold material, in whole span numbers, joined where they go on straight."""
import numpy as np

from igatools.iga_model import INTERIOR, TRIMMED


def lines(model):
    """Edges of interior spans, and those that a trimmed span has too: two arrays (n, 2, 3) of corners (u, v, w)."""
    state = np.asarray(model["/spans/state"]).reshape(model.spans[::-1]).transpose()  # u, v, w
    found = {INTERIOR: [], TRIMMED: []}
    for along in range(3):
        kinds = _edge_kinds(state, along)
        for kind, segments in found.items():
            segments.append(_joined(kinds == kind, along))
    return np.concatenate(found[INTERIOR]), np.concatenate(found[TRIMMED])


def _edge_kinds(state, along):
    """For the edges along an axis, the highest state of the four spans around: spans along the axis, corners across."""
    across = [axis for axis in range(3) if axis != along]
    padded = np.pad(state, [(0, 0) if axis == along else (1, 1) for axis in range(3)])
    kinds = np.zeros([n + (axis != along) for axis, n in enumerate(state.shape)], state.dtype)
    for first in (0, 1):
        for second in (0, 1):
            part = [slice(None)] * 3
            for axis, start in zip(across, (first, second)):
                part[axis] = slice(start, start + kinds.shape[axis])
            kinds = np.maximum(kinds, padded[tuple(part)])
    return kinds


def _joined(chosen, along):
    """Corners where runs of chosen edges begin and end: (n, 2, 3)."""
    runs = np.moveaxis(chosen, along, 2).astype(np.int8)
    change = np.diff(np.pad(runs, [(0, 0), (0, 0), (1, 1)]), axis=2)
    begin, end = np.argwhere(change == 1), np.argwhere(change == -1)  # both sorted by line, then along it
    across = [axis for axis in range(3) if axis != along]
    corners = np.empty((len(begin), 2, 3), np.int64)
    for place, ends in enumerate((begin, end)):
        corners[:, place, across] = ends[:, :2]
        corners[:, place, along] = ends[:, 2]
    return corners
