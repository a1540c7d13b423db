"""Leno, seersucker, helices and braids on mandrels: what is built, judged on the 126s of IGES files by arithmetic of its
own. Needs the system's Python with numpy."""

import math
import unittest

import numpy as np

from program import EVERYTHING, Case, SAMPLES, run
from test_points import Spline, curves_of


def named(path):
    """The B-splines of a file of centre lines, by the names of its warps, wefts and braiders in their order."""
    return [Spline(c) for c in curves_of(path)]


def length(line):
    knots = np.unique(line.k)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    half = np.diff(knots)[:, None] / 2
    ts = (knots[:-1, None] + half) + half * nodes
    speeds = np.linalg.norm(line.derivative()(ts.ravel()), axis=1).reshape(ts.shape)
    return float(np.sum(half * weights * speeds))


class Along:
    """A line that goes up along an axis, by a fine polygon."""

    def __init__(self, line, axis):
        points = line(line.dense(60))
        self.axis, self.points = axis, points

    def __call__(self, place):
        return np.array([np.interp(place, self.points[:, self.axis], self.points[:, k]) for k in range(3)]).T


class RealCloths(Case):
    def setUp(self):
        super().setUp()
        self.out.mkdir(exist_ok=True)

    def lines_of(self, text):
        source = self.folder / "cloth.txt"
        source.write_text(text)
        self.succeeds("convert", source, "--lines", "-o", self.out / "cloth.igs")
        return named(self.out / "cloth.igs")

    def sound(self, source, *options):
        done = self.succeeds("check", source, *options)
        self.assertIn("sound: every yarn is a closed valid solid, no two overlap", done.stdout)

    LENO = """fabric 1
thread g
  diameter {0}
end
thread d
  diameter {1}
end
thread w
  diameter {2}
end
weave
  warp g,d 6 pitch {3}
  weft w 5 pitch {4}
  draft leno {5}
end
"""

    def test_leno(self):
        """Who passes above whom, and on which side: told by the lines alone."""
        for kind in ("half", "full"):
            for g, d, w, warp, weft in (
                (0.2, 0.2, 0.25, 0.6, 1.3),
                (0.3, 0.15, 0.2, 0.8, 2.0),
                (0.15, 0.2, 0.3, 0.7, 1.5),
            ):
                text = self.LENO.format(g, d, w, warp, weft, kind)
                lines = self.lines_of(text)
                self.sound(self.folder / "cloth.txt")
                warps, wefts = [Along(line, 0) for line in lines[:6]], [Along(line, 1) for line in lines[6:]]
                for standing, doup in zip(warps[::2], warps[1::2]):
                    sides, turns = [], 0.0
                    for j in range(5):
                        x = (j + 0.5) * weft
                        s, u = standing(x), doup(x)
                        pick = wefts[j](u[1])
                        # Over the pick, and the standing end under it.
                        self.assertGreater(u[2] - pick[2], 0.5 * (d + w))
                        self.assertLess(standing(x)[2] - wefts[j](s[1])[2], -0.5 * (g + w))
                        sides.append(np.sign(u[1] - s[1]) if abs(u[1] - s[1]) > 1e-9 else 0)
                        if j == 4:
                            continue
                        middle = x + 0.5 * weft
                        self.assertLess(doup(middle)[2], standing(middle)[2] - 0.5 * (g + d))
                        # The way about the standing end from pick to pick.
                        xs = np.linspace(x, x + weft, 60)
                        off = doup(xs) - standing(xs)
                        angles = np.unwrap(np.arctan2(off[:, 2], off[:, 1]))
                        turns = (angles[-1] - angles[0]) / (2 * math.pi)
                        if kind == "full":
                            self.assertAlmostEqual(abs(turns), 1, delta=1e-6)
                        else:
                            self.assertTrue(0.5 < abs(turns) < 1, turns)
                    if kind == "half":
                        self.assertEqual(sides, [sides[0] * (-1) ** j for j in range(5)])
                        self.assertNotEqual(sides[0], 0)

    def test_lenos_that_cannot_be(self):
        for values, word in (
            ((0.2, 0.2, 0.25, 0.2, 1.3, ""), "no room beside each other"),
            ((0.2, 0.2, 0.25, 0.6, 0.3, ""), "no room to cross"),
            ((0.2, 0.2, 0.25, 0.6, 1.3, "quarter"), "unknown"),
        ):
            source = self.folder / "cloth.txt"
            source.write_text(self.LENO.format(*values))
            done = run("convert", source, "-o", self.out / "x.igs")
            self.assertNotEqual(done.returncode, 0)
            self.assertRegex(done.stderr, r"cloth\.txt:\d+:\d+: error")
            if word != "unknown":
                self.assertIn(word, done.stderr)
            if word == "no room to cross":  # the remedy works
                pitch = float(done.stderr.split("at a pitch of ")[1].split()[0]) * 1.001
                source.write_text(self.LENO.format(0.2, 0.2, 0.25, 0.6, pitch, ""))
                self.sound(source)

    def test_seersucker(self):
        """The ratio of lengths, of the stripe's warps to the tight ones; picks stay."""
        cloths = ((1.08, 6, 12), (1.03, 4, 10), (1.12, 8, 16))
        for ratio, slack, every in cloths if EVERYTHING else cloths[1:2]:
            text = (SAMPLES / "weave_seersucker.txt").read_text()
            text = text.replace(
                "tight 3 slack 6 ratio 1.08 every 12", f"tight 3 slack {slack} ratio {ratio} every {every}"
            )
            text = text.replace("3tight,6slack 12", f"3tight,{slack}slack {6 + slack}")
            text = text.replace("weft   tight 12", f"weft tight {every}")
            lines = self.lines_of(text)
            self.sound(self.folder / "cloth.txt")
            count = 6 + slack
            lengths = [length(line) for line in lines[:count]]
            tight = lengths[:3] + lengths[3 + slack :]
            self.assertLess(max(tight) - min(tight), 1e-6 * max(tight))
            mean = np.mean(lengths[3 : 3 + slack]) / np.mean(tight)
            self.assertAlmostEqual(mean, ratio, delta=5e-4)
            # A plain weave everywhere, in the stripe as beside it.
            warps, wefts = [Along(line, 0) for line in lines[:count]], [Along(line, 1) for line in lines[count:]]
            for i, warp in enumerate(warps):
                for j, weft in enumerate(wefts):
                    above = warp(0.4 * (j + 0.5))[2] - weft(0.4 * (i + 0.5))[2]
                    self.assertGreater(above * (-1) ** (i + j), 0.15)
            heights = [np.abs(line(line.dense(10))[:, 2]).max() for line in lines[:count]]
            self.assertLess(max(heights[:3]), 0.25)
            self.assertGreater(heights[3 + slack // 2], 3 * max(heights[:3]))

    def test_helices(self):
        for radius, pitch, turns, hand, start in (
            (1, 0.5, 3.25, "left", 30),
            (5, 2, 10, "right", 0),
            (0.3, 4, 0.5, "", -45),
        ):
            tolerance = 1e-3
            text = (
                f"fabric 1\ntolerance {tolerance}\nyarn a\n  diameter 0.2\n"
                f"  helix radius {radius} pitch {pitch} turns {turns} {hand} start {start}\nend\n"
            )
            (line,) = self.lines_of(text)
            wanted = turns * math.hypot(2 * math.pi * radius, pitch)
            self.assertAlmostEqual(length(line), wanted, delta=1e-4 * wanted)
            ts = line.dense(9)
            points = line(ts)
            self.assertLess(np.max(np.abs(np.hypot(points[:, 0], points[:, 1]) - radius)), 0.1 * tolerance)
            sign = -1 if hand == "left" else 1
            angle = math.radians(start) + sign * 2 * math.pi * points[:, 2] / pitch
            exact = np.c_[radius * np.cos(angle), radius * np.sin(angle), points[:, 2]]
            self.assertLess(np.max(np.linalg.norm(points - exact, axis=1)), 0.12 * tolerance)
            self.assertAlmostEqual(points[-1, 2], pitch * turns, delta=1e-9)

    MANDREL = """fabric 1
thread t
  diameter 0.4
end
braid
  thread t
  carriers {0}
  pattern 1/1
  angle {1}
  mandrel
    {2}
  end
end
"""

    def test_braid_angles_on_a_cone(self):
        """tan(angle) = 2 pi r omega / v for constant rates: the middle of each braider's way, from its azimuth."""
        rows = [(0, 0, 0, 5), (0, 0, 10, 6), (0, 0, 20, 7), (0, 0, 30, 8)]
        text = self.MANDREL.format(16, 30, "\n    ".join(" ".join(map(str, r)) for r in rows))
        lines = self.lines_of(text)
        self.sound(self.folder / "cloth.txt")
        self.assertEqual(len(lines), 16)
        rate = math.tan(math.radians(30)) / 5  # radians a millimetre
        # Crossings: over and under in turn, on every braider of one direction.
        unrolled = []
        for line in lines:
            p = line(line.dense(60))
            unrolled.append((p[:, 2], np.unwrap(np.arctan2(p[:, 1], p[:, 0])), np.hypot(p[:, 0], p[:, 1])))
        zs = np.linspace(0.05, 29.95, 6000)
        for one in unrolled[:8]:
            met = []
            for other in unrolled[8:]:
                apart = np.interp(zs, one[0], one[1]) - np.interp(zs, other[0], other[1])
                turns = np.floor(apart / (2 * math.pi))
                for k in np.nonzero(np.diff(turns))[0]:
                    met.append((zs[k], np.interp(zs[k], one[0], one[2]) > np.interp(zs[k], other[0], other[2])))
            order = [over for _, over in sorted(met)]
            self.assertGreater(len(order), 8)
            self.assertEqual(order, [order[0] ^ bool(k % 2) for k in range(len(order))])
        for number, line in enumerate(lines):
            ts = line.dense(20)
            points, slopes = line(ts), line.derivative()(ts)
            azimuth = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
            turned = (azimuth[-1] - azimuth[0]) / 30
            self.assertAlmostEqual(turned, rate if number < 8 else -rate, delta=1e-6)
            r = np.hypot(points[:, 0], points[:, 1])
            # The radius of a cone: 5 + z / 10, off by the amplitude at the most.
            self.assertLess(np.max(np.abs(r - 5 - points[:, 2] / 10)), 0.5)
            round_ = (points[:, 0] * slopes[:, 1] - points[:, 1] * slopes[:, 0]) / r
            self.assertLess(np.max(np.abs(np.abs(round_ / slopes[:, 2]) - r * rate)), 2e-3)

    def test_a_straight_mandrel_is_the_tube(self):
        """Along any axis: the tube of `radius` and `length`, moved."""
        tube = self.lines_of(self.MANDREL.format(12, 40, "0 0 0 4\n    0 0 12 4"))
        plain = self.lines_of(
            "fabric 1\nthread t\n  diameter 0.4\nend\nbraid\n  thread t\n  carriers 12\n  pattern 1/1\n"
            "  angle 40\n  radius 4\n  length 12\nend\n"
        )
        for a, b in zip(tube, plain):
            ts = b.dense(9)
            self.assertLess(np.max(np.abs(a(ts) - b(ts))), 1e-9)

    def test_braids_on_bent_mandrels(self):
        """A quarter of a torus: yarns lie within the amplitude of it, and are free of overlap."""
        angles = np.linspace(0, math.pi / 2, 9)
        rows = "\n    ".join(f"{20 - 20 * math.cos(a)!r} 0 {20 * math.sin(a)!r} 4" for a in angles)
        lines = self.lines_of(self.MANDREL.format(12, 35, rows))
        self.sound(self.folder / "cloth.txt")
        for line in lines:
            p = line(line.dense(8))
            off = np.hypot(np.hypot(p[:, 0] - 20, p[:, 2]) - 20, p[:, 1])
            self.assertLess(np.max(np.abs(off - 4)), 0.32)
        self.sound(SAMPLES / "braid_mandrel.txt")

    def test_mandrels_that_cannot_be(self):
        for rows, word in (
            ("0 0 0 4", "at least 2 rows"),
            ("0 0 0 4\n    0 0 0 4", "equals the one before"),
            ("0 0 0 4\n    0 0 9", "x y z RADIUS"),
            ("0 0 0 9\n    3 0 3 9\n    0 0 6 9", "folds"),
            ("0 0 0 4\n    0 0 30 0.2", "room"),
        ):
            source = self.folder / "cloth.txt"
            source.write_text(self.MANDREL.format(12, 35, rows))
            done = run("convert", source, "-o", self.out / "x.igs")
            self.assertNotEqual(done.returncode, 0)
            self.assertRegex(done.stderr, r"cloth\.txt:\d+:\d+: error")
            self.assertIn(word, done.stderr)


if __name__ == "__main__":
    unittest.main()
