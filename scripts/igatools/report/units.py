"""Names of units, where the run says which set of units its numbers are in."""

SYSTEMS = {  # unit_system of igasolve
    "t-mm-s": {"frequency": "Hz", "stress": "MPa", "time": "s", "mass": "t"},
    "kg-mm-ms": {"frequency": "kHz", "stress": "GPa", "time": "ms", "mass": "kg"},
    "SI": {"frequency": "Hz", "stress": "Pa", "time": "s", "mass": "kg"},
}


def of_report(report):
    """Units by quantity; empty text where the report does not say."""
    named = SYSTEMS.get((report.get("material") or {}).get("unit_system") or "", {})
    length = report.get("length_unit") or ""
    return {key: named.get(key, "") for key in ("frequency", "stress", "time", "mass")} | {
        "length": "" if length == "unspecified" else length}


def with_unit(text, unit):
    return f"{text} {unit}" if unit else text


def headed(name, unit):
    """Name of a column or an axis."""
    return f"{name} [{unit}]" if unit else name
