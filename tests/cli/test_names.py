"""Names on a terminal: nothing in them steers it or turns text around, and long ones widen neither tables nor comments."""

import json
import re
import shutil
import unittest

from program import Case, GRID, PATH, RING, run

STEERING = "a\x1b[2J\n\x9b31m\u202egpj\u2066\x07"
SHOWN = r"a\x1B[2J\n\x9B31m\u202Egpj\u2066\x07"
LONG = "y" * 10000

CROSSING = """fabric 1
thread t
  diameter 0.5
end
"""


def pair(number, apart, begin=""):
    """Two straight yarns beside each other, their centre lines this far apart."""
    return "".join(
        f"yarn {begin}{letter}{number} t\n path\n 0 {y} 0\n 1 {y} 0\n end\nend\n"
        for letter, y in (("a", 2 * number), ("b", round(2 * number + apart, 4)))
    )


class Steering(Case):
    def test_file_names(self):
        source = self.folder / f"{STEERING}.txt"
        shutil.copy(GRID, source)
        broken = self.folder / f"{STEERING}.stp"
        broken.write_text("no STEP")
        report = self.folder / "report.json"
        for arguments in (
            ("info", source),
            ("check", source),
            ("roundtrip", source, "--to", "iges"),
            ("convert", source, "--to", "iges", "-o", f"{self.folder}/{STEERING}/", "-v"),
            ("diff", source, PATH),
            ("info", broken),
            ("check", self.folder / f"{STEERING}-none.txt"),
            ("convert", source, "-o", f"{self.folder}/{STEERING}.{STEERING}"),
            ("relax", source, "-o", f"{self.folder}/relaxed/"),
            ("convert", "--" + STEERING),
            ("view", source, "--size", "8x8", "-o", f"{self.folder}/{STEERING}.png", "-v"),
        ):
            done = run(*arguments)
            text = done.stdout + done.stderr
            self.assertEqual(re.findall("[^\n -~]", text), [], arguments)
            for line in text.splitlines():
                self.assertNotIn("31m", line.replace(SHOWN, ""), "a newline of a name is one on the terminal")
        run("info", source, "--report", report)
        self.assertEqual(json.loads(report.read_text())["inputs"][0]["path"], str(source))

    def test_titles(self):
        """Strings in STEP files may hold anything."""
        step = self.folder / "x.stp"
        self.succeeds("convert", RING, "-o", step)
        step.write_text(step.read_text().replace("A closed ring", r"A\X2\202E\X0\ closed ring"))
        for arguments in (("info", step), ("check", step), ("diff", step, GRID)):
            done = run(*arguments)
            self.assertNotIn("\u202e", done.stdout + done.stderr)
        self.assertIn(r"A\u202E closed ring", run("info", step).stdout)


class Long(Case):
    def setUp(self):
        super().setUp()
        self.source = self.folder / "long.txt"
        self.source.write_text(f'title "{LONG}"\n'.join(("fabric 1\n", "")) + CROSSING[9:] + pair(1, 0.4, LONG))

    def test_tables_and_lines(self):
        for arguments in (
            ("info", self.source),
            ("check", self.source),
            ("roundtrip", self.source, "--to", "iges"),
            ("diff", self.source, GRID),
        ):
            done = run(*arguments)
            lines = (done.stdout + done.stderr).splitlines()
            self.assertLess(max(map(len, lines)), 240, arguments)
            if arguments[0] != "roundtrip":
                self.assertRegex("\n".join(lines), "y{20}\\.\\.\\.")
        entry = json.loads(run("info", self.source, "--json").stdout)["inputs"][0]
        self.assertEqual([yarn["name"] for yarn in entry["yarns"]], [LONG + "a1", LONG + "b1"])

    def test_comments_of_decks(self):
        self.source.write_text(CROSSING + pair(1, 0.8, LONG))
        for suffix in ("inp", "cdb", "bdf", "k", "unv"):
            deck = self.folder / f"x.{suffix}"
            self.succeeds("mesh", self.source, "--size", "0.3", "-o", deck)
            self.assertLess(max(map(len, deck.read_text().splitlines())), 160, suffix)

    def test_formats_hold_them_whole(self):
        self.source.write_text(CROSSING + pair(1, 0.8, LONG))
        for suffix in ("igs", "stp", "txt"):
            self.succeeds("convert", self.source, "-o", self.folder / f"x.{suffix}")
            entry = json.loads(run("info", self.folder / f"x.{suffix}", "--json").stdout)["inputs"][0]
            self.assertEqual([yarn["name"] for yarn in entry["yarns"]], [LONG + "a1", LONG + "b1"], suffix)


class Many(Case):
    """Of many messages alike: the first, their number and the worst."""

    def test_overlaps(self):
        source = self.folder / "many.txt"
        source.write_text(CROSSING + "".join(pair(i, 0.4 - 0.001 * (i == 70)) for i in range(94)))
        done = run("check", source, "--quiet")
        self.assertEqual(done.returncode, 3, done.stderr)
        lines = done.stderr.splitlines()
        self.assertEqual(len(lines), 21, done.stderr)
        self.assertRegex(
            lines[-1],
            r"error: x94, of which 74 are not shown; the worst: yarns 'a70' and 'b70' overlap, 0\.10\d* mm deep",
        )
        self.assertRegex(done.stdout, "94 defects")
        report = self.folder / "report.json"
        run("check", source, "--report", report)
        entry = json.loads(report.read_text())["inputs"][0]
        self.assertEqual(len(entry["overlaps"]), 94)
        self.assertEqual(len(entry["messages"]), 21)


if __name__ == "__main__":
    unittest.main()
