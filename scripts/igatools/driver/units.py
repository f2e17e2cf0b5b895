"""Units of the numbers of a run, and numbers with units as a user types them: "1.2 m", "0,0,-1 kN"."""
import re
from dataclasses import dataclass

from igatools.driver.programs import Failed
from igatools.unit_systems import SYSTEMS

STANDARD_GRAVITY = 9.80665  # m/s²
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"

# In SI.
KNOWN = {"length": {"um": 1e-6, "µm": 1e-6, "mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048},
         "speed": {"mm/s": 1e-3, "m/s": 1.0, "km/h": 1 / 3.6},
         "acceleration": {"mm/s2": 1e-3, "mm/s²": 1e-3, "m/s2": 1.0, "m/s²": 1.0, "g": STANDARD_GRAVITY},
         "force": {"N": 1.0, "kN": 1e3}, "stress": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "bar": 1e5},
         "time": {"us": 1e-6, "µs": 1e-6, "ms": 1e-3, "s": 1.0}}


@dataclass(frozen=True)
class Typed:
    """Numbers as typed, with their unit where they have one."""
    words: str
    measure: str
    numbers: tuple
    unit: str

    def within(self, system):
        """The numbers in a unit system; without a unit they are taken as they are."""
        if not self.unit:
            return list(self.numbers)
        if system is None:
            raise Failed(f"{self.words}: the unit {self.unit} cannot be converted, since the run's own units are not known; give "
                         "--material NAME or --unit-system, or the number without a unit", 2)
        factor = KNOWN[self.measure][self.unit] / system.unit(self.measure)
        return [factor * x for x in self.numbers]


def typed(words, measure, count=1, must_have_unit=False):
    """Typed numbers. Raises ValueError that says what was found and what is expected."""
    found = re.fullmatch(rf"\s*({NUMBER}(?:\s*,\s*{NUMBER})*)\s*([^\d\s,].*?)?\s*", words)
    known = KNOWN[measure]
    wanted = "a number" if count == 1 else f"{count} numbers joined by commas"
    if not found:
        raise ValueError(f"found {words!r}, expected {wanted} with a unit ({', '.join(known)})")
    numbers, unit = tuple(float(x) for x in found[1].split(",")), found[2] or ""
    if len(numbers) != count:
        raise ValueError(f"found {len(numbers)} numbers in {words!r}, expected {wanted}")
    if unit and unit not in known:
        raise ValueError(f"found the unit {unit!r} in {words!r}, expected one of {', '.join(known)}")
    if must_have_unit and not unit:
        raise ValueError(f"found {words!r} without a unit, expected one of {', '.join(known)} behind it")
    return Typed(words, measure, numbers, unit)


def symbol(system, measure, length_unit="unspecified"):
    """For reports: "" where the units are not known."""
    if system:
        return system.symbol(measure)
    return length_unit if measure == "length" and length_unit != "unspecified" else ""


def of_run(options, length_unit):
    """The unit system of a run's numbers: as igasolve takes it, by the model's length unit where none is given; None where the
    material is given by number alone, in units that nobody told."""
    if options.unit_system:
        return SYSTEMS[options.unit_system]
    if options.material_name or options.run:
        return {"mm": SYSTEMS["t-mm-s"], "m": SYSTEMS["SI"]}.get(length_unit)
    return None
