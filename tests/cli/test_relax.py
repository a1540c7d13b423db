"""`selvage relax` and --relax: yarns moved apart, what is said of it, and that nothing is written without a solution."""

import json
import re
import unittest

from program import Case, PATH, files_below, run

HEAD = (
    'fabric 1\ntitle "two yarns"\n'
    "thread t\n  diameter 1\n  material steel\n  color 10 20 30\n  twist 100 S\nend\n"
    "thread thin\n  diameter 0.3\nend\n"
    "material steel\n  density 7.8\n  elastic isotropic 210000 0.3\nend\n"
)


def yarn(name, role, rows, thread="t"):
    return f"yarn {name} {thread}\n  role {role}\n  path\n" + "".join(f"    {row}\n" for row in rows) + "  end\nend\n"


def along_x(height, word="", name="a", thread="t", y=0):
    return yarn(name, "warp", [f"{x} {y} {height} {word}" for x in (-3, -1, 0, 1, 3)], thread)


def along_y(height, word=""):
    return yarn("b", "weft", [f"0 {y} {height} {word}" for y in (-3, -1, 0, 1, 3)])


CROSSING = HEAD + along_x(0) + along_y(0.9)  # 0.1 deep in each other
FREE = HEAD + along_x(0) + along_y(1.1)


def rows_of(text, name):
    """The control points of a yarn's grid."""
    block = re.search(rf"^yarn {name}\b.*?^end$", text, re.MULTILINE | re.DOTALL)[0]
    return [tuple(map(float, line.split())) for line in block.splitlines() if re.match(r"    -?[0-9.]", line)]


class Relaxing(Case):
    def file(self, text, name="cloth.txt"):
        path = self.folder / name
        path.write_text(text)
        return path

    def relaxed(self, text, *options):
        """The text that comes out, what it says, and its `relax` in the report."""
        source, report = self.file(text), self.folder / "report.json"
        done = self.succeeds("relax", source, "-o", self.folder / "apart.txt", "--report", report, *options)
        entry = json.loads(report.read_text())["inputs"][0]
        return (self.folder / "apart.txt").read_text(), done, entry["relax"]

    def gap_of(self, path):
        """The least distance of two yarns, by CGAL; overlaps fail."""
        report = self.folder / "check.json"
        self.succeeds("check", path, "--report", report)
        return json.loads(report.read_text())["inputs"][0]["min_gap"]


class Solved(Relaxing):
    def test_two_yarns(self):
        text, done, relax = self.relaxed(CROSSING)
        self.assertGreater(self.gap_of(self.folder / "apart.txt"), 0.0099)  # 1 % of the thickness
        self.assertTrue(relax["solved"])
        self.assertEqual(relax["before"]["overlaps"], 1)
        self.assertAlmostEqual(relax["before"]["depth"], 0.1, delta=0.001)
        self.assertEqual(relax["after"]["overlaps"], 0)
        self.assertNotIn("depth", relax["after"])
        self.assertGreater(relax["after"]["min_gap"], 0.0099)
        self.assertGreater(relax["iterations"], 0)
        # Together they moved by the depth and the gap, less what their sections gave way.
        self.assertGreater(relax["largest_move"], 0.01)
        self.assertLess(relax["largest_move"], 0.11)
        self.assertIn(relax["moved_most"], ("a", "b"))
        self.assertLess(relax["largest_area_change"], 0.02)
        self.assertLess(relax["largest_length_change"], 0.01)
        self.assertLess(relax["largest_volume_change"], 0.01)
        self.assertRegex(done.stdout, r"before\s+1\s+0\.(?:099|100)\d+\s+-\n\s+after\s+0\s+-\s+0\.01")
        self.assertIn("solved after", done.stdout)

    def test_the_text_says_what_it_said(self):
        text, _, _ = self.relaxed(CROSSING)
        self.assertTrue(text.startswith('fabric 1\ntitle "two yarns"\n'))
        for words in (
            "thread t\n  diameter 1\n  twist 100 S\n  color 10 20 30\n  material steel\nend\n",
            "material steel\n  density 7.8\n",
            "yarn a t\n  role warp\n  grid ",
            "yarn b t\n  role weft\n  grid ",
        ):
            self.assertIn(words, text)
        self.assertEqual(run("check", self.folder / "apart.txt").stderr, "")

    def test_every_output_has_the_same_surfaces(self):
        source = self.file(CROSSING)
        self.succeeds("relax", source, "-o", self.folder / "apart.txt")
        self.succeeds("relax", source, "--to", "iges,step", "-o", self.folder / "relaxed")
        self.succeeds("convert", source, "--relax", "--to", "txt,iges", "-o", self.folder / "converted")
        for other in ("relaxed/cloth.igs", "relaxed/cloth.stp", "converted/cloth.txt", "converted/cloth.igs"):
            self.succeeds("diff", self.folder / "apart.txt", self.folder / other)  # tolerance 0
        self.succeeds("convert", self.folder / "apart.txt", "-o", self.folder / "again.txt")
        self.assertEqual((self.folder / "again.txt").read_text(), (self.folder / "apart.txt").read_text())

    def test_mesh(self):
        source = self.file(CROSSING)
        message = self.fails(1, "mesh", source, "-o", self.folder / "raw.inp", "--size", "0.4")
        self.assertIn("--relax", message)
        self.assertFalse((self.folder / "raw.inp").exists())
        self.succeeds("mesh", source, "--relax", "-o", self.folder / "direct.inp", "--size", "0.4")
        self.succeeds("relax", source, "-o", self.folder / "apart.txt")
        self.succeeds("mesh", self.folder / "apart.txt", "-o", self.folder / "twice.inp", "--size", "0.4")
        decks = [(self.folder / name).read_text() for name in ("direct.inp", "twice.inp")]
        for deck in decks:
            self.assertRegex(deck, r"(?i)\*material, *name=steel")
            self.assertNotIn("generic", deck)
        comments = re.compile(r"^\*\*.*\n|^\*HEADING\n.*\n", re.MULTILINE | re.IGNORECASE)
        self.assertEqual(*(comments.sub("", deck) for deck in decks))

    def test_yarns_that_keep_their_distance_stay(self):
        text, done, relax = self.relaxed(FREE)
        self.assertIn("nothing had to move", done.stdout)
        self.assertEqual((relax["iterations"], relax["largest_move"]), (0, 0))
        self.succeeds("diff", self.file(FREE), self.folder / "apart.txt")  # tolerance 0
        self.assertIn("grid", text)

    def test_a_bend_that_is_too_tight_is_told(self):
        """Nothing makes it wider, and it is as it was in the text that comes out."""
        for text in (FREE, CROSSING):
            _, done, _ = self.relaxed(text + yarn("bent", "other", ["6 0 0", "9 0 0", "9.3 0.3 0", "9 0.6 0", "6 2 0"]))
            self.assertEqual(
                done.stderr.count("yarn 'bent' bends more tightly than its section allows"), 1, done.stderr
            )

    def test_gap(self):
        self.relaxed(CROSSING, "--gap", "0.2")
        self.assertGreater(self.gap_of(self.folder / "apart.txt"), 0.199)
        self.relaxed(FREE, "--gap", "0.2")
        self.assertGreater(self.gap_of(self.folder / "apart.txt"), 0.199)

    def test_overlap(self):
        """More than wanted, and less."""
        for wanted in (0.05, 0.15):
            _, _, relax = self.relaxed(CROSSING, "--overlap", wanted)
            done = run("check", self.folder / "apart.txt")
            depth = re.search(r"overlap, ([0-9.]+) mm deep", done.stderr)
            self.assertIsNotNone(depth, done.stderr)
            self.assertAlmostEqual(float(depth[1]), wanted, delta=0.05 * wanted)

    def test_stiff_sections_are_moved_as_they_are(self):
        _, _, relax = self.relaxed(CROSSING, "--stiff-section")
        self.assertGreater(self.gap_of(self.folder / "apart.txt"), 0.0099)
        self.succeeds("convert", self.file(CROSSING), "-o", self.folder / "before.igs")
        self.succeeds("convert", self.folder / "before.igs", "-o", self.folder / "before.txt")
        before, after = ((self.folder / name).read_text() for name in ("before.txt", "apart.txt"))
        for name in "ab":
            round_ = int(re.search(rf"^yarn {name}\b.*?grid \d+ (\d+)", after, re.MULTILINE | re.DOTALL)[1])
            sections = []
            for text in (before, after):
                rows = rows_of(text, name)
                sections.append([rows[k : k + round_] for k in range(0, len(rows), round_)])
            if len(sections[0]) != len(sections[1]):
                continue  # knots were put in: not row by row
            for old, new in zip(*sections):
                for k in range(round_):
                    self.assertAlmostEqual(dist(new[k], new[0]), dist(old[k], old[0]), delta=0.02)

    def test_fixed_rows(self):
        """Where one yarn is fixed, the other one moves all the way."""
        text, _, _ = self.relaxed(HEAD + along_x(0, "fixed") + along_y(0.9))
        self.assertGreater(self.gap_of(self.folder / "apart.txt"), 0.0099)
        heights = {name: [z for x, y, z in rows_of(text, name) if abs(x) < 0.6 and abs(y) < 0.6] for name in "ab"}
        self.assertLess(abs(max(heights["a"]) + min(heights["a"])), 0.02)
        self.assertGreater(min(heights["b"]) + max(heights["b"]), 2 * 0.93)
        self.assertNotIn("fixed", text)
        # Without a place to go, there is no solution.
        source = self.file(HEAD + along_x(0, "fixed") + along_y(0.9, "fixed"))
        self.fails(3, "relax", source, "-o", self.folder / "none.txt", "--stiff-section")
        self.assertFalse((self.folder / "none.txt").exists())

    def test_plies_stay_parts_of_their_yarn(self):
        plied = (
            HEAD
            + "thread ply\n  diameter 0.8\n  tex 90\n  density 1.5\n  plies 2 100 S\n  material steel\nend\n"
            + yarn("a", "warp", ["-3 0 0", "0 0 0", "3 0 0"], "ply")
            + yarn("b", "weft", ["0 -3 0.6", "0 0 0.6", "0 3 0.6"], "ply")
        )
        text, _, relax = self.relaxed(plied)
        self.assertGreater(relax["before"]["overlaps"], 0)
        for name in ("a.ply1", "a.ply2", "b.ply1", "b.ply2"):
            self.assertRegex(text, rf"yarn {name}\n  role (warp|weft)\n  group {name[0]}\n  tex 45\n")
        self.assertEqual(text.count("  material steel\n"), 6)
        done = run("check", self.folder / "apart.txt")
        self.assertEqual((done.returncode, done.stderr), (0, ""))  # nothing asks for plies of plies

    def test_folds_of_grids_are_those_of_their_surfaces(self):
        """The middle line of a grid's rows may be bent where the surface is not: a straight yarn whose sections turn and shrink."""
        head = "fabric 1\ntolerance 0.002\nthread t\n  diameter 0.55\nend\nyarn y t\n"
        straight = self.file(
            head + "  ends fan\n  path polyline\n    0 0.85 -0.26 0.435 0.663 89.9\n"
            "    1.1 0.79 -0.02 0.627 0.419\n  end\nend\n"
        )
        self.succeeds("relax", straight, "-o", self.folder / "grid.txt")
        self.assertIn(
            "sound: every yarn is a closed valid solid", self.succeeds("check", self.folder / "grid.txt").stdout
        )
        # One that is bent more tightly than it is thick folds, as a grid, too.
        bent = self.file(head + "  path\n    0 0 0\n    1 0 0\n    1.2 0.2 0\n    1 0.4 0\n    0 0.4 0\n  end\nend\n")
        self.succeeds("convert", bent, "-o", self.folder / "bent.igs")
        self.assertIn("its surface folds over itself", self.fails(3, "check", self.folder / "bent.igs"))

    def test_standard_output_has_the_text_alone(self):
        source = self.file(CROSSING)
        done = self.succeeds("relax", source, "-o", "-")
        self.succeeds("relax", source, "-o", self.folder / "apart.txt")
        self.assertEqual(done.stdout, (self.folder / "apart.txt").read_text())
        self.assertIn("solved after", done.stderr)

    def test_same_input_same_bytes(self):
        source = self.file(CROSSING)
        for folder, workers in (("one", "1"), ("four", "4")):
            self.succeeds("relax", source, "--to", "txt,iges", "-o", self.folder / folder, "-j", workers)
        self.assertEqual(files_below(self.folder / "one"), files_below(self.folder / "four"))

    def test_constructions_of_one_name(self):
        weave = "weave\n  warp t 2 pitch 3\n  weft t 2 pitch 3\n  draft plain\nend\n"
        text, _, _ = self.relaxed(HEAD + weave + "yarn warp_1 t\n  path\n    0 30 0\n    6 30 0\n  end\nend\n")
        names = re.findall(r"^yarn (\S+)", text, re.MULTILINE)
        self.assertEqual(len(names), len(set(names)), names)
        self.assertEqual(len(names), 5)


def dist(a, b):
    return sum((p - q) ** 2 for p, q in zip(a, b)) ** 0.5


class NoSolution(Relaxing):
    def judge(self, text, pattern, *options, commands=("relax", "convert", "mesh")):
        """Exit 3 with these words; nothing is written, and what stood there stays."""
        source = self.file(text)
        out = self.folder / "there"
        for command in commands:
            name = {"relax": "cloth.txt", "convert": "cloth.igs", "mesh": "cloth.inp"}[command]
            out.mkdir(exist_ok=True)
            (out / name).write_text("what stood here")
            before = files_below(out)
            how = [] if command == "relax" else ["--relax"]
            report = self.folder / "report.json"
            message = self.fails(3, command, source, "-o", out / name, "--report", report, *how, *options)
            self.assertRegex(message, pattern, command)
            self.assertRegex(message, rf"(?m)^{re.escape(str(source))}: error: ")
            self.assertEqual(files_below(out), before, command)
            self.assertEqual(source.read_text(), text)
            entry = json.loads(report.read_text())["inputs"][0]
            self.assertFalse(entry["ok"])
            self.assertNotIn("outputs", entry)
            if "relax" in entry:
                self.assertFalse(entry["relax"]["solved"])
        return message

    def test_through_each_others_middle(self):
        self.judge(
            HEAD + along_x(0) + along_y(0),
            r"yarns 'a' and 'b' cannot be moved apart.*each other's middle at \(0, 0, 0\)",
        )

    def test_nearly_through_each_others_middle(self):
        self.judge(HEAD + along_x(0) + along_y(0.05), "'a' and 'b'")

    def test_identical_yarns(self):
        message = self.judge(HEAD + along_x(0) + along_x(0, name="b"), "the same centre line")
        self.assertEqual(message.count("the same centre line"), 1)

    def test_one_inside_another(self):
        self.judge(HEAD + along_x(0) + along_x(0, name="b", thread="thin", y=0.1), r"'a' and 'b'.*overlap")

    def test_a_gap_that_the_cloth_has_no_room_for(self):
        """Either the neighbours stand in the way, or what has to stay as it is."""
        jammed = HEAD + "weave\n  warp t 3 pitch 1.75\n  weft t 3 pitch 1.75\n  draft plain\nend\n"
        self.judge(
            jammed,
            r"cannot be moved apart: (the yarns are jammed|.*yarn '\w+' would change by .* allowed)",
            "--gap",
            "0.4",
            "--as-published",
            commands=["relax"],
        )

    def test_sections_would_vanish(self):
        self.judge(CROSSING, "section would vanish", "--gap", "0.95")
        self.judge(CROSSING, "section would vanish", "--gap", "50")

    def test_too_few_steps(self):
        message = self.judge(CROSSING, "1 step", "--max-iterations", "1")
        self.assertRegex(message, r"yarns 'a' and 'b' jam: the smallest overlap that was reached is 0\.0\d+ mm at \(")

    def test_others_are_done(self):
        sources = [self.file(CROSSING, "good.txt"), self.file(HEAD + along_x(0) + along_y(0), "bad.txt")]
        self.fails(3, "relax", *sources, "-o", self.out)
        self.assertEqual([path.name for path in self.out.iterdir()], ["good.txt"])


class Words(Relaxing):
    def refused(self, pattern, *arguments):
        self.assertRegex(self.fails(2, *arguments), pattern)
        self.assertFalse(self.out.exists())

    def test_what_goes_with_relax(self):
        for option in (["--gap", "0.1"], ["--overlap", "0.1"], ["--stiff-section"], ["--max-iterations", "3"]):
            for command in ("convert", "mesh"):
                self.refused(f"{option[0]}.* goes with --relax", command, PATH, "-o", self.out, *option)
        self.refused("does not go with --gap", "relax", PATH, "-o", self.out, "--gap", "0.1", "--overlap", "0.1")
        for option, value in (("--gap", "-1"), ("--overlap", "0"), ("--max-iterations", "0"), ("--gap", "x")):
            self.refused(re.escape(option), "relax", PATH, "-o", self.out, option, value)

    def test_the_input_is_not_replaced(self):
        source = self.file(CROSSING)
        self.assertIn("would replace", self.fails(2, "relax", source))
        self.assertEqual(source.read_text(), CROSSING)

    def test_limits_hold(self):
        """A cloth that takes longer than it may."""
        source = self.file(
            "fabric 1\nthread t\n  diameter 0.2\nend\nknit jersey\n  thread t\n  courses 60\n  wales 60\nend\n"
        )
        message = self.fails(1, "relax", source, "--as-published", "-o", self.out, "--timeout", "0.5")
        self.assertIn("--timeout", message)
        self.assertFalse(self.out.exists())

    def test_resume_knows_the_settings(self):
        source, report = self.file(CROSSING), self.folder / "report.json"
        arguments = ("relax", source, "-o", self.folder / "apart.txt", "--report", report, "--resume")
        self.succeeds(*arguments)
        self.assertIn("1 were up to date", self.succeeds(*arguments).stderr)
        self.assertNotIn("up to date", self.succeeds(*arguments, "--gap", "0.1").stderr)


if __name__ == "__main__":
    unittest.main()
