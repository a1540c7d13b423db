"""What goes to IGES comes back: TXT -> IGES -> TXT -> IGES and IGES -> IGES give the same bytes, in every unit and with every
form of ends: of the smallest sample of each family, every night of all samples (SELVAGE_EVERYTHING=1).
"""

import os
import re
import sys
import unittest

from iges_trip import IgesTrip
from program import EVERYTHING, SAMPLES, run, smallest_of_each_family

UNITS = ["m", "cm", "mm", "um", "inch"]
SMALL = 1_500_000  # bytes of IGES up to which a sample is tried in every unit


def samples():
    every = sorted(p for p in SAMPLES.iterdir() if p.suffix in (".txt", ".wif"))
    return every if EVERYTHING else smallest_of_each_family(every)


def part():
    """The samples that this run takes: SELVAGE_PART is I/N."""
    index, count = map(int, os.environ.get("SELVAGE_PART", "0/1").split("/"))
    return samples()[index::count]


class Identity(IgesTrip):
    def trip(self, source, *options):
        iges = self.folder / "x.igs"
        with self.subTest(sample=source.name):
            self.convert(source, iges, *options)
            self.expect_same_after_trip(iges, *options)
        return iges.stat().st_size

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


if __name__ == "__main__":
    unittest.main(argv=sys.argv, verbosity=2)
