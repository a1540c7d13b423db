"""WIF files of several programs' habits: the draft, colours and pitches that the program reads are those of an oracle."""

import pathlib
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cli"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from oracle import Wif  # noqa: E402
from program import BAD, Case, ROOT, SAMPLES, run  # noqa: E402

OWN = pathlib.Path(__file__).resolve().parent / "files"
FIXTURES = ROOT.parent / "shared" / "fixtures" / "wif"
UNITS = {"mm": 1, "cm": 10, "inch": 25.4}


class Text:
    """The weave of a Fabric TXT as the program writes it."""

    def __init__(self, text):
        self.unit = UNITS[re.search(r"^units (\w+)$", text, re.MULTILINE)[1]]
        threads = re.findall(r"^thread (\S+)\n  diameter (\S+)\n(?:  color (\d+) (\d+) (\d+)\n)?", text, re.MULTILINE)
        self.color = {name: tuple(map(int, rgb)) if rgb[0] else None for name, _, *rgb in threads}
        self.diameter = {name: float(diameter) * self.unit for name, diameter, *_ in threads}
        self.systems = {name: (names.split(","), int(count), float(pitch) * self.unit) for name, names, count, pitch
                        in re.findall(r"^  (warp|weft) (\S+) (\d+) pitch (\S+)$", text, re.MULTILINE)}
        self.rows = re.search(r"^  draft\n((?:    [01]+\n)+)  end$", text, re.MULTILINE)[1].split()


class WifCase(Case):
    def fixtures(self, kind):
        files = sorted((FIXTURES / kind).glob("*.wif"))
        self.assertTrue(files, f"no files in {FIXTURES / kind}: the fixtures stand beside the project's folder")
        return files

    def text_of(self, path):
        done = self.succeeds("convert", path, "--to", "txt", "-o", "-", "--quiet")
        return Text(done.stdout)

    def agrees(self, path):
        wif, text = Wif(path), self.text_of(path)
        self.assertEqual(text.rows, wif.rows)
        for system, count in (("warp", wif.ends), ("weft", wif.picks)):
            names, written, pitch = text.systems[system]
            self.assertEqual(written, count)
            self.assertEqual([text.color[names[i % len(names)]] for i in range(count)], wif.colors[system])
            if wif.spacing[system]:
                self.assertAlmostEqual(pitch, wif.spacing[system], delta=1e-9 * pitch)


class Reading(WifCase):
    def test_good_fixtures(self):
        files = self.fixtures("desired_basic_wif") + self.fixtures("basic_wif") + self.fixtures("warn_wif")
        self.assertEqual(len(files), 15)
        for path in files:
            with self.subTest(path.name):
                self.agrees(path)

    def test_habits_of_programs(self):
        files = sorted(OWN.glob("*.wif"))
        self.assertGreaterEqual(len(files), 8)
        for path in files:
            with self.subTest(path.name):
                self.agrees(path)

    def test_samples(self):
        files = sorted(SAMPLES.glob("*.wif"))
        self.assertEqual(len(files), 3)
        for path in files:
            with self.subTest(path.name):
                self.agrees(path)
                self.assertNotIn("warning", run("convert", path, "--to", "txt", "-o", "-").stderr)

    def test_warnings(self):
        for path in self.fixtures("warn_wif"):
            with self.subTest(path.name):
                messages = run("convert", path, "--to", "txt", "-o", "-").stderr
                self.assertRegex(messages, r"wif:\d+:7: warning: color (0|11) is not in \[COLOR TABLE\]")

    def test_bad_fixtures(self):
        expected = {"default warp color too big": "82:7: error: color 11 ",
                    "default warp color too small": "82:7: error: color 0 ",
                    "default weft color too big": "88:7: error: color 11 ",
                    "default weft color too small": "88:7: error: color 0 ",
                    "missing liftplan": "error: there is neither [LIFTPLAN] nor [TIEUP] and [TREADLING]",
                    "missing tieup": "35:1: error: [TREADLING] needs [TIEUP], which is missing",
                    "missing treadling": "error: [TREADLING] is missing",
                    "missing_color_table_warp": "69:3: error: color 3, but there is no [COLOR TABLE]",
                    "missing_color_table_weft": "69:3: error: color 3, but there is no [COLOR TABLE]",
                    "too many treadles in treadline": "44:3: error: treadle 7 is beyond the 6 treadles of [WEAVING]",
                    "warp_color too big": "39:3: error: color 11 ",
                    "warp_color too small": "30:3: error: color 0 ",
                    "weft_color too big": "35:3: error: color 11 ",
                    "weft_color too small": "32:3: error: color 0 "}
        files = self.fixtures("bad_wif")
        self.assertEqual([path.stem for path in files], sorted(expected))
        for path in files:
            with self.subTest(path.name):
                self.assertIn(expected[path.stem], self.fails(1, "convert", path, "--to", "txt", "-o", "-"))


CLOTH = """fabric 1
thread t
  diameter 0.3
end
weave
  warp t 8 pitch 1
  weft t 8 pitch 1
  {}
end
"""


class DraftFile(WifCase):
    """`draft file NAME` in a Fabric TXT."""

    def cloth(self, draft, name="cloth.txt"):
        path = self.folder / name
        path.write_text(CLOTH.format(draft))
        return path

    def as_text(self, path):
        return self.succeeds("convert", path, "--to", "txt", "-o", "-", "--quiet").stdout

    def test_is_the_files_draft_in_rows(self):
        for sample in sorted(SAMPLES.glob("*.wif")):
            with self.subTest(sample.name):
                (self.folder / "drafts").mkdir(exist_ok=True)
                (self.folder / "drafts" / "a b.wif").write_bytes(sample.read_bytes())
                named = self.cloth('draft file "drafts/a b.wif"')
                rows = self.cloth("draft\n" + "\n".join(Wif(sample).rows) + "\nend", "rows.txt")
                self.assertEqual(self.as_text(named), self.as_text(rows))
                plain = self.cloth("draft plain", "plain.txt")
                self.assertNotEqual(self.as_text(named), self.as_text(plain))

    def test_a_wif_and_its_text_are_one_fabric(self):
        for sample in sorted(SAMPLES.glob("*.wif")):
            with self.subTest(sample.name):
                text = self.folder / "same.txt"
                text.write_text(self.as_text(sample))
                self.assertEqual(self.as_text(text), text.read_text())

    def test_a_wif_and_the_equal_draft_are_the_same_yarns(self):
        """Byte for byte in IGES; the draft in the text is the oracle's."""
        for sample in sorted(SAMPLES.glob("*.wif")):
            with self.subTest(sample.name):
                head, rest = self.as_text(sample).split("  draft\n")
                text = self.folder / "same.txt"
                text.write_text(head + "  draft\n" + "\n".join(Wif(sample).rows) + "\n" + rest[rest.index("  end\n"):])
                files = []
                for number, source in enumerate((sample, text)):
                    files.append(self.folder / str(number) / "cloth.igs")
                    files[-1].parent.mkdir(exist_ok=True)
                    self.succeeds("convert", source, "-o", files[-1], "--quiet")
                self.assertEqual(files[0].read_bytes(), files[1].read_bytes())
                self.assertIn(b"warp_1", files[0].read_bytes())

    def test_may_be_a_fabric_text(self):
        self.cloth("draft twill 2/1", "twill.txt")
        self.assertIn("draft twill 2/1", self.as_text(self.cloth("draft file twill.txt")))

    def test_faults_are_told_in_the_file_and_at_the_draft(self):
        (self.folder / "bad.wif").write_text((BAD / "wif_no_tieup.wif").read_text())
        self.cloth("draft file cloth.txt", "again.txt")
        (self.folder / "none.txt").write_text("fabric 1\n")
        for name, parts in {"missing.wif": ["No such file"],
                            "bad.wif": ["it has errors", "bad.wif:25:1: error: [TREADLING] needs [TIEUP]"],
                            "none.txt": ["it has 0 weaves, not one"],
                            "again.txt": ["its draft stands in a file, too: 'cloth.txt'"],
                            "-": ["No such file"]}.items():
            with self.subTest(name):
                messages = self.fails(1, "convert", self.cloth(f'draft file "{name}"'), "--to", "txt", "-o", "-")
                self.assertIn(f"cloth.txt:8:3: error: no draft in the file '{name}': ", messages)
                self.assertIn(f'  draft file "{name}"\n', messages)
                for part in parts:
                    self.assertIn(part, messages)

    def test_edit_reads_it_too(self):
        messages = self.fails(1, "edit", self.cloth("draft file missing.wif"), "--yarn", "warp_1", "--point", "1", "--to",
                              "0,0,0", "-o", self.folder / "edited.txt")
        self.assertIn("cloth.txt:8:3: error: no draft in the file 'missing.wif': ", messages)

    def test_resume_sees_that_the_file_changed(self):
        draft = self.folder / "draft.wif"
        draft.write_bytes((SAMPLES / "wif_herringbone.wif").read_bytes())
        arguments = ("convert", self.cloth("draft file draft.wif"), "--to", "txt", "-o", self.out, "--report",
                     self.folder / "report.json")
        self.succeeds(*arguments)
        first = self.out.read_text()
        draft.write_bytes((SAMPLES / "wif_satin_liftplan.wif").read_bytes())
        self.succeeds(*arguments, "--resume")
        self.assertNotEqual(self.out.read_text(), first)


class BadSamples(Case):
    def test_each_is_refused_at_its_place(self):
        expected = {"wif_no_tieup.wif": "25:1: error: [TREADLING] needs [TIEUP], which is missing",
                    "wif_shaft_beyond.wif": "27:3: error: shaft 5 is beyond the 4 shafts of [WEAVING]",
                    "wif_treadle_beyond.wif": "33:3: error: treadle 9 is beyond the 4 treadles of [WEAVING]"}
        self.assertEqual(sorted(path.name for path in BAD.glob("*.wif")), sorted(expected))
        for name, message in expected.items():
            with self.subTest(name):
                self.assertIn(f"{name}:{message}", self.fails(1, "convert", BAD / name, "--to", "txt", "-o", "-"))


if __name__ == "__main__":
    unittest.main()
