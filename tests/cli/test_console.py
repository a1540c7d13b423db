"""Standard error: progress for programs, and colours for people alone."""

import json
import os
import re
import subprocess
import unittest

from program import BAD, Case, PROGRAM, ROD, environment, run, terminal


def objects(text):
    return [json.loads(line) for line in text.splitlines() if line.startswith("{")]


class Progress(Case):
    def rods(self, count):
        paths = [self.folder / f"rod {i}.txt" for i in range(count)]
        for i, path in enumerate(paths):
            path.write_text(ROD.format(title=f"rod {i}", height=0.1 * i))
        return paths

    def test_objects(self):
        done = self.succeeds("convert", *self.rods(5), "--to", "iges", "-o", self.out, "-j", "2", "--progress", "json")
        found = objects(done.stderr)
        self.assertGreaterEqual(len(found), 2)
        first, last = found[0], found[-1]
        self.assertEqual((first["progress"], first["done"], first["inputs"]), (0, 0, 5))
        self.assertEqual((last["progress"], last["done"], last["failed"], last["inputs"]), (1, 5, 0, 5))
        self.assertEqual(last["seconds_left"], 0)
        self.assertNotIn("seconds_left", first)
        for before, after in zip(found, found[1:]):
            self.assertLessEqual(before["done"], after["done"])
            self.assertLessEqual(before["seconds"], after["seconds"])
        # What is no object is what would be there anyway.
        rest = [line for line in done.stderr.splitlines() if not line.startswith("{")]
        self.assertEqual(len(rest), 1)
        self.assertIn("5 of 5 inputs done", rest[0])

    def test_failures_are_counted(self):
        done = run("convert", *self.rods(2), BAD / "misspelt.txt", "--to", "iges", "-o", self.out, "--progress", "json")
        self.assertEqual(done.returncode, 1)
        last = objects(done.stderr)[-1]
        self.assertEqual((last["done"], last["failed"], last["progress"]), (3, 1, 1))

    def test_quiet_leaves_the_objects(self):
        done = self.succeeds("-q", "check", *self.rods(1), "--progress", "json")
        self.assertEqual(len(objects(done.stderr)), len(done.stderr.splitlines()))
        self.assertEqual(self.succeeds("check", "-q", *self.rods(1), "--progress", "auto").stderr, "")

    def test_company(self):
        self.assertIn("--no-progress", self.fails(2, "check", *self.rods(1), "--progress", "json", "--no-progress"))
        self.assertIn("auto or json", self.fails(2, "check", *self.rods(1), "--progress", "xml"))

    def test_the_same_outputs(self):
        [path] = self.rods(1)
        self.succeeds("convert", path, "--to", "iges,step", "-o", self.out)
        self.succeeds("convert", path, "--to", "iges,step", "-o", self.folder / "again", "--progress", "json")
        for name in ("rod 0.igs", "rod 0.stp"):
            self.assertEqual((self.out / name).read_bytes(), (self.folder / "again" / name).read_bytes())


class Colors(Case):
    def on_terminal(self, *arguments, **variables):
        """Standard error of a run whose standard error is a terminal."""
        master, slave = terminal()
        env = {name: value for name, value in environment(TERM="xterm").items() if name != "NO_COLOR"}
        process = subprocess.Popen(
            [PROGRAM, *map(str, arguments)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=slave,
            env={**env, **variables},
        )
        os.close(slave)
        text = b""
        try:
            while block := os.read(master, 65536):
                text += block
        except OSError:  # Linux says so where nobody holds the other side
            pass
        os.close(master)
        process.wait()
        return text.decode().replace("\r\n", "\n")

    def test_errors_are_red_at_a_terminal_only(self):
        command = ("convert", BAD / "misspelt.txt", "-o", self.out, "--no-progress", "-q")
        plain = run(*command).stderr
        self.assertIn(": error: ", plain)
        self.assertNotIn("\x1b", plain)
        shown = self.on_terminal(*command)
        self.assertIn("\x1b[1;31merror:\x1b[0m", shown)
        self.assertEqual(re.sub(r"\x1b\[[\d;]*m", "", shown), plain)
        for variables in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
            self.assertEqual(self.on_terminal(*command, **variables), plain)
        self.assertEqual(self.on_terminal(*command, NO_COLOR=""), shown)

    def test_of_the_command_line(self):
        self.assertEqual(self.on_terminal("convrt"), run("convrt").stderr.replace("error:", "\x1b[1;31merror:\x1b[0m"))

    def test_warnings(self):
        text = self.folder / "warned.txt"
        text.write_text(
            ROD.format(title="x", height=0).replace("  path chord", "  tangent start 1 0 0\n  closed\n  path chord")
        )
        shown = self.on_terminal("info", text)
        self.assertIn("\x1b[1;35mwarning:\x1b[0m", shown)

    def test_a_message_is_coloured_once(self):
        # A name with "error: " in it is not what says that it is one.
        odd = self.folder / "x: error: y.txt"
        shown = self.on_terminal("info", odd)
        self.assertEqual(shown.count("\x1b[1;31m"), 1)


if __name__ == "__main__":
    unittest.main()
