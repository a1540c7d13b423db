"""Meshes of straight tetrahedra at the default size keep the yarns' volume: measured from the deck, against formulas and against
the volume of the B-spline yarn."""

import json
import math
import re
import unittest

import numpy as np

import unit_cell as cell
from program import Case, RING, SAMPLES

TOLERANCE = 0.002
HEAD = "fabric 1\nunits mm\ntolerance 1e-5\nthread t\n  section {}\nend\n"


def yarn(name, *places):
    return f"yarn {name} t\n  path\n" + "".join(f"    {place}\n" for place in places) + "  end\nend\n"


class KeptVolume(Case):
    def mesh(self, source, *more):
        """Points, the volumes of the yarns in the deck, the report's entry, and what stood on the console."""
        deck, report = self.folder / "mesh.inp", self.folder / "report.json"
        done = self.succeeds("mesh", source, "-o", deck, "--report", report, "--no-progress", *more)
        read = cell.Deck(deck)
        volumes = [cell.volumes(read.points, rows).sum() for rows in read.sets.values()]
        return read, volumes, json.loads(report.read_text())["inputs"][0], done.stdout

    def written(self, text):
        path = self.folder / "input.txt"
        path.write_text(text)
        return path

    def test_a_cylinder(self):
        text = HEAD.format("circle 0.6") + yarn("rod", "0 0 0", "2 0 0")
        read, volumes, _, console = self.mesh(self.written(text))
        self.assertLess(abs(volumes[0] / (math.pi * 0.09 * 2) - 1), TOLERANCE)
        self.assertLess(abs(read.points[:, 0].min()), 1e-12)  # the ends stay planes
        self.assertLess(abs(read.points[:, 0].max() - 2), 1e-12)
        self.assertRegex(console, r"volumes are right to \S+ %, the worst is yarn 'rod'")

    def test_a_torus(self):
        _, volumes, _, _ = self.mesh(RING)
        self.assertLess(abs(volumes[0] / (2 * math.pi**2 * 5 * 0.25) - 1), TOLERANCE)

    def test_dry_samples(self):
        for name in ("weave_plain", "ply3_z", "weave_racetrack"):
            with self.subTest(sample=name):
                _, volumes, entry, _ = self.mesh(SAMPLES / (name + ".txt"))
                for volume, wanted in zip(volumes, entry["yarns"], strict=True):
                    self.assertLess(abs(volume / wanted["volume"] - 1), TOLERANCE, wanted["name"])

    def test_angles(self):
        """Ten degrees, whether corners have moved for the volume or not."""
        for name in ("plain4_grid", "weave_plain"):
            for order in ("1", "2"):
                with self.subTest(sample=name, order=order):
                    read, *_ = self.mesh(SAMPLES / (name + ".txt"), "--order", order)
                    self.assertGreaterEqual(
                        min(cell.dihedral_angles(read.points, rows).min() for rows in read.sets.values()), 10 - 1e-6
                    )

    def test_no_tetrahedron_turns(self):
        """Coarse triangles over a sharp crest, whose points go far: as far as the tetrahedra below them are high."""
        read, volumes, entry, _ = self.mesh(SAMPLES / "sections.txt", "--size", "0.4")
        for volume, wanted in zip(volumes, entry["yarns"], strict=True):
            self.assertLess(abs(volume / wanted["volume"] - 1), TOLERANCE, wanted["name"])
        self.assertGreater(min(cell.dihedral_angles(read.points, rows).min() for rows in read.sets.values()), 1)

    def test_a_gap_stays_open(self):
        """Two rods a hundredth of their diameter apart: the nodes between them stay where they are, the others make up."""
        text = HEAD.format("circle 0.6") + yarn("low", "0 0 0", "2 0 0") + yarn("high", "0 0 0.606", "2 0 0.606")
        read, volumes, _, _ = self.mesh(self.written(text))
        for volume in volumes:
            self.assertLess(abs(volume / (math.pi * 0.09 * 2) - 1), TOLERANCE)
        low, high = (read.points[np.unique(rows)] for rows in read.sets.values())
        self.assertGreater(high[:, 2].min() - low[:, 2].max(), 0.85 * 0.006)
        self.assertLess(low[:, 2].min(), -0.3)  # on the other side they are outside of the rod

    def test_a_jammed_cloth(self):
        """Its yarns touch all along: 0.006 mm are left, and a twentieth of that from each side is no room for 1.8 % of a volume."""
        read, volumes, entry, _ = self.mesh(SAMPLES / "weave_jammed.txt")
        for volume, wanted in zip(volumes, entry["yarns"], strict=True):
            self.assertLess(abs(volume / wanted["volume"] - 1), TOLERANCE, wanted["name"])

    def test_what_is_not_kept_is_told(self):
        """Seven coarse filaments that touch, of which the middle one has no room to grow; with nodes on its edges it is right."""
        text = (HEAD.replace("1e-5", "5e-4").format("ellipse 0.442 0.221") + yarn("y", "0 0 0", "0.122 0 0")).replace(
            "\nend", "\n  filaments 7\n  packing 0.7\nend", 1
        )
        source, report = self.written(text), self.folder / "report.json"
        for order, is_kept in (("1", False), ("2", True)):
            done = self.succeeds(
                "mesh", source, "-o", self.folder / "a.inp", "--size", "0.033", "--order", order, "--report", report
            )
            mesh = json.loads(report.read_text())["inputs"][0]["mesh"]
            worst = max(abs(region["volume_error"]) for region in mesh["regions"])
            self.assertEqual(worst < TOLERANCE, is_kept)
            self.assertEqual("a smaller --size or --order 2 makes it better" in done.stderr, not is_kept, done.stderr)

    def test_nodes_of_order_2_are_on_the_surface(self):
        text = HEAD.format("circle 0.6") + yarn("rod", "0 0 0", "2 0 0")
        read, volumes, _, _ = self.mesh(self.written(text), "--order", "2")
        self.assertLess(abs(volumes[0] / (math.pi * 0.09 * 2) - 1), TOLERANCE)
        radii = np.hypot(read.points[:, 1], read.points[:, 2])
        self.assertLess(abs(radii.max() / 0.3 - 1), 1e-3)

    def test_a_cell(self):
        """A straight tow through a block: half the ellipse's area times the length, and the console says the fractions."""
        tow = (
            (SAMPLES / "cell_straight.txt")
            .read_text()
            .replace("thread roving\n", "thread roving\n  tex 300\n  density 2.5\n")
        )
        _, volumes, entry, console = self.mesh(self.written(tow), "--matrix", "--periodic")
        exact = math.pi / 4 * 0.8 * 0.5
        self.assertLess(abs(volumes[0] / exact - 1), TOLERANCE)
        self.assertLess(abs(sum(volumes) / 0.7 - 1), 1e-12)
        share = re.search(
            r"yarns fill (\S+) % of the cell \(wanted: (\S+) %\), fibres (\S+) %; volumes are right to", console
        )
        self.assertIsNotNone(share, console)
        for found, wanted in zip(share.groups(), (exact, exact, 0.3 / 2.5)):  # 300 tex of 2.5 g/cm3: 0.12 mm2
            self.assertLess(abs(float(found) / (100 * wanted / 0.7) - 1), TOLERANCE)
        for region in entry["mesh"]["regions"]:
            self.assertLess(abs(region["volume_error"]), TOLERANCE)


if __name__ == "__main__":
    unittest.main()
