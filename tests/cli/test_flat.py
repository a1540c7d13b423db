"""Many inputs in one call: the parent's memory and descriptors stay as they are. test_flat.py INPUTS: with so many, and a table."""

import os
import pathlib
import sys
import time
import unittest

from program import Case, ROD, start

INPUTS = 500


def resident(pid):
    """KiB of memory that are the process's own."""
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("RssAnon:"):
            return int(line.split()[1])
    raise ProcessLookupError


class Flat(Case):
    def test_memory_and_descriptors(self):
        inside = self.folder / "in"
        inside.mkdir()
        for i in range(INPUTS):
            (inside / f"{i:06}.txt").write_text(ROD.format(title=i, height=0.1))
        process = start("convert", inside, "--to", "iges", "-o", self.out, "-j", 2, "--no-progress")
        begin = last = time.monotonic()
        samples, step, told = [], max(1, INPUTS // 20), 0
        while process.poll() is None:
            time.sleep(0.02 if INPUTS <= 500 else 1)  # to look takes time from what is looked at
            done = len(os.listdir(self.out)) if self.out.is_dir() else 0
            if done < (len(samples) + 1) * step:
                continue
            try:
                samples.append((done, resident(process.pid), len(os.listdir(f"/proc/{process.pid}/fd"))))
            except (FileNotFoundError, ProcessLookupError):
                break
            if INPUTS > 500:
                now = time.monotonic()
                print(
                    f"{done:6} done, {samples[-1][1]:6} KiB, {samples[-1][2]:2} descriptors, {now - begin:6.1f} s, "
                    f"{1000 * (now - last) / (done - told):.2f} ms a job",
                    flush=True,
                )
                last, told = now, done
        _, message = process.communicate()
        self.assertEqual(process.returncode, 0, message)
        self.assertEqual(len(os.listdir(self.out)), INPUTS)
        self.assertGreater(len(samples), 5, "too few samples: the test tests nothing")
        first, last = samples[1], samples[-1]
        self.assertLessEqual(max(sample[2] for sample in samples), 16)
        # What is kept of each input is a few words.
        self.assertLessEqual(last[1] - first[1], 300 + (last[0] - first[0]) // 4, samples)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        INPUTS = int(sys.argv.pop())
    unittest.main()
