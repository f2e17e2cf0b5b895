"""Arrays as a page holds them: base64 of little-endian numbers, real numbers as 16-bit integers with a scale."""
import base64

import numpy as np

LARGEST = 32767  # of an int16


def integers(values):
    """Whole numbers from 0, with 16 or 32 bits."""
    values = np.asarray(values)
    if values.size and values.min() < 0:
        raise ValueError(f"found {values.min()}, expected numbers from 0")
    kind = "uint16" if values.max(initial=0) < 2**16 else "uint32"
    return _packed(values, kind)


def reals(values):
    """Real numbers to 1/32767 of the largest magnitude: value = scale * integer."""
    values = np.asarray(values, float)
    if not np.isfinite(values).all():
        raise ValueError("found other than finite numbers")
    scale = float(np.abs(values).max(initial=0)) / LARGEST
    whole = np.rint(values / scale) if scale > 0 else np.zeros(values.shape)
    return _packed(whole, "int16") | {"scale": scale}


def _packed(values, kind):
    raw = np.ascontiguousarray(values).astype(np.dtype(kind).newbyteorder("<")).tobytes()
    return {"kind": kind, "shape": list(values.shape), "base64": base64.b64encode(raw).decode()}


def unpacked(array):
    """The values of integers() or reals(), as the page sees them."""
    raw = np.frombuffer(base64.b64decode(array["base64"]), np.dtype(array["kind"]).newbyteorder("<"))
    return raw.reshape(array["shape"]) * array.get("scale", 1)
