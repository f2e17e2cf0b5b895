"""What a program prints with --help, taken apart: the one source of its manual page and its completion in the shell.

Reads the two forms there are: CLI11's (igaprep, igasolve, igaprep-cad) and argparse's (iga).
"""
import os
import re
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

CLI11_COLUMN = 30  # where CLI11 begins to explain an option


@dataclass
class Entry:
    """An option, an argument or a command: its names, what follows it, and what it means."""

    names: list
    value: str
    text: str

    @property
    def choices(self):
        """Words that may follow, where the help lists all: {1,2,3}."""
        found = re.fullmatch(r"\{(.+)\}", self.value)
        return found[1].split(",") if found else []


@dataclass
class Command:
    """A program or one of its commands."""

    name: str  # "igasolve eigen"
    description: str = ""
    usage: str = ""
    arguments: list = field(default_factory=list)  # of Entry
    options: list = field(default_factory=list)  # of (heading, list of Entry)
    notes: str = ""  # examples and all else that follows the options
    commands: list = field(default_factory=list)  # of Command

    def every_option(self):
        return [entry for _, entries in self.options for entry in entries]


def printed(program, words):
    """The help of a program, in lines as long as they want to be."""
    run = subprocess.run([*program, *words, "--help"], capture_output=True, text=True,
                         env={**os.environ, "COLUMNS": "1000", "LC_ALL": "C.UTF-8"})
    if run.returncode != 0:
        sys.exit(f"{' '.join([*program, *words])} --help ends with exit code {run.returncode}: {run.stderr}")
    return run.stdout


def split_names(text):
    """"-o,--output FILE" or "-o FILE, --output FILE" → names and what follows them."""
    names = re.findall(r"(?<![^\s,])--?[A-Za-z][\w-]*", text)
    value = [word.rstrip(",") for word in re.sub(r"(?<![^\s,])--?[A-Za-z][\w-]*(\{false\})?,?", " ", text).split()]
    half = len(value) // len(names) if names and value[:len(value) // len(names)] * len(names) == value else len(value)
    return names, " ".join(value[:half])


def entries_of(lines, column):
    """Entries of a section whose lines are indented; explanations begin at a column, or after two spaces."""
    entries = []
    for line in lines:
        line = re.sub(r":\w+ in \[[^]]*\]$", "", line)  # CLI11's range of a number
        if line[:column].strip() == "":
            if entries and line.strip():
                entries[-1].text = (entries[-1].text + " " + line.strip()).strip()
            continue
        at = re.match(r"\s*\S.*?(?=\s{2,}\S)|.*", line).end()
        if 0 < column <= len(line) and line[column - 1] == " ":
            at = min(at, column)
        head, text = re.sub(r" (REQUIRED|(Excludes|Needs): .*)$", "", line[:at].strip()), line[at:].strip()
        if head.startswith("-"):
            entries.append(Entry(*split_names(head), text))
        else:
            name, _, value = head.partition(" ")
            entries.append(Entry([name], value, text))
    return entries


def sections_of(text):
    """(heading, lines) of a text whose headings end with a colon; the first heading is ""."""
    sections = [("", [])]
    for line in text.splitlines():
        if re.fullmatch(r"\S[^:]*:", line):
            sections.append((line[:-1], []))
        else:
            sections[-1][1].append(line)
    return sections


def read_cli11(name, text):
    command = Command(name)
    head, _, rest = text.partition("\nUsage:")
    usage, _, rest = rest.partition("\n")
    command.description, command.usage = " ".join(head.split()), usage.strip()
    found = []  # commands
    notes = []
    for heading, lines in sections_of(rest):
        body = [line for line in lines if line.strip()]
        is_list = bool(body) and (heading in ("Positionals", "Subcommands") or body[0].startswith("  -"))
        if notes or not is_list:
            notes += ([heading + ":"] if heading else []) + (lines if heading or body else [])
            continue
        # A list ends where a line is not indented: notes that begin without a heading.
        end = next((i for i, line in enumerate(lines) if line.strip() and not line.startswith("  ")), len(lines))
        notes += lines[end:]
        entries = entries_of(lines[:end], CLI11_COLUMN)
        if heading == "Positionals":
            command.arguments = entries
        elif heading == "Subcommands":
            found = entries
        else:
            command.options.append((heading, entries))
    command.notes = "\n".join(notes).strip("\n")
    return command, found


def without_options(usage):
    """One [OPTIONS] in the place of "[-h] [--probe [NAME=]X,Y,Z] …"; what is not in brackets must be given and stays."""
    kept, depth, dropped = "", 0, False
    for i, letter in enumerate(usage):
        if letter == "[" and (depth or usage[i + 1] == "-"):
            kept += "" if dropped else "[OPTIONS]"
            depth, dropped = depth + 1, True
        elif letter == "]" and depth:
            depth -= 1
        elif not depth:
            kept += letter
    return " ".join(kept.split())


def read_argparse(name, text):
    command = Command(name)
    usage, _, rest = text.removeprefix("usage: ").partition("\n\n")
    command.usage = without_options(" ".join(usage.split()))
    found, description = [], []
    for heading, lines in sections_of(rest):
        is_options = next((line for line in lines if line.strip()), "").startswith("  -")
        if heading != "positional arguments" and not is_options:
            description += ([heading + ":"] if heading else []) + lines
            continue
        deeper = [line for line in lines if re.match(r"    \S", line)]
        if is_options:
            command.options.append((heading.capitalize(), entries_of(lines, 3)))
        elif deeper:
            found = entries_of(deeper, 5)
        else:
            command.arguments = entries_of(lines, 3)
    first, _, notes = "\n".join(description).strip().partition("\n\n")
    command.description, command.notes = " ".join(first.split()), notes.strip("\n")
    return command, found


def read_program(path):
    """The Command of a program, with all of its commands."""
    path = Path(path)
    program = [str(path)]
    if path.read_bytes()[:2] == b"#!":
        program = [sys.executable, str(path)]

    def read(words):
        text = printed(program, words).replace(f"{path.parent.name}/{path.name}", path.name)  # scripts/iga
        reader = read_argparse if text.startswith("usage: ") else read_cli11
        command, found = reader(" ".join([path.name, *words]), text)
        for entry in found:
            command.commands.append(read([*words, entry.names[0]]))
            command.commands[-1].description = entry.text or command.commands[-1].description
        return command

    return read([])
