#!/usr/bin/python3
"""Every option that a program prints with --help stands in its manual page and in its completion; man prints the page
without a warning.
usage: manual_test.py MANUAL_FOLDER PROGRAM ...; exit code 77 where man is missing and all else is right"""
import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from installation import run, skip

MANUAL, PROGRAMS = Path(sys.argv[1]), [Path(path) for path in sys.argv[2:]]
HAS_MAN = shutil.which("man") is not None


def help_of(program, *words):
    interpreter = [sys.executable] if program.read_bytes()[:2] == b"#!" else []
    return run(*interpreter, program, *words, "--help", env={**os.environ, "COLUMNS": "1000"})


def options_in(text):
    """Names of options where the help lists them: lines that begin with one."""
    lists = [re.split(r"\s{2,}", line.strip())[0] for line in text.splitlines() if re.match(r"\s+-", line)]
    return {name for line in lists for name in re.findall(r"(?:^|[\s,])(--?[A-Za-z][\w-]*)", line.split(" Excludes:")[0])}


def commands_in(text):
    listed = re.search(r"(?:Subcommands:|positional arguments:\n +\S.*)\n((?: +\w.*\n)+)", text)
    return re.findall(r"^\s+([a-z]\w*)", listed[1], re.MULTILINE) if listed else []


def completed(program, *words):
    """What bash offers for the last word."""
    script = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=()\n'
              f'_{program.name.replace("-", "_")}; printf "%s\\n" "${{COMPREPLY[@]}}"')
    return set(run("bash", "-c", script, "bash", MANUAL / "completions" / program.name, program.name, *words).split())


class Manual(unittest.TestCase):
    def test_every_option_is_in_page_and_completion(self):
        for program in PROGRAMS:
            text = help_of(program)
            page = (MANUAL / "man1" / f"{program.name}.1").read_text().replace("\\-", "-")
            commands = commands_in(text)
            self.assertEqual(bool(commands), program.name in ("igasolve", "iga"), program.name)
            if commands:
                self.assertEqual(completed(program, ""), set(commands))
            for words in ([], *([command] for command in commands)):
                options = options_in(help_of(program, *words))
                self.assertIn("--help", options)
                for name in options:
                    self.assertIn(f"\\fB{name}\\fR", page, f"{program.name} {words}: {name} is not in the manual page")
                self.assertEqual(completed(program, *words, "-"), options, f"{program.name} {words}: completion")

    def test_choices_and_files(self):
        for program in PROGRAMS:
            if program.name == "iga":
                self.assertEqual(completed(program, "modes", "--degree", ""), set("1234"))
            self.assertEqual(completed(program, *commands_in(help_of(program))[:1], "part.st"), set())  # bash offers files then

    @unittest.skipUnless(HAS_MAN, "man is missing")
    def test_man_prints_the_pages(self):
        for program in PROGRAMS:
            env = {**os.environ, "LC_ALL": "C.UTF-8", "MANROFFSEQ": "", "MANWIDTH": "80"}
            shown = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", MANUAL / "man1" / f"{program.name}.1"], env=env,
                                   capture_output=True, text=True)
            self.assertEqual((shown.returncode, shown.stderr), (0, ""), program.name)
            for heading in ("NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "SEE ALSO"):
                self.assertRegex(shown.stdout, rf"(?m)^{heading}$", program.name)


if __name__ == "__main__":
    if not unittest.main(argv=sys.argv[:1], exit=False).result.wasSuccessful():
        sys.exit(1)
    if not HAS_MAN:
        skip("man is missing; apt-get install man-db")
