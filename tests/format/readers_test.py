#!/usr/bin/python3
"""Runs the readers that schema/README.md shows: each must find volume, centroid and unknowns of models with a turned grid, mixed
degrees, copies of functions and ends of gaps.
usage: readers_test.py SOURCE_DIR WRITE_SYNTHETIC_MODEL IGAPREP CXX HDF5_FLAGS"""
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, WRITER, IGAPREP, CXX = Path(sys.argv[1]), *sys.argv[2:5]
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "tests" / "scripts")]
from igatools import extrusion, iga_model, stl  # noqa: E402
from parts import run_tests  # noqa: E402

MISSING = "" if shutil.which("octave-cli") else "Octave is not installed (scripts/setup --solvers installs it)"
README = (SOURCE / "schema" / "README.md").read_text()
BLOCKS = dict(re.findall(r"^```(\w+) reader\n(.*?)^```$", README, re.M | re.S))
SLIT = [(0, 0), (9, 0), (9, 20), (9.05, 20), (9.05, 0), (20, 0), (20, 40), (0, 40)]  # a gap that ends inside


class Readers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = Path(folder.name)
        cls.models = [cls.path / f"{kind}.h5" for kind in ("box", "rotated", "slit")]
        for file in cls.models[:2]:
            subprocess.run([WRITER, file.stem, file, "optional"], check=True, capture_output=True)
        stl.write_stl(cls.path / "slit.stl", extrusion.Prism(SLIT, 10).triangles())
        subprocess.run([IGAPREP, cls.path / "slit.stl", "-o", cls.models[2], "--span-size", "5", "--quiet"], check=True)

    def expect(self, *command):
        for file in self.models:
            with self.subTest(file.stem):
                done = subprocess.run([*command, file], capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                model = iga_model.read(file)
                volume, centroid, _ = model.volume_integrals()
                *numbers, unknowns = done.stdout.split()
                np.testing.assert_allclose([float(x) for x in numbers], [volume, *centroid], rtol=1e-12)
                self.assertEqual(int(unknowns), model.coefficients_from_unknowns().shape[1])

    def block(self, language, name):
        path = self.path / name
        path.write_text(BLOCKS[language])
        return path

    def test_python(self):
        self.expect(sys.executable, self.block("python", "read.py"))

    def test_cpp(self):
        source, program = self.block("cpp", "read.cpp"), self.path / "read"
        done = subprocess.run([CXX, "-std=c++20", source, "-o", program, *sys.argv[5:]], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.expect(program)

    @unittest.skipIf(MISSING, MISSING)
    def test_octave(self):
        self.expect("octave-cli", "--no-gui", "-q", self.block("octave", "read.m"))


run_tests(MISSING)
