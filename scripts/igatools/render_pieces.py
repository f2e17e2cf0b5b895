"""Picture of an interchange file for render.py --pieces: which spans hold several walls, and which bodies are separate."""
import sys

import numpy as np

from igatools import drawing, iga_model
from igatools.locate import fan, patches

GREY = (0.80, 0.82, 0.85)
# Separate bodies: pale, so that cells stand out; the first is grey.
BODIES = [GREY, (0.70, 0.80, 0.90), (0.91, 0.83, 0.66), (0.76, 0.87, 0.72), (0.88, 0.75, 0.82), (0.72, 0.86, 0.85)]
# Cells of spans that hold several.
CELLS = [(0.84, 0.26, 0.20), (0.14, 0.40, 0.72), (0.20, 0.60, 0.28), (0.93, 0.65, 0.10), (0.52, 0.28, 0.66), (0.10, 0.62, 0.66)]
GAP_END = (0.96, 0.90, 0.45)
MOST_BOXES = 4000  # outlines of split spans; more of them would be one dark stain


def colour_numbers(model, split):
    """Entry of CELLS for each cell of the spans `split`, -1 for others: different within a span, the same along links where
    that can be, so that the two sides of a gap are seen as such."""
    number, links = model["/cells/span"], model["/links/cells"]
    neighbours = {cell: [] for cell in np.flatnonzero(np.isin(number, split))}
    for a, b in links[np.isin(links, list(neighbours)).all(1)]:
        neighbours[a].append(b)
        neighbours[b].append(a)
    colours, used = np.full(len(number), -1), {span: set() for span in split}

    def give(cell, colour):
        colours[cell] = colour
        used[number[cell]].add(colour)

    for start in neighbours:
        if colours[start] < 0:
            give(start, next(k for k in range(len(used[number[start]]) + 1) if k not in used[number[start]]))
        front = [start]
        while front:
            cell = front.pop()
            for other in neighbours[cell]:
                if colours[other] < 0 and colours[cell] not in used[number[other]]:
                    give(other, colours[cell])
                    front.append(other)
    return colours


def outlines(model, split):
    """Edges of spans as segments (k, 2, 3), in the grid's frame."""
    A, h = model.attribute("/patch", "A"), model.span_size()
    edges = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if (a ^ b) in (1, 2, 4)])
    corner = np.array([[c >> d & 1 for d in range(3)] for c in range(8)])
    ijk = model.split_numbers(split, model.spans)
    return (A + (ijk[:, None, None] + corner[edges][None]) * h).reshape(-1, 2, 3)


def body_of_triangles(model):
    """Separate body of each triangle: that of the cell of any of its surface points, or of its first vertex."""
    component, count = model.components()
    body = component[model["/surface/vertex_cell"][model["/surface/triangles"][:, 0]]]
    group = "/surface/quadrature"
    body[model[group + "/triangle"]] = component[model.point_cells(group)]
    return body, count


def draw(arguments, file):
    try:
        model = iga_model.read(arguments.file)
    except (OSError, KeyError, iga_model.FormatError) as error:
        sys.exit(f"render.py: {arguments.file}: {error}")
    number, count = np.unique(model["/cells/span"], return_counts=True)
    split = number[count > 1]
    copied, ends = model.copied_functions(), int(model.gap_end_cells().sum())
    body, bodies = body_of_triangles(model)
    patch = model.attributes["/patch"]
    centre, R = (patch["A"] + patch["B"]) / 2, patch["rotation"]

    def in_space(points):
        return centre + (np.asarray(points) - centre) @ R.T

    vertices, triangles = model["/surface/vertices"], model["/surface/triangles"]
    actors = [drawing.actor_of(drawing.with_normals(drawing.triangle_mesh(vertices, triangles[body % len(BODIES) == k])),
                               colour=colour)
              for k, colour in enumerate(BODIES) if (body % len(BODIES) == k).any()]
    legend = [(BODIES[k], "the part" if bodies == 1 else f"body {k + 1}") for k in range(min(bodies, 3))]
    whole_ends = np.setdiff1d(model["/cells/span"][model.gap_end_cells()], split)
    if len(whole_ends):
        polygons, _ = patches(model, centre + (vertices - centre) @ R, whole_ends)
        actors.append(drawing.on_top(drawing.actor_of(drawing.triangle_mesh(*fan([in_space(p) for p in polygons])),
                                                      colour=GAP_END)))
        legend.append((GAP_END, "whole cell at the end of a gap"))
    if len(split):
        in_grid = centre + (vertices - centre) @ R
        polygons, owners = patches(model, in_grid, split)
        numbers = colour_numbers(model, split)
        for k, colour in enumerate(CELLS):
            own = [in_space(polygon) for polygon, at in zip(polygons, numbers[owners]) if at % len(CELLS) == k]
            if own:
                actors.append(drawing.on_top(drawing.actor_of(drawing.triangle_mesh(*fan(own)), colour=colour)))
        if len(split) <= MOST_BOXES:
            actors.append(drawing.actor_of(drawing.grid_lines(in_space(outlines(model, split))), colour=(0.25, 0.25, 0.28),
                                           opacity=0.35, flat=True))
        legend += [(CELLS[k], ("one cell of a span", "another", "a third")[k]) for k in range(min(int(numbers.max()) + 1, 3))]
    pixels = drawing.picture(actors, np.array(arguments.sight), (0, 0, 1), vertices)
    drawing.page(pixels, f"{drawing.text(model.attribute('/', 'title')) or arguments.file.stem}: pieces and copies",
                 f"{len(split):,} of {len(number):,} spans hold several cells; {copied:,} of "
                 f"{len(np.unique(model['/functions/number'])):,} B-splines have copies; " + (f"{ends:,} cells at gap ends; " if ends else "") + f"{bodies:,} separate "
                 f"{'body' if bodies == 1 else 'bodies'}", file, legend=legend)
