#!/usr/bin/python3
"""Holds the writer, the C++ reader and the Python reader of results against schema/results.toml.
usage: results_schema_test.py SOURCE_DIR SYNTHETIC_RESULTS_TOOL"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, TOOL = (Path(argument) for argument in sys.argv[1:3])
sys.path.insert(0, str(SOURCE / "scripts"))
from igatools import iga_model, iga_results  # noqa: E402
from schema_cases import SchemaCases  # noqa: E402


class ResultsSchemaTest(SchemaCases, unittest.TestCase):
    schema = iga_results.SCHEMA
    readme = (SOURCE / "schema" / "README.md").read_text()
    together = ("/provenance/timing_seconds",)  # belongs to timing_stages
    lists = ("/surface/regions", "/time_series/contact_names", "/time_series/body_names", "/time_series/rigid_names",
             "/time_series/support_names", "/time_series/probe_names", "/body_names", "/table_names",
             "/tables/probe tip/values", "/tables/rms/values", "/provenance/timing_stages", "/provenance/findings",
             "/provenance/warnings", "/eigen/preload", "/buckling/growing", "/buckling/constant")

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        cls.files = [cls.path / f"{kind}.h5" for kind in ("full", "eigen", "static", "buckling")]
        for file in cls.files:
            subprocess.run([TOOL, "write", file.stem, file], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def check(self, path):
        done = subprocess.run([TOOL, "check", path], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def read(self, path):
        return iga_results.read(path)

    def expect_group(self, change, entry):
        if entry["path"] == "/eigen":  # what the analysis named by the file leaves behind
            self.expect_refused(change, "eigen")
        else:
            super().expect_group(change, entry)

    def test_what_users_add_is_ignored(self):
        def change(file):
            file["notes"] = "measured on Tuesday"
            file["eigen/damping"] = np.arange(5)
        self.expect_accepted(change)

    def test_an_impossible_shape_is_refused_without_the_memory(self):
        def change(file):
            del file["/surface/vertices"]
            file.create_dataset("/surface/vertices", shape=(2**40, 3), dtype="f8", chunks=(4096, 3))
        code, text = self.check(self.changed(change))
        self.assertEqual(code, 3, text)

    def test_the_coefficients_are_the_field(self):
        """With the model beside it the file gives the displacement anywhere: here on the surface."""
        subprocess.run([TOOL, "model", self.path / "model.h5"], check=True)
        model, results = iga_model.read(self.path / "model.h5"), iga_results.read(self.path / "eigen.h5")
        cells = results["/surface/vertex_cell"]
        np.testing.assert_array_equal(model["/cells/span"][cells], results["/surface/vertex_span"])
        for step in range(9):
            u = results.field(model, results["/modes"][step], cells, results["/surface/vertex_parameters"])
            np.testing.assert_allclose(u, results["/surface/displacement"][step], atol=1e-15)
        self.assertEqual(results.elastic(), [7, 8])

    def test_command(self):
        command = [sys.executable, SOURCE / "scripts" / "igatools" / "iga_results.py"]
        for kind in ("eigen", "static", "buckling", "full"):
            done = subprocess.run([*command, self.path / f"{kind}.h5", "--json"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            report = json.loads(done.stdout)
            self.assertEqual(report["model"], "box.h5")
        self.assertEqual(report["factors"], [2.5, 4, -3])
        self.assertEqual(report["kinds"][6:], ["MECHANISM", "ELASTIC", "ELASTIC"])
        self.assertEqual(report["reactions"]["Wand"], [4, 5, 6])
        self.assertEqual(subprocess.run([*command, "missing.h5"], capture_output=True).returncode, 2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
