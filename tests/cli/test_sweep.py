"""`--set` and `sweep`: which variants there are, what their table says, and what a kill leaves."""

import csv
import json
import signal
import subprocess
import unittest

from program import Case, run, start

CLOTH = """fabric 1
param distance 1.0
param d 0.3mm
thread y
  diameter d
end
weave
  warp y 4 distance
  weft y 4 distance
  draft plain
end
"""


class Sweep(Case):
    def setUp(self):
        super().setUp()
        self.cloth = self.folder / "cloth.txt"
        self.cloth.write_text(CLOTH)
        self.table = self.folder / "table.csv"

    def sweep(self, *words, code=0):
        result = run("sweep", self.cloth, *words, "--csv", self.table)
        self.assertEqual(result.returncode, code, result.stderr)
        return result, self.rows()

    def rows(self):
        with open(self.table, newline="") as file:
            return list(csv.DictReader(file))

    def test_one_value(self):
        result = self.succeeds(
            "convert", self.cloth, "--set", "d=distance/4", "--set", "distance=2", "--to", "txt", "-o", "-"
        )
        self.assertIn("pitch 2\n", result.stdout)
        self.assertIn("diameter 0.5\n", result.stdout)

    def test_grid(self):
        result, rows = self.sweep("--set", "distance=0.9:1.1:0.1", "--set", "d=0.2,0.3mm")
        self.assertEqual(
            [(row["distance"], row["d"]) for row in rows],
            [(p, d) for p in ("0.9", "1", "1.1") for d in ("0.2", "0.3mm")],
        )
        self.assertIn("6 variants: 6 ok", result.stderr)
        self.assertEqual(result.stdout, "")
        for row in rows:
            # 8 yarns over 4 pitches each; a bent one is longer.
            self.assertEqual(row["result"], "ok")
            self.assertGreater(float(row["length"]), 8 * 4 * float(row["distance"]))
            self.assertLess(float(row["length"]), 8 * 4 * float(row["distance"]) * 1.2)
            self.assertEqual(row["overlaps"], "0")

    def test_hypercube(self):
        words = ("--set", "distance=0.9:1.4", "--set", "d=0.2:0.3mm", "--lhs", 10)
        _, rows = self.sweep(*words)
        for name, low, high in (("distance", 0.9, 1.4), ("d", 0.2, 0.3)):
            parts = sorted(int((float(row[name].removesuffix("mm")) - low) / (high - low) * 10) for row in rows)
            self.assertEqual(parts, list(range(10)), "each tenth of the range has one sample")
        again = self.sweep(*words)[1]
        other = self.sweep(*words, "--seed", 2)[1]
        values = [[(row["distance"], row["d"]) for row in run] for run in (rows, again, other)]
        self.assertEqual(values[0], values[1])
        self.assertNotEqual(values[0], values[2])

    def test_table(self):
        given = self.folder / "given.csv"
        given.write_text('d;distance\n0.2mm;1\n# a comment\n"0.25";1.2\n')
        _, rows = self.sweep("--table", given, "--do", "convert", "--to", "iges,txt", "-o", self.out)
        self.assertEqual([row["d"] for row in rows], ["0.2mm", "0.25"])
        self.assertEqual(
            sorted(path.name for path in self.out.iterdir()),
            ["cloth_0001.igs", "cloth_0001.txt", "cloth_0002.igs", "cloth_0002.txt"],
        )
        self.assertIn("pitch 1.2", (self.out / "cloth_0002.txt").read_text())
        self.assertIn("diameter 0.25", (self.out / "cloth_0002.txt").read_text())

    def test_no_cell_is_a_formula(self):
        """What begins as a formula does is a text to spreadsheets, and reads back as it was."""
        odd = self.folder / "=1+1.txt"
        odd.write_text(CLOTH)
        given = self.folder / "given.csv"
        given.write_text('d,distance\n"\'+0.2mm",1\n+0.2,1\n')
        self.cloth = odd
        _, rows = self.sweep("--table", given)
        self.assertEqual([row["variant"] for row in rows], ["'=1+1_0001", "'=1+1_0002"])
        self.assertEqual([row["d"] for row in rows], ["'+0.2mm", "+0.2"])
        self.assertNotRegex(self.table.read_text(), r"(?m)(^|,)\"?[=@]")

    def test_tables_that_are_none(self):
        given = self.folder / "given.csv"
        for content, words in (
            (b"d\n0.2\n1\0002\n", ":3:1: error: the value of d has a zero byte"),
            (b"d\0\n1\n", ":1:1: error: no param is called 'd"),
            (b"a" * 300 + b"\n1\n", ":1:1: error: no param is called 'aaa"),
            (b"d\n" + b"1\n" * 1_000_001, "error: 1000001 variants are more than the 1000000"),
        ):
            given.write_bytes(content)
            result = run("sweep", self.cloth, "--table", given, "--csv", self.table)
            self.assertEqual(result.returncode, 2)
            self.assertIn(f"{given}", result.stderr)
            self.assertIn(words, result.stderr)

    def test_an_input_that_fails_without_a_parameter(self):
        path = self.folder / "wrong.txt"
        path.write_text("fabric 1\nyarn\n")
        done = run("sweep", path, "--csv", self.folder / "out.csv")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, rf"^{path}:2:\d+: error: [^\[]*\n")
        self.assertIn("1 failed", done.stderr)

    def test_variants_that_fail_have_a_row(self):
        result, rows = self.sweep("--set", "distance=0.1,1", code=1)
        self.assertEqual([row["result"] for row in rows], ["failed", "ok"])
        self.assertIn("jammed", rows[0]["message"])
        self.assertIn("[distance=0.1]", result.stderr)

    def test_wrong_words(self):
        for words, part in (
            (("--set", "distance=0:1e9:1"), "1000000001 variants are more than the 1000000"),
            (("--set", "distance"), "it is NAME=VALUE"),
            (("--set", "distance=2:1:0.1"), "from the smaller number to the larger one"),
            (("--set", "distance=1:2:0"), "a step is larger than 0"),
            (("--set", "distance=1:2:x"), "'x' is not a number"),
            (("--set", "distance=1:2"), "is for --lhs"),
            (("--set", "distance=1", "--set", "distance=2"), "set twice"),
            (("--lhs", 3), "--lhs samples ranges"),
            (("--table", self.folder / "none.csv"), "none.csv"),
            (("--size", "0.1", "--set", "distance=1"), "does not go with a sweep that does 'check'"),
        ):
            result = run("sweep", self.cloth, *words, "--csv", self.table)
            self.assertEqual(result.returncode, 2, words)
            self.assertIn(part, result.stderr)
            self.assertFalse(self.table.exists())
        result = run("check", self.cloth, "--set", "distance=1:2:1")
        self.assertEqual(result.returncode, 2)
        self.assertIn("selvage sweep", result.stderr)
        result = run("check", self.cloth, "--set", "distanc=1")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no such param; did you mean 'distance'?", result.stderr)
        iges = self.folder / "cloth.igs"
        self.succeeds("convert", self.cloth, "-o", iges)
        self.assertIn("has no params to set", run("check", iges, "--set", "distance=1").stderr)

    def test_bad_tables(self):
        given = self.folder / "given.csv"
        for text, part in (
            ("", "is empty"),
            ("d,\n1,2\n", "column 2 has no name"),
            ("d,d\n1,2\n", "twice"),
            ("d,distance\n0.2\n", "given.csv:2:1: error: this row has 1 values"),
            ('d\n"0.2\n', "a quote is not closed"),
            ("d,distance\n,2\n", "the value of d is missing"),
        ):
            given.write_text(text)
            result = run("sweep", self.cloth, "--table", given, "--csv", self.table)
            self.assertEqual(result.returncode, 2, text)
            self.assertIn(part, result.stderr)

    def test_stopped_and_resumed(self):
        report = self.folder / "report.json"
        words = (
            "sweep",
            self.cloth,
            "--set",
            "distance=0.9:1.5",
            "--set",
            "d=0.2:0.3",
            "--lhs",
            400,
            "--csv",
            self.table,
            "--do",
            "convert",
            "--to",
            "iges",
            "-o",
            self.out,
            "--report",
            report,
            "-j",
            2,
        )
        process = start(*words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        # Ended by Ctrl-C, it leaves its report. Two are worked on at once: of four files two at least are reported.
        while process.poll() is None and len(list(self.out.glob("[!.]*.igs"))) < 4:
            pass
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(), 130)
        done = len(json.loads(report.read_text())["inputs"])
        self.assertGreater(done, 0)
        self.assertLess(done, 400)
        self.assertEqual(sum(row["result"] == "ok" for row in self.rows()), done)
        result = run(*words, "--resume")
        self.assertEqual(result.returncode, 0, result.stderr)
        counts = json.loads(report.read_text())["counts"]
        self.assertEqual((counts["skipped"], counts["done"]), (done, 400 - done))
        self.assertEqual(len(list(self.out.iterdir())), 400)
        self.assertTrue(all(row["result"] == "ok" and row["volume"] for row in self.rows()))

    def test_what_was_checked_is_not_checked_again(self):
        words = ("sweep", self.cloth, "--csv", self.table, "--report", self.folder / "report.json")
        self.succeeds(*words, "--set", "distance=1,1.1")
        self.succeeds(*words, "--set", "distance=1,1.1,1.2", "--resume")
        counts = json.loads((self.folder / "report.json").read_text())["counts"]
        self.assertEqual((counts["skipped"], counts["done"]), (2, 1))
        self.assertEqual([row["result"] for row in self.rows()], ["ok", "ok", "ok"])


if __name__ == "__main__":
    unittest.main()
