"""The Debian package on a bare Debian 12: it installs, its dependencies are all that it needs, it works, and it goes without a trace.

Takes root, debootstrap and Debian's archive, so it runs every night, and by hand:
  scripts/package && python3 tests/packaging/test_package.py
SELVAGE_PACKAGE: the package (default: that in build). SELVAGE_ROOT: the folder of a bare root, made where it is missing and kept
(default: one that goes at the end).
"""

import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
SAMPLES = "/usr/share/selvage/samples"
PATH = "/usr/sbin:/usr/bin:/sbin:/bin"


def commands(page):
    """The lines of a page's blocks of commands."""
    return [
        line
        for block in re.findall(r"```sh\n(.*?)```", (REPOSITORY / page).read_text(), re.DOTALL)
        for line in block.splitlines()
    ]


def packages():
    named = os.environ.get("SELVAGE_PACKAGE")
    return [pathlib.Path(named)] if named else sorted((REPOSITORY / "build").glob("selvage_*.deb"))


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        (cls.package,) = packages()
        kept = os.environ.get("SELVAGE_ROOT")
        cls.root = pathlib.Path(kept or tempfile.mkdtemp(prefix="selvage-root-"))
        if not (cls.root / "etc/debian_version").exists():
            subprocess.run(
                ["debootstrap", "--variant=minbase", "bookworm", cls.root], check=True, stdout=subprocess.DEVNULL
            )
        if not kept:
            cls.addClassCleanup(shutil.rmtree, cls.root)
        # It reaches the archive in the way that this machine does.
        shutil.copy("/etc/resolv.conf", cls.root / "etc")
        shutil.rmtree(cls.root / "etc/apt")
        shutil.copytree("/etc/apt", cls.root / "etc/apt")
        subprocess.run(["mount", "-t", "proc", "proc", cls.root / "proc"], check=True)
        cls.addClassCleanup(subprocess.run, ["umount", cls.root / "proc"], check=True)
        shutil.copy(cls.package, cls.root / "root/selvage.deb")
        cls.addClassCleanup((cls.root / "root/selvage.deb").unlink)
        cls.inside("apt-get", "update", "-q")

    @classmethod
    def inside(cls, *command, folder="/", code=0):
        """Runs a command in the root; its standard output."""
        done = subprocess.run(
            [
                "chroot",
                cls.root,
                "env",
                "-i",
                "-C",
                folder,
                "HOME=/root",
                f"PATH={PATH}",
                "LC_ALL=C",
                "DEBIAN_FRONTEND=noninteractive",
                *command,
            ],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )
        if done.returncode != code:
            raise AssertionError(f"{command}: {done.returncode}\n{done.stdout}\n{done.stderr}")
        return done.stdout

    def assert_bare(self):
        self.inside("rm", "-rf", "/var/cache/man")  # the pages that man-db keeps as it showed them
        self.assertEqual(
            self.inside("find", "/", "-xdev", "-iname", "*selvage*", "-not", "-path", "/root/selvage.deb"), ""
        )

    def test_from_nothing_to_nothing(self):
        self.assert_bare()
        self.inside("apt-get", "install", "-q", "-y", "--no-install-recommends", "/root/selvage.deb")
        self.addCleanup(self.inside, "dpkg", "--purge", "selvage")  # where something fails
        files = self.inside("dpkg", "-L", "selvage").split()
        self.assertIn("/usr/bin/selvage", files)
        self.completes()
        self.has_its_bill_of_materials()
        self.assertIn("/usr/lib/selvage/three.module.min.js", files)
        programs = [
            name for name in files if name.startswith(("/usr/bin/", "/usr/lib/selvage/")) and not name.endswith(".js")
        ]
        self.assertEqual(len(programs), 11)
        for name in programs:
            if name not in ("/usr/bin/selvage-homogenize", "/usr/bin/selvage-permeability"):
                self.assertNotIn("not found", self.inside("ldd", name))
        self.works()
        self.a_first_picture()
        self.first_steps()
        self.a_program_of_ones_own()
        self.inside("apt-get", "purge", "-q", "-y", "--autoremove", "selvage")
        for name in programs:
            self.assertFalse((self.root / name[1:]).exists(), name)
        self.assert_bare()

    def has_its_bill_of_materials(self):
        """The one that is beside the package; it has all packages that this one depends on."""
        beside = self.package.with_suffix(".spdx.json").read_text()
        self.assertEqual((self.root / "usr/share/doc/selvage/selvage.spdx.json").read_text(), beside)
        stated = {package["name"] for package in json.loads(beside)["packages"]}
        depends = subprocess.run(
            ["dpkg-deb", "-f", self.package, "Depends"], check=True, capture_output=True, text=True
        ).stdout
        wanted = {word.split()[0] for word in depends.split(",")}
        self.assertGreater(len(wanted), 5)
        self.assertEqual(wanted - stated, set())

    def completes(self):
        """The manual page by man, and a word that bash completes once it has looked for the program's completions."""
        self.inside("apt-get", "install", "-q", "-y", "--no-install-recommends", "man-db", "bash-completion")
        self.assertIn("fabrics yarn by yarn", self.inside("man", "-P", "cat", "selvage"))
        script = """. /usr/share/bash-completion/bash_completion; _completion_loader selvage
                    COMP_WORDS=(selvage expl); COMP_CWORD=1; COMP_LINE="selvage expl"; COMP_POINT=12
                    set -- $(complete -p selvage); while [ "$1" != -F ]; do shift; done; $2 selvage expl selvage; echo ${COMPREPLY[@]}"""
        self.assertEqual(self.inside("bash", "-c", script).split(), ["explain"])

    def works(self):
        """Each module is opened, and the worker runs."""
        weave, out = f"{SAMPLES}/weave_plain.txt", "/root/out"
        self.assertTrue(self.inside("selvage", "--version").startswith("selvage "))
        self.inside("selvage", "convert", weave, "--to", "iges,step", "-o", out)
        self.assertTrue((self.root / "root/out/weave_plain.igs").read_text().rstrip().endswith("T      1"))
        self.assertTrue((self.root / "root/out/weave_plain.stp").read_text().endswith("END-ISO-10303-21;\n"))
        self.inside("selvage", "check", f"{out}/weave_plain.stp")
        self.inside("selvage", "mesh", weave, "--size", "0.2", "-o", f"{out}/weave.inp")
        self.assertIn("*ELEMENT", (self.root / "root/out/weave.inp").read_text().upper())
        self.inside("selvage", "view", weave, "--size", "80x60", "-o", f"{out}/weave.png")
        self.inside("selvage", "view", weave, "-o", f"{out}/weave.html")
        self.inside(
            "selvage", "convert", f"{SAMPLES}/plain_by_params.txt", "--set", "sett=2*11", "-o", f"{out}/params.igs"
        )
        self.inside("rm", "-r", out)

    def picture(self, name):
        """Width and height of a PNG that holds more than a background."""
        data = (self.root / name).read_bytes()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(len(data), 10000)
        return int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")

    def a_first_picture(self):
        """From the package to a picture of a cloth of one's own: two commands, and one's own numbers between them."""
        self.inside("sh", "-c", "selvage new denim > /root/own.txt")
        own = self.root / "root/own.txt"
        own.write_text(own.read_text().replace("denim", "mine"))
        self.inside("selvage", "view", "own.txt", "-o", "own.png", folder="/root")
        self.assertGreater(min(self.picture("root/own.png")), 400)
        self.inside("rm", "/root/own.txt", "/root/own.png")

    def first_steps(self):
        """The page as printed, with what the package recommends. Two layouts of one weave are the same in x and y."""
        self.inside("apt-get", "install", "-q", "-y", "--no-install-recommends", "calculix-ccx", "python3-numpy")
        page = "src/cli/first-steps.md"
        (self.root / "root/steps").mkdir()
        for name, text in re.findall(
            r"ave\s+it\s+as\s+`([\w.]+)`:\n\n```\n(.*?)```", (REPOSITORY / page).read_text(), re.DOTALL
        ):
            (self.root / "root/steps" / name).write_text(text)
        lines = commands(page)
        self.assertEqual({shlex.split(line)[0] for line in lines}, {"selvage", "selvage-homogenize"})
        for line in lines:
            with self.subTest(line):
                self.inside("sh", "-c", line, folder="/root/steps")
        self.picture("root/steps/cloth.png")
        constants = json.loads((self.root / "root/steps/stiffness.json").read_text())["engineering"]
        self.assertAlmostEqual(constants["E1"], constants["E2"], delta=0.01 * constants["E1"])
        told = float(re.search(r"E1 and E2 of some ([\d.]+) GPa", (REPOSITORY / page).read_text())[1])
        self.assertAlmostEqual(constants["E1"] / 1000, told, delta=0.1)
        self.inside("rm", "-r", "/root/steps")

    def a_program_of_ones_own(self):
        """find_package(Selvage) with what the package suggests: the program of the page writes what the installed one does."""
        self.inside(
            "apt-get",
            "install",
            "-q",
            "-y",
            "--no-install-recommends",
            "cmake",
            "make",
            "g++",
            "libeigen3-dev",
            "libmd-dev",
            "zlib1g-dev",
        )
        self.inside("cmake", "-S", "/usr/share/selvage/samples/api", "-B", "/root/api")
        self.inside("cmake", "--build", "/root/api")
        moment = "SOURCE_DATE_EPOCH=1700000000"
        self.inside("env", moment, "/root/api/plain_weave", "plain.igs", folder="/root/api")
        self.inside(
            "env", moment, "selvage", "convert", f"{SAMPLES}/weave_plain.txt", "-o", "/root/api/program/plain.igs"
        )
        self.assertEqual(
            (self.root / "root/api/plain.igs").read_bytes(), (self.root / "root/api/program/plain.igs").read_bytes()
        )
        self.inside("rm", "-r", "/root/api")


if __name__ == "__main__":
    unittest.main()
