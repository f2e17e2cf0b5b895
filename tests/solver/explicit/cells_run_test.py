#!/usr/bin/python3
"""Explicit runs on spans that hold two walls each: restart bit for bit, the walls pressed onto each other, fields on both.
usage: cells_run_test.py SOURCE_DIR IGAPREP IGASOLVE"""
import json
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

SOURCE, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path[:0] = [str(SOURCE / "scripts"), str(SOURCE / "tests/scripts")]
import explicit_runs  # noqa: E402
from igatools import iga_model, iga_results  # noqa: E402
from parts import write_boxes  # noqa: E402

# Two plates of 2 mm, 1 mm apart, in spans of 5 mm: the upper one is pressed onto the lower one.
PLATES = [((0, 0, 0), (30, 20, 2)), ((0, 0, 3), (30, 20, 5))]
SPAN = 5

RUN = """
[[bodies]]
name = "plates"
model = "plates.h5"
material = {{ law = "neo-hookean", E = 210, nu = 0.3, rho = 7.8e-6 }}
damping = 0.1
[[contacts]]
self = "plates"
friction = 0.2
[[supports]]
name = "floor"
plane = {{ point = [0, 0, 0], normal = [0, 0, -1] }}
fixed = "xyz"
[[supports]]
name = "press"
plane = {{ point = [0, 0, 5], normal = [0, 0, 1] }}
[supports.drive]
kind = "displacement"
z = [[0, 0], [{end}, -{press}]]
[time]
end = {end}
{time}
[output]
interval = {interval}
field_interval = {end}
viewer = false
"""


def run_text(end=0.02, press=1.1, interval=0.001, time=""):
    return RUN.format(end=end, press=press, interval=interval, time=time)


class TwoWallsInASpan(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        write_boxes(cls.path / "plates.stl", PLATES)
        subprocess.run([IGAPREP, cls.path / "plates.stl", "--span-size", str(SPAN), "--length-unit", "mm", "-o",
                        cls.path / "plates.h5", "--quiet"], check=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def write(self, name, **changes):
        (self.path / f"{name}.toml").write_text(run_text(**changes))

    def command(self, name, out, *more):
        return [IGASOLVE, "explicit", self.path / f"{name}.toml", "-o", self.path / out, *more]

    def solve(self, name, out, *more):
        done = subprocess.run(self.command(name, out, *more), capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def start(self, name, out, *more):
        return explicit_runs.start(self.command(name, out, *more))

    def bits(self, out):
        results = iga_results.read(self.path / out)
        data = {name: value.tobytes() for name, value in explicit_runs.series(self.path / out).items()}
        for step in range(results.num_fields()):
            data.update({f"{step} {name}": value.tobytes() for name, value in results.fields(step).data.items()})
        return data

    def test_the_spans_hold_two_walls(self):
        model = iga_model.read(self.path / "plates.h5")
        spans = model["/cells/span"]
        self.assertGreater(len(spans), len(np.unique(spans)))
        functions = model["/functions/number"]
        self.assertGreater(len(functions), len(np.unique(functions)))
        self.assertEqual(model.components()[1], 2)

    def test_a_restart_goes_on_bit_for_bit(self):
        self.write("run", end=0.1, time="dt_max = 1e-5")
        self.solve("run", "whole.h5", "--quiet", "--force")
        process = self.start("run", "parts.h5", "--force")
        caught = 0
        for number in range(3):
            time.sleep(0.1 * number)
            process.send_signal(signal.SIGINT)
            words = process.communicate()[1]
            if process.returncode == 0:
                break
            caught += 1
            self.assertEqual(process.returncode, 130, words)
            process = self.start("run", "parts.h5", "--restart")
        self.assertGreater(caught, 0)
        self.assertEqual(process.wait(), 0)
        process.communicate()
        whole, parts = self.bits("whole.h5"), self.bits("parts.h5")
        self.assertEqual(whole.keys(), parts.keys())
        for name in whole:
            self.assertEqual(whole[name], parts[name], name)
        self.assertGreater(self.contact("whole.h5")["normal_force"].max(), 0)

    def contact(self, out):
        results = iga_results.read(self.path / out)
        return results.series("contact/" + results.texts("/time_series/contact_names")[0])

    def pressed(self, name, **changes):
        """Report and contact of a run that presses the plates slowly together, by half a millimetre beyond touching."""
        self.write(name, end=2, press=1.5, interval=0.02, **changes)
        report = json.loads(self.solve(name, f"{name}.h5", "--force", "--json").stdout)
        self.assertLess(report["momentum_error"], 1e-9)
        balance = iga_results.read(self.path / f"{name}.h5")["/time_series/energy_error"]
        self.assertLess(abs(balance[-1]), 1e-3)
        return report, self.contact(f"{name}.h5")

    def test_walls_of_a_span_hold_each_other(self):
        # Supports hold every node of plates thinner than a span: they took all the stiffness that the step allows, and the plates
        # sank into each other without a force.
        report, contact = self.pressed("default")
        self.assertGreater(contact["normal_force"][-1], 1000)
        self.assertLess(contact["depth"].max(), 0.25)
        self.assertRegex("\n".join(report["warnings"]), r"one side lies 0\.\d+ deep in the other, 0\.\d+ of the wall's thickness")
        self.assertNotIn("without a force", "\n".join(report["warnings"]))
        self.assertRegex("\n".join(report["warnings"]), r"support '\w+' gives way: its surface is 0\.\d+ from where it should be")
        # A quarter of the step: what the advice says.
        report, stiff = self.pressed("quarter", time=f"dt_max = {report['time_step']['dt'] / 4:.9g}")
        self.assertLess(stiff["depth"].max(), 0.07)
        self.assertNotRegex("\n".join(report["warnings"]), "of the wall's thickness|gives way")
        # The elastic squeeze of both plates and of the springs is all that is left of the half millimetre.
        self.assertGreater(stiff["normal_force"][-1], 3 * contact["normal_force"][-1])

    def test_fields_are_told_by_cell(self):
        self.write("fields", end=0.3, press=1.3)
        self.solve("fields", "fields.h5", "--force", "--quiet")
        model, results = iga_model.read(self.path / "plates.h5"), iga_results.read(self.path / "fields.h5")
        step = results.fields(-1)
        cells, parameters = step.mesh["plates/vertex_cell"], step.mesh["plates/vertex_parameters"]
        np.testing.assert_array_equal(model["/cells/span"][cells], step.mesh["plates/vertex_span"])
        N = model.functions_at(model.cell_spans(cells), parameters)[1]
        u = np.einsum("qi,qid->qd", N, step["plates/coefficients"][model["/cells/functions"][cells]])
        np.testing.assert_allclose(u, step["plates/displacement"], atol=1e-12)
        lower = step.mesh["plates/vertices"][:, 2] < 2.5
        self.assertLess(u[~lower, 2].max(), u[lower, 2].min())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
