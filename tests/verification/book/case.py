"""What a case says about itself, and the list of all cases."""
import importlib.util
import inspect
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable

FOLDER = Path(__file__).resolve().parents[1] / "cases"


class BookError(Exception):
    """A name that the book does not have, or a case that contradicts itself."""


@dataclass
class Case:
    """One part under one set of supports and loads, with one or several numbers whose exact values are known.

    exact       number, or {quantity: number} where the case has several; or a function that gives either
    grids       what the function is called with, coarse to fine; a number is the span size, of a tuple the first one is
    unit        one, or {quantity: unit}
    tolerance   claimed relative error at the finest grid; number, or {quantity: number}
    known       relative error of the exact value itself, where it is published with few digits or a result of others; comparisons with
                CalculiX take smaller errors as equal
    scale       what errors are relative to; default: the exact value; needed where that is zero
    calculix    function(run) -> values as those of `function`, by finite elements; None: no comparison
    """
    id: str
    title: str
    function: Callable
    geometry: str
    material: str
    source: str
    exact: Any
    unit: Any
    grids: tuple
    tolerance: Any
    quick: bool = False
    calculix: Callable | None = None
    calculix_mesh: str = ""
    known: float = 0.0
    scale: float | None = None
    notes: str = ""
    topic: str = ""
    _exact: dict | None = field(default=None, repr=False)

    def exact_values(self):
        """{quantity: value}; the quantity of a single number is ''."""
        if self._exact is None:
            found = self.exact() if callable(self.exact) else self.exact
            self._exact = as_values(found)
        return self._exact

    def claimed(self, quantity):
        return self.tolerance[quantity] if isinstance(self.tolerance, dict) else self.tolerance

    def unit_of(self, quantity):
        return self.unit[quantity] if isinstance(self.unit, dict) else self.unit

    def error(self, quantity, value):
        """Relative and signed, as a share."""
        exact = self.exact_values()[quantity]
        return (value - exact) / (self.scale or abs(exact))

    def checked(self, found):
        """The values that a run gave, as {quantity: number}. Raises BookError where they are not those that `exact` has."""
        values = as_values(found)
        if set(values) != set(self.exact_values()):
            raise BookError(f"{self.id}: the run gave {sorted(values)}, expected {sorted(self.exact_values())}")
        return values


def as_values(found):
    return {name: float(value) for name, value in found.items()} if isinstance(found, dict) else {"": float(found)}


_cases: list[Case] = []


def case(**settings):
    """Makes a case of the function below it, function(run, grid) -> number or {quantity: number}. Keys: those of Case."""
    def register(function):
        new = Case(function=function, topic=Path(inspect.getfile(function)).stem, **settings)
        if len(new.grids) != 3:
            raise BookError(f"{new.id}: has {len(new.grids)} grids, expected three")
        if any(other.id == new.id for other in _cases):
            raise BookError(f"{new.id}: there are two cases of this name")
        _cases.append(new)
        return function
    return register


def read_cases(folder=FOLDER):
    """All cases by topic, {topic: (heading, [cases])}: those of each file, whose docstring's first line is the heading."""
    topics = {}
    for path in sorted(folder.glob("*.py")):
        spec = importlib.util.spec_from_file_location(f"cases_{path.stem}", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        heading = (module.__doc__ or path.stem).strip().splitlines()[0].rstrip(".")
        topics[path.stem] = heading, [one for one in _cases if one.topic == path.stem]
    return topics


def chosen(topics, names, quick):
    """The cases that names (of cases or topics; none: all) ask for. Raises BookError for a name that there is not."""
    every = [one for _, cases in topics.values() for one in cases]
    known = {one.id for one in every} | set(topics)
    for name in names:
        if name not in known:
            raise BookError(f"no case or topic is named '{name}'; topics: {', '.join(topics)}; cases: "
                            + ", ".join(one.id for one in every))
    return [one for one in every if (not names or one.id in names or one.topic in names) and (one.quick or not quick)]
