"""STEP files of the program's own, and what can be damaged of them without leaving the grammar of the format. Of chance alone: the
same generator of numbers makes the same file."""

import re

from program import GRID, RING, SAMPLES

# Reading sources: one row a kind of file that the program writes.
BASES = [
    ("patch", [GRID]),
    ("fan", [GRID, "--ends", "fan"]),
    ("planar", [RING, "--ends", "planar"]),
    ("open", [GRID, "--ends", "none"]),
    ("plies", [SAMPLES / "ply2_plain.txt", "--step-schema", "AP214"]),
    ("instances", [SAMPLES / "weave_plain.txt", "--instances"]),
    ("pieces", [SAMPLES / "pocket_pieces.txt"]),
    ("cell", [SAMPLES / "cell_straight.txt", "--cut", "--matrix"]),
]
REFERENCE = re.compile(r"#(\d+)")
STATEMENT = re.compile(r"(?m)^#(\d+)\s*=\s*\(?\s*([A-Z0-9_]+)")
WHOLE_STATEMENT = re.compile(r"(?ms)^#(\d+)\s*=.*?;[ \t]*$")
NUMBER = re.compile(r"(?<=[(,])\s*-?\d+\.?\d*(?:E[-+]?\d+)?(?=[,)])")
LIST = re.compile(r"\([^()']*\)")
FLAG = re.compile(r"\.[TF]\.")
OTHERS = ["$", "*", "()", "''", "0.", "1", ".T.", "LENGTH_MEASURE(1.)", "(#1,#2)"]
NUMBERS = [
    "0",
    "0.",
    "-1",
    "1",
    "-1.",
    "1.E-300",
    "1.E300",
    "-1.E300",
    "1.E-7",
    "2147483647",
    "-2147483648",
    "4294967296",
    "1.E19",
    "3",
    "100",
]


def split(text):
    """The text around its DATA section, and that section."""
    begin, end = text.index("DATA;") + 5, text.rindex("ENDSEC;")
    return text[:begin], text[begin:end], text[end:]


def places_of_references(data):
    """Where references stand that are no statement's own number."""
    return [match for match in REFERENCE.finditer(data) if not re.match(r"\s*=", data[match.end() : match.end() + 3])]


def replaced(data, match, new):
    return data[: match.start()] + new + data[match.end() :]


class Base:
    def __init__(self, text):
        self.head, self.data, self.tail = split(text)
        self.references = places_of_references(self.data)
        self.types = {int(number): kind for number, kind in STATEMENT.findall(self.data)}
        self.numbers = sorted(self.types)
        self.of_type = {}
        for number in self.numbers:
            self.of_type.setdefault(self.types[number], []).append(number)

    def other_reference(self, chance, match):
        """What takes the place of a reference: another entity (in a third of the cases of the same type), or no reference."""
        kind = chance.randrange(6)
        if kind == 0:
            return chance.choice(OTHERS)
        number = int(match.group(1))
        if kind < 3 and number in self.types:
            return f"#{chance.choice(self.of_type[self.types[number]])}"
        return f"#{chance.choice(self.numbers)}"

    def mutated(self, chance):
        """One reference is another one."""
        match = chance.choice(self.references)
        return self.head + replaced(self.data, match, self.other_reference(chance, match)) + self.tail

    def damaged(self, chance):
        """One to four damages of any kind."""
        kinds = [
            self.reference,
            self.reference,
            self.number,
            self.number,
            self.listed,
            self.flag,
            self.type,
            self.statement,
        ]
        data = self.data
        for _ in range(chance.randint(1, 4)):
            data = chance.choice(kinds)(data, chance)
        return self.head + data + self.tail

    @staticmethod
    def at_chance(pattern, data, chance):
        """One of the places of a pattern; none: it has no place."""
        places = list(pattern.finditer(data))
        return chance.choice(places) if places else None

    def reference(self, data, chance):
        places = places_of_references(data)
        match = chance.choice(places) if places else None
        return replaced(data, match, self.other_reference(chance, match)) if match else data

    def number(self, data, chance):
        match = self.at_chance(NUMBER, data, chance)
        if not match:
            return data
        value = float(match.group())
        near = [f"{value * factor!r}".upper() for factor in (-1, 1 + 1e-6, 0.5, 1000)]
        whole = "." not in match.group()
        return replaced(
            data, match, chance.choice(NUMBERS + ([str(int(value) + step) for step in (-1, 1)] if whole else near))
        )

    def listed(self, data, chance):
        """A list without an element, with one twice, in another order, or empty."""
        match = self.at_chance(LIST, data, chance)
        if not match:
            return data
        words = match.group()[1:-1].split(",")
        at, kind = chance.randrange(len(words)), chance.randrange(4)
        if kind == 0:
            del words[at]
        elif kind == 1:
            words.insert(at, words[at])
        elif kind == 2:
            chance.shuffle(words)
        else:
            words = words[:at]
        return replaced(data, match, f"({','.join(words)})")

    def flag(self, data, chance):
        match = self.at_chance(FLAG, data, chance)
        return replaced(data, match, ".F." if match.group() == ".T." else ".T.") if match else data

    def type(self, data, chance):
        match = self.at_chance(STATEMENT, data, chance)
        if not match:
            return data
        begin = match.start(2)
        return data[:begin] + chance.choice(sorted(self.of_type)) + data[match.end(2) :]

    def statement(self, data, chance):
        """One that is missing, that has another's number, or that is there with another's content."""
        match, other = (self.at_chance(WHOLE_STATEMENT, data, chance) for _ in range(2))
        if not match:
            return data
        kind = chance.randrange(3)
        if kind == 0:
            return replaced(data, match, "")
        if kind == 1:
            return replaced(data, match, match.group() + "\n" + re.sub(r"^#\d+", f"#{other.group(1)}", match.group()))
        return replaced(data, match, re.sub(r"^#\d+", f"#{match.group(1)}", other.group()))
