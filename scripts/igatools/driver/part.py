"""What the driver knows of a part before its first grid: the kind of its file, and the spans that its walls want."""
import math

ALONG = 12             # spans along the longest side, where nothing asks for smaller ones
THIN_SHARE = 0.2       # of the volume: where less of it lies in thin walls, finer grids are left to find them
CAD_ENDINGS = (".step", ".stp", ".iges", ".igs", ".brep", ".brp")


def is_cad(part):
    return part.suffix.lower() in CAD_ENDINGS


def power(quotient, ratio):
    """The power of the ratio that gives the quotient."""
    return math.log(quotient) / math.log(ratio)


def functions(volume, area, degree, size):
    """Rough number of B-splines that see material: one for each span inside, and along the surface p + 1 layers of half a span."""
    return volume / size**3 + (degree + 1) * area / (2 * size**2)


def smallest(volume, area, degree, most):
    """The size with so many functions."""
    low, high = 1e-9 * math.sqrt(area), math.sqrt(area)
    for _ in range(80):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if functions(volume, area, degree, middle) > most else (low, middle)
    return high


def size(prep, degree, most):
    """Size, and a sentence where the walls want a smaller one than a first grid of so many functions at most has.
    prep: report of igaprep for ALONG spans."""
    usual = min(prep["grid"]["span_size"])
    wall, gap, wanted = prep.get("thinnest_wall"), prep.get("narrowest_gap"), usual
    is_thin = wall and prep["thin_wall_volume_share"] > THIN_SHARE
    if is_thin:
        wanted = min(wanted, wall["span_size"])
    if gap:
        # Walls across a gap move on their own whatever the span size; only where it ends do spans of its width help.
        wanted = min(wanted, max(gap["width"], usual / 2))
    least = smallest(prep["volume"], prep["area"], degree, most)
    first = max(wanted, min(usual, least))
    note = None
    if is_thin and first > 1.05 * wall["span_size"]:
        note = (f"walls of {wall['thickness']:.3g} want spans of {wall['span_size']:.3g}; the first grid has {first:.3g}, since finer "
                "ones would be large")
    return first, note
