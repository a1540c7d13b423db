"""Many inputs: each in its own process, so that one that crashes, hangs or eats memory costs only itself."""

import os
import pathlib
import resource
import shutil
import signal
import time
import unittest

from program import Case, GRID, RING, SAMPLES, children_of, environment, files_below, run, seconds_of, start


class Isolation(Case):
    def setUp(self):
        super().setUp()
        self.stuck = self.silent_pipe("stuck.txt")

    def silent_pipe(self, name):
        """An input that never comes: a pipe with a writer, this process, that writes nothing."""
        pipe = self.folder / name
        os.mkfifo(pipe)
        self.addCleanup(os.close, os.open(pipe, os.O_RDWR))
        return pipe

    def wait_for_children(self, process, count):
        while len(children_of(process.pid)) < count:
            self.assertIsNone(process.poll(), "ended too early")
            time.sleep(0.01)
        return children_of(process.pid)

    def wait_for(self, path):
        while not path.exists():
            time.sleep(0.01)

    def test_a_hanging_input_is_stopped(self):
        message = self.fails(1, "convert", self.stuck, GRID, "--to", "iges", "-o", self.out, "--timeout", "0.5")
        self.assertIn(f"{self.stuck}: error: this input was stopped: not done within its 0.5 s; --timeout gives it more", message)
        self.assertEqual(list(files_below(self.out)), ["plain4_grid.igs"])

    def test_a_crash_costs_one_input(self):
        for number, words in ((signal.SIGSEGV, "crashed: Segmentation fault"), (signal.SIGKILL, "ran out of memory")):
            shutil.rmtree(self.out, ignore_errors=True)
            process = start("convert", self.stuck, GRID, RING, "--to", "iges", "-o", self.out, "-j", 1)
            os.kill(self.wait_for_children(process, 1)[0], number)
            _, message = process.communicate()
            self.assertEqual(process.returncode, 1, message)
            self.assertRegex(message, f"(?m)^{self.stuck}: error: this input .*{words}")
            self.assertEqual(sorted(files_below(self.out)), ["plain4_grid.igs", "ring.igs"])

    def test_texts_have_a_time_limit_of_their_own(self):
        """The signal of the limit comes from here: nobody waits ten minutes for it."""
        process = start("mesh", SAMPLES / "cell_twill.txt", "--matrix", "--size", "0.02", "-o", self.folder / "x.inp", "--quiet")
        self.addCleanup(process.kill)
        worker, = self.wait_for_children(process, 1)
        while seconds_of(worker) < 0.5:
            self.assertIsNone(process.poll(), "ended too early")
            time.sleep(0.01)
        os.kill(worker, signal.SIGALRM)
        _, message = process.communicate()
        self.assertEqual(process.returncode, 1)
        self.assertIn("cell_twill.txt: error: this input was stopped: not done within its 600 s; --timeout gives it more", message)
        self.assertIn("(default: 600 for texts, 300 for formats of other programs)", " ".join(run("mesh", "--help").stdout.split()))

    def test_few_descriptors(self):
        """Where the system has none left, that is said, and not that something is forbidden."""
        ends = set()
        for count in range(3, 16):
            def limit(count=count):
                resource.setrlimit(resource.RLIMIT_NOFILE, (count, count))
            done = run("info", RING, preexec_fn=limit)
            ends.add(done.returncode)
            self.assertNotIn("denied", done.stderr, count)
            if done.returncode != 0 and count > 4:
                self.assertIn("Too many open files", done.stderr, count)
        self.assertIn(0, ends)
        self.assertGreater(len(ends), 1)

    def test_memory_is_limited(self):
        large = self.folder / "large.txt"
        rows = "\n".join(f"{i} 0 0" for i in range(200000))
        large.write_text(f"fabric 1\nthread t\n diameter 0.5\nend\nyarn y t\n path\n{rows}\n end\nend\n")
        message = self.fails(1, "convert", large, GRID, "--to", "iges", "-o", self.out, "--memory", "60")
        self.assertRegex(message, f"(?m)^{large}: error: needs more memory than the 60 MB of --memory")
        self.assertEqual(list(files_below(self.out)), ["plain4_grid.igs"])

    def test_memory_is_limited_in_modules_too(self):
        message = self.fails(1, "check", GRID, "--memory", "60")
        self.assertRegex(message, f"(?m)^{GRID}: error: ")

    def test_memory_that_ends_in_a_library(self):
        """The exception of a module cannot pass into the program, which says what helps all the same."""
        wide = self.folder / "wide.txt"
        wide.write_text("fabric 1\nthread a\n diameter 0.4\nend\n"
                        "warpknit\n bar a 1-0/9999-9998\n wales 3 pitch 3\n courses 4 pitch 5\nend\n")
        message = self.fails(1, "check", wide, "--memory", "2000")
        self.assertRegex(message, f"(?m)^{wide}: error: .*needs more memory than the 2000 MB .*--memory")

    def test_interrupts(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(number.name):
                shutil.rmtree(self.out, ignore_errors=True)
                process = start("convert", GRID, self.stuck, "--to", "iges", "-o", self.out, "-j", 2)
                self.wait_for(self.out / "plain4_grid.igs")
                child = self.wait_for_children(process, 1)
                process.send_signal(number)
                _, message = process.communicate()
                self.assertEqual(process.returncode, 130, message)
                self.assertIn("interrupted", message)
                self.assertEqual(list(files_below(self.out)), ["plain4_grid.igs"])
                for pid in child:
                    self.assertFalse(pathlib.Path(f"/proc/{pid}").exists(), "a child outlived the program")

    def test_children_die_with_a_killed_parent(self):
        process = start("convert", self.stuck, "-o", self.out)
        child = self.wait_for_children(process, 1)[0]
        process.kill()
        process.communicate()
        while pathlib.Path(f"/proc/{child}/stat").exists():
            state = pathlib.Path(f"/proc/{child}/stat").read_text().split(")")[1].split()[0]
            if state == "Z":
                break
            time.sleep(0.01)

    def test_workers_run_at_once(self):
        pipes = []
        for i in range(3):
            pipe = self.folder / f"p{i}.txt"
            os.mkfifo(pipe)
            pipes.append(pipe)
        process = start("convert", *pipes, "--to", "iges", "-o", self.out, "-j", 3)
        self.assertEqual(len(self.wait_for_children(process, 3)), 3)
        text = pathlib.Path(RING).read_bytes()
        for pipe in reversed(pipes):
            pipe.write_bytes(text)
        _, message = process.communicate()
        self.assertEqual(process.returncode, 0, message)
        self.assertEqual(sorted(files_below(self.out)), ["p0.igs", "p1.igs", "p2.igs"])


class Speech(Case):
    def test_results_stand_in_the_order_of_the_inputs(self):
        inputs = []
        for i in range(12):
            inputs.append(self.folder / f"f{i}.txt")
            shutil.copy(RING if i % 2 else GRID, inputs[-1])
        done = self.succeeds("info", *inputs, "-j", 8)
        self.assertEqual([line for line in done.stdout.splitlines() if line.startswith("/")], [str(path) for path in inputs])

    def test_quiet(self):
        self.assertEqual(self.succeeds("convert", GRID, "-o", self.folder / "x.igs", "--quiet").stderr, "")
        self.assertIn("error:", self.fails(1, "convert", "nowhere.txt", "-o", self.folder / "y.igs", "--quiet"))

    def test_verbose_names_what_was_written(self):
        message = self.succeeds("convert", GRID, "-o", self.folder / "x.igs", "-v").stderr
        self.assertRegex(message, rf"note: wrote '{self.folder}/x.igs', \d+ bytes")

    def test_no_control_characters_where_there_is_no_terminal(self):
        message = self.succeeds("convert", GRID, RING, "--to", "iges", "-o", self.out).stderr
        self.assertNotIn("\r", message)
        self.assertEqual(message, f"selvage: 2 of 2 inputs done; 2 files written to '{self.out}'\n")


if __name__ == "__main__":
    unittest.main()
