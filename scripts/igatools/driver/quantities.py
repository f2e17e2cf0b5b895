"""Numbers that a user asks for, followed from grid to grid, each with its error."""
from dataclasses import dataclass

import numpy as np

from igatools.driver import estimate

SMALL = 0.05  # of the largest of its kind


@dataclass
class Quantity:
    """What is known of a quantity before its values are compared."""
    name: str
    unit: str
    value: float
    order: float              # that its estimate relies on
    counts: bool = True       # for the tolerance
    no_limit: str | None = None  # why it has none as spans shrink: then no error is told, and of a stress no value
    kind: str | None = None   # "stress" or "displacement": one that is small beside others of its kind has no relative error
    note: str | None = None
    from_solution: float | None = None  # relative error that the solution itself tells
    fewest_grids: int = 2     # from which on its error is told
    largest_error: float | None = None  # beyond it the error is not told
    must_settle: bool = False    # error only where changes from grid to grid fall, all in one direction


def told(sizes, histories, quantity):
    """Entry of the report for a quantity with its values on all grids."""
    if quantity.no_limit:
        # What is large without bound is no number; what grows like a logarithm is one, of its grid.
        value = None if quantity.kind == "stress" else histories[-1]
        return {"name": quantity.name, "unit": quantity.unit, "value": value, "error": None, "order": None, "history": histories,
                "note": quantity.no_limit, "counts": False, "has_limit": False}
    sizes = sizes[len(sizes) - len(histories):]
    found = estimate.error_of(sizes, histories, quantity.order, quantity.from_solution)
    error, note = found.error, quantity.note
    if error is not None and len(histories) < quantity.fewest_grids:
        error, note = None, f"error unknown: needs {quantity.fewest_grids} grids"
    elif error is not None and quantity.must_settle and len(histories) > 2 and found.order is None:
        error, note = None, ("error unknown: its changes from grid to grid do not fall in one direction; the last three values lie within "
                             f"{100 * np.ptp(histories[-3:]) / (abs(histories[-1]) or 1.0):.2g} %")
    elif error is not None and quantity.largest_error is not None and error > quantity.largest_error:
        error, note = None, f"error unknown: it still changes by {100 * change(histories):.2g} % from grid to grid"
    return {"name": quantity.name, "unit": quantity.unit, "value": histories[-1], "error": error, "order": found.order,
            "history": histories, "note": note, "counts": quantity.counts, "has_limit": True}


def change(history):
    return abs(history[-1] - history[-2]) / (abs(history[-1]) or 1.0)


def follow(grids):
    """Entries of the report: the quantities of the finest grid, each with its values on the grids that have it, up to that one."""
    sizes = [grid.span_size for grid in grids]
    found = []
    for quantity in grids[-1].found["quantities"]:
        history = []
        for grid in reversed(grids):
            same = [other.value for other in grid.found["quantities"] if other.name == quantity.name]
            if not same:
                break
            history.insert(0, same[0])
        found.append(told(sizes, history, quantity))
    leave_out_small(found, grids[-1].found["quantities"])
    return found


def leave_out_small(entries, quantities):
    """An error relative to nearly nothing, such as the displacement of a held place, says nothing."""
    for kind in ("stress", "displacement"):
        own = [entry for entry, quantity in zip(entries, quantities) if quantity.kind == kind]
        largest = max((abs(entry["history"][-1]) for entry in own), default=0)
        for entry in own:
            if entry["error"] is not None and abs(entry["value"]) < SMALL * largest:
                entry |= {"error": None, "counts": False, "note": f"small beside the largest {kind}: no relative error"}


def errors_that_count(entries):
    return [entry["error"] for entry in entries if entry["counts"]]
