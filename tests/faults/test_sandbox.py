"""Workers that turn against the user are stopped, and the run goes on; the limits that nobody asked for."""

import ctypes
import os
import pathlib
import shutil
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from program import Case, GRID, RING, environment, files_below, run  # noqa: E402


def has_landlock():
    return ctypes.CDLL(None).syscall(444, None, ctypes.c_size_t(0), 1) > 0


class Traitor(Case):
    def convert(self, sandbox):
        inside, elsewhere = self.folder / "in", self.folder / "elsewhere"
        for folder in (inside, elsewhere):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
        for name in ("a.txt", "traitor.txt", "z.txt"):
            shutil.copy(GRID, inside / name)
        done = run("convert", inside, "--to", "iges", "-o", self.out, "-j", 1, "--sandbox", sandbox,
                   env=environment(LD_PRELOAD=os.environ["SELVAGE_TRAITOR"], TRAITOR=str(elsewhere)))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(files_below(self.out)), ["a.igs", "traitor.igs", "z.igs"])
        deeds = {line.split()[1] for line in done.stderr.splitlines() if line.startswith("traitor:")}
        self.assertEqual("file" in deeds, (elsewhere / "file").exists())
        return deeds

    def test_it_is_stopped(self):
        self.assertEqual(self.convert("auto"), set() if has_landlock() else {"file"})

    def test_it_does_so_where_it_may(self):
        self.assertEqual(self.convert("off"), {"socket", "program", "file"})


class Option(Case):
    def test_require(self):
        done = run("check", RING, "--sandbox", "require")
        if has_landlock():
            self.assertEqual(done.returncode, 0, done.stderr)
        else:
            self.assertEqual(done.returncode, 2)
            self.assertIn("this kernel has no Landlock", done.stderr)

    def test_words(self):
        self.assertIn("--sandbox", self.fails(2, "check", RING, "--sandbox", "maybe"))

    def test_every_command_lives_within_it(self):
        out = self.out
        for words in (["convert", GRID, "-o", out], ["convert", GRID, "--to", "iges", "-o", "-"],
                      ["check", GRID, "--report", out / "r/report.json", "--gap-map", out / "maps/gaps.vtu"],
                      ["mesh", RING, "--size", "0.5", "-o", out], ["view", GRID, "-o", out / "pictures/a.png"],
                      ["roundtrip", GRID], ["diff", GRID, GRID], ["info", GRID], ["relax", GRID, "-o", out / "relaxed/"],
                      ["edit", RING, "--yarn", "ring", "--point", "1", "--to", "5.1,0,0", "-o", out / "edited/e.txt"]):
            with self.subTest(words[0]):
                self.succeeds(*words, "--sandbox", "require" if has_landlock() else "auto")

    def test_links_lead_where_they_lead(self):
        (self.folder / "away").mkdir()
        shutil.copy(GRID, self.folder / "away/a.txt")
        (self.folder / "in").mkdir()
        (self.folder / "in/link.txt").symlink_to("../away/a.txt")
        (self.folder / "linked").symlink_to("away")
        self.succeeds("convert", self.folder / "in/link.txt", "--to", "iges", "-o", f"{self.folder}/linked/")
        self.assertTrue((self.folder / "away/link.igs").exists())

    def test_help_tells_the_limits(self):
        for command in ("convert", "check", "mesh", "diff", "edit"):
            words = " ".join(self.succeeds(command, "--help").stdout.split())
            for limit in ("default: 300 for formats of other programs", "shared by the inputs worked on at once", "--sandbox"):
                self.assertIn(limit, words)


if __name__ == "__main__":
    unittest.main()
