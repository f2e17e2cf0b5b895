#!/usr/bin/python3
# %% [markdown]
# # A model and its results in Python
#
# The bracket of sample 12. Open this file in VS Code, Spyder or Jupyter (jupytext), which run it cell by cell, or run it as a
# script: `bracket.py MODEL STATIC [FOLDER]`, with the files that sample 12 makes.

# %%
import sys
from pathlib import Path

import numpy as np

import igatools

MODEL, STATIC = sys.argv[1:3] if len(sys.argv) > 2 else ("bracket_static_model.h5", "bracket_static.h5")
FOLDER = Path(sys.argv[3] if len(sys.argv) > 3 else ".")

# %% [markdown]
# ## The model
# Printing it tells what is inside.

# %%
model = igatools.Model(MODEL)
print(model)

# %% [markdown]
# Its quadrature points integrate any function over the solid: volume, centre of mass, moments of inertia (per density).

# %%
centre = model.weights @ model.points / model.volume
arm = model.points - centre
inertia = np.einsum("q,qab->ab", model.weights, (arm**2).sum(1)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :])
print(f"volume {model.volume:.1f}, centre of mass {centre.round(2)}, principal moments {np.linalg.eigvalsh(inertia).round(-3)}")

# %% [markdown]
# ## The results
# Displacements and stresses at any point of the solid. Points outside it give nan: where the arm's bore is.

# %%
static = igatools.Results(STATIC, model=model)
print(static)

x = np.linspace(0, 60, 25)
line = np.stack([x, np.full_like(x, 22.5), np.full_like(x, 2.5)], 1)
deflection = static.displacement(line)[:, 2]
bending = static.stress(line)[:, 0]
for row in zip(x[::4], deflection[::4], bending[::4]):
    print("x = {:5.1f} mm   deflection {:9.5f} mm   stress along the arm {:7.3f} MPa".format(*row))

# %% [markdown]
# The most loaded quadrature point, and what the file stores about the supports.

# %%
stress = static["/static/points/von_mises"]
worst = stress.argmax()
print(f"von Mises {stress[worst]:.2f} MPa at {static['/static/points/position'][worst].round(1)}")
for name, force in zip(static.texts("/static/supports/name"), static["/static/supports/force"]):
    print(f"{name} holds {force.round(2)} N")

# %% [markdown]
# ## Files for other programs
# Tables for spreadsheets, files for ParaView.

# %%
for path in static.to_csv(FOLDER / "tables", "reactions") + static.to_csv(FOLDER / "tables", "probes"):
    print("wrote", path)
static.to_vtk(FOLDER / "bracket_surface.vtp")
static.to_vtk(FOLDER / "bracket_points.vtu")
model.to_vtk(FOLDER / "bracket_spans.vtu")

# %% [markdown]
# ## A plot, where matplotlib is installed

# %%
try:
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError:
    print("no plot: matplotlib is not installed")
else:
    figure, axes = plt.subplots(figsize=(8, 4), constrained_layout=True)
    axes.plot(x, deflection, marker="o")
    axes.set_xlabel(f"x [{model.length_unit}]")
    axes.set_ylabel(f"deflection [{model.length_unit}]")
    axes.set_title("Deflection along the middle of the arm; no material in the bore", loc="left")
    axes.grid(True, color="#dfe2e6")
    figure.savefig(FOLDER / "bracket_deflection.png", dpi=120)
