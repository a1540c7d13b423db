"""Where outputs go, that they are whole or absent, and that no two inputs share one."""

import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import unittest

from program import BAD, Case, GRID, PATH, PROGRAM, RING, environment, files_below, run, start


class Places(Case):
    def names(self):
        return sorted(files_below(self.folder))

    def test_one_input_one_format_is_a_file(self):
        self.succeeds("convert", GRID, "-o", self.folder / "a" / "x.igs")
        self.assertEqual(self.names(), ["a/x.igs"])

    def test_a_name_without_an_extension_is_a_folder(self):
        """With one format and one input, too."""
        self.succeeds("convert", GRID, "--to", "iges", "-o", self.folder / "plain")
        self.succeeds("relax", PATH, "-o", self.folder / "relaxed")
        self.succeeds("mesh", GRID, "--size", "0.4", "-o", self.folder / "meshed")
        self.succeeds("view", RING, "--size", "8x8", "-o", self.folder / "seen")
        self.succeeds("edit", PATH, "--yarn", "warp1", "--point", "2", "--to", "0.4,0.5,0.2", "-o", self.folder / "edited")
        self.assertEqual(self.names(), ["edited/plain4_path.txt", "meshed/plain4_grid.inp", "plain/plain4_grid.igs",
                                        "relaxed/plain4_path.txt", "seen/ring.png"])

    def test_a_name_that_is_fixed(self):
        """Equal content is equal bytes under every name, if what headers call the file is said."""
        os.environ["SOURCE_DATE_EPOCH"] = "1700000000"
        self.addCleanup(os.environ.pop, "SOURCE_DATE_EPOCH")
        for extension, header in (("igs", rb"10Hfabric\.cad"), ("stp", rb"FILE_NAME\('fabric\.cad'")):
            own = [self.folder / f"{stem}.{extension}" for stem in ("one", "another")]
            fixed = [self.folder / "fixed" / path.name for path in own]
            for free, named in zip(own, fixed):
                self.succeeds("convert", GRID, "-o", free)
                self.succeeds("convert", GRID, "-o", named, "--file-name", "fabric.cad")
            self.assertNotEqual(own[0].read_bytes(), own[1].read_bytes())
            self.assertEqual(fixed[0].read_bytes(), fixed[1].read_bytes())
            self.assertRegex(fixed[0].read_bytes()[:2000], header)
            # Also where a file that is read says another one.
            self.succeeds("convert", own[0], "-o", self.out / fixed[0].name, "--file-name", "fabric.cad")
            self.assertRegex((self.out / fixed[0].name).read_bytes()[:2000], header)

    def test_a_time_that_is_none(self):
        for moment in ("yesterday", "", "1.5", "-1", "253402300800"):
            message = self.fails(2, "convert", GRID, "-o", self.folder / "x.igs", env=environment(SOURCE_DATE_EPOCH=moment))
            self.assertIn(f"selvage: error: SOURCE_DATE_EPOCH is '{moment}'", message)
            self.assertEqual(self.names(), [])

    def test_an_extension_that_no_format_has(self):
        for arguments, listed in ((("convert", GRID), r"\.igs, .*\.stp"), (("convert", GRID, "--to", "iges"), r"\.igs"),
                                  (("convert", GRID, RING), r"\.igs"), (("relax", PATH), r"\.txt"),
                                  (("mesh", GRID), r"\.inp"), (("view", GRID), r"\.png"),
                                  (("edit", PATH, "--yarn", "warp1", "--point", "2", "--to", "0,0,0"), r"\.txt")):
            message = self.fails(2, *arguments, "-o", self.folder / "x.sat")
            self.assertRegex(message, f"no format has the extension '.sat'.*{listed}")
            self.assertEqual(self.names(), [])
        self.assertIn("cannot write iges", self.fails(2, "edit", PATH, "--yarn", "warp1", "--point", "2", "--to", "0,0,0",
                                                         "-o", self.folder / "x.igs"))
        # A folder may be called so.
        self.succeeds("convert", GRID, "--to", "iges", "-o", f"{self.folder}/v1.5/")
        self.succeeds("convert", RING, "--to", "iges", "-o", self.folder / "v1.5")
        self.assertEqual(self.names(), ["v1.5/plain4_grid.igs", "v1.5/ring.igs"])

    def test_without_format_iges_and_step_in_a_folder(self):
        self.succeeds("convert", GRID, "-o", self.out)
        self.assertEqual(self.names(), ["out/plain4_grid.igs", "out/plain4_grid.stp"])

    def test_a_macro_belongs_to_load_cases(self):
        """Dry yarns have none: no second file, also for --resume."""
        report = self.folder / "report.json"
        self.succeeds("mesh", GRID, "--size", "0.4", "--to", "cdb", "-o", self.out / "x.cdb", "--report", report)
        self.assertEqual(list(files_below(self.out)), ["x.cdb"])
        again = self.succeeds("mesh", GRID, "--size", "0.4", "--to", "cdb", "-o", self.out / "x.cdb", "--report", report,
                              "--resume")
        self.assertIn("1 were up to date", again.stderr)
        refused = run("mesh", GRID, "--size", "0.4", "--to", "mac", "-o", self.out / "y.mac")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("--matrix --periodic", refused.stderr)

    def test_a_folder_that_exists(self):
        self.out.mkdir()
        self.succeeds("convert", GRID, "--to", "iges", "-o", self.out)
        self.assertEqual(self.names(), ["out/plain4_grid.igs"])

    def test_beside_the_input(self):
        shutil.copy(GRID, self.folder / "a.txt")
        self.succeeds("convert", self.folder / "a.txt", "--to", "iges")
        self.assertEqual(self.names(), ["a.igs", "a.txt"])

    def test_folders_are_mirrored(self):
        for name in ("in/a/plain.txt", "in/b/plain.txt", "in/top.txt", "in/.hidden/no.txt"):
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(GRID, self.folder / name)
        (self.folder / "in" / "notes.md").write_text("not a fabric")
        self.succeeds("convert", self.folder / "in", "--to", "iges", "-o", self.out)
        self.assertEqual(sorted(files_below(self.out)), ["a/plain.igs", "b/plain.igs", "top.igs"])

    def test_standard_output(self):
        self.succeeds("convert", GRID, "-o", self.folder / "-.igs")
        done = self.succeeds("convert", GRID, "--to", "iges", "-o", "-")
        self.assertEqual(done.stdout.splitlines()[-1], (self.folder / "-.igs").read_text().splitlines()[-1])
        self.assertEqual(done.stderr, "")
        self.assertIn("one input and one format", self.fails(2, "convert", GRID, "-o", "-"))
        self.assertIn("one input and one format", self.fails(2, "convert", GRID, RING, "--to", "iges", "-o", "-"))

    def test_the_same_bytes_with_any_number_of_workers(self):
        inputs = [GRID, PATH, RING]
        self.succeeds("convert", *inputs, "--to", "iges", "-o", self.folder / "one", "-j", 1)
        self.succeeds("convert", *inputs, "--to", "iges", "-o", self.folder / "four", "-j", 4)
        self.assertEqual(files_below(self.folder / "one"), files_below(self.folder / "four"))


class Units(Case):
    """--units writes the same shape in another unit."""

    def iges(self, *options):
        """(units flag of the global section, numbers of the first 128)"""
        untitled = self.folder / "ring.txt"  # titles and their commas aside, a record is split at its commas
        untitled.write_text(re.sub("(?m)^title.*\n", "", pathlib.Path(RING).read_text()))
        lines = self.succeeds("convert", untitled, "--to", "iges", "-o", "-", *options).stdout.splitlines()
        # The first field is the comma itself, so the 14th stands one place later.
        flag = "".join(line[:72].strip() for line in lines if line[72] == "G").split(",")[14]
        surface = "".join(line[:64].strip() for line in lines if line[72] == "P").split(";")
        return flag, next([float(word) for word in part.split(",")] for part in surface if part.startswith("128,"))

    def test_surfaces(self):
        flag, mm = self.iges()
        self.assertEqual((flag, self.iges("--units", "mm")), ("2", (flag, mm)))
        k1, k2, m1, m2 = (int(x) for x in mm[1:5])
        knots = k1 + m1 + 2 + k2 + m2 + 2
        count = (k1 + 1) * (k2 + 1)
        head = 10 + knots + count  # type, sizes, flags, knots, weights: the same in any unit
        for unit, wanted, scale in (("cm", "10", 0.1), ("inch", "1", 1 / 25.4), ("m", "6", 0.001), ("um", "9", 1000.0)):
            flag, other = self.iges("--units", unit)
            self.assertEqual(flag, wanted)
            self.assertEqual(other[:head], mm[:head])
            for a, b in zip(other[head:head + 3 * count], mm[head:head + 3 * count]):
                self.assertAlmostEqual(a, b * scale, delta=4e-16 * abs(b * scale))

    def test_tables(self):
        length = lambda text: float(next(line for line in text.splitlines() if "together" in line).split()[2].rstrip(","))
        mm = length(self.succeeds("info", RING).stdout)
        self.assertAlmostEqual(length(self.succeeds("info", RING, "--units", "cm").stdout), mm / 10, places=5)


class Collisions(Case):
    def refused(self, pattern, *arguments):
        before = files_below(self.folder)
        self.assertRegex(self.fails(2, *arguments), pattern)
        self.assertEqual(files_below(self.folder), before)

    def test_two_inputs_one_output(self):
        for name in ("a/plain.txt", "b/plain.txt"):
            (self.folder / name).parent.mkdir()
            shutil.copy(GRID, self.folder / name)
        self.refused("would both write", "convert", self.folder / "a/plain.txt", self.folder / "b/plain.txt", "-o", self.out)
        # The same folder under two names is one place.
        os.symlink(self.folder / "a", self.folder / "c")
        self.refused("would both write", "convert", self.folder / "a/plain.txt", self.folder / "c/plain.txt")

    def test_an_output_that_is_an_input(self):
        shutil.copy(GRID, self.folder / "a.txt")
        self.refused("would replace the input", "convert", self.folder / "a.txt", "--to", "txt")
        self.refused("would replace the input", "convert", self.folder / "a.txt", "-o", self.folder / "a.txt")

    def test_a_report_in_the_way(self):
        shutil.copy(GRID, self.folder / "a.txt")
        self.refused("report", "convert", self.folder / "a.txt", "--report", self.folder / "a.txt", "-o", self.out)
        self.refused("report", "convert", self.folder / "a.txt", "--report", self.out / "a.igs", "-o", self.out)

    def test_several_inputs_one_file(self):
        self.refused("names one file", "convert", GRID, RING, "-o", self.folder / "x.igs")


class Trouble(Case):
    """One output cannot be written; the other inputs are done, and nothing half-written stays."""

    def test_output_is_a_directory(self):
        (self.out / "ring.igs").mkdir(parents=True)
        message = self.fails(1, "convert", RING, GRID, "--to", "iges", "-o", self.out)
        self.assertIn(f"{self.out}/ring.igs: error: cannot write: Is a directory", message)
        self.assertEqual(list(files_below(self.out)), ["plain4_grid.igs"])
        self.assertIn("Is a directory", self.fails(1, "convert", GRID, "-o", self.out / "ring.igs"))

    def test_a_file_where_a_folder_is_needed(self):
        self.out.write_text("in the way")
        self.assertIn(str(self.out), self.fails(1, "convert", GRID, "-o", self.out))
        self.assertEqual(self.out.read_text(), "in the way")

    def test_limit_of_file_size(self):
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))

        done = subprocess.run([PROGRAM, "convert", GRID, "--to", "iges", "-o", self.folder / "x.igs"], preexec_fn=limit,
                              env=environment(), capture_output=True, text=True)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("x.igs: error: cannot write: File too large", done.stderr)
        self.assertEqual(files_below(self.folder), {})

    def test_full_disk(self):
        self.out.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=16k", "none", self.out], capture_output=True)
        if mounted.returncode != 0:
            self.skipTest("a small file system can be mounted by root only; test_limit_of_file_size stands in")
        try:
            old = self.out / "plain4_grid.igs"
            old.write_text("old")
            message = self.fails(1, "convert", GRID, "--to", "iges", "-o", self.out)
            self.assertIn("No space left on device", message)
            self.assertEqual(files_below(self.out), {"plain4_grid.igs": b"old"})
        finally:
            subprocess.run(["umount", self.out], check=True)

    def test_folder_without_permission(self):
        options, program = {}, PROGRAM
        if os.geteuid() == 0:  # root may write everywhere: be someone else, with a program that he can reach
            program = self.folder / "selvage"
            shutil.copy(PROGRAM, program)
            os.chmod(self.folder, 0o755)
            options = {"user": 65534, "group": 65534, "extra_groups": []}
        source = self.folder / "grid.txt"
        shutil.copy(GRID, source)
        source.chmod(0o644)
        closed = self.folder / "closed"
        closed.mkdir(mode=0o500)
        done = subprocess.run([program, "convert", source, "-o", closed / "x.igs"], env=environment(), capture_output=True,
                              text=True, **options)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("x.igs: error: cannot write: Permission denied", done.stderr)
        closed.chmod(0o000)
        done = subprocess.run([program, "convert", closed, source, "--to", "iges", "-o", "-"], env=environment(),
                              capture_output=True, text=True, **options)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(files_below(self.folder).keys() - {"selvage"}, {"grid.txt"})

    def test_a_failed_input_leaves_the_old_output(self):
        target = self.folder / "x.igs"
        target.write_text("old")
        self.fails(1, "convert", BAD / "short_grid.txt", "-o", target)
        self.assertEqual(files_below(self.folder), {"x.igs": b"old"})

    def test_standard_output_that_cannot_be_written(self):
        """Whatever was to be read there: full, or closed, it is an error, and no file gets the closed one's number."""
        edit = ("edit", PATH, "--yarn", "warp1", "--point", "2", "--to", "0.4,0.5,0.2", "-o", "-")
        report = ("convert", GRID, "-o", self.folder / "x.igs", "--report", "-")
        for arguments in (("info", GRID), ("info", GRID, "--json"), ("formats",), ("--version",), ("--help",),
                          ("convert", "--help"), ("check", GRID), ("diff", GRID, GRID), ("diff", GRID, PATH),
                          ("diff", GRID, GRID, "--json"), ("convert", GRID, "--to", "iges", "-o", "-"), report, edit,
                          ("roundtrip", GRID, "--to", "iges")):
            with self.subTest(arguments):
                with open("/dev/full", "w") as full:
                    done = subprocess.run([PROGRAM, *map(str, arguments)], stdout=full, stderr=subprocess.PIPE,
                                          env=environment(), text=True)
                self.assertEqual(done.returncode, 1, done.stderr)
                self.assertIn("No space left on device", done.stderr)
                closed = subprocess.run(["sh", "-c", 'exec "$@" >&-', "sh", PROGRAM, *map(str, arguments)],
                                        stderr=subprocess.PIPE, env=environment(), text=True)
                self.assertEqual(closed.returncode, 1, closed.stderr)
                self.assertIn("Bad file descriptor", closed.stderr)
        self.succeeds("convert", GRID, "-o", self.folder / "y.igs")
        self.assertEqual((self.folder / "x.igs").read_bytes().replace(b"x.igs", b"y.igs"),
                         (self.folder / "y.igs").read_bytes())

    def test_what_killed_runs_left_is_removed(self):
        self.out.mkdir()
        (self.out / ".selvage-0123456789abcdef.partial").write_text("from a run that was killed")
        own = self.out / ".plain4_grid.igs.selvage-partial"
        own.write_text("the user's own")
        self.succeeds("convert", GRID, "--to", "iges", "-o", self.out)
        self.assertEqual(files_below(self.out).keys(), {"plain4_grid.igs", own.name})
        self.assertEqual(own.read_text(), "the user's own")

    def test_runs_at_once_into_one_folder(self):
        inputs = [GRID, PATH, RING]
        self.succeeds("convert", *inputs, "--to", "iges,txt", "-o", self.folder / "alone")
        for _ in range(3):
            runs = [start("convert", *inputs, "--to", "iges,txt", "-o", self.out, "-j", 2) for _ in range(6)]
            for process in runs:
                _, message = process.communicate()
                self.assertEqual(process.returncode, 0, message)
            self.assertEqual(files_below(self.out), files_below(self.folder / "alone"))

    def test_what_is_replaced(self):
        """The permissions stay, and the link; what else leads to the old file keeps it."""
        old = self.folder / "old.igs"
        old.write_text("old")
        old.chmod(0o640)
        os.link(old, self.folder / "kept.igs")
        os.symlink("old.igs", self.folder / "link.igs")
        self.succeeds("convert", GRID, "-o", self.folder / "link.igs")
        self.assertTrue((self.folder / "link.igs").is_symlink())
        self.assertEqual(old.read_bytes()[72:80], b"S      1")
        self.assertEqual(old.stat().st_mode & 0o777, 0o640)
        self.assertEqual((self.folder / "kept.igs").read_text(), "old")

    def test_a_link_to_what_is_not_there(self):
        """The file is made where the link leads, in another folder."""
        (self.folder / "store").mkdir()
        os.symlink("store/new.igs", self.folder / "a.igs")
        self.succeeds("convert", GRID, "-o", self.folder / "a.igs")
        self.assertTrue((self.folder / "a.igs").is_symlink())
        self.assertEqual((self.folder / "store/new.igs").read_bytes()[72:80], b"S      1")


if __name__ == "__main__":
    unittest.main()
