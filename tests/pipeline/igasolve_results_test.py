#!/usr/bin/python3
"""From a model to results: files of igasolve obey their schema and hold what closed forms say.
usage: igasolve_results_test.py SOURCE_DIR WRITE_SYNTHETIC_MODEL IGASOLVE"""
import csv
import hashlib
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import h5py
import numpy as np

SOURCE, WRITER, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path.insert(0, str(SOURCE / "scripts"))
from igatools import iga_model, iga_results, iga_schema  # noqa: E402

E, NU, PULL = 50.0, 0.3, 2.0
LOWER, UPPER = np.array([1.25, 1.5, 1]), np.array([4.75, 3.5, 2.6])  # of the synthetic box
TENSION = f"""
model = "box.h5"
[material]
E = {E}
nu = {NU}
rho = 1
""" + "".join(f"""
[[support]]
name = "plane {d}"
region = "{d}-"
fixed = "normal"
""" for d in "uvw") + f"""
[[load]]
name = "pull"
region = "u+"
traction = [{PULL}, 0, 0]
[[probe]]
name = "inside"
position = [3, 2.5, 2]
"""


class IgasolveResults(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        subprocess.run([WRITER, "box", cls.path / "box.h5"], check=True, capture_output=True)
        (cls.path / "pull.toml").write_text(TENSION)
        cls.modes, cls.pull = cls.path / "modes.h5", cls.path / "pull.h5"
        cls.eigen = ["eigen", cls.path / "box.h5", "--E", str(E), "--nu", str(NU), "--rho", "1", "--modes", "4"]
        for command in ([*cls.eigen, "-o", cls.modes], ["static", cls.path / "pull.toml", "-o", cls.pull]):
            code, _, errors = cls.solve(*command)
            assert code == 0, errors

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @staticmethod
    def solve(*arguments):
        done = subprocess.run([IGASOLVE, *arguments], capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    def test_both_files_obey_the_schema(self):
        for path in (self.modes, self.pull):
            with h5py.File(path) as file:
                iga_schema.validate(file, iga_results.SCHEMA)
                iga_schema.validate_storage(file, iga_results.SCHEMA)
            results = iga_results.read(path)
            model = hashlib.sha256((self.path / "box.h5").read_bytes()).hexdigest()
            self.assertEqual(results.attribute("/model", "sha256"), model)
            self.assertEqual(results.attribute("/model", "file"), "box.h5")
            self.assertEqual(results.attribute("/provenance", "producer"), "igasolve")
            lame = E * NU / ((1 + NU) * (1 - 2 * NU))
            self.assertAlmostEqual(results.attribute("/material", "C")[0, 1], lame, delta=1e-12 * lame)

    def test_modes(self):
        results = iga_results.read(self.modes)
        self.assertEqual(results.kinds(), ["RIGID"] * 6 + ["ELASTIC"] * 4)
        self.assertEqual(results["/frequencies"][:6].tolist(), [0] * 6)
        self.assertTrue((np.diff(results["/frequencies"][6:]) >= 0).all())
        self.assertLess(results["/eigen/residual"].max(), 1e-8)
        np.testing.assert_allclose(results["/eigen/omega_squared"][6:], (2 * np.pi * results["/frequencies"][6:]) ** 2,
                                   rtol=1e-12)

    def test_coefficients_and_surface_tell_the_same(self):
        model = iga_model.read(self.path / "box.h5")
        for path, coefficients in ((self.modes, "/modes"), (self.pull, "/static/displacement")):
            results = iga_results.read(path)
            cells = results["/surface/vertex_cell"]
            c = np.atleast_3d(results[coefficients]).reshape(-1, results.symbols["n_f"], 3)
            for step, field in enumerate(results["/surface/displacement"]):
                u = results.field(model, c[step], cells, results["/surface/vertex_parameters"])
                np.testing.assert_allclose(u, field, atol=1e-12 * np.abs(field).max())

    def test_a_bar_in_tension(self):
        results = iga_results.read(self.pull)
        size = UPPER - LOWER
        area, volume = size[1] * size[2], size.prod()
        stress = np.array([PULL, 0, 0, 0, 0, 0])
        strain = np.array([1, -NU, -NU, 0, 0, 0]) * PULL / E

        def displacement(x):
            return (x - LOWER) * strain[:3]

        for group, places in (("/static/points", "/static/points/position"), ("/static/probes", "/static/probes/position"),
                              ("/surface", "/surface/vertices")):
            shape = lambda value: np.broadcast_to(value, results[f"{group}/stress"].shape)  # noqa: E731
            np.testing.assert_allclose(results[f"{group}/stress"], shape(stress), atol=1e-9)
            np.testing.assert_allclose(results[f"{group}/strain"], shape(strain), atol=1e-11)
            np.testing.assert_allclose(results[f"{group}/von_mises"], PULL, atol=1e-9)
            u = results[f"{group}/displacement"]
            np.testing.assert_allclose(u, np.broadcast_to(displacement(results[places]), u.shape), atol=1e-11)
        self.assertEqual(results.texts("/static/probes/name"), ["inside"])
        reactions = dict(zip(results.texts("/static/supports/name"), results["/static/supports/force"]))
        np.testing.assert_allclose(reactions["plane u"], [-PULL * area, 0, 0], atol=1e-9)
        np.testing.assert_allclose(reactions["plane v"], 0, atol=1e-9)
        self.assertEqual(results.texts("/static/loads/name"), ["pull"])
        np.testing.assert_allclose(results["/static/loads/force"], [[PULL * area, 0, 0]], atol=1e-12)
        for name in ("strain_energy", "external_work"):
            self.assertAlmostEqual(results.attribute("/static", name), PULL**2 / E * volume / 2, delta=1e-9)

    def test_the_surface_is_as_fine_as_asked(self):
        counts = []
        for subdivide in ("1", "3"):
            code, _, errors = self.solve(*self.eigen, "--subdivide", subdivide, "-o", self.path / "fine.h5", "--force")
            self.assertEqual(code, 0, errors)
            results = iga_results.read(self.path / "fine.h5")
            corners = results["/surface/vertices"][results["/surface/triangles"]]  # the box's spans have size 1
            edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
            self.assertLessEqual(edges.max(), 1 / int(subdivide) + 1e-12)
            counts.append(len(corners))
        self.assertLess(counts[0], counts[1])

    def test_nothing_is_replaced_unasked(self):
        before = self.modes.read_bytes()
        code, _, errors = self.solve(*self.eigen, "-o", self.modes)
        self.assertEqual(code, 2)
        self.assertIn("modes.h5", errors)
        self.assertIn("--force", errors)
        self.assertEqual(self.modes.read_bytes(), before)
        # The files for ParaView count too.
        lone = self.path / "lone.h5"
        lone.with_suffix(".pvd").write_text("of another day")
        code, _, errors = self.solve(*self.eigen, "-o", lone)
        self.assertEqual(code, 2)
        self.assertIn("lone.pvd", errors)
        self.assertFalse(lone.exists())
        code, _, errors = self.solve(*self.eigen, "-o", lone, "--no-viewer")
        self.assertEqual(code, 0, errors)
        self.assertEqual(lone.with_suffix(".pvd").read_text(), "of another day")

    def test_a_folder_that_cannot_be_written_is_named(self):
        places = [self.path / "missing", Path("/proc")]
        if os.geteuid() != 0:
            places.append(self.path / "read_only")
            places[-1].mkdir()
            places[-1].chmod(0o555)
        for place in places:
            code, _, errors = self.solve(*self.eigen, "-o", place / "modes.h5")
            self.assertEqual(code, 2)
            self.assertIn(str(place), errors)
            self.assertIn("nothing was changed", errors)

    def test_results_are_no_model(self):
        code, text, errors = self.solve("eigen", self.modes, *self.eigen[2:])
        self.assertEqual(code, 3, text)
        self.assertIn("iga-trimmed-solid-results", text + errors)

    def test_check_reads_results_too(self):
        code, text, errors = self.solve("check", self.modes)
        self.assertEqual(code, 0, errors)
        self.assertIn("sound", text)

    def table(self, path):
        """Names of the columns without units, their units, and the rows of a CSV file."""
        with open(path, newline="", encoding="utf-8") as file:
            head, *rows = csv.reader(file)
        units = [title.partition(" [")[2].rstrip("]") for title in head]
        return [title.partition(" [")[0] for title in head], units, rows

    def columns(self, path, *names):
        head, _, rows = self.table(path)
        return np.array([[float(row[head.index(name)]) for name in names] for row in rows])

    def export(self, file, *words):
        folder = self.path / f"{file.stem}_{len(words)}"
        code, text, errors = self.solve("export", file, "--csv", "-o", folder, *words)
        self.assertEqual(code, 0, errors)
        return folder

    def test_tables_of_modes(self):
        results, folder = iga_results.read(self.modes), self.export(self.modes)
        self.assertEqual(sorted(file.name for file in folder.iterdir()), ["frequencies.csv", "participation.csv", "surface.csv", "triangles.csv"])
        head, units, rows = self.table(folder / "frequencies.csv")
        self.assertEqual(head, ["mode", "frequency", "omega_squared", "kind", "residual"])
        self.assertEqual(units[1:3], ["1/time", "1/time^2"])
        self.assertEqual([row[3].upper() for row in rows], results.kinds())
        np.testing.assert_array_equal(self.columns(folder / "frequencies.csv", "frequency")[:, 0], results["/frequencies"])
        unit = self.table(folder / "surface.csv")[1][2]
        self.assertEqual(unit, results.attribute("/", "length_unit"))
        shape = results["/surface/displacement"].shape
        np.testing.assert_array_equal(
            self.columns(folder / "surface.csv", "displacement_x", "displacement_y", "displacement_z").reshape(shape),
            results["/surface/displacement"])
        np.testing.assert_array_equal(self.columns(folder / "triangles.csv", "vertex_1", "vertex_2", "vertex_3"),
                                      results["/surface/triangles"])
        # One table into one file; nothing is replaced unasked.
        one = self.path / "frequencies_alone.csv"
        self.assertEqual(self.solve("export", self.modes, "--csv", "-o", one)[0], 0)
        self.assertEqual(one.read_bytes(), (folder / "frequencies.csv").read_bytes())
        code, _, errors = self.solve("export", self.modes, "--csv", "-o", one)
        self.assertEqual(code, 2)
        self.assertIn("--force", errors)

    def test_tables_of_statics(self):
        results, folder = iga_results.read(self.pull), self.export(self.pull)
        for table, group, name, suffixes in (("reactions", "/static/supports", "force", "xyz"),
                                             ("loads", "/static/loads", "moment", "xyz"),
                                             ("probes", "/static/probes", "displacement", "xyz"),
                                             ("points", "/static/points", "position", "xyz"),
                                             ("points", "/static/points", "stress", ("xx", "yy", "zz", "xy", "yz", "zx"))):
            found = self.columns(folder / f"{table}.csv", *(f"{name}_{suffix}" for suffix in suffixes))
            np.testing.assert_array_equal(found, results[f"{group}/{name}"])
        head, _, rows = self.table(folder / "reactions.csv")
        self.assertEqual([row[0] for row in rows], results.texts("/static/supports/name"))

    def test_tables_of_a_model(self):
        folder = self.export(self.path / "box.h5")
        with h5py.File(self.path / "box.h5") as file:
            weights = self.columns(folder / "points.csv", "weight")[:, 0]
            np.testing.assert_array_equal(weights, file["quadrature/weights"])
            spans = self.columns(folder / "points.csv", "span")[:, 0]
            np.testing.assert_array_equal(spans, np.repeat(file["cells/span"], np.diff(file["quadrature/offsets"])))
            np.testing.assert_array_equal(self.columns(folder / "surface_points.csv", "normal_x", "normal_y", "normal_z"),
                                          file["surface/quadrature/normals"])
            np.testing.assert_array_equal(self.columns(folder / "functions.csv", "mass_fraction")[:, 0],
                                          file["functions/mass_fraction"])

    def test_tables_of_an_explicit_run(self):
        run = self.path / "flight.toml"
        run.write_text("""
[[bodies]]
name = "box, thrown"
model = "box.h5"
material = { law = "neo-hookean", E = 50, nu = 0.3, rho = 1e-3 }
velocity = [1, 2, 3]
[time]
end = 0.01
[output]
interval = 0.005
field_interval = 0.01
""")
        flight = self.path / "flight.h5"
        code, _, errors = self.solve("explicit", run, "-o", flight)
        self.assertEqual(code, 0, errors)
        folder = self.export(flight)
        with h5py.File(flight) as file:
            series = file["time_series"]
            for name, dataset in (("time", "time"), ("kinetic", "energy/kinetic"), ("energy_error", "energy_error")):
                np.testing.assert_array_equal(self.columns(folder / "energy.csv", name)[:, 0], series[dataset])
            np.testing.assert_array_equal(
                self.columns(folder / "body_box, thrown.csv", "momentum_x", "momentum_y", "momentum_z"),
                series["body/box, thrown/momentum"])
            steps = [name.decode() if isinstance(name, bytes) else name for name in file["fields/file"][:]]
        for step, name in enumerate(steps):
            with h5py.File(self.path / name) as fields:
                np.testing.assert_array_equal(
                    self.columns(folder / f"surface_box, thrown_{step + 1:04d}.csv", "displacement_x", "von_mises"),
                    np.column_stack([fields["bodies/box, thrown/displacement"][:, 0],
                                     fields["bodies/box, thrown/von_mises"]]))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
