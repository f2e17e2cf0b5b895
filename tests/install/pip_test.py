#!/usr/bin/python3
"""pip installs the Python package, without a network, and it works from there.
usage: pip_test.py SOURCES IGAPREP_FOLDER FOLDER; exit code 77 where pip, setuptools or wheel is missing"""
import os
import shutil
import subprocess
import sys
import unittest
from importlib.util import find_spec
from pathlib import Path

from installation import run, skip

SOURCES, PROGRAMS, WORK = map(Path, sys.argv[1:4])
TAKEN = ("pyproject.toml", "setup.py", "CMakeLists.txt", "README.md", "scripts", "schema")


class Pip(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        for name in TAKEN:  # pip leaves its work beside the sources
            copy = shutil.copytree if (SOURCES / name).is_dir() else shutil.copy
            (WORK / "sources").mkdir(parents=True, exist_ok=True)
            copy(SOURCES / name, WORK / "sources" / name)
        cls.target = WORK / "target"
        run(sys.executable, "-m", "pip", "install", WORK / "sources", "--target", cls.target, "--no-build-isolation", "--no-deps",
            "--no-index", "--disable-pip-version-check", "--quiet", env={**os.environ, "PIP_ROOT_USER_ACTION": "ignore"})
        shutil.rmtree(WORK / "sources")
        cls.env = {**os.environ, "PYTHONPATH": str(cls.target), "PATH": f"{PROGRAMS}:/usr/bin:/bin"}

    def python(self, text, *words):
        return run(sys.executable, "-c", text, *words, env=self.env, cwd=WORK)

    def test_version_is_that_of_cmake(self):
        text = "from importlib.metadata import version; print(version('iga-trimmed-solids'))"
        self.assertIn(f"VERSION {self.python(text).strip()} ", (SOURCES / "CMakeLists.txt").read_text())

    def test_everything_the_package_needs_is_there(self):
        for path in (SOURCES / "scripts/igatools").rglob("*"):
            if path.is_file() and "__pycache__" not in path.parts:
                self.assertTrue((self.target / path.relative_to(SOURCES / "scripts")).exists(), path)
        self.assertTrue((self.target / "igatools/schema/model.toml").exists())

    def test_models_are_read(self):
        run(PROGRAMS / "igaprep", SOURCES / "samples/impact_cube/cube.stl", "-o", WORK / "cube.h5", "--spans", 4, "--quiet")
        text = "import igatools, sys; print(igatools.Model(sys.argv[1]).volume, igatools.__file__)"
        volume, file = self.python(text, WORK / "cube.h5").split()
        self.assertAlmostEqual(float(volume), 1e6, places=3)
        self.assertTrue(file.startswith(str(self.target)), file)

    def test_iga_starts(self):
        self.assertIn("usage: iga", run(sys.executable, self.target / "bin/iga", "--help", env=self.env, cwd=WORK))
        refused = subprocess.run([sys.executable, self.target / "bin/iga", "modes", "nothing.stl", "--material", "steel"],
                                 env=self.env, cwd=WORK, capture_output=True, text=True)
        self.assertEqual(refused.returncode, 2, refused.stderr)


if __name__ == "__main__":
    missing = [name for name in ("pip", "setuptools", "wheel") if find_spec(name) is None]
    if missing:
        skip(f"Python's {', '.join(missing)} is missing; apt-get install python3-pip python3-setuptools python3-wheel")
    unittest.main(argv=sys.argv[:1])
