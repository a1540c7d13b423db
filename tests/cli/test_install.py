"""What `cmake --install` puts where works there: the program with its modules and worker, and the library for find_package.

SELVAGE_BUILD: the build folder that is installed. The package, which takes root and Debian's archive, is tests/packaging.
"""

import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

import iges_surfaces
from program import Case, HAS_PAGES, ROOT, environment, files_below

BUILD = pathlib.Path(os.environ.get("SELVAGE_BUILD", ROOT / "build")).resolve()
PACKAGING = ROOT / "scripts" / "packaging"
WEAVE = "share/selvage/samples/weave_plain.txt"
BY_PARAMS = "share/selvage/samples/plain_by_params.txt"


def do(command, folder):
    """Runs a command line in the folder, which is its home, too; its standard output."""
    done = subprocess.run(
        ["sh", "-e", "-c", command], cwd=folder, env=environment(HOME=str(folder)), capture_output=True, text=True
    )
    if done.returncode != 0:
        raise AssertionError(f"{command}\n{done.stdout}\n{done.stderr}")
    return done.stdout


def of_page(beginning):
    """The block of commands of the page in which a line begins so, from that line on."""
    for block in re.findall(r"```sh\n(.*?)```", (PACKAGING / "README.md").read_text(), re.DOTALL):
        found = re.search(rf"^{re.escape(beginning)}", block, re.MULTILINE)
        if found:
            return block[found.start() :]
    raise AssertionError(f"no command begins with '{beginning}'")


class Installed(Case):
    """Installed as the page says, and then moved: nothing may know of the place where it was at first."""

    @classmethod
    def setUpClass(cls):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="selvage-test-"))
        cls.addClassCleanup(shutil.rmtree, folder, ignore_errors=True)
        at_first, cls.home = folder / "first", folder / "home"
        at_first.mkdir()
        (at_first / "build").symlink_to(BUILD)
        do(of_page("cmake --install"), at_first)
        at_first.rename(cls.home)
        cls.prefix = cls.home / ".local"
        (cls.home / "samples").symlink_to(cls.prefix / "share/selvage/samples")

    def works(self, *arguments, code=0):
        done = subprocess.run(
            [self.prefix / "bin/selvage", *map(str, arguments)],
            env=environment(),
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout

    def test_what_is_there(self):
        files = set(files_below(self.prefix))
        outside = {name for name in files if not name.startswith(("include/", "share/selvage/", "lib/cmake/"))}
        self.assertEqual(
            outside,
            {
                "bin/selvage",
                "bin/selvage-homogenize",
                "bin/selvage-permeability",
                "lib/libselvage.a",
                "lib/selvage/selvage-tetgen",
                "lib/selvage/selvage_cgal.so",
                "lib/selvage/selvage_embree.so",
                "lib/selvage/selvage_hdf5.so",
                "lib/selvage/selvage_minizip.so",
                "lib/selvage/selvage_muparser.so",
                "lib/selvage/selvage_occt.so",
                "lib/selvage/selvage_pugixml.so",
                *(["lib/selvage/three.module.min.js"] if HAS_PAGES else []),
                *(["share/doc/selvage/selvage.spdx.json"] if (BUILD / "selvage.spdx.json").exists() else []),
                "share/doc/selvage/copyright",
                "share/doc/selvage/CHANGELOG.md",
                "share/man/man1/selvage.1",
                "share/bash-completion/completions/selvage",
                "share/zsh/vendor-completions/_selvage",
                "share/fish/vendor_completions.d/selvage.fish",
            },
        )
        table = (PACKAGING / "README.md").read_text()
        for name in files:
            self.assertTrue(
                any(name.startswith(place) for place in re.findall(r"`((?:bin|lib|include|share)[\w/.-]*)`", table)),
                name,
            )
        samples = subprocess.run(["git", "ls-files", "samples"], cwd=ROOT, capture_output=True, text=True)
        if samples.returncode == 0 and samples.stdout:  # not in a copy without its repository
            self.assertEqual({f"share/selvage/{name}" for name in samples.stdout.splitlines()} - files, set())

    def test_pages_and_completions_are_those_of_the_program(self):
        for kind, place in (
            ("man", "man/man1/selvage.1"),
            ("complete-bash", "bash-completion/completions/selvage"),
            ("complete-zsh", "zsh/vendor-completions/_selvage"),
            ("complete-fish", "fish/vendor_completions.d/selvage.fish"),
        ):
            self.assertEqual((self.prefix / "share" / place).read_text(), self.works("--generate", kind))

    def test_what_needs_another_machine_runs_every_night(self):
        nightly = (ROOT / ".github/workflows/nightly.yml").read_text()
        for command in ("scripts/package\n", *of_page("docker build").splitlines(keepends=True)):
            self.assertIn(f"- run: {command}", nightly)

    def test_headers_include_what_is_installed(self):
        include = self.prefix / "include/selvage"
        headers = sorted(include.rglob("*.h"))
        of_formats = [*(ROOT / "formats").glob("*.h"), *(ROOT / "formats").glob("*/options.h")]
        self.assertGreater(len(of_formats), 2)
        for header in of_formats:
            self.assertIn(include / header.relative_to(ROOT), headers)
        for header in headers:
            for name in re.findall(r'^#include "(.*)"', header.read_text(), re.MULTILINE):
                self.assertTrue((include / name).exists(), f"{header}: {name}")

    def test_the_program_with_all_its_parts(self):
        weave = self.prefix / WEAVE
        self.works("convert", weave, "-o", self.folder)
        self.works("check", self.folder / "weave_plain.stp")  # OpenCASCADE, CGAL
        self.works("mesh", weave, "-o", self.folder / "weave.inp", "--size", "0.2")  # TetGen's worker
        self.works("view", weave, "-o", self.folder / "weave.png", "--size", "80x60")  # Embree
        self.works("view", weave, "-o", self.folder / "weave.html", code=0 if HAS_PAGES else 1)  # three.js
        self.works(
            "convert", self.prefix / BY_PARAMS, "--set", "sett=2*11", "-o", self.folder / "params.igs"
        )  # muParser

    def test_homogenize_of_what_is_installed(self):
        """Its imports are all there, and it calls the program beside it: a block of one material has that material's stiffness."""
        (self.folder / "block.txt").write_text(
            "fabric 1\nmaterial resin\n  elastic isotropic 1000 0.25\nend\nthread tow\n  section circle 0.5\n  material resin\nend\n"
            "yarn one tow\n  path chord\n    -1 0 0\n    2 0 0\n  end\nend\n"
            "cell 0 -0.5 -0.5  1 0.5 0.5\n  matrix resin\n  periodic x y z\nend\n"
        )
        done = subprocess.run(
            [
                self.prefix / "bin/selvage-homogenize",
                "block.txt",
                "--voxel",
                "3",
                "--solver",
                "iterative",
                "--json",
                "-",
            ],
            env=environment(),
            cwd=self.folder,
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        stiffness = np.array(json.loads(done.stdout)["stiffness"])
        np.testing.assert_allclose(stiffness[:2, :2], [[1200, 400], [400, 1200]], rtol=1e-6)

    def test_permeability_of_what_is_installed(self):
        """Along cylinders in squares, 20 % of the cell: the series of Drummond and Tahir (1984), which at that share is good to 1e-3."""
        share = 0.2
        radius = math.sqrt(share / math.pi)
        (self.folder / "array.txt").write_text(
            f"fabric 1\nunits mm\ntolerance 1e-4\nthread fibre\n  section circle {2 * radius!r}\nend\n"
            "yarn one fibre\n  path chord\n    -1 0 0\n    2 0 0\n  end\nend\n"
            "cell 0 -0.5 -0.5  0.2 0.5 0.5\n  periodic x y z\nend\n"
        )
        done = subprocess.run(
            [self.prefix / "bin/selvage-permeability", "array.txt", "--segments", "12", "--json", "-"],
            env=environment(),
            cwd=self.folder,
            capture_output=True,
            text=True,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        series = (
            radius**2
            / (4 * share)
            * (-math.log(share) - 1.476336 + 2 * share - share**2 / 2 - 0.0509713 * share**4)
        )
        self.assertAlmostEqual(json.loads(done.stdout)["permeability_mm2"][0][0], series, delta=0.005 * series)

    def test_an_incomplete_installation_is_told(self):
        copy = self.folder / "copy"
        shutil.copytree(self.prefix, copy)
        (copy / "lib/selvage/selvage-tetgen").unlink()
        failed = subprocess.run(
            [copy / "bin/selvage", "mesh", copy / WEAVE, "-o", self.folder / "weave.inp"],
            env=environment(),
            capture_output=True,
            text=True,
        )
        self.assertEqual(failed.returncode, 1)
        self.assertIn("the installation is incomplete: 'selvage-tetgen' is neither in", failed.stderr)

    def test_a_program_of_ones_own(self):
        """That of the page: every point of its yarns is where the cloth's numbers put it, and the bytes are the program's own."""
        do("mkdir out", self.home)
        do(of_page("cmake -S samples/api"), self.home)
        made = self.home / "out/plain.igs"
        bodies = [
            grid
            for grid in iges_surfaces.surfaces(made)
            if not np.allclose(grid[0], grid[0, 0]) and np.ptp(grid.mean(axis=1), axis=0).max() > 1
        ]
        self.assertEqual(len(bodies), 8)
        middles = []
        for grid in bodies:
            lies = int(np.argmin(np.ptp(grid.mean(axis=1)[:, :2], axis=0)))  # x of warps, y of wefts
            middles.append((lies, round((grid[:, :, lies].min() + grid[:, :, lies].max()) / 2, 6)))
            self.assertAlmostEqual(np.ptp(grid[:, :, lies]), 0.3, delta=1e-3)
        middles.sort()
        for lies in (0, 1):
            at = [middle for axis, middle in middles if axis == lies]
            np.testing.assert_allclose(np.diff(at), 0.7, atol=1e-6)
        own = self.folder / "plain.igs"
        self.works("convert", self.prefix / WEAVE, "-o", own)
        self.assertEqual(made.read_bytes(), own.read_bytes())

    def test_another_version_is_refused(self):
        project = self.folder / "project"
        project.mkdir()
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.20)\nproject(other LANGUAGES CXX)\n" "find_package(Selvage 99 REQUIRED)\n"
        )
        failed = subprocess.run(
            ["cmake", "-S", project, "-B", project / "build", f"-DCMAKE_PREFIX_PATH={self.prefix}"],
            capture_output=True,
            text=True,
        )
        self.assertNotEqual(failed.returncode, 0)
        self.assertIn("SelvageConfig.cmake, version:", failed.stderr)


class Version(Case):
    def git(self, *words, folder=None):
        subprocess.run(
            ["git", "-c", "user.name=n", "-c", "user.email=e", *words],
            cwd=folder or self.folder,
            check=True,
            capture_output=True,
            env=environment(GIT_CONFIG_GLOBAL="/dev/null", GIT_CONFIG_SYSTEM="/dev/null"),
        )

    def version(self, folder):
        script = self.folder / "script.cmake"
        script.write_text(
            f'include({PACKAGING}/version.cmake)\nselvage_version(version "{folder}" 0.1.0)\nmessage("${{version}}")\n'
        )
        return subprocess.run(["cmake", "-P", script], capture_output=True, text=True, check=True).stderr.strip()

    def test_by_the_tag(self):
        clone = self.folder / "clone"
        clone.mkdir()
        self.assertEqual(self.version(clone), "0.1.0")
        self.git("init", folder=clone)
        self.git("commit", "--allow-empty", "-m", "one", folder=clone)
        self.assertEqual(self.version(clone), "0.1.0")
        self.git("tag", "other", folder=clone)
        self.assertEqual(self.version(clone), "0.1.0")
        self.git("tag", "v0.2.0", folder=clone)
        self.assertEqual(self.version(clone), "0.2.0")
        self.git("commit", "--allow-empty", "-m", "two", folder=clone)
        head = subprocess.run(
            ["git", "rev-parse", "HEAD"], cwd=clone, capture_output=True, text=True, check=True
        ).stdout
        told = re.fullmatch(r"0\.2\.0\+1\.g([0-9a-f]{7,})", self.version(clone))
        self.assertTrue(head.startswith(told[1]), told)
        self.git("tag", "v0.3.0-rc1", folder=clone)
        self.assertEqual(self.version(clone), "0.3.0-rc1")

    def test_a_repository_round_the_sources_says_nothing(self):
        self.git("init")
        self.git("commit", "--allow-empty", "-m", "one")
        self.git("tag", "v9.0.0")
        self.assertEqual(self.version(self.folder), "9.0.0")
        inside = self.folder / "inside"
        inside.mkdir()
        self.assertEqual(self.version(inside), "0.1.0")


if __name__ == "__main__":
    unittest.main()
