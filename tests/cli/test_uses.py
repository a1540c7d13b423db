"""Blocks and used files through the program: what is refused and where, round trips, what files hold, cells of repeats meshed."""

import json
import re
import unittest

from program import Case

WEAVE = """fabric 1
material glass
  density 2.5
  elastic isotropic 70000 0.2
end
thread roving
  section ellipse 1.1 0.3
  material glass
end
weave
  warp roving 2 pitch 1.5
  weft roving 2 pitch 1.5
  draft plain
end
"""
USES = """fabric 1
material epoxy
  density 1.2
  elastic isotropic 3400 0.35
end
use file parts/weave.txt as lower
end
use file parts/weave.txt as upper
  mirror x
  rotate 90
  place 3 3 0.72
end
"""
CELL = "cell repeat {}\n  matrix epoxy\nend\n"


class Uses(Case):
    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def setUp(self):
        super().setUp()
        self.write("parts/weave.txt", WEAVE)

    def test_a_file_below_is_read_where_files_are_contained(self):
        text = self.write("two.txt", USES)
        report = self.folder / "report.json"
        done = self.succeeds("check", text, "--sandbox", "require", "--report", report)
        self.assertIn("sound: every yarn is a closed valid solid, no two overlap", done.stdout)
        yarns = json.loads(report.read_text())["inputs"][0]["yarns"]
        self.assertEqual([yarn["name"] for yarn in yarns],
                         [f"{use}.{system}_{i}" for use in ("lower", "upper") for system in ("warp", "weft") for i in (1, 2)])
        volumes = {round(yarn["volume"], 9) for yarn in yarns}
        self.assertEqual(len(volumes), 1)

    def test_what_cannot_be_used_is_told_at_its_line(self):
        self.write("outside.txt", WEAVE)
        self.write("in/parts/weave.txt", WEAVE.replace("fabric 1\n", "fabric 1\nunits cm\n"))
        self.write("in/parts/bad.txt", WEAVE.replace("ellipse", "elipse"))
        self.write("in/parts/none.txt", "fabric 1\nthread t\n diameter 1\nend\n")
        self.write("in/parts/self.txt", "fabric 1\nuse file self.txt\nend\n")
        self.write("in/parts/a.txt", "fabric 1\nuse file ../main.txt\nend\n")
        for file, words in (("parts/missing.txt", "cannot open: No such file"),
                            ("parts", "not a regular file"),
                            ("../outside.txt", "--allow-outside"),
                            ("/dev/zero", "--allow-outside"),
                            ("parts/weave.txt", "its unit is cm, that of this text mm"),
                            ("parts/bad.txt", "it has errors"),
                            ("parts/none.txt", "it has no yarns"),
                            ("parts/self.txt", "it has errors"),
                            ("main.txt", "uses itself"),
                            ("parts/a.txt", "it has errors")):
            text = self.write("in/main.txt", f"fabric 1\n\n  use file {file}\n  end\n")
            said = self.fails(1, "convert", text, "-o", self.out)
            self.assertRegex(said, re.escape(str(text)) + ":3:3: error: the file '" + re.escape(file) + "' cannot be used: .*" +
                             re.escape(words))
        self.assertRegex(said, r"parts/a\.txt:2:1: error: the file '../main.txt' cannot be used: it uses itself")
        self.write("in/main.txt", "fabric 1\nuse file ../outside.txt\nend\n")
        self.succeeds("convert", text, "--allow-outside", "--to", "iges", "-o", self.out)

    def test_files_that_name_each_other_again_and_again_end_soon(self):
        """Two files a level, each used by both of the level above: 2^14 readings of files of 80 bytes."""
        levels = 14
        for level in range(levels):
            for side in "ab":
                self.write(f"deep/L{level}{side}.txt", f"fabric 1\nuse file L{level + 1}a.txt as x\nend\nuse file L{level + 1}b.txt as y\nend\n")
        for side in "ab":
            self.write(f"deep/L{levels}{side}.txt", WEAVE)
        for command in ("check", "info"):
            said = self.fails(1, command, self.folder / "deep" / "L0a.txt")
            self.assertRegex(said, r"L0a\.txt:[24]:1: error: the file 'L1[ab]\.txt' cannot be used: .* more than 10000 files")
            self.assertEqual(said.count("error:"), 1, said)

    def test_one_file_of_points_for_each_yarn(self):
        rows = "".join(f"t{i},{x / 10},{i},0\n" for i in range(50) for x in range(20))
        self.write("tows.csv", "yarn,x,y,z\n" + rows)
        yarns = "".join(f"yarn y{i} a\n points tows.csv yarn t{i}\nend\n" for i in range(50))
        text = self.write("tows.txt", "fabric 1\nthread a\n diameter 0.2\nend\n" + yarns)
        self.succeeds("info", text, "--sandbox", "require")
        self.write("long.csv", "yarn,x,y,z\n" + "".join(f"t,{x / 10},0,0\n" for x in range(20000)))
        again = "".join(f"yarn y{i} a\n points long.csv\nend\n" for i in range(200))
        text = self.write("again.txt", "fabric 1\nthread a\n diameter 0.2\nend\n" + again)
        said = self.fails(1, "info", text)
        self.assertRegex(said, r"again\.txt:\d+:\d+: error: no yarn in the file 'long\.csv': the files that this input names are read again and again")

    def test_many_blocks_and_uses(self):
        """Names of one kind do not cost the square of their number: a thousand of each are there at once."""
        yarn = "yarn y a\n path\n  0 0 0\n  1 0 0\n end\nend\n"
        head = "fabric 1\nthread a\n diameter 0.2\nend\n"
        chain = head + "block b0\n" + yarn + "end\n" + "".join(f"block b{i}\nuse b{i - 1}\nend\nend\n" for i in range(1, 1000))
        said = self.fails(1, "info", self.write("chain.txt", chain + "use b999\nend\n"))
        self.assertRegex(said, r"error: more than 100 blocks use each other in turn")
        same = head + "block b\n" + yarn + "end\n" + "".join(f"use b\nplace 0 {i} 0\nend\n" for i in range(1000))
        names = self.folder / "names.json"
        self.succeeds("info", self.write("same.txt", same), "--report", names)
        yarns = [one["name"] for one in json.loads(names.read_text())["inputs"][0]["yarns"]]
        self.assertEqual(yarns, ["b.y"] + [f"b_{i}.y" for i in range(2, 1001)])

    def test_overlaps_name_the_yarns_and_the_place(self):
        text = self.write("two.txt", USES.replace("0.72", "0.3"))
        said = self.fails(3, "check", text)
        self.assertRegex(said, r"yarns 'lower\.w\w+_\d' and 'upper\.w\w+_\d' overlap, [\d.]+ mm deep at \(")

    def test_written_out_it_stands_alone(self):
        text = self.write("two.txt", USES)
        alone = self.folder / "elsewhere" / "two.txt"
        self.succeeds("convert", text, "--to", "txt", "-o", alone)
        self.assertNotIn("use file", alone.read_text())
        self.succeeds("diff", text, alone)
        again = self.folder / "again" / "two.txt"
        self.succeeds("convert", alone, "--to", "txt", "-o", again)
        self.assertEqual(alone.read_bytes(), again.read_bytes())
        self.succeeds("roundtrip", text)

    def test_moved_yarns_are_instances(self):
        text = self.write("two.txt", USES)
        sizes = []
        for words in ([], ["--instances"]):
            self.succeeds("convert", text, *words, "-o", self.folder / f"out{len(words)}" / "two.igs")
            sizes.append((self.folder / f"out{len(words)}" / "two.igs").stat().st_size)
        self.assertLess(sizes[1], 0.55 * sizes[0])
        self.succeeds("diff", self.folder / "out0" / "two.igs", self.folder / "out1" / "two.igs", "--tolerance", "1e-8")

    def test_edits_belong_into_the_block(self):
        text = self.write("two.txt", USES)
        said = self.fails(1, "edit", text, "--yarn", "lower.warp_1", "--point", "2", "--to", "1,1,1", "-o", self.folder / "e.txt")
        self.assertIn("is one of a block", said)

    def test_relaxed_yarns_keep_their_threads(self):
        text = self.write("two.txt", USES.replace("0.72", "0.6"))
        relaxed = self.folder / "relaxed.txt"
        self.succeeds("relax", text, "-o", relaxed)
        self.succeeds("check", relaxed)
        self.assertIn('material glass', relaxed.read_text())

    def test_used_files_count_for_resume(self):
        text = self.write("two.txt", USES)
        words = ("convert", text, "--to", "iges", "-o", self.out, "--report", self.folder / "r.json", "--resume")
        self.succeeds(*words)
        before = (self.out / "two.igs").read_bytes()
        self.write("parts/weave.txt", WEAVE.replace("1.1 0.3", "1.0 0.3"))
        self.succeeds(*words)
        self.assertNotEqual(before, (self.out / "two.igs").read_bytes())

    def mesh(self, text, *words):
        report = self.folder / "report.json"
        self.succeeds("mesh", text, "--matrix", "--periodic", *words, "--report", report, "-o", self.folder / "cell.inp")
        return json.loads(report.read_text())["inputs"][0]

    def test_cells_of_repeats_are_meshed(self):
        jersey = "thread y\n diameter 0.2\n material epoxy\nend\nknit jersey\n thread y\n courses 2\n wales 2\nend\n"
        twill = ("thread y\n section ellipse 0.9 0.2\n material epoxy\nend\nweave\n warp y 3 pitch 1.2\n weft y 3 pitch 1.2\n"
                 " draft twill 2/1\nend\n")
        head = USES[:USES.index("use file")]
        for cloth in (jersey, twill, "use file parts/weave.txt\nend\n"):
            text = self.write("one.txt", head + cloth + CELL.format(""))
            report = self.mesh(text, "--size", "0.12")
            self.assertTrue(report["ok"])

    def test_stacked_cloths_have_one_cell(self):
        text = self.write("two.txt", USES + CELL.format("1 x 1"))
        said = self.succeeds("info", text).stderr
        self.assertRegex(said, r"two\.txt:\d+:1: note: the cell reaches from \(0, 0, -[\d.]+\) to \(3, 3, [\d.]+\)")
        self.mesh(text, "--voxel", "10")


if __name__ == "__main__":
    unittest.main()
