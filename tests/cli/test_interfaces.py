"""`mesh --matrix --interface surfaces | cohesive`: nodes, wedges, faces and equations of six cells by a program of its own
(interfaces.py), the stiffness of the whole against the bonded cell's, and a laminate against its closed form."""

import base64
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest
import zlib

import numpy as np

import interfaces
from program import Case, SAMPLES

SCRIPTS = pathlib.Path(__file__).parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))
import cell_deck
import cell_elements

CELLS = {  # coarse: what is judged here does not depend on the size
    "cell_plain": ("--segments", "8", "--matrix-size", "0.5"),
    "thick_plain": ("--size", "0.4", "--matrix-size", "0.6"),
    "thick_twill": ("--size", "0.4", "--matrix-size", "0.6"),
    "cell_straight": ("--size", "0.2"),
    "crossed": ("--size", "0.25"),
    "cell_fibre": (),
    "cell_jersey": ("--segments", "8", "--matrix-size", "0.5"),
    "cell_tricot": ("--segments", "8", "--matrix-size", "0.5"),  # bars go on as others over the faces
}
# SELVAGE_CELL: names of these, or of samples, for studies by hand.
NAMES = os.environ.get("SELVAGE_CELL", " ".join(CELLS)).split()

WEAVE = """fabric 1
units mm
tolerance 0.001
material tow
  elastic transverse 51500 17500 0.26 5800 0.31
end
material epoxy
  elastic isotropic 3400 0.35
end
thread roving
  section ellipse 0.9 0.5
  material tow
end
weave
  warp roving {count} pitch 1.3
  weft roving {count} pitch 1.3
  draft {draft}
end
cell repeat
  margin 0.1
  matrix epoxy
  periodic x y
end
"""

CROSSED = """fabric 1
units mm
tolerance 0.001
material tow
  elastic transverse 51500 17500 0.26 5800 0.31
end
material epoxy
  elastic isotropic 3400 0.35
end
thread roving
  section ellipse 0.7 0.4
  material tow
end
yarn along roving
  path
    -0.5 0.5 0.3
    1.5 0.5 0.3
  end
end
yarn across roving
  path
    0.5 -0.5 0.8
    0.5 1.5 0.8
  end
end
cell 0 0 0  1 1 1.1
  matrix epoxy
  periodic x y z
end
"""

TEXTS = {
    "thick_plain": WEAVE.format(count=2, draft="plain"),
    "thick_twill": WEAVE.format(count=3, draft="twill 2/1"),
    "crossed": CROSSED,
}

LAMINATE = """fabric 1
units mm
tolerance 1e-5
material ply
  elastic isotropic 5000 0.3
{ply}end
material resin
  elastic isotropic 3000 0.2
{resin}end
thread slab
  section polygon
    -2 -0.25
    2 -0.25
    2 0.25
    -2 0.25
  end
  material ply
end
yarn ply slab
  path
    -1 0.5 0.5
    2 0.5 0.5
  end
end
cell 0 0 0  1 1 1
  matrix resin
  periodic x y z
end
"""


def block(**values):
    rows = "".join(f"    {word} {normal!r} {shear!r}\n" for word, (normal, shear) in values.items())
    return f"  interface\n{rows}  end\n" if rows else ""


def confined(modulus, poisson):
    """Stress along an axis by the strain along it, nothing moving across."""
    return modulus * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))


def across_faces(deck, faces, axes):
    """For each axis: (place on the high face, region there) -> (place opposite, region there), by the triangles of both faces: a
    yarn may go on as another one."""
    low, high = deck.cell
    opposite = []
    for axis in axes:
        on = {False: {}, True: {}}  # places of a triangle's corners on the low face -> its region
        for name, own in faces.items():
            for (corners, _, _, _), *more in own.values():
                for is_high, plane in ((False, low[axis]), (True, high[axis])):
                    if not more and all(deck.nodes[n][axis] == plane for n in corners):
                        key = frozenset((*deck.at[n][:axis], *deck.at[n][axis + 1 :]) for n in corners)
                        on[is_high][key] = name
        assert on[False].keys() == on[True].keys() and on[True]
        pairs = {}
        for key, name in on[True].items():
            for flat in key:
                above, below = ((*flat[:axis], round(plane, 9), *flat[axis:]) for plane in (high[axis], low[axis]))
                assert pairs.setdefault((above, name), (below, on[False][key])) == (below, on[False][key])
        opposite.append(pairs)
    return opposite


class Interfaces(Case):
    def mesh(self, text, *options, to="inp"):
        source = text
        if isinstance(text, str):
            source = self.folder / "cell.txt"
            source.write_text(text)
        out = self.folder / f"{source.stem}{len(list(self.folder.iterdir()))}.{to}"
        self.succeeds("mesh", source, "--matrix", "--periodic", *options, "-o", out, "--quiet")
        return out

    def deck(self, text, *options):
        return interfaces.Deck(self.mesh(text, *options))

    def homogenized(self, deck, *options):
        result = self.folder / "result.json"
        done = subprocess.run(
            [SCRIPTS / "homogenize", deck, "--json", result, *options], capture_output=True, text=True, check=False
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return json.loads(result.read_text())


class Cells(Interfaces):
    """Of six cells: what an independent reader finds."""

    def mesh_of(self, name, interface):
        text = TEXTS.get(name) or SAMPLES / f"{name}.txt"
        return self.mesh(text, "--interface", interface, "--order", "1", *CELLS.get(name, ()))

    def judge_nodes(self, deck):
        """One node a region at each place: no more, no fewer."""
        region_of = deck.region_of_nodes()
        at = {}
        for node, region in region_of.items():
            at.setdefault(deck.at[node], []).append(region)
        for point, regions in at.items():
            self.assertEqual(len(regions), len(set(regions)), f"two nodes of a region at {point}")
        self.assertTrue(any(len(regions) == 2 for regions in at.values()))
        return region_of, at

    def judge_wedges(self, deck, region_of, faces):
        """A wedge on every face between two regions, and its normal from the first to the second."""
        between = {}  # corner places -> regions whose outer face is there
        for name, own in faces.items():
            for found in own.values():
                if len(found) == 1:
                    between.setdefault(tuple(sorted(deck.at[n] for n in found[0][0])), []).append(name)
        wanted = {corners for corners, names in between.items() if len(names) == 2}
        seen = set()
        for number, nodes in deck.wedges.items():
            first, second = nodes[:3], nodes[3:]
            for a, b in zip(first, second):
                self.assertNotEqual(a, b)
                self.assertEqual(deck.nodes[a].tolist(), deck.nodes[b].tolist())
            regions = {region_of[n] for n in first}, {region_of[n] for n in second}
            self.assertEqual([len(names) for names in regions], [1, 1])
            (one,), (other,) = regions
            self.assertNotEqual(one, other)
            self.assertNotEqual(one, "Matrix", number)
            p = [deck.nodes[n] for n in first]
            normal = np.cross(p[1] - p[0], p[2] - p[0])
            for name, side, sign in ((one, first, -1), (other, second, 1)):
                ((_, opposite, _, _),) = faces[name][tuple(sorted(side))]
                self.assertGreater(sign * normal @ (deck.nodes[opposite] - p[0]), 0)
            seen.add(tuple(sorted(deck.at[n] for n in first)))
        self.assertEqual(len(seen), len(deck.wedges))
        self.assertEqual(seen, wanted)

    def judge_faces(self, deck, region_of, axes, opposite):
        """Nodes stand opposite nodes of the same yarn or matrix, and sets are in the same order."""
        low, high = deck.cell
        for axis, pairs in zip(axes, opposite):
            period = np.zeros(3)
            period[axis] = high[axis] - low[axis]
            below, above = (
                {(deck.at[n], region) for n, region in region_of.items() if deck.nodes[n][axis] == plane}
                for plane in (low[axis], high[axis])
            )
            self.assertEqual(set(pairs), above)
            self.assertEqual(set(pairs.values()), below)
            face_high, face_low = deck.sets["Face" + "ACE"[axis]], deck.sets["Face" + "BDF"[axis]]
            self.assertEqual(len(face_high), len(face_low))
            for a, b in zip(face_high, face_low):
                self.assertEqual(pairs[deck.at[a], region_of[a]], (deck.at[b], region_of[b]))
                np.testing.assert_allclose(deck.nodes[a] - deck.nodes[b], period, atol=1e-9)
        on_box = {n for n in region_of if (deck.nodes[n] == low).any() or (deck.nodes[n] == high).any()}
        in_sets = [n for name, own in deck.sets.items() if re.match("Face|Edge|Corner", name) for n in own]
        self.assertEqual(len(in_sets), len(set(in_sets)))
        self.assertEqual(set(in_sets), on_box)

    def judge_equations(self, deck, region_of, axes, opposite):
        """Every node of a high side depends on that of its yarn on the low sides, in all directions, by the drivers alone."""
        low, high = deck.cell
        drivers = deck.drivers()
        kind = "plate" if len(axes) == 2 else "block"
        number = {(deck.at[n], region): n for n, region in region_of.items()}
        found = {}
        for first, *others in deck.equations:
            self.assertNotIn((first[0], first[1]), found)
            found[first[0], first[1]] = others
            self.assertEqual(first[2], 1)
        dependent = {node for node, _ in found}
        for node, region in region_of.items():
            p, here = deck.nodes[node].copy(), (deck.at[node], region)
            for axis, pairs in zip(axes, opposite):
                if p[axis] == high[axis]:
                    p[axis] = low[axis]
                    here = pairs[here]
            if here == (deck.at[node], region):
                self.assertNotIn(node, dependent)
                continue
            master = number[here]
            way = interfaces.modes(deck.nodes[node], deck.cell, kind) - interfaces.modes(p, deck.cell, kind)
            for direction in range(3):
                others = found.pop((node, direction))
                self.assertEqual([t for t in others if t[0] not in drivers], [(master, direction, -1.0)])
                given = np.zeros(len(drivers))
                for n, d, factor in others:
                    if n in drivers:
                        self.assertEqual(d, 0)
                        given[drivers.index(n)] = -factor
                self.assertLess(np.abs(given - way[direction]).max(), 1e-9)
        self.assertEqual(found, {})

    def test_cohesive(self):
        for name in NAMES:
            with self.subTest(cell=name):
                deck, bonded = (interfaces.Deck(self.mesh_of(name, one)) for one in ("cohesive", "bonded"))
                # Nodes at one place taken for one, it is the bonded mesh.
                index = {at: n for n, at in bonded.at.items()}
                for number, nodes in bonded.solids.items():
                    self.assertEqual(nodes, [index[deck.at[n]] for n in deck.solids[number]])
                region_of, at = self.judge_nodes(deck)
                faces = {own: interfaces.faces_of(deck, numbers) for own, numbers in deck.regions.items()}
                self.judge_wedges(deck, region_of, faces)
                axes = [0, 1] if any("Curvature" in one for one in deck.sets) else [0, 1, 2]
                opposite = across_faces(deck, faces, axes)
                self.judge_faces(deck, region_of, axes, opposite)
                self.judge_equations(deck, region_of, axes, opposite)
                self.assertEqual(sum(len(r) for r in at.values()) - len(at), len(deck.nodes) - len(bonded.nodes))
                print(
                    f"{name}: {len(deck.solids)} tetrahedra, {len(deck.wedges)} wedges, "
                    f"{len(deck.nodes) - len(bonded.nodes)} nodes doubled"
                )

    def test_the_console_counts_them(self):
        for interface, words in (
            ("cohesive", "{} cohesive elements in 1 interface"),
            ("surfaces", "1 interface of surfaces that face each other, {} triangles on either side"),
        ):
            out = self.folder / f"{interface}.inp"
            done = self.succeeds(
                *("mesh", SAMPLES / "cell_fibre.txt", "--matrix", "--periodic", "--order", "1"),
                *("--interface", interface, "-o", out),
            )
            if interface == "cohesive":  # the first: the surfaces have as many triangles
                count = len(interfaces.Deck(out).wedges)
            self.assertIn(words.format(count), done.stdout + done.stderr)

    def test_bonded_yarns(self):
        """With --bond yarns hold on to each other, too; where three regions meet there are three nodes."""
        deck = self.deck(SAMPLES / "cell_plain.txt", "--interface", "cohesive", "--bond", "--size", "0.15")
        region_of, at = self.judge_nodes(deck)
        self.judge_wedges(deck, region_of, {own: interfaces.faces_of(deck, n) for own, n in deck.regions.items()})
        self.assertTrue(any(len(regions) == 3 for regions in at.values()))
        between = {frozenset((region_of[n[0]], region_of[n[3]])) for n in deck.wedges.values()}
        self.assertTrue(any("Matrix" not in pair for pair in between))
        self.assertTrue(any(re.fullmatch(r".*_Cohesive\d+", name) for name in deck.layers))

    def test_stiffness(self):
        """By default as stiff as the bonded cell, to a thousandth: both put together as scripts/homogenize does it, which
        would refuse plates of such coarse elements."""
        for name in NAMES:
            if name in ("cell_plain", "thick_twill"):  # as thick_plain, and take two times as long
                continue
            with self.subTest(cell=name):
                found = []
                for interface in ("bonded", "cohesive"):
                    deck = cell_deck.Deck(self.mesh_of(name, interface))
                    found.append(cell_elements.Cell(deck, deck.drivers(), deck.matrices()).stiffness()[0])
                bonded, cohesive = found
                scale = np.sqrt(np.outer(np.diag(bonded), np.diag(bonded)))
                print(f"{name}: stiffness differs by {np.abs((cohesive - bonded) / scale).max():.2e}")
                self.assertLess(np.abs((cohesive - bonded) / scale).max(), 1e-3)
                # What yields makes nothing stiffer.
                self.assertGreater(np.linalg.eigvalsh((bonded - cohesive) / scale).min(), -1e-5)


class Laws(Interfaces):
    """What is known in closed form."""

    def laminate(self, ply="", resin="", *options):
        return self.deck(
            LAMINATE.format(ply=ply, resin=resin), "--interface", "cohesive", "--order", "1", "--size", "0.4", *options
        )

    def test_laminate(self):
        """Two half blocks, pulled apart and sheared: each interface opens by traction over stiffness, everywhere."""
        across, along = 2e4, 5e3
        deck = self.laminate(resin=block(stiffness=(across, along)))
        solved = interfaces.Solved(deck)
        ply, resin = confined(5000, 0.3), confined(3000, 0.2)
        shear = 1 / (0.5 / (5000 / 2.6) + 0.5 / (3000 / 2.4) + 2 / along)
        stiffness = solved.stiffness / np.prod(deck.cell[1] - deck.cell[0])
        for driver, direction, wanted, spring in (
            (2, 2, 1 / (0.5 / ply + 0.5 / resin + 2 / across), across),
            (4, 0, shear, along),
            (5, 1, shear, along),
        ):
            self.assertAlmostEqual(stiffness[driver, driver] / wanted, 1, delta=1e-9)
            for first_second in (nodes for nodes in deck.wedges.values()):
                for a, b in zip(first_second[:3], first_second[3:]):
                    jump = solved.moved[3 * b : 3 * b + 3, driver] - solved.moved[3 * a : 3 * a + 3, driver]
                    up = 1 if deck.nodes[a][2] > 0.5 else -1
                    expected = np.zeros(3)
                    expected[direction] = up * wanted / spring
                    np.testing.assert_allclose(jump, expected, atol=1e-9 * wanted / spring + 1e-12)

    def test_own_assembly_agrees(self):
        """scripts/homogenize and this test's factorization, of soft and of default interfaces."""
        for resin in ("", block(stiffness=(3e4, 1e4))):
            path = self.mesh(LAMINATE.format(ply="", resin=resin), "--interface", "cohesive", "--size", "0.4")
            theirs = np.array(self.homogenized(path)["stiffness"])
            ours = interfaces.Solved(interfaces.Deck(path)).stiffness
            np.testing.assert_allclose(theirs, ours, atol=1e-5 * ours.max())

    def test_softer_and_softer(self):
        """The softer the interfaces, the softer the whole, in every direction."""
        text = (SAMPLES / "cell_straight.txt").read_text()
        before = None
        for stiffness in (None, 1e6, 1e5, 1e4, 1e3, 1e2):
            given = block(stiffness=(stiffness, stiffness / 2)) if stiffness else ""
            own = text.replace("  elastic isotropic 3400 0.35\n", "  elastic isotropic 3400 0.35\n" + given)
            solved = interfaces.Solved(self.deck(own, "--interface", "cohesive", "--size", "0.25")).stiffness
            if before is not None:
                self.assertGreater(np.linalg.eigvalsh(before - solved).min(), -1e-9 * before.max())
                for k in range(1, 6):  # along the tow the interface carries nothing
                    self.assertLess(solved[k, k], before[k, k])
            before = solved

    def test_weaker_one_holds(self):
        deck = self.laminate(
            block(stiffness=(1e5, 2e4), strength=(30, 50), energy=(0.2, 0.9)),
            block(stiffness=(2e5, 1e4), strength=(40, 45), energy=(0.3, 0.8)),
        )
        law = deck.materials["ply_resin"]
        self.assertEqual(law["traction"], [1e5, 1e4, 1e4])
        self.assertEqual(law["damage initiation"], [30, 45, 45])
        self.assertEqual(law["damage evolution"], [0.2, 0.8, 0.8])

    def test_energy_below_what_is_elastic(self):
        source = self.folder / "cell.txt"
        source.write_text(
            LAMINATE.format(ply="", resin=block(stiffness=(1e3, 1e3), strength=(40, 40), energy=(0.2, 0.9)))
        )
        said = self.fails(
            1, "mesh", source, "--matrix", "--periodic", "--interface", "cohesive", "-o", self.out / "a.inp"
        )
        self.assertIn("takes 0.8 N/mm elastically up to its normal strength", said)
        self.assertIn("cell.txt:7", said)


class Surfaces(Interfaces):
    """`--interface surfaces`."""

    def test_sides_face_each_other(self):
        deck = self.deck(SAMPLES / "cell_straight.txt", "--interface", "surfaces", "--size", "0.25", "--order", "1")
        region_of = deck.region_of_nodes()
        side, facing = deck.surfaces["tow_Side"], deck.surfaces["tow_Facing"]

        def triangles(rows):
            nodes = [[deck.solids[int(e)][i] for i in interfaces.TETRAHEDRON_FACES[int(s[1:]) - 1]] for e, s in rows]
            return {tuple(sorted(deck.at[n] for n in face)) for face in nodes}, {region_of[n] for f in nodes for n in f}

        own, of_tow = triangles(side)
        others, of_matrix = triangles(facing)
        self.assertEqual((of_tow, of_matrix), ({"tow"}, {"Matrix"}))
        self.assertEqual(own, others)
        tied = set(deck.sets["tow_Tied"])
        dependent = {first[0] for first, *_ in deck.equations}
        on_side = {
            n for e, s in side for n in [deck.solids[int(e)][i] for i in interfaces.TETRAHEDRON_FACES[int(s[1:]) - 1]]
        }
        self.assertEqual(tied, on_side - dependent)
        self.assertEqual(deck.ties, [["tow_Tied", "tow_Facing"]])

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed")
    def test_tied_is_bonded(self):
        """CalculiX ties what was parted: the bonded cell's stiffness, of both orders; and so does scripts/homogenize."""
        for order in ("1", "2"):
            found = []
            for interface, solver in (("bonded", "direct"), ("surfaces", "direct"), ("surfaces", "iterative")):
                path = self.mesh(
                    SAMPLES / "cell_straight.txt", "--interface", interface, "--order", order, "--size", "0.3"
                )
                found.append(np.array(self.homogenized(path, "--solver", solver)["stiffness"]))
            for other in found[1:]:
                np.testing.assert_allclose(other, found[0], atol=2e-5 * found[0].max())

    def test_bonded_yarns_are_tied_once(self):
        deck = self.deck(
            SAMPLES / "cell_plain.txt", "--interface", "surfaces", "--bond", "--size", "0.15", "--order", "1"
        )
        tied = [n for name, own in deck.sets.items() if "_Tied" in name for n in own]
        self.assertEqual(len(tied), len(set(tied)))


class OtherFormats(Interfaces):
    def everything(self, *options):
        self.succeeds(
            "mesh", SAMPLES / "cell_straight.txt", "--matrix", "--periodic", "--size", "0.25", *options, "-o", self.out
        )
        deck = self.out / "cell_straight.inp"
        return interfaces.Deck(deck) if deck.exists() else None

    def test_wedges_everywhere(self):
        """The same wedges in all formats, each in its way."""
        deck = self.everything("--interface", "cohesive", "--to", "inp,cdb,k,msh,vtu")
        wanted = [nodes for _, nodes in sorted(deck.wedges.items())]
        self.assertEqual(self.of_cdb(), [[*w[:3], w[2], *w[3:], w[5]] for w in wanted])
        text = (self.out / "cell_straight.k").read_text()
        solids = re.search(r"\*ELEMENT_SOLID\n((?: .*\n)+)\*(?!ELEMENT_SOLID)", text)[1].splitlines()[-len(wanted) :]
        self.assertEqual(
            [[int(row[k : k + 8]) for k in range(16, 80, 8)] for row in solids],
            [[*w[:3], w[2], *w[3:], w[5]] for w in wanted],
        )
        self.assertRegex(text, r"\*SECTION_SOLID\n +2 +21\n\*PART\ntow_Cohesive\n +3 +2 +3\n")
        self.assertIn("*MAT_COHESIVE_ELASTIC_TITLE\ntow_epoxy\n", text)
        import meshio

        for ending in ("msh", "vtu"):  # meshio numbers Gmsh's nodes anew
            mesh = meshio.read(self.out / f"cell_straight.{ending}")
            wedges = np.concatenate([block.data for block in mesh.cells if block.type == "wedge"])
            np.testing.assert_array_equal(mesh.points[wedges], [[deck.nodes[n] for n in nodes] for nodes in wanted])
            solids = [block.data for block in mesh.cells if block.type == "tetra"]
            tow, matrix = solids if ending == "msh" else np.split(solids[0], [len(deck.regions["tow"])])
            self.assertTrue(np.isin(wedges[:, :3], tow).all() and np.isin(wedges[:, 3:], matrix).all())

    def of_cdb(self, nodes=8):
        rows = (self.out / "cell_straight.cdb").read_text().split("(19i10)\n")[1].split("        -1\n")[0].splitlines()
        found, k = [], 0
        while k < len(rows):
            numbers = [int(rows[k][i : i + 10]) for i in range(0, len(rows[k]), 10)]
            k += 1
            if numbers[8] > len(numbers) - 11:
                numbers += [int(rows[k][i : i + 10]) for i in range(0, len(rows[k]), 10)]
                k += 1
            if numbers[1] == 3:
                self.assertEqual(numbers[8], nodes)
                found.append(numbers[11:])
        return found

    def of_vtu(self):
        """Points, and by VTK's types the cells: meshio knows no wedge of twelve nodes."""
        text = (self.out / "cell_straight.vtu").read_text()

        def array(name, kind):
            code = re.search(rf'Name="{name}"[^>]*>\n(.*)\n', text)[1].strip()
            count = int(np.frombuffer(base64.b64decode(code[:32])[:8], "<u8")[0])
            head = -(-8 * (3 + count) // 3) * 4
            sizes = np.frombuffer(base64.b64decode(code[:head]), "<u8")[3:]
            data, parts, k = base64.b64decode(code[head:]), b"", 0
            for size in map(int, sizes):
                parts += zlib.decompress(data[k : k + size])
                k += size
            return np.frombuffer(parts, kind)

        nodes, ends, types = array("connectivity", "<i8"), array("offsets", "<i8"), array("types", "u1")
        cells = {}
        for begin, end, kind in zip([0, *ends[:-1]], ends, types):
            cells.setdefault(int(kind), []).append(nodes[begin:end].tolist())
        return array("Points", "<f8").reshape(-1, 3), cells

    def test_second_order(self):
        """INTER204 and VTK's wedges of twelve nodes: midside nodes are in the middle of their edges, on their own side."""
        self.everything("--interface", "cohesive", "--order", "2", "--to", "cdb,vtu")
        points, cells = self.of_vtu()
        wedges = np.array(cells[31])
        inter = np.array(self.of_cdb(16)) - 1
        np.testing.assert_array_equal(inter[:, [0, 1, 2, 4, 5, 6, 8, 9, 11, 12, 13, 15]], wedges)
        for same in ((2, 3, 10), (6, 7, 14)):
            self.assertTrue((inter[:, same] == inter[:, [same[0]]]).all())
        p = points[wedges]
        np.testing.assert_array_equal(p[:, :3], p[:, 3:6])
        np.testing.assert_array_equal(p[:, 6:9], p[:, 9:12])
        solids = {
            frozenset((row[a], row[b])): row[4 + m]
            for row in cells[24]
            for m, (a, b) in enumerate([(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)])
        }
        for w in wedges:
            for k, (a, b) in enumerate([(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3)]):
                self.assertEqual(solids[frozenset((w[a], w[b]))], w[6 + k])

    def test_surfaces_everywhere(self):
        deck = self.everything("--interface", "surfaces", "--order", "1", "--to", "inp,cdb,k,msh,vtu")
        count = len(deck.surfaces["tow_Side"])
        text = (self.out / "cell_straight.k").read_text()
        for name in ("tow_Side", "tow_Facing"):
            self.assertEqual(
                len(re.search(rf"\*SET_SEGMENT_TITLE\n{name}\n.*\n((?: .*\n)+)", text)[1].splitlines()), count
            )
        self.assertIn("*CONTACT_TIED_SURFACE_TO_SURFACE_OFFSET_ID\n         1tow_Tied\n         1         2", text)
        archive = (self.out / "cell_straight.cdb").read_text()
        for line in (
            "ET,3,170",
            "ET,4,174",
            "KEYOPT,4,12,5",
            "CMBLOCK,tow_Side,NODE",
            "CMSEL,S,tow_Facing,NODE",
            "ESURF",
        ):
            self.assertIn(line, archive)
        import meshio

        mesh = meshio.read(self.out / "cell_straight.msh")
        for name in ("tow_side", "matrix_tow"):
            self.assertEqual(sum(len(rows) for rows in mesh.cell_sets[name] if rows is not None and len(rows)), count)
        mesh = meshio.read(self.out / "cell_straight.vtu")
        yarns = np.concatenate(
            [rows for block, rows in zip(mesh.cells, mesh.cell_data["yarn"]) if block.type == "triangle"]
        )
        self.assertEqual(sorted(yarns.tolist()), [-1] * count + [0] * count)

    def test_strength_everywhere(self):
        source = self.folder / "cell_straight.txt"
        given = block(stiffness=(1e5, 5e4), strength=(40, 60), energy=(0.2, 0.8))
        source.write_text((SAMPLES / "cell_straight.txt").read_text().replace("0.35\n", "0.35\n" + given, 1))
        self.succeeds(
            "mesh",
            source,
            "--matrix",
            "--periodic",
            "--size",
            "0.3",
            "--interface",
            "cohesive",
            "--to",
            "cdb,k",
            "-o",
            self.out,
        )
        constants = re.search(r"TB,CZM,3,1,,BILI\nTBDATA,1,(.*)", (self.out / "cell_straight.cdb").read_text())[1]
        most, parted, shear, shear_parted, share, weight = map(float, constants.split(","))
        np.testing.assert_allclose(
            [most, most * parted / 2, shear, shear * shear_parted / 2, weight], [40, 0.2, 60, 0.8, 1]
        )
        self.assertGreaterEqual(most / (share * parted), 1e5 * (1 - 1e-12))
        self.assertGreaterEqual(shear / (share * shear_parted), 5e4 * (1 - 1e-12))
        card = re.search(
            r"\*MAT_COHESIVE_MIXED_MODE_TITLE\n.*\n(.*)\n(.*)\n", (self.out / "cell_straight.k").read_text()
        )
        self.assertEqual([float(word) for word in card[1].split()][3:], [1, 1e5, 5e4, 0.2, 0.8])
        self.assertEqual([float(word) for word in card[2].split()], [1, 40, 60])

    def test_what_cannot_be(self):
        cell, out = SAMPLES / "cell_straight.txt", self.out / "a.inp"
        for words, said in (
            (
                ("--matrix", "--interface", "cohesive", "--order", "2"),
                "inp has no elements for --interface cohesive --order 2",
            ),
            (("--matrix", "--interface", "cohesive", "--to", "bdf"), "bdf has no elements for --interface cohesive"),
            (("--matrix", "--interface", "surfaces", "--to", "unv"), "unv has no elements for --interface surfaces"),
            (("--matrix", "--interface", "cohesive", "--voxel", "8"), "--interface"),
            (("--cut", "--interface", "cohesive"), "yarns that only keep a gap hold nothing: it goes with --matrix"),
            (("--matrix", "--interface", "cohesive", "--physics", "conduction"), "is of elastic materials"),
            (("--matrix", "--interface", "welded"), "bonded, surfaces or cohesive"),
        ):
            with self.subTest(words=words):
                target = self.out / "a.bdf" if "bdf" in words else self.out / "a.unv" if "unv" in words else out
                self.assertIn(said, self.fails(2, "mesh", cell, *words, "-o", target))
        said = self.fails(1, "mesh", cell, "--matrix", "--bond", "--interface", "cohesive", "--size", "0.3", "-o", out)
        self.assertIn("no yarns are bonded", said)
        self.assertIn("leave out --bond", said)


if __name__ == "__main__":
    unittest.main()
