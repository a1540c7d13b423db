"""The example of samples/ci works as it stands: as a script, in the workflow, under CTest; and its failures can be read."""

import os
import re
import shutil
import subprocess
import unittest
import xml.etree.ElementTree as ElementTree

from program import Case, PROGRAM, ROOT, SAMPLES, environment


class Example(Case):
    def setUp(self):
        super().setUp()
        self.copy = self.folder / "project"
        shutil.copytree(SAMPLES / "ci", self.copy)
        programs = self.folder / "programs"
        programs.mkdir()
        os.symlink(PROGRAM, programs / "selvage")
        self.env = environment(PATH=f"{programs}:{os.environ['PATH']}")

    def sh(self, command):
        return subprocess.run(["sh", "-e", "-c", command], cwd=self.copy, env=self.env, capture_output=True, text=True)

    def coarser(self):
        """What a colleague does: another yarn in the cuff."""
        text = self.copy / "fabrics" / "cuff.txt"
        before = text.read_text()
        self.assertIn("diameter 0.5\n", before)
        text.write_text(before.replace("diameter 0.5\n", "diameter 0.52\n"))

    def test_the_script(self):
        done = self.sh("./check.sh")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(done.stdout.count("\nequal: "), 2)
        suite = ElementTree.parse(self.copy / "roundtrip.xml").getroot().find("testsuite")
        self.assertEqual((suite.get("failures"), suite.get("errors")), ("0", "0"))
        self.assertEqual(len(suite), 8)

    def test_a_failure_can_be_read(self):
        self.coarser()
        done = self.sh("./check.sh")
        self.assertEqual(done.returncode, 1)
        shown = re.search(r"```\n(cuff:\n.*?)```", (self.copy / "README.md").read_text(), re.DOTALL)[1]

        # Another machine may round another way: the words are compared, not the digits.
        def words(text):
            return re.sub(r"-?\d+\.\d+", "#", text)

        self.assertEqual(words(done.stdout)[: len(words(shown))], words(shown))

    def test_the_workflow(self):
        workflow = (self.copy / "github" / "fabrics.yml").read_text()
        commands = re.findall(r"^ +run: (?!\|)(.+)$", workflow, re.MULTILINE)
        self.assertEqual(len(commands), 1)
        for command in commands:
            done = self.sh(command)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        kept = re.search(r"^ +path: (roundtrip\S+)$", workflow, re.MULTILINE)[1]
        self.assertTrue((self.copy / kept).exists())
        for script in re.findall(r"^ +selvage/(scripts/\S+)", workflow, re.MULTILINE):
            self.assertTrue(os.access(ROOT / script, os.X_OK), script)
        self.coarser()
        self.assertNotEqual(self.sh(commands[0]).returncode, 0)

    def test_ctest(self):
        configured = self.sh("cmake -S . -B build")
        self.assertEqual(configured.returncode, 0, configured.stdout + configured.stderr)
        passed = self.sh("ctest --test-dir build --output-on-failure")
        self.assertEqual(passed.returncode, 0, passed.stdout + passed.stderr)
        self.assertIn("100% tests passed, 0 tests failed out of 3", passed.stdout)
        self.coarser()
        failed = self.sh("ctest --test-dir build --output-on-failure")
        self.assertNotEqual(failed.returncode, 0)
        self.assertIn("67% tests passed, 1 tests failed out of 3", failed.stdout)
        self.assertRegex(failed.stdout, r"reshaped: yarn 'warp_1', .* by \S+( to \S+)? mm")
        self.assertRegex(failed.stdout, r"different: 4 reshaped, all by about .*; the other 0 equal")


if __name__ == "__main__":
    unittest.main()
