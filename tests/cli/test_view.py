"""Pictures: their bytes, and what is to be seen in them."""

import json
import math
import re
import shutil
import struct
import subprocess
import unittest
import zlib

from program import BAD, Case, GRID, HAS_PAGES, NO_PAGES, PATH, PROGRAM, RING, SAMPLES, files_below


def decode(data):
    """(width, height, rows of (r, g, b)) of an 8-bit RGB PNG, by the PNG specification alone."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n", data[:8]
    at, packed, header = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += length + 12
    width, height, depth, color, _, _, interlaced = header
    assert (depth, color, interlaced) == (8, 2, 0), header
    raw, stride = zlib.decompress(packed), 3 * width
    before, rows = bytearray(stride), []
    for y in range(height):
        form, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1 : (y + 1) * (stride + 1)])
        for i in range(stride):
            left, up = line[i - 3] if i >= 3 else 0, before[i]
            corner = before[i - 3] if i >= 3 else 0
            if form == 4:
                guess = min((left, up, corner), key=lambda value: abs(left + up - corner - value))
            else:
                guess = (0, left, up, (left + up) // 2)[form]
            line[i] = (line[i] + guess) & 255
        rows.append([tuple(line[i : i + 3]) for i in range(0, stride, 3)])
        before = line
    return width, height, rows


def fabric(*yarns, head=""):
    """Straight yarns: (name, colour, from, to, statements)."""
    text = "fabric 1\nthread t\n diameter 1\nend\n" + head
    for name, color, start, end, more in yarns:
        text += f"yarn {name} t\n color {color}\n {more}\n path\n  {start}\n  {end}\n end\nend\n"
    return text


RED, BLUE, GREY = "200 40 40", "40 40 200", "128 128 128"
CROSS = (("under", BLUE, "0 -4 -0.6", "0 4 -0.6", ""), ("over", RED, "-4 0 0.6", "4 0 0.6", ""))


def is_magenta(pixel):
    r, g, b = pixel
    return r > 90 and b > 0.6 * r and g < 0.4 * r


class Base(Case):
    def picture(self, text, *options, size="200x200", bar=False):
        path = self.folder / "in.txt"
        path.write_text(text)
        self.succeeds(
            "view", path, "-o", self.folder / "x.png", "--size", size, *options, *(() if bar else ("--no-scale-bar",))
        )
        width, height, rows = decode((self.folder / "x.png").read_bytes())
        self.assertEqual(f"{width}x{height}", size)
        return rows


class Pictures(Base):
    def test_the_upper_yarn_hides_the_lower(self):
        for view, upper in (("top", 0), ("bottom", 2)):
            pixel = self.picture(fabric(*CROSS), "--from", view)[100][100]
            self.assertEqual(pixel.index(max(pixel)), upper, (view, pixel))

    def test_overlaps_are_tinted(self):
        def count(gap):
            rods = (("a", GREY, "-4 0 0", "4 0 0", ""), ("b", GREY, f"0 -4 {gap}", f"0 4 {gap}", ""))
            return sum(is_magenta(pixel) for row in self.picture(fabric(*rods)) for pixel in row)

        self.assertEqual(count(1.05), 0)
        self.assertEqual(count(1.0), 0)  # they touch
        self.assertGreater(count(0.9), 20)
        self.assertGreater(count(0.5), count(0.9))

    def test_a_yarn_in_itself_is_tinted_otherwise(self):
        crossing = "fabric 1\nyarn a\n diameter 1\n path polyline\n -3 -2 0\n 3 2 0\n 3 -2 0\n -3 2 0\n end\nend\n"
        r, g, b = self.picture(crossing)[100][100]
        self.assertGreater(r, 2 * b)
        self.assertGreater(g, 1.5 * b)

    def test_silhouettes_have_the_analytic_area(self):
        def covered(pixel, full=0):  # a yarn of this brightness on white
            return (255 - pixel[1]) / (255 - full)

        rod = fabric(("a", "0 0 0", "-2 0 0", "2 0 0", ""))
        rows = self.picture(rod, size="400x200")
        unit = sum(map(covered, rows[100])) / 4  # pixels a millimetre, by the rod's length
        self.assertGreater(unit, 80)
        self.assertAlmostEqual(sum(map(covered, (p for row in rows for p in row))) / (4 * unit**2), 1, delta=0.01)
        rows = self.picture(rod, "--from", "side", "--flat")
        end = rows[100][100][1]
        across = sum(covered(pixel, end) for pixel in rows[100])
        self.assertGreater(across, 150)
        area = sum(covered(pixel, end) for row in rows for pixel in row)
        self.assertAlmostEqual(area / (math.pi / 4 * across**2), 1, delta=0.01)

    def slope_of_stripes(self, twist):
        """How far the stripes in the middle of an upright yarn go to the right a pixel up; and pixels a millimetre."""
        text = fabric(("a", "200 200 200", "0 -2 0", "0 2 0", f"twist {twist}"))
        rows = self.picture(text, "--flat", size="300x600")
        unit = 600 / 4 * (1 - 0.08 * 300 / 600)
        up, half, slopes = 40, int(0.2 * unit), []
        for y in range(200, 400, 20):
            lower, upper = ([pixel[1] for pixel in rows[k]] for k in (y, y - up))

            def difference(shift):
                return sum((lower[x] - upper[x + shift]) ** 2 for x in range(150 - half, 150 + half))

            slopes.append(min(range(-25, 26), key=difference) / up)
        return sorted(slopes)[len(slopes) // 2]

    def test_z_is_seen_as_z(self):
        # The middle stroke of the letter: to the right as it goes up. A fibre that makes T turns a millimetre on a
        # yarn of diameter D has the slope pi D T in front.
        for hand, sign in (("Z", 1), ("S", -1)):
            slope = self.slope_of_stripes(f"100 {hand}")
            self.assertAlmostEqual(slope, sign * math.pi * 0.1, delta=0.04, msg=hand)
        turning = self.slope_of_stripes("100 Z rotate")
        self.assertAlmostEqual(turning, math.pi * 0.1, delta=0.04)

    def test_ends_are_lighter(self):
        side, end = (
            self.picture(fabric(("a", RED, "-2 0 0", "2 0 0", "")), "--from", view, "--flat")[100][100][1]
            for view in ("front", "side")
        )
        self.assertGreater(end, side + 20)

    def test_angles_are_the_named_views(self):
        text = fabric(*CROSS, ("up", GREY, "1 2 0", "1 2 3", ""))
        for view, angles in (("front", (0, 0)), ("side", (90, 0)), ("back", (180, 0)), ("top", (0, 90))):
            named = self.picture(text, "--from", view, "--flat")
            turned = self.picture(text, "--azimuth", angles[0], "--elevation", angles[1], "--flat")
            different = sum(
                max(abs(a - b) for a, b in zip(p, q)) > 8 for one, two in zip(named, turned) for p, q in zip(one, two)
            )
            self.assertLess(different, 20, view)
        turned = self.picture(text, "--azimuth", 90, "--flat")
        self.assertEqual(turned, self.picture(text, "--azimuth", -270, "--flat"))

    def test_zoom_is_of_the_middle(self):
        rod = fabric(("a", "0 0 0", "-8 0 0", "8 0 0", ""))

        def thickness(*options):
            return sum(row[100][1] < 128 for row in self.picture(rod, "--flat", *options))

        once = thickness()
        self.assertAlmostEqual(thickness("--zoom", 4), 4 * once, delta=4)

    def test_some_yarns_alone(self):
        rows = self.picture(fabric(*CROSS), "--yarns", "und*")
        self.assertEqual(rows[100][100].index(max(rows[100][100])), 2)
        both = self.picture(fabric(*CROSS), "--yarns", "under", "over")
        self.assertEqual(both, self.picture(fabric(*CROSS)))
        self.assertIn(
            "no yarn has a name like 'x*'",
            self.fails(1, "view", self.folder / "in.txt", "--yarns", "x*", "-o", self.folder / "y.png"),
        )

    def test_background(self):
        self.assertEqual(self.picture(fabric(*CROSS), "--background", "1,20,255")[0][0], (1, 20, 255))

    def test_the_same_bytes_with_any_number_of_threads(self):
        for threads in (1, 2, 5):
            self.succeeds(
                "view", PATH, "-o", self.folder / f"{threads}.png", "-j", threads, "--size", "300x200", "--from", "iso"
            )
        self.assertEqual(len(set(files_below(self.folder).values())), 1)


# Four picks of five ends, like none of its mirror images and turns.
ROWS = ["10010", "01100", "10100", "00111"]
WEAVE = "fabric 1\nthread a\n diameter 0.4\n{}end\nthread b\n diameter 0.4\n{}end\nweave\n warp a {} pitch 1\n weft b {} pitch 1\n {}\nend\n"


def is_blue(pixel):
    return pixel[2] > 1.2 * pixel[0]


class Upright(Base):
    """A weave as its draft is drawn: the warp upright, the first weft above, the first warp on the left."""

    def crossings(self, text, ends, picks, *options):
        """What is on top of each crossing, row by row of the picture: 1 where it is blue, which is the warp."""
        step = 40
        width, height = (round(step * n / 0.92) for n in (ends, picks))
        side = max(width, height)
        rows = self.picture(text, "--flat", *options, size=f"{side}x{side}")
        unit = 0.92 * side / max(ends, picks)

        def place(k, count):
            return round(side / 2 + (k + 0.5 - count / 2) * unit)

        return [
            "".join(str(int(is_blue(rows[place(j, picks)][place(i, ends)]))) for i in range(ends)) for j in range(picks)
        ]

    def weave(self, draft, ends, picks, colors=(" color 40 40 200\n", " color 200 40 40\n")):
        return WEAVE.format(*colors, ends, picks, draft)

    def test_the_rows_of_a_draft(self):
        text = self.weave("draft\n  " + "\n  ".join(ROWS) + "\n end", 5, 4)
        self.assertEqual(self.crossings(text, 5, 4), ROWS)
        self.assertEqual(self.crossings(text, 5, 4, "--from", "plan"), ROWS)
        # Seen with x to the right and y up it is the same cloth, turned and not mirrored.
        top = self.crossings(text, 4, 5, "--from", "top")
        turned = ["".join(ROWS[j][4 - i] for j in range(4)) for i in range(5)]
        self.assertEqual(top, turned)

    def test_a_z_twill_rises_to_the_right(self):
        for hand, step in (("Z", 1), ("S", -1)):
            rows = self.crossings(self.weave(f"draft twill 3/1 {hand}", 8, 8), 8, 8)
            self.assertEqual({row.count("1") for row in rows}, {6})
            for upper, lower in zip(rows, rows[1:]):
                self.assertEqual(upper, lower[-step:] + lower[:-step], (hand, rows))

    def test_by_the_colours_of_the_roles(self):
        text = self.weave("draft\n  " + "\n  ".join(ROWS) + "\n end", 5, 4, ("", ""))
        self.assertEqual(self.crossings(text, 5, 4), ROWS)

    def test_some_yarns_are_turned_as_all_are(self):
        text = self.weave("draft plain", 4, 2)
        rows = self.picture(text, "--flat", "--yarns", "weft_*", size="400x400")
        # Two wefts from left to right: white between them in the middle column, none in their rows.
        middle = [row[200] != (255, 255, 255) for row in rows]
        self.assertGreater(sum(middle), 20)
        self.assertGreater(max(sum(pixel != (255, 255, 255) for pixel in row) for row in rows), 350)
        self.assertLess(sum(middle), 200)

    def test_wales_and_warps_along_y_stand_as_they_are(self):
        for sample in ("jersey.txt", "warpknit_tricot.txt", "braid_flat3.txt"):
            text = (SAMPLES / sample).read_text()
            self.assertEqual(self.picture(text), self.picture(text, "--from", "top"), sample)
        text = fabric(("a", RED, "0 -2 0", "0.3 2 0", "role warp"), ("b", BLUE, "-1 0 1", "1 0 1", "role weft"))
        self.assertEqual(self.picture(text), self.picture(text, "--from", "top"))
        # By hand, with a warp along x.
        text = fabric(("a", RED, "-2 0 0", "2 0.3 0", "role warp"), ("b", BLUE, "1 -1 1", "1 1 1", "role weft"))
        rows = self.picture(text)
        self.assertEqual(rows[12][100].index(max(rows[12][100])), 0)
        below = [k for k in range(200) if is_blue(rows[k][80])]
        self.assertGreater(min(below), 120)  # x is downwards


class Colors(Base):
    def test_roles_where_the_text_gives_none(self):
        # A section shows the very colour.
        yarns = [
            ("warp", (46, 98, 150)),
            ("weft", (205, 140, 52)),
            ("wale", (72, 128, 92)),
            ("course", (58, 130, 140)),
            ("braider", (150, 84, 120)),
            ("axial", (120, 116, 66)),
            ("binder", (176, 72, 60)),
            ("other", (140, 146, 150)),
        ]
        text = "fabric 1\nthread t\n diameter 1\nend\n" + "".join(
            f"yarn y{k} t\n role {role}\n path\n  -2 {2 * k} 0\n  2 {2 * k} 0\n end\nend\n"
            for k, (role, _) in enumerate(yarns)
        )
        rows = self.picture(text, "--section", "x=0", size="800x200")
        unit = 0.5 * (800 - 16) / 7.5  # y from -0.5 to 14.5
        for k, (role, color) in enumerate(yarns):
            shade = 1 if k % 2 == 0 else 1.14
            seen = rows[100][round(400 + (2 * k - 7) * unit)]
            self.assertLess(max(abs(min(255, shade * c) - s) for c, s in zip(color, seen)), 1, (role, seen))
        # What the text says stays.
        text = text.replace(" diameter 1\n", " diameter 1\n color 200 200 200\n")
        self.assertEqual(
            self.picture(text, "--section", "x=0", size="800x200")[100][round(400 - 7 * unit)], (200, 200, 200)
        )

    @unittest.skipUnless(HAS_PAGES, NO_PAGES)
    def test_the_page_has_the_same(self):
        self.succeeds("view", SAMPLES / "weave_plain.txt", "-o", self.folder / "x.html", "--contacts", "no")
        text = (self.folder / "x.html").read_text()
        data = json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1])["yarns"]
        self.assertEqual(data["role_colors"][data["roles"].index("warp")], [[46, 98, 150], [52, 112, 171]])


class Sections(Base):
    ROD = fabric(("a", RED, "-2 0 0", "2 0 0", ""))

    def full(self, rows, color=(200, 40, 40)):
        """How much is filled with it: its dark rim, too, by half pixels of it."""
        return sum(pixel == color for row in rows for pixel in row)

    def test_across_a_yarn_is_a_disc(self):
        rows = self.picture(self.ROD, "--section", "x=0.3", size="400x400")
        self.assertEqual(rows[200][200], (200, 40, 40))
        across = sum(pixel != (255, 255, 255) for pixel in rows[200])
        # As wide as the yarn's end; the rim is a pixel and a half wide or so.
        end = self.picture(self.ROD, "--from", "side", size="400x400")
        self.assertAlmostEqual(across, sum(pixel != (255, 255, 255) for pixel in end[200]), delta=2)
        self.assertGreater(across, 300)
        self.assertAlmostEqual(2 * math.sqrt(self.full(rows) / math.pi), across - 3, delta=2)

    def test_along_a_yarn_is_as_wide_as_its_chord(self):
        for z in (0, 0.3, -0.4):
            rows = self.picture(self.ROD, "--section", f"z={z}", "--from", "top", size="600x200")
            unit = (600 - 16) / 4
            filled = sum(row[300] == (200, 40, 40) for row in rows)
            self.assertAlmostEqual(filled / unit, 2 * math.sqrt(0.25 - z * z) - 3 / unit, delta=0.03, msg=z)

    def test_the_side_of_the_eye_goes(self):
        for view, place, color in (("top", "-0.6", (40, 40, 200)), ("bottom", "0.6", (200, 40, 40))):
            rows = self.picture(fabric(*CROSS), "--section", f"z={place}", "--from", view)
            self.assertEqual(rows[100][100], color)
        # Whole where the plane lies before it.
        rows = self.picture(fabric(*CROSS), "--section", "z=0.6", "--from", "top")
        self.assertEqual(rows[100][100], (200, 40, 40))
        self.assertTrue(is_blue(rows[20][100]))
        # Seen along the plane: the larger coordinates go.
        rows = self.picture(self.ROD, "--section", "x=0", "--from", "top")
        self.assertTrue(all(pixel == (255, 255, 255) for row in rows for pixel in row[102:]))
        self.assertTrue(any(pixel != (255, 255, 255) for row in rows for pixel in row[:98]))

    def test_oblique_views(self):
        rows = self.picture(self.ROD, "--section", "x=0", "--from", "iso")
        self.assertGreater(self.full(rows), 100)
        turned = self.picture(self.ROD, "--section", "x=0", "--azimuth", "90")
        side = self.picture(self.ROD, "--section", "x=0", "--from", "side")
        self.assertLess(
            sum(max(abs(a - b) for a, b in zip(p, q)) > 8 for one, two in zip(turned, side) for p, q in zip(one, two)),
            20,
        )

    def test_what_is_left_lies_in_the_light(self):
        # Nothing that was cut away shades what is left.
        pins = [
            (f"p{x}{y}", GREY, f"{x}3.9 {y}1.4 -0.5", f"{x}3.9 {y}1.4 0.6", "diameter 0.1") for x in "+-" for y in "+-"
        ]
        pins = [(name.replace("+", "a").replace("-", "b"), *rest) for name, *rest in pins]
        low = ("low", GREY, "-3.5 0 0", "3.5 0 0", "")
        covers = [(f"h{k}", RED, f"-3.5 {0.9 * k - 0.9} 2", f"3.5 {0.9 * k - 0.9} 2", "") for k in range(3)]
        free, uncovered = (
            self.picture(fabric(low, *pins, *more), "--section", "z=0.45", "--from", "top", size="400x200")
            for more in ((), covers)
        )
        different = sum(
            max(abs(a - b) for a, b in zip(p, q)) > 8 for one, two in zip(free, uncovered) for p, q in zip(one, two)
        )
        self.assertLess(different, 20)
        self.assertNotEqual(free, self.picture(fabric(low, *pins, *covers), "--from", "top", size="400x200"))

    def test_overlaps_are_marked(self):
        def count(gap, plane):
            rods = (("a", GREY, "-4 0 0", "4 0 0", ""), ("b", GREY, f"0 -4 {gap}", f"0 4 {gap}", ""))
            return sum(
                is_magenta(p)
                for row in self.picture(fabric(*rods), "--section", plane, "--from", "top", size="400x400")
                for p in row
            )

        self.assertEqual(count(1.0, "z=0.5"), 0)  # they touch there
        self.assertEqual(count(1.05, "z=0.4"), 0)
        self.assertGreater(count(0.9, "z=0.45"), 20)
        self.assertGreater(count(0.5, "z=0.25"), count(0.9, "z=0.45"))

    def test_a_yarn_in_itself_is_marked_otherwise(self):
        crossing = "fabric 1\nyarn a\n diameter 1\n path polyline\n -3 -2 0\n 3 2 0\n 3 -2 0\n -3 2 0\n end\nend\n"
        rows = self.picture(crossing, "--section", "z=0.1")
        r, g, b = rows[100][100]
        self.assertGreater(r, 2 * b)
        self.assertGreater(g, 1.5 * b)
        self.assertEqual(rows[100][180], (140, 146, 150))

    def test_a_ring_is_cut_twice(self):
        self.succeeds(
            "view", RING, "--section", "x=0", "-o", self.folder / "x.png", "--no-scale-bar", "--size", "400x300"
        )
        row = decode((self.folder / "x.png").read_bytes())[2][150]
        color = (140, 146, 150)  # of a yarn without a role
        runs = re.findall("1{8,}", "".join(str(int(pixel == color)) for pixel in row))
        # What is behind them may have it, too.
        self.assertAlmostEqual(len(runs[0]), len(runs[-1]), delta=1)
        self.assertGreater(len(runs[0]), 25)

    def test_refusals(self):
        self.picture(self.ROD)
        source, target = self.folder / "in.txt", self.folder / "y.png"
        for word in ("w=0", "z", "z=", "z=low", "z=nan", "=1", "", "z=0mm"):
            self.assertRegex(
                self.fails(2, "view", source, "-o", target, "--section", word), "is no section; it is x=, y= or z="
            )
        message = self.fails(1, "view", source, "-o", target, "--section", "z=0.7")
        self.assertRegex(message, r"the section z=0\.7 cuts no yarn; they reach from -0\.50*\d? to 0\.50*\d?\n")
        self.assertIn("cuts no yarn", self.fails(1, "view", source, "-o", target, "--section", "x=-2.1"))
        self.assertIn(
            "--section is of pictures", self.fails(1, "view", source, "-o", self.folder / "y.html", "--section", "z=0")
        )
        self.assertEqual(sorted(files_below(self.folder)), ["in.txt", "x.png"])

    def test_the_same_bytes_with_any_number_of_threads(self):
        for threads in (1, 2, 5):
            self.succeeds(
                "view",
                PATH,
                "-o",
                self.folder / f"{threads}.png",
                "-j",
                threads,
                "--size",
                "300x200",
                "--from",
                "iso",
                "--section",
                "y=1",
            )
        self.assertEqual(len(set(files_below(self.folder).values())), 1)


class ScaleBar(Base):
    def foot(self, text, *options, size="800x600", ground=(255, 255, 255)):
        """The parts of its ink, the bar first; the picture."""
        rows = self.picture(text, "--flat", *options, size=size, bar=True)
        width, height = map(int, size.split("x"))
        ink = {
            (x, y) for y in range(round(height * 0.9), height) for x in range(width) if self.is_ink(rows[y][x], ground)
        }
        return self.parts(ink), rows

    @staticmethod
    def is_ink(pixel, ground):
        return max(abs(a - b) for a, b in zip(pixel, ground)) > 100

    @staticmethod
    def parts(ink):
        """Connected ones, from left to right: (left, right, top, bottom)."""
        found = []
        while ink:
            todo, part = [ink.pop()], []
            while todo:
                x, y = todo.pop()
                part.append((x, y))
                for near in [(x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]:
                    if near in ink:
                        ink.remove(near)
                        todo.append(near)
            found.append(
                (min(x for x, _ in part), max(x for x, _ in part), min(y for _, y in part), max(y for _, y in part))
            )
        return sorted(found)

    def rod(self, length, units="mm"):
        text = fabric(("a", "0 0 0", f"-{length / 2} 0 0", f"{length / 2} 0 0", ""))
        return text.replace("fabric 1\n", f"fabric 1\nunits {units}\n").replace("diameter 1", f"diameter {length / 8}")

    def test_its_length_is_round_and_true(self):
        # A rod of a known length fills the picture's width but for 4 % of the smaller side of what is above the foot.
        for length, units, bar, signs in (
            (4, "mm", 1, 3),
            (9.9, "mm", 2, 3),
            (21, "mm", 5, 3),
            (0.004, "mm", 0.001, 3),
            (4, "cm", 1, 4),
            (1, "inch", 0.2, 8),
            (1.7, "m", 0.2, 5),
            (200, "um", 50, 4),
            (2, "mm", 0.5, 5),
            (5, "m", 1, 2),
        ):
            with self.subTest(f"{length} {units}"):
                parts, rows = self.foot(self.rod(length, units))
                left, right = parts[0][:2]
                dark = [x for x in range(800) if rows[250][x][1] < 128]
                unit = (max(dark) - min(dark) + 1) / length
                self.assertAlmostEqual((right - left + 1) / unit / bar, 1, delta=0.01)
                # "1 mm": three signs; of an i two parts.
                self.assertEqual(len(parts) - 1, signs, parts)

    def test_it_is_below_what_is_shown(self):
        parts, rows = self.foot(self.rod(4))
        whole = self.picture(self.rod(4), "--flat", size="800x600")
        self.assertEqual(len(rows), 600)
        top = min(part[2] for part in parts)
        dark = [y for y in range(600) if any(pixel[1] < 128 for pixel in rows[y][390:410])]
        self.assertLess(max(y for y in dark if y < 0.9 * 600), top - 5)
        self.assertEqual(sum(pixel[1] < 128 for row in whole[-40:] for pixel in row), 0)
        # Zoomed in, the yarn ends above it.
        _, rows = self.foot(self.rod(4), "--zoom", "20")
        self.assertEqual(rows[540][700], (0, 0, 0))
        self.assertEqual(rows[590][700], (255, 255, 255))

    def test_it_is_readable_at_any_size(self):
        for size in ("1200x900", "4000x3000", "300x200"):
            parts, _ = self.foot(self.rod(4), size=size)
            height = int(size.split("x")[1])
            letters = parts[1:]
            self.assertEqual(len(letters), 3)
            self.assertGreaterEqual(max(low - top for _, _, top, low in letters) + 1, max(8, 0.02 * height), size)
        # Light on dark.
        parts, _ = self.foot(
            self.rod(4).replace("0 0 0\n role", "").replace("color 0 0 0", "color 200 200 200"),
            "--background",
            "0,0,60",
            ground=(0, 0, 60),
        )
        self.assertEqual(len(parts), 4)

    def test_small_pictures_have_none(self):
        self.assertEqual(self.picture(self.rod(4), size="60x40", bar=True), self.picture(self.rod(4), size="60x40"))


class Meshes(Case):
    """Decks and Gmsh meshes of a cloth are seen as the same mesh in VTU is."""

    def test_decks_and_gmsh(self):
        self.succeeds("mesh", PATH, "--to", "vtu,inp,msh", "-o", f"{self.out}/")
        pictures = []
        for ending in ("vtu", "inp", "msh"):
            path = self.folder / f"{ending}.png"
            self.succeeds("view", self.out / f"plain4_path.{ending}", "-o", path, "--size", "240x180")
            pictures.append(path.read_bytes())
        self.assertEqual(pictures[0], pictures[1])
        self.assertEqual(pictures[0], pictures[2])

    def test_meshes_of_other_programs(self):
        """Gmsh's version 2.2, a surface alone, and what cannot be shown."""
        old = (
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
            "$Elements\n2\n1 15 2 0 1 1\n2 4 2 7 1 1 2 3 4\n$EndElements\n"
        )
        shell = "*Node\n1, 0, 0, 0\n2, 1, 0, 0\n3, 1, 1, 0\n4, 0, 1, 0\n*Element, type=S4R\n1, 1, 2, 3, 4\n"
        for name, text, said in (
            ("old.msh", old, None),
            ("shell.inp", shell, None),
            ("binary.msh", old.replace("2.2 0 8", "4.1 1 8"), "this mesh is binary: save it as text"),
            ("version.msh", old.replace("2.2 0 8", "4 0 8"), "the version 4 of Gmsh's format is not read"),
            ("node.msh", old.replace("2 3 4\n$End", "2 3 9\n$End"), ":14:1: error: element 2 has the node 9"),
            ("node.inp", shell.replace("1, 2, 3, 4\n", "1, 2, 3, 9\n"), ":7:1: error: element 1 has the node 9"),
            ("beams.inp", shell.replace("S4R", "B31"), "no element that is a surface or a solid"),
            ("split.inp", "*HEADING\n*INCLUDE, INPUT=a_mesh.inp\n", "this deck takes in 'a_mesh.inp': view that file"),
        ):
            with self.subTest(name):
                path = self.folder / name
                path.write_text(text)
                if said is None:
                    self.succeeds("view", path, "-o", self.folder / "seen.png", "--size", "80x60")
                else:
                    self.assertIn(said, self.fails(1, "view", path, "-o", self.folder / "seen.png"))


class Files(Case):
    def test_several_inputs(self):
        self.succeeds("view", GRID, RING, "-o", self.out, "--size", "40x30")
        self.assertEqual(sorted(files_below(self.out)), ["plain4_grid.png", "ring.png"])
        self.assertIn("names one file", self.fails(2, "view", GRID, RING, "-o", self.folder / "x.png"))

    def test_beside_the_input_and_standard_output(self):
        shutil.copy(GRID, self.folder / "a.txt")
        self.succeeds("view", self.folder / "a.txt", "--size", "40x30")
        self.assertEqual(decode((self.folder / "a.png").read_bytes())[:2], (40, 30))
        done = subprocess.run([PROGRAM, "view", GRID, "-o", "-", "--size", "40x30"], capture_output=True)
        self.assertEqual(done.stdout, (self.folder / "a.png").read_bytes())

    def test_resume_goes_by_the_options_too(self):
        report, picture = self.folder / "r.json", self.folder / "x.png"

        def again(*options):
            return self.succeeds(
                "view", GRID, "-o", picture, "--size", "40x30", "--report", report, "--resume", *options
            ).stderr

        again()
        self.assertIn("up to date", again())
        self.assertNotIn("up to date", again("--from", "iso"))

    def test_what_cannot_be_shown(self):
        self.fails(1, "view", BAD / "misspelt.txt", "-o", self.folder / "x.png")
        piece = self.fails(1, "view", SAMPLES / "back_piece.txt", "-o", self.folder / "x.png")
        self.assertIn("no yarn to show", piece)
        self.assertEqual(files_below(self.folder), {})


if __name__ == "__main__":
    unittest.main()
