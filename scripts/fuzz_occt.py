"""A campaign against OpenCASCADE: see scripts/fuzz. Damaged STEP files, the same ones of the same seed, go through the program as a
user would call it, many a run; what OpenCASCADE does of them has to stay within the time and the memory, and to be reported as a
defect of the file. Files that failed stand in build-fuzz/found."""

import argparse
import json
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time

import fuzz_page

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "cli"))
from step_damage import Base

SECONDS, MEGABYTES = 20, 2000
# What a run takes longer than its limit: the end of a worker, and the next one's begin, on a busy machine.
MARGIN = 10
BATCH = 100
COMMANDS = {"check": ["check"], "convert": ["convert", "--to", "iges"]}
# Deaths that are reported as the program's own, and those as the file's.
OURS = re.compile(r"crashed:|ended unexpectedly|unexpected failure|was killed from outside|could not (be started|tell)")
STOPPED = re.compile(r"makes the reader of STEP fail|was stopped: not done within|needs more memory than")


# As small as they can be, since an execution costs what its yarns cost: a straight yarn, a ring, two yarns and their cell, a piece.
THREAD = "material epoxy\n density 1.2\nend\nthread t\n diameter 1\n material epoxy\nend\n"
YARN = "yarn {} t\n path polyline\n -1 {} 0\n 3 {} 0\n end\nend\n"
CELL = "cell 0 -1 -1  2 3 1\n matrix epoxy\nend\n"
TEXTS = {
    "yarn": f"fabric 1\ntolerance 0.1\n{THREAD}{YARN.format('a', 0, 0)}",
    "ring": f"fabric 1\ntolerance 0.2\n{THREAD}yarn a t\n closed\n path\n 0 0 0\n 5 0 0\n 5 5 0\n 0 5 0\n end\nend\n",
    "two": f"fabric 1\ntolerance 0.1\n{THREAD}{YARN.format('a', 0, 0)}{YARN.format('b', 1.5, 1.5)}{CELL}",
    "piece": (ROOT / "samples" / "pocket_pieces.txt").read_text(),
}
# Every kind of file that the program writes: a text and the options.
KINDS = [
    ("yarn", []),
    ("yarn", ["--ends", "fan"]),
    ("ring", ["--ends", "planar"]),
    ("yarn", ["--ends", "none", "--step-schema", "AP214"]),
    ("two", ["--instances"]),
    ("piece", []),
    ("two", ["--cut", "--matrix"]),
]


def bases_of(program, folder):
    for number, (name, options) in enumerate(KINDS):
        text, path = folder / f"{name}.txt", folder / f"base{number}.stp"
        text.write_text(TEXTS[name])
        subprocess.run([program, "convert", text, *options, "-o", path, "--quiet"], check=True)
        yield Base(path.read_text())


def mutant(bases, seed, number):
    return bases[number % len(bases)].damaged(random.Random(f"{seed}:{number}"))


class Tally:
    def __init__(self, name, found):
        self.name, self.found = name, found
        self.files = self.sound = self.defects = self.stopped = 0
        self.longest, self.failures = 0.0, []

    def fail(self, path, reason):
        shutil.copy(path, self.found / f"occt-{self.name}-{path.name}")
        self.failures.append(f"{path.name}: {reason}")

    def take(self, entry, path):
        texts = [message["text"] for message in entry.get("messages", [])]
        self.files += 1
        self.longest = max(self.longest, entry["seconds"])
        if any(STOPPED.search(text) for text in texts):
            self.stopped += 1
        elif entry["ok"] and not entry.get("defect"):
            self.sound += 1
        else:
            self.defects += 1
        if ours := [text for text in texts if OURS.search(text)]:
            self.fail(path, ours[0])
        elif entry["seconds"] > SECONDS + MARGIN:
            self.fail(path, f"took {entry['seconds']:.0f} s of {SECONDS}")


def run_batch(program, tally, folder, files):
    report, out = folder / "report.json", folder / "out"
    more = ["-o", out] if tally.name == "convert" else []
    done = subprocess.run(
        [
            program,
            *COMMANDS[tally.name],
            *files,
            *more,
            "--report",
            report,
            "--quiet",
            "--sandbox",
            "require",
            "--timeout",
            str(SECONDS),
            "--memory",
            str(MEGABYTES),
        ],
        capture_output=True,
        text=True,
    )
    shutil.rmtree(out, ignore_errors=True)
    if done.returncode not in (0, 1, 3) or not report.exists():
        tally.fail(files[0], f"exit code {done.returncode} of a run that begins with it: {done.stderr[-500:]}")
        return
    inputs = json.loads(report.read_text())["inputs"]
    report.unlink()
    if len(inputs) != len(files):
        tally.fail(files[0], f"{len(inputs)} inputs in the report of {len(files)}")
    for entry in inputs:
        tally.take(entry, pathlib.Path(entry["path"]))


def main():
    parser = argparse.ArgumentParser(prog="scripts/fuzz occt")
    parser.add_argument("--program", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--folder", required=True, type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("-runs", type=int, required=True, help="number of files, each for every command")
    parser.add_argument("-seed", type=int, default=1)
    chosen = parser.parse_args()
    found = chosen.folder / "found"
    found.mkdir(parents=True, exist_ok=True)
    tallies = [Tally(name, found) for name in COMMANDS]
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        bases = list(bases_of(chosen.program, folder))
        begin = time.monotonic()
        for first in range(0, chosen.runs, BATCH):
            batch = folder / "batch"
            batch.mkdir()
            files = []
            for number in range(first, min(first + BATCH, chosen.runs)):
                files.append(batch / f"m{number:06}.stp")
                files[-1].write_text(mutant(bases, chosen.seed, number))
            for tally in tallies:
                run_batch(chosen.program, tally, folder, files)
            shutil.rmtree(batch)
            print(
                f"occt: {first + len(files)} files, {time.monotonic() - begin:.0f} s, "
                f"{sum(len(tally.failures) for tally in tallies)} failures",
                file=sys.stderr,
                flush=True,
            )
    for tally in tallies:
        fuzz_page.update(
            "occt",
            tally.name,
            [
                tally.files,
                chosen.seed,
                tally.sound,
                tally.defects,
                tally.stopped,
                f"{tally.longest:.1f}",
                len(tally.failures),
            ],
        )
        for failure in tally.failures:
            print(f"occt: {tally.name}: {failure}", file=sys.stderr)
    return 1 if any(tally.failures for tally in tallies) else 0


if __name__ == "__main__":
    sys.exit(main())
