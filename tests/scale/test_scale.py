"""A cloth of a million loops and a batch of 100,000 inputs: complete, in flat memory, in time by their number.

Takes half an hour and 26 GB of disk, so it runs every night, and by hand:
  SELVAGE=build/bin/selvage python3 tests/scale/test_scale.py
SELVAGE_SCALE=0.01: sizes smaller by that. Processor time is compared (of the program and all that it starts), from size
to size of one run.
"""

import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))

from program import PROGRAM, ROD, Case, environment  # noqa: E402

SCALE = float(os.environ.get("SELVAGE_SCALE", "1"))
MEBIBYTE = 1 << 20
# Time grows as size to this power at most. A machine's speed changes by some per cent while it runs.
MOST_GROWTH = 1.1

JERSEY = """fabric 1
units mm
thread cotton30
  tex 30
  density 1.52
  packing 0.75
end
knit jersey
  thread cotton30
  courses {courses}
  wales {wales}
end
"""


class Used:
    """What a run took: seconds of processor time, and bytes of its largest process."""

    def __init__(self, *arguments):
        process = subprocess.Popen([PROGRAM, *map(str, arguments)], env=environment(), stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.messages = process.stderr.read().decode(errors="replace")
        process.stderr.close()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = self.code = os.waitstatus_to_exitcode(status)
        self.seconds = usage.ru_utime + usage.ru_stime
        self.user = usage.ru_utime
        self.bytes = usage.ru_maxrss * 1024  # of this process or of one that it waited for


def growth(small, large, times):
    return math.log(large / small) / math.log(times)


class Scale(Case):
    def tell(self, text):
        print(f"  {text}", file=sys.stderr, flush=True)

    def assert_grows(self, seconds, sizes, what):
        exponent = growth(seconds[0], seconds[-1], sizes[-1] / sizes[0])
        self.tell(f"{what}: {seconds[-1]:.1f} s of processor time for {sizes[-1]}, exponent {exponent:.3f}")
        self.assertLess(exponent, MOST_GROWTH, (seconds, sizes))

    def test_a_million_loops(self):
        largest = max(40, round(1000 * math.sqrt(SCALE)))
        needed = 26e3 * largest**2
        free = shutil.disk_usage(self.folder).free
        if free < needed:
            self.skipTest(f"{needed / 1e9:.0f} GB of disk are needed, {free / 1e9:.0f} are free")
        sizes, seconds = [], []
        for side in (largest // 10, largest):
            sizes.append(side * side)
            cloth = self.folder / f"jersey{side}.txt"
            cloth.write_text(JERSEY.format(courses=side, wales=side))
            used = Used("convert", cloth, "--to", "iges", "-o", self.out, "-j2", "--no-progress", "--timeout", "7200")
            self.assertEqual(used.code, 0, used.messages)
            seconds.append(used.user)
            parts = sorted(self.out.glob(f"jersey{side}*.igs"))
            surfaces = 0
            for part in parts:
                # The first of two lines in the directory of each of a yarn's surfaces: body and two ends.
                lines = subprocess.run(["grep", "-c", "^     128 .*D[0-9 ]*[13579]$", part],
                                       capture_output=True, text=True, check=True)
                surfaces += int(lines.stdout)
                part.unlink()
            self.assertEqual(surfaces, 3 * side, f"{len(parts)} files")
            self.tell(f"{side} x {side} loops: {used.bytes / MEBIBYTE:.0f} MiB, {len(parts)} files")
            self.assertLess(used.bytes, 200 * MEBIBYTE)
        self.assert_grows(seconds, sizes, "loops")

    def test_a_hundred_thousand_inputs(self):
        largest = max(1000, round(100_000 * SCALE))
        sizes, seconds, memory = [], [], []
        for count in (largest // 10, largest):
            inputs = self.folder / f"rods{count}"
            inputs.mkdir()
            for k in range(count):
                (inputs / f"rod{k:06}.txt").write_text(ROD.format(title=k, height=0.5 + 0.1 * k / count))
            used = Used("convert", inputs, "--to", "iges", "-o", self.out, "-j2", "--no-progress")
            self.assertEqual(used.code, 0, used.messages)
            self.assertRegex(used.messages, re.compile(f"{count} of {count} inputs done"))
            self.assertEqual(sum(1 for _ in self.out.rglob("*.igs")), count)
            shutil.rmtree(self.out)
            shutil.rmtree(inputs)
            sizes.append(count)
            seconds.append(used.seconds)
            memory.append(used.bytes)
            self.tell(f"{count} inputs: {used.bytes / MEBIBYTE:.0f} MiB")
        self.assertLess(memory[-1] - memory[0], 150 * (sizes[-1] - sizes[0]), "bytes an input while it is planned")
        self.assert_grows(seconds, sizes, "inputs")


if __name__ == "__main__":
    unittest.main()
