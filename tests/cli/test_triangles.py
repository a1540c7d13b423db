"""Yarns as triangles: STL, OBJ, PLY and glTF, as readers of their own (tests/formats/triangles/reader.py), meshio and gmsh see them;
volumes beside those of the B-splines, and beside what is known in closed form."""

import json
import math
import shutil
import subprocess
import sys
import unittest

import meshio
import numpy as np

from program import PROGRAM, ROOT, SAMPLES, Case, files_below

sys.path.insert(0, str(ROOT / "tests/formats/triangles"))
import reader

RING = SAMPLES / "ring.txt"
# Paths and grids, ends of every style, rings, plies, knits.
CLOTHS = [
    SAMPLES / name
    for name in ("plain4_path.txt", "plain4_grid.txt", "ring.txt", "sections.txt", "ply2_plain.txt", "braid_tape.txt")
]
CYLINDER = """fabric 1
units {units}
tolerance 0.001
thread rod
  section circle {diameter}
  color 10 128 250
end
yarn rod rod
  path chord
{rows}
  end
  ends {ends}
end
"""


def cylinder(units="mm", diameter=0.4, at=0.0, ends="patch", length=3):
    rows = "\n".join(f"    {at + length * k / 4!r} {at!r} 0" for k in range(5))
    return CYLINDER.format(units=units, diameter=diameter, rows=rows, ends=ends)


class Triangles(Case):
    def source(self, text, name="cloth.txt"):
        path = self.folder / name
        path.write_text(text)
        return path

    def write(self, source, *options):
        """The meshes of each format, by its name; the messages."""
        done = self.succeeds("convert", source, "--to", "stl,obj,ply,gltf", "-o", f"{self.out}/", *options)
        stem = self.out / source.stem
        self.facets = reader.stl(f"{stem}.stl")[1]
        meshes = {
            "obj": reader.obj(f"{stem}.obj"),
            "ply": reader.ply(f"{stem}.ply")[0],
            "gltf": reader.gltf(f"{stem}.glb"),
        }
        return meshes, reader.stl(f"{stem}.stl")[0], done.stderr

    def yarns(self, source):
        return json.loads(self.succeeds("info", source, "--json").stdout)["inputs"][0]["yarns"]

    def test_every_yarn_is_closed_and_has_its_volume(self):
        # None: the input's own tolerance, where it does not give millions of triangles. Coarse ones lose more than 1e-3.
        fine = [4e-4, 4e-4, 1e-3, 4e-4, 2e-4, 1e-3]
        coarse = [None, 1e-3, 0.02, 5e-3, None, 0.01]
        for source, *chords in zip(CLOTHS, fine, coarse):
            facts = self.yarns(source)
            for chord in chords:
                with self.subTest(source=source.name, chord=chord):
                    meshes, soup, _ = self.write(source, *(["--chord", chord] if chord else []))
                    for name, yarns in meshes.items():
                        self.assertEqual([mesh.name for mesh in yarns], [yarn["name"] for yarn in facts], name)
                        for mesh, yarn in zip(yarns, facts):
                            self.assertEqual(mesh.bad_edges(), 0, (name, mesh.name))
                            self.assertGreater(mesh.areas().min(), 0, (name, mesh.name))
                            loss = 1 - mesh.volume() / yarn["volume"]
                            if chord == chords[0]:
                                self.assertLess(abs(loss), 1e-3, (name, mesh.name))
                            if chord:
                                self.assertLess(
                                    abs(loss) * yarn["volume"], chord * mesh.areas().sum(), (name, mesh.name)
                                )
                    # STL has no yarns: it is all of them.
                    self.assertEqual(soup.bad_edges(), 0)
                    self.assertGreater(soup.areas().min(), 0)
                    total = sum(mesh.volume() for mesh in meshes["gltf"])
                    self.assertAlmostEqual(soup.volume() / total, 1, delta=1e-6)

    def test_the_default_chord_is_a_hundredth_of_the_thinnest_section(self):
        """Without --chord as with it, and a small part of the bytes of the tubes' tolerance, a thousandth."""
        source = self.source(cylinder(diameter=0.4))
        for options, name in (((), "own"), (("--chord", 0.004), "same"), (("--chord", 0.0004), "fine")):
            self.succeeds("convert", source, *options, "-o", self.out / f"{name}.ply")
        own, same, fine = (reader.ply(self.out / f"{name}.ply")[0][0] for name in ("own", "same", "fine"))
        self.assertEqual((self.out / "own.ply").read_bytes(), (self.out / "same.ply").read_bytes())
        self.assertLess(own.areas().size, 0.5 * fine.areas().size)
        self.assertEqual(same.bad_edges(), 0)

    def test_all_formats_have_the_same_triangles(self):
        meshes, soup, _ = self.write(SAMPLES / "plain4_path.txt")
        self.assertEqual(len(meshes["obj"]), 4)
        self.assertGreater(len({mesh.color for mesh in meshes["obj"]}), 1)
        for own in zip(*meshes.values()):
            for other in own[1:]:
                self.assertEqual(own[0].color, other.color)
                self.assertTrue(np.array_equal(own[0].triangles, other.triangles))
        for text, doubles, floats in zip(meshes["obj"], meshes["ply"], meshes["gltf"]):
            self.assertTrue(np.array_equal(text.points, doubles.points))
            self.assertTrue(np.array_equal(text.points.astype(np.float32), floats.points))
        corners = np.vstack([mesh.corners() for mesh in meshes["gltf"]])
        self.assertTrue(np.array_equal(corners, self.facets["corners"]))
        # What STL says of its facets is what they are.
        a, b, c = np.moveaxis(corners.astype(float), 1, 0)
        normals = np.cross(b - a, c - a)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        self.assertLess(np.abs(normals - self.facets["normal"]).max(), 1e-6)

    def test_a_cylinder(self):
        radius, length = 0.2, 3
        exact = math.pi * radius**2 * length
        for ends in ("patch", "fan", "planar"):
            source = self.source(cylinder(ends=ends))
            losses = []
            for chord in (4e-3, 1e-3, 2.5e-4):
                meshes, soup, _ = self.write(source, "--chord", chord)
                for mesh in (soup, *(yarns[0] for yarns in meshes.values())):
                    self.assertEqual(mesh.bad_edges(), 0, ends)
                mesh = meshes["ply"][0]
                losses.append(1 - mesh.volume() / exact)
                # As the page says; a cylinder has no other loss.
                self.assertLess(abs(losses[-1]), 8 * chord / (3 * 2 * radius) + 1e-5)
                # Nowhere is the side farther from the cylinder than asked for: middles of triangles and edges.
                corners = mesh.corners()
                side = corners[np.ptp(corners[:, :, 0], axis=1) > 1e-9]
                a, b, c = np.moveaxis(side, 1, 0)
                for middle in ((a + b + c) / 3, (a + b) / 2, (b + c) / 2, (c + a) / 2):
                    depth = radius - np.hypot(middle[:, 1], middle[:, 2])
                    self.assertLess(depth.max(), chord + 1e-5)
                self.assertGreater(depth.max(), chord / 50)
            self.assertLess(losses[1], losses[0] / 2, ends)
            self.assertLess(losses[2], losses[1] / 2, ends)

    def test_a_torus(self):
        turns = [2 * math.pi * k / 48 for k in range(48)]
        rows = "".join(f"    {5 * math.cos(turn)!r} {5 * math.sin(turn)!r} 0\n" for turn in turns)
        source = self.source(
            "fabric 1\nunits mm\ntolerance 1e-4\nthread rod\n  diameter 1\nend\nyarn ring rod\n  closed\n"
            f"  path uniform\n{rows}  end\nend\n"
        )
        meshes, soup, _ = self.write(source, "--chord", 5e-4)
        exact = 2 * math.pi**2 * 5 * 0.5**2  # Pappus
        for mesh in (soup, *(yarns[0] for yarns in meshes.values())):
            self.assertEqual(mesh.bad_edges(), 0)
            self.assertAlmostEqual(mesh.volume() / exact, 1, delta=1e-3)
            # A closed surface with a hole.
            self.assertEqual(len(mesh.points) - 3 * len(mesh.triangles) // 2 + len(mesh.triangles), 0)

    def test_other_programs_read_them(self):
        source = SAMPLES / "plain4_path.txt"
        meshes, soup, _ = self.write(source)
        for name in ("stl", "obj", "ply"):
            mesh = meshio.read(self.out / f"plain4_path.{name}")
            triangles = np.vstack([block.data for block in mesh.cells])
            self.assertEqual(len(triangles), len(soup.triangles), name)
            volume = reader.Mesh("", mesh.points, triangles).volume()
            self.assertAlmostEqual(volume / soup.volume(), 1, delta=1e-6)
        gmsh = shutil.which("gmsh")
        done = subprocess.run(
            [gmsh, "plain4_path.stl", "-save", "-format", "msh22", "-o", "again.msh"],
            cwd=self.out,
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        again = meshio.read(self.out / "again.msh")
        self.assertEqual(len(again.cells_dict["triangle"]), len(soup.triangles))

    def test_stl_as_text(self):
        source = SAMPLES / "plain4_path.txt"
        meshes, soup, _ = self.write(source)
        self.succeeds("convert", source, "--to", "stl", "--stl-ascii", "-o", self.out / "text.stl")
        solids = reader.stl_text(self.out / "text.stl")
        self.assertEqual([mesh.name for mesh in solids], [mesh.name for mesh in meshes["gltf"]])
        for text, floats in zip(solids, meshes["gltf"]):
            self.assertTrue(np.array_equal(text.corners(), floats.corners()))
            self.assertEqual(text.bad_edges(), 0)
        self.assertIn("this is stl", self.fails(1, "info", self.out / "text.stl"))

    def test_gltf_in_its_three_forms(self):
        source = SAMPLES / "jersey.txt"
        chord = ["--chord", 0.01]
        self.succeeds("convert", source, *chord, "-o", self.out / "full.glb")
        self.succeeds("convert", source, *chord, "-o", self.out / "text.gltf")
        self.succeeds("convert", source, *chord, "--instances", "-o", self.out / "short.glb")
        full, text, short = (reader.gltf(self.out / name) for name in ("full.glb", "text.gltf", "short.glb"))
        document, data = reader.gltf_parts(self.out / "full.glb")
        other, same = reader.gltf_parts(self.out / "text.gltf")
        self.assertEqual(data, same)
        del document["buffers"], other["buffers"]
        self.assertEqual(document, other)
        document, data = reader.gltf_parts(self.out / "short.glb")
        self.assertLess(len(document["meshes"]), len(document["nodes"]) - 1)
        self.assertLess(len(data), len(same))
        self.assertEqual(len(full), len(short))
        for a, b, c in zip(full, text, short):
            self.assertEqual((a.name, a.color), (c.name, c.color))
            self.assertTrue(np.array_equal(a.points, b.points))
            self.assertEqual(c.bad_edges(), 0)
            self.assertAlmostEqual(c.volume() / a.volume(), 1, delta=1e-5)
            self.assertLess(np.abs(np.sort(a.points, axis=0) - np.sort(c.points, axis=0)).max(), 1e-5)

    def test_a_motion_that_turns(self):
        rows = [(0, 0, 0), (1, 0.2, 0.1), (2, -0.1, 0.3), (3, 0, 0)]
        text = "fabric 1\nunits mm\nthread t\n  section circle 0.3\nend\n"
        for name, turn in (
            ("first", lambda x, y, z: (x, y, z)),
            ("second", lambda x, y, z: (5 - y, x + 1, z + 2)),
            ("third", lambda x, y, z: (x, y, z + 4)),
        ):
            text += (
                f"yarn {name} t\n  path\n"
                + "".join("    {} {} {}\n".format(*turn(*row)) for row in rows)
                + "  end\nend\n"
            )
        source = self.source(text)
        self.succeeds("convert", source, "--instances", "-o", self.out / "short.glb")
        self.succeeds("convert", source, "-o", self.out / "full.glb")
        document, _ = reader.gltf_parts(self.out / "short.glb")
        self.assertEqual(len(document["meshes"]), 1)
        self.assertEqual(
            [sorted({"matrix", "translation"} & set(node)) for node in document["nodes"][1:]],
            [[], ["matrix"], ["translation"]],
        )
        for a, b in zip(reader.gltf(self.out / "full.glb"), reader.gltf(self.out / "short.glb")):
            self.assertAlmostEqual(b.volume() / a.volume(), 1, delta=1e-5)
            self.assertLess(np.abs(a.points.min(axis=0) - b.points.min(axis=0)).max(), 1e-4)
            self.assertLess(np.abs(a.points.max(axis=0) - b.points.max(axis=0)).max(), 1e-4)

    def test_gltf_is_in_metres_and_y_is_up(self):
        metres = {"mm": 1e-3, "inch": 0.0254, "um": 1e-6, "m": 1.0}
        for units, size in metres.items():
            source = self.source(cylinder(units=units, at=2.0))
            self.succeeds("convert", source, "-o", self.out / "a.glb")
            own, placed = reader.gltf(self.out / "a.glb")[0], reader.gltf(self.out / "a.glb", in_metres=True)[0]
            x, y, z = own.points.astype(float).T
            self.assertLess(np.abs(placed.points - size * np.stack([x, z, -y], axis=1)).max(), 1e-12 * size)
            self.assertGreater(placed.volume(), 0)
        self.succeeds("convert", source, "--units", "mm", "-o", self.out / "b.glb")
        again = reader.gltf(self.out / "b.glb", in_metres=True)[0]
        self.assertLess(np.abs(again.points - placed.points).max(), 1e-6)

    def test_the_chord_is_in_the_inputs_unit(self):
        source = self.source(cylinder())
        counts = []
        for units in ("mm", "m", "inch"):
            self.succeeds("convert", source, "--chord", 0.002, "--units", units, "-o", self.out / f"{units}.ply")
            counts.append(len(reader.ply(self.out / f"{units}.ply")[0][0].triangles))
        self.assertEqual(len(set(counts)), 1, counts)
        self.assertIn("--chord", self.fails(2, "convert", source, "--chord", 0, "--to", "ply", "-o", self.out))

    def test_khronos_validator(self):
        node = shutil.which("node")
        if (
            node is None
            or subprocess.run([node, "-e", "require('gltf-validator')"], capture_output=True).returncode != 0
        ):
            self.skipTest("gltf-validator is not installed (a package of Node.js; NODE_PATH tells where it is)")
        script = (
            "require('gltf-validator').validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[1])))"
            ".then(r => console.log(JSON.stringify(r.issues)))"
        )
        for options in ([], ["--instances"]):
            for name in ("a.glb", "a.gltf"):
                self.succeeds("convert", SAMPLES / "jersey.txt", "--chord", 0.01, *options, "-o", self.out / name)
                done = subprocess.run([node, "-e", script, self.out / name], capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
                issues = json.loads(done.stdout)
                self.assertEqual((issues["numErrors"], issues["numWarnings"]), (0, 0), issues)

    def test_far_from_the_origin(self):
        # Floats near 100000 are 1/128 apart, more than the tolerance 0.004.
        far = self.source(cylinder(at=100000.0), "far.txt")
        meshes, soup, messages = self.write(far)
        for name in ("STL", "glTF"):
            self.assertIn(
                f"warning: {name} has single precision: where yarn 'rod' is, neighbouring coordinates are 0.0078 mm apart, "
                "more than the tolerance 0.004",
                messages,
            )
        for mesh in (soup, meshes["gltf"][0]):
            self.assertEqual(mesh.unpaired(), 0)
            corners = mesh.corners()
            self.assertFalse(np.any(np.all(corners == np.roll(corners, 1, axis=1), axis=2)))
        exact = math.pi * 0.04 * 3
        for name in ("obj", "ply"):
            self.assertEqual(meshes[name][0].bad_edges(), 0)
            self.assertAlmostEqual(meshes[name][0].volume() / exact, 1, delta=1e-2)
        done = self.succeeds("convert", far, "--to", "obj,ply", "-o", self.folder / "exact/")
        self.assertNotIn("warning", done.stderr)
        done = self.succeeds("convert", self.source(cylinder(at=10.0)), "--to", "stl,gltf", "-o", self.folder / "near/")
        self.assertNotIn("warning", done.stderr)

    def test_names_of_every_kind(self):
        source = self.source(cylinder().replace("yarn rod rod", 'yarn "Kette 1\\ü, 50%" rod'))
        self.write(source)
        self.assertEqual(reader.gltf(self.out / "cloth.glb")[0].name, self.yarns(source)[0]["name"])
        self.assertEqual(
            reader.obj(self.out / "cloth.obj")[0].name,
            self.yarns(source)[0]["name"].replace(" ", "_").replace("\\", "_"),
        )

    def test_what_they_cannot_hold_is_said_first(self):
        parts = self.folder / "parts.igs"
        self.succeeds("convert", SAMPLES / "cell_plain.txt", "--cut", "-o", parts)
        lines = self.folder / "lines.igs"
        self.succeeds("convert", RING, "--lines", "-o", lines)
        for name in ("stl", "obj", "ply", "gltf"):
            words = self.fails(1, "convert", lines, "--to", name, "-o", f"{self.out}/")
            self.assertIn(
                f"error: {name} holds no free curves, and this input has 1 curve, such as 'ring': write iges", words
            )
            words = self.fails(1, "convert", parts, "--to", name, "-o", f"{self.out}/")
            self.assertRegex(
                words,
                f"error: {name} holds no free surfaces, and this input has \\d+ surfaces, such as '.*': write iges or step",
            )
            words = self.fails(1, "convert", SAMPLES / "cell_plain.txt", "--cut", "--to", name, "-o", f"{self.out}/")
            self.assertIn(f"{name} holds no solids, which --cut makes: write iges or step", words)
            words = self.fails(1, "convert", RING, "--lines", "--to", name, "-o", f"{self.out}/")
            self.assertIn(f"{name} holds no centre lines, which --lines makes: write ", words)
            words = self.fails(1, "convert", SAMPLES / "back_piece.txt", "--to", name, "-o", f"{self.out}/")
            self.assertIn(f"{name} holds no garment pieces", words)
        self.assertFalse(files_below(self.out))

    def test_none_of_them_is_read(self):
        self.write(RING, "--chord", 0.1)
        for path, name in (
            ("ring.stl", "stl"),
            ("ring.obj", "obj"),
            ("ring.mtl", "mtl"),
            ("ring.ply", "ply"),
            ("ring.glb", "gltf"),
        ):
            self.assertIn(f"this is {name} (", self.fails(1, "info", self.out / path))
        # By their first bytes, too.
        for path, name in (("ring.ply", "ply"), ("ring.glb", "gltf")):
            shutil.copy(self.out / path, self.folder / "unknown")
            self.assertIn(f"this is {name} (", self.fails(1, "info", self.folder / "unknown"))

    def test_materials_come_with_an_object_file(self):
        source = SAMPLES / "plain4_path.txt"
        report = self.folder / "report.json"
        self.succeeds("convert", source, "-o", self.out / "a b.obj", "--report", report)
        self.assertEqual(set(files_below(self.out)), {"a b.obj", "a b.mtl"})
        outputs = json.loads(report.read_text())["inputs"][0]["outputs"]
        self.assertEqual([output["format"] for output in outputs], ["obj", "mtl"])
        meshes = reader.obj(self.out / "a b.obj")
        self.assertEqual(outputs[1]["entities"], {"materials": len({mesh.color for mesh in meshes})})
        done = self.succeeds("convert", source, "--to", "obj", "-o", "-")
        self.assertNotIn("mtl", done.stdout)
        self.assertEqual(done.stdout.count("\no "), 4)
        self.assertIn("cannot write mtl", self.fails(2, "convert", source, "--to", "mtl", "-o", self.out))

    def test_same_input_same_bytes(self):
        runs = []
        for k, workers in enumerate((1, 2)):
            folder = self.folder / f"run{k}"
            self.succeeds(
                "convert", *CLOTHS[:3], "--chord", 0.002, "--to", "stl,obj,ply,gltf", "-j", workers, "-o", f"{folder}/"
            )
            runs.append(files_below(folder))
        self.assertEqual(len(runs[0]), 15)
        self.assertEqual(*runs)

    def test_memory_does_not_grow_with_the_cloth(self):
        peaks = []
        for count in (8, 40):
            source = self.source(
                f"fabric 1\nunits mm\ntolerance 0.002\nthread t\n  section ellipse 0.4 0.2\nend\nweave\n  warp t {count} pitch 1\n"
                f"  weft t {count} pitch 1\n  draft plain\nend\n"
            )
            words = ["convert", source, "--to", "stl,obj,ply,gltf", "-o", f"{self.out}/", "--chord", 0.002]
            script = (
                "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True, capture_output=True); "
                "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
            )
            done = subprocess.run(
                [sys.executable, "-c", script, PROGRAM, *map(str, words)], capture_output=True, text=True
            )
            self.assertEqual(done.returncode, 0, done.stderr)
            peaks.append((int(done.stdout) * 1024, (self.out / "cloth.glb").stat().st_size))
        (small, _), (large, size) = peaks
        self.assertLess(large - small, size / 4, peaks)


if __name__ == "__main__":
    unittest.main()
