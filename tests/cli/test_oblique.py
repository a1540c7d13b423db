"""Oblique unit cells, `cell vectors`: a twill's smallest repeat against the cell along its axes, in stiffness and from the inside;
the deck's pairs and equations against numpy; what is no repeat."""

import json
import os
import pathlib
import re
import subprocess
import sys
import unittest

import numpy as np

from program import Case

ROOT = pathlib.Path(__file__).parents[2]
HOMOGENIZE = ROOT / "scripts" / "homogenize.py"
TWILL = (ROOT / "samples" / "cell_twill.txt").read_text()
VECTORS = "cell vectors 4.8 0 0  -1.2 1.2 0"


def twill(cell):
    return TWILL.replace(VECTORS, cell)


class Deck:
    """Nodes, elements, equations and named nodes of an Abaqus deck."""

    def __init__(self, path):
        self.nodes, self.elements, self.equations, self.sets = {}, [], [], {}
        block, name, rows = None, None, []
        for line in path.read_text().splitlines():
            found = re.match(r"\*\* Cell: (.*)", line)
            if found:
                self.cell = np.array(found[1].split(), float).reshape(-1, 3)
            if line.startswith("*"):
                if line.startswith("**"):
                    continue
                words = [word.strip() for word in line.split(",")]
                block, name = words[0].upper(), next((w.split("=")[1] for w in words if w.upper().startswith("NSET=")), None)
            elif block == "*NODE":
                number, *at = line.split(",")
                self.nodes[int(number)] = np.array(at, float)
                if name and len(self.sets.get(name, [])) < 1:
                    self.sets.setdefault(name, []).append(int(number))
            elif block == "*ELEMENT":
                self.elements.append([int(word) for word in line.split(",") if word.strip()][1:])
            elif block == "*NSET":
                self.sets.setdefault(name, []).extend(int(w) for w in line.split(",") if w.strip().isdigit())
            elif block == "*EQUATION":
                rows.append([word for word in line.replace(",", " ").split()])
        flat = [word for row in rows for word in row]
        while flat:
            count = int(flat[0])
            terms = np.array(flat[1:1 + 3 * count], float).reshape(-1, 3)
            self.equations.append([(int(n), int(d), f) for n, d, f in terms])
            flat = flat[1 + 3 * count:]


class Oblique(Case):
    def mesh(self, text, name, *more):
        source = self.folder / f"{name}.txt"
        source.write_text(text)
        deck = self.folder / f"{name}.inp"
        return deck, self.succeeds("mesh", source, "--matrix", "--periodic", *more, "-o", deck, "--report", self.folder / f"{name}.json")

    def stiffness(self, deck):
        run = subprocess.run([sys.executable, HOMOGENIZE, deck, "--json", "-", "--solver", "iterative"], capture_output=True,
                             text=True, check=False, env=os.environ)
        self.assertEqual(run.returncode, 0, run.stderr)
        result = json.loads(run.stdout)
        return np.array(result["stiffness"]), result

    def both(self, *more):
        """Of the oblique cell and of that along the axes, four times as large, of the same height."""
        oblique, run = self.mesh(TWILL, "oblique", *more)
        corners = Deck(oblique).cell
        low, high = corners[0][2], corners[0][2] + corners[3][2]
        whole, _ = self.mesh(twill(f"cell 0 0 {low!r}  4.8 4.8 {high!r}"), "whole", *more)
        return oblique, whole

    def assert_alike(self, oblique, whole, most):
        ours, facts = self.stiffness(oblique)
        theirs, other = self.stiffness(whole)
        self.assertEqual(facts["kind"], "plate")
        self.assertLess(3.5 * facts["elements"], other["elements"])
        scale = np.sqrt(np.diag(theirs))
        off = np.abs(ours - theirs) / np.outer(scale, scale)
        self.assertLess(off.max(), most, off)
        self.assertGreater(np.linalg.eigvalsh(ours).min(), 0)

    def test_the_stiffness_of_the_whole_repeat(self):
        self.assert_alike(*self.both("--size", "0.2", "--matrix-size", "0.4"), 5e-3)

    def test_voxels(self):
        """Along x as many over the same length; the others are parallelepipeds. Stairs differ: 3 %."""
        oblique, whole = self.both("--voxel", "48")
        self.assert_alike(oblique, whole, 3e-2)


if __name__ == "__main__":
    unittest.main()
