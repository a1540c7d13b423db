"""Random fabrics through the whole program: what does not hold is shrunk and printed.

    SELVAGE=build/bin/selvage python3 tests/random/run.py --count 200 --seed 1

A fabric is its seed; --seed S --count N takes S, S + 1, ..., S + N - 1. OCCT_TOTALS names the test program that reads STEP with
OpenCASCADE. Needs numpy and meshio (/usr/bin/python3 where scripts/setup was run). The exit code is 1 when something does not hold.
"""

import argparse
import collections
import concurrent.futures
import pathlib
import resource
import shutil
import sys
import tempfile

import generator
import oracles
import tree


def judge_batch(seeds, family, keep, wanted):
    """What came of a batch: plain data, as it crosses processes."""
    made = {f"s{seed}": generator.fabric(seed, family) for seed in seeds}
    folder = pathlib.Path(tempfile.mkdtemp(prefix="selvage-random-"))
    try:
        judge = oracles.Judge(folder, {name: text for name, (_, text) in made.items()}, wanted).judge()
    finally:
        if not keep:
            shutil.rmtree(folder, ignore_errors=True)
    return [(made[name][0], name, made[name][1], judge.asked[name], [(f.oracle, f.kind, f.detail) for f in judge.findings[name]],
             judge.refusals[name], judge.warnings[name]) for name in made]


def still_fails(key):
    def judged(texts):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="selvage-random-"))
        try:
            named = {f"c{i}": text for i, text in enumerate(texts)}
            judge = oracles.Judge(folder, named, wanted={key[0]}).judge()
            return [any(f.key == key for f in judge.findings[name]) for name in named]
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    return judged


class Tally:
    def __init__(self):
        self.fabrics = collections.Counter()
        self.held, self.failed = collections.Counter(), collections.Counter()
        self.findings, self.refusals, self.warnings = (collections.defaultdict(list) for _ in range(3))

    def add(self, family, name, text, asked, findings, refusals, warnings):
        self.fabrics[family] += 1
        bad = {oracle for oracle, _, _ in findings}
        for oracle in asked:
            (self.failed if oracle in bad else self.held)[family, oracle] += 1
        for oracle, kind, detail in findings:
            self.findings[oracle, kind].append((name, text, detail))
        for told, counted in ((refusals, self.refusals), (warnings, self.warnings)):
            for tag, message in {(tag, oracles.kind_of(message)): (tag, message) for tag, message in told}.values():
                counted[tag.split()[0], oracles.kind_of(message)].append((name, message))

    def table(self):
        """Fabrics by family; for each oracle how many hold, and after a stroke how many do not."""
        used = [o for o in oracles.ORACLES if any((f, o) in self.held or (f, o) in self.failed for f in self.fabrics)]
        def cell(held, failed):
            return f"{held}/{failed}" if failed else str(held) if held else "-"
        rows = [["", "fabrics", *used]]
        for family in sorted(self.fabrics):
            rows.append([family, str(self.fabrics[family]), *[cell(self.held[family, o], self.failed[family, o]) for o in used]])
        total = [cell(sum(self.held[f, o] for f in self.fabrics), sum(self.failed[f, o] for f in self.fabrics)) for o in used]
        rows.append(["all", str(sum(self.fabrics.values())), *total])
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        return "\n".join("  ".join(word.rjust(w) if i else word.ljust(w) for i, (word, w) in enumerate(zip(row, widths))) for row in rows)

    def told(self, title, counted):
        print(f"\n{title}")
        for (tag, kind), cases in sorted(counted.items(), key=lambda item: -len(item[1])):
            print(f"{len(cases):6} {tag}: {kind}\n         {cases[0][0]}: {cases[0][1][:300]}")


def main():
    parse = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("--count", type=int, default=50)
    parse.add_argument("--seed", type=int, default=1)
    parse.add_argument("--jobs", type=int, default=1)
    parse.add_argument("--batch", type=int, default=25, help="fabrics in one call of each command")
    parse.add_argument("--family", choices=[*generator.FAMILIES], help="only this kind of fabric")
    parse.add_argument("--shrink", type=int, default=60, help="calls that shrinking one kind of failure may take; 0: none")
    parse.add_argument("--refusals", action="store_true", help="list refusals and warnings by kind")
    parse.add_argument("--only", type=lambda words: set(words.split(",")), help=f"of these oracles: {', '.join(oracles.ORACLES)}")
    parse.add_argument("--keep", action="store_true", help="keep the folders in $TMPDIR")
    given = parse.parse_args()
    seeds = range(given.seed, given.seed + given.count)
    batches = [seeds[i:i + given.batch] for i in range(0, len(seeds), given.batch)]
    tally = Tally()
    with concurrent.futures.ProcessPoolExecutor(given.jobs) as pool:
        same = ([value] * len(batches) for value in (given.family, given.keep, given.only))
        for batch in pool.map(judge_batch, batches, *same):
            for fabric in batch:
                tally.add(*fabric)
                for oracle, kind, detail in fabric[4]:
                    print(f"  {fabric[1]} ({fabric[0]}) {oracle}: {kind}: {detail[:200]}", file=sys.stderr)
            print(f"{sum(tally.fabrics.values())} fabrics, {sum(map(len, tally.findings.values()))} findings", file=sys.stderr, flush=True)
    if given.refusals:
        tally.told("Refusals", tally.refusals)
        tally.told("Warnings", tally.warnings)
    for (oracle, kind), cases in sorted(tally.findings.items(), key=lambda item: -len(item[1])):
        name, text, detail = min(cases, key=lambda case: len(case[1]))
        print(f"\n{len(cases)} x {oracle}: {kind}\n  {' '.join(sorted({case[0] for case in cases})[:12])}\n  {name}: {detail}")
        if given.shrink:
            text = tree.shrunk(text, still_fails((oracle, kind)), given.shrink)
            print("  shrunk:")
        print("".join(f"    {line}\n" for line in text.splitlines()), end="", flush=True)
    print(f"\n{tally.table()}")
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    print(f"{used.ru_utime + used.ru_stime:.0f} s of processor time, {(used.ru_utime + used.ru_stime) / max(1, given.count):.2f} s a fabric")
    return 1 if tally.findings else 0


if __name__ == "__main__":
    sys.exit(main())
