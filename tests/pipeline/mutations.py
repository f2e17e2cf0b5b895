"""Ways to rewrite one dataset, attribute or group of a sound HDF5 file so that all checksums hold and the content does not.
Used by mutated_files_test.py."""
from pathlib import Path

import h5py
import numpy as np

# Other numbers of the right type and shape: where nothing else in the file says which are right, they must do no harm,
# but need not be seen.
OTHER_VALUES = {"negative", "first negative", "last zero", "middle huge", "first huge count", "falling", "ends swapped",
                "first twice", "all equal", "all plus one"}


def replace(file, path, data=None, **how):
    """The dataset anew, with its attributes."""
    attributes = dict(file[path].attrs)
    del file[path]
    made = file.create_dataset(path, data=data, **how)
    for name, value in attributes.items():
        made.attrs[name] = value


def is_numeric(dataset):
    return dataset.dtype.kind in "fiu" and dataset.size is not None and dataset.size > 0


def changed(function, kinds="fiu"):
    """Mutation by a function of the values; none where it returns None or the same again."""
    def mutate(file, path):
        old = file[path]
        if old.dtype.kind not in kinds or not old.size:
            return False
        values = np.array(old[()])
        new = function(values.copy())
        if new is None or (new.dtype == values.dtype and np.array_equal(new, values)):
            return False
        keeps_enum = h5py.check_enum_dtype(old.dtype) and new.dtype == values.dtype
        replace(file, path, new, **({"dtype": old.dtype} if keeps_enum else {}))
        return True
    return mutate


def put(where, value, kinds="fiu"):
    def function(values):
        at = {"first": 0, "middle": values.size // 2, "last": values.size - 1}[where]
        if values.dtype.kind != "f" and not np.iinfo(values.dtype).min <= value <= np.iinfo(values.dtype).max:
            return None
        values.reshape(-1)[at] = value
        return values
    return changed(function, kinds)


def swap_ends(values):
    flat = values.reshape(-1)
    flat[0], flat[-1] = flat[-1], flat[0]
    return values


def repeat_first(values):
    if values.ndim == 0 or len(values) < 2:
        return None
    values[1] = values[0]
    return values


def rows(function):
    """A function of arrays with rows, of any type."""
    return changed(lambda values: function(values) if values.ndim else None, "fiuSO")


def group_instead(file, path):
    del file[path]
    file.create_group(path)
    return True


def soft_loop(file, path):
    del file[path]
    file[path] = h5py.SoftLink(path)
    return True


def soft_link(file, path):
    file.move(path, path + "_moved")
    file[path] = h5py.SoftLink(path + "_moved")
    return True


def external_link(file, path):
    del file[path]
    file[path] = h5py.ExternalLink("sound.h5", path)
    return True


def missing(file, path):
    del file[path]
    return True


def claims(rows):
    """A size without data behind it."""
    def mutate(file, path):
        if not is_numeric(file[path]):
            return False
        replace(file, path, shape=(rows,) + file[path].shape[1:], dtype=file[path].dtype, chunks=True)
        return True
    return mutate


def chunks_of_gigabytes(file, path):
    if not is_numeric(file[path]) or file[path].ndim == 0:
        return False
    shape = file[path].shape
    replace(file, path, shape=shape, maxshape=(None,) * len(shape), dtype=file[path].dtype,
            chunks=(2**28,) + (1,) * (len(shape) - 1), compression="gzip", compression_opts=1)
    return True


def external_storage(file, path):
    if not is_numeric(file[path]):
        return False
    values, raw = np.array(file[path][()]), Path(file.filename).with_name("raw.bin")
    values.tofile(raw)
    replace(file, path, shape=values.shape, dtype=values.dtype, external=[(str(raw), 0, values.nbytes)])
    return True


def virtual(file, path):
    if not is_numeric(file[path]):
        return False
    layout = h5py.VirtualLayout(shape=file[path].shape, dtype=file[path].dtype)
    layout[...] = h5py.VirtualSource("sound.h5", path, shape=file[path].shape)
    del file[path]
    file.create_virtual_dataset(path, layout)
    return True


def compound(file, path):
    if not is_numeric(file[path]):
        return False
    both = np.zeros(file[path].shape, dtype=[("x", file[path].dtype), ("y", "f4")])
    replace(file, path, both)
    return True


def strings(file, path):
    if not is_numeric(file[path]):
        return False
    replace(file, path, np.full(file[path].shape, b"nonsense"))
    return True


def empty_space(file, path):
    if not is_numeric(file[path]):
        return False
    replace(file, path, h5py.Empty(file[path].dtype))
    return True


DATASET = {
    "negative": changed(lambda v: -np.abs(v), "fi"), "first negative": put("first", -1), "last zero": put("last", 0),
    "middle huge": put("middle", 1e300, "f"), "first huge count": put("first", 2**31 - 1),
    "NaN": put("middle", np.nan, "f"), "inf": put("last", np.inf, "f"), "minus inf": put("first", -np.inf, "f"),
    "falling": changed(lambda v: v[::-1].copy() if v.ndim else None), "ends swapped": changed(swap_ends),
    "first twice": changed(repeat_first), "all equal": changed(lambda v: np.full_like(v, v.reshape(-1)[0])),
    "all plus one": changed(lambda v: v + 1),
    "float for int": changed(lambda v: v.astype("f8"), "iu"), "int for float": changed(lambda v: np.zeros(v.shape, "i8"), "f"),
    "single precision": changed(lambda v: v.astype("f4"), "f"), "narrow": changed(lambda v: v.astype("i2"), "iu"),
    "unsigned": changed(lambda v: v.astype("u8"), "i"),
    "big-endian": changed(lambda v: v.astype(v.dtype.newbyteorder(">")), "fi"),
    "one short": rows(lambda v: v[:-1].copy()), "one more": rows(lambda v: np.concatenate([v, v[-1:]])),
    "none": rows(lambda v: v[:0].copy()), "another rank": rows(lambda v: v.reshape(v.shape + (1,))),
    "scalar": rows(lambda v: v.reshape(-1)[0:1].reshape(())),
    "transposed": changed(lambda v: v.T.copy() if v.ndim > 1 and len(set(v.shape)) > 1 else None),
    "strings": strings, "compound": compound, "empty space": empty_space, "group": group_instead,
    "soft loop": soft_loop, "soft link": soft_link, "external link": external_link, "missing": missing,
    "2^60 rows": claims(2**60), "2^40 rows": claims(2**40), "2^28 rows": claims(2**28),
    "chunks of gigabytes": chunks_of_gigabytes, "external storage": external_storage, "virtual": virtual,
}
GROUP = {"missing": missing, "soft loop": soft_loop, "external link": external_link}
ATTRIBUTE = {
    "missing": None, "string": "nonsense", "empty string": "", "number": 7.5, "NaN": np.nan, "inf": np.inf,
    "negative": -3, "zero": 0, "huge": 2**62, "list": [1.0, 2.0, 3.0],
    "three huge counts": np.array([2**39, 2**39, 2**39]), "three counts": np.array([10**6, 10**6, 10**6]),
    "compound": np.zeros(1, dtype=[("a", "f8"), ("b", "i4")]), "empty space": h5py.Empty("f8"),
    "text of 60 000 letters": "x" * 60000, "number as big-endian": np.array(5.0, dtype=">f8"),
}


class Mutation:
    """`apply(file)` rewrites an open file; False where this mutation changes nothing there."""

    def __init__(self, path, attribute, name, apply):
        self.path, self.attribute, self.name, self.apply = path, attribute, name, apply

    def __str__(self):
        return f"{self.path}{' attribute ' + self.attribute if self.attribute else ''}: {self.name}"


def attribute_mutation(path, attribute, name, value):
    def apply(file):
        if name == "missing":
            del file[path].attrs[attribute]
        else:
            file[path].attrs[attribute] = value
        return True
    return Mutation(path, attribute, name, apply)


def mutations_of(sound):
    """All of them, for every dataset, group and attribute of a file, but for the words that explain datasets."""
    found = []
    with h5py.File(sound, "r") as file:
        paths = ["/"]
        file.visit(lambda path: paths.append("/" + path))
        for path in paths:
            for attribute in sorted(file[path].attrs):
                if attribute not in ("description", "unit", "order"):
                    found += [attribute_mutation(path, attribute, *entry) for entry in ATTRIBUTE.items()]
            table = DATASET if isinstance(file[path], h5py.Dataset) else GROUP if path != "/" else {}
            found += [Mutation(path, None, name, lambda f, m=m, p=path: m(f, p)) for name, m in table.items()]
    return found
