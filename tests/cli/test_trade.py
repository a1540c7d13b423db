"""Cloths of the trade: what is built against the data sheets that samples/trade/README.md lists."""

import re
import unittest

from program import SAMPLES, Case, run

TRADE = SAMPLES / "trade"
TEX = {"tex": lambda v: v, "denier": lambda v: v / 9, "Ne": lambda v: 590.5412 / v}


def rows():
    pattern = re.compile(r"^\| `([\w-]+)\.txt` \| ([\d.]+) x ([\d.]+) \| ([\d.]+) \| ([\d.]+) \|", re.MULTILINE)
    return [(name, *map(float, numbers)) for name, *numbers in pattern.findall((TRADE / "README.md").read_text())]


class Trade(Case):
    def test_every_file_is_listed(self):
        self.assertEqual(sorted(row[0] for row in rows()), sorted(path.stem for path in TRADE.glob("*.txt")))
        self.assertGreater(len(rows()), 10)

    def test_thickness_and_mass(self):
        for name, ends, picks, thickness, mass in rows():
            with self.subTest(name):
                text = (TRADE / f"{name}.txt").read_text()
                word, value = re.search(r"^  (tex|denier|Ne) ([\d.]+)", text, re.MULTILINE).groups()
                tex = TEX[word](float(value))
                for system, an_inch in (("warp", ends), ("weft", picks)):
                    pitch = re.search(rf"^  {system} yarn 8 pitch ([\d.]+)", text, re.MULTILINE)[1]
                    self.assertAlmostEqual(float(pitch) * an_inch, 25.4, delta=0.02 * an_inch * float(pitch))
                report = run("info", TRADE / f"{name}.txt").stdout
                low, high = map(float, re.search(r"within \(.*, (-[\d.]+)\) and \(.*, ([\d.]+)\)", report).groups())
                self.assertAlmostEqual(high - low, thickness, delta=0.15 * thickness)
                lengths = {system: [float(length) for length in
                                    re.findall(rf"^  {system}_\d+ .*?\d+x\d+ +([\d.]+)", report, re.MULTILINE)]
                           for system in ("warp", "weft")}
                self.assertEqual([len(of) for of in lengths.values()], [8, 8])
                area = (8 * 25.4 / ends) * (8 * 25.4 / picks)  # mm2
                # mm of 1e-6 g/mm on mm2, in g/m2
                built = tex * sum(map(sum, lengths.values())) / area
                self.assertAlmostEqual(built, mass, delta=0.05 * mass)

    def test_nothing_overlaps(self):
        for name, *_ in rows():
            with self.subTest(name):
                self.assertIn("no two overlap", run("check", TRADE / f"{name}.txt").stdout)


if __name__ == "__main__":
    unittest.main()
