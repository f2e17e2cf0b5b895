"""Run files of the user: read, checked for what the driver needs, and made fit for another folder and model."""
import json
import re
import tomllib

from igatools.driver.kept import hash_of_file
from igatools.driver.programs import Failed

# Keys whose value may name a file beside the run file.
FILE_KEYS = {"model", "materials", "patch", "file", "yield_curve", "factor", "x", "y", "z", "rotation"}


def read(path):
    """The tables of a run file."""
    try:
        with open(path, "rb") as file:
            return tomllib.load(file)
    except tomllib.TOMLDecodeError as error:
        raise Failed(f"{path}: is not a run file: {error}", 2) from error
    except (OSError, UnicodeDecodeError) as error:
        raise Failed(f"{path}: cannot be read: {error}", 2) from error


def named_files(settings, folder):
    """(key, words, path) of the files that a run file names and that are there."""
    found = []
    for key, value in settings.items():
        for entry in value if isinstance(value, list) else [value]:
            if isinstance(entry, dict):
                found += named_files(entry, folder)
            elif isinstance(entry, str) and key in FILE_KEYS and (folder / entry).is_file():
                found.append((key, entry, folder / entry))
    return found


def content(path, settings):
    """What a result depends on: the text and the content of the files that it names, models excepted."""
    return [path.read_text(), *(hash_of_file(file) for key, _, file in named_files(settings, path.parent) if key != "model")]


def with_value(text, key, before, after):
    """The text with `key = "after"` for `key = "before"`, line for line."""
    return re.sub(rf"""(\b{key}\s*=\s*)(["']){re.escape(before)}\2""", lambda found: found[1] + json.dumps(after), text)


def elsewhere(path, settings, models):
    """The text of a run file for any folder: files by their full paths, and models (as the run file names them) replaced.
    Lines stay where they are, so that messages about them hold for the user's file too."""
    text = path.read_text()
    for key, words, file in named_files(settings, path.parent):
        if not (key == "model" and words in models):
            text = with_value(text, key, words, str(file.resolve()))
    for before, after in models.items():
        text = with_value(text, "model", before, str(after.resolve()))
    return text


def refuse_bodies(path, settings):
    if "bodies" in settings:
        raise Failed(f"{path}: has [[bodies]]; this command takes one part, igasolve itself takes several", 2)


def refuse_without_material(path, settings, material):
    if not material and "material" not in settings:
        raise Failed(f"{path}: has no material; add material = \"steel\" or a [material] table, or give --material NAME", 2)


def refuse_without_loads(path, settings):
    moved = [table for table in settings.get("support", []) if "value" in table or "gradient" in table]
    if not settings.get("load") and not moved:
        raise Failed(f"{path}: has neither a [[load]] nor a [[support]] with a value, so nothing would move; add one, such as "
                     '[[load]] with region = "face 3" and force = [0, 0, -1000]', 2)
