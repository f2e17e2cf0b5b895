#!/usr/bin/python3
"""Faults around files, for both tools: inputs are never replaced, old files stay whole, nothing is left behind, and each
fault has a message and its documented exit code.
usage: files_test.py SOURCE_DIR IGAPREP IGASOLVE"""
import os
import random
import re
import resource
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "scripts"))
from parts import write_boxes  # noqa: E402

SOURCE, IGAPREP, IGASOLVE = (Path(argument) for argument in sys.argv[1:4])
DOCUMENTED = {0, 2, 4, 129, 130, 131, 141, 143}
PREP = ["--degree", "1", "--spans", "4"]
STEEL = ["--E", "210", "--nu", "0.3", "--rho", "1", "--modes", "2"]
RUN = """
[[bodies]]
name = "block"
model = "part.h5"
velocity = [0, 0, -0.1]
material = { law = "neo-hookean", E = 1, nu = 0.2, rho = 1 }
[[rigid_bodies]]
name = "tool"
shape = "stl"
file = "tool.stl"
centre = [0.5, 0.5, -2]
[[rigid_bodies]]
name = "ram"
shape = "sphere"
radius = 0.1
centre = [5, 5, 5]
[rigid_bodies.drive]
z = "ram.csv"
[[contacts]]
bodies = ["block", "tool"]
[time]
end = END
[output]
file = "out.h5"
field_interval = 0.2
"""


class Files(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name)
        for name in ("part.stl", "tool.stl"):
            write_boxes(self.path / name, [((0, 0, 0), (1, 1, 1))])
        (self.path / "ram.csv").write_text("0,0\n100,1\n")
        (self.path / "prep.toml").write_text('input = "part.stl"\n[grid]\ndegree = 1\nspans = 4\n')
        (self.path / "run.toml").write_text(RUN.replace("END", "1"))
        (self.path / "eigen.toml").write_text('model = "part.h5"\n[material]\nE = 210\nnu = 0.3\nrho = 1\n[eigen]\nmodes = 2\n')
        self.run_tool(IGAPREP, "part.stl", *PREP, code=0)

    def run_tool(self, tool, *arguments, code=None, **options):
        done = subprocess.run([str(tool), *map(str, arguments)], cwd=self.path, capture_output=True, text=True,
                              timeout=120, **options)
        if code is not None:
            self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}{done.stderr}")
        return done

    def shell(self, line):
        """The line with $IGAPREP and $IGASOLVE; stderr of the whole is returned."""
        return subprocess.run(["bash", "-c", line], cwd=self.path, capture_output=True, text=True, timeout=120,
                              env={**os.environ, "IGAPREP": str(IGAPREP), "IGASOLVE": str(IGASOLVE)})

    def expect_nothing_left(self, folder=None):
        left = [str(p) for p in Path(folder or self.path).rglob(".*") if "iga-tmp" in p.name]
        self.assertEqual(left, [])

    def commands(self):
        """Each command that writes, as tool, arguments and the name of its output."""
        return [(IGAPREP, ["part.stl", *PREP], "new.h5"),
                (IGASOLVE, ["eigen", "part.h5", *STEEL], "modes.h5"),
                (IGASOLVE, ["explicit", "run.toml"], "run.h5")]

    # ---- inputs -------------------------------------------------------------------------------------------------

    def spellings(self, name):
        """Ways to name the same file."""
        (self.path / "sub").mkdir(exist_ok=True)
        for link in ("symbolic.h5", "hard.h5", "chain.h5"):
            (self.path / link).unlink(missing_ok=True)
        (self.path / "symbolic.h5").symlink_to(name)
        (self.path / "chain.h5").symlink_to("symbolic.h5")
        os.link(self.path / name, self.path / "hard.h5")
        return [name, f"./{name}", f"sub/../{name}", str(self.path / name), "symbolic.h5", "chain.h5", "hard.h5"]

    def test_force_never_replaces_an_input(self):
        cases = [(IGAPREP, ["part.stl", *PREP], "part.stl"),
                 (IGAPREP, ["prep.toml"], "part.stl"),
                 (IGAPREP, ["prep.toml"], "prep.toml"),
                 (IGASOLVE, ["eigen", "part.h5", *STEEL], "part.h5"),
                 (IGASOLVE, ["eigen", "eigen.toml"], "part.h5"),
                 (IGASOLVE, ["eigen", "eigen.toml"], "eigen.toml"),
                 (IGASOLVE, ["explicit", "run.toml"], "run.toml"),
                 (IGASOLVE, ["explicit", "run.toml"], "part.h5"),
                 (IGASOLVE, ["explicit", "run.toml"], "tool.stl"),
                 (IGASOLVE, ["explicit", "run.toml"], "ram.csv")]
        for tool, arguments, name in cases:
            before = (self.path / name).read_bytes()
            for spelling in self.spellings(name):
                with self.subTest(arguments=arguments, output=spelling):
                    done = self.run_tool(tool, *arguments, "-o", spelling, "--force", code=2)
                    self.assertIn("never replaced", done.stderr)
                    self.assertEqual((self.path / name).read_bytes(), before)
        self.expect_nothing_left()

    def test_side_files_replace_no_input(self):
        model = (self.path / "part.h5").read_bytes()
        for name in ("x_restart.h5", "x.pvd"):  # beside -o x.h5
            shutil.copyfile(self.path / "part.h5", self.path / name)
            (self.path / "side.toml").write_text(RUN.replace("END", "1").replace("part.h5", name))
            done = self.run_tool(IGASOLVE, "explicit", "side.toml", "-o", "x.h5", "--force", code=2)
            self.assertIn("never replaced", done.stderr)
            self.assertEqual((self.path / name).read_bytes(), model)
            (self.path / name).unlink()
        for folder in ("x_vtp", "x_fields"):
            (self.path / folder).mkdir()
            (self.path / folder / "x_0001.vtp").symlink_to(self.path / "part.h5")
            done = self.run_tool(IGASOLVE, "explicit", "run.toml", "-o", "x.h5", "--force", code=2)
            self.assertIn("lies in the folder", done.stderr)
            self.assertEqual((self.path / "part.h5").read_bytes(), model)
            shutil.rmtree(self.path / folder)
        done = self.run_tool(IGASOLVE, "eigen", "part.h5", *STEEL, "-o", "modes.pvd", code=2)
        self.assertFalse((self.path / "modes.pvd").exists())

    def test_a_foreign_restart_file_stays(self):
        (self.path / "run_restart.h5").write_text("of another day")
        done = self.run_tool(IGASOLVE, "explicit", "run.toml", "-o", "run.h5", code=2)
        self.assertIn("run_restart.h5", done.stderr)
        self.assertEqual((self.path / "run_restart.h5").read_text(), "of another day")

    # ---- outputs that cannot be written -------------------------------------------------------------------------

    def test_outputs_that_cannot_be(self):
        os.mkdir(self.path / "folder.h5")
        (self.path / "loop.h5").symlink_to("loop.h5")
        for tool, arguments, _ in self.commands():
            for output in ("/dev/full", "folder.h5", "missing/out.h5", "/proc/out.h5", "loop.h5", "n" * 300 + ".h5"):
                with self.subTest(arguments=arguments, output=output):
                    done = self.run_tool(tool, *arguments, "-o", output, "--force", code=2)
                    self.assertIn("error: ", done.stderr)
                    # of missing/out.h5 the folder is named; explicit runs name any of their outputs
                    self.assertIn("missing" if "missing" in output else output[:200], done.stderr)
        self.expect_nothing_left()

    def test_long_names(self):
        name = "n" * 240 + ".h5"
        self.run_tool(IGAPREP, "part.stl", *PREP, "-o", name, code=0)
        self.assertTrue((self.path / name).exists())

    def test_a_folder_that_only_can_be_read(self):
        if os.geteuid() == 0:
            self.skipTest("root may write everywhere")
        shut = self.path / "shut"
        shut.mkdir(mode=0o555)
        for tool, arguments, output in self.commands():
            self.assertIn("shut", self.run_tool(tool, *arguments, "-o", shut / output, code=2).stderr)

    def test_full_disks_leave_old_files_whole(self):
        """Files longer than a limit fail as on a full disk, at each place of the file."""
        for tool, arguments, output in self.commands():
            self.run_tool(tool, *arguments, "-o", output, code=0)
            old = (self.path / output).read_bytes()
            for size in (0, 1, 4096, len(old) // 2, len(old) - 1):
                limit = lambda size=size: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))  # noqa: E731
                done = self.run_tool(tool, *arguments, "-o", output, "--force", "--quiet", code=2, preexec_fn=limit)
                self.assertIn("nothing was changed", done.stderr)
                self.assertEqual((self.path / output).read_bytes(), old)
                self.expect_nothing_left()

    def test_a_full_small_file_system(self):
        disk = self.path / "disk"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], capture_output=True)
        if mounted.returncode != 0:
            self.skipTest("no file system can be mounted here")
        try:
            (disk / "old").write_bytes(b"x" * 50000)
            for tool, arguments, output in self.commands():
                done = self.run_tool(tool, *arguments, "-o", disk / output, code=2)
                self.assertIn("No space left on device", done.stderr)
                self.assertFalse((disk / output).exists())
                self.expect_nothing_left(disk)
                shutil.rmtree(disk / "run_fields", ignore_errors=True)
        finally:
            subprocess.run(["umount", disk], check=True)

    # ---- standard streams ---------------------------------------------------------------------------------------

    def test_closed_and_full_streams(self):
        prep, info, eigen = "$IGAPREP part.stl --degree 1 --spans 4 --force -o s.h5", "$IGASOLVE info part.h5", \
            f"$IGASOLVE eigen part.h5 {' '.join(STEEL)} --force -o s.h5"
        for command in (prep, info, eigen):
            for streams, code in (("2>&-", 0), ("2>/dev/full", 0), ("<&-", 0), ("<&- 2>&-", 0), (">/dev/full", 2),
                                  (">&-", 2), ("<&- >&- 2>&-", 2)):
                with self.subTest(command=command, streams=streams):
                    done = self.shell(f"{command} {streams}")
                    self.assertEqual(done.returncode, code, done.stderr)
                    if code == 2 and "2>" not in streams:
                        self.assertIn("standard output", done.stderr)
                    if command != info:
                        with h5py.File(self.path / "s.h5", "r") as file:
                            self.assertIn("format", file.attrs)
        for tool in ("$IGAPREP", "$IGASOLVE"):
            self.assertEqual(self.shell(f"{tool} --help >/dev/full").returncode, 2)
        self.expect_nothing_left()

    def test_pipes_whose_reader_goes(self):
        for command in ("$IGASOLVE info part.h5", "$IGAPREP part.stl --degree 1 --spans 4 --force -o s.h5",
                        f"$IGASOLVE eigen part.h5 {' '.join(STEEL)} --force -o s.h5"):
            done = self.shell(f"{command} 2>err | true; echo ${{PIPESTATUS[0]}}")
            self.assertIn(int(done.stdout), (0, 141), done.stderr)
            self.assertNotIn("error", (self.path / "err").read_text())
            done = self.shell(f"{command} 2>&1 >/dev/null | true; echo ${{PIPESTATUS[0]}}")
            self.assertEqual(int(done.stdout), 0, "a message that nobody reads ends no run")
        self.expect_nothing_left()

    # ---- signals ------------------------------------------------------------------------------------------------

    def start(self, tool, *arguments, **options):
        return subprocess.Popen([str(tool), *map(str, arguments)], cwd=self.path, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, **options)

    def long_run(self):
        (self.path / "long.toml").write_text(RUN.replace("END", "1000"))
        return ["explicit", "long.toml", "-o", "long.h5", "--force"]

    def started(self, process):
        for line in process.stderr:
            if line.startswith("stepping"):
                return
        self.fail("the run ended early")

    def test_signals_end_a_run_with_its_state(self):
        for sign, code in ((signal.SIGHUP, 129), (signal.SIGINT, 130), (signal.SIGQUIT, 131), (signal.SIGTERM, 143)):
            process = self.start(IGASOLVE, *self.long_run())
            self.started(process)
            process.send_signal(sign)
            process.send_signal(sign)  # as a terminal that closes does
            words = process.communicate(timeout=60)[1]
            self.assertEqual(process.returncode, code, words)
            self.assertIn("--restart", words)
            self.assertTrue((self.path / "long_restart.h5").exists())
            self.expect_nothing_left()

    def test_nohup(self):
        process = self.start(IGASOLVE, *self.long_run(), preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        self.started(process)
        process.send_signal(signal.SIGHUP)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        process.terminate()
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 143)

    def test_signals_at_random_times_leave_old_files(self):
        choose = random.Random(11)
        for tool, arguments, output in self.commands():
            begin = time.monotonic()
            self.run_tool(tool, *arguments, "-o", output, code=0)
            duration = time.monotonic() - begin
            for sign in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM) * 2:
                process = self.start(tool, *arguments, "-o", output, "--force")
                time.sleep(choose.uniform(0.02, 1.1 * duration))
                process.send_signal(sign)
                words = process.communicate(timeout=60)[1]
                self.assertIn(process.returncode, (0, 128 + sign, -sign), words)
                with h5py.File(self.path / output, "r") as file:
                    self.assertIn("format", file.attrs)
                self.expect_nothing_left()

    def test_killed_runs_are_cleared_by_the_next(self):
        choose = random.Random(12)
        for tool, arguments, output in self.commands():
            for _ in range(6):
                process = self.start(tool, *arguments, "-o", output, "--force")
                time.sleep(choose.uniform(0, 0.3))
                process.kill()
                process.communicate()
                left = [p.name for p in self.path.rglob(".*") if f"-{process.pid}-" in p.name]
                self.assertLessEqual(len(left), 1 + os.cpu_count(),
                                     f"the mark of the run, and files that its threads were writing: {left}")
            self.run_tool(tool, *arguments, "-o", output, "--force", code=0)
            self.expect_nothing_left()

    # ---- several processes --------------------------------------------------------------------------------------

    def test_two_runs_on_one_output(self):
        first = self.start(IGASOLVE, *self.long_run())
        self.started(first)
        second = self.run_tool(IGASOLVE, *self.long_run(), code=2)
        self.assertIn(f"another run (process {first.pid}) is writing this file", second.stderr)
        first.terminate()
        first.communicate(timeout=60)
        self.assertEqual(first.returncode, 143)
        runs = [self.start(IGAPREP, "part.stl", *PREP, "-o", "both.h5", "--force") for _ in range(4)]
        codes = []
        for run in runs:
            words = run.communicate(timeout=60)[1]
            codes.append(run.returncode)
            self.assertIn(run.returncode, (0, 2), words)
            if run.returncode == 2:
                self.assertIn("another run", words)
        self.run_tool(IGASOLVE, "check", "both.h5" if 0 in codes else "part.h5", code=0)
        self.expect_nothing_left()

    def test_a_mark_from_another_machine_is_named(self):
        mark = self.path / ".new.h5.iga-tmp-other-machine-77-1234-abcdef"
        mark.touch()
        done = self.run_tool(IGAPREP, "part.stl", *PREP, "-o", "new.h5", code=2)
        self.assertIn(mark.name, done.stderr)
        mark.rename(self.path / f".new.h5.iga-tmp-{socket.gethostname()[:60]}-{2**22 + 1}-1234-abcdef")
        self.run_tool(IGAPREP, "part.stl", *PREP, "-o", "new.h5", code=0)
        self.expect_nothing_left()

    def test_a_model_open_elsewhere(self):
        with h5py.File(self.path / "part.h5", "r+", libver="latest") as file:
            file.flush()
            done = self.run_tool(IGASOLVE, "info", "part.h5", code=2)
        self.assertIn("open for writing", done.stderr)
        self.assertNotIn("damaged", done.stderr)
        self.run_tool(IGASOLVE, "info", "part.h5", code=0)

    # ---- memory -------------------------------------------------------------------------------------------------

    def test_little_memory(self):
        """At ten limits of address space each command ends, in time, with its result or with words about memory."""
        (self.path / "static.toml").write_text('model = "part.h5"\nmaterial = { E = 210, nu = 0.3 }\n[[support]]\nplane = '
                                               "{ point = [0, 0, 0], normal = [0, 0, 1] }\n[[load]]\nbody_force = [0, 0, 1]\n")
        commands = [*self.commands(), (IGASOLVE, ["static", "static.toml"], "static.h5"),
                    (IGASOLVE, ["check", "part.h5"], None), (IGASOLVE, ["info", "part.h5"], None)]
        for tool, arguments, output in commands:
            for mib in (60, 80, 97, 110, 150, 200, 300, 500, 1000, 4000):
                limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (mib << 20, mib << 20))  # noqa: E731
                target = ["-o", output, "--force"] if output else []
                with self.subTest(arguments=arguments, mib=mib):
                    done = self.run_tool(tool, *arguments, *target, preexec_fn=limit)
                    if "error while loading shared libraries" in done.stderr or \
                            done.returncode == 130 and "blas_thread_init" in done.stderr:
                        continue  # the program could not even be loaded
                    self.assertIn(done.returncode, (0, 2), done.stderr)
                    if done.returncode == 2:
                        self.assertIn("memory", done.stderr)
                        self.assertNotIn("damaged", done.stderr)
                    self.expect_nothing_left()

    def test_the_need_is_told_before(self):
        """What info estimates is what an analysis takes, within a factor of 1.5."""
        self.run_tool(IGAPREP, "part.stl", "--degree", "2", "--spans", "12", "-o", "larger.h5", code=0)
        told = re.search(r"eigen needs about ([0-9.]+) GiB", self.run_tool(IGASOLVE, "info", "larger.h5", code=0).stdout)
        process = self.start(IGASOLVE, "eigen", "larger.h5", *STEEL[:-1], "10", "--quiet")
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        process.communicate()
        self.assertEqual(process.returncode, 0)
        ratio = usage.ru_maxrss / 2**20 / float(told.group(1))
        self.assertTrue(1 / 1.5 < ratio < 1.5, f"took {ratio:.2f} times what was told")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[4:])
