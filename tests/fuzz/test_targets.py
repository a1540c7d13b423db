"""Every reader has a fuzz target, every target seeds, and the nightly workflow runs all of them."""

import os
import pathlib
import re
import subprocess
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FUZZ = ROOT / "tests" / "fuzz"
# Written by a grammar of their own: any bytes will do.
FREE = {"mesh", "placing", "expressions"}

sys.path.insert(0, str(ROOT / "scripts"))
from fuzz_seeds import EXTENSIONS


def targets():
    """name: extension of its seeds"""
    listed = subprocess.run([os.environ["FUZZ_REPLAY"], "--list"], check=True, capture_output=True, text=True).stdout
    return {name: seeds for name, seeds, _, _ in (line.split("\t") for line in listed.splitlines())}


def readers():
    """Names of formats whose descriptor has a reader, by the sources."""
    for path in sorted((ROOT / "formats").glob("*/*.cpp")):
        text = path.read_text()
        for descriptor in re.split(r"static const Descriptor", text)[1:]:
            if re.search(r"\.read_(fabric|model|points|mesh|deck) =", descriptor):
                yield re.search(r'\.name = "(\w+)"', descriptor)[1]


class Targets(unittest.TestCase):
    def test_every_reader_has_one(self):
        named = list(readers())
        self.assertGreater(len(named), 9)
        self.assertEqual([name for name in named if name not in targets()], [])

    def test_every_one_has_seeds(self):
        samples = {path.suffix.lower() for folder in ("samples", "tests") for path in (ROOT / folder).rglob("*")}
        for name, seeds in targets().items():
            if name not in FREE:
                with self.subTest(name):
                    has_own = (FUZZ / "seeds" / name).is_dir() and any((FUZZ / "seeds" / name).iterdir())
                    self.assertTrue(has_own or EXTENSIONS.get(seeds, {seeds}) & samples)

    def test_kept_inputs_are_of_targets(self):
        for kind in ("seeds", "crashers"):
            self.assertEqual([path.name for path in (FUZZ / kind).iterdir() if path.name not in targets()], [])

    def test_what_is_left_out_of_coverage_is_there(self):
        for line in (FUZZ / "not_of_readers.txt").read_text().splitlines():
            if line and not line.startswith("#"):
                place, reason = line.split(None, 1)
                with self.subTest(place):
                    self.assertTrue(list(ROOT.glob(place.partition(":")[0])))
                    self.assertTrue(reason)

    def test_the_nightly_workflow_runs_all(self):
        text = (ROOT / ".github" / "workflows" / "nightly.yml").read_text()
        self.assertIn("targets=$(scripts/fuzz --list --json)", text)
        self.assertIn("target: ${{ fromJSON(needs.fuzzer.outputs.targets) }}", text)
        self.assertRegex(text, r"scripts/fuzz \$\{\{ matrix\.target \}\} \d+")


if __name__ == "__main__":
    unittest.main()
