"""Programs of knitting machines, written by parameters: what the tests of knitout read."""

RIGHT, LEFT = "+", "-"


class Program:
    """A machine with two beds of needles 1, 2, ...; carriers change their direction after each pass."""

    def __init__(self, needles, gauge=10, carriers="1 2 3", yarn=None):
        self.needles = needles
        self.lines = [";!knitout-2"]
        if gauge:
            self.lines.append(f";;Gauge: {gauge}")
        self.lines.append(f";;Carriers: {carriers}")
        if yarn:
            self.lines.append(f";;Yarn-1: {yarn}")
        self.side = {}

    def say(self, *words):
        self.lines.append(" ".join(str(word) for word in words))

    def bring(self, carrier="1"):
        self.say("inhook", carrier)
        self.side.setdefault(carrier, RIGHT)

    def row(self, stitches, carrier="1"):
        """One pass: {column: "kf5"} and the like, by columns in the direction of the carrier."""
        if carrier not in self.side:
            self.bring(carrier)
        direction = self.side[carrier]
        verbs = {"k": "knit", "t": "tuck", "m": "miss"}
        for _, stitch in sorted(stitches.items(), reverse=direction == LEFT):
            self.say(verbs[stitch[0]], direction, stitch[1:], carrier)
        self.side[carrier] = LEFT if direction == RIGHT else RIGHT

    def signs(self, text, carrier="1", first=1):
        """One pass: a sign a needle; K P: knit on the front and back bed, T U: tuck there, blank: nothing."""
        words = {"K": "kf", "P": "kb", "T": "tf", "U": "tb"}
        self.row({first + i: f"{words[sign]}{first + i}" for i, sign in enumerate(text) if sign in words}, carrier)

    def cast_on(self, beds=None, carrier="1"):
        """Every other needle on the way out, the rest on the way back."""
        beds = beds or "f" * self.needles
        for turn in (0, 1):
            self.row({i + 1: f"t{bed}{i + 1}" for i, bed in enumerate(beds) if i % 2 == turn}, carrier)

    def knit(self, rows=1, text=None, carrier="1"):
        for _ in range(rows):
            self.signs(text or "K" * self.needles, carrier)

    def move(self, *steps, bed="f"):
        """Loops from needle to needle of one bed over the other one; those that come first lie before the others."""
        other = "b" if bed == "f" else "f"
        for start, _ in steps:
            self.say("xfer", f"{bed}{start}", f"{other}{start}")
        for start, end in steps:
            self.say("rack", end - start if bed == "f" else start - end)
            self.say("xfer", f"{other}{start}", f"{bed}{end}")
        self.say("rack", 0)

    def text(self):
        outs = [f"outhook {carrier}" for carrier in self.side]
        return "\n".join(self.lines + outs) + "\n"


def plain(needles, rows):
    made = Program(needles)
    made.cast_on()
    made.knit(rows)
    return made


def back_bed(needles, rows):
    made = Program(needles)
    made.cast_on("b" * needles)
    made.knit(rows, "P" * needles)
    return made


def rib(pattern, rows):
    made = Program(len(pattern))
    made.cast_on(pattern.replace("K", "f").replace("P", "b"))
    made.knit(rows, pattern)
    return made


def tube(needles, rows):
    made = Program(needles)
    made.row({i: f"tf{i}" for i in range(1, needles + 1, 2)})
    made.row({i: f"tb{i}" for i in range(1, needles + 1, 2)})
    made.row({i: f"tf{i}" for i in range(2, needles + 1, 2)})
    made.row({i: f"tb{i}" for i in range(2, needles + 1, 2)})
    for _ in range(rows):
        made.knit(1)
        made.knit(1, "P" * needles)
    return made


def between_beds(rows):
    """Rows of K and P over the whole width; loops go to the bed that knits them."""
    made = Program(len(rows[0]))
    made.cast_on(rows[0].replace("K", "f").replace("P", "b"))
    before = rows[0]
    for row in rows:
        for i, (old, new) in enumerate(zip(before, row)):
            if old != new:
                source, target = ("f", "b") if new == "P" else ("b", "f")
                made.say("xfer", f"{source}{i + 1}", f"{target}{i + 1}")
        made.knit(1, row)
        before = row
    return made


def moved(needles, *steps, before=2, after=2, bed="f"):
    """Loops of the row before the last ones move."""
    made = Program(needles)
    made.cast_on(bed * needles)
    sign = "K" if bed == "f" else "P"
    made.knit(before, sign * needles)
    made.move(*steps, bed=bed)
    made.knit(after, sign * needles)
    return made


def lace_mesh(needles, rows):
    made = Program(needles)
    made.cast_on()
    made.knit(1)
    for row in range(rows):
        first = 2 + row % 2
        made.move(*[(i, i + 1) for i in range(first, needles - 1, 2)])
        made.knit(2)
    return made


def double_decrease():
    """Two neighbours meet on the middle needle, whose own loop comes last and lies behind."""
    made = Program(7)
    made.cast_on()
    made.knit(2)
    made.move((3, 4), (5, 4), (4, 4))
    made.knit(2)
    return made


def cable(left, right, front="right", rows=2, margin=2):
    """The loops of `left` needles change places with those of `right` needles; `front`: who lean that way pass before."""
    made = Program(left + right + 2 * margin)
    made.cast_on()
    made.knit(rows)
    first = margin + 1
    rightward = [(first + i, first + i + right) for i in reversed(range(left))]
    leftward = [(first + left + i, first + i) for i in range(right)]
    made.move(*(rightward + leftward if front == "right" else leftward + rightward))
    made.knit(rows)
    return made


def plait():
    made = Program(7)
    made.cast_on()
    made.knit(2)
    made.move((3, 4), (4, 3))
    made.knit(2)
    made.move((4, 5), (5, 4))
    made.knit(2)
    return made


def interlock(needles, rows):
    made = Program(needles)
    made.cast_on(("fb" * needles)[:needles])
    made.row({i: f"t{'bf'[i % 2 == 0]}{i}" for i in range(1, needles + 1)})
    for _ in range(rows):
        made.knit(1, ("KP" * needles)[:needles])
        made.knit(1, ("PK" * needles)[:needles])
    return made


def charted(beds, rows):
    """Rows of signs after a cast-on, the first one first."""
    made = Program(len(beds))
    made.cast_on(beds)
    for row in rows:
        made.knit(1, row)
    return made


def jacquard(rows):
    made = Program(len(rows[0]))
    made.cast_on()
    made.knit(1)
    for row in rows:
        for carrier in "12":
            made.signs("".join("K" if sign == carrier else " " for sign in row), carrier)
    return made


def stripes(needles):
    made = Program(needles)
    made.cast_on()
    for carrier in "1122":
        made.knit(1, carrier=carrier)
    return made


def intarsia(needles, rows):
    made = Program(needles)
    made.cast_on()
    half = needles // 2
    for _ in range(rows):
        made.signs("K" * half, "1")
        made.signs("K" * (needles - half), "2", first=half + 1)
    return made


def short_rows(spans, needles=8, after=2):
    made = Program(needles)
    made.cast_on()
    made.knit(2)
    for first, last in spans:
        made.signs("K" * (last - first + 1), first=first)
    made.knit(after)
    return made


def widening(needles, rows):
    made = Program(needles)
    made.cast_on()
    made.knit(1)
    for row in range(rows):
        made.signs("K" * (needles + row + 1))
    return made


def narrowing(needles, rows):
    made = Program(needles)
    made.cast_on()
    made.knit(2)
    for row in range(rows):
        last = needles - row
        made.move((last, last - 1))
        made.signs("K" * (last - 1))
        made.signs("K" * (last - 1))
    return made


def racked_rib(rackings, needles=4):
    """The back bed goes to and fro between rows of a 1x1 rib."""
    made = Program(2 * needles)
    for turn in (0, 1):
        made.row({2 * i + turn: f"t{'fb'[turn]}{2 * i + turn}" for i in range(1, needles + 1)})
    for racking in rackings:
        made.say("rack", racking)
        made.row(
            {
                **{2 * i: f"kf{2 * i}" for i in range(1, needles + 1)},
                **{2 * i + 1 + racking: f"kb{2 * i + 1}" for i in range(1, needles + 1)},
            }
        )
    return made


def all_needle(needles, rows, racking=0.25):
    made = Program(needles)
    made.say("rack", racking)
    stitches = {}
    for i in range(1, needles + 1):
        stitches[2 * i] = f"f{i}"
        stitches[2 * (i + int(racking // 1)) + 1] = f"b{i}"
    columns = sorted(stitches)
    for turn in (0, 1):
        made.row({column: f"t{stitches[column]}" for column in columns[turn::2]})
    for _ in range(rows):
        made.row({column: f"k{stitches[column]}" for column in columns})
    return made


def dropped(needles, which, rows=2):
    made = Program(needles)
    made.cast_on()
    made.knit(2)
    made.say("drop", f"f{which}")
    made.knit(rows, "K" * (which - 1) + " " + "K" * (needles - which))
    return made


def spacer(needles, rows):
    made = Program(needles)
    made.cast_on("f" * needles, "1")
    made.cast_on("b" * needles, "2")
    for _ in range(rows):
        made.knit(1, "K" * needles, "1")
        made.knit(1, "P" * needles, "2")
        made.knit(1, ("TU" * needles)[:needles], "3")
    return made


LAID = {
    "jersey 4x3": plain(4, 3),
    "jersey 7x5": plain(7, 5),
    "jersey 1 wide": plain(1, 3),
    "back bed": back_bed(5, 4),
    "tube": tube(5, 3),
    "rib 1x1": rib("KPKPK", 4),
    "rib 2x2": rib("KKPPKK", 4),
    "rib 3x1": rib("PKKKPKKKP", 3),
    "garter": between_beds(["KKKKK", "PPPPP"] * 2),
    "seed": between_beds(["KPKPK", "PKPKP"] * 2),
    "basket": between_beds(["KKPPKK", "KKPPKK", "PPKKPP", "PPKKPP"]),
    "lace right": moved(6, (3, 4)),
    "lace left": moved(6, (4, 3)),
    "lace far": moved(7, (3, 5)),
    "lace twice": moved(8, (3, 2), (6, 7)),
    "lace of the back bed": moved(6, (3, 4), bed="b"),
    "lace mesh": lace_mesh(8, 2),
    "lace lean": moved(7, (3, 4), (4, 5), (5, 6)),
    "decrease from both sides": moved(7, (3, 4), (5, 4)),
    "decrease behind": double_decrease(),
    "cable 1x1 right": cable(1, 1),
    "cable 1x1 left": cable(1, 1, "left"),
    "cable 1x2": cable(1, 2),
    "cable 2x1": cable(2, 1, "left"),
    "cable 2x2 right": cable(2, 2),
    "cable 2x2 left": cable(2, 2, "left"),
    "cable 3x3 right": cable(3, 3),
    "cable 3x3 left": cable(3, 3, "left"),
    "plait": plait(),
    "interlock": interlock(6, 2),
    "half cardigan": charted("fbfbf", ["KPKPK", "KUKUK"] * 2),
    "full cardigan": charted("fbfbf", ["KUKUK", "TPTPT"] * 2),
    "half milano": charted("fbfbf", ["KPKPK", "K K K"] * 2),
    "milano": charted("fbfbf", ["KPKPK", "K K K", " P P "]),
    "pique": charted("fffff", ["KTKTK", "KKKKK", "TKTKT", "KKKKK"]),
    "tucks over two rows": charted("fffff", ["KKTKK", "KKTKK", "KKKKK"]),
    "floats": charted("ffffff", ["KK KKK", "K KKK K"[:6], "KKKKKK"]),
    "held": charted("fffff", ["KK KK", "KK KK", "KKKKK"]),
    "jacquard": jacquard(["112112", "221221"]),
    "stripes": stripes(5),
    "intarsia": intarsia(6, 3),
    "short rows right": short_rows([(5, 8), (5, 8)]),
    "short rows left": short_rows([(1, 4), (1, 4)]),
    "short rows in steps": short_rows([(1, 6), (1, 6), (1, 4), (1, 4)]),
    "widening": widening(4, 3),
    "narrowing": narrowing(6, 2),
    "racked rib": racked_rib([0, 2, 0, 2]),
    "racked rib one way": racked_rib([0, 2, 4]),
    "all needle": all_needle(4, 3),
    "all needle, other way": all_needle(4, 3, -0.75),
    "dropped": dropped(6, 3),
    "spacer": spacer(6, 2),
}
