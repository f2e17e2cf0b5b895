#!/usr/bin/python3
"""Decks of scripts/export_lsdyna.py against an independent reader of their cards (lsdyna_deck.py): frequencies and mass
of igasolve, contact nodes on the surface, materials, tools, contacts; what is refused. usage: export_lsdyna_test.py
SOURCE_DIR IGAPREP IGASOLVE"""

import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh

SOURCE, IGAPREP, IGASOLVE = Path(sys.argv[1]).resolve(), sys.argv[2], sys.argv[3]
sys.path[:0] = [str(SOURCE / "scripts"), str(Path(__file__).resolve().parent)]
from igatools import iga_model  # noqa: E402
from igatools.lsdyna import cards  # noqa: E402
from igatools.lsdyna.skin import split_long_edges  # noqa: E402
from igatools.lsdyna.writer import Writer  # noqa: E402
from lsdyna_deck import Deck  # noqa: E402
from parts import run_tests, write_boxes  # noqa: E402

ROUNDING = 3e-8  # of contact nodes, whose weights have 9 digits, times distances of up to 4
# Two boxes 0.2 apart in spans of 1: cells of both in the same spans, control points twice.
NEIGHBOURS = [((0.3, 0.2, 0.3), (3.6, 2.3, 2.4)), ((0.3, 0.2, 2.6), (3.6, 2.3, 4.7))]
ELASTIC = 'law = "linear-elastic"\nE = 2.6\nnu = 0.3\nrho = 0.5'


def run_text(model, material=ELASTIC, more="", body="", top=""):
    return (
        f'{top}\n[[bodies]]\nname = "part"\nmodel ='
        f' "{model}"\n{body}\n[bodies.material]\n{material}\n{more}\n[time]\nend = 2\n'
    )


class ExportLsDyna(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = Path(folder.name)
        write_boxes(cls.path / "two.stl", NEIGHBOURS)
        write_boxes(cls.path / "one.stl", [((0.3, 0.2, 0.3), (3.6, 2.3, 2.4))])
        cls.two = cls.model("two", "two.stl", "--degree", 2)
        cls.one = cls.model("one", "one.stl", "--degree", 1, "--region-angle", 30)

    @classmethod
    def model(cls, name, stl, *words):
        path = cls.path / f"{name}.h5"
        subprocess.run(
            [
                IGAPREP,
                cls.path / stl,
                "-o",
                path,
                "--quiet",
                "--force",
                "--span-size",
                "1",
                "--gap-ends",
                "glued",
                "--quadrature",
                "ggq-reduced",
                *map(str, words),
            ],
            check=True,
            capture_output=True,
        )
        return path

    def export(self, text, *words, code=0):
        """The deck of a run file; what the command said where an exit code is expected."""
        (self.path / "run.toml").write_text(text)
        done = subprocess.run(
            [
                SOURCE / "scripts" / "export_lsdyna.py",
                *words,
                self.path / "run.toml",
                "-o",
                self.path / "deck.k",
                "--force",
            ],
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, code, done.stderr)
        self.said = done.stdout + done.stderr
        return Deck(self.path / "deck.k") if code == 0 else self.said

    def frequencies(self, model, remedy, modes=8):
        done = subprocess.run(
            [
                IGASOLVE,
                "eigen",
                model,
                "--E",
                "2.6",
                "--nu",
                "0.3",
                "--rho",
                "0.5",
                "--mass",
                "lumped",
                "--light-functions",
                remedy,
                "--modes",
                str(modes),
                "--json",
            ],
            check=True,
            capture_output=True,
            text=True,
        )
        return json.loads(done.stdout)

    def check_frequencies(self, model, remedy):
        """K and M of the deck and of igasolve have the same elastic frequencies to the deck's digits."""
        deck = self.export(run_text(model, body=f'light_functions = "{remedy}"'))
        _, K, mass = deck.system()
        report = self.frequencies(model, remedy)
        expected, rigid = np.array(report["frequencies"]), report["rigid_modes"]
        D = sparse.diags(1 / np.sqrt(np.repeat(mass, 3)))
        values = eigsh(
            (D @ K @ D).tocsc(), len(expected), sigma=-1e-2, which="LM", return_eigenvectors=False, tol=1e-13
        )
        found = np.sort(np.sqrt(np.maximum(values, 0)) / (2 * np.pi))
        np.testing.assert_allclose(found[rigid:], expected[rigid:], rtol=1e-9)
        volume = iga_model.read(model)["/quadrature/weights"].sum()
        self.assertAlmostEqual(mass.sum(), 0.5 * volume, delta=1e-11 * volume)
        return deck

    def test_frequencies_and_mass_with_copies(self):
        deck = self.check_frequencies(self.two, "linear")
        positions = np.array([x for x, tc, _ in deck.nodes.values() if tc == 0])
        self.assertLess(len(np.unique(np.round(positions, 6), axis=0)), len(positions))  # nodes at the same place
        self.assertLess(len(deck.forms), len(deck.solids))  # cells alike share a formulation
        self.check_walls_are_apart(deck)

    def check_walls_are_apart(self, deck):
        """No element and no contact node joins the two boxes, although cells of both lie in the same spans."""
        index = {n: k for k, n in enumerate(sorted({n for _, nodes in deck.solids.values() for n in nodes}))}
        pairs = np.array([(index[nodes[0]], index[n]) for _, nodes in deck.solids.values() for n in nodes])
        count, body = sparse.csgraph.connected_components(
            sparse.coo_matrix((np.ones(len(pairs)), pairs.T), (len(index),) * 2), directed=False
        )
        self.assertEqual(count, 2)
        owners = {}
        for number, masters in deck.interpolations.items():
            found = {body[index[m]] for m in masters}
            self.assertEqual(len(found), 1)
            owners.setdefault(found.pop(), set()).add(deck.nodes[number][0][2] > 2.5)
        self.assertEqual(sorted(owners.values(), key=min), [{False}, {True}])

    def test_frequencies_in_a_turned_grid_where_the_part_is_thin(self):
        """No cell has all its functions above the threshold, which falls."""
        self.check_frequencies(
            self.model("turned", "one.stl", "--degree", 3, "--rotate-axis-angle", 1, 2, 3, 25), "linear"
        )
        self.assertIn("threshold", self.said)

    def test_frequencies_without_extension(self):
        deck = self.check_frequencies(self.one, "none")
        self.assertEqual({len(nodes) for _, nodes in deck.solids.values()}, {8})

    def test_contact_nodes_lie_on_the_surface(self):
        """They follow their masters exactly, the triangles are as short as asked for, closed, and regions are parts of
        their own."""
        deck = self.export(
            run_text(
                self.one,
                more='''[[contacts]]
self = "part"
friction = 0.3
[[rigid_bodies]]
name = "ball"
shape = "sphere"
radius = 2.0
centre = [2, 1, 8]
motion = "free"
mass = 3
inertia = [1, 2, 3, 0.1, 0.2, 0.3]
velocity = [0, 0, -4]
guided = "xy"
[[contacts]]
bodies = ["part", "ball"]
damping = 0.05
first_regions = ["FACE"]'''.replace("FACE", iga_model.read(self.one).texts("/surface/regions")[2]),
                body="edge_length = 0.4",
            )
        )
        made, given, sums = deck.contact_nodes()
        np.testing.assert_allclose(made, given, atol=1e-12)
        np.testing.assert_allclose(sums, 1, rtol=0, atol=1e-15)
        low, high = np.array((0.3, 0.2, 0.3)), np.array((3.6, 2.3, 2.4))
        to_faces = np.minimum(abs(made - low), abs(made - high)).min(1)
        self.assertLess(to_faces.max(), ROUNDING)
        self.assertTrue(((made > low - ROUNDING) & (made < high + ROUNDING)).all())
        selected = [deck.sets[cards[1][0]] for cards in deck.cards["CONTACT_AUTOMATIC_SINGLE_SURFACE_ID"]][0]
        self.assertEqual(len(selected), 6)
        corners = np.concatenate([deck.shell_triangles(part)[:, :3] for part in selected])
        self.assertLess(np.linalg.norm(corners - np.roll(corners, 1, 1), axis=2).max(), 0.4 * (1 + 1e-6))
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
        a, b, c = high - low
        self.assertAlmostEqual(areas.sum(), 2 * (a * b + b * c + c * a), delta=1e-6)
        edges = {}
        for part in selected:
            for _, nodes in ((p, n) for p, n in deck.shells.values() if p == part):
                self.assertEqual(nodes[2], nodes[3])
                for k in range(3):
                    key = nodes[k], nodes[(k + 1) % 3]
                    edges[key] = edges.get(key, 0) + 1
        self.assertTrue(all(count == 1 and edges.get((j, i)) == 1 for (i, j), count in edges.items()))
        self.check_ball(deck)

    def check_ball(self, deck):
        pair = deck.cards["CONTACT_AUTOMATIC_SURFACE_TO_SURFACE_ID"][0]
        (face,), (ball,) = deck.sets[pair[1][0]], deck.sets[pair[1][1]]
        self.assertEqual(pair[2][:5], [0, 0, 0, 0, 5])
        part = deck.parts[ball]
        self.assertEqual(part.cards[2][:4], [2, 1, 8, 3])
        self.assertEqual(part.cards[3], [1, 0.1, 0.3, 2, 0.2, 3])  # xx xy xz yy yz zz
        self.assertEqual(part.cards[4], [0, 0, -4, 0, 0, 0])
        self.assertEqual(deck.materials[part.material][1][1], [1, 4, 0])  # CMO, no way along x and y, free to turn
        thickness = pair[3][2]
        radius = np.linalg.norm(deck.shell_triangles(ball) - [2, 1, 8], axis=2)
        np.testing.assert_allclose(radius, 2 - thickness, atol=1e-8)  # contact at half a thickness of either side
        section = deck.sections[deck.parts[face].section][1]
        self.assertEqual(section[1][:4], [thickness] * 4)

    def test_foam_and_start(self):
        deck = self.export(
            run_text(
                self.one,
                '''law = "crushable-foam"
E = 0.05
nu = 0
rho = 6e-8
yield_curve = [[0, 3e-4], [0.9, 5e-3]]
tension_limit = 2e-4
damping = 0.1''',
                body=(
                    "velocity = [0, 0, -8]\nspin = [0, 1, 0]\nspin_centre = [0, 0, 0]\nplace = { shift = [10, 0, 0],"
                    " degrees = 90, axis = [0, 0, 1] }"
                ),
                top="gravity = [0, 0, -9.81e-3]",
            )
        )
        card = deck.materials[1][1][0]
        self.assertEqual(card[1:4] + card[5:], [6e-8, 0.05, 0, 2e-4, 0.1, 0])
        curve = deck.curves[card[4]]
        np.testing.assert_allclose(curve[:2], [[0, 3e-4], [0.9, 5e-3]])
        self.assertAlmostEqual((curve[-1] - curve[-2])[1] / (curve[-1] - curve[-2])[0], 0.05, delta=1e-12)
        for number, v in deck.velocities.items():
            np.testing.assert_allclose(v, [0, 0, -8] + np.cross([0, 1, 0], deck.nodes[number][0]), atol=1e-6)
        x = np.array([deck.nodes[n][0] for n in deck.interpolations])
        np.testing.assert_allclose(
            np.sort([x.min(0), x.max(0)], 0), [[10 - 2.3, 0.3, 0.3], [10 - 0.2, 3.6, 2.4]], atol=1e-8
        )
        self.assertEqual(deck.cards["LOAD_BODY_Z"][0][0][1], 9.81e-3)  # a frame that rises: bodies feel gravity
        _, _, mass = deck.system()
        self.assertAlmostEqual(mass.sum() / 6e-8, 3.3 * 2.1 * 2.1, delta=1e-9)

    def test_loads(self):
        """Nodal forces have the resultants and moments of the loads, in a placed body too."""
        name = iga_model.read(self.one).texts("/surface/regions")[0]
        loads = f'''[[loads]]
pressure = 0.2
region = "{name}"
factor = [[0, 0], [1, 1]]
[[loads]]
force = [1, 2, 3]
whole_surface = true
[[loads]]
acceleration = [0, 0, -2]'''
        place = "place = { shift = [10, 0, 0], degrees = 90, axis = [0, 0, 1] }"
        deck = self.export(run_text(self.one, more=loads, body=place))
        title = cards.heading(f"part: surface; region {name}")
        part = next(number for number, part in deck.parts.items() if part.cards[0][0] == title)
        corners = deck.shell_triangles(part)[:, :3]
        twice = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        force = -0.2 * twice.sum(0) / 2
        moment = -0.2 * np.cross(corners.mean(1), twice / 2).sum(0)
        np.testing.assert_allclose(deck.resultant(1), [force, moment], atol=1e-5)
        np.testing.assert_allclose(deck.curves[1][:2], [[0, 0], [1, 1]])
        centre = np.array([10 - 1.25, 1.95, 1.35])
        np.testing.assert_allclose(deck.resultant(2), [[1, 2, 3], np.cross(centre, [1, 2, 3])], atol=1e-5)
        weight = np.array([0, 0, -2 * 0.5 * 3.3 * 2.1 * 2.1])
        np.testing.assert_allclose(deck.resultant(3), [weight, np.cross(centre, weight)], atol=1e-5)

    def test_metal_and_a_press(self):
        deck = self.export(
            run_text(
                self.one,
                'law = "j2"\nE = 117\nnu = 0.35\nrho = 8.93e-6\nyield_stress = 0.4\n'
                'hardening_modulus = 0.1\nrate_law = "cowper-symonds"\nrate_reference = 40\nrate_exponent = 5',
                more='''[[rigid_bodies]]
name = "press"
shape = "plane"
normal = [0, 0, -1]
centre = [0, 0, 2.4]
[rigid_bodies.drive]
kind = "velocity"
z = [[0, 0], [1, -2]]
smooth = true
[[rigid_bodies]]
name = "pin"
shape = "cylinder"
radius = 1
axis = [0, 1, 0]
height = 3
centre = [0, 0, -2]
[[rigid_bodies]]
name = "block"
shape = "box"
size = [1, 2, 3]
centre = [9, 0, 0]
[[contacts]]
bodies = ["press", "part"]''',
            )
        )
        metal = deck.materials[1][1]
        self.assertEqual(metal[0][1:5], [8.93e-6, 117, 0.35, 0.4])
        # LS-DYNA's tangent from ours over the plastic strain
        self.assertAlmostEqual(metal[0][5], 117 * 0.1 / 117.1, delta=1e-7)
        self.assertEqual(metal[1][:2] + metal[1][4:], [40, 5, 1])
        motion = deck.cards["BOUNDARY_PRESCRIBED_MOTION_RIGID"][0][0]
        self.assertEqual(motion[1:3], [3, 0])  # along z, a velocity
        drive = deck.curves[motion[3]]
        np.testing.assert_allclose(np.interp([0.25, 0.5, 1, 4], *drive.T), [-0.3125, -1, -2, -2], atol=1e-6)
        tools = {part.cards[0][0]: number for number, part in deck.parts.items() if "rigid" in part.cards[0][0]}
        thickness = deck.sections[deck.parts[tools["rigid body press"]].section][1][1][0]
        np.testing.assert_allclose(deck.shell_triangles(tools["rigid body press"])[..., 2], 2.4 + thickness, atol=1e-7)
        pin = deck.shell_triangles(tools["rigid body pin"]).reshape(-1, 3) - [0, 0, -2]
        self.assertAlmostEqual(np.hypot(pin[:, 0], pin[:, 2]).max(), 1 - thickness, delta=1e-7)
        self.assertAlmostEqual(abs(pin[:, 1]).max(), 1.5 - thickness, delta=1e-7)
        block = deck.shell_triangles(tools["rigid body block"]).reshape(-1, 3) - [9, 0, 0]
        np.testing.assert_allclose(block.max(0), np.array([1, 2, 3]) / 2 - thickness, atol=1e-7)

    def test_what_is_left_out_is_said_and_what_cannot_be_held_is_refused(self):
        deck = self.export(run_text(self.one, more="[watch]\ndepth_limit = 1"))
        self.assertTrue(any(remark.startswith("left out: watch") for remark in deck.remarks))
        self.assertTrue(any("LS-DYNA itself has not run" in remark for remark in deck.remarks))
        base = run_text(self.one)
        for text, expected in [
            (base.replace('"linear-elastic"', '"neo-hookean"'), "law 'neo-hookean'"),
            (base.replace("rho = 0.5", "rho = 0.5\nC = [1]"), "material key 'C'"),
            (base + "[[loads]]\npressure = 1", "expected region or whole_surface"),
            (base + "[[loads]]\nbearing = [1, 0, 0]", "[loads] bearing"),
            (base + "[[supports]]\nfixed = 'x'", "supports"),
            (run_text(self.one, body='mass = "two-pass"'), "two-pass"),
            (run_text(self.one, body="damping = 1"), "damping"),
            (run_text(self.one, body='light_functions = "degree-p"'), "degree-p"),
            (run_text(self.one, more='[[contacts]]\nbodies = ["part", "nothing"]'), "nothing"),
            (run_text(self.one, more='[[rigid_bodies]]\nname = "x"\nshape = "cone"'), "cone"),
            ("model = 'part.h5'\nmaterial = 'steel'", "not a run file of igasolve explicit"),
            ("[[bodies", "refused.toml"),
        ]:
            with self.subTest(expected):
                (self.path / "refused.toml").write_text(text)
                with self.assertRaises(cards.DeckError) as caught:
                    Writer(self.path / "refused.toml")
                self.assertIn(expected, str(caught.exception))
        self.assertIn("no such file", self.export(run_text("nothing.h5"), code=2))
        self.assertIn("README.md", self.export(run_text(SOURCE / "README.md"), code=3))

    def test_a_model_with_functions_that_follow_others_is_refused(self):
        """Where a slot ends, igaprep makes /unknowns unless it is asked for glued ends."""
        write_boxes(
            self.path / "slot.stl", [((0, 0, 0), (6, 2, 1.45)), ((0, 0, 1.55), (6, 2, 3)), ((6, 0, 0), (8, 2, 3))]
        )
        path = self.path / "slot.h5"
        subprocess.run(
            [IGAPREP, self.path / "slot.stl", "-o", path, "--quiet", "--repair", "--span-size", "1"],
            check=True,
            capture_output=True,
        )
        self.assertIn("--gap-ends glued", self.export(run_text(path), code=2))

    def test_numbers_in_fields(self):
        rng = np.random.default_rng(3)
        for value in [*(rng.standard_normal(300) * 10.0 ** rng.integers(-30, 30, 300)), 0.0, -0.5, 1 / 3, 0.05, 1e21]:
            for width, digits in ((10, 2), (16, 8), (20, 12)):
                text = cards.shortest(float(value), width)
                self.assertLessEqual(len(text), width)
                self.assertAlmostEqual(float(text), value, delta=abs(value) * 10.0**-digits)
        for _ in range(200):
            w = rng.standard_normal(27) * rng.choice([0.01, 0.3, 3])
            w[0] += 1 - w.sum()
            units = cards.rounded_weights(w)
            self.assertEqual(units.sum(), 10**9)
            lines = cards.pair_lines(range(1, 28), units)
            found = np.array([float(line[k : k + 10]) for line in lines for k in range(10, len(line), 20)])
            np.testing.assert_allclose(found, w, atol=2e-6)
            np.testing.assert_array_equal(np.rint(found * 1e9), units)

    def test_edges_are_halved_in_neighbours_alike(self):
        x = np.array([(0, 0, 0), (4, 0, 0), (0, 1, 0), (0, 0, 1)], float)
        x, triangles, region, origin = split_long_edges(
            x, np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]), np.arange(4), 0.7
        )
        np.testing.assert_array_equal(region, origin)
        edges = np.sort(np.stack([triangles, np.roll(triangles, -1, 1)], 2), 2).reshape(-1, 2)
        self.assertTrue((np.unique(edges, axis=0, return_counts=True)[1] == 2).all())
        self.assertLessEqual(np.linalg.norm(x[edges[:, 0]] - x[edges[:, 1]], axis=1).max(), 0.7)
        six = np.einsum("ij,ij->i", x[triangles[:, 0]], np.cross(x[triangles[:, 1]], x[triangles[:, 2]]))
        self.assertAlmostEqual(six.sum(), 4, delta=1e-12)


if __name__ == "__main__":
    run_tests("")
