"""What can be named as an input, and what is said of inputs that are bad."""

import os
import pathlib
import shutil
import subprocess
import threading
import unittest

from program import BAD, Case, GRID, PATH, PROGRAM, RING, environment, files_below


class Kinds(Case):
    def converted(self, *arguments, **options):
        self.succeeds("convert", *arguments, "--to", "iges", "-o", f"{self.out}/", **options)
        return sorted(files_below(self.out))

    def test_standard_input(self):
        text = pathlib.Path(GRID).read_text()
        self.assertEqual(self.converted("-", input=text), ["stdin.igs"])
        direct = self.succeeds("convert", GRID, "--to", "iges", "-o", "-").stdout
        piped = self.succeeds("convert", "-", "--to", "iges", "-o", "-", input=text).stdout
        # All but the names in the global section are the same.
        self.assertEqual(
            [line for line in direct.splitlines() if line[72] in "DP"],
            [line for line in piped.splitlines() if line[72] in "DP"],
        )
        self.assertIn("name one with -o", self.fails(2, "convert", "-", input=text))
        self.assertIn("only once", self.fails(2, "convert", "-", "-", "-o", self.out, input=text))

    def test_list(self):
        listing = self.folder / "list.txt"
        listing.write_text(f"{GRID}\r\n\n{RING}\n")
        self.assertEqual(self.converted(f"@{listing}"), ["plain4_grid.igs", "ring.igs"])

    def test_list_that_is_missing(self):
        self.assertIn("No such file", self.fails(2, "convert", f"@{self.folder}/none.txt", "-o", self.out))

    def test_lines_of_a_list_that_are_no_paths(self):
        listing = self.folder / "list.txt"
        for content, place, words in (
            (f"{GRID}\r\n{GRID}\0x\r\n", 2, "this line has a zero byte"),
            (f"\n\n@{GRID}\n", 3, "a list cannot name another list"),
            (f"{GRID}\n{'a/' * 3000}b\n", 2, "this line has 6001 bytes, and a path less than 4096"),
        ):
            listing.write_text(content, newline="")
            message = self.fails(2, "convert", f"@{listing}", "-o", self.out)
            self.assertIn(f"{listing}:{place}:1: error: {words}", message)
        huge = self.folder / "huge.txt"
        with open(huge, "w") as file:
            file.truncate(1 << 40)
        self.assertIn("larger than the 268435456 bytes", self.fails(2, "convert", f"@{huge}", "-o", self.out))

    def test_a_list_in_a_pipe(self):
        pipe = self.folder / "pipe"
        os.mkfifo(pipe)
        writer = threading.Thread(target=lambda: pipe.write_text(f"{GRID}\r\n{RING}"))
        writer.start()
        self.assertEqual(self.converted(f"@{pipe}"), ["plain4_grid.igs", "ring.igs"])
        writer.join()

    def test_pattern_that_the_shell_left_alone(self):
        for name in ("a1.txt", "a2.txt", "b.txt"):
            shutil.copy(GRID, self.folder / name)
        self.assertEqual(self.converted(f"{self.folder}/a?.txt"), ["a1.igs", "a2.igs"])

    def test_a_name_with_a_star_in_it(self):
        shutil.copy(GRID, self.folder / "a*.txt")
        self.assertEqual(self.converted(f"{self.folder}/a*.txt"), ["a*.igs"])

    def test_content_tells_before_the_extension(self):
        shutil.copy(GRID, self.folder / "fabric.dat")
        self.assertEqual(self.converted(self.folder / "fabric.dat"), ["fabric.igs"])

    def test_shards_are_a_partition(self):
        inputs = self.folder / "in"  # the outputs can be read, too, and are no inputs
        inputs.mkdir()
        for i in range(7):
            shutil.copy(RING, inputs / f"r{i}.txt")
        parts = []
        for i in range(3):
            out = self.folder / f"part{i}"
            self.succeeds("convert", inputs, "--to", "iges", "-o", f"{out}/", "--shard", f"{i}/3")
            parts.append({name for name in files_below(out) if name.startswith("r")})
        self.assertEqual(sorted(map(len, parts)), [2, 2, 3])
        self.assertEqual(set.union(*parts), {f"r{i}.igs" for i in range(7)})


class Links(Case):
    """A folder is not left by way of a symbolic link in it."""

    def setUp(self):
        super().setUp()
        self.inside, self.outside = self.folder / "in", self.folder / "outside"
        for folder in (self.inside / "sub", self.outside / "deep"):
            folder.mkdir(parents=True)
        shutil.copy(RING, self.inside / "own.txt")
        shutil.copy(RING, self.outside / "other.txt")
        shutil.copy(RING, self.outside / "deep" / "one.txt")
        (self.outside / "words.txt").write_text("secret words\n")
        for name, target in (
            ("within.txt", "own.txt"),
            ("sub/up.txt", "../own.txt"),
            ("out.txt", "../outside/other.txt"),
            ("words.txt", self.outside / "words.txt"),
            ("folder", "../outside"),
            ("loop", "."),
            ("sub/loop", ".."),
            ("sub/above", "../.."),
            ("twice", "../outside/deep"),
            ("circle.txt", "circle.txt"),
            ("nowhere.txt", "gone.txt"),
            ("kernel.txt", "/proc/kmsg"),
            ("shadow.txt", "/etc/shadow"),
        ):
            (self.inside / name).symlink_to(target)

    def test_links_are_passed_by(self):
        messages = self.succeeds("convert", self.inside, "--to", "iges", "-o", f"{self.out}/").stderr
        self.assertEqual(sorted(files_below(self.out)), ["own.igs", "sub/up.igs", "within.igs"])
        for name in ("out.txt", "words.txt", "folder", "kernel.txt", "shadow.txt", "sub/above", "twice"):
            self.assertIn(
                f"{self.inside}/{name}: note: passed by: this symbolic link leads out of the folder; --allow-outside follows it\n",
                messages,
            )
        for name in ("circle.txt", "nowhere.txt"):
            self.assertRegex(messages, f"{self.inside}/{name}: note: passed by: this symbolic link leads nowhere ")
        for name in ("loop", "sub/loop"):
            self.assertIn(
                f"{self.inside}/{name}: note: passed by: this symbolic link leads to a folder that is searched where it is\n",
                messages,
            )
        self.assertNotIn("secret", messages)
        self.assertEqual(messages.count("note"), 11)
        quiet = self.succeeds("convert", self.inside, "--to", "iges", "-o", f"{self.out}/", "--quiet").stderr
        self.assertEqual(quiet, "")

    def test_links_are_followed_where_that_is_wanted(self):
        for name in ("kernel.txt", "shadow.txt", "words.txt"):
            (self.inside / name).unlink()
        (self.outside / "words.txt").unlink()
        (self.outside / "back").symlink_to("../in")
        (self.outside / "deep" / "round").symlink_to("..")
        messages = self.succeeds("convert", self.inside, "--to", "iges", "-o", f"{self.out}/", "--allow-outside").stderr
        made = sorted(files_below(self.out))
        self.assertEqual([name for name in made if "/" not in name], ["out.igs", "own.igs", "within.igs"])
        self.assertIn("folder/other.igs", made)
        self.assertIn("folder/deep/one.igs", made)
        self.assertLess(len(made), 12)
        self.assertNotIn("leads out", messages)

    def test_lines_of_another_folder_are_not_shown(self):
        message = self.fails(1, "info", self.inside / "words.txt")
        self.assertIn("in/words.txt:1:1: error: ", message)
        self.assertNotIn("secret", message)
        self.assertIn("secret words\n  ^", self.fails(1, "info", self.outside / "words.txt"))

    def test_many_links(self):
        for k in range(100):
            (self.inside / f"link{k:03}.txt").symlink_to("/etc/shadow")
        messages = self.succeeds("info", self.inside).stderr
        self.assertEqual(messages.count("note: "), 21)
        self.assertIn("further symbolic links were passed by", messages)


class Bad(Case):
    """The others are done, the bad one is named with its place, and nothing of it is written."""

    def failed(self, path, pattern):
        message = self.fails(1, "convert", path, GRID, "--to", "iges", "-o", f"{self.out}/")
        self.assertRegex(message, pattern)
        self.assertEqual(sorted(files_below(self.out)), ["plain4_grid.igs"])

    def test_places_in_bad_samples(self):
        places = {
            "decimal_comma": r":5:12: error: .*comma",
            "misspelt": r":3:3: error: .*diameter",
            "nan": r":3:12: error: ",
            "unknown_thread": r":2:8: error: .*nothread",
            "version": r":1:8: error: ",
            "no_end": r":\d+:\d+: error: .*end",
            "short_grid": r":\d+:\d+: error: ",
            "zero_length": r":\d+:\d+: error: ",
            "binary": r":1:1: error: ",
            "edit_joint": r":10:1: error: .*no joint 4",
            "edit_weight": r":12:1: error: .*off the plane",
            "piece_gap": r":5:3: error: line 'side' starts at",
            "piece_open": r":6:3: error: .*not closed",
            "piece_crossing": r":10:3: error: .*'a' and line 'c' meet at \(10, 10\)",
            "piece_flat": r":3:1: error: .*no area",
            "weave_pitch": r":5:1: error: the cloth is jammed: .* Remedies: `pitch 0\.67[0-9]*` for the warp",
            "weave_state": r":8:9: error: unknown state 'finshed'; did you mean 'finished'",
            "weave_ragged": r":10:5: error: .*3 signs",
            "lapping_open": r":6:17: error: .*does not close",
            "loops_1e9": r":5:1: error: .*31623 yarns .*8e\+09 data points, about 2.4e\+04 GB",
            "empty": r":1:1: error: ",
        }
        self.assertEqual(sorted(places), sorted(path.stem for path in BAD.glob("*.txt")))
        for name, pattern in places.items():
            with self.subTest(name):
                self.failed(BAD / f"{name}.txt", f"(?m)^{BAD}/{name}.txt{pattern}")

    def test_missing(self):
        self.failed("nowhere.txt", "^nowhere.txt: error: cannot open: No such file or directory")
        self.failed("no*where.txt", "no file matches")

    def test_unknown_format(self):
        unknown = self.folder / "x.bin"
        unknown.write_bytes(bytes(range(256)))
        self.failed(unknown, "x.bin: error: of no known format")

    def test_an_empty_folder(self):
        (self.folder / "empty").mkdir()
        self.failed(self.folder / "empty", "empty: error: no readable file")

    def test_a_folder_that_cannot_be_entered(self):
        if os.geteuid() != 0:
            closed = self.folder / "in" / "closed"
            closed.mkdir(parents=True)
            closed.chmod(0)
            self.addCleanup(closed.chmod, 0o700)
            self.failed(closed, "cannot read the folder: Permission denied")
            return
        program = self.folder / "selvage"  # root may read everything: be someone else
        shutil.copy(PROGRAM, program)
        inside = self.folder / "in"
        (inside / "closed").mkdir(parents=True)
        shutil.copy(GRID, inside / "grid.txt")
        (inside / "grid.txt").chmod(0o644)
        (inside / "closed").chmod(0)
        out = self.folder / "out"
        out.mkdir()
        for path in (self.folder, inside):
            path.chmod(0o755)
        out.chmod(0o777)
        done = subprocess.run(
            [program, "convert", inside, "--to", "iges", "-o", out],
            env=environment(),
            text=True,
            capture_output=True,
            user=65534,
            group=65534,
            extra_groups=[],
        )
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stderr, "in/closed: error: cannot read the folder: Permission denied")
        self.assertEqual(list(files_below(out)), ["grid.igs"])


class Text(Case):
    def test_windows_lines_and_mark(self):
        plain = pathlib.Path(GRID).read_bytes()
        windows = self.folder / "plain4_grid.txt"
        windows.write_bytes(b"\xef\xbb\xbf" + plain.replace(b"\n", b"\r\n"))
        self.succeeds("convert", windows, "-o", self.folder / "w.igs")
        self.succeeds("convert", GRID, "-o", self.folder / "u.igs")
        drop_names = lambda name: [line for line in (self.folder / name).read_text().splitlines() if line[72] in "DP"]
        self.assertEqual(drop_names("w.igs"), drop_names("u.igs"))

    def test_text_written_and_read_gives_the_same_surfaces(self):
        for sample in (GRID, PATH, RING):
            with self.subTest(sample):
                self.succeeds("convert", sample, "-o", self.folder / "again.txt")
                first = self.succeeds("convert", sample, "--to", "iges", "-o", "-").stdout.splitlines()
                second = self.succeeds(
                    "convert", self.folder / "again.txt", "--to", "iges", "-o", "-"
                ).stdout.splitlines()
                self.assertEqual(
                    [line for line in first if line[72] == "P"], [line for line in second if line[72] == "P"]
                )


if __name__ == "__main__":
    unittest.main()
