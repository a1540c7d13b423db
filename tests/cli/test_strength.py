"""Strengths of materials: in decks, and what of a unit cell breaks first (scripts/homogenize), against closed forms."""

import json
import math
import re
import subprocess
import sys
import unittest

import numpy

from program import Case, ROOT, run

CELL = """fabric 1
material tow
  elastic isotropic {tow}
  strength transverse 100 60 12 30 20 14
end
material resin
  elastic isotropic {resin}
  strength isotropic {strength}
end
thread t
  section {section}
  material tow
end
yarn tow t
  path
{path}
  end
end
cell 0 0 0  1 1 {height}
  matrix resin
  periodic x y{z}
end
"""
XT, XC, YT, YC, S12, S23 = 100, 60, 12, 30, 20, 14
STRAIGHT = "    -2 0.5 0.4\n    4 0.5 0.4"
SLANTED = "    -2 0.3 0.35\n    4 0.9 0.45"


def hashin(s):
    """The largest of the modes' sums at a stress (3 x 3, axis 1 along the yarn)."""
    across, slide = s[1, 1] + s[2, 2], (s[0, 1] ** 2 + s[0, 2] ** 2) / S12**2
    turn = (s[1, 2] ** 2 - s[1, 1] * s[2, 2]) / S23**2
    fibre = (s[0, 0] / XT) ** 2 + slide if s[0, 0] > 0 else -s[0, 0] / XC
    if across >= 0:
        return max(fibre, (across / YT) ** 2 + turn + slide)
    return max(fibre, ((YC / 2 / S23) ** 2 - 1) * across / YC + (across / 2 / S23) ** 2 + turn + slide)


def load_of(criterion, stress):
    """By bisection, where the criterion of the stress times it is 1."""
    low, high = 0.0, 1e5
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if criterion(middle * stress) < 1 else (low, middle)
    return low


def unit_stress(k):
    stress = numpy.zeros((3, 3))
    i, j = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)][k]
    stress[i, j] = stress[j, i] = 1
    return stress


class Strength(Case):
    def cell(
        self,
        *options,
        name="cell",
        tow="3400 0.35",
        resin="3400 0.35",
        strength="500 500",
        section="ellipse 0.4 0.3",
        path=STRAIGHT,
        height=1,
        z=" z",
    ):
        text = self.folder / f"{name}.txt"
        text.write_text(
            CELL.format(tow=tow, resin=resin, strength=strength, section=section, path=path, height=height, z=z)
        )
        done = run("mesh", text, "--matrix", *options, "-o", self.folder / f"{name}.inp")
        self.assertEqual(done.returncode, 0, done.stderr)
        return self.folder / f"{name}.inp"

    def homogenize(self, deck, *options):
        done = subprocess.run(
            [sys.executable, ROOT / "scripts" / "homogenize.py", deck, "--json", "-", *options],
            text=True,
            capture_output=True,
            check=False,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def loads(self, deck, *options):
        failure = self.homogenize(deck, *options)["first_failure"]
        self.assertEqual(failure["not_judged"], [])
        return failure["loads"]

    def test_a_slanted_yarn_in_what_is_as_stiff(self):
        """Stress is the same everywhere: Hashin's sums of it, turned into the yarn."""
        first = numpy.array([6, 0.6, 0.1]) / math.sqrt(36 + 0.36 + 0.01)
        second = numpy.cross([0, 0, 1], first)
        second /= numpy.linalg.norm(second)
        turn = numpy.array([first, second, numpy.cross(first, second)])
        deck = self.cell("--voxel", "8", path=SLANTED)
        for solver in ("direct", "iterative"):
            modes = set()
            for k, entry in enumerate(self.loads(deck, "--solver", solver)):
                sign = 1 if entry["direction"] == "+" else -1
                expected = load_of(hashin, sign * turn @ unit_stress(k % 6) @ turn.T)
                for one in (entry["first"], entry["one_percent"]):
                    self.assertAlmostEqual(one["value"] / expected, 1, delta=1e-5, msg=entry)
                    self.assertEqual(one["region"], "tow")
                modes.add(entry["first"]["mode"])
            self.assertEqual(modes, {"fibre tension", "fibre compression", "matrix tension", "matrix compression"})

    def test_the_weaker_of_yarn_and_matrix(self):
        deck = self.cell("--size", "0.3", "--order", "1", strength="10 25 6")
        expected = {("xx", "+"): 10, ("xx", "-"): 12, ("xy", "+"): 6}  # XX-: sheared by half of it
        for entry in self.loads(deck):
            value = expected.get((entry["load"], entry["direction"]))
            if value:
                self.assertAlmostEqual(entry["first"]["value"], value, delta=1e-4 * value)
                self.assertEqual(entry["first"]["region"], "Matrix")

    def test_layers(self):
        """Of one Poisson's ratio: each has the stress of the whole by its share of the stiffness."""
        deck = self.cell(
            "--voxel",
            "8",
            tow="7000 0.3",
            resin="3000 0.3",
            strength="20 50",
            section="polygon\n -4 -0.25\n 4 -0.25\n 4 0.25\n -4 0.25\n end",
            path="    -2 0.5 0.5\n    3 0.5 0.5",
        )  # half of the height
        mean = (7000 + 3000) / 2
        found = {(entry["load"], entry["direction"]): entry["first"] for entry in self.loads(deck)}
        for load, region, strength, modulus in (
            (("xx", "+"), "Matrix", 20, 3000),
            (("xx", "-"), "tow", XC, 7000),
            (("yy", "+"), "tow", YT, 7000),
            (("yy", "-"), "tow", YC, 7000),
            (("xy", "+"), "tow", S12, 7000),
        ):
            self.assertEqual(found[load]["region"], region)
            self.assertAlmostEqual(found[load]["value"] / (strength * mean / modulus), 1, delta=1e-5)

    def test_a_plate_in_bending(self):
        """Without contraction ten nodes bend rightly, as far as four points integrate curved ones: the stress is 12 M z / h^3 at the
        farthest point of integration."""
        deck = self.cell("--periodic", "--size", "0.3", tow="3400 0", resin="3400 0", strength="8 9", height=0.8, z="")
        sys.path.insert(0, str(ROOT / "scripts"))
        from cell_deck import Deck

        mesh = Deck(deck)
        corners = numpy.array([[mesh.nodes[n] for n in nodes[:4]] for nodes in mesh.elements.values()])[:, :, 2] - 0.4
        near = (5 - math.sqrt(5)) / 20
        highest = abs(near * corners.sum(axis=1)[:, None] + (1 - 4 * near) * corners).max()
        found = {(entry["load"], entry["direction"]): entry["first"] for entry in self.loads(deck)}
        self.assertAlmostEqual(found["xx", "+"]["value"] / (8 * 0.8), 1, delta=1e-3)
        self.assertAlmostEqual(found["kxx", "+"]["value"] / (8 * 0.8**3 / 12 / highest), 1, delta=1e-3)

    def test_cards(self):
        text = ROOT / "samples" / "cell_straight.txt"
        plain = text.read_text()
        given = self.folder / "given.txt"
        given.write_text(
            plain.replace("material tow\n", "material tow\n  strength transverse 900 500 40 140 70\n", 1).replace(
                "material epoxy\n", "material epoxy\n  strength isotropic 80 120\n", 1
            )
        )
        done = run("mesh", given, "--matrix", "--periodic", "--voxel", "6", "--to", "inp,cdb,k,bdf", "-o", self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr.count("has no place for the strengths"), 2, done.stderr)  # LS-DYNA, Nastran
        deck = (self.folder / "given.inp").read_text()
        self.assertIn("*MATERIAL, NAME=tow\n** Strength: transverse 900 500 40 140 70 70\n", deck)
        self.assertIn("*MATERIAL, NAME=epoxy\n** Strength: isotropic 80 120\n", deck)
        archive = (self.folder / "given.cdb").read_text()
        self.assertIn("TB,FCLI,1,1,20,1\nTBDATA,1,900,-500,40,-140,40,-140\nTBDATA,7,70,70,70\n", archive)
        self.assertIn("TB,FCLI,2,1,20,1\nTBDATA,1,80,-120,80,-120,80,-120\nTBDATA,7,80,80,80\n", archive)

    def test_where_there_is_no_card_a_warning_says_so(self):
        text = (ROOT / "samples" / "plain4_path.txt").read_text()
        given = self.folder / "dry.txt"
        given.write_text(
            text.replace(
                "thread tow\n",
                "material fibre\n  elastic isotropic 72000 0.22\n  strength transverse 2150 1450\nend\n"
                "thread tow\n  material fibre\n",
                1,
            )
        )
        for options, count in ((("--size", "0.3", "--to", "cdb"), 1), (("--elements", "beam", "--to", "inp,cdb,k"), 3)):
            done = run("mesh", given, *options, "-o", self.folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(
                len(re.findall("no place for the strengths|card of strengths wants those across", done.stderr)),
                count,
                done.stderr,
            )
            for archive in self.folder.glob("*.cdb"):
                self.assertNotIn("FCLI", archive.read_text())

    def test_fibres_are_judged_along_alone(self):
        deck = self.cell("--voxel", "4", strength="5000 5000")
        deck.write_text(deck.read_text().replace("transverse 100 60 12 30 20 14", "transverse 100 60"))
        failure = self.homogenize(deck)["first_failure"]
        self.assertEqual(failure["judged_along_alone"], ["tow"])
        found = {(entry["load"], entry["direction"]): entry["first"] for entry in failure["loads"]}
        self.assertAlmostEqual(found["xx", "+"]["value"], 100, delta=1e-3)
        self.assertAlmostEqual(found["xx", "-"]["value"], 60, delta=1e-3)
        self.assertEqual(found["yy", "+"]["region"], "Matrix")

    def test_what_has_no_strength_is_said(self):
        deck = self.cell("--voxel", "4")
        deck.write_text(deck.read_text().replace("** Strength: isotropic 500 500\n", ""))
        failure = self.homogenize(deck)["first_failure"]
        self.assertEqual(failure["not_judged"], ["Matrix"])
        deck.write_text("\n".join(line for line in deck.read_text().splitlines() if "Strength" not in line) + "\n")
        self.assertNotIn("first_failure", self.homogenize(deck))


if __name__ == "__main__":
    unittest.main()
