"""What the benchmark's page says of the page before: nothing that became worse goes unseen."""

import math
import pathlib
import sys
import unittest
from xml.etree import ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "benchmarks"))
import trend

PAGE = """# Benchmarks

## Writing: of yarns

| writer | yarns | ms | MB/s | memory, MiB | times the bare loop's time | times OpenCASCADE's speed |
|---|---|---|---|---|---|---|
| selvage | 8 | 1.00 | 400 | 3.0 | 1.00 | 10 |
| bare loop | 8 | 1.00 | 300 | 2.0 |  |  |
| selvage | 64 | 8.00 | 400 | 3.0 | 1.00 | 10 |
| selvage | 512 | 64.00 | 400 | 3.0 | 1.00 | 10 |

## Overlaps

| cloth | loops or crossings | overlaps found | ours, s | to the first | CGAL, s |
|---|---|---|---|---|---|
| jersey 4 x 4 | 16 | 99 | 1.0 | 1.00 | 5 |
| jersey 8 x 8 | 64 | 455 | 16.0 | 4.00 | 20 |

## Meshes

| size, mm | triangles | mesher | threads | tetrahedra | s |
|---|---|---|---|---|---|
| 0.1 | 500 | selvage | 1 | 5000 | 2.0 |
| 0.1 | 500 | selvage | 2 | 5000 | 1.0 |
"""


class Trend(unittest.TestCase):
    def worse(self, *changes):
        now = PAGE
        for old, new in changes:
            self.assertIn(old, now)
            now = now.replace(old, new)
        return trend.worse_rows(PAGE, now)

    def test_the_same_page_is_not_worse(self):
        self.assertEqual(self.worse(), ([], 7))

    def test_a_tenth_more_is_told(self):
        found, _ = self.worse(("| selvage | 64 | 8.00 |", "| selvage | 64 | 8.90 |"))
        self.assertEqual(found, [("Writing: of yarns", ("selvage", "64"), "ms", 8.0, 8.9)])
        self.assertEqual(self.worse(("| selvage | 64 | 8.00 |", "| selvage | 64 | 8.70 |"))[0], [])

    def test_less_speed_is_worse_and_more_is_not(self):
        found, _ = self.worse(("| 64.00 | 400 |", "| 64.00 | 300 |"), ("| 8.00 | 400 |", "| 8.00 | 500 |"))
        self.assertEqual([row[1:3] for row in found], [(("selvage", "512"), "MB/s")])

    def test_growth_is_no_loss_where_the_row_gains(self):
        self.assertEqual(
            self.worse(("| 1.0 | 1.00 | 5 |", "| 0.1 | 1.00 | 5 |"), ("| 16.0 | 4.00 |", "| 15.0 | 37.00 |"))[0], []
        )
        found, _ = self.worse(("| 16.0 | 4.00 |", "| 16.0 | 5.00 |"))
        self.assertEqual([row[2:] for row in found], [("to the first", 4.0, 5.0)])

    def test_peers_are_not_ours(self):
        self.assertEqual(
            self.worse(("| bare loop | 8 | 1.00 |", "| bare loop | 8 | 1.05 |"), ("4.00 | 20 |", "4.00 | 90 |"))[0], []
        )

    def test_times_count_beyond_those_of_peers(self):
        """On a machine twice as slow all takes twice as long: what takes three times as long, or more memory, is worse."""
        slow = [
            ("| bare loop | 8 | 1.00 | 300 |", "| bare loop | 8 | 2.00 | 150 |"),
            ("| selvage | 8 | 1.00 | 400 |", "| selvage | 8 | 2.00 | 200 |"),
            ("| selvage | 64 | 8.00 | 400 | 3.0 |", "| selvage | 64 | 24.00 | 133 | 3.0 |"),
            ("| 64.00 | 400 | 3.0 |", "| 128.00 | 200 | 4.0 |"),
        ]
        found, _ = self.worse(*slow)
        self.assertEqual(
            [row[1:3] for row in found], [(("selvage", "64"), "MB/s"), (("selvage", "512"), "memory, MiB")]
        )
        now = PAGE
        for old, new in slow:
            now = now.replace(old, new)
        self.assertIn("took 2.00 times as long as in abc (the median of 1 rows)", trend.summary(PAGE, "abc", now))

    def test_another_mesh_of_the_same_size_is_compared(self):
        found, compared = self.worse(
            ("| 0.1 | 500 | selvage | 1 | 5000 | 2.0 |", "| 0.1 | 300 | selvage | 1 | 2500 | 20.0 |"),
            ("| 0.1 | 500 | selvage | 2 | 5000 | 1.0 |", "| 0.1 | 300 | selvage | 2 | 2500 | 0.9 |"),
        )
        self.assertEqual(compared, 7)
        self.assertEqual([row[1:] for row in found], [(("0.1", "selvage", "threads 1"), "s", 2.0, 20.0)])

    def test_a_row_that_is_gone_is_told(self):
        summary = trend.summary(PAGE, "abc", PAGE.replace("| jersey 8 x 8 | 64 | 455 | 16.0 | 4.00 | 20 |\n", ""))
        self.assertIn("Rows of abc that are here no more:\n\n- **Overlaps**, jersey 8 x 8\n", summary)

    def test_what_a_run_finds_does_not_hide_a_row(self):
        found, compared = self.worse(("| 455 | 16.0 |", "| 456 | 20.0 |"), ("| 2 | 5000 | 1.0 |", "| 2 | 5100 | 1.5 |"))
        self.assertEqual(compared, 7)
        self.assertEqual(
            [(row[1], row[2]) for row in found],
            [(("jersey 8 x 8",), "ours, s"), (("0.1", "selvage", "threads 2"), "s")],
        )

    def test_exponents(self):
        found = {what: trend.exponent(points) for _, what, points in trend.curves(PAGE)}
        self.assertAlmostEqual(found["selvage, ms"], 1.0)
        self.assertAlmostEqual(found["jersey, ours, s"], 2.0)

    def test_the_page_begins_with_what_is_worse(self):
        summary = trend.summary(PAGE, "abc", PAGE.replace("| 16.0 |", "| 32.0 |"))
        self.assertIn("1 of 7 rows are worse than in abc by more than 10%:", summary)
        self.assertIn("ours, s 16 -> 32", summary)
        self.assertIn("Overlaps, jersey, ours, s: 2.50", summary)
        self.assertIn("There are no results to compare with.", trend.summary("", "", PAGE))

    def test_plots_have_every_curve_at_its_place(self):
        """Equal ratios are equal lengths, in x and y; the labels are the names and exponents."""
        drawing = ElementTree.fromstring(trend.plot(PAGE))
        lines = [
            [tuple(map(float, point.split(","))) for point in line.get("points").split()]
            for line in drawing.iter("{http://www.w3.org/2000/svg}polyline")
        ]
        curves = trend.curves(PAGE)
        self.assertEqual([len(line) for line in lines], [len(points) for _, _, points in curves])
        for line, (_, _, points) in zip(lines, curves):
            for axis, sign in ((0, 1), (1, -1)):
                for first, second in zip(range(len(points)), range(1, len(points))):
                    length = sign * (line[second][axis] - line[first][axis])
                    ratio = points[second][axis] / points[first][axis]
                    self.assertGreater(length, 0)
                    whole = sign * (line[-1][axis] - line[0][axis])
                    of_all = math.log(ratio) / math.log(points[-1][axis] / points[0][axis])
                    self.assertAlmostEqual(length / whole, of_all, delta=0.01)
        texts = [text.text for text in drawing.iter("{http://www.w3.org/2000/svg}text")]
        for _, what, points in curves:
            self.assertIn(f"{what} ({trend.exponent(points):.2f})", texts)

    def test_the_committed_plots_are_those_of_the_page(self):
        page = ROOT / "scripts" / "benchmarks" / "RESULTS.md"
        self.assertEqual(page.with_suffix(".svg").read_text(), trend.plot(page.read_text()))


if __name__ == "__main__":
    unittest.main()
