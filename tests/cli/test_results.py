"""Pictures and pages of CalculiX's results: what they show, against closed forms, CalculiX's own values at integration points, and
a reader of .frd of this test's own."""

import math
import os
import re
import struct
import subprocess
import unittest
import zlib

import numpy as np
import page
from program import HAS_PAGES, NO_PAGES, SAMPLES, Case

# viridis at ninths, as published, of which the scale is made.
SCALE = np.array(
    [
        (68, 1, 84),
        (72, 40, 120),
        (62, 74, 137),
        (49, 104, 142),
        (38, 130, 142),
        (31, 158, 137),
        (53, 183, 121),
        (109, 205, 89),
        (180, 222, 44),
        (253, 231, 37),
    ],
    float,
)
# A ply of aligned fibres.
E1, E2, NU12, NU23, G12 = 140000.0, 9000.0, 0.3, 0.4, 5000.0
ANGLE = math.radians(30)
SIDES = (2.0, 1.0, 1.0)


def color(share):
    at = min(max(share, 0), 1) * 9
    k = min(8, int(at))
    return SCALE[k] + (at - k) * (SCALE[k + 1] - SCALE[k])


def pixels(path):
    """A PNG of 8-bit colours, by its chunks and filters: height x width x 3."""
    data, at, packed = path.read_bytes(), 8, b""
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        body = data[at + 8 : at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, form = struct.unpack(">IIBB", body[:10])
            assert (depth, form) == (8, 2)
        if kind == b"IDAT":
            packed += body
        at += 12 + length
    raw, stride = zlib.decompress(packed), 3 * width
    rows = np.zeros((height, stride), np.uint8)
    for y in range(height):
        kind, line = raw[y * (stride + 1)], np.frombuffer(raw, np.uint8, stride, y * (stride + 1) + 1).astype(int)
        above = rows[y - 1].astype(int) if y else np.zeros(stride, int)
        if kind == 0:
            rows[y] = line
        elif kind == 2:
            rows[y] = (line + above) & 255
        else:
            own = np.zeros(stride + 3, int)
            before = np.concatenate([np.zeros(3, int), above])
            for k in range(stride):
                a, b, c = own[k], before[k + 3], before[k]
                p = a + b - c
                guess = {1: a, 3: (a + b) // 2, 4: min((abs(p - v), i, v) for i, v in enumerate((a, b, c)))[2]}[kind]
                own[k + 3] = (line[k] + guess) & 255
            rows[y] = own[3:]
    return rows.reshape(height, width, 3)


def results(path):
    """Nodes, and of each set of results its blocks by name: {node: values}."""
    nodes, sets, block = {}, {}, None
    mode = ""
    for line in path.read_text().splitlines():
        if line.startswith("    2C"):
            mode = "nodes"
        elif line.startswith("    3C"):
            mode = "elements"
        elif line.startswith("  100C"):
            mode, number = "results", int(line[58:63])
        elif line.startswith(" -4"):
            block = sets.setdefault(number, {}).setdefault(line[5:13].strip(), {})
        elif line.startswith(" -3"):
            mode = ""
        elif line.startswith(" -1") and mode in ("nodes", "results"):
            values = [float(line[at : at + 12]) for at in range(13, len(line.rstrip()), 12)]
            (nodes if mode == "nodes" else block)[int(line[3:13])] = values
    return nodes, sets


def ccx(folder, name):
    done = subprocess.run(
        ["ccx", "-i", name], cwd=folder, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"}
    )
    assert done.returncode == 0 and "*ERROR" not in done.stdout, done.stdout[-2000:]


def ply_deck(order="C3D8", warming=0.0):
    """A block of a ply whose fibres lie 30 degrees off x, drawn along x and free to shear: 4 x 2 x 2 hexahedra, and a soft
    block without fibres on top of it that shares its nodes."""
    steps = (4, 2, 3)
    number = lambda i, j, k: 1 + i + 5 * (j + 3 * k)
    place = lambda i, j, k: (SIDES[0] * i / 4, SIDES[1] * j / 2, SIDES[2] * k / 2)
    lattice = [(i, j, k) for k in range(4) for j in range(3) for i in range(5)]
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    elements = [
        [number(i + a, j + b, k + c) for a, b, c in corner] for k in range(3) for j in range(2) for i in range(4)
    ]
    assert len(elements) == steps[0] * steps[1] * steps[2]
    cos, sin = math.cos(ANGLE), math.sin(ANGLE)
    text = "*NODE, NSET=ALL\n" + "".join(f"{number(*n)}, {', '.join(map(repr, place(*n)))}\n" for n in lattice)
    text += "*ELEMENT, TYPE=C3D8, ELSET=tow 1\n" + "".join(
        f"{e}, {', '.join(map(str, n))}\n" for e, n in enumerate(elements[:16], 1)
    )
    text += "*ELEMENT, TYPE=C3D8, ELSET=Matrix\n" + "".join(
        f"{e}, {', '.join(map(str, n))}\n" for e, n in enumerate(elements[16:], 17)
    )
    text += f"*ORIENTATION, NAME=fibre\n{cos!r}, {sin!r}, 0, {-sin!r}, {cos!r}, 0\n"
    text += (
        "*MATERIAL, NAME=carbon\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n"
        f"{E1}, {E2}, {E2}, {NU12}, {NU12}, {NU23}, {G12}, {G12},\n{E2 / 2 / (1 + NU23)}\n*EXPANSION, TYPE=ORTHO\n1e-6, 30e-6, 30e-6\n"
        "*MATERIAL, NAME=resin\n*ELASTIC\n1e-3, 0\n*EXPANSION\n0\n"
        "*SOLID SECTION, ELSET=tow 1, MATERIAL=carbon, ORIENTATION=fibre\n*SOLID SECTION, ELSET=Matrix, MATERIAL=resin\n"
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20\n"
    )
    end = lambda axis, at: [n for n in lattice if n[axis] == at]
    fixed = (
        "".join(f"{number(*n)}, 1, 1, 0\n" for n in end(0, 0))
        + f"{number(0, 0, 0)}, 2, 3, 0\n{number(0, 2, 0)}, 3, 3, 0\n"
    )
    # A uniform stress along x: forces that bilinear faces make of it.
    share = lambda n: (0.5 if n[1] in (0, 2) else 1) * (0.5 if n[2] in (0, 2) else 1) / 8
    loads = "".join(f"{number(*n)}, 1, {100 * 2 * share(n)}\n" for n in end(0, 4) if n[2] <= 2)
    text += (
        f"** drawn\n*STEP\n*STATIC\n*BOUNDARY\n{fixed}*CLOAD\n{loads}*TEMPERATURE\nALL, {20 + warming}\n"
        "*NODE FILE\nU\n*EL FILE\nS, E\n*EL PRINT, ELSET=Matrix\nS\n*END STEP\n"
    )
    return text


class Results(Case):
    def picture(self, source, *options):
        path = self.folder / "picture.png"
        self.succeeds("view", source, "-o", path, "--size", "480x480", "--flat", *options)
        return pixels(path)

    def solve_ply(self, **options):
        (self.folder / "ply.inp").write_text(ply_deck(**options))
        ccx(self.folder, "ply")
        return self.folder / "ply.frd"

    def field(self, source, name, region):
        """A field at the points of one region's outside, as the page has it."""
        if not HAS_PAGES:
            self.skipTest(NO_PAGES)
        made = self.folder / "page.html"
        self.succeeds("view", source, "-o", made)
        read = page.Page(made)
        skin = read.data["skin"]
        points, triangles, of = read.skin()
        which = [one["name"] for one in skin["regions"]].index(region)
        used = np.unique(triangles[of == which])
        return points[used], read.field(name)[used]

    def test_the_colour_of_a_displacement(self):
        """A bar without Poisson's effect: its displacement is linear, and so the colour has to be, from the first pixel to the last."""
        deck = self.folder / "bar.inp"
        deck.write_text(
            "*NODE, NSET=ALL\n1,0,0,0\n2,2,0,0\n3,2,1,0\n4,0,1,0\n5,0,0,1\n6,2,0,1\n7,2,1,1\n8,0,1,1\n*ELEMENT, TYPE=C3D8, ELSET=bar\n"
            "1,1,2,3,4,5,6,7,8\n*MATERIAL, NAME=m\n*ELASTIC\n1000, 0\n*SOLID SECTION, ELSET=bar, MATERIAL=m\n*STEP\n*STATIC\n*BOUNDARY\n"
            "ALL, 2, 3, 0\n1,1,1,0\n4,1,1,0\n5,1,1,0\n8,1,1,0\n2,1,1,0.03\n3,1,1,0.03\n6,1,1,0.03\n7,1,1,0.03\n*NODE FILE\nU\n*EL FILE\nS\n*END STEP\n"
        )
        ccx(self.folder, "bar")
        for field, limits, value in (
            ("displacement", (), lambda x: x),
            ("DISP.x", ("--range", "0:0.06"), lambda x: x / 2),
            ("stress.xx", ("--range", "0:20"), lambda x: 0.75),
            ("stress", ("--range", "-15:15"), lambda x: 1),
        ):
            image = self.picture(
                self.folder / "bar.frd", "--field", field, *limits, "--from", "front", "--no-scale-bar"
            )
            drawn = (image != 255).any(axis=2)
            # The bar: twice as wide as high, above the legend. Lines of its edges are darker.
            rows = np.flatnonzero(drawn[:, 240])
            top, foot = rows[0], next(y for y, below in zip(rows, rows[1:]) if below != y + 1)
            columns = np.flatnonzero(drawn[(top + foot) // 2])
            left, right = columns[0], columns[-1] + 1
            self.assertAlmostEqual((right - left) / (foot + 1 - top), 2, delta=0.03)
            for share in np.linspace(0.05, 0.95, 13):
                x = int(left + share * (right - left))
                seen = image[top + (foot - top) // 3, x]
                wanted = color(value((x + 0.5 - left) / (right - left)))
                self.assertLess(np.abs(seen - wanted).max(), 4, (field, share))
            # The legend has the same colours from its least value to its largest.
            row = next(y for y in range(foot + 5, 480) if drawn[y].mean() > 0.65)
            bar = np.flatnonzero(drawn[row + 2])
            for share in (0.1, 0.5, 0.9):
                self.assertLess(
                    np.abs(image[row + 2, int(bar[0] + share * (bar[-1] + 1 - bar[0]))] - color(share)).max(), 4
                )

    def test_fibres_off_the_axis(self):
        """Under a stress s along x: s cos^2 along the fibre, and the strain is that times the compliance."""
        source = self.solve_ply()
        cos, sin = math.cos(ANGLE), math.sin(ANGLE)
        along, across = 100 * cos**2, 100 * sin**2
        _, stress = self.field(source, "STRESS along the fibre", "tow 1")
        self.assertLess(np.abs(stress - along).max(), 1e-3 * along)
        _, strain = self.field(source, "TOSTRAIN along the fibre", "tow 1")
        self.assertLess(np.abs(strain - (along - NU12 * across) / E1).max(), 1e-3 * along / E1)
        # What carries nearly nothing takes nothing of its neighbour's stress, as it does in the solver's own means.
        _, soft = self.field(source, "STRESS", "Matrix")
        self.assertLess(np.abs(soft).max(), 1e-4)
        nodes, sets = results(source)
        own = max(abs(sets[1]["STRESS"][node][0]) for node, place in nodes.items() if place[2] == 1.0)
        self.assertTrue(40 < own < 60)
        _, without = self.field(source, "STRESS along the fibre", "Matrix")
        self.assertTrue(np.isnan(without).all())
        image = self.picture(
            source, "--field", "stress.fibre", "--range", "0:100", "--from", "bottom", "--no-scale-bar"
        )
        self.assertLess(np.abs(image[150, 200] - color(cos**2)).max(), 4)

    def test_warmth_is_no_stress(self):
        """Warmed and drawn: the stress is the one of the forces alone, the strain along the fibre has the expansion, too."""
        source = self.solve_ply(warming=50)
        along, across = 100 * math.cos(ANGLE) ** 2, 100 * math.sin(ANGLE) ** 2
        _, stress = self.field(source, "STRESS along the fibre", "tow 1")
        self.assertLess(np.abs(stress - along).max(), 1e-3 * along)
        _, strain = self.field(source, "TOSTRAIN along the fibre", "tow 1")
        self.assertLess(np.abs(strain - (along - NU12 * across) / E1 - 50e-6).max(), 2e-7)

    def test_tetrahedra_and_their_integration_points(self):
        """Of tetrahedra of first order CalculiX prints one stress each: at nodes of one region the means of those are shown."""
        deck = self.folder / "cell.inp"
        self.succeeds(
            "mesh", SAMPLES / "cell_straight.txt", "--matrix", "--periodic", "--order", "1", "--size", 0.3, "-o", deck
        )
        text = deck.read_text()
        deck.write_text(re.sub(r"\*EL FILE\nS, E\n", "*EL FILE\nS, E\n*EL PRINT, ELSET=tow\nS\n", text))
        ccx(self.folder, "cell")
        printed, step = {}, 0
        for line in (self.folder / "cell.dat").read_text().splitlines():
            words = line.split()
            if line.startswith(" stresses"):
                step += 1
            elif (
                len(words) == 9 and words[1] == "1" and step
            ):  # the last one: by this orientation, here the axes of space
                x, y, z, xy, xz, yz = map(float, words[2:8])
                printed.setdefault(step, {})[int(words[0])] = np.array((x, y, z, xy, yz, xz))
        corners, current = {}, ""
        for line in text.splitlines():
            if line.startswith("*"):
                current = line
            elif current == "*ELEMENT, TYPE=C3D4, ELSET=tow":
                element, *nodes = map(int, line.split(","))
                corners[element] = nodes
        nodes, _ = results(self.folder / "cell.frd")
        points, of_x = self.field(self.folder / "cell.frd", "STRESS", "tow")
        made = page.Page(self.folder / "page.html")
        self.assertEqual(made.data["skin"]["steps"][0], "step 1, strain xx")
        self.assertEqual(made.data["skin"]["steps"][-1], "step 7, thermal")
        where = {tuple(np.round(place, 4)): node for node, place in nodes.items()}
        skin_points, triangles, of = made.skin()
        used = np.unique(triangles[of == [one["name"] for one in made.data["skin"]["regions"]].index("tow")])
        for step in (1, 4, 7):
            shown = made.field("STRESS", step)[used]
            largest = max(np.abs(one).max() for one in printed[step].values())
            means = {}
            for element, nodes_of in corners.items():
                for node in nodes_of:
                    means.setdefault(node, []).append(printed[step][element])
            for point, value in list(zip(skin_points[used], shown))[::7]:
                wanted = np.mean(means[where[tuple(np.round(point, 4))]], axis=0)
                self.assertLess(np.abs(value - wanted).max(), 2e-4 * largest + 1e-4)

    def test_stresses_that_elements_hold(self):
        """Bending of straight tetrahedra with ten nodes, and tension of hexahedra and wedges: stresses that these elements have exactly.
        Every node but one inside is where the closed form puts it."""
        young, poisson = 1000.0, 0.3
        thread = {
            "box": "polygon\n    -0.5 -0.4\n    0.5 -0.4\n    0.5 0.4\n    -0.5 0.4\n  end",
            "lens": "lenticular 1 0.4",
        }
        strain, bend = 0.01, 0.02

        def bent(x, y, z):
            """Drawn, and bent about z."""
            return (
                strain * x + bend * x * y,
                -poisson * strain * y - bend * (x * x + poisson * (y * y - z * z)) / 2,
                -poisson * (strain * z + bend * y * z),
            )

        def drawn(x, y, z):
            return strain * x, -poisson * strain * y, -poisson * strain * z

        for section, options, field, curved in (
            ("box", ("--order", "2", "--size", "0.4"), bent, bend),
            ("lens", ("--elements", "hex", "--size", "0.15"), drawn, 0.0),
        ):
            with self.subTest(section):
                source = self.folder / f"{section}.txt"
                source.write_text(
                    f"fabric 1\ntolerance 1e-4\nmaterial m\n  elastic isotropic {young} {poisson}\nend\nthread t\n  section {thread[section]}\n"
                    "  material m\nend\nyarn y t\n  path chord\n    0 0 0\n    1 0 0\n    2 0 0\n  end\nend\n"
                )
                deck = self.folder / f"{section}.inp"
                self.succeeds("mesh", source, *options, "-o", deck)
                model = deck.read_text()
                model = model[: model.index("*STEP")]
                nodes, inside, kinds = {}, False, set()
                for line in model.splitlines():
                    if line.startswith("*"):
                        inside = line.startswith("*NODE")
                        kinds |= set(re.findall(r"^\*ELEMENT, TYPE=(\w+)", line))
                    elif inside:
                        number, *place = line.split(",")
                        nodes[int(number)] = tuple(map(float, place))
                self.assertLessEqual(kinds, {"C3D10", "C3D6", "C3D8R", "C3D8I", "C3D8"})
                free = min(nodes, key=lambda n: sum((a - b) ** 2 for a, b in zip(nodes[n], (1, 0, 0))))
                held = "".join(
                    f"{n}, {k + 1}, {k + 1}, {value:.11e}\n"
                    for n, place in nodes.items()
                    if n != free
                    for k, value in enumerate(field(*place))
                )
                deck.write_text(f"{model}*STEP\n*STATIC\n*BOUNDARY\n{held}*NODE FILE\nU\n*EL FILE\nS, E\n*END STEP\n")
                ccx(self.folder, section)
                points, stress = self.field(self.folder / f"{section}.frd", "STRESS", "y")
                wanted = np.zeros((len(points), 6))
                wanted[:, 0] = young * (strain + curved * points[:, 1])
                self.assertGreater(len(points), 50)
                self.assertLess(np.abs(stress - wanted).max(), 2e-3 * young * strain)

    def test_steps_shapes_and_the_matrix(self):
        self.succeeds(
            "mesh",
            SAMPLES / "cell_straight.txt",
            "--matrix",
            "--periodic",
            "--voxel",
            6,
            "-o",
            self.folder / "cell.inp",
        )
        ccx(self.folder, "cell")
        source = self.folder / "cell.frd"
        whole, half, none = (
            self.picture(source, "--field", "stress", "--step", "1", "--show-matrix", part)
            for part in ("whole", "half", "none")
        )
        self.assertTrue((whole != half).any() and (half != none).any())
        self.assertTrue((self.picture(source, "--field", "stress", "--step", "1") == half).all())
        self.assertTrue((self.picture(source, "--field", "stress", "--step", "1", "--yarns", "tow") == none).all())
        self.assertTrue(
            (
                self.picture(source, "--field", "stress")
                == self.picture(source, "--field", "STRESS.mises", "--step", "7")
            ).all()
        )
        # Strain xy of 1e-3, drawn 300 times: the block seen from above is a parallelogram.
        still, moved = (
            self.picture(source, "--step", "4", "--from", "top", "--no-scale-bar", *more)
            for more in ((), ("--deformed", "300"))
        )
        # From corner to corner, over a whole period: the stiffer tow in the middle leans less.
        for image, lean in ((still, 0), (moved, 0.15)):
            shape = (image != 255).any(axis=2)
            y, x = np.nonzero(shape)
            low, high = np.argmin(x - y), np.argmin(x + y)  # the corners at the left, at the bottom and at the top
            self.assertAlmostEqual((x[high] - x[low]) / (y[low] - y[high]), lean, delta=0.01)

    def test_faults(self):
        source = self.solve_ply()
        png = self.folder / "x.png"
        for options, words in (
            (("--field", "stres"), "no field 'stres': it has DISP, "),
            (("--field", "stress.q"), "no part 'q'"),
            (("--field", "DISP.fibre"), "no stress or strain"),
            (("--step", "3"), "no step 3: there are 1 'step 1, drawn'"),
            (("--field", "stress.fibre", "--yarns", "Matrix"), "no value of 'stress.fibre'"),
            (("--yarns", "nobody"), "no region is shown"),
            (("--section", "z=0"), "--section is of yarns"),
        ):
            self.assertIn(words, self.fails(1, "view", source, "-o", png, *options))
            self.assertFalse(png.exists())
        for options, words in (
            (("--field", "stress", "--range", "5:1"), "the lower value first"),
            (("--deformed", "much"), "a number, or auto"),
            (("--range", "0:1"), "--field"),
        ):
            self.assertIn(words, self.fails(2, "view", source, "-o", png, *options))
        self.assertIn("of pictures", self.fails(1, "view", source, "-o", self.folder / "x.html", "--field", "stress"))
        self.assertIn("are of meshes", self.fails(1, "view", SAMPLES / "ring.txt", "-o", png, "--field", "stress"))

    def test_decks(self):
        """Named, beside, another one, and none."""
        source = self.solve_ply()
        alone = self.folder / "alone.frd"
        alone.write_bytes(source.read_bytes())
        png = self.folder / "x.png"
        self.assertIn("means over both", self.succeeds("view", alone, "-o", png, "--field", "stress").stderr)
        self.assertIn(
            "name the deck that was solved", self.fails(1, "view", alone, "-o", png, "--field", "stress.fibre")
        )
        self.assertEqual(
            self.succeeds(
                "view", alone, "-o", png, "--field", "stress.fibre", "--deck", self.folder / "ply.inp"
            ).stderr.count("warning"),
            0,
        )
        good = (self.folder / "ply.inp").read_text()
        for old, new, words in (
            ("*STEP", "*STEP, NLGEOM", "small displacements"),
            ("*ELASTIC\n1e-3, 0", "*ELASTIC\n1e-3, 0\n*PLASTIC\n1, 0", "linear elasticity"),
            ("\n1, 1, 2, 7", "\n1, 1, 2, 8", "not the one that was solved"),
            ("*HEADING", "*INCLUDE, INPUT=mesh.inp", "--split-deck"),
            ("1e-3, 0", "1e-3, x", r"bad\.inp:\d+:\d+: error: 'x' is not a number"),
            ("ORIENTATION=fibre", "ORIENTATION=other", "orientation of this section"),
            ("TYPE=C3D8, ELSET=Matrix", "TYPE=S8, ELSET=Matrix", "elements of the type 'S8'"),
        ):
            bad = self.folder / "bad.inp"
            changed = good.replace(old, new, 1)
            bad.write_text(changed if changed != good else f"{new}\n{good}")
            self.assertRegex(self.fails(1, "view", alone, "-o", png, "--field", "stress", "--deck", bad), words)
        # One beside that cannot be taken is said, and left.
        (self.folder / "ply.inp").write_text(good.replace("*STEP", "*STEP, NLGEOM", 1))
        self.assertRegex(
            self.succeeds("view", source, "-o", png, "--field", "stress").stderr, "warning: NLGEOM.*is left"
        )


if __name__ == "__main__":
    unittest.main()
