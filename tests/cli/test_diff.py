"""`selvage diff`: what two files differ in, in lines, as JSON, and as an exit code."""

import json
import pathlib
import re
import signal
import time
import unittest
import xml.etree.ElementTree

from program import BAD, Case, GRID, PATH, RING, SAMPLES, run, start

PIECE = str(SAMPLES / "back_piece.txt")
WEAVE = """fabric 1
{extra}
thread a
  diameter 0.5
  color 200 30 40
end
thread b
  diameter 0.5
  color {color}
end
weave
  warp a {warps} pitch 1.0
  weft b 6 pitch 1.0
  draft plain
end
"""


class Differences(Case):
    def text(self, name, content):
        path = self.folder / name
        path.write_text(content)
        return path

    def lines(self, code, *arguments):
        done = run("diff", *arguments, "--no-progress")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(done.stderr, "")
        return done.stdout.splitlines()

    def found(self, code, *arguments):
        return json.loads("\n".join(self.lines(code, *arguments, "--json")))

    def test_a_file_and_itself(self):
        for path, words in ((GRID, "4 yarns, 12 surfaces"), (RING, "1 yarn, 1 surface"), (PIECE, "1 part, 1 surface")):
            lines = self.lines(0, path, path)
            self.assertEqual(len(lines), 1)
            self.assertTrue(lines[0].startswith("equal: "), lines)
            self.assertIn(words, lines[0])
            found = self.found(0, path, path)
            self.assertEqual((found["equal"], found["differences"]), (True, []))

    def test_one_control_point(self):
        text = pathlib.Path(GRID).read_text()
        numbers = list(re.finditer(r"^\s+(\S+) (\S+) (\S+)$", text, re.MULTILINE))
        row = numbers[20]
        moved = f"{float(row[3]) + 1e-9!r}"
        changed = self.text("changed.txt", text[: row.start(3)] + moved + text[row.end(3) :])
        lines = self.lines(3, GRID, changed)
        self.assertRegex(
            lines[0],
            r"^reshaped: yarn 'warp1', control point \(\d+, \d+\) of \d+ x \d+ of its body at "
            r"\(.*\) by 1e-09 mm; \d of \d+ points differ$",
        )
        self.assertRegex(lines[-1], r"^different: 1 reshaped; the other 3 equal \(tolerance 0 mm\)$")
        one = self.found(3, GRID, changed)["differences"][0]
        self.assertEqual((one["kind"], one["name"], one["surface"]), ("reshaped", "warp1", "body"))
        self.assertAlmostEqual(one["at_least"], 1e-9, delta=1e-15)
        self.assertEqual(len(self.lines(0, GRID, changed, "--tolerance", "2e-9")), 1)

    def test_added_removed_recoloured(self):
        before = self.text("before.txt", WEAVE.format(extra="", color="1 2 3", warps=6))
        after = self.text("after.txt", WEAVE.format(extra='title "after"', color="3 2 1", warps=5))
        found = self.found(3, before, after)
        kinds = found["kinds"]
        self.assertEqual(kinds["removed"], 1)
        self.assertEqual(kinds["recoloured"], 6)
        self.assertEqual([d["name"] for d in found["differences"] if d["kind"] == "removed"], ["warp_6"])
        colors = {(tuple(d["from"]), tuple(d["to"])) for d in found["differences"] if d["kind"] == "recoloured"}
        self.assertEqual(colors, {((1, 2, 3), (3, 2, 1))})
        self.assertEqual(self.found(3, after, before)["kinds"]["added"], 1)
        self.assertIn("titles: '' and 'after'", found["notes"])

    def test_moved(self):
        turned = self.text("moved.txt", pathlib.Path(PATH).read_text())
        lines = turned.read_text().splitlines()
        block = [i for i, line in enumerate(lines) if line.startswith("yarn warp2")][0]
        for i in range(block, len(lines)):
            words = lines[i].split()
            if words == ["end"]:
                break
            if len(words) == 3 and all(re.fullmatch(r"-?[\d.]+", word) for word in words):
                lines[i] = f"    {words[0]} {words[1]} {float(words[2]) + 0.75!r}"
        turned.write_text("\n".join(lines) + "\n")
        out = self.lines(3, PATH, turned, "--tolerance", "1e-9")
        self.assertRegex(out[0], r"^moved: yarn 'warp2' by \((-?\d\S*, ){2}0.75\), 0.75 mm$")

    def test_units_are_brought_to_one(self):
        body = pathlib.Path(GRID).read_text()
        self.assertEqual(body.count("\nunits mm\n"), 1)
        number = r"^(    )(-?[\d.]+) (-?[\d.]+) (-?[\d.]+)$"
        scaled = re.sub(
            number, lambda m: m[1] + " ".join(repr(float(m[k]) * 1000) for k in (2, 3, 4)), body, flags=re.MULTILINE
        )
        micrometres = self.text("um.txt", scaled.replace("\nunits mm\n", "\nunits um\n"))
        lines = self.lines(0, GRID, micrometres)
        self.assertIn("note: units: mm and um; compared in mm", lines)

    def test_swapped_names(self):
        text = pathlib.Path(PATH).read_text()
        swapped = (
            text.replace("yarn warp1", "yarn x").replace("yarn warp2", "yarn warp1").replace("yarn x", "yarn warp2")
        )
        lines = self.lines(3, PATH, self.text("swapped.txt", swapped))
        self.assertEqual(lines[0], "renamed: yarn 'warp1' to 'warp2': the two swapped their names")
        self.assertEqual(len(lines), 3)

    def test_all_have_changed(self):
        before = self.text("before.txt", WEAVE.format(extra="", color="1 2 3", warps=12))
        after = self.text("after.txt", before.read_text().replace("diameter 0.5", "diameter 0.52"))
        found = self.found(3, before, after)
        self.assertEqual(found["kinds"]["reshaped"], 18)
        for one in found["differences"]:
            self.assertLessEqual(one["at_least"], one.get("at_most", 1))
            self.assertGreater(one["at_least"], 0.005)  # the radii differ by 0.01
            self.assertLess(one["at_least"], 0.06)
        self.assertRegex(
            self.lines(3, before, after)[-1], r"^different: 18 reshaped, all by about 0\.\d+( to 0\.\d+)? mm; "
        )

    def test_junit(self):
        before = self.text("before.txt", WEAVE.format(extra="", color="1 2 3", warps=6))
        after = self.text("after.txt", WEAVE.format(extra="", color="3 2 1", warps=5))
        path = self.folder / "diff.xml"
        self.lines(3, before, after, "--junit", path)
        suite = xml.etree.ElementTree.parse(path).getroot().find("testsuite")
        self.assertEqual(suite.get("name"), "selvage diff")
        cases = {case.get("name"): case.find("failure") for case in suite}
        self.assertEqual(len(cases), 12)
        self.assertEqual(suite.get("failures"), "7")
        self.assertIsNone(cases["yarn 'warp_1'"])
        self.assertIn("recoloured", cases["yarn 'weft_1'"].text)
        self.assertIn("removed", cases["yarn 'warp_6'"].text)
        run("diff", before, self.folder / "none.txt", "--junit", path)
        suite = xml.etree.ElementTree.parse(path).getroot().find("testsuite")
        self.assertEqual((suite.get("tests"), suite.get("errors")), ("1", "1"))

    def test_at_most_twenty_lines(self):
        before = self.text("before.txt", WEAVE.format(extra="", color="1 2 3", warps=30))
        after = self.text("after.txt", WEAVE.format(extra="", color="1 2 3", warps=3))
        lines = self.lines(3, before, after)
        self.assertEqual(len(lines), 22)
        self.assertRegex(lines[20], r"^\.\.\. and \d+ more \(--all shows them\)$")
        everything = self.lines(3, before, after, "--all")
        self.assertEqual(len(everything), 20 + int(lines[20].split()[2]) + 1)
        self.assertEqual(everything[:20], lines[:20])

    def test_bad_inputs(self):
        done = run("diff", GRID, BAD / "nan.txt")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"nan\.txt:\d+:\d+: error: ")
        self.assertEqual(done.stdout, "")
        both = self.fails(1, "diff", BAD / "nan.txt", self.folder / "none.txt")
        self.assertIn("nan.txt", both)
        self.assertIn("none.txt", both)
        self.assertIn("only one of the two", self.fails(2, "diff", "-", "-"))
        self.fails(2, "diff", GRID)
        self.fails(2, "diff", GRID, GRID, "--tolerance", "-1")
        self.assertEqual(run("diff", "-", GRID, input=pathlib.Path(GRID).read_text()).returncode, 0)

    def test_limits_and_interruption(self):
        large = self.text("large.txt", WEAVE.format(extra="", color="1 2 3", warps=6000))
        self.assertIn(
            "not done within its 0.2 s", self.fails(1, "diff", large, large, "--timeout", "0.2", "--no-progress")
        )
        running = start("diff", large, large, "--no-progress")
        time.sleep(0.3)
        running.send_signal(signal.SIGINT)
        self.assertEqual(running.communicate()[1], "selvage: interrupted\n")
        self.assertEqual(running.returncode, 130)


if __name__ == "__main__":
    unittest.main()
