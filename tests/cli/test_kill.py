"""SIGKILL or SIGTERM at 60 random moments of a batch: every file that is there is whole, and the next run completes the rest."""

import random
import shutil
import signal
import subprocess
import time
import unittest

from program import Case, GRID, PATH, children_of, files_below, start

INPUTS = 12
MOMENTS = 60


class Killed(Case):
    def test_whole_or_absent(self):
        inside = self.folder / "in"
        inside.mkdir()
        for i in range(INPUTS):
            shutil.copy(PATH if i % 3 == 0 else GRID, inside / f"f{i}.txt")
        begin = time.monotonic()
        self.succeeds("convert", inside, "--to", "iges,txt", "-o", self.folder / "whole", "-j", 2)
        seconds = time.monotonic() - begin
        whole = files_below(self.folder / "whole")
        self.assertEqual(len(whole), 2 * INPUTS)

        moment = random.Random(20131104)
        stopped_midway = 0
        for number in range(MOMENTS):
            process = start(
                "convert",
                inside,
                "--to",
                "iges,txt",
                "-o",
                self.out,
                "-j",
                2,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            time.sleep(moment.uniform(0, seconds))
            children = children_of(process.pid)
            process.send_signal(signal.SIGTERM if number % 2 else signal.SIGKILL)
            self.assertIn(process.wait(), (0, 130, -signal.SIGKILL, -signal.SIGTERM))
            self.gone(children)
            found = {name: data for name, data in files_below(self.out).items() if not name.startswith(".")}
            for name, data in found.items():
                self.assertEqual(data, whole[name], f"{name} is not whole")
            if 0 < len(found) < len(whole):
                stopped_midway += 1
            if moment.random() < 0.5:  # half of the runs begin anew, the others replace what is there
                shutil.rmtree(self.out, ignore_errors=True)
        self.succeeds("convert", inside, "--to", "iges,txt", "-o", self.out)
        self.assertEqual(files_below(self.out), whole, "hidden files too: nothing else may be left")
        self.assertGreater(stopped_midway, 0, "no kill hit the batch while it wrote: the test tests nothing")

    def gone(self, children):
        for pid in children:
            while True:
                try:
                    with open(f"/proc/{pid}/stat") as stat:
                        if stat.read().rsplit(")", 1)[1].split()[0] == "Z":
                            break
                except (FileNotFoundError, ProcessLookupError):
                    break
                time.sleep(0.001)


if __name__ == "__main__":
    unittest.main()
