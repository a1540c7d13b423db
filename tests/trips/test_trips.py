"""`selvage diff` of files and what OpenCASCADE wrote after reading them: the geometry is the same, whatever it did to it."""

import json
import os
import re
import subprocess
import unittest

from program import Case, SAMPLES, run

OCCT_TRIP = os.environ["OCCT_TRIP"]
# Coordinates below 100 mm, where ten digits of OpenCASCADE's IGES resolve 1e-7 mm.
NAMES = (
    "plain4_grid",
    "plain4_path",
    "ring",
    "sections",
    "weave_racetrack",
    "jersey",
    "braid",
    "ply2_plain",
    "warpknit_tricot",
    "weave_satin5",
)


class Trips(Case):
    def written(self, name, extension, *options):
        path = self.folder / f"{name}{extension}"
        if not path.exists():
            self.succeeds("convert", SAMPLES / f"{name}.txt", "-o", path, "--quiet", *options)
        return path

    def travelled(self, path, source, target):
        out = self.folder / f"{path.stem}-{target}{'.stp' if target.startswith('step') else '.igs'}"
        subprocess.run([OCCT_TRIP, source, path, target, out], check=True, stdout=subprocess.DEVNULL)
        return out

    def assert_equal(self, a, b):
        done = run("diff", a, b, "--tolerance", "1e-7")
        self.assertEqual(done.returncode, 0, f"{done.stdout[:2000]}{done.stderr[:2000]}")
        return done.stdout

    def test_step(self):
        for name in NAMES:
            for form in ("step", "step-named"):
                with self.subTest(name=name, form=form):
                    before = self.written(name, ".stp")
                    self.assert_equal(before, self.travelled(before, form, form))

    def test_iges(self):
        for name in NAMES:
            for target in ("iges", "iges-brep"):
                with self.subTest(name=name, target=target):
                    before = self.written(name, ".igs")
                    self.assert_equal(before, self.travelled(before, "iges", target))

    def test_across(self):
        """IGES that was made of STEP, and the text that both came from."""
        for name in NAMES[:4]:
            with self.subTest(name=name):
                step = self.written(name, ".stp")
                self.assert_equal(SAMPLES / f"{name}.txt", self.travelled(step, "step", "iges-brep"))

    def test_a_change_is_seen_through_a_trip(self):
        """One point of one yarn is moved by 1e-5 mm: found, and in that yarn."""
        text = (SAMPLES / "plain4_grid.txt").read_text()
        rows = [m for m in re.finditer(r"^(    )(-?[\d.]+) (-?[\d.]+) (-?[\d.]+)$", text, re.MULTILINE)]
        row = rows[len(rows) // 2 + 40]
        changed = self.folder / "changed.txt"
        changed.write_text(text[: row.start(4)] + repr(float(row[4]) + 1e-5) + text[row.end(4) :])
        yarn = re.findall(r"^yarn (\S+)", text[: row.start()], re.MULTILINE)[-1]
        before, after = self.folder / "before.stp", self.folder / "after.stp"
        self.succeeds("convert", SAMPLES / "plain4_grid.txt", "-o", before, "--quiet")
        self.succeeds("convert", changed, "-o", after, "--quiet")
        done = run("diff", before, self.travelled(after, "step-named", "step-named"), "--tolerance", "1e-7", "--json")
        self.assertEqual(done.returncode, 3, done.stderr)
        differences = json.loads(done.stdout)["differences"]
        self.assertEqual([(d["kind"], d["name"]) for d in differences], [("reshaped", yarn)])
        self.assertLessEqual(differences[0]["at_least"], 1.0001e-5)
        self.assertGreater(differences[0]["at_most"], 1e-6)


if __name__ == "__main__":
    unittest.main()
