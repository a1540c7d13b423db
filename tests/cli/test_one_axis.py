"""Cells that are periodic along one axis, whose stiffness is that of a beam, by CalculiX: a rod and a bar against Saint-Venant, a
rope of three plies and a braided tube against Kirchhoff's theory of thin rods; what holds them in each deck.

Of yarns that touch nothing a force F and a torque M along the axis go through each alone: at the place r (from the axis) its
section carries the force F e and the moment M e + F e x r, e being the axis, and Castigliano's theorem gives its stretch and
twist. For a helix that is a closed form; the lines of a braid are taken as the program says them. Thin rods: their radius times
their curvature, 0.1 of the helices here, 0.05 of the braid, is small.
"""

import csv
import json
import os
import re
import shutil
import subprocess
import sys
import unittest

import numpy as np

from program import Case, ROOT

HOMOGENIZE = ROOT / "scripts" / "homogenize.py"
E, NU = 200000.0, 0.3
G = E / (2 * (1 + NU))
SHEAR = 6 * (1 + NU) / (7 + 6 * NU)  # Timoshenko's coefficient of a circle
HEAD = """fabric 1
units mm
material steel
  elastic isotropic 200000 0.3
  expansion 12e-6 12e-6
end
material soft
  elastic isotropic 50000 0.3
  expansion 12e-6 12e-6
end
thread wire
  diameter {diameter}
  material steel
end
"""
ROD = HEAD.format(diameter=0.8) + "yarn rod wire\n  path\n    -2 0 0\n    4 0 0\n  end\nend\n"
RADIUS, PITCH, WIRE = 1.0, 9.0, 0.2
ROPE = HEAD.format(diameter=2 * WIRE) + "".join(
    f"yarn ply{k} wire\n  helix radius {RADIUS} pitch {PITCH} turns 2 start {120 * k}deg\nend\n" for k in range(3)
)
# Between two planes a third of the pitch apart each ply goes on where the next one began.
ROPE += f"cell -1.5 -1.5 6  1.5 1.5 {6 + PITCH / 3}\n  periodic z\nend\n"
TUBE = HEAD.format(diameter=0.3) + (
    "braid\n  thread wire\n  carriers 6\n  pattern 1/1\n  radius 2.5\n  angle 40\n  length 10\nend\n"
    "cell repeat\nend\n"
)


def circle(radius):
    """Area, second moment, and torsion constant."""
    return np.pi * radius**2, np.pi * radius**4 / 4, np.pi * radius**4 / 2


def compliance(places, tangents, lengths, radius):
    """Of a line of length `lengths` at each place: stretch and twist by force and torque along z, summed."""
    area, second, torsion = circle(radius)
    axis = np.array([0.0, 0, 1])
    forces = np.stack([np.broadcast_to(axis, places.shape), np.zeros(places.shape)])
    moments = np.stack([np.cross(axis, places), np.broadcast_to(axis, places.shape)])
    along = [(some * tangents).sum(axis=2) for some in (forces, moments)]
    across = [some - part[:, :, None] * tangents for some, part in zip((forces, moments), along)]
    result = sum(
        np.einsum("in,jn,n->ij", part, part, lengths) / stiff for part, stiff in zip(along, (E * area, G * torsion))
    )
    return result + sum(
        np.einsum("inc,jnc,n->ij", part, part, lengths) / stiff
        for part, stiff in zip(across, (SHEAR * G * area, E * second))
    )


class OneAxis(Case):
    def mesh(self, text, *options, name="cell.inp"):
        source = self.folder / "cell.txt"
        source.write_text(text)
        deck = self.folder / name
        done = self.succeeds("mesh", source, "--periodic", *options, "-o", deck)
        return deck, done.stderr

    def homogenize(self, *arguments):
        return subprocess.run(
            [sys.executable, HOMOGENIZE, *arguments], capture_output=True, text=True, check=False, env=os.environ
        )

    def stiffness(self, text, *options, solver="direct"):
        if solver == "direct" and shutil.which("ccx") is None:
            self.skipTest("CalculiX is not installed")
        deck, _ = self.mesh(text, *options)
        run = self.homogenize(deck, "--json", "-", "--solver", solver)
        self.assertEqual(run.returncode, 0, run.stderr)
        result = json.loads(run.stdout)
        self.assertEqual(result["kind"], "beam")
        matrix = np.array(result["stiffness"])
        self.assertGreater(np.linalg.eigvalsh(matrix).min(), 0)
        return matrix, result

    def assert_near(self, ours, wanted, share):
        """Entries that are none are measured by those on the diagonal."""
        scale = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
        off = np.abs(ours - wanted) / scale
        self.assertLess(off.max(), share, f"{ours}\n{wanted}")

    def test_a_rod(self):
        """About its own axis, and about one beside it, to which it is free to turn: only its stretch has an arm."""
        area, second, torsion = circle(0.4)
        for solver in ("direct", "iterative"):
            ours, facts = self.stiffness(
                ROD + "cell 0 -1 -1  1 1 1\n  periodic x\nend\n", "--size", "0.2", solver=solver
            )
            self.assert_near(ours, np.diag([E * area, G * torsion, E * second, E * second]), 1e-3)
            self.assertEqual(facts["axis"], "x")
            self.assertAlmostEqual(facts["expansion"]["alpha"], 12e-6, 9)
        ours, facts = self.stiffness(ROD + "cell 0 -1 -1  1 1.6 1\n  periodic x\nend\n", "--size", "0.2")
        np.testing.assert_allclose(facts["middle"], [0.5, 0.3, 0], atol=1e-12)
        self.assertEqual(facts["order"][2:], ["bending_y", "bending_z"])
        wanted = np.diag([E * area, G * torsion, E * (second + 0.09 * area), E * second])
        wanted[0, 2] = wanted[2, 0] = -0.3 * E * area
        self.assert_near(ours, wanted, 1e-3)

    def test_a_bar_of_two_materials(self):
        """A round core in a square along y. Poisson's ratios are equal, so that it stretches and bends without stresses across."""
        text = (
            ROD.replace("-2 0 0", "0 -2 0").replace("4 0 0", "0 4 0")
            + "cell -0.6 0 -0.7  0.6 1 0.7\n  matrix {}\n  periodic y\nend\n"
        )
        area, second, _ = circle(0.4)
        a, b = 1.2, 1.4
        ours, facts = self.stiffness(text.format("soft"), "--matrix", "--size", "0.25")
        self.assertEqual(facts["order"][2:], ["bending_x", "bending_z"])
        soft, more = 50000.0, E - 50000.0
        wanted = [
            soft * a * b + more * area,
            soft * b * a**3 / 12 + more * second,
            soft * a * b**3 / 12 + more * second,
        ]
        np.testing.assert_allclose(np.diag(ours)[[0, 2, 3]], wanted, rtol=1e-3)
        # Of one material: Saint-Venant's series for a rectangle.
        ours, _ = self.stiffness(text.format("steel"), "--matrix", "--size", "0.3")
        odd = np.arange(1, 60, 2)
        torsion = (
            b * a**3 / 3 * (1 - 192 * a / (np.pi**5 * b) * (np.tanh(odd * np.pi * b / (2 * a)) / odd**5).sum())
        )
        wanted = np.diag([E * a * b, G * torsion, E * b * a**3 / 12, E * a * b**3 / 12])
        self.assert_near(ours, wanted, 5e-3)

    def test_a_rope_of_three_plies(self):
        """Three right-handed helices that touch nothing: springs. Stretched they unwind: the coupling is negative."""
        t = np.arctan2(PITCH, 2 * np.pi * RADIUS)
        place = np.array([[RADIUS, 0, 0]])
        tangent = np.array([[0, np.cos(t), np.sin(t)]])
        wanted = np.zeros((4, 4))
        wanted[:2, :2] = 3 * np.linalg.inv(compliance(place, tangent, np.array([1 / np.sin(t)]), WIRE))
        # A moment across the axis twists and bends the wire by turns.
        _, second, torsion = circle(WIRE)
        wanted[2, 2] = wanted[3, 3] = (
            3 * np.sin(t) / (np.cos(t) ** 2 / (2 * G * torsion) + (1 - np.cos(t) ** 2 / 2) / (E * second))
        )
        self.assertLess(wanted[0, 1], 0)
        ours, _ = self.stiffness(ROPE, "--segments", "10")
        self.assert_near(ours, wanted, 1.2e-2)

    def test_a_braided_tube(self):
        """Six yarns that pass each other with a gap; three turn one way, three the other, so that stretch turns nothing."""
        ours, facts = self.stiffness(TUBE, "--segments", "6")
        self.succeeds("convert", self.folder / "cell.txt", "--lines", "-o", self.folder / "lines.csv")
        low, length = facts["middle"][2] - facts["length"] / 2, facts["length"]
        lines = {}
        with (self.folder / "lines.csv").open() as file:
            for row in csv.DictReader(file):
                at = [float(row[name]) for name in ("x_mm", "y_mm", "z_mm", "tangent_x", "tangent_y", "tangent_z")]
                if low - 1e-6 <= at[2] <= low + length + 1e-6:
                    lines.setdefault(row["yarn"], []).append(at)
        self.assertEqual(len(lines), 6)
        by_hand = {}
        for line in map(np.array, lines.values()):
            middle = (line[1:] + line[:-1]) / 2
            ways = np.linalg.norm(np.diff(line[:, :3], axis=0), axis=1)
            tangents = middle[:, 3:] / np.linalg.norm(middle[:, 3:], axis=1)[:, None]
            self.assertAlmostEqual(np.ptp(line[:, 2]), length, 6)
            hand = np.sign(np.cross(middle[0, :2], tangents[0, :2]))
            by_hand.setdefault(float(hand), []).append(
                compliance(middle[:, :3] * [1, 1, 0], tangents, ways, 0.15) / length
            )
        # Of one hand they follow each other round the tube: one yarn in the eyes of the cell.
        wanted = sum(len(some) * np.linalg.inv(np.mean(some, axis=0)) for some in by_hand.values())
        self.assert_near(ours[:2, :2], wanted, 1e-2)
        self.assertLess(abs(ours[0, 1]) / np.sqrt(wanted[0, 0] * wanted[1, 1]), 1e-3)

    def test_all_decks_hold_it(self):
        """Each ply is a part of its own where the cell is a whole pitch: three nodes, and three that keep them from turning."""
        text = ROPE.replace(f"1.5 {6 + PITCH / 3}", f"1.5 {6 + PITCH}")
        deck, _ = self.mesh(text, "--segments", "6", "--order", "1", "--to", "inp,bdf,k,cdb", name="")
        files = {path.suffix: path.read_text() for path in self.folder.iterdir()}
        first = files[".inp"].split("*BOUNDARY")[1]
        rows = [line.split(",") for line in first.splitlines() if re.match(r"\d+, ", line)]
        held = [(int(node), int(low) if low == high else 0) for node, low, high in rows]
        self.assertEqual(len({node for node, _ in held}), 6)
        self.assertEqual([direction == 0 for _, direction in held], [True, False] * 3)
        self.assertNotIn(3, [direction for _, direction in held])
        bdf = [
            tuple(map(int, found)) for found in re.findall(r"^SPC1\* +1 +(\d+) +(\d+)$", files[".bdf"], re.MULTILINE)
        ]
        self.assertEqual([(node, 0 if c == 123 else c) for c, node in bdf if c != 23], held)
        block = files[".k"].split("*BOUNDARY_SPC_NODE\n")[1].split("*")[0]
        rows = [list(map(int, line.split())) for line in block.splitlines()][:6]
        self.assertEqual([(row[0], 0 if sum(row[2:5]) == 3 else row[2:5].index(1) + 1) for row in rows], held)
        solution = files[".mac"].split("! load step")[0]
        ansys = re.findall(r"^D,(\d+),U([XYZ]),0(,,,,UY,UZ)?$", solution, re.MULTILINE)
        self.assertEqual([(int(node), 0 if rest else "XYZ".index(c) + 1) for node, c, rest in ansys], held)

    def test_what_is_said(self):
        """That few nodes are too stiff; what has no load cases."""
        _, said = self.mesh(ROD + "cell 0 -1 -1  1 1 1\n  periodic x\nend\n", "--order", "1")
        self.assertIn("tetrahedra of four nodes make a beam too stiff in bending", said)
        source = self.folder / "ring.txt"
        source.write_text(
            ROD.replace("-2 0 0", "-5 0 0").replace("4 0 0", "6 0 0")
            + "yarn ring wire\n  closed\n  path\n    0.5 2 0\n    2.5 4 0\n    0.5 6 0\n    -1.5 4 0\n  end\nend\n"
            "cell -3 -1 -1  4 8 1\n  periodic x\nend\n"
        )
        told = self.fails(1, "mesh", source, "--periodic", "-o", self.folder / "ring.inp")
        self.assertRegex(
            told, r"a part of 'ring' reaches neither end of this cell.* nothing holds it; put it into a matrix"
        )
        run = self.homogenize(self.folder / "cell.inp", "--bounds")
        self.assertEqual(run.returncode, 1)
        self.assertIn("bounds are known of blocks and plates", run.stderr)

    def test_homogenize_meshes_yarns_alone(self):
        (self.folder / "rod.txt").write_text(ROD + "cell 0 -1 -1  1 1 1\n  periodic x\nend\n")
        run = self.homogenize(
            self.folder / "rod.txt",
            "--dry",
            "--size",
            "0.3",
            "--solver",
            "iterative",
            "--selvage",
            os.environ["SELVAGE"],
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("beam stiffness (N, N mm, N mm2) - stretch twist bending_y bending_z", run.stdout)
        self.assertRegex(run.stdout, r"EI_z +40[12]\d")


if __name__ == "__main__":
    unittest.main()
