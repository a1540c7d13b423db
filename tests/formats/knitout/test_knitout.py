"""Programs of knitting machines: what is drawn through what is that of an oracle, in the chart and in the laid yarns."""

import json
import pathlib
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cli"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import numpy as np

from cloth import Chart, Cloth, lines_of
from oracle import Machine, named_links
from program import Case, SAMPLES, run
from programs import LAID, Program, cable, jacquard, plain, tube


class KnitoutCase(Case):
    def written(self, program, name="program.k"):
        path = self.folder / name
        path.write_text(program if isinstance(program, str) else program.text())
        return path

    def text_of(self, path):
        return self.succeeds("convert", path, "--to", "txt", "-o", "-", "--quiet").stdout


class Topology(KnitoutCase):
    def test_number_of_programs(self):
        self.assertGreaterEqual(len(LAID), 40)

    def test_links(self):
        """Every loop of the machine is one of the chart, drawn through the same ones in the same order."""
        for name, program in LAID.items():
            with self.subTest(name):
                machine = Machine(program.text())
                chart = Chart(self.text_of(self.written(program)))
                self.assertEqual(chart.named_links(), named_links(machine.loops))

    def test_laid_yarns(self):
        """Both halves of each loop pass once through each loop that it is drawn through, from its back to its face; and through no
        other of its neighbourhood."""
        for name, program in LAID.items():
            with self.subTest(name):
                path = self.written(program)
                chart = Chart(self.text_of(path))
                lines = lines_of(self.succeeds("convert", path, "--to", "csv", "-o", "-", "--quiet").stdout)
                self.assertEqual(
                    sorted(lines), sorted(chart.yarn(r) for r, row in enumerate(chart.rows) if row.strip("."))
                )
                cloth = Cloth(chart, lines)
                for cell, held in chart.through.items():
                    if chart.rows[cell[0]][cell[1]] in "TU":
                        continue
                    for other in chart.through:
                        if (
                            other == cell
                            or other[0] == cell[0]
                            or abs(other[0] - cell[0]) > 4
                            or abs(other[1] - cell[1]) > 3
                        ):
                            continue
                        self.assertEqual(
                            cloth.through(cell, other), (1, 1) if other in held else (0, 0), f"{cell} through {other}"
                        )

    def test_free_of_overlap(self):
        for name, program in LAID.items():
            with self.subTest(name):
                report = self.folder / "report.json"
                done = run("check", self.written(program), "--report", report, "--quiet")
                entry = json.loads(report.read_text())["inputs"][0]
                self.assertEqual((done.returncode, entry["overlaps"]), (0, []), done.stderr)
                self.assertFalse(any(yarn["self_overlap"] for yarn in entry["yarns"]))


# What lies before the last rows is a cloth; these are not supported: (program, operations behind it).
ENDS = {
    "tube closed by transfers": (tube(4, 2), [f"xfer b{i} f{i}" for i in range(1, 5)], "K" * 4),
    "split": (plain(5, 3), [], "split"),
    "loop moved over thirteen needles": (
        plain(5, 3),
        ["xfer f5 b5", "rack 13", "xfer b5 f18", "rack 0"],
        " " * 17 + "K",
    ),
}


class Beginnings(KnitoutCase):
    def test_links_before_the_end(self):
        """The cloth is that of the lines before the one that the warning names, by the oracle's machine."""
        for name, (program, transfers, row) in ENDS.items():
            with self.subTest(name):
                program.lines += transfers
                if row == "split":
                    program.say("split", program.side["1"], "f5", "b5", "1")
                    program.say("knit", program.side["1"], "f4", "1")
                else:
                    program.knit(2, row)
                path = self.written(program)
                done = self.succeeds("convert", path, "--to", "txt", "-o", "-")
                line, built, made = (
                    int(number)
                    for number in re.search(
                        r"the cloth ends before line (\d+): (\d+) of (\d+) loops", done.stderr
                    ).groups()
                )
                before = Machine("\n".join(program.text().splitlines()[: line - 1]))
                chart = Chart(done.stdout)
                self.assertEqual(len(before.loops), built)
                self.assertGreater(made, built)
                self.assertEqual(chart.named_links(), named_links(before.loops))


class Together(KnitoutCase):
    def program(self, rows):
        lines = [";!knitout-2", ";;Gauge: 10", ";;Carriers: 1 2,3;4", "inhook 1 2"]
        for row, signs in enumerate(rows):
            needles = [(f"{'f' if sign == 'K' else 'b'}{i + 1}") for i, sign in enumerate(signs)]
            for needle in needles[:: 1 if row % 2 == 0 else -1]:
                lines.append(f"knit {'+-'[row % 2]} {needle} 1 2")
        return "\n".join(lines[:7] + ["releasehook 1 2"] + lines[7:] + ["outhook 1 2"]) + "\n"

    def test_plating(self):
        """A jersey of two carriers: both yarns of a course, apart, the first one on the face."""
        path = self.written(self.program(["KKKK"] * 4))
        done = self.succeeds("convert", path, "--to", "txt", "-o", "-")
        self.assertNotIn("warning", done.stderr)
        self.assertIn("  plating carrier_2\n", done.stdout)
        lines = lines_of(self.succeeds("convert", path, "--to", "csv", "-o", "-", "--quiet").stdout)
        self.assertEqual(len(lines), 8)
        for course in range(1, 5):
            face, back = lines[f"course_{course}"], lines[f"course_{course}_plating"]
            self.assertGreater(face[:, 2].mean(), back[:, 2].mean())
        self.succeeds("check", path, "--quiet")

    def test_as_one_yarn(self):
        """A rib of two carriers: one yarn with the area of both."""
        text = self.program(["KPKP"] * 4)
        done = self.succeeds("convert", self.written(text), "--to", "txt", "-o", "-")
        self.assertIn("warning: carriers 1 2 are knitted together: they are built as one yarn", done.stderr)
        chart = Chart(done.stdout)
        self.assertEqual(chart.named_links(), named_links(Machine(text).loops))
        wale = chart.wale
        self.assertAlmostEqual(float(re.search(r"diameter (\S+)", done.stdout)[1]), wale / 6, delta=1e-9)
        text = text.replace(";;Gauge: 10", ";;Gauge: 10\n;;Yarn-1: 0.3 mm\n;;Yarn-2: 0.4 mm")
        done = self.succeeds("convert", self.written(text), "--to", "txt", "-o", "-")
        self.assertAlmostEqual(float(re.search(r"diameter (\S+)", done.stdout)[1]), 0.5, delta=1e-12)


class Warnings(KnitoutCase):
    def test_each_carrier_has_a_color(self):
        text = self.text_of(self.written(jacquard(["112112", "221221"])))
        colors = re.findall(r"^thread carrier_\S+\n(?:  .*\n)*?  color (.+)$", text, re.MULTILINE)
        self.assertEqual((len(colors), len(set(colors))), (2, 2))

    def test_without_the_first_line(self):
        """A program is one by its first operation, too, and not a deck of LS-DYNA."""
        text = plain(4, 3).text()
        for lines in (text.split("\n", 1)[1], "\n; a comment\nx-speed 5\n" + text.split("\n", 3)[3]):
            for name in ("a.k", "a.knitout", "a"):
                done = self.succeeds("convert", self.written(lines, name), "--to", "txt", "-o", "-")
                self.assertIn("the first line of a knitout program is missing", done.stderr)
                self.assertEqual(Chart(done.stdout).named_links(), named_links(Machine(text).loops))


class Crossings(KnitoutCase):
    def test_who_passes_before_whom(self):
        """Where legs of loops that change places cross, seen from the face, those that were told first lie above the others."""
        for left, right in ((1, 1), (2, 1), (2, 2)):
            for front in ("right", "left"):
                with self.subTest(left=left, right=right, front=front):
                    path = self.written(cable(left, right, front))
                    chart = Chart(self.text_of(path))
                    cloth = Cloth(
                        chart, lines_of(self.succeeds("convert", path, "--to", "csv", "-o", "-", "--quiet").stdout)
                    )
                    loops = {cell: by for cell, by in chart.moves.items() if by}
                    self.assertEqual(sorted(loops.values()), [-left] * right + [right] * left)
                    found = 0
                    for cell, by in loops.items():
                        for other, way in loops.items():
                            if by > 0 > way:
                                heights = over(cloth.stitches[cell], cloth.stitches[other])
                                found += len(heights)
                                self.assertTrue(np.all(heights > 0 if front == "right" else heights < 0), heights)
                    self.assertGreaterEqual(
                        found, 3 * left * right
                    )  # two legs over two legs, of which one may cross near the feet


def over(first, second):
    """How far the first line lies above the second one where they cross, above the feet of both."""
    heights = []
    level = max(first[:, 1].min(), second[:, 1].min())
    reach = first[:, 1].max() - level
    for a, b in zip(first, first[1:]):
        for c, d in zip(second, second[1:]):
            along, across, gap = b - a, d - c, c - a
            cross = along[0] * across[1] - along[1] * across[0]
            if cross == 0:
                continue
            s, t = (gap[0] * across[1] - gap[1] * across[0]) / cross, (gap[0] * along[1] - gap[1] * along[0]) / cross
            y = a[1] + s * along[1]
            if 0 <= s < 1 and 0 <= t < 1 and 0.25 * reach < y - level < 0.7 * reach:
                heights.append(a[2] + s * along[2] - c[2] - t * across[2])
    return np.array(heights)


def without_cast_on(loops, made):
    """The last `made` loops, as if nothing lay below them."""
    kept = loops[len(loops) - made :]
    below = set(loops[: len(loops) - made])
    for loop in kept:
        loop.through = [other for other in loop.through if other not in below]
    return kept


class Writing(KnitoutCase):
    def test_programs_come_back(self):
        """What was read from a program and written as one knits the same loops, through each other in the same order."""
        for name, program in LAID.items():
            with self.subTest(name):
                path = self.written(program)
                text = self.succeeds("convert", path, "--to", "knitout", "-o", "-", "--quiet").stdout
                expected = Machine(program.text()).loops
                written = without_cast_on(Machine(text).loops, len(expected))
                self.assertEqual(named_links(written), named_links(expected))
                again = Chart(self.text_of(self.written(text, "again.knitout")))
                if len(Machine(text).loops) == len(expected):  # no cast-on was needed
                    chart = Chart(self.text_of(path))
                    self.assertEqual(again.named_links(), chart.named_links())
                    self.assertEqual(
                        [row.strip("M.") for row in again.rows if row.strip("M.")],
                        [row.strip("M.") for row in chart.rows if row.strip("M.")],
                    )

    def test_knits_of_texts(self):
        """Classics and charts: the written program knits the chart's stitches through each other."""
        for form, rows, feeds in (
            ("jersey", ["KKKKKK"] * 4, 1),
            ("rib 1x1", ["KPKPKP"] * 4, 1),
            ("rib 2x2", ["KKPPKK"] * 4, 1),
            ("purl", ["KKKKKK", "PPPPPP"] * 2, 1),
            ("interlock", ["KPKPKP", "PKPKPK"] * 4, 2),
            ("half-cardigan", ["KPKPKP", "KTKTKT"] * 2, 1),
            ("full-cardigan", ["KTKTKT", "TPTPTP"] * 2, 1),
            ("milano", ["KPKPKP", "KMKMKM", "MPMPMP", "KPKPKP"], 1),
        ):
            with self.subTest(form):
                path = self.written(
                    f"fabric 1\nthread a\n  diameter 0.2\nend\nknit {form}\n  thread a\n  courses 4\n  wales 6\nend\n",
                    "knit.txt",
                )
                written = self.succeeds("convert", path, "--to", "knitout", "-o", "-", "--quiet").stdout
                loops = Machine(written).loops
                made = sum(sign != "M" for row in rows for sign in row)
                self.assertIn(len(loops) - made, (0, 6, 12))
                chart = Chart(
                    "  courses 1 pitch 1\n  wales 6 pitch 1\n"
                    + f"  feeds {feeds}\n"
                    + "  gating opposite\n" * (feeds > 1)
                    + "  chart\n"
                    + "".join(f"    {row}\n" for row in reversed(rows))
                    + "  end\n"
                )
                if form not in ("half-cardigan", "full-cardigan"):  # whose first tucks join the cast-on
                    self.assertEqual(named_links(without_cast_on(loops, made)), chart.named_links())

    def test_what_cannot_be_written(self):
        knit = "fabric 1\nthread a\n  diameter 0.2\nend\nknit jersey\n  thread a\n  courses 4\n  wales 6\n  {}\nend\n"
        for text, message in (
            (knit.format("plating a"), "a plated knit is not written as knitout"),
            (knit.format("").replace("wales 6", "wales 1300"), "1300 wales are more than the 1200 needles"),
            (
                knit.format(
                    "chart\n   KPKPKP\n   KPKPKP\n   KPKPKP\n   KPKPKP\n  end\n  transfer 2 1 right 2\n  transfer 2 4 left 2"
                ).replace(" jersey", ""),
                "loops of both beds are moved",
            ),
            (pathlib.Path(SAMPLES / "weave_plain.txt").read_text(), "knitout holds one weft knit"),
            (pathlib.Path(SAMPLES / "back_piece.txt").read_text(), "knitout holds one weft knit"),
        ):
            with self.subTest(message):
                path = self.written(text, "other.txt")
                self.assertIn(message, self.fails(1, "convert", path, "--to", "knitout", "-o", "-"))


class Recognition(KnitoutCase):
    def test_first_line_tells(self):
        for name in ("a.k", "a.knitout", "a.txt", "a", "a.igs"):
            self.assertIn("knit", self.text_of(self.written(plain(4, 2), name)))

    def test_folder(self):
        """A .k of a knitting machine is an input, one of LS-DYNA is not."""
        folder = self.folder / "in"
        folder.mkdir()
        (folder / "cloth.k").write_text(plain(4, 2).text())
        (folder / "deck.k").write_text("*KEYWORD\n*NODE\n*END\n")
        self.succeeds("convert", folder, "--to", "txt", "-o", self.out)
        self.assertEqual([path.name for path in self.out.rglob("*") if path.is_file()], ["cloth.txt"])
        self.assertIn("this version cannot read", self.fails(1, "convert", folder / "deck.k", "--to", "txt", "-o", "-"))

    def test_many_lines(self):
        """A hundred thousand stitches are read in one piece."""
        text = self.text_of(self.written(plain(100, 1000)))
        self.assertEqual(len(Chart(text).through), 100 * 1001)

    def test_sizes(self):
        program = Program(4, gauge=5, yarn="0.4 mm of something")
        program.cast_on()
        program.knit(2)
        text = self.text_of(self.written(program))
        self.assertIn("diameter 0.4\n", text)
        self.assertAlmostEqual(Chart(text).wale, 25.4 / 5, delta=1e-12)
        for yarn, said in (
            ("30 tex cotton, red", "tex 30"),
            ("Ne 20 cotton", "Ne 20"),
            ("75den polyester", "denier 75"),
        ):
            with self.subTest(yarn):
                program.lines[3] = f";;Yarn-1: {yarn}"
                text = self.text_of(self.written(program))
                self.assertIn(said + "\n", text)
                self.assertIn("material " + ("polyester" if "poly" in yarn else "cotton"), text)


if __name__ == "__main__":
    unittest.main()
