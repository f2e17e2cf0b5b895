#!/usr/bin/python3
"""An installation works by itself: its programs, its Python package, and its library in programs of others.
usage: install_test.py CMAKE BUILD_FOLDER FOLDER"""
import json
import os
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import h5py

from installation import Installation, run

CMAKE, BUILD, WORK = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
CONSUMER = Path(__file__).resolve().parent / "consumer"


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        cls.prefix = WORK / "prefix"
        run(CMAKE, "--install", BUILD, "--prefix", cls.prefix)
        cls.installed = Installation(cls.prefix, WORK / "run")
        cls.report = cls.installed.prepare("03_sphere", "sphere.h5")
        cls.model = cls.installed.folder / "samples/parts/sphere.h5"
        with h5py.File(cls.model) as file:
            cls.cells = len(file["/cells/span"])

    def test_programs(self):
        report = json.loads(self.installed.run("igasolve", "info", self.model, "--json"))
        self.assertEqual(report["cells"]["total"], self.cells)

    def test_iga_finds_the_programs_beside_itself(self):
        report = self.installed.modes()
        self.assertEqual(len(report["frequencies"]), 1)
        log = (self.installed.folder / "aligned_box_modes/log.txt").read_text()
        self.assertIn(f"{self.prefix}/bin/igaprep ", log)

    def test_cad_files(self):
        if not (self.prefix / "bin/igaprep-cad").exists():
            self.skipTest("igaprep was built without OpenCASCADE")
        self.assertIn("faces", self.installed.run("igaprep", "samples/14_bracket_from_step/bracket.step", "--list", "--json"))

    def test_python_package(self):
        env = {**self.installed.env, "PYTHONPATH": str(self.prefix / "share/iga-trimmed-solids/scripts")}
        text = "import sys; from igatools import iga_model; print(len(iga_model.read(sys.argv[1])['/cells/span']))"
        self.assertEqual(run(sys.executable, "-c", text, self.model, env=env, cwd="/").split(), [str(self.cells)])

    def test_samples_lead_nowhere_else(self):
        for path in (self.prefix / "share/iga-trimmed-solids/samples").rglob("*.toml"):
            self.assertNotIn("build/", path.read_text(), path)

    def test_python_sample(self):
        self.installed.prepare("12_bracket_static", "bracket_static_model.h5", "--span-size", 6)
        self.installed.run("igasolve", "static", "samples/12_bracket_static/run.toml", "--no-viewer", "--quiet")
        env = {**self.installed.env, "PYTHONPATH": str(self.prefix / "share/iga-trimmed-solids/scripts")}
        parts = self.installed.folder / "samples/parts"
        run(self.installed.folder / "samples/results_in_python/bracket.py", parts / "bracket_static_model.h5",
            parts / "bracket_static.h5", env=env, cwd=self.installed.folder)
        self.assertTrue((self.installed.folder / "bracket_spans.vtu").exists())

    def test_consumer_by_cmake(self):
        folder = WORK / "consumer_cmake"
        run(CMAKE, "-S", CONSUMER, "-B", folder, f"-DCMAKE_PREFIX_PATH={self.prefix}", "-DCMAKE_BUILD_TYPE=Release")
        run(CMAKE, "--build", folder)
        self.assertEqual(run(folder / "number_of_cells", self.model).split(), [str(self.cells)])

    def test_consumer_by_pkg_config(self):
        packages = next(self.prefix.glob("lib*/**/pkgconfig"))
        env = {**os.environ, "PKG_CONFIG_PATH": str(packages)}
        flags = run("pkg-config", "--cflags", "--libs", "iga-trimmed-solids", env=env).split()
        program = WORK / "number_of_cells"
        run("c++", CONSUMER / "number_of_cells.cpp", *flags, "-o", program)
        self.assertEqual(run(program, self.model).split(), [str(self.cells)])

    def test_headers_need_nothing_that_is_not_installed(self):
        include = self.prefix / "include/iga-trimmed-solids"
        headers = sorted(include.rglob("*.hpp"))
        self.assertGreater(len(headers), 10)
        text = "".join(f'#include "{header.relative_to(include)}"\n' for header in headers)
        compiled = subprocess.run(["c++", "-std=c++20", "-fsyntax-only", f"-I{include}", "-x", "c++", "-"], input=text,
                                  capture_output=True, text=True)
        self.assertEqual(compiled.returncode, 0, compiled.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
