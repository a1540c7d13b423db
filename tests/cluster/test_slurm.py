"""scripts/cluster/selvage-slurm against a real Slurm of four nodes on this machine (slurm_cluster.py).

Takes minutes, and needs `scripts/setup cluster`: it runs every night, and by hand:
  SELVAGE=build/bin/selvage python3 tests/cluster/test_slurm.py
Run by root, as in a container, it becomes nobody first: nothing of it needs a privilege.
"""

import json
import os
import pathlib
import pwd
import re
import signal
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
if os.geteuid() == 0:
    NOBODY = pwd.getpwnam("nobody")
    os.setgroups([])
    os.setgid(NOBODY.pw_gid)
    os.setuid(NOBODY.pw_uid)
    os.environ["HOME"] = "/nonexistent"

from program import PROGRAM, ROD, ROOT, Case, environment, files_below, run
from slurm_cluster import SlurmCluster, wait_for

DRIVER = ROOT / "scripts" / "cluster" / "selvage-slurm"


def put_rods(folder, count):
    folder.mkdir()
    for k in range(count):
        (folder / f"rod{k:04}.txt").write_text(ROD.format(title=f"rod {k}", height=1 + k / 1000))


def without_times(report):
    """What two runs of the same inputs have in common."""
    kept = {key: value for key, value in report.items() if key not in ("started", "seconds")}
    kept["inputs"] = [{key: value for key, value in entry.items() if key != "seconds"} for entry in report["inputs"]]
    return kept


class Slurm(Case):
    def setUp(self):
        super().setUp()
        self.cluster = SlurmCluster(self.folder / "slurm", 4)
        self.addCleanup(self.cluster.stop)
        self.cluster.start()

    def start(self, *arguments, **more):
        return subprocess.Popen(
            [DRIVER, "in", "-o", "out", "--selvage", PROGRAM, *arguments],
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            env=environment(**more),
            start_new_session=True,
        )

    def drive(self, code, *arguments, **more):
        running = self.start(*arguments, **more)
        self.addCleanup(running.kill)
        told = running.communicate(timeout=600)[1]
        self.assertEqual(running.returncode, code, told)
        return told

    def report(self):
        return json.loads((self.folder / "out" / "report.json").read_text())

    def assert_as_on_one_machine(self):
        """Every file's bytes, and the report but for its times."""
        done = run("convert", "in", "-o", "one", "--to", "iges", "--report", "one.json", cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        ours = {
            name: data
            for name, data in files_below(self.folder / "out").items()
            if name != "report.json" and not name.startswith(".slurm")
        }
        self.assertEqual(ours, files_below(self.folder / "one"))
        alone = json.loads((self.folder / "one.json").read_text().replace('"one/', '"out/'))
        self.assertEqual(without_times(self.report()), without_times(alone))

    def queued(self):
        return self.cluster.asked("squeue", "-h", "-t", "PENDING,RUNNING", "-o", "%i").split()

    def test_a_thousand_inputs_and_a_lost_node(self):
        put_rods(self.folder / "in", 1000)
        running = self.start("--per-job", "25", "--", "--to", "iges")
        self.addCleanup(running.kill)
        ended = self.folder / "out" / ".slurm" / "ended"
        wait_for(lambda: ended.is_dir() and len(list(ended.iterdir())) >= 8, "some shards ended")
        wait_for(lambda: len(self.cluster.processes_on("node2")) > 1, "a job runs on the node that will be lost")
        self.assertTrue(self.cluster.lose_node("node2"))
        self.assertLess(
            len(list(ended.iterdir())), 36, "most is done already; the node was lost too late to prove something"
        )
        told = running.communicate(timeout=600)[1]
        self.assertEqual(running.returncode, 0, told)
        self.assertRegex(told, r"shard \d+ \(job \d+_\d+ on node2\): lost \(NODE_FAIL\); it is done again elsewhere")
        self.assertEqual(self.report()["counts"], {"inputs": 1000, "done": 1000, "failed": 0, "skipped": 0})
        self.assert_as_on_one_machine()

    def test_an_interrupt_cancels_and_a_second_call_goes_on(self):
        put_rods(self.folder / "in", 80)
        running = self.start("--per-job", "4", "--at-once", "2", "--", "--to", "iges")
        self.addCleanup(running.kill)
        ended = self.folder / "out" / ".slurm" / "ended"
        wait_for(lambda: ended.is_dir() and len(list(ended.iterdir())) >= 3, "some shards ended")
        os.killpg(running.pid, signal.SIGINT)
        told = running.communicate(timeout=60)[1]
        self.assertEqual(running.returncode, 130, told)
        self.assertRegex(told, r"cancelled \d+ jobs; the same call again goes on")
        wait_for(lambda: not self.queued(), "nothing of it is queued")
        before = len(list(ended.iterdir()))
        told = self.drive(0, "--", "--to", "iges")
        fresh = int(re.search(r"job \d+: (\d+) of 20 shards", told)[1])
        self.assertLess(fresh, 20 - 2, f"{before} had ended")
        self.assertEqual(self.report()["counts"]["inputs"], 80)
        self.assertNotIn("job ", self.drive(0, "--", "--to", "iges"), "there is nothing left to do")

    def test_a_driver_that_was_killed_finds_its_jobs_again(self):
        put_rods(self.folder / "in", 80)
        running = self.start("--per-job", "4", "--at-once", "1", "--", "--to", "iges")
        ended = self.folder / "out" / ".slurm" / "ended"
        wait_for(lambda: ended.is_dir() and len(list(ended.iterdir())) >= 2, "some shards ended")
        running.kill()
        running.communicate()
        told = self.drive(0, "--", "--to", "iges")
        self.assertRegex(told, r"\d+ jobs of an earlier call still run; waiting for them")
        self.assertNotRegex(told, r"job \d+: \d+ of 20 shards")
        self.assertEqual(self.report()["counts"]["done"], 80)

    def test_another_list_is_refused_and_split_anew_on_request(self):
        put_rods(self.folder / "in", 12)
        self.drive(0, "--per-job", "4", "--", "--to", "iges")
        (self.folder / "in" / "more.txt").write_text(ROD.format(title="more", height=2))
        told = self.drive(2, "--per-job", "4", "--", "--to", "iges")
        self.assertIn("the list of inputs is not the one that was split before: 1 new (in/more.txt)", told)
        self.assertIn("--afresh", told)
        self.drive(0, "--afresh", "--per-job", "4", "--", "--to", "iges")
        self.assertEqual(self.report()["counts"], {"inputs": 13, "done": 1, "failed": 0, "skipped": 12})

    def test_an_input_that_fails_is_tried_twice_and_costs_nothing_else(self):
        put_rods(self.folder / "in", 12)
        (self.folder / "in" / "rod0005.txt").write_text("fabric 1\nyarn\n")
        told = self.drive(1, "--per-job", "4", "--", "--to", "iges")
        self.assertEqual(told.count("once more"), 1, told)
        self.assertRegex(told, r"shard 1 \(job .* on node\d\): ended with 1; see .*/logs/1\.\d+\.txt")
        report = self.report()
        self.assertEqual(report["counts"], {"inputs": 12, "done": 11, "failed": 1, "skipped": 0})
        self.assertEqual([entry["path"] for entry in report["inputs"] if not entry["ok"]], ["in/rod0005.txt"])

    def test_a_change_of_one_input_is_done_again(self):
        put_rods(self.folder / "in", 8)
        self.drive(0, "--per-job", "4", "--", "--to", "iges")
        (self.folder / "in" / "rod0003.txt").write_text(ROD.format(title="other", height=3))
        self.drive(0, "--", "--to", "iges")
        self.assertEqual(self.report()["counts"], {"inputs": 8, "done": 1, "failed": 0, "skipped": 7})

    def test_shards_are_as_long_as_was_measured(self):
        put_rods(self.folder / "in", 8)
        told = self.drive(0, "--", "--to", "iges")
        self.assertRegex(told, r"an input takes about .* s: \d+ inputs a job")
        self.assertIn("1 of 1 shards ended", told)
        self.assert_as_on_one_machine()

    def test_options_of_selvage_are_refused_before_anything_is_queued(self):
        put_rods(self.folder / "in", 4)
        self.assertIn("--no-such", self.drive(2, "--", "--no-such"))
        self.assertIn("is given by this script", self.drive(2, "--", "--shard", "0/2"))
        self.assertEqual(self.queued(), [])


class NoSlurm(Case):
    def test_what_to_install_and_how_to_do_without(self):
        put_rods(self.folder / "in", 1)
        (self.folder / "programs").mkdir()
        os.symlink("/usr/bin/python3", self.folder / "programs" / "python3")
        done = subprocess.run(
            [DRIVER, "in", "-o", "out", "--selvage", PROGRAM],
            cwd=self.folder,
            stderr=subprocess.PIPE,
            text=True,
            env=environment(PATH=str(self.folder / "programs")),
        )
        self.assertEqual(done.returncode, 2)
        for part in (
            "sbatch is not found",
            "apt-get install slurm-wlm",
            "selvage convert INPUT... -o OUT",
            "--shard 0/4",
        ):
            self.assertIn(part, done.stderr)
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    unittest.main()
