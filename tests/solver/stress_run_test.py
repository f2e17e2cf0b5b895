#!/usr/bin/python3
"""Runs igaprep and igasolve static on a thick cylinder: stress recovered at the bore, safety factor, line through the wall, and
what is refused."""
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

ROOT, IGAPREP, IGASOLVE = sys.argv[1:4]
sys.path[:0] = [str(Path(ROOT) / "scripts"), str(Path(ROOT) / "tests" / "verification")]
from book import parts  # noqa: E402
from igatools import iga_results, stl  # noqa: E402

INNER, OUTER, PRESSURE = 50.0, 100.0, 100.0
HEAD = """model = "tube.h5"
[material]
E = 200e3
nu = 0.3
yield = 300
"""
PLANES = "".join(f'[[support]]\nname = "{name}"\nfixed = "normal"\nplane = {{ point = {point}, normal = {normal} }}\n'
                 for name, point, normal in (("y", [0, 0, 0], [0, 1, 0]), ("x", [0, 0, 0], [1, 0, 0]), ("low", [0, 0, 0], [0, 0, 1]),
                                             ("high", [0, 0, 30], [0, 0, 1])))
LOAD = '[[load]]\nname = "p"\npressure = 100\npatch = "bore.stl"\n[[probe]]\nname = "bore"\nposition = [50, 0, 15]\n'
HALF = math.sqrt(0.5)


def line(start, end):
    return f'[[line]]\nname = "wall"\nfrom = {start}\nto = {end}\n'


def static(folder, text, *flags):
    (folder / "run.toml").write_text(text)
    return subprocess.run([IGASOLVE, "static", folder / "run.toml", *flags], capture_output=True, text=True, timeout=60)


def near(what, found, expected, error):
    assert abs(found - expected) <= error * abs(expected), f"{what}: {found}, expected {expected} within {100 * error} %"


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        tube = parts.wedge(INNER, OUTER, 30.0, np.pi / 2, 64)
        stl.write_stl(folder / "tube.stl", tube)
        stl.write_stl(folder / "bore.stl", parts.where(tube, lambda x: np.hypot(x[:, 0], x[:, 1]) < INNER * (1 + 1e-9)))
        subprocess.run([IGAPREP, folder / "tube.stl", "-o", folder / "tube.h5", "--span-size", "16", "--quiet"], check=True, timeout=60)

        through = line([INNER * HALF, INNER * HALF, 15], [OUTER * HALF, OUTER * HALF, 15])
        done = static(folder, HEAD + PLANES + LOAD + through, "--json", "-o", folder / "out.h5")
        assert done.returncode == 0, done.stderr
        report = json.loads(done.stdout)
        hoop = PRESSURE * (INNER**2 + OUTER**2) / (OUTER**2 - INNER**2)
        axial = 0.3 * (hoop - PRESSURE)
        mises = math.sqrt(0.5 * ((hoop + PRESSURE)**2 + (hoop - axial)**2 + (axial + PRESSURE)**2))
        stress = report["stress"]
        near("largest von Mises", stress["largest"]["von_mises"], mises, 0.02)
        assert "no_limit_beside" not in stress["largest"], stress["largest"]
        assert 0 < stress["largest"]["error"] < 0.05 * mises, stress["largest"]
        near("safety factor", stress["safety_factor"]["value"], 300 / mises, 0.02)
        probe = stress["probes"][0]
        near("first principal stress", probe["principal"][0], hoop, 0.01)
        near("last principal stress", probe["principal"][2], -PRESSURE, 0.01)
        near("largest shear", probe["largest_shear"], 0.5 * (hoop + PRESSURE), 0.01)

        # Along the line the hoop stress is (1, -1) / √2.
        wall = stress["lines"][0]
        of_hoop = lambda s: 0.5 * (s[0] + s[1]) - s[3]  # noqa: E731
        thickness, share = OUTER - INNER, PRESSURE * INNER**2 / (OUTER**2 - INNER**2)
        near("membrane hoop stress", of_hoop(wall["membrane"]), PRESSURE * INNER / thickness, 0.005)
        middle = 0.5 * (INNER + OUTER)  # ∫ share (1 + b²/r²) (middle - r) dr
        moment = share * OUTER**2 * (middle * (1 / INNER - 1 / OUTER) - math.log(OUTER / INNER))
        near("bending hoop stress", of_hoop(wall["bending"]), 6 * moment / thickness**2, 0.01)
        assert len(wall["stress"]) == 6 * len(wall["distance"]) and wall["distance"] == sorted(wall["distance"])

        # The results file has what the report says; asked for, the stress of the displacements themselves.
        surface = iga_results.read(folder / "out.h5")["/surface/von_mises"][0]
        near("on the surface", surface.max(), mises, 0.02)
        raw = static(folder, HEAD + PLANES + LOAD + '[results]\nstress = "raw"\n', "--json")
        assert "error" not in json.loads(raw.stdout)["stress"]["largest"], raw.stdout

        for text, word in ((line([0, 0, 15], [OUTER, 0, 15]), "line 'wall'"), (line([INNER, 0, 15], [INNER, 0, 15]), "no length"),
                           ('[results]\nstress = "smooth"\n', "recovered"), ('[[line]]\nfrom = [1, 2, 3]\n', "'to'")):
            done = static(folder, HEAD + PLANES + LOAD + text)
            assert done.returncode == 2 and word in done.stderr, (text, done.stderr)
        done = static(folder, HEAD.replace("300", "-1") + PLANES + LOAD)
        assert done.returncode == 2 and "yield" in done.stderr, done.stderr
    print("stress of a thick cylinder: ok")


main()
