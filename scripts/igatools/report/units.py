"""Names of units, where the run says which set of units its numbers are in."""

MEASURES = ("frequency", "stress", "time", "mass", "energy", "force", "density")
SYSTEMS = {  # unit_system of igasolve
    "t-mm-s": ("Hz", "MPa", "s", "t", "mJ", "N", "t/mm³"),
    "kg-mm-ms": ("kHz", "GPa", "ms", "kg", "J", "kN", "kg/mm³"),
    "SI": ("Hz", "Pa", "s", "kg", "J", "N", "kg/m³"),
}


def of_report(report):
    """Units by quantity; empty text where the report does not say."""
    named = SYSTEMS.get((report.get("material") or {}).get("unit_system"), [""] * len(MEASURES))
    length = report.get("length_unit") or ""
    return dict(zip(MEASURES, named)) | {"length": "" if length == "unspecified" else length}


def with_unit(text, unit):
    return f"{text} {unit}" if unit else text


def headed(name, unit):
    """Name of a column or an axis."""
    return f"{name} [{unit}]" if unit else name
