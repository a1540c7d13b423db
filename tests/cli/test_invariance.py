"""What is measured of a fabric does not depend on how it is written: unit, place, quarter turns, order of yarns, `use`.

Every number of `check` and of the yarns is the same to 1e-6: of the samples as texts in another unit, of uses of them that are moved
and turned, of their surfaces with the yarns in the opposite order. Weft knits as texts in another unit are not compared: where loops are
moved apart, rounding of 1e-10 decides by how much. Prints the table of what was compared.
"""

import json
import re
import sys
import unittest

from program import Case, EVERYTHING, SAMPLES, run, smallest_of_each_family

WITHIN = 1e-6
# The bound of a surface's error has the rounding of its points in it, to decimals of the text's unit.
ROUNDED = {"tube_error": 1e-3}
NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
# Statements with lengths that the test can put in another unit; a sample with others is not compared by units.
SECTION = rf"^(\s*section +(?:circle|ellipse|racetrack|lenticular|rectangle))((?: +{NUMBER})+)"
KEYWORD = rf"\b(diameter|thickness|tolerance|loop|pitch|length|radius|amplitude|place|step|margin)((?: +{NUMBER})+)(?![\w/.*])"
ROW = rf"^(\s*(?:derivative +(?:start|end))?)((?: +{NUMBER}){{2,3}})\s*$"
NO_LENGTHS = set(
    """fabric title units thread material tex dtex denier Ne Nm density packing filaments color twist plies weave warp weft draft knit
    warpknit bar braid carriers angle axial yarn path grid derivative section diameter thickness tolerance loop pitch length radius
    amplitude wales courses role end twill plain stitch elastic expansion strength conductivity chart gating plating block use repeat
    place rotate mirror closed tangent pattern feeds profile spacing crossing method layers curve""".split()
)


def without_comments(text):
    return "".join(re.sub(r'(^|\s)#[^"]*$', "", line.rstrip("\n")) + "\n" for line in text.splitlines())


def in_unit(text, unit, millimetres):
    """The same fabric with its lengths in another unit; None: it has statements that this test does not know."""
    text = without_comments(text)
    if re.search(r"^\s*units +(?!mm)", text, re.MULTILINE) or re.search(
        r"^\s*(param|points|line|use +file|section +(?:power|loop7)) ", text, re.MULTILINE
    ):
        return None
    words = set(re.findall(r"^\s*([A-Za-z][\w-]*)", text, re.MULTILINE))
    if words - NO_LENGTHS:
        return None

    def scaled(match):
        return match[1] + re.sub(NUMBER, lambda number: repr(float(number[0]) / millimetres), match[2])

    lines, opened = [], []
    for line in text.splitlines():
        word = line.split()[0] if line.split() else ""
        if word == "end" and opened:
            opened.pop()
        elif word == "grid" or line.split()[:2] == ["section", "polygon"]:
            opened.append("grid")
        elif word in ("draft", "chart", "path", "pattern") and len(line.split()) <= 2:
            opened.append(word)
        if word == "units":
            continue
        line = re.sub(SECTION, scaled, line)
        line = re.sub(KEYWORD, scaled, line)
        if word == "derivative" or (opened and opened[-1] in ("path", "grid")):
            line = re.sub(ROW, scaled, line)
        lines.append(line + (f"\nunits {unit}" if word == "fabric" else ""))
    return "\n".join(lines) + "\n"


def turned_order(text):
    """The yarns of a text of surfaces in the opposite order."""
    blocks = re.split(r"(?m)^(?=yarn )", text)
    tail = re.search(r"(?ms)^end\n(.*)\Z", blocks[-1])
    rest = tail[1] if tail and re.match(r"(?m)^(cell|edit)", tail[1] or "") else ""
    last = blocks[-1][: len(blocks[-1]) - len(rest)]
    return blocks[0] + "".join(reversed([*blocks[1:-1], last])) + rest


class Invariance(Case):
    def measured(self, path):
        """The numbers of `check`: of each yarn by its name without that of a use, and of the whole."""
        report = self.folder / "report.json"
        done = run("check", path, "--report", report, "--quiet", "--digits", "full")
        self.assertIn(done.returncode, (0, 3), f"{path.name}: {done.stderr}")
        entry = json.loads(report.read_text())["inputs"][0]
        numbers = {
            "yarns": entry["yarn_count"],
            "overlaps": len(entry["overlaps"]),
            "gap": entry.get("min_gap") or 0,
            "defects": sum("defect" in yarn for yarn in entry["yarns"]),
        }
        for number, overlap in enumerate(sorted(entry["overlaps"], key=lambda one: -one["depth"])):
            numbers[f"depth {number}"] = overlap["depth"]
            numbers[f"area {number}"] = overlap.get("area", 0)
        for yarn in entry["yarns"]:
            name = yarn["name"].removeprefix("used.")
            for key in ("length", "volume", "min_bend_radius", "tube_error", "self_overlap", "closed"):
                numbers[f"{name} {key}"] = yarn.get(key) or 0
            numbers[f"{name} points"] = yarn["control_points"][0] * yarn["control_points"][1]
        return numbers

    def used(self, sample, *moves):
        text = self.folder / "uses.txt"
        (self.folder / "used.txt").write_text(sample.read_text())
        text.write_text("fabric 1\nuse file used.txt as used\n" + "".join(f"  {move}\n" for move in moves) + "end\n")
        return text

    def variants(self, sample):
        """Pairs of texts that are the same fabric: the name, and both."""
        text = sample.read_text(encoding="utf-8-sig")
        for unit, millimetres in (("inch", 25.4), ("m", 1000), ("um", 1e-3)):
            other = in_unit(text, unit, millimetres)
            if other is not None and not re.search(r"(?m)^knit\b", text):
                path = self.folder / f"in_{unit}.txt"
                path.write_text(other)
                yield unit, sample, path
        if not re.search(r"(?m)^\s*(cell|piece|use|points|draft +file|units +(?!mm))\b", text):
            for name, *moves in (
                ("used",),
                ("moved", "place 31.7 -20.3 11.9"),
                ("turned", "rotate 90"),
                ("on edge", "rotate x 90"),
            ):
                yield name, sample, self.used(sample, *moves)
        surfaces = self.folder / "surfaces.txt"
        self.succeeds("convert", sample, "--to", "txt", "--digits", "full", "-o", surfaces, "--quiet")
        if re.search(r"(?m)^yarn ", surfaces.read_text()):
            other = self.folder / "order.txt"
            other.write_text(turned_order(surfaces.read_text()))
            yield "order", surfaces, other
            for unit in ("mm", "inch"):
                self.succeeds("convert", sample, "--units", unit, "-o", self.folder / f"{unit}.igs", "--quiet")
            yield "surfaces in inches", self.folder / "mm.igs", self.folder / "inch.igs"

    def test_samples(self):
        samples = sorted(SAMPLES.glob("*.txt"))
        if not EVERYTHING:
            samples = smallest_of_each_family(samples)
        compared, known = {}, {}
        for sample in samples:
            for variant, one, other in self.variants(sample):
                with self.subTest(sample=sample.name, variant=variant):
                    key = sample.name, one.name
                    if key not in known:
                        known[key] = self.measured(one)
                    first, second = known[key], self.measured(other)
                    self.assertEqual(set(first), set(second))
                    off = {name: abs(second[name] - value) / (abs(value) or 1) for name, value in first.items()}
                    wrong = {
                        name: (first[name], second[name])
                        for name, share in off.items()
                        if share > ROUNDED.get(name.split()[-1], WITHIN)
                    }
                    exact = max(share for name, share in off.items() if name.split()[-1] not in ROUNDED)
                    fabrics, so_far = compared.get(variant, (0, 0))
                    compared[variant] = fabrics + 1, max(so_far, exact)
                    self.assertFalse(wrong, dict(list(wrong.items())[:6]))
        print("\nvariant              fabrics  largest relative difference", file=sys.stderr)
        for variant, (fabrics, largest) in compared.items():
            print(f"{variant:20} {fabrics:7}  {largest:.1e}", file=sys.stderr)
        self.assertGreaterEqual(len(compared), 7)


if __name__ == "__main__":
    unittest.main()
