"""Supports and loads of the command line: --fix "face 12", --force "face 3=0,0,-1000" become a run file."""
import json
from dataclasses import dataclass

from igatools.driver import units
from igatools.driver.part import is_cad
from igatools.driver.programs import Failed

FIXED = {"normal", "pinned", "radial"} | {"x", "y", "z", "xy", "xz", "yz", "xyz"}
MOST_LISTED = 12  # names that an error message lists


@dataclass(frozen=True)
class Placed:
    """Something that acts on a named place."""
    place: str
    value: object  # a Typed, or the word behind --fix


def fix(words):
    """"face 12" or "face 12=normal"."""
    place, equals, how = words.rpartition("=")
    if not equals:
        return Placed(words.strip(), "xyz")
    if how.strip() not in FIXED:
        raise ValueError(f"found {how.strip()!r} behind the = of {words!r}, expected one of {', '.join(sorted(FIXED))}")
    return Placed(place.strip(), how.strip())


def placed(words, measure, count):
    """"face 3=0,0,-1000" or "face 3=0,0,-1 kN"."""
    place, equals, value = words.rpartition("=")
    if not equals or not place.strip():
        example = "face 3=0,0,-1000" if count == 3 else "face 3=0.5"
        raise ValueError(f"found {words!r}, expected a name, = and {count} number{'s joined by commas' if count > 1 else ''}, such as "
                         f'"{example}"')
    return Placed(place.strip(), units.typed(value, measure, count))


def names_of(model):
    """{key of a run file: names} of a model."""
    return {"region": model.texts("/surface/regions"), "curve": list(model.curves()), "point": list(model.markers())}


def key_for(place, names, options):
    """"region", "curve" or "point"; Failed where the part has no such name."""
    for key, known in names.items():
        if place in known:
            return key
    shown = names["region"][:MOST_LISTED]
    more = len(names["region"]) - len(shown)
    places = (f"igaprep {options.part} --list shows where they lie, --list-edges edges and vertices too" if is_cad(options.part) else
              f"igasolve info {options.output / 'model_first.h5'} shows their areas; --region-angle 30 splits them at sharp edges")
    raise Failed(f"{options.part} has no face, edge or vertex '{place}'; its faces are {', '.join(shown)}"
                 + (f" and {more} more" if more else "") + f" ({places})", 2)


def table(kind, entries):
    return "\n".join([f"[[{kind}]]", *(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in entries.items())])


def run_text(options, model, system):
    """The run file of --fix, --force, --pressure, --gravity; names are looked up in the model, units converted to the system."""
    names, tables = names_of(model), []
    for entry in options.fix:
        key = key_for(entry.place, names, options)
        tables.append(table("support", {"name": f"fixed {entry.place}", "fixed": entry.value, key: entry.place}))
    for entry in options.force:
        key = key_for(entry.place, names, options)
        tables.append(table("load", {"name": f"force on {entry.place}", "force": entry.value.within(system), key: entry.place}))
    for entry in options.pressure:
        if key_for(entry.place, names, options) != "region":
            raise Failed(f"--pressure acts on a face; '{entry.place}' of {options.part} is an edge or a vertex", 2)
        tables.append(table("load", {"name": f"pressure on {entry.place}", "pressure": entry.value.within(system)[0],
                                     "region": entry.place}))
    if options.gravity:
        tables.append(table("load", {"name": "gravity", "acceleration": options.gravity.within(system)}))
    tables += [table("probe", {"name": name, "position": list(position)}) for name, position in options.probe]
    head = (f"# Supports and loads of iga static {options.part.name}; to be used with --model and --material, or as\n"
            f"# iga static {options.part.name} --run THIS.toml\n")
    return head + "\n" + "\n\n".join(tables) + "\n"


def probe(words):
    """"tip=60,20,3" or "60,20,3"."""
    name, _, place = words.rpartition("=")
    numbers = units.typed(place, "length", 3)
    if numbers.unit:
        raise ValueError(f"found the unit {numbers.unit!r} in {words!r}, expected numbers in the part's length unit")
    return name.strip() or place.strip(), numbers.numbers
