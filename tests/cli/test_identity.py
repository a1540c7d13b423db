"""What goes to IGES comes back: TXT -> IGES -> TXT -> IGES and IGES -> IGES give the same bytes.

An IGES file holds every control point, knot and weight of body and end faces in the shortest text that reads back to
the same double (the second reader of tests/formats/iges proves that), so equal files are equal models, bit for bit.
"""

import os
import re
import sys
import tempfile
import unittest
from pathlib import Path

from program import SAMPLES, run

UNITS = ["m", "cm", "mm", "um", "inch"]
SMALL = 1_500_000  # bytes of IGES up to which a sample is tried in every unit


def samples():
    return sorted(p for p in SAMPLES.iterdir() if p.suffix in (".txt", ".wif"))


def part():
    """The share of the samples that this run takes: SELVAGE_PART is I/N."""
    index, count = map(int, os.environ.get("SELVAGE_PART", "0/1").split("/"))
    return samples()[index::count]


class Identity(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="selvage-test-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def convert(self, source, target, *options):
        result = run("convert", str(source), "-o", str(target), "--quiet", *options)
        self.assertEqual(result.returncode, 0, f"{source} {options}: {result.stderr}")
        self.assertTrue(target.exists(), f"{source} {options}: {target.name} is missing")

    def trip(self, source, *options):
        """source -> a/x.igs -> b/x.igs and a/x.igs -> x.txt -> c/x.igs."""
        a, b, c = (self.folder / name / "x.igs" for name in "abc")
        for path in (a, b, c):
            path.parent.mkdir(exist_ok=True)
        self.convert(source, a, *options)
        with self.subTest(sample=source.name, options=options, trip="IGES, IGES"):
            self.convert(a, b)
            self.assertTrue(a.read_bytes() == b.read_bytes(), "the IGES file changed")
        with self.subTest(sample=source.name, options=options, trip="TXT, IGES, TXT"):
            text = self.folder / "x.txt"
            self.convert(a, text)
            solid = [o for o in options if o == "--iges-solid"]
            self.convert(text, c, *solid)
            self.assertEqual(undated(a), undated(c), "control points, knots, weights or names changed")
        return a.stat().st_size

    def test_every_sample(self):
        for sample in part():
            size = self.trip(sample)
            if size > SMALL or sample.suffix != ".txt":
                continue
            for unit in UNITS:
                self.trip(sample, "--units", unit)
            text = sample.read_text(encoding="utf-8-sig")
            if re.search(PHYSICAL, text, re.M | re.I):
                continue
            for unit in UNITS:
                changed = self.folder / sample.name
                changed.write_text(with_unit(text, unit), encoding="utf-8")
                if "far outside of what exists" in run("info", str(changed)).stderr:
                    continue  # glass fibres in um: no section is so small
                self.trip(changed)

    def test_every_end_and_solids(self):
        for sample in part():
            if sample.stat().st_size > 4000 or sample.suffix != ".txt":
                continue
            for ends in ("fan", "planar", "none"):
                self.trip(sample, "--ends", ends)
            self.trip(sample, "--iges-solid")


# With lengths in another unit beside it, a thread of so many tex or turns a metre makes another fabric, possibly an
# impossible one; a draft stands in a file of its own.
PHYSICAL = r"^\s*(tex|denier|ne|twist|plies|filaments|draft\s+file|use\s+file)\b"


def with_unit(text, unit):
    """The same numbers in another unit."""
    if re.search(r"^units\s", text, re.M | re.I):
        return re.sub(r"^units\s+\S+", f"units {unit}", text, count=1, flags=re.M | re.I)
    return re.sub(r"^(fabric\s+1[^\n]*\n)", rf"\1units {unit}\n", text, count=1, flags=re.M | re.I)


def undated(path):
    """The lines but those that say when the file was written, and the name that a text does not keep."""
    return [line for line in path.read_bytes().split(b"\n") if line[72:73] not in (b"G", b"S")]


if __name__ == "__main__":
    unittest.main(argv=sys.argv, verbosity=2)
