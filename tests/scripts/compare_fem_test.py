#!/usr/bin/python3
"""The comparison with standard finite elements, on a cube whose frequencies are known: Gmsh, CalculiX, igaprep and igasolve
in one run, and the parts of the scripts alone.  usage: compare_fem_test.py SOURCE_DIR BIN_DIR
Exit code 77 (skipped) where Gmsh or CalculiX are not installed."""
import csv
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, BIN = Path(sys.argv[1]), Path(sys.argv[2])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "scripts" / "studies"), str(Path(__file__).resolve().parent)]
import comparison_report  # noqa: E402
from igatools import calculix, tet_mesh  # noqa: E402
from parts import CUBE_FREQUENCIES, run_tests, write_boxes  # noqa: E402

MISSING = [f"{name} (apt-get install {package})" for name, package in (("gmsh", "gmsh"), ("ccx", "calculix-ccx"))
           if shutil.which(name) is None]
SCRIPT = SOURCE / "scripts" / "studies" / "compare_fem.py"


class PartsTest(unittest.TestCase):
    def test_closest_points_on_a_triangle(self):
        triangle = np.array([[(0, 0, 0), (1, 0, 0), (0, 1, 0)]], dtype=float)
        cases = {(-1, -1, 0): (0, 0, 0), (2, -1, 3): (1, 0, 0), (-1, 2, 1): (0, 1, 0), (0.4, -1, 1): (0.4, 0, 0),
                 (-1, 0.3, 1): (0, 0.3, 0), (1, 1, 2): (0.5, 0.5, 0), (0.2, 0.3, 5): (0.2, 0.3, 0)}
        for point, expected in cases.items():
            found = tet_mesh.closest_on_triangles(np.array([point], dtype=float), triangle)
            np.testing.assert_allclose(found[0], expected, atol=1e-15)

    def test_closest_points_on_large_and_small_triangles(self):
        random = np.random.default_rng(3)
        corners = random.uniform(-1, 1, (40, 1, 3))
        triangles = corners + random.uniform(-1, 1, (40, 3, 3)) * random.choice([0.01, 0.3, 1.5], (40, 1, 1))
        points = random.uniform(-1, 1, (50, 3))
        every = np.stack([tet_mesh.closest_on_triangles(points, np.repeat(t[None], 50, axis=0)) for t in triangles], 1)
        distance = np.linalg.norm(every - points[:, None], axis=2).min(1)
        found = tet_mesh.Surface(triangles, 0.05).closest(points)
        np.testing.assert_allclose(np.linalg.norm(found - points, axis=1), distance, atol=0.01)

    def test_mid_edge_nodes_go_to_the_surface_and_back_where_they_distort(self):
        nodes = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], dtype=float)
        tets = np.array([[0, 1, 2, 3]])

        class Bulge:
            def __init__(self, size):
                self.size = size

            def closest(self, points):
                return points * (1 + self.size)

        straight, quadratic = tet_mesh.quadratic_tets(nodes, tets)
        self.assertEqual(straight.shape, (10, 3))
        np.testing.assert_allclose(straight[quadratic[0, 4:]], nodes[tet_mesh.EDGES].mean(1))
        self.assertAlmostEqual(tet_mesh.curved_volume(straight, quadratic), 1 / 6, delta=1e-15)
        curved, quadratic = tet_mesh.quadratic_tets(nodes, tets, Bulge(0.1))
        np.testing.assert_allclose(curved[quadratic[0, 4:]], 1.1 * nodes[tet_mesh.EDGES].mean(1))
        self.assertGreater(tet_mesh.curved_volume(curved, quadratic), 1 / 6)
        folded, quadratic = tet_mesh.quadratic_tets(nodes, tets, Bulge(5.0))
        np.testing.assert_allclose(folded, straight)

    def test_extrapolation_and_times_at_equal_error(self):
        def run(method, elements, frequency, time):
            return {"method": method, "size": str(elements), "unknowns": elements, "elements": elements, "volume": 1.0,
                    "frequencies": [frequency, 5.0 + (elements == 512)], "prep_wall_s": 0, "solve_wall_s": time,
                    "prep_cpu_s": 0, "solve_cpu_s": time, "prep_memory_mib": 1, "solve_memory_mib": 2, "points": elements}

        runs = [run("C3D10", n**3, 2 + 0.3 * n**-3.5, n**3) for n in (2, 4, 8)]
        extrapolated = comparison_report.richardson(runs)
        self.assertAlmostEqual(extrapolated[0], 2, delta=1e-12)
        self.assertIsNone(extrapolated[1])
        for one, error in zip(runs, (1e-1, 1e-2, 1e-3)):
            one["mean_error"] = error
        self.assertAlmostEqual(comparison_report.time_at_error(runs, 1e-2, "solve_cpu_s"), 64)
        self.assertAlmostEqual(comparison_report.time_at_error(runs, 10**-1.5, "solve_cpu_s"), (8 * 64)**0.5)
        self.assertIsNone(comparison_report.time_at_error(runs, 1e-4, "solve_cpu_s"))

    def test_a_missing_program_names_its_package(self):
        with tempfile.TemporaryDirectory() as folder:
            write_boxes(Path(folder) / "cube.stl", [((0, 0, 0), (1, 1, 1))])
            done = subprocess.run([SCRIPT, Path(folder) / "cube.stl", "--output", Path(folder) / "out", "--only", "fem"],
                                  capture_output=True, text=True, env={"PATH": folder})
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("apt-get install gmsh", done.stderr)


@unittest.skipIf(MISSING, f"missing: {', '.join(MISSING)}")
class CubeTest(unittest.TestCase):
    def test_both_ways_reach_the_known_frequencies(self):
        with tempfile.TemporaryDirectory() as folder:
            path, out = Path(folder) / "cube.stl", Path(folder) / "out"
            write_boxes(path, [((0, 0, 0), (1, 1, 1))])
            words = [path, "--output", out, "--bin", BIN, "--E", "2.6", "--nu", "0.3", "--rho", "1", "--degrees", "2",
                     "--linear-sizes", "0.2", "--quadratic-sizes", "0.4", "0.2", "--spans", "0.25"]
            done = subprocess.run([SCRIPT, *words], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            runs = {(run["method"], run["size"]): run for run in json.loads((out / "comparison.json").read_text())["runs"]}
            bounds = {("C3D4", "0.2"): 0.25, ("C3D10", "0.4"): 0.04, ("C3D10", "0.2"): 0.004, ("p2", "0.25"): 0.004}
            self.assertEqual(set(runs), set(bounds))
            for key, bound in bounds.items():
                error = 2 * np.pi * np.array(runs[key]["frequencies"]) / CUBE_FREQUENCIES[:10] - 1
                self.assertGreater(error.min(), -1e-5, key)
                self.assertLess(error.max(), bound, key)
                self.assertAlmostEqual(runs[key]["volume"], 1, delta=1e-9)
                self.assertGreater(runs[key]["solve_memory_mib"], 1)
            self.assertEqual(runs["C3D10", "0.2"]["points"], 4 * runs["C3D4", "0.2"]["points"])
            self.assertEqual(runs["C3D10", "0.2"]["max_error"], 0)
            self.assertIn("reference", done.stdout)
            self.assertEqual(len(list(csv.reader((out / "frequencies.csv").read_text().splitlines()))), 2 + len(runs))  # p2c too
            splines = runs["p2", "0.25"]
            exact = CUBE_FREQUENCIES[:10] / (2 * np.pi)
            off = {key: np.abs(np.array(splines[key]) / exact - 1).mean() for key in ("frequencies", "corrected")}
            self.assertLess(off["corrected"], 0.5 * off["frequencies"])
            self.assertTrue((out / "comparison.png").exists())
            again = subprocess.run([SCRIPT, *words, "--reuse", "all"], capture_output=True, text=True)
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertEqual(again.stdout.count("(reused)"), 1 + len(runs))
            other = subprocess.run([SCRIPT, *words, "--reuse", "all", "--E", "3"], capture_output=True, text=True)
            self.assertEqual(other.returncode, 2)
            self.assertIn("another part, material", other.stderr)


if __name__ == "__main__":
    run_tests(f"missing {', '.join(MISSING)}" if MISSING else "")
