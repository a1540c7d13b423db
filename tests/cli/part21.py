"""A strict reader of Part 21 files (ISO 10303-21), and of the entities that STEP files of yarns consist of: whatever is not as the
grammar and the schema have it is an error. Independent of the program and of OpenCASCADE."""

import re


class Wrong(Exception):
    pass


class Ref(int):
    """The number of an entity."""


class Enum(str):
    """A word between dots."""


class Typed(tuple):
    """(NAME, value): a value that says its type."""


UNSET, DERIVED = Enum("$"), Enum("*")

TOKEN = re.compile(
    r"""
    (?P<space>(?:[ \n]|/\*.*?\*/)+)
  | (?P<string>'(?:[^'\n]|'')*')
  | (?P<real>[+-]?[0-9]+\.[0-9]*(?:E[+-]?[0-9]+)?)
  | (?P<integer>[+-]?[0-9]+)
  | (?P<ref>\#[1-9][0-9]*)
  | (?P<enum>\.[A-Z_][A-Z0-9_]*\.)
  | (?P<word>[A-Z_][A-Z0-9_-]*)
  | (?P<sign>[$*(),;=])""",
    re.VERBOSE | re.DOTALL,
)
CODES = re.compile(r"\\X2\\((?:[0-9A-F]{4})+)\\X0\\|\\X4\\((?:[0-9A-F]{8})+)\\X0\\")


def decoded(quoted):
    text = quoted[1:-1].replace("''", "'")
    if any(not " " <= c <= "~" for c in text):
        raise Wrong(f"a character that is not allowed in {quoted}")
    if "\\" in CODES.sub("", text):
        raise Wrong(f"an unknown code in {quoted}")
    return CODES.sub(lambda m: bytes.fromhex(m[1] or m[2]).decode("utf-16-be" if m[1] else "utf-32-be"), text)


class File:
    """header: {keyword: attributes}; entities: {number: {keyword: attributes}}, of one part but for complex ones."""

    def __init__(self, text):
        self.tokens, at = [], 0
        while at < len(text):
            match = TOKEN.match(text, at)
            if match is None:
                raise Wrong(f"no token: {text[at:at + 40]!r}")
            at = match.end()
            if match.lastgroup != "space":
                self.tokens.append((match.lastgroup, match[0]))
        self.tokens.append(("end", ""))
        self.at = 0
        self.header, self.entities = {}, {}
        self.read()
        del self.tokens

    def next(self, wanted=None):
        kind, word = self.tokens[self.at]
        if wanted is not None and word != wanted:
            raise Wrong(f"{wanted} is missing before {word!r}, token {self.at}")
        self.at += 1
        return kind, word

    def is_next(self, word):
        return self.tokens[self.at][1] == word

    def read(self):
        for word in ("ISO-10303-21", ";", "HEADER", ";"):
            self.next(word)
        while not self.is_next("ENDSEC"):
            keyword = self.keyword()
            self.header[keyword] = self.attributes()
            self.next(";")
        if list(self.header) != ["FILE_DESCRIPTION", "FILE_NAME", "FILE_SCHEMA"]:
            raise Wrong(f"the header has {list(self.header)}")
        for word in ("ENDSEC", ";", "DATA", ";"):
            self.next(word)
        while not self.is_next("ENDSEC"):
            kind, word = self.next()
            if kind != "ref":
                raise Wrong(f"an entity begins with {word!r}")
            number = int(word[1:])
            if number in self.entities:
                raise Wrong(f"#{number} is there twice")
            self.next("=")
            parts = {}
            if self.is_next("("):
                self.next()
                while not self.is_next(")"):
                    keyword = self.keyword()
                    if parts and keyword <= list(parts)[-1]:
                        raise Wrong(f"#{number}: parts of a complex entity stand in the order of their names")
                    parts[keyword] = self.attributes()
                self.next()
                if len(parts) < 2:
                    raise Wrong(f"#{number}: a complex entity of {len(parts)} parts")
            else:
                keyword = self.keyword()
                parts[keyword] = self.attributes()
            self.entities[number] = parts
            self.next(";")
        for word in ("ENDSEC", ";"):
            self.next(word)
        if self.next()[1] != "END-ISO-10303-21" or self.next()[1] != ";" or self.next()[0] != "end":
            raise Wrong("it does not end with END-ISO-10303-21;")

    def keyword(self):
        kind, word = self.next()
        if kind != "word" or "-" in word:
            raise Wrong(f"{word!r} where a keyword should be")
        return word

    def attributes(self):
        self.next("(")
        values = []
        while not self.is_next(")"):
            if values:
                self.next(",")
            values.append(self.value())
        self.next()
        return values

    def value(self):
        kind, word = self.next()
        if kind == "string":
            return decoded(word)
        if kind == "real":
            return float(word)
        if kind == "integer":
            return int(word)
        if kind == "ref":
            return Ref(word[1:])
        if kind == "enum" or word in "$*":
            return Enum(word)
        if kind == "word":
            values = self.attributes() if self.is_next("(") else []
            if len(values) != 1:
                raise Wrong(f"{word} has {len(values)} values")
            return Typed((word, values[0]))
        if word == "(":
            self.at -= 1
            return self.attributes()
        raise Wrong(f"{word!r} where a value should be")

    def one(self, number, *names):
        """The attributes of an entity that is one of these."""
        parts = self.entities[number]
        for name in names:
            if name in parts:
                return parts[name]
        raise Wrong(f"#{number} is {'+'.join(parts)}, not {' or '.join(names)}")

    def all(self, name):
        return [number for number, parts in self.entities.items() if name in parts]


# Attributes, as the schemas have them. S string, I integer, R real, B boolean, E enumeration, $ not set, * derived, M NAME: a
# measure that says its type, @A|B: an entity that is one of these, [x]: a list of one or more, [[x]]: rows. x$: or not set.
CURVES = "@B_SPLINE_CURVE_WITH_KNOTS"
SURFACES = "@B_SPLINE_SURFACE_WITH_KNOTS|PLANE"
UNITS = "@NAMED_UNIT|DERIVED_UNIT"
CONTEXT = "@GEOMETRIC_REPRESENTATION_CONTEXT"
SHAPES = "@SHAPE_REPRESENTATION|ADVANCED_BREP_SHAPE_REPRESENTATION|MANIFOLD_SURFACE_SHAPE_REPRESENTATION"
SOLIDS = "@MANIFOLD_SOLID_BREP|SHELL_BASED_SURFACE_MODEL"
SCHEMA = {
    "APPLICATION_CONTEXT": "S",
    "APPLICATION_PROTOCOL_DEFINITION": "S S I @APPLICATION_CONTEXT",
    "PRODUCT_CONTEXT": "S @APPLICATION_CONTEXT S",
    "PRODUCT_DEFINITION_CONTEXT": "S @APPLICATION_CONTEXT S",
    "PRODUCT": "S S S$ [@PRODUCT_CONTEXT]",
    "PRODUCT_RELATED_PRODUCT_CATEGORY": "S S$ [@PRODUCT]",
    "PRODUCT_DEFINITION_FORMATION": "S S$ @PRODUCT",
    "PRODUCT_DEFINITION": "S S$ @PRODUCT_DEFINITION_FORMATION @PRODUCT_DEFINITION_CONTEXT",
    "PRODUCT_DEFINITION_SHAPE": "S S$ @PRODUCT_DEFINITION|NEXT_ASSEMBLY_USAGE_OCCURRENCE",
    "NEXT_ASSEMBLY_USAGE_OCCURRENCE": "S S S$ @PRODUCT_DEFINITION @PRODUCT_DEFINITION S$",
    "SHAPE_DEFINITION_REPRESENTATION": "@PRODUCT_DEFINITION_SHAPE " + SHAPES,
    "SHAPE_REPRESENTATION": "S [@AXIS2_PLACEMENT_3D] " + CONTEXT,
    "ADVANCED_BREP_SHAPE_REPRESENTATION": "S [@AXIS2_PLACEMENT_3D|MANIFOLD_SOLID_BREP] " + CONTEXT,
    "MANIFOLD_SURFACE_SHAPE_REPRESENTATION": "S [@AXIS2_PLACEMENT_3D|SHELL_BASED_SURFACE_MODEL] " + CONTEXT,
    "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION": "@SHAPE_REPRESENTATION_RELATIONSHIP @PRODUCT_DEFINITION_SHAPE",
    "ITEM_DEFINED_TRANSFORMATION": "S S$ @AXIS2_PLACEMENT_3D @AXIS2_PLACEMENT_3D",
    "REPRESENTATION_RELATIONSHIP": f"S S$ {SHAPES} {SHAPES}",
    "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION": "@ITEM_DEFINED_TRANSFORMATION",
    "SHAPE_REPRESENTATION_RELATIONSHIP": "",
    "GEOMETRIC_REPRESENTATION_CONTEXT": "I",
    "GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT": "[@UNCERTAINTY_MEASURE_WITH_UNIT]",
    "GLOBAL_UNIT_ASSIGNED_CONTEXT": "[@NAMED_UNIT]",
    "REPRESENTATION_CONTEXT": "S S",
    "UNCERTAINTY_MEASURE_WITH_UNIT": "M:LENGTH_MEASURE @LENGTH_UNIT S S$",
    "LENGTH_MEASURE_WITH_UNIT": "M:LENGTH_MEASURE @LENGTH_UNIT",
    "CONVERSION_BASED_UNIT": "S @LENGTH_MEASURE_WITH_UNIT",
    "LENGTH_UNIT": "",
    "MASS_UNIT": "",
    "PLANE_ANGLE_UNIT": "",
    "SOLID_ANGLE_UNIT": "",
    "NAMED_UNIT": "@DIMENSIONAL_EXPONENTS*",
    "SI_UNIT": "E$ E",
    "DIMENSIONAL_EXPONENTS": "R R R R R R R",
    "DERIVED_UNIT": "[@DERIVED_UNIT_ELEMENT]",
    "DERIVED_UNIT_ELEMENT": "@NAMED_UNIT R",
    "CARTESIAN_POINT": "S [R]",
    "DIRECTION": "S [R]",
    "AXIS2_PLACEMENT_3D": "S @CARTESIAN_POINT @DIRECTION @DIRECTION",
    "PLANE": "S @AXIS2_PLACEMENT_3D",
    "B_SPLINE_CURVE_WITH_KNOTS": "S I [@CARTESIAN_POINT] E E E [I] [R] E",
    "B_SPLINE_SURFACE_WITH_KNOTS": "S I I [[@CARTESIAN_POINT]] E E E E [I] [I] [R] [R] E",
    "VERTEX_POINT": "S @CARTESIAN_POINT",
    "EDGE_CURVE": f"S @VERTEX_POINT @VERTEX_POINT {CURVES} B",
    "ORIENTED_EDGE": "S * * @EDGE_CURVE B",
    "EDGE_LOOP": "S [@ORIENTED_EDGE]",
    "FACE_OUTER_BOUND": "S @EDGE_LOOP B",
    "ADVANCED_FACE": f"S [@FACE_OUTER_BOUND] {SURFACES} B",
    "CLOSED_SHELL": "S [@ADVANCED_FACE]",
    "OPEN_SHELL": "S [@ADVANCED_FACE]",
    "MANIFOLD_SOLID_BREP": "S @CLOSED_SHELL",
    "SHELL_BASED_SURFACE_MODEL": "S [@OPEN_SHELL]",
    "STYLED_ITEM": "S [@PRESENTATION_STYLE_ASSIGNMENT] " + SOLIDS,
    "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION": "S [@STYLED_ITEM] " + CONTEXT,
    "PRESENTATION_STYLE_ASSIGNMENT": "[@SURFACE_STYLE_USAGE]",
    "SURFACE_STYLE_USAGE": "E @SURFACE_SIDE_STYLE",
    "SURFACE_SIDE_STYLE": "S [@SURFACE_STYLE_FILL_AREA]",
    "SURFACE_STYLE_FILL_AREA": "@FILL_AREA_STYLE",
    "FILL_AREA_STYLE": "S [@FILL_AREA_STYLE_COLOUR]",
    "FILL_AREA_STYLE_COLOUR": "S @COLOUR_RGB",
    "COLOUR_RGB": "S R R R",
    "PRESENTATION_LAYER_ASSIGNMENT": f"S S [{SOLIDS}]",
    "PROPERTY_DEFINITION": "S S$ @PRODUCT_DEFINITION_SHAPE|PRODUCT_DEFINITION",
    "PROPERTY_DEFINITION_REPRESENTATION": "@PROPERTY_DEFINITION @REPRESENTATION",
    "REPRESENTATION": "S [@MEASURE_REPRESENTATION_ITEM|CARTESIAN_POINT|DESCRIPTIVE_REPRESENTATION_ITEM] " + CONTEXT,
    "MEASURE_REPRESENTATION_ITEM": "S M:VOLUME_MEASURE|AREA_MEASURE|POSITIVE_RATIO_MEASURE @DERIVED_UNIT",
    "DESCRIPTIVE_REPRESENTATION_ITEM": "S S",
}
# Complex entities, as the program has them: rational splines come apart into their supertypes.
IN_PARTS = {
    "BOUNDED_CURVE": "",
    "CURVE": "",
    "GEOMETRIC_REPRESENTATION_ITEM": "",
    "BOUNDED_SURFACE": "",
    "SURFACE": "",
    "REPRESENTATION_ITEM": "S",
    "B_SPLINE_CURVE": "I [@CARTESIAN_POINT] E E E",
    "B_SPLINE_CURVE_WITH_KNOTS": "[I] [R] E",
    "RATIONAL_B_SPLINE_CURVE": "[R]",
    "B_SPLINE_SURFACE": "I I [[@CARTESIAN_POINT]] E E E E",
    "B_SPLINE_SURFACE_WITH_KNOTS": "[I] [I] [R] [R] E",
    "RATIONAL_B_SPLINE_SURFACE": "[[R]]",
}


def check(file):
    """Every entity is one of SCHEMA with its attributes, whatever they refer to is there and of the right type, and all is used."""
    used = set()

    def fits(value, kind):
        if kind.endswith("$"):
            return value is not DERIVED and (value == UNSET or fits(value, kind[:-1]))
        if kind.endswith("*"):
            return value == DERIVED or (len(kind) > 1 and fits(value, kind[:-1]))
        if kind.startswith("["):
            return isinstance(value, list) and len(value) > 0 and all(fits(v, kind[1:-1]) for v in value)
        if kind.startswith("@"):
            if not isinstance(value, Ref) or value not in file.entities:
                return False
            used.add(int(value))
            return any(name in file.entities[value] for name in kind[1:].split("|"))
        if kind.startswith("M:"):
            return isinstance(value, Typed) and value[0] in kind[2:].split("|") and isinstance(value[1], float)
        if kind == "B":
            return value in (".T.", ".F.") and isinstance(value, Enum)
        if kind == "E":
            return isinstance(value, Enum) and value not in (UNSET, DERIVED)
        if kind == "S":
            return isinstance(value, str) and not isinstance(value, Enum)
        return type(value) is {"I": int, "R": float}[kind]

    for number, parts in file.entities.items():
        for name, values in parts.items():
            table = IN_PARTS if len(parts) > 1 and name in IN_PARTS else SCHEMA
            if name not in table:
                raise Wrong(f"#{number}: {name} is not expected")
            kinds = table[name].split()
            if len(kinds) != len(values) or not all(map(fits, values, kinds)):
                raise Wrong(f"#{number}: {name}{values} is not {kinds}")
    roots = {
        "DERIVED_UNIT",
        "APPLICATION_PROTOCOL_DEFINITION",
        "PRODUCT_RELATED_PRODUCT_CATEGORY",
        "SHAPE_DEFINITION_REPRESENTATION",
        "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION",
        "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION",
        "PRESENTATION_LAYER_ASSIGNMENT",
        "PROPERTY_DEFINITION_REPRESENTATION",
    }
    for number, parts in file.entities.items():
        if number not in used and not roots & set(parts):
            raise Wrong(f"#{number} {'+'.join(parts)}: nothing refers to it")
