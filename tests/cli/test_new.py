"""`selvage new`: every text is built without a warning, is sound, and comes back from what was written."""

import os
import re
import unittest

from program import Case, run


def kinds():
    return re.findall(r"^  (\w+)  +\S", run("new").stdout, re.MULTILINE)[1:]


class New(Case):
    def test_kinds(self):
        lines = self.succeeds("new").stdout.splitlines()
        self.assertGreater(len(kinds()), 12)
        self.assertEqual(len(lines), len(kinds()) + 1)
        for kind in kinds():
            text = self.succeeds("new", kind).stdout
            first = text.splitlines()[0]
            self.assertTrue(first.startswith("# "), kind)
            self.assertIn(first[2:], "\n".join(lines), kind)
            self.assertRegex(text, r"(?m)^fabric 1$")
            self.assertGreater(text.count("#"), 1, f"{kind} explains nothing")

    def test_every_kind_is_sound(self):
        for kind in kinds():
            self.succeeds("new", kind, "-o", self.folder / f"{kind}.txt")
        texts = sorted(self.folder.glob("*.txt"))
        self.assertEqual(len(texts), len(kinds()))
        done = self.succeeds("check", "--strict", "--no-progress", *texts)
        self.assertEqual(done.stderr, "", "a text to begin with has no warning")
        self.assertEqual(len(re.findall(r"(?m)^  sound: ", done.stdout)), len(texts), done.stdout)
        done = self.succeeds("convert", "--strict", "--no-progress", *texts, "--to", "iges", "-o", self.out)
        self.assertNotRegex(done.stderr, "warning|error")
        for path in texts:
            # The piece has no yarns, but an outline.
            self.assertGreater(len((self.out / f"{path.stem}.igs").read_bytes()), 5000, path.name)

    def test_the_cell_is_meshed_as_it_says(self):
        text = self.succeeds("new", "cell").stdout
        (self.folder / "cell.txt").write_text(text)
        command = re.search(r"# selvage (mesh .*)", text)[1].replace("FILE", "cell.txt").split()
        self.succeeds(*command, "--voxel", "12", cwd=self.folder)
        self.assertIn("*EQUATION", (self.folder / "cell.inp").read_text().upper())

    def test_a_param_of_the_yarns_moves_them(self):
        # At half = 0.15 the yarns of 0.3 touch: less overlaps, by what is missing.
        path = self.folder / "yarns.txt"
        path.write_text(self.succeeds("new", "yarns").stdout)
        done = run("check", path, "--set", "half=0.14")
        self.assertEqual(done.returncode, 3)
        self.assertAlmostEqual(float(re.search(r"overlap, ([0-9.]+) mm deep", done.stderr)[1]), 0.02, delta=1e-3)

    def test_unknown_kind(self):
        self.assertRegex(self.fails(2, "new", "denmi"), "no text of the kind 'denmi'; did you mean 'denim'")
        self.assertNotIn("did you mean", self.fails(2, "new", "qqqqqqqq"))

    def test_a_file_that_is_there_stays(self):
        path = self.folder / "mine.txt"
        path.write_text("mine")
        self.assertRegex(self.fails(2, "new", "plain", "-o", path), "mine.txt: error: it is there already")
        self.assertEqual(path.read_text(), "mine")
        dangling = self.folder / "link.txt"
        os.symlink(self.folder / "nowhere", dangling)
        self.fails(2, "new", "plain", "-o", dangling)
        self.succeeds("new", "plain", "-o", self.folder / "below" / "new.txt")
        self.assertEqual(
            (self.folder / "below" / "new.txt").read_text(), self.succeeds("new", "plain", "-o", "-").stdout
        )


if __name__ == "__main__":
    unittest.main()
