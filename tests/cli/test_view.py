"""Pictures: their bytes, and what is to be seen in them."""

import math
import shutil
import struct
import subprocess
import unittest
import zlib

from program import BAD, Case, GRID, PATH, PROGRAM, RING, SAMPLES, files_below


def decode(data):
    """(width, height, rows of (r, g, b)) of an 8-bit RGB PNG, by the PNG specification alone."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n", data[:8]
    at, packed, header = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0] == zlib.crc32(kind + body)
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
        form, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, up = line[i - 3] if i >= 3 else 0, before[i]
            corner = before[i - 3] if i >= 3 else 0
            if form == 4:
                guess = min((left, up, corner), key=lambda value: abs(left + up - corner - value))
            else:
                guess = (0, left, up, (left + up) // 2)[form]
            line[i] = (line[i] + guess) & 255
        rows.append([tuple(line[i:i + 3]) for i in range(0, stride, 3)])
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


class Pictures(Case):
    def picture(self, text, *options, size="200x200"):
        path = self.folder / "in.txt"
        path.write_text(text)
        self.succeeds("view", path, "-o", self.folder / "x.png", "--size", size, *options)
        width, height, rows = decode((self.folder / "x.png").read_bytes())
        self.assertEqual(f"{width}x{height}", size)
        return rows

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
                return sum((lower[x] - upper[x + shift])**2 for x in range(150 - half, 150 + half))
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
        side, end = (self.picture(fabric(("a", RED, "-2 0 0", "2 0 0", "")), "--from", view, "--flat")[100][100][1]
                     for view in ("front", "side"))
        self.assertGreater(end, side + 20)

    def test_angles_are_the_named_views(self):
        text = fabric(*CROSS, ("up", GREY, "1 2 0", "1 2 3", ""))
        for view, angles in (("front", (0, 0)), ("side", (90, 0)), ("back", (180, 0)), ("top", (0, 90))):
            named = self.picture(text, "--from", view, "--flat")
            turned = self.picture(text, "--azimuth", angles[0], "--elevation", angles[1], "--flat")
            different = sum(max(abs(a - b) for a, b in zip(p, q)) > 8 for one, two in zip(named, turned) for p, q in zip(one, two))
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
        self.assertIn("no yarn has a name like 'x*'", self.fails(1, "view", self.folder / "in.txt", "--yarns", "x*", "-o", self.folder / "y.png"))

    def test_background(self):
        self.assertEqual(self.picture(fabric(*CROSS), "--background", "1,20,255")[0][0], (1, 20, 255))

    def test_the_same_bytes_with_any_number_of_threads(self):
        for threads in (1, 2, 5):
            self.succeeds("view", PATH, "-o", self.folder / f"{threads}.png", "-j", threads, "--size", "300x200",
                          "--from", "iso")
        self.assertEqual(len(set(files_below(self.folder).values())), 1)


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
            return self.succeeds("view", GRID, "-o", picture, "--size", "40x30", "--report", report, "--resume", *options).stderr
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
