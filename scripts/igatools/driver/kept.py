"""Which files of an output folder may be used again: those that the same programs made from the same content with the same options."""
import hashlib
import json
from pathlib import Path

from igatools.whole_file import write_text


def hash_of_file(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def key_of(*parts):
    return hashlib.sha256(json.dumps([str(part) for part in parts]).encode()).hexdigest()


class Kept:
    """kept.json: for each file its key, its size and time of change, and the report of the program that made it."""

    def __init__(self, folder, may_reuse=True):
        self.folder, self.path = Path(folder), Path(folder) / "kept.json"
        self.entries = {}
        if may_reuse and self.path.exists():
            try:
                self.entries = json.loads(self.path.read_text())
            except ValueError:
                self.entries = {}  # what cannot be read is made again

    @staticmethod
    def state(path):
        found = path.stat()
        return [found.st_size, found.st_mtime_ns]

    def find(self, name, key, at_least=0):
        """The report of the program that made the file `name`, where it may be used again; else None.
        at_least: what was asked for then (such as a number of modes) must not be less."""
        entry, path = self.entries.get(name), self.folder / name
        if not entry or entry["key"] != key or entry["asked"] < at_least or not path.exists() or entry["state"] != self.state(path):
            return None
        return entry["report"]

    def keep(self, name, key, report, asked=0):
        self.entries[name] = {"key": key, "state": self.state(self.folder / name), "asked": asked, "report": report}
        write_text(self.path, json.dumps(self.entries, indent=1) + "\n")

    def forget(self, name):
        """Before a file is made anew: an interrupted run must not leave an entry beside a file that is no longer its own."""
        if self.entries.pop(name, None):
            write_text(self.path, json.dumps(self.entries, indent=1) + "\n")
