"""Counts the instructions of hot paths with valgrind's callgrind, and compares them with those of before. Called by
scripts/counts.

Counts do not depend on how busy the machine is. What of them would depend on the processor (glibc chooses among several
memcpy, sin and the like) and on the environment is pinned; compilers and libraries are those of Debian 12.
"""

import argparse
import concurrent.futures
import datetime
import os
import pathlib
import platform
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]

# A path that became dearer by more than this has to be looked at.
BOUND = 0.05

# What each path is. What the program `counts` does not have is a whole process.
PATHS = {
    "build-jersey": "jersey of 16 x 16 loops, as published: centre lines and tubes",
    "build-weave": "plain weave of 12 x 12 yarns: centre lines and tubes",
    "equilibrium": "satin of 5 ends and picks, from three starts",
    "mend-knit": "jersey of 8 x 8 loops of 0.2 mm, mended so that none overlap, and built",
    "iges-write": "256 yarns of 18 x 16 control points",
    "iges-read": "the same file, to surfaces",
    "step-write": "16 yarns of 18 x 16 control points",
    "contact": "overlaps in a raw jersey of 6 x 6 loops",
    "check": "plain weave of 4 x 4 yarns: valid solids? overlapping? (without what CGAL does)",
    "diff": "two jerseys of 16 x 16 loops: a point moved, and a yarn with twice as many spans",
    "mesh-cell": "one crossing of elliptic tows in a matrix, edges of 0.3 mm, without TetGen's own process",
    "start-up": "the whole of `selvage --version`",
}

# What glibc would choose by the processor; all that are left out, an x86-64 of the first kind has not either.
FEATURES = """AVX AVX2 AVX512F AVX512VL AVX512BW AVX_Fast_Unaligned_Load BMI1 BMI2 ERMS FSRM FMA FMA4 LZCNT MOVBE POPCNT RTM
  SSE4_1 SSE4_2 SSSE3 XSAVE XSAVEC Fast_Unaligned_Copy Fast_Unaligned_Load Prefer_No_VZEROUPPER Slow_BSF""".split()


def environment(folder):
    """All that the programs see."""
    caches = "glibc.cpu.x86_data_cache_size=0x8000:glibc.cpu.x86_shared_cache_size=0x100000:glibc.cpu.x86_non_temporal_threshold=0xc0000"
    return {
        "PATH": "/usr/bin:/bin",
        "HOME": folder,
        "TMPDIR": folder,
        "LC_ALL": "C",
        "SOURCE_DATE_EPOCH": "0",
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=" + ",".join("-" + name for name in FEATURES) + ":" + caches,
    }


def command_of(path, bin_folder, folder):
    """What callgrind runs, and its own options: only what happens within `measured` counts, or all of it."""
    if path == "start-up":
        return [], [f"{bin_folder}/selvage", "--version"]
    return ["--toggle-collect=measured"], [f"{bin_folder}/counts", path, folder]


def count(path, bin_folder):
    """Instructions of one path, and those of all that callgrind saw of it."""
    with tempfile.TemporaryDirectory(prefix="counts") as folder:
        options, command = command_of(path, bin_folder, folder)
        # Addresses stay the same: what hashes or sorts them takes the same way.
        valgrind = ["setarch", "-R", "valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out.%p", *options]
        done = subprocess.run(valgrind + command, cwd=folder, env=environment(folder), capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"counts: {path} failed with {done.returncode}: {' '.join(command)}\n{done.stdout}{done.stderr}")
        total = 0
        for out in pathlib.Path(folder).glob("out.*"):  # one a process
            found = re.search(r"^(?:summary|totals): (\d+)", out.read_text(), re.MULTILINE)
            if not found:
                sys.exit(f"counts: callgrind left no sum of {path}")
            total += int(found[1])
        if total == 0:
            sys.exit(f"counts: nothing of {path} was counted")
        return total


def counts_of(paths, bin_folder):
    with concurrent.futures.ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        return dict(zip(paths, pool.map(lambda path: count(path, bin_folder), paths)))


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True, cwd=ROOT).stdout.strip()


def tools():
    """Whose work the counts are, too."""
    names = [
        "g++",
        "libc6",
        "libstdc++6",
        "libocct-modeling-algorithms-7.6",
        "libcgal-dev",
        "libtet1.5",
        "libeigen3-dev",
        "valgrind",
    ]
    listed = subprocess.run(
        ["dpkg-query", "-W", "-f", "${Package} ${Version}, ", *names], capture_output=True, text=True
    )
    return f"{output_of('g++', '-dumpfullversion')} on {platform.machine()}; {listed.stdout.strip(', ')}"


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|---|" + "---:|" * (len(heads) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def write(file, counts):
    rows = [[path, f"{counts[path]:,}", PATHS[path]] for path in PATHS]
    file.write_text(
        "# Instructions of hot paths\n\n"
        f"Generated by `scripts/counts --write` on {datetime.date.today()}, commit {output_of('git', 'rev-parse', '--short', 'HEAD')}.\n"
        f"Compiler {tools()}.\n\n"
        f"`scripts/counts --check` fails where a path takes more than {BOUND:.0%} more than here. One thread; one processor like the other.\n\n"
        + table(["path", "instructions", "what it does"], rows).replace("---:|\n", "---|\n", 1)
    )


def read(file):
    if not file.exists():
        sys.exit(f"counts: there is no {file}; scripts/counts --write makes it")
    return {
        name: int(value.replace(",", ""))
        for name, value in re.findall(r"^\| ([a-z-]+) \| ([\d,]+) \|", file.read_text(), re.MULTILINE)
    }


def check(file, counts):
    """A table of all, and the names of those that are too dear."""
    before = read(file)
    rows, dear, cheap = [], [], []
    for path, now in counts.items():
        if path not in before:
            sys.exit(f"counts: {file} has no '{path}'; scripts/counts --write renews it")
        change = now / before[path] - 1
        if change > BOUND:
            dear.append(path)
        elif change < -BOUND:
            cheap.append(path)
        verdict = "TOO DEAR" if change > BOUND else "cheaper" if change < -BOUND else "as before"
        rows.append([path, f"{before[path]:,}", f"{now:,}", f"{100 * change:+.1f} %", verdict])
    print(table(["path", "before", "now", "change", ""], rows), end="")
    if cheap:
        print(f"counts: cheaper: {', '.join(cheap)}; scripts/counts --write keeps that", file=sys.stderr)
    if not dear:
        return
    print(
        f"counts: more than {BOUND:.0%} dearer: {', '.join(dear)}\nEither mend it (callgrind_annotate shows where), or say in the "
        "commit why it has to be, and renew the file with scripts/counts --write.",
        file=sys.stderr,
    )
    if f"Compiler {tools()}." not in file.read_text():
        print(f"counts: {file} was made by another compiler or other libraries; here: {tools()}", file=sys.stderr)
    sys.exit(1)


def main():
    parser = argparse.ArgumentParser(prog="scripts/counts")
    parser.add_argument("--bin", required=True, help=argparse.SUPPRESS)
    parser.add_argument("--file", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("--check", action="store_true", help="compare with the committed counts")
    parser.add_argument("--write", action="store_true", help="renew the committed counts")
    parser.add_argument("paths", nargs="*", metavar="PATH", help="only these: " + ", ".join(PATHS))
    given = parser.parse_args()
    unknown = [path for path in given.paths if path not in PATHS]
    if unknown:
        parser.error(f"no path {', '.join(unknown)}; there are {', '.join(PATHS)}")
    if given.write and (given.paths or given.check):
        parser.error("--write renews all paths, and goes by itself")

    counts = counts_of(given.paths or list(PATHS), given.bin)
    if given.write:
        write(given.file, counts)
    elif given.check:
        check(given.file, counts)
    else:
        print(table(["path", "instructions"], [[path, f"{value:,}"] for path, value in counts.items()]), end="")


if __name__ == "__main__":
    main()
