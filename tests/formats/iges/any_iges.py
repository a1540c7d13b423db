"""A parser of any conforming fixed-length ASCII IGES file: other delimiters, strings with delimiters inside, D
exponents, defaulted fields, DOS line ends. It takes a file as it is meant; iges_file.py is the strict one, for the
files that the program writes. For iges_model.py; the standard library only."""

import re


class Fault(Exception):
    pass


def need(condition, text, *values):
    if not condition:
        raise Fault(text.format(*values))


# Millimetres in one unit by its flag; flag 3 goes by the name.
MILLIMETRES = {1: 25.4, 2: 1.0, 4: 304.8, 5: 1609344.0, 6: 1000.0, 7: 1e6, 8: 0.0254, 9: 1e-3, 10: 10.0, 11: 2.54e-5}
BY_NAME = {"INCH": 1, "IN": 1, "MM": 2, "FT": 4, "MI": 5, "M": 6, "KM": 7, "MIL": 8, "UM": 9, "CM": 10, "UIN": 11}


def split_sections(data):
    sections = {letter: [] for letter in "SGDPT"}
    for raw in data.decode("latin-1").split("\n"):
        line = raw[:-1] if raw.endswith("\r") else raw
        if line.strip("\x1a\x00 ") == "":
            continue
        need(len(line) > 72 and line[72] in sections, "a line without a section letter: {!r}", line)
        sections[line[72]].append(line)
    return sections


def end_of(ends, text, at):
    found = ends.search(text, at)
    return found.start() if found else len(text)


def tokens(text, delimiter, record, at=0):
    """The values from `at` to the record delimiter: strings as a tuple of one, the rest as bare text; and where it
    ended."""
    values, ends, counted = [], re.compile(f"[{re.escape(delimiter + record)}]"), re.compile(r"(\d+) *H")
    while True:
        while at < len(text) and text[at] == " ":
            at += 1
        string = counted.match(text, at)
        if string:
            at = string.end() + int(string.group(1))
            need(at <= len(text), "a string runs out of its record")
            values.append((text[string.end() : at],))
            rest, at = at, end_of(ends, text, at)
            need(text[rest:at].strip() == "", "text after a string: {!r}", text[rest:at])
        else:
            start, at = at, end_of(ends, text, at)
            values.append(text[start:at].replace(" ", ""))
        need(at < len(text), "no record delimiter")
        at += 1
        if text[at - 1] == record:
            return values, at


def global_tokens(lines):
    text = "".join(line[:72] for line in lines)
    delimiter, at = ",", 0
    if text[0] != ",":
        need(text[:2] == "1H", "the global section begins with {!r}", text[:10])
        delimiter, at = text[2], 3
    need(text[at] == delimiter, "the first delimiter is not followed by itself")
    at += 1
    record = ";"
    if text[at] != delimiter:
        need(text[at : at + 2] == "1H", "the second parameter begins with {!r}", text[at : at + 8])
        record, at = text[at + 2], at + 3
    at += 1
    return delimiter, record, tokens(text, delimiter, record, at)[0] if text[at - 1] != record else []


def integer_of(value, default=0):
    if value == "":
        return default
    need(isinstance(value, str) and re.fullmatch(r"[+-]?\d+", value), "{!r} is no integer", value)
    return int(value)


def real_of(value, default=0.0):
    if value == "":
        return default
    need(
        isinstance(value, str) and re.fullmatch(r"[+-]?(\d+\.?\d*|\.\d+)([EeDd][+-]?\d+)?", value),
        "{!r} is no number",
        value,
    )
    return float(value.upper().replace("D", "E"))


class Values:
    """Typed values in order; what is missing at the end has its default."""

    def __init__(self, values, what):
        self.values, self.what, self.at = values, what, 0

    def take(self):
        self.at += 1
        return self.values[self.at - 1] if self.at <= len(self.values) else ""

    def integer(self, default=0):
        return integer_of(self.take(), default)

    def real(self, default=0.0):
        return real_of(self.take(), default)

    def reals(self, count):
        return [self.real() for _ in range(count)]

    def point(self):
        return tuple(self.reals(3))

    def points(self, count):
        return [self.point() for _ in range(count)]

    def integers(self, count):
        need(0 <= count <= len(self.values), "{}: a count of {}", self.what, count)
        return [self.integer() for _ in range(count)]

    def string(self, default=""):
        value = self.take()
        return value[0] if isinstance(value, tuple) else default

    def more(self):
        return self.at < len(self.values)


class Entity:
    """type, form, level, colour, matrix (directory pointer), status, label, and the values after the type."""


class File:
    def __init__(self, data):
        sections = split_sections(data)
        self.lines = {letter: len(lines) for letter, lines in sections.items()}
        self.delimiter, self.record, rest = global_tokens(sections["G"])
        self.read_global(Values(rest, "global section"))
        self.entities = {}
        directory, parameters = sections["D"], sections["P"]
        for at in range(0, len(directory) - 1, 2):
            e = self.entity(directory[at].ljust(80), directory[at + 1].ljust(80), at + 1, parameters)
            self.entities[e.de] = e

    def read_global(self, g):
        self.product, self.name, self.system, self.version = (g.string() for _ in range(4))
        g.integers(5)
        self.receiver = g.string()
        self.scale = g.real(1.0)
        self.flag = g.integer(1)
        self.unit_name = g.string()
        self.millimetres = MILLIMETRES[BY_NAME[self.unit_name.upper()] if self.flag == 3 else self.flag]
        g.take(), g.take()
        self.date = g.string()
        self.resolution, self.largest = g.real(), g.real()

    def entity(self, first, second, de, parameters):
        fields = [line[8 * i : 8 * i + 8].strip() for line in (first, second) for i in range(9)]
        e = Entity()
        e.de, e.type, e.form = de, integer_of(fields[0]), integer_of(fields[13])
        e.level, e.matrix, e.color = (integer_of(fields[i]) for i in (4, 6, 11))
        e.status = first[64:72].replace(" ", "0")
        e.label, e.subscript = fields[16], fields[17]
        e.what = "%d form %d at D%d" % (e.type, e.form, de)
        start, count = integer_of(fields[1]), integer_of(fields[12], 1)
        text = "".join(line[:64] for line in parameters[start - 1 : start - 1 + max(count, 1)])
        e.values = tokens(text, self.delimiter, self.record)[0] if e.type else [""]
        need(e.type == 0 or integer_of(e.values[0]) == e.type, "{}: parameters of another type", e.what)
        e.values = e.values[1:]
        return e
