"""Numbers of knits, measured on the surfaces of the written IGES file: its type 128s are evaluated here, by the recursion of
Cox and de Boor, and nothing else of the program is asked. Needs numpy."""

import math
import pathlib
import unittest

import numpy as np

from program import Case, SAMPLES


def entities(path, number):
    """The parameters of each entity of a type, in the order of the file."""
    data, kinds = {}, {}
    for line in pathlib.Path(path).read_text().split("\n"):
        if line[72:73] == "D" and int(line[73:80]) % 2 == 1:
            kinds[int(line[73:80])] = int(line[:8])
        if line[72:73] == "P":
            data.setdefault(int(line[64:72]), []).append(line[:64])
    for entry, kind in sorted(kinds.items()):
        if kind == number:
            fields = "".join(data[entry]).split(";")[0].split(",")
            yield [float(field.replace("D", "E")) for field in fields]


def basis(knots, degree, t):
    """All basis functions in each of the parameters, which lie inside the knots."""
    knots, t = np.asarray(knots), np.asarray(t)[:, None]
    rows = ((knots[:-1] <= t) & (t < knots[1:])).astype(float)
    for k in range(1, degree + 1):
        with np.errstate(divide="ignore", invalid="ignore"):
            left = np.nan_to_num((t - knots[: -k - 1]) / (knots[k:-1] - knots[: -k - 1]), posinf=0, neginf=0)
            right = np.nan_to_num((knots[k + 1 :] - t) / (knots[k + 1 :] - knots[1:-k]), posinf=0, neginf=0)
        rows = left * rows[:, :-1] + right * rows[:, 1:]
    return rows


def inside(knots, degree, count):
    """Middles of equal shares of the spans: nodes of the midpoint rule."""
    spans = np.unique(knots[degree : len(knots) - degree])
    return np.concatenate([a + (b - a) * (np.arange(count) + 0.5) / count for a, b in zip(spans, spans[1:])])


class Tube:
    """A body of the file: rows round the section, columns along the yarn."""

    def __init__(self, p):
        k1, k2, m1, m2 = map(int, p[1:5])
        at = 10
        knots = [p[at : at + k1 + m1 + 2], p[at + k1 + m1 + 2 : at + k1 + m1 + k2 + m2 + 4]]
        at += k1 + m1 + k2 + m2 + 4
        count = (k1 + 1) * (k2 + 1)
        assert all(weight == 1 for weight in p[at : at + count])  # polynomial
        net = np.array(p[at + count : at + 4 * count]).reshape(k2 + 1, k1 + 1, 3)
        round_, along = (basis(k, m, inside(k, m, n)) for k, m, n in zip(knots, (m1, m2), (16, 12)))
        self.points = round_ @ np.tensordot(along, net, 1)  # along, round, xyz
        self.axis = np.array([self.centroid(ring) for ring in self.points])

    @staticmethod
    def centroid(ring):
        """Of the area within a flat ring."""
        middle = ring.mean(0)
        a, b = ring - middle, np.roll(ring, -1, 0) - middle
        normal = np.cross(a, b).sum(0)
        areas = np.cross(a, b) @ normal / np.linalg.norm(normal)
        return middle + (areas[:, None] * (a + b) / 3).sum(0) / areas.sum()

    def length(self):
        return np.linalg.norm(np.diff(self.axis, axis=0), axis=1).sum()

    def areas(self):
        a = self.points - self.axis[:, None]
        return np.linalg.norm(np.cross(a, np.roll(a, -1, 1)).sum(1), axis=1) / 2

    def volume(self):
        """By Pappus, from section to section."""
        steps, areas = np.linalg.norm(np.diff(self.axis, axis=0), axis=1), self.areas()
        return (steps * (areas[1:] + areas[:-1]) / 2).sum()


def bodies(path):
    """Of three surfaces a yarn the first one; its ends follow."""
    surfaces = list(entities(path, 128))
    assert len(surfaces) % 3 == 0
    return [Tube(surface) for surface in surfaces[::3]]


class KnitNumbers(Case):
    def tubes(self, text):
        self.out.mkdir(exist_ok=True)
        source = self.folder / "cloth.txt"
        source.write_text(text)
        self.succeeds("convert", source, "--to", "iges", "-o", f"{self.out}/")
        (written,) = self.out.glob("*.igs")
        tubes = bodies(written)
        written.unlink()
        return tubes

    def test_a_straight_rod_measures_right(self):
        text = "fabric 1\nthread t\n diameter 0.5\nend\nyarn a t\n path\n  0 0 0\n  1 2 2\n  2 4 4\n end\nend\n"
        (rod,) = self.tubes(text)
        # The axis lacks half a share of a span at both ends.
        self.assertAlmostEqual(rod.length(), 6, delta=0.6)
        self.assertAlmostEqual(rod.volume() / rod.length(), math.pi / 16, delta=2e-3)

    def test_jersey_of_18_courses_13_wales_and_loops_of_2_8_mm(self):
        sample = (SAMPLES / "knit_jersey_density.txt").read_text()
        self.assertIn("courses 6 pitch 0.5555556", sample)
        for text in (
            sample,
            sample.replace("knit jersey\n", "knit jersey\n  shape relaxed\n"),
            sample.replace("courses 6", "courses 3").replace("wales   5", "wales   12"),
        ):
            tubes = self.tubes(text)
            wales = 12 if "wales   12" in text else 5
            self.assertEqual(len(tubes), 3 if wales == 12 else 6)
            for tube in tubes:
                self.assertAlmostEqual(tube.length() / wales, 2.8, delta=0.01 * 2.8)
                # A head a wale.
                y = tube.axis[:, 1]
                heads = [i for i in range(2, len(y) - 2) if y[i] == max(y[i - 2 : i + 3]) and y[i] > y.mean()]
                self.assertEqual(len(heads), wales)
                for one, next_one in zip(heads, heads[1:]):
                    pitch = tube.axis[next_one, 0] - tube.axis[one, 0]
                    self.assertAlmostEqual(10 / pitch, 13, delta=0.04 * 13)  # from one sample to another
                first, last = tube.axis[heads[0], 0], tube.axis[heads[-1], 0]
                self.assertAlmostEqual(10 * (wales - 1) / (last - first), 13, delta=0.01 * 13)
            for low, high in zip(tubes, tubes[1:]):
                rise = high.axis[:, 1].max() - low.axis[:, 1].max()
                self.assertAlmostEqual(10 / rise, 18, delta=0.01 * 18)

    def test_a_monofilament_by_its_material_and_count_alone_in_a_warp_knit(self):
        """Goktepe's yarn: its radius follows from linear density and material. W. E. Morton and J. W. S.
        Hearle (Physical Properties of Textile Fibres, 4th ed., table 5.1) give polyester 1.39 g/cm3, nylon 1.14."""
        for material, density in (("polyester", 1.39), ("nylon", 1.14)):
            text = (
                f"fabric 1\nthread mono\n  dtex 76\n  material {material}\n  filaments 1\nend\n"
                "warpknit tricot\n  thread mono\n  wales 2 pitch 0.9\n  courses 3 pitch 0.6\nend\n"
            )
            for tube in self.tubes(text):
                # g/m of what was built: mm2 times g/cm3.
                self.assertAlmostEqual(tube.volume() / tube.length() * density, 7.6e-3, delta=0.01 * 7.6e-3)
                diameter = 2 * math.sqrt(7.6e-3 / (math.pi * density))
                sides = np.linalg.norm(tube.points - tube.axis[:, None], axis=2)
                self.assertAlmostEqual(2 * sides.mean(), diameter, delta=0.005 * diameter)


if __name__ == "__main__":
    unittest.main()
