"""The program under test, and a folder to work in."""

import os
import pathlib
import pty
import shutil
import subprocess
import tempfile
import unittest

PROGRAM = os.path.abspath(os.environ.get("SELVAGE", "build/bin/selvage"))
ROOT = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
GRID = str(SAMPLES / "plain4_grid.txt")
PATH = str(SAMPLES / "plain4_path.txt")
RING = str(SAMPLES / "ring.txt")
BAD = SAMPLES / "bad"

# The library of pages, which npm gives (scripts/setup): where it is not, the program says so, and there is no page to test.
HAS_PAGES = (pathlib.Path(PROGRAM).parent / "three.module.min.js").exists()
NO_PAGES = "three.js is not there: no pages are made"

# A fabric that is made in a moment.
ROD = """fabric 1
title "{title}"
units mm
thread rod
  tex 100
  density 2
  section circle 0.4
end
yarn one rod
  path chord
    0 0 0
    1 0 {height}
    2 0 0
  end
end
"""


def is_page(line):
    """Does the command write a page that needs three.js? Those of reports do not."""
    return line.endswith(".html") and " view " in line


def environment(**more):
    # One moment for all files, so that two runs can be compared byte for byte.
    return {**os.environ, "SOURCE_DATE_EPOCH": "1700000000", "LC_ALL": "C", **more}


def run(*arguments, **options):
    """Runs the program; the result has returncode, stdout and stderr as text."""
    options = {"env": environment(), "stdin": subprocess.DEVNULL, **options}
    if "input" in options:
        del options["stdin"]
    return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, errors="replace", **options)


def start(*arguments, **options):
    options = {"env": environment(), "stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE,
               "text": True, **options}
    return subprocess.Popen([PROGRAM, *map(str, arguments)], **options)


def terminal():
    """The two sides of a new terminal; where the machine has none (a bare change of root) the test is skipped."""
    try:
        return pty.openpty()
    except OSError as error:
        raise unittest.SkipTest(f"no terminal: {error}") from error


def children_of(pid):
    """The processes that `pid` has started and that are still there."""
    try:
        return [int(word) for word in pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except FileNotFoundError:
        return []


def seconds_of(pid):
    """Of processor time; 0 of a process that is gone."""
    try:
        fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    except (FileNotFoundError, ProcessLookupError):
        return 0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def files_below(folder):
    """Every file below the folder, hidden ones too, with its bytes, by its path inside it."""
    folder = pathlib.Path(folder)
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


class Case(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="selvage-test-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.out = self.folder / "out"

    def succeeds(self, *arguments, **options):
        done = run(*arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def fails(self, code, *arguments, **options):
        """Runs, expects this exit code, and gives the messages."""
        done = run(*arguments, **options)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}\n{done.stderr}")
        return done.stderr
