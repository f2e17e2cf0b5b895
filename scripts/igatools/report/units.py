"""Names of units, where the run says which set of units its numbers are in."""

SYSTEMS = {  # unit_system of igasolve
    "t-mm-s": {"frequency": "Hz", "stress": "MPa", "time": "s", "mass": "t", "energy": "mJ", "force": "N", "density": "t/mm³"},
    "kg-mm-ms": {"frequency": "kHz", "stress": "GPa", "time": "ms", "mass": "kg", "energy": "J", "force": "kN", "density": "kg/mm³"},
    "SI": {"frequency": "Hz", "stress": "Pa", "time": "s", "mass": "kg", "energy": "J", "force": "N", "density": "kg/m³"},
}


def of_report(report):
    """Units by quantity; empty text where the report does not say."""
    named = SYSTEMS.get((report.get("material") or {}).get("unit_system") or "", {})
    length = report.get("length_unit") or ""
    return dict.fromkeys(SYSTEMS["SI"], "") | named | {"length": "" if length == "unspecified" else length}


def with_unit(text, unit):
    return f"{text} {unit}" if unit else text


def headed(name, unit):
    """Name of a column or an axis."""
    return f"{name} [{unit}]" if unit else name
