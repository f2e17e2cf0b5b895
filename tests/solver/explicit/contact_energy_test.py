#!/usr/bin/python3
"""A heavy ball crushes a foam block flat, at several speeds and with other foams: it never passes and energy is never made, or
the run ends with a message that says where and what to do.
usage: contact_energy_test.py SOURCE_DIR IGAPREP IGASOLVE"""
import concurrent.futures
import json
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "tests/scripts")]
from igatools import iga_results  # noqa: E402
from parts import write_boxes  # noqa: E402

SIDE, RADIUS, MASS = 60.0, 20.0, 2.0
CURVE = [[0, 2e-4], [0.5, 3e-4], [0.7, 8e-4], [0.8, 3e-3], [0.9, 7e-3], [0.95, 9e-3]]
FOAM = 'law = "crushable-foam"\nE = {E}\nnu = 0.0\nrho = 6e-8\nyield_curve = {curve}\ntension_limit = 3e-4'
SOFT = 'law = "{law}"\nE = 0.002\nnu = 0.2\nrho = 6e-8'

RUN = """
[[bodies]]
name = "foam"
model = "block.h5"
[bodies.material]
{material}
[[rigid_bodies]]
name = "ball"
shape = "sphere"
radius = 20
centre = [30, 30, 80.5]
motion = "free"
mass = 2
inertia = 320
velocity = [0, 0, -{speed}]
[[rigid_bodies]]
name = "floor"
shape = "plane"
normal = [0, 0, 1]
centre = [0, 0, 0]
[[contacts]]
bodies = ["foam", "ball"]
[[contacts]]
bodies = ["foam", "floor"]
[time]
end = {end}
{time}
[output]
viewer = false
field_interval = {end}
{more}
"""


def foam(E=0.05, times=1.0):
    return FOAM.format(E=E, curve=[[x, times * y] for x, y in CURVE])


class ContactEnergy(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        write_boxes(cls.path / "block.stl", [((0, 0, 0), (SIDE, SIDE, SIDE))])
        subprocess.run([IGAPREP, cls.path / "block.stl", "--spans", "5", "--length-unit", "mm", "-o", cls.path / "block.h5",
                        "--quiet"], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def solve(self, name, material, speed, time="", more="", end=None):
        text = RUN.format(material=material, speed=speed, end=end or 120 / speed, time=time, more=more)
        (self.path / f"{name}.toml").write_text(text)
        return subprocess.run([IGASOLVE, "explicit", self.path / f"{name}.toml", "-o", self.path / f"{name}.h5", "--json",
                               "--threads", "1"], capture_output=True, text=True)

    def check(self, name, done, speed):
        """Right, or told."""
        results = iga_results.read(self.path / f"{name}.h5")
        start = MASS * speed**2 / 2
        energy = results.series("energy")
        made = (energy["internal"] + energy["kinetic"] + energy["friction"] + energy["damping"] + energy["eroded"]
                - energy["external"]) / start - 1
        print(f"{name}: exit {done.returncode}, energy made {made.max():.1e}, contact at least "
              f"{energy['contact'].min() / start:.1e} of the start's", flush=True)
        self.assertLess(made.max(), 0.01, name)
        self.assertGreater(energy["contact"].min(), -0.01 * start, name)
        if done.returncode == 0:
            # The ball stopped within the block and goes back, no faster than it came.
            ball = results.series("rigid/ball")
            self.assertGreater(ball["velocity"][-1, 2], 0, name)
            self.assertLess(ball["velocity"][-1, 2], 1.01 * speed, name)
            self.assertGreater(ball["position"][:, 2].min(), RADIUS - SIDE / 5, name)  # a span below the floor at most
        else:
            self.assertEqual(done.returncode, 4, done.stderr)
            self.assertRegex(done.stderr, r"t = \S+: .*near \(.*(use|take|give) ", name)
        return done.returncode

    def run_all(self, cases):
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            jobs = {name: pool.submit(self.solve, name, material, speed, time)
                    for name, (material, speed, time) in cases.items()}
        return {name: self.check(name, job.result(), cases[name][1]) for name, job in jobs.items()}

    def test_a_ball_on_foam_at_four_speeds(self):
        codes = self.run_all({"16": (foam(), 16, ""), "16_short_steps": (foam(), 16, "safety = 0.67"), "20": (foam(), 20, ""),
                              "40": (foam(), 40, ""), "100": (foam(), 100, ""), "400": (foam(), 400, "")})
        # Where 400 J meet foam that takes them the run is right, not only told.
        self.assertEqual([codes["16"], codes["16_short_steps"], codes["20"]], [0, 0, 0])

    def test_other_foams(self):
        self.run_all({"soft": (foam(E=0.01), 20, ""), "stiff_40": (foam(E=0.25), 40, ""), "weak": (foam(times=0.1), 20, ""),
                      "strong_40": (foam(times=10), 40, ""), "weak_100": (foam(times=0.1), 100, ""),
                      "strong_400": (foam(times=10), 400, "")})

    def test_other_laws(self):
        self.run_all({"neo": (SOFT.format(law="neo-hookean"), 20, ""), "neo_100": (SOFT.format(law="neo-hookean"), 100, ""),
                      "st_venant": (SOFT.format(law="st-venant-kirchhoff"), 20, "")})

    def test_trouble_is_told_at_once_at_the_end_and_in_json(self):
        done = self.solve("told", foam(), 20, more="[watch]\ndepth_warning = 0.01\ndepth_limit = 0", end=0.5)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = re.findall(r"warning: t = \S+: contact 'foam-ball': one side lies \S+ deep in the other, \S+ spans, near \(.*",
                           done.stderr)
        self.assertEqual(len(found), 2, done.stderr)  # when it happens, and beside the result with how bad it became
        self.assertIn("at worst", found[1])
        self.assertTrue(any("at worst" in text for text in json.loads(done.stdout)["warnings"]))
        done = self.solve("ended", foam(), 20, more="[watch]\ndepth_limit = 0.01", end=0.5)
        self.assertEqual(done.returncode, 4)
        self.assertRegex(done.stderr, r"more than 0.01 is not allowed; take shorter steps")
        done = self.solve("crushed", foam(), 40, more="[watch]\ninverted_limit = 0.001")
        self.assertEqual(done.returncode, 4)
        self.assertRegex(done.stderr, r"body 'foam': \d+ of 1331 points are crushed below min_volume_ratio, the first in span")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
