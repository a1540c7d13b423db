"""`selvage explain` and `selvage help`: no word of the language without an explanation, and none that the parser does not know."""

import json
import re
import unittest

from program import Case, HAS_PAGES, ROOT, is_page, run

TXT = ROOT / "formats" / "txt"
STRANGE = "qqqqqqqqqqqq"  # near to no word


def source(name):
    return (TXT / name).read_text()


def array(text, name):
    """The words in quotes of `constexpr ... name ... = {...};`."""
    body = re.search(rf"constexpr [^;=]*\b{name}\b[^;=]*=?\s*\{{(.*?)\}};", text, re.DOTALL)[1]
    return re.findall(r'"([^"]+)"', body)


class Explain(Case):
    @classmethod
    def setUpClass(cls):
        cls.known = json.loads(run("--generate", "json-usage").stdout)
        cls.blocks = {}  # of the program's own table: the statements of each block, the lines that open blocks
        cls.opening = {}
        for lesson in cls.known["language"]["statements"]:
            for block in lesson["blocks"]:
                cls.blocks.setdefault(block, set()).add(lesson["word"])
            if lesson["opens_block"]:
                for block in lesson["blocks"]:
                    cls.opening.setdefault(lesson["word"], (block, lesson["example"]))

    def words_of_the_parser(self, block):
        """What the parser says that it knows in such a block, where it meets a word that it does not know."""
        lines, at = [], block
        while at != "file":
            outer, example = self.opening[at]
            lines.insert(0, example)
            at = outer
        path = self.folder / "text.txt"
        path.write_text("\n".join(["fabric 1", *lines, STRANGE, *["end"] * len(lines), ""]))
        message = run("info", path).stderr
        found = re.search(rf"unknown word '{STRANGE}'.*; known: (.*)", message)
        self.assertIsNotNone(found, f"{block}: {message}")
        return set(re.sub(r" \(yarn '.*'\)$", "", found[1]).split(", ")) - {"end"}

    def test_statements_are_those_of_the_parser(self):
        self.assertGreater(len(self.blocks), 12)
        for block, words in self.blocks.items():
            if block != "every":
                with self.subTest(block):
                    self.assertEqual(words, self.words_of_the_parser(block))

    def test_every_block_of_the_parser_is_in_the_table(self):
        # Those without words of their own have rows alone.
        rows = {"outline", "chart", "mandrel", "points", "draft", "polygon"}
        kinds = set()
        for path in TXT.glob("*.cpp"):
            kinds |= set(re.findall(r'read_block\("(\w+)"', path.read_text()))
        self.assertIn("path", kinds)
        self.assertEqual(kinds - rows - set(self.blocks), set())
        for block in set(self.opening) - rows:
            self.assertIn(block, self.blocks)

    def test_examples_are_read(self):
        """Each example stands where the table says, and its line is no error."""
        for lesson in self.known["language"]["statements"]:
            for block in lesson["blocks"]:
                if block in ("every",):
                    continue
                lines, at = [], block
                while at != "file":
                    outer, example = self.opening[at]
                    lines.insert(0, example)
                    at = outer
                path = self.folder / "text.txt"
                begin = [] if lesson["word"] == "fabric" else ["fabric 1"]
                path.write_text(
                    "\n".join([*begin, *lines, lesson["example"], *["end"] * (len(lines) + lesson["opens_block"]), ""])
                )
                line = len(begin) + len(lines) + 1
                # What the line lacks around it (a thread, rows) is another matter than how it is written.
                bad = [
                    m
                    for m in run("info", path).stderr.splitlines()
                    if re.search(
                        rf"text.txt:{line}:\d+: error: (unknown (?!thread|material|yarn|outline|block|piece)|"
                        r".*(is|are) missing|.*is expected|.*nothing|.*has to be)",
                        m,
                    )
                ]
                with self.subTest(block=block, word=lesson["word"]):
                    self.assertEqual(bad, [])

    def explained(self, word):
        done = run("explain", word)
        self.assertEqual(done.returncode, 0, f"'{word}' is not explained: {done.stderr}")
        return done.stdout

    def test_fixed_words_of_the_parser(self):
        words = re.findall(r'\{"([^"]+)",', source("words.h"))
        words += re.findall(r'_word = "([^"]+)"', source("words.h"))
        self.assertGreater(len(words), 90)
        for path in TXT.glob("*.cpp"):
            text = path.read_text()
            words += re.findall(r'(?:expect|is_word)\("([^"]+)"\)', text)
            words += [
                w
                for w in re.findall(r'same_word\([^()]*(?:\([^()]*\))?[^()"]*, "([^"]+)"\)', text)
                if w not in ("nan", "inf", "infinity")
            ]  # numbers that are none
            for line in re.findall(r"std::array<Word<\w+>, \d+> \w+\{\{(.*?)\}\};", text):
                words += re.findall(r'\{"([^"]+)",', line)
        for word in ("levels", "slack", "ease", "isotropic", "left"):
            self.assertIn(word, words)
        known = {word.lower() for word in self.known["explain"]}
        self.assertEqual({word for word in words if word.lower() not in known}, set())

    def test_words_that_no_param_may_have(self):
        text = source("scope.cpp")
        known = {word.lower() for word in self.known["explain"]}
        words = array(text, "keywords") + array(text, "functions")
        self.assertGreater(len(words), 110)
        self.assertEqual({w for w in words if w.lower() not in known} - {"nan", "inf", "infinity"}, set())

    def test_no_value_that_its_statement_does_not_have(self):
        statements = {}
        for lesson in self.known["language"]["statements"]:
            statements.setdefault(lesson["word"], "")
            statements[lesson["word"]] += " " + lesson["usage"] + " " + lesson["meaning"]
        for value in self.known["language"]["values"]:
            for statement in value["statements"]:
                with self.subTest(value["word"], statement=statement):
                    self.assertRegex(statements[statement], rf"(?<![\w-]){re.escape(value['word'])}(?![\w-])")

    def test_what_is_said(self):
        twist = self.explained("TWIST")
        for part in (
            "twist TURNS Z | S [rotate]",
            "`thread`, `yarn`",
            "tpm tpi",
            "Example: twist 600 Z",
            "Right-handed",
        ):
            self.assertIn(part, twist)
        self.assertRegex(self.explained("units"), r"Default: +mm")
        self.assertIn("26/cm", self.explained("pitch") + self.explained("warp"))
        # Densities of Morton and Hearle's table.
        self.assertIn("density 1.52", self.explained("cotton"))
        self.assertIn("GPa", self.explained("GPa"))
        self.assertEqual(self.explained("knots").count("Example:"), 2, "of a path or curve, of a grid")
        self.assertEqual(self.explained("points").count("Example:"), 3, "of a yarn, a knit, a warp knit")

    def test_codes(self):
        for code in ("0", "1", "2", "3", "130"):
            self.assertIn("an exit code", self.explained(code))
        kinds = array((ROOT / "src/core/diagnostics.cpp").read_text(), "std::array<std::string_view, 8> names")
        self.assertIn("geometry", kinds)
        for kind in kinds:
            self.assertIn("a kind of error", self.explained(kind))
        for word in ("reshaped", "not done", "overlap", "sound", "warning"):
            self.explained(word)

    def test_topics(self):
        equilibrium = self.explained("Equilibrium")
        self.assertEqual(equilibrium, self.succeeds("help", "equilibrium").stdout)
        for state in array(source("words.h"), "state_words"):
            self.assertIn(f"state {state} ", equilibrium)
        for word in ("crimp", "thickness", "info", "profile", "twist", "remedies"):
            self.assertIn(word, equilibrium)
        for line in equilibrium.splitlines():
            self.assertLess(len(line), 120)
        for topic in self.known["topics"]:
            self.explained(topic)
            self.assertIn(topic, self.known["explain"])
        state = self.explained("state")
        self.assertIn("selvage explain equilibrium", state)
        self.assertIn("equal tensions", state)
        # The word has another meaning with `spacing`, which stays.
        self.assertEqual(self.explained("relaxed").count("A word within"), 2)

    def test_unknown_words(self):
        self.assertIn("did you mean 'twist'", self.fails(2, "explain", "twst"))
        self.assertNotIn("did you mean", self.fails(2, "explain", STRANGE))
        words = self.succeeds("explain").stdout
        for word in ("warpknit", "substrate", "130", "Topics:", "equilibrium"):
            self.assertIn(word, words)
        self.assertIn("did you mean 'equilibrium'", self.fails(2, "explain", "equilibrum"))


class Help(Case):
    def test_of_the_program_and_its_commands(self):
        everything = self.succeeds("--help").stdout
        self.assertEqual(self.succeeds("help").stdout, everything)
        self.assertEqual(self.succeeds("-h").stdout, everything)
        for command in re.findall(r"(?m)^  ([a-z]+)  ", everything.split("Subcommands:")[1]):
            text = self.succeeds(command, "--help").stdout
            self.assertEqual(self.succeeds("help", command).stdout, text)
            self.assertEqual(self.succeeds(command, "-h").stdout, text)
            self.assertRegex(text, r"Examples:\n +selvage ", command)

    def test_version(self):
        self.assertEqual(self.succeeds("version").stdout, self.succeeds("--version").stdout)

    def test_examples_work(self):
        everything = self.succeeds("--help").stdout
        for kind in ("twill", "jersey", "rib", "yarns", "cell"):
            self.succeeds("new", kind, "-o", self.folder / f"{kind}.txt")
        count = 0
        for command in re.findall(r"(?m)^  ([a-z]+)  ", everything.split("Subcommands:")[1]):
            for line in re.search(r"Examples:\n(.*)", self.succeeds(command, "--help").stdout, re.DOTALL)[
                1
            ].splitlines():
                if line.strip():
                    self.assertTrue(line.strip().startswith(f"selvage {command}"), line)
                    with self.subTest(line):
                        # What is read back is proven to about 1e-12, not to the bit.
                        if is_page(line) and not HAS_PAGES:
                            self.assertIn("three.js", self.fails(1, *line.split()[1:], cwd=self.folder))
                        else:
                            self.succeeds(*line.split()[1:], cwd=self.folder)
                    count += 1
        self.assertGreater(count, 20)

    def test_topics(self):
        self.assertIn("  length ", self.succeeds("help", "units").stdout)
        self.assertIn("130", self.succeeds("help", "exit-codes").stdout)
        for topic, part in (
            ("weave", "binder THREAD every K"),
            ("knit", "gating rib"),
            ("cell", "periodic x | y | z"),
            ("tolerance", "B-spline surface"),
            ("sections", "racetrack"),
            ("overlap", "selvage relax"),
            ("equilibrium", "state loom"),
            ("inputs", "@LIST"),
            ("outputs", "-o"),
            ("language", "warpknit"),
            ("braid", "selvage new KIND"),
        ):
            self.assertIn(part, self.succeeds("help", topic).stdout, topic)
        tolerance = self.succeeds("help", "tolerance").stdout
        self.assertEqual(tolerance.count("--tolerance X"), 2, "of the tubes, and of comparisons")
        self.assertIn("did you mean 'units'", self.fails(2, "help", "unitz"))

    def test_flags_before_the_command(self):
        self.succeeds("new", "yarns", "-o", self.folder / "yarns.txt")
        done = self.succeeds("-q", "convert", self.folder / "yarns.txt", "--to", "iges", "-o", self.out)
        self.assertEqual(done.stderr, "")
        self.assertTrue((self.out / "yarns.igs").exists())
        self.assertEqual(self.succeeds("--help", "convert").stdout, self.succeeds("convert", "--help").stdout)
        self.assertEqual(self.succeeds("--version", "convert").stdout, self.succeeds("--version").stdout)


if __name__ == "__main__":
    unittest.main()
