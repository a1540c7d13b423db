"""One campaign of libFuzzer: see scripts/fuzz, which builds the fuzzer and calls this."""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import time

import fuzz_page
from fuzz_seeds import write_seeds

ROOT = pathlib.Path(__file__).resolve().parents[1]
SEEDS = [ROOT / "samples", ROOT / "tests" / "fixtures", ROOT / "tests" / "formats"]
OWN_SEEDS = ROOT / "tests" / "fuzz" / "seeds"
KEPT = ROOT / "tests" / "fuzz" / "crashers"
# Whose strings are the words of a target that is no format; of others those of Fabric TXT.
SOURCES = {
    "results": ["formats/frd", "formats/inp"],
    "use": ["formats/txt", "formats/wif", "formats/csv"],
    "report": ["src/pipeline"],
}
# What only costs time: a long quarantine of freed memory, and the callers of each malloc (ASAN_OPTIONS=malloc_context_size=30 tells them).
SANITIZER = "quarantine_size_mb=8:malloc_context_size=0:detect_stack_use_after_return=0"
# Seconds of one execution that are a finding: of a reader fewer than of what builds, measures and meshes.
PATIENCE = {"check": 100, "mesh": 100}


def targets(fuzzer):
    """name: (extension of its seeds, most bytes, what it does)"""
    lines = subprocess.run([fuzzer], check=True, capture_output=True, text=True).stdout.splitlines()
    return {name: (seeds, int(most), does) for name, seeds, most, does in (line.split("\t") for line in lines)}


def write_dictionary(name, path):
    """The words of a format: the strings of its source."""
    words = set()
    folders = SOURCES.get(name) or ([f"formats/{name}"] if (ROOT / "formats" / name).is_dir() else ["formats/txt"])
    for source in sorted(file for folder in folders for file in (ROOT / folder).glob("*")):
        if source.suffix in (".cpp", ".h"):
            words.update(re.findall(r'"([A-Za-z0-9*/;.,()\[\]=#$<@-][A-Za-z0-9_ ()\[\]-]{0,30})"', source.read_text()))
    path.write_text("".join(f'"{word}"\n' for word in sorted(words) if not word.endswith(".h")))


def add_to_total(path, executions, seconds, found):
    """What there was since the last finding."""
    total = json.loads(path.read_text()) if path.exists() else {"campaigns": 0, "executions": 0, "seconds": 0}
    new = {"campaigns": 1, "executions": executions, "seconds": seconds}
    total = {key: 0 if found else total[key] + new[key] for key in total}
    path.write_text(json.dumps(total))
    return total


def main():
    parser = argparse.ArgumentParser(prog="scripts/fuzz")
    parser.add_argument("--fuzzer", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--folder", required=True, type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--json", action="store_true", help="with --list: the names, for a matrix of jobs")
    parser.add_argument("target", nargs="?")
    chosen, more = parser.parse_known_args()
    known = targets(chosen.fuzzer)
    if chosen.list and chosen.json:
        print(json.dumps(list(known)))
        return 0
    if chosen.list:
        for name, (_, _, does) in known.items():
            print(f"{name:12} {does}")
        return 0
    if chosen.target not in known:
        sys.exit(f"fuzz: no target '{chosen.target}'; there are: {', '.join(known)}")
    if len(more) != 1 or not re.fullmatch(r"\d+|-runs=\d+", more[0]):
        sys.exit("fuzz: how long? SECONDS or -runs=N")
    seeds, most, does = known[chosen.target]
    corpus, found = chosen.folder / "corpus" / chosen.target, chosen.folder / "found"
    for folder in (corpus, found):
        folder.mkdir(parents=True, exist_ok=True)
    dictionary = chosen.folder / f"{chosen.target}.dict"
    write_dictionary(chosen.target, dictionary)
    write_seeds(SEEDS, [OWN_SEEDS / chosen.target, KEPT / chosen.target], seeds, most, corpus)
    length = more[0] if more[0].startswith("-") else f"-max_total_time={more[0]}"
    log = chosen.folder / f"{chosen.target}.log"
    patience = PATIENCE.get(chosen.target, 20)
    begin = time.monotonic()
    with log.open("w") as output:
        code = subprocess.run(
            [
                chosen.fuzzer,
                f"--target={chosen.target}",
                f"-artifact_prefix={found}/{chosen.target}-",
                f"-dict={dictionary}",
                f"-max_len={most}",
                f"-timeout={patience}",
                f"-report_slow_units={patience}",
                "-rss_limit_mb=2500",
                "-close_fd_mask=1",
                "-entropic=0",
                "-print_final_stats=1",
                length,
                corpus,
            ],
            stderr=output,
            env={**os.environ, "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", SANITIZER)},
        ).returncode
    text = log.read_text(errors="replace")
    sys.stderr.write("".join(line + "\n" for line in text.splitlines()[-40 if code else -12 :]))
    last = re.findall(r"cov: (\d+) ft: (\d+) corp: (\d+)", text)
    count = re.search(r"stat::number_of_executed_units: (\d+)", text)
    seconds = round(time.monotonic() - begin)
    if not last or not count:
        return code or 1
    found = "Test unit written to" in text
    total = add_to_total(chosen.folder / f"{chosen.target}.json", int(count[1]), seconds, found)
    kept = sum(1 for path in (KEPT / chosen.target).glob("*"))
    fuzz_page.update(
        "campaigns",
        chosen.target,
        [
            does,
            most,
            total["executions"],
            total["campaigns"],
            total["seconds"],
            total["executions"] // max(total["seconds"], 1),
            *last[-1],
            kept,
        ],
    )
    return code


if __name__ == "__main__":
    sys.exit(main())
