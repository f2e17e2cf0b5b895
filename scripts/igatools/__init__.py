"""What the Python scripts share: readers of the model and results files, pictures, surfaces in STL, finite element meshes and
their solver, measured runs of programs. A script finds this package in its own folder or in the one above."""
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]  # of the repository
