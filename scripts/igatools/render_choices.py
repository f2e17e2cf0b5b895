"""Supports and loads of a run file drawn on the part: every choice of surface in a colour of its own."""
import sys
import tomllib

import numpy as np

from igatools import drawing, iga_model
from igatools.choices import chosen_polygons, snap_length

TABLES = ("support", "load")
COLOURS = ((0.84, 0.15, 0.16), (0.12, 0.47, 0.71), (0.17, 0.63, 0.17), (1.0, 0.5, 0.05), (0.58, 0.4, 0.74), (0.55, 0.34, 0.29),
           (0.89, 0.47, 0.76), (0.09, 0.75, 0.81))


def area_and_centroid(polygons):
    total, moment = 0.0, np.zeros(3)
    for polygon in polygons:
        for k in range(1, len(polygon) - 1):
            corners = polygon[[0, k, k + 1]]
            area = np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0])) / 2
            total += area
            moment += area * corners.mean(axis=0)
    return total, moment / total if total > 0 else moment


def read_run(path):
    """Model file and [(kind, table)] of a run file, those that choose surface."""
    try:
        with open(path, "rb") as file:
            run = tomllib.load(file)
    except (OSError, tomllib.TOMLDecodeError) as error:
        sys.exit(f"render.py: {path}: cannot be read as a run file ({error})")
    if "model" not in run:
        sys.exit(f"render.py: {path}: names no model; --choices draws run files of igasolve static and eigen with one body (model = \"…\")")
    keys = ("region", "box", "plane", "normal", "whole_surface")
    for kind in TABLES:
        for number, table in enumerate(run.get(kind, []), 1):
            what = [key for key in ("patch", "curve", "line", "point", "at") if key in table]
            if what:
                print(f"{kind} '{table.get('name', number)}': its {what[0]} is not drawn; the report of igasolve says what it found")
        run[kind] = [table for table in run.get(kind, []) if "patch" not in table]
    chosen = [(kind, table) for kind in TABLES for table in run.get(kind, []) if any(key in table for key in keys)]
    if not chosen:
        sys.exit(f"render.py: {path}: no [[support]] or [[load]] chooses surface; nothing to draw")
    return path.parent / run["model"], chosen


def patch(polygons, lift):
    """Polydata of convex polygons, lifted off the surface so that they are seen on it."""
    points, triangles = [], []
    for polygon in polygons:
        normal = np.cross(polygon[1] - polygon[0], polygon[2] - polygon[0])
        first = sum(len(p) for p in points)
        points.append(polygon + lift * normal / max(np.linalg.norm(normal), 1e-300))
        triangles += [(first, first + k, first + k + 1) for k in range(1, len(polygon) - 1)]
    return drawing.triangle_mesh(np.concatenate(points), np.array(triangles))


def draw(arguments):
    """<run file>_choices.png, seen along --sight and from behind; areas and centroids on stdout."""
    run = arguments.choices
    path, chosen = read_run(run)
    try:
        model = iga_model.read(path)
        vertices, triangles = model["/surface/vertices"], model["/surface/triangles"]
        region, names = model["/surface/region"], model.texts("/surface/regions")
        snap = snap_length(model)
    except (OSError, KeyError) as error:
        sys.exit(f"render.py: {path}: not a readable interchange file ({error}); try igasolve check")
    size = np.ptp(vertices, axis=0).max()
    actors = [drawing.actor_of(drawing.with_normals(drawing.triangle_mesh(vertices, triangles)), colour=(0.80, 0.82, 0.85))]
    legend = []
    for k, (kind, table) in enumerate(chosen):
        polygons = chosen_polygons(table, vertices, triangles, region, names, snap)
        area, centroid = area_and_centroid(polygons)
        name = table.get("name", f"{kind} {k + 1}")
        print(f"{kind} '{name}': area {area:.8g}, centroid ({', '.join(f'{c:.6g}' for c in centroid)})")
        if area == 0:
            continue
        colour = COLOURS[k % len(COLOURS)]
        actors.append(drawing.actor_of(patch(polygons, (1 + k) * 5e-4 * size), colour=colour, flat=True))
        legend.append((colour, f"{kind} {name} (area {area:.4g})"))
    width, height = drawing.PIXELS
    sides = [drawing.picture(actors, sign * np.array(arguments.sight), (0, 0, 1), vertices, (width // 2, height))
             for sign in (1, -1)]
    folder = arguments.output or run.parent
    folder.mkdir(parents=True, exist_ok=True)
    title = drawing.text(model.attribute("/", "title")) or path.stem
    drawing.page(np.concatenate(sides, axis=1), f"{title}: supports and loads", f"{run.name}; from both sides",
                 folder / f"{run.stem}_choices.png", legend=legend)
