"""What a chart and the laid yarns say: links of a Fabric TXT's chart, and how often a yarn passes through a loop."""

import csv
import io
import re

import numpy as np


class Chart:
    """The knit of a Fabric TXT as the program writes it, read as the page of the format says."""

    def __init__(self, text):
        self.rows = re.search(r"^  chart\n((?:    \S+\n)+)  end$", text, re.MULTILINE)[1].split()[::-1]
        self.is_opposite = "gating opposite" in text
        found = re.search(r"^  feeds (\d+)$", text, re.MULTILINE)
        self.feeds = int(found[1]) if found else 1
        self.wale = float(re.search(r"^  wales \d+ pitch (\S+)$", text, re.MULTILINE)[1])
        self.course = float(re.search(r"^  courses \d+ pitch (\S+)$", text, re.MULTILINE)[1])
        self.moves, self.drops, self.order = {}, set(), {}
        for word, row, wale, side, count in re.findall(
            r"^  (transfer|drop) (\d+) (\d+)(?: (right|left) (\d+))?$", text, re.MULTILINE
        ):
            cell = (int(row) - 1, int(wale) - 1)
            self.order[cell] = len(self.order)
            if word == "drop":
                self.drops.add(cell)
            else:
                self.moves[cell] = int(count) * (1 if side == "right" else -1)
        self.through = self.knit()  # cells, each with those that it is drawn through; tucks through none

    def yarn(self, row):
        return f"course_{row // self.feeds + 1}" + (f"_{row % self.feeds + 1}" if self.feeds > 1 else "")

    def height(self, row):
        return row / self.feeds * self.course

    def bed(self, cell, held=()):
        """A tuck is on the bed of the loop that it joins."""
        sign = self.rows[cell[0]][cell[1]]
        if sign == "T" and not self.is_opposite:
            return next((self.beds[below] for below in held), "f")
        return "f" if sign in "KT" else "b"

    def knit(self):
        needles, through, self.beds = {}, {}, {}
        for r, row in enumerate(self.rows):
            made = []
            for w, sign in enumerate(row):
                if sign in "M.":
                    continue
                cell = (r, w)
                key = (w, self.bed(cell) if self.is_opposite else "")
                held = needles.get(key, [])
                self.beds[cell] = self.bed(cell, held)
                through[cell] = []
                if sign in "KP":
                    face = 1 if sign == "K" else -1
                    through[cell] = sorted(held, key=lambda item: (item[0], face * self.order.get(item, -1)))
                    needles[key] = []
                made.append((cell, (w + self.moves.get(cell, 0), key[1])))
            for cell, key in made:
                if cell not in self.drops:
                    needles.setdefault(key, []).append(cell)
        return through

    def named_links(self):
        """As oracle.named_links."""
        first = min(w for _, w in self.through)
        names, counts = {}, {}
        for r, w in sorted(self.through):
            key = (w - first, self.beds[r, w])
            counts[key] = counts.get(key, 0) + 1
            names[r, w] = (*key, counts[key])
        return sorted((names[cell], tuple(names[below] for below in held)) for cell, held in self.through.items())


def lines_of(text):
    """The points of each yarn of a CSV."""
    yarns = {}
    for row in csv.DictReader(io.StringIO(text)):
        yarns.setdefault(row["yarn"], []).append([float(row[name]) for name in ("x_mm", "y_mm", "z_mm")])
    return {name: np.array(points) for name, points in yarns.items()}


class Cloth:
    """The stitches of the laid yarns: each the piece of its yarn between the middles of its sinkers."""

    def __init__(self, chart, lines):
        self.chart, self.stitches, self.ways = chart, {}, {}
        for r, row in enumerate(chart.rows):
            wales = [w for w, sign in enumerate(row) if sign != "."]
            if not wales:
                continue
            points = lines[chart.yarn(r)]
            low = points[:, 1].min()
            ends = [0]
            for w in wales[1:]:
                away = np.hypot(points[:, 0] - w * chart.wale, points[:, 1] - low)
                away[: ends[-1] + 1] = np.inf
                ends.append(int(away.argmin()))
            ends.append(len(points) - 1)
            for i, w in enumerate(wales):
                if row[w] != "M":
                    self.stitches[r, w] = points[ends[i] : ends[i + 1] + 1]

    def through(self, cell, other):
        """How often each half of a stitch passes through the loop of another one, from its back to its face.

        The loop is closed between its sinkers, and the half goes on without end: from its sinker to the back, from the place
        on its leg where it has come to the face further there. The linking numbers of the two."""
        ring = self.stitches[other][::-1]  # counter-clockwise, seen from the face of the cloth
        ring = np.vstack([ring, ring[:1]])
        face = 1 if self.chart.beds[cell] == "f" else -1
        return tuple(face * round(linking_number(ring, self.way(cell, turn))) for turn in (1, -1))

    def way(self, cell, turn):
        if (cell, turn) not in self.ways:
            stitch = self.stitches[cell][::turn]
            half = stitch[: int(stitch[:, 1].argmax()) + 1]
            face = 1 if self.chart.beds[cell] == "f" else -1
            ahead = face * (half[:, 2] - half[0, 2])
            stop = int(np.argmax(ahead >= 0.6 * ahead.max())) if ahead.max() > 0 else len(half) - 1
            far = 100 * self.chart.wale
            start, end = half[0] - [0, 0, face * far], half[stop] + [0, 0, face * far]
            self.ways[cell, turn] = np.vstack(
                [start, half[: stop + 1], end, end - [far, 0, 0], start - [far, 0, 0], start]
            )
        return self.ways[cell, turn]


SEEN = np.linalg.qr(np.array([[1, 0.0137, 0.0211], [0.0171, 1, -0.0193], [-0.0151, 0.0223, 1]]))[0]


def beside(segments, low, high):
    """Those of n x 2 x 3 whose boxes, seen along z, meet that of `low` and `high`."""
    least, most = segments[:, :, :2].min(axis=1), segments[:, :, :2].max(axis=1)
    return segments[np.all((most >= low[:2]) & (least <= high[:2]), axis=1)]


def linking_number(first, second):
    """Of two closed polygons: half the sum of the signs of their crossings, seen along a direction that meets no corner."""
    first, second = (np.stack([line[:-1], line[1:]], axis=1) for line in (first @ SEEN, second @ SEEN))
    second = beside(second, first.min(axis=(0, 1)), first.max(axis=(0, 1)))
    if not len(second):
        return 0
    first = beside(first, second.min(axis=(0, 1)), second.max(axis=(0, 1)))
    a, b = first[:, None, 0], (first[:, 1] - first[:, 0])[:, None]
    c, d = second[None, :, 0], (second[:, 1] - second[:, 0])[None]
    cross = b[..., 0] * d[..., 1] - b[..., 1] * d[..., 0]
    gap = c - a
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (gap[..., 0] * d[..., 1] - gap[..., 1] * d[..., 0]) / cross
        t = (gap[..., 0] * b[..., 1] - gap[..., 1] * b[..., 0]) / cross
    meets = (cross != 0) & (s >= 0) & (s < 1) & (t >= 0) & (t < 1)
    i, j = np.nonzero(meets)
    over = a[i, 0, 2] + s[i, j] * b[i, 0, 2] - c[0, j, 2] - t[i, j] * d[0, j, 2]
    return np.sum(np.sign(cross[i, j]) * np.sign(over)) / 2
