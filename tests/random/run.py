"""Random fabrics through the whole program: what does not hold is shrunk and printed.

    SELVAGE=build/bin/selvage python3 tests/random/run.py --count 200 --seed 1

--record FILE keeps what came of each seed (the last judgement of it); --table writes the results of all that is recorded into
README.md. A fabric is its seed; --seed S --count N takes S, S + 1, ..., S + N - 1. OCCT_TOTALS names the test program that reads STEP with
OpenCASCADE. Needs numpy and meshio (/usr/bin/python3 where scripts/setup was run). The exit code is 1 when something does not hold.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import shutil
import sys
import tempfile

import generator
import oracles
import tree


README = pathlib.Path(__file__).with_name("README.md")
HEADING = "## Results\n"


def processor_time():
    """Seconds of this process and of those that it has waited for."""
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system


def judge_batch(seeds, family, keep, wanted):
    """What came of a batch: plain data, as it crosses processes."""
    begin = processor_time()
    made = {f"s{seed}": generator.fabric(seed, family) for seed in seeds}
    folder = pathlib.Path(tempfile.mkdtemp(prefix="selvage-random-"))
    try:
        judge = oracles.Judge(folder, {name: text for name, (_, text) in made.items()}, wanted).judge()
    finally:
        if not keep:
            shutil.rmtree(folder, ignore_errors=True)
    seconds = (processor_time() - begin) / len(made)
    return [
        (
            made[name][0],
            name,
            made[name][1],
            judge.asked[name],
            [(f.oracle, f.kind, f.detail) for f in judge.findings[name]],
            judge.refusals[name],
            judge.warnings[name],
            seconds,
        )
        for name in made
    ]


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
        self.seconds = 0.0

    def count(self, family, asked, bad, seconds):
        self.fabrics[family] += 1
        self.seconds += seconds
        for oracle in asked:
            (self.failed if oracle in bad else self.held)[family, oracle] += 1

    def add(self, family, name, text, asked, findings, refusals, warnings, seconds):
        self.count(family, asked, {oracle for oracle, _, _ in findings}, seconds)
        for oracle, kind, detail in findings:
            self.findings[oracle, kind].append((name, text, detail))
        for told, counted in ((refusals, self.refusals), (warnings, self.warnings)):
            for tag, message in {(tag, oracles.kind_of(message)): (tag, message) for tag, message in told}.values():
                counted[tag.split()[0], oracles.kind_of(message)].append((name, message))

    def rows(self):
        """Fabrics by family; for each oracle how many hold, and after a stroke how many do not."""
        used = [o for o in oracles.ORACLES if any((f, o) in self.held or (f, o) in self.failed for f in self.fabrics)]

        def cell(held, failed):
            return f"{held}/{failed}" if failed else str(held) if held else "-"

        yield ["", "fabrics", *used]
        for family in sorted(self.fabrics):
            yield [
                family,
                str(self.fabrics[family]),
                *[cell(self.held[family, o], self.failed[family, o]) for o in used],
            ]
        total = [
            cell(sum(self.held[f, o] for f in self.fabrics), sum(self.failed[f, o] for f in self.fabrics)) for o in used
        ]
        yield ["all", str(sum(self.fabrics.values())), *total]

    def table(self):
        rows = list(self.rows())
        widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
        return "\n".join(
            "  ".join(word.rjust(w) if i else word.ljust(w) for i, (word, w) in enumerate(zip(row, widths)))
            for row in rows
        )

    def time(self):
        count = sum(self.fabrics.values())
        return f"{self.seconds:.0f} s of processor time, {self.seconds / max(1, count):.2f} s a fabric"

    def told(self, title, counted):
        print(f"\n{title}")
        for (tag, kind), cases in sorted(counted.items(), key=lambda item: -len(item[1])):
            print(f"{len(cases):6} {tag}: {kind}\n         {cases[0][0]}: {cases[0][1][:300]}")


def read_record(path):
    """(family, asked, {oracle: kind of what does not hold}, seconds) by seed."""
    seeds = {}
    for line in path.read_text().splitlines() if path.exists() else []:
        seed, *came = json.loads(line)
        seeds[seed] = came
    return seeds


def write_results(record):
    """The section of results in README.md."""
    seeds = read_record(record)
    tally, left = Tally(), []
    for seed, (family, asked, bad, seconds) in sorted(seeds.items()):
        tally.count(family, asked, bad, seconds)
        left += [f"- seed {seed} ({family}), {oracle}: {kind}\n" for oracle, kind in bad.items()]
    head, *rows = tally.rows()
    lines = [" | ".join(row) for row in (head, ["---"] + ["--:"] * (len(head) - 1), *rows)]
    told = (
        f"{HEADING}\nGenerated by `run.py --table`: do not edit. {len(seeds)} fabrics, seeds {min(seeds)} to {max(seeds)}; {tally.time()}, "
        "that of the oracles included. Where an\noracle did not hold, the number stands after a stroke, and the seeds below.\n\n"
    )
    text = README.read_text().split(HEADING)[0].rstrip() + "\n\n" + told + "".join(f"| {line} |\n" for line in lines)
    README.write_text(text + ("\n" + "".join(left) if left else ""))


def main():
    parse = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parse.add_argument("--count", type=int, default=50)
    parse.add_argument("--seed", type=int, default=1)
    parse.add_argument("--jobs", type=int, default=1)
    parse.add_argument("--batch", type=int, default=25, help="fabrics in one call of each command")
    parse.add_argument("--family", choices=[*generator.FAMILIES], help="only this kind of fabric")
    parse.add_argument(
        "--skip", choices=[*generator.FAMILIES], nargs="+", default=[], help="leave out seeds of these kinds of fabric"
    )
    parse.add_argument(
        "--shrink", type=int, default=60, help="calls that shrinking one kind of failure may take; 0: none"
    )
    parse.add_argument("--refusals", action="store_true", help="list refusals and warnings by kind")
    parse.add_argument(
        "--only", type=lambda words: set(words.split(",")), help=f"of these oracles: {', '.join(oracles.ORACLES)}"
    )
    parse.add_argument("--keep", action="store_true", help="keep the folders in $TMPDIR")
    parse.add_argument("--record", type=pathlib.Path, metavar="FILE", help="keep what came of each seed in this file")
    parse.add_argument(
        "--table", action="store_true", help="write the results of all that --record holds into README.md"
    )
    given = parse.parse_args()
    seeds = [
        seed
        for seed in range(given.seed, given.seed + given.count)
        if generator.fabric(seed, given.family)[0] not in given.skip
    ]
    batches = [seeds[i : i + given.batch] for i in range(0, len(seeds), given.batch)]
    tally = Tally()
    with concurrent.futures.ProcessPoolExecutor(given.jobs) as pool:
        same = ([value] * len(batches) for value in (given.family, given.keep, given.only))
        for batch in pool.map(judge_batch, batches, *same):
            for fabric in batch:
                tally.add(*fabric)
                if given.record:
                    family, name, _, asked, findings, _, _, seconds = fabric
                    bad = {oracle: kind for oracle, kind, _ in findings}
                    with given.record.open("a") as record:
                        record.write(json.dumps([int(name[1:]), family, sorted(asked), bad, round(seconds, 3)]) + "\n")
                for oracle, kind, detail in fabric[4]:
                    print(f"  {fabric[1]} ({fabric[0]}) {oracle}: {kind}: {detail[:200]}", file=sys.stderr)
            print(
                f"{sum(tally.fabrics.values())} fabrics, {sum(map(len, tally.findings.values()))} findings",
                file=sys.stderr,
                flush=True,
            )
    if given.refusals:
        tally.told("Refusals", tally.refusals)
        tally.told("Warnings", tally.warnings)
    for (oracle, kind), cases in sorted(tally.findings.items(), key=lambda item: -len(item[1])):
        name, text, detail = min(cases, key=lambda case: len(case[1]))
        print(
            f"\n{len(cases)} x {oracle}: {kind}\n  {' '.join(sorted({case[0] for case in cases})[:12])}\n  {name}: {detail}"
        )
        if given.shrink:
            text = tree.shrunk(text, still_fails((oracle, kind)), given.shrink)
            print("  shrunk:")
        print("".join(f"    {line}\n" for line in text.splitlines()), end="", flush=True)
    print(f"\n{tally.table()}")
    print(tally.time())
    if given.record and given.table:
        write_results(given.record)
    return 1 if tally.findings else 0


if __name__ == "__main__":
    sys.exit(main())
