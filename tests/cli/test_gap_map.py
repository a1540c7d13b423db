"""`selvage check --reach` and --gap-map: near contacts, and the yarns coloured by gap, as meshio reads them."""

import json
import unittest

import meshio
import numpy as np

from program import Case, SAMPLES, files_below, run

HEAD = "fabric 1\nunits {}\nthread t\n  diameter 1\nend\nthread thin\n  diameter 0.4\nend\n"


def yarn(name, rows, thread="t"):
    return f"yarn {name} {thread}\n  path\n" + "".join(f"    {row}\n" for row in rows) + "  end\nend\n"


def crossing(height, units="mm", thread="t"):
    """A yarn along x and one along y above it; both are straight."""
    return (
        HEAD.format(units)
        + yarn("a", [f"{x} 0 0" for x in (-3, -1, 0, 1, 3)])
        + yarn("b", [f"0 {y} {height}" for y in (-3, -1, 0, 1, 3)], thread)
    )


class GapMap(Case):
    def file(self, text, name="cloth.txt"):
        path = self.folder / name
        path.write_text(text)
        return path

    def check(self, source, *options, code=0):
        """The entry in the report, and the output."""
        report = self.folder / "report.json"
        done = run("check", source, "--report", report, *options)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return json.loads(report.read_text())["inputs"][0], done

    def map(self, source, *options, code=0):
        """The mesh's points, triangles, gaps and yarns, and the entry in the report."""
        path = self.folder / "gaps.vtu"
        entry, _ = self.check(source, "--gap-map", path, *options, code=code)
        mesh = meshio.read(path)
        self.assertEqual([block.type for block in mesh.cells], ["triangle"])
        # The names, each with the number that its yarn has in the cell data.
        names = [yarn["name"] for yarn in entry["yarns"]]
        self.assertEqual(
            {name: int(number[0]) for name, number in mesh.field_data.items()}, dict(zip(names, range(len(names))))
        )
        triangles, gaps, yarns = mesh.cells[0].data, mesh.point_data["gap"], mesh.cell_data["yarn"][0]
        self.assertEqual(len(gaps), len(mesh.points))
        self.assertEqual(len(yarns), len(triangles))
        self.assertEqual(sorted(set(triangles.ravel())), list(range(len(mesh.points))))
        output = entry["outputs"][0]
        self.assertEqual((output["format"], output["bytes"]), ("vtu", path.stat().st_size))
        self.assertEqual(output["entities"], {"cells": len(triangles), "points": len(gaps)})
        return mesh.points, triangles, gaps, yarns, entry

    def judge_skins(self, points, triangles, yarns, entry):
        """Every yarn's triangles are its own, closed, outward, and hold its volume."""
        self.assertEqual(sorted(set(yarns)), list(range(entry["yarn_count"])))
        for k, facts in enumerate(entry["yarns"]):
            own = triangles[yarns == k]
            edges = np.vstack([own[:, [0, 1]], own[:, [1, 2]], own[:, [2, 0]]])
            there = np.unique(edges, axis=0)
            self.assertEqual(len(there), len(edges))
            self.assertTrue(np.array_equal(there, np.unique(edges[:, ::-1], axis=0)), facts["name"])
            p = points[own] - points[own[0, 0]]
            volume = np.einsum("ij,ij->i", p[:, 0], np.cross(p[:, 1], p[:, 2])).sum() / 6
            self.assertLess(abs(volume / facts["volume"] - 1), 0.05, facts["name"])
        of_yarn = [set(triangles[yarns == k].ravel()) for k in range(entry["yarn_count"])]
        self.assertEqual(sum(map(len, of_yarn)), len(points))


class Maps(GapMap):
    def test_two_yarns_that_overlap(self):
        """The gap at every vertex is the distance to the other one's axis less its radius."""
        points, triangles, gaps, yarns, entry = self.map(self.file(crossing(0.9)), "--reach", "0.3", code=3)
        self.judge_skins(points, triangles, yarns, entry)
        depth = entry["overlaps"][0]["depth"]
        self.assertAlmostEqual(depth, 0.1, delta=0.001)
        chord = 0.01
        self.assertAlmostEqual(gaps.min(), -depth, delta=chord)
        of_a = np.zeros(len(points), bool)
        of_a[triangles[yarns == 0].ravel()] = True
        to_b = np.hypot(points[:, 0], points[:, 2] - 0.9) - 0.5
        to_a = np.hypot(points[:, 1], points[:, 2]) - 0.5
        exact = np.where(of_a, to_b, to_a)
        self.assertLess(np.abs(gaps - np.minimum(exact, 0.3)).max(), chord + 0.001)  # and the tubes' tolerance
        self.assertEqual(gaps.max(), 0.3)

    def test_two_free_yarns(self):
        _, _, gaps, _, entry = self.map(self.file(crossing(1.04)))
        self.assertAlmostEqual(gaps.min(), entry["min_gap"], delta=0.01)
        self.assertGreater(gaps.min(), 0)
        self.assertAlmostEqual(gaps.max(), 0.1, delta=0.002)  # a tenth of the thickness
        self.assertNotIn("contacts", entry)

    def test_in_millimetres(self):
        points, _, gaps, _, entry = self.map(self.file(crossing(0.9, "cm")), "--reach", "0.3", code=3)
        self.assertAlmostEqual(points[:, 0].max(), 30, delta=0.1)
        self.assertAlmostEqual(gaps.min(), -entry["overlaps"][0]["depth"], delta=0.1)
        self.assertAlmostEqual(gaps.max(), 3, delta=1e-9)

    def test_thickness_counts_for_each_yarn(self):
        """The reach is a tenth of the thinner one's."""
        _, _, gaps, yarns, _ = self.map(self.file(crossing(0.71, thread="thin")))
        self.assertAlmostEqual(gaps.max(), 0.04, delta=0.001)
        self.assertAlmostEqual(gaps.min(), 0.01, delta=0.005)

    def test_a_free_fabric(self):
        for name in ("jersey", "weave_plain", "plain4_path"):
            points, triangles, gaps, yarns, entry = self.map(SAMPLES / f"{name}.txt")
            self.assertEqual(entry["overlaps"], [], name)
            self.judge_skins(points, triangles, yarns, entry)
            self.assertGreater(gaps.min(), 0, name)

    def test_fabrics_that_overlap(self):
        """The deepest value is the deepest overlap, within the chord."""
        for name in ("jersey", "knit_rib_1x1"):  # the latter's is of a yarn with itself
            source = SAMPLES / f"{name}.txt"
            _, _, gaps, _, entry = self.map(source, "--as-published", code=3)
            depth = entry["overlaps"][0]["depth"]
            thinnest = 10 * gaps.max()
            self.assertLess(abs(gaps.min() + depth), 0.011 * thinnest + 0.01 * depth, name)

    def test_same_input_same_bytes(self):
        source = self.file(crossing(0.9))
        for workers in ("1", "4"):
            (self.folder / workers).mkdir()
            self.fails(3, "check", source, "--gap-map", self.folder / workers / "gaps.vtu", "-j", workers)
        self.assertEqual(files_below(self.folder / "1"), files_below(self.folder / "4"))


class Near(GapMap):
    def test_near_contacts(self):
        """Two yarns above a third one, at different heights; the near contacts are no defects."""
        text = crossing(1.02) + yarn("c", [f"2 {y} 1.1" for y in (-3, -1, 0, 1, 3)])
        source = self.file(text)
        entry, done = self.check(source, "--reach", "0.15")
        contacts = entry["contacts"]
        self.assertEqual([(one["a"], one["b"]) for one in contacts], [("a", "b"), ("a", "c")])
        for one, gap, place in zip(contacts, (0.02, 0.1), ((0, 0, 0.51), (2, 0, 0.55))):
            self.assertAlmostEqual(one["gap"], gap, delta=0.001)
            for have, want in zip(one["at"], place):
                self.assertAlmostEqual(have, want, delta=0.002)
            self.assertEqual((len(one["site_a"]), len(one["site_b"])), (2, 2))
        self.assertRegex(
            done.stdout, r"near contacts of\s+and\s+gap\s+x\s+y\s+z\n\s+a\s+b\s+0\.0[12]\d*\s.*\n\s+a\s+c\s"
        )
        self.assertIn("sound:", done.stdout)
        self.assertEqual(done.stderr, "")
        fewer, _ = self.check(source, "--reach", "0.05")
        self.assertEqual(len(fewer["contacts"]), 1)
        none, done = self.check(source, "--reach", "0.01")
        self.assertEqual(none["contacts"], [])
        self.assertNotIn("near contacts", done.stdout)
        plain, done = self.check(source)
        self.assertNotIn("contacts", plain)
        self.assertNotIn("near contacts", done.stdout)

    def test_overlaps_are_not_near(self):
        entry, _ = self.check(self.file(crossing(0.9)), "--reach", "0.2", code=3)
        self.assertEqual((len(entry["overlaps"]), entry["contacts"]), (1, []))

    def test_units(self):
        entry, done = self.check(self.file(crossing(1.02, "cm")), "--reach", "0.05", "--units", "mm")
        self.assertAlmostEqual(entry["contacts"][0]["gap"], 0.2, delta=0.01)
        self.assertRegex(done.stdout, r"a\s+b\s+0\.(19|20)")


class Words(GapMap):
    def refused(self, pattern, *arguments):
        self.assertRegex(self.fails(2, "check", *arguments), pattern)
        self.assertFalse(list(self.folder.glob("*.vtu")))

    def test_use(self):
        source, other = self.file(crossing(1.1)), self.file(crossing(1.2), "other.txt")
        gaps = self.folder / "gaps.vtu"
        self.refused("name one input", source, other, "--gap-map", gaps)
        self.refused("name one input", self.folder, "--gap-map", gaps)
        for name in ("gaps.vtk", "gaps", "gaps.msh", "-"):
            self.refused("name a .vtu file", source, "--gap-map", name)
        for value in ("0", "-1", "x"):
            self.refused("--reach", source, "--reach", value)
        self.refused("would both be", source, "--gap-map", gaps, "--report", gaps)

    def test_nothing_is_left_of_a_failure(self):
        piece = SAMPLES / "collar_piece.txt"
        self.assertIn("no yarn", self.fails(1, "check", piece, "--gap-map", self.folder / "gaps.vtu"))
        source = self.file("fabric 1\nyarn a none\nend\n")
        self.fails(1, "check", source, "--gap-map", self.folder / "gaps.vtu")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["cloth.txt"])

    def test_standard_input(self):
        done = run("check", "-", "--gap-map", self.folder / "gaps.vtu", input=crossing(1.1))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "gaps.vtu").exists())


if __name__ == "__main__":
    unittest.main()
