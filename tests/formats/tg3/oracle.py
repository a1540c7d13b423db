"""The yarns of a TexGen model, by their definition: nodes, frames, sections as points, volumes. Nothing of the program is in it."""

import itertools
import xml.etree.ElementTree as xml

import numpy as np


def numbers(text):
    return np.array([float(word) for word in text.split(",")])


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def section_points(element, ts):
    """The section's points at the parameters ts, which lie in [0, 1)."""
    kind = element.get("type")
    size = [float(element.get(name, 0)) for name in ("Width", "Height")]
    inner = element.findall("Section")
    angle = 2 * np.pi * ts
    if kind == "CSectionEllipse":
        return np.stack([size[0] / 2 * np.cos(angle), size[1] / 2 * np.sin(angle)], 1)
    if kind == "CSectionPowerEllipse":
        offset = float(element.get("XOffset", 0))
        x = np.where(np.cos(angle) > 0, size[0] / 2 - offset, size[0] / 2 + offset) * np.cos(angle) + offset
        sine = np.where(np.abs(np.sin(angle)) < 1e-15, 0, np.sin(angle))
        return np.stack([x, size[1] / 2 * np.sign(sine) * np.abs(sine) ** float(element.get("Power"))], 1)
    if kind == "CSectionLenticular":
        shift = float(element.get("Distortion", 0))
        points = []
        for t in ts:
            sagitta = size[1] / 2 - shift if t < 0.5 else size[1] / 2 + shift
            radius = (size[0] ** 2 / 4 + sagitta**2) / (2 * sagitta)
            reach = np.arcsin(size[0] / 2 / radius)
            turn = reach * ((1 - 4 * t) if t < 0.5 else (4 * t - 3))
            height = size[1] / 2 - radius * (1 - np.cos(turn))
            points.append([radius * np.sin(turn), height if t < 0.5 else radius * (1 - np.cos(turn)) - size[1] / 2])
        return np.array(points)
    if kind in ("CSectionRectangle", "CSectionPolygon"):
        w, h = size[0] / 2, size[1] / 2
        corners = np.array([[w, 0], [w, h], [-w, h], [-w, -h], [w, -h]])
        if kind == "CSectionPolygon":
            corners = np.array([numbers(point.get("value")) for point in element.findall("PolygonPoint")])
        closed = np.vstack([corners, corners[:1]])
        if kind == "CSectionPolygon" and element.get("RetainPoints") == "1":
            at = np.linspace(0, 1, len(closed))
        else:
            at = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
            at /= at[-1]
        return np.stack([np.interp(ts, at, closed[:, axis]) for axis in range(2)], 1)
    if kind == "CSectionBezier":
        points = np.array([numbers(point.get("value")) for point in element.findall("BezierPoint")])
        count = len(points) // 3
        piece = np.minimum((ts * count).astype(int), count - 1)
        s = (ts * count - piece)[:, None]
        p = [points[(3 * piece + k) % len(points)] for k in range(4)]
        return (1 - s) ** 3 * p[0] + 3 * (1 - s) ** 2 * s * p[1] + 3 * (1 - s) * s**2 * p[2] + s**3 * p[3]
    if kind == "CSectionRotated":
        a = float(element.get("Angle"))
        return section_points(inner[0], ts) @ np.array([[np.cos(a), np.sin(a)], [-np.sin(a), np.cos(a)]])
    if kind == "CSectionScaled":
        return section_points(inner[0], ts) * numbers(element.get("Scale"))
    if kind == "CSectionHybrid":
        divisions = [float(division.get("Value")) for division in element.findall("Division")]
        number = np.searchsorted(divisions, ts, side="right") - 1
        parts = np.array([section_points(part, ts) for part in inner])
        return parts[number, np.arange(len(ts))]
    raise ValueError(kind)


class Yarn:
    """Places along it are (span, t): the span behind a node, and the share of the way to the next one."""

    def __init__(self, element):
        nodes = element.findall("MasterNode")
        self.points = np.array([numbers(node.get("Position")) for node in nodes])
        self.given = np.array([numbers(node.get("Tangent", "0,0,0")) for node in nodes])
        self.ups = np.array([numbers(node.get("Up", "0,0,1")) for node in nodes])
        self.angles = np.array([float(node.get("Angle", 0)) for node in nodes])
        self.repeats = [numbers(repeat.get("value")) for repeat in element.findall("Repeat")]
        law = element.find("Interpolation")
        self.adjustments = [
            [(float(at.get("T")), numbers(at.get("Vector"))) for at in one] for one in law.findall("Adjustment")
        ]
        law = law if law.find("Interpolation") is None else law.find("Interpolation")
        self.form = law.get("type")[len("CInterpolation") :]
        self.is_periodic = law.get("Periodic", "1") == "1"
        self.flat_nodes = law.get("ForceMasterNodeTangent", "0") == "1"
        self.sections = element.find("YarnSection")
        self.shifts = []  # of the outline: of each span places along it, with vectors by the outline's parameter
        if self.sections.get("type") == "CYarnSectionAdjusted":
            self.shifts = [
                [
                    (float(at.get("T")), [(float(one.get("T")), numbers(one.get("Vector"))) for one in at])
                    for at in span.findall("AdjustmentSection")
                ]
                for span in self.sections.findall("Adjustment")
            ]
            self.sections = self.sections.find("YarnSection")
        self.ts = self.parameters()
        self.derivatives = self.cubic() if self.form == "Cubic" else None
        spans = range(len(self.points) - 1)
        steps = np.linspace(0, 1, 2001)
        self.lengths = np.array(
            [np.linalg.norm(np.diff(self.line(span, steps)[0], axis=0), axis=1).sum() for span in spans]
        )

    def parameters(self):
        """Those of 720 even ones and of all polygons' corners."""
        ts = set(np.arange(720) / 720)
        for section in self.sections.iter("Section"):
            points = np.array([numbers(point.get("value")) for point in section.findall("PolygonPoint")])
            if len(points) and section.get("RetainPoints") == "1":
                ts.update(np.arange(len(points)) / len(points))
            elif len(points):
                edges = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
                ts.update((np.cumsum(edges) - edges) / edges.sum())
        ts.update(t % 1 for span in self.shifts for _, around in span for t, _ in around)
        return np.array(sorted(ts))

    def shift(self, span, t):
        """Of the outline's points at a place of a span."""
        if span >= len(self.shifts) or not self.shifts[span]:
            return np.zeros((len(self.ts), 2))
        rows = [
            np.stack(
                [np.interp(self.ts, [u for u, _ in around], [by[axis] for _, by in around]) for axis in range(2)], 1
            )
            for _, around in self.shifts[span]
        ]
        places = [place for place, _ in self.shifts[span]]
        right = min(max(int(np.searchsorted(places, t)), 1), len(places) - 1) if len(places) > 1 else 0
        if right == 0:
            return rows[0]
        share = np.clip((t - places[right - 1]) / (places[right] - places[right - 1]), 0, 1)
        return rows[right - 1] + share * (rows[right] - rows[right - 1])

    def cubic(self):
        """Derivatives at the nodes of the spline with equal second derivatives on both sides of each node."""
        p, count = self.points, len(self.points)
        left, right = np.zeros((count, count)), np.zeros((count, 3))
        for i in range(1, count - 1):
            left[i, i - 1 : i + 2] = 1, 4, 1
            right[i] = 3 * (p[i + 1] - p[i - 1])
        if self.is_periodic:
            left[0, 0], left[0, -1] = 1, -1
            # The second derivative at the end is that at the beginning.
            left[-1, [-2, -1]] += 2, 4
            left[-1, [0, 1]] += 4, 2
            right[-1] = 6 * (p[1] - p[0]) + 6 * (p[-1] - p[-2])
        else:
            left[0, :2], right[0] = (2, 1), 3 * (p[1] - p[0])
            left[-1, -2:], right[-1] = (1, 2), 3 * (p[-1] - p[-2])
        return np.linalg.solve(left, right)

    def node_tangents(self):
        p = self.points
        period = p[-1] - p[0]
        before = np.vstack([p[-2] - period if self.is_periodic else p[0], p[:-1]])
        after = np.vstack([p[1:], p[1] + period if self.is_periodic else p[-1]])
        tangents = np.where(np.any(self.given != 0, axis=1)[:, None], self.given, unit(after - before))
        if self.flat_nodes:
            tangents = tangents * [1, 1, 0]
        return tangents

    def line(self, span, t):
        """Places and tangents at the parameters t."""
        t = np.atleast_1d(t)[:, None]
        p, q = self.points[span], self.points[span + 1]
        if self.form == "Linear":
            a, b = self.node_tangents()[span : span + 2]
            place, tangent = p + t * (q - p), a + t * (b - a)
        else:
            if self.form == "Cubic":
                a, b = self.derivatives[span : span + 2] / 3
            else:
                a, b = self.node_tangents()[span : span + 2] * np.linalg.norm(q - p) / 3
            c = [p, p + a, q - b, q]
            place = (1 - t) ** 3 * c[0] + 3 * (1 - t) ** 2 * t * c[1] + 3 * (1 - t) * t**2 * c[2] + t**3 * c[3]
            tangent = (1 - t) ** 2 * (c[1] - c[0]) + 2 * (1 - t) * t * (c[2] - c[1]) + t**2 * (c[3] - c[2])
        if span < len(self.adjustments):
            at, by = zip(*self.adjustments[span])
            place = place + np.stack([np.interp(t[:, 0], at, np.array(by)[:, axis]) for axis in range(3)], 1)
        return place, unit(tangent)

    def outline(self, span, t):
        """The blended section, in the plane."""
        kind = self.sections.get("type")
        if kind == "CYarnSectionConstant":
            return section_points(self.sections.find("Section"), self.ts)
        if kind == "CYarnSectionInterpNode":
            here, following = self.sections.findall("NodeSection")[span : span + 2]
            stations = (
                [(0.0, here)]
                + [(float(one.get("t")), one) for one in here.findall("MidNodeSection")]
                + [(1.0, following)]
            )
            place = t
        else:
            stations = [(float(one.get("t")), one) for one in self.sections.findall("PositionSection")]
            stations = [(stations[-1][0] - 1, stations[-1][1])] + stations + [(stations[0][0] + 1, stations[0][1])]
            place = (self.lengths[:span].sum() + t * self.lengths[span]) / self.lengths.sum()
        number = max(i for i, station in enumerate(stations[:-1]) if station[0] <= place + 1e-12)
        (a, first), (b, second) = stations[number : number + 2]
        share = (place - a) / (b - a)
        if self.sections.get("Ramped") == "1":
            share = 3 * share**2 - 2 * share**3
        p, q = (section_points(one.find("Section"), self.ts) for one in (first, second))
        if self.sections.get("Polar") != "1":
            return p + share * (q - p)
        radii, angles = (
            [np.linalg.norm(one, axis=1) for one in (p, q)],
            [np.arctan2(one[:, 1], one[:, 0]) for one in (p, q)],
        )
        turn = (angles[1] - angles[0] + np.pi) % (2 * np.pi) - np.pi
        radius, angle = radii[0] + share * (radii[1] - radii[0]), angles[0] + share * turn
        return np.stack([radius * np.cos(angle), radius * np.sin(angle)], 1)

    def section(self, span, t):
        """Points round the yarn at a place."""
        place, tangent = (one[0] for one in self.line(span, t))
        up = self.ups[span] + t * (self.ups[span + 1] - self.ups[span])
        up = unit(up - tangent * (tangent @ up))
        side = np.cross(tangent, up)
        angle = self.angles[span] + t * (self.angles[span + 1] - self.angles[span])
        side = np.cos(angle) * side + np.sin(angle) * np.cross(up, side)
        outline = self.outline(span, t) + self.shift(span, t)
        return place + outline[:, :1] * side + outline[:, 1:] * up

    def at_nodes(self):
        spans = len(self.points) - 1
        return [self.section(span, 0.0) for span in range(spans)] + [self.section(spans - 1, 1.0)]

    def volume(self, each=200):
        """Of the triangles between sections, and of both ends."""
        rows = [self.section(span, t) for span in range(len(self.points) - 1) for t in np.arange(each) / each]
        rows = np.array(rows + [self.section(len(self.points) - 2, 1.0)])
        a, b = rows[:-1], rows[1:]
        a1, b1 = np.roll(a, -1, axis=1), np.roll(b, -1, axis=1)

        def six(p, q, r):
            return np.einsum("...i,...i", p, np.cross(q, r)).sum()

        total = six(a, b1, a1) + six(a, b, b1)
        for row, sign in ((rows[0], 1), (rows[-1], -1)):
            middle = np.broadcast_to(row.mean(axis=0), row.shape)
            total += sign * six(middle, row, np.roll(row, -1, axis=0))
        return abs(total) / 6


class Model:
    def __init__(self, path):
        self.tree = xml.parse(path)
        self.textile = self.tree.getroot().find("Textile")
        self.yarns = [Yarn(element) for element in self.textile.findall("Yarn")]

    def without_domain(self, path):
        """The same model, each of whose yarns stands there once."""
        domain = self.textile.find("Domain")
        if domain is not None:
            self.textile.remove(domain)
        self.tree.write(path)

    def box(self):
        """The least and the largest coordinates of a domain that is a box."""
        low, high = np.zeros(3), np.zeros(3)
        for plane in self.textile.find("Domain"):
            normal = numbers(plane.get("Normal"))
            (high if normal.sum() < 0 else low)[np.argmax(np.abs(normal))] = normal.sum() * float(plane.get("d"))
        return low, high

    def copies(self, yarn):
        """How many copies of a yarn have a box that reaches into the domain's."""
        low, high = self.box()
        rows = np.array([yarn.section(span, t) for span in range(len(yarn.points) - 1) for t in np.arange(9) / 8])
        least, most = rows.min(axis=(0, 1)), rows.max(axis=(0, 1))
        count = 0
        for steps in itertools.product(range(-9, 10), repeat=len(yarn.repeats)):
            shift = sum(step * repeat for step, repeat in zip(steps, yarn.repeats))
            count += bool(np.all(least + shift < high - 1e-5) and np.all(most + shift > low + 1e-5))
        return count
