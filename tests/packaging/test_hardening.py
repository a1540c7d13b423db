"""Program, modules, workers and library are hardened: by their headers and symbols (readelf), and by how they were compiled.

SELVAGE_BUILD: the build folder (default: build), of the type Release.
"""

import json
import os
import pathlib
import platform
import re
import subprocess
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ.get("SELVAGE_BUILD", REPOSITORY / "build")).resolve()
PROGRAMS = ("selvage", "selvage-tetgen")
FLAGS = {"-O2", "-D_FORTIFY_SOURCE=3", "-fstack-protector-strong"}
OF_PROCESSOR = {"x86_64": {"-fstack-clash-protection", "-fcf-protection"}}


def readelf(*arguments):
    command = ["readelf", "--wide", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, "LC_ALL": "C"}).stdout


def flags_of(entry):
    return set(entry["command"].split())


def object_of(entry):
    """Below the build folder."""
    return re.search(r" -o (\S+)", entry["command"])[1]


class Hardening(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.programs = [BUILD / "bin" / name for name in PROGRAMS]
        cls.modules = sorted((BUILD / "bin").glob("selvage_*.so"))
        entries = json.loads((BUILD / "compile_commands.json").read_text())
        # Tests are not released.
        cls.commands = [entry for entry in entries if not object_of(entry).startswith("tests/")]
        cls.objects = [BUILD / object_of(entry) for entry in cls.commands if object_of(entry).endswith(".o")]

    def pages(self, kind):
        """(name, what readelf prints) of each object that is built."""
        built = [path for path in self.objects if path.exists()]
        self.assertGreater(len(built), 100)
        pages = re.split(r"^File: ", readelf(kind, *built), flags=re.MULTILINE)[1:]
        self.assertEqual(len(pages), len(built))
        return [page.split("\n", 1) for page in pages]

    def each(self, files, check):
        for path in files:
            with self.subTest(path.name):
                check(path)

    def test_programs_can_be_loaded_at_any_address(self):
        def check(path):
            self.assertRegex(readelf("--file-header", path), r"Type: +DYN")
            self.assertRegex(readelf("--dynamic", path), r"\(FLAGS_1\) .*\bPIE\b")

        self.each(self.programs, check)

    def test_relocations_are_bound_at_the_start_and_read_only_after_it(self):
        def check(path):
            dynamic = readelf("--dynamic", path)
            self.assertRegex(dynamic, r"\(FLAGS_1\) .*\bNOW\b")
            self.assertNotIn("(TEXTREL)", dynamic)
            self.assertRegex(readelf("--program-headers", path), r"\n +GNU_RELRO ")

        self.assertGreater(len(self.modules), 6)
        self.each(self.programs + self.modules, check)

    def test_no_memory_is_written_and_run(self):
        def check(path):
            headers = readelf("--program-headers", path)
            segments = re.findall(r"\n +(LOAD|GNU_STACK) .* ([R ][W ][E ]) 0x", headers)
            self.assertIn(("GNU_STACK", "RW "), segments)
            self.assertGreater(len(segments), 2)
            self.assertEqual([s for s in segments if s[1].endswith("WE")], [])

        self.each(self.programs + self.modules, check)

    def test_libraries_come_from_the_system(self):
        self.each(
            self.programs + self.modules,
            lambda path: self.assertNotRegex(readelf("--dynamic", path), r"\((RPATH|RUNPATH)\)"),
        )

    def test_stacks_and_copies_are_guarded(self):
        """Objects call the functions in which the guards end: most that of stacks, some those of copies with known sizes. (Programs
        call them in any case, for the sake of static libraries.)"""
        undefined = [set(re.findall(r" UND (\w+)", page)) for _, page in self.pages("--syms")]
        guarded = [names for names in undefined if "__stack_chk_fail" in names]
        checked = [names for names in undefined if any(re.fullmatch(r"__(?!stack)\w+_chk", name) for name in names)]
        self.assertGreater(len(guarded), 0.5 * len(undefined))
        self.assertGreater(len(checked), 3)

    def test_calls_and_returns_are_guarded_in_each_object(self):
        """Not in the whole program: Debian's C library and its start files are built without."""
        if platform.machine() != "x86_64":
            self.skipTest("CET is of x86")
        for name, page in self.pages("--notes"):
            self.assertIn("x86 feature: IBT, SHSTK", page, name)

    def test_every_source_is_compiled_so(self):
        wanted = FLAGS | OF_PROCESSOR.get(platform.machine(), set())
        self.assertGreater(len(self.commands), 100)
        for entry in self.commands:
            self.assertEqual(wanted - flags_of(entry), set(), entry["file"])
            self.assertTrue(flags_of(entry) & {"-fPIC", "-fPIE"}, entry["file"])
            self.assertEqual({f for f in flags_of(entry) if f.startswith(("-fno-stack", "-O0", "-no-pie"))}, set())


if __name__ == "__main__":
    unittest.main()
