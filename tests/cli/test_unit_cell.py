"""Cells of the samples as `mesh --matrix --periodic` writes them: measured from the deck alone.

SELVAGE_CELL names samples (without .txt), SELVAGE_SEGMENTS the numbers of edges round their yarns to go through,
SELVAGE_ORDER the order: for studies by hand.
"""

import json
import os
import unittest

import numpy as np

import unit_cell as cell
from program import Case, SAMPLES

NAMES = os.environ.get(
    "SELVAGE_CELL", "cell_plain twill_cell cell_satin5 cell_orthogonal cell_jersey cell_tricot"
).split()
SEGMENTS = os.environ.get("SELVAGE_SEGMENTS", "").split()
USUAL = {"twill_cell": "28"}  # edges may not be longer than a yarn is thick; of the others 20
COARSEST = {"cell_jersey": "0.1", "cell_tricot": "0.05"}  # mm, away from the yarns; of the others 0.2
ORDER = os.environ.get("SELVAGE_ORDER", "1")
TARGET = 10.0


class UnitCell(Case):
    def mesh(self, name, *more):
        sample, deck, report = SAMPLES / (name + ".txt"), self.folder / (name + ".inp"), self.folder / "report.json"
        more = ("--matrix-size", COARSEST.get(name, "0.2"), *more)
        self.succeeds(
            "mesh", sample, "--matrix", "--periodic", "--order", ORDER, *more, "-o", deck, "--report", report, "--quiet"
        )
        return sample, cell.Deck(deck), json.loads(report.read_text())["inputs"][0]["mesh"]

    def judge(self, name, *more):
        sample, deck, report = self.mesh(name, *more)
        low, high = cell.box_of(sample)
        size = (high - low).max()
        points, cells = deck.points, deck.all_elements()

        # Memory is planned by the estimate.
        self.assertLess(abs(np.log2(len(cells) / report["estimate"])), 1, f"{name} {more}: {report['estimate']:.0f}")

        # Conformal: inner faces have two elements, and the outer ones are the box.
        used = points[deck.used()]
        np.testing.assert_array_equal(used.min(axis=0), low)
        np.testing.assert_array_equal(used.max(axis=0), high)
        faces = cell.outer_faces(cells)
        sides = [(axis, value) for axis in range(3) for value in (low[axis], high[axis])]
        in_face = np.array([np.all(points[faces][:, :, axis] == value, axis=1) for axis, value in sides])
        self.assertTrue(in_face.any(axis=0).all(), "an outer face lies in no face of the box")
        for (axis, _), chosen in zip(sides, in_face):
            area = np.prod(np.delete(high - low, axis))
            self.assertAlmostEqual(cell.face_areas(points, faces[chosen]).sum() / area, 1, delta=1e-12)

        # Positive and well shaped.
        self.assertGreater(cell.smallest_jacobian(points, cells), 0)
        angles = np.sort(cell.dihedral_angles(points, cells).min(axis=1))
        angle = angles[0]
        self.assertGreaterEqual(angle, TARGET)
        self.assertAlmostEqual(angle, report["min_dihedral"], delta=1e-6)
        self.assertAlmostEqual(angles[len(angles) // 100], report["first_percentile_dihedral"], delta=1e-6)

        # Periodic.
        miss = max(cell.opposite_miss(used, low, high, axis) for axis in (0, 1))
        self.assertLessEqual(miss, 1e-12 * size)

        # Regions and their volumes.
        regions = {region["name"]: region for region in report["regions"]}
        self.assertEqual(len(deck.sets), len(regions))
        found = {name: cell.volumes(points, rows).sum() for name, rows in deck.sets.items()}
        self.assertAlmostEqual(sum(found.values()) / np.prod(high - low), 1, delta=1e-12)
        errors = [abs(volume / region["exact_volume"] - 1) for volume, region in zip(found.values(), report["regions"])]
        return max(errors), angle, len(cells)

    def test_cells(self):
        for name in NAMES:
            for segments in SEGMENTS or [USUAL.get(name, "20")]:
                with self.subTest(cell=name, segments=segments):
                    error, angle, count = self.judge(name, "--segments", segments)
                    print(f"{name} {segments}: {count} tetrahedra, volumes to {100 * error:.3f} %, {angle:.2f} degrees")
                    self.assertLess(error, 0.002)

    def test_volumes_are_kept_at_any_size(self):
        for name, segments in (("cell_plain", "12"), ("cell_plain", "40"), ("cell_jersey", "12")):
            with self.subTest(cell=name, segments=segments):
                self.assertLess(self.judge(name, "--segments", segments)[0], 0.002)

    def test_bonded_yarns_share_faces(self):
        """`--bond`: only then do yarns have faces in common, and what they gain is what the matrix loses."""
        shared, volumes = [], []
        for more in ((), ("--bond",)):
            _, deck, report = self.mesh("cell_plain", "--size", "0.15", *more)
            yarns = {name: cells for name, cells in deck.sets.items() if name != "Matrix"}
            faces = np.concatenate([cell.outer_faces(cells) for cells in yarns.values()])
            unique, counts = np.unique(faces, axis=0, return_counts=True)
            shared.append(cell.face_areas(deck.points, unique[counts == 2]).sum())
            volumes.append({name: cell.volumes(deck.points, cells).sum() for name, cells in deck.sets.items()})
            for region, volume in zip(report["regions"], volumes[-1].values()):
                self.assertAlmostEqual(region["volume"] / volume, 1, delta=1e-9)
        self.assertEqual(shared[0], 0)
        self.assertGreater(shared[1], 0.1)  # mm2: four crossings of tows 1.1 mm wide
        self.assertAlmostEqual(sum(volumes[0].values()), sum(volumes[1].values()), delta=1e-12)
        for name in volumes[0]:
            (self.assertLess if name == "Matrix" else self.assertGreater)(volumes[1][name], volumes[0][name])


if __name__ == "__main__":
    unittest.main()
