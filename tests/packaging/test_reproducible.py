"""The Debian package of one commit is the same, byte for byte, from two clones at other paths (of another length),
at other times, with another home, user, umask, language and time zone.

Takes two builds, so it runs every night, and by hand: python3 tests/packaging/test_reproducible.py. What is committed is built.
SELVAGE_CCACHE=1: with the compiler cache, for a quick look at what packs and links; without it each source is compiled twice.
"""

import hashlib
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
PATH = "/usr/sbin:/usr/bin:/sbin:/bin"


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


class Reproducible(unittest.TestCase):
    def package(self, folder, umask, **environment):
        """(package, bill of materials) of a clone in the folder."""
        folder.mkdir(parents=True)
        subprocess.run(["git", "clone", "--quiet", "--no-checkout", REPOSITORY, folder / "selvage"], check=True)
        subprocess.run(["git", "-C", folder / "selvage", "checkout", "--quiet", "--detach", self.commit], check=True)
        home = folder / "home"
        # The library of pages, which npm gave: a home of its own has it, too.
        kept = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache")) / "selvage"
        if kept.exists():
            shutil.copytree(kept, home / ".cache/selvage")
        cache = {"CCACHE_DISABLE": "1"}
        if os.environ.get("SELVAGE_CCACHE"):
            cache = {"CCACHE_DIR": os.environ.get("CCACHE_DIR", str(pathlib.Path.home() / ".cache/ccache"))}
        done = subprocess.run(
            ["scripts/package"],
            cwd=folder / "selvage",
            env={"PATH": PATH, "HOME": str(home), **cache, **environment},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            umask=umask,
        )
        self.assertEqual(done.returncode, 0, done.stderr[-5000:])
        return [pathlib.Path(line) for line in done.stdout.splitlines()]

    def test_two_clones(self):
        # The same for both, whatever is committed while they are built.
        self.commit = subprocess.run(
            ["git", "-C", REPOSITORY, "rev-parse", "HEAD"], check=True, stdout=subprocess.PIPE, text=True
        ).stdout.strip()
        with tempfile.TemporaryDirectory(prefix="selvage-test-") as top:
            first = self.package(pathlib.Path(top, "a"), 0o022, LC_ALL="C", TZ="UTC")
            second = self.package(
                pathlib.Path(top, "another/longer.place"), 0o077, LC_ALL="C.UTF-8", TZ="Asia/Kathmandu", USER="someone"
            )
            self.assertEqual([path.name for path in first], [path.name for path in second])
            self.assertEqual([path.suffixes[-1] for path in first], [".deb", ".json"])
            for one, other in zip(first, second):
                if digest(one) != digest(other):
                    self.fail(f"{one.name} differs:\n{self.difference(one, other)}")
                print(f"{one.name}: {one.stat().st_size} bytes, SHA-256 {digest(one)}")

    def difference(self, one, other):
        if not shutil.which("diffoscope"):
            return "(diffoscope, of diffoscope-minimal, shows what)"
        command = ["diffoscope", "--max-text-report-size", "20000", one, other]
        return subprocess.run(command, capture_output=True, text=True).stdout


if __name__ == "__main__":
    unittest.main()
