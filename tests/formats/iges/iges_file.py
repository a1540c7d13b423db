"""A parser of fixed 80-column IGES 5.3 files that checks everything which the format says about itself. For
iges_oracle.py; the standard library only."""

import math
import re

from bspline import Curve, Surface, clamped, dot

UNITS = {"inch": (1, "INCH"), "mm": (2, "MM"), "m": (6, "M"), "um": (9, "UM"), "cm": (10, "CM")}


class Fault(Exception):
    pass


def need(condition, text, *values):
    if not condition:
        raise Fault(text.format(*values))


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
        need(
            isinstance(value, str) and re.fullmatch(r"-?(0|[1-9]\d*)", value),
            "{}: {!r} is no integer",
            self.what,
            value,
        )
        return int(value)

    def real(self):
        value = self.take()
        form = r"-?\d+\.\d*(E[+-]\d+)?"
        need(isinstance(value, str) and re.fullmatch(form, value), "{}: {!r} is no real", self.what, value)
        number = float(value)
        digits = value.split("E")[0].lstrip("-").replace(".", "").strip("0")
        shortest = repr(number).split("e")[0].lstrip("-").replace(".", "").strip("0")
        # Integers beyond 2^53 may be written out; every other number has its shortest digits.
        need(
            len(digits) <= len(shortest) or abs(number) >= 2.0**53,
            "{}: {!r} has more digits than it needs",
            self.what,
            value,
        )
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
        need(
            re.fullmatch(r"\d{4}(0[1-9]|1[0-2])([0-2]\d|3[01])\.([01]\d|2[0-3])[0-5]\d[0-5]\d", time), "date {!r}", time
        )
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
        e.on = read_pointers(r, e, 1, 128)[0]
        e.flat, e.space = (read_pointers(r, e, 1, 126, 102)[0] for _ in range(2))
        need(r.integer() in (0, 1, 2, 3), "{}: preference", e.what)
    elif key == (102, 0):
        e.parts = read_pointers(r, e, r.integer(), 126)
    elif key == (144, 0):
        e.on = read_pointers(r, e, 1, 128)[0]
        need((r.integer(), r.integer()) == (1, 0), "{}: boundaries", e.what)
        e.outer = read_pointers(r, e, 1, 142)[0]
    elif key == (402, 7):
        e.members = read_pointers(r, e, r.integer(), 128, 144, 126)
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
        e.uses, e.flats = [], []  # an edge's curves in the parameters
        for _ in range(r.integer()):
            kind = r.integer()
            need(kind in (0, 1), "{}: kind of edge", e.what)
            e.uses.append((kind, read_pointers(r, e, 1, (504, 502)[kind])[0], r.integer(), r.integer()))
            flats = []
            for _ in range(r.integer()):
                need(r.integer() == 0, "{}: along a parameter", e.what)
                flats += read_pointers(r, e, 1, 126)
            e.flats.append(flats)
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
        use = "02" if e.type == 314 else "05" if e.type in (126, 102) and is_flat(e, entities) else "00"
        need(e.status[4:6] == use, "{}: use flag of {!r}", e.what, e.status)


def is_flat(e, entities):
    return any(
        e.de in [c.flat, *getattr(entities[c.flat], "parts", [])]
        if c.type == 142
        else c.type == 508 and [e.de] in c.flats
        for c in entities.values()
    )


def curves_of(e, entities):
    """The B-splines of a curve entity in their order: of a 126 itself, of a 102 its parts, which meet to the last bit."""
    if e.type == 126:
        return [e.curve]
    curves = [entities[part].curve for part in e.parts]
    for a, b in zip(curves, curves[1:]):
        need(a.points[-1] == b.points[0], "{}: parts that do not meet", e.what)
    return curves


def check_knots(knots, what):
    need(all(a <= b for a, b in zip(knots, knots[1:])), "{}: knots decrease", what)
