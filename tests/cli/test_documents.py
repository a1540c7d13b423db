"""Every command of the documents works as printed, and nothing is said in two of them."""

import os
import re
import shutil
import subprocess
import unittest

from program import Case, HAS_PAGES, PROGRAM, ROOT, environment, is_page, run


def commands(document):
    """(command, expected exit code) of each line of the document's `sh` blocks; "# exit N" says a code other than 0."""
    for block in re.findall(r"```sh\n(.*?)```", (ROOT / document).read_text(), re.DOTALL):
        for line in block.splitlines():
            code = re.search(r"# exit (\d+)$", line)
            yield line, int(code[1]) if code else 0


def without_code(text):
    return re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)


def headings(text):
    """The anchors of a page, as GitHub makes them."""
    lines = re.findall(r"^#+ (.*)$", without_code(text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", line.lower()).replace(" ", "-") for line in lines}


def saved_texts(document):
    """(name, text) of each block that the document says to save as a file."""
    return re.findall(r"ave\s+it\s+as\s+`([\w.]+)`:\n\n```\n(.*?)```", (ROOT / document).read_text(), re.DOTALL)


def pages():
    """Every page for users, by its place."""
    return sorted(
        str(path.relative_to(ROOT))
        for folder in ("src/cli", "formats", "samples", "scripts")
        for path in (ROOT / folder).rglob("*.md")
    ) + ["README.md"]


class Documents(Case):
    def setUp(self):
        super().setUp()
        shutil.copytree(ROOT / "samples", self.folder / "samples")
        programs = self.folder / "programs"
        programs.mkdir()
        os.symlink(PROGRAM, programs / "selvage")
        homogenize = programs / "selvage-homogenize"
        homogenize.write_text(f'#!/bin/sh\nexec {ROOT}/scripts/homogenize "$@"\n')
        homogenize.chmod(0o755)
        self.path = f"{programs}:{os.environ['PATH']}"

    def check(self, document):
        """Runs the commands in a folder that holds the samples and the texts that the document says to save."""
        for name, text in saved_texts(document):
            (self.folder / name).write_text(text)
        count = 0
        for line, code in commands(document):
            if line == "./scripts/test":
                continue  # this is what is running
            line = line.replace("./scripts/run", "selvage", 1)
            line = re.sub(r"^scripts/", f"{ROOT}/scripts/", line)
            with self.subTest(line):
                self.assertRegex(
                    line,
                    f"^(selvage|selvage-homogenize|ccx|{ROOT}/scripts/homogenize) ",
                    "no other commands are expected here",
                )
                done = subprocess.run(
                    ["sh", "-c", line], cwd=self.folder, env=environment(PATH=self.path), capture_output=True, text=True
                )
                if is_page(line) and not HAS_PAGES:
                    self.assertIn("three.js", done.stderr)
                else:
                    self.assertEqual(done.returncode, code, done.stderr)
            count += 1
        self.assertGreater(count, 1)

    def test_readme(self):
        self.check("README.md")
        self.assertLess(len((ROOT / "README.md").read_bytes()), 9000)

    def test_pages_of_the_command_line(self):
        for page in sorted((ROOT / "src/cli").glob("*.md")):
            with self.subTest(page.name):
                self.check(page.relative_to(ROOT))

    def test_samples(self):
        self.check("samples/README.md")
        self.check("samples/ci/README.md")

    def test_readme_opens_with_the_two_commands(self):
        first = (ROOT / "README.md").read_text().split("```sh\n")[1].split("```")[0]
        self.assertEqual(first, "./scripts/run convert samples/plain4_grid.txt -o out\n./scripts/test\n")

    def test_table_of_formats(self):
        table = run("formats").stdout
        self.assertIn(f"```\n{table}```", (ROOT / "formats" / "README.md").read_text())

    def test_every_sample_is_described(self):
        text = (ROOT / "samples" / "README.md").read_text()
        patterns = re.findall(r"`([\w*-]+\.txt)`", text)
        for path in sorted((ROOT / "samples").glob("*.txt")):
            self.assertTrue(any(path.match(pattern) for pattern in patterns), path.name)

    def test_every_command_is_on_a_page_that_is_checked(self):
        checked = {
            "README.md",
            "samples/README.md",
            "samples/ci/README.md",
            "scripts/packaging/README.md",  # by test_install.py
            *(str(page.relative_to(ROOT)) for page in (ROOT / "src/cli").glob("*.md")),
        }
        for page in pages():
            if list(commands(page)):
                self.assertIn(page, checked)

    def test_links_lead_to_pages_and_headings(self):
        for page in pages():
            for target in re.findall(r"\]\(([^)\s]+)\)", (ROOT / page).read_text()):
                if target.startswith("http"):
                    continue
                name, _, heading = target.partition("#")
                path = ROOT / page if not name else (ROOT / page).parent / name
                with self.subTest(f"{page}: {target}"):
                    self.assertTrue(path.exists())
                    if heading:
                        self.assertIn(heading, headings(path.read_text()))

    def test_no_sentence_stands_on_two_pages(self):
        where = {}
        for page in pages():
            text = without_code((ROOT / page).read_text())
            for sentence in set(re.split(r"(?<=[.:;])\s+|\n\n|\|", re.sub(r"(?<!\n)\n(?!\n)", " ", text))):
                if len(sentence.split()) >= 9:
                    self.assertNotIn(sentence, where, f"{page} says what {where.get(sentence)} says: {sentence}")
                    where[sentence] = page

    def test_options_of_the_help_are_on_the_pages(self):
        text = "".join(page.read_text() for page in (ROOT / "src/cli").glob("*.md"))
        for command in ("convert", "relax", "check", "mesh", "diff", "roundtrip", "info", "edit", "view", "report"):
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
