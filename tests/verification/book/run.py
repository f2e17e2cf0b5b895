"""One run of a case: a folder of its own, igaprep and igasolve in it, what they took."""
from pathlib import Path

import numpy as np

from igatools.measured_run import RunError, measured_report, measured_run
from igatools.stl import write_stl


def toml_value(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (str, Path)):
        return '"' + str(value).replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml_value(item)}" for key, item in value.items()) + " }"
    if isinstance(value, (int, np.integer)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    return "[" + ", ".join(toml_value(item) for item in np.asarray(value, object).tolist()) + "]"


def run_file(**keys):
    """Text of a run file: numbers, words and lists become keys, dictionaries [tables], lists of dictionaries [[tables]]. Empty
    lists are left out."""
    keys = {key: value for key, value in keys.items() if not (isinstance(value, (list, tuple)) and len(value) == 0)}
    is_table = lambda value: isinstance(value, dict)  # noqa: E731
    is_list = lambda value: isinstance(value, (list, tuple)) and len(value) > 0 and all(map(is_table, value))  # noqa: E731
    lines = [f"{key} = {toml_value(value)}" for key, value in keys.items() if not is_table(value) and not is_list(value)]
    for key, value in keys.items():
        for table in [value] if is_table(value) else value if is_list(value) else []:
            lines += [f"[{key}]" if is_table(value) else f"[[{key}]]",
                      *(f"{name} = {toml_value(item)}" for name, item in table.items())]
    return "\n".join(lines) + "\n"


class Run:
    """What a case's function gets. It counts the CPU seconds of all programs and keeps the unknowns of the last analysis.

    folder      of this run alone, empty at first
    programs    folder of igaprep and igasolve
    unknowns, seconds   may be set by the function where it knows better
    triangles   (n, 3, 3) of the part's surface, for its picture
    """

    def __init__(self, folder, programs, threads=1):
        self.folder, self.programs, self.threads = Path(folder).resolve(), Path(programs).resolve(), threads
        self.folder.mkdir(parents=True, exist_ok=True)
        self.unknowns, self.seconds, self.triangles = 0, 0.0, None

    def surface(self, name, triangles):
        """Writes triangles (n, 3, 3) as NAME.stl: a part, or a piece of surface for `patch = "NAME.stl"`."""
        path = self.folder / f"{name}.stl"
        write_stl(path, triangles)
        return path

    def model(self, part, span, degree=2, *options, name="part"):
        """Runs igaprep: NAME.h5 of a surface's triangles (n, 3, 3) or of a CAD or surface file. span: a number, or three; more
        flags of igaprep as `options`. Returns its report (what --json prints)."""
        if isinstance(part, np.ndarray):
            if self.triangles is None:
                self.triangles = part
            part = self.surface(name, part)
        return self._report("igaprep", part, "-o", self.folder / f"{name}.h5", "--degree", degree, "--span-size",
                            *np.atleast_1d(span), "--force", *options, log=f"{name}.igaprep")

    def solve(self, analysis, settings, *options, name="run", results=False):
        """Runs igasolve with a run file: its text, or a dictionary of its keys (run_file); without model and bodies it takes
        part.h5. Returns the report (what --json prints); with `results` that and the path of the results file."""
        if isinstance(settings, dict):
            if not {"model", "bodies"} & set(settings):
                settings = {"model": "part.h5", **settings}
            settings = run_file(**settings)
        path, file = self.folder / f"{name}.toml", self.folder / f"{name}_results.h5"
        path.write_text(settings, encoding="utf-8")
        output = ["-o", file, "--force"] if results else []
        report = self._report("igasolve", analysis, path, *output, *options, log=f"{name}.igasolve")
        self.unknowns = report.get("unknowns", self.unknowns)
        return (report, file) if results else report

    def program(self, *command, log):
        """Runs another program in the folder. Raises RunError where it fails."""
        measured = measured_run(command, self.folder / f"{log}.log", self.folder, self.threads)
        self.seconds += measured["cpu_s"]
        if measured["exit_code"] != 0:
            raise RunError(f"{Path(command[0]).name} ended with exit code {measured['exit_code']}; see {self.folder / log}.log")

    def _report(self, tool, *words, log):
        measured, found = measured_report([self.programs / tool, *words, "--json", "--threads", self.threads],
                                          self.folder / f"{log}.log", self.threads)
        self.seconds += measured["cpu_s"]
        return found


def probe(report, name):
    """The probe of this name in the report of a static run: position, displacement, strain, stress, von_mises."""
    return next(one for one in report.get("statics", report)["probes"] if one["name"] == name)


def elastic(report):
    """Frequencies of the modes that are not rigid."""
    return report["frequencies"][report["rigid_modes"]:]
