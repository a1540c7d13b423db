"""Explicit decks, read by programs of their own: what is named is there, keywords are of a list, frames are hinged, plates stand off,
and the stable increment is what numpy makes of the mesh. Neither solver is here to run them."""

import json
import math
import unittest

import numpy as np

from program import Case, SAMPLES

YOUNG, POISSON, DENSITY = 5000.0, 0.3, 2.5e-9  # N, mm, t

# Two yarns along x under two along y, half a millimetre apart.
CROSSED = """fabric 1
title "crossed yarns"
material m
  {density}
  elastic isotropic 5000 0.3
end
thread t
  tex 100
  density 1
  section polygon
    -0.5 -0.5
    0.5 -0.5
    0.5 0.5
    -0.5 0.5
  end
  material m
end
""" + "".join(
    f"yarn {name} t\n  path\n{points}  end\nend\n"
    for name, points in (
        ("x1", "    -10 -3 0\n    0 -3 0\n    10 -3 0\n"),
        ("x2", "    -10 3 0\n    0 3 0\n    10 3 0\n"),
        ("y1", "    -3 -8 1.5\n    -3 0 1.5\n    -3 8 1.5\n"),
        ("y2", "    3 -8 1.5\n    3 0 1.5\n    3 8 1.5\n"),
    )
)

# A weave turned by 45 degrees, and a box inside it, longer along x.
BIAS = """fabric 1
material m
  density 2.5
  elastic transverse 70000 8000 0.3 3000 0.4
end
thread tow
  section ellipse 1.1 0.3
  material m
end
block cloth
weave
  warp tow 6 pitch 1.5
  weft tow 6 pitch 1.5
  draft plain
  profile sine
end
end
use cloth
  rotate {turn}
end
cell {cell}
end
"""

# Keywords of Abaqus/Explicit, with the parameters that are used of them.
ABAQUS = {
    "HEADING": "",
    "NODE": "NSET",
    "NSET": "NSET GENERATE",
    "ELEMENT": "TYPE ELSET",
    "ELSET": "ELSET",
    "SURFACE": "NAME TYPE",
    "DISTRIBUTION TABLE": "NAME",
    "DISTRIBUTION": "NAME LOCATION TABLE",
    "ORIENTATION": "NAME SYSTEM",
    "MATERIAL": "NAME",
    "ELASTIC": "TYPE",
    "DENSITY": "",
    "EXPANSION": "TYPE",
    "SECTION CONTROLS": "NAME HOURGLASS",
    "SOLID SECTION": "ELSET MATERIAL ORIENTATION CONTROLS",
    "BEAM SECTION": "SECTION ELSET MATERIAL",
    "BEAM GENERAL SECTION": "SECTION ELSET DENSITY",
    "RIGID BODY": "REF NODE|ELSET|TIE NSET",
    "AMPLITUDE": "NAME|TIME|DEFINITION|SMOOTH",
    "SURFACE INTERACTION": "NAME",
    "FRICTION": "",
    "STEP": "NLGEOM",
    "DYNAMIC": "EXPLICIT",
    "CONTACT": "",
    "CONTACT INCLUSIONS": "ALL EXTERIOR",
    "CONTACT PROPERTY ASSIGNMENT": "",
    "SURFACE PROPERTY ASSIGNMENT": "PROPERTY",
    "BOUNDARY": "TYPE AMPLITUDE",
    "OUTPUT": "FIELD|HISTORY|NUMBER INTERVAL|TIME INTERVAL",
    "NODE OUTPUT": "NSET",
    "ELEMENT OUTPUT": "",
    "ENERGY OUTPUT": "",
    "END STEP": "",
}
# Elements that Abaqus/Explicit has: C3D10 is none of them.
ELEMENTS = {"C3D4", "C3D6", "C3D8R", "C3D10M", "B31", "T3D2", "R3D4"}
# Keywords of LS-DYNA.
DYNA = set(
    """KEYWORD TITLE NODE PART PART_CONTACT SECTION_SOLID SECTION_SHELL SECTION_BEAM CONTROL_SOLID ELEMENT_SOLID ELEMENT_SOLID_ORTHO
ELEMENT_SHELL ELEMENT_BEAM ELEMENT_BEAM_ORIENTATION MAT_ELASTIC_TITLE MAT_ORTHOTROPIC_ELASTIC_TITLE MAT_RIGID_TITLE SET_PART_LIST_TITLE SET_NODE_LIST_TITLE
CONTROL_TERMINATION CONTROL_TIMESTEP CONTROL_ENERGY CONTROL_ACCURACY CONTROL_HOURGLASS DEFINE_CURVE_TITLE
CONSTRAINED_NODAL_RIGID_BODY_INERTIA BOUNDARY_PRESCRIBED_MOTION_RIGID CONTACT_AUTOMATIC_SINGLE_SURFACE CONTACT_AUTOMATIC_GENERAL
DATABASE_GLSTAT DATABASE_MATSUM DATABASE_BNDOUT DATABASE_RBDOUT DATABASE_SLEOUT DATABASE_BINARY_D3PLOT END""".split()
)


def blocks_of(deck):
    """(keyword, parameters, rows of data) of each card of an Abaqus deck; flags have the value None."""
    blocks = []
    for line in deck.splitlines():
        if line.lstrip().startswith("**"):
            continue
        if line.lstrip().startswith("*"):
            words = [word.strip() for word in line.strip()[1:].split(",")]
            parameters = dict((word.split("=") + [None])[:2] for word in words[1:])
            blocks.append((words[0], parameters, []))
        else:
            blocks[-1][2].append(
                [field.strip() for field in line.rstrip(",").split(",")]
                if not line.startswith(",")
                else line.split(",")
            )
    return blocks


class Abaqus:
    def __init__(self, deck):
        self.blocks = blocks_of(deck)
        self.nodes, self.sets, self.elements, self.elsets = {}, {}, {}, {}
        for word, parameters, rows in self.blocks:
            if word == "NODE":
                self.nodes.update({int(r[0]): np.array(r[1:4], float) for r in rows})
            elif word == "NSET" and "GENERATE" in parameters:
                self.sets[parameters["NSET"]] = list(range(int(rows[0][0]), int(rows[0][1]) + 1))
            elif word == "NSET":
                fields = [f for r in rows for f in r if f]
                self.sets[parameters["NSET"]] = [
                    n for f in fields for n in (self.sets[f] if f in self.sets else [int(f)])
                ]
            elif word == "ELEMENT":
                self.elsets.setdefault(parameters["ELSET"], []).extend(int(r[0]) for r in rows)
                self.elements.update({int(r[0]): (parameters["TYPE"], [int(n) for n in r[1:]]) for r in rows})
            elif word == "ELSET":
                self.elsets[parameters["ELSET"]] = rows

    def all(self, keyword):
        return [(parameters, rows) for word, parameters, rows in self.blocks if word == keyword]

    def names(self, keyword):
        return {parameters["NAME"] for parameters, _ in self.all(keyword)}

    def amplitude(self, name, at):
        """The value at a share of the step's time."""
        ((parameters, rows),) = [one for one in self.all("AMPLITUDE") if one[0]["NAME"] == name]
        duration = float(self.all("DYNAMIC")[0][1][0][1])
        if parameters["DEFINITION"] == "SMOOTH STEP":
            return at**3 * (10 - 15 * at + 6 * at * at)
        times, values = np.array(rows, float).T
        return np.interp(at * duration, times, values)

    def motion(self, grip, at):
        """Displacements and rotations of a grip's reference, all six."""
        found = {}
        for parameters, rows in self.all("BOUNDARY"):
            for row in rows:
                if row[0] == f"{grip}_Ref":
                    assert row[1] not in found and row[1] == row[2]
                    found[row[1]] = float(row[3]) * self.amplitude(parameters["AMPLITUDE"], at) if len(row) > 3 else 0.0
        return np.array([found[str(k)] for k in range(1, 7)])


class Dyna:
    def __init__(self, deck):
        self.blocks = []
        for line in deck.splitlines():
            if line.startswith("*"):
                self.blocks.append((line[1:], []))
            elif not line.startswith("$"):
                self.blocks[-1][1].append(line)

    def all(self, keyword):
        return [rows for word, rows in self.blocks if word == keyword]

    def curves(self):
        return {
            int(rows[1]): np.array([[float(row[:20]), float(row[20:])] for row in rows[2:]])
            for rows in self.all("DEFINE_CURVE_TITLE")
        }

    def motions(self):
        rows = [
            [float(row[10 * k : 10 * k + 10]) for k in range(5)]
            for block in self.all("BOUNDARY_PRESCRIBED_MOTION_RIGID")
            for row in block
        ]
        return [(int(part), int(dof), int(vad), int(curve), factor) for part, dof, vad, curve, factor in rows]


class Explicit(Case):
    def source(self, text, name="cloth.txt"):
        path = self.folder / name
        path.write_text(text)
        return path

    def crossed(self, density="density 2.5"):
        return self.source(CROSSED.format(density=density))

    def deck(self, source, *options, to="inp"):
        output, report = self.folder / f"deck.{to}", self.folder / "report.json"
        run = self.succeeds("mesh", source, "--deck", "explicit", "-o", output, "--report", report, *options)
        self.console = run.stdout
        self.facts = json.loads(report.read_text())["inputs"][0]["mesh"]["explicit"]
        return (Abaqus if to == "inp" else Dyna)(output.read_text())

    def check_abaqus(self, deck):
        for word, parameters, _ in deck.blocks:
            self.assertIn(word, ABAQUS)
            known = (
                ABAQUS[word].split("|") if "|" in ABAQUS[word] or word == "CONTACT INCLUSIONS" else ABAQUS[word].split()
            )
            self.assertLessEqual(set(parameters), set(known), word)
        self.assertLessEqual({kind for kind, _ in deck.elements.values()}, ELEMENTS)
        surfaces = deck.names("SURFACE")
        for word, parameters, rows in deck.blocks:
            for key, there in (
                ("AMPLITUDE", deck.names("AMPLITUDE")),
                ("CONTROLS", deck.names("SECTION CONTROLS")),
                ("ORIENTATION", deck.names("ORIENTATION")),
                ("MATERIAL", deck.names("MATERIAL")),
                ("TIE NSET", deck.sets),
            ):
                if key in parameters and word != key:
                    self.assertIn(parameters[key], there, word)
            if word in ("SOLID SECTION", "BEAM SECTION", "RIGID BODY") and "ELSET" in parameters:
                self.assertIn(parameters["ELSET"], deck.elsets)
            if word == "NODE OUTPUT" and "NSET" in parameters:
                self.assertIn(parameters["NSET"], deck.sets)
            if word == "SURFACE PROPERTY ASSIGNMENT":
                self.assertLessEqual({row[0] for row in rows}, surfaces)
            if word == "BOUNDARY":
                self.assertLessEqual({row[0] for row in rows}, set(deck.sets))
        self.assertEqual(
            deck.all("CONTACT PROPERTY ASSIGNMENT")[0][1][0][2].strip(), *deck.names("SURFACE INTERACTION")
        )
        for _, nodes in deck.elements.values():
            self.assertLessEqual(set(nodes), set(deck.nodes))
        grips = [n for parameters, _ in deck.all("RIGID BODY") for n in deck.sets.get(parameters.get("TIE NSET"), [])]
        self.assertEqual(len(grips), len(set(grips)), "a node in two grips")
        energies = {field for _, rows in deck.all("ENERGY OUTPUT") for row in rows for field in row}
        self.assertLessEqual({"ALLKE", "ALLIE", "ALLAE"}, energies)
        for parameters, _ in deck.all("RIGID BODY"):
            self.assertIn(int(parameters["REF NODE"]), deck.sets["References"])

    def check_dyna(self, deck):
        self.assertLessEqual({word for word, _ in deck.blocks}, DYNA)
        parts = {
            int(rows[1][:10]): (int(rows[1][10:20]), int(rows[1][20:30]))
            for word in ("PART", "PART_CONTACT")
            for rows in deck.all(word)
        }
        sections = {
            int(rows[0][:10]) for word in ("SECTION_SOLID", "SECTION_SHELL", "SECTION_BEAM") for rows in deck.all(word)
        }
        materials = {
            int(rows[1][:10])
            for word in ("MAT_ELASTIC_TITLE", "MAT_ORTHOTROPIC_ELASTIC_TITLE", "MAT_RIGID_TITLE")
            for rows in deck.all(word)
        }
        self.assertEqual({s for s, _ in parts.values()}, sections)
        self.assertEqual({m for _, m in parts.values()}, materials)
        nodes = [int(row[:8]) for rows in deck.all("NODE") for row in rows]
        self.assertEqual(len(nodes), len(set(nodes)))
        for rows in deck.all("ELEMENT_SHELL"):
            for row in rows:
                self.assertIn(int(row[8:16]), parts)
                self.assertLessEqual({int(row[k : k + 8]) for k in range(16, 48, 8)}, set(nodes))
        sets = {
            int(rows[1]): [int(n) for row in rows[2:] for n in row.split()] for rows in deck.all("SET_NODE_LIST_TITLE")
        }
        self.assertEqual(len(sets), len(deck.all("SET_NODE_LIST_TITLE")))
        bodies = {int(rows[0][:10]): int(rows[0][20:30]) for rows in deck.all("CONSTRAINED_NODAL_RIGID_BODY_INERTIA")}
        self.assertFalse(set(bodies) & set(parts))
        self.assertLessEqual(set(bodies.values()), set(sets))
        curves = deck.curves()
        moved = {}
        for part, dof, vad, curve, factor in deck.motions():
            self.assertIn(curve, curves)
            self.assertEqual(vad, 2)
            self.assertNotEqual(factor, 0)  # zero stands for one
            moved.setdefault(part, []).append(dof)
        for body in bodies:
            self.assertEqual(sorted(moved[body]), [1, 2, 3, 5, 6, 7])
        self.assertLessEqual(set(moved), set(bodies) | set(parts))

    def test_stable_increment(self):
        deck = self.deck(self.crossed(), "--size", "0.4")
        self.check_abaqus(deck)
        self.assertEqual(float(deck.all("DENSITY")[0][1][0][0]), DENSITY)
        corners = np.array([[deck.nodes[n] for n in nodes] for kind, nodes in deck.elements.values() if kind == "C3D4"])
        volume = np.linalg.det(corners[:, 1:] - corners[:, :1]) / 6
        areas = [
            np.linalg.norm(np.cross(corners[:, j] - corners[:, i], corners[:, k] - corners[:, i]), axis=1) / 2
            for i, j, k in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
        ]
        height = (3 * volume / np.max(areas, axis=0)).min()
        speed = math.sqrt(YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON)) / DENSITY)
        self.assertAlmostEqual(self.facts["wave_speed"] / speed, 1, delta=1e-12)
        self.assertAlmostEqual(self.facts["stable_increment"] / (height / speed), 1, delta=1e-9)
        # 20 passages along a bar of the longest yarn.
        self.assertAlmostEqual(self.facts["duration"] / (20 * 20 / math.sqrt(YOUNG / DENSITY)), 1, delta=1e-6)
        self.assertAlmostEqual(
            self.facts["increments"] * self.facts["stable_increment"] / self.facts["duration"], 1, delta=1e-12
        )
        self.assertIn("no mass scaling", self.console)
        self.assertIn("increments", self.console)

    def test_biaxial(self):
        source = self.crossed()
        deck = self.deck(source, "--elements", "hex", "--stroke", "0.3")
        self.check_abaqus(deck)
        for grip, axis, sign, size in (
            ("GripXLow", 0, -1, 10),
            ("GripXHigh", 0, 1, 10),
            ("GripYLow", 1, -1, 8),
            ("GripYHigh", 1, 1, 8),
        ):
            np.testing.assert_allclose([deck.nodes[n][axis] for n in deck.sets[grip]], sign * size, atol=1e-9)
            wanted = np.zeros(6)
            wanted[axis] = sign * 0.15
            np.testing.assert_allclose(deck.motion(grip, 1), wanted, atol=1e-12)
        self.check_dyna(self.deck(source, "--elements", "hex", to="k"))

    def test_frame(self):
        """Bars keep their lengths, meet at the hinges at all times, and end sheared by the angle."""
        source = self.crossed()
        options = ("--elements", "beam", "--load", "frame", "--stroke", "40")
        deck = self.deck(source, *options)
        self.check_abaqus(deck)
        arms = {"GripXLow": (0, -8), "GripXHigh": (0, 8), "GripYLow": (-10, 0), "GripYHigh": (10, 0)}

        def ends(motion, reference, arm):
            turn = np.array([[math.cos(motion[5]), -math.sin(motion[5])], [math.sin(motion[5]), math.cos(motion[5])]])
            return [reference[:2] + motion[:2] + sign * turn @ np.array(arm, float) for sign in (-1, 1)]

        def check(bars, angle, delta):
            (a, b), (c, d) = bars["GripXLow"], bars["GripXHigh"]  # a at (-x, y), b at (-x, -y)
            (e, f), (g, h) = bars["GripYLow"], bars["GripYHigh"]  # e at (x, -y), f at (-x, -y)
            for one, other in ((a, g), (b, f), (c, e), (d, h)):
                np.testing.assert_allclose(one, other, atol=delta)
            between = (d - c) @ (e - f) / np.linalg.norm(d - c) / np.linalg.norm(e - f)
            self.assertAlmostEqual(math.degrees(math.asin(between)), angle, delta=1e-3)

        references = {grip: deck.nodes[deck.sets[f"{grip}_Ref"][0]] for grip in arms}
        for at in (0, 0.25, 0.5, 1):
            shear = 40 * at**3 * (10 - 15 * at + 6 * at * at)
            check({grip: ends(deck.motion(grip, at), references[grip], arm) for grip, arm in arms.items()}, shear, 1e-9)
        dyna = self.deck(source, *options, to="k")
        self.check_dyna(dyna)
        curves, bodies = dyna.curves(), dyna.all("CONSTRAINED_NODAL_RIGID_BODY_INERTIA")
        bars = {}
        for rows, (grip, arm) in zip(bodies, arms.items()):
            motion = np.zeros(8)
            for part, dof, _, curve, factor in dyna.motions():
                if part == int(rows[0][:10]):
                    motion[dof] += factor * curves[curve][-1, 1]
            bars[grip] = ends(
                motion[[1, 2, 3, 5, 6, 7]], np.array([float(rows[1][10 * k : 10 * k + 10]) for k in range(3)]), arm
            )
        check(bars, 40, 1e-6)

    def test_compaction(self):
        source = self.crossed()
        for options, reach in ((("--elements", "hex"), 0), (("--elements", "beam"), 0.5)):
            deck = self.deck(source, *options, "--load", "compaction", "--thickness", "2.2")
            self.check_abaqus(deck)
            yarns = np.array([deck.nodes[n] for n in deck.sets["AllNodes"]])
            low, high = yarns[:, 2].min() - reach, yarns[:, 2].max() + reach
            plates = {
                name: np.array([deck.nodes[n] for e in deck.elsets[name] for n in deck.elements[e][1]])
                for name in ("PlateLow", "PlateHigh")
            }
            self.assertLess(plates["PlateLow"][:, 2].max(), low)
            self.assertGreater(plates["PlateHigh"][:, 2].min(), high)
            for plate in plates.values():
                self.assertTrue(
                    (plate[:, :2].min(0) < yarns[:, :2].min(0)).all()
                    and (plate[:, :2].max(0) > yarns[:, :2].max(0)).all()
                )
            end = [plates[name][0, 2] + deck.motion(name, 1)[2] for name in ("PlateLow", "PlateHigh")]
            self.assertAlmostEqual(end[1] - end[0], 2.2, delta=1e-9)
            # Faces look at the cloth.
            for name, way in (("PlateLow", 1), ("PlateHigh", -1)):
                a, b, c = (deck.nodes[n] for n in deck.elements[deck.elsets[name][0]][1][:3])
                self.assertGreater(way * np.cross(b - a, c - a)[2], 0)
            dyna = self.deck(source, *options, "--load", "compaction", "--thickness", "2.2", to="k")
            self.check_dyna(dyna)
            thickness = float(dyna.all("SECTION_SHELL")[0][1][:10])
            shells = np.array(
                [
                    [float(row[8 + 16 * k : 24 + 16 * k]) for k in range(3)]
                    for rows in dyna.all("NODE")[1:]
                    for row in rows
                ]
            )
            self.assertAlmostEqual(shells[:, 2].max() - thickness / 2, plates["PlateHigh"][0, 2], delta=1e-7)
            self.assertAlmostEqual(shells[:, 2].min() + thickness / 2, plates["PlateLow"][0, 2], delta=1e-7)

    def test_bias(self):
        source = self.source(BIAS.format(turn=45, cell="-2.5 3 -0.5  2.5 7 0.5"))
        deck = self.deck(source, "--load", "bias", "--cut", "--size", "0.15")
        self.check_abaqus(deck)
        np.testing.assert_allclose([deck.nodes[n][0] for n in deck.sets["GripXHigh"]], 2.5, atol=1e-9)
        np.testing.assert_allclose([deck.nodes[n][0] for n in deck.sets["GripXLow"]], -2.5, atol=1e-9)
        self.assertNotIn("GripYLow", deck.sets)
        np.testing.assert_allclose(
            deck.motion("GripXHigh", 1) - deck.motion("GripXLow", 1), [0.5, 0, 0, 0, 0, 0], atol=1e-12
        )
        straight = self.source(BIAS.format(turn=0, cell="1 1 -0.5  7 6 0.5"), "straight.txt")
        self.assertIn(
            "45",
            self.fails(
                1,
                "mesh",
                straight,
                "--deck",
                "explicit",
                "--load",
                "bias",
                "--cut",
                "--size",
                "0.15",
                "-o",
                self.folder / "x.inp",
            ),
        )

    def test_order_and_split(self):
        source = self.crossed()
        self.check_abaqus(self.deck(source, "--order", "2", "--size", "0.5"))
        self.deck(source, "--elements", "hex", "--split-deck")
        model, mesh = ((self.folder / name).read_text() for name in ("deck.inp", "deck_mesh.inp"))
        self.check_abaqus(Abaqus(model.replace("*INCLUDE, INPUT=deck_mesh.inp\n", mesh)))

    def test_beams_in_contact(self):
        deck = self.deck(self.crossed(), "--elements", "beam", "--friction", "0.2")
        ((_, rows),) = deck.all("SURFACE PROPERTY ASSIGNMENT")
        thickness = {row[0]: float(row[1]) for row in rows}
        self.assertEqual(set(thickness), {f"{yarn}_Surface" for yarn in ("x1", "x2", "y1", "y2")})
        np.testing.assert_allclose(list(thickness.values()), 1, atol=1e-12)
        self.assertEqual(float(deck.all("FRICTION")[0][1][0][0]), 0.2)
        self.assertAlmostEqual(self.facts["wave_speed"] / math.sqrt(YOUNG / DENSITY), 1, delta=1e-12)

    def test_trusses(self):
        """As beams, but for their elements, which have an area alone."""
        deck = self.deck(self.crossed(), "--elements", "truss", "--load", "compaction", "--thickness", "2.2")
        self.check_abaqus(deck)
        self.assertEqual({kind for kind, _ in deck.elements.values()}, {"T3D2", "R3D4"})
        for words, rows in deck.all("SOLID SECTION"):
            self.assertAlmostEqual(float(rows[0][0]), 1, delta=1e-9)
        self.assertAlmostEqual(self.facts["wave_speed"] / math.sqrt(YOUNG / DENSITY), 1, delta=1e-12)
        dyna = self.deck(self.crossed(), "--elements", "truss", "--load", "compaction", "--thickness", "2.2", to="k")
        self.check_dyna(dyna)
        for rows in dyna.all("SECTION_BEAM"):
            self.assertEqual(int(rows[0][10:20]), 3)
            self.assertAlmostEqual(float(rows[1][:10]), 1, delta=1e-9)

    def test_refusals(self):
        source = self.crossed()
        for options, words in (
            (["--deck", "explicit", "--matrix"], "--matrix"),
            (["--deck", "explicit", "--to", "cdb"], "--to inp --to k"),
            (["--load", "frame"], "--deck"),
            (["--deck", "explicit", "--thickness", "1"], "compaction"),
            (["--deck", "explicit", "--load", "compaction", "--thickness", "1", "--stroke", "1"], "--stroke"),
        ):
            with self.subTest(options):
                self.assertIn(words, self.fails(2, "mesh", source, "-o", f"{self.folder}/x/", *options))
        for options, words in (
            (["--load", "frame", "--stroke", "95"], "below 90"),
            (["--load", "compaction", "--thickness", "30"], "nearer"),
            (["--load", "bias"], "--cut"),
        ):
            with self.subTest(options):
                self.assertIn(
                    words,
                    self.fails(
                        1,
                        "mesh",
                        source,
                        "--elements",
                        "hex",
                        "--deck",
                        "explicit",
                        "-o",
                        self.folder / "x.inp",
                        *options,
                    ),
                )
        self.assertIn(
            "density V",
            self.fails(
                1, "mesh", self.crossed(""), "--elements", "hex", "--deck", "explicit", "-o", self.folder / "x.inp"
            ),
        )
        self.assertIn(
            "x low",
            self.fails(
                1, "mesh", SAMPLES / "ring.txt", "--elements", "beam", "--deck", "explicit", "-o", self.folder / "x.inp"
            ),
        )


if __name__ == "__main__":
    unittest.main()
