"""Cloths of the trade: what is built against the sheets in samples/trade/sheets.csv (trade_sheets.py measures it)."""

import math
import re
import unittest

import trade_sheets as trade
from program import Case, run


class Trade(Case):
    def test_every_file_has_a_sheet_and_says_what_it_says(self):
        sheets = trade.sheets()
        self.assertEqual(
            sorted(sheet["cloth"] for sheet in sheets), sorted(path.stem for path in trade.TRADE.glob("*.txt"))
        )
        published = [sheet for sheet in sheets if sheet["kind"] != "memory"]
        self.assertGreaterEqual(len(published), 65)
        self.assertGreaterEqual(sum(not sheet["outside"] for sheet in published), 41)
        for sheet in sheets:
            with self.subTest(sheet["cloth"]):
                text = trade.text_of(sheet)
                self.assertLessEqual(len(text.splitlines()), 20)
                # A cloth from a published source names it.
                self.assertEqual(text.startswith("# "), sheet["kind"] != "memory")
                systems = [("warp", "ends"), ("weft", "picks")]
                if "knit" in text:
                    systems = [("wales", "ends"), ("courses", "picks")]
                for system, count in systems:
                    self.assertRegex(text, rf"(?m)^  {system} (\S+ )?\d+ (pitch )?{re.escape(sheet[count])}$")
                for yarn in filter(None, trade.yarns_of(sheet["warp"]) + trade.yarns_of(sheet["weft"])):
                    if match := re.match(r"([\d.]+) mm", yarn):
                        value, unit = re.search(r"^  diameter ([\d.]+)(in)?$", text, re.MULTILINE).groups()
                        self.assertAlmostEqual(float(value) * (25.4 if unit else 1), float(match[1]), places=9)
                    else:
                        self.assertRegex(text, rf"(?m)^  {yarn}$")

    def test_measures_are_those_of_known_paths(self):
        # An arc of a radian on a radius of 2, by three points; and Peirce's plain cloth, whose arcs and straights are
        # in closed form: yarns of 0.3 mm at a pitch of 1 mm, as published.
        arc = [
            trade.Point((2 * s, 0, 2 * (1 - c)), (c, 0, s), 0.1)
            for s, c in ((0, 1), (0.479425538604203, 0.8775825618903728), (0.8414709848078965, 0.5403023058681398))
        ]
        self.assertAlmostEqual(trade.length(arc), 2.0, places=12)
        path = self.folder / "peirce.txt"
        path.write_text(
            "fabric 1\ntolerance 1e-6\nthread a\n  diameter 0.3\nend\nweave\n  warp a 8 1\n  weft a 8 1\n"
            "  draft plain\nend\n"
        )
        lines = trade.lines_of(path, "--as-published")
        crimp = trade.crimp(lines["warp_3"], 0, 1.0, 8)
        # By bisection: p = (l - D t) cos t + D sin t and h = (l - D t) sin t + D (1 - cos t), D = 0.6, h = 0.3.
        low, high = 0.0, 1.5
        for _ in range(200):
            t = (low + high) / 2
            straight = (1 - 0.6 * math.sin(t)) / math.cos(t)
            if straight * math.sin(t) + 0.6 * (1 - math.cos(t)) < 0.3:
                low = t
            else:
                high = t
        self.assertAlmostEqual(crimp, straight + 0.6 * t - 1, delta=2e-5)

    def test_what_is_built_is_what_is_published(self):
        told = {}
        for line in (trade.TRADE / "README.md").read_text().splitlines():
            if match := re.match(r"\| `(\w+)` \|", line):
                told[match[1]] = [cell.strip() for cell in line.strip("|").split("|")]
        for sheet in trade.sheets():
            with self.subTest(sheet["cloth"]):
                built = trade.measured(sheet)
                # Those outside are known, with the reason; no others, and no fewer.
                known = sorted(filter(None, sheet["outside"].split("; ")))
                self.assertEqual(trade.outside(sheet, built), known, built)
                self.assertEqual(bool(known), bool(sheet["why"]))
                # No path is shorter than the straight one.
                self.assertGreater(min(built.get("warp crimp", 1.0), built.get("weft crimp", 1.0)), 0.0)
                cells = told[sheet["cloth"]]
                self.assertEqual(cells[8], ", ".join(known))
                for what, cell in zip(trade.BOUNDS, cells[2:6]):
                    if what in built:
                        self.assertAlmostEqual(float(cell.split()[0]), built[what], delta=0.01 * built[what] + 0.006)
        self.assertEqual(len(told), len(trade.sheets()))

    def test_nothing_overlaps(self):
        for sheet in trade.sheets():
            with self.subTest(sheet["cloth"]):
                self.assertIn("no two overlap", run("check", trade.TRADE / f"{sheet['cloth']}.txt").stdout)


if __name__ == "__main__":
    unittest.main()
