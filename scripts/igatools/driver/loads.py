"""Supports and loads of the command line: --fix "face 12", --force "face 3=0,0,-1000" become a run file."""
import difflib
import json
from dataclasses import dataclass

import numpy as np

from igatools.driver import units
from igatools.driver.part import is_cad
from igatools.driver.programs import Failed

FIXED = {"normal", "pinned", "radial"} | {"x", "y", "z", "xy", "xz", "yz", "xyz"}
MOST_LISTED = 12  # names that an error message lists
FLAT = 1e-6       # share by which the normals of a flat face fall short of their area
MOST_PLACES = 40  # and with where they lie, a line each


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


def key_for(place, model, options):
    """"region", "curve" or "point"; Failed where the part has no such name."""
    names = names_of(model)
    for key, known in names.items():
        if place in known:
            return key
    near = nearest(place, [name for known in names.values() for name in known])
    raise Failed(f"{options.part} has no face, edge or vertex '{place}'" + (f", did you mean '{near}'?" if near else "; ")
                 + (" " if near else "") + faces_in_words(model, names["region"], options), 2)


def nearest(place, names):
    """The name that a user may have meant, or None."""
    without_number = place.rstrip("0123456789")
    others = [name for name in names if name.rstrip("0123456789") != without_number]  # "face 40" is not meant by "face 4"
    close = difflib.get_close_matches(place, others, 1, 0.7)
    return close[0] if close else next((name for name in others if place.lower() in name.lower()), None)


def faces_in_words(model, names, options):
    """The names of the faces, and how to find out which is which."""
    if not is_cad(options.part):
        split = "" if options.region_angle else "\n--region-angle 30 splits the surface into more faces, at its sharp edges"
        return f"its faces are\n{places_of_faces(model, names)}{split}"
    more = f" and {len(names) - MOST_LISTED} more" if len(names) > MOST_LISTED else ""
    return (f"its faces are {', '.join(names[:MOST_LISTED])}{more} (igaprep {options.part} --list shows where they lie, --list-edges "
            "edges and vertices too)")


def places_of_faces(model, names):
    """A line for each face, the largest ones: name, area, centroid, and the normal where it is flat."""
    corners = model["/surface/vertices"][model["/surface/triangles"]]
    normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas, region = np.linalg.norm(normals, axis=1), model["/surface/region"]
    total = np.bincount(region, areas, len(names))
    largest, width, lines = np.argsort(-total, kind="stable")[:MOST_PLACES], max(map(len, names)), []
    for number in sorted(largest):
        own = region == number
        middle = areas[own] @ corners[own].mean(axis=1) / total[number]
        normal = normals[own].sum(axis=0) / total[number]
        is_flat = np.linalg.norm(normal) > 1 - FLAT
        lines.append(f"  {names[number]:<{width}}  area {total[number]:.4g}, around {in_words(middle)}"
                     + (f", flat, normal {in_words(normal)}" if is_flat else ""))
    more = len(names) - len(largest)
    return "\n".join(lines) + (f"\n  and {more} smaller ones" if more else "")


def where_names(path):
    """How to learn the names of a part's faces before any of them is known."""
    return f"igaprep {path} --list tells the names of its faces" if is_cad(path) else "a wrong name makes iga list those of its faces"


def in_words(x):
    return "(" + ", ".join(f"{c + 0.0:.4g}" if abs(c) > 1e-9 * np.abs(x).max() else "0" for c in x) + ")"


def table(kind, entries):
    return "\n".join([f"[[{kind}]]", *(f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in entries.items())])


def run_text(options, model, system):
    """The run file of --fix, --force, --pressure, --gravity; names are looked up in the model, units converted to the system."""
    tables = []
    for entry in options.fix:
        key = key_for(entry.place, model, options)
        tables.append(table("support", {"name": f"fixed {entry.place}", "fixed": entry.value, key: entry.place}))
    for entry in options.force:
        key = key_for(entry.place, model, options)
        tables.append(table("load", {"name": f"force on {entry.place}", "force": entry.value.within(system), key: entry.place}))
    for entry in options.pressure:
        if key_for(entry.place, model, options) != "region":
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
