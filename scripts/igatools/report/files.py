"""The files that a report names."""
from pathlib import Path


def located(folder, name):
    """A file of a report: beside the report, or relative to where the command ran. None where it is not found."""
    if not name:
        return None
    name = Path(name)
    places = [name] if name.is_absolute() else [folder / name, name]
    places.append(folder / name.name)  # the folder was moved
    return next((place for place in places if place.is_file()), None)
