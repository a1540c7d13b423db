"""Runs the benchmark programs and whole processes of selvage, and writes their figures as tables. Called by scripts/bench."""

import argparse
import datetime
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
GRID = ROOT / "samples" / "plain4_grid.txt"

# What a whole process is compared with: nothing but its version.
VERSION_PROGRAM = '#include <iostream>\nint main() { std::cout << "version 0.1.0\\n"; }\n'


def seconds(command):
    """Wall time of one process from start to end, its output thrown away."""
    quiet = [(os.POSIX_SPAWN_OPEN, 1, "/dev/null", os.O_WRONLY, 0)]
    begin = time.perf_counter()
    pid = os.posix_spawn(command[0], command, os.environ, file_actions=quiet)
    status = os.waitpid(pid, 0)[1]
    took = time.perf_counter() - begin
    if status != 0:
        sys.exit(f"failed: {command}")
    return took


def interleaved(commands, repeats):
    """Times of each command, taken in turns so that a busy moment of the machine hits all alike."""
    times = [[] for _ in commands]
    for _ in range(repeats):
        for command, list_ in zip(commands, times):
            list_.append(seconds(command))
    return times


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def iges_write(bin_folder, folder, quick):
    command = [f"{bin_folder}/iges_write", "--folder", folder] + (["--repeats", "3", "--yarns", "8,64"] if quick else [])
    rows = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["rows"]
    number = lambda row, key, form: format(row[key], form) if key in row else ""
    return table(
        ["writer", "yarns", "ms", "MB/s", "yarns/s", "million doubles/s", "memory, MiB", "times the bare loop's time", "times OpenCASCADE's speed"],
        [[row["writer"], str(row["yarns"]), f"{1e3 * row['seconds']:.2f}", f"{row['mb_per_s']:.0f}", f"{row['yarns_per_s']:.0f}",
          f"{row['doubles_per_s'] / 1e6:.1f}", f"{row['peak_rss_growth_mib']:.1f}", number(row, "time_to_bare_loop", ".2f"),
          number(row, "times_occt", ".0f")] for row in rows])


def whole_process(bin_folder, folder, quick):
    source, program = f"{folder}/version.cpp", f"{folder}/version"
    pathlib.Path(source).write_text(VERSION_PROGRAM)
    subprocess.run(["c++", "-O2", source, "-o", program], check=True)
    selvage = f"{bin_folder}/selvage"
    commands = [[program], [selvage, "--version"],
                [selvage, "convert", str(GRID), "-o", f"{folder}/x.igs", "--quiet"],
                [selvage, "convert", str(GRID), "-o", f"{folder}/x.stp", "--quiet"]]
    names = ["a C++ program that prints its version", "selvage --version", "plain4_grid.txt to IGES", "plain4_grid.txt to STEP"]
    times = interleaved(commands, 30 if quick else 300)
    least = statistics.median(times[0])
    return table(["process", "median, ms", "fastest, ms", "times the first"],
                 [[name, f"{1e3 * statistics.median(t):.2f}", f"{1e3 * min(t):.2f}", f"{statistics.median(t) / least:.1f}"]
                  for name, t in zip(names, times)])


def many_yarns(path, count):
    """A fabric of `count` yarns: the first grid of the sample, moved along y."""
    lines = GRID.read_text().splitlines()
    begin = next(i for i, line in enumerate(lines) if line.startswith("yarn "))
    head = lines[:begin]
    block = lines[begin:]
    first = next(i for i, line in enumerate(block) if line.split()[:1] == ["grid"])
    size = [int(word) for word in block[first].split()[1:3]]
    rows = [[float(x) for x in line.split("#")[0].split()] for line in block[first + 1:] if line.strip()[:1] in set("-.0123456789")]
    rows = rows[:size[0] * size[1]]
    thread = block[0].split()[2]
    with open(path, "w") as out:
        out.write("\n".join(head) + "\n")
        for k in range(count):
            out.write(f"yarn y{k} {thread}\n  grid {size[0]} {size[1]}\n")
            out.writelines(f"    {x!r} {y + 2.0 * k!r} {z!r}\n" for x, y, z in rows)
            out.write("  end\nend\n")


def step_is_linear(bin_folder, folder, quick):
    rows = []
    for count in (64, 512) if quick else (64, 512, 2048):
        path = f"{folder}/many.txt"
        many_yarns(path, count)
        took = min(seconds([f"{bin_folder}/selvage", "convert", path, "-o", f"{folder}/many.stp", "--quiet", "--no-progress"])
                   for _ in range(3))
        size = os.path.getsize(f"{folder}/many.stp")
        rows.append([str(count), f"{took:.2f}", f"{1e3 * took / count:.2f}", f"{size / 1e6:.1f}"])
    return table(["yarns", "s", "ms a yarn", "MB"], rows)


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "unknown")
    return f"{model}, {os.cpu_count()} cores"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--quick", action="store_true", help="fewer repeats and sizes")
    given = parser.parse_args()
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    with tempfile.TemporaryDirectory(prefix="selvage-bench-") as folder:
        text = (
            f"# Benchmarks\n\nGenerated by `scripts/bench`{' --quick' if given.quick else ''} on {datetime.date.today()}, commit "
            f"{commit or 'unknown'}, {machine()}.\n\n"
            "## Writing IGES: yarns of 18 x 16 control points, three surfaces each\n\n"
            "The bare loop sends the same values through `to_chars` and the same buffered write; OpenCASCADE writes about ten "
            "digits, selvage all of them.\n\n" + iges_write(given.bin, folder, given.quick) +
            "\n## Whole processes\n\n" + whole_process(given.bin, folder, given.quick) +
            "\n## STEP, text to file: the time a yarn stays the same\n\n" + step_is_linear(given.bin, folder, given.quick))
    pathlib.Path(given.out).write_text(text)
    print(text)


if __name__ == "__main__":
    main()
