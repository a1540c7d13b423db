"""Constructions of seeded random sizes come out free of overlap: `check` finds nothing.

SELVAGE_FREE_COUNT: how many of each kind.
"""

import os
import random
import unittest

from program import Case, run

COUNT = int(os.environ.get("SELVAGE_FREE_COUNT", "6"))


def number(value):
    return f"{value:.6g}"


def section(dice, width, height):
    """A section of about this size: its line, and its width and thickness."""
    form = dice.choice(["circle", "ellipse", "lenticular", "racetrack", "power"])
    if form == "circle":
        return f"circle {number(height)}", height, height
    exponent = f" {number(dice.uniform(0.7, 1.3))}" if form == "power" else ""
    return f"{form} {number(width)} {number(height)}{exponent}", width, height


def weave(dice):
    threads, sizes = [], []
    for name in ("a", "b"):
        line, width, height = section(dice, dice.uniform(0.5, 1.2), dice.uniform(0.12, 0.4))
        threads.append(f"thread {name}\n  section {line}\nend\n")
        sizes.append((width, height))
    height = sizes[0][1] + sizes[1][1]
    draft = dice.choice(["plain", "twill 2/2", "twill 2/1", "twill 3/1", "satin 5/2", "basket 2/2"])
    profile = dice.choice(["", "", "  profile sine\n"])
    layers = dice.choice(["", "", "  layers 2\n"])
    # Room beside each yarn for the one that passes between it and its neighbour.
    return "".join(threads) + (
        f"weave\n  warp a 4 pitch {number(sizes[0][0] + dice.uniform(0.8, 2.0) * height)}\n"
        f"  weft b 4 pitch {number(sizes[1][0] + dice.uniform(0.8, 2.0) * height)}\n  draft {draft}\n{profile}{layers}end\n"
    )


def bound_weave(dice):
    threads, sizes = [], []
    for name in ("a", "b", "c"):
        line, width, height = section(dice, dice.uniform(0.5, 1.2), dice.uniform(0.12, 0.4))
        if name == "c":
            width = height = dice.uniform(0.1, 0.3)
            line = f"circle {number(height)}"
        threads.append(f"thread {name}\n  section {line}\nend\n")
        sizes.append((width, height))
    layers = dice.randint(1, 3)
    top = layers + 1
    binders = dice.choice(
        [
            [f"{top} 0", f"0 {top}"],
            [f"{top} 1", f"0 {top - 1}"],
            [" ".join(map(str, [*range(top), *range(top, 0, -1)]))] * 2,
        ]
    )
    lines = "".join(f"  binder c every 2 first {i + 1} levels {levels}\n" for i, levels in enumerate(binders))
    rise = (layers + 1) * (sizes[0][1] + sizes[1][1])
    return "".join(threads) + (
        f"weave\n  warp a 3 pitch {number(sizes[0][0] + sizes[2][0] * dice.uniform(1.1, 1.6))}\n"
        f"  weft b 4 pitch {number(sizes[1][0] + rise * dice.uniform(0.9, 1.3) + 2 * sizes[2][0])}\n"
        f"  profile straight\n  layers {layers}\n{lines}end\n"
    )


def lapping(dice, length, widest, wraps):
    steps = []
    for _ in range(length):
        at = dice.randint(0, widest)
        steps.append(dice.choice([f"{at + 1}-{at}", f"{at}-{at + 1}"]) if wraps else f"{at}-{at}")
    return "/".join(steps)


def warpknit(dice):
    bars, threads = [], "thread a\n  diameter 0.1\nend\nthread b\n  diameter 0.08\nend\n"
    count = dice.randint(1, 3)
    length = dice.choice([1, 2, 2, 3, 4])
    for i in range(count):
        wraps = i == 0 or dice.random() < 0.6
        bars.append(
            f"  bar {dice.choice('ab')} {lapping(dice, dice.choice([length, 2 * length]), dice.randint(1, 4), wraps)}\n"
        )
    knitting = sum(
        "-" in bar and any(a != b for a, b in (s.split("-") for s in bar.split()[2].split("/"))) for bar in bars
    )
    wale = (2 * knitting + 2) * 0.1 * dice.uniform(1.02, 2.0)
    course = (2 * knitting + 4.4) * 0.1 * dice.uniform(1.02, 2.0)
    return (
        threads + f"warpknit\n{''.join(bars)}  wales 4 pitch {number(wale)}\n  courses 5 pitch {number(course)}\nend\n"
    )


CLASSICS = ["tricot", "cord", "satin", "velvet", "locknit", "queens-cord", "atlas"]


def classic(dice):
    name = dice.choice(CLASSICS)
    bars = 2 if name in ("locknit", "queens-cord") else 1
    wale = (2 * bars + 2) * 0.1 * dice.uniform(1.02, 2.5)
    course = (2 * (bars - 1) + 4.4) * 0.1 * dice.uniform(1.02, 2.5)
    return (
        f"thread a\n  diameter 0.1\nend\nwarpknit {name}\n  thread a\n  wales 6 pitch {number(wale)}\n"
        f"  courses 5 pitch {number(course)}\n  stitch {dice.choice(['open', 'closed'])}\nend\n"
    )


def braid(dice):
    pattern = dice.choice([(1, 1), (2, 2), (3, 3), (2, 1)])
    period = sum(pattern)
    carriers = period * (2 if period % 2 else 1) * dice.randint(2, 3)
    angle = dice.uniform(25, 50)
    form = dice.choice(["circle 0.4", "circle 0.6", "ellipse 0.9 0.2", "racetrack 1.0 0.2", "lenticular 1.2 0.2"])
    width = float(form.split()[1])
    height = float(form.split()[-1])
    shape = f"radius {number(carriers * (width + height) * dice.uniform(1.1, 1.5) / (2 * 3.14159) / 0.6)}"
    if dice.random() < 0.35:
        shape, carriers = "flat", dice.randint(3, 9)
    return (
        f"thread a\n  section {form}\nend\nbraid\n  thread a\n  carriers {carriers}\n"
        f"  pattern {pattern[0]}/{pattern[1]}\n  {shape}\n  angle {number(angle)}\n  length {number(8 * width)}\nend\n"
    )


def bundle(dice):
    parts = dice.choice(
        [
            f"  plies {dice.randint(2, 4)} {number(dice.uniform(50, 400))} {dice.choice('SZ')}\n",
            f"  filaments {dice.randint(2, 19)}\n  twist {number(dice.uniform(0, 300))} Z\n",
            f"  plies 2 {number(dice.uniform(50, 200))} S\n  filaments 7\n  twist {number(dice.uniform(50, 200))} Z\n",
        ]
    )
    height = dice.uniform(0.1, 0.3)
    return (
        f"thread a\n  diameter 0.5\n{parts}end\nyarn y a\n  path\n    0 0 0\n    1.5 0 {number(height)}\n    3 0 0\n"
        f"    4.5 {number(0.5 * height)} {number(-height)}\n    6 0 0\n  end\nend\n"
    )


def plied_weave(dice):
    plies = dice.randint(2, 3)
    pitch = 0.4 * dice.uniform(2.0, 3.0)
    return (
        f"thread a\n  diameter 0.4\n  plies {plies} {number(dice.uniform(100, 400))} {dice.choice('SZ')}\nend\n"
        f"weave\n  warp a 3 pitch {number(pitch)}\n  weft a 3 pitch {number(pitch)}\n  draft plain\nend\n"
    )


class Free(Case):
    def judge(self, make):
        for seed in range(COUNT):
            text = "fabric 1\n" + make(random.Random(f"{make.__name__} {seed}"))
            path = self.folder / f"{make.__name__}_{seed}.txt"
            path.write_text(text)
        done = run("check", self.folder, "--quiet")
        self.assertEqual(done.returncode, 0, done.stdout[-3000:] + done.stderr[-6000:])
        self.assertEqual(done.stderr.count("jammed"), 0, done.stderr)

    def test_weaves(self):
        self.judge(weave)

    def test_bound_weaves(self):
        self.judge(bound_weave)

    def test_warp_knits(self):
        self.judge(warpknit)

    def test_classics(self):
        self.judge(classic)

    def test_braids(self):
        self.judge(braid)

    def test_bundles(self):
        self.judge(bundle)

    def test_plied_weaves(self):
        self.judge(plied_weave)


if __name__ == "__main__":
    unittest.main()
