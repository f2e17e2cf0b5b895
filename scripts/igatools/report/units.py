"""Names of units, where the run says which set of units its numbers are in."""

from igatools.unit_systems import MEASURES, SYSTEMS


def of_report(report):
    """Units by quantity; empty text where the report does not say."""
    system = SYSTEMS.get((report.get("material") or {}).get("unit_system"))
    length = report.get("length_unit") or ""
    return (system.symbols if system else dict.fromkeys(MEASURES, "")) | {"length": "" if length == "unspecified" else length}


def with_unit(text, unit):
    return f"{text} {unit}" if unit else text


def headed(name, unit):
    """Name of a column or an axis."""
    return f"{name} [{unit}]" if unit else name
