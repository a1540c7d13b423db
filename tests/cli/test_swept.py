"""Dry yarns as swept hexahedra and as beams: shapes and volumes by a program of its own, bending in CalculiX against beam theory."""

import json
import math
import re
import subprocess
import unittest

import meshio
import numpy as np

from program import Case, PATH, RING, SAMPLES

CCX = "ccx"
YOUNG, POISSON, LENGTH = 5000.0, 0.3, 20.0
FORCE = 1e-4  # so small that CalculiX, which turns beams about knots, is linear

# Straight along x, with any section.
STRAIGHT = """fabric 1
title "cantilever"
material m
  density 1
  {elastic}
end
thread t
  tex 100
  density 1
  section {section}
  material m
end
yarn y t
  path
    0 0 0
    10 0 0
    20 0 0
  end
end
"""
ISOTROPIC = f"elastic isotropic {YOUNG} {POISSON}"


def box(width, height):
    x, y = width / 2, height / 2
    return f"polygon\n    {-x} {-y}\n    {x} {-y}\n    {x} {y}\n    {-x} {y}\n  end"


# Corners of a hexahedron and a wedge, each with the ends of its edges, right-handed.
HEXAHEDRON = np.array(
    [(0, 1, 3, 4), (1, 2, 0, 5), (2, 3, 1, 6), (3, 0, 2, 7), (4, 7, 5, 0), (5, 4, 6, 1), (6, 5, 7, 2), (7, 6, 4, 3)]
)
WEDGE = np.array([(0, 1, 2, 3), (1, 2, 0, 4), (2, 0, 1, 5), (3, 5, 4, 0), (4, 3, 5, 1), (5, 4, 3, 2)])
# Sides, counter-clockwise seen from outside.
SIDES = {
    "hexahedron": [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
    "wedge": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
}


def shape_functions(kind, at):
    """Their derivatives by the three natural coordinates, a row a node."""
    if kind == "hexahedron":
        signs = np.array(
            [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)]
        )
        f = (1 + signs * at) / 2
        return np.stack([signs[:, k] / 2 * f[:, (k + 1) % 3] * f[:, (k + 2) % 3] for k in range(3)], axis=1)
    r, s, t = at
    triangle, slope = np.array([1 - r - s, r, s]), np.array([(-1, -1), (1, 0), (0, 1)])
    low, high = (1 - t) / 2, (1 + t) / 2
    return np.vstack([np.column_stack([slope * low, -triangle / 2]), np.column_stack([slope * high, triangle / 2])])


def gauss_points(kind):
    g = 1 / math.sqrt(3)
    if kind == "hexahedron":
        return [np.array((x, y, z)) for x in (-g, g) for y in (-g, g) for z in (-g, g)], np.ones(8)
    return [np.array((*p, z)) for p in ((1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)) for z in (-g, g)], np.full(
        6, 1 / 6
    )


def determinants(kind, places):
    """At the Gauss points of each element, with the volume of each."""
    points, weights = gauss_points(kind)
    found = np.array([np.linalg.det(np.einsum("enk,nj->ekj", places, shape_functions(kind, at))) for at in points])
    return found, weights @ found


def corner_products(kind, places):
    table = HEXAHEDRON if kind == "hexahedron" else WEDGE
    edges = [places[:, table[:, k]] - places[:, table[:, 0]] for k in (1, 2, 3)]
    return np.einsum("eci,eci->ec", np.cross(edges[0], edges[1]), edges[2])


def is_conforming(mesh):
    """Does every side belong to two elements, or stand on the outside, where every edge belongs to two sides?"""
    sides = {}
    for block in mesh.cells:
        for element in block.data if block.type in SIDES else []:
            for side in SIDES[block.type]:
                sides.setdefault(tuple(sorted(element[list(side)])), []).append(element[list(side)])
    edges = {}
    for found in sides.values():
        if len(found) > 2:
            return False
        if len(found) == 1:
            for a, b in zip(found[0], np.roll(found[0], -1)):
                edges[(a, b)] = edges.get((a, b), 0) + 1
    return all(edges.get((b, a)) == count == 1 for (a, b), count in edges.items())


def second_moment(outline):
    """About the axis along y through the centroid, of a polygon in the yz plane."""
    y, z = outline[:, 0], outline[:, 1]
    y2, z2 = np.roll(y, -1), np.roll(z, -1)
    cross = y * z2 - y2 * z
    area = cross.sum() / 2
    middle = (cross * (z + z2)).sum() / (6 * area)
    return abs((cross * (z * z + z * z2 + z2 * z2)).sum() / 12 - area * middle**2)


def solved(folder, name, what="DISP"):
    """Runs CalculiX on NAME.inp; the displacements (FORC: forces) of the last step, by node."""
    run = subprocess.run([CCX, name], cwd=folder, capture_output=True, text=True, timeout=300)
    if "Job finished" not in run.stdout:
        raise AssertionError(run.stdout[-2000:] + run.stderr)
    found, inside = {}, False
    for line in (folder / f"{name}.frd").read_text().splitlines():
        if line.startswith(f" -4  {what}"):
            inside, found = True, {}
        elif inside and line.startswith(" -1"):
            found[int(line[3:13])] = [float(line[13 + 12 * k : 25 + 12 * k]) for k in range(3)]
        elif line.startswith(" -3"):
            inside = False
    return found


def with_step(deck, step):
    """The deck with another step in place of its own."""
    return deck[: deck.index("*STEP")] + step


def set_of(deck, name):
    found = re.search(rf"\*NSET, NSET={name}\n([\d, \n]+)", deck)
    return [int(n) for n in re.findall(r"\d+", found.group(1))]


def lens_moment(width, height):
    """Of two arcs, about the long axis, by the midpoint rule."""
    radius = (width**2 / 4 + height**2 / 4) / height
    x = (np.arange(20000) + 0.5) / 20000 * width - width / 2
    half = np.sqrt(radius**2 - x**2) - (radius - height / 2)
    return (2 / 3 * half**3).mean() * width


class Meshes(Case):
    def mesh(self, source, *options, to="vtu"):
        report = self.folder / "report.json"
        output = self.folder / f"mesh.{to}"
        self.succeeds("mesh", source, "-o", output, "--report", report, *options)
        return output, json.loads(report.read_text())["inputs"][0]

    def straight(self, section, elastic=ISOTROPIC):
        path = self.folder / "straight.txt"
        path.write_text(STRAIGHT.format(section=section, elastic=elastic))
        return path


class Swept(Meshes):
    def check(self, source, *options):
        """Jacobians, volumes and neighbours, from the VTU; the report's figures of the same."""
        output, report = self.mesh(source, "--elements", "hex", *options)
        mesh = meshio.read(output)
        volumes, counts = {}, {"hexahedron": 0, "wedge": 0}
        for block, yarns in zip(mesh.cells, mesh.cell_data["yarn"]):
            places = mesh.points[block.data]
            at_points, volume = determinants(block.type, places)
            self.assertGreater(at_points.min(), 0, source)
            self.assertGreater(corner_products(block.type, places).min(), 0, source)
            counts[block.type] += len(block.data)
            for yarn in np.unique(yarns):
                volumes[yarn] = volumes.get(yarn, 0) + volume[np.asarray(yarns).ravel() == yarn].sum()
        self.assertTrue(is_conforming(mesh), source)
        facts = report["mesh"]
        self.assertEqual(facts["hexahedra"], counts["hexahedron"])
        self.assertEqual(facts.get("wedges", 0), counts["wedge"])
        self.assertGreater(facts["min_scaled_jacobian"], 0)
        for k, yarn in enumerate(report["yarns"]):
            self.assertLess(abs(volumes[k] / yarn["volume"] - 1), 0.005, f"{source}: {yarn['name']}")
            self.assertAlmostEqual(volumes[k] / facts["regions"][k]["volume"], 1, delta=1e-9)
        return mesh, facts

    def test_all_kinds_of_cloths(self):
        for name in (
            "plain4_grid",
            "plain4_path",
            "ring",
            "twill_cell",
            "cell_orthogonal",
            "jersey",
            "warpknit_tricot",
            "cabled",
            "braid_hercules",
            "braid_tape",
            "filaments7",
            "sections",
            "pressed_yarn",
        ):
            with self.subTest(name):
                self.check(SAMPLES / f"{name}.txt")

    def test_sections(self):
        for section, has_wedges in (
            ("circle 1", False),
            (box(2, 0.5), False),
            ("lenticular 2 0.3", True),
            ("ellipse 3 0.5", False),
        ):
            with self.subTest(section):
                mesh, facts = self.check(self.straight(section))
                self.assertEqual("wedges" in facts, has_wedges)
                # As coarse as straightness allows: eight sizes, of a third of the thickness.
                self.assertLess(len(np.unique(mesh.points[:, 0].round(9))), 60)

    def test_it_follows_size_and_bends(self):
        coarse = self.check(PATH)[1]["hexahedra"]
        self.assertGreater(self.check(PATH, "--size", "0.03")[1]["hexahedra"], 4 * coarse)

    def test_formats_agree(self):
        source = self.straight("lenticular 2 0.3")
        whole = self.mesh(source, "--elements", "hex")[1]["mesh"]
        for to, kinds in (
            ("msh", ("hexahedron", "wedge")),
            ("inp", ("hexahedron", "wedge")),
            ("bdf", ("hexahedron", "wedge")),
        ):
            output, report = self.mesh(source, "--elements", "hex", to=to)
            mesh = meshio.read(output)
            total = 0
            for block in mesh.cells:
                if block.type in kinds:
                    total += determinants(block.type, mesh.points[block.data])[1].sum()
            self.assertAlmostEqual(total / whole["volume"], 1, delta=1e-9, msg=to)
        entities = self.mesh(source, "--elements", "hex", to="unv")[1]["outputs"][0]["entities"]
        self.assertEqual(entities["elements"], whole["hexahedra"] + whole["wedges"])
        text = self.mesh(source, "--elements", "hex", to="k")[0].read_text()
        solids = re.findall(r"^ {1,7}\d+ {1,7}\d+((?: {1,7}\d+){8})$", text[text.index("*ELEMENT_SOLID") :], re.M)
        wedges = [n for n in map(str.split, solids) if n[4] == n[5] and n[6] == n[7]]
        self.assertEqual((len(solids), len(wedges)), (whole["hexahedra"] + whole["wedges"], whole["wedges"]))
        text = self.mesh(source, "--elements", "hex", to="cdb")[0].read_text()
        self.assertIn("ET,1,185\n", text)

    def test_end_faces_have_their_nodes(self):
        output, _ = self.mesh(self.straight("lenticular 2 0.3"), "--elements", "hex", to="inp")
        deck, mesh = output.read_text(), meshio.read(output)
        for name, x in (("y_Start", 0), ("y_End", LENGTH)):
            np.testing.assert_allclose(mesh.points[np.array(set_of(deck, name)) - 1, 0], x, atol=1e-12)
            self.assertEqual(len(set_of(deck, name)), np.count_nonzero(np.abs(mesh.points[:, 0] - x) < 1e-9))

    def test_own_deck_runs(self):
        output, _ = self.mesh(PATH, "--elements", "hex", to="inp")
        found = np.array(list(solved(self.folder, output.stem).values()))
        self.assertTrue(np.isfinite(found).all())
        self.assertGreater(np.abs(found).max(), 1e-4)

    def bending_stiffness(self, section, brick):
        """Moment by curvature, of a yarn whose ends turn and are free to contract."""
        output, _ = self.mesh(self.straight(section), "--elements", "hex", "--brick", brick, to="inp")
        deck, points = output.read_text(), meshio.read(output).points
        start, end = (np.array(set_of(deck, name)) for name in ("y_Start", "y_End"))
        angle = 1e-4
        anchor = start[np.argmin(np.hypot(*points[start - 1, 1:].T))]
        aside = start[np.argmax(points[start - 1, 1])]
        step = "*STEP\n*STATIC\n*BOUNDARY\ny_Start, 1, 1\n" + f"{anchor}, 2, 3\n{aside}, 3, 3\n"
        step += "".join(f"{n}, 1, 1, {angle * points[n - 1, 2]:.9e}\n" for n in end)
        (self.folder / "bend.inp").write_text(with_step(deck, step + "*NODE FILE\nU, RF\n*END STEP\n"))
        forces = solved(self.folder, "bend", "FORC")
        return sum(forces[n][0] * points[n - 1, 2] for n in end) / (angle / LENGTH)

    def test_bending(self):
        for section, moment in (
            (box(1, 1), 1 / 12),
            ("circle 1", math.pi / 64),
            ("ellipse 3 0.5", math.pi / 64 * 3 * 0.5**3),
            ("lenticular 2 0.3", lens_moment(2, 0.3)),
        ):
            with self.subTest(section):
                self.assertLess(abs(self.bending_stiffness(section, "C3D8I") / (YOUNG * moment) - 1), 0.02)

    def test_refusals(self):
        cell = SAMPLES / "cell_plain.txt"
        for options, words in (
            (["--elements", "hex", "--matrix"], "--matrix"),
            (["--elements", "beam", "--voxel", "8"], "--voxel"),
            (["--elements", "hex", "--order", "2"], "--order 2"),
            (["--elements", "hex", "--min-dihedral", "15"], "--min-dihedral"),
            (["--elements", "beam", "--to", "vtu"], "--to inp"),
            (["--elements", "beam", "--split-deck"], "--split-deck"),
        ):
            with self.subTest(options):
                self.assertIn(words, self.fails(2, "mesh", cell, "-o", f"{self.folder}/x/", *options))


class Beams(Meshes):
    def beams(self, source, *options, to="inp"):
        output, report = self.mesh(source, "--elements", "beam", *options, to=to)
        return output, report["mesh"]

    def test_constants_of_sections(self):
        a, b = 1.5, 0.25
        ellipse = self.beams(self.straight("ellipse 3 0.5"))[1]["sections"][0]
        self.assertEqual(ellipse["shape"], "ellipse")
        for key, wanted in (
            ("area", math.pi * a * b),
            ("i11", math.pi / 4 * a * b**3),
            ("i22", math.pi / 4 * a**3 * b),
            ("torsion", math.pi * (a * b) ** 3 / (a * a + b * b)),
        ):
            self.assertLess(abs(ellipse[key] / wanted - 1), 0.005, key)
        rectangle = self.beams(self.straight(box(2, 1)))[1]["sections"][0]
        self.assertEqual(rectangle["shape"], "rectangle")
        # Saint-Venant's series for twice as wide as high.
        series = 1 / 3 - 64 / math.pi**5 * sum(math.tanh(n * math.pi) / n**5 for n in range(1, 40, 2)) / 2
        for key, wanted in (("area", 2), ("i11", 2 / 12), ("i22", 8 / 12), ("torsion", 2 * series)):
            self.assertLess(abs(rectangle[key] / wanted - 1), 0.01, key)
        lens = self.beams(self.straight("lenticular 2 0.3"))[1]["sections"][0]
        self.assertEqual(lens["shape"], "general")
        self.assertLess(abs(lens["i11"] / lens_moment(2, 0.3) - 1), 0.002)

    def test_cantilever(self):
        """Of a material that does not contract sideways: CalculiX's beams are solids, which a clamp would hold from that."""
        for section, moment in (
            ("circle 1", math.pi / 64),
            ("ellipse 2 0.5", math.pi / 64 * 2 * 0.5**3),
            (box(2, 0.5), 2 * 0.5**3 / 12),
        ):
            with self.subTest(section):
                output, _ = self.beams(self.straight(section, f"elastic isotropic {YOUNG} 0"), "--solver", "calculix")
                deck = output.read_text()
                held, pulled = set_of(deck, "y_Start")[0], set_of(deck, "y_End")[0]
                step = f"*STEP\n*STATIC\n*BOUNDARY\n{held}, 1, 6\n*CLOAD\n{pulled}, 3, {FORCE:.9e}\n*NODE FILE, OUTPUT=2D\nU\n*END STEP\n"
                (self.folder / "bend.inp").write_text(with_step(deck, step))
                found = solved(self.folder, "bend")[pulled][2]
                self.assertLess(abs(found / (FORCE * LENGTH**3 / (3 * YOUNG * moment)) - 1), 0.01)

    def test_trusses(self):
        """A straight chain whose nodes only move along it is a bar; areas times lengths are the yarns' volumes, in all decks."""
        output, _ = self.mesh(self.straight("ellipse 2 0.5"), "--elements", "truss", to="inp")
        deck = output.read_text()
        held, pulled = set_of(deck, "y_Start")[0], set_of(deck, "y_End")[0]
        step = (
            f"*STEP\n*STATIC\n*BOUNDARY\nAllNodes, 2, 3\n{held}, 1\n*CLOAD\n{pulled}, 1, {FORCE:.9e}\n"
            "*NODE FILE, OUTPUT=2D\nU\n*END STEP\n"
        )
        (self.folder / "pull.inp").write_text(deck + step)
        found = solved(self.folder, "pull")[pulled][0]
        self.assertLess(abs(found / (FORCE * LENGTH / (YOUNG * math.pi * 0.25)) - 1), 0.005)
        output, report = self.mesh(RING, "--elements", "truss", to="inp")
        mesh = meshio.read(output)
        (lines,) = (block.data for block in mesh.cells if block.type == "line")
        length = np.linalg.norm(np.diff(mesh.points[lines], axis=1), axis=-1).sum()
        areas = {
            "inp": r"\*SOLID SECTION.*\n(\S+)",
            "cdb": r"SECTYPE,\d+,LINK\nSECDATA,(\S+)",
            "k": r"\*SECTION_BEAM\n *\d+ +3\n *([\d.e+-]+)",
        }
        for to, pattern in areas.items():
            (area,) = map(float, re.findall(pattern, self.mesh(RING, "--elements", "truss", to=to)[0].read_text()))
            (region,) = report["mesh"]["regions"]
            self.assertAlmostEqual(area * length / region["volume"], 1, delta=1e-4, msg=to)

    def test_deck_of_a_cloth_runs(self):
        output, facts = self.beams(PATH, "--solver", "calculix")
        self.assertGreater(len(solved(self.folder, output.stem)), facts["nodes"])

    def test_contact_pairs(self):
        """Every warp of a plain weave meets every weft; no two of a system meet."""
        for to, mark in (
            ("inp", r"\*\* pair: (\S+), (\S+): (\S+), (\d+)"),
            ("cdb", r"! pair: (\S+), (\S+): (\S+), (\d+)"),
            ("k", r"\$ pair: (\S+), (\S+): (\S+), (\d+)"),
        ):
            output, facts = self.beams(PATH, to=to)
            pairs = {frozenset(m[:2]) for m in re.findall(mark, output.read_text())}
            self.assertEqual(pairs, {frozenset((f"warp{i}", f"weft{j}")) for i in (1, 2) for j in (1, 2)}, to)
            self.assertEqual({frozenset((c["a"], c["b"])) for c in facts["contact_pairs"]}, pairs)
        # The gap is that which `check` finds.
        report = self.folder / "check.json"
        self.succeeds("check", PATH, "--report", report)
        least = json.loads(report.read_text())["inputs"][0]["min_gap"]
        self.assertAlmostEqual(min(c["gap"] for c in facts["contact_pairs"]), least, delta=1e-9)

    def test_chains_follow_their_yarns(self):
        """Nodes of a ring are on its circle, and its chain is closed; volumes are those of the yarns to the chord's shortness."""
        output, facts = self.beams(RING)
        mesh = meshio.read(output)
        (lines,) = (block.data for block in mesh.cells)
        self.assertEqual(sorted(lines[:, 0]), sorted(lines[:, 1]))
        np.testing.assert_allclose(np.hypot(*mesh.points[:, :2].T), 5, rtol=5e-3)
        (region,) = facts["regions"]
        self.assertLess(abs(region["volume"] / region["exact_volume"] - 1), 0.02)

    def test_varying_sections_are_stations(self):
        text = (
            STRAIGHT.format(section="ellipse 1 0.5", elastic=ISOTROPIC)
            .replace("    20 0 0", "    20 0 0  2 1")
            .replace("    0 0 0", "    0 0 0  1 0.5")
        )
        source = self.folder / "cone.txt"
        source.write_text(text)
        run = self.succeeds("mesh", source, "--elements", "beam", "-o", self.folder / "cone.inp")
        self.assertIn("the section varies", run.stdout + run.stderr)
        _, facts = self.beams(source)
        self.assertGreater(facts["regions"][0]["sections"], 4)

    def test_transverse_material_is_general(self):
        source = self.straight("circle 1", "elastic transverse 70000 8000 0.3 3000 0.4")
        deck = self.beams(source)[0].read_text()
        numbers = deck[deck.index("*BEAM GENERAL SECTION") :].splitlines()
        self.assertEqual([float(x) for x in numbers[3].split(",")], [70000, 3000])
        area, i11, i12, i22, torsion = (float(x) for x in numbers[1].split(","))
        self.assertLess(abs(torsion / (math.pi / 32) - 1), 0.005)
        self.assertLess(abs(i11 / (math.pi / 64) - 1), 0.002)


if __name__ == "__main__":
    unittest.main()
