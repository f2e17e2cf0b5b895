#!/usr/bin/python3
"""The comparison of elastic waves: CalculiX explicit and igasolve explicit in one run, coarse; and its exact solution alone.
usage: compare_wave_test.py SOURCE_DIR BIN_DIR
Exit code 77 (skipped) where CalculiX is not installed."""
import csv
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, BIN = Path(sys.argv[1]), Path(sys.argv[2])
SCRIPT = SOURCE / "scripts" / "studies" / "compare_wave.py"
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "scripts" / "studies")]
import bar_wave  # noqa: E402
from igatools import calculix  # noqa: E402
from parts import run_tests  # noqa: E402

MISSING = None if shutil.which("ccx") else "missing: ccx (apt-get install calculix-ccx)"


class PartsTest(unittest.TestCase):
    def test_exact_solution_keeps_momentum_and_obeys_the_wave_equation(self):
        t = np.linspace(0, bar_wave.END, 2001)
        x = np.linspace(0, bar_wave.LENGTH, 401)
        u = np.array([bar_wave.exact(place, t) for place in x])
        # The bar's momentum per area is the impulse of the pressure.
        momentum = bar_wave.RHO * np.gradient(np.trapz(u, x, axis=0), t)
        np.testing.assert_allclose(momentum[5:-5], bar_wave.impulse(t)[5:-5], atol=1e-4 * bar_wave.impulse(1.0))
        # The far end is free, the near one under the pressure: E u_x = -p.
        slope = np.gradient(u, x, axis=0)
        stress = bar_wave.E * slope
        self.assertLess(np.abs(stress[-1]).max(), 0.02 * bar_wave.PEAK)
        self.assertLess(np.abs(stress[0] + bar_wave.pressure(t)).max(), 0.02 * bar_wave.PEAK)
        inside = bar_wave.E * np.gradient(slope, x, axis=0) - bar_wave.RHO * np.gradient(np.gradient(u, t, axis=1), t, axis=1)
        self.assertLess(np.abs(inside[2:-2, 2:-2]).max(), 0.02 * np.abs(bar_wave.RHO * np.gradient(np.gradient(u, t, axis=1), t,
                                                                                                   axis=1)).max())

    def test_probes_are_nodes_and_their_mean_is_that_of_the_face(self):
        nodes, bricks, loaded = bar_wave.hexahedra(5.0)
        self.assertEqual(len(bricks), 20 * 2 * 2)
        self.assertEqual(len(loaded), 4)
        points = bar_wave.probe_points()
        np.testing.assert_allclose(nodes[bar_wave.nodes_at(nodes, points)], points)
        y, z = points[:-1, 1], points[:-1, 2]
        found = bar_wave.observed(np.append(y**2 * z**3, 0)[None])[0, 0]
        self.assertAlmostEqual(found, 10**2 / 3 * 10**3 / 4, delta=1e-9)

    def test_displacements_are_read_in_the_order_of_the_probes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "run.dat"
            block = " displacements (vx,vy,vz) for set PROBES and time  {}\n\n 3 1. 2. 3.\n 7 4. 5. 6.\n 5 7. 8. 9.\n\n"
            path.write_text(block.format("0.1E+00") + block.format("0.2E+00"))
            t, u = calculix.read_displacements(path, [6, 2, 4])
        np.testing.assert_allclose(t, [0.1, 0.2])
        np.testing.assert_allclose(u[1], [[4, 5, 6], [1, 2, 3], [7, 8, 9]])

    def test_a_missing_program_names_its_package(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([SCRIPT, "--quick", "--methods", "C3D8", "--output", folder], capture_output=True, text=True,
                                  env=os.environ | {"PATH": folder})
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("apt-get install calculix-ccx", done.stderr)


@unittest.skipIf(MISSING, MISSING)
class WaveTest(unittest.TestCase):
    def test_both_programs_meet_the_exact_wave_and_each_other(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([SCRIPT, "--quick", "--methods", "C3D8", "p1-aligned", "p2", "p2-two-pass", "--bin", BIN,
                                   "--output", folder], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            print(done.stdout)
            with open(Path(folder) / "wave.csv", newline="") as file:
                rows = {(float(row["nu"]), row["method"]): row for row in csv.DictReader(file)}
            self.assertGreater((Path(folder) / "wave.png").stat().st_size, 10000)
        error = {key: float(row["error_end"]) for key, row in rows.items() if row["error_end"]}
        # Ten sizes to the pulse: lumped p = 1 errs by (k h)^2 / 24 = 1.5 % in frequency at its wave number, the step takes
        # part of that back; p = 2 by three times as much; two passes leave the step's error.
        self.assertLess(error[0, "C3D8"], 0.015)
        self.assertLess(error[0, "p1-aligned"], 0.015)
        self.assertLess(error[0, "p2"], 0.045)
        self.assertLess(error[0, "p2-two-pass"], 0.015)
        self.assertLess(3 * error[0, "p2-two-pass"], error[0, "p2"])
        # nu = 0.3: the other program's curve, same size.
        self.assertEqual(rows[0.3, "C3D8"]["error_end"], "")
        self.assertLess(error[0.3, "p1-aligned"], 0.015)  # the same element, another step
        self.assertLess(error[0.3, "p2-two-pass"], 0.03)
        self.assertEqual(rows[0, "C3D8"]["unknowns"], rows[0, "p1-aligned"]["unknowns"])


if __name__ == "__main__":
    run_tests(MISSING)
