"""Oblique unit cells, `cell vectors`: a twill's smallest repeat against the cell along its axes, in stiffness and from the inside;
the deck's pairs and equations against numpy; what is no repeat."""

import json
import os
import pathlib
import re
import subprocess
import sys
import unittest

import meshio
import numpy as np

import unit_cell as cell
from program import Case

ROOT = pathlib.Path(__file__).parents[2]
HOMOGENIZE = ROOT / "scripts" / "homogenize.py"
TWILL = (ROOT / "samples" / "cell_twill.txt").read_text()
VECTORS = "cell vectors 4.8 0 0  -1.2 1.2 0"


TOW = """fabric 1
units mm
material carbon
  elastic transverse 140000 9000 0.3 4500 0.4
end
material epoxy
  elastic isotropic 3400 0.35
end
thread tow
  section  lenticular 1.9 0.12
  material carbon
end
yarn straight tow
  path
    0 -9 0
    0 9 0
  end
end
cell vectors {}
  matrix epoxy
end
"""

VOXELS = 0.12  # what stairs of 0.15 on yarns 0.5 thick may change, of the roots of the diagonal


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
                block, name = words[0].upper(), next(
                    (w.split("=")[1] for w in words if w.upper().startswith("NSET=")), None
                )
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
            terms = np.array(flat[1 : 1 + 3 * count], float).reshape(-1, 3)
            self.equations.append([(int(n), int(d), f) for n, d, f in terms])
            flat = flat[1 + 3 * count :]


class Oblique(Case):
    def mesh(self, text, name, *more):
        source = self.folder / f"{name}.txt"
        source.write_text(text)
        deck = self.folder / f"{name}.inp"
        return deck, self.succeeds("mesh", source, "--matrix", "--periodic", *more, "-o", deck)

    def stiffness(self, deck, solver="iterative"):
        run = subprocess.run(
            [sys.executable, HOMOGENIZE, deck, "--json", "-", "--solver", solver],
            capture_output=True,
            text=True,
            check=False,
            env=os.environ,
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        result = json.loads(run.stdout)
        return np.array(result["stiffness"]), result

    def both(self, *more):
        """Of the oblique cell and of that along the axes, four times as large; both stacked, so that nothing bends."""
        stacked = TWILL.replace("periodic x y", "periodic x y z").replace("ellipse 0.8 0.3", "ellipse 0.8 0.5")
        oblique, _ = self.mesh(stacked.replace(VECTORS, f"{VECTORS}  0 0 1.2"), "oblique", *more)
        whole, _ = self.mesh(stacked.replace(VECTORS, "cell 0 0 -0.6  4.8 4.8 0.6"), "whole", *more)
        return oblique, whole

    def assert_alike(self, oblique, whole, most):
        ours, facts = self.stiffness(oblique)
        theirs, other = self.stiffness(whole)
        self.assertLess(2.5 * facts["elements"], other["elements"])
        scale = np.sqrt(np.diag(theirs))
        off = np.abs(ours - theirs) / np.outer(scale, scale)
        self.assertLess(off.max(), most, off)
        self.assertGreater(np.linalg.eigvalsh(ours).min(), 0)

    def test_the_stiffness_of_the_whole_repeat(self):
        """Of linear tetrahedra, whose own error is larger than what is allowed here: their meshes differ."""
        self.assert_alike(*self.both("--size", "0.5", "--order", "1"), 1.2e-2)

    def test_the_stiffness_of_the_whole_repeat_by_curved_tetrahedra(self):
        if not os.environ.get("SELVAGE_TABLE"):
            self.skipTest("SELVAGE_TABLE is not set: some minutes")
        self.assert_alike(*self.both("--size", "0.6", "--order", "2"), 5e-3)

    def test_the_bending_of_the_whole_repeat(self):
        """Both as plates, of curved tetrahedra: all of A, B and D."""
        if not os.environ.get("SELVAGE_TABLE"):
            self.skipTest("SELVAGE_TABLE is not set: two minutes")
        oblique, _ = self.mesh(TWILL, "oblique", "--size", "0.3")
        whole, _ = self.mesh(TWILL.replace(VECTORS, "cell 0 0 -0.345  4.8 4.8 0.345"), "whole", "--size", "0.3")
        self.assert_alike(oblique, whole, 5e-3)

    def test_a_cohesive_interface(self):
        """The stiffness is that of the bonded cell to a thousandth, in an oblique one as well."""
        stacked = (
            TWILL.replace("periodic x y", "periodic x y z")
            .replace("ellipse 0.8 0.3", "ellipse 0.8 0.5")
            .replace(VECTORS, f"{VECTORS}  0 0 1.2")
        )
        bonded, _ = self.mesh(stacked, "bonded", "--size", "0.5", "--order", "1")
        cohesive, _ = self.mesh(stacked, "cohesive", "--size", "0.5", "--order", "1", "--interface", "cohesive")
        wanted, found = self.stiffness(bonded)[0], self.stiffness(cohesive)[0]
        scale = np.sqrt(np.diag(wanted))
        self.assertLess((np.abs(found - wanted) / np.outer(scale, scale)).max(), 1e-3)

    def test_voxels(self):
        """As many along x over the same length; the others are parallelepipeds, so that the stairs differ."""
        self.assert_alike(*self.both("--voxel", "32"), VOXELS)

    def test_a_field_of_constant_strain_meets_all_conditions(self):
        """Nodes opposite each other, over all three pairs of faces; the elements fill the cell."""
        deck = Deck(self.both("--size", "0.5", "--order", "1")[0])
        corner, edges = deck.cell[0], deck.cell[1:]
        strain = np.array([[1.0, 0.3, -0.2], [0.3, -0.7, 0.5], [-0.2, 0.5, 0.4]])
        value = {
            d: strain[i, j] * (1 if i == j else 2)
            for d, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)])
        }
        drivers = {deck.sets[f"ConstraintsDriver{d}"][0]: value[d] for d in value}
        dependent = set()
        for equation in deck.equations:
            moved = [f * (drivers[n] if n in drivers else (strain @ deck.nodes[n])[d - 1]) for n, d, f in equation]
            self.assertLess(abs(sum(moved)), 1e-12)
            dependent.add(equation[0][0])
        used = {n for element in deck.elements for n in element}
        own = {n: np.linalg.solve(edges.T, deck.nodes[n] - corner) for n in used}  # 0 .. 1 along each edge
        self.assertEqual(dependent, {n for n in used if (own[n] > 1 - 1e-9).any()})
        places = np.array([own[n] for n in used])
        self.assertLess(abs(places - 0.5).max(), 0.5 + 1e-12)
        points = np.array([[deck.nodes[n] for n in element] for element in deck.elements])
        volumes = np.linalg.det(points[:, 1:] - points[:, :1]) / 6
        self.assertGreater(volumes.min(), 0)
        self.assertAlmostEqual(volumes.sum() / np.linalg.det(edges), 1, 9)

    def test_what_is_no_repeat_is_told_the_true_vectors(self):
        """And these make a cell."""
        source = self.folder / "askew.txt"
        source.write_text(TWILL.replace(VECTORS, "cell vectors 4.8 0 0  -1.2 1.1 0"))
        told = self.fails(1, "mesh", source, "--matrix", "--periodic", "-o", self.folder / "askew.inp")
        self.assertIn("not periodic along its second vector", told)
        right = re.search(r"`(cell vectors [^`]*)`", told)[1]
        deck, _ = self.mesh(TWILL.replace(VECTORS, right), "right", "--voxel", "16")
        self.assertAlmostEqual(np.linalg.det(Deck(deck).cell[1:, :]) / Deck(deck).cell[3][2], 4 * 1.2**2, 9)

    def test_a_flat_tow_that_the_face_cuts_at_a_slant(self):
        """Its lens of 14.5 degrees ends in needles, 4.6 degrees sharp in the face; tetrahedra are hardly flatter than the lens."""
        for vectors in ("2 2 0  -1 3 0  0 0 0.4 at -0.5 -2.5 -0.2", "1 3 0  -4 4 0  0 0 0.4 at 1 -3 -0.2"):
            with self.subTest(vectors=vectors):
                source, mesh = self.folder / "tow.txt", self.folder / "tow.msh"
                source.write_text(TOW.format(vectors))
                self.succeeds("mesh", source, "--matrix", "--order", "1", "-o", mesh)
                read = meshio.read(mesh)
                self.assertGreater(cell.dihedral_angles(read.points, read.cells_dict["tetra"]).min(), 11.5)

    def test_ten_nodes_have_longer_edges_where_nobody_says_how_long(self):
        """A third of the square's side where four nodes have a quarter."""
        source, mesh = self.folder / "tow.txt", self.folder / "tow.msh"
        source.write_text(TOW.format("3 0 0  1 3 0  0 0 0.4 at -2 -1.5 -0.2"))
        counts = {}
        for size in ((), ("--size", "0.1")):
            for order, kind in (("1", "tetra"), ("2", "tetra10")):
                self.succeeds("mesh", source, "--matrix", "--order", order, *size, "-o", mesh)
                counts[order, size] = len(meshio.read(mesh).cells_dict[kind])
        self.assertLess(counts["2", ()], 0.8 * counts["1", ()])
        given = ("--size", "0.1")
        self.assertAlmostEqual(counts["2", given] / counts["1", given], 1, delta=0.02)

    def test_a_planar_triaxial_braid_in_calculix(self):
        text = (ROOT / "samples" / "cell_braid.txt").read_text().replace("periodic x y", "periodic x y z")
        deck, _ = self.mesh(text, "braid", "--size", "0.25", "--order", "1")
        stiffness, facts = self.stiffness(deck, "direct")
        self.assertLess(facts["asymmetry"], 1e-6)
        self.assertGreater(np.linalg.eigvalsh(stiffness).min(), 0)
        self.assertGreater(stiffness[0, 0], 1.5 * stiffness[1, 1])  # axial yarns run along x

    def test_cad(self):
        source = self.folder / "twill.txt"
        source.write_text(TWILL)
        self.succeeds("convert", source, "--matrix", "-o", self.folder / "twill.stp")
        self.succeeds("check", self.folder / "twill.stp")


if __name__ == "__main__":
    unittest.main()
