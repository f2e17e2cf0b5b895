"""What pyproject.toml cannot say: the version is CMake's, and the schema lies beside the scripts, not among them."""
import re
from pathlib import Path

from setuptools import find_namespace_packages, setup

ROOT = Path(__file__).resolve().parent

setup(
    version=re.search(r"project\(\S+ VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1],
    packages=["igatools.schema",
              *find_namespace_packages("scripts", include=["igatools", "igatools.*"], exclude=["*__pycache__*"])],
    package_dir={"": "scripts", "igatools.schema": "schema"},
    package_data={"": ["*"]},
    scripts=["scripts/iga"],
)
