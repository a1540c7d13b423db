"""Every command of the documents works as printed."""

import os
import pathlib
import re
import shutil
import subprocess
import unittest

from program import Case, PROGRAM, ROOT, environment, run


def commands(document):
    """(command, expected exit code) of each line of the document's `sh` blocks; "# exit N" says a code other than 0."""
    for block in re.findall(r"```sh\n(.*?)```", (ROOT / document).read_text(), re.DOTALL):
        for line in block.splitlines():
            code = re.search(r"# exit (\d+)$", line)
            yield line, int(code[1]) if code else 0


class Documents(Case):
    def setUp(self):
        super().setUp()
        shutil.copytree(ROOT / "samples", self.folder / "samples")
        programs = self.folder / "programs"
        programs.mkdir()
        os.symlink(PROGRAM, programs / "selvage")
        self.path = f"{programs}:{os.environ['PATH']}"

    def check(self, document):
        count = 0
        for line, code in commands(document):
            if line == "./scripts/test":
                continue  # this is what is running
            line = line.replace("./scripts/run", "selvage", 1)
            with self.subTest(line):
                self.assertTrue(line.startswith("selvage "), "only commands of selvage are expected here")
                done = subprocess.run(["sh", "-c", line], cwd=self.folder, env=environment(PATH=self.path),
                                      capture_output=True, text=True)
                self.assertEqual(done.returncode, code, done.stderr)
            count += 1
        self.assertGreater(count, 2)

    def test_readme(self):
        self.check("README.md")

    def test_samples(self):
        self.check("samples/README.md")
        self.check("samples/ci/README.md")

    def test_readme_opens_with_the_two_commands(self):
        first = (ROOT / "README.md").read_text().split("```sh\n")[1].split("```")[0]
        self.assertEqual(first, "./scripts/run convert samples/plain4_grid.txt -o out\n./scripts/test\n")

    def test_table_of_formats(self):
        table = run("formats").stdout
        self.assertIn(f"```\n{table}```", (ROOT / "README.md").read_text())

    def test_every_sample_is_described(self):
        text = (ROOT / "samples" / "README.md").read_text()
        patterns = re.findall(r"`([\w*-]+\.txt)`", text)
        for path in sorted((ROOT / "samples").glob("*.txt")):
            self.assertTrue(any(path.match(pattern) for pattern in patterns), path.name)

    def test_options_of_the_help_are_in_the_readme(self):
        text = (ROOT / "README.md").read_text()
        for command in ("convert", "relax", "check", "mesh", "diff", "roundtrip", "info", "edit", "view"):
            for option in re.findall(r"^\s+(?:-\w,)?(--[\w-]+)", run(command, "--help").stdout, re.MULTILINE):
                if option not in ("--help", "--output", "--verbose"):  # -h, -o, -v
                    self.assertIn(option, text, command)

    def test_formats_are_named_in_their_own_folders_alone(self):
        names = re.findall(r"^  (\w+)", run("formats").stdout, re.MULTILINE)[1:]
        self.assertGreater(len(names), 10)
        for path in sorted((*(ROOT / "src/pipeline").iterdir(), *(ROOT / "src/cli").iterdir())):
            for name in names:
                self.assertNotIn(f'"{name}"', path.read_text(), path.name)


if __name__ == "__main__":
    unittest.main()
