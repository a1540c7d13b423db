"""The data sheet of `info` against the written IGES: each number is calculated anew here, from points of the surfaces of a
larger piece of the cloth, away from its edges. Needs the system's Python with numpy."""

import csv
import json
import math
import re
import unittest

import numpy as np

from iges_surfaces import Tube, surfaces
from program import EVERYTHING, Case, SAMPLES

NEAR = 1e-3  # of each number


def larger(name, *changes):
    text = (SAMPLES / f"{name}.txt").read_text()
    for old, new in changes:
        text, count = re.subn(old, new, text)
        assert count > 0, old
    return text


def hidden(lanes, period):
    """Share of a period that lanes (low, high) cover, by looking at a hundred thousand places."""
    at = (np.arange(100000) + 0.5) / 100000 * period
    covered = np.zeros(len(at), bool)
    for low, high in lanes:
        for turn in (-1, 0, 1, 2):
            begin = low - math.floor(low / period) * period - turn * period
            covered |= (at >= begin) & (at <= begin + high - low)
    return covered.mean()


# Of each cloth: a piece with a border round the repeat; low corner and size of what is measured (mm); the systems in
# the order of the file, as (name, axis, tex, fibre density, how many yarns stand in the file).
CLOTHS = {
    "denim": (
        larger("weave_denim", ("warp warp 8", "warp warp 12"), ("weft weft 8", "weft weft 12")),
        (4 * 0.588, 4 * 0.3846),
        (4 * 0.588, 4 * 0.3846),
        [("warp", 0, 590.5412 / 7, 1.52, 12), ("weft", 1, 590.5412 / 6, 1.52, 12)],
    ),
    "glass": (
        larger("weave_glass7628", ("warp ec9 6", "warp ec9 8"), ("weft ec9 4", "weft ec9 8")),
        (3 * 0.747, 3 * 0.577),
        (2 * 0.747, 2 * 0.577),
        [("warp", 0, 68, 2.54, 8), ("weft", 1, 68, 2.54, 8)],
    ),
    "satin": (
        larger(
            "weave_satin5",
            ("  diameter 0.2", "  tex 40\n  density 1.3\n  diameter 0.25"),
            ("ground 5 pitch 0.36", "ground 15 pitch 0.44"),
            ("silk 5 pitch 0.36", "silk 15 pitch 0.5"),
        ),
        (5 * 0.5, 5 * 0.44),
        (5 * 0.5, 5 * 0.44),
        [("warp", 0, 40, 1.3, 15), ("weft", 1, 40, 1.3, 15)],
    ),
    "twill": (
        larger(
            "weave_twill22",
            ("  diameter 0.4", "  tex 90\n  material wool\n  diameter 0.4"),
            ("warp  wool 8 pitch 0.8", "warp  wool 12 pitch 0.7"),
            ("weft  wool 8", "weft  wool 12"),
        ),
        (4 * 0.8, 4 * 0.7),
        (4 * 0.8, 4 * 0.7),
        [("warp", 0, 90, 1.31, 12), ("weft", 1, 90, 1.31, 12)],
    ),
    "jersey": (
        larger("knit_jersey_density", ("courses 6", "courses 16"), ("wales   5", "wales 16")),
        (8 * 0.7692308, 8 * 0.5555556),
        (0.7692308, 0.5555556),
        [("course", 0, 20, 1.52, 16)],
    ),
    "rib": (
        larger("knit_rib_1x1", ("courses 4", "courses 14 pitch 1"), ("wales   4", "wales 16 pitch 1.1")),
        (8 * 1.1, 7 * 1.0),
        (2 * 1.1, 1.0),
        [("course", 0, 30, 1.52, 14)],
    ),
    # With a cell the cloth goes on beyond it; how far its loops are moved apart is then that of any endless piece.
    "full cardigan": (
        larger(
            "knit_full_cardigan",
            ("  diameter 0.5", "  tex 110\n  density 1.31\n  diameter 0.5"),
            ("courses 6", "courses 2 pitch 1.6"),
            ("wales   5", "wales 2 pitch 2.4"),
        )
        + "cell 0 0 -2  4.8 3.2 2\nend\n",
        (0, 0),
        (2 * 2.4, 2 * 1.6),
        [("course", 0, 110, 1.31, 14)],
    ),
    "locknit": (
        larger("warpknit_locknit", ("wales   3", "wales 6"), ("courses 4", "courses 14")),
        (3 * 0.9, 6 * 0.8),
        (0.9, 2 * 0.8),
        [("bar1", 1, 7.6, 1.38, 6), ("bar2", 1, 7.6, 1.38, 6)],
    ),
    "satin of bars": (
        larger("warpknit_satin", ("wales   4", "wales 9"), ("courses 6", "courses 14")),
        (4 * 0.9, 6 * 0.6),
        (0.9, 2 * 0.6),
        [("bar1", 1, 4.4, 1.14, 9), ("bar2", 1, 7.6, 1.38, 9)],
    ),
    "braid": (larger("braid_regular", ("length   9", "length 40")), (0, 0, 12), None, [("braider", 2, 400, 1.5, 12)]),
    "flat braid": (larger("braid_flat5", ("length   14", "length 40")), (12, 0), None, [("braider", 0, 800, 1.5, 5)]),
}


# Tried on every change; every night all of them.
FEW = ("denim", "satin", "jersey", "rib", "locknit", "braid", "flat braid")


class Sheet(Case):
    def sheet_of(self, text):
        path = self.folder / "cloth.txt"
        path.write_text(text)
        report = json.loads(self.succeeds("info", path, "--json").stdout)
        sheets = report["inputs"][0]["sheets"]
        self.assertEqual(len(sheets), 1)
        return next(iter(sheets.values()))

    def tubes_of(self, text):
        path = self.folder / "cloth.txt"
        path.write_text(text)
        written = self.folder / "cloth.igs"
        self.succeeds("convert", path, "-o", written, "--ends", "none", "--digits", "full")
        return [Tube(grid) for grid in surfaces(written)]

    def near(self, value, expected, what):
        self.assertAlmostEqual(value, expected, delta=NEAR * abs(expected), msg=what)

    def test_numbers_from_surfaces(self):
        for name in CLOTHS if EVERYTHING else FEW:
            text, low, size, systems = CLOTHS[name]
            with self.subTest(name):
                sheet = self.sheet_of(text)
                tubes = self.tubes_of(text)
                self.assertEqual(len(tubes), sum(system[-1] for system in systems))
                measure = self.measure_plane if size else self.measure_braid
                measure(sheet, iter(tubes), low, size, systems)

    def measure_plane(self, sheet, tubes, low, size, systems):
        low, size = np.array(low), np.array(size)
        area, mass, volume, fibres, heights, lanes = size.prod(), 0, 0, 0, [], {0: [], 1: []}
        self.near(sheet["repeat_x"] * sheet["repeat_y"], area, "repeat")
        for system, axis, tex, density, count in systems:
            across, length, yarns = 1 - axis, 0, 0
            for tube in (next(tubes) for _ in range(count)):
                # Beside the places where loops are level and yarns cross.
                part = tube.between(axis, low[axis] + 0.21 * size[axis], low[axis] + 1.21 * size[axis])
                self.assertIsNotNone(part)
                of_it, filled, start, rows = part
                if not 0 <= start[across] - low[across] - 0.0731 * size[across] < size[across]:
                    continue
                yarns += 1
                length += of_it
                volume += filled
                box = tube.grid[rows]
                heights += [box[:, :, 2].min(), box[:, :, 2].max()]
                lanes[axis].append((box[:, :, across].min(), box[:, :, across].max()))
            said = sheet["systems"][system]
            mass += 1e-6 * tex * length
            fibres += tex * length / (1000 * density)
            self.near(said["per_cm"], 10 * yarns / size[across], "per_cm")
            ratio = length / (yarns * size[axis])
            if "yarn_ratio" in said:
                self.near(said["yarn_ratio"], ratio, "yarn ratio")
            else:
                # 0.1 % of the length: a crimp of 1 % is not known to 0.1 % of itself by it.
                self.assertAlmostEqual(said["crimp"], ratio - 1, delta=NEAR * ratio)
            self.near(said["length"], 1000 * length / area, "length")
            self.near(said["mass"], tex * length / area, "mass")
            if axis == 0 and "loop_length" in said:
                loop = length * 0.1 * sheet["wales_per_cm"] ** -1 * 100 / (yarns * size[0]) / 1
                self.near(said["loop_length"], loop, "loop length")
                self.near(said["tightness_factor"], math.sqrt(tex) / (0.1 * loop), "tightness factor")
            if "run_in" in said:
                self.near(said["run_in"], 480 * length * 10 / sheet["courses_per_cm"] / (yarns * size[1]), "run-in")
            if "cover_factor" in said:
                self.near(said["cover_factor"], 25.4 * yarns / size[across] / math.sqrt(590.5412 / tex), "cover factor")
        thickness = max(heights) - min(heights)
        self.near(sheet["mass"], 1e6 * mass / area, "mass")
        self.near(sheet["thickness"], thickness, "thickness")
        self.near(sheet["yarn_fraction"], volume / (area * thickness), "yarns")
        self.near(sheet["fibre_fraction"], fibres / (area * thickness), "fibres")
        self.near(sheet["porosity"], 1 - fibres / (area * thickness), "porosity")
        if "cover" in sheet:
            k = [hidden(lanes[axis], size[1 - axis]) for axis in (0, 1)]
            self.near(sheet["cover"], k[0] + k[1] - k[0] * k[1], "cover")

    def measure_braid(self, sheet, tubes, low, _, systems):
        ((system, axis, tex, density, count),) = systems
        repeat = sheet["repeat_x"]
        length = volume = turn = width = 0
        reach = []
        for tube in (next(tubes) for _ in range(count)):
            # Two repeats: where the same set of yarns is, is up to the pattern.
            of_it, filled, _, rows = tube.between(axis, low[axis], low[axis] + 2 * repeat)
            length += of_it / 2
            volume += filled / 2
            middles = tube.middles[rows]
            turn += abs(np.unwrap(np.arctan2(middles[:, 1], middles[:, 0]))[[0, -1]] @ [-1, 1]) / np.ptp(
                middles[:, axis]
            )
            width += 2 * math.sqrt(tube.volumes.sum() / tube.steps.sum() / math.pi)
            points = tube.grid[rows].reshape(-1, 3)
            reach.append((points[:, 2], points[:, 1]) if axis == 0 else (np.hypot(points[:, 0], points[:, 1]),) * 2)
        thick, wide = (np.ptp(np.concatenate(values)) for values in zip(*reach))
        self.near(sheet["thickness"], thick, "thickness")
        self.near(sheet["linear_mass"], tex * length / repeat * 1e-3, "linear mass")
        self.near(sheet["systems"][system]["length"], length / repeat, "length")
        if axis == 2:
            wide = 2 * math.pi * 3
            angle = math.atan(3 * turn / count)
            filled = width / (2 * wide * math.cos(angle))
            self.near(sheet["braid_angle"], math.degrees(angle), "angle")
            self.near(sheet["braid_angle"], 35, "angle")
            self.near(sheet["cover"], 2 * filled - filled**2, "cover")
        self.near(sheet["mass"], tex * length / (repeat * wide), "mass")
        self.near(sheet["yarn_fraction"], volume / (repeat * wide * thick), "yarns")
        self.near(sheet["fibre_fraction"], tex * length / (1000 * density) / (repeat * wide * thick), "fibres")

    # By hand: straight warps between two layers of straight wefts.
    def test_straight_yarns(self):
        text = """fabric 1
thread rod
  tex 100
  density 2
  packing 0.5
  twist 400 Z
  section racetrack 2 0.5
end
weave
  warp rod 4 pitch 4
  weft rod 4 pitch 5
  profile straight
end
"""
        sheet = self.sheet_of(text)
        self.assertAlmostEqual(sheet["mass"], 0.1 * (250 + 2 * 200), delta=1e-9)
        self.assertAlmostEqual(sheet["cover"], 0.5 + 0.4 - 0.5 * 0.4, delta=1e-9)
        thread = sheet["threads"]["rod"]
        self.assertAlmostEqual(thread["twist_factor"], 4000, delta=1e-9)
        self.assertAlmostEqual(thread["cotton_twist_factor"], 400 * 0.0254 / math.sqrt(590.5412 / 100), delta=1e-5)
        self.assertAlmostEqual(thread["fibre_fraction"], 0.05 / (0.25 * math.pi * 0.25 + 1.5 * 0.5), delta=1e-5)
        self.assertAlmostEqual(thread["length"], 650, delta=1e-9)

    # A triaxial braid of a maker's sheet (0/60/-60, 536 g/m2): carriers and axial yarns on its width, braiders at the angle.
    def test_planar_braid(self):
        text = """fabric 1
thread ax
  tex 1650
  density 1.8
  section ellipse 4.4 0.16
end
thread bi
  tex 800
  density 1.8
  section ellipse 3 0.14
end
braid
  thread   bi
  carriers 16
  pattern  2/2
  planar   71.2
  angle    60
  length   60
  axial    ax 8
end
"""
        sheet = self.sheet_of(text)
        braiders, axial = sheet["systems"]["braider"], sheet["systems"]["axial"]
        a_mm = 16 / (71.2 * math.cos(math.radians(60)))
        self.near(sheet["braid_angle"], 60, "angle")
        self.near(braiders["per_cm"], 10 * a_mm, "braiders")
        self.near(axial["per_cm"], 80 / 71.2, "axial yarns")
        self.assertAlmostEqual(axial["crimp"], 0, delta=1e-6)
        self.assertTrue(0 < braiders["crimp"] < 0.02, braiders["crimp"])
        self.near(sheet["mass"], 800 * a_mm * (1 + braiders["crimp"]) + 1650 * 8 / 71.2, "mass")
        self.assertAlmostEqual(sheet["mass"], 536, delta=0.03 * 536)
        self.near(sheet["cover"], 1 - (1 - 3 * a_mm / 2) ** 2 * (1 - 4.4 * 8 / 71.2), "cover")
        for angle in (25, 45, 70):
            sheet = self.sheet_of(
                text.replace("angle    60", f"angle {angle}").replace("ellipse 3 0.14", "ellipse 1 0.14")
            )
            self.near(sheet["braid_angle"], angle, "angle")
            a_cm = 160 / (71.2 * math.cos(math.radians(angle)))
            self.near(sheet["systems"]["braider"]["per_cm"], a_cm, f"braiders at {angle} degrees")
            self.near(sheet["systems"]["axial"]["per_cm"], 80 / 71.2, f"axial yarns at {angle} degrees")

    def test_table(self):
        table = self.folder / "sheets.csv"
        self.succeeds("info", SAMPLES / "weave_denim.txt", SAMPLES / "jersey.txt", SAMPLES / "ring.txt", "--csv", table)
        rows = list(csv.DictReader(table.read_text().splitlines()))
        self.assertEqual([row["input"] for row in rows], ["weave_denim", "jersey", "ring"])
        self.assertEqual([row["result"] for row in rows], ["ok"] * 3)
        sheet = json.loads(self.succeeds("info", SAMPLES / "weave_denim.txt", "--json").stdout)["inputs"][0]["sheets"]
        self.assertEqual(float(rows[0]["sheets.weave.mass"]), sheet["weave"]["mass"])
        self.assertEqual(float(rows[0]["sheets.weave.systems.warp.crimp"]), sheet["weave"]["systems"]["warp"]["crimp"])
        self.assertEqual(rows[2]["sheets.weave.mass"] + rows[2]["sheets.knit.mass"] + rows[1]["sheets.weave.mass"], "")

    # At the same yarn twice the density is more than twice the mass: crimp grows.
    def test_sweep(self):
        table = self.folder / "sweep.csv"
        self.succeeds("sweep", SAMPLES / "plain_by_params.txt", "--do", "info", "--set", "sett=10,20", "--csv", table)
        light, dense = (float(row["sheets.weave.mass"]) for row in csv.DictReader(table.read_text().splitlines()))
        self.assertGreater(dense, 2 * light)
        self.assertLess(dense, 2.2 * light)

    # What cannot have one is told.
    def test_repeat_beyond_reason(self):
        path = self.folder / "cloth.txt"
        path.write_text(
            "fabric 1\nthread t\n  diameter 0.2\nend\nweave\n  warp t 4 pitch 0.5\n  weft t 4 pitch 0.5\n"
            "  draft basket 250/250\nend\n"
        )
        told = self.succeeds("info", path)
        self.assertIn("no data sheet of this weave: its repeat is far larger", told.stderr)
        self.assertNotIn("data sheet of the", told.stdout)


if __name__ == "__main__":
    unittest.main()
