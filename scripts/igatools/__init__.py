"""Models and results of iga-trimmed-solids in Python: igatools.Model("part.h5"), igatools.Results("modes.h5").

Besides these two, what the project's scripts share: readers of the files, pictures, surfaces in STL, finite element meshes and
their solver, measured runs of programs. A script finds this package in its own folder or in the one above.
"""
from importlib import import_module
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]  # of the repository, or of what is installed

_PUBLIC = {"Model": "igatools.model", "Results": "igatools.results", "FormatError": "igatools.iga_schema"}
__all__ = sorted(_PUBLIC)


def __getattr__(name):
    """Imported where they are asked for: not every script has h5py."""
    if name not in _PUBLIC:
        raise AttributeError(f"module 'igatools' has no attribute {name!r}")
    return getattr(import_module(_PUBLIC[name]), name)
