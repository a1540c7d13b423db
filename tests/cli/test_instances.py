"""--instances: yarns that are equal up to a rigid motion are written once and placed. OpenCASCADE (occt_totals) reads the same
solids, names, colours and volumes as in the full files."""

import json
import os
import subprocess
import unittest

from program import ROOT, Case

TOTALS = os.environ.get("OCCT_TOTALS", "build/bin/occt_totals")


def weave(count, more=""):
    return f"""fabric 1
units mm
tolerance 0.01
thread a
  section ellipse 0.4 0.2
  color 10 20 30
end
thread b
  section ellipse 0.5 0.25
  color 200 100 0
end
weave
  warp a {count} pitch 1
  weft b {count} pitch 1
  draft plain
end
{more}"""


class Instances(Case):
    def write(self, text, *options):
        """The same fabric in full and by reference: {(kind, format): path}, and the reports."""
        source = self.folder / "w.txt"
        source.write_text(text)
        files, self.reports, self.messages = {}, {}, {}
        for kind, words in (("full", []), ("short", ["--instances"])):
            folder = self.folder / kind
            done = self.succeeds(
                "convert", source, "-o", folder, "--report", self.folder / f"{kind}.json", *words, *options
            )
            self.messages[kind] = done.stderr
            self.reports[kind] = json.loads((self.folder / f"{kind}.json").read_text())["inputs"][0]
            for name in ("igs", "stp"):
                files[kind, name] = folder / f"w.{name}"
        return files

    def totals(self, *paths):
        done = subprocess.run([TOTALS, *map(str, paths)], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return [json.loads(line) for line in done.stdout.splitlines()]

    def volume(self):
        return sum(yarn["volume"] for yarn in self.reports["full"]["yarns"])

    def test_a_weave_of_64_by_64(self):
        files = self.write(weave(64), "--iges-solid")
        for name in ("igs", "stp"):
            full, short = (os.path.getsize(files[kind, name]) for kind in ("full", "short"))
            self.assertGreaterEqual(full, 10 * short, name)
        found = self.reports["short"]["instances"]
        self.assertEqual((found["shapes"], found["copies"]), (4, 128))
        self.assertLess(found["largest_deviation"], 64e-9)
        self.assertNotIn("instances", self.reports["full"])
        for seen in self.totals(files["short", "igs"], files["short", "stp"]):
            self.assertEqual((seen["solids"], seen["valid"]), (128, 128))
            # OpenCASCADE's integral is no better; test_the_same_as_in_full compares it with itself.
            self.assertAlmostEqual(seen["volume"], self.volume(), delta=1e-3 * self.volume())

    def test_the_same_as_in_full(self):
        for options in ([], ["--iges-solid"], ["--ends", "planar"]):
            with self.subTest(options):
                files = self.write(weave(6), *options)
                full_igs, short_igs, full, short = self.totals(
                    *(files[kind, name] for name in ("igs", "stp") for kind in ("full", "short"))
                )
                for key in ("fails", "roots", "faces", "solids", "valid"):
                    self.assertEqual(full_igs[key], short_igs[key], key)
                self.assertEqual(full_igs["solids"], 12)
                self.assertAlmostEqual(full_igs["volume"], short_igs["volume"], delta=1e-6 * full_igs["volume"])
                self.assertEqual((full["solids"], full["valid"]), (12, 12))
                self.assertEqual((short["solids"], short["valid"]), (12, 12))
                self.assertAlmostEqual(full["volume"], short["volume"], delta=1e-9 * full["volume"])
                for a, b in zip(full["parts"], short["parts"]):
                    self.assertEqual(a[:2], b[:2])  # name and colour
                    for x, y in zip(a[2] + a[3], b[2] + b[3]):  # where it is
                        self.assertAlmostEqual(x, y, delta=1e-6)

    def test_the_second_parser_places_them(self):
        import sys

        sys.path.insert(0, str(ROOT / "tests/formats/iges"))
        try:
            import iges_model
        finally:
            sys.path.pop(0)
        files = self.write(weave(6))
        models = [iges_model.Model(files[kind, "igs"].read_bytes()) for kind in ("full", "short")]
        samples = []
        for model in models:
            faces = []
            for part in model.parts:
                for face in part.faces:
                    u0, u1, v0, v1 = face.surface.range
                    places = [(i / 4, j / 7) for i in range(5) for j in range(8)]
                    faces.append(
                        [value for s, t in places for value in face.surface.at(u0 + (u1 - u0) * s, v0 + (v1 - v0) * t)]
                    )
            samples.append(sorted(faces, key=lambda values: [round(value, 6) for value in values]))
        self.assertEqual(len(samples[0]), 36)
        self.assertEqual(len(samples[1]), 36)
        for a, b in zip(*samples):
            self.assertEqual(len(a), len(b))
            for x, y in zip(a, b):
                self.assertAlmostEqual(x, y, delta=1e-8)

    def test_it_is_said_who_drops_them(self):
        self.write(weave(4))
        self.assertIn("Abaqus/CAE", self.messages["short"])
        self.assertIn("308", self.messages["short"])
        self.assertNotIn("Abaqus", self.messages["full"])

    def test_yarns_that_are_like_no_other_stand_alone(self):
        yarn = "yarn odd a\n  path chord\n    0 0 5\n    3 1 5\n    6 0 6\n  end\nend\n"
        self.write(weave(4, yarn), "--to", "iges")
        entities = self.reports["short"]["outputs"][0]["entities"]
        self.assertEqual((entities["308"], entities["408"], entities["128"]), (4, 8, 15))

    def test_in_several_files_each_has_its_shapes(self):
        self.write(weave(6), "--to", "iges")
        source = self.folder / "w.txt"
        report = self.folder / "r.json"
        self.succeeds(
            "convert", source, "-o", self.folder / "s.igs", "--instances", "--iges-lines", 600, "--report", report
        )
        outputs = json.loads(report.read_text())["inputs"][0]["outputs"]
        self.assertGreater(len(outputs), 1)
        self.assertEqual(sum(output["entities"].get("408", 0) for output in outputs), 12)
        totals = self.totals(*(output["path"] for output in outputs))
        self.assertEqual(sum(total["solids"] for total in totals), 12)
        self.assertAlmostEqual(sum(total["volume"] for total in totals), self.volume(), delta=1e-3 * self.volume())


if __name__ == "__main__":
    unittest.main()
