#!/usr/bin/python3
"""Holds the sources to the dependency rule: format/model <- format/io <- {preprocessor, solver}; the two tools never
include each other; HDF5 is known to one file; CGAL stays out of headers, so that one slow file does not slow all."""
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LAYERS = {  # folder: what its files may include from this repository
    "format/model": ["format/model"],
    "format/io": ["format/model", "format/io"],
    "preprocessor": ["format", "preprocessor"],
    "solver": ["format", "solver"],
    "samples": ["format", "preprocessor", "solver", "samples", "tests/support"],
    "tests": ["format", "preprocessor", "solver", "samples", "tests"],
}
# Folders of a tool in order: files include from their own folder and from those before it.
ORDER = {
    "preprocessor": ["base", "cad", "surface", "trim", "connectivity", "interior", "fit", "reduce", "quadrature", "walls",
                     "program", "cad/occt"],
    "solver": ["base", "space", "linalg", "mechanics", "multigrid", "estimate", "output", "supports", "ties", "stress", "analysis",
               "response", "report", "explicit/simd",
               "explicit/laws", "explicit/kernel", "explicit/motion", "explicit/contact", "explicit/loads",
               "explicit/run", "nonlinear", "program"],
}
# Projects of their own, which use nothing of the rest: they include what lies beside them.
OWN_PROJECTS = ("samples/dealii",)
OURS = ("format/", "preprocessor/", "solver/", "samples/", "tests/")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def wrong_order(name, target):
    """A sentence where `target` belongs to a folder that comes after that of the file `name`; else None."""
    tool = name.split("/")[0]
    if tool not in ORDER or not target.startswith(tool + "/"):
        return None
    own, other = (path[len(tool) + 1:].rpartition("/")[0] for path in (name, target))
    for folder in (own, other):
        if folder not in ORDER[tool]:
            return f"the folder {tool}/{folder} has no place in the order of scripts/checks/check_includes.py"
    if ORDER[tool].index(other) > ORDER[tool].index(own):
        return f'"{target}" belongs to a folder that comes after {tool}/{own}'
    return None


def problems_of(path, text):
    """Sentences about one source file; `path` is relative to the repository."""
    name = path.as_posix()
    alone = path.parent.as_posix() in OWN_PROJECTS
    folder = next(layer for layer in LAYERS if name.startswith(layer + "/"))
    for number, line in enumerate(text.splitlines(), 1):
        match = INCLUDE.match(line)
        if not match:
            continue
        bracket, target = match.groups()
        where = f"{name}:{number}"
        if alone:
            if bracket == '"' and not (ROOT / path.parent / target).is_file():
                yield f'{where}: "{target}" does not lie beside it; the sample uses nothing of the rest'
            continue
        if bracket == '"':
            if not target.startswith(OURS):
                yield f'{where}: "{target}" does not start at the repository\'s root'
            elif not any(target.startswith(layer + "/") for layer in LAYERS[folder]):
                yield f'{where}: {folder} may not include "{target}"'
            elif order := wrong_order(name, target):
                yield f"{where}: {order}"
        if re.match(r"(hdf5|H5\w*)\.h$", target) and name != "format/io/h5_file.cpp":
            yield f"{where}: HDF5 belongs to format/io/h5_file.cpp alone"
        if target.startswith("CGAL/"):
            if folder in ("format/model", "format/io", "solver"):
                yield f"{where}: {folder} must not know CGAL"
            if path.suffix == ".hpp" and not name.startswith(("preprocessor/surface/surface_", "samples/surface_")):
                yield f"{where}: CGAL may not appear in a header (surface_*.hpp excepted)"
        if folder == "format/model" and re.match(r"(Eigen|tbb|CLI|toml\+\+|openssl)/", target):
            yield f"{where}: format/model stands on the standard library and fmt alone"


def main():
    problems, files = [], 0
    for folder in LAYERS:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".hpp", ".cpp"):
                files += 1
                problems += problems_of(path.relative_to(ROOT), path.read_text())
    for problem in sorted(set(problems)):
        print(problem, file=sys.stderr)
    print(f"{files} files, {len(set(problems))} problems")
    return 1 if problems or files == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
