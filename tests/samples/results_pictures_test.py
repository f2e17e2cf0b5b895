#!/usr/bin/python3
"""scripts/render.py and scripts/plot.py draw results: the pictures show the colours that they should, the printed rates are
those of the numbers, and wrong input is refused in one line.  usage: results_pictures_test.py SYNTHETIC_RESULTS_TOOL FOLDER"""
import json
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import matplotlib.image
import numpy as np

TOOL, FOLDER = Path(sys.argv[1]), Path(sys.argv[2])
SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
from igatools import iga_results, render_results  # noqa: E402


def run(script, *arguments):
    done = subprocess.run([sys.executable, SCRIPTS / script, *arguments], capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


def share(picture, test):
    """Part of the drawing (title and legend left out) whose colour passes the test."""
    pixels = matplotlib.image.imread(picture)[150:-150, :, :3]
    return np.mean(test(pixels[..., 0], pixels[..., 1], pixels[..., 2]))


def red(r, g, b):
    return (r > g + 0.2) & (r > b + 0.2)


def coloured(r, g, b):
    return np.maximum(np.maximum(r, g), b) > np.minimum(np.minimum(r, g), b) + 0.3


class ResultsPictures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(FOLDER, ignore_errors=True)
        FOLDER.mkdir(parents=True)
        for kind in ("eigen", "static"):
            subprocess.run([TOOL, "write", kind, FOLDER / f"{kind}.h5"], check=True)
        subprocess.run([TOOL, "model", FOLDER / "part.h5"], check=True)

    def draw(self, *arguments):
        code, _, errors = run("render.py", *arguments, "--output", FOLDER)
        self.assertEqual(code, 0, errors)

    def test_sheet_of_modes(self):
        self.draw(FOLDER / "eigen.h5")
        self.assertGreater(share(FOLDER / "eigen_modes.png", red), 0.002)  # where the displacement is largest
        self.assertGreater(share(FOLDER / "eigen_modes.png", coloured), 0.1)

    def test_single_modes(self):
        self.draw(FOLDER / "eigen.h5", "--mode", "8", "9", "--colour", "von_mises", "--scale", "20", "--sight", "0", "0", "-1")
        for number in (8, 9):
            self.assertGreater(share(FOLDER / f"eigen_mode_{number}.png", red), 0.01)

    def test_errors_of_the_report_beside(self):
        """Of the results that the report speaks of, and of no others."""
        folder = FOLDER / "told"
        folder.mkdir()
        path = folder / "eigen.h5"
        shutil.copy(FOLDER / "eigen.h5", path)
        results = iga_results.read(path)
        self.assertEqual(render_results.told_beside(path, results), {})
        report = {"results": "eigen.h5", "frequencies": [3201.44, 5085.7], "errors": [0.027, None], "material": {"unit_system": "t-mm-s"}}
        (folder / "report.json").write_text(json.dumps(report))
        told = render_results.told_beside(path, results)
        self.assertEqual(told[results.elastic()[0]], "f = 3201.4 Hz ± 2.7 %")
        self.assertEqual(told[results.elastic()[1]], "f = 5085.7 Hz, error unknown")
        self.draw(path)
        (folder / "report.json").write_text(json.dumps(report | {"results": "other.h5"}))
        self.assertEqual(render_results.told_beside(path, results), {})

    def test_deformed_part(self):
        self.draw(FOLDER / "static.h5", "--colour", "displacement")
        self.assertGreater(share(FOLDER / "static_static.png", red), 0.002)

    def test_spectrum(self):
        for files in (["eigen.h5"], ["eigen.h5", "eigen.h5"]):
            output = FOLDER / f"spectrum{len(files)}.png"
            code, _, errors = run("plot.py", "spectrum", *(FOLDER / file for file in files), "-o", output)
            self.assertEqual(code, 0, errors)
            self.assertGreater(share(output, coloured), 0.001)

    def test_convergence_prints_the_rates_of_the_last_lines(self):
        table = FOLDER / "errors.csv"
        h = [0.5, 0.25, 0.125, 0.0625]
        lines = [f"{x},{3 * x**2},{-x**4 if x < 0.4 else 1},{x**6 if x > 0.1 else ''}" for x in h]
        table.write_text("h,quadratic,quartic,six\n" + "\n".join(lines) + "\n")
        code, text, errors = run("plot.py", "convergence", table, "-o", FOLDER / "errors.svg")
        self.assertEqual(code, 0, errors)
        for words in ("quadratic: rate 2.00", "quartic: rate 4.00", "six: rate 6.00"):
            self.assertIn(words, text)

    def test_wrong_input_is_refused_in_one_line(self):
        (FOLDER / "text.h5").write_text("no HDF5")
        (FOLDER / "one.csv").write_text("h,e\n1,2\n")
        (FOLDER / "words.csv").write_text("h,e\n1,2\n0.5,small\n")
        cases = [("render.py", FOLDER / "none.h5"), ("render.py", FOLDER / "text.h5"),
                 ("render.py", FOLDER / "eigen.h5", "--mode", "10"), ("render.py", FOLDER / "static.h5", "--mode", "1"),
                 ("plot.py", "spectrum", FOLDER / "part.h5"), ("plot.py", "spectrum", FOLDER / "static.h5"),
                 ("plot.py", "convergence", FOLDER / "one.csv"), ("plot.py", "convergence", FOLDER / "words.csv")]
        for case in cases:
            with self.subTest(case):
                code, _, errors = run(*case)
                self.assertEqual(code, 1)
                self.assertEqual(len(errors.strip().splitlines()), 1, errors)
                self.assertIn(case[0], errors)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
