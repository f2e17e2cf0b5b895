#!/usr/bin/python3
"""A block with a slit that ends in its middle, through every analysis, beside tetrahedra.
usage: gap_ends_test.py SOURCE_DIR IGAPREP IGASOLVE

omega of ten-node tetrahedra (CalculiX; section meshed down to 0.05 at the slit's end, 115 000 unknowns, last refinement 0.1 %),
E 210, nu 0.3, rho 7.85e-3, free: scripts/studies/gap_study.py repeats them."""
import json
import math
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))
import explicit_runs  # noqa: E402

SOURCE, IGAPREP, IGASOLVE = Path(sys.argv[1]), *sys.argv[2:4]
MATERIAL = ("--E", "210", "--nu", "0.3", "--rho", "7.85e-3")
TETRAHEDRA = [2.2843, 2.6600, 5.4794, 5.6486, 6.0687, 6.7167]
OUTLINE = [(0, 0), (9, 0), (9, 20), (9.05, 20), (9.05, 0), (20, 0), (20, 40), (0, 40)]
INSIDE = [(0, 1, 2), (0, 2, 7), (2, 3, 7), (3, 6, 7), (3, 4, 5), (3, 5, 6)]


def write_block(path):
    at = lambda corner, z: (*OUTLINE[corner], z)  # noqa: E731
    facets = [tuple(at(c, z) for c in (t if z else t[::-1])) for t in INSIDE for z in (0, 10)]
    for a in range(len(OUTLINE)):
        b = (a + 1) % len(OUTLINE)
        facets += [(at(a, 0), at(b, 0), at(b, 10)), (at(a, 0), at(b, 10), at(a, 10))]
    path.write_text("solid slit\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % v for v in facet) + "endloop\nendfacet\n"
        for facet in facets) + "endsolid\n")


class GapEnds(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = Path(folder.name)
        write_block(cls.path / "slit.stl")
        cls.models = {}

    def model(self, degree=2, *options):
        name = "_".join(["slit", str(degree), *options]).replace("-", "") + ".h5"
        if name not in self.models:
            done = subprocess.run([IGAPREP, self.path / "slit.stl", "-o", self.path / name, "--span-size", "4", "--degree",
                                   str(degree), "--json", *options],
                                  capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.models[name] = json.loads(done.stdout)
        return self.path / name, self.models[name]

    def solve(self, *command):
        done = subprocess.run([IGASOLVE, *map(str, command), "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def omega(self, degree, *options):
        report = self.solve("eigen", self.model(degree, *options)[0], *MATERIAL, "--modes", "6")
        self.assertEqual(report["rigid_modes"], 6)
        return 2 * math.pi * np.array(report["frequencies"][6:])

    def test_frequencies_are_near_those_of_tetrahedra_and_lie_below_glued_ones(self):
        turned = ("--rotate-axis-angle", "1", "2", "3", "17")  # where nothing lies along the grid, the end takes more spans
        for degree, grid, most in ((2, (), 0.04), (3, (), 0.02), (2, turned, 0.36), (3, turned, 0.33)):
            with self.subTest(degree=degree, grid=grid):
                found, glued = self.omega(degree, *grid), self.omega(degree, "--gap-ends", "glued", *grid)
                self.assertLess(np.abs(found / TETRAHEDRA - 1).max(), most)
                self.assertGreater(found[0], 0.999 * TETRAHEDRA[0])
                self.assertGreater((glued / TETRAHEDRA - 1).max(), 1.7 * most)  # what it would be
                self.assertTrue((found < glued * (1 + 1e-3)).all())  # both by rules of different degrees

    def test_reports_say_so(self):
        path, prepared = self.model()
        self.assertGreater(prepared["gap_end_cells"], 0)
        self.assertEqual(prepared["components"], 1)
        self.assertEqual(self.model(2, "--gap-ends", "glued")[1]["gap_end_cells"], 0)
        self.assertEqual(self.model(1)[1]["gap_end_cells"], 0)
        with h5py.File(path) as file:
            self.assertEqual(prepared["functions"], len(file["unknowns/function"]))
        with h5py.File(self.model(1)[0]) as file:
            self.assertNotIn("unknowns", file)
        checked = subprocess.run([IGASOLVE, "check", path], capture_output=True, text=True)
        self.assertEqual(checked.returncode, 0, checked.stderr)

    def test_the_second_solver_agrees(self):
        path = self.model()[0]
        found = self.solve("eigen", path, *MATERIAL, "--modes", "6", "--light-functions", "none")["frequencies"][6:]
        done = subprocess.run([sys.executable, SOURCE / "scripts/studies/iga_reference_solver.py", path, *MATERIAL, "--modes",
                               "6", "--json"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        np.testing.assert_allclose(json.loads(done.stdout)["frequencies"][6:], found, rtol=1e-7)

    def test_damage_is_refused_by_both_readers(self):
        path = self.path / "damaged.h5"
        for dataset, index, value in (("weights", 5, 3.0), ("terms", 0, -1), ("terms", 0, 10**6), ("offsets", 1, 10**7),
                                      ("parameters", (3, 0), 99.0)):
            with self.subTest(dataset=dataset, value=value):
                path.write_bytes(self.model()[0].read_bytes())
                with h5py.File(path, "r+") as file:
                    file["unknowns"][dataset][index] = value
                for command in ([IGASOLVE, "check", path], [sys.executable, SOURCE / "scripts/igatools/iga_model.py", path]):
                    done = subprocess.run(command, capture_output=True, text=True)
                    self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
                    self.assertIn("unknowns", done.stdout + done.stderr)

    def test_uniform_tension_is_exact(self):
        (self.path / "tension.toml").write_text(f"""model = '{self.model()[0]}'
[material]
E = 210
nu = 0.3
rho = 7.85e-3
[[support]]
plane = {{ point = [0, 0, 0], normal = [0, 0, 1], tolerance = 1e-6 }}
fixed = "z"
[[support]]
plane = {{ point = [0, 0, 0], normal = [1, 0, 0], tolerance = 1e-6 }}
fixed = "x"
[[support]]
plane = {{ point = [0, 40, 0], normal = [0, 1, 0], tolerance = 1e-6 }}
fixed = "y"
[[load]]
plane = {{ point = [0, 0, 10], normal = [0, 0, 1], tolerance = 1e-6 }}
traction = [0, 0, 0.21]
[[probe]]
name = "beside the slit"
position = [8, 10, 10]
[[probe]]
name = "across it"
position = [10, 10, 10]
""")
        probes = self.solve("static", self.path / "tension.toml", "-o", self.path / "tension.h5")["statics"]["probes"]
        for probe in probes:
            x, y = probe["position"][:2]
            expected = [-0.3e-3 * x, -0.3e-3 * (y - 40), 1e-2]
            np.testing.assert_allclose(probe["displacement"], expected, atol=1e-9)

    def write_flight(self, end):
        (self.path / "flight.toml").write_text(f"""[[bodies]]
name = "block"
model = '{self.model()[0]}'
material = {{ law = "neo-hookean", E = 210, nu = 0.3, rho = 7.85e-3 }}
velocity = [0.3, 0, 0]
spin = [0, 0, 0.02]
[time]
end = {end}
[output]
interval = 0.2
""")

    def test_free_flight_keeps_its_energy_and_restarts_bit_for_bit(self):
        self.write_flight(40)
        report = self.solve("explicit", self.path / "flight.toml", "-o", self.path / "whole.h5")
        self.assertIn("--gap-ends glued", " ".join(report["findings"]))
        whole = explicit_runs.series(self.path / "whole.h5")
        total = whole["energy/kinetic"] + whole["energy/internal"]
        self.assertLess(np.abs(total / total[0] - 1).max(), 1e-6)
        process = explicit_runs.start([IGASOLVE, "explicit", self.path / "flight.toml", "-o", self.path / "parts.h5"])
        process.send_signal(signal.SIGINT)
        process.communicate()
        self.assertEqual(process.returncode, 130)
        self.solve("explicit", self.path / "flight.toml", "-o", self.path / "parts.h5", "--restart")
        parts = explicit_runs.series(self.path / "parts.h5")
        self.assertEqual(whole.keys(), parts.keys())
        for name in whole:
            self.assertEqual(whole[name].tobytes(), parts[name].tobytes(), name)

    def test_runs_with_contact_glue_gap_ends(self):
        """One model file serves both: with contact it is the model that --gap-ends glued makes, but for finer rules."""
        self.write_flight(4)
        text = (self.path / "flight.toml").read_text() + '[[contacts]]\nself = "block"\n'
        energies, steps = [], []
        for name, options in (("split", ()), ("glued", ("--gap-ends", "glued"))):
            run = self.path / f"contact_{name}.toml"
            run.write_text(text.replace(str(self.model()[0]), str(self.model(2, *options)[0])))
            report = self.solve("explicit", run, "-o", self.path / f"contact_{name}.h5")
            self.assertEqual("share functions there" in " ".join(report["findings"]), name == "split")
            series = explicit_runs.series(self.path / f"contact_{name}.h5")
            energies.append(series["energy/kinetic"][-1])
            steps.append(report["dt"])
        self.assertAlmostEqual(energies[0] / energies[1], 1, places=3)
        self.assertGreater(steps[0] / steps[1], 0.8)

    def test_time_steps(self):
        """Lumped masses: continuous functions have higher frequencies, by how much is in the README."""
        fine, glued = (self.solve("timestep", self.model(2, *options)[0], *MATERIAL, "--mass", "lumped")["dt_crit"]
                       for options in ((), ("--gap-ends", "glued")))
        self.assertGreater(fine / glued, 0.3)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
