#!/usr/bin/python3
"""scripts/render.py --choices draws what igasolve chooses: the same areas and centroids, which are exact, each in its colour."""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.image
import numpy as np

SOURCE, IGAPREP, IGASOLVE = sys.argv[1:4]
CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 10) for x in (0, 10)]
FACES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
         (1, 3, 7), (1, 7, 5)]
RUN = """
model = "plate.h5"
[material]
E = 1
nu = 0.3
[[support]]
name = "edge"
fixed = "xyz"
box = [0, 0, 1, 0.02, 10, 1]
[[support]]
name = "side"
fixed = "x"
normal = { direction = [1, 0, 0] }
plane = { point = [10, 5, 0.5], normal = [0, 1, 0], tolerance = 0.5 }
[[load]]
name = "weight"
pressure = 1
box = [3, 3, 1, 4.5, 7, 1]
"""
EXPECTED = {"edge": (0.2, (0.01, 5, 1)), "side": (1, (10, 5, 0.5)), "weight": (6, (3.75, 5, 1))}


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)


with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    (folder / "plate.obj").write_text("".join("v {} {} {}\n".format(*c) for c in CORNERS)
                                      + "".join("f {} {} {}\n".format(*(i + 1 for i in f)) for f in FACES))
    made = run(IGAPREP, folder / "plate.obj", "-o", folder / "plate.h5", "--spans", 10, "--quiet")
    assert made.returncode == 0, made.stderr
    (folder / "run.toml").write_text(RUN)
    solved = run(IGASOLVE, "static", folder / "run.toml", "--json")
    assert solved.returncode == 0, solved.stderr
    statics = json.loads(solved.stdout)["statics"]
    for found in statics["supports"] + statics["loads"]:
        area, centroid = EXPECTED[found["name"]]
        assert abs(found["area"] - area) < 1e-12 * area, found
        np.testing.assert_allclose(found["centroid"], centroid, atol=1e-11)
    assert statics["energy_defect"] < 1e-9, statics["energy_defect"]
    drawn = run(sys.executable, Path(SOURCE) / "scripts/render.py", "--choices", folder / "run.toml")
    print(drawn.stdout, drawn.stderr)
    assert drawn.returncode == 0
    for name, (area, _) in EXPECTED.items():
        assert f"'{name}': area {area:.8g}," in drawn.stdout, name
    pixels = matplotlib.image.imread(folder / "run_choices.png")[150:-150, :, :3]
    red, green, blue = pixels[..., 0], pixels[..., 1], pixels[..., 2]
    assert np.mean((green > red + 0.2) & (green > blue + 0.2)) > 0.005, "the load's area is not seen"
