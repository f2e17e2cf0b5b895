#!/usr/bin/python3
"""The verification book's own parts: exact solutions against published digits, surfaces, finite elements' forces, tables, exit codes.
usage: book_test.py SOURCE_DIR"""
import subprocess
import sys
import tempfile
import tomllib
import unittest
from collections import Counter
from pathlib import Path

import numpy as np

SOURCE = Path(sys.argv[1])
sys.path[:0] = [str(SOURCE / "tests/verification"), str(SOURCE / "scripts")]
from book import exact, fem, page, parts  # noqa: E402
from book.case import BookError, Case  # noqa: E402
from book.main import Found, Outcome  # noqa: E402
from book.mixed import Body  # noqa: E402
from book.run import run_file  # noqa: E402

STEEL = {"E": 200e9, "nu": 0.3, "rho": 8000.0}


class ExactSolutions(unittest.TestCase):
    def test_radial_modes_are_those_of_nafems_fv42(self):
        np.testing.assert_allclose(exact.hollow_sphere_radial(1.8, 6, **STEEL, count=5), [369.91, 838.03, 1451.2, 2117.0, 2795.8], rtol=1e-4)

    def test_solid_sphere(self):  # Lamb 1882; at ν = 1/4 the first spheroidal mode is 2.6399
        self.assertAlmostEqual(exact.sphere_torsional(2, 1)[0], 2.501133, 6)
        self.assertAlmostEqual(exact.sphere_torsional(1, 1)[0], 5.763459, 6)
        self.assertAlmostEqual(exact.sphere_spheroidal(2, 0.25, 1)[0], 2.639869, 6)
        # The breathing mode of a solid sphere at ν = 1/4: ω a / c_p = 2.563 (tan x = x / (1 - 3 x² / 4)).
        cp, _ = exact.wave_speeds(1.0, 0.25, 1.0)
        x = 2 * np.pi * exact.hollow_sphere_radial(0, 1, 1.0, 0.25, 1.0, 1)[0] / cp
        self.assertAlmostEqual(np.tan(x), x / (1 - 0.75 * x * x), 8)

    def test_waves_of_a_thin_plate_are_those_of_plate_theory(self):
        cp, cs = exact.wave_speeds(**STEEL)
        thickness, k = 1e-2, 1.0
        bending = k**2 * np.sqrt(STEEL["E"] * thickness**2 / (12 * (1 - 0.3**2) * STEEL["rho"]))
        stretching = k * np.sqrt(STEEL["E"] / (1 - 0.3**2) / STEEL["rho"])
        self.assertAlmostEqual(exact.lamb(k, thickness, cp, cs, True) / bending, 1, 4)
        self.assertAlmostEqual(exact.lamb(k, thickness, cp, cs, False) / stretching, 1, 4)

    def test_square_plates(self):  # Leissa 1973, and later series for the cantilever
        scale = 2 * np.pi / np.sqrt(1 / (12 * (1 - 0.09)))
        np.testing.assert_allclose(scale * exact.square_plate(1, 1, 1, 0.3, 1, False, 3), [13.468, 19.596, 24.270], rtol=5e-5)
        np.testing.assert_allclose(scale * exact.square_plate(1, 1, 1, 0.3, 1, True, 3), [3.4710, 8.5066, 21.284], rtol=1e-4)

    def test_torsion_constants(self):
        self.assertAlmostEqual(exact.torsion_constant(1, 1), 0.1406, 4)
        self.assertAlmostEqual(exact.torsion_constant(2, 1), 2 * 0.2287, 4)
        self.assertAlmostEqual(exact.torsion_constant(1, 1e-3) / (1e-9 / 3), 1, 2)



class MixedElements(unittest.TestCase):
    def test_uniform_rubber(self):
        """A cylinder between smooth plates at half its height: σ of the law, which is solved for along with the stretch across."""
        mu, lam, along = 1.0, 5000.0, 0.5
        across = np.sqrt(1 / along)
        for _ in range(20):  # μ b + (λ ln J - μ) / b = 0
            log = np.log(across**2 * along)
            across -= (mu * across**2 + lam * log - mu) / (2 * mu * across + 2 * lam / across)
        nominal = mu * along + (lam * np.log(across**2 * along) - mu) / along
        body = Body(lambda x: 2 * x + 0.2 * np.column_stack([x[:, 0] * (1 - x[:, 0]), 0 * x[:, 1]]), (3, 2), mu, lam, axisymmetric=True)
        axis, low, top = body.unit[:, 0] == 0, body.unit[:, 1] == 0, body.unit[:, 1] == 1
        for share in (0.25, 0.5):
            force = body.solve([(axis, 0, 0), (low, 1, 0), (top, 1, -2 * share)])[top, 1].sum()
        self.assertAlmostEqual(force / (nominal * np.pi * 4), 1, 8)
        self.assertAlmostEqual(body.u.reshape(-1, 2)[body.unit[:, 0] == 1, 0].min() / (2 * (across - 1)), 1, 8)


class Surfaces(unittest.TestCase):
    def test_closed_outwards_and_of_their_volume(self):
        angle = 0.3
        shapes = {"box": (parts.box((0, 0, 0), (1, 2, 3)), 6), "ball": (parts.ball(2.0, 12), 4 / 3 * np.pi * 8),
                  "wedge": (parts.wedge(1, 2, 3, angle, 64), angle / 2 * 3 * 3), "sector": (parts.wedge(0, 2, 3, angle, 64), angle / 2 * 4 * 3),
                  "octant": (parts.octant(1, 2, 24), np.pi / 6 * 7), "cylinder": (parts.cylinder(1, 2, 24), 2 * np.pi),
                  "pyramid": (parts.pyramid(1, 2, angle, 24), np.arcsin(np.sin(np.arctan(np.tan(angle))) ** 2) * 7 / 3)}
        for name, (triangles, volume) in shapes.items():
            edges = Counter((tuple(a), tuple(b)) for t in triangles for a, b in zip(t, np.roll(t, -1, 0)))
            self.assertTrue(all(count == 1 and edges[b, a] == 1 for (a, b), count in list(edges.items())), f"{name} is open")
            self.assertAlmostEqual(parts.volume(triangles) / volume, 1, 2 if name in ("octant", "pyramid") else 4, name)


class FiniteElements(unittest.TestCase):
    def test_forces_have_the_resultant_of_their_traction(self):
        mesh = fem.bricks(parts.wedge_mapping(1, 2, 3, np.pi / 2), (2, 6, 2))
        bore = lambda x: np.abs(np.hypot(x[:, 0], x[:, 1]) - 1) < 1e-9  # noqa: E731
        total = mesh.forces(bore, lambda x, n: -n).sum(0)  # a pressure of 1 outwards: what it presses on, 1 by 3, along x and y
        np.testing.assert_allclose(total, [3, 3, 0], atol=1e-3)
        self.assertEqual(len(mesh.boundary), 2 * (2 * 6 + 6 * 2 + 2 * 2))
        triangles = fem.triangle_rule()
        self.assertAlmostEqual(sum(w * x**2 * y**2 for (x, y), w in zip(*triangles)), 1 / 180, 15)  # degree 4
        for at in ((0.3, -0.7), (0.1, 0.2)):
            for shapes in (fem.quad_shapes, fem.triangle_shapes):
                values, slopes = shapes(at)
                self.assertAlmostEqual(values.sum(), 1, 14)
                for d in range(2):
                    ahead, behind = (shapes(tuple(np.array(at) + s * np.eye(2)[d]))[0] for s in (1e-6, -1e-6))
                    np.testing.assert_allclose(slopes[d], (ahead - behind) / 2e-6, atol=1e-8)


def made(values, exact_value=1.0, tolerance=0.01, calculix=None):
    case = Case(id="x", title="t", function=None, geometry="g", material="m", source="s", exact=exact_value, unit="mm", grids=(4.0, 2.0, 1.0),
                tolerance=tolerance, topic="topic")
    outcome = Outcome(case)
    outcome.grids = [Found(case.checked(value), 100 * 8**k, 1.0) for k, value in enumerate(values)]
    outcome.calculix = None if calculix is None else Found(case.checked(calculix), 900, 1.0)
    return outcome


class Tables(unittest.TestCase):
    def test_order_claim_and_ratio(self):
        outcome = made([1.64, 1.08, 1.005], calculix=0.96)
        self.assertAlmostEqual(outcome.order(""), 4, 10)
        self.assertEqual(outcome.missed(), [])
        self.assertAlmostEqual(outcome.beside_calculix(""), 2, 10)  # 0.08 at 800 unknowns over 0.04 at 900
        self.assertEqual(page.verdicts([outcome])[:2], (0, 0))
        self.assertIn("error 2 %, claimed 1 %", made([1.64, 1.08, 0.98]).missed()[0])
        self.assertTrue(made([1, 1, float("nan")]).missed())  # no number is no success

    def test_other_quantities_than_announced_are_refused(self):
        with self.assertRaises(BookError):
            made([{"a": 1}, {"a": 1}, {"a": 1}])

    def test_readme_keeps_topics_that_did_not_run(self):
        with tempfile.TemporaryDirectory() as folder:
            readme = Path(folder) / "README.md"
            readme.write_text("before\n" + "\n".join(page.TABLES) + "\nafter\n")
            outcome, broken = made([1.64, 1.08, 1.005]), made([1.64, 1.08, 1.005])
            topics = {"topic": ("Heading", [outcome.case])}
            self.assertEqual(page.write_readme(topics, [outcome], readme), [])
            first = readme.read_text()
            self.assertIn("### Heading", first)
            self.assertTrue(first.startswith("before\n") and first.endswith("after\n"))
            broken.faults.append("could not be run")
            self.assertEqual(len(page.write_readme(topics, [broken], readme)), 1)
            self.assertEqual(readme.read_text(), first)
            self.assertIn("1 of 1 cases hold", page.html(topics, [outcome], 1.0))

    def test_run_files_are_toml(self):
        keys = {"model": "a\\b\".h5", "material": {"E": 1e-300, "C": np.eye(2)}, "support": [{"name": "ü", "at": [1, 2.5, 0], "on": True}],
                "load": []}
        found = tomllib.loads(run_file(**keys))
        self.assertEqual(found, {"model": keys["model"], "material": {"E": 1e-300, "C": [[1, 0], [0, 1]]},
                                 "support": [{"name": "ü", "at": [1, 2.5, 0], "on": True}]})


class CommandLine(unittest.TestCase):
    def command(self, *words):
        return subprocess.run([SOURCE / "scripts/verify", *words], capture_output=True, text=True)

    def test_exit_codes_of_wrong_use(self):
        unknown = self.command("no_such_case")
        self.assertEqual(unknown.returncode, 2)
        self.assertIn("no case or topic is named 'no_such_case'", unknown.stderr)
        missing = self.command("--bin", "/nowhere", "--calculix", "without")
        self.assertEqual(missing.returncode, 2)
        self.assertIn("igaprep is missing", missing.stderr)
        self.assertEqual(self.command("--write", "--quick").returncode, 2)
        self.assertEqual(self.command("--list").returncode, 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
