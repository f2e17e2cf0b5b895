"""Tables of models and results as text files (CSV): the same names and units as those of igasolve export."""
import csv
import re
from pathlib import Path

import numpy as np

from igatools.iga_schema import text_of


class Table:
    """Columns by their headings: "force_x [N]" → values (n)."""

    def __init__(self, name, reader, schema):
        self.name, self.columns = name, {}
        self.reader, self.schema = reader, schema
        self.label = reader.attribute("/", "length_unit")

    def plain(self, heading, values):
        """A column as it stands."""
        self.columns[heading] = list(values)
        return self

    def add(self, path, heading=None):
        """A dataset of the file, with its unit; nothing where the file has none."""
        if path not in self.reader.data:
            return self
        entry = next(entry for entry in self.schema["dataset"]
                     if re.fullmatch(entry["path"].replace("<name>", "[^/]+"), path))
        values, order = self.reader[path], entry["order"]
        if order.startswith("(step; vertex"):  # one row for each vertex of each step
            values, order = values.reshape(-1, *values.shape[2:]), order.replace("; vertex", "")
        return self.numbers(heading or path.rpartition("/")[2], entry["unit"], values, order)

    def numbers(self, heading, unit, values, order=""):
        """`order` names the components behind its semicolon: "(point; x y z)"."""
        unit = unit if self.label == "unspecified" else unit.replace("length", self.label, 1)
        unit = "" if unit == "1" else f" [{unit}]"
        values = np.asarray(values)
        if values.ndim == 1:
            values = [text_of(value) for value in values] if values.dtype.kind in "OS" else values
            return self.plain(heading + unit, values)
        components = order.partition(";")[2].partition(")")[0].split(",")[0].split()
        for component, column in zip(components, values.T):
            self.plain(f"{heading}_{component}{unit}", column)
        return self

    def write(self, path):
        with open(path, "w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(self.columns)
            writer.writerows(zip(*([shortest(value) for value in values] for values in self.columns.values())))


def shortest(value):
    """A number with as many digits as tell it from its neighbours; whole ones without a point."""
    if isinstance(value, float):
        return repr(int(value)) if value == int(value) and abs(value) < 1e15 else repr(float(value))
    return value


def write_tables(tables, folder, chosen=None):
    """Writes <folder>/<name>.csv for each table, or for the chosen one alone; the paths."""
    tables = list(tables)
    names = [table.name for table in tables]
    if chosen is not None and chosen not in names:
        raise ValueError(f"there is no table {chosen!r}; there are: {', '.join(names)}")
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    paths = []
    for table in tables:
        if chosen in (None, table.name):
            paths.append(folder / f"{table.name}.csv")
            table.write(paths[-1])
    return paths
