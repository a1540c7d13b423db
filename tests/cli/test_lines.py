"""Centre lines as the result: `convert --lines`. The axis of each yarn is solved here anew, as one dense system of the
paper's equations (001), and compared with what gmsh (OpenCASCADE) reads from IGES and STEP, ezdxf from DXF, and XML and
CSV parsers from the points. Needs the system's Python with numpy, gmsh and ezdxf."""

import csv
import math
import pathlib
import re
import unittest
import xml.etree.ElementTree

import ezdxf
import gmsh
import numpy as np

from program import Case, PATH, RING, SAMPLES

DERIVATIVES = """fabric 1
thread t
  tex 100
  density 2
  section ellipse 0.3 0.1
end
yarn "a, b" t
  path {how}
    0 0 0
    1 0.5 0.2
    1.5 2 -0.1
    3 2.5 0.3
    5 2 0
  end
  derivative start 6 -2 1
  derivative end 3 -9 0.5
end
"""
ROWS = np.array([[0, 0, 0], [1, 0.5, 0.2], [1.5, 2, -0.1], [3, 2.5, 0.3], [5, 2, 0]])


def parameters(points, how):
    power = {"uniform": 0, "chord": 1, "centripetal": 0.5}[how]
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1) ** power
    return np.concatenate([[0], np.cumsum(steps) / np.sum(steps)])


def basis(knots, i, k, t, last):
    """Cox and de Boor, of degree k."""
    if k == 0:
        return 1.0 if knots[i] <= t < knots[i + 1] or (last and t == knots[i + 1] > knots[i]) else 0.0
    out = 0.0
    if knots[i + k] > knots[i]:
        out += (t - knots[i]) / (knots[i + k] - knots[i]) * basis(knots, i, k - 1, t, last)
    if knots[i + k + 1] > knots[i + 1]:
        out += (knots[i + k + 1] - t) / (knots[i + k + 1] - knots[i + 1]) * basis(knots, i + 1, k - 1, t, last)
    return out


def end_derivative(points, u):
    """Of the parabola through three points, at the first."""
    (p, q, r), (a, b, c) = points[:3], u[:3]
    return p * (1 / (a - b) + 1 / (a - c)) + q * (a - c) / ((b - a) * (b - c)) + r * (a - b) / ((c - a) * (c - b))


class Axis:
    """The clamped cubic through rows with given derivatives at its ends, by one dense solve."""

    def __init__(self, points, how="chord", start=None, end=None):
        u = parameters(points, how)
        self.knots = [0.0] * 3 + list(u) + [1.0] * 3
        n = len(points)
        start = end_derivative(points, u) if start is None else start
        end = end_derivative(points[::-1], u[::-1]) if end is None else end
        matrix, right = np.zeros((n + 2, n + 2)), np.zeros((n + 2, 3))
        for row, t in enumerate(u):
            matrix[row] = [basis(self.knots, i, 3, t, t == 1) for i in range(n + 2)]
            right[row] = points[row]
        matrix[n, :2], right[n] = (-1, 1), (u[1] - u[0]) / 3 * start
        matrix[n + 1, -2:], right[n + 1] = (-1, 1), (u[-1] - u[-2]) / 3 * end
        self.control = np.linalg.solve(matrix, right)

    def __call__(self, t):
        return sum(basis(self.knots, i, 3, t, t == 1) * p for i, p in enumerate(self.control))


def rows_of(text):
    """The rows of each yarn's path, by the yarn's name."""
    out = {}
    for name, block in re.findall(r"^yarn (\S+)[^\n]*\n(.*?)^end", text, re.M | re.S):
        path = re.search(r"path[^\n]*\n(.*?)^  end", block, re.M | re.S).group(1)
        out[name] = np.array([[float(x) for x in line.split("#")[0].split()] for line in path.strip().split("\n")])
    return out


def gmsh_curves(path):
    """(parameter, point) along each curve of a CAD file, in mm, in the order of the file."""
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.merge(str(path))
        out = []
        for _, tag in gmsh.model.getEntities(1):
            (low,), (high,) = gmsh.model.getParametrizationBounds(1, tag)
            ts = np.linspace(low, high, 41)
            out.append((ts, np.array(gmsh.model.getValue(1, tag, ts)).reshape(-1, 3)))
        return out
    finally:
        gmsh.finalize()


def vtp(path):
    """Names, and of each line its point data, by an XML parser."""
    root = xml.etree.ElementTree.parse(path).getroot()
    piece = root.find("PolyData/Piece")

    def array(element):
        values = np.array([float(x) for x in element.text.split()])
        width = int(element.get("NumberOfComponents", 1))
        return values.reshape(-1, width) if width > 1 else values

    names = bytes(int(x) for x in root.find("PolyData/FieldData/Array").text.split()).decode().split("\0")[:-1]
    data = {a.get("Name"): array(a) for a in [*piece.find("PointData"), *piece.find("Points")]}
    lines = {a.get("Name"): array(a).astype(int) for a in piece.find("Lines")}
    assert int(piece.get("NumberOfPoints")) == len(data["points"]) == len(lines["connectivity"])
    ends = [0, *lines["offsets"]]
    return {
        name: {key: value[lines["connectivity"][a:b]] for key, value in data.items()}
        for name, a, b in zip(names, ends, ends[1:])
    }


class Lines(Case):
    def setUp(self):
        super().setUp()
        self.out.mkdir(exist_ok=True)

    def convert(self, source, formats, *options):
        self.succeeds("convert", source, "--lines", "--to", formats, "-o", f"{self.out}/", *options)

    def axes(self):
        """Of the sample with four yarns, whose warps have directions at their ends."""
        axes = {}
        for name, rows in rows_of(pathlib.Path(PATH).read_text()).items():
            u = parameters(rows, "chord")
            ends = [end_derivative(rows, u), end_derivative(rows[::-1], u[::-1])]
            if name.startswith("warp"):
                ends = [np.array([np.linalg.norm(e), 0, 0]) for e in ends]
            axes[name] = Axis(rows, "chord", *ends)
        return axes

    def assert_near(self, a, b, delta):
        self.assertEqual(np.shape(a), np.shape(b))
        self.assertLess(np.max(np.abs(np.asarray(a) - np.asarray(b))), delta)

    def test_other_programs_read_the_axis(self):
        self.convert(PATH, "iges,step,dxf,svg,vtp,csv")
        axes = self.axes()
        self.assertEqual(len(axes), 4)
        for suffix in ("igs", "stp"):
            curves = gmsh_curves(self.out / f"plain4_path.{suffix}")
            self.assertEqual(len(curves), 4)
            for (ts, points), axis in zip(curves, axes.values()):
                self.assert_near(points, [axis(t) for t in ts], 1e-9)
        document = ezdxf.readfile(self.out / "plain4_path.dxf")
        self.assertEqual(len(document.audit().errors), 0)
        for name, axis in axes.items():
            spline = document.blocks.get(name).query("SPLINE").first.construction_tool()
            for t in np.linspace(0, 1, 41):
                self.assert_near(spline.point(t), axis(t), 1e-9)
        for name, line in vtp(self.out / "plain4_path.vtp").items():
            self.assert_near(line["points"], [axes[name](t) for t in line["parameter"]], 1e-9)

    def test_the_drawing_is_the_view_from_above(self):
        self.convert(PATH, "svg")
        root = xml.etree.ElementTree.parse(self.out / "plain4_path.svg").getroot()
        paths = {p[0].text: p for p in root.iter("{http://www.w3.org/2000/svg}path")}
        for name, axis in self.axes().items():
            numbers = [float(x) for x in re.findall(r"-?[0-9.]+(?:e-?\d+)?", paths[name].get("d"))]
            points = np.array(numbers).reshape(-1, 2)
            knots = axis.knots[3:-3]
            self.assertEqual(len(points), 3 * (len(knots) - 1) + 1)
            for k, (a, b) in enumerate(zip(knots, knots[1:])):
                p = points[3 * k : 3 * k + 4]
                middle = (p[0] + 3 * p[1] + 3 * p[2] + p[3]) / 8
                self.assert_near(middle, axis((a + b) / 2)[:2] * [1, -1], 1e-9)

    def test_derivatives_at_the_ends(self):
        for how in ("uniform", "chord", "centripetal"):
            source = self.folder / f"{how}.txt"
            source.write_text(DERIVATIVES.format(how=how))
            self.convert(source, "vtp,iges")
            axis = Axis(ROWS, how, np.array([6, -2, 1]), np.array([3, -9, 0.5]))
            line = vtp(self.out / f"{how}.vtp")["a, b"]
            self.assert_near(line["points"], [axis(t) for t in line["parameter"]], 1e-12)
            ((ts, points),) = gmsh_curves(self.out / f"{how}.igs")
            self.assert_near(points, [axis(t) for t in ts], 1e-9)
            again = self.folder / "again.txt"
            self.succeeds("convert", source, "-o", again)
            self.assertIn("derivative start 6 -2 1", again.read_text())

    def test_frames_sizes_lengths_and_curvatures(self):
        source = self.folder / "d.txt"
        source.write_text(DERIVATIVES.format(how="chord"))
        self.convert(source, "vtp,csv")
        axis = Axis(ROWS, "chord", np.array([6, -2, 1]), np.array([3, -9, 0.5]))
        line = vtp(self.out / "d.vtp")["a, b"]
        h = 1e-4
        fine = np.array([axis(t) for t in np.linspace(0, 1, 20001)])
        lengths = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(fine, axis=0), axis=1))])
        tolerance = 1e-4  # a thousandth of the section
        for i, t in enumerate(line["parameter"]):
            self.assertAlmostEqual(line["arc_length"][i], np.interp(t, np.linspace(0, 1, 20001), lengths), delta=1e-7)
            tangent, side, up = (line[key][i] for key in ("tangent", "side", "up"))
            self.assert_near(np.array([tangent, side, up]) @ np.array([tangent, side, up]).T, np.eye(3), 1e-12)
            self.assert_near(np.cross(tangent, side), up, 1e-12)
            self.assertAlmostEqual(line["width"][i], 0.3, delta=2 * tolerance)
            self.assertAlmostEqual(line["height"][i], 0.1, delta=2 * tolerance)
            self.assertAlmostEqual(line["radius"][i], math.sqrt(0.3 * 0.1) / 2, delta=tolerance)
            if 2 * h < t < 1 - 2 * h and min(abs(t - k) for k in axis.knots) > 2 * h:
                before, here, after = axis(t - h), axis(t), axis(t + h)
                d1, d2 = (after - before) / (2 * h), (after - 2 * here + before) / h**2
                self.assert_near(tangent, d1 / np.linalg.norm(d1), 1e-5)
                curvature = np.linalg.norm(np.cross(d1, d2)) / np.linalg.norm(d1) ** 3
                self.assertAlmostEqual(line["curvature"][i], curvature, delta=1e-4 * (1 + curvature))
        # No chord is farther from the line than the tolerance.
        for a, b, p, q in zip(line["parameter"], line["parameter"][1:], line["points"], line["points"][1:]):
            along = (q - p) / np.linalg.norm(q - p)
            off = [np.linalg.norm(np.cross(axis(t) - p, along)) for t in np.linspace(a, b, 9)]
            self.assertLess(max(off), 1.1 * tolerance)
        with open(self.out / "d.csv", newline="") as file:
            table = list(csv.DictReader(file))
        self.assertEqual([r["yarn"] for r in table], ["a, b"] * len(line["points"]))
        self.assertEqual([int(r["point"]) for r in table], list(range(1, len(table) + 1)))
        for column, values in (
            ("x_mm", line["points"][:, 0]),
            ("side_y", line["side"][:, 1]),
            ("radius_mm", line["radius"]),
            ("curvature_per_mm", line["curvature"]),
            ("arc_length_mm", line["arc_length"]),
        ):
            self.assertEqual([float(r[column]) for r in table], list(values))

    def test_rational_lines(self):
        """Peirce's arcs: half circles of radius (d1 + d2) / 2 and straights, exact in IGES."""
        self.convert(SAMPLES / "weave_plain.txt", "iges,vtp")
        lines = vtp(self.out / "weave_plain.vtp")
        # OpenCASCADE cuts a curve where its curvature jumps; a new one begins at the parameter 0.
        curves = []
        for ts, points in gmsh_curves(self.out / "weave_plain.igs"):
            if ts[0] == 0:
                curves.append(([], []))
            curves[-1][0].extend(ts)
            curves[-1][1].extend(points)
        self.assertEqual(len(curves), len(lines))
        compared = 0
        d = float(re.search(r"diameter\s+(\S+)", (SAMPLES / "weave_plain.txt").read_text()).group(1))
        for (ts, points), line in zip(curves, lines.values()):
            for t, p in zip(ts, points):
                k = np.searchsorted(line["parameter"], t)
                if k < len(line["parameter"]) and abs(line["parameter"][k] - t) < 1e-14:
                    self.assert_near(p, line["points"][k], 1e-9)
                    compared += 1
            # Curvature is that of an arc, or none; 0.5 % of the thickness is left between yarns.
            bent = [c for c in line["curvature"] if c > 1e-6]
            self.assertGreater(len(bent), 20)
            for c in bent:
                self.assertAlmostEqual(c, 1 / d, delta=0.02 / d)
        self.assertGreater(compared, 100)

    def test_units_rings_and_what_cannot_be(self):
        self.convert(RING, "vtp", "--units", "cm")
        (line,) = vtp(self.out / "ring.vtp").values()
        self.assertEqual(list(line["points"][0]), list(line["points"][-1]))
        self.succeeds("convert", RING, "-o", self.out / "r.csv")  # nothing else of a yarn goes into a CSV
        with open(self.out / "r.csv", newline="") as file:
            last = list(csv.DictReader(file))[-1]
        self.assertAlmostEqual(float(last["arc_length_mm"]), 10 * line["arc_length"][-1], delta=1e-9)
        self.assertIn("txt holds no centre lines", self.fails(1, "convert", RING, "--lines", "-o", self.out / "r.txt"))
        self.assertIn("--lines", self.fails(1, "convert", RING, "-o", self.out / "r.svg"))
        self.assertIn("--cut", self.fails(2, "convert", RING, "--lines", "--cut"))
        self.assertIn(
            "holds no garment pieces", self.fails(1, "convert", SAMPLES / "back_piece.txt", "-o", self.out / "b.vtp")
        )
        tight = self.folder / "tight.txt"
        tight.write_text(
            "fabric 1\nthread t\n diameter 0.5\nend\nyarn bent t\n path polyline\n 0 0 0\n 1 0 0\n 1 1 0\n end\nend\n"
            "yarn hair t\n path\n 0 0 5\n 1 0 5\n 1 0.1 5\n 0 0.1 5\n end\nend\n"
        )
        told = self.succeeds("convert", tight, "--lines", "-o", self.out / "t.vtp").stderr
        self.assertRegex(told, r"hair.*radius")
        hair = vtp(self.out / "t.vtp")["hair"]
        self.assertGreater(max(hair["curvature"]), 1 / 0.25)


if __name__ == "__main__":
    unittest.main()
