#!/usr/bin/python3
"""igatools.Model and igatools.Results against what igaprep and igasolve computed: points are found in their cells, fields at
points, tables, files for ParaView; the sample in Python runs as a script.

python_api_test.py ROOT IGAPREP IGASOLVE FOLDER_OF_SAMPLE_PARTS"""
import csv
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

ROOT, IGAPREP, IGASOLVE, PARTS = Path(sys.argv[1]), *sys.argv[2:4], Path(sys.argv[4])
sys.path.insert(0, str(ROOT / "scripts"))
import igatools  # noqa: E402
from igatools import locate  # noqa: E402
import parts  # noqa: E402

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader
    NO_VTK = None
except ImportError as error:
    NO_VTK = f"no vtk for {sys.executable} ({error}); apt-get install python3-paraview"

STATIC = """
model = "plate.h5"
[material]
E = 210e3
nu = 0.3
rho = 7.8e-9
[[support]]
name = "left"
fixed = "xyz"
box = [-0.1, -1, -1, 0.1, 11, 11]
[[load]]
name = "right"
force = [0, 0, -10]
box = [39.9, -1, -1, 40.1, 11, 11]
[[probe]]
name = "middle"
position = [20, 5, 5]
[[probe]]
name = "face"
position = [31, 5, 10]
"""
EXPLICIT = """
[[bodies]]
name = "plate"
model = "plate.h5"
material = { law = "neo-hookean", E = 210, nu = 0.3, rho = 7.8e-6 }
velocity = [0, 0, -5]
[[rigid_bodies]]
name = "floor"
shape = "plane"
normal = [0, 0, 1]
centre = [20, 5, -0.01]
motion = "fixed"
[[contacts]]
bodies = ["plate", "floor"]
[time]
end = 0.01
[output]
interval = 0.005
field_interval = 0.005
"""
BODIES = "".join(f'[[bodies]]\nname = "{name}"\nmodel = "plate.h5"\n'
                 f'material = {{ E = {E}, nu = 0.3, rho = 7.8e-9 }}\nplace = {{ shift = [{shift}, 0, 0] }}\n'
                 for name, E, shift in (("first", 210e3, 0), ("second", 70e3, 100)))


def run(*words):
    done = subprocess.run([str(word) for word in words], cwd=FOLDER, capture_output=True, text=True)
    assert done.returncode == 0, f"{words}: {done.stderr}"
    return done.stdout


def rows(path):
    with open(path, newline="") as file:
        return list(csv.reader(file))


def setUpModule():
    global FOLDER, _folder
    _folder = tempfile.TemporaryDirectory()
    FOLDER = Path(_folder.name)
    parts.write_boxes(FOLDER / "plate.stl", [((0, 0, 0), (40, 10, 10))])
    # Two blocks a hundredth of a span apart, and one behind them, in a grid whose axes are none of theirs.
    parts.write_boxes(FOLDER / "gap.stl", [((0, 0, 0), (20, 20, 9)), ((0, 0, 9.05), (20, 20, 18)), ((0, 22, 0), (20, 30, 18))])
    run(IGAPREP, "plate.stl", "-o", "plate.h5", "--span-size", 4.3, "--length-unit", "mm", "--quiet")
    run(IGAPREP, "gap.stl", "-o", "gap.h5", "--span-size", 5, "--rotate-axis-angle", 1, 2, 3, 20, "--quiet")
    for name, text in (("static", STATIC), ("explicit", EXPLICIT), ("bodies", BODIES)):
        (FOLDER / f"{name}.toml").write_text(text)
    run(IGASOLVE, "static", "static.toml", "-o", "static.h5", "--quiet")
    run(IGASOLVE, "eigen", "plate.h5", "--E", 210e3, "--nu", 0.3, "--rho", 7.8e-9, "--modes", 2, "-o", "modes.h5", "--quiet")
    run(IGASOLVE, "explicit", "explicit.toml", "-o", "explicit.h5", "--quiet")
    run(IGASOLVE, "eigen", "bodies.toml", "--modes", 2, "-o", "bodies.h5", "--quiet")


def tearDownModule():
    _folder.cleanup()


def model(name):
    return igatools.Model(FOLDER / f"{name}.h5")


def results(name, **options):
    return igatools.Results(FOLDER / f"{name}.h5", **options)


class Locate(unittest.TestCase):
    def test_windings(self):
        """Of a tetrahedron, with rays through its vertices and edges, against solid angles."""
        vertices = np.array([(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 2)], float)
        triangles = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
        grid = np.stack(np.meshgrid(*3 * [np.linspace(-0.5, 2.5, 13)], indexing="ij"), -1).reshape(-1, 3)
        margin = np.min([*grid.T, 2 - grid.sum(1)], axis=0)
        clear = np.abs(margin) > 1e-9
        np.testing.assert_array_equal(locate.windings(grid, vertices, triangles)[clear], (margin > 0)[clear])

    def test_distances(self):
        triangle = np.array([[(0, 0, 0), (4, 0, 0), (0, 4, 0)]], float)
        for point, distance in (((1, 1, 3), 3), ((-3, 1, 4), 5), ((-3, -4, 0), 5), ((3, 3, 0), 2**0.5), ((6, -2, 1), 3)):
            self.assertAlmostEqual(locate.nearest_triangle(np.array([point], float), triangle)[0][0], distance, places=14)

    def test_bodies_beside_a_gap(self):
        """Random points of three blocks belong to the block's body; those between the blocks and around them to none."""
        gap = model("gap")
        self.assertGreater((np.bincount(gap["/cells/span"]) > 1).sum(), 5)
        body = gap.components()[0]
        blocks = np.array([((0, 0, 0), (20, 20, 9)), ((0, 0, 9.05), (20, 20, 18)), ((0, 22, 0), (20, 30, 18))], float)
        shares = np.random.default_rng(1).random((400, 3))
        found = []
        for low, high in blocks:
            cells, _ = gap.locate(low + (high - low) * shares)
            self.assertTrue((cells >= 0).all())
            found.append(set(body[cells]))
        self.assertEqual(sorted(map(len, found)), [1, 1, 1])
        self.assertEqual(len(set.union(*found)), 3)
        for low, high in (((0, 20.3, 0), (20, 21.7, 18)), ((-5, 0, -5), (25, 30, -0.3)), ((100, 100, 100), (200, 200, 200))):
            self.assertTrue((gap.locate(np.array(low) + (np.array(high) - low) * shares)[0] == -1).all())
        own = gap["/surface/vertex_cell"]
        np.testing.assert_array_equal(body[gap.locate(gap.vertices)[0]], body[own])

    def test_own_points(self):
        for name in ("plate", "gap"):
            found = model(name)
            cells, parameters = found.locate(found.points)
            self.assertTrue((cells >= 0).all())
            np.testing.assert_allclose(found.positions_of(parameters), found.points, atol=1e-12)
            interior = found["/cells/state"][found.point_cells()] == 2
            np.testing.assert_array_equal(found.components()[0][cells[interior]],
                                          found.components()[0][found.point_cells()[interior]])


class Fields(unittest.TestCase):
    def test_statics(self):
        static = results("static")
        for group in ("points", "probes"):
            at = static[f"/static/{group}/position"]
            for found, name in ((static.displacement(at), "displacement"), (static.strain(at), "strain"),
                                (static.stress(at), "stress"), (static.von_mises(at), "von_mises")):
                if group == "probes" and name in ("stress", "von_mises"):
                    continue  # recovered stress, which is not that of the displacements
                stored = static[f"/static/{group}/{name}"]
                np.testing.assert_allclose(found, stored, rtol=0, atol=1e-10 * np.abs(stored).max(), err_msg=name)
        outside = static.displacement([[20, 5, 5], [20, 5, 12], [-40, 0, 0]])
        np.testing.assert_array_equal(np.isnan(outside).all(1), [False, True, True])
        self.assertTrue(np.isnan(static.stress([[20, 5, 12]])).all())

    def test_modes_steps_and_bodies(self):
        for name, choices in (("modes", {"mode": 6}), ("explicit", {"step": -1}), ("bodies", {"mode": 13, "body": "first"}),
                              ("bodies", {"mode": 12, "body": "second"})):
            of = results(name)
            vertices, triangles, fields = of.surface(**choices)
            shift = [100, 0, 0] if choices.get("body") == "second" else [0, 0, 0]  # points are those of the body's own model
            found = of.displacement(vertices - shift, **choices)
            stored = fields["displacement"]
            np.testing.assert_allclose(found, stored, rtol=0, atol=1e-9 * max(np.abs(stored).max(), 1), err_msg=name)
            self.assertLess(triangles.max(), len(vertices))
        self.assertEqual(len(results("explicit").times), results("explicit").num_fields())
        self.assertEqual(len(results("modes").frequencies), 8)

    def test_what_is_refused(self):
        static, modes, explicit, bodies = map(results, ("static", "modes", "explicit", "bodies"))
        at = [[20, 5, 5]]
        (FOLDER / "elsewhere").mkdir()
        (FOLDER / "elsewhere/static.h5").write_bytes((FOLDER / "static.h5").read_bytes())
        moved = igatools.Results(FOLDER / "elsewhere/static.h5")
        for error, text, call in (
                (ValueError, "expected mode=<number>", lambda: modes.displacement(at)),
                (ValueError, "expected step=<number>", lambda: explicit.displacement(at, mode=1)),
                (ValueError, "expected neither mode nor step", lambda: static.displacement(at, mode=0)),
                (IndexError, "mode is 8, expected one of 0 … 7", lambda: modes.displacement(at, mode=8)),
                (ValueError, "expected one of: first, second", lambda: bodies.displacement(at, mode=0)),
                (ValueError, "shape (3,), expected (n, 3)", lambda: static.displacement(at[0])),
                (ValueError, "are stored, not evaluated", lambda: explicit.stress(at)),
                (ValueError, "material of one body only", lambda: bodies.stress(at, mode=0, body="first")),
                (ValueError, "only 'eigen' has frequencies", lambda: static.frequencies),
                (ValueError, "results of another model", lambda: results("static", model=FOLDER / "gap.h5").displacement(at)),
                (FileNotFoundError, "put it beside them", lambda: moved.displacement(at)),
                (ValueError, "there is no table 'probe'; there are: reactions", lambda: static.to_csv(FOLDER / "t", "probe")),
                (ValueError, "expected a name that ends with", lambda: model("plate").to_vtk("plate.stl")),
                (FileNotFoundError, "nothing.h5", lambda: igatools.Model(FOLDER / "nothing.h5")),
                (igatools.FormatError, "expected 'iga-trimmed-solid'", lambda: igatools.Model(FOLDER / "modes.h5"))):
            with self.assertRaises(error) as caught:
                call()
            self.assertIn(text, str(caught.exception))
        self.assertEqual(igatools.Results(moved.path, model=FOLDER / "plate.h5").displacement(at).shape, (1, 3))


class Files(unittest.TestCase):
    def test_tables_are_those_of_igasolve(self):
        for name, reader in (("static", results), ("modes", results), ("explicit", results), ("plate", model)):
            run(IGASOLVE, "export", f"{name}.h5", "--csv", "-o", f"{name}_csv")
            paths = reader(name).to_csv(FOLDER / f"{name}_python")
            self.assertGreater(len(paths), 1)
            for path in paths:
                ours, its = rows(path), rows(FOLDER / f"{name}_csv" / path.name)
                self.assertEqual((ours[0], len(ours)), (its[0], len(its)), path.name)
                for mine, other in zip(ours[1:], its[1:]):
                    for a, b in zip(mine, other):
                        if a != b:  # positions are computed anew
                            self.assertLess(abs(float(a) - float(b)), 1e-12 * 40, path.name)
        self.assertEqual([path.name for path in results("static").to_csv(FOLDER / "one", "probes")], ["probes.csv"])

    @unittest.skipIf(NO_VTK, NO_VTK)
    def test_vtk_reads_the_files(self):
        def read(path):
            reader = (vtkXMLUnstructuredGridReader if path.suffix == ".vtu" else vtkXMLPolyDataReader)()
            reader.SetFileName(str(path))
            reader.Update()
            return reader.GetOutput()

        def arrays(data):
            return {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}

        plate, static = model("plate"), results("static")
        plate.to_vtk(FOLDER / "spans.vtu")
        spans = read(FOLDER / "spans.vtu")
        self.assertEqual(spans.GetNumberOfCells(), len(np.unique(plate["/cells/span"])))
        volume = sum(spans.GetCell(k).GetLength2() for k in range(spans.GetNumberOfCells()))
        self.assertAlmostEqual(volume, spans.GetNumberOfCells() * (plate.span_size()**2).sum(), places=6)
        np.testing.assert_array_equal(np.bincount(arrays(spans.GetCellData())["state"])[1:],
                                      np.bincount(plate["/cells/state"])[1:])
        plate.to_vtk(FOLDER / "surface.vtp")
        surface = read(FOLDER / "surface.vtp")
        np.testing.assert_array_equal(vtk_to_numpy(surface.GetPoints().GetData()), plate.vertices)
        np.testing.assert_array_equal(vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3), plate.triangles)
        static.to_vtk(FOLDER / "points.vtu")
        found = arrays(read(FOLDER / "points.vtu").GetPointData())
        for name in ("displacement", "strain", "stress", "von_mises"):
            np.testing.assert_array_equal(found[name], static[f"/static/points/{name}"])
        results("explicit").to_vtk(FOLDER / "step.vtp", step=1)
        found = arrays(read(FOLDER / "step.vtp").GetPointData())
        np.testing.assert_array_equal(found["displacement"], results("explicit").fields(1)["plate/displacement"])

    def test_repr_tells_what_is_inside(self):
        for shown, words in ((model("plate"), ("plate.h5", "in mm", "degree 2", "interior", "quadrature points", "1 regions")),
                             (results("modes"), ("eigen", "8, of which 2 elastic", "plate.h5")),
                             (results("static"), ("static", "supports left", "loads right", "strain energy")),
                             (results("explicit"), ("explicit", "contacts plate-floor", "steps")),
                             (results("bodies"), ("plate.h5, plate.h5",))):
            for word in words:
                self.assertIn(word, repr(shown))

    def test_the_sample(self):
        sample = ROOT / "samples/12_bracket_static"
        run(IGAPREP, sample / "prep.toml", "--input", PARTS / "bracket_with_ribs.stl", "-o", "bracket.h5", "--span-size", 6, "--quiet")
        run(IGASOLVE, "static", sample / "run.toml", "--model", "bracket.h5", "-o", "bracket_static.h5", "--no-viewer", "--quiet")
        done = subprocess.run([sys.executable, ROOT / "samples/results_in_python/bracket.py", "bracket.h5", "bracket_static.h5"],
                              cwd=FOLDER, capture_output=True, text=True,
                              env={"PYTHONPATH": str(ROOT / "scripts"), "PYTHONDONTWRITEBYTECODE": "1", "MPLCONFIGDIR": str(FOLDER)})
        self.assertEqual(done.returncode, 0, done.stderr)
        for word in ("volume 259", "x =  40.0 mm   deflection       nan", "screw holds", "wrote tables/reactions.csv"):
            self.assertIn(word, done.stdout)
        for name in ("bracket_surface.vtp", "bracket_points.vtu", "bracket_spans.vtu"):
            self.assertTrue((FOLDER / name).exists())


if __name__ == "__main__":
    parts.run_tests(NO_VTK)
