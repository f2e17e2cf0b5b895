#!/usr/bin/python3
"""scripts/render.py draws both pictures of a model, and they show the colours that their legends name."""
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import numpy as np

model, folder = Path(sys.argv[1]), Path(sys.argv[2])
script = Path(__file__).resolve().parents[2] / "scripts" / "render.py"
subprocess.run([sys.executable, script, model, "--output", folder], check=True)


def share(picture, hue_test):
    """Part of the drawing (title and legend left out) whose colour passes the test."""
    pixels = matplotlib.image.imread(picture)[150:-150, :, :3]
    return np.mean(hue_test(pixels[..., 0], pixels[..., 1], pixels[..., 2]))


spans, points = folder / f"{model.stem}_spans.png", folder / f"{model.stem}_points.png"
checks = {
    "trimmed spans, orange": share(spans, lambda r, g, b: (r > b + 0.2) & (g > b)),
    "interior spans, blue": share(spans, lambda r, g, b: b > r + 0.15),
    "surface, grey": share(spans, lambda r, g, b: (abs(r - b) < 0.1) & (r > 0.3) & (r < 0.85)),
    "points, purple to yellow": share(points, lambda r, g, b: np.maximum(r, b) > g + 0.2),
}
missing = [name for name, found in checks.items() if found < 0.002]
for name, found in checks.items():
    print(f"{name}: {100 * found:.1f} % of the picture")
sys.exit(f"missing in the pictures: {', '.join(missing)}" if missing else 0)
