"""The driver sees what it has to see: its measures against closed forms, its oracles against texts that break them, and that
shrinking keeps the failure."""

import math
import pathlib
import tempfile
import unittest

import numpy as np

import generator
import measures
import oracles
import relaxed
import tree

CROSSING = """fabric 1
thread t
  diameter 1
end
yarn a t
  path
    -3 0 0
    3 0 0
  end
end
yarn b t
  path
    0 -3 0.8
    0 3 0.8
  end
end
"""


def cylinder():
    """A grid that is nearly a tube of radius 1 about x from 0 to 5."""
    rows = [
        (x, math.cos(a) / math.cos(math.pi / 16), math.sin(a) / math.cos(math.pi / 16))
        for x in (0, 1, 2, 3, 5)
        for a in (2 * math.pi * i / 16 for i in range(16))
    ]
    text = "yarn tube\n  grid 5 16\n" + "".join(f"    {x!r} {y!r} {z!r}\n" for x, y, z in rows) + "  end\nend\n"
    return relaxed.Yarn(text)


class Measures(unittest.TestCase):
    def test_a_tube(self):
        measured = measures.Measured(cylinder())
        self.assertAlmostEqual(measured.length, 5, places=9)
        self.assertAlmostEqual(measured.volume / (5 * math.pi), 1, delta=0.01)
        self.assertLess(measured.flatness, 1e-12)
        # The area of a closed quadratic B-spline over a regular polygon, exactly: between the polygon's corners and sides
        # each span is a parabola over the triangle of two middles of sides and a corner, two thirds of it.
        outer = 1 / math.cos(math.pi / 16)
        polygon = 8 * outer**2 * math.sin(math.pi / 8)
        inner = 8 * math.sin(math.pi / 8)  # through the middles of the sides, at distance 1
        self.assertAlmostEqual(measured.volume / 5, inner + 2 / 3 * (polygon - inner), places=9)

    def test_areas(self):
        self.assertAlmostEqual(measures.section_area(["racetrack", "3", "1"], None)[0], 2 + math.pi / 4)
        self.assertAlmostEqual(measures.section_area(["power", "2", "1", "1"], None)[0], math.pi / 2, places=6)
        self.assertAlmostEqual(measures.section_area(["lenticular", "2", "2"], None)[0], math.pi)
        self.assertAlmostEqual(measures.section_area(["polygon"], [(0, 0), (2, 0), (2, 1), (0, 1)])[0], 2)

    def test_quadrature_of_rational_yarns(self):
        """Weights that go on round and along: the rule converges to what one with twice the points gives."""
        grid = cylinder()
        grid.weights = grid.weights * (1 + 0.8 * np.sin(np.arange(grid.weights.size)).reshape(grid.weights.shape))
        grid.weights[:, -grid.degree_u :] = grid.weights[:, : grid.degree_u]
        volume, rule = measures.Measured(grid).volume, measures.GAUSS_RATIONAL
        measures.GAUSS_RATIONAL = np.polynomial.legendre.leggauss(24)
        try:
            self.assertAlmostEqual(volume / measures.Measured(grid).volume, 1, delta=1e-9)
        finally:
            measures.GAUSS_RATIONAL = rule

    def test_what_lies_inside(self):
        skin = measures.coarse(cylinder())
        self.assertEqual(measures.deepest_shared(skin + [0, 2.1, 0], skin), 0)
        self.assertAlmostEqual(measures.deepest_shared(skin + [0, 1.7, 0], skin), 0.3, delta=0.02)
        self.assertGreater(measures.deepest_shared(0.5 * skin + [1, 0, 0], skin), 0.4)


class Shrinking(unittest.TestCase):
    def test_every_text_is_a_tree(self):
        for seed in range(200):
            text = generator.fabric(seed)[1]
            self.assertEqual(tree.render(tree.parse(text)).split(), text.split())

    def test_the_failure_stays(self):
        text = (
            "fabric 1\nthread t\n  diameter 0.5\nend\nyarn a t\n  path\n"
            + "".join(f"    {i}.25 {i * i} 0\n" for i in range(9))
            + "    77.123 5 2\n  end\nend\nyarn b t\n  path\n    0 0 0\n    1 1 1\n  end\nend\n"
        )

        def fails(texts):
            return ["77" in t and "path" in t for t in texts]

        small = tree.shrunk(text, fails, effort=1000)
        self.assertEqual(small, "fabric 1\nyarn a t\n  path\n    77 0 0\n  end\nend\n")

    def test_seeds_are_fabrics(self):
        self.assertEqual(generator.fabric(5), generator.fabric(5))
        families = {generator.fabric(seed)[0] for seed in range(200)}
        self.assertEqual(families, set(generator.FAMILIES))


class Oracles(unittest.TestCase):
    def judged(self, **texts):
        with tempfile.TemporaryDirectory(prefix="selvage-test-") as folder:
            return oracles.Judge(pathlib.Path(folder), texts).judge()

    def test_overlapping_yarns_are_moved_apart_and_a_bad_text_is_refused(self):
        judge = self.judged(
            crossing=CROSSING, bad="fabric 1\nyarn a nowhere\n  path\n    0 0 0\n    1 0 0\n  end\nend\n"
        )
        self.assertEqual([f.key for found in judge.findings.values() for f in found], [])
        self.assertLessEqual(
            {"runs", "closed", "volume", "section", "trip", "relax", "relax measured"}, judge.asked["crossing"]
        )
        self.assertEqual(len(judge.refusals["bad"]), 1)

    def test_what_is_wrong_is_found(self):
        """Verdicts on reports and grids that are wrong on purpose."""
        judge = oracles.Judge("nowhere", {"a": CROSSING})
        judge.look_at("check", "a", {"ok": False, "messages": []})
        judge.look_at("convert", "a", {"ok": False, "messages": []})
        judge.look_at(
            "mesh", "a", {"ok": False, "messages": [{"severity": "error", "text": "crashed: Segmentation fault"}]}
        )
        judge.look_at("info", "a", {"ok": True, "volume": math.nan})
        skin = cylinder()
        moved = cylinder()
        moved.points = moved.points + np.array([0, 1.0, 0])
        judge.look_for_overlaps("a", {"one": skin, "other": moved}, "overlaps seen")
        told = {
            "severity": "warning",
            "text": "the volume of yarn 'y' is 1 % too large; a smaller --size makes it better",
        }
        for messages in ([], [told]):
            judge.judge_kept_volumes("a", {"messages": messages}, "mesh", [("x", 1.0, 1.001), ("y", 1.01, 1.0)])
        self.assertEqual(
            [f.kind for f in judge.findings["a"]],
            [
                "convert: failed without a message",
                "mesh: crashed: Segmentation fault",
                "info: no number in the report: .volume",
                "points of a yarn lie in another one",
                "mesh: volume of a yarn, without a warning",
            ],
        )


if __name__ == "__main__":
    unittest.main()
