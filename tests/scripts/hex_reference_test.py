#!/usr/bin/python3
"""The finite element program beside the impact sample, held against what is known in closed form.
usage: hex_reference_test.py SOURCE_DIR"""
import sys
import unittest
from pathlib import Path

import numpy as np

SOURCE = Path(sys.argv[1])
sys.path.insert(0, str(SOURCE / "scripts" / "studies"))
import compare_impact  # noqa: E402
import hex_reference as hexes  # noqa: E402

ELASTIC = [(0, 1e9), (1, 1e9)]


def turn(axis, angle):
    a = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


class TensorTest(unittest.TestCase):
    def test_clips_principal_values_and_keeps_directions(self):
        random = np.random.default_rng(5)
        s = random.normal(size=(200, 3, 3))
        s += np.swapaxes(s, 1, 2)
        q = np.linalg.qr(s[0])[0]
        s[:3] = [q @ np.diag(d) @ q.T for d in ((2, 2, -3), (-2, -2, -2), (0.1, 0.1 + 1e-9, 2))]
        low, high = -random.uniform(0.1, 1, 200), 0.8
        value, vector = np.linalg.eigh(s)
        expected = np.einsum("nik,nk,njk->nij", vector, np.clip(value, low[:, None], high), vector)
        found = hexes.clip_principal(np.moveaxis(s, 0, 2), low, high)
        np.testing.assert_allclose(np.moveaxis(found, 2, 0), expected, atol=2e-7)

    def test_inverse(self):
        a = np.random.default_rng(2).normal(size=(3, 3, 50))
        one = np.repeat(np.eye(3)[:, :, None], 50, 2)
        np.testing.assert_allclose(hexes.product(a, hexes.inverse(a)), one, atol=1e-10)
        np.testing.assert_allclose(hexes.determinant(a), np.linalg.det(np.moveaxis(a, 2, 0)), atol=1e-12)


class ElementTest(unittest.TestCase):
    def crushed(self, rate, one_point, depth=0.7, steps=350):
        """One element of edge 2 pressed along z, with the force on its upper face at every step."""
        block = hexes.Block([2, 2, 2], [1, 1, 1], hexes.Foam(rate=rate), one_point)
        upper, moved = block.start[:, 2] > 1, np.zeros_like(block.start)
        moved[upper, 2] = -2 * depth / steps
        force = []
        for _ in range(steps):
            block.position = block.position + moved
            force.append(block.forces(moved)[upper].sum(0))
        return block, upper, moved, np.array(force)

    def test_uniaxial_crush_follows_the_curve(self):
        strain = np.arange(1, 351) / 500
        stress = -np.minimum(hexes.Foam().yield_stress(strain), -0.05 * np.log(1 - strain))
        for rate in ("jaumann", "polar"):
            for one_point in (False, True):
                force = self.crushed(rate, one_point)[3]
                np.testing.assert_allclose(force[4:, 2] / 4, stress[4:], rtol=1e-12)
                np.testing.assert_allclose(force[:, :2], 0, atol=1e-12)

    def test_unloads_elastically_to_the_tension_limit(self):
        block, upper, moved, force = self.crushed("jaumann", False)
        back = np.array([block.forces(-moved / 10)[upper, 2].sum() for _ in range(60)])
        length = 0.3 + np.arange(61) * 0.0002
        elastic = force[-1, 2] / 4 + 0.05 * np.log(length[1:] / 0.3)
        np.testing.assert_allclose(back / 4, np.minimum(elastic, 3e-4), atol=1e-9)
        self.assertAlmostEqual(back[-1] / 4, 3e-4, delta=1e-15)

    def test_simple_shear_tells_the_rates_apart(self):
        """Dienes 1979: tau / mu = sin(g) with Jaumann's rate; with R of F = R U another, tan(beta) = g / 2. The increments of
        Hughes and Winget are not turned by half a step: what is left is of first order, (1 - cos g) / 2 of a step here."""
        shear, steps = 3.0, 600
        beta = np.arctan(shear / 2)
        green = 2 * np.cos(2 * beta) * (2 * beta - 2 * np.tan(2 * beta) * np.log(np.cos(beta)) - np.tan(beta))
        for rate, expected in (("jaumann", np.sin(shear)), ("polar", green)):
            law = hexes.Foam(curve=ELASTIC, tension=1e9, rate=rate)
            f, kept, change = np.eye(3)[:, :, None].copy(), np.zeros((3, 3, 1)), np.zeros((3, 3, 1))
            change[0, 1] = shear / steps
            for _ in range(steps):
                kept, stress = law.update(kept, f, change, np.ones(1))
                f = f + change
            self.assertAlmostEqual(stress[0, 1, 0] / law.shear, expected, delta=1.05 * shear / steps)

    def test_forces_turn_with_a_crushed_element(self):
        for rate in ("jaumann", "polar"):
            block, _, moved, force = self.crushed(rate, False, depth=0.3, steps=20)
            before, shape = block.forces(np.zeros_like(moved)), block.position
            for k in range(1, 41):
                place = shape @ turn((1, 2, 3), 0.05 * k).T
                after = block.forces(place - block.position)
                block.position = place
            np.testing.assert_allclose(after, before @ turn((1, 2, 3), 2.0).T, atol=1e-9 * abs(before).max())


class RunTest(unittest.TestCase):
    def test_elastic_block_bounces(self):
        law = hexes.Foam(curve=ELASTIC, tension=1e9)
        block = hexes.Block([10, 10, 40], [2, 2, 8], law)
        block.velocity[:] = 0, 0, -2
        floor = hexes.Contact(block, hexes.Rigid((0, 0, 0)), 0.2, 0.05 / 5)
        series = hexes.simulate(block, [floor], 0.2, safety=0.2)
        total = series["internal"] + series["kinetic"] + series["contact"] + series["friction"]
        self.assertLess(abs(total / total[0] - 1).max(), 1e-3)
        momentum = block.mass @ block.velocity
        mass = block.mass.sum()
        self.assertAlmostEqual(momentum[2] + 2 * mass, -series["impulse"][-1], delta=1e-12)
        self.assertLess(abs(momentum[2] / mass / 2 - 1), 0.02)  # all of it leaves upwards
        self.assertEqual(series["force"][-1], 0)

    def test_impact_balances_and_a_quarter_is_the_whole(self):
        whole, quarter = (hexes.impact(4, end=1.0, quarter=quarter) for quarter in (False, True))
        for name in hexes.SERIES:
            np.testing.assert_allclose(quarter[name], whole[name], rtol=1e-7, atol=1e-7)
        total = sum(whole[name] for name in ("internal", "kinetic", "contact", "friction"))
        self.assertLess(abs(total / total[0] - 1).max(), 1e-3)
        self.assertGreaterEqual(np.diff(whole["friction"]).min(), 0)
        self.assertAlmostEqual(whole["impulse"][-1], whole["velocity"][-1] + 8, delta=1e-9)
        self.assertGreater(compare_impact.figures(whole)["early"], 0.1)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
