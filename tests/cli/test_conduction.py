"""Conductivity of unit cells, `mesh --matrix --periodic --physics conduction` and scripts/homogenize: against laminates, the
rule of mixtures, and the series of Rayleigh for arrays of cylinders in squares and hexagons (W. T. Perrins, D. R. McKenzie,
R. C. McPhedran, Proc. R. Soc. Lond. A 369 (1979) 207-225; array_conduction.py)."""

import json
import math
import os
import pathlib
import re
import subprocess
import sys
import unittest

import numpy as np

from array_conduction import HEXAGON, array_of_cylinders
from program import EVERYTHING, Case, SAMPLES, run

# SELVAGE_SIZE: the edges of the arrays' meshes (pitch 1), for studies by hand.
SCRIPTS = pathlib.Path(__file__).parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
import cell_conduction

CONTRASTS = (10, 50)
DENSITIES = {"square": (0.2, 0.4, 0.6), "hexagonal": (0.2, 0.5, 0.7)}
WANTED = 0.001  # of the series; it is 0.00003 with edges of 0.07


def published(kind, share, contrast):
    """The formulas of the paper, which end after three multipoles."""
    t = (1 + contrast) / (1 - contrast)
    f = share
    if kind == "square":
        rest = 0.305827 * f**4 * t / (t**2 - 1.402958 * f**8) + 0.013362 * f**8 / t
    else:
        rest = 0.075422 * f**6 * t / (t**2 - 1.060283 * f**12) + 0.000076 * f**12 / t
    return 1 - 2 * f / (t + f - rest)


def text_of(yarns, box, section, inner, outer, periodic="x y z"):
    """Straight yarns along x, by their places across it, in a box from the origin."""
    rows = "".join(
        f"yarn rod_{k} rod\n  path\n    -1 {y!r} {z!r}\n    {box[0] + 1!r} {y!r} {z!r}\n  end\nend\n"
        for k, (y, z) in enumerate(yarns)
    )
    return (
        f"fabric 1\nunits mm\ntolerance 1e-5\nmaterial inner\n{inner}\nend\nmaterial outer\n{outer}\nend\n"
        f"thread rod\n  section {section}\n  material inner\nend\n{rows}"
        f"cell 0 0 0  {box[0]!r} {box[1]!r} {box[2]!r}\n  matrix outer\n  periodic {periodic}\nend\n"
    )


def share_of_yarns(result):
    return sum(share for name, share in result["volume_fractions"].items() if name != "Matrix")


class Conduction(Case):
    def deck(self, text, *options, periodic=("--periodic",), physics="conduction"):
        cell, deck = self.folder / "cell.txt", self.folder / "cell.inp"
        cell.write_text(text)
        self.succeeds("mesh", cell, "--matrix", *periodic, "--physics", physics, *options, "-o", deck, "--quiet")
        return deck

    def run_script(self, deck, *more):
        return subprocess.run(
            [sys.executable, SCRIPTS / "homogenize.py", deck, "--json", "-", *more],
            text=True,
            capture_output=True,
            check=False,
        )

    def homogenized(self, deck, *more):
        told = self.run_script(deck, *more)
        self.assertEqual(told.returncode, 0, told.stderr)
        result = json.loads(told.stdout)
        self.assertLess(result["asymmetry"], 1e-5)
        self.assertEqual(result["warnings"], [])
        return result, np.array(result["tensor"])


class Series(unittest.TestCase):
    def test_against_the_formulas_of_the_paper(self):
        for kind, densities in DENSITIES.items():
            for share in densities:
                for contrast in CONTRASTS:
                    ours, theirs = array_of_cylinders(kind, share, contrast), published(kind, share, contrast)
                    self.assertAlmostEqual(ours / theirs, 1, delta=2e-4, msg=f"{kind} {share} {contrast}")

    def test_orders(self):
        """The densest that are asked for have converged; Keller's theorem holds: the array of the other contrast is inverse."""
        for kind, densities in DENSITIES.items():
            ours = array_of_cylinders(kind, densities[-1], 50)
            self.assertAlmostEqual(ours / array_of_cylinders(kind, densities[-1], 50, 16), 1, delta=1e-9)
            self.assertAlmostEqual(ours * array_of_cylinders(kind, densities[-1], 1 / 50), 1, delta=1e-12)


class Arrays(Conduction):
    def judge(self, kind, share):
        if kind == "square":
            yarns, box, diameter = [(0.5, 0.5)], (0.1, 1.0, 1.0), 2 * math.sqrt(share / math.pi)
        else:  # two cylinders, in halves on all sides
            diameter = 2 * math.sqrt(share * HEXAGON / 2 / math.pi)
            yarns, box = [(0.5, 0.0), (0.5, HEXAGON), (0.0, HEXAGON / 2), (1.0, HEXAGON / 2)], (0.1, 1.0, HEXAGON)
        size = os.environ.get("SELVAGE_SIZE", "0.07")
        text = text_of(yarns, box, f"circle {diameter!r}", " conductivity 10", " conductivity 1")
        deck = self.deck(text, "--order", "2", "--size", size)
        for contrast in CONTRASTS:
            deck.write_text(re.sub(r"(NAME=inner\n\*CONDUCTIVITY\n)\d+", rf"\g<1>{contrast}", deck.read_text()))
            result, tensor = self.homogenized(deck)
            inside = share_of_yarns(result)
            series = array_of_cylinders(kind, share, contrast)
            off = [
                tensor[0, 0] / (1 + inside * (contrast - 1)) - 1,
                tensor[1, 1] / series - 1,
                tensor[2, 2] / series - 1,
            ]
            print(
                f"{kind} {share} {contrast}: {tensor[1, 1]:.5f} {tensor[2, 2]:.5f}, series {series:.5f}: "
                f"{100 * off[1]:+.3f} % {100 * off[2]:+.3f} %; share {inside:.5f}; {result['nodes']} nodes {result['seconds']:.1f} s"
            )
            self.assertAlmostEqual(inside / share, 1, delta=1e-3)
            self.assertLess(abs(off[0]), 1e-6)
            self.assertLess(max(map(abs, off[1:])), WANTED, f"{kind} {share} {contrast}")
            self.assertLess(abs(tensor - np.diag(np.diag(tensor))).max(), 1e-3 * series)

    def test_square(self):
        for share in DENSITIES["square"]:
            with self.subTest(share=share):
                self.judge("square", share)

    def test_hexagonal(self):
        for share in DENSITIES["hexagonal"]:
            with self.subTest(share=share):
                self.judge("hexagonal", share)


class Identities(Conduction):
    def laminate(self, inner, outer, *more):
        """A ply of half the height, of voxels: it fills the cell across."""
        text = text_of(
            [(0.5, 0.5)], (1.0, 1.0, 1.0), "polygon\n -2 -0.25\n 2 -0.25\n 2 0.25\n -2 0.25\n end", inner, outer
        )
        return self.homogenized(self.deck(text, "--voxel", "4"), *more)

    def test_laminate(self):
        """Across in series, along in parallel, exactly, by either solver."""
        for solver in ("direct", "iterative"):
            result, tensor = self.laminate(" conductivity 30", " conductivity 2", "--solver", solver)
            np.testing.assert_allclose(tensor, np.diag([16, 16, 2 / (1 / 30 + 1 / 2)]), atol=2e-5)
            np.testing.assert_allclose(np.diag(result["wiener"]["lower"]), 2 / (1 / 30 + 1 / 2))
            theirs = result["hashin_shtrikman"]
            self.assertAlmostEqual(theirs["from_below"], theirs["lower"], delta=1e-4)  # a laminate reaches both
            self.assertAlmostEqual(theirs["from_above"], theirs["upper"], delta=1e-4)

    def test_transversely_isotropic_ply(self):
        result, tensor = self.laminate(" conductivity 8 2", " conductivity 1")
        np.testing.assert_allclose(tensor, np.diag([4.5, 1.5, 4 / 3]), atol=1e-5)
        self.assertNotIn("hashin_shtrikman", result)

    def test_one_material(self):
        """A yarn in a matrix of the same: the tensor is the material's."""
        rods = text_of([(0.5, 0.5)], (1.0, 1.0, 1.0), "circle 0.6", " conductivity 5", " conductivity 5")
        for options in ((), ("--order", "2")):
            _, tensor = self.homogenized(self.deck(rods, "--size", "0.2", *options))
            np.testing.assert_allclose(tensor, 5 * np.eye(3), atol=5e-5)

    def test_turned_yarn(self):
        """A yarn along the diagonal of x and y that fills the cell: its tensor in space, by CalculiX's orientations and ours."""
        text = (
            "fabric 1\nmaterial m\n conductivity 9 1\nend\nthread t\n section circle 40\n material m\nend\n"
            "yarn a t\n path\n -20 -20 0\n 20 20 0\n end\nend\ncell 0 0 0  1 1 1\n matrix m\n periodic x y z\nend\n"
        )
        for solver in ("direct", "iterative"):
            _, tensor = self.homogenized(self.deck(text, "--voxel", "3"), "--solver", solver)
            np.testing.assert_allclose(tensor, [[5, 4, 0], [4, 5, 0], [0, 0, 1]], atol=2e-5)

    def test_plate_and_held_faces(self):
        """A plate's faces let nothing through: a row of a square array, which is its own mirror image, feels none of it. With the
        gradient held on all faces the tensor is an upper bound."""
        array = array_of_cylinders("square", 0.09 * math.pi, 20)
        for periodic, options, axes in (("x y", ("--periodic",), 2), ("x y z", (), 3)):
            text = text_of([(0.5, 0.5)], (0.5, 1.0, 1.0), "circle 0.6", " conductivity 20", " conductivity 1", periodic)
            result, tensor = self.homogenized(self.deck(text, "--size", "0.1", periodic=options))
            self.assertEqual(tensor.shape, (axes, axes))
            self.assertEqual(result["kind"], "plate" if axes == 2 else "block")
            self.assertNotIn("hashin_shtrikman", result)
            self.assertAlmostEqual(tensor[0, 0], 1 + 19 * share_of_yarns(result), delta=1e-4)
            if axes == 2:
                self.assertAlmostEqual(tensor[1, 1] / array, 1, delta=0.02)
            else:
                self.assertGreater(tensor[1, 1], 1.02 * array)

    def test_physics_are_one(self):
        """Diffusion and permittivity of the same numbers give the same tensor, by their own words."""
        found = []
        for word, prop in (
            ("conduction", "conductivity"),
            ("diffusion", "diffusivity"),
            ("permittivity", "permittivity"),
        ):
            text = text_of([(0.5, 0.5)], (0.2, 1.0, 1.0), "circle 0.6", f" {prop} 7", f" {prop} 2 3")
            result, tensor = self.homogenized(self.deck(text, "--voxel", "8", physics=word))
            self.assertEqual((result["physics"], result["property"]), (word, prop))
            found.append(tensor)
        np.testing.assert_array_equal(found[0], found[1])
        np.testing.assert_array_equal(found[0], found[2])


class Samples(Conduction):
    def test_within_bounds(self):
        """Every cell of the samples that has a matrix, its yarns and that given conductivities of glass or carbon and a resin."""
        cells = [
            path for path in sorted(SAMPLES.glob("cell_*.txt")) if re.search(r"^\s*matrix", path.read_text(), re.M)
        ]
        for sample in cells if EVERYTHING else cells[::2]:
            for inner in ("1", "8 1.2"):
                with self.subTest(sample=sample.stem, inner=inner):
                    text = sample.read_text()
                    matrix = re.search(r"^\s*matrix\s+(\S+)", text, re.M)[1]
                    text = re.sub(r"^\s*conductivity.*\n", "", text, flags=re.M)
                    text = re.sub(
                        r"^material (\S+)(.*)$",
                        lambda m: f"{m[0]}\n  conductivity {'0.2' if m[1] == matrix else inner}",
                        text,
                        flags=re.M,
                    )
                    result, tensor = self.homogenized(self.deck(text, "--voxel", "24"))
                    self.assertEqual(result["outside"], 0)
                    self.assertEqual(result["notes"], [])
                    axes = len(tensor)
                    for upper, lower in ((result["wiener"]["upper"], tensor), (tensor, result["wiener"]["lower"])):
                        self.assertGreater(np.linalg.eigvalsh(np.array(upper) - np.array(lower)).min(), 0)
                    if inner == "1" and axes == 3:
                        theirs = result["hashin_shtrikman"]
                        for value in ("mean", "from_below", "from_above"):
                            self.assertTrue(theirs["lower"] < theirs[value] < theirs["upper"], value)


class Refusals(Conduction):
    def refused(self, text, *options):
        cell = self.folder / "cell.txt"
        cell.write_text(text)
        told = run("mesh", cell, "--matrix", "--periodic", "--voxel", "4", *options)
        self.assertNotEqual(told.returncode, 0)
        return told.stderr

    def test_messages(self):
        cell = lambda inner, outer: text_of([(0.5, 0.5)], (1.0, 1.0, 1.0), "circle 0.6", inner, outer)
        deck = ("-o", self.folder / "cell.inp")
        text = self.refused(cell(" density 1", " conductivity 1"), "--physics", "conduction", *deck)
        self.assertRegex(text, r"cell.txt:4:1: error: .*'inner' has no conductivity.*`conductivity \.\.\.`")
        text = self.refused(cell(" diffusivity 1", " conductivity 1"), "--physics", "diffusion", *deck)
        self.assertIn("'outer' has no diffusivity", text)
        good = cell(" conductivity 2", " conductivity 1")
        self.assertIn(
            "no material", self.refused(good.replace("  material inner\n", ""), "--physics", "conduction", *deck)
        )
        self.assertIn("--to inp", self.refused(good, "--physics", "conduction", "-o", self.folder / "cell.bdf"))
        self.assertIn(
            "--yarn-stiffness", self.refused(good, "--physics", "conduction", "--yarn-stiffness", "chamis", *deck)
        )

    def test_tensor_outside_of_its_bounds(self):
        """A deck whose equations drive too hard: what comes of it is refused, not printed."""
        text = text_of([(0.5, 0.5)], (1.0, 1.0, 1.0), "circle 0.6", " conductivity 20", " conductivity 1")
        deck = self.deck(text, "--voxel", "6")
        text = deck.read_text()
        driver = re.search(r"NSET=GradientDriver1\n(\d+)", text)[1]
        deck.write_text(re.sub(rf"\b{driver}, 11, -1\b", f"{driver}, 11, -3", text))
        told = self.run_script(deck)
        self.assertEqual(told.returncode, 1)
        self.assertRegex(told.stderr, "conductivity that was found is above (Wiener|Hashin)")


class Bounds(unittest.TestCase):
    def test_hashin_shtrikman(self):
        """Of two phases their own formula; of coated spheres, which reach it, the tensor as it is."""
        low, high = cell_conduction.hashin_shtrikman({1.0: 0.7, 11.0: 0.3})
        self.assertAlmostEqual(low, 1 + 0.3 / (1 / 10 + 0.7 / 3))
        self.assertAlmostEqual(high, 11 + 0.7 / (-1 / 10 + 0.3 / 33))
        self.assertAlmostEqual(cell_conduction.as_isotropic(low * np.eye(3), 1.0), low)

    def test_cylinders_reach_the_trace_bound(self):
        """Coated cylinders: parallel along, 1 + 2 f / (2 / (k - 1) + 1 - f) across (Hashin 1970)."""
        f, k = 0.3, 11.0
        across = 1 + 2 * f / (2 / (k - 1) + 1 - f)
        low, _ = cell_conduction.hashin_shtrikman({1.0: 1 - f, k: f})
        self.assertAlmostEqual(cell_conduction.as_isotropic(np.diag([1 + f * (k - 1), across, across]), 1.0), low)


if __name__ == "__main__":
    unittest.main()
