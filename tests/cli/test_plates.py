"""Stiffness of plates as `mesh --matrix --periodic` makes their cells and scripts/homogenize tells it: against the same mesh put
together by plate_elements.py, and against plates whose bending is known."""

import json
import os
import pathlib
import subprocess
import sys
import unittest

import numpy as np

import plate_elements
import unit_cell
from program import Case

HOMOGENIZE = pathlib.Path(__file__).parents[2] / "scripts" / "homogenize.py"
TOW, RESIN = "transverse 51500 17500 0.26 5800 0.31", "isotropic 3400 0.35"


def plate_text(tow=TOW, thickness=0.7):
    """A straight tow in the middle of a plate of 1 x 1."""
    middle = thickness / 2
    return (
        f"fabric 1\nmaterial tow\n elastic {tow}\n expansion 60e-6 60e-6\nend\nmaterial resin\n elastic {RESIN}\n"
        " expansion 60e-6 60e-6\nend\nthread T\n section ellipse 0.8 0.5\n material tow\nend\n"
        f"yarn tow T\n path\n -0.5 0.5 {middle}\n 1.5 0.5 {middle}\n end\nend\n"
        f"cell 0 0 0  1 1 {thickness}\n matrix resin\n periodic x y\nend\n"
    )


def scaled(difference, matrix):
    """Over the roots of the diagonal: membrane, coupling and bending have units of their own."""
    scale = np.sqrt(np.diag(matrix))
    return np.abs(difference / np.outer(scale, scale))


class Plates(Case):
    def deck(self, text, *more):
        source = self.folder / "plate.txt"
        source.write_text(text)
        deck = self.folder / "plate.inp"
        run = self.succeeds("mesh", source, "--matrix", "--periodic", *more, "-o", deck)
        return deck, run

    def homogenize(self, deck, *more):
        return subprocess.run(
            [sys.executable, HOMOGENIZE, deck, "--json", "-", *more],
            capture_output=True,
            text=True,
            check=False,
            env=os.environ,
        )

    def stiffness(self, deck, *more):
        run = self.homogenize(deck, *more)
        self.assertEqual(run.returncode, 0, run.stderr)
        return np.array(json.loads(run.stdout)["stiffness"])

    def test_the_same_mesh_assembled_anew(self):
        """Solved by CalculiX and by conjugate gradients; what repeats is found with Kirchhoff's field as the elements have it,
        and, as curved edges allow, as it is exactly."""
        deck, _ = self.deck(plate_text(), "--size", "0.4")
        anew = plate_elements.plate(deck)
        self.assertLess(scaled(plate_elements.plate(deck, exact_field=True) - anew, anew).max(), 2e-3)
        for solver in ("direct", "iterative"):
            with self.subTest(solver=solver):
                self.assertLess(scaled(self.stiffness(deck, "--solver", solver) - anew, anew).max(), 1e-6)

    def test_one_material_bends_as_it_should(self):
        """E t^3 / (12 (1 - nu^2)) at the default size, and no coupling."""
        deck, _ = self.deck(plate_text(RESIN))
        self.assertEqual(unit_cell.Deck(deck).types, {"C3D10"})
        found = self.stiffness(deck)
        e, nu, t = 3400, 0.35, 0.7
        plane = e / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
        exact = np.block([[plane * t, np.zeros((3, 3))], [np.zeros((3, 3)), plane * t**3 / 12]])
        error = scaled(found - exact, exact)
        self.assertLess(error[3:, 3:].max(), 1e-3)
        self.assertLess(error[:3].max(), 1e-6)

    def test_a_symmetric_plate_is_not_coupled(self):
        found = self.stiffness(self.deck(plate_text())[0])
        # Free meshes are not symmetric: what is left falls with the edges' length.
        coarse = scaled(found, found)[:3, 3:].max()
        self.assertLess(coarse, 5e-4)
        fine = self.stiffness(self.deck(plate_text(), "--size", "0.1")[0])
        self.assertLess(scaled(fine, fine)[:3, 3:].max(), 0.5 * coarse)

    def test_what_cannot_be_is_not_told(self):
        """Two four-node tetrahedra over the thickness: above Voigt's bound in twisting."""
        deck, run = self.deck(plate_text(RESIN), "--order", "1", "--size", "0.4")
        self.assertIn("tetrahedra of four nodes make a plate too stiff in bending", run.stderr)
        refused = self.homogenize(deck)
        self.assertEqual(refused.returncode, 1)
        self.assertEqual(refused.stdout, "")
        self.assertIn("above Voigt's bound", refused.stderr)
        self.assertIn("--order 2", refused.stderr)


if __name__ == "__main__":
    unittest.main()
