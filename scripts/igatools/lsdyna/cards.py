"""Fixed-width cards of LS-DYNA's keyword format (standard format: fields of 10 columns where nothing else is said)."""

import textwrap

import numpy as np

# Widths of the fields of cards that differ from eight fields of 10 columns.
NODE = (8, 16, 16, 16, 8, 8)
SHELL = (8,) * 6
CURVE = (20, 20)
LARGEST_I8 = 99_999_999


class DeckError(Exception):
    """What the deck cannot hold: the user changes the run file or the model."""


def shortest(value, width):
    """A number with as many digits as fit into `width` columns, without a leading zero; real ones have a point."""
    if isinstance(value, (int, np.integer)):
        text = str(value)
        if len(text) > width:
            raise DeckError(f"number {value} does not fit into {width} columns")
        return text
    value = float(value)
    if not np.isfinite(value):
        raise DeckError(f"{value} in a card: expected a finite number")
    for plain in (repr(value), *(f"{value:.{digits}g}" for digits in range(16, 0, -1))):
        mantissa, mark, exponent = plain.partition("e")
        mantissa = (mantissa if "." in mantissa else mantissa + ".").removesuffix(
            "0" if mantissa.endswith(".0") else ""
        )
        for zero, short in (("0.", "."), ("-0.", "-.")):
            if mantissa.startswith(zero) and len(mantissa) > len(zero):
                mantissa = short + mantissa[len(zero) :]
        text = mantissa + (f"e{int(exponent)}" if mark else "")
        if len(text) <= width:
            return text
    raise DeckError(f"{value!r} does not fit into {width} columns")


def card(*values, widths=None):
    """One line. None is a blank field, a string stands as it is."""
    widths = widths or (10,) * 8
    if len(values) > len(widths):
        raise DeckError(f"{len(values)} values for a card of {len(widths)} fields")
    fields = [
        "" if value is None else value if isinstance(value, str) else shortest(value, width)
        for value, width in zip(values, widths)
    ]
    if any(len(field) > width for field, width in zip(fields, widths)):
        raise DeckError(f"a field of {fields} is wider than its columns")
    return "".join(field.rjust(width) for field, width in zip(fields, widths)).rstrip()


def number_lines(numbers):
    """Lines of eight integers of 10 columns."""
    return ["".join(f"{n:10d}" for n in numbers[k : k + 8]) for k in range(0, len(numbers), 8)]


def pair_lines(numbers, weights):
    """Lines of four pairs of an integer and a weight, 10 columns each."""
    pairs = [f"{n:10d}{_weight(w):>10}" for n, w in zip(numbers, weights)]
    return ["".join(pairs[k : k + 4]) for k in range(0, len(pairs), 4)]


def rounded_weights(weights):
    """Weights that add up to 1, as fields of 10 columns hold them: whole numbers of 1e-9 whose sum is 10^9.

    A sign and each digit before the point take one of the nine digits.
    """
    digits = np.floor(np.log10(np.maximum(abs(weights), 0.1))).astype(int) + 1  # before the point
    step = 10 ** (digits + (weights < 0))
    units = step * np.rint(weights * 1e9 / step).astype(np.int64)
    between = (units > 0) & (units < 10**9)
    units[np.argmax(np.where(between, units, 0) if between.any() else units)] += 10**9 - units.sum()
    return units


def _weight(units):
    whole, part = divmod(abs(int(units)), 10**9)
    if units < 0:
        text = f"-{whole or ''}.{part // 10:08d}"
    else:
        text = f"{whole or ''}.{part:09d}"
    return text[:10]


def wide_rows(values):
    """Lines of four numbers of 20 columns (14 digits) from values (n, 4), as one text."""
    return "\n".join(["%20.13e%20.13e%20.13e%20.13e"] * len(values)) % tuple(np.ravel(values))


def heading(text, width=70):
    """A title in one line; a comma would make it a card in free format."""
    return " ".join(text.replace(",", ";").split())[:width]


def comment_lines(text):
    """A comment in lines of 80 columns at most."""
    return ["$ " + line for line in textwrap.wrap(text, 78, subsequent_indent="  ", break_on_hyphens=False)]


class Deck:
    """Lines of a deck in the order of the keywords, and the numbers given out so far."""

    def __init__(self):
        self.lines, self.used = [], {}

    def next(self, kind, count=1):
        """First of `count` numbers of their own of nodes, elements, parts, curves, ... from 1."""
        first = self.used.get(kind, 0) + 1
        self.used[kind] = first + count - 1
        if self.used[kind] > LARGEST_I8:
            raise DeckError(
                f"{self.used[kind]} {kind}: fields of 8 columns hold {LARGEST_I8}; expected a coarser model"
            )
        return first

    def keyword(self, name, *lines):
        self.lines.append("*" + name)
        self.lines.extend(lines)

    def comment(self, text):
        self.lines.extend(comment_lines(text))

    def curve(self, points, title):
        """*DEFINE_CURVE of points (n, 2) with ascending abscissae; its number."""
        number = self.next("curves")
        self.keyword(
            "DEFINE_CURVE_TITLE",
            heading(title),
            card(number, 0, 1.0, 1.0, 0.0, 0.0, 0),
            *(card(float(x), float(y), widths=CURVE) for x, y in points),
        )
        return number
