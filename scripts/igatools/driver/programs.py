"""Runs igaprep and igasolve, shows how far they are, and keeps what they say."""
import os
import shlex
import subprocess
import time
from pathlib import Path

from igatools import ROOT
from igatools.measured_run import RunError, report


class Failed(RunError):
    """What the driver itself finds wrong: a message and the exit code that goes with it."""


class Programs:
    """The two programs, with a log of every command."""

    def __init__(self, folder, progress, binaries=None):
        self.binaries = Path(binaries) if binaries else self.find()
        for name in ("igaprep", "igasolve"):
            if not (self.binaries / name).exists():
                raise Failed(f"{self.binaries} has no {name}", 2)
        self.progress = progress
        self.log = open(folder / "log.txt", "a")
        self.peak_memory_mib = 0.0
        self.deadline = float("inf")  # on the monotonic clock: no program runs beyond it

    @staticmethod
    def find():
        """In the sources' builds, in the installation that this is a part of, or on the PATH."""
        for preset in ("release", "portable"):
            if (ROOT / "build" / preset / "bin" / "igaprep").exists():
                return ROOT / "build" / preset / "bin"
        installed = [ROOT.parents[1] / "bin"] if ROOT.parent.name == "share" else []
        for folder in (*installed, *os.environ.get("PATH", "").split(os.pathsep)):
            if (Path(folder) / "igaprep").exists():
                return Path(folder)
        raise Failed("igaprep is neither built nor installed; run: cmake --preset release && cmake --build --preset release", 2)

    def identity(self, program):
        """Changes whenever the program does."""
        state = (self.binaries / program).stat()
        return f"{program} {state.st_size} {state.st_mtime_ns}"

    def version(self, program):
        done = subprocess.run([str(self.binaries / program), "--version"], capture_output=True, text=True)
        return done.stdout.strip().removeprefix(program).strip()

    def run(self, program, *words):
        """The object that the program prints with --json, with the seconds that it took under "wall_seconds"."""
        command = [str(self.binaries / program), *map(str, words), "--json"]
        self.log.write(shlex.join(command) + "\n")
        self.log.flush()
        begin = time.monotonic()
        found = report(command, self.log, self.wait)
        found["wall_seconds"] = time.monotonic() - begin
        self.peak_memory_mib = max(self.peak_memory_mib, found.get("peak_memory_mib", 0.0))
        return found

    def wait(self):
        """While a program runs."""
        self.progress.tick()
        if time.monotonic() > self.deadline:
            raise Failed("stopped, since --max-time was over for long", 4)


def free_memory_gib():
    """Memory that this machine can still give."""
    for line in Path("/proc/meminfo").read_text().splitlines():
        if line.startswith("MemAvailable:"):
            return int(line.split()[1]) / 2**20
    return float("inf")
