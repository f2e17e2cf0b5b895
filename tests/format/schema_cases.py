"""What holds for every file format of this project: a writer, a C++ reader and a Python reader against one table of
schema/. A test class mixes SchemaCases in and names the table, the files and the readers."""
import shutil
from pathlib import Path

import h5py
from igatools import iga_schema
import numpy as np

WRONG_TYPE = {"f64": np.float32, "i64": np.int32, "i32": np.int64, "enum": np.uint8, "string": np.float64}


class SchemaCases:
    schema = None  # the table
    files = ()  # good files, the first of which holds every listed entry
    readme = ""  # text of schema/README.md
    together = ()  # datasets that another one cannot do without
    lists = ()  # datasets that may be longer than what uses them

    def check(self, path):
        """Exit code and words of the C++ reader."""
        raise NotImplementedError

    def read(self, path):
        """The Python reader."""
        raise NotImplementedError

    def entries(self):
        with h5py.File(self.files[0]) as file:
            return iga_schema.entries(self.schema, file)

    def changed(self, change):
        """A copy of the first file after change(file)."""
        copy = Path(self.files[0]).with_name("changed.h5")
        shutil.copyfile(self.files[0], copy)
        with h5py.File(copy, "r+") as file:
            change(file)
        return copy

    def expect_refused(self, change, *words):
        copy = self.changed(change)
        code, text = self.check(copy)
        self.assertEqual(code, 3, text)
        self.assertNotIn("HDF5-DIAG", text)
        for word in words:
            self.assertIn(word, text)
        with self.assertRaises(iga_schema.FormatError) as caught:
            self.read(copy)
        for word in words:
            self.assertIn(word, str(caught.exception))

    def expect_accepted(self, change):
        copy = self.changed(change)
        code, text = self.check(copy)
        self.assertEqual(code, 0, text)
        self.read(copy)

    def test_writer_keeps_the_schema(self):
        for path in self.files:
            with h5py.File(path) as file:
                iga_schema.validate(file, self.schema)
                iga_schema.validate_storage(file, self.schema)
            self.assertEqual(self.check(path)[0], 0)
        with h5py.File(self.files[0]) as file:
            table = iga_schema.entries(self.schema, file)
            self.assertNotIn("<name>", str(table))
            for kind in ("group", "attribute", "dataset"):
                self.assertGreaterEqual(len(table[kind]), len(self.schema[kind]))
            for entry in table["dataset"] + table["group"]:
                self.assertIn(entry["path"], file)
            for entry in table["attribute"]:
                self.assertIn(entry["name"], file[entry["object"]].attrs)

    def test_the_readme_names_everything(self):
        for entry in self.schema["dataset"]:
            name, shape = entry["path"].rsplit("/", 1)[1], ", ".join(entry["shape"])
            row = f"| `{name}` | {entry['dtype']} | {shape} | {entry['unit']} |"
            self.assertTrue(row in self.readme, f"schema/README.md: no row {row}")
        for entry in self.schema["attribute"]:
            self.assertTrue(f"`{entry['name']}`" in self.readme, f"schema/README.md: no attribute {entry['name']}")

    def test_a_missing_group_is_refused(self):
        for entry in self.entries()["group"]:
            with self.subTest(entry["path"]):
                def change(file):
                    del file[entry["path"]]
                self.expect_group(change, entry)

    def expect_group(self, change, entry):
        """What becomes of a file without this group."""
        self.expect_refused(change, entry["path"]) if entry["required"] else self.expect_accepted(change)

    def test_a_missing_dataset_is_refused(self):
        for entry in self.entries()["dataset"]:
            if entry["path"] in self.together:
                continue
            with self.subTest(entry["path"]):
                def change(file):
                    del file[entry["path"]]
                self.expect_refused(change, entry["path"]) if entry["required"] else self.expect_accepted(change)

    def test_a_dataset_of_another_rank_is_refused(self):
        for entry in self.entries()["dataset"]:
            with self.subTest(entry["path"]):
                def change(file):
                    data, dtype = file[entry["path"]][()], file[entry["path"]].dtype
                    del file[entry["path"]]
                    file.create_dataset(entry["path"], data=data[..., None], dtype=dtype)
                self.expect_refused(change, entry["path"], "shape")

    def test_a_longer_dataset_is_refused(self):
        for entry in self.entries()["dataset"]:
            if entry["path"] in self.lists:
                continue
            with self.subTest(entry["path"]):
                def change(file):
                    data, dtype = file[entry["path"]][()], file[entry["path"]].dtype
                    del file[entry["path"]]
                    file.create_dataset(entry["path"], data=np.concatenate([data, data[-1:]]), dtype=dtype)
                code, text = self.check(self.changed(change))
                self.assertEqual(code, 3, text)

    def test_another_type_is_refused(self):
        for entry in self.entries()["dataset"]:
            with self.subTest(entry["path"]):
                def change(file):
                    shape = file[entry["path"]].shape
                    del file[entry["path"]]
                    file.create_dataset(entry["path"], data=np.ones(shape, WRONG_TYPE[entry["dtype"]]))
                self.expect_refused(change, entry["path"], "expected")

    def test_a_missing_attribute_is_refused(self):
        for entry in self.entries()["attribute"]:
            if entry["name"].startswith("input_"):
                continue  # the two belong together
            with self.subTest(entry["object"] + " " + entry["name"]):
                def change(file):
                    del file[entry["object"]].attrs[entry["name"]]
                if entry["required"]:
                    self.expect_refused(change, entry["name"])
                else:
                    self.expect_accepted(change)

    def test_an_attribute_of_another_kind_is_refused(self):
        for entry in self.entries()["attribute"]:
            with self.subTest(entry["object"] + " " + entry["name"]):
                def change(file):
                    attributes = file[entry["object"]].attrs
                    shape = attributes.get_id(entry["name"]).shape
                    del attributes[entry["name"]]
                    if entry["dtype"] == "string":
                        attributes.create(entry["name"], np.ones(shape))
                    else:
                        attributes.create(entry["name"], np.full(shape, b"text"))
                self.expect_refused(change, entry["name"])

    def test_an_attribute_of_another_shape_is_refused(self):
        for entry in self.entries()["attribute"]:
            with self.subTest(entry["object"] + " " + entry["name"]):
                def change(file):
                    attributes = file[entry["object"]].attrs
                    data = np.asarray(attributes[entry["name"]])
                    del attributes[entry["name"]]
                    attributes.create(entry["name"], np.repeat(data.reshape(1, -1), 2, axis=0))
                code, text = self.check(self.changed(change))
                self.assertEqual(code, 3, text)

    def test_versions(self):
        def version(text):
            def change(file):
                file.attrs["format_version"] = text
            return change
        major = int(self.schema["format_version"].split(".")[0])
        self.expect_accepted(version(f"{major}.7"))
        for text in (f"{major - 1}.0", f"{major + 1}.0", "", "10.0"):
            self.expect_refused(version(text), "version")
