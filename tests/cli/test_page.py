"""Pages of `selvage view`: that what they hold is the yarns and the meshes. How they look and behave in a browser is looked at every
night (tests/page)."""

import base64
import csv
import hashlib
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import unittest

import meshio
import numpy as np

from page import Page
from program import HAS_PAGES, NO_PAGES, PROGRAM, SAMPLES, Case, environment, files_below

# Round, flat, twisted, looped, braided; paths, grids, a ring.
CLOTHS = [
    "plain4_path.txt",
    "plain4_grid.txt",
    "ring.txt",
    "weave_tow.txt",
    "jersey.txt",
    "braid.txt",
    "ply2_plain.txt",
]
ROUND = ["jersey.txt", "weave_plain.txt", "braid_diamond.txt", "warpknit_tricot.txt"]

HEAD = "fabric 1\nunits mm\ntolerance 1e-4\nthread rod\n  diameter 0.4\nend\n"


def rod(name, rows, more=""):
    return f"yarn {name} rod\n{more}  path chord\n" + "".join(f"    {row}\n" for row in rows) + "  end\nend\n"


def distances(points, line):
    """Of points from a polyline, by its nearest segment."""
    a, b = line[:-1], line[1:]
    way = b - a
    size = np.maximum((way**2).sum(axis=1), 1e-300)
    best = np.empty(len(points))
    for first in range(0, len(points), 512):
        p = points[first : first + 512, None]
        share = np.clip(((p - a) * way).sum(axis=2) / size, 0, 1)
        best[first : first + 512] = np.sqrt((((a + share[..., None] * way) - p) ** 2).sum(axis=2)).min(axis=1)
    return best


class Base(Case):
    def setUp(self):
        super().setUp()
        if not HAS_PAGES:
            self.skipTest(NO_PAGES)

    def source(self, text, name="cloth.txt"):
        path = self.folder / name
        path.write_text(text)
        return path

    def page(self, source, *options):
        self.path = self.folder / "page.html"
        self.succeeds("view", source, "-o", self.path, *options)
        return Page(self.path)

    def facts(self, source):
        return json.loads(self.succeeds("info", source, "--json").stdout)["inputs"][0]

    def lines(self, source):
        """The yarns' centre lines and radii, by name."""
        self.succeeds("convert", source, "--lines", "--to", "csv", "-o", self.folder / "lines.csv")
        with open(self.folder / "lines.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        yarns = {}
        for row in rows:
            yarns.setdefault(row["yarn"], []).append([float(row[f"{key}_mm"]) for key in ("x", "y", "z", "radius")])
        return {name: np.array(values) for name, values in yarns.items()}


class Yarns(Base):
    def test_every_yarn_is_there_and_fills_its_volume(self):
        for name in CLOTHS:
            with self.subTest(cloth=name):
                page, facts = self.page(SAMPLES / name), self.facts(SAMPLES / name)
                self.assertEqual(page.names, [yarn["name"] for yarn in facts["yarns"]])
                for k, yarn in enumerate(facts["yarns"]):
                    self.assertAlmostEqual(page.measures[k, 0] / yarn["length"], 1, delta=1e-6)
                    # Enclosed by the finest grid and flat ends: the divergence theorem on the page's own triangles.
                    six = 0.0
                    for tube in page.tubes(k, 0):
                        a, b = tube.points[:-1, :-1], tube.points[:-1, 1:]
                        d, c = tube.points[1:, :-1], tube.points[1:, 1:]
                        six += (a * np.cross(b, c)).sum() + (a * np.cross(c, d)).sum()
                        columns = tube.points.shape[1]
                        starts = tube.ends[: columns + 1] if len(tube.ends) else tube.ends
                        if len(tube.ends) == columns + 1 and not np.allclose(
                            tube.ends[:columns], tube.points[0], atol=1e-9
                        ):
                            starts = tube.ends[:0]
                        for rim, sign in ((starts, -1), (tube.ends[len(starts) :], 1)):
                            if len(rim):
                                six += sign * (rim[-1] * np.cross(rim[:-2], rim[1:-1])).sum()
                    self.assertAlmostEqual(six / 6 / yarn["volume"], 1, delta=0.02, msg=yarn["name"])

    def test_round_yarns_keep_their_radius_at_every_level(self):
        for name in ROUND:
            page, lines = self.page(SAMPLES / name), self.lines(SAMPLES / name)
            for k, yarn in list(enumerate(page.names))[:: max(1, len(page.names) // 3)]:
                line = lines[yarn]
                radius, shape = line[0, 3], page.shape(k)
                self.assertLess(np.ptp(line[:, 3]), 3e-3 * radius)
                for level, description in enumerate(shape["levels"]):
                    chord = description["chord"]
                    if description["tube"]:
                        points = np.vstack([tube.points.reshape(-1, 3) for tube in page.tubes(k, level)])[::7]
                        # Vertices stand on the surface: what is left is the grid of whole steps, and the tolerance.
                        miss = np.abs(distances(points, line[:, :3]) - radius)
                        self.assertLess(miss.max(), 2 * shape["step"] + 0.006 * radius, (name, yarn, level))
                        # Middles of edges along the yarn and round it are within the chord.
                        for tube in page.tubes(k, level):
                            p = tube.points
                            middles = np.vstack(
                                [((p[1:] + p[:-1]) / 2).reshape(-1, 3), ((p[:, 1:] + p[:, :-1]) / 2).reshape(-1, 3)]
                            )[::7]
                            depth = radius - distances(middles, line[:, :3])
                            self.assertLess(
                                depth.max(), 1.3 * chord + 2 * shape["step"] + 0.006 * radius, (name, yarn, level)
                            )
                            out = tube.points - tube.points.mean(axis=1, keepdims=True)
                            self.assertGreater((out * tube.normals).sum(axis=2).min(), 0)
                    else:
                        for points, across, up in page.ribbons(k, level):
                            self.assertLess(distances(points, line[:, :3]).max(), 1e-2 * radius)
                            for vector in (across, up):
                                self.assertLess(np.abs(np.linalg.norm(vector, axis=1) - radius).max(), 0.02 * radius)
                        # The other way: no point of the line is farther than the chord from the ribbon.
                        whole = np.vstack([points for points, _, _ in page.ribbons(k, level)])
                        self.assertLess(
                            distances(line[:, :3], whole).max(), 1.05 * chord + 1e-3 * radius, (name, yarn, level)
                        )

    def test_levels_end_where_the_yarn_does(self):
        page = self.page(SAMPLES / "jersey.txt")
        lines = self.lines(SAMPLES / "jersey.txt")
        for k, yarn in enumerate(page.names):
            for level in range(3, 6):
                parts = page.ribbons(k, level)
                self.assertLess(np.abs(parts[0][0][0] - lines[yarn][0, :3]).max(), 1e-4)
                self.assertLess(np.abs(parts[-1][0][-1] - lines[yarn][-1, :3]).max(), 1e-4)

    def test_a_long_yarn_is_cut_into_parts_that_meet(self):
        turns = [f"{0.02 * k} {0.3 * math.sin(0.11 * k):.6f} {0.3 * math.cos(0.07 * k):.6f}" for k in range(0, 8000, 4)]
        page = self.page(self.source(HEAD + rod("long", turns)))
        parts = len(page.shape(0)["boxes"])
        self.assertGreater(parts, 2)
        for level in range(3):
            tubes = page.tubes(0, level)
            self.assertEqual(len(tubes), parts)
            for one, next_one in zip(tubes, tubes[1:]):
                # To the bit: both are multiples of one step.
                self.assertTrue(np.array_equal(one.points[-1], next_one.points[0]))
            for tube, (low, high) in zip(tubes, page.shape(0)["boxes"]):
                flat = tube.points.reshape(-1, 3) - page.centre - page.motions[0][:, 3]
                self.assertGreater((flat - low).min(), -0.03 * 0.4)
                self.assertLess((flat - high).max(), 0.03 * 0.4)

    def test_an_analytic_cylinder(self):
        page = self.page(self.source(HEAD + rod("a", ["1e5 0 0", "100001 0 0", "100003 0 0"])))
        self.assertAlmostEqual(page.centre[0], 100001.5, delta=1)
        for level, description in enumerate(page.shape(0)["levels"][:3]):
            points = page.tubes(0, level)[0].points
            self.assertLess(np.abs(np.hypot(points[..., 1], points[..., 2]) - 0.2).max(), page.shape(0)["step"])
            angles = math.pi / (description["columns"] - 1)
            self.assertLess(0.2 * (1 - math.cos(angles)), 1.05 * description["chord"])

    def test_equal_yarns_are_one_shape(self):
        for name, shapes in (("jersey.txt", 1), ("braid.txt", 6), ("knit_rib_1x1.txt", 3)):
            page = self.page(SAMPLES / name)
            self.assertLessEqual(len(page.data["shapes"]), shapes, name)
            self.assertGreater(len(page.names), len(page.data["shapes"]))
            for motion in page.motions:  # rotations, no mirrors
                self.assertLess(np.abs(motion[:, :3] @ motion[:, :3].T - np.eye(3)).max(), 1e-6)
                self.assertAlmostEqual(np.linalg.det(motion[:, :3]), 1, delta=1e-6)

    def test_copies_stand_where_they_were_built(self):
        page, lines = self.page(SAMPLES / "braid.txt"), self.lines(SAMPLES / "braid.txt")
        for k, yarn in enumerate(page.names):
            points = np.vstack([points for points, _, _ in page.ribbons(k, 3)])
            self.assertLess(distances(points, lines[yarn][:, :3]).max(), 1e-3, yarn)

    def test_contacts_are_those_of_check(self):
        cross = (
            HEAD
            + rod("a", ["-2 0 0", "0 0 0", "2 0 0"])
            + rod("b", ["0 -2 0.35", "0 0 0.35", "0 2 0.35"])
            + rod("c", ["-1 -2 -0.41", "-1 0 -0.41", "-1 2 -0.41"])
        )
        source = self.source(cross)
        page = self.page(source, "--reach", 0.05)
        contacts = page.data["contacts"]
        self.assertEqual((contacts["overlap_count"], contacts["near_count"]), (1, 1))
        ((a, b, gap, x, y, z),) = contacts["overlaps"]
        self.assertEqual({page.names[a], page.names[b]}, {"a", "b"})
        self.assertAlmostEqual(gap, -0.05, delta=1e-3)
        self.assertLess(np.abs(np.array([x, y, z - 0.175])).max(), 1e-3)
        ((a, b, gap, x, y, z),) = contacts["near"]
        self.assertEqual({page.names[a], page.names[b]}, {"a", "c"})
        self.assertAlmostEqual(gap, 0.01, delta=1e-4)
        self.assertLess(np.abs(np.array([x + 1, y, z + 0.205])).max(), 1e-3)
        report = self.folder / "r.json"
        self.assertIn("overlap", self.fails(3, "check", source, "--report", report))
        (overlap,) = json.loads(report.read_text())["inputs"][0]["overlaps"]
        self.assertAlmostEqual(overlap["depth"], -contacts["overlaps"][0][2], delta=1e-9)
        page = self.page(source, "--contacts", "no")
        self.assertNotIn("contacts", page.data)
        self.assertIn("--contacts no", page.data["contacts_note"])

    def test_the_data_sheet_is_that_of_info(self):
        for name in ("weave_denim.txt", "jersey.txt", "warpknit_tricot.txt", "braid.txt"):
            self.assertEqual(self.page(SAMPLES / name).data["sheets"], self.facts(SAMPLES / name)["sheets"], name)
        self.assertIsNone(self.page(SAMPLES / "ring.txt").data["sheets"])


class Text(Base):
    """Names of others are data; nothing is asked of a network."""

    HOSTILE = '</script><script>alert(1)</script><b>&amp;"{{data}}<!--'

    def test_names_are_no_html(self):
        name = self.HOSTILE.replace('"', "'")
        source = self.source(
            HEAD.replace("units", f'title "{name}"\nunits') + rod(f'"{name}"', ["0 0 0", "1 0 0", "2 0 0.5"])
        )
        page, plain = self.page(source), self.page(
            self.source(HEAD + rod("a", ["0 0 0", "1 0 0", "2 0 0.5"]), "plain.txt")
        )
        self.assertEqual(Page(self.path).names, ["a"])
        self.assertEqual(page.names, [name])
        self.assertEqual(page.data["title"], name)
        self.assertEqual(page.elements.title, name)
        self.assertEqual([tag for tag, _ in page.elements.tags], [tag for tag, _ in plain.elements.tags])
        self.assertNotIn("alert(1)</script>", page.text)
        # No text of the page's own is made HTML of.
        for way in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write"):
            self.assertNotIn(
                way,
                "".join(
                    path.read_text() for path in (pathlib.Path(__file__).parents[2] / "src/view/page").glob("*.js")
                ),
            )

    def test_nothing_is_asked_of_a_network(self):
        page = self.page(SAMPLES / "plain4_path.txt")
        policy = next(a["content"] for tag, a in page.elements.tags if a.get("http-equiv") == "Content-Security-Policy")
        self.assertIn("default-src 'none'", policy)
        for tag, attributes in page.elements.tags:
            for key in ("src", "href", "action", "data", "poster", "srcset"):
                self.assertTrue(
                    attributes.get(key, "#").startswith(("#", "data:")), (tag, attributes.get(key, "")[:60])
                )
        own = "".join(
            path.read_text() for path in (pathlib.Path(__file__).parents[2] / "src/view/page").glob("*.[jch]*")
        )
        for word in ("fetch(", "XMLHttpRequest", "WebSocket", "@import", "url(", "sendBeacon", "EventSource"):
            self.assertNotIn(word, own)

    def test_pages_are_light(self):
        self.page(SAMPLES / "jersey.txt")
        self.assertLess(self.path.stat().st_size, 2_000_000)
        loops = "fabric 1\nthread y\n tex 30\n density 1.52\n packing 0.75\nend\nknit jersey\n thread y\n courses {0}\n wales {0}\nend\n"
        page = self.page(self.source(loops.format(300)))
        self.assertEqual(len(page.names), 300)
        self.assertEqual(len(page.data["shapes"]), 1)
        self.assertLess(self.path.stat().st_size, 20_000_000)
        # What is left out for its size is the finest; what is there is coarse to fine still.
        chords = [level["chord"] for level in page.data["shapes"][0]["levels"]]
        self.assertEqual(chords, sorted(chords))
        self.assertIn("--contacts yes", page.data["contacts_note"])

    def test_the_same_bytes_with_any_number_of_threads(self):
        for threads in (1, 2):
            self.succeeds("view", SAMPLES / "braid.txt", "-o", self.out / f"{threads}.html", "-j", threads)
        self.assertEqual(len(set(files_below(self.out).values())), 1)

    def test_a_picture_is_there_for_browsers_without_webgl(self):
        page = self.page(SAMPLES / "ring.txt")
        image = re.search(r'<noscript>.*?<img [^>]*src="data:image/png;base64,([^"]+)"', page.text, re.DOTALL)[1]
        self.assertEqual(base64.b64decode(image)[:8], b"\x89PNG\r\n\x1a\n")


class Files(Case):
    def test_names_of_outputs(self):
        source = SAMPLES / "ring.txt"
        self.assertIn(
            "names one file", self.fails(2, "view", source, SAMPLES / "jersey.txt", "-o", self.folder / "x.html")
        )
        self.assertIn(".png, .html", self.fails(2, "view", source, "-o", self.folder / "x.htm"))
        done = subprocess.run([PROGRAM, "view", source, "-o", "-"], capture_output=True, env=environment())
        self.assertEqual(done.stdout[:8], b"\x89PNG\r\n\x1a\n")
        self.assertIn(
            "no yarn to show", self.fails(1, "view", SAMPLES / "back_piece.txt", "-o", self.folder / "x.html")
        )
        self.assertEqual(files_below(self.folder), {})

    def test_without_the_library(self):
        # The program alone, beside nothing: it says what is missing, at once, and writes nothing.
        alone = self.folder / "bin"
        alone.mkdir()
        shutil.copy(PROGRAM, alone / "selvage")
        done = subprocess.run(
            [alone / "selvage", "view", SAMPLES / "ring.txt", "-o", self.out / "x.html"],
            capture_output=True,
            text=True,
            env=environment(),
        )
        self.assertEqual(done.returncode, 1)
        for word in ("three.js", "three.module.min.js", "scripts/setup", ".png"):
            self.assertIn(word, done.stderr)
        self.assertEqual(files_below(self.out) if self.out.exists() else {}, {})
        # Another file of that name is none.
        (alone / "three.module.min.js").write_text("export default 1")
        done = subprocess.run(
            [alone / "selvage", "view", SAMPLES / "ring.txt", "-o", self.out / "x.html"],
            capture_output=True,
            text=True,
            env=environment(),
        )
        self.assertEqual(done.returncode, 1)
        self.assertIn("not the three.js", done.stderr)

    @unittest.skipUnless(HAS_PAGES, NO_PAGES)
    def test_the_library_is_the_pinned_one(self):
        lock = (pathlib.Path(__file__).parents[2] / "scripts/three.lock").read_text()
        library = pathlib.Path(PROGRAM).parent / "three.module.min.js"
        self.assertEqual(re.search(r"sha256=(\w+)", lock)[1], hashlib.sha256(library.read_bytes()).hexdigest())


class Meshes(Base):
    def mesh(self):
        path = self.folder / "mesh.vtu"
        self.succeeds("mesh", SAMPLES / "plain4_path.txt", "-o", path)
        return path

    def assert_skin_of(self, page, read):
        """Every region is closed, and encloses what its tetrahedra fill."""
        points, triangles, region_of = page.skin()
        cells = read.cells_dict["tetra"]
        corners = read.points[cells]
        volumes = (
            np.einsum(
                "ij,ij->i",
                np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]),
                corners[:, 3] - corners[:, 0],
            )
            / 6
        )
        yarn_of = read.cell_data_dict["yarn"]["tetra"]
        for region, facts in enumerate(page.data["skin"]["regions"]):
            own = points[triangles[region_of == region]]
            enclosed = np.einsum("ij,ij->", own[:, 0], np.cross(own[:, 1], own[:, 2])) / 6
            members = yarn_of == region
            self.assertEqual(facts["elements"], members.sum())
            self.assertAlmostEqual(enclosed / volumes[members].sum(), 1, delta=1e-4)
        self.assertTrue((np.diff(region_of.astype(int)) >= 0).all())

    def test_a_mesh_of_our_own(self):
        source = self.mesh()
        page, read = self.page(source), meshio.read(source)
        self.assertEqual(
            [region["name"] for region in page.data["skin"]["regions"]], ["warp1", "warp2", "weft1", "weft2"]
        )
        self.assertEqual(page.data["skin"]["nodes"], len(read.points))
        self.assert_skin_of(page, read)
        angles = page.data["skin"]["histograms"][0]
        values = read.cell_data_dict["min_dihedral"]["tetra"]
        self.assertEqual(sum(angles["counts"]), len(values))
        self.assertAlmostEqual(angles["least"], values.min(), delta=1e-3)
        self.assertAlmostEqual(angles["mean"], values.mean(), delta=1e-3)
        expected, _ = np.histogram(np.clip(values, 0, 74.999), bins=30, range=(0, 75))
        self.assertLess(np.abs(expected - angles["counts"]).sum(), 0.01 * len(values))

    def test_other_forms_of_vtu(self):
        first = meshio.read(self.mesh())
        first.point_data = {
            "u": np.column_stack([first.points[:, 0], first.points[:, 1] ** 2, first.points[:, 2]]),
            "t": first.points[:, 2],
        }
        for form in ({"binary": False}, {"binary": True, "compression": None}, {"binary": True, "compression": "zlib"}):
            path = self.folder / "form.vtu"
            meshio.vtu.write(path, first, **form)
            page = self.page(path)
            self.assert_skin_of(page, first)
            points, _, _ = page.skin()
            self.assertLess(np.abs(page.field("t")[:, 0] - points[:, 2]).max(), 1e-5)
            self.assertLess(np.abs(page.field("u")[:, 1] - points[:, 1] ** 2).max(), 1e-5)

    def test_elements_of_every_shape(self):
        cube = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
        # VTK's wedge: its first triangle is seen counter-clockwise from outside.
        for kind, cell, volume in (
            ("tetra", [0, 1, 3, 4], 1 / 6),
            ("pyramid", [0, 1, 2, 3, 4], 1 / 3),
            ("wedge", [0, 3, 1, 4, 7, 5], 1 / 2),
            ("hexahedron", list(range(8)), 1),
            ("voxel", [0, 1, 3, 2, 4, 5, 7, 6], 1),
        ):
            path = self.folder / f"{kind}.vtu"
            types = {"voxel": 11, "hexahedron": 12, "wedge": 13, "pyramid": 14, "tetra": 10}
            numbers = lambda values: " ".join(map(str, np.ravel(values)))
            path.write_text(
                '<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece><Points><DataArray type="Float64" NumberOfComponents="3" '
                f'format="ascii">{numbers(cube)}</DataArray></Points><Cells><DataArray type="Int64" Name="connectivity" format="ascii">'
                f'{numbers(cell)}</DataArray><DataArray type="Int64" Name="offsets" format="ascii">{len(cell)}</DataArray>'
                f'<DataArray type="UInt8" Name="types" format="ascii">{types[kind]}</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>'
            )
            points, triangles, _ = self.page(path).skin()
            own = points[triangles]
            # Outward, and closed: the divergence theorem, from two origins.
            for origin in (0, 10):
                p = own - origin
                self.assertAlmostEqual(
                    np.einsum("ij,ij->", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6, volume, delta=1e-5, msg=kind
                )

    def test_appended_data(self):
        """As VTK appends them: a head and bytes of each array, behind an underscore."""
        points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], "<f8")
        arrays = [
            ("Points", points, "Float64", 3),
            ("connectivity", np.array([0, 1, 2, 3, 1, 2, 3, 4], "<i4"), "Int32", 1),
            ("offsets", np.array([4, 8], "<i4"), "Int32", 1),
            ("types", np.array([10, 10], "u1"), "UInt8", 1),
            ("material", np.array([7, 9], "<i4"), "Int32", 1),
        ]
        for encoding in ("raw", "base64"):
            blob, tags = b"", {}
            for name, values, kind, components in arrays:
                tags[
                    name
                ] = f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="appended" offset="{len(blob)}"/>'
                data = len(values.tobytes()).to_bytes(4, "little") + values.tobytes()
                blob += data if encoding == "raw" else base64.b64encode(data)
            text = (
                (
                    '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">\n<UnstructuredGrid>\n'
                    f'<Piece NumberOfPoints="5" NumberOfCells="2">\n<Points>{tags["Points"]}</Points>\n'
                    f'<Cells>{tags["connectivity"]}{tags["offsets"]}{tags["types"]}</Cells>\n<CellData>{tags["material"]}</CellData>\n</Piece>\n'
                    f'</UnstructuredGrid>\n<AppendedData encoding="{encoding}">\n_'
                ).encode()
                + blob
                + b"\n</AppendedData>\n</VTKFile>\n"
            )
            path = self.folder / "appended.vtu"
            path.write_bytes(text)
            page = self.page(path)
            self.assertEqual([region["name"] for region in page.data["skin"]["regions"]], ["material 7", "material 9"])
            self.assertEqual(page.data["skin"]["triangle_count"], 8)

    def test_faults_are_told_at_their_place(self):
        text = (
            '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">\n<UnstructuredGrid><Piece>\n<Points>\n'
            '<DataArray type="Float64" Name="Points" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>\n<Cells>\n'
            '<DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3</DataArray>\n'
            '<DataArray type="Int64" Name="offsets" format="ascii">4</DataArray>\n<DataArray type="UInt8" Name="types" format="ascii">10</DataArray>\n'
            "</Cells></Piece></UnstructuredGrid></VTKFile>\n"
        )
        self.page(self.source(text, "good.vtu"))
        for old, new, line, words in (
            ("0 1 2 3", "0 1 2 4", 6, "no point 4"),
            (">4<", ">9<", 7, "offset of cell 0"),
            ("0 0 0 1 0 0", "0 0 x 1 0 0", 4, "'x' is not"),
            (">10<", ">3<", 1, "no cell"),
            ('Name="offsets" format="ascii">4', 'Name="offsets" format="binary">AA', 7, "data end"),
            ('Grid" version', 'Grid" compressor="vtkLZ4DataCompressor" version', 1, "zlib"),
        ):
            bad = self.source(text.replace(old, new), "bad.vtu")
            message = self.fails(1, "view", bad, "-o", self.folder / "bad.html")
            self.assertRegex(message, rf"bad\.vtu:{line}:\d+: error: .*{words}")

    def test_results_of_calculix(self):
        """A bar of two cubes, pulled: what ccx says of it is in the page."""
        deck = self.folder / "bar.inp"
        nodes = [(x, y, z) for x in (0, 1, 2) for z in (0, 1) for y in (0, 1)]
        number = {node: k + 1 for k, node in enumerate(nodes)}
        cube = lambda x: [
            number[n]
            for n in (
                (x, 0, 0),
                (x + 1, 0, 0),
                (x + 1, 1, 0),
                (x, 1, 0),
                (x, 0, 1),
                (x + 1, 0, 1),
                (x + 1, 1, 1),
                (x, 1, 1),
            )
        ]
        deck.write_text(
            "*NODE, NSET=ALL\n"
            + "".join(f"{k}, {x}, {y}, {z}\n" for (x, y, z), k in number.items())
            + "*ELEMENT, TYPE=C3D8, ELSET=ONE\n"
            + f"1, {', '.join(map(str, cube(0)))}\n"
            + "*ELEMENT, TYPE=C3D8, ELSET=TWO\n"
            + f"2, {', '.join(map(str, cube(1)))}\n"
            + "*MATERIAL, NAME=GLASS\n*ELASTIC\n1000, 0\n*MATERIAL, NAME=RESIN\n*ELASTIC\n500, 0\n"
            "*SOLID SECTION, ELSET=ONE, MATERIAL=GLASS\n*SOLID SECTION, ELSET=TWO, MATERIAL=RESIN\n"
            "*STEP\n*STATIC\n*BOUNDARY\n"
            + "".join(f"{k}, 1, 3, 0\n" for (x, _, _), k in number.items() if x == 0)
            + "".join(f"{k}, 1, 1, 0.03\n" for (x, _, _), k in number.items() if x == 2)
            + "*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n"
        )
        subprocess.run(
            ["ccx", "-i", "bar"],
            cwd=self.folder,
            check=True,
            capture_output=True,
            env={**os.environ, "OMP_NUM_THREADS": "1"},
        )
        page = self.page(self.folder / "bar.frd")
        self.assertEqual([region["name"] for region in page.data["skin"]["regions"]], ["ONE", "TWO"])
        points, triangles, _ = page.skin()
        self.assertEqual(len(triangles), 24)
        moved = page.field("DISP")
        # Without Poisson's effect two springs in a row: the soft one takes two thirds.
        self.assertLess(np.abs(moved[:, 0] - np.interp(points[:, 0], [0, 1, 2], [0, 0.01, 0.03])).max(), 1e-6)
        stress = page.field("STRESS")
        self.assertEqual(stress.shape[1], 6)
        self.assertLess(np.abs(stress[:, 0] - 10).max(), 1e-3)
        self.assertLess(np.abs(stress[:, 1:]).max(), 1e-3)

    def test_faults_of_frd(self):
        text = (
            "    1C\n    1UUSER\n    2C                             4                                     1\n"
            + "".join(
                f" -1{k:10d}{x:12.5E}{y:12.5E}{z:12.5E}\n"
                for k, (x, y, z) in enumerate([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], 1)
            )
            + " -3\n    3C                             1                                     1\n -1         1    3    0    1\n"
            " -2         1         2         3         4\n -3\n 9999\n"
        )
        page = self.page(self.source(text, "good.frd"))
        self.assertEqual([region["name"] for region in page.data["skin"]["regions"]], ["material 1"])
        self.assertEqual(page.data["skin"]["triangle_count"], 4)
        for old, new, line, words in (
            ("3         4\n -3", "3         5\n -3", 11, "no node '5'"),
            ("1    3    0", "1   99    0", 10, "type"),
            ("1.00000E+00 0.00000E+00 0.00000E+00", "1.0x000E+00 0.00000E+00 0.00000E+00", 5, "finite"),
            ("   4                                     1", "   4                                     2", 3, "binary"),
        ):
            self.assertIn(old, text)
            bad = self.source(text.replace(old, new, 1), "bad.frd")
            self.assertRegex(
                self.fails(1, "view", bad, "-o", self.folder / "bad.html"), rf"bad\.frd:{line}:\d+: error: .*{words}"
            )


if __name__ == "__main__":
    unittest.main()
