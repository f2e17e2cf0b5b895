"""Files that are there whole or not at all."""
import os
from pathlib import Path


def write_text(path, text):
    """In UTF-8, under a temporary name first."""
    beside = Path(f"{path}.new")
    beside.write_text(text, encoding="utf-8")
    os.replace(beside, path)
