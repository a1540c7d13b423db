"""Fabrics too long for one IGES file: written as NAME.1.igs, NAME.2.igs, ..., read back as one. The limit is lowered by
--iges-lines."""

import json
import os
import shutil
import subprocess
import unittest

from program import Case, files_below

WEAVE = """fabric 1
units mm
title "Two by two"
thread a
  section ellipse 0.4 0.2
end
weave
  warp a 4 pitch 1
  weft a 4 pitch 1
  draft plain
  profile sine
end
"""
LINES = 1540  # four of eight yarns


class Set(Case):
    def setUp(self):
        super().setUp()
        self.text = self.folder / "w.txt"
        self.text.write_text(WEAVE)
        self.whole = self.folder / "whole.igs"
        self.target = self.out / "w.igs"

    def names(self):
        return sorted(files_below(self.out))

    def split(self, *options, lines=LINES):
        return self.succeeds("convert", self.text, "-o", self.target, "--iges-lines", lines, *options)

    def yarns(self, *arguments):
        """Names in the order of the file, as `info --json` reads them."""
        report = json.loads(self.succeeds("info", *arguments, "--json").stdout)
        return [[yarn["name"] for yarn in entry["yarns"]] for entry in report["inputs"]]


class Writing(Set):
    def test_the_report_lists_every_file(self):
        done = self.split("--report", self.folder / "r.json")
        self.assertRegex(done.stderr, r"warning: .*written as [23] files, '.*w\.1\.igs' to '.*w\.[23]\.igs'")
        self.assertIn(f"{len(self.names())} files written", done.stderr)
        entry = json.loads((self.folder / "r.json").read_text())["inputs"][0]
        self.assertEqual([os.path.basename(output["path"]) for output in entry["outputs"]], self.names())
        self.assertNotIn("w.igs", self.names())
        self.assertEqual(sum(output["entities"]["128"] for output in entry["outputs"]), 24)
        for output in entry["outputs"]:
            self.assertEqual(output["bytes"], os.path.getsize(output["path"]))
            digest = subprocess.run(["sha256sum", output["path"]], capture_output=True, text=True).stdout.split()[0]
            self.assertEqual(output["sha256"], digest)

    def test_one_file_keeps_its_name(self):
        self.split(lines=9999999)
        self.assertEqual(self.names(), ["w.igs"])

    def test_resume_goes_by_all_files(self):
        options = ["--report", self.folder / "r.json", "--resume"]
        self.split(*options)
        self.assertIn("1 were up to date", self.split(*options).stderr)
        self.assertIn("1 of 1 inputs done", self.split(*options, lines=LINES - 1).stderr)
        (self.out / "w.2.igs").unlink()
        self.assertNotIn("up to date", self.split(*options, lines=LINES - 1).stderr)
        self.assertIn("w.2.igs", self.names())

    def test_nothing_of_an_earlier_run_misleads(self):
        self.split(lines=800)
        many = len(self.names())
        self.split()
        self.assertLess(len(self.names()), many)
        other = self.out / f"w.{len(self.names()) + 1}.igs"
        other.write_text("not ours")
        self.split(lines=9999999)
        self.assertEqual(self.names(), sorted(["w.igs", other.name]))
        self.split()
        self.assertNotIn("w.igs", self.names())
        self.assertEqual(other.read_text(), "not ours")

    def test_a_failed_run_leaves_what_was_there(self):
        self.split()
        before = files_below(self.out)
        self.fails(1, "convert", self.text, "-o", self.target, "--iges-lines", 250)
        self.fails(1, "convert", self.text, "-o", self.target, "--iges-lines", 800, "--strict")
        self.assertEqual(files_below(self.out), before)

    def test_standard_output_cannot_be_split(self):
        message = self.fails(1, "convert", self.text, "--to", "iges", "-o", "-", "--iges-lines", LINES)
        self.assertIn("name a file with -o", message)

    def test_an_input_is_never_replaced_by_a_part(self):
        # The second input's file has the name that the first part of the first one's would have.
        shutil.copy(self.text, self.folder / "w.1.txt")
        message = self.fails(
            1, "convert", self.text, self.folder / "w.1.txt", "--to", "iges", "-o", self.out, "--iges-lines", LINES
        )
        self.assertRegex(message, r"w\.igs' does not fit into one file, and its file 1, '.*w\.1\.igs', would replace")
        self.assertEqual(self.names(), ["w.1.1.igs", "w.1.2.igs"] + (["w.1.3.igs"] if len(self.names()) > 2 else []))

    def test_a_set_is_not_replaced_by_its_own_fabric(self):
        self.split()
        self.assertIn("would replace the input", self.fails(2, "convert", self.out / "w.1.igs", "-o", self.target))

    def test_a_yarn_too_long_for_any_file(self):
        message = self.fails(1, "convert", self.text, "-o", self.target, "--iges-lines", 250)
        self.assertRegex(message, r"error: yarn warp_1 alone needs \d+ parameter lines .* 250 at most: --split-yarns")
        done = self.split("--split-yarns", lines=250)
        self.assertIn("cut into", done.stderr)
        names = self.yarns(self.out / "w.1.igs")[0]
        self.assertEqual(names[:2], ["warp_1.part1", "warp_1.part2"])
        self.assertEqual(len({name.split(".")[0] for name in names}), 8)
        # The pieces are closed, and that two of them touch is no defect.
        self.assertIn(
            "every yarn is a closed valid solid, no two overlap", self.succeeds("check", self.out / "w.1.igs").stdout
        )


class Reading(Set):
    def setUp(self):
        super().setUp()
        self.split()
        self.succeeds("convert", self.text, "-o", self.whole)

    def test_the_first_file_and_the_plain_name_stand_for_all(self):
        names = self.yarns(self.whole)
        self.assertEqual(len(names[0]), 8)
        self.assertEqual(self.yarns(self.out / "w.1.igs"), names)
        self.assertEqual(self.yarns(self.target), names)
        self.succeeds("diff", self.whole, self.target)

    def test_folders_and_patterns_take_a_set_once(self):
        names = self.yarns(self.whole)
        self.assertEqual(self.yarns(self.out), names)
        self.assertEqual(self.yarns(str(self.out / "*.igs")), names)
        self.assertEqual(self.yarns(*sorted(self.out.iterdir())), names)

    def test_a_later_file_by_itself(self):
        done = self.succeeds("info", self.out / "w.2.igs")
        self.assertIn("w.2.igs: warning: this is file 2 of", done.stderr)
        self.assertIn("w.1.igs' stands for all", done.stderr)

    def test_outputs_have_no_number(self):
        (self.folder / "texts").mkdir()
        self.succeeds("convert", self.out / "w.1.igs", "--to", "txt", "-o", self.folder / "texts")
        self.assertEqual(list(files_below(self.folder / "texts")), ["w.txt"])
        self.succeeds("convert", self.out, "--to", "txt", "-o", self.folder / "again")
        self.assertEqual(list(files_below(self.folder / "again")), ["w.txt"])

    def test_written_as_one_it_is_the_same_file(self):
        self.succeeds("convert", self.out / "w.1.igs", "-o", self.folder / "one.igs")
        self.succeeds("convert", self.whole, "-o", self.folder / "two.igs")
        one, two = ((self.folder / name).read_text().splitlines() for name in ("one.igs", "two.igs"))
        self.assertEqual([line for line in one if line[72] in "DP"], [line for line in two if line[72] in "DP"])

    def test_a_missing_file_is_named(self):
        (self.out / "w.2.igs").unlink()
        message = self.fails(1, "info", self.out / "w.1.igs")
        self.assertRegex(message, r"w\.2\.igs: error: .*file 2 of")

    def test_files_of_different_runs_are_no_set(self):
        other = self.out / "w.2.igs"
        text = other.read_text()
        self.text.write_text(WEAVE.replace("0.4 0.2", "0.4 0.22"))
        self.split()
        other.write_text(text)
        self.assertRegex(self.fails(1, "info", self.out / "w.1.igs"), r"w\.2\.igs: error: .*different runs")
        other.write_text(self.whole.read_text())
        self.assertRegex(self.fails(1, "info", self.out / "w.1.igs"), r"w\.2\.igs: error: this is not file 2 of")

    def test_errors_in_a_later_file_are_told_of_it(self):
        other = self.out / "w.2.igs"
        other.write_text(other.read_text().replace("128,10,", "128,1x,", 1))
        self.assertRegex(self.fails(1, "info", self.out / "w.1.igs"), r"w\.2\.igs.*error:")


if __name__ == "__main__":
    unittest.main()
