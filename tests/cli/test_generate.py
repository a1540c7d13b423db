"""`selvage --generate`: a manual page without warnings, completion that completes, a grammar that knows every statement."""

import json
import os
import re
import select
import shutil
import subprocess
import time
import unittest

from program import Case, PROGRAM, ROOT, environment, run, terminal


def names(table):
    """The first column of a table of the program."""
    return re.findall(r"^  (\w\S*)  ", table, re.MULTILINE)[1:]


class Generated(Case):
    @classmethod
    def setUpClass(cls):
        cls.usage = json.loads(run("--generate", "json-usage").stdout)
        cls.commands = [command["name"] for command in cls.usage["commands"]]

    def generated(self, form):
        path = self.folder / form
        path.write_text(self.succeeds("--generate", form).stdout)
        return path

    def test_forms(self):
        message = self.fails(2, "--generate", "sonnet")
        for form in ("man", "complete-bash", "complete-zsh", "complete-fish", "json-usage", "textmate"):
            self.assertIn(form, message)
            self.assertIn(form, self.succeeds("--help").stdout)
        self.fails(2, "--generate")

    def test_usage_is_that_of_help(self):
        self.assertEqual(self.commands, re.findall(r"(?m)^  ([a-z]+)  ", run("--help").stdout.split("Subcommands:")[1]))
        for command in self.usage["commands"]:
            text = self.succeeds(command["name"], "--help").stdout.split("Examples:")[0]
            shown = set(re.findall(r"(?m)^  (?:-\w,)?(--?[\w-]+)", text)) - {"--help"}
            listed = {option["names"][-1] for option in command["options"] if option["names"][0].startswith("-")}
            self.assertEqual(shown, listed, command["name"])
        self.assertEqual([f["name"] for f in self.usage["formats"]], names(run("formats").stdout))

    def test_manual_page(self):
        page = self.generated("man")
        if shutil.which("groff"):
            done = subprocess.run(["groff", "-ww", "-man", "-Tutf8", "-P-c", page], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            # Words may be hyphenated at the end of a line.
            shown = re.sub(r"(\x1b\[\d*m|.\x08|\u2010\n\s*)", "", done.stdout)
            for command in self.usage["commands"]:
                self.assertRegex(shown, rf"(?m)^ +{command['name']}\b")
                for option in command["options"]:
                    self.assertIn(option["names"][-1], shown)
            for code in self.usage["exit_codes"]:
                self.assertRegex(shown, rf"(?m)^ +{code}\b")
            for section in ("NAME", "SYNOPSIS", "OPTIONS", "EXIT STATUS", "EXAMPLES"):
                self.assertRegex(shown, rf"(?m)^{section}$")
        if shutil.which("mandoc"):
            done = subprocess.run(["mandoc", "-Tlint", page], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stdout), (0, ""))

    # --- completion

    def completed(self, *words):
        """What bash offers for the last one of these words of a command line."""
        script = self.folder / "complete-bash"
        if not script.exists():
            self.generated("complete-bash")
        driver = (
            f'source {script}\nCOMP_WORDS=("$@")\nCOMP_CWORD=$(($# - 1))\n_selvage\n'
            "((${#COMPREPLY[@]})) && printf '%s\\n' \"${COMPREPLY[@]}\"\ntrue\n"
        )
        done = subprocess.run(
            ["bash", "--norc", "-c", driver, "bash", "selvage", *words], cwd=self.folder, capture_output=True, text=True
        )
        self.assertEqual((done.returncode, done.stderr), (0, ""), words)
        return done.stdout.splitlines()

    def test_bash_of_commands_and_options(self):
        self.assertEqual(self.completed(""), self.commands)
        self.assertEqual(self.completed("con"), ["convert"])
        self.assertEqual(self.completed("--ver"), ["--version"])
        self.assertIn("man", self.completed("--generate", ""))
        for command in self.usage["commands"]:
            expected = {name for option in command["options"] for name in option["names"] if name.startswith("-")}
            self.assertEqual(set(self.completed(command["name"], "-")), expected | {"-h", "--help"}, command["name"])
        self.assertEqual(self.completed("mesh", "--mat"), ["--matrix", "--matrix-material", "--matrix-size"])

    def test_bash_of_values(self):
        self.assertEqual(self.completed("convert", "--ends", ""), ["patch", "fan", "planar", "none"])
        self.assertEqual(self.completed("convert", "--ends", "=", "pl"), ["planar"])
        self.assertEqual(self.completed("convert", "--ends", "="), ["patch", "fan", "planar", "none"])
        self.assertEqual(self.completed("convert", "x.txt", "--units", "c"), ["cm"])
        writable = set(self.completed("mesh", "--to", ""))
        self.assertIn("inp", writable)
        self.assertNotIn("iges", writable)
        self.assertEqual(self.completed("convert", "--to", "iges,ste"), ["iges,step"])
        self.assertEqual(self.completed("convert", "-j", ""), [])

    def test_bash_of_words(self):
        kinds = names(run("new").stdout)
        self.assertEqual(self.completed("new", ""), kinds)
        self.assertEqual(self.completed("new", "den"), ["denim"])
        self.assertEqual(self.completed("explain", "warpk"), ["warpknit"])
        self.assertEqual(set(self.completed("explain", "")), {w for w in self.usage["explain"] if " " not in w})
        self.assertIn("exit-codes", self.completed("help", "exit"))
        self.assertIn("mesh", self.completed("help", "mes"))

    def test_bash_of_files(self):
        for name in ("a b.txt", "plain.txt", "solid.stp", "draft.wif", "mesh.inp", "picture.png"):
            (self.folder / name).write_text("")
        (self.folder / "below").mkdir()
        readable = {e for f in self.usage["formats"] if f["readable"] for e in f["extensions"]}
        self.assertNotIn(".inp", readable)
        expected = {p.name for p in self.folder.iterdir() if p.is_dir() or p.suffix in readable}
        self.generated("complete-bash")
        self.assertIn("a b.txt", expected)
        self.assertEqual(set(self.completed("convert", "")), expected)
        self.assertEqual(self.completed("check", "plain.txt", "dr"), ["draft.wif"])
        self.assertEqual(self.completed("view", "plain.txt", "-o", "pic"), ["picture.png"])
        self.assertEqual(self.completed("diff", "plain.txt", "so"), ["solid.stp"])

    def test_bash_at_a_terminal(self):
        script = self.generated("complete-bash")
        os.symlink(PROGRAM, self.folder / "selvage")
        master, slave = terminal()
        shell = subprocess.Popen(
            ["bash", "--norc", "--noprofile", "-i"],
            stdin=slave,
            stdout=slave,
            stderr=slave,
            env=environment(PATH=f"{self.folder}:{os.environ['PATH']}", TERM="dumb", PS1="> "),
            start_new_session=True,
        )
        os.close(slave)
        self.addCleanup(os.close, master)
        self.addCleanup(shell.wait)
        self.addCleanup(shell.kill)
        shown = b""

        def wait_for(text):
            nonlocal shown
            end = time.monotonic() + 60
            while text not in shown and time.monotonic() < end:
                if select.select([master], [], [], 1)[0]:
                    shown += os.read(master, 65536)
            self.assertIn(text, shown)

        os.write(master, f"source {script}; echo re''ady\n".encode())
        wait_for(b"ready")
        os.write(master, b"selvage expl\twarpk\t\n")
        wait_for(b"A warp knit by its bars")

    def test_other_shells(self):
        for shell, form, check in (("zsh", "complete-zsh", "-n"), ("fish", "complete-fish", "--no-execute")):
            script = self.generated(form)
            for command in self.commands:
                self.assertIn(command, script.read_text())
            if shutil.which(shell):
                done = subprocess.run([shell, check, script], capture_output=True, text=True)
                self.assertEqual((done.returncode, done.stderr), (0, ""), shell)


class Grammar(Case):
    def test_the_file_is_up_to_date(self):
        path = ROOT / "formats/txt/fabric.tmLanguage.json"
        self.assertEqual(
            path.read_text(),
            self.succeeds("--generate", "textmate").stdout,
            "renew it: selvage --generate textmate > formats/txt/fabric.tmLanguage.json",
        )

    def scopes(self, patterns, line):
        """(text, scope) from left to right, as editors match: the pattern that begins first, of several the first one."""
        at, found = 0, []
        while at < len(line):
            matches = [(m.start(), i, m) for i, p in enumerate(patterns) if (m := p[1].search(line, at)) and m[0]]
            if not matches:
                break
            _, i, match = min(matches, key=lambda m: m[:2])
            rule = patterns[i][0]
            for k, capture in rule.get("captures", {}).items():
                found.append((match[int(k)], capture["name"]))
            if "name" in rule:
                found.append((match[0].strip(), rule["name"]))
            at = match.end()
        return found

    def test_every_statement_of_the_samples_is_known(self):
        grammar = json.loads(self.succeeds("--generate", "textmate").stdout)
        patterns = [(p, re.compile(p["match"])) for p in grammar["patterns"]]
        texts = [p.read_text() for p in (ROOT / "samples").glob("*.txt")]
        count = 0
        for text in texts:
            self.assertRegex(
                next(line for line in text.splitlines() if line and not line.startswith("#")), grammar["firstLineMatch"]
            )
            rows, params = False, re.findall(r"(?m)^param\s+(\w+)", text)
            for line in text.splitlines():
                word = re.match(r"\s*([A-Za-z][\w.-]*)", line)
                if word and re.match(r"\w+", word[1])[0] in params:
                    continue  # a row
                rows = bool(re.match(r"\s*(chart|draft\s*(#|$))", line)) or (rows and not re.match(r"\s*end\b", line))
                if not word or (rows and not re.match(r"\s*(chart|draft|end)\b", line)):
                    continue
                scopes = self.scopes(patterns, line)
                with self.subTest(line):
                    self.assertEqual(scopes[0][0].lower(), word[1].lower())
                    self.assertRegex(scopes[0][1], "^keyword")
                count += 1
        self.assertGreater(count, 1500)

    def test_what_stands_in_a_line(self):
        grammar = json.loads(self.succeeds("--generate", "textmate").stdout)
        patterns = [(p, re.compile(p["match"])) for p in grammar["patterns"]]
        for line, text, scope in (
            ("  warp cotton 8 24/cm  # so many", "24/cm", "constant.numeric"),
            ("  warp cotton 8 24/cm  # so many", "# so many", "comment"),
            ('title "A # in it"', '"A # in it"', "string"),
            ("  color #1E90FF", "#1E90FF", "constant.other.color"),
            ("Thread tow", "tow", "entity.name"),
            ("  draft TWILL 2/2", "TWILL", "constant.language"),
            ("    0 -.5e-3 30deg", "-.5e-3", "constant.numeric"),
            ("    0 -.5e-3 30deg", "30deg", "constant.numeric"),
        ):
            with self.subTest(text):
                found = [s for t, s in self.scopes(patterns, line) if t == text]
                self.assertTrue(found and found[0].startswith(scope), self.scopes(patterns, line))


if __name__ == "__main__":
    unittest.main()
