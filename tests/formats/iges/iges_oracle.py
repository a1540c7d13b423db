#!/usr/bin/env python3
"""An independent judge of IGES 5.3 files: its own parser of fixed 80-column files and its own B-spline evaluator, in
the standard library only. It shares nothing with the program that it judges.

    iges_oracle.py FILE.igs [MODEL]

checks everything that the file says about itself (lines, sequence numbers, counts, pointers, strings, flags, topology)
and, with MODEL (written by model_dump.cpp from the geometry in memory), that the file says the same as the model, with
numbers equal to the last bit. Prints one line and exits with 0, or names the first fault and exits with 1.
"""

import math
import re
import sys

FEW_ULPS = 64 * 2.0**-52
UNITS = {"inch": (1, "INCH"), "mm": (2, "MM"), "m": (6, "M"), "um": (9, "UM"), "cm": (10, "CM")}
ROLES = ["warp", "weft", "wale", "course", "braider", "axial", "binder", "other"]


class Fault(Exception):
    pass


def need(condition, text, *values):
    if not condition:
        raise Fault(text.format(*values))


# ---- the file ------------------------------------------------------------------------------------------------------


def split_sections(data):
    need(data.endswith(b"\n"), "the last line has no newline")
    sections = {letter: [] for letter in "SGDPT"}
    order = ""
    for number, raw in enumerate(data[:-1].split(b"\n"), 1):
        need(len(raw) == 80, "line {} has {} columns", number, len(raw))
        need(all(32 <= c < 127 for c in raw), "line {} is not printable ASCII", number)
        line = raw.decode("ascii")
        letter = line[72]
        need(letter in sections, "line {}: section letter {!r}", number, letter)
        if not order.endswith(letter):
            order += letter
        sections[letter].append(line)
        need(line[73:] == "%7d" % len(sections[letter]), "line {}: sequence number {!r}", number, line[73:])
    need(order == "SGDPT", "sections come in the order {}", order)
    counts = "".join("%s%7d" % (letter, len(sections[letter])) for letter in "SGDP")
    need(len(sections["T"]) == 1 and sections["T"][0][:72] == counts.ljust(72), "terminate line {!r}", sections["T"][0])
    return sections


class Tokens:
    """Free-format parameters from the data columns of one section or entity."""

    def __init__(self, lines, width, what):
        self.lines = [line[:width] for line in lines]
        self.what = what
        self.values = self.split()

    def split(self):
        values = []
        row = column = 0
        done = False
        while not done:
            need(row < len(self.lines), "{}: no record delimiter", self.what)
            line = self.lines[row]
            if column >= len(line) or not line[column:].strip():
                row, column = row + 1, 0
                continue
            text = re.compile(r"(\d+)H").match(line, column)
            if text:
                value, row, column = self.hollerith(int(text.group(1)), row, text.end())
                line = self.lines[row]
                end = re.compile(r"[,;]").match(line, column)
                need(end, "{}: no delimiter after the string {!r}", self.what, value)
            else:
                end = re.compile(r"([^,;]*)[,;]").match(line, column)
                need(end, "{}: a value is broken across lines: {!r}", self.what, line[column:])
                value = end.group(1)
                need(value == value.strip(), "{}: blanks in a value {!r}", self.what, value)
            values.append(value if not text else (value,))
            done = line[end.end() - 1] == ";"
            column = end.end()
        need(row == len(self.lines) - 1, "{}: lines after the record delimiter", self.what)
        need(not self.lines[row][column:].strip(), "{}: text after the record delimiter", self.what)
        return values

    def hollerith(self, length, row, column):
        need(length > 0, "{}: empty string with a count", self.what)
        text = ""
        while len(text) < length:
            need(row < len(self.lines), "{}: a string runs out of its entity", self.what)
            part = self.lines[row][column : column + length - len(text)]
            text += part
            column += len(part)
            if column == len(self.lines[row]):
                row, column = row + 1, 0
        return text, row, column


class Reader:
    """Typed values in order; everything must be read."""

    def __init__(self, values, what):
        self.values, self.what, self.at = values, what, 0

    def take(self):
        need(self.at < len(self.values), "{}: too few values", self.what)
        self.at += 1
        return self.values[self.at - 1]

    def integer(self):
        value = self.take()
        need(isinstance(value, str) and re.fullmatch(r"-?(0|[1-9]\d*)", value), "{}: {!r} is no integer", self.what, value)
        return int(value)

    def real(self):
        value = self.take()
        form = r"-?\d+\.\d*(E[+-]\d+)?"
        need(isinstance(value, str) and re.fullmatch(form, value), "{}: {!r} is no real", self.what, value)
        number = float(value)
        digits = value.split("E")[0].lstrip("-").replace(".", "").strip("0")
        shortest = repr(number).split("e")[0].lstrip("-").replace(".", "").strip("0")
        # Integers beyond 2^53 may be written out; every other number has its shortest digits.
        need(len(digits) <= len(shortest) or abs(number) >= 2.0**53, "{}: {!r} has more digits than it needs", self.what, value)
        return number

    def reals(self, count):
        return [self.real() for _ in range(count)]

    def points(self, count):
        flat = self.reals(3 * count)
        return [tuple(flat[3 * i : 3 * i + 3]) for i in range(count)]

    def string(self):
        value = self.take()
        if value == "":
            return ""
        need(isinstance(value, tuple), "{}: {!r} is no string", self.what, value)
        return value[0]

    def end(self):
        need(self.at == len(self.values), "{}: {} values too many", self.what, len(self.values) - self.at)


def parse_global(lines):
    values = Tokens(lines, 72, "global section")
    reader = Reader(values.values, "global section")
    need(len(values.values) == 26, "global section has {} parameters", len(values.values))
    g = {}
    g["delimiters"] = (reader.string(), reader.string())
    need(g["delimiters"] == (",", ";"), "delimiters {}", g["delimiters"])
    for key in ("product", "file", "system", "version"):
        g[key] = reader.string()
    g["precision"] = [reader.integer() for _ in range(5)]
    need(g["precision"] == [32, 38, 6, 308, 15], "precision of the numbers {}", g["precision"])
    g["receiver"] = reader.string()
    g["scale"], g["flag"], g["units"] = reader.real(), reader.integer(), reader.string()
    need(g["scale"] == 1, "scale {}", g["scale"])
    need((g["flag"], g["units"]) in UNITS.values(), "units {} {}", g["flag"], g["units"])
    g["weights"], g["width"] = reader.integer(), reader.real()
    need(g["weights"] >= 1 and g["width"] > 0, "line weights")
    g["time"] = reader.string()
    g["resolution"], g["largest"] = reader.real(), reader.real()
    g["author"], g["organization"] = reader.string(), reader.string()
    need((reader.integer(), reader.integer()) == (11, 0), "version or drafting standard")
    g["changed"], g["protocol"] = reader.string(), reader.string()
    for time in (g["time"], g["changed"]):
        need(re.fullmatch(r"\d{4}(0[1-9]|1[0-2])([0-2]\d|3[01])\.([01]\d|2[0-3])[0-5]\d[0-5]\d", time), "date {!r}", time)
    need(0 < g["resolution"], "resolution {}", g["resolution"])
    reader.end()
    return g


class Entity:
    pass


def parse_directory(sections):
    lines, parameters = sections["D"], sections["P"]
    need(len(lines) % 2 == 0, "odd number of directory lines")
    entities, next_line = {}, 1
    for at in range(0, len(lines), 2):
        fields = []
        for line in lines[at : at + 2]:
            fields += [line[8 * i : 8 * i + 8] for i in range(9)]
        e = Entity()
        e.de = at + 1
        what = "directory entry %d" % e.de

        def integer(index):
            text = fields[index]
            need(re.fullmatch(r" *-?\d+", text), "{}: field {!r} is not a right-justified integer", what, text)
            return int(text)

        e.type, e.first, e.level, e.color, e.count, e.form = (integer(i) for i in (0, 1, 4, 11, 12, 13))
        need(all(integer(i) == 0 for i in (2, 3, 5, 6, 7, 10)), "{}: a field that should be 0 is not", what)
        need(integer(9) == e.type, "{}: two entity types", what)
        need(re.fullmatch(r"\d{8}", fields[8]), "{}: status {!r}", what, fields[8])
        need(fields[14].strip() == fields[15].strip() == "", "{}: reserved fields", what)
        e.status = fields[8]
        need(int(e.status[2:4]) <= 3 and int(e.status[4:6]) <= 6 and int(e.status[6:]) <= 2, "{}: status", what)
        e.label = fields[16].lstrip()
        need(fields[16] == e.label.rjust(8), "{}: label is not right-justified", what)
        integer(17)
        # Parameter lines: whole, in order, each with the pointer back.
        need(e.first == next_line and e.count >= 1, "{}: parameters at {}, expected at {}", what, e.first, next_line)
        own = parameters[e.first - 1 : e.first - 1 + e.count]
        need(len(own) == e.count, "{}: parameter lines run out", what)
        next_line += e.count
        for line in own:
            need(line[64:72] == " %7d" % e.de, "{}: parameter line {!r} points elsewhere", what, line[64:])
        e.what = "%d form %d at D%d" % (e.type, e.form, e.de)
        e.values = Tokens(own, 64, e.what).values
        entities[e.de] = e
    need(next_line == len(parameters) + 1, "parameter lines that no directory entry has")
    return entities


def read_surface(r, e):
    s = e.surface = Surface()
    s.nu, s.nv = r.integer() + 1, r.integer() + 1
    s.du, s.dv = r.integer(), r.integer()
    need(s.nu > s.du >= 1 and s.nv > s.dv >= 1, "{}: degrees", e.what)
    e.flags = [r.integer() for _ in range(5)]
    s.ku, s.kv = r.reals(s.nu + s.du + 1), r.reals(s.nv + s.dv + 1)
    s.weights, s.points = r.reals(s.nu * s.nv), r.points(s.nu * s.nv)
    e.range = r.reals(4)
    check_knots(s.ku, e.what)
    check_knots(s.kv, e.what)
    need(e.range == [s.ku[s.du], s.ku[s.nu], s.kv[s.dv], s.kv[s.nv]], "{}: parameter range {}", e.what, e.range)
    need(min(s.weights) > 0, "{}: weights", e.what)
    rows = [[(s.points[j * s.nu + i], s.weights[j * s.nu + i]) for i in range(s.nu)] for j in range(s.nv)]
    closed_u = clamped(s.ku, s.du) and all(row[0] == row[-1] for row in rows)
    closed_v = clamped(s.kv, s.dv) and rows[0] == rows[-1]
    polynomial = min(s.weights) == max(s.weights)
    need(e.flags == [int(closed_u), int(closed_v), int(polynomial), 0, 0], "{}: flags {}", e.what, e.flags)


def read_curve(r, e):
    c = e.curve = Curve()
    c.n, c.d = r.integer() + 1, r.integer()
    need(c.n > c.d >= 1, "{}: degree", e.what)
    e.flags = [r.integer() for _ in range(4)]
    c.k, c.weights, c.points = r.reals(c.n + c.d + 1), r.reals(c.n), r.points(c.n)
    e.range, e.normal = r.reals(2), r.points(1)[0]
    check_knots(c.k, e.what)
    need(e.range == [c.k[c.d], c.k[c.n]], "{}: parameter range", e.what)
    closed = clamped(c.k, c.d) and c.points[0] == c.points[-1] and c.weights[0] == c.weights[-1]
    need(e.flags[1:] == [int(closed), int(min(c.weights) == max(c.weights)), 0], "{}: flags {}", e.what, e.flags)
    size = max(max(map(abs, p)) for p in c.points)
    if e.flags[0]:
        need(abs(math.hypot(*e.normal) - 1) < 1e-14, "{}: normal of the plane", e.what)
        heights = [dot(p, e.normal) for p in c.points]
        need(max(heights) - min(heights) <= 1e-9 * max(size, 1e-300), "{}: says planar and is not", e.what)
    else:
        need(e.normal == (0, 0, 0), "{}: normal of a curve that is not planar", e.what)


def read_pointers(r, e, count, *types):
    pointers = [r.integer() for _ in range(count)]
    for p in pointers:
        e.points_to.append((p, types))
    return pointers


def read_entity(e):
    r = Reader(e.values, e.what)
    e.points_to = []
    need(r.integer() == e.type, "{}: parameters begin with another type", e.what)
    key = (e.type, e.form)
    if key == (128, 0):
        read_surface(r, e)
    elif key == (126, 0):
        read_curve(r, e)
    elif key == (142, 0):
        need(r.integer() in (0, 1, 2, 3), "{}: way of creation", e.what)
        e.on, e.flat, e.space = (read_pointers(r, e, 1, t)[0] for t in (128, 126, 126))
        need(r.integer() in (0, 1, 2, 3), "{}: preference", e.what)
    elif key == (144, 0):
        e.on = read_pointers(r, e, 1, 128)[0]
        need((r.integer(), r.integer()) == (1, 0), "{}: boundaries", e.what)
        e.outer = read_pointers(r, e, 1, 142)[0]
    elif key == (402, 7):
        e.members = read_pointers(r, e, r.integer(), 128, 144)
    elif key == (406, 15):
        need(r.integer() == 1, "{}: count of values", e.what)
        e.name = r.string()
    elif key == (406, 3):
        need((r.integer(), r.integer()) == (2, 0), "{}: values", e.what)
        e.name = r.string()
    elif key == (314, 0):
        e.percent = r.reals(3)
        need(all(0 <= p <= 100 for p in e.percent), "{}: percentages", e.what)
    elif key == (186, 0):
        e.shell = read_pointers(r, e, 1, 514)[0]
        need((r.integer(), r.integer()) == (1, 0), "{}: orientation or voids", e.what)
    elif key == (514, 1):
        e.faces = [(read_pointers(r, e, 1, 510)[0], r.integer()) for _ in range(r.integer())]
    elif key == (510, 1):
        e.on = read_pointers(r, e, 1, 128)[0]
        need((r.integer(), r.integer()) == (1, 1), "{}: loops", e.what)
        e.loop = read_pointers(r, e, 1, 508)[0]
    elif key == (508, 1):
        e.uses = []
        for _ in range(r.integer()):
            kind = r.integer()
            need(kind in (0, 1), "{}: kind of edge", e.what)
            e.uses.append((kind, read_pointers(r, e, 1, (504, 502)[kind])[0], r.integer(), r.integer()))
            need(r.integer() == 0, "{}: curves in parameters", e.what)
    elif key == (504, 1):
        e.edges = []
        for _ in range(r.integer()):
            curve = read_pointers(r, e, 1, 126)[0]
            ends = [(read_pointers(r, e, 1, 502)[0], r.integer()) for _ in range(2)]
            e.edges.append((curve, ends[0], ends[1]))
    elif key == (502, 1):
        e.vertices = r.points(r.integer())
    else:
        raise Fault(e.what + ": an entity that the writer should not use")
    e.properties = []
    if r.at < len(r.values):  # what points back, and properties
        need(r.integer() == 0, "{}: associativities", e.what)
        e.properties = read_pointers(r, e, r.integer(), 406)
    r.end()


def check_pointers(entities):
    parents = {de: [] for de in entities}
    for e in entities.values():
        for pointer, types in e.points_to:
            need(pointer in entities, "{}: pointer to {}, where no entity begins", e.what, pointer)
            need(entities[pointer].type in types, "{}: pointer to a {}", e.what, entities[pointer].type)
            if e.type != 402:
                parents[pointer].append(e.de)
        if e.color:
            need(e.color < 0 and entities.get(-e.color) and entities[-e.color].type == 314, "{}: colour", e.what)
    for e in entities.values():
        inside = any(entities[p].type != 402 for p in parents[e.de]) and e.type != 406
        need(e.status[2:4] == ("01" if inside else "00"), "{}: subordinate flag of {!r}", e.what, e.status)
        use = "02" if e.type == 314 else "05" if e.type == 126 and is_flat(e, entities) else "00"
        need(e.status[4:6] == use, "{}: use flag of {!r}", e.what, e.status)


def is_flat(e, entities):
    return any(c.type == 142 and c.flat == e.de for c in entities.values())


# ---- geometry: points on B-splines by de Boor's triangle in homogeneous coordinates ---------------------------------


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def check_knots(knots, what):
    need(all(a <= b for a, b in zip(knots, knots[1:])), "{}: knots decrease", what)


def clamped(knots, degree):
    return len(set(knots[: degree + 1])) == 1 and len(set(knots[-degree - 1 :])) == 1


def span_of(knots, degree, count, t):
    """The k with knots[k] <= t < knots[k + 1]; the last span at the end of the domain."""
    low, high = degree, count - 1
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if knots[middle] <= t else (low, middle - 1)
    while knots[low] == knots[low + 1]:
        low -= 1
    return low


def de_boor(knots, degree, span, control, t):
    """Value and first derivative from the degree + 1 control tuples that matter on a span."""
    d = before = control
    for level in range(1, degree + 1):
        before = d
        d = d[:]
        for i in range(degree, level - 1, -1):
            low, high = knots[span - degree + i], knots[span + 1 + i - level]
            a = (t - low) / (high - low)
            d[i] = tuple((1 - a) * x + a * y for x, y in zip(before[i - 1], before[i]))
    width = knots[span + 1] - knots[span]
    slope = tuple(degree * (y - x) / width for x, y in zip(before[degree - 1], before[degree]))
    return d[degree], slope


def lift(points, weights):
    return [(x * w, y * w, z * w, w) for (x, y, z), w in zip(points, weights)]


def project(value, slope):
    point = tuple(x / value[3] for x in value[:3])
    return point, tuple((dx - slope[3] * p) / value[3] for dx, p in zip(slope[:3], point))


class Curve:
    def at(self, t):
        k = span_of(self.k, self.d, self.n, t)
        part = slice(k - self.d, k + 1)
        return project(*de_boor(self.k, self.d, k, lift(self.points[part], self.weights[part]), t))

    def low(self):
        return self.k[self.d]

    def high(self):
        return self.k[self.n]

    def sides(self):
        return spans(self.k, self.d, self.n)


class Surface:
    def at(self, u, v):
        k, m = span_of(self.ku, self.du, self.nu, u), span_of(self.kv, self.dv, self.nv, v)
        across = []
        for j in range(m - self.dv, m + 1):
            part = slice(j * self.nu + k - self.du, j * self.nu + k + 1)
            across.append(de_boor(self.ku, self.du, k, lift(self.points[part], self.weights[part]), u))
        value, dv = de_boor(self.kv, self.dv, m, [a[0] for a in across], v)
        du, _ = de_boor(self.kv, self.dv, m, [a[1] for a in across], v)
        point, s_u = project(value, du)
        return point, s_u, project(value, dv)[1]

    def size(self):
        return max(max(map(abs, p)) for p in self.points)


def spans(knots, degree, count):
    values = sorted(set(knots[degree : count + 1]))
    return list(zip(values, values[1:]))


GAUSS = [(-0.9061798459386640, 0.2369268850561891), (-0.5384693101056831, 0.4786286704993665), (0.0, 0.5688888888888889),
         (0.5384693101056831, 0.4786286704993665), (0.9061798459386640, 0.2369268850561891)]


def flux(surface):
    """A third of the integral of S . (S_u x S_v): the volume that an outward face closes off against the origin."""
    total = 0.0
    for u0, u1 in spans(surface.ku, surface.du, surface.nu):
        for v0, v1 in spans(surface.kv, surface.dv, surface.nv):
            for x, a in GAUSS:
                for y, b in GAUSS:
                    p, s_u, s_v = surface.at((u0 + u1) / 2 + x * (u1 - u0) / 2, (v0 + v1) / 2 + y * (v1 - v0) / 2)
                    total += a * b * (u1 - u0) * (v1 - v0) / 4 * dot(p, cross(s_u, s_v))
    return total / 3


def planar_flux(curve, normal):
    """The same for the plane region inside a closed curve that runs counter-clockwise about `normal`."""
    area = [0.0, 0.0, 0.0]
    for t0, t1 in curve.sides():
        for x, a in GAUSS:
            p, d = curve.at((t0 + t1) / 2 + x * (t1 - t0) / 2)
            area = [s + a * (t1 - t0) / 4 * c for s, c in zip(area, cross(p, d))]
    return dot(curve.points[0], normal) * dot(area, normal) / 3


def distance_to(surface, point):
    """Distance to the surface: Newton from the best of a grid of places."""
    u0, u1, v0, v1 = surface.ku[surface.du], surface.ku[surface.nu], surface.kv[surface.dv], surface.kv[surface.nv]
    best = None
    for i in range(25):
        for j in range(25):
            u, v = u0 + (u1 - u0) * i / 24, v0 + (v1 - v0) * j / 24
            gap = minus(surface.at(u, v)[0], point)
            if best is None or dot(gap, gap) < best[0]:
                best = (dot(gap, gap), u, v)
    _, u, v = best
    for _ in range(60):
        p, a, b = surface.at(u, v)
        gap = minus(point, p)
        aa, ab, bb, ga, gb = dot(a, a), dot(a, b), dot(b, b), dot(gap, a), dot(gap, b)
        determinant = aa * bb - ab * ab
        if determinant <= 1e-14 * aa * bb:
            break
        u = min(max(u + (ga * bb - gb * ab) / determinant, u0), u1)
        v = min(max(v + (gb * aa - ga * ab) / determinant, v0), v1)
    return math.hypot(*minus(surface.at(u, v)[0], point))


# ---- what the entities say together ---------------------------------------------------------------------------------


def check_trimmed(e, entities):
    boundary = entities[e.outer]
    surface, flat, space = entities[e.on].surface, entities[boundary.flat].curve, entities[boundary.space].curve
    need(boundary.on == e.on, "{}: bounded by a curve on another surface", e.what)
    need(flat.points[0] == flat.points[-1] and space.points[0] == space.points[-1], "{}: boundary is open", e.what)
    for i in range(33):
        t = flat.low() + (flat.high() - flat.low()) * i / 32
        x, y, z = flat.at(t)[0]
        need(z == 0, "{}: parameter curve leaves its plane", e.what)
        u0, u1, v0, v1 = entities[e.on].range
        need(u0 < x < u1 and v0 < y < v1, "{}: parameter curve leaves the surface", e.what)
        gap = math.hypot(*minus(surface.at(x, y)[0], space.at(t)[0]))
        need(gap <= FEW_ULPS * space_size(space), "{}: the two boundary curves are {} apart", e.what, gap)


def space_size(curve):
    return max(max(map(abs, p)) for p in curve.points)


def check_solid(solid, entities):
    """Closed loops; every edge twice, once each way; edges on their surfaces. Returns the volume."""
    shell = entities[solid.shell]
    used, vertices, volume = {}, set(), 0.0
    for face_pointer, outward in shell.faces:
        face = entities[face_pointer]
        loop = entities[face.loop]
        surface = entities[face.on].surface
        chain, outlines = [], []
        for kind, list_pointer, index, forward in loop.uses:
            if kind == 1:
                vertices.add((list_pointer, index))
                chain.append(((list_pointer, index),) * 2)
                continue
            edges = entities[list_pointer].edges
            need(1 <= index <= len(edges), "{}: edge {}", loop.what, index)
            curve, a, b = edges[index - 1]
            chain.append((a, b) if forward else (b, a))
            vertices.update((a, b))
            used.setdefault((list_pointer, index), []).append(forward == outward)
            outlines.append(entities[curve].curve)
        for (_, a), (b, _) in zip(chain, chain[1:] + chain[:1]):
            need(a == b, "{}: the loop is not closed", loop.what)
        for curve in outlines:
            for i in (1, 3, 7):
                t = curve.low() + (curve.high() - curve.low()) * i / 8
                gap = distance_to(surface, curve.at(t)[0])
                need(gap <= 1e-9 * surface.size(), "{}: an edge is {} off its surface", face.what, gap)
        if (surface.du, surface.dv) == (1, 1):
            _, s_u, s_v = surface.at(surface.ku[1], surface.kv[1])
            normal = cross(s_u, s_v)
            length = math.hypot(*normal)
            need(len(outlines) == 1, "{}: plane with {} edges", face.what, len(outlines))
            part = planar_flux(outlines[0], tuple(x / length for x in normal))
        else:
            part = flux(surface)
        volume += part if outward else -part
    lists = {pointer for pointer, _ in used}
    count = sum(len(entities[p].edges) for p in lists)
    need(len(used) == count, "{}: edges that no loop uses", solid.what)
    for (list_pointer, index), ways in used.items():
        need(sorted(ways) == [False, True], "{}: edge {} is used {} times", solid.what, index, ways)
        curve, *ends = entities[list_pointer].edges[index - 1]
        c = entities[curve].curve
        for (vertex_list, v), t in zip(ends, (c.low(), c.high())):
            points = entities[vertex_list].vertices
            need(1 <= v <= len(points), "{}: vertex {}", solid.what, v)
            gap = math.hypot(*minus(points[v - 1], c.at(t)[0]))
            need(gap <= FEW_ULPS * space_size(c), "{}: a vertex is {} off its edge", solid.what, gap)
    need(all(len(entities[p].vertices) <= len(vertices) for p, _ in vertices), "{}: stray vertices", solid.what)
    ring = len(shell.faces) == 1
    need(len(vertices) - count + len(shell.faces) == (0 if ring else 2), "{}: Euler's number", solid.what)
    return volume


# ---- the model -------------------------------------------------------------------------------------------------------


def read_model(path):
    model, bodies = {"bodies": []}, None
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            word, _, rest = line.rstrip("\n").partition(" ")
            parts = rest.split()
            if word in ("file", "title", "units", "time"):
                model[word] = rest
            elif word in ("solid", "largest"):
                model[word] = float.fromhex(rest)
            elif word == "body":
                body = {"name": rest, "surfaces": [], "outlines": []}
                model["bodies"].append(body)
            elif word in ("role", "start", "end"):
                body[word] = rest
            elif word == "color":
                body[word] = [int(p) for p in parts]
            elif word in ("ring", "inward"):
                body[word] = rest == "1"
            elif word == "volume":
                body[word] = float.fromhex(rest)
            elif word == "surface":
                shape = {"kind": parts[0], "counts": [int(p) for p in parts[1:]], "samples": []}
                body["surfaces"].append(shape)
            elif word == "outline":
                shape = {"counts": [int(p) for p in parts], "samples": []}
                body["outlines"].append(shape)
            elif word == "sample":
                shape["samples"].append([float.fromhex(p) for p in parts])
            else:
                shape[word] = [float.fromhex(p) for p in parts]
    return model


def bits(values):
    return [v.hex() for v in values]


def compare_shape(what, own, shape, keys):
    """Counts, knots, weights and points of an entity against the model's, to the last bit (and the sign of zero)."""
    counts, knots = keys
    need(counts == shape["counts"], "{}: counts {} instead of {}", what, counts, shape["counts"])
    for name, values in knots.items():
        need(bits(values) == bits(shape[name]), "{}: {} differ from the model's", what, name)
    need(bits(own.weights) == bits(shape["weights"] or [1.0] * len(own.weights)), "{}: weights differ", what)
    flat = [x for p in own.points for x in p]
    for i, (a, b) in enumerate(zip(bits(flat), bits(shape["points"]))):
        need(a == b, "{}: coordinate {} of point {} is {} instead of {}", what, i % 3, i // 3, a, b)
    need(len(flat) == len(shape["points"]), "{}: number of points", what)
    for *place, x, y, z in shape["samples"]:
        gap = math.hypot(*minus(own.at(*place)[0], (x, y, z)))
        size = max(map(abs, shape["points"]))
        need(gap <= FEW_ULPS * size, "{}: at {} evaluated {} away from the model", what, place, gap)


def compare_surface(e, shape):
    s = e.surface
    compare_shape(e.what, s, shape, ([s.du, s.dv, s.nu, s.nv], {"knots_u": s.ku, "knots_v": s.kv}))


def compare_curve(e, shape):
    c = e.curve
    compare_shape(e.what, c, shape, ([c.d, c.n], {"knots": c.k}))


def compare_faces(body, faces, entities):
    """The yarn's faces in their order: body, start, end."""
    surfaces, outlines = iter(body["surfaces"]), iter(body["outlines"])
    compare_surface(faces[0], next(surfaces))
    at = 1
    for style in (() if body["ring"] else (body["start"], body["end"])):
        if style == "none":
            continue
        face = faces[at]
        at += 1
        if style == "planar":
            outline = next(outlines)
            if face.type == 144:
                compare_curve(entities[entities[face.outer].space], outline)
        else:
            need(face.type == 128, "{}: a {} end is not a 128", face.what, style)
            compare_surface(face, next(surfaces))
    need(at == len(faces), "{} faces instead of {}", len(faces), at)


def without_unicode(text):
    return "".join(c if " " <= c <= "~" else "_" for c in text)


def compare_look(e, body, entities):
    for sub, de in (("name", e.properties),):
        need(len(de) == 1 and entities[de[0]].form == 15, "{}: {} property", e.what, sub)
    name = without_unicode(body["name"])
    need(entities[e.properties[0]].name == name, "{}: name {!r}", e.what, entities[e.properties[0]].name)
    need(e.label == name[:8].strip(), "{}: label {!r}", e.what, e.label)
    color = [round(p * 2.55) for p in entities[-e.color].percent]
    need(color == body["color"], "{}: colour {}", e.what, color)
    need(e.level == ROLES.index(body["role"]) + 1, "{}: level {}", e.what, e.level)


def compare(entities, g, sections, model):
    need((g["flag"], g["units"]) == UNITS[model["units"]], "units {}", g["units"])
    need(g["time"] == g["changed"] == model["time"], "time {}", g["time"])
    need(g["file"] == without_unicode(model["file"]), "file name {!r}", g["file"])
    title = without_unicode(model["title"])
    need(g["product"] == g["receiver"] == (title or g["file"]), "product {!r}", g["product"])
    need(title in "".join(line[:72] for line in sections["S"]), "the title is not in the start section")
    need(g["largest"] >= model["largest"], "a coordinate passes the bound {}", g["largest"])
    need(g["largest"] <= model["largest"] * 1.5, "the bound {} is far from the truth", g["largest"])
    colors = [tuple(e.percent) for e in entities.values() if e.type == 314]
    need(len(set(colors)) == len(colors), "a colour is there twice")
    levels = {e.level: e.name for e in entities.values() if (e.type, e.form) == (406, 3)}
    need(all(ROLES[level - 1] == name for level, name in levels.items()), "levels {}", levels)
    need({levels.get(ROLES.index(b["role"]) + 1) for b in model["bodies"]} == {b["role"] for b in model["bodies"]}, "levels")
    heads = [e for e in entities.values() if e.type == (186 if model["solid"] else 402)]
    need(len(heads) == len(model["bodies"]), "{} yarns instead of {}", len(heads), len(model["bodies"]))
    for head, body in zip(heads, model["bodies"]):
        compare_look(head, body, entities)
        if model["solid"]:
            shell = entities[head.shell]
            faces = [entities[entities[f].on] for f, _ in shell.faces]
            compare_faces(body, faces, entities)
            volume = check_solid(head, entities)
            # Gauss's rule is exact for the polynomial surfaces only.
            close = 1e-9 if all(f.flags[2] == 1 for f in faces) else 1e-6
            need(abs(volume - body["volume"]) <= close * body["volume"], "{}: volume {} of {}", head.what, volume, body["volume"])
        else:
            # The entities' own order, not the group's.
            faces = [entities[m] for m in sorted(head.members)]
            need(len(set(head.members)) == len(head.members), "{}: a member twice", head.what)
            for face in faces:
                compare_look(face, body, entities)
            compare_faces(body, faces, entities)
    if not model["solid"]:
        grouped = [m for h in heads for m in h.members]
        alone = [e.de for e in entities.values() if e.type in (128, 144) and e.status[2:4] == "00"]
        need(sorted(grouped) == alone, "faces outside the groups")


def check(path, model_path=None):
    with open(path, "rb") as file:
        sections = split_sections(file.read())
    g = parse_global(sections["G"])
    entities = parse_directory(sections)
    for e in entities.values():
        read_entity(e)
    check_pointers(entities)
    for e in entities.values():
        if e.type == 144:
            check_trimmed(e, entities)
    points = [x for e in entities.values() if e.type == 128 for p in e.surface.points for x in p]
    need(all(abs(x) <= g["largest"] for x in points), "a coordinate passes the bound {}", g["largest"])
    if model_path:
        compare(entities, g, sections, read_model(model_path))
    elif any(e.type == 186 for e in entities.values()):
        for e in entities.values():
            if e.type == 186:
                need(check_solid(e, entities) > 0, "{}: inside out", e.what)
    return entities


def main():
    try:
        entities = check(*sys.argv[1:3])
    except Fault as fault:
        print("%s: %s" % (sys.argv[1], fault))
        return 1
    counts = {}
    for e in entities.values():
        counts[e.type] = counts.get(e.type, 0) + 1
    print("%s: right; %s" % (sys.argv[1], ", ".join("%d x %d" % (n, t) for t, n in sorted(counts.items()))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
