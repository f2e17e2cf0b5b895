"""Run files: those of the samples for models that lie elsewhere, and what several readers of them ask."""
from pathlib import Path

LOAD_KINDS = ("traction", "pressure", "force", "body_force", "acceleration")


def kind_of_load(load):
    """Which of LOAD_KINDS the table of a load holds. Raises ValueError where it is not one."""
    kinds = [kind for kind in LOAD_KINDS if kind in load]
    if len(kinds) != 1:
        raise ValueError(f"expected one of {', '.join(LOAD_KINDS)}")
    return kinds[0]


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
