"""A real Slurm of several nodes on this machine, for a test: slurmctld, one slurmd a node and munge, all run by the test's own user on
loopback, with all that they keep in one folder. Debian's slurmctld, slurmd, slurm-client and munge (scripts/setup cluster)."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

CONFIGURATION = """ClusterName=selvage
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={port}
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
SchedulerType=sched/builtin
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdTimeout=10
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=2
"""


def free_ports(count):
    held = [socket.socket() for _ in range(count)]
    for one in held:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in held]
    for one in held:
        one.close()
    return ports


def wait_for(condition, what, seconds=60):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise AssertionError(f"after {seconds} s still not: {what}")
        time.sleep(0.1)


class SlurmCluster:
    """Runs from start() to stop(); the environment's SLURM_CONF leads the programs of Slurm to it."""

    def __init__(self, folder, nodes):
        self.folder, self.nodes = pathlib.Path(folder), [f"node{k}" for k in range(nodes)]
        self.daemons = {}

    def start(self):
        self.folder.mkdir()
        for name in ["state", *(f"spool.{node}" for node in self.nodes)]:
            (self.folder / name).mkdir()
        key = self.folder / "munge.key"
        key.touch(0o600)
        key.write_bytes(os.urandom(1024))
        ports = free_ports(1 + len(self.nodes))
        host = socket.gethostname()
        text = CONFIGURATION.format(host=host, folder=self.folder, user=os.geteuid(), port=ports[0])
        for node, port in zip(self.nodes, ports[1:]):
            text += f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=1 State=UNKNOWN\n"
        text += "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n"
        (self.folder / "slurm.conf").write_text(text)
        os.environ["SLURM_CONF"] = str(self.folder / "slurm.conf")
        self.run(
            "munged",
            "munged",
            "--foreground",
            "--force",
            f"--socket={self.folder}/munge.socket",
            f"--key-file={key}",
            f"--pid-file={self.folder}/munged.pid",
            f"--log-file={self.folder}/munged.log",
            f"--seed-file={self.folder}/munge.seed",
        )
        wait_for((self.folder / "munge.socket").exists, "munge answers")
        self.run("slurmctld", "slurmctld", "-D", "-c")
        for node in self.nodes:
            self.start_node(node)
        wait_for(
            lambda: self.asked("sinfo", "-h", "-t", "idle", "-o", "%D").strip() == str(len(self.nodes)),
            "all nodes are idle",
        )

    def run(self, name, program, *words):
        found = shutil.which(program, path=os.environ["PATH"] + ":/usr/sbin")
        if not found:
            raise AssertionError(f"{program} is missing: scripts/setup cluster installs it")
        with open(self.folder / f"{name}.out", "ab") as out:
            self.daemons[name] = subprocess.Popen([found, *words], stdin=subprocess.DEVNULL, stdout=out, stderr=out)

    def start_node(self, node):
        self.run(node, "slurmd", "-D", "-N", node)

    def asked(self, *command):
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout

    def processes_on(self, node):
        """Of the node's jobs: (pid, whether it is Slurm's own)."""
        wanted = f"SLURMD_NODENAME={node}".encode()
        found = {}
        for place in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if wanted not in (place / "environ").read_bytes().split(b"\0"):
                    continue
                found[int(place.name)] = False
                above = int((place / "stat").read_text().rsplit(")", 1)[1].split()[1])
                if pathlib.Path(f"/proc/{above}/comm").read_text().startswith("slurmstepd"):
                    found[above] = True
            except (FileNotFoundError, PermissionError, ProcessLookupError):
                continue  # it ended meanwhile, or is somebody else's
        return sorted(found.items(), key=lambda one: not one[1])

    def lose_node(self, node):
        """As when its power fails: nobody there tells anything anymore. True: a job ran there."""
        self.daemons[node].kill()
        self.daemons.pop(node).wait()
        jobs = self.processes_on(node)
        for pid, _ in jobs:  # Slurm's first, lest they tell
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass  # it ended by itself
        return bool(jobs)

    def stop(self):
        for node in self.nodes:
            for pid, _ in self.processes_on(node):
                try:
                    os.kill(pid, signal.SIGKILL)
                except ProcessLookupError:
                    pass
        for daemon in reversed(list(self.daemons.values())):
            daemon.terminate()
            try:
                daemon.wait(10)
            except subprocess.TimeoutExpired:
                daemon.kill()
                daemon.wait()
