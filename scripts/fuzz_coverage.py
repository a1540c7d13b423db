"""Lines of readers that what campaigns have learnt reaches: see scripts/fuzz."""

import argparse
import collections
import fnmatch
import json
import os
import pathlib
import re
import subprocess
import sys

import fuzz_page

ROOT = pathlib.Path(__file__).resolve().parents[1]
FUZZ = ROOT / "tests" / "fuzz"
EXCUSES, LEFT = FUZZ / "not_of_readers.txt", FUZZ / "UNREACHED.md"
# Readers whose work is done in other folders as well.
FOLDERS = {
    "results": ["src/results/solved_deck.cpp"],
    "report": ["src/pipeline/report.cpp", "src/pipeline/report_page.cpp"],
    "use": ["src/pipeline/named_files.cpp"],
}


def excuses():
    """(pattern of paths, pattern of functions, reason), a line each"""
    for line in EXCUSES.read_text().splitlines():
        if line and not line.startswith("#"):
            place, reason = line.split(None, 1)
            path, _, function = place.partition(":")
            yield path, function or "*", reason


def sources_of(target):
    folder = ROOT / "formats" / target
    return FOLDERS.get(target) or ([f"formats/{target}/"] if folder.is_dir() else [])


def replay(program, target, corpus, profile):
    """Runs the inputs of a target; the number of them."""
    inputs = [
        folder
        for folder in (corpus, FUZZ / "seeds" / target, FUZZ / "crashers" / target)
        if folder.is_dir() and any(folder.iterdir())
    ]
    done = subprocess.run(
        [program, target, *inputs],
        capture_output=True,
        text=True,
        env={**os.environ, "LLVM_PROFILE_FILE": str(profile)},
    )
    if done.returncode != 0:
        sys.exit(f"fuzz: {target} stops at {done.stderr.splitlines()[-1]}")
    return int(done.stdout.split()[0])


def source_path(name, build):
    """Relative to the root. Compilers are told not to name this machine's folders: a name is one below the root (./src/x.cpp) or
    seen from the folder of the build (../src/x.h), both behind that folder's own name, `build`."""
    name = name.removeprefix(f"./{build}/")
    return os.path.normpath(os.path.join(build, name) if name.startswith("../") else name)


def functions_of(program, profile, sources):
    """(path, name, first line, last line, {line: is reached}) of each function in these sources. A function that is compiled several
    times (a template) is one."""
    merged = profile.with_suffix(".profdata")
    subprocess.run(["llvm-profdata-14", "merge", "-sparse", profile, "-o", merged], check=True)
    exported = json.loads(
        subprocess.run(
            ["llvm-cov-14", "export", "-skip-expansions", program, f"-instr-profile={merged}"],
            check=True,
            capture_output=True,
            text=True,
        ).stdout
    )
    found = {}
    for function in exported["data"][0]["functions"]:
        path = source_path(function["filenames"][0], program.parents[1].name)
        if not any(path.startswith(source) for source in sources):
            continue
        regions = [region for region in function["regions"] if region[5] == 0 and region[7] == 0]
        if not regions:
            continue
        lines = lines_of(regions)
        key = (path, regions[0][0], regions[0][2])
        known = found.setdefault(key, (function["name"], {}))[1]
        for line, reached in lines.items():
            known[line] = known.get(line, False) or reached
    names = subprocess.run(
        ["c++filt", "-p"],
        input="\n".join(name.split(":")[-1] for name, _ in found.values()),
        check=True,
        capture_output=True,
        text=True,
    ).stdout.splitlines()
    for ((path, first, last), (_, lines)), name in zip(found.items(), names):
        yield path, re.sub(
            r"^.*::(?=[^:(]*(\{|$|\())", "", name.replace("(anonymous namespace)::", "").replace("[abi:cxx11]", "")
        ), first, last, lines


def lines_of(regions):
    """Is each line of a function reached? Of nested regions the innermost counts."""
    lines = {}
    for begin, _, end, _, count, *_ in sorted(regions, key=lambda region: region[0] - region[2]):
        for line in range(begin, end + 1):
            lines[line] = count > 0
    return lines


def ranges(numbers):
    parts = []
    for number in sorted(numbers):
        if parts and number == parts[-1][1] + 1:
            parts[-1][1] = number
        else:
            parts.append([number, number])
    return ", ".join(f"{first}" if first == last else f"{first}-{last}" for first, last in parts)


def measure(program, target, folder, known):
    """The row of a target and its part of the list of lines that are not reached."""
    profile = folder / f"{target}.profraw"
    count = replay(program, target, folder / "corpus" / target, profile)
    total, missing = collections.Counter(), []
    lines_seen = {}
    for path, name, first, last, lines in sorted(
        functions_of(program, profile, sources_of(target)), key=lambda f: (f[0], f[2], -f[3])
    ):
        if any(fnmatch.fnmatch(path, where) and fnmatch.fnmatch(name, what) for where, what, _ in known):
            continue
        own = {line: reached for line, reached in lines.items() if (path, line) not in lines_seen}
        lines_seen.update({(path, line): reached for line, reached in own.items()})
        total.update(lines=len(own), reached=sum(own.values()))
        if left := [line for line, reached in own.items() if not reached]:
            missing.append(f"| `{path}` | `{name}` | {ranges(left)} | {len(left)} |")
    if not total:
        sys.exit(f"fuzz: the program has no line of the sources of {target}")
    return [total["lines"], total["reached"], f"{100 * total['reached'] / total['lines']:.1f}", count], missing


def main():
    parser = argparse.ArgumentParser(prog="scripts/fuzz --coverage")
    parser.add_argument("--replay", required=True, type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--folder", required=True, type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("targets", nargs="*")
    chosen = parser.parse_args()
    # Its own profile would become a file in the folder that this was called from.
    unprofiled = {**os.environ, "LLVM_PROFILE_FILE": os.devnull}
    usage = subprocess.run([chosen.replay, "--list"], capture_output=True, text=True, check=True, env=unprofiled).stdout
    targets = [line.split("\t")[0] for line in usage.splitlines()]
    known = list(excuses())
    parts = dict(re.findall(r"(?ms)^## (\w+)\n(.*?)(?=^## |\Z)", LEFT.read_text())) if LEFT.exists() else {}
    for target in chosen.targets or targets:
        if not sources_of(target):
            continue
        row, missing = measure(chosen.replay, target, chosen.folder, known)
        fuzz_page.update("lines", target, row)
        parts[target] = "\n| source | function | lines | number |\n|---|---|---|---|\n" + "\n".join(missing) + "\n\n"
        print(f"{target}: {row[1]} of {row[0]} lines, {row[2]} %", file=sys.stderr)
    head = "# Lines of readers that no input of a campaign reaches\n\nGenerated by `scripts/fuzz --coverage`: do not edit.\n\n"
    LEFT.write_text((head + "".join(f"## {name}\n{parts[name]}" for name in sorted(parts))).rstrip() + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
