#!/usr/bin/python3
"""Holds the writer, the C++ reader and the Python reader against schema/model.toml, and the Python reader against what is
known of a box in closed form.  usage: schema_test.py SOURCE_DIR WRITE_SYNTHETIC_MODEL IGASOLVE"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

SOURCE, WRITER, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path.insert(0, str(SOURCE / "scripts"))
from igatools import iga_model  # noqa: E402
from schema_cases import SchemaCases  # noqa: E402

README = (SOURCE / "schema" / "README.md").read_text()


class SchemaTest(SchemaCases, unittest.TestCase):
    schema = iga_model.SCHEMA
    readme = README
    together = ("/provenance/timing_seconds",)  # belongs to timing_stages
    lists = ("/surface/regions", "/provenance/timing_stages", "/provenance/findings", "/provenance/warnings")

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        cls.files = [cls.path / f"{kind}.h5" for kind in ("box", "rotated")]
        for file in cls.files:
            subprocess.run([WRITER, file.stem, file, "optional"], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def check(self, path):
        done = subprocess.run([IGASOLVE, "check", path], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def read(self, path):
        return iga_model.read(path)

    def test_what_users_add_is_ignored(self):
        def change(file):
            file["notes"] = "measured on Tuesday"
            file["spans/colour"] = np.arange(5)
            file["quadrature"].attrs["mine"] = 7
        self.expect_accepted(change)

    def test_a_model_of_version_1_is_to_be_made_again(self):
        def change(file):
            file.attrs["format_version"] = "1.1"
        self.expect_refused(change, "made by an older igaprep (format 1.x)", "make the model again with igaprep")

    def test_an_impossible_shape_is_refused_without_the_memory(self):
        def change(file):
            del file["/quadrature/weights"]
            file.create_dataset("/quadrature/weights", shape=(2**40,), dtype="f8", chunks=(4096,))
        code, text = self.check(self.changed(change))
        self.assertEqual(code, 3, text)

    def test_a_damaged_model_names_its_problem(self):
        def set_value(path, index, value):
            def change(file):
                file[path][index] = value
            return change
        cases = [("/quadrature/weights", 0, -1.0, "weights"), ("/quadrature/parameters", (0, 0), 99.0, "parameters"),
                 ("/cells/span", 0, 0, "cells/span"), ("/cells/state", 0, 0, "cells/span"),
                 ("/cells/functions", (0, 1), 0, "cells/functions"), ("/cells/functions", (0, 0), -1, "cells/functions"),
                 ("/functions/number", 0, 0, "cells/functions"), ("/links/cells", (0, 1), 0, "links/cells"),
                 ("/surface/vertex_cell", 0, 10**6, "vertex"),
                 ("/patch/knots_u", 4, 0.5, "knots_u"), ("/patch/control_points", (7, 1), 3.3, "control_points"),
                 ("/curves/offsets", 1, 1, "points, expected two"), ("/curves/offsets", 2, 5, "offset"),
                 ("/curves/names", 1, b"edge 1", "twice"), ("/curves/points", (0, 1), np.inf, "finite"),
                 ("/markers/names", 1, b"", "empty"), ("/markers/positions", (1, 0), np.nan, "finite"),
                 ("/surface/region", 0, 77, "region"), ("/surface/triangles", (0, 0), -1, "triangle"),
                 ("/cells/volume_fraction", 3, np.nan, "volume_fraction")]
        for path, index, value, word in cases:
            with self.subTest(path):
                code, text = self.check(self.changed(set_value(path, index, value)))
                self.assertEqual(code, 3, text)
                self.assertIn(word, text)


    def test_a_point_outside_the_surface_is_found(self):
        def change(file):
            span = iga_model.read(self.files[0]).point_spans()[0]
            degree = file["patch"].attrs["degree"]
            corner = [file[f"patch/knots_{d}"][degree[c] + span[c]] for c, d in enumerate("uvw")]
            file["/quadrature/parameters"][0] = corner  # in its span still
        code, text = self.check(self.changed(change))
        self.assertEqual(code, 3, text)
        self.assertIn("1 of", text)
        self.assertIn("outside the surface", text)


    def test_a_misplaced_point_is_found_by_the_moments_alone(self):
        """Two weights of one cell exchanged, a point moved inside its span and the solid: every other promise holds."""
        def exchange(file):
            first, last = file["/quadrature/offsets"][:2]
            w = file["/quadrature/weights"][first:last]
            w[[w.argmin(), w.argmax()]] = w[[w.argmax(), w.argmin()]]
            self.assertGreater(np.ptp(w), 0)
            file["/quadrature/weights"][first:last] = w

        def move(file):
            first, last = file["/quadrature/offsets"][:2]
            u = file["/quadrature/parameters"][first:last]
            file["/quadrature/parameters"][first] = u.mean(0)
        for change in (exchange, move):
            code, text = self.check(self.changed(change))
            self.assertEqual(code, 3, text)
            self.assertEqual([line for line in text.splitlines() if line.startswith("FAIL")],
                             [line for line in text.splitlines() if "moments" in line and line.startswith("FAIL")])
            self.assertIn("FAIL", text)


class CommandTest(unittest.TestCase):
    """igasolve's exit codes and reports."""

    setUpClass = classmethod(SchemaTest.setUpClass.__func__)
    tearDownClass = classmethod(SchemaTest.tearDownClass.__func__)

    def run_command(self, *arguments):
        done = subprocess.run([IGASOLVE, *arguments], capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    def test_info(self):
        code, text, errors = self.run_command("info", self.path / "rotated.h5", "--json")
        self.assertEqual((code, errors), (0, ""))
        report = json.loads(text)
        self.assertEqual(report["spans"], {"interior": 2, "trimmed": 22, "exterior": 96})
        self.assertEqual(report["grid"]["degree"], [1, 3, 4])
        self.assertAlmostEqual(report["volume"]["weights"], 11.2, delta=1e-12)
        self.assertEqual(len(report["surface"]["regions"]), 6)
        self.assertEqual(report["provenance"]["inputs"][1]["name"], "größe µ.stl")
        self.assertEqual(report["curves"], [{"name": "edge 1", "points": 3, "length": 5},
                                            {"name": "rim größe", "points": 4, "length": 12}])
        self.assertEqual(report["markers"][1], {"name": "vertex 2", "position": [1.5, 2.5, 3.5]})
        code, text, _ = self.run_command("info", self.path / "rotated.h5")
        for word in ("2 interior, 22 trimmed, 96 exterior", "11.2 mm³", "w+: 2 triangles, area 7", "edge 1: 3 points, length 5",
                     "vertex 2: (1.5, 2.5, 3.5)", "igaprep"):
            self.assertIn(word, text)

    def test_check(self):
        code, text, errors = self.run_command("check", self.path / "box.h5", "--json")
        self.assertEqual((code, errors), (0, ""))
        report = json.loads(text)
        self.assertTrue(report["sound"])
        self.assertEqual(len(report["figures"]), 12)
        for row in report["figures"]:
            self.assertTrue(row["pass"] and 0 <= row["found"] <= row["allowed"], row)
            self.assertLess(row["found"], 1e-13, row)
        broken = self.path / "broken.h5"
        broken.write_bytes((self.path / "box.h5").read_bytes()[:5000])
        for command in ("check", "info"):
            code, _, errors = self.run_command(command, broken)
            self.assertEqual(code, 3)
            self.assertIn("broken.h5", errors)
        code, text, _ = self.run_command("check", broken, "--json")
        self.assertEqual(code, 3)
        self.assertFalse(json.loads(text)["sound"])

    def test_results_of_a_model(self):
        results = self.path / "timestep.h5"
        run = self.path / "run.toml"
        run.write_text(f'model = "{self.path / "box.h5"}"\nlight_functions = "degree-p"\n'
                       '[material]\nE = 210\nnu = 0.3\nrho = 7.8e-6\n'
                       '[[support]]\nname = "foot"\nfixed = "xyz"\nregion = "u-"\nmethod = "penalty"\n'
                       '[[load]]\nname = "pull"\nforce = [1, 2, 3]\nregion = "u+"\n')
        code, _, errors = self.run_command("static", run, "-o", results, "--quiet", "--no-viewer", "--force")
        self.assertEqual(code, 0, errors)
        code, text, errors = self.run_command("check", self.path / "box.h5", results)
        self.assertEqual((code, errors), (0, ""), text)
        self.assertEqual(text.count("pass"), 17)
        code, text, errors = self.run_command("check", self.path / "rotated.h5", results)
        self.assertEqual(code, 3)
        self.assertIn("another model", errors)
        with h5py.File(results, "r+") as file:
            file["/static/points/displacement"][3, 1] += 1e-6 * np.abs(file["/static/displacement"]).max()
        code, text, errors = self.run_command("check", self.path / "box.h5", results)
        self.assertEqual(code, 3)
        self.assertIn("displacement at the points", errors)
        code, text, errors = self.run_command("check", self.path / "box.h5", self.path / "rotated.h5")
        self.assertEqual(code, 3)
        self.assertIn("is no results file", errors)

    def test_usage(self):
        self.assertEqual(self.run_command("info", "missing.h5")[0], 2)
        self.assertIn("No such file", self.run_command("check", "missing.h5")[2])
        self.assertEqual(self.run_command()[0], 2)
        self.assertEqual(self.run_command("melt", "part.h5")[0], 2)
        self.assertEqual(self.run_command("info")[0], 2)
        self.assertEqual(self.run_command("info", "a.h5", "--json", "--quiet")[0], 2)
        self.assertEqual(self.run_command("--version")[0], 0)
        self.assertIn("Exit codes", self.run_command("--help")[1])
        self.assertEqual(self.run_command("info", self.path / "box.h5", "--quiet"), (0, "", ""))


class ReaderTest(unittest.TestCase):
    """Volume, centroid and inertia from the points alone against the box's closed form."""

    setUpClass = classmethod(SchemaTest.setUpClass.__func__)
    tearDownClass = classmethod(SchemaTest.tearDownClass.__func__)

    def test_box(self):
        lower, upper, centre = np.array([1.25, 1.5, 1]), np.array([4.75, 3.5, 2.6]), np.array([3, 2.5, 2])
        size = upper - lower
        for kind in ("box", "rotated"):
            model = iga_model.read(self.path / f"{kind}.h5")
            R = model.attribute("/patch", "rotation")
            volume, centroid, second = model.volume_integrals()
            self.assertAlmostEqual(volume, size.prod(), delta=1e-12 * size.prod())
            np.testing.assert_allclose(centroid, centre + R @ ((lower + upper) / 2 - centre), atol=1e-12)
            expected = R @ np.diag(size.prod() * size**2 / 12) @ R.T
            np.testing.assert_allclose(second, expected, atol=1e-11)
            np.testing.assert_allclose(model.mass_fractions(), model["/functions/mass_fraction"], rtol=1e-12)
            np.testing.assert_allclose(model.vertex_positions(), model["/surface/vertices"], atol=1e-12)
            area, normal, enclosed = model.surface_integrals()
            faces = [size[1] * size[2], size[2] * size[0], size[0] * size[1]]
            np.testing.assert_allclose(area, np.repeat(faces, 2), rtol=1e-12)
            np.testing.assert_allclose(normal, 0, atol=1e-12)
            self.assertAlmostEqual(enclosed, size.prod(), delta=1e-12 * size.prod())

    def test_curves_and_markers(self):
        model = iga_model.read(self.path / "box.h5")
        self.assertEqual({name: model.length_of(points) for name, points in model.curves().items()},
                         {"edge 1": 5, "rim größe": 12})
        self.assertEqual(model.markers()["vertex 1"].tolist(), [1.25, 1.5, 1])
        subprocess.run([WRITER, "box", self.path / "none.h5"], check=True, capture_output=True)
        model = iga_model.read(self.path / "none.h5")
        self.assertEqual((model.curves(), model.markers()), ({}, {}))
        self.assertFalse([path for path in model.data if path.startswith(("/curves", "/markers"))])

    def test_control_points_of_a_very_fine_grid(self):
        subprocess.run([WRITER, "fine", self.path / "fine.h5"], check=True, capture_output=True)
        model = iga_model.read(self.path / "fine.h5")
        self.assertNotIn("/patch/control_points", model.data)
        # Positions about 1e6 from the origin are known to 1e-10.
        np.testing.assert_allclose(model.vertex_positions(), model["/surface/vertices"], atol=1e-8)

    def test_command(self):
        command = [sys.executable, SOURCE / "scripts" / "igatools" / "iga_model.py"]
        good = subprocess.run([*command, self.path / "box.h5", "--json"], capture_output=True, text=True)
        self.assertEqual(good.returncode, 0, good.stderr)
        self.assertEqual(subprocess.run([*command, "missing.h5"], capture_output=True).returncode, 2)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
