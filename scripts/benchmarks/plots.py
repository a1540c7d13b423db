"""Log-log plots of curves as SVG, a panel for each section: one element for each axis, curve and label, so that a page stays
small and its differences can be read."""

import math
from xml.sax.saxutils import escape

COLUMNS, WIDTH, HEIGHT = 2, 500, 320  # panels: number in a row; px
LEFT, RIGHT, TOP, BOTTOM = 46, 16, 26, 34  # px of a panel around its axes
LEGEND = 11  # px, height of a line
COLORS = ("#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b", "#e377c2", "#17becf", "#7f7f7f", "#bcbd22")


def decades(values):
    """(low, high): the exponents of ten that enclose all values."""
    low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
    return low, max(high, low + 1)


class Axis:
    """Positions on a logarithmic axis from `start` to `end`, both in px."""

    def __init__(self, values, start, end):
        self.low, self.high = decades(values)
        self.start, self.end = start, end

    def place(self, value):
        return self.start + (math.log10(value) - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self):
        return [(10.0**k, f"{10.0 ** k:g}" if abs(k) < 5 else f"1e{k}") for k in range(self.low, self.high + 1)]


def panel(left, top, title, curves):
    """Lines of SVG. curves: [(label, [(number, time)])]."""
    points = [point for _, curve in curves for point in curve]
    x = Axis([n for n, _ in points], left + LEFT, left + WIDTH - RIGHT)
    y = Axis([t for _, t in points], top + HEIGHT - BOTTOM, top + TOP + LEGEND * len(curves))
    middle = (x.start + x.end) / 2
    lines = [
        f'<text x="{middle:.0f}" y="{top + 16}" class="title">{escape(title)}</text>',
        f'<text x="{middle:.0f}" y="{top + HEIGHT - 6}" class="x">number</text>',
        f'<rect x="{x.start}" y="{y.end}" width="{x.end - x.start}" height="{y.start - y.end}"/>',
    ]
    for value, label in x.ticks():
        lines.append(f'<path d="M{x.place(value):.1f} {y.start}v4" class="tick"/>')
        lines.append(f'<text x="{x.place(value):.1f}" y="{y.start + 14}" class="x">{label}</text>')
    for value, label in y.ticks():
        lines.append(f'<path d="M{x.start} {y.place(value):.1f}h-4" class="tick"/>')
        lines.append(f'<text x="{x.start - 7}" y="{y.place(value) + 3:.1f}" class="y">{label}</text>')
    for k, (label, curve) in enumerate(curves):
        color, below = COLORS[k % len(COLORS)], top + TOP + 6 + LEGEND * k
        places = " ".join(f"{x.place(n):.1f},{y.place(t):.1f}" for n, t in curve)
        lines.append(f'<polyline points="{places}" stroke="{color}"/>')
        lines.append(f'<path d="M{x.start + 6} {below - 3}h14" stroke="{color}"/>')
        lines.append(f'<text x="{x.start + 24}" y="{below}">{escape(label)}</text>')
    return lines


def page(sections):
    """The text of an SVG file. sections: {title: [(label, [(number, time)])]}; numbers and times are positive."""
    rows = -(-len(sections) // COLUMNS)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {COLUMNS * WIDTH} {rows * HEIGHT}">',
        "<!-- Written by scripts/bench: do not edit. -->",
        "<style>",
        "svg { background: white } text { font: 9px sans-serif } .title { font-size: 11px }",
        ".title, .x { text-anchor: middle } .y { text-anchor: end }",
        "rect, path, polyline { fill: none; stroke-width: 1.2 } rect, .tick { stroke: black; stroke-width: 0.8 }",
        "polyline { marker: url(#point) }",
        "</style>",
        '<marker id="point" viewBox="-2 -2 4 4" markerWidth="4" markerHeight="4"><circle r="1.5"/></marker>',
    ]
    for k, (title, curves) in enumerate(sections.items()):
        lines += panel(k % COLUMNS * WIDTH, k // COLUMNS * HEIGHT, title, curves)
    return "\n".join([*lines, "</svg>"]) + "\n"
