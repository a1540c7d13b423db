"""Planar braids: who lies on top at each crossing of their lines, by plane geometry; their cell, wherever it lies; stiffness in CalculiX,
beside that of the like braid whose yarns are told by hand."""

import csv
import itertools
import json
import os
import re
import shutil
import subprocess
import sys
import unittest

import numpy as np

from program import Case, ROOT, SAMPLES

HOMOGENIZE = ROOT / "scripts" / "homogenize.py"
TEXT = (SAMPLES / "cell_triaxial.txt").read_text()
CELL = TEXT[TEXT.index("cell repeat") :]


def braid(carriers=4, pattern="2/2", width="4.4", angle=45, length=4.4, axial="axial carbon 2", cell=CELL):
    block = (
        f"braid\n  thread carbon\n  carriers {carriers}\n  pattern {pattern}\n  planar {width}\n  angle {angle}\n"
        f"  length {length}\n  {axial}\nend\n"
    )
    return TEXT[: TEXT.index("braid\n  thread")] + block + cell


class PlanarBraid(Case):
    def written(self, text):
        source = self.folder / "braid.txt"
        source.write_text(text)
        return source

    def lines(self, text):
        """Of each yarn the places of its line."""
        self.succeeds("convert", self.written(text), "--lines", "-o", self.folder / "lines.csv")
        lines = {}
        with (self.folder / "lines.csv").open() as file:
            for row in csv.DictReader(file):
                lines.setdefault(row["yarn"], []).append([float(row[name]) for name in ("x_mm", "y_mm", "z_mm")])
        return {name: np.array(line) for name, line in lines.items()}

    def assert_braided(self, lines, carriers, over, under, width, angle, axials):
        column, slope = width / carriers, np.tan(np.radians(angle))
        ways = {1: [], -1: []}
        for name, line in lines.items():
            if name.startswith("axial"):
                continue
            sign = 1 if line[-1, 1] > line[0, 1] else -1
            offsets = line[:, 1] - sign * slope * line[:, 0]
            self.assertLess(np.ptp(offsets), 1e-9)  # straight, seen from above
            ways[sign].append((offsets.mean(), line))
        for some in ways.values():
            gaps = np.diff(np.sort([offset for offset, _ in some]))
            np.testing.assert_allclose(gaps, 2 * column, rtol=1e-9)
        crossings = 0
        for (up, first), (down, second) in itertools.product(ways[1], ways[-1]):
            x = (down - up) / (2 * slope)
            if not all(line[0, 0] <= x <= line[-1, 0] for line in (first, second)):
                continue
            number = (up + slope * x) / column + (carriers - 1) / 2
            self.assertAlmostEqual(number, round(number), 6)
            z, other = (np.interp(x, line[:, 0], line[:, 2]) for line in (first, second))
            self.assertEqual(z > other, round(number) % (over + under) < over)
            crossings += 1
        places = sorted(
            {
                round(float(line[0, 1]) / column + (carriers - 1) / 2, 6)
                for name, line in lines.items()
                if name.startswith("axial")
            }
        )
        self.assertEqual(places, axials)
        return crossings

    def test_who_lies_on_top(self):
        for carriers, (over, under), angle, axial, axials in (
            (8, (2, 2), 60, 4, [0.5, 2.5, 4.5, 6.5]),
            (12, (2, 1), 30, 2, [0.5, 6.5]),
            (6, (1, 1), 45, 0, []),
        ):
            with self.subTest(carriers=carriers):
                width = 1.6 * carriers
                text = braid(
                    carriers, f"{over}/{under}", width, angle, 20, f"axial carbon {axial}" if axial else "", ""
                )
                self.assertGreater(
                    self.assert_braided(self.lines(text), carriers, over, under, width, angle, axials), 3 * carriers
                )

    def test_nothing_overlaps(self):
        """Nor comes nearer than the gap that the page promises, a half per cent of the thickness, with room for the tolerance."""
        done = self.succeeds("check", self.written(braid(8, "2/2", 8.8, 50, 9, "axial carbon 4", "")))
        self.assertGreater(float(re.search(r"smallest gap between yarns: (\S+)", done.stdout)[1]), 0.002 * 0.25)

    def corners(self, text):
        done = self.succeeds("convert", self.written(text), "-o", self.folder / "cell.igs", "-v")
        found = re.search(r"reaches from \((.*)\) to \((.*)\)", done.stderr)
        return np.array([[float(word) for word in place.split(",")] for place in found.groups()])

    def test_its_repeat(self):
        """Two crossings by four columns; twice as many where every fourth run alone has an axial yarn, by two with pattern 1/1."""
        for text, sides in (
            (braid(), (2.2, 4.4)),
            (braid(8, width="8.8", axial="axial carbon 1"), (2.2, 8.8)),
            (braid(8, width="8.8", axial="axial carbon 4"), (2.2, 4.4)),
            (braid(4, "1/1", 6, axial=""), (3, 3)),
            (braid(4, angle=60, width=8), (4 / np.sqrt(3), 8)),
        ):
            low, high = self.corners(text)
            np.testing.assert_allclose((high - low)[:2], sides, rtol=1e-5)

    def test_a_cell_anywhere(self):
        """Also beyond the cloth that the text says: it goes on. One that is no repeat is told the true one."""
        shares = []
        for at in ((0.3, 0.2), (0.3, -3.1), (30.8, 20.7)):
            x, y = at
            text = braid(cell=f"cell {x} {y} -0.45  {x + 2.2} {y + 4.4} 0.45\n  matrix epoxy\n  periodic x y\nend\n")
            done = self.succeeds(
                "mesh",
                self.written(text),
                "--matrix",
                "--periodic",
                "--size",
                "0.3",
                "--order",
                "1",
                "-o",
                self.folder / "cell.inp",
            )
            shares.append(float(re.search(r"yarns fill .* \(wanted: (\S+) %\)", done.stdout + done.stderr)[1]))
        self.assertLess(np.ptp(shares), 0.02)
        text = braid(cell="cell 0 0 -0.45  2.2 3.3 0.45\n  matrix epoxy\n  periodic x y\nend\n")
        told = self.fails(1, "mesh", self.written(text), "--matrix", "--periodic", "-o", self.folder / "cell.inp")
        self.assertRegex(
            told, r"3\.3 mm long along y, which is no whole number of repeats: its yarns repeat after 4\.4 mm"
        )

    def test_refusals(self):
        self.assertIn(
            "the pattern 2/2 does not repeat in a planar braid of 6 carriers: it takes a multiple of 4, such as 8",
            self.fails(1, "check", self.written(braid(6))),
        )
        self.assertIn(
            "of a planar braid run each way: their number has to be even",
            self.fails(1, "check", self.written(braid(5))),
        )
        told = self.fails(1, "check", self.written(braid(width=1)))
        needed = re.search(r"it has to be at least (\S+) mm", told)[1]
        self.succeeds("info", self.written(braid(width=needed)))
        self.assertIn("3 axial yarns are too many", self.fails(1, "check", self.written(braid(axial="axial carbon 3"))))
        told = self.fails(1, "check", self.written(braid(length=0.5, cell="")))
        length = re.search(r"its length has to be at least (\S+) mm", told)[1]
        self.succeeds("check", self.written(braid(length=length, cell="")))

    def test_back_to_text(self):
        self.succeeds("convert", self.written(TEXT), "--to", "txt", "-o", self.folder / "back.txt")
        self.assertIn("planar 4.4\n", (self.folder / "back.txt").read_text())

    def test_its_stiffness(self):
        """Positive and symmetric; beside the braid by hand of the same sections, ways and pattern. That one is 7 % higher, so that
        it has less yarn, and its waves are longer: what the one costs the other brings, within 5 % of the diagonal's roots (found: 3.6).
        """
        if shutil.which("ccx") is None:
            self.skipTest("CalculiX is not installed")
        found = []
        for text in (
            TEXT.replace("matrix epoxy", "matrix epoxy\n  periodic x y z"),
            (SAMPLES / "cell_braid.txt").read_text().replace("periodic x y", "periodic x y z"),
        ):
            deck = self.folder / "cell.inp"
            self.succeeds(
                "mesh", self.written(text), "--matrix", "--periodic", "--size", "0.25", "--order", "1", "-o", deck
            )
            run = subprocess.run(
                [sys.executable, HOMOGENIZE, deck, "--json", "-", "--solver", "direct"],
                capture_output=True,
                text=True,
                check=False,
                env=os.environ,
            )
            self.assertEqual(run.returncode, 0, run.stderr)
            result = json.loads(run.stdout)
            self.assertLess(result["asymmetry"], 1e-6)
            found.append(np.array(result["stiffness"]))
            self.assertGreater(np.linalg.eigvalsh(found[-1]).min(), 0)
        ours, by_hand = found
        scale = np.sqrt(np.outer(np.diag(by_hand), np.diag(by_hand)))
        self.assertLess((np.abs(ours - by_hand) / scale).max(), 0.05, f"{ours}\n{by_hand}")


if __name__ == "__main__":
    unittest.main()
