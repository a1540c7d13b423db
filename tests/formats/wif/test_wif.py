"""WIF files of several programs' habits: the draft, colours and pitches that the program reads are those of an oracle."""

import os
import pathlib
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cli"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from oracle import Wif
from program import BAD, Case, PATH, SAMPLES, run

OWN = pathlib.Path(__file__).resolve().parent / "files"
# A folder of more files, where somebody has one and says so: those below a folder whose name begins with `bad` are refused.
MORE = os.environ.get("SELVAGE_WIF_FILES")
# File, lines replaced, what is said of it after the line's number.
FAULTS = [
    ("fiberworks_rosepath.wif", [("[WARP]", "[WARP]\nColor=9")], "7: error: color 9 "),
    ("fiberworks_rosepath.wif", [("[WARP]", "[WARP]\nColor=0")], "7: error: color 0 "),
    ("fiberworks_rosepath.wif", [("[WEFT]", "[WEFT]\nColor=9")], "7: error: color 9 "),
    ("fiberworks_rosepath.wif", [("[WEFT]", "[WEFT]\nColor=0")], "7: error: color 0 "),
    ("fiberworks_rosepath.wif", [("13=3", "13=4")], "4: error: color 4 "),
    ("weavepoint_stripes.wif", [("[WARP COLORS]", "[WARP COLORS]\n2=4")], "3: error: color 4 "),
    ("weavepoint_stripes.wif", [("[WARP COLORS]", "[WARP COLORS]\n2=0")], "3: error: color 0 "),
    ("weavepoint_stripes.wif", [("[WEFT COLORS]", "[WEFT COLORS]\n2=0")], "3: error: color 0 "),
    ("weavepoint_stripes.wif", [("[COLOR TABLE]", "[NOTES]")], r"3: error: color 1, but there is no \[COLOR TABLE\]"),
    (
        "weavepoint_stripes.wif",
        [("Treadles=4", "Treadles=3")],
        r"3: error: treadle 4 is beyond the 3 treadles of \[WEAVING\]",
    ),
    ("weavepoint_stripes.wif", [("[TIEUP]", "[NOTES]")], r"1: error: \[TREADLING\] needs \[TIEUP\], which is missing"),
    ("handweaving_net.wif", [("[TREADLING]", "[NOTES]")], r"\d+: error: \[TREADLING\] is missing"),
    ("handweaving_net.wif", [("Shafts=6", "Shafts=5")], r"\d: error: shaft 6 is beyond the 5 shafts of \[WEAVING\]"),
    (
        "arahweave_satin.wif",
        [("[LIFTPLAN]", "[NOTES]")],
        r"\d+: error: there is neither \[LIFTPLAN\] nor \[TIEUP\] and \[TREADLING\]",
    ),
    ("tempoweave_liftplan.wif", [("[THREADING]", "[NOTES]")], r"\d+: error: .*\[THREADING\] is missing"),
    ("adacad_bitmap.wif", [("4=4", "4=four")], r"3: error: 'four' is no whole number"),
    ("sinking_countermarch.wif", [("units=Decipoints", "units=points")], r"7: error: 'points' is no unit of a WIF"),
]
UNITS = {"mm": 1, "cm": 10, "inch": 25.4}


class Text:
    """The weave of a Fabric TXT as the program writes it."""

    def __init__(self, text):
        self.unit = UNITS[re.search(r"^units (\w+)$", text, re.MULTILINE)[1]]
        threads = re.findall(r"^thread (\S+)\n  diameter (\S+)\n(?:  color (\d+) (\d+) (\d+)\n)?", text, re.MULTILINE)
        self.color = {name: tuple(map(int, rgb)) if rgb[0] else None for name, _, *rgb in threads}
        self.diameter = {name: float(diameter) * self.unit for name, diameter, *_ in threads}
        self.systems = {
            name: (names.split(","), int(count), float(pitch) * self.unit)
            for name, names, count, pitch in re.findall(r"^  (warp|weft) (\S+) (\d+) pitch (\S+)$", text, re.MULTILINE)
        }
        self.rows = re.search(r"^  draft\n((?:    [01]+\n)+)  end$", text, re.MULTILINE)[1].split()


class WifCase(Case):
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
    def test_more_files(self):
        files = sorted(pathlib.Path(MORE).rglob("*.wif")) if MORE else []
        self.assertEqual(bool(files), bool(MORE), f"SELVAGE_WIF_FILES: no files below {MORE}")
        for path in files:
            with self.subTest(path.name):
                if path.parent.name.startswith("bad"):
                    self.assertIn(".wif:", self.fails(1, "convert", path, "--to", "txt", "-o", "-"))
                else:
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

    def changed(self, name, changes):
        """A copy of the program's file with some lines replaced (None: taken out), each of which it has."""
        lines = (OWN / name).read_bytes().replace(b"\r", b"\n").replace(b"\n\n", b"\n").decode().split("\n")
        for old, new in changes:
            at = lines.index(old)
            lines[at : at + 1] = [] if new is None else [new]
        path = self.folder / name
        path.write_text("\n".join(lines))
        return path

    def test_the_tie_up_of_the_whole_loom(self):
        """Treadles and shafts beyond those that [WEAVING] counts, which no pick and no end needs."""
        path = self.changed("fiberworks_rosepath.wif", [("[TIEUP]", "[TIEUP]\n41=1,2\n42=1,40")])
        self.agrees(path)
        messages = run("convert", path, "--to", "txt", "-o", "-").stderr
        self.assertRegex(
            messages, r"warning: \[TIEUP\] has treadle 41 \(and 1 more\), and \[WEAVING\] says \d+ treadles"
        )
        self.assertRegex(messages, r"warning: \[TIEUP\] has shaft 40, and \[WEAVING\] says \d+ shafts")

    def test_threads_that_have_no_room_are_built_as_thick_as_they_can_be(self):
        """The same cloth whatever thickness jams, in any unit: no cliff where the drawing has the spacing itself."""
        built = {}
        for unit, long in (("Centimeters", 1), ("Inches", 1 / 2.54), ("Decipoints", 10 / 25.4 * 720)):
            for share in (0.5, 0.8, 0.99, 1.0, 1.2):
                system = f"Units={unit}\nThreads=2\nSpacing={0.04 * long}\nThickness={share * 0.04 * long}\n"
                path = self.folder / "drawn.wif"
                path.write_text(
                    "[WIF]\nVersion=1.1\n[CONTENTS]\nTHREADING=true\nTIEUP=true\nTREADLING=true\n"
                    "[THREADING]\n1=1\n2=2\n[TIEUP]\n1=1\n2=2\n[TREADLING]\n1=1\n2=2\n"
                    "[WEAVING]\nRising Shed=true\nTreadles=2\nShafts=2\n"
                    f"[WARP]\n{system}[WEFT]\n{system}"
                )
                with self.subTest(unit=unit, share=share):
                    messages = self.succeeds("check", path).stderr
                    times = re.search(r"its threads are built ([\d.]+) times as thick", messages)
                    self.assertEqual(times is None, share == 0.5, messages)
                    if times:
                        built[unit, share] = share * float(times[1])
        # To the 1 % of the search, and the clearance, which grows with the thickness of the drawing.
        self.assertLess(max(built.values()) / min(built.values()), 1.03, built)
        self.assertGreater(min(built.values()), 0.577)  # Peirce's jammed cloth of round threads

    def test_colors_that_nobody_takes(self):
        """A default beyond the table, where every thread has a colour of its own."""
        for system in ("WARP", "WEFT"):
            for color in (0, 4):
                with self.subTest(system=system, color=color):
                    path = self.changed("weavepoint_stripes.wif", [(f"[{system}]", f"[{system}]\nColor={color}")])
                    self.agrees(path)
                    messages = run("convert", path, "--to", "txt", "-o", "-").stderr
                    self.assertRegex(messages, rf"wif:\d+:7: warning: color {color} is not in \[COLOR TABLE\]")

    def test_faults(self):
        """One fault in a file with the habits of a program, told at its place."""
        for name, changes, message in FAULTS:
            with self.subTest(name=name, changes=changes):
                path = self.changed(name, changes)
                messages = self.fails(1, "convert", path, "--to", "txt", "-o", "-")
                self.assertRegex(messages, rf"{name}:\d+:{message}")


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
                text.write_text(head + "  draft\n" + "\n".join(Wif(sample).rows) + "\n" + rest[rest.index("  end\n") :])
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
        for name, parts in {
            "missing.wif": ["No such file"],
            "bad.wif": ["it has errors", "bad.wif:25:1: error: [TREADLING] needs [TIEUP]"],
            "none.txt": ["it has 0 weaves, not one"],
            "again.txt": ["its draft stands in a file, too: 'cloth.txt'"],
            "-": ["No such file"],
        }.items():
            with self.subTest(name):
                messages = self.fails(1, "convert", self.cloth(f'draft file "{name}"'), "--to", "txt", "-o", "-")
                self.assertIn(f"cloth.txt:8:3: error: no draft in the file '{name}': ", messages)
                self.assertIn(f'  draft file "{name}"\n', messages)
                for part in parts:
                    self.assertIn(part, messages)

    def refused_everywhere(self, cloth, reason):
        """By a command that works in a process of its own, and by one that does not."""
        for arguments in (
            ("info", cloth, "--timeout", "60"),
            ("edit", cloth, "--yarn", "warp_1", "--point", "1", "--to", "0,0,0", "-o", self.folder / "edited.txt"),
        ):
            messages = self.fails(1, *arguments, timeout=120)
            self.assertRegex(messages, r"cloth\.txt:8:3: error: no draft in the file '[^\n]*': " + reason)
            self.assertNotRegex(messages, "crash|signal|defect of this program")

    def test_geometry_has_no_draft(self):
        """A format that can be read, but not as a fabric, is an error at the draft's place."""
        for name in ("yarns.igs", "yarns.stp"):
            with self.subTest(name):
                self.succeeds("convert", PATH, "-o", self.folder / name, "--quiet")
                self.refused_everywhere(self.cloth(f"draft file {name}"), r"it is (iges|step) .* no draft")

    def test_only_regular_files_are_read(self):
        os.mkfifo(self.folder / "pipe.wif")
        (self.folder / "zero.wif").symlink_to("/dev/zero")
        (self.folder / "folder.wif").mkdir()
        for name, outside in (("pipe.wif", False), ("folder.wif", False), ("zero.wif", True), ("/dev/zero", True)):
            with self.subTest(name):
                cloth = self.cloth(f"draft file {name}")
                self.refused_everywhere(
                    cloth, "it is neither in this text's folder" if outside else "it is not a regular file"
                )
                if outside:
                    self.assertIn(
                        "it is not a regular file", self.fails(1, "info", cloth, "--allow-outside", timeout=120)
                    )

    def test_only_files_below_the_text_are_read(self):
        sample = SAMPLES / "wif_herringbone.wif"
        (self.folder / "texts").mkdir()
        (self.folder / "outside.wif").write_bytes(sample.read_bytes())
        (self.folder / "texts" / "link.wif").symlink_to("../outside.wif")
        (self.folder / "texts" / "inside.wif").write_bytes(sample.read_bytes())
        (self.folder / "texts" / "inner.wif").symlink_to("inside.wif")
        for name in ("inside.wif", "inner.wif", "../texts/inside.wif", self.folder / "texts" / "inside.wif"):
            with self.subTest(name):
                self.as_text(self.cloth(f"draft file {name}", "texts/cloth.txt"))
        inside = self.as_text(self.cloth("draft file inside.wif", "texts/cloth.txt"))
        for name in ("../outside.wif", "link.wif", self.folder / "outside.wif"):
            with self.subTest(name):
                cloth = self.cloth(f"draft file {name}", "texts/cloth.txt")
                self.refused_everywhere(cloth, "it is neither in this text's folder nor below it: .*--allow-outside")
                done = self.succeeds("convert", cloth, "--to", "txt", "-o", "-", "--quiet", "--allow-outside")
                self.assertEqual(done.stdout, inside)

    def test_edit_reads_it_too(self):
        messages = self.fails(
            1,
            "edit",
            self.cloth("draft file missing.wif"),
            "--yarn",
            "warp_1",
            "--point",
            "1",
            "--to",
            "0,0,0",
            "-o",
            self.folder / "edited.txt",
        )
        self.assertIn("cloth.txt:8:3: error: no draft in the file 'missing.wif': ", messages)

    def test_resume_sees_that_the_file_changed(self):
        draft = self.folder / "draft.wif"
        draft.write_bytes((SAMPLES / "wif_herringbone.wif").read_bytes())
        arguments = (
            "convert",
            self.cloth("draft file draft.wif"),
            "--to",
            "txt",
            "-o",
            self.out / "cloth.txt",
            "--report",
            self.folder / "report.json",
        )
        self.succeeds(*arguments)
        first = (self.out / "cloth.txt").read_text()
        draft.write_bytes((SAMPLES / "wif_satin_liftplan.wif").read_bytes())
        self.succeeds(*arguments, "--resume")
        self.assertNotEqual((self.out / "cloth.txt").read_text(), first)


class BadSamples(Case):
    def test_each_is_refused_at_its_place(self):
        expected = {
            "wif_no_tieup.wif": "25:1: error: [TREADLING] needs [TIEUP], which is missing",
            "wif_shaft_beyond.wif": "21:3: error: shaft 5 is beyond the 4 shafts of [WEAVING]",
            "wif_treadle_beyond.wif": "33:3: error: treadle 9 is beyond the 4 treadles of [WEAVING]",
        }
        self.assertEqual(sorted(path.name for path in BAD.glob("*.wif")), sorted(expected))
        for name, message in expected.items():
            with self.subTest(name):
                self.assertIn(f"{name}:{message}", self.fails(1, "convert", BAD / name, "--to", "txt", "-o", "-"))


if __name__ == "__main__":
    unittest.main()
