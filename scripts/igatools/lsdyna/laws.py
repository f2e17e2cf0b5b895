"""Materials of a run file as cards of LS-DYNA."""

from igatools.lsdyna.cards import DeckError, card

OFF = 1e-20  # LS-DYNA takes 0 for a default
COMMON = {"law", "rho", "E", "nu", "bulk_viscosity", "inversion", "min_volume_ratio"}
KEYS = {
    "linear-elastic": COMMON - {"inversion", "min_volume_ratio"},
    "j2": COMMON | {"yield_stress", "hardening_modulus", "yield_curve", "rate_law", "rate_reference", "rate_exponent"},
    "crushable-foam": COMMON | {"yield_curve", "tension_limit", "damping", "modulus"},
}


def write_material(deck, body, table, curve_points, notes):
    """The *MAT card of a body; its number. `curve_points(value)` reads a yield curve; `notes` takes what differs from
    igasolve."""
    law = table.get("law", "neo-hookean")
    if law not in KEYS:
        raise DeckError(f"{body}: law '{law}' is not exported; expected one of {', '.join(KEYS)}")
    if "name" in table:
        raise DeckError(f"{body}: material by name is not exported; expected E, nu and rho as numbers")
    unknown = set(table) - KEYS[law]
    if unknown:
        raise DeckError(
            f"{body}: material key '{sorted(unknown)[0]}' of law '{law}' is not exported; expected no others than "
            f"{', '.join(sorted(KEYS[law]))}"
        )
    missing = {"E", "nu", "rho"} - set(table)
    if missing:
        raise DeckError(f"{body}: material without {sorted(missing)[0]}")
    for key in sorted({"inversion", "min_volume_ratio"} & set(table)):
        notes.append(f"{body}: material.{key} (points that are crushed flat)")
    number = deck.next("materials")
    head = (number, float(table["rho"]), float(table["E"]), float(table["nu"]))
    {"linear-elastic": _elastic, "j2": _j2, "crushable-foam": _foam}[law](deck, body, table, head, curve_points, notes)
    return number


def _elastic(deck, body, table, head, curve_points, notes):
    deck.keyword("MAT_ELASTIC", card(*head))
    notes.append(
        f"{body}: *MAT_ELASTIC follows rotations, law linear-elastic does not; equal at small displacement only"
    )


def _j2(deck, body, table, head, curve_points, notes):
    E, curve = head[2], None
    rate = ()
    if "rate_law" in table:
        if table["rate_law"] != "cowper-symonds":
            raise DeckError(f"{body}: rate_law '{table['rate_law']}' is not exported; expected cowper-symonds")
        rate = (float(table["rate_reference"]), float(table["rate_exponent"]))
    if "yield_curve" in table:
        curve = deck.curve(_continued(curve_points(table["yield_curve"])), f"{body}: yield stress over plastic strain")
        yielding, tangent = None, None
    else:
        H = float(table.get("hardening_modulus", 0))
        yielding, tangent = float(table["yield_stress"]), E * H / (E + H)
    c, p = rate or (None, None)
    deck.keyword(
        "MAT_PIECEWISE_LINEAR_PLASTICITY",
        card(*head, yielding, tangent, 1e21),
        card(c, p, curve, None, 1.0 if rate else 0.0),
        card(*[0.0] * 8),
        card(*[0.0] * 8),
    )


def _continued(points):
    """A curve whose last slope goes on, ten times as far: LS-DYNA's has no slope of its own behind its end."""
    if len(points) < 2:
        return [*points, (points[-1][0] + 1.0, points[-1][1])]
    (a, fa), (b, fb) = points[-2:]
    reach = 10 * max(b - points[0][0], b - a)
    return [*points, (b + reach, fb + reach * (fb - fa) / (b - a))]


def _foam(deck, body, table, head, curve_points, notes):
    points, E = curve_points(table["yield_curve"]), head[2]
    if table.get("modulus", "E") == "E":  # *MAT_CRUSHABLE_FOAM takes its stiffness from the curve's final slope
        end, value = points[-1]
        step = max(0.05, 0.05 * end)
        points = [*points, (end + step, value + E * step)]
        notes.append(
            f"{body}: the yield curve has one point more, behind its end: its final slope is E, from which MODEL 0 of "
            "*MAT_CRUSHABLE_FOAM takes the elastic stiffness (igasolve keeps the last slope of its curve there)"
        )
    if not table.get("tension_limit"):
        notes.append(f"{body}: tension_limit 0 means the yield stress to igasolve; TSC is the first value of the curve")
    tension = float(table.get("tension_limit") or points[0][1])
    curve = deck.curve(points, f"{body}: yield stress over volumetric strain 1 - V/V0")
    deck.keyword("MAT_CRUSHABLE_FOAM", card(*head, curve, tension, float(table.get("damping", 0)) or OFF, 0))
    if table.get("damping"):
        notes.append(f"{body}: damping stands in DAMP as it is; the length in LS-DYNA's viscous term is its own choice")


def bulk_viscosity(tables):
    """Q1, Q2 of *CONTROL_BULK_VISCOSITY, which are those of all bodies."""
    found = {tuple(map(float, table.get("bulk_viscosity", (0.0, 0.0)))) for table in tables}
    if len(found) > 1:
        raise DeckError(
            "bulk_viscosity differs between bodies; expected the same, since LS-DYNA's control card is that of all"
        )
    return [value or OFF for value in found.pop()]
