"""`selvage roundtrip`: through every surface format and back; its table, report, JUnit file, and what it leaves behind."""

import json
import math
import pathlib
import signal
import time
import unittest
import xml.etree.ElementTree as ElementTree

from program import BAD, Case, GRID, PATH, RING, SAMPLES, environment, run, start

ALL = ["iges", "iges-solid", "step", "txt"]
LARGE = "fabric 1\nthread a\n  diameter 0.5\nend\nweave\n  warp a 120 pitch 1.0\n  weft a 40 pitch 1.0\n  draft plain\nend\n"


class Trips(Case):
    def trips(self, code, *arguments):
        """The trips of each input in the report, by format."""
        report = self.folder / "report.json"
        done = run("roundtrip", *arguments, "--report", report, "--no-progress")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return [
            {trip["format"]: trip for trip in entry.get("roundtrips", [])}
            for entry in json.loads(report.read_text())["inputs"]
        ], done

    def junit(self, code, *arguments):
        path = self.folder / "junit.xml"
        done = run("roundtrip", *arguments, "--junit", path, "--no-progress")
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        root = ElementTree.parse(path).getroot()
        suite = root.find("testsuite")
        cases = suite.findall("testcase")
        for name, count in (
            ("tests", len(cases)),
            ("failures", len(suite.findall("testcase/failure"))),
            ("errors", len(suite.findall("testcase/error"))),
            ("skipped", len(suite.findall("testcase/skipped"))),
        ):
            self.assertEqual(int(suite.get(name)), count, name)
            self.assertEqual(int(root.get(name)), count, name)
        return cases, done

    def test_nothing_is_lost(self):
        inputs = (GRID, PATH, RING, SAMPLES / "jersey.txt", SAMPLES / "weave_racetrack.txt", SAMPLES / "sections.txt")
        found, done = self.trips(0, *inputs)
        for path, trips in zip(inputs, found):
            info = json.loads(run("info", path, "--json").stdout)["inputs"][0]
            self.assertEqual(sorted(trips), ALL)
            for name, trip in trips.items():
                with self.subTest(path=path, format=name):
                    self.assertTrue(trip["equal"])
                    self.assertEqual(trip["differences"], [])
                    self.assertEqual(trip["closed"], [info["yarn_count"]] * 2)
                    volume = math.fsum(yarn["volume"] for yarn in info["yarns"])
                    for value in trip["volume"]:
                        self.assertAlmostEqual(value / volume, 1, delta=1e-9)
                    self.assertEqual([y["name"] for y in trip["yarns"]], [y["name"] for y in info["yarns"]])
                    self.assertEqual(max(y["deviation"] for y in trip["yarns"]), trip["largest_deviation"])
                    if name != "step":
                        self.assertEqual(trip["largest_deviation"], 0)
        self.assertEqual(done.stdout.count("  equal\n"), len(inputs) * len(ALL))

    def test_pieces(self):
        found, _ = self.trips(0, SAMPLES / "back_piece.txt", SAMPLES / "pocket_pieces.txt", "--to", "iges,step")
        for trips in found:
            self.assertTrue(all(trip["equal"] for trip in trips.values()))

    def test_formats(self):
        found, _ = self.trips(0, GRID, "--to", "txt,iges-solid")
        self.assertEqual(sorted(found[0]), ["iges-solid", "txt"])
        for word in ("stl", "svg", "inp"):
            self.assertIn(f"'{word}' is no format of surfaces", self.fails(2, "roundtrip", GRID, "--to", word))

    def test_junit(self):
        strange = self.folder / "a & <b> \"c\" 'd' \u00e9.txt"
        strange.write_text(pathlib.Path(GRID).read_text())
        cases, _ = self.junit(1, strange, BAD / "nan.txt", self.folder / "missing.txt", "--to", "iges,txt")
        self.assertEqual(
            [(c.get("classname"), c.get("name"), [x.tag for x in c]) for c in cases],
            [
                (str(strange), "iges", []),
                (str(strange), "txt", []),
                (str(BAD / "nan.txt"), "roundtrip", ["error"]),
                (str(self.folder / "missing.txt"), "roundtrip", ["error"]),
            ],
        )
        self.assertIn("nan", cases[2][0].get("message"))
        self.assertIn("No such file", cases[3][0].text)

    def test_a_difference(self):
        """IGES holds ASCII only: another name comes back. Told readably, and the XML is whole."""
        named = self.folder / "named.txt"
        named.write_text(pathlib.Path(GRID).read_text().replace("\nyarn warp1 ", '\nyarn "tr\u00e8s <1> &" '))
        cases, done = self.junit(3, named, "--to", "iges,txt")
        self.assertEqual([[x.tag for x in case] for case in cases], [["failure"], []])
        self.assertEqual(cases[0][0].text, "renamed: yarn 'tr\u00e8s <1> &' to 'tr_s <1> &'\n")
        self.assertEqual(cases[0][0].get("message"), cases[0][0].text.strip())
        self.assertIn("error: through iges: renamed", done.stderr)
        self.assertIn("different", done.stdout)

    def test_nothing_is_left_behind(self):
        place = self.folder / "tmp"
        place.mkdir()
        env = environment(TMPDIR=str(place))
        self.assertEqual(run("roundtrip", GRID, env=env).returncode, 0)
        self.assertEqual(list(place.iterdir()), [])
        large = self.folder / "large.txt"
        large.write_text(LARGE)
        for sign in (signal.SIGINT, signal.SIGTERM):
            running = start("roundtrip", large, "--no-progress", env=env)
            deadline = time.monotonic() + 60
            while (
                not any(path.is_file() for path in place.rglob("*"))
                and running.poll() is None
                and time.monotonic() < deadline
            ):
                time.sleep(0.01)
            self.assertTrue(any(place.iterdir()), "there is a folder while it runs")
            running.send_signal(sign)
            messages = running.communicate()[1]
            self.assertEqual(running.returncode, 130)
            self.assertIn("interrupted", messages)
            self.assertEqual(list(place.iterdir()), [])

    def test_places_that_cannot_be_written(self):
        self.assertIn("Is a directory", self.fails(2, "roundtrip", GRID, "--junit", self.folder))
        self.assertIn(
            "temporary folder", self.fails(1, "roundtrip", GRID, env=environment(TMPDIR=str(self.folder / "no")))
        )


if __name__ == "__main__":
    unittest.main()
