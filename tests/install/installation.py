"""What the tests of an installation share: running its programs on a sample that came with it."""
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path


def run(*words, cwd=None, env=None, timeout=300):
    """Output of a command; one that fails ends the test with what it said."""
    found = subprocess.run([str(word) for word in words], cwd=cwd, env=env, capture_output=True, text=True, timeout=timeout)
    if found.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, words))}: exit code {found.returncode}\n{found.stdout}{found.stderr}")
    return found.stdout


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(77)


class Installation:
    """An installation with this prefix, and a writable copy of its samples in `folder`."""

    def __init__(self, prefix, folder):
        self.prefix, self.folder = Path(prefix), Path(folder)
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        shutil.copytree(self.prefix / "share/iga-trimmed-solids/samples", self.folder / "samples")
        # Nothing but the installation and the system: no programs of the build folder.
        self.env = {**os.environ, "PATH": f"{self.prefix / 'bin'}:/usr/bin:/bin"}

    def run(self, *words):
        return run(*words, cwd=self.folder, env=self.env)

    def prepare(self, sample, model, *options):
        """Makes the model of a sample and checks it; what igaprep reports."""
        report = json.loads(self.run("igaprep", f"samples/{sample}/prep.toml", "--json", *options))
        self.run("igasolve", "check", f"samples/parts/{model}")
        return report

    def modes(self):
        """One estimate of a box's frequencies by iga: its report."""
        return json.loads(self.run("iga", "modes", "samples/parts/aligned_box.stl", "--material", "steel", "--length-unit", "mm",
                                   "--modes", 1, "--degree", 1, "--json", "--quiet"))
