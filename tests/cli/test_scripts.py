"""Scripts: those that people call first tell how far they are where nobody watches a terminal; scripts/homogenize reads decks of
anyone; scripts/cluster/selvage-slurm takes files of any name."""

import json
import os
import shutil
import subprocess
import sys
import unittest

from program import Case, PROGRAM, ROD, ROOT, SAMPLES, environment

PYTHON = "/usr/bin/python3" if os.path.exists("/usr/bin/python3") else sys.executable
HAS_NUMPY = subprocess.run([PYTHON, "-c", "import numpy"], capture_output=True).returncode == 0

# Stands for ninja: half way, until somebody opens the pipe `go`.
NINJA = """#!/bin/sh
echo "[7/20] Building something"
read line < "$SELVAGE_BUILD/go"
exit 0
"""


class Progress(Case):
    def test_a_build_is_not_silent(self):
        programs, build = self.folder / "programs", self.folder / "build"
        for path, text in ((programs / "ninja", NINJA), (build / "bin" / "selvage", "#!/bin/sh\necho run: $*\n"),
                           (build / "build.ninja", "")):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            path.chmod(0o755)
        os.mkfifo(build / "go")
        running = subprocess.Popen([ROOT / "scripts" / "run", "formats"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   text=True, env=environment(PATH=f"{programs}:{os.environ['PATH']}", SELVAGE_BUILD=str(build)))
        self.addCleanup(running.kill)
        self.assertEqual(running.stderr.readline(), "building: [7/20]\n")
        (build / "go").write_text("go\n")
        out, rest = running.communicate()
        self.assertEqual((running.returncode, out), (0, "run: formats\n"), rest)


class Decks(Case):
    """Decks that no program wrote: an error with its place, and no file is read that does not stand beside them."""

    def setUp(self):
        super().setUp()
        if not (HAS_NUMPY and shutil.which("ccx")):
            self.skipTest("NumPy or CalculiX is not there")
        self.deck = self.folder / "in" / "cell.inp"
        self.deck.parent.mkdir()
        self.succeeds("mesh", SAMPLES / "cell_straight.txt", "--matrix", "--periodic", "--voxel", "6", "-o", self.deck, "--quiet")
        self.text = self.deck.read_text()

    def homogenize(self, *options):
        return subprocess.run([PYTHON, ROOT / "scripts" / "homogenize.py", self.deck, *options], capture_output=True, text=True, env=environment())

    def refused(self, text, words, *options):
        self.deck.write_text(text)
        for solver in ("direct", "iterative"):
            done = self.homogenize("--solver", solver, *options)
            self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
            self.assertRegex(done.stderr, f"(?m)^homogenize: .*{words}")
            self.assertNotIn("Traceback", done.stderr)

    def line_behind(self, keyword):
        return self.text.split(keyword, 1)[1].split("\n")[1]

    def test_a_good_deck(self):
        for solver in ("direct", "iterative"):
            done = self.homogenize("--solver", solver)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_bad_numbers(self):
        node, element, elastic = (self.line_behind(keyword) for keyword in ("*NODE", "*ELEMENT", "*ELASTIC"))
        for old, new, words in ((node, "x, y", r"cell\.inp:\d+: \*NODE.* cannot be read"), (node, "1, nan, 0, 0", r"\*NODE.*nan is no number"),
                                (node, "999999999999999, 0, 0, 0", ""), (element, element.rsplit(",", 1)[0], r"\*ELEMENT.* an element of"),
                                (element, element.rsplit(",", 1)[0] + ", 77777777", "(?:.*77777777|CalculiX stopped)"),
                                (elastic, "0, 0", r"\*ELASTIC.* cannot be read"), (elastic, "1e999", "is no number"),
                                ("*EQUATION\n", "*EQUATION\n-2\n", r"\*EQUATION.* an equation of -2 terms"), ("*STEP", "*STPE", "STPE is no keyword"),
                                ("MATERIAL=", "MATERIAL=no", "missing|stopped"), ("** Cell: ", "** Cell: x ", "cannot be read"),
                                ("*NODE\n", "*NSET, NSET=A\n1\n" + "*NSET, NSET=A\n A, A\n" * 40 + "*NODE\n", "a set of more than 100000000 numbers")):
            with self.subTest(new[:40]):
                self.assertIn(old, self.text)
                self.refused(self.text.replace(old, new, 1), words)

    def test_other_files(self):
        secret = self.folder / "secret.inp"
        secret.write_text("*NODE\nsecret\n")
        (self.deck.parent / "link.inp").symlink_to(secret)
        (self.deck.parent / "round.inp").symlink_to("round.inp")
        os.mkfifo(self.deck.parent / "pipe.inp")
        (self.deck.parent / "self.inp").write_text("*INCLUDE, INPUT=self.inp\n")
        for line, words in (("*INCLUDE, INPUT=/etc/passwd", "is not in the folder of the deck"), ("*INCLUDE, INPUT=../secret.inp", "is not in the folder"),
                            ("*include,input=link.inp", "is not in the folder"), ("*INCLUDE, INPUT=round.inp", "no such file"),
                            ("*INCLUDE, INPUT=cell.inp", "is included already"), ("*INCLUDE, INPUT=self.inp", "is included already"),
                            ("*INCLUDE, INPUT=gone.inp", "no regular file"), ("*INCLUDE, INPUT=pipe.inp", "no regular file"),
                            ("* I N CLUDE, INPUT=/etc/passwd", r"cell\.inp:1: \*INCLUDE is no keyword"), (" *RESTART, READ", r"\*RESTART is no keyword"),
                            ("*NSET, NSET=A, INPUT=/etc/passwd", "names another file"), ("*MATERIAL, NAME=@LIB", "names another file")):
            with self.subTest(line):
                self.refused(f"{line}\n{self.text}", words)
        self.deck.write_bytes(b"\xff\xfe" + self.text.encode())
        self.assertIn("is not UTF-8", self.homogenize().stderr)

    def test_a_mesh_beside_the_deck(self):
        head, rest = self.text.split("*NODE\n", 1)
        (self.deck.parent / "cell_mesh.inp").write_text("*NODE\n" + rest)
        self.deck.write_text(head + "*INCLUDE, INPUT=cell_mesh.inp\n")
        self.assertEqual(self.homogenize().returncode, 0)

    def test_limits_of_calculix(self):
        program = self.folder / "ccx"
        program.write_text("#!/bin/sh\nexec sleep 1000\n")
        program.chmod(0o755)
        done = self.homogenize("--solver", "direct", "--ccx", program, "--timeout", "0.2")
        self.assertEqual((done.returncode, done.stderr), (1, "homogenize: CalculiX was stopped: not done within its 0.2 s; --timeout gives it more\n"))
        program.write_text("#!/bin/sh\nulimit -v\n")
        self.assertIn(f"CalculiX stopped: {2000 * 1024}\n", self.homogenize("--solver", "direct", "--ccx", program, "--memory", "2000").stderr)


# Runs the jobs of an array at once, one after the other.
SBATCH = """#!/bin/sh
for word; do
  case "$word" in --array=*) array=${word#--array=} ;; --chdir=*) folder=${word#--chdir=} ;; esac
  before=$script; script=$last; last=$word
done
cd "$folder" || exit 1
for shard in $(seq "${array%-*}" "${array#*-}"); do
  SLURM_ARRAY_JOB_ID=7 SLURM_ARRAY_TASK_ID=$shard "$before" --task "$last" > "$FAKE_SLURM/$shard.txt" 2>&1
done
echo 7
"""


class Slurm(Case):
    """Without Slurm: what stands for it does each job at once. tests/cluster has a real one."""

    def setUp(self):
        super().setUp()
        self.programs = self.folder / "programs"
        self.programs.mkdir()
        for name, text in (("sbatch", SBATCH), ("squeue", "#!/bin/sh\n"), ("scancel", "#!/bin/sh\n"), ("scontrol", "#!/bin/sh\necho MaxArraySize = 1001\n")):
            (self.programs / name).write_text(text)
            (self.programs / name).chmod(0o755)

    def drive(self, *arguments):
        return subprocess.run([ROOT / "scripts" / "cluster" / "selvage-slurm", *arguments, "-o", "out", "--selvage", PROGRAM, "--per-job", "2", "--", "--to", "iges"],
                              cwd=self.folder, capture_output=True, text=True, errors="surrogateescape", stdin=subprocess.DEVNULL,
                              env=environment(PATH=f"{self.programs}:{os.environ['PATH']}", FAKE_SLURM=str(self.programs)))

    def test_names_that_are_not_utf8(self):
        inside = os.fsencode(self.folder / "in")
        os.mkdir(inside)
        for name in (b"a\xff.txt", b"b\xe9t\xe9.txt", b"c\x85d.txt", "d\u2028e.txt".encode(), b"plain.txt"):
            with open(os.path.join(inside, name), "w") as file:
                file.write(ROD.format(title="rod", height=1))
        (self.folder / "list").write_bytes(b"".join(b"in/" + name + b"\r\n" for name in sorted(os.listdir(inside))))
        for words in (("in",), ("@list", "--afresh")):
            done = self.drive(*words)
            self.assertEqual(done.returncode, 0, done.stderr)
            report = json.loads((self.folder / "out" / "report.json").read_text())
            self.assertEqual(report["counts"]["inputs"], 5)
            self.assertEqual(report["counts"]["failed"], 0)
        self.assertEqual(len([name for name in os.listdir(os.fsencode(self.folder / "out")) if name.endswith(b".igs")]), 5)
        os.rename(os.path.join(inside, b"a\xff.txt"), os.path.join(inside, b"z\xfe.txt"))
        done = self.drive("in")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("the inputs were named in another way before", done.stderr) if "named" in done.stderr else self.assertIn("1 new", done.stderr)


if __name__ == "__main__":
    unittest.main()
