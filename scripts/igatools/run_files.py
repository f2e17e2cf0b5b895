"""Run files of the samples, for models that lie elsewhere."""
from pathlib import Path


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
