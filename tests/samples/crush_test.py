#!/usr/bin/python3
"""The crush sample on its coarse grid, pressed four times as fast for half of its way: energy and momentum balance, notch and
pockets touch, nothing lies in itself deeper than a share of a span.
usage: crush_test.py SOURCE_DIR BIN_DIR PARTS_DIR WORK_DIR"""
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import numpy as np

SOURCE, BIN, PARTS, WORK = (Path(argument).resolve() for argument in sys.argv[1:5])
sys.path.insert(0, str(SOURCE / "scripts"))
from igatools import iga_results  # noqa: E402
import penetration  # noqa: E402
from igatools.run_files import moved_run  # noqa: E402

SAMPLE = SOURCE / "samples" / "crush_foam"
SPAN, WIDTH, SPEED, END = 50.0, 308.6, 8.0, 18.0
# A wall of the coarse model is a third of a span: contact in it may be a tenth of a span deep.
ALLOWED = 0.1 * SPAN


class Crush(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)
        WORK.mkdir(parents=True)
        subprocess.run([BIN / "igaprep", SAMPLE / "prep_coarse.toml", "--input", PARTS / "foam_part.stl", "-o",
                        WORK / "foam.h5", "--quiet"], check=True)
        (WORK / "crush.toml").write_text(moved_run(
            SAMPLE / "crush_coarse.toml", WORK / "foam.h5", ("x = -2\n", f"x = -{SPEED}\n"), ("dt_max = 0.01", "dt_max = 0.02"),
            ("end = 100", f"end = {END}"), ("field_interval = 5", f"field_interval = {END}\nviewer = false")))
        subprocess.run([BIN / "igasolve", "explicit", WORK / "crush.toml", "-o", WORK / "crush.h5", "--quiet", "--threads",
                        "1"], check=True)
        cls.results = iga_results.read(WORK / "crush.h5")

    def series(self, name):
        return self.results[f"/time_series/{name}"]

    def test_energy_is_balanced_at_every_output(self):
        self.assertLess(np.abs(self.series("energy_error")).max(), 0.02)
        self.assertGreater(self.series("energy/internal")[-1], 50 * self.series("energy/contact")[-1])

    def test_momentum_is_that_of_the_impulses(self):
        change = self.series("body/foam/momentum") - self.series("body/foam/momentum")[0]
        impulse = self.series("contact/foam-plate/impulse") + self.series("contact/foam-press/impulse")
        self.assertLess(np.abs(change - impulse).max(), 1e-9 * np.abs(self.series("contact/foam-press/impulse")).max())

    def test_it_touches_itself_and_does_not_pass_through(self):
        self.assertGreater(self.series("contact/foam self/normal_force")[-1], 0.1)
        fields = self.results.fields(len(self.results["/fields/time"]) - 1)
        rest = fields.mesh["foam/vertices"]
        now = rest + fields["foam/displacement"]
        _, depths = penetration.deepest(rest, fields.mesh["foam/triangles"], now)
        self.assertLess(depths.max(initial=0), ALLOWED)
        self.assertGreater(now[:, 0].min(), -ALLOWED)
        self.assertLess(now[:, 0].max(), WIDTH - SPEED * fields.time + ALLOWED)
        self.assertLess(np.ptp(now[:, 0]), 0.55 * WIDTH)  # crushed to about a half

    def test_force_has_no_spikes(self):
        time, force = self.series("time"), np.abs(self.series("contact/foam-plate/force")[:, 0])
        later = time > 4
        means = np.convolve(force, np.ones(5) / 5, "same")
        self.assertLess(np.abs(force - means)[later][:-3].max(), 0.15 * force[later].max())
        self.assertEqual(self.series("body/foam/inverted").max(), 0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
