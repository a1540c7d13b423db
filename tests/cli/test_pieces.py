"""Garment pieces through every format and command, before gmsh, ezdxf, an XML parser and the judge of IGES files."""

import itertools
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest
import xml.etree.ElementTree

import gmsh_mesh
from program import Case, PATH, ROOT, SAMPLES

GMSH = os.environ.get("SELVAGE_GMSH") or shutil.which("gmsh")
PIECES = sorted(path for path in SAMPLES.glob("*.txt") if re.search(r"^piece ", path.read_text(), re.MULTILINE))
MM = {"mm": 1, "cm": 10, "inch": 25.4}
ORACLE = ROOT / "tests" / "formats" / "iges" / "iges_oracle.py"
SQUARE = "fabric 1\nunits inch\npiece {}\nline a 0 0 2 0\nline b 2 0 2 3\nline c 2 3 0 3\nline d 0 3 0 0\nend\n"


def bezier(p, t):
    s = 1 - t
    return tuple(s**3 * a + 3 * s * s * t * b + 3 * s * t * t * c + t**3 * d for a, b, c, d in zip(*p))


def least_squares(points, at):
    """The inner control points by Cramer's rule on the normal equations, with the points at these parameters."""
    n = len(points) - 1
    aa = ab = bb = 0.0
    ra, rb = [0.0, 0.0], [0.0, 0.0]
    for i in range(1, n):
        t = at[i]
        a, b = 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t)
        aa, ab, bb = aa + a * a, ab + a * b, bb + b * b
        for k in (0, 1):
            rest = points[i][k] - (1 - t) ** 3 * points[0][k] - t**3 * points[n][k]
            ra[k] += a * rest
            rb[k] += b * rest
    if n == 2:  # the parabola through the three
        peak = [2 * q - (p + r) / 2 for p, q, r in zip(*points)]
        return [[(end[k] + 2 * peak[k]) / 3 for k in (0, 1)] for end in (points[0], points[2])]
    det = aa * bb - ab * ab
    return [[(bb * ra[k] - ab * rb[k]) / det for k in (0, 1)], [(aa * rb[k] - ab * ra[k]) / det for k in (0, 1)]]


def segments(path):
    """The control points of each L and C of an SVG path without spaces to spare, after its M."""
    at, out = None, []
    for letter, numbers in re.findall(r"([MLCZ])([^MLCZ]*)", path):
        values = [float(x) for x in numbers.replace(",", " ").split()]
        points = list(zip(values[::2], values[1::2]))
        if letter in "LC":
            out.append([at, *points])
        if points:
            at = points[-1]
    return out


def polygon_of(runs, steps=2000):
    """A closed polygon along lines and Beziers."""
    points = []
    for run_ in runs:
        points += run_[:1] if len(run_) == 2 else [bezier(run_, i / steps) for i in range(steps)]
    return points


def area_of(points):
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(points, points[1:] + points[:1])) / 2


def triangles(mesh):
    """Number and area of the triangles of a mesh."""
    areas = [
        ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2
        for _, (a, b, c) in gmsh_mesh.elements(mesh, gmsh_mesh.TRIANGLE)
    ]
    return len(areas), sum(areas)


class Pieces(Case):
    def facts(self, sample, *options):
        entry = json.loads(self.succeeds("info", sample, "--json", *options).stdout)["inputs"][0]
        self.assertEqual(entry["messages"], [])
        return entry["pieces"], MM[entry["units"]]

    def text(self, content, name="piece.txt"):
        path = self.folder / name
        path.write_text(content)
        return path

    def test_there_are_samples(self):
        self.assertGreaterEqual(len(PIECES), 5)

    def test_control_points_and_errors(self):
        curves = 0
        for sample in PIECES:
            for piece in self.facts(sample, "--table")[0]:
                for edge in piece["edges"]:
                    if edge["kind"] == "line" or "spline" in sample.read_text():
                        self.assertNotIn("fit", edge)
                        continue
                    curves += 1
                    fit = edge["fit"]
                    points = [p["point"] for p in fit["points"]]
                    size = max(math.dist(points[0], p) for p in points)
                    at = [p["parameter"] for p in fit["points"]]
                    if fit["by"] == "uniform":
                        self.assertEqual(at, [i / (len(points) - 1) for i in range(len(points))])
                    expected = [points[0], *least_squares(points, at), points[-1]]
                    for kind in ("control_points", "control_points_by_descent"):
                        for a, b in zip(fit[kind], expected):
                            self.assertLess(math.dist(a, b), 1e-11 * size, (sample.name, edge["name"], kind))
                    errors = [math.dist(bezier(expected, t), p) for t, p in zip(at, points)]
                    if fit["by"] == "distance":  # the samples' points are met
                        self.assertLess(max(errors), 1e-9 * size)
                    for point, error in zip(fit["points"], errors):
                        self.assertAlmostEqual(point["error"], error, delta=1e-11 * size)
                        nearest = min(math.dist(bezier(expected, i / 5000), point["point"]) for i in range(5001))
                        self.assertLessEqual(point["distance"], nearest + 1e-9 * size)
                        self.assertGreaterEqual(point["distance"], nearest - 1e-3 * size)
                    self.assertAlmostEqual(fit["largest_error"], max(errors), delta=1e-11 * size)
        self.assertGreaterEqual(curves, 12)

    def test_table_as_text(self):
        back = (SAMPLES / "back_piece.txt").read_text().replace("curve side S", "curve side S by uniform")
        table = self.succeeds("info", self.text(back), "--table").stdout
        self.assertRegex(
            table, r"curve 'side' of piece 'back': S, points by uniform, largest error 0\.945, \d+ steps of descent"
        )
        self.assertRegex(table, r"(?m)^ +3 +0\.5 +23\.6 +28 +0\.945 +0\.453$")
        self.assertRegex(table, r"(?m)^  B1 +20\.7935 +35\.3856 +20\.7935 +35\.3856 +\S+$")

    def test_svg(self):
        for sample in PIECES:
            for unit in (None, "mm", "inch"):
                options = ["--units", unit] if unit else []
                facts, mm = self.facts(sample)
                mm = MM[unit] if unit else mm
                self.succeeds("convert", sample, "-o", self.folder / "p.svg", *options)
                root = xml.etree.ElementTree.parse(self.folder / "p.svg").getroot()
                space = "{http://www.w3.org/2000/svg}"
                paths = root.findall(f".//{space}path")
                self.assertEqual([p.find(f"{space}title").text for p in paths], [f["name"] for f in facts])
                whole = []
                for path, piece in zip(paths, facts):
                    runs = segments(path.get("d"))
                    kinds = ["line" if len(r) == 2 else "curve" for r in runs]
                    # A spline is a curve a span.
                    alike = [
                        [kind for kind, _ in itertools.groupby(k)] for k in (kinds, [e["kind"] for e in piece["edges"]])
                    ]
                    self.assertEqual(*alike)
                    self.assertEqual(kinds.count("line"), [e["kind"] for e in piece["edges"]].count("line"))
                    self.assertEqual(path.find(f"{space}desc").text, ", ".join(e["name"] for e in piece["edges"]))
                    self.assertEqual(runs[0][0], runs[-1][-1])
                    points = polygon_of(runs)
                    whole += points
                    # y points down: what runs counter-clockwise in the fabric has a negative sign here.
                    self.assertAlmostEqual(-area_of(points) * mm**2 / piece["area"], 1, delta=1e-6)
                low = [min(p[k] for p in whole) for k in (0, 1)]
                high = [max(p[k] for p in whole) for k in (0, 1)]
                x, y, width, height = map(float, root.get("viewBox").split())
                for page, box, at, a, b in (
                    ("width", width, x, low[0], high[0]),
                    ("height", height, y, low[1], high[1]),
                ):
                    self.assertTrue(root.get(page).endswith("mm"))
                    self.assertAlmostEqual(float(root.get(page)[:-2]), box * mm, delta=1e-9 * box * mm)
                    self.assertAlmostEqual(box * mm, (b - a) * mm + 10, delta=1e-4)
                    self.assertAlmostEqual(at * mm, a * mm - 5, delta=1e-4)

    def test_names_in_svg(self):
        sample = self.text(SQUARE.format('"a <c> & \u00e9"') + SQUARE.split("\n", 2)[2].format('"a (c) & \u00e9"'))
        self.succeeds("convert", sample, "-o", self.folder / "p.svg")
        root = xml.etree.ElementTree.parse(self.folder / "p.svg").getroot()
        paths = root.findall(".//{http://www.w3.org/2000/svg}path")
        self.assertEqual([p[0].text for p in paths], ["a <c> & \u00e9", "a (c) & \u00e9"])
        self.assertEqual([p.get("id") for p in paths], ["a__c_____", "a__c______2"])

    def judge_cad(self, sample, file, several_spans=False):
        """The areas of gmsh's CAD, and those that its triangles fill, in mm2."""
        facts, _ = self.facts(sample)
        script = self.folder / "piece.geo"
        script.write_text(
            f'SetFactory("OpenCASCADE");\nv() = ShapeFromFile("{file.name}");\ns() = Surface{{:}};\n'
            'For i In {0:#s()-1}\nm() = Mass Surface{s(i)};\nPrintf("mass %.16g", m(0));\nEndFor\n'
        )
        read = subprocess.run(
            [GMSH, script.name, "-parse_and_exit"], cwd=self.folder, capture_output=True, text=True, timeout=300
        )
        areas = [float(m) for m in re.findall(r"mass (\S+)", read.stdout)]
        self.assertEqual(len(areas), len(facts), read.stdout)
        for theirs, piece in zip(areas, facts):
            # gmsh does not ask OpenCASCADE for an integral that is exact where a curve has several spans, or weights.
            self.assertAlmostEqual(theirs / piece["area"], 1, delta=2e-2 if several_spans else 1e-9)
        total = sum(piece["area"] for piece in facts)
        for size in (math.sqrt(total) / k for k in (4, 16)):
            subprocess.run(
                [GMSH, file.name, "-2", "-format", "msh2", "-clmax", str(size), "-clmin", str(size), "-o", "p.msh"],
                cwd=self.folder,
                capture_output=True,
                check=True,
                timeout=300,
            )
            count, area = triangles(self.folder / "p.msh")
            self.assertGreater(count, 4)
            # Chords of curves: of second order in their length.
            self.assertLess(abs(area / total - 1), (1.2 if several_spans else 0.4) * size**2 / total)

    def test_gmsh_reads_and_meshes_step_and_iges(self):
        self.assertTrue(GMSH, "gmsh is not installed")
        for sample in PIECES:
            for suffix in (".stp", ".igs"):
                with self.subTest(sample=sample.name, suffix=suffix):
                    file = self.folder / f"p{suffix}"
                    self.succeeds("convert", sample, "-o", file)
                    self.judge_cad(sample, file, several_spans="spline" in sample.read_text())

    def test_iges_is_right(self):
        for sample in PIECES:
            file = self.folder / "p.igs"
            self.succeeds("convert", sample, "-o", file)
            judged = subprocess.run([sys.executable, "-B", ORACLE, file], capture_output=True, text=True)
            self.assertEqual(judged.returncode, 0, judged.stdout + judged.stderr)
            edges = [edge["name"] for piece in self.facts(sample)[0] for edge in piece["edges"]]
            for name in edges:
                self.assertIn(f"{len(name)}H{name};", file.read_text())

    def test_step_names(self):
        self.succeeds("convert", SAMPLES / "pocket_pieces.txt", "-o", self.folder / "p.stp")
        text = (self.folder / "p.stp").read_text()
        self.assertEqual(re.findall(r"SHELL_BASED_SURFACE_MODEL\('(\w+)'", text), ["pocket", "flap"])
        self.assertEqual(text.count("ADVANCED_FACE"), 2)

    def dxf(self, sample, *options):
        file = self.folder / "p.dxf"
        done = self.succeeds("convert", sample, "-o", file, *options)
        python = pathlib.Path("/usr/bin/python3")
        read = subprocess.run(
            [python, "-B", pathlib.Path(__file__).with_name("dxf_facts.py"), file], capture_output=True, text=True
        )
        self.assertEqual(read.returncode, 0, read.stderr)
        return json.loads(read.stdout), done.stderr

    def test_dxf(self):
        for sample in PIECES:
            for unit, code in ((None, None), ("mm", 4), ("inch", 1), ("cm", 5)):
                with self.subTest(sample=sample.name, unit=unit):
                    facts, mm = self.facts(sample, "--table")
                    read, _ = self.dxf(sample, *(["--units", unit] if unit else []))
                    mm = MM[unit] if unit else mm
                    self.assertEqual((read["version"], read["errors"], read["fixes"]), ("AC1015", 0, 0))
                    if code:
                        self.assertEqual((read["insunits"], read["measurement"]), (code, 0 if unit == "inch" else 1))
                    self.assertEqual([b["name"] for b in read["blocks"]], [f["name"] for f in facts])
                    for block, piece in zip(read["blocks"], facts):
                        self.assertTrue(block["closed"])
                        self.assertEqual(block["at"], [0, 0, 0])
                        self.assertEqual(
                            block["kinds"], ["LINE" if e["kind"] == "line" else "SPLINE" for e in piece["edges"]]
                        )
                        self.assertAlmostEqual(block["area"] * mm**2 / piece["area"], 1, delta=1e-6)
                        fits = [e["fit"] for e in piece["edges"] if "fit" in e]
                        for ours, theirs in zip(fits, block["control_points"]):
                            theirs = [[x * mm for x in p] for p in theirs]
                            gaps = [
                                max(map(math.dist, order, ours["control_points"])) for order in (theirs, theirs[::-1])
                            ]
                            self.assertLess(min(gaps), 1e-9 * math.sqrt(piece["area"]))
                        layers = {"2": len(piece["edges"]), "3": sum(len(f["points"]) - 2 for f in fits)}
                        self.assertEqual(block["layers"], layers)
                        self.assertEqual(block["texts"], ["Piece Name: " + piece["name"]])
                    for k in (0, 1):
                        low = min(b["box"][0][k] for b in read["blocks"])
                        high = max(b["box"][1][k] for b in read["blocks"])
                        self.assertAlmostEqual(read["extents"][0][k] * mm, low * mm, delta=1e-4)
                        self.assertAlmostEqual(read["extents"][1][k] * mm, high * mm, delta=1e-4)

    def test_names_in_dxf(self):
        second = SQUARE.split("\n", 2)[2]
        read, words = self.dxf(
            self.text(SQUARE.format('"R\u00fccken/1"') + second.format('"r\u00dcCKEN:1"') + second.format('"R_1"'))
        )
        self.assertEqual((read["errors"], read["fixes"]), (0, 0))
        names = [block["name"] for block in read["blocks"]]
        self.assertEqual(names[0], "R\u00fccken_1")
        self.assertEqual(names[2], "R_1")
        self.assertEqual(read["blocks"][0]["texts"], ["Piece Name: R\u00fccken/1"])
        self.assertRegex(words, r"piece.txt:3:1: warning: DXF does not admit the name")

    def test_same_input_same_bytes(self):
        for suffix in ("svg", "dxf", "igs", "stp"):
            for name in "ab":
                (self.folder / name).mkdir(exist_ok=True)
                self.succeeds("convert", SAMPLES / "pocket_pieces.txt", "-o", self.folder / name / f"p.{suffix}")
            self.assertEqual(
                (self.folder / "a" / f"p.{suffix}").read_bytes(), (self.folder / "b" / f"p.{suffix}").read_bytes()
            )

    def test_check(self):
        for sample in PIECES:
            done = self.succeeds("check", sample)
            self.assertIn("sound: every piece is a valid face in a closed outline", done.stdout)
        for name, words in (
            ("gap", "starts at"),
            ("open", "not closed"),
            ("crossing", "crosses or touches"),
            ("flat", "no area"),
        ):
            self.assertIn(words, self.fails(3, "check", SAMPLES / "bad" / f"piece_{name}.txt"))

    def test_word_that_says_otherwise(self):
        sample = self.text("fabric 1\npiece p\ncurve arc S\n0 0\n1 1\n2 0\nend\nline l 2 0 0 0\nend\n")
        warning = (
            f"{sample}:3:1: warning: curve 'arc' is called S, but turns one way only, as a C does, and so do its points"
        )
        self.assertIn(warning, self.succeeds("info", sample).stderr)
        self.assertIn(warning, self.fails(1, "info", sample, "--strict"))

    def test_what_cannot_hold_a_piece(self):
        back = SAMPLES / "back_piece.txt"
        self.assertRegex(
            self.fails(1, "mesh", back, "-o", self.folder / "p.inp"), r"back_piece.txt:5:1: error: .*flat face"
        )
        for suffix in ("svg", "dxf"):
            self.assertRegex(
                self.fails(1, "convert", PATH, "-o", self.folder / f"y.{suffix}"), f"{suffix} holds garment pieces"
            )
        both = self.text(
            pathlib.Path(PATH).read_text() + "piece p\nline a 0 0 2 0\nline b 2 0 2 3\nline c 2 3 0 0\nend\n"
        )
        self.assertIn("has 4 yarns", self.fails(1, "convert", both, "-o", self.folder / "y.svg"))
        self.assertFalse((self.folder / "y.svg").exists())
        report = self.folder / "r.json"
        self.succeeds("convert", both, "--to", "iges,step", "-o", self.out, "--report", report)
        outputs = json.loads(report.read_text())["inputs"][0]["outputs"]
        self.assertEqual(outputs[0]["entities"]["144"], 1)
        self.assertEqual(outputs[1]["entities"], {"MANIFOLD_SOLID_BREP": 4, "SHELL_BASED_SURFACE_MODEL": 1})
        self.succeeds("check", both)

    def test_a_pattern_follows_the_measurements(self):
        """Three bodies, drafted here once more; the curves by their cubics through four rows, the area by a polygon."""
        for chest, back, neck in ((88, 41, 36), (104, 43, 40), (76, 38.5, 34.5)):
            width, depth, hollow = chest / 4 + 1.5, chest / 8 + 10.5, neck / 6 + 0.5
            armhole = [
                (width, back - depth),
                (width - 3.6, back - depth + 3.4),
                (chest / 8 + neck / 8 + 2, back - depth / 2),
                (hollow + 11.5, back - 4.5),
            ]
            neckline = [
                (hollow, back),
                (0.87 * hollow, back - 0.575 * hollow),
                (0.5 * hollow, back - hollow),
                (0, back - 1.15 * hollow),
            ]
            cubics = [[rows[0], *least_squares(rows, [0, 1 / 3, 2 / 3, 1]), rows[-1]] for rows in (armhole, neckline)]
            body = ("--set", f"chest={chest}", "--set", f"back={back}", "--set", f"neck={neck}")
            (piece,), mm = self.facts(SAMPLES / "bodice_measured.txt", "--table", *body)
            lengths = {edge["name"]: edge["length"] / mm for edge in piece["edges"]}
            for name, (p, q) in {
                "waist": ((0, 0), (width, 0)),
                "side": ((width, 0), armhole[0]),
                "shoulder": (armhole[-1], neckline[0]),
                "middle": (neckline[-1], (0, 0)),
            }.items():
                self.assertAlmostEqual(lengths[name], math.dist(p, q), delta=1e-12 * back)
            for name, cubic in zip(("armhole", "neckline"), cubics):
                points = [bezier(cubic, i / 2000) for i in range(2001)]
                self.assertAlmostEqual(lengths[name], sum(map(math.dist, points, points[1:])), delta=1e-5)
            outline = polygon_of(
                [
                    [(0, 0), (width, 0)],
                    [(width, 0), armhole[0]],
                    cubics[0],
                    [armhole[-1], neckline[0]],
                    cubics[1],
                    [neckline[-1], (0, 0)],
                ]
            )
            self.assertAlmostEqual(piece["area"] / mm**2, area_of(outline), delta=1e-4)

    def test_armhole_follows_its_sleeve(self):
        """Lengths by sums of chords along what the drawing has."""
        self.succeeds("convert", SAMPLES / "sleeve_and_armhole.txt", "-o", self.folder / "p.svg")
        root = xml.etree.ElementTree.parse(self.folder / "p.svg").getroot()
        lengths = {}
        for path in root.iter("{http://www.w3.org/2000/svg}path"):
            curves = [run for run in segments(path.get("d")) if len(run) == 4]
            points = [bezier(run, i / 2000) for run in curves for i in range(2001)]
            lengths[path[0].text] = sum(map(math.dist, points, points[1:]))
        self.assertAlmostEqual(lengths["body"], lengths["sleeve"] - 2, delta=1e-5)
        # Wherever the sleeve goes, the armhole follows.
        text = (SAMPLES / "sleeve_and_armhole.txt").read_text().replace("18.0  56.0", "18.0  56.7")
        facts, mm = self.facts(self.text(text))
        by_name = {edge["name"]: edge["length"] / mm for piece in facts for edge in piece["edges"]}
        self.assertGreater(by_name["cap"], lengths["sleeve"] + 0.3)
        self.assertAlmostEqual(by_name["armhole"], by_name["cap"] - 2, delta=1e-10)

    def test_edit_of_a_curve(self):
        source = SAMPLES / "sleeve_and_armhole.txt"
        edit = ("edit", source, "--piece", "sleeve", "--curve", "cap", "-o", self.folder / "e.txt")
        self.succeeds(*edit, "--point", "5", "--to", "18,56.5")
        before, after = source.read_text(), (self.folder / "e.txt").read_text()
        line = "  edit cap point 5 to 18 56.5\n"
        self.assertIn(line, after)
        self.assertEqual(after.replace(line, ""), before)
        facts, _ = self.facts(self.folder / "e.txt")
        self.assertEqual(len(facts), 2)
        self.assertIn("where the outline would open", self.fails(1, *edit, "--point", "1", "--to", "0,1"))
        self.assertIn("two numbers", self.fails(2, *edit, "--point", "2", "--to", "0,1,2"))
        self.assertIn(
            "either --yarn NAME, or --piece", self.fails(2, "edit", source, "--point", "1", "--to", "0,1", "-o", "-")
        )
        self.assertIn(
            "no piece 'x'",
            self.fails(1, "edit", source, "--piece", "x", "--curve", "cap", "--point", "2", "--to", "0,1", "-o", "-"),
        )

    def test_rational_curves_in_files(self):
        """A disc of four rational cubics, and a half of one B-spline with weights and knots, before gmsh and ezdxf."""
        w, a = (1 + math.sqrt(2)) / 3, math.sqrt(2) / (1 + math.sqrt(2))
        text, (x, y) = "fabric 1\nunits cm\npiece disc\n", (2, 0)
        for quarter in range(4):
            text += (
                f"curve q{quarter} control\n{x} {y}\n{x - a * y} {y + a * x} {w}\n{-y + a * x} {x + a * y} {w}\n"
                f"{-y} {x}\nend\n"
            )
            x, y = -y, x
        text += (
            "end\npiece half\ncurve c control\nknots 0 0 0 0 0.3 0.3 0.7 1 1 1 1\n5 0\n6 0 2\n7 1\n7 2 0.5\n6 3\n5 3 3\n4 1\nend\n"
            "line l 4 1 5 0\nend\n"
        )
        sample = self.text(text, "disc.txt")
        facts, _ = self.facts(sample)
        self.assertAlmostEqual(facts[0]["area"], 400 * math.pi, delta=1e-5)
        for suffix in (".stp", ".igs"):
            self.succeeds("convert", sample, "-o", self.folder / f"p{suffix}")
            self.judge_cad(sample, self.folder / f"p{suffix}", several_spans=True)
        read, _ = self.dxf(sample)
        self.assertEqual((read["errors"], read["fixes"]), (0, 0))
        self.assertAlmostEqual(read["blocks"][0]["area"], 4 * math.pi, delta=1e-5)
        self.assertAlmostEqual(read["blocks"][1]["area"] * 100 / facts[1]["area"], 1, delta=1e-6)
        self.assertIn("sound", self.succeeds("check", sample, self.folder / "p.igs").stdout)
        self.assertNotIn("different", self.succeeds("roundtrip", sample).stdout)

    def test_text_written_and_read_is_the_same_piece(self):
        for sample in PIECES:
            self.succeeds("convert", sample, "-o", self.folder / "again.txt")
            first = self.succeeds("convert", sample, "--to", "svg", "-o", "-").stdout
            self.assertEqual(
                first, self.succeeds("convert", self.folder / "again.txt", "--to", "svg", "-o", "-").stdout
            )


if __name__ == "__main__":
    unittest.main()
