"""`selvage check` on CAD files: sound ones, planted faults with their lines, what other systems stumble on."""

import json
import re
import unittest
import xml.etree.ElementTree

from program import GRID, PATH, RING, Case, run


class CheckCad(Case):
    def written(self, name, *options, source=GRID):
        path = self.folder / name
        self.succeeds("convert", source, "-o", path, *options)
        return path

    def broken(self, path, line, column, text):
        """The file with `text` over line `line` from `column`, both from 1; every line is 80 columns and LF."""
        data = path.read_bytes()
        at = 81 * (line - 1) + column - 1
        self.assertNotEqual(data[at : at + len(text)].decode(), text)
        other = path.with_name("broken" + path.suffix)
        other.write_bytes(data[:at] + text.encode() + data[at + len(text) :])
        return other

    def line_of(self, path, beginning):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if line.startswith(beginning):
                return number
        self.fail(beginning)

    def test_junit(self):
        """A test case an input: sound, with defects, unreadable."""
        deep = self.folder / "deep.txt"
        deep.write_text(
            "fabric 1\n"
            + "".join(
                f"yarn {name}\n  diameter 0.4\n  path\n    0 0 {z}\n    1 0 {z}\n  end\nend\n"
                for name, z in (("a", 0), ("b", 0.2))
            )
        )
        bad = self.folder / "bad.txt"
        bad.write_text("fabric 1\nyarm a\n")
        path = self.folder / "check.xml"
        self.assertEqual(run("check", GRID, deep, bad, "--junit", path).returncode, 1)
        suite = xml.etree.ElementTree.parse(path).getroot().find("testsuite")
        self.assertEqual(
            [suite.get(key) for key in ("name", "tests", "failures", "errors")], ["selvage check", "3", "1", "1"]
        )
        cases = {case.get("classname"): case for case in suite}
        self.assertEqual(len(cases[str(GRID)]), 0)
        self.assertIn("overlap", cases[str(deep)].find("failure").text)
        self.assertIn("yarm", cases[str(bad)].find("error").text)

    def test_own_files_are_sound(self):
        for name, options in (("a.igs", ()), ("b.igs", ("--iges-solid",)), ("c.stp", ())):
            for source in (GRID, PATH, RING):
                with self.subTest(name, source=source):
                    done = run("check", self.written(name, *options, source=source))
                    self.assertEqual(done.returncode, 0, done.stderr)
                    self.assertEqual(done.stderr, "")
                    self.assertIn("its surfaces are sound; every yarn is a closed valid solid", done.stdout)

    def test_a_file_that_was_warned_of_does_not_keep_to_its_format(self):
        step, iges = self.written("good.stp").read_text(), self.written("good.igs").read_text()
        first = re.search(r"(?m)^#\d+ = CARTESIAN_POINT.*;$", step)[0]
        number = re.search(r"(-?\d+\.\d*)[,)]", first)[1]
        for name, text in (
            ("schema.stp", re.sub(r"FILE_SCHEMA\(\(\s*'[^']*'", "FILE_SCHEMA(('NOBODYS_SCHEMA'", step)),
            ("twice.stp", step.replace(first, f"{first}\n{first}", 1)),
            ("exponent.stp", step.replace(first, first.replace(number, f"{number}e0", 1), 1)),
            ("trailing.igs", iges + "more\n"),
        ):
            with self.subTest(name):
                path = self.folder / name
                path.write_text(text)
                done = run("check", path)
                self.assertRegex(done.stderr, r"warning|error")
                self.assertNotIn("keeps to its format", done.stdout)
        for name in ("good.stp", "good.igs"):
            self.assertIn("sound: the file keeps to its format", self.succeeds("check", self.folder / name).stdout)

    def test_fan_has_poles(self):
        path = self.written("fan.igs", "--ends", "fan")
        done = run("check", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, r"fan\.igs:\d+:1: warning: Creo lists surfaces with a pole .*: 8 of them")
        self.assertEqual(run("check", path, "--strict").returncode, 1)

    def test_structure(self):
        good = self.written("good.igs")
        lines = good.read_text().splitlines()
        last = len(lines)
        body = self.line_of(good, "128,17,15")
        for line, column, text, message in (
            (last, 10, "     99", r"counts 99 lines in the global section"),
            (body, 79, "77", r"sequence number P\d+ follows"),
            (body, 70, "999", r"points back to"),
            (last, 1, "X", r"where the number of start lines is due"),
        ):
            with self.subTest(message):
                done = run("check", self.broken(good, line, column, text))
                self.assertIn(done.returncode, (1, 3), done.stderr)
                self.assertRegex(done.stderr, r"broken\.igs:%d:\d+: error: .*%s" % (line, message))
        done = run("check", self.broken(good, last, 10, "     99"))
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertIn("  geometry: sound\n  header, records and flags: 1 defect\n", done.stdout)
        self.assertIn("  1 defect\n", done.stdout)

    def test_flags_are_no_defects(self):
        """Of what flags say wrongly one line a kind is shown, and it alone fails nothing."""
        good = self.written("good.igs")
        path = good
        lines = [i for i, line in enumerate(good.read_text().splitlines(), 1) if line.startswith("128,17,15")]
        self.assertGreater(len(lines), 3)
        for line in lines:
            path = self.broken(path, line, 15, "0")
        done = run("check", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = [line for line in done.stderr.splitlines() if "PROP1 says that it is open in u" in line]
        self.assertEqual(len(found), 1, done.stderr)
        self.assertRegex(found[0], r"broken\.igs:%d:\d+: warning: x%d, for example: 128 at " % (lines[0], len(lines)))
        self.assertIn("  geometry: sound\n  header, records and flags: %d warnings\n" % len(lines), done.stdout)
        every = run("check", path, "--all")
        self.assertEqual(every.stderr.count("PROP1 says that it is open in u"), len(lines))
        self.assertEqual(every.returncode, 0)
        self.assertEqual(run("check", path, "--strict").returncode, 1)

    def moved_corner(self, path):
        """The file with the first control point of its first end face moved: one digit of its largest coordinate."""
        lines = path.read_text().splitlines()
        end_face = [i for i, line in enumerate(lines) if line.startswith("128,") and line[72] == "P"][1]
        pointer = lines[end_face][64:72]
        words = [
            (i, at, word)
            for i, line in enumerate(lines)
            if line[64:73] == pointer + "P"
            for at, word in self.words(line[:64])
        ]
        counts = [int(word) for _, _, word in words[1:5]]
        first = 10 + sum(counts) + 4 + (counts[0] + 1) * (counts[1] + 1)
        line, at, word = max(words[first : first + 3], key=lambda w: abs(float(w[2])))
        digit = at + word.index(".") + 1
        while not lines[line][digit].isdigit():
            self.fail(word)
        return self.broken(path, line + 1, digit + 1, str((int(lines[line][digit]) + 1) % 10))

    @staticmethod
    def words(line):
        at = 0
        for word in line.rstrip().rstrip(";").split(","):
            if word.strip():
                yield at, word
            at += len(word) + 1

    def test_gap_is_in_the_report(self):
        good = self.written("good.igs")
        report = self.folder / "r.json"
        done = run("check", good, "--report", report)
        self.assertEqual(done.returncode, 0, done.stderr)
        entry = json.loads(report.read_text())["inputs"][0]
        self.assertNotIn("error", {m["severity"] for m in entry["messages"]})
        self.assertGreater(entry["creo_absolute_accuracy"], 0)
        bad = self.moved_corner(good)
        done = run("check", bad, "--report", report)
        texts = [m["text"] for m in json.loads(report.read_text())["inputs"][0]["messages"]]
        self.assertTrue(
            any("an edge" in text and ("apart" in text or "no other face" in text) for text in texts), texts
        )

    def test_stated_measures(self):
        """A STEP file whose volume, area or centre is changed is defective; each is told by the product's name."""
        good = self.written("good.stp", source=RING)
        text = good.read_text("ascii")
        changed = good.with_name("changed.stp")
        for pattern, what in (
            (r"(VOLUME_MEASURE\()([^)]*)(\))", "volume"),
            (r"(AREA_MEASURE\()([^)]*)(\))", "area"),
            (r"('centre point',\()([^,]*)(,)", "centre"),
        ):
            with self.subTest(what):
                found = re.search(pattern, text)
                value = float(found.group(2))
                other = value * 1.002 if what != "centre" else value + 0.1
                changed.write_text(text[: found.start(2)] + repr(other).upper() + text[found.end(2) :], "ascii")
                done = run("check", changed)
                self.assertEqual(done.returncode, 3, done.stderr)
                self.assertRegex(done.stderr, r"changed\.stp: error: '\w+': the file says that its %s is " % what)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        for unit in ("m", "inch"):
            path = self.folder / "unit.stp"
            self.succeeds("convert", RING, "-o", path, "--units", unit)
            self.assertEqual(run("check", path).returncode, 0)

    def test_not_readable(self):
        path = self.folder / "cut.igs"
        path.write_bytes(self.written("good.igs").read_bytes()[:3000])
        done = run("check", path)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, r"cut\.igs:\d+:\d+: error: ")


if __name__ == "__main__":
    unittest.main()
