#!/usr/bin/python3
"""Sound models, results and restart files whose content is rewritten under valid checksums: each is refused with the file,
what was found and what was expected, unless nothing in the file could tell; nothing crashes, hangs or takes 1 GiB.
usage: mutated_files_test.py SOURCE_DIR IGAPREP IGASOLVE [--all]; without --all a sample with a fixed seed"""
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py

from mutations import OTHER_VALUES, mutations_of

SOURCE, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
ALL = "--all" in sys.argv
SAMPLE = 150  # of each kind of file
SECONDS = 10
MEMORY = 1 << 30
STEEL = ["--E", "210", "--nu", "0.3", "--rho", "1", "--modes", "8", "--quiet"]
CUBE = """OFF
8 12 0
0 0 0  1 0 0  0 1 0  1 1 0  0 0 1  1 0 1  0 1 1  1 1 1
3 0 2 3  3 0 3 1  3 4 5 7  3 4 7 6  3 0 1 5  3 0 5 4
3 2 6 7  3 2 7 3  3 0 4 6  3 0 6 2  3 1 3 7  3 1 7 5
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
TEXT = {"string", "empty string", "text of 60 000 letters"}
FREE_TEXTS = {"title", "length_unit", "file", "sha256", "mass", "light_functions", "law", "bodies_file"}
# Numbers that stand alone: any of the right kind will do.
FREE_NUMBERS = {"dropped_spans", "snapped_spans", "tolerance", "accepted_leak", "bodies", "complete_below", "density",
                "light_threshold", "unknowns", "rows", "fields", "strain_energy", "external_work"}
# What a refusal says beside the path and what was found.
EXPLAINED = re.compile(r"expected|missing|belongs? to|this program reads|was written by|changed|cannot be read|run began|"
                       r"outside its span|not exterior|falls from|names (triangle|vertex|region)|not finite|must lie|"
                       r"largest residual")
OPTIONAL = {("/surface", "bodies"), ("/surface/displacement", None), ("/surface/von_mises", None), ("/surface", None),
            ("/fields", None), ("/bodies", None)}
# Of a model nearly all is held against the rest; but nothing says that two points may not coincide.
MODEL_VALUES = {("/quadrature/parameters", "first twice"), ("/surface/quadrature/parameters", "first twice"),
                ("/surface/quadrature/weights", "falling")}


def may_pass(kind, m):
    """Is this a change that no reader can see, or that is none?"""
    if m.path.startswith("/provenance") or m.name in ("big-endian", "number as big-endian"):
        return True  # the record of how a file came to be; numbers are read in any byte order
    if m.attribute:
        return (m.attribute in FREE_TEXTS and m.name in TEXT
                or m.attribute in FREE_NUMBERS and m.name in ("number", "zero", "huge")
                or m.name == "missing" and (m.path, m.attribute) in OPTIONAL)
    if m.name == "missing":
        return kind != "model" and ((m.path, None) in OPTIONAL or m.path.startswith("/time_series/"))
    if m.path == "/contact/touches" and m.name in ("none", "empty space"):
        return True  # nothing touches
    if m.path.endswith("_names") and m.name in ("one short", "none"):
        return kind == "series"  # a group that no name leads to is not looked at
    if m.path.endswith("/regions"):
        return m.name == "one more"
    if kind == "model":
        return (m.path, m.name) in MODEL_VALUES
    if kind == "restart" and m.name in ("inf", "minus inf"):  # limits that nothing has reached yet
        return not m.path.startswith("/bodies") or m.path.endswith("/numbers")
    return m.name in OTHER_VALUES


class MutatedFiles(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.sound = Path(folder.name)
        (cls.sound / "part.off").write_text(CUBE)
        (cls.sound / "run.toml").write_text(RUN)
        for command in ([IGAPREP, "part.off", "--degree", "1", "--spans", "2"],
                        [IGASOLVE, "eigen", "part.h5", *STEEL, "-o", "modes.h5"]):
            subprocess.run([str(word) for word in command], cwd=cls.sound, check=True, capture_output=True)
        run = subprocess.Popen([str(IGASOLVE), "explicit", "run.toml", "-o", "out.h5"], cwd=cls.sound,
                               stderr=subprocess.PIPE, text=True)
        next(line for line in run.stderr if line.startswith("stepping"))
        run.send_signal(signal.SIGTERM)
        run.communicate(timeout=60)
        (cls.sound / "run.toml").write_text(RUN + "max_steps = 1\n")

    def fault(self, kind, mutation, name, command):
        """What is wrong with the answer to one mutation; nothing where all is well, None where nothing was changed."""
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            shutil.copytree(self.sound, folder, dirs_exist_ok=True)
            shutil.copyfile(self.sound / name, folder / "sound.h5")
            with h5py.File(folder / name, "r+") as file:
                if not mutation.apply(file):
                    return None
            run = subprocess.Popen([str(IGASOLVE), *command], cwd=folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True, errors="replace", preexec_fn=limits)
            try:
                words = run.communicate(timeout=3 * SECONDS)[1]
            except subprocess.TimeoutExpired:
                run.kill()
                run.communicate()
                return f"{mutation}: hangs"
            return "".join(f"{mutation}: {fault}: {words[-400:]}\n"
                           for fault in self.faults(kind, mutation, name, run.returncode, words))

    @staticmethod
    def faults(kind, mutation, name, code, words):
        if code not in (0, 2, 3, 4) or "fault of the program" in words:
            yield f"exit code {code}"
        elif "out of memory" in words:
            yield "asks for all memory"
        elif code in (2, 3):
            if name not in words:
                yield "the file is not named"
            if not EXPLAINED.search(words):
                yield "it is not said what was expected"
        elif not may_pass(kind, mutation):
            yield "accepted"

    def attack(self, kind, name, command):
        mutations = mutations_of(self.sound / name)
        if not ALL:
            mutations = random.Random(11).sample(mutations, SAMPLE)
        with ThreadPoolExecutor(2) as pool:
            found = [f for f in pool.map(lambda m: self.fault(kind, m, name, command), mutations) if f is not None]
        faults = [f for f in found if f]
        print(f"{kind}: {len(found)} mutations, {len(faults)} faults", flush=True)
        self.assertEqual(faults, [], "\n" + "".join(faults))

    def test_models(self):
        self.attack("model", "part.h5", ["check", "part.h5"])

    def test_modes(self):
        self.attack("results", "modes.h5", ["check", "modes.h5"])

    def test_series(self):
        self.attack("series", "out.h5", ["check", "out.h5"])

    def test_restart_files(self):
        self.attack("restart", "out_restart.h5", ["explicit", "run.toml", "-o", "out.h5", "--restart", "--quiet"])


    def test_files_without_checksums(self):
        """h5py writes superblock 0 unless told otherwise: models are read, files that only igasolve writes are refused."""
        for name, code, command in (("part.h5", 0, ["check", "part.h5"]), ("modes.h5", 3, ["check", "modes.h5"]),
                                    ("out_restart.h5", 3, ["explicit", "run.toml", "-o", "out.h5", "--restart"])):
            with tempfile.TemporaryDirectory() as folder:
                shutil.copytree(self.sound, folder, dirs_exist_ok=True)
                with h5py.File(self.sound / name) as old, h5py.File(Path(folder) / name, "w") as new:
                    for key in old:
                        old.copy(key, new)
                    for key, value in old.attrs.items():
                        new.attrs[key] = value
                done = subprocess.run([str(IGASOLVE), *command], cwd=folder, capture_output=True, text=True, timeout=60)
                self.assertEqual(done.returncode, code, done.stderr)
                if code:
                    self.assertRegex(done.stderr, f"{name}: /: has an HDF5 superblock of version 0, expected 2 or 3")


def limits():
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))
    resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))


if __name__ == "__main__":
    unittest.main(argv=[argument for argument in sys.argv[:1] + sys.argv[4:] if argument != "--all"])
