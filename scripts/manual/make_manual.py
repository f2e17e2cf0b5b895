#!/usr/bin/python3
"""Writes manual pages and completions for bash from what programs print with --help.

  scripts/manual/make_manual.py --output folder --version 0.1.0 build/release/bin/igaprep scripts/iga …

Leaves folder/man1/<program>.1, the same packed (.1.gz), and folder/completions/<program>.
"""
import argparse
import gzip
from pathlib import Path

from completion import bash_completion
from help_text import read_program
from man_page import man_page


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("programs", type=Path, nargs="+", metavar="program")
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder")
    parser.add_argument("--version", required=True, help="of the programs")
    arguments = parser.parse_args()
    pages, completions = arguments.output / "man1", arguments.output / "completions"
    for folder in (pages, completions):
        folder.mkdir(parents=True, exist_ok=True)
    names = [path.name for path in arguments.programs]
    for path in arguments.programs:
        program = read_program(path)
        others = [name for name in names if name != path.name]
        page = man_page(program, arguments.version, others)
        (pages / f"{path.name}.1").write_text(page)
        (pages / f"{path.name}.1.gz").write_bytes(gzip.compress(page.encode(), mtime=0))
        (completions / path.name).write_text(bash_completion(program))


if __name__ == "__main__":
    main()
