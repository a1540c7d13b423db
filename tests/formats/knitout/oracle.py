"""A knitting machine of its own: what a program knits, as loops and what each is drawn through.

Written from the specification of knitout 2, not from the program under test: F = B + R, that is, at racking R the back
needle B faces the front needle B + R."""

import math


class Loop:
    def __init__(self, carrier, bed, place, through):
        self.carrier, self.bed, self.place = carrier, bed, place
        self.through = through  # loops, from the needle's own bed on
        self.is_knit_off = False


class Machine:
    def __init__(self, text):
        self.needles, self.loops, self.racking = {}, [], 0.0
        for line in text.splitlines():
            words = line.split(";")[0].split()
            if words:
                self.run(words)

    def place(self, needle):
        number = float(needle[1:])
        return number if needle[0] == "f" else number + self.racking

    def run(self, words):
        verb, rest = words[0], words[1:]
        if verb == "rack":
            self.racking = float(rest[0])
        elif verb == "xfer":
            source, target = rest
            assert source[0] != target[0] and self.place(source) == self.place(target), words
            # The stack turns over: what lay next to the one bed lies farthest from the other.
            self.needles.setdefault(target, []).extend(reversed(self.needles.pop(source, [])))
        elif verb == "drop" or (verb == "knit" and len(rest) == 2):
            self.needles.pop(rest[-1], None)
        elif verb in ("knit", "tuck"):
            needle, carrier = rest[1], " ".join(rest[2:])
            held = self.needles.setdefault(needle, [])
            loop = Loop(carrier, needle[0], self.place(needle), [])
            if verb == "knit":
                loop.through = list(held)
                for below in held:
                    below.is_knit_off = True
                held.clear()
            held.append(loop)
            self.loops.append(loop)


def columns(loops):
    """Of each loop its column from the left, from 0, in a chart with two columns a needle where the racking has a fraction."""
    if any(loop.place != int(loop.place) for loop in loops):
        at = [2 * math.floor(loop.place) + (loop.bed == "b") for loop in loops]
    else:
        at = [int(loop.place) for loop in loops]
    first = min(at)
    return [column - first for column in at]


def named_links(loops):
    """Links of loops that are named by column, bed and how many of these lie below: what is drawn through what."""
    names, counts = {}, {}
    for loop, column in zip(loops, columns(loops)):
        key = (column, loop.bed)
        counts[key] = counts.get(key, 0) + 1
        names[loop] = (*key, counts[key])
    return sorted((names[loop], tuple(names[below] for below in loop.through)) for loop in loops)
