#!/usr/bin/python3
"""igasolve explicit as a user runs it: series, restart bit for bit, threads, kill -9, runs that fail.
usage: explicit_run_test.py SOURCE_DIR WRITE_SYNTHETIC_MODEL IGASOLVE"""
import json
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

import h5py
import numpy as np

SOURCE, WRITE_MODEL, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "tests/scripts")]
import explicit_runs  # noqa: E402
from igatools import iga_results  # noqa: E402

# The box 3.5 × 2 × 1.6 of the synthetic model, hit by a sphere from above, on a plate; friction, gravity, damping.
RUN = """
gravity = [0, 0, -0.01]
[[bodies]]
name = "block"
model = "box.h5"
damping = 0.01
spin = [0, 0, 0.02]
material = {{ law = "{law}", E = 1, nu = 0.2, rho = 1{material} }}
[[rigid_bodies]]
name = "ball"
shape = "sphere"
radius = 1
centre = [3.2, 2.4, 3.65]
motion = "free"
mass = 3
inertia = 1.2
velocity = [0.02, 0, -0.15]
[[rigid_bodies]]
name = "plate"
shape = "box"
size = [8, 8, 1]
centre = [3, 2.5, 0.5]
[rigid_bodies.drive]
kind = "velocity"
z = [[0, 0], [5, 0.01]]
[[contacts]]
name = "hit"
bodies = ["ball", "block"]
friction = 0.3
[[contacts]]
bodies = ["block", "plate"]
friction = 0.2
friction_dynamic = 0.1
friction_decay = 2
[[loads]]
name = "push"
pressure = 0.002
plane = {{ point = [1.25, 2, 2], normal = [1, 0, 0] }}
factor = [[0, 0], [2, 1]]
follows = true
[[supports]]
name = "foot"
plane = {{ point = [3, 3, 1], normal = [0, 0, 1] }}
fixed = "x"
[time]
end = {end}
dt_max = {dt_max}
{time}
[output]
interval = 0.2
field_interval = 2
subdivide = 1
{output}
"""


def run_text(law="crushable-foam", material=", yield_curve = [[0, 0.02], [0.5, 0.05]]", end=10, dt_max=0.05, time="", output="", more=""):
    return RUN.format(law=law, material=material, end=end, dt_max=dt_max, time=time, output=output) + more


def pressed_text(**changes):
    """Without contact, whose springs limit the step first, and pressed hard: the step of the block itself falls."""
    text = run_text(**changes).replace("pressure = 0.002", "pressure = 0.5")
    return text[:text.index("[[contacts]]")] + text[text.index("[[loads]]"):]


class ExplicitRunTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        subprocess.run([WRITE_MODEL, "box", cls.path / "box.h5"], check=True, stdout=subprocess.DEVNULL)
        (cls.path / "run.toml").write_text(run_text())
        # Long enough to be caught at work: some seconds.
        (cls.path / "long.toml").write_text(run_text(end=40, dt_max=0.008, output="restart_interval = 1"))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def command(self, run, out, *more):
        return [IGASOLVE, "explicit", self.path / run, "-o", self.path / out, *more]

    def solve(self, run, out, *more, code=0):
        done = subprocess.run(self.command(run, out, *more), capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def start(self, run, out, *more):
        return explicit_runs.start(self.command(run, out, *more))

    def series(self, out):
        return {name: value.tobytes() for name, value in explicit_runs.series(self.path / out).items()}

    def fields(self, out):
        results = iga_results.read(self.path / out)
        return [{name: value.tobytes() for name, value in results.fields(step).data.items()}
                for step in range(results.num_fields())]

    def test_series_and_fields(self):
        done = self.solve("run.toml", "out.h5", "--json", "--force")
        report = json.loads(done.stdout)
        self.assertLess(report["energy_error"], 0.02)
        step = report["time_step"]
        self.assertEqual(step["by"], step["bounds"][0]["by"])
        self.assertEqual([bound["dt"] for bound in step["bounds"]], sorted(bound["dt"] for bound in step["bounds"]))
        self.assertEqual({bound["by"] for bound in step["bounds"]}, {"material of body 'block'", "contact of body 'block'", "dt_max in [time]"})
        self.assertEqual(len(step["twice_the_step_needs"]), sum(bound["dt"] < 2 * step["dt"] for bound in step["bounds"]))
        self.assertTrue(any("rotational inertia that is off by +" in warning for warning in report["warnings"]), report["warnings"])
        self.assertLess(report["momentum_error"], 1e-9)
        results = iga_results.read(self.path / "out.h5")
        times = results["/time_series/time"]
        self.assertEqual((times[0], times[-1]), (0, 10))
        self.assertEqual(len(times), report["outputs"])
        # No row is later than its interval by more than a step.
        late = times[1:-1] - 0.2 * np.floor(times[1:-1] / 0.2 + 1e-9)
        self.assertTrue((late <= 1.001 * results["/time_series/dt"].max()).all())
        hit, ball = results.series("contact/hit"), results.series("rigid/ball")
        # The ball is the first-named side: pushed up, and the only thing besides gravity that changes its momentum.
        self.assertGreater(hit["force"][:, 2].max(), 0)
        gained = 3 * (ball["velocity"][-1] - [0.02, 0, -0.15])
        expected = hit["impulse"][-1] + 3 * np.array([0, 0, -0.01]) * (10 + results["/time_series/dt"][-1] / 2)
        np.testing.assert_allclose(gained, expected, atol=1e-9)
        np.testing.assert_allclose(np.linalg.norm(ball["rotation"], axis=1), 1, atol=1e-12)
        plate = results.series("rigid/plate")["position"]
        np.testing.assert_allclose(plate[:, 2], 0.5 + 0.001 * np.minimum(times, 5) ** 2 + 0.01 * np.maximum(times - 5, 0), atol=1e-12)
        self.assertEqual(results.num_fields(), report["fields"])
        last = results.fields(-1)
        self.assertEqual(last.time, 10)
        self.assertEqual(len(last["block/displacement"]), len(last.mesh["block/vertices"]))
        self.assertGreater(last["block/von_mises"].max(), 0)
        # The deformed surface in ParaView's file is vertices + displacement.
        self.check_viewer_files("out")

    def check_viewer_files(self, stem):
        index = xml.parse(self.path / f"{stem}.pvd").getroot()
        entries = index.findall("Collection/DataSet")
        self.assertGreater(len(entries), 0)
        for entry in entries:
            data = (self.path / entry.get("file")).read_bytes()
            self.assertTrue(data.startswith(b"<?xml") and data.rstrip().endswith(b"</VTKFile>"), entry.get("file"))

    def test_plastic_strain_of_laws_that_have_one(self):
        more = ", yield_stress = 0.01, hardening_modulus = 0.05, bulk_viscosity = [1.5, 0.06]"
        (self.path / "metal.toml").write_text(run_text(law="j2", material=more, end=4, output="points = true"))
        self.solve("metal.toml", "metal.h5", "--quiet")
        results = iga_results.read(self.path / "metal.h5")
        first, last = results.fields(0), results.fields(-1)
        self.assertEqual(first["block/point_plastic_strain"].max(), 0)
        points, surface = last["block/point_plastic_strain"], last["block/plastic_strain"]
        self.assertEqual(len(points), len(last["block/point_stress"]))
        self.assertEqual(len(surface), len(last.mesh["block/vertices"]))
        self.assertGreater(points.max(), 0.001)
        self.assertGreaterEqual(points.min(), 0)
        self.assertTrue((surface >= -1e-15).all() and (surface <= points.max() * (1 + 1e-12)).all())  # carried without spikes
        # Where it flows the stress lies on the yield surface.
        s = last["block/point_stress"]
        mises = np.sqrt(0.5 * ((s[:, 0] - s[:, 1]) ** 2 + (s[:, 1] - s[:, 2]) ** 2 + (s[:, 2] - s[:, 0]) ** 2)
                        + 3 * (s[:, 3:] ** 2).sum(axis=1))
        excess = mises - (0.01 + 0.05 * points)
        self.assertLess(excess.max(), 1e-12)
        self.assertIn(b'Name="plastic_strain"', (self.path / "metal_vtp" / "metal_0001_0.vtp").read_bytes())
        self.solve("run.toml", "foam.h5", "--quiet")
        self.assertNotIn("block/plastic_strain", iga_results.read(self.path / "foam.h5").fields(-1))

    def test_the_number_of_threads_changes_no_bit(self):
        self.solve("run.toml", "one.h5", "--threads", "1", "--quiet", "--force")
        self.solve("run.toml", "four.h5", "--threads", "4", "--quiet", "--force")
        self.assertEqual(self.series("one.h5"), self.series("four.h5"))
        self.assertEqual(self.fields("one.h5"), self.fields("four.h5"))

    def test_the_report_says_where_the_time_went(self):
        done = self.solve("run.toml", "profile.h5", "--threads", "1", "--profile", "--json", "--force")
        took = json.loads(done.stdout)["steps_took"]
        self.assertEqual(took["threads"], 1)
        names = [phase["name"] for phase in took["phases"]]
        self.assertEqual(names, ["internal forces", "contact search", "touch list", "contact forces",
                                 "loads and supports", "nodes", "step control", "output"])
        for phase in took["phases"]:
            self.assertLessEqual(phase["serial_cpu_seconds"], phase["cpu_seconds"] + 1e-9)
            self.assertLessEqual(phase["cpu_seconds"], phase["seconds"] + 0.01)
        self.assertTrue(0 < took["serial_share"] <= 1)
        text = self.solve("run.toml", "profile.h5", "--threads", "1", "--force").stdout
        self.assertRegex(text, r"steps took +internal forces \d+\.\d %, contact search \d+\.\d %")
        self.assertNotIn("times as fast", text)

    def test_short_edges_of_the_contact_surface_are_merged(self):
        text = run_text().replace("damping = 0.01", "damping = 0.01\nedge_length = 0.5\nmerge_length = 0.45")
        (self.path / "merged.toml").write_text(text)
        done = self.solve("merged.toml", "merged.h5", "--json", "--force")
        report = json.loads(done.stdout)
        found = [re.search(r"contact works on (\d+) of (\d+) vertices.* within (\S+) of", text) for text in report["findings"]]
        left, before, off = next(match.groups() for match in found if match)
        self.assertTrue(8 <= int(left) < int(before))
        self.assertLess(float(off), 1e-12)  # a box: what is merged lies in its faces
        self.assertLess(report["momentum_error"], 1e-12)
        self.assertLess(report["energy_error"], 1e-3)

    def test_progress_lines(self):
        done = self.solve("run.toml", "progress.h5", "--force")
        lines = [line for line in done.stderr.splitlines() if line.startswith("stepping:")]
        self.assertGreaterEqual(len(lines), 2)
        for line in lines:
            self.assertRegex(line, r"stepping: \d+ %(, .* left)?; step \d+, t = \S+, dt = \S+, internal \S+, kinetic \S+, ")
        self.assertIn("100 %", lines[-1])
        self.assertEqual(self.solve("run.toml", "quiet.h5", "--quiet", "--force").stderr, "")

    def test_an_interrupted_run_goes_on_bit_for_bit(self):
        self.solve("long.toml", "whole.h5", "--quiet", "--force")
        process = self.start("long.toml", "parts.h5", "--force")
        caught = 0
        for number, (sign, code) in enumerate(((signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGINT, 130))):
            time.sleep(0.05 * number)
            process.send_signal(sign)
            words = process.communicate()[1]
            if process.returncode == 0:
                break
            caught += 1
            self.assertEqual(process.returncode, code, words)
            self.assertIn("--restart", words)
            self.assertTrue((self.path / "parts_restart.h5").exists())
            iga_results.read(self.path / "parts.h5")
            process = self.start("long.toml", "parts.h5", "--restart")
        self.assertGreater(caught, 0)
        self.assertEqual(process.wait(), 0)
        process.communicate()
        self.assertEqual(self.series("parts.h5"), self.series("whole.h5"))
        self.assertEqual(self.fields("parts.h5"), self.fields("whole.h5"))
        self.assertFalse((self.path / "parts_restart.h5").exists())

    def test_killed_at_any_time_leaves_results(self):
        self.solve("long.toml", "unkilled.h5", "--quiet", "--force")
        choose = random.Random(20)
        for attempt in range(6):
            process = self.start("long.toml", "killed.h5", "--force")
            time.sleep(choose.uniform(0, 0.25))
            process.kill()
            process.communicate()
            with h5py.File(self.path / "killed.h5", "r") as file:
                rows = len(file["time_series/time"])
                self.assertGreater(rows, 0)
                self.assertEqual(len(file["time_series/contact/hit/force"]), rows)
            results = iga_results.read(self.path / "killed.h5")
            for step in range(results.num_fields()):
                results.fields(step)
            self.check_viewer_files("killed")
        if process.returncode == -signal.SIGKILL and (self.path / "killed_restart.h5").exists():
            self.solve("long.toml", "killed.h5", "--restart", "--quiet")
            self.assertEqual(self.series("killed.h5"), self.series("unkilled.h5"))

    def test_existing_results_are_kept(self):
        (self.path / "kept.h5").write_text("of another day")
        done = self.solve("run.toml", "kept.h5", code=2)
        self.assertIn("--force", done.stderr)
        self.assertEqual((self.path / "kept.h5").read_text(), "of another day")

    def interrupted(self, run, out):
        """The run, ended by Ctrl-C at work: a restart file lies there."""
        process = self.start(run, out, "--force")
        process.send_signal(signal.SIGINT)
        words = process.communicate()[1]
        self.assertEqual(process.returncode, 130, words)

    def test_a_restart_refuses_what_would_corrupt_the_run(self):
        text = (self.path / "long.toml").read_text().replace('damping = 0.01', 'damping = 0.01\nedge_length = 0.4')
        edited = self.path / "edited.toml"
        edited.write_text(text)
        self.interrupted("edited.toml", "edited.h5")
        rows = self.series("edited.h5")
        edits = (("edge_length = 0.4", "edge_length = 0.8", r"bodies\[1\].edge_length: 0.4 when the run began, 0.8 now"),
                 ("edge_length = 0.4", "edge_length = 0.2", r"bodies\[1\].edge_length: 0.4 when the run began, 0.2 now"),
                 ("edge_length = 0.4", "", r"bodies\[1\].edge_length: 0.4 when the run began, nothing now"),
                 ("E = 1,", "E = 2,", r"bodies\[1\].material.E: 1 when the run began, 2 now"),
                 ("radius = 1\n", "radius = 2\n", r"rigid_bodies\[1\].radius"),
                 ("[5, 0.01]", "[5, 0.02]", r"rigid_bodies\[2\].drive.z"),
                 ("friction = 0.3", "friction = 0.4", r"contacts\[1\].friction"),
                 ("pressure = 0.002", "pressure = 0.003", r"loads\[1\].pressure"),
                 ('fixed = "x"', 'fixed = "xy"', r"supports\[1\].fixed"),
                 ("normal = [0, 0, 1] }\nfixed", "normal = [0, 0, 1], tolerance = 0.1 }\nfixed", r"supports\[1\].plane.tolerance"),
                 ("gravity = [0, 0, -0.01]", "gravity = [0, 0, -0.02]", "gravity"),
                 ("subdivide = 1", "subdivide = 2", "output.subdivide: 1 when the run began, 2 now"))
        for before, after, words in edits:
            self.assertIn(before, text)
            edited.write_text(text.replace(before, after))
            self.assertRegex(self.solve("edited.toml", "edited.h5", "--restart", code=2).stderr, words)
        self.assertEqual(self.series("edited.h5"), rows)
        # What may change does, and is told; rows come at the new interval from here on.
        later = text.replace("end = 40", "end = 50").replace("\ninterval = 0.2", "\ninterval = 0.5")
        edited.write_text(later + "[energy]\nlimit = 0.5\n[[stop]]\nquantity = \"energy/kinetic\"\nabove = 1e9\n")
        done = self.solve("edited.toml", "edited.h5", "--restart", "--json")
        for words in (r"time.end: 40 when the run began, 50 now", "output.interval: 0.2 when the run began, 0.5 now", "energy.limit"):
            self.assertRegex(json.loads(done.stdout)["warnings"][0], words)
        times = iga_results.read(self.path / "edited.h5")["/time_series/time"]
        self.assertEqual(times[-1], 50)
        steps = np.diff(times)
        self.assertLess(steps.max(), 0.52)
        self.assertGreater(steps[-20:-1].min(), 0.48)

    def test_a_restart_file_that_lost_a_number_is_refused(self):
        self.interrupted("long.toml", "short.h5")
        whole = (self.path / "short_restart.h5").read_bytes()
        for name in ("bodies/block/velocity", "bodies/block/history", "rigid_bodies/ball", "contact/density/block",
                     "contact/last_force/block", "contact/touches", "contact/numbers", "supports/foot", "sums", "numbers"):
            with h5py.File(self.path / "short_restart.h5", "r+") as file:
                values = file[name][()]
                del file[name]
                data = file.create_dataset(name, data=np.append(values, 0.5), chunks=(len(values) + 1,), fletcher32=True)
                data.attrs["description"] = "longer"
            words = self.solve("long.toml", "short.h5", "--restart", code=3 if name == "numbers" else 2).stderr
            self.assertRegex(words, f"/?{name}: (found|holds) {len(values) + 1} numbers.*expected")
            (self.path / "short_restart.h5").write_bytes(whole)
        self.solve("long.toml", "short.h5", "--restart", "--quiet")

    def test_a_restart_needs_the_same_files(self):
        shutil.copyfile(self.path / "box.h5", self.path / "changing.h5")
        (self.path / "changing.toml").write_text((self.path / "long.toml").read_text().replace('"box.h5"', '"changing.h5"'))
        process = self.start("changing.toml", "changed.h5", "--force")
        process.send_signal(signal.SIGINT)
        process.communicate()
        self.assertEqual(process.returncode, 130)
        with h5py.File(self.path / "changing.h5", "r+") as file:
            file["notes"] = "changed"
        done = self.solve("changing.toml", "changed.h5", "--restart", code=2)
        self.assertRegex(done.stderr, "changing.toml:5: 'model' in .bodies.: changing.h5 changed since the run began")
        self.assertIn("no restart: there is no such file", self.solve("run.toml", "never.h5", "--restart", code=2).stderr)

    def expect_blow_up(self, text, *words):
        (self.path / "bad.toml").write_text(text)
        done = self.solve("bad.toml", "bad.h5", "--force", code=4)
        for word in words:
            self.assertRegex(done.stderr, word)
        results = iga_results.read(self.path / "bad.h5")
        self.assertGreater(len(results["/time_series/time"]), 0)
        self.check_viewer_files("bad")

    def test_a_run_that_blows_up_keeps_its_results(self):
        self.expect_blow_up(run_text(material=', yield_curve = [[0, 0.02], [0.5, 0.05]], inversion = "stop", min_volume_ratio = 0.95'),
                            r"t = \S+: \d+ points of body 'block' inverted", "in span", "near", "holds what was found until")
        self.expect_blow_up(run_text(more="[energy]\nlimit = 1e-12\n"), r"t = \S+", "the energy balance is off")
        first = self.first_dt()
        self.expect_blow_up(pressed_text(end=10, dt_max=2 * first, time=f"dt_min = {0.97 * first:.9g}"),
                            r"t = \S+: the time step fell to", "'block'")

    def first_dt(self):
        (self.path / "first.toml").write_text(pressed_text(end=0.5, dt_max=0))
        self.solve("first.toml", "first.h5", "--quiet", "--force")
        return iga_results.read(self.path / "first.h5")["/time_series/dt"][0]

    def test_a_free_spin_keeps_its_momentum(self):
        text = run_text(law="neo-hookean", material="", end=2).replace("gravity = [0, 0, -0.01]", "").replace("damping = 0.01", "")
        (self.path / "spin.toml").write_text(text[:text.index("[[rigid_bodies]]")] + text[text.index("[time]"):])
        report = json.loads(self.solve("spin.toml", "spin.h5", "--json", "--force").stdout)
        self.assertLess(report["angular_momentum_error"], 1e-12)
        self.assertLess(report["momentum_error"], 1e-12)  # of the momentum that its parts carry, not of their sum of zero
        self.assertRegex("\n".join(report["warnings"]), r"rotational inertia that is off by \+\S+ % about the axis of its spin.*two-pass")

    def test_a_stop_condition_ends_the_run(self):
        (self.path / "stop.toml").write_text(run_text(more='[[stop]]\nquantity = "rigid/ball/velocity.z"\nabove = -0.1\n'))
        report = json.loads(self.solve("stop.toml", "stop.h5", "--json", "--force").stdout)
        self.assertLess(report["time"], 10)
        velocity = iga_results.read(self.path / "stop.h5").series("rigid/ball")["velocity"][:, 2]
        self.assertTrue((velocity[:-1] <= -0.1).all() and velocity[-1] > -0.1)

    def test_what_only_the_model_can_tell(self):
        """Refused before the first step, with the place in the run file."""
        for change, words in (
            (("point = [1.25, 2, 2]", "point = [9, 2, 2]"), r"bad.toml:\d+: .*push"),
            (("point = [3, 3, 1]", "point = [3, 3, 9]"), r"bad.toml:\d+: .*foot"),
            (("[3.2, 2.4, 3.65]", "[3.2, 2.4, 2.0]"), r"bad.toml:\d+: contact 'hit': the bodies overlap by"),
            (("size = [8, 8, 1]\ncentre = [3, 2.5, 0.5]", "size = [8, 8, 3]\ncentre = [3, 2.5, 0.2]"), r"bad.toml:\d+: contact 'block-plate': the bodies overlap by"),
            (('friction = 0.3', 'friction = 0.3\nsecond_regions = ["top"]'), r"bad.toml:\d+: body 'block' has no region 'top'"),
            (("dt_max = 0.05", "dt_min = 5"), r"bad.toml:\d+: the first time step would be \S+ \(body 'block'\), below dt_min"),
            (("[output]", '[[stop]]\nquantity = "rigid/bal/velocity.z"\nabove = 0\n[output]'),
             r"bad.toml:\d+: .*did you mean \"rigid/ball/velocity.z\""),
            (("gravity", 'units = "furlong"\ngravity'), r"bad.toml:\d+: the length unit"),
            (("velocity = [0.02, 0, -0.15]", "velocity = [0.02, 0, -1500]"),
             r"bad.toml:\d+: contact 'hit': the sides move against each other at 1500, which is \S+ spans in a step of \S+; .*dt_max below"),
        ):
            with self.subTest(change[1]):
                text = run_text()
                self.assertIn(change[0], text)
                (self.path / "bad.toml").write_text(text.replace(*change))
                for left in ("unwritten.h5", "unwritten.pvd"):
                    (self.path / left).unlink(missing_ok=True)
                done = self.solve("bad.toml", "unwritten.h5", code=2)
                self.assertRegex(done.stderr, words)
                self.assertEqual(list(self.path.glob("unwritten*")), [])
                if "overlap" in words:  # known before stiffness and time step are
                    self.assertNotIn("time step", done.stderr)

    def test_help_shows_a_run_file_that_works(self):
        done = subprocess.run([IGASOLVE, "explicit", "--help"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0)
        text = re.search(r"(  gravity = .*?)\n\n", done.stdout, re.S).group(1)
        text = re.sub("cube.h5", "box.h5", text).replace("[50, 50, 136]", "[3, 2.5, 37.7]")
        (self.path / "help.toml").write_text(text.replace("end = 8", "end = 0.1"))
        self.solve("help.toml", "help.h5", "--quiet", "--force")

    def test_check_reads_results(self):
        self.solve("run.toml", "checked.h5", "--quiet", "--force")
        done = subprocess.run([IGASOLVE, "check", self.path / "checked.h5"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(self.path / "checked.h5", "r+") as file:
            del file["time_series/contact/hit/force"]
        done = subprocess.run([IGASOLVE, "check", self.path / "checked.h5"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 3)
        self.assertIn("/time_series/contact/hit/force", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
