"""Workers that turn against the user are stopped, and the run goes on; the limits that nobody asked for.

test_sandbox.py --table writes the table of hostile actions into README.md.
"""

import ctypes
import errno
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
from program import Case, GRID, PROGRAM, RING, children_of, environment, files_below, run, terminal

TRAITOR = os.path.abspath(os.environ["SELVAGE_TRAITOR"])
README = pathlib.Path(__file__).with_name("README.md")
HEADING = "## Hostile actions\n"
NOBODY = 65534
# Landlock refuses by EACCES. The filter of calls refuses by EPERM, or by ENOSYS where the C library has another way.
REFUSALS = {errno.EACCES: "Landlock", errno.EPERM: "filter of calls", errno.ENOSYS: "filter of calls"}


def has_landlock():
    return ctypes.CDLL(None).syscall(444, None, ctypes.c_size_t(0), 1) > 0


def is_almighty():
    """May this process do all that the system has for its administrator? (In a container it may not.)"""
    status = dict(
        line.split(":\t") for line in pathlib.Path("/proc/self/status").read_text().splitlines() if ":\t" in line
    )
    last = int(pathlib.Path("/proc/sys/kernel/cap_last_cap").read_text())
    return int(status["CapEff"], 16) == (1 << last + 1) - 1 and status.get("Seccomp") == "0"


def is_there(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except (FileNotFoundError, ProcessLookupError):
        return False


def descendants_of(pid):
    children = children_of(pid)
    return children + [further for child in children for further in descendants_of(child)]


@unittest.skipUnless(has_landlock(), "THIS KERNEL HAS NO LANDLOCK: nothing of the containment was tested")
class Traitor(Case):
    """A batch of three, the second of which is the traitor's."""

    def setUp(self):
        super().setUp()
        # Where another user finds what he runs and works with.
        self.folder.chmod(0o755)
        self.inside, self.elsewhere = self.folder / "in", self.folder / "elsewhere"
        programs = self.folder / "programs"
        programs.mkdir()
        self.program, self.traitor = (str(shutil.copy(path, programs)) for path in (PROGRAM, TRAITOR))

    def prepare(self, deed, user=None):
        for folder in (self.inside, self.elsewhere, self.out):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
        for name in ("file", "old", "gone"):
            (self.elsewhere / name).write_text("as it was")
        (self.elsewhere / "empty").mkdir()
        for name in ("a.txt", "traitor.txt", "z.txt"):
            shutil.copy(GRID, self.inside / name)
        if user is not None:
            for path in (self.folder, *self.folder.rglob("*")):
                os.chown(path, user, user)
        self.environment = environment(
            LD_PRELOAD=self.traitor, TRAITOR=str(self.elsewhere), TRAITOR_OUT=str(self.out), TRAITOR_DEED=deed
        )

    def words(self, sandbox, *more):
        return [
            self.program,
            "convert",
            str(self.inside),
            "--to",
            "iges",
            "-o",
            str(self.out),
            "-j",
            "1",
            "--sandbox",
            sandbox,
            *more,
        ]

    def betrayed(self, deed, sandbox, *more, user=None):
        self.prepare(deed, user)
        other = {} if user is None else {"user": user, "group": user, "extra_groups": []}
        return subprocess.run(
            self.words(sandbox, *more),
            env=self.environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=600,
            **other,
        )

    def all_written(self, done):
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(files_below(self.out)), ["a.igs", "traitor.igs", "z.igs"])

    def others_written(self, done):
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(sorted(files_below(self.out)), ["a.igs", "z.igs"])

    def begin(self, deed, sandbox="require", **options):
        """Starts a run, and waits until the traitor's deed has begun."""
        self.prepare(deed)
        process = subprocess.Popen(
            self.words(sandbox),
            env=self.environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            **options,
        )
        self.addCleanup(process.stderr.close)
        return process, process.stderr.readline()

    def gone(self, processes):
        """A signal may need a moment to arrive; the test's own time limit is the only one."""
        while any(map(is_there, processes)):
            time.sleep(0.001)


class Actions(Traitor):
    def actions(self, sandbox, user=None):
        """What came of each: {name: (who may do it, errno)}."""
        done = self.betrayed("actions", sandbox, user=user)
        if sandbox == "off":
            # Where they succeed, some of them change the input itself.
            self.others_written(done)
            self.assertIn("changed while it was read", done.stderr)
        else:
            self.all_written(done)
        found = re.findall(r"^traitor: (\w+): (.*): (\d+)$", done.stderr, re.MULTILINE)
        self.assertGreater(len(found), 60)
        return {name: (who, int(number)) for who, name, number in found}

    def users(self):
        return [None, NOBODY] if os.getuid() == 0 else [None]

    def test_none_succeeds(self):
        for user in self.users():
            with self.subTest(user=user):
                before = {"file": b"as it was", "old": b"as it was", "gone": b"as it was"}
                actions = self.actions("require", user)
                self.assertEqual({name: number for name, (_, number) in actions.items() if number not in REFUSALS}, {})
                self.assertEqual(files_below(self.elsewhere), before)
                self.assertEqual(self.table(actions), self.table(self.actions("require")), "the same for every user")

    def test_each_reaches_the_system_elsewhere(self):
        for user in self.users():
            with self.subTest(user=user):
                inside, outside = self.actions("require", user), self.actions("off", user)
                everything = user is None and is_almighty()
                same = {
                    name
                    for name, (who, number) in inside.items()
                    if outside[name][1] == number and (everything or who == "anybody")
                }
                # What this kernel was built without answers ENOSYS to everybody.
                without = {name for name in same if outside[name][1] == errno.ENOSYS}
                self.assertEqual(same - without, set())
                self.assertLess(len(without), len(inside) / 4)
                self.assertGreater(sum(number == 0 for _, number in outside.values()), 60)

    @staticmethod
    def table(actions):
        rows = [
            "| action | refused by | as |",
            "| --- | --- | --- |",
            *(
                f"| {name} | {REFUSALS.get(number, 'NOTHING')} | {errno.errorcode.get(number, number)} |"
                for name, (_, number) in actions.items()
            ),
        ]
        return "".join(f"{row}\n" for row in rows)

    def page(self):
        actions = self.actions("require")
        refused = sum(number in REFUSALS for _, number in actions.values())
        return (
            f"{HEADING}\nGenerated by `test_sandbox.py --table`: do not edit. Of {len(actions)} hostile actions of a worker under "
            f"`--sandbox require`\n{len(actions) - refused} succeed, whoever runs it.\n\n{self.table(actions)}"
        )

    def test_table(self):
        _, _, section = README.read_text().partition(HEADING)
        self.assertEqual(HEADING + section.partition("\n## ")[0].rstrip("\n") + "\n", self.page())

    def test_calls_of_another_processor_end_the_worker(self):
        done = self.betrayed("foreign", "require")
        self.others_written(done)


class Processes(Traitor):
    def test_no_process_outlives_the_run(self):
        done = self.betrayed("daemon", "require", "--timeout", "60")
        self.all_written(done)
        self.assertNotIn("daemon", done.stderr)

    def test_a_daemon_is_what_the_test_makes(self):
        done = self.betrayed("daemon", "off")
        daemon = int(re.search("traitor: daemon (\\d+)", done.stderr)[1])
        self.assertTrue(is_there(daemon))
        os.kill(daemon, signal.SIGKILL)

    def test_timeout(self):
        done = self.betrayed("hang", "require", "--timeout", "1")
        self.others_written(done)
        self.assertIn("was stopped: not done within its 1 s", done.stderr)

    def test_signals_to_the_group_interrupt_the_run(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number.name):
                process, line = self.begin("hang", start_new_session=True)
                self.assertEqual(line, "traitor: hangs\n")
                workers = descendants_of(process.pid)
                self.assertEqual(len(workers), 1)
                os.killpg(process.pid, number)
                rest = process.stderr.read()
                self.assertEqual(process.wait(), 130, rest)
                self.assertEqual(rest, "selvage: interrupted; the inputs that were not done have no new outputs\n")
                self.gone(workers)

    def test_nothing_is_left_of_a_killed_run(self):
        process, line = self.begin("hang")
        self.assertEqual(line, "traitor: hangs\n")
        workers = descendants_of(process.pid)
        process.kill()
        self.assertEqual(process.wait(), -signal.SIGKILL)
        self.gone(workers)

    def test_nothing_is_left_of_a_killed_mesher(self):
        self.prepare("hang")
        process = subprocess.Popen(
            [PROGRAM, "mesh", self.inside / "traitor.txt", "--size", "0.5", "-o", self.out, "--sandbox", "require"],
            env={**self.environment, "LD_PRELOAD": TRAITOR},
            stdin=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(process.stderr.close)
        self.assertEqual(process.stderr.readline(), "traitor: hangs\n")
        workers = descendants_of(process.pid)
        self.assertEqual(len(workers), 2, "the worker, and what would start TetGen for it")
        process.kill()
        process.wait()
        self.gone(workers)

    def test_a_flood_does_not_fill_the_parent(self):
        for deed in ("flood", "packets"):
            with self.subTest(deed):
                self.prepare(deed)
                with open(self.folder / "messages", "w+") as messages:
                    process = subprocess.Popen(
                        self.words("require"),
                        env=self.environment,
                        stdin=subprocess.DEVNULL,
                        stdout=subprocess.DEVNULL,
                        stderr=messages,
                    )
                    _, status, used = os.wait4(process.pid, 0)
                    process.returncode = os.waitstatus_to_exitcode(status)
                    messages.seek(0)
                    self.assertIn("was stopped: its results take more than 128 MB", messages.read())
                self.assertEqual(process.returncode, 1)
                self.assertLessEqual({"a.igs", "z.igs"}, set(files_below(self.out)), "the others")
                self.assertLess(used.ru_maxrss / 1024, 400, "MB, of the parent and its workers")


class Streams(Traitor):
    def on_terminal(self, typed, *words, deed="streams"):
        """Runs with a terminal as all three standard streams; gives the exit code and what it shows."""
        self.prepare(deed)
        master, slave = terminal()
        self.addCleanup(os.close, master)
        shown = []

        def read():
            try:
                while block := os.read(master, 65536):
                    shown.append(block)
            except OSError:  # the other side has closed
                pass

        process = subprocess.Popen(
            [self.program, *map(str, words)],
            env=self.environment,
            stdin=slave,
            stdout=slave,
            stderr=slave,
            start_new_session=True,
        )
        os.close(slave)
        reader = threading.Thread(target=read)
        reader.start()
        os.write(master, typed)
        process.wait()
        reader.join()
        return process.returncode, b"".join(shown).decode(errors="replace").replace("\r\n", "\n")

    def test_no_stream_is_the_terminal(self):
        code, shown = self.on_terminal(
            b"", "convert", self.inside / "traitor.txt", "--to", "iges", "-o", "-", "--no-progress"
        )
        self.assertEqual(code, 0, shown)
        self.assertEqual(re.findall("traitor: (.*)", shown), ["stream 0 other", "stream 1 other", "stream 2 other"])
        whole = run("convert", self.inside / "traitor.txt", "--to", "iges", "-o", "-", "--quiet").stdout
        self.assertGreater(len(whole), 10_000)
        self.assertIn(whole, shown)

    def test_what_is_typed_is_read(self):
        text = pathlib.Path(RING).read_bytes()
        code, shown = self.on_terminal(text + b"\4", "info", "-", "--no-progress", deed="")
        self.assertEqual(code, 0, shown)
        self.assertIn("yarn  role", shown)

    def test_last_words_do_not_steer_the_terminal(self):
        code, shown = self.on_terminal(
            b"", "convert", self.inside / "traitor.txt", "--to", "iges", "-o", self.out, "--no-progress", deed="escape"
        )
        self.assertEqual(code, 0, shown)
        self.assertIn("traitor: ?[31m", shown)

    def test_output_files_keep_their_permissions(self):
        for mode in (0o600, 0o640, 0o666, 0o755):
            (self.out / "a.igs").parent.mkdir(exist_ok=True)
            (self.out / "a.igs").write_text("old")
            (self.out / "a.igs").chmod(mode)
            self.succeeds(
                "convert", GRID, "--to", "iges", "-o", self.out / "a.igs", "--sandbox", "require", umask=0o027
            )
            self.assertEqual((self.out / "a.igs").stat().st_mode & 0o777, mode)
        self.succeeds("convert", GRID, "--to", "iges", "-o", self.out / "new.igs", "--sandbox", "require", umask=0o027)
        self.assertEqual((self.out / "new.igs").stat().st_mode & 0o777, 0o640)

    def test_every_format_goes_to_standard_output(self):
        for form in ("txt", "iges", "step", "stl", "ply", "gltf", "svg", "dxf", "vtp", "csv"):
            with self.subTest(form):
                self.succeeds(
                    "convert",
                    GRID,
                    "--to",
                    form,
                    "--file-name",
                    "x",
                    "-o",
                    f"{self.out}/{form}/",
                    "--sandbox",
                    "require",
                    *(["--lines"] if form in ("svg", "dxf", "vtp", "csv") else []),
                )
                [written] = files_below(self.out / form).values()
                done = subprocess.run(
                    [
                        PROGRAM,
                        "convert",
                        GRID,
                        "--to",
                        form,
                        "--file-name",
                        "x",
                        "-o",
                        "-",
                        "--quiet",
                        "--sandbox",
                        "require",
                        *(["--lines"] if form in ("svg", "dxf", "vtp", "csv") else []),
                    ],
                    env=environment(),
                    capture_output=True,
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(done.stdout, written)


class Option(Case):
    def test_require(self):
        done = run("check", RING, "--sandbox", "require")
        if has_landlock():
            self.assertEqual(done.returncode, 0, done.stderr)
        else:
            self.assertEqual(done.returncode, 2)
            self.assertIn("this kernel has no Landlock", done.stderr)

    def test_words(self):
        self.assertIn("--sandbox", self.fails(2, "check", RING, "--sandbox", "maybe"))

    def test_every_command_lives_within_it(self):
        out = self.out
        for words in (
            ["convert", GRID, "-o", out],
            ["convert", GRID, "--to", "iges", "-o", "-"],
            ["check", GRID, "--report", out / "r/report.json", "--gap-map", out / "maps/gaps.vtu"],
            ["mesh", RING, "--size", "0.5", "-o", out],
            ["view", GRID, "-o", out / "pictures/a.png"],
            ["roundtrip", GRID],
            ["diff", GRID, GRID],
            ["info", GRID],
            ["relax", GRID, "-o", out / "relaxed/"],
            ["edit", RING, "--yarn", "ring", "--point", "1", "--to", "5.1,0,0", "-o", out / "edited/e.txt"],
        ):
            with self.subTest(words[0]):
                self.succeeds(*words, "--sandbox", "require" if has_landlock() else "auto")

    def test_links_lead_where_they_lead(self):
        (self.folder / "away").mkdir()
        shutil.copy(GRID, self.folder / "away/a.txt")
        (self.folder / "in").mkdir()
        (self.folder / "in/link.txt").symlink_to("../away/a.txt")
        (self.folder / "linked").symlink_to("away")
        self.succeeds("convert", self.folder / "in/link.txt", "--to", "iges", "-o", f"{self.folder}/linked/")
        self.assertTrue((self.folder / "away/link.igs").exists())

    def test_help_tells_the_limits(self):
        for command in ("convert", "check", "mesh", "diff", "edit"):
            words = " ".join(self.succeeds(command, "--help").stdout.split())
            for limit in (
                "default: 600 for texts, 300 for formats of other programs",
                "shared by the inputs worked on at once",
                "--sandbox",
            ):
                self.assertIn(limit, words)


def write_table():
    case = Actions("page")
    case.setUp()
    try:
        before, _, section = README.read_text().partition(HEADING)
        _, mark, after = section.partition("\n## ")
        README.write_text(f"{before.rstrip()}\n\n{case.page()}{mark}{after}")
    finally:
        case.doCleanups()


if __name__ == "__main__":
    if "--table" in sys.argv:
        write_table()
    else:
        unittest.main()
