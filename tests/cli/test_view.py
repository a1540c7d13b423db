"""Pictures: their bytes, and what is to be seen in them."""

import math
import shutil
import struct
import unittest
import zlib

from program import BAD, Case, GRID, PATH, RING, files_below, run


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

    def test_the_same_bytes_with_any_number_of_threads(self):
        for threads in (1, 2, 5):
            self.succeeds("view", PATH, "-o", self.folder / f"{threads}.png", "-j", threads, "--size", "300x200",
                          "--from", "iso")
        self.assertEqual(len(set(files_below(self.folder).values())), 1)


if __name__ == "__main__":
    unittest.main()
