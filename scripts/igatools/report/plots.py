"""Plots of the page as SVG: convergence over the span size, energies over time."""
import math
from dataclasses import dataclass, field
from html import escape

WIDTH, HEIGHT = 760, 420
LEFT, RIGHT, TOP, BOTTOM = 78, 18, 16, 56
MARKERS = ["M-4 0A4 4 0 1 0 4 0A4 4 0 1 0 -4 0Z", "M-4 -4H4V4H-4Z", "M0 -5L5 4H-5Z", "M0 -5.5L5.5 0L0 5.5L-5.5 0Z", "M0 5L5 -4H-5Z"]
DASHES = ["", "7 3", "2 3", "9 3 2 3", "12 4"]
ROUNDED = 0.02  # share of a tick's distance by which a curve may leave the frame
BESIDE = 22  # estimates are drawn so far to the right of their place
COLOURS = 10  # classes c0 … c9 of the style sheet


@dataclass
class Curve:
    name: str
    points: list                    # (x, y)
    estimate: tuple | None = None   # (x, y) of the error estimate that belongs to it


@dataclass
class Axis:
    label: str
    low: float
    high: float
    ticks: list = field(default_factory=list)
    is_log: bool = False
    is_reversed: bool = False

    def share(self, value):
        """0 … 1 along the axis."""
        f = math.log10 if self.is_log else float
        t = (f(value) - f(self.low)) / (f(self.high) - f(self.low))
        return 1 - t if self.is_reversed else t


def log_axis(label, values, is_reversed=False):
    """Around positive values, ticks at 1, 2, 5 of each decade, or at decades where there are many."""
    low, high = min(values) / 1.3, max(values) * 1.3
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    steps = (1, 2, 5) if math.log10(high / low) < 2.5 else (1,)
    ticks = [s * 10.0**d for d in decades for s in steps if low <= s * 10.0**d <= high]
    return Axis(label, low, high, ticks, True, is_reversed)


def linear_axis(label, values, ends_at_ticks=True):
    low, high = min(values), max(values)
    if high == low:
        low, high = low - 1, high + 1
    step = 10.0 ** math.floor(math.log10((high - low) / 4))
    step *= next((m for m in (1, 2, 5, 10) if (high - low) / (step * m) <= 8), 10)
    if not ends_at_ticks:
        ticks = range(math.ceil(low / step), math.floor(high / step) + 1)
        return Axis(label, low, high, [k * step for k in ticks])
    first, last = math.floor(low / step + ROUNDED), math.ceil(high / step - ROUNDED)
    return Axis(label, first * step, last * step, [k * step for k in range(first, last + 1)])


def spot(x_axis, y_axis, point):
    """Place of a point in the picture."""
    return (LEFT + (WIDTH - LEFT - RIGHT) * x_axis.share(point[0]),
            HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * y_axis.share(point[1]))


def words_at(x, y, words, anchor="start", kind="", turn=""):
    of_kind = f' class="{kind}"' if kind else ""
    turned = f' transform="{turn}"' if turn else ""
    return f'<text{of_kind} x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{turned}>{escape(words)}</text>'


def frame(x_axis, y_axis):
    """Grid lines, tick labels and titles of the axes."""
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    parts = []
    for tick in x_axis.ticks:
        x = spot(x_axis, y_axis, (tick, y_axis.low))[0]
        parts += [f'<path class="grid" d="M{x:.1f} {TOP}V{bottom}"/>', words_at(x, bottom + 18, f"{tick:.4g}", "middle")]
    for tick in y_axis.ticks:
        y = spot(x_axis, y_axis, (x_axis.low, tick))[1]
        parts += [f'<path class="grid" d="M{LEFT} {y:.1f}H{right}"/>', words_at(LEFT - 8, y + 4, f"{tick:.4g}", "end")]
    parts.append(f'<path class="axis" d="M{LEFT} {TOP}V{bottom}H{right}"/>')
    middle = (TOP + bottom) / 2
    parts += [words_at((LEFT + right) / 2, HEIGHT - 14, x_axis.label, "middle", "title"),
              words_at(18, middle, y_axis.label, "middle", "title", f"rotate(-90 18 {middle})")]
    return "".join(parts)


def path(points):
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)


def curve_group(number, curve, x_axis, y_axis, with_markers):
    points = [spot(x_axis, y_axis, p) for p in curve.points]
    marker = MARKERS[number % len(MARKERS)]
    parts = []
    if len(points) > 1:
        dash = DASHES[number % len(DASHES)] if not with_markers else ""
        parts.append(f'<path class="line" d="{path(points)}"' + (f' stroke-dasharray="{dash}"' if dash else "") + "/>")
    if with_markers:
        parts += [f'<path class="marker" d="{marker}" transform="translate({x:.1f} {y:.1f})"/>' for x, y in points]
    if curve.estimate:
        x, y = spot(x_axis, y_axis, curve.estimate)
        parts.append(f'<path class="estimate" d="{marker}" transform="translate({x + BESIDE:.1f} {y:.1f}) scale(1.2)"/>')
    return f'<g class="curve c{number % COLOURS}" data-curve="{number}"><title>{escape(curve.name)}</title>{"".join(parts)}</g>'


def legend(curves, with_markers):
    """A button for each curve, which brings it to the front."""
    items = []
    for number, curve in enumerate(curves):
        shape = (f'<path class="marker" d="{MARKERS[number % len(MARKERS)]}" transform="translate(14 8)"/>' if with_markers else
                 f'<path class="line" d="M0 8H28" stroke-dasharray="{DASHES[number % len(DASHES)]}"/>')
        items.append(f'<button type="button" aria-pressed="false" data-curve="{number}"><svg class="c{number % COLOURS}" '
                     f'width="28" height="16" aria-hidden="true">{shape}</svg>{escape(curve.name)}</button>')
    return f'<div class="legend" role="group" aria-label="Highlight a curve">{"".join(items)}</div>'


def figure(label, curves, x_axis, y_axis, with_markers, extra=""):
    """SVG with its legend; `label` says what is to be seen."""
    groups = "".join(curve_group(n, curve, x_axis, y_axis, with_markers) for n, curve in enumerate(curves))
    return (f'<figure class="plot"><svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(label)}">'
            f"{frame(x_axis, y_axis)}{extra}{groups}</svg>{legend(curves, with_markers)}</figure>")


def level(x_axis, y_axis, value, text):
    """A horizontal line with its name."""
    if not y_axis.low <= value <= y_axis.high:
        return ""
    y = spot(x_axis, y_axis, (x_axis.low, value))[1]
    return f'<path class="limit" d="M{LEFT} {y:.1f}H{WIDTH - RIGHT}"/>' + words_at(LEFT + 8, y - 6, text, kind="limit")


def slope(x_axis, y_axis, order, start, text):
    """A straight line of a power of x through `start`, over the range of x."""
    x0, y0 = start
    ends = []
    for x in (x_axis.low, x_axis.high):
        y = y0 * (x / x0) ** order
        if not y_axis.low <= y <= y_axis.high:
            y = min(max(y, y_axis.low), y_axis.high)
            x = x0 * (y / y0) ** (1 / order)
        ends.append((x, y))
    ends = [(min(max(x, x_axis.low), x_axis.high), y) for x, y in ends]
    points = [spot(x_axis, y_axis, end) for end in ends]
    x, y = (0.6 * a + 0.4 * b for a, b in zip(*sorted(points)))
    return f'<path class="slope" d="{path(points)}"/>' + words_at(x, y - 10, text, kind="slope")
