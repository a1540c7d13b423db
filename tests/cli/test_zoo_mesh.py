"""Samples with yarns pass `mesh` as they come, and meshio finds every yarn whole in what was written.

Exit code 0 of `mesh` says that no two yarns overlap. SELVAGE_ZOO=I/N takes the I-th of N parts of the samples. A third of them is meshed once, with
middle nodes on the surfaces; the smallest of each family, and every night (SELVAGE_EVERYTHING=1) all of them, with edges as short as give every yarn
its volume to 1 %.
"""

import json
import os
import subprocess
import unittest

from program import EVERYTHING, Case, SAMPLES, ROOT, run, smallest_of_each_family

PYTHON = os.environ.get("SELVAGE_MESHIO_PYTHON", "/usr/bin/python3")  # with meshio
READER = ROOT / "tests" / "formats" / "mesh" / "yarn_volumes.py"
PART, PARTS = map(int, os.environ.get("SELVAGE_ZOO", "0/1").split("/"))


def has_yarns(sample):
    return sample.suffix == ".wif" or not any(line.startswith("piece") for line in sample.read_text().splitlines())


ZOO = sorted(path for path in SAMPLES.iterdir() if path.suffix in (".txt", ".wif") and has_yarns(path))
REFINED = ZOO if EVERYTHING else smallest_of_each_family(ZOO)
MESHED = ZOO if EVERYTHING else sorted({*REFINED, *ZOO[::3]})


class ZooMesh(Case):
    def size_for(self, sample):
        """Seven fifths of the side of a square as large as the smallest section."""
        report = self.folder / "info.json"
        self.succeeds("info", sample, "--report", report, "--quiet")
        yarns = json.loads(report.read_text())["inputs"][0]["yarns"]
        return 1.4 * min((yarn["volume"] / yarn["length"]) ** 0.5 for yarn in yarns)

    def mesh(self, sample, size):
        """The volume and the smallest tetrahedron of every yarn, and what the program says of the yarns."""
        report, out = self.folder / "mesh.json", self.folder / (sample.stem + ".vtu")
        done = run("mesh", sample, "-o", out, "--size", f"{size:.4g}", "--order", "2", "--report", report, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        read = subprocess.run([PYTHON, READER, out], capture_output=True, text=True)
        self.assertEqual(read.returncode, 0, read.stderr)
        found = [tuple(map(float, line.split())) for line in read.stdout.splitlines()]
        yarns = json.loads(report.read_text())["inputs"][0]["yarns"]
        self.assertEqual(len(found), len(yarns))
        return [(volume / yarn["volume"], smallest) for (volume, smallest), yarn in zip(found, yarns)]

    def judge(self, sample):
        size = self.size_for(sample)
        for _ in range(4):  # flat sections need finer ones
            found = self.mesh(sample, size)
            self.assertGreater(min(smallest for _, smallest in found), 0.0)
            error = max(abs(share - 1) for share, _ in found)
            if error < 0.01 or sample not in REFINED:
                return
            size /= 2
        self.assertLess(error, 0.01)

    def test_samples(self):
        for sample in MESHED[PART::PARTS]:
            with self.subTest(sample=sample.name):
                self.judge(sample)


if __name__ == "__main__":
    unittest.main()
