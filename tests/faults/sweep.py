"""Every system call that can fail is made to fail once, and from then on: nothing partial, the right exit code, no hang.

sweep.py [--all] [--in parent] [--table] [COMMAND...]: all points instead of a few of each call; only calls of the process that was
started, not of its workers; the results of these commands into README.md; only these commands. Prints the points and what was
found. SELVAGE names the program, SELVAGE_FAULTS the library of preload.cpp.
"""

import argparse
import concurrent.futures
import functools
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from program import PROGRAM, ROD

LIBRARY = os.path.abspath(os.environ["SELVAGE_FAULTS"])
CALLS = [
    "write",
    "pwrite",
    "read",
    "pread",
    "fsync",
    "ftruncate",
    "rename",
    "renameat2",
    "linkat",
    "flock",
    "open",
    "mkdir",
    "mmap",
    "memfd_create",
    "fork",
    "pipe2",
    "signalfd",
    "fstat",
    "poll",
    "posix_spawn",
    "pthread_create",
    "dlopen",
]
POINTS = 2  # of one call in one command, without --all
PATIENCE = 120  # seconds; a run takes less than one
README = pathlib.Path(__file__).with_name("README.md")
HEADINGS = {"all": "## All processes\n", "parent": "## The process that was started alone\n"}
OLD = b"what an earlier run wrote\n"

# The outputs, and the rest of the command line; {in} and {out} are folders.
COMMANDS = {
    "convert": (["a.igs", "a.stp"], ["convert", "{in}/a.txt", "--to", "iges,step", "-o", "{out}"]),
    "convert -": ([], ["convert", "{in}/a.txt", "--to", "iges", "-o", "-"]),
    "mesh": (["a.inp"], ["mesh", "{in}/a.txt", "--size", "0.3", "-o", "{out}"]),
    "check": ([], ["check", "{in}/a.txt"]),
    "view": (["a.png"], ["view", "{in}/a.txt", "-o", "{out}/a.png"]),
    "diff": ([], ["diff", "{in}/a.txt", "{in}/b.txt"]),
    "roundtrip": ([], ["roundtrip", "{in}/a.txt"]),
    "edit": (
        ["e.txt"],
        ["edit", "{in}/a.txt", "--yarn", "one", "--point", "2", "--to", "1,0,0.2", "-o", "{out}/e.txt"],
    ),
    "relax": (["a.txt"], ["relax", "{in}/a.txt", "-o", "{out}"]),
}


class Run:
    """One run of a command in folders of its own, with a fault or none."""

    def __init__(self, command, call="", at="0", old=False, within="all"):
        outputs, words = COMMANDS[command]
        folder = pathlib.Path(tempfile.mkdtemp(prefix="selvage-faults-"))
        try:
            # In sight of the program only as relative paths, so that all runs say the same.
            for name in ("in", "out", "tmp"):
                (folder / name).mkdir()
            (folder / "in/a.txt").write_text(ROD.format(title="one", height=0.1))
            (folder / "in/b.txt").write_text(ROD.format(title="other", height=0.15))
            for name in outputs if old else []:
                (folder / "out" / name).write_bytes(OLD)
            self.start(folder, [word.replace("{in}", "in").replace("{out}", "out") for word in words], call, at, within)
            self.files = {path.name: path.read_bytes() for path in (folder / "out").iterdir()}
            self.left = [
                str(path.relative_to(folder))
                for path in folder.rglob("*")
                if path.is_file() and path.parent.name != "out" and path.name not in ("a.txt", "b.txt")
            ]
            self.left += [str(path.relative_to(folder)) for path in (folder / "tmp").iterdir()]
        finally:
            shutil.rmtree(folder)

    def start(self, folder, words, call, at, within):
        page = os.memfd_create("faults", 0)
        try:
            os.ftruncate(page, 4096)
            surroundings = {
                **os.environ,
                "LD_PRELOAD": LIBRARY,
                "FAULT_CALL": call,
                "FAULT_AT": at,
                "FAULT_IN": within,
                "FAULT_PAGE": str(page),
                "TMPDIR": str(folder / "tmp"),
                "SOURCE_DATE_EPOCH": "1700000000",
                "LC_ALL": "C",
            }
            process = subprocess.Popen(
                [PROGRAM, *words, "-j1"] if words[0] != "edit" else [PROGRAM, *words],
                cwd=folder,
                env=surroundings,
                pass_fds=[page],
                start_new_session=True,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
            )
            try:
                self.stdout, self.stderr = process.communicate(timeout=PATIENCE)
                self.hung = False
            except subprocess.TimeoutExpired:
                self.hung = True
                os.killpg(process.pid, signal.SIGKILL)
                self.stdout, self.stderr = process.communicate()
            self.code = process.returncode
            self.calls, self.faults = (int.from_bytes(os.pread(page, 4, offset), sys.byteorder) for offset in (4, 8))
        finally:
            os.close(page)

    def violations(self, whole, old):
        """What is wrong with it, beside the run without a fault."""
        if self.hung:
            return ["it hangs"]
        wrong = []
        if self.code not in {whole.code, 1}:
            wrong.append(f"exit code {self.code}")
        if self.code == whole.code and (self.files != whole.files or self.stdout != whole.stdout):
            wrong.append(f"exit code {self.code}, and not all of its outputs")
        if self.code != whole.code and b"error: " not in self.stderr:
            wrong.append(f"exit code {self.code} without an error message")
        for name, bytes_ in self.files.items():
            if name not in whole.files:
                wrong.append(f"out/{name} is left over")
            elif bytes_ != whole.files[name] and not (old and bytes_ == OLD):
                wrong.append(f"out/{name} is partial")
        if old and len(self.files) < len(whole.files):
            wrong.append("an old output is gone")
        return wrong + [f"{name} is left over" for name in self.left]


@functools.cache
def unharmed(command):
    return Run(command)


def chosen(total, every):
    """The calls that are made to fail: the first and last ones, and some between."""
    if every or total <= POINTS:
        return list(range(1, total + 1))
    return sorted({1 + round(k * (total - 1) / (POINTS - 1)) for k in range(POINTS)})


def sweep(command, call, every, within, pool):
    """The numbers of calls and of faults, and the violations, of this call in this command: once over old outputs, and
    from then on without any."""
    whole = unharmed(command)
    most, faults, found = 0, 0, []
    for old, lasting in ((True, ""), (False, "+")):
        total = Run(command, call, "0", old, within).calls
        most = max(most, total)
        plan = [f"{n}{lasting}" for n in chosen(total, every)]
        runs = list(pool.map(lambda at: Run(command, call, at, old, within), plan))
        # Until one passes without a fault: waiting takes another number of calls every time.
        while not runs or runs[-1].faults:
            plan.append(f"{total + 1}{lasting}")
            total += 1 + total // 4
            runs.append(Run(command, call, plan[-1], old, within))
        faults += sum(run.faults > 0 for run in runs)
        found += [
            f"{command}, {call} {at}{' over old outputs' if old else ''}: {wrong}\n"
            f"    {run.stderr.decode(errors='replace').strip()}"
            for at, run in zip(plan, runs)
            for wrong in run.violations(whole, old)
        ]
    return most, faults, found


def read_table(within):
    """{(command, call): what stands in the table of README.md}."""
    _, _, section = README.read_text().partition(HEADINGS[within])
    rows = [
        [word.strip(" `") for word in line.strip("|").split("|")]
        for line in section.partition("\n#")[0].splitlines()
        if line.startswith("|")
    ]
    return {(command, row[0]): cell for row in rows[2:-1] for command, cell in zip(rows[0][1:], row[1:]) if cell != "-"}


def write_tables(within, swept, cells):
    """Faults by call and command, and after a stroke violations: the rows of the commands that were swept are new."""
    parts = [README.read_text().partition("\n## ")[0].rstrip() + "\n"]
    for part in HEADINGS:
        table = read_table(part)
        if part == within:
            table = {key: cell for key, cell in table.items() if key[0] not in swept} | cells
        if not table:
            continue
        commands = [c for c in COMMANDS if any(c == command for command, _ in table)]
        total = sum(int(cell.partition("/")[0]) for cell in table.values())
        rows = [["", *(f"`{c}`" for c in commands)], ["---", *["--:"] * len(commands)]]
        rows += [
            [f"`{call}`", *(table.get((c, call), "-") for c in commands)]
            for call in CALLS
            if any(k[1] == call for k in table)
        ]
        rows.append(
            [
                "all",
                *(str(sum(int(cell.partition("/")[0]) for k, cell in table.items() if k[0] == c)) for c in commands),
            ]
        )
        parts += [
            f"\n{HEADINGS[part]}\nGenerated by `sweep.py --all{' --in parent' if part == 'parent' else ''} --table`: do not edit. "
            f"{total} faults, by call and command;\nwhere something was wrong afterwards the number of violations stands after a "
            "stroke.\n\n",
            *(f"| {' | '.join(row)} |\n" for row in rows),
        ]
    # What other programs write there stays.
    parts += [
        f"\n## {rest}"
        for rest in README.read_text().split("\n## ")[1:]
        if f"## {rest.partition(chr(10))[0]}\n" not in HEADINGS.values()
    ]
    README.write_text("".join(parts))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--all", action="store_true", help="every point")
    parser.add_argument(
        "--in",
        dest="within",
        choices=["all", "parent"],
        default="all",
        help="calls of all processes, or of the first one alone",
    )
    parser.add_argument("--table", action="store_true", help="write the results into README.md")
    parser.add_argument("--call", action="append", help="only this call")
    parser.add_argument("commands", nargs="*", metavar="COMMAND")
    wanted = parser.parse_args()
    print(f"{'command':10} {'call':15} {'calls':>6} {'faults':>7} {'violations':>11}")
    violations, points, cells = [], 0, {}
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        for command in wanted.commands or COMMANDS:
            for call in wanted.call or CALLS:
                total, faults, found = sweep(command, call, wanted.all, wanted.within, pool)
                if total:
                    cells[command, call] = f"{faults}/{len(found)}" if found else str(faults)
                    print(f"{command:10} {call:15} {total:6} {faults:7} {len(found):11}", flush=True)
                for text in found:
                    print(text, flush=True)
                violations += found
                points += faults
    if wanted.table:
        write_tables(wanted.within, wanted.commands or list(COMMANDS), cells)
    print(f"{points} faults, {len(violations)} violations")
    return 1 if violations or points == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
