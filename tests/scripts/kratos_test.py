#!/usr/bin/python3
"""Kratos Multiphysics on our models (scripts/solve_kratos.py) beside igasolve; results that other programs write, and how they are drawn.
usage: kratos_test.py SOURCE_DIR IGAPREP IGASOLVE

Where Kratos is not installed (scripts/setup --kratos) its tests are left out and the exit code is 77; with IGA_TEST_KRATOS=1 that fails.
"""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

SOURCE, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path[:0] = [str(SOURCE / "scripts"), str(Path(__file__).resolve().parent), str(SOURCE / "tests" / "pipeline")]
import gap_ends_test  # noqa: E402
import parts  # noqa: E402
from igatools import Model, Results, foreign_results  # noqa: E402
from igatools.kratos import stored_energy  # noqa: E402
from igatools.kratos.explicit_run import open_run  # noqa: E402
from igatools.kratos.run_file import RunError, RunFile  # noqa: E402

PYTHON = Path(os.environ.get("IGA_KRATOS", SOURCE / "build" / "kratos")) / "bin" / "python"
KRATOS = PYTHON.exists()
DIGITS = 1e-8  # what two solvers of one system are to agree to; found 1e-10 … 1e-15

STATIC = """model = "{model}"
light_functions = "none"
[material]
E = 1000.0
nu = 0.3
rho = 2.0
[[support]]
name = "wall"
plane = {{ point = [0, 0, 0], normal = [1, 0, 0] }}
method = "penalty"
[[support]]
name = "side"
fixed = "y"
value = [0, 0.001, 0]
normal = {{ direction = [0, 1, 0] }}
method = "penalty"
[[support]]
name = "guide"
fixed = "normal"
normal = {{ direction = [0, 0, -1] }}
method = "penalty"
penalty_factor = 20
[[load]]
name = "end"
plane = {{ point = [6, 0, 0], normal = [1, 0, 0] }}
force = [0, 0, 5]
rotate_axis_angle = [1, 0, 0, 30]
[[load]]
name = "top"
pressure = 0.3
normal = {{ direction = [0, 0, 1] }}
[[load]]
name = "weight"
acceleration = [0, 0.2, -1]
[[probe]]
name = "tip"
position = [6, 1, 1]
"""
SLIT = """model = "{model}"
light_functions = "none"
material = {{ E = 210.0, nu = 0.3, rho = 7.85e-3 }}
[[support]]
plane = {{ point = [0, 40, 0], normal = [0, 1, 0] }}
method = "penalty"
[[load]]
plane = {{ point = [0, 0, 0], normal = [1, 0, 0] }}
traction = [-0.02, 0, 0]
[eigen]
modes = 4
"""
LARGE = """model = "{model}"
light_functions = "none"
[material]
law = "{law}"
E = 1000.0
nu = 0.3
[[support]]
plane = {{ point = [0, 0, 0], normal = [1, 0, 0] }}
[[load]]
plane = {{ point = [6, 0, 0], normal = [1, 0, 0] }}
force = [0, 0, -30]
[[probe]]
name = "tip"
position = [6, 1, 1]
[nonlinear]
steps = 2
"""
STEPS = """gravity = [0, -2, 0]
[[bodies]]
model = "{model}"
velocity = [0.5, 0, 0]
spin = [0, 3, 1]
light_functions = "none"
[bodies.material]
law = "{law}"
E = 1000.0
nu = 0.3
rho = 2.0
[[loads]]
name = "pull"
plane = {{ point = [6, 0, 0], normal = [1, 0, 0] }}
force = [0, 0, -100]
factor = [[0, 0], [0.08, 1], [0.12, 0.5]]
smooth = true
[[loads]]
pressure = 2
normal = {{ direction = [0, 0, 1] }}
[time]
end = 0.16
dt_max = 4e-3
[output]
interval = 4e-2
field_interval = 8e-2
"""


def relative(found, expected):
    return np.abs(np.asarray(found) - expected).max() / np.abs(expected).max()


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = Path(folder.name)
        parts.write_boxes(cls.path / "beam.stl", [((0, 0, 0), (6, 2, 2))])
        gap_ends_test.write_block(cls.path / "slit.stl")
        cls.beam = cls.prepare("beam", "--span-size", "1.3", "--rotate-axis-angle", "1", "2", "3", "25")

    @classmethod
    def prepare(cls, name, *words):
        path = cls.path / f"{name}.h5"
        subprocess.run(
            [IGAPREP, path.with_suffix(".stl"), "-o", path, "--degree", "2", "--quiet", "--force", *words], check=True
        )
        return path

    def run_file(self, name, text, **values):
        path = self.path / f"{name}.toml"
        path.write_text(text.format(**values))
        return path

    def igasolve(self, analysis, run):
        output = run.with_suffix(f".{analysis}.h5")
        done = subprocess.run(
            [IGASOLVE, analysis, run, "-o", output, "--json", "--threads", "2"], capture_output=True, text=True
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return Results(output)

    def draw(self, *words):
        done = subprocess.run([SOURCE / "scripts" / "render.py", *words, "-o", self.path], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)


@unittest.skipUnless(KRATOS, "Kratos Multiphysics is not installed")
class KratosTest(Case):
    def kratos(self, model, run, *words):
        done = subprocess.run(
            [SOURCE / "scripts" / "solve_kratos.py", model, run, "-o", run.parent, "--json", *words],
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return Results(json.loads(done.stdout)["output"])

    def expect_same_static(self, ours, theirs):
        for energy in ("strain_energy", "external_work", "penalty_energy"):
            self.assertLess(relative(theirs.attribute("/static", energy), ours.attribute("/static", energy)), DIGITS)
        self.assertLess(relative(theirs["/static/displacement"], ours["/static/displacement"]), DIGITS)
        self.assertLess(relative(theirs["/static/supports/force"], ours["/static/supports/force"]), DIGITS)
        self.assertLess(relative(theirs["/static/supports/moment"], ours["/static/supports/moment"]), DIGITS)
        for name in ("area", "centroid", "force"):
            self.assertLess(relative(theirs[f"/static/loads/{name}"], ours[f"/static/loads/{name}"]), DIGITS)
        self.assertEqual(theirs.texts("/static/loads/kind"), ours.texts("/static/loads/kind"))

    def test_statics_on_a_turned_grid(self):
        run = self.run_file("static", STATIC, model=self.beam)
        ours, theirs = self.igasolve("static", run), self.kratos(self.beam, run)
        self.expect_same_static(ours, theirs)
        self.assertLess(relative(theirs["/static/probes/displacement"], ours["/static/probes/displacement"]), DIGITS)
        self.assertEqual(theirs.attribute("/provenance", "producer"), "Kratos Multiphysics")
        exported = subprocess.run([IGASOLVE, "export", theirs.path, "--csv"], capture_output=True, text=True)  # our C++ reader
        self.assertEqual(exported.returncode, 0, exported.stderr)

    def test_copies_and_gap_ends(self):
        """Statics and modes; the mass of interior spans takes Gauss points."""
        slit = self.prepare("slit", "--span-size", "4")
        self.assertGreater(Model(slit).copied_functions(), 0)
        self.assertTrue(Model(slit).gap_end_cells().any())
        run = self.run_file("slit", SLIT, model=slit)
        self.expect_same_static(self.igasolve("static", run), self.kratos(slit, run, "--analysis", "static"))
        ours, theirs = self.igasolve("eigen", run), self.kratos(slit, run)
        self.assertEqual(len(theirs["/eigen/omega_squared"]), 4)
        self.assertLess(np.abs(theirs["/eigen/omega_squared"] / ours["/eigen/omega_squared"][:4] - 1).max(), DIGITS)

    def test_free_modes(self):
        run = self.run_file(
            "free",
            'model = "{model}"\nlight_functions = "none"\nmaterial = {{ E = 1000.0, nu = 0.3, rho = 2.0 }}\n'
            "[eigen]\nmodes = 6\n",
            model=self.beam,
        )
        ours, theirs = self.igasolve("eigen", run), self.kratos(self.beam, run)
        self.assertEqual(theirs.kinds(), ["RIGID"] * 6 + ["ELASTIC"] * 6)
        self.assertLess(
            np.abs(theirs["/eigen/omega_squared"][6:] / ours["/eigen/omega_squared"][6:12] - 1).max(), DIGITS
        )

    def test_large_displacement(self):
        for law in ("neo-hookean", "st-venant-kirchhoff"):
            with self.subTest(law):
                run = self.run_file(law, LARGE, model=self.beam, law=law)
                ours, theirs = self.igasolve("nonlinear", run), self.kratos(self.beam, run)
                tip = ours["/time_series/probe/tip/displacement"][-1]
                self.assertGreater(np.abs(tip).max(), 0.4)
                self.assertLess(relative(theirs["/static/probes/displacement"][0], tip), DIGITS)
        self.draw(ours.path, "--minus", theirs.path)
    def test_explicit_steps(self):
        """Kratos' central differences with its own masses: the same motion and energies."""
        run = self.run_file("steps", STEPS, model=self.beam, law="neo-hookean")
        ours, theirs = self.igasolve("explicit", run), self.kratos(self.beam, run)
        self.assertLess(relative(theirs.coefficients(), ours.coefficients(step=-1)), DIGITS)
        found = theirs.table("energies")
        np.testing.assert_allclose(found["time"], ours["/time_series/time"], rtol=1e-12)
        for name, row in (("kinetic", "kinetic"), ("external_work", "external")):
            self.assertLess(relative(found[name][1:], ours[f"/time_series/energy/{row}"][1:]), DIGITS)
        # ours is the work of the steps, theirs what the law stores
        self.assertLess(relative(found["internal"], ours["/time_series/energy/internal"]), 0.02)
        self.assertGreater(found["internal"][-1], 0.01 * found["kinetic"][0])
        self.draw(ours.path, "--minus", theirs.path)
        self.assertTrue((self.path / f"{ours.path.stem}_minus_{theirs.path.stem}.png").is_file())

    def test_steps_above_the_limit_are_refused(self):
        run = self.run_file("long", STEPS.replace("dt_max = 4e-3", "dt_max = 8e-2").replace("end = 0.16", "end = 8"), model=self.beam, law="neo-hookean")
        done = subprocess.run([SOURCE / "scripts" / "solve_kratos.py", self.beam, run, "-o", self.path], capture_output=True, text=True)
        self.assertEqual(done.returncode, 4, done.stderr)
        self.assertRegex(done.stderr, "smaller dt_max")
        self.assertFalse((self.path / "long_kratos.h5").exists())


class ForeignResultsTest(Case):
    def test_coefficients_of_igasolve_come_back_as_its_own_fields(self):
        """And the difference of the two files is drawn; it is zero to rounding."""
        run, model = self.run_file("own", STATIC, model=self.beam), Model(self.beam)
        ours = self.igasolve("static", run)
        path = self.path / "again.h5"
        fields = {"displacement": ours["/static/displacement"], "strain_energy": 1.0, "external_work": 1.0}
        foreign_results.write_results(
            path, model, fields, solver="another", version="2", material=(ours.attribute("/material", "C"), 2.0)
        )
        again, points = Results(path), model.points[::50]
        np.testing.assert_array_equal(again.displacement(points), ours.displacement(points))
        vertices, triangles, found = again.surface()
        np.testing.assert_allclose(found["displacement"], ours.displacement(vertices), rtol=0, atol=1e-12)
        corners = vertices[triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
        self.assertAlmostEqual(np.linalg.norm(normals, axis=1).sum(), 56, delta=1e-12)  # the beam's surface, closed
        self.assertAlmostEqual((corners.mean(1) * normals).sum() / 3, 24, delta=1e-12)
        edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        self.assertTrue((np.unique(edges, axis=0, return_counts=True)[1] == 2).all())
        self.assertLessEqual(np.linalg.norm(np.subtract(*vertices[edges.T]), axis=1).max(), min(model.span_size()) / 2)
        self.draw(ours.path, "--minus", path)
        self.assertTrue((self.path / f"{ours.path.stem}_minus_again.png").stat().st_size > 10_000)

    def test_wrong_coefficients_are_refused_and_leave_nothing(self):
        model, path = Model(self.beam), self.path / "wrong.h5"
        for wrong in (np.zeros((3, 3)), np.full((len(model["/functions/number"]), 3), np.nan)):
            with self.assertRaisesRegex(ValueError, "one row for each entry of /functions"):
                foreign_results.write_results(path, model, {"displacement": wrong}, solver="x", material=(np.eye(6), 0))
        self.assertFalse(path.exists() or path.with_name("wrong.h5.new").exists())

    def test_stresses_of_laws_are_derivatives_of_their_energies(self):
        """sigma = dpsi/dF F^T / J by central differences."""
        gradient, step = 0.2 * np.random.default_rng(1).standard_normal((1, 3, 3)), 1e-6
        F = np.eye(3) + gradient[0]
        for law in ("neo-hookean", "st-venant-kirchhoff"):
            P = np.empty((3, 3))
            for a, b in np.ndindex(3, 3):
                unit = np.zeros((1, 3, 3))
                unit[0, a, b] = step
                P[a, b] = (
                    stored_energy.density(law, 10.0, 0.3, gradient + unit)
                    - stored_energy.density(law, 10.0, 0.3, gradient - unit)
                )[0] / (2 * step)
            sigma = P @ F.T / np.linalg.det(F)
            found = stored_energy.cauchy(law, 10.0, 0.3)(gradient)[0]
            np.testing.assert_allclose(
                found, [sigma[0, 0], sigma[1, 1], sigma[2, 2], sigma[0, 1], sigma[1, 2], sigma[2, 0]], rtol=1e-7
            )

    def test_what_kratos_cannot_do_is_refused_with_its_line(self):
        text = STATIC.format(model=self.beam)
        cases = [
            (('method = "penalty"', 'method = "nitsche"'), 10, "Nitsche"),
            (('fixed = "y"', 'fixed = "pinned"'), 13, "pinned"),
            (('light_functions = "none"', 'light_functions = "linear"'), 2, "igasolve"),
            (("pressure = 0.3", "bearing = [0, 0, 1]"), 30, "bearing"),
            (("rho = 2.0", 'name = "steel"'), 6, "name"),
            (("[[probe]]", "[temperature]\nuniform = 2\n[[probe]]"), 35, "temperature"),
            (("force = [0, 0, 5]", "force = [0, 5]"), 26, "3 numbers"),
            (("value = [0, 0.001, 0]", "value = 1"), 14, "3 numbers"),
            (("[[probe]]", "[[spring]]\n[[probe]]"), 35, "spring"),
        ]
        for (before, after), line, reason in cases:
            with self.subTest(after), self.assertRaisesRegex(RunError, f"line {line}: .*{reason}"):
                run = self.path / "refused.toml"
                run.write_text(text.replace(before, after, 1))
                RunFile(run)
        run.write_text(
            text.replace(
                "point = [0, 0, 0], normal = [1, 0, 0]", "point = [0, 0, 0], normal = [1, 0, 0], tolerance = 1", 1
            )
        )
        with self.assertRaisesRegex(RunError, "line 9: .*cuts triangle"):
            RunFile(run).points("support", 0, Model(self.beam))
        run.write_text(text.replace("rho = 2.0", 'law = "j2"', 1))
        with self.assertRaisesRegex(RunError, "line 6: .*j2"):
            RunFile(run, "nonlinear")

    def test_keys_of_explicit_runs_that_kratos_cannot_follow_are_refused_with_their_line(self):
        text = STEPS.format(model=self.beam, law="neo-hookean")
        run = self.path / "refused.toml"
        for line, before, after, reason in (
            (1, "gravity = [0, -2, 0]", "gravity = 9.81", "3 numbers"),
            (6, 'light_functions = "none"', 'light_functions = "linear"', "igasolve's own"),
            (6, 'light_functions = "none"', 'mass = "two-pass"', "lumped"),
            (8, "neo-hookean", "j2", "st-venant-kirchhoff"),
            (9, "E = 1000.0", "E = 1000.0\nbulk_viscosity = [1.5, 0.06]", "not given this"),
            (16, "factor = [[0, 0], [0.08, 1], [0.12, 0.5]]", "factor = [[0, 0], [0, 1]]", "ascend"),
            (19, "pressure = 2", "pressure = 2\nfollows = true", "not given this"),
            (21, "dt_max = 4e-3", "", "equal steps"),
        ):
            with self.subTest(after), self.assertRaisesRegex(RunError, f"line {line}: .*{reason}|line {line + 1}: .*{reason}"):
                run.write_text(text.replace(before, after, 1))
                open_run(run)
        run.write_text(text.replace("[time]", "[[contacts]]\nself = \"beam\"\n[time]"))
        with self.assertRaisesRegex(RunError, "line 21: contacts"):
            open_run(run)
        run.write_text(text)
        smooth = [open_run(run).factor(0, time) for time in (-1, 0, 0.02, 0.04, 0.08, 0.1, 0.12, 9)]
        np.testing.assert_allclose(smooth, [0, 0, 0.15625, 0.5, 1, 0.75, 0.5, 0.5], atol=1e-15)


if __name__ == "__main__":
    if os.environ.get("IGA_TEST_KRATOS") == "1" and not KRATOS:
        sys.exit(f"kratos_test.py: IGA_TEST_KRATOS is 1, but {PYTHON} is missing; run scripts/setup --kratos")
    parts.run_tests(
        "" if KRATOS else f"Kratos Multiphysics is not installed ({PYTHON} is missing); run scripts/setup --kratos"
    )
