"""Surfaces in STL files: reading, writing, and what their triangles enclose."""
import numpy as np


def read_stl(path):
    """Triangles (n, 3, 3) of a binary or text STL."""
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    if len(data) == 84 + 50 * count:
        facets = np.frombuffer(data, dtype=np.uint8, offset=84).reshape(count, 50)
        return facets[:, 12:48].copy().view("<f4").reshape(count, 3, 3).astype(float)
    words = [line.split()[1:] for line in data.decode().splitlines() if line.strip().startswith("vertex")]
    return np.array(words, dtype=float).reshape(-1, 3, 3)


def surface_figures(triangles):
    """Volume, centroid and area by the divergence theorem, about the middle of the part."""
    middle = (triangles.min(axis=(0, 1)) + triangles.max(axis=(0, 1))) / 2
    a, b, c = np.moveaxis(triangles - middle, 1, 0)
    normals = np.cross(b - a, c - a)
    six_volumes = np.einsum("ij,ij->i", a, np.cross(b, c))
    volume = six_volumes.sum() / 6
    centroid = middle + ((a + b + c) * six_volumes[:, None]).sum(axis=0) / (24 * volume)
    return volume, centroid, np.linalg.norm(normals, axis=1).sum() / 2


def write_stl(path, triangles):
    """Text STL of triangles (n, 3, 3), with 17 digits."""
    with open(path, "w") as file:
        file.write("solid part\n")
        for triangle in triangles:
            lines = ["vertex " + " ".join(f"{x:.17g}" for x in corner) for corner in triangle]
            file.write("\n".join(["facet normal 0 0 0", "outer loop", *lines, "endloop", "endfacet", ""]))
        file.write("endsolid part\n")
