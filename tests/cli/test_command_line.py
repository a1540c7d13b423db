"""Words, exit codes, help: what is wrong is said, and nothing is done."""

import re
import unittest

from program import BAD, Case, GRID, PATH, run


class Usage(Case):
    def refused(self, pattern, *arguments):
        message = self.fails(2, *arguments)
        self.assertRegex(message, pattern)
        self.assertTrue(message.startswith("selvage: error: "), message)
        self.assertFalse(self.out.exists(), "a refused command line must do nothing")

    def test_version_and_help(self):
        version, libraries = self.succeeds("--version").stdout.splitlines()
        self.assertRegex(version, r"^selvage \d+\.\d+\.\d+\S*$")
        self.assertRegex(libraries, r"^with (\w+ \d+(\.\d+)+(, |$))+$")
        for library in ("OpenCASCADE", "CGAL", "Embree", "TetGen", "muParser", "Eigen", "fmt"):
            self.assertIn(f"{library} ", libraries)
        everything = self.succeeds("--help").stdout
        for command in ("convert", "relax", "check", "mesh", "info", "edit", "view", "formats"):
            self.assertIn(command, everything)
        for command in ("convert", "relax", "check", "mesh", "info", "view"):
            text = self.succeeds(command, "--help").stdout
            for option in (
                "INPUT",
                "-j",
                "--report",
                "-q,--quiet",
                "-v,--verbose",
                "--no-progress",
                "--timeout",
                "--memory",
                "--strict",
                "--tolerance",
                "--shard",
            ):
                self.assertIn(option, text, command)

    def test_unknown_words(self):
        self.refused("subcommand is required")
        self.refused("did you mean 'convert'", "convrt", GRID)
        self.refused(
            "unknown option '--repot'; did you mean '--report'", "convert", "--repot", "x", GRID, "-o", self.out
        )
        self.refused(
            "unknown option '--matrix-siz'; did you mean '--matrix-size'",
            "mesh",
            GRID,
            "--matrix",
            "--matrix-siz",
            "1",
            "-o",
            self.out,
        )
        self.refused("it goes with --matrix", "mesh", GRID, "--matrix-size", "1", "-o", self.out)
        self.refused("it goes with --matrix", "mesh", GRID, "--bond", "-o", self.out)
        self.refused("it goes with --matrix", "mesh", GRID, "--segments", "20", "-o", self.out)
        self.refused("--yarn-stiffness is of a unit cell", "mesh", GRID, "--yarn-stiffness", "chamis", "-o", self.out)
        self.refused("--size is of tetrahedra", "mesh", GRID, "--voxel", "9", "--size", "1", "-o", self.out)
        self.refused("--order 2 is of tetrahedra", "mesh", GRID, "--voxel", "9", "--order", "2", "-o", self.out)
        self.refused("'nan' is not a positive number", "mesh", GRID, "--size", "nan", "-o", self.out)
        self.refused("INPUT is required", "convert")
        self.refused(
            "unknown format 'igs'; did you mean 'iges'|unknown format 'igs'",
            "convert",
            GRID,
            "--to",
            "igs",
            "-o",
            self.out,
        )

    def test_values(self):
        for option, value in (
            ("-j", "0"),
            ("-j", "x"),
            ("--timeout", "-1"),
            ("--memory", "0"),
            ("--ends", "round"),
            ("--units", "feet"),
            ("--tolerance", "0"),
            ("--step-schema", "AP203"),
            ("--shard", "2/2"),
            ("--shard", "1"),
            ("--shard", "-1/2"),
            ("--shard", "0/0"),
            ("--iges-lines", "99"),
            ("--iges-lines", "10000000"),
        ):
            self.refused(re.escape(option), "convert", GRID, "-o", self.out, option, value)
        for option, value in (
            ("--order", "3"),
            ("--size", "0"),
            ("--size", "nan"),
            ("--size", "inf"),
            ("--matrix-size", "nan"),
            ("--gap", "nan"),
            ("--tolerance", "nan"),
            ("--timeout", "nan"),
            ("--min-dihedral", "nan"),
            ("--min-dihedral", "45"),
        ):
            self.refused(re.escape(option), "mesh", GRID, "-o", self.out, option, value)
        for option, value in (
            ("--size", "0x9"),
            ("--size", "12"),
            ("--size", "9x9x9"),
            ("--size", "99999x9"),
            ("--size", "ax9"),
            ("--size", "-4x9"),
            ("--from", "below"),
            ("--background", "white"),
            ("--background", "0,0,256"),
            ("--section", "w=0"),
            ("--section", "z"),
            ("--background", "0,0"),
        ):
            self.refused(re.escape(option), "view", GRID, "-o", self.out, option, value)

    def test_formats_that_do_not_fit(self):
        self.refused("selvage mesh", "convert", GRID, "--to", "inp", "-o", self.out)
        self.refused("writes PNG pictures and HTML pages", "view", GRID, "-o", self.folder / "x.igs")
        self.refused("cannot write iges", "mesh", GRID, "--to", "iges", "-o", self.out)
        self.refused(
            "names a file of iges, but --to asks for step", "convert", GRID, "--to", "step", "-o", self.folder / "x.igs"
        )
        self.refused("--units", "convert", GRID, "--to", "txt", "--units", "m", "-o", self.out)

    def test_resume_needs_a_report(self):
        self.refused("--report", "convert", GRID, "-o", self.out, "--resume")

    def test_a_report_that_cannot_be_written(self):
        message = self.fails(2, "convert", GRID, "-o", self.out, "--report", self.folder)
        self.assertIn("directory", message.lower())
        self.assertFalse(self.out.exists())


class Codes(Case):
    def test_one_failure_among_others(self):
        self.fails(1, "convert", BAD / "misspelt.txt", GRID, "-o", self.out, "--to", "iges")
        self.assertEqual([p.name for p in self.out.iterdir()], ["plain4_grid.igs"])

    def test_defects(self):
        overlapping = self.folder / "overlapping.txt"
        overlapping.write_text(
            "fabric 1\nthread t\n diameter 1\nend\n"
            "yarn a t\n path\n -3 0 0\n 3 0 0\n end\nend\nyarn b t\n path\n 0 -3 0.9\n 0 3 0.9\n end\nend\n"
        )
        done = run("check", overlapping)
        self.assertEqual(done.returncode, 3, done.stderr)
        depth = re.search(r"yarns 'a' and 'b' overlap, ([0-9.]+) mm deep at \(0, 0, 0\.45\)", done.stderr)
        self.assertIsNotNone(depth, done.stderr)
        self.assertAlmostEqual(float(depth[1]), 0.1, delta=0.001)
        self.assertRegex(done.stdout, r"overlap of\s+and\s+depth")

    def test_sound(self):
        done = self.succeeds("check", PATH)
        self.assertIn("sound", done.stdout)
        self.assertEqual(done.stderr, "")

    def test_strict_makes_a_warning_fail(self):
        # A thread of 30 tex that is 0.0912 mm wide would hold three times its own section of fibre.
        doubtful = self.folder / "doubtful.txt"
        doubtful.write_text(
            "fabric 1\nthread t\n tex 30\n density 1.52\n packing 0.75\n diameter 0.0912\nend\n"
            "yarn a t\n path\n 0 0 0\n 1 0 0\n end\nend\n"
        )
        done = self.succeeds("convert", doubtful, "-o", self.folder / "x.igs")
        self.assertIn("warning:", done.stderr)
        self.fails(1, "convert", doubtful, "-o", self.folder / "y.igs", "--strict")
        self.assertFalse((self.folder / "y.igs").exists())


if __name__ == "__main__":
    unittest.main()
