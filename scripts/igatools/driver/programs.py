"""Runs igaprep and igasolve, says what runs and for how long, and keeps what they say."""
import json
import os
import subprocess
import sys
import time
from pathlib import Path

from igatools import ROOT


class Failed(Exception):
    """A program ended with an error: its message and exit code."""

    def __init__(self, message, code):
        super().__init__(message)
        self.code = code


class Programs:
    """The two programs, with a log of every command."""

    def __init__(self, folder, quiet, binaries=None):
        self.binaries = Path(binaries) if binaries else self.find()
        self.quiet = quiet
        self.log = open(folder / "log.txt", "a")
        self.peak_memory_mib = 0.0

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

    def say(self, text):
        if not self.quiet:
            print(text, file=sys.stderr, flush=True)

    def run(self, program, *words):
        """The object that the program prints with --json, with the seconds that it took under "wall_seconds"."""
        command = [str(self.binaries / program), *map(str, words), "--json"]
        self.log.write(" ".join(command) + "\n")
        self.log.flush()
        begin = time.monotonic()
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            out, err = process.communicate()
        except KeyboardInterrupt:
            process.wait()
            raise
        self.log.write(err)
        self.log.flush()
        if process.returncode != 0:
            message = [line for line in err.splitlines() if ": error: " in line] or err.splitlines()[-1:] or ["no output"]
            raise Failed(message[0], process.returncode)
        found = json.loads(out)
        found["wall_seconds"] = time.monotonic() - begin
        self.peak_memory_mib = max(self.peak_memory_mib, found.get("peak_memory_mib", 0.0))
        return found


def free_memory_gib():
    """Memory that this machine can still give."""
    for line in Path("/proc/meminfo").read_text().splitlines():
        if line.startswith("MemAvailable:"):
            return int(line.split()[1]) / 2**20
    return float("inf")
