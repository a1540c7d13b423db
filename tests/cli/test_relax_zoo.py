"""Fabrics that overlap, of every family, are moved apart: CGAL finds no overlap any more, and what makes the fabric is
as it was, measured here on the grids (relaxed.py). SELVAGE_PART=I/N takes the I-th of N parts of them.

Needs numpy: /usr/bin/python3 has it where scripts/setup was run.
"""

import json
import os
import unittest

import relaxed
from program import Case, SAMPLES

THREAD = "fabric 1\nthread t\n  {}\nend\n"


def weave(section, pitch, draft, more="", count=4):
    return THREAD.format(section) + (
        f"weave\n  warp t {count} pitch {pitch}\n  weft t {count} pitch {pitch}\n" f"  draft {draft}\n  {more}\nend\n"
    )


# Round yarns of 0.4 on sines of amplitude 0.205 are free from a pitch of 0.7887 on (by bisection with `check`).
FREE_TWILL_PITCH = 0.7887

FABRICS = {
    "jersey": (SAMPLES / "jersey.txt").read_text(),  # 6 courses by 4 wales
    "rib": (SAMPLES / "knit_rib_1x1.txt").read_text(),
    # The sample is free; with less room its loops overlap.
    "tricot": (SAMPLES / "warpknit_tricot.txt")
    .read_text()
    .replace("pitch 0.9", "pitch 0.55")
    .replace("pitch 0.6", "pitch 0.47"),
    "satin": (SAMPLES / "warpknit_satin.txt").read_text(),
    "queens_cord": (SAMPLES / "warpknit_queens-cord.txt").read_text(),
    "twill": weave("section circle 0.4", 0.9 * FREE_TWILL_PITCH, "twill 2/2", "profile sine 0.205"),
    # The sample's tolerance asks for more than 1 % of room, so that nothing would have to move.
    "braid": (SAMPLES / "braid_regular.txt").read_text().replace("tolerance 0.005\n", ""),
    "orthogonal": (SAMPLES / "weave_orthogonal.txt").read_text(),
    "plies": weave("diameter 0.4\n  plies 3 300 S", 1.0, "plain", "profile sine 0.18", 2),
    "sine": weave("section ellipse 0.8 0.2", 1.0, "plain", "profile sine 0.09"),
}
TUBES = ("braid",)
FREE = ("satin",)  # as they are
PART, PARTS = map(int, os.environ.get("SELVAGE_PART", "0/1").split("/"))


class Zoo(Case):
    def grids_before(self, source):
        """The yarns as they are built, as grids: by way of IGES, which keeps every bit."""
        iges = self.folder / "before.igs"
        self.succeeds("convert", source, "--as-published", "-o", iges, "--quiet")
        self.succeeds("convert", iges, "-o", self.folder / "before.txt", "--quiet")
        return relaxed.grids_of(self.folder / "before.txt")

    def judge(self, name):
        source, out = self.folder / f"{name}.txt", self.folder / "out"
        source.write_text(FABRICS[name])
        report = self.folder / "report.json"
        self.succeeds("relax", source, "--as-published", "--to", "txt,iges", "-o", out, "--report", report, "--quiet")
        relax = json.loads(report.read_text())["inputs"][0]["relax"]
        self.assertTrue(relax["solved"])
        self.assertEqual(relax["after"]["overlaps"], 0)
        for written in (out / f"{name}.txt", out / f"{name}.igs"):
            checked = self.folder / "check.json"
            self.succeeds("check", written, "--report", checked, "--quiet")
            entry = json.loads(checked.read_text())["inputs"][0]
            self.assertEqual(entry["overlaps"], [])
            self.assertFalse(any(yarn["self_overlap"] for yarn in entry["yarns"]))
        before, after = self.grids_before(source), relaxed.grids_of(out / f"{name}.txt")
        self.assertEqual(list(before), list(after))
        largest = 0.0
        for yarn in before:
            with self.subTest(yarn=yarn):
                change = relaxed.Change(before[yarn], after[yarn])
                self.assertLess(change.area, 0.02 + 1e-4)
                self.assertLess(change.volume, 0.01 + 1e-4)
                self.assertLess(change.length, 0.01 + 1e-4)
                self.assertLess(change.out_of_plane, 1e-9 * change.size)
                self.assertEqual(change.dents, 0)
                largest = max(largest, change.move)
        if name in FREE:
            self.assertEqual((relax["before"]["overlaps"], relax["iterations"], largest), (0, 0, 0))
        else:
            self.assertAlmostEqual(relax["largest_move"] / largest, 1, delta=0.1)
        tube = name in TUBES
        changed, crossings = relaxed.interlacing_changes(before, after, tube)
        self.assertEqual(changed, [])
        self.assertGreater(crossings, len(before))

    def test_every_fabric(self):
        for name in sorted(FABRICS)[PART::PARTS]:
            with self.subTest(fabric=name):
                self.judge(name)


class Measures(unittest.TestCase):
    """The measures see what they have to see."""

    def test_crossings(self):
        t = relaxed.np.linspace(-1, 1, 21)[:, None]
        over, under = t * [1, 0, 0] + [0, 0, 0.1], t * [0, 1, 0]
        self.assertEqual(relaxed.crossings(over, under).tolist(), [[0, 0, 1, 1]])
        self.assertEqual(relaxed.crossings(over - [0, 0, 0.2], under).tolist(), [[0, 0, 1, -1]])
        self.assertEqual(len(relaxed.crossings(over + [3, 0, 0], under)), 0)

    def test_changes_of_crossings(self):
        cross, away, under = [0, 0, 1, 1], [0.3, 0, 1, 1], [0, 0, 1, -1]
        same = relaxed.same_crossings
        self.assertTrue(same([cross], [away], 0.5))
        self.assertFalse(same([cross], [under], 0.5))
        self.assertFalse(same([cross], [], 0.5))
        self.assertTrue(same([cross], [cross, [5, 0, 1, 1], [6, 0, -1, 1]], 0.5))  # slid over it, out and back
        self.assertFalse(same([cross], [cross, [5, 0, 1, 1], [6, 0, -1, -1]], 0.5))  # hooked round it
        self.assertFalse(same([[5, 0, 1, 1], [6, 0, -1, -1]], [], 0.5))  # and pulled out

    def test_a_cylinder(self):
        """Pappus and Euclid: a round section of 1 along 5."""
        np = relaxed.np
        angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
        ring = np.stack([0 * angle, 0.5 * np.cos(angle), 0.5 * np.sin(angle)], axis=1)
        sections = np.stack([ring + [x, 0, 0] for x in np.linspace(0, 5, 11)]) + [3, 4, 5]
        self.assertAlmostEqual(np.linalg.norm(relaxed.area_vectors(sections)[3]), np.pi / 4, delta=1e-3)
        self.assertAlmostEqual(relaxed.volume(sections), 5 * np.pi / 4, delta=5e-3)
        self.assertAlmostEqual(relaxed.length(sections), 5, delta=1e-12)
        normals = relaxed.area_vectors(sections)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        self.assertGreater(relaxed.turning(sections, normals).min(), 0)
        sections[4, 17] *= [1, 0.99, 0.99]
        self.assertLess(relaxed.turning(sections, normals)[4], -1e-3)


if __name__ == "__main__":
    unittest.main()
