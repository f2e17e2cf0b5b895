#!/usr/bin/python3
"""Sound files of all kinds, rewritten by h5py with valid checksums but wrong content: every reader refuses them with the
path, what was found and what was expected (exit code 3 or 2), or is shown not to mind; nothing crashes, hangs or takes
more than 1 GiB.
usage: attacks_test.py SOURCE_DIR IGAPREP IGASOLVE [--list]"""
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np

SOURCE, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
sys.path.insert(0, str(SOURCE / "tests" / "pipeline"))
HUGE = 2**60
MEMORY = 1 << 30
SECONDS = 20
STEEL = ["--E", "210", "--nu", "0.3", "--rho", "1", "--modes", "2", "--quiet"]
CUBE = """OFF
8 12 0
0 0 0
1 0 0
0 1 0
1 1 0
0 0 1
1 0 1
0 1 1
1 1 1
3 0 2 3
3 0 3 1
3 4 5 7
3 4 7 6
3 0 1 5
3 0 5 4
3 2 6 7
3 2 7 3
3 0 4 6
3 0 6 2
3 1 3 7
3 1 7 5
"""
RUN = """
[[bodies]]
name = "block"
model = "part.h5"
velocity = [0, 0, -0.1]
material = { law = "neo-hookean", E = 1, nu = 0.2, rho = 1 }
[[rigid_bodies]]
name = "floor"
shape = "plane"
normal = [0, 0, 1]
centre = [0, 0, -0.01]
[[contacts]]
bodies = ["block", "floor"]
friction = 0.1
[time]
end = 1e5
"""


# ---- mutations: name, function(file, path) that rewrites one dataset -------------------------------------------------

def replace(file, path, data=None, **how):
    """The dataset anew, with its attributes."""
    attributes = {}
    for name in file[path].attrs:  # no types that h5py cannot read are among them
        attributes[name] = file[path].attrs[name]
    del file[path]
    made = file.create_dataset(path, data=data, **how)
    for name, value in attributes.items():
        made.attrs[name] = value


def values_of(file, path):
    return np.array(file[path][()])


def changed(function):
    def mutate(file, path):
        values = values_of(file, path)
        new = function(values.copy())
        if new is None or (new.dtype == values.dtype and new.shape == values.shape and np.array_equal(new, values)):
            return False
        if h5py.check_enum_dtype(file[path].dtype) and new.dtype == values.dtype:
            replace(file, path, new, dtype=file[path].dtype)
        else:
            replace(file, path, new)
        return True
    return mutate


def numeric(values):
    return values.dtype.kind in "fiu" and values.size > 0


def set_at(where, value):
    def function(values):
        if not numeric(values) or (values.dtype.kind != "f" and isinstance(value, float)):
            return None
        at = {"first": 0, "middle": values.size // 2, "last": values.size - 1}[where]
        values.reshape(-1)[at] = value
        return values
    return changed(function)


def of_numbers(function):
    return changed(lambda values: function(values) if numeric(values) else None)


def swap_ends(values):
    flat = values.reshape(-1)
    flat[0], flat[-1] = flat[-1], flat[0]
    return values


def repeat_first(values):
    if len(values) < 2:
        return None
    values[1] = values[0]
    return values


def as_group(file, path):
    del file[path]
    file.create_group(path)
    return True


def soft_loop(file, path):
    del file[path]
    file[path] = h5py.SoftLink(path)
    return True


def soft_link(file, path):
    file.move(path, path + "_moved")
    file[path] = h5py.SoftLink(path + "_moved")
    return True


def external_link(file, path):
    del file[path]
    file[path] = h5py.ExternalLink("sound.h5", path)
    return True


def missing(file, path):
    del file[path]
    return True


def huge(shape_of):
    def mutate(file, path):
        if file[path].dtype.kind not in "fiu":
            return False
        replace(file, path, shape=shape_of(file[path].shape), dtype=file[path].dtype, chunks=True)
        return True
    return mutate


def big_chunks(file, path):
    old = file[path]
    if old.dtype.kind not in "fiu" or old.size == 0:
        return False
    values = values_of(file, path)
    chunk = (2**28,) + (1,) * (values.ndim - 1)
    replace(file, path, shape=values.shape, maxshape=(None,) * values.ndim, dtype=values.dtype, chunks=chunk,
            compression="gzip", compression_opts=1)
    # Only the claim: no data of that size is made.
    return True


def external_storage(file, path):
    old = file[path]
    if old.dtype.kind not in "fiu" or old.size == 0:
        return False
    values = values_of(file, path)
    values.tofile(Path(file.filename).with_name("raw.bin"))
    replace(file, path, shape=values.shape, dtype=values.dtype,
            external=[(str(Path(file.filename).with_name("raw.bin")), 0, values.nbytes)])
    return True


def virtual(file, path):
    old = file[path]
    if old.dtype.kind not in "fiu" or old.size == 0:
        return False
    layout = h5py.VirtualLayout(shape=old.shape, dtype=old.dtype)
    layout[...] = h5py.VirtualSource("sound.h5", path, shape=old.shape)
    del file[path]
    file.create_virtual_dataset(path, layout)
    return True


def compound(file, path):
    values = values_of(file, path)
    if not numeric(values):
        return False
    both = np.zeros(values.shape, dtype=[("x", values.dtype), ("y", "f4")])
    both["x"] = values
    replace(file, path, both)
    return True


def texts(file, path):
    shape = file[path].shape
    replace(file, path, np.full(shape, b"nonsense"))
    return True


def empty_space(file, path):
    dtype = file[path].dtype
    replace(file, path, h5py.Empty(dtype if dtype.kind in "fiu" else "f8"))
    return True


DATASET = {
    "negative": of_numbers(lambda v: -np.abs(v)),
    "first negative": set_at("first", -1),
    "last zero": set_at("last", 0),
    "middle huge": set_at("middle", 1e300), "first huge count": set_at("first", 2**31 - 1),
    "NaN": set_at("middle", np.nan), "inf": set_at("last", np.inf), "minus inf": set_at("first", -np.inf),
    "falling": of_numbers(lambda v: v[::-1].copy()),
    "ends swapped": of_numbers(swap_ends),
    "first twice": of_numbers(repeat_first),
    "all equal": of_numbers(lambda v: np.full_like(v, v.reshape(-1)[0])),
    "all plus one": of_numbers(lambda v: v + 1),
    "float for int": changed(lambda v: v.astype("f8") if v.dtype.kind in "iu" else None),
    "int for float": changed(lambda v: v.astype("i8") if v.dtype.kind == "f" else None),
    "single precision": changed(lambda v: v.astype("f4") if v.dtype.kind == "f" else None),
    "narrow": changed(lambda v: v.astype("i2") if v.dtype.kind in "iu" else None),
    "unsigned": changed(lambda v: v.astype("u8") if v.dtype.kind == "i" else None),
    "big-endian": changed(lambda v: v.astype(v.dtype.newbyteorder(">")) if v.dtype.kind in "fi" else None),
    "one short": changed(lambda v: v[:-1].copy() if v.ndim and len(v) else None),
    "one more": changed(lambda v: np.concatenate([v, v[-1:]]) if v.ndim and len(v) else None),
    "none": changed(lambda v: v[:0].copy() if v.ndim and len(v) else None),
    "another rank": changed(lambda v: v.reshape(v.shape + (1,))), "scalar": changed(lambda v: v.reshape(-1)[0:1].reshape(()) if v.size else None),
    "transposed": changed(lambda v: v.T.copy() if v.ndim > 1 else None),
    "strings": texts, "compound": compound, "empty space": empty_space,
    "group": as_group, "soft loop": soft_loop, "soft link": soft_link, "external link": external_link, "missing": missing,
    "2^60 rows": huge(lambda shape: (HUGE,) + shape[1:]), "2^40 rows": huge(lambda shape: (2**40,) + shape[1:]),
    "2^28 rows": huge(lambda shape: (2**28,) + shape[1:]),
    "chunks of 2 GiB": big_chunks, "external storage": external_storage, "virtual": virtual,
}

ATTRIBUTE = {
    "missing": None,
    "string": "nonsense", "empty string": "", "number": 7.5, "NaN": np.nan, "inf": np.inf, "negative": -3, "zero": 0,
    "huge": 2**62, "list": [1.0, 2.0, 3.0], "three huge counts": np.array([2**39, 2**39, 2**39]),
    "three counts": np.array([10**6, 10**6, 10**6]), "compound": np.zeros(1, dtype=[("a", "f8"), ("b", "i4")]),
    "empty space": h5py.Empty("f8"), "text of 60 000 letters": "x" * 60000,
    "number as big-endian": np.array(5.0, dtype=">f8"),
}

# Attributes that are words for people, or numbers that nothing follows from: any value of the right type will do.
FREE = {"description", "unit", "order", "title", "length_unit", "producer", "version", "command_line", "created",
        "findings", "timings", "input_names", "input_sha256"}


class Case:
    def __init__(self, kind, place, name, mutate):
        self.kind, self.place, self.name, self.mutate = kind, place, name, mutate

    def text(self):
        return f"{self.kind}: {self.place}: {self.name}"


def attribute_case(kind, path, attribute, name, value):
    def mutate(file):
        if name == "missing":
            del file[path].attrs[attribute]
        else:
            file[path].attrs[attribute] = value
        return True
    return Case(kind, f"{path} attribute {attribute}", name, mutate)


def cases_of(kind, sound):
    cases = []
    with h5py.File(sound, "r") as file:
        objects = ["/"]
        file.visit(lambda path: objects.append("/" + path))
        for path in objects:
            for attribute in file[path].attrs:
                if attribute in ("description", "unit", "order"):
                    continue
                for name, value in ATTRIBUTE.items():
                    cases.append(attribute_case(kind, path, attribute, name, value))
            if isinstance(file[path], h5py.Dataset):
                for name, mutate in DATASET.items():
                    cases.append(Case(kind, path, name, lambda f, m=mutate, p=path: m(f, p)))
            elif path != "/":
                for name, mutate in (("missing", missing), ("soft loop", soft_loop), ("external link", external_link)):
                    cases.append(Case(kind, path, name, lambda f, m=mutate, p=path: m(f, p)))
    return cases


def small_memory():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class Attacks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        (cls.path / "part.off").write_text(CUBE)
        (cls.path / "run.toml").write_text(RUN)
        run = lambda *a: subprocess.run([str(x) for x in a], cwd=cls.path, check=True, capture_output=True)  # noqa: E731
        run(IGAPREP, "part.off", "--degree", "1", "--spans", "2")
        run(IGASOLVE, "eigen", "part.h5", *STEEL, "-o", "modes.h5", "--no-viewer")
        process = subprocess.Popen([str(IGASOLVE), "explicit", "run.toml", "-o", "out.h5"], cwd=cls.path,
                                   stderr=subprocess.PIPE, text=True)
        for line in process.stderr:
            if line.startswith("stepping"):
                break
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
        assert (cls.path / "out_restart.h5").exists()
        shutil.copytree(cls.path, cls.path.with_name(cls.path.name + "_sound"))
        cls.sound = cls.path.with_name(cls.path.name + "_sound")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()
        shutil.rmtree(cls.sound)

    def outcome(self, case, name, commands):
        """What is wrong with the answer to one case; nothing where all is well."""
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            for file in ("part.h5", "run.toml", "out.h5", "out_restart.h5"):
                shutil.copyfile(self.sound / file, folder / file)
            shutil.copytree(self.sound / "out_fields", folder / "out_fields")
            shutil.copyfile(self.sound / name, folder / "sound.h5")
            shutil.copyfile(self.sound / name, folder / name)
            with h5py.File(folder / name, "r+") as file:
                if not case.mutate(file):
                    return None
            faults = []
            for command in commands:
                begin = time.monotonic()
                try:
                    done = subprocess.run(["/usr/bin/env", "time", "-f", "peak %M", str(IGASOLVE), *command], cwd=folder,
                                          capture_output=True, text=True, errors="replace", timeout=SECONDS,
                                          preexec_fn=small_memory) if TIME else subprocess.run(
                        [str(IGASOLVE), *command], cwd=folder, capture_output=True, text=True, errors="replace",
                        timeout=SECONDS, preexec_fn=small_memory)
                except subprocess.TimeoutExpired:
                    faults.append(f"{command[0]} hangs")
                    continue
                seconds = time.monotonic() - begin
                code, words = done.returncode, done.stderr
                if TIME:
                    peak = int(words.rsplit("peak ", 1)[-1]) if "peak " in words else 0
                    if peak * 1024 > MEMORY:
                        faults.append(f"{command[0]} takes {peak / 1024:.0f} MiB")
                if code not in (0, 2, 3, 4):
                    faults.append(f"{command[0]}: exit code {code} after {seconds:.1f} s: {words[-300:]}")
                elif code in (2, 3):
                    if name not in words and "part.h5" not in words:
                        faults.append(f"{command[0]}: the file is not named: {words[-300:]}")
                    if "fault of the program" in words:
                        faults.append(f"{command[0]}: {words[-300:]}")
                elif code == 0 and not self.harmless(case):
                    faults.append(f"{command[0]}: accepted")
            return f"{case.text()}: " + "; ".join(faults) if faults else None

    @staticmethod
    def harmless(case):
        """Content that is right, or that nothing is computed from."""
        attribute = case.place.rsplit(" attribute ", 1)[-1] if " attribute " in case.place else None
        if attribute is not None:
            return attribute in HARMLESS_ATTRIBUTES or case.name in HARMLESS_ATTRIBUTES.get(attribute, ()) \
                or case.name in ("number as big-endian",)
        return case.name == "big-endian" or any(case.place.startswith(p) and (n == "*" or case.name in n)
                                                for p, n in HARMLESS_DATASETS)

    def attack(self, kind, name, commands):
        cases = cases_of(kind, self.sound / name)
        with ThreadPoolExecutor(2) as pool:
            faults = [f for f in pool.map(lambda case: self.outcome(case, name, commands), cases) if f]
        print(f"{kind}: {len(cases)} mutations, {len(cases) * len(commands)} runs, {len(faults)} faults", flush=True)
        self.assertEqual(faults, [], "\n" + "\n".join(faults))

    def test_models(self):
        self.attack("model", "part.h5", [["check", "part.h5"]])

    def test_results(self):
        self.attack("results", "modes.h5", [["check", "modes.h5"]])

    def test_series(self):
        self.attack("series", "out.h5", [["check", "out.h5"]])

    def test_restart(self):
        run = self.sound / "run.toml"
        run.write_text(RUN.replace("1e5", "1e5\nmax_steps = 1"))
        self.attack("restart", "out_restart.h5", [["explicit", "run.toml", "-o", "out.h5", "--restart", "--quiet"]])


TIME = shutil.which("time") is not None
# Attributes and datasets that hold words for people or figures for the record, which no analysis uses.
HARMLESS_ATTRIBUTES = {}
HARMLESS_DATASETS = []

if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
