"""Centre lines in: points of yarns, measured or written by `--lines`, as CSV and VTP. What is built is judged on the 126s
of the IGES files, by the basis functions of test_lines. Needs the system's Python with numpy."""

import csv
import json
import math
import pathlib
import sys
import unittest

import numpy as np

from program import Case, RING, SAMPLES, run

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "formats" / "iges"))
import iges_file


def curves_of(path):
    """Every 126 of a file."""
    sections = iges_file.split_sections(pathlib.Path(path).read_bytes())
    out = []
    for entity in iges_file.parse_directory(sections).values():
        if entity.type == 126:
            iges_file.read_entity(entity)
            out.append(entity.curve)
    return out


class Spline:
    """A 126 as an array of points at parameters, with two derivatives by differences of its own pieces."""

    def __init__(self, curve):
        self.d, self.k = curve.d, np.array(curve.k)
        self.p = np.array(curve.points)

    def coefficients(self, ts):
        rows = np.zeros((len(ts), len(self.k) - 1))
        last = max(i for i in range(len(self.k) - 1) if self.k[i] < self.k[i + 1])
        for i in range(len(self.k) - 1):
            rows[:, i] = (self.k[i] <= ts) & (ts < self.k[i + 1])
        rows[ts >= self.k[-1], last] = 1
        for k in range(1, self.d + 1):
            new = np.zeros((len(ts), len(self.k) - 1 - k))
            for i in range(new.shape[1]):
                if self.k[i + k] > self.k[i]:
                    new[:, i] += (ts - self.k[i]) / (self.k[i + k] - self.k[i]) * rows[:, i]
                if self.k[i + k + 1] > self.k[i + 1]:
                    new[:, i] += (self.k[i + k + 1] - ts) / (self.k[i + k + 1] - self.k[i + 1]) * rows[:, i + 1]
            rows = new
        return rows

    def __call__(self, ts):
        return self.coefficients(np.asarray(ts, float)) @ self.p

    def derivative(self):
        out = Spline.__new__(Spline)
        n = len(self.p)
        steps = self.k[self.d + 1 : self.d + n] - self.k[1:n]
        with np.errstate(divide="ignore", invalid="ignore"):
            out.p = np.where(steps[:, None] > 0, self.d * np.diff(self.p, axis=0) / steps[:, None], 0)
        out.d, out.k = self.d - 1, self.k[1:-1]
        return out

    def dense(self, of_each=60):
        knots = np.unique(self.k)
        return np.concatenate(
            [np.linspace(a, b, of_each, endpoint=False) for a, b in zip(knots, knots[1:])] + [[knots[-1]]]
        )

    def curvature(self, ts):
        first, second = self.derivative(), self.derivative().derivative()
        a, b = first(ts), second(ts)
        return np.linalg.norm(np.cross(a, b), axis=1) / np.linalg.norm(a, axis=1) ** 3


def distances(points, line):
    """Of points from a dense polygon on the line."""
    fine = line(line.dense(200))
    out = []
    for p in points:
        d = np.linalg.norm(fine - p, axis=1)
        i = min(max(int(np.argmin(d)), 1), len(fine) - 2)
        best = d[i]
        for a, b in ((fine[i - 1], fine[i]), (fine[i], fine[i + 1])):
            s = np.clip(np.dot(p - a, b - a) / np.dot(b - a, b - a), 0, 1)
            best = min(best, np.linalg.norm(p - a - s * (b - a)))
        out.append(best)
    return np.array(out)


def helix(t):
    return np.c_[np.cos(4 * np.pi * t), np.sin(4 * np.pi * t), 4 * t]


def sine(t):
    return np.c_[10 * t, 0.4 * np.sin(8 * np.pi * t), 0 * t]


class Points(Case):
    def setUp(self):
        super().setUp()
        self.out.mkdir(exist_ok=True)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def lines_of(self, source, *options):
        target = self.out / "lines.igs"
        done = self.succeeds("convert", source, "--lines", "-o", target, *options)
        return [Spline(c) for c in curves_of(target)], done

    def test_what_lines_writes_comes_back(self):
        for sample in ("plain4_path", "ring", "jersey", "path_derivatives", "warpknit_tricot", "braid_regular"):
            source = SAMPLES / f"{sample}.txt"
            self.succeeds("convert", source, "--lines", "--to", "csv,vtp,iges", "-o", f"{self.out}/")
            wanted = [Spline(c) for c in curves_of(self.out / f"{sample}.igs")]
            for form in ("csv", "vtp"):
                back = self.out / "back.igs"
                self.succeeds("convert", self.out / f"{sample}.{form}", "--lines", "-o", back)
                found = [Spline(c) for c in curves_of(back)]
                self.assertEqual(len(found), len(wanted))
                for a, b in zip(wanted, found):
                    ts = a.dense(7)
                    self.assertLess(np.max(np.abs(a(ts) - b(ts))), 1e-9, sample)
                    # No knots but its own: no more control points than there were.
                    self.assertLessEqual(len(b.p), len(a.p), sample)

    def test_names_and_sections_come_back(self):
        source = SAMPLES / "plain4_path.txt"
        self.succeeds("convert", source, "--to", "csv,vtp", "--lines", "-o", f"{self.out}/")
        for form in ("csv", "vtp"):
            self.succeeds(
                "convert", self.out / f"plain4_path.{form}", "--to", "csv", "--lines", "-o", self.out / "b.csv"
            )
            with open(self.out / "plain4_path.csv", newline="") as a, open(self.out / "b.csv", newline="") as b:
                one, other = list(csv.DictReader(a)), list(csv.DictReader(b))
            self.assertEqual([r["yarn"] for r in one], [r["yarn"] for r in other])
            for r, s in zip(one, other):
                for key in ("width_mm", "height_mm"):
                    self.assertAlmostEqual(float(r[key]), float(s[key]), delta=2e-3 * float(r[key]))

    def noisy(self, shape, sigma, count, seed):
        random = np.random.default_rng(seed)
        true = shape(np.linspace(0, 1, count))
        points = true + random.normal(0, sigma, true.shape)
        rows = "".join(f"a,{x!r},{y!r},{z!r}\n" for x, y, z in points.tolist())
        self.write("ct.csv", "yarn,x_mm,y_mm,z_mm\n" + rows)
        return points

    def test_noisy_points(self):
        """Sigma is known: at the error of five of it the line is near the true curve, and bends no more than it should."""
        for shape, curvature in (
            (helix, 4 * np.pi**2 * 4 / ((4 * np.pi) ** 2 + 16)),
            (sine, 0.4 * (0.8 * np.pi) ** 2),
        ):
            for sigma, count in ((0.01, 400), (0.003, 150)):
                points = self.noisy(shape, sigma, count, 7)
                error = 5 * sigma
                text = self.write("ct.txt", f"fabric 1\nyarn a\n  diameter 0.3\n  points ct.csv error {error}\nend\n")
                (line,), done = self.lines_of(text)
                self.assertNotIn("warning", done.stderr)
                self.assertLessEqual(distances(points, line).max(), error * (1 + 1e-6))
                true = shape(np.linspace(0, 1, 4000))
                ts = line.dense(20)
                off = [np.min(np.linalg.norm(true - p, axis=1)) for p in line(ts)]
                self.assertLess(max(off), error)
                self.assertLess(np.mean(off), 0.4 * error)
                k = line.curvature(line.dense(50))
                self.assertLess(k.max(), 1 / 0.15)
                # Fewer control points than a tenth of the points have coordinates.
                self.assertLess(len(line.p), 40)

    def test_the_error_is_kept_and_asks_for_knots(self):
        points = self.noisy(helix, 0.004, 500, 3)
        numbers = []
        for error in (0.2, 0.05, 0.02, 0.012):
            text = self.write("ct.txt", f"fabric 1\nyarn a\n  diameter 0.1\n  points ct.csv error {error}\nend\n")
            (line,), _ = self.lines_of(text)
            self.assertLessEqual(distances(points, line).max(), error * (1 + 1e-6))
            numbers.append(len(line.p))
        self.assertEqual(numbers, sorted(numbers))
        self.assertLess(numbers[0], numbers[-1])

    def test_tight_bends_are_told(self):
        """A yarn that is thicker than its helix bends."""
        self.noisy(helix, 0.004, 400, 5)
        text = self.write("ct.txt", "fabric 1\nyarn a\n  diameter 2.6\n  points ct.csv error 0.02\nend\n")
        (line,), done = self.lines_of(text)
        self.assertGreater(line.curvature(line.dense(50)).max(), 1 / 1.3)
        done = run("convert", text, "-o", self.out / "a.igs")
        self.assertIn("bends more tightly than its section allows", done.stderr)

    def test_widths_heights_and_angles(self):
        rows = ["x,y,z,width,height,angle"]
        random = np.random.default_rng(2)
        for t in np.linspace(0, 1, 200):
            noise = random.uniform(-0.004, 0.004, 2)
            rows.append(f"{10 * t},0,0,{0.4 + 0.2 * t + noise[0]},{0.2 - 0.1 * t + noise[1]},{90 * t}")
        self.write("s.csv", "\n".join(rows) + "\n")
        text = self.write("s.txt", "fabric 1\nyarn a\n  points s.csv error 0.01\nend\n")
        self.succeeds("convert", text, "--to", "csv", "--lines", "-o", self.out / "l.csv")
        with open(self.out / "l.csv", newline="") as file:
            table = list(csv.DictReader(file))
        for r in table:
            t = float(r["x_mm"]) / 10
            a, b = 0.2 + 0.1 * t, 0.1 - 0.05 * t
            self.assertAlmostEqual(math.pi * float(r["radius_mm"]) ** 2, math.pi * a * b, delta=0.03)
            # The width ends where the section has turned to.
            turn = math.degrees(math.atan2(float(r["side_z"]), float(r["side_y"])))
            self.assertLess(abs((turn - 90 * t + 90) % 180 - 90) if t > 0.02 else 0, 5)

    def test_rings_and_units(self):
        ts = np.linspace(0, 1, 61)
        points = np.c_[np.cos(2 * np.pi * ts), np.sin(2 * np.pi * ts), 0 * ts] / 10
        points[-1] = points[0]
        self.write(
            "r.csv",
            "name,x_cm,y_cm,z_cm,diameter_cm\n"
            + "".join(f"ring,{x!r},{y!r},{z!r},0.02\n" for x, y, z in points.tolist()),
        )
        for error in ("", " error 0.001"):
            text = self.write("r.txt", f"fabric 1\nunits mm\nyarn r\n  points r.csv yarn ring{error}\nend\n")
            (line,), _ = self.lines_of(text)
            p = line(line.dense())
            self.assertLess(np.max(np.abs(np.linalg.norm(p, axis=1) - 1)), 2e-3)
            self.assertEqual(list(p[0]), list(p[-1]))
        done = self.succeeds("info", self.folder / "r.csv")
        self.assertIn("cm", done.stdout + done.stderr)

    def test_outlines_of_sections(self):
        """A cone of ellipses, each begun somewhere else and every other one run the other way: volume by Pappus' rule."""
        random = np.random.default_rng(4)
        rows = ["section,x_mm,y_mm,z_mm"]
        for k in range(9):
            n = 60 + int(random.integers(0, 5))
            angles = 2 * np.pi * (np.arange(n) / n + random.uniform())
            if k % 2:
                angles = angles[::-1]
            size = 1 - 0.05 * k
            rows += [f"s{k},{0.5 * size * math.cos(a)},{0.3 * size * math.sin(a)},{k}" for a in angles]
        self.write("stack.csv", "\n".join(rows) + "\n")
        done = self.succeeds("info", self.folder / "stack.csv", "--json")
        yarn = json.loads(done.stdout)["inputs"][0]["yarns"][0]
        volume = math.pi * 0.15 * sum((1 - 0.05 * k / 1000) ** 2 for k in range(8000)) / 1000
        self.assertAlmostEqual(yarn["volume"], volume, delta=0.005 * volume)
        self.assertNotIn("warning", self.succeeds("check", self.folder / "stack.csv").stderr)

    def refused(self, table, *words, text=None):
        self.write("bad.csv", table)
        source = self.folder / "bad.csv"
        if text is not None:
            source = self.write("bad.txt", text)
        done = run("convert", source, "-o", self.out / "x.igs")
        self.assertEqual(done.returncode, 1 if done.returncode == 1 else 2, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_bad_input(self):
        head = "yarn,x,y,z,radius\n"
        self.refused(head + "a,0,0,0,1\na,nan,0,0,1\n", "bad.csv:3:3: error", "'nan' is not a number")
        self.refused(head + "a,0,0,0,1\na,1e999,0,0,1\n", "bad.csv:3:3: error")
        self.refused(head + "a,0,0,0,1\na,1,0,0,0\n", "bad.csv:3:9: error", "larger than 0")
        self.refused(head + "a,0,0,0,1\n", "bad.csv:2:3: error", "one point")
        self.refused(head, "bad.csv:1:1: error", "no point")
        self.refused(head + "a,0,0,0,1\na,0,0,0,1\n", "bad.csv:3:3: error", "equals the one before")
        self.refused(head + "a,0,0,0,1\na,2,0,0,1\na,1,0.01,0,1\na,3,0,0,1\n", "bad.csv:3:3: error", "doubles back")
        self.refused("yarn,x,y,radius\na,0,0,1\n", "bad.csv:1:1: error", "columns are missing: z")
        self.refused("x_mm,y_mm,z_cm,radius\n0,0,0,1\n", "different units")
        self.refused("x,y,z\n0,0,0\n1,0,0\n", "bad.csv:2:1: error", "how thick")
        self.refused(
            "point,x,y,z,radius\n1,0,0,0,1\n3,1,0,0,1\n2,2,0,0,1\n", "bad.csv:4:1: error", "points out of order"
        )
        self.refused("section,x,y,z\n1,0,0,0\n1,1,0,0\n", "bad.csv:2:3: error", "one section")
        self.refused(head + "a,0,0,0,1\na,1,0\n", "bad.csv:3:1: error", "3 values")
        yarn = "fabric 1\nyarn y\n  points bad.csv{}\nend\n"
        two = head + "a,0,0,0,1\na,1,0,0,1\nb,0,1,0,1\nb,1,1,0,1\n"
        self.refused(two, "bad.txt:3:3: error", "2 yarns", text=yarn.format(""))
        self.refused(two, "bad.txt:3:3: error", "no yarn 'c'", text=yarn.format(" yarn c"))
        self.refused(two, "bad.txt:3:24: error", text=yarn.format(" error -1"))
        self.refused(two, "bad.txt:3:3: error", "cannot open", text=yarn.format("").replace("bad.csv", "none.csv"))
        self.refused(
            two,
            "bad.txt:3:3: error",
            "neither in this text's folder",
            text=yarn.format("").replace("bad.csv", "/etc/hostname"),
        )

    def test_bad_vtp(self):
        self.succeeds("convert", RING, "--to", "vtp", "--lines", "-o", self.out / "r.vtp")
        good = (self.out / "r.vtp").read_text()
        for old, new, word in (
            ("ascii", "binary", "only ascii"),
            ('Name="offsets"', 'Name="other"', "no Lines"),
            ("<Points>", "<Nothing>", "no Points"),
        ):
            path = self.write("bad.vtp", good.replace(old, new))
            done = run("convert", path, "-o", self.out / "x.igs")
            self.assertNotEqual(done.returncode, 0)
            self.assertRegex(done.stderr, r"bad\.vtp:\d+:\d+: error")
            self.assertIn(word, done.stderr)

    def test_folders_leave_tables_alone(self):
        """A table beside texts is no input of its own, unless it is named."""
        self.noisy(helix, 0.01, 50, 1)
        self.write("a.txt", "fabric 1\nyarn a\n  diameter 0.3\n  points ct.csv error 0.1\nend\n")
        (self.folder / "out").rmdir()
        self.succeeds("convert", self.folder, "-o", f"{self.out}/")
        self.assertEqual(sorted(p.name for p in self.out.iterdir()), ["a.igs", "a.stp"])


if __name__ == "__main__":
    unittest.main()
