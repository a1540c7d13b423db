"""`selvage edit`: one line more, no other byte changed, and nothing written when the yarn cannot be moved so."""

import json
import os
import re
import unittest

from program import Case, GRID, PATH, SAMPLES, files_below, run

TEXT = """fabric 1
# a wave
thread t
  diameter 0.2
end
yarn a t
  path uniform
    0 0 0
    1 0 0.2
    2 0 0
    3 0 -0.2
    4 0 0
    5 0 0.2
    6 0 0
  end
end   # of a
title "later"
yarn "b 2" t
  path chord
    0 2 0
    1 2 0.2
    2 2 0
  end
end
"""
MOVE = ("--yarn", "a", "--point", "4", "--to", "3.0,0.10,+.2")
LINE = "edit a point 4 to 3.0 0.10 +.2"


class Editing(Case):
    def setUp(self):
        super().setUp()
        self.input = self.folder / "in.txt"

    def edited(self, data, *arguments):
        """The bytes that come of these bytes."""
        self.input.write_bytes(data)
        output = self.folder / "edited.txt"
        self.succeeds("edit", self.input, *arguments, "-o", output)
        self.assertEqual(self.input.read_bytes(), data)
        return output.read_bytes()

    def refused(self, code, pattern, *arguments, data=TEXT):
        self.input.write_text(data)
        before = files_below(self.folder)
        message = self.fails(code, "edit", self.input, *arguments)
        self.assertRegex(message, pattern)
        self.assertEqual(files_below(self.folder), before, "an error must write nothing")
        return message

    def length(self, path, yarn):
        report = json.loads(self.succeeds("info", path, "--json").stdout)
        return next(y["length"] for y in report["inputs"][0]["yarns"] if y["name"] == yarn)


class Bytes(Editing):
    def test_the_line_stands_behind_its_yarn(self):
        whole = TEXT.replace("end   # of a\n", f"end   # of a\n{LINE}\n")
        self.assertEqual(self.edited(TEXT.encode(), *MOVE).decode(), whole)

    def test_line_ends_mark_and_last_line_are_kept(self):
        crlf = TEXT.replace("\n", "\r\n").encode()
        self.assertEqual(self.edited(crlf, *MOVE), crlf.replace(b"of a\r\n", f"of a\r\n{LINE}\r\n".encode()))
        marked = b"\xef\xbb\xbf" + TEXT.encode()
        self.assertEqual(self.edited(marked, *MOVE), marked.replace(b"of a\n", f"of a\n{LINE}\n".encode()))
        for data, end in ((TEXT.encode(), b"\n"), (crlf, b"\r\n")):
            cut = data[: data.index(b"title")].rstrip()
            self.assertEqual(self.edited(cut, *MOVE), cut + end + LINE.encode())
        mixed = TEXT.replace("of a\n", "of a\r\n").encode()
        self.assertEqual(self.edited(mixed, *MOVE), mixed.replace(b"of a\r\n", f"of a\r\n{LINE}\r\n".encode()))

    def test_behind_the_edits_that_are_there(self):
        first = self.edited(TEXT.encode(), "--yarn", "b 2", "--point", "2", "--length", "3.0", "--along", "0,0,1e0")
        self.assertEqual(first.decode(), TEXT + 'edit "b 2" length 3.0 point 2 along 0 0 1e0\n')
        self.assertEqual(self.edited(first, *MOVE), first + LINE.encode() + b"\n")
        # An edit may stand before what it names: the new one does not.
        early = TEXT.replace("# a wave", "edit a point 2 to 1 0 0.3")
        self.assertEqual(self.edited(early.encode(), *MOVE).decode(), early.replace("of a\n", f"of a\n{LINE}\n"))

    def test_in_place_and_through_pipes(self):
        self.input.write_text(TEXT)
        whole = self.edited(TEXT.encode(), *MOVE)
        old = os.stat(self.input).st_ino
        self.succeeds("edit", self.input, *MOVE, "-o", self.input)
        self.assertEqual(self.input.read_bytes(), whole)
        self.assertNotEqual(os.stat(self.input).st_ino, old, "the old file is replaced, not written into")
        self.assertEqual(run("edit", "-", *MOVE, "-o", "-", input=TEXT).stdout.encode(), whole)


class Meaning(Editing):
    def test_to_a_length(self):
        self.edited(TEXT.encode(), "--yarn", "a", "--point", "4", "--length", "8.25", "--along", "0,0,-1")
        self.assertAlmostEqual(self.length(self.folder / "edited.txt", "a"), 8.25, delta=1e-9)

    def test_the_edited_text_is_the_written_one(self):
        """What was added is what reading it gives: convert writes the same edit."""
        self.edited(TEXT.encode(), *MOVE)
        again = self.folder / "again.txt"
        self.succeeds("convert", self.folder / "edited.txt", "-o", again)
        self.assertIn("edit a point 4 to 3 0.1 0.2\n", again.read_text())

    def test_by_weight(self):
        flat = TEXT.replace("1 0 0.2", "1 0 0.6").replace("5 0 0.2", "5 0 0.6")
        message = self.refused(
            1,
            "nearest point that they reach is",
            "--yarn",
            "a",
            "--point",
            "3",
            "--to",
            "2,0.5,0.1",
            "--by",
            "weight",
            "-o",
            self.out,
            data=flat,
        )
        self.assertIn("0.5 off the plane", message)
        nearest = re.search(r"they reach is \(([^)]*)\)", message)[1].replace(" ", "")
        self.edited(flat.encode(), "--yarn", "a", "--point", "3", "--to", nearest, "--by", "weight")
        self.assertIn(f"edit a weight 3 to {nearest.replace(',', ' ')}\n", (self.folder / "edited.txt").read_text())
        self.succeeds("check", self.folder / "edited.txt")

    def test_a_yarn_of_a_construction(self):
        """The line stands behind the block, and the yarn next to it keeps its length."""
        jersey = (SAMPLES / "jersey.txt").read_bytes()
        data = self.edited(jersey, "--yarn", "course_2", "--point", "5", "--length", "14", "--along", "0,1,0")
        self.assertEqual(data, jersey + b"edit course_2 length 14 point 5 along 0 1 0\n")
        edited = self.folder / "edited.txt"
        self.assertAlmostEqual(self.length(edited, "course_2"), 14, delta=1e-7)
        self.assertEqual(self.length(edited, "course_3"), self.length(SAMPLES / "jersey.txt", "course_3"))
        message = self.fails(1, "edit", edited, "--yarn", "coarse_2", "--point", "5", "--to", "1,1,1", "-o", self.out)
        self.assertIn("did you mean 'course_2'?", message)

    def test_a_yarn_that_folds_is_told(self):
        self.input.write_text(TEXT)
        done = self.succeeds("edit", self.input, "--yarn", "a", "--point", "4", "--to", "3,0,4", "-o", self.out)
        self.assertIn("folds over itself", done.stderr)
        self.assertEqual(
            self.succeeds(
                "edit", self.input, "--yarn", "a", "--point", "4", "--to", "3,0,4", "-o", self.out, "--quiet"
            ).stderr,
            "",
        )


class Refusals(Editing):
    def test_what_cannot_be(self):
        self.refused(1, r"no yarn 'aa' to edit", "--yarn", "aa", "--point", "4", "--to", "1,1,1", "-o", self.out)
        self.refused(
            1,
            r"in\.txt:6:1: error: there is no joint 8: the centre line has 7",
            "--yarn",
            "a",
            "--point",
            "8",
            "--to",
            "1,1,1",
            "-o",
            self.out,
        )
        self.refused(
            1,
            r"joint 1: it is an end",
            "--yarn",
            "a",
            "--point",
            "1",
            "--to",
            "1,1,1",
            "--by",
            "weight",
            "-o",
            self.out,
        )
        self.refused(
            1,
            r"long at the shortest",
            "--yarn",
            "a",
            "--point",
            "4",
            "--length",
            "2",
            "--along",
            "0,0,1",
            "-o",
            self.out,
        )
        self.refused(1, r"straights and arcs", *MOVE, "-o", self.out, data=TEXT.replace("uniform", "polyline"))
        self.refused(1, r":4:3: error: .*diameter", *MOVE, "-o", self.out, data=TEXT.replace("diameter", "diametr"))
        self.assertRegex(
            self.fails(1, "edit", GRID, "--yarn", "warp1", "--point", "2", "--to", "1,1,1", "-o", self.out),
            r"is a grid: it has no centre line",
        )
        self.assertFalse(self.out.exists())

    def test_an_output_that_is_a_folder(self):
        """The text goes into it, by the input's name; a folder that is called like a file is in the way."""
        self.input.write_text(TEXT)
        self.out.mkdir()
        self.succeeds("edit", self.input, *MOVE, "-o", self.out)
        self.assertEqual(list(files_below(self.out)), ["in.txt"])
        (self.folder / "x.txt").mkdir()
        self.refused(1, "cannot write: Is a directory", *MOVE, "-o", self.folder / "x.txt")

    def test_what_is_not_fabric_txt(self):
        iges = self.folder / "x.igs"
        self.succeeds("convert", PATH, "-o", iges)
        self.assertIn("error: this is iges", self.fails(1, "edit", iges, *MOVE, "-o", self.out))
        self.assertIn("cannot open", self.fails(1, "edit", self.folder / "none.txt", *MOVE, "-o", self.out))
        self.assertFalse(self.out.exists())

    def test_the_command_line(self):
        at = ("--yarn", "a", "--point", "4")
        for pattern, *arguments in (
            (r"--output is required", *MOVE),
            ("name either --yarn NAME, or --piece NAME", "--point", "4", "--to", "1,1,1", "-o", self.out),
            ("--point", "--yarn", "a", "--point", "0", "--to", "1,1,1", "-o", self.out),
            ("--point", "--yarn", "a", "--point", "1.5", "--to", "1,1,1", "-o", self.out),
            ("either --to", *at, "-o", self.out),
            ("either --to", *MOVE, "--length", "3", "--along", "0,0,1", "-o", self.out),
            ("go together", *at, "--length", "3", "-o", self.out),
            ("go together", *at, "--along", "0,0,1", "-o", self.out),
            ("--by", *MOVE, "--by", "force", "-o", self.out),
            ("--by weight goes with --to", *at, "--length", "3", "--along", "0,0,1", "--by", "weight", "-o", self.out),
            ("--length 0", *at, "--length", "0", "--along", "0,0,1", "-o", self.out),
            ("no direction", *at, "--length", "3", "--along", "0,-0,0.0", "-o", self.out),
        ):
            self.assertRegex(self.refused(2, pattern, *arguments), "^selvage: error: ")
        for vector in ("1,1", "1,1,1,1", "1,1,x", "1,,1", "1,1,nan", "1,1,1e999", "1, 1,1", "1,1,+-1", "1,1,0x1"):
            self.refused(2, "three numbers", *at, f"--to={vector}", "-o", self.out)


if __name__ == "__main__":
    unittest.main()
