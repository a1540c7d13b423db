"""STEP files of our own with one reference that points elsewhere, or one attribute that is another: whatever they say, no
worker dies of them. STEP_MUTATIONS files (default 30, every night 100) for each command; the same ones on every run."""

import json
import os
import pathlib
import random
import re
import signal
import time
import unittest

from program import EVERYTHING, GRID, Case, children_of, run, seconds_of, start
from step_damage import BASES, Base

COUNT = int(os.environ.get("STEP_MUTATIONS", "100" if EVERYTHING else "30"))
COMMANDS = {
    "info": ["info"],
    "check": ["check"],
    "convert": ["convert", "--to", "iges"],
}


class Mutations(Case):
    def bases(self):
        made = []
        for name, arguments in BASES:
            path = self.folder / f"{name}.stp"
            self.succeeds("convert", *arguments, "-o", path)
            made.append(Base(path.read_text()))
        return made

    def test_no_worker_dies(self):
        bases, chance = self.bases(), random.Random(6)
        folder = self.folder / "mutated"
        folder.mkdir()
        for number in range(COUNT):
            (folder / f"m{number:05}.stp").write_text(bases[number % len(bases)].mutated(chance))
        for name, command in COMMANDS.items():
            report = self.folder / f"{name}.json"
            more = ["-o", self.folder / f"out_{name}"] if name == "convert" else []
            done = run(*command, folder, *more, "--report", report, "--quiet", "--timeout", "120", "--memory", "2000")
            self.assertIn(done.returncode, (0, 1, 3), done.stderr[-2000:])
            inputs = json.loads(report.read_text())["inputs"]
            self.assertEqual(len(inputs), COUNT)
            with self.subTest(command=name):
                died = [
                    (pathlib.Path(each["path"]).name, message["text"])
                    for each in inputs
                    for message in each.get("messages", [])
                    if re.search(r"crashed|was stopped|was killed", message["text"])
                ]
                self.keep(folder, died)
                self.assertEqual(died, [])

    def test_what_kills_the_reader_is_a_defect_of_the_file(self):
        """No such file is known: the signal comes from here, while OpenCASCADE reads."""
        text = "fabric 1\ntolerance 0.05\n"
        for number in range(400):
            text += f'yarn "y{number}"\n diameter 0.4\n path polyline\n {number} 0 0\n {number} 1 0\n end\nend\n'
        (self.folder / "many.txt").write_text(text)
        path = self.folder / "many.stp"
        self.succeeds("convert", self.folder / "many.txt", "-o", path)
        for arguments in (("info", path), ("diff", path, GRID), ("diff", GRID, path)):
            with self.subTest(arguments):
                process = start(*arguments, "--quiet")
                deadline = time.monotonic() + 300
                while time.monotonic() < deadline and process.poll() is None:
                    worker = next(iter(children_of(process.pid)), None)
                    if worker and seconds_of(worker) > 0.3:
                        os.kill(worker, signal.SIGSEGV)
                        break
                    time.sleep(0.01)
                _, errors = process.communicate(timeout=300)
                self.assertEqual(process.returncode, 1)
                self.assertRegex(
                    errors, rf"^{path}: error: what this file says makes the reader of STEP fail \(Segmentation fault\)"
                )

    def keep(self, folder, died):
        kept = os.environ.get("STEP_MUTATIONS_KEEP")
        for name, _ in died if kept else []:
            (pathlib.Path(kept) / name).write_bytes((folder / name).read_bytes())


if __name__ == "__main__":
    unittest.main()
