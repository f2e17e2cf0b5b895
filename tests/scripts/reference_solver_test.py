#!/usr/bin/python3
"""The second solver (scripts/studies/iga_reference_solver.py) against formulas and reference numbers, then igasolve against
it.  usage: reference_solver_test.py SOURCE_DIR SHARED_DIR IGAPREP IGASOLVE"""
import csv
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, SHARED, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:5])
SOLVER = SOURCE / "scripts" / "studies" / "iga_reference_solver.py"
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "scripts" / "studies"), str(Path(__file__).resolve().parent)]
import iga_reference_solver as reference  # noqa: E402
from igatools import iga_model  # noqa: E402
from parts import CUBE_FREQUENCIES, write_boxes  # noqa: E402

STEEL = {"E": 2.6, "nu": 0.3, "rho": 1.0}  # shear modulus 1


def material_words(material=None):
    return [word for key, value in (material or STEEL).items() for word in (f"--{key}", repr(value))]


class ReferenceSolverTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        write_boxes(cls.path / "cube.stl", [((0, 0, 0), (1, 1, 1))])
        write_boxes(cls.path / "two.stl", [((0, 0, 0), (1, 1, 1)), ((5, 0, 0), (6, 1, 1))])

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def model(self, name, stl, *words):
        """A model of a part of this folder, made by igaprep."""
        path = self.path / f"{name}.h5"
        subprocess.run([IGAPREP, stl, "-o", path, "--quiet", "--force", "--threads", "2", *map(str, words)], check=True)
        return path

    def rotated_cube(self, degree, spans):
        return self.model(f"rotated{degree}", self.path / "cube.stl", "--degree", degree, "--span-size", 1 / spans,
                          "--moment-degree", "2p", "--rotate-axis-angle", 1, 2, 3, 25)

    def test_derivatives_are_limits_of_differences(self):
        for degree in (1, 2, 3, 4):
            knots = np.concatenate([[0.0] * (degree + 1), [0.7, 1.5, 1.9, 3.0], [4.0] * (degree + 1)])
            for span, (low, high) in enumerate(zip(knots[degree:], knots[degree + 1:len(knots) - degree])):
                u = np.linspace(low, high, 9)[1:-1]
                spans, step = np.full(len(u), span), 1e-5
                difference = (iga_model.basis(knots, degree, spans, u + step)
                              - iga_model.basis(knots, degree, spans, u - step)) / (2 * step)
                np.testing.assert_allclose(iga_model.basis_derivatives(knots, degree, spans, u), difference, atol=1e-8)

    def test_gradients_of_positions_are_the_identity_in_a_rotated_grid(self):
        model = iga_model.read(self.rotated_cube(2, 3))
        spans, parameters = model.point_spans(), model["/quadrature/parameters"]
        numbers, _ = model.functions_at(spans, parameters)
        gradients = model.gradients_at(spans, parameters)
        of_x = np.einsum("qia,qib->qab", model.control_points(numbers), gradients)
        np.testing.assert_allclose(of_x, np.broadcast_to(np.eye(3), of_x.shape), atol=1e-11)

    def test_free_cube(self):
        """Multiplicities too; a conforming method with exact integrals is stiffer than the solid."""
        C, mu = reference.isotropic(STEEL["E"], STEEL["nu"]), STEEL["E"] / (2 * (1 + STEEL["nu"]))
        cases = [("aligned", self.model("aligned", self.path / "cube.stl", "--degree", 3, "--spans", 4), 5e-4, 1e-9),
                 ("rotated", self.rotated_cube(2, 4), 5e-3, 1e-3)]
        for name, path, bound, spread in cases:
            with self.subTest(name):
                report = reference.solve(path, C, STEEL["rho"], len(CUBE_FREQUENCIES))
                self.assertEqual(report["rigid_modes"], 6)
                self.assertAlmostEqual(report["mass"], 1, delta=1e-12)
                self.assertLess(report["max_residual"], 1e-9)
                found = 2 * np.pi * np.array(report["frequencies"])
                self.assertLess(found[5], 1e-5 * found[6])
                error = found[6:] / np.sqrt(mu / STEEL["rho"]) / CUBE_FREQUENCIES - 1
                self.assertGreater(error.min(), -1e-5)
                self.assertLess(error.max(), bound)
                np.testing.assert_allclose(found[[7, 9, 10, 12, 13]], found[[6, 8, 8, 11, 11]], rtol=spread)

    def test_two_bodies_have_twelve_rigid_modes_and_every_frequency_twice(self):
        path = self.model("two", self.path / "two.stl", "--degree", 2, "--span-size", 0.5)
        values = reference.solve(path, reference.isotropic(2.6, 0.3), 1.0, 10)
        self.assertEqual(values["rigid_modes"], 12)
        self.assertEqual(len(values["frequencies"]), 22)
        elastic = np.array(values["frequencies"][12:])
        np.testing.assert_allclose(elastic[:4], elastic[0], rtol=1e-9)
        np.testing.assert_allclose(elastic[4:], elastic[4], rtol=0.05)

    def test_the_full_matrix_of_an_isotropic_material_says_the_same(self):
        path = self.rotated_cube(2, 3)
        C = reference.isotropic(2.6, 0.3)
        words = ["--elasticity", *(repr(c) for c in C.ravel()), "--rho", "1", "--modes", "4", "--json"]
        done = subprocess.run([SOLVER, path, *words], capture_output=True, text=True, check=True)
        expected = reference.solve(path, C, 1.0, 4)
        np.testing.assert_allclose(json.loads(done.stdout)["frequencies"][6:], expected["frequencies"][6:], rtol=1e-10)

    def test_largest_frequency_of_the_trimmed_cube(self):
        table = SHARED / "reference" / "trimmed_cube_omega.csv"
        if not table.exists():
            self.skipTest(f"{table} is absent")
        rows = csv.DictReader(table.read_text().splitlines())
        known = {(row["p"], row["theta_mm"]): float(row["omega_max_rad_per_ms"]) for row in rows}
        for degree, theta in ((1, "3"), (2, "9.9")):
            with self.subTest(f"p = {degree}, theta = {theta}"):
                low, high = (float(theta),) * 3, (120 - float(theta),) * 3
                write_boxes(self.path / "trimmed.stl", [(low, high)])
                path = self.model("trimmed", self.path / "trimmed.stl", "--degree", degree, "--box", 0, 0, 0, 120, 120, 120,
                                  "--spans", 12, "--moment-degree", "2p")
                report = reference.solve(path, reference.isotropic(210, 0.33), 7.8e-6, only_largest=True)
                self.assertAlmostEqual(report["omega_max"] / known[str(degree), theta], 1, delta=1e-6)
                self.assertAlmostEqual(report["dt_crit"] * report["omega_max"], 2, delta=1e-12)

    def igasolve(self, path, *words):
        done = subprocess.run([IGASOLVE, "eigen", path, *material_words(), "--light-functions", "none", "--json",
                               "--threads", "2", *map(str, words)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_igasolve_finds_the_same_eigenvalues(self):
        boxed = ("--box", -0.31, -0.31, -0.31, 1.49, 1.49, 1.49, "--spans", 6)
        parts = [("rotated cube, p = 2", self.rotated_cube(2, 3)),
                 ("trimmed cube, p = 2", self.model("boxed2", self.path / "cube.stl", "--degree", 2, *boxed)),
                 ("trimmed cube, p = 3", self.model("boxed3", self.path / "cube.stl", "--degree", 3, *boxed)),
                 ("two cubes, p = 1", self.model("two1", self.path / "two.stl", "--degree", 1, "--span-size", 0.3))]
        C = reference.isotropic(STEEL["E"], STEEL["nu"])
        for name, path in parts:
            with self.subTest(name):
                ours, theirs = reference.solve(path, C, STEEL["rho"], 12), self.igasolve(path, "--modes", 12)
                for key in ("rigid_modes", "unknowns"):
                    self.assertEqual(ours[key], theirs[key])
                rigid = ours["rigid_modes"]
                eigenvalues = [np.square(report["frequencies"][rigid:]) for report in (ours, theirs)]
                self.assertEqual(len(eigenvalues[1]), 12)
                np.testing.assert_allclose(*eigenvalues, rtol=1e-8)

    def test_igasolve_finds_the_same_largest_frequency(self):
        path = self.rotated_cube(2, 3)
        ours = reference.solve(path, reference.isotropic(STEEL["E"], STEEL["nu"]), STEEL["rho"], only_largest=True)
        theirs = self.igasolve(path, "--largest", "--mass", "lumped")
        self.assertAlmostEqual(theirs["omega_max"] / ours["omega_max"], 1, delta=1e-8)

    def test_wrong_input_is_refused_with_a_reason(self):
        path = self.rotated_cube(2, 3)
        damaged = self.path / "damaged.h5"
        shutil.copyfile(path, damaged)
        with open(damaged, "r+b") as file:
            file.truncate(path.stat().st_size // 2)
        indefinite = np.eye(6)
        indefinite[0, 0] = -1
        cases = [
            (path, ["--E", "1", "--nu", "0.5", "--rho", "1"], 2, "nu = 0.5"),
            (path, ["--E", "1", "--nu", "0.3", "--rho", "0"], 2, "density"),
            (path, ["--rho", "1"], 2, "--elasticity"),
            (path, ["--elasticity", *map(str, indefinite.ravel()), "--rho", "1"], 2, "positive definite"),
            (path, [*material_words(), "--modes", "100000"], 2, "unknowns"),
            (path, [*material_words(), "--largest"], 2, "--mass lumped"),
            (self.path / "absent.h5", material_words(), 2, "absent.h5"),
            (damaged, material_words(), 3, "damaged.h5"),
        ]
        for model, words, code, reason in cases:
            with self.subTest(reason):
                done = subprocess.run([SOLVER, model, *words], capture_output=True, text=True)
                self.assertEqual(done.returncode, code, done.stderr)
                self.assertIn(reason, done.stderr)
                self.assertNotIn("Traceback", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
