#!/usr/bin/python3
"""Runs a program and measures wall time, CPU time and peak memory of it alone."""
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

class RunError(Exception):
    """A program ended with an error: its words and its exit code."""

    def __init__(self, message, code=1):
        super().__init__(message)
        self.code = code


WAIT = 0.25  # seconds between two calls of while_waiting
GRACE = 10   # seconds that a tool has to end

# A small process of its own starts the program: memory that the caller holds would otherwise count as the program's peak.
LAUNCHER = """
import json, resource, subprocess, sys, time
start = time.perf_counter()
code = subprocess.call(sys.argv[2:])
wall = time.perf_counter() - start
used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open(sys.argv[1], "w") as file:
    json.dump({"exit_code": code, "wall_s": wall, "cpu_s": used.ru_utime + used.ru_stime,
               "memory_mib": used.ru_maxrss / 1024}, file)
"""


def measured_run(command, log, folder=None, threads=1):
    """Exit code, wall_s, cpu_s and memory_mib of a command whose output goes to the file `log`."""
    environment = dict(os.environ)
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "CCX_NPROC_EQUATION_SOLVER", "CCX_NPROC_STIFFNESS"):
        environment[name] = str(threads)
    with tempfile.TemporaryDirectory() as scratch, open(log, "w") as output:
        answer = Path(scratch) / "measured.json"
        subprocess.run([sys.executable, "-S", "-c", LAUNCHER, answer, *map(str, command)], stdout=output,
                       stderr=subprocess.STDOUT, cwd=folder, env=environment, check=True)
        return json.loads(answer.read_text())


def last_words(log):
    lines = [line for line in Path(log).read_text(errors="replace").splitlines() if line.strip()]
    return lines[-1] if lines else "no output"


def report(command, log=None, while_waiting=None):
    """The object that a tool prints with --json. What it says on stderr goes to the open file `log`; while_waiting() is called some
    times a second. The tool does not outlive an exception here, such as that of Ctrl-C. Raises RunError with the tool's last words."""
    process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               start_new_session=True)  # Ctrl-C in a terminal reaches this process alone, which then ends the tool
    try:
        out, err = finished(process, while_waiting)
    except BaseException:
        end(process)
        raise
    if log:
        log.write(err)
        log.flush()
    if process.returncode != 0:
        raise RunError(words_of_error(Path(command[0]).name, err, process.returncode), process.returncode)
    return json.loads(out)


def words_of_error(tool, err, code):
    """What a tool says of its error, all lines of it; its last line where it does not."""
    lines = err.strip().splitlines()
    starts = [number for number, line in enumerate(lines) if ": error: " in line]
    if not starts:
        return f"{tool} ended with exit code {code}: {lines[-1] if lines else 'no output'}"
    return "\n".join(lines[starts[0]:]).replace(": error: ", ": ", 1)


def finished(process, while_waiting):
    """What a process wrote to stdout and stderr until its end."""
    while True:
        try:
            return process.communicate(timeout=WAIT if while_waiting else None)
        except subprocess.TimeoutExpired:
            while_waiting()


def end(process):
    """Asks a process to end, and makes it where it does not within some seconds."""
    process.terminate()
    try:
        process.communicate(timeout=GRACE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.communicate()


def measured_report(command, log, threads=1):
    """The measured run of a tool with --json, and the object that it prints. Raises RunError with the tool's last words."""
    measured = measured_run(command, log, None, threads)
    words = Path(log).read_text()
    if measured["exit_code"] != 0 or "{" not in words:
        raise RunError(f"{Path(command[0]).name} ended with exit code {measured['exit_code']}: {last_words(log)}")
    found, _ = json.JSONDecoder().raw_decode(words, words.index("{"))
    return measured, found
