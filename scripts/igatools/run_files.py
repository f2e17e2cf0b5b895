"""Run files: those of the samples for models that lie elsewhere, and what several readers of them ask."""
from pathlib import Path

LOAD_KINDS = ("traction", "pressure", "force", "body_force", "acceleration")


def kind_of_load(load):
    """Which of LOAD_KINDS the table of a load holds. Raises ValueError where it is not one."""
    kinds = [kind for kind in LOAD_KINDS if kind in load]
    if len(kinds) != 1:
        raise ValueError(f"expected one of {', '.join(LOAD_KINDS)}")
    return kinds[0]


def read_curve(path):
    """Points (x, y) of a curve's text file: two columns, commas, semicolons or blanks, # opens a comment. Raises ValueError naming it."""
    rows = [line.partition("#")[0].replace(",", " ").replace(";", " ").split() for line in Path(path).read_text().splitlines()]
    try:
        points = [(float(x), float(y)) for x, y in (row for row in rows if row)]
    except ValueError as error:
        raise ValueError(f"{path}: {error}; expected two columns of numbers") from error
    if not points or any(b[0] <= a[0] for a, b in zip(points, points[1:])):
        raise ValueError(f"{path}: expected rows whose first column ascends")
    return points


def smooth_pieces(points, pieces):
    """The curve that `smooth = true` makes of points, s^2 (3 - 2 s) between two of them, as points with so many straight pieces each."""
    fine = [(a + t * (b - a), fa + t * t * (3 - 2 * t) * (fb - fa))
            for (a, fa), (b, fb) in zip(points, points[1:]) for t in (k / pieces for k in range(pieces))]
    return [*fine, points[-1]]


def moved_run(settings, model, *changes):
    """Text of a sample's run file for a model elsewhere and to be stored anywhere; each change (before, after) must apply."""
    text = "\n".join(f'model = "{Path(model).resolve()}"' if line.startswith("model = ") else line
                     for line in settings.read_text().splitlines()) + "\n"
    curve = ('"yield_curve.csv"', f'"{settings.with_name("yield_curve.csv").resolve()}"')
    for before, after in [*([curve] if curve[0] in text else []), *changes]:
        if before not in text:
            raise ValueError(f"{settings} does not hold {before!r}")
        text = text.replace(before, after)
    return text
