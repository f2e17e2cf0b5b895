"""Holds HDF5 files against the tables in schema/: what their readers and the tests share. h5py alone."""
import argparse
import ast
import json
import operator
import sys
import tomllib
from pathlib import Path

import h5py

from igatools import ROOT

# Where pip has installed the package, the schema is a part of it.
FOLDER = next(folder for folder in (Path(__file__).parent / "schema", ROOT / "schema") if folder.is_dir())
COMPRESS_ABOVE = 64 * 1024  # bytes


class FormatError(Exception):
    """The file breaks the schema."""


def load(name):
    """The table of schema/<name>.toml."""
    return tomllib.loads((FOLDER / f"{name}.toml").read_text())


def _evaluate(expression, symbols):
    """Value of a sum and product of numbers and symbols."""
    operators = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul}

    def value(node):
        if isinstance(node, ast.BinOp):
            return operators[type(node.op)](value(node.left), value(node.right))
        return node.value if isinstance(node, ast.Constant) else symbols[node.id]

    return value(ast.parse(expression, mode="eval").body)


def _dtype_name(dtype):
    if h5py.check_string_dtype(dtype) is not None:
        return "string"
    if h5py.check_enum_dtype(dtype) is not None:
        return "enum"
    return f"{dtype.kind}{8 * dtype.itemsize}"


def text_of(value):
    """An attribute or an entry of strings as str, whichever way it is stored."""
    return value.decode("utf-8") if isinstance(value, bytes) else str(value)


def _expect_shape(path, expressions, found, symbols):
    if len(found) != len(expressions):
        raise FormatError(f"{path}: has shape {found}, expected {len(expressions)} extents ({', '.join(expressions)})")
    for expression, extent in zip(expressions, found):
        if expression.isidentifier() and expression not in symbols:
            symbols[expression] = extent
        expected = _evaluate(expression, symbols)
        if extent != expected:
            raise FormatError(f"{path}: has shape {found}, expected ({', '.join(expressions)}) with {expression} = {expected}")


def _check_attribute(file, entry, symbols):
    path = f"{entry['object']} attribute {entry['name']}"
    attributes = file[entry["object"]].attrs
    if entry["name"] not in attributes:
        if entry["required"]:
            raise FormatError(f"{path}: is missing")
        return
    attribute = attributes.get_id(entry["name"])
    dtype = _dtype_name(attribute.dtype)
    if dtype != entry["dtype"]:
        raise FormatError(f"{path}: holds {dtype}, expected {entry['dtype']}")
    _expect_shape(path, entry["shape"], attribute.shape, symbols)


def _check_dataset(file, entry, schema, symbols):
    path = entry["path"]
    if path not in file:
        too_long = "required_up_to" in entry and _evaluate(entry["shape"][0], symbols) > entry["required_up_to"]
        if _is_required(entry, file) and not too_long:
            raise FormatError(f"{path}: is missing")
        return
    dataset = file[path]
    if not isinstance(dataset, h5py.Dataset):
        raise FormatError(f"{path}: is a group, expected a dataset")
    dtype = _dtype_name(dataset.dtype)
    if dtype != entry["dtype"]:
        raise FormatError(f"{path}: holds {dtype}, expected {entry['dtype']}")
    if dtype == "enum" and h5py.check_enum_dtype(dataset.dtype) != schema["enum"][entry["enum"]]:
        raise FormatError(f"{path}: names {h5py.check_enum_dtype(dataset.dtype)}, expected {schema['enum'][entry['enum']]}")
    _expect_shape(path, entry["shape"], dataset.shape, symbols)


def _expanded(entry, key, file):
    """The entry once for every group that <name> in its path stands for."""
    before, sign, after = entry[key].partition("<name>")
    if not sign:
        return [entry]
    group = file.get(before.rstrip("/"))
    names = group.keys() if isinstance(group, h5py.Group) else []
    # In a shape <name> stands for the number: sizes may differ from group to group.
    return [{**entry, key: before + name + after,
             **({"shape": [extent.replace("<name>", f"_{number}") for extent in entry["shape"]]} if "shape" in entry else {})}
            for number, name in enumerate(names) if isinstance(group[name], h5py.Group)]


def entries(schema, file):
    """Groups, attributes and datasets of the table, with names in the place of <name>."""
    return {kind: [one for entry in schema[kind] for one in _expanded(entry, key, file)]
            for kind, key in (("group", "path"), ("attribute", "object"), ("dataset", "path"))}


def _is_required(entry, file):
    return entry["required"] and ("with" not in entry or entry["with"] in file)


def validate(file, schema, made_by=None):
    """Holds an open file against a table; returns the symbols' values. Raises FormatError. `made_by`: the program that is to
    make a file of an older major version again."""
    found = text_of(file.attrs.get("format", "")), text_of(file.attrs.get("format_version", ""))
    major, its_major = (version.split(".")[0] for version in (schema["format_version"], found[1]))
    if found[0] == schema["format"] and made_by and its_major.isdigit() and int(its_major) < int(major):
        raise FormatError(f"/ attribute format_version: is {found[1]!r}, expected {major}.x: made by an older {made_by} (format "
                          f"{its_major}.x); make the model again with {made_by}")
    if found[0] != schema["format"] or its_major != major:
        raise FormatError(f"/: format {found[0]!r} and format_version {found[1]!r}, "
                          f"expected {schema['format']!r} and {major}.x")
    table = entries(schema, file)
    absent = []
    for group in table["group"]:
        if group["path"] not in file:
            if _is_required(group, file):
                raise FormatError(f"{group['path']}: is missing; expected a group")
            absent.append(group["path"])
    symbols = {}
    for entry in table["attribute"]:
        if entry["object"] not in absent:
            _check_attribute(file, entry, symbols)
    for name, source in schema["symbols"].items():
        symbols[name] = int(file[source["object"]].attrs[source["attribute"]][source["index"]])
    for entry in table["dataset"]:
        if entry["path"].rpartition("/")[0] not in absent:
            _check_dataset(file, entry, schema, symbols)
    return symbols


def validate_storage(file, schema):
    """What a writer owes beyond a reader's needs: texts on every dataset, checksums, compression, nothing unlisted."""
    table = entries(schema, file)
    listed = {entry["path"]: entry for entry in table["dataset"]}
    groups = {entry["path"] for entry in table["group"]}
    attributes = {(entry["object"], entry["name"]) for entry in table["attribute"]}

    def visit(name, item):
        path = "/" + name
        names = set(item.attrs) - {name for owner, name in attributes if owner == path} - {"description"}
        if isinstance(item, h5py.Group):
            if path not in groups or not item.attrs.get("description"):
                raise FormatError(f"{path}: is not in the schema or has no description")
        else:
            names -= {"unit", "order"}
            entry = listed.get(path)
            if entry is None:
                raise FormatError(f"{path}: is not in the schema")
            for key in ("unit", "order"):
                if text_of(item.attrs.get(key, "")) != entry[key]:
                    raise FormatError(f"{path} attribute {key}: is {item.attrs.get(key)!r}, expected {entry[key]!r}")
            if not text_of(item.attrs.get("description", "")):
                raise FormatError(f"{path}: has no description")
            if item.chunks is None or not item.fletcher32:
                raise FormatError(f"{path}: is not chunked with a Fletcher-32 checksum")
            packed = item.compression == "gzip" and item.shuffle
            if item.size * item.dtype.itemsize > COMPRESS_ABOVE and not packed:
                raise FormatError(f"{path}: is larger than 64 KiB and not compressed")
        if names:
            raise FormatError(f"{path}: has attributes beyond the schema: {sorted(names)}")

    file.visititems(visit)


def report(description, name, what, summary):
    """The command line of a reader: prints summary(path), or what is wrong with the file; returns the exit code."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(name, help=what)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    path = getattr(arguments, name)
    try:
        found = summary(path)
    except FormatError as error:
        print(f"{path}: {error}", file=sys.stderr)
        return 3
    except OSError as error:
        print(f"{path}: {error}", file=sys.stderr)
        return 2 if isinstance(error, FileNotFoundError) else 3
    if arguments.json:
        print(json.dumps(found))
    else:
        for key, value in found.items():
            print(f"{key:24} {value}")
    return 0
