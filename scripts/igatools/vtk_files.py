"""VTK's XML files, which ParaView and vtk read, without their libraries: numpy alone."""
import sys

import numpy as np

TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}
TRIANGLE, HEXAHEDRON, VERTEX = 5, 12, 1


class File:
    """Arrays are appended to the text as raw bytes, each behind its length."""

    def __init__(self, kind):
        self.kind, self.text, self.bytes = kind, [], []
        self.size = 0

    def array(self, values, name=None):
        values = np.ascontiguousarray(values)
        components = values.shape[1] if values.ndim == 2 else 1
        named = f' Name="{name}"' if name else ""
        self.text.append(f'<DataArray type="{TYPES[values.dtype.str[1:]]}"{named} NumberOfComponents="{components}" '
                         f'format="appended" offset="{self.size}"/>')
        data = values.tobytes()
        self.bytes += [np.uint64(len(data)).tobytes(), data]
        self.size += 8 + len(data)

    def arrays(self, heading, arrays):
        self.text.append(f"<{heading}>")
        for name, values in arrays.items():
            self.array(values, name)
        self.text.append(f"</{heading}>")

    def data_and_points(self, on_points, on_cells, points):
        self.arrays("PointData", dict(on_points))
        self.arrays("CellData", dict(on_cells))
        self.text.append("<Points>")
        self.array(np.asarray(points, float))
        self.text.append("</Points>")

    def write(self, path, counts):
        order = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
        head = (f'<?xml version="1.0"?>\n<VTKFile type="{self.kind}" version="1.0" byte_order="{order}" header_type="UInt64">\n'
                f"<{self.kind}>\n<Piece {counts}>\n")
        tail = f'\n</Piece>\n</{self.kind}>\n<AppendedData encoding="raw">\n_'
        with open(path, "wb") as file:
            file.write((head + "\n".join(self.text) + tail).encode())
            file.writelines(self.bytes)
            file.write(b"\n</AppendedData>\n</VTKFile>\n")


def write_surface(path, vertices, triangles, on_vertices=(), on_triangles=()):
    """A .vtp file: vertices (n, 3), triangles (m, 3), and arrays by name, (n) or (n, k) on vertices, (m) on triangles."""
    file = File("PolyData")
    file.data_and_points(on_vertices, on_triangles, vertices)
    file.arrays("Polys", {"connectivity": np.asarray(triangles, np.int64).ravel(),
                          "offsets": 3 * np.arange(1, len(triangles) + 1, dtype=np.int64)})
    file.write(path, f'NumberOfPoints="{len(vertices)}" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="0" '
                     f'NumberOfPolys="{len(triangles)}"')


def write_cells(path, kind, points, cells, on_points=(), on_cells=()):
    """A .vtu file of cells of one kind: points (n, 3), the points' numbers of each cell (m, k), arrays by name."""
    cells = np.asarray(cells, np.int64)
    file = File("UnstructuredGrid")
    file.data_and_points(on_points, on_cells, points)
    file.arrays("Cells", {"connectivity": cells.ravel(), "offsets": cells.shape[1] * np.arange(1, len(cells) + 1, dtype=np.int64),
                          "types": np.full(len(cells), kind, np.uint8)})
    file.write(path, f'NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}"')
