"""The JSON report, and --resume which goes by it."""

import hashlib
import json
import os
import pathlib
import re
import shutil
import threading
import unittest

from program import BAD, Case, GRID, PATH, RING, ROOT, files_below, run


class Report(Case):
    def setUp(self):
        super().setUp()
        self.path = self.folder / "report.json"

    def report(self):
        return json.loads(self.path.read_text())

    def test_fields(self):
        self.fails(
            1,
            "convert",
            GRID,
            BAD / "misspelt.txt",
            "nowhere.txt",
            "--to",
            "iges",
            "-o",
            f"{self.out}/",
            "--report",
            self.path,
        )
        report = self.report()
        self.assertEqual(list(report), ["selvage", "libraries", "started", "seconds", "ok", "counts", "inputs"])
        self.assertRegex(report["selvage"], r"^\d+\.\d+\.\d+\S*$")
        self.assertEqual(
            sorted(report["libraries"]),
            ["cgal", "eigen", "embree", "fmt", "hdf5", "muparser", "occt", "png", "pugixml", "tetgen", "zlib"],
        )
        self.assertFalse(report["ok"])
        self.assertEqual(report["counts"], {"inputs": 3, "done": 1, "failed": 2, "skipped": 0})
        good, bad, missing = report["inputs"]
        self.assertEqual((good["path"], good["ok"], good["units"], good["yarn_count"]), (GRID, True, "mm", 4))
        self.assertEqual(good["sha256"], hashlib.sha256(pathlib.Path(GRID).read_bytes()).hexdigest())
        self.assertEqual([yarn["name"] for yarn in good["yarns"]], ["warp1", "warp2", "weft1", "weft2"])
        for yarn in good["yarns"]:
            self.assertEqual(yarn["control_points"], [18, 16])
            self.assertIs(yarn["closed"], True)
            self.assertGreater(yarn["length"], 2.0)
            self.assertGreater(yarn["volume"], 0.1)
            self.assertNotIn("self_overlap", yarn, "not looked for by convert: left out")
        for absent in ("overlaps", "min_gap", "mesh"):
            self.assertNotIn(absent, good)
        self.assertGreater(good["creo_absolute_accuracy"], 0)
        (written,) = good["outputs"]
        data = (self.out / "plain4_grid.igs").read_bytes()
        self.assertEqual((written["path"], written["format"]), (f"{self.out}/plain4_grid.igs", "iges"))
        self.assertEqual((written["bytes"], written["sha256"]), (len(data), hashlib.sha256(data).hexdigest()))
        self.assertEqual(written["entities"]["128"], 12)
        self.assertEqual((bad["ok"], missing["ok"]), (False, False))
        self.assertNotIn("outputs", bad)
        (message,) = bad["messages"]
        self.assertEqual((message["severity"], message["where"]), ("error", f"{BAD}/misspelt.txt:3:3"))
        self.assertIn("did you mean", message["text"])
        self.assertEqual(missing["messages"][0]["where"], "nowhere.txt")

    def test_lengths_are_in_millimetres(self):
        text = pathlib.Path(RING).read_text()
        self.assertIn("units mm\n", text)
        metres = self.folder / "ring.txt"
        metres.write_text(text.replace("units mm\n", "units cm\n"))
        reports = []
        for path in (RING, metres):
            self.succeeds("convert", path, "-o", self.folder / "x.igs", "--report", self.path)
            reports.append(self.report()["inputs"][0])
        mm, cm = (report["yarns"][0] for report in reports)
        self.assertEqual((reports[0]["units"], reports[1]["units"]), ("mm", "cm"))
        for key, factor in (("length", 10), ("volume", 1000), ("min_bend_radius", 10)):
            self.assertAlmostEqual(cm[key] / mm[key], factor, places=9)

    def test_check(self):
        self.succeeds("check", PATH, "--report", self.path)
        entry = self.report()["inputs"][0]
        self.assertEqual(entry["overlaps"], [])
        self.assertGreater(entry["min_gap"], 0)
        self.assertTrue(all(yarn["closed"] and not yarn["self_overlap"] for yarn in entry["yarns"]))
        # Neither a gap nor a section may vanish in it.
        self.assertLess(entry["creo_absolute_accuracy"], entry["min_gap"])

    def test_mesh(self):
        self.succeeds("mesh", PATH, "-o", self.folder / "x.inp", "--report", self.path)
        entry = self.report()["inputs"][0]
        self.assertEqual(
            sorted(entry["mesh"]),
            [
                "below_target",
                "first_percentile_dihedral",
                "in_wedges",
                "max_aspect",
                "min_dihedral",
                "nodes",
                "regions",
                "tets",
                "volume",
                "volume_error",
                "worst",
            ],
        )
        self.assertGreater(entry["mesh"]["tets"], 100)
        exact = sum(yarn["volume"] for yarn in entry["yarns"])
        self.assertAlmostEqual(entry["mesh"]["volume_error"], abs(entry["mesh"]["volume"] - exact) / exact, places=6)
        self.assertLess(entry["mesh"]["volume_error"], 0.1)
        regions, worst = entry["mesh"]["regions"], entry["mesh"]["worst"]
        self.assertEqual([region["name"] for region in regions], [yarn["name"] for yarn in entry["yarns"]])
        self.assertEqual({region["kind"] for region in regions}, {"yarn"})
        self.assertEqual(sum(region["tets"] for region in regions), entry["mesh"]["tets"])
        self.assertAlmostEqual(sum(region["volume"] for region in regions), entry["mesh"]["volume"], places=12)
        for region, yarn in zip(regions, entry["yarns"]):
            self.assertAlmostEqual(region["exact_volume"], yarn["volume"], places=9)
        self.assertEqual(min(region["min_dihedral"] for region in regions), entry["mesh"]["min_dihedral"])
        self.assertEqual(len(worst), 10)
        self.assertEqual([bad["min_dihedral"] for bad in worst], sorted(bad["min_dihedral"] for bad in worst))
        self.assertEqual(worst[0]["min_dihedral"], entry["mesh"]["min_dihedral"])

    def test_mesh_with_a_target(self):
        self.succeeds("mesh", PATH, "-o", self.folder / "x.inp", "--min-dihedral", "15", "--report", self.path)
        mesh = self.report()["inputs"][0]["mesh"]
        self.assertGreaterEqual(mesh["min_dihedral"], 15)
        self.assertEqual((mesh["below_target"], mesh["in_wedges"]), (0, 0))

    def test_info_as_json(self):
        report = json.loads(self.succeeds("info", RING, "--json").stdout)
        self.assertEqual(report["inputs"][0]["yarn_count"], 1)
        self.assertTrue(report["ok"])

    def test_the_box_is_that_of_the_surface(self):
        # Straight yarns along x: across it a section of these sizes.
        for section, across, up, places in (
            ("ellipse 0.6 0.4", 0.3, 0.2, 3),
            ("circle 0.5", 0.25, 0.25, 3),
            ("loop7 0.4", 0.2, 0.2, 1.9),
        ):
            source = self.folder / "straight.txt"
            source.write_text(
                f"fabric 1\nunits mm\nthread t\n  section {section}\nend\n"
                "yarn y t\n  path\n    0 0 0\n    10 0 0\n  end\nend\n"
            )
            found = re.search(r"within \((.*)\) and \((.*)\)", self.succeeds("info", source).stdout)
            low, high = ([float(x) for x in found[k].split(",")] for k in (1, 2))
            for value, wanted in zip(low + high, (0, -across, -up, 10, across, up)):
                self.assertLess(abs(value - wanted), 10**-places, section)

    def test_a_crashed_input_is_in_the_report(self):
        self.fails(1, "convert", GRID, "-o", self.folder / "x.igs", "--report", self.path, "--memory", "1")
        (entry,) = self.report()["inputs"]
        self.assertFalse(entry["ok"])
        self.assertEqual(entry["messages"][0]["severity"], "error")


class Resume(Case):
    def setUp(self):
        super().setUp()
        self.path = self.folder / "report.json"
        self.inside = self.folder / "in"
        self.inside.mkdir()
        for name, sample in (("a", GRID), ("b", PATH), ("c", RING)):
            shutil.copy(sample, self.inside / f"{name}.txt")
        self.convert()

    def convert(self, *more):
        self.succeeds("convert", self.inside, "--to", "iges", "-o", self.out, "--report", self.path, "--resume", *more)
        return json.loads(self.path.read_text())["counts"]

    def test_nothing_to_do(self):
        before = {path: path.stat().st_ino for path in self.out.iterdir()}
        self.assertEqual(self.convert(), {"inputs": 3, "done": 0, "failed": 0, "skipped": 3})
        self.assertEqual({path: path.stat().st_ino for path in self.out.iterdir()}, before)
        entry = json.loads(self.path.read_text())["inputs"][0]
        self.assertTrue(entry["skipped"] and entry["ok"])
        self.assertEqual(entry["yarn_count"], 4)
        self.assertEqual(self.convert()["skipped"], 3)

    def test_what_changed_is_done_again(self):
        (self.out / "a.igs").unlink()
        (self.out / "b.igs").write_text("damaged")
        self.assertEqual(self.convert(), {"inputs": 3, "done": 2, "failed": 0, "skipped": 1})
        with open(self.inside / "c.txt", "a") as text:
            text.write("# another comment\n")
        self.assertEqual(self.convert()["done"], 1)

    def test_other_settings_are_other_outputs(self):
        self.assertEqual(self.convert("--ends", "fan")["done"], 3)
        self.assertEqual(self.convert("--ends", "fan")["skipped"], 3)
        self.assertEqual(self.convert("--tolerance", "0.0020", "--iges-lines", "5000")["done"], 3)
        self.assertEqual(self.convert("--iges-lines", "5000", "--tolerance", "2e-3", "-j", "2")["skipped"], 3)
        self.assertEqual(self.convert("--tolerance", "2e-3")["done"], 3)
        self.assertEqual(self.convert("--tolerance", "2e-3", "--detail", "usual")["skipped"], 3)
        self.assertEqual(self.convert("--tolerance", "2e-3", "--detail", "filaments")["done"], 3)

    def test_another_program_is_other_outputs(self):
        """Another version, other sources, another library: it may write other bytes."""
        settings = json.loads(self.path.read_text())["inputs"][0]["settings"]
        self.assertRegex(settings, r"^selvage=\d+\.\d+\.\d+\S* build=[0-9a-f]{16} occt=[\d.]+ ")
        for old, new in (("selvage=", "selvage=9"), ("build=", "build=f"), ("occt=", "occt=1")):
            self.path.write_text(self.path.read_text().replace(old, new))
            self.assertEqual(self.convert()["done"], 3)
            self.assertEqual(self.convert()["skipped"], 3)

    def test_a_clock_says_nothing(self):
        for path in self.inside.iterdir():
            path.touch()
        self.assertEqual(self.convert()["skipped"], 3)

    def test_a_report_of_something_else(self):
        self.path.write_text("[1, 2]")
        self.assertIn(
            "not a report", self.fails(2, "convert", self.inside, "-o", self.out, "--report", self.path, "--resume")
        )
        for value, place in (
            ('{"path": 3}', r"inputs\[0\]\.path is a number"),
            ("4", "its input 1 has no path"),
            ('{"path": "a.txt", "ok": null}', r"inputs\[0\]\.ok is null"),
            ('{"path": "a.txt", "ok": true, "outputs": 7}', r"inputs\[0\]\.outputs is a number, where a list"),
            ("[" * 60000 + "]" * 60000, "nested more than 32 deep"),
        ):
            self.path.write_text('{"inputs": [%s]}' % value)
            message = self.fails(2, "convert", self.inside, "-o", self.out, "--report", self.path, "--resume")
            self.assertRegex(message, f"^{self.path}: error: this is not a report .*{place}")


def members(value, place=()):
    """The places of all that a report has, of lists the first element."""
    yield place
    if isinstance(value, dict):
        for name in value:
            yield from members(value[name], (*place, name))
    elif isinstance(value, list) and value:
        yield from members(value[0], (*place, 0))


def in_words(place):
    return re.escape("".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in place).removeprefix("."))


class FromOutside(Case):
    """Reports that somebody else wrote: what is wrong is said with its place, and costs no more than a small multiple of them."""

    def setUp(self):
        super().setUp()
        self.path = self.folder / "report.json"

    def refused(self, content, pattern):
        self.path.write_bytes(content if isinstance(content, bytes) else content.encode())
        for arguments in (
            ("merge", self.path, "-o", self.folder / "all.json"),
            ("html", self.path, "-o", self.folder / "page.html"),
        ):
            message = self.fails(1, "report", *arguments)
            self.assertRegex(message, f"^{self.path}: error: {pattern}")
            self.assertEqual(message.count("\n"), 1, message)
        self.assertEqual(list(files_below(self.folder)), ["report.json"])

    def test_nested(self):
        for depth in (33, 1000, 60000, 1_000_000):
            for start, end in (("[", "]"), ('{"a":', "}")):
                nested = depth * start + "0" + depth * end
                for content in (nested, '{"inputs": [{"path": "a", "more": %s}]}' % nested, depth * start):
                    self.refused(
                        content, "this is not a report of selvage .*: lists and objects are nested more than 32 deep"
                    )
        # The program itself nests less.
        self.path.write_text('{"inputs": [{"path": "a", "more": %s0%s}]}' % (28 * "[", 28 * "]"))
        self.succeeds("report", "merge", self.path, "-o", "-")

    def test_no_json(self):
        for content, place in (
            ("", "it is no JSON at line 1, column 1"),
            ('{"inputs": [\n  {"path": "a"},]}', "it is no JSON at line 2, column 17"),
            (b'{"inputs": [{"path": "\xff"}]}', "it is no JSON at line 1, column 2[23]"),
            ('{"inputs": []} x', "it is no JSON"),
            ('{"inputs": [{"path": "a", "seconds": 1e999}]}', "a number is too large at line 1"),
            ('{"inputs": [], "inputs": []}', "an object has two members 'inputs'"),
            ('{"inputs": [{"path": "a\\u0000b"}]}', r"inputs\[0\]\.path is a text, where"),
            ('{"inputs": [{"path": ""}]}', "its input 1 has no path"),
            ('{"inputs": [], "seconds": 1e300}', "seconds is a number, where a number from 0 to 1e15 is needed"),
            ('{"inputs": [], "counts": {"done": -1}}', r"counts\.done is a number, where a whole number from 0"),
            ('{"ok": true}', "it has no inputs"),
            ("3", "it is a number, where an object is needed"),
        ):
            with self.subTest(content):
                self.refused(content, f"this is not a report of selvage .*: {place}")

    def test_wrong_types(self):
        """Every member of reports of all kinds, with a value of every other type."""
        seen = set()
        for arguments in (
            ("info", ROOT / "samples" / "plain_by_params.txt"),
            ("check", GRID, "--reach", "1"),
            ("mesh", PATH, "-o", self.folder / "x.inp"),
            ("convert", RING, BAD / "misspelt.txt", "--to", "iges", "-o", self.out),
        ):
            run(*arguments, "--report", self.path)
            report = json.loads(self.path.read_text())
            for place in members(report):
                if place[:1] == ("inputs",) and place[2:] in seen:
                    continue
                seen.add(place[2:] if place[:1] == ("inputs",) else place)
                wrong = json.loads(json.dumps(report))
                holder = wrong
                for step in place[:-1]:
                    holder = holder[step]
                right = holder[place[-1]] if place else report
                for value in (None, True, 5.5, "a text", [], {}):
                    kinds = (bool, (int, float), str, list, dict)
                    if any(
                        isinstance(value, kind)
                        and isinstance(right, kind)
                        and isinstance(value, bool) == isinstance(right, bool)
                        for kind in kinds
                    ):
                        continue
                    if place:
                        holder[place[-1]] = value
                    else:
                        wrong = value
                    with self.subTest(place=place, value=value):
                        self.path.write_text(json.dumps(wrong))
                        message = self.fails(1, "report", "merge", self.path, "-o", self.folder / "all.json")
                        self.assertRegex(
                            message,
                            rf"error: this is not a report of selvage .*: {in_words(place) or 'it'} is .*, where .* is needed$",
                        )
        self.assertGreater(len(seen), 60)

    def test_a_page_is_not_larger_than_its_report_makes_it(self):
        """Tables whose rows have nothing in common, inputs without end, and one input named again and again."""
        rows = {f"r{k}": {f"k{k}": 1} for k in range(5000)}
        empty = {f"r{k}": {} for k in range(10000)}
        wide = {"r": {f"k{k}": 1 for k in range(10000)}}
        for content in (
            [{"path": "a", "sheets": {"weave": {"threads": rows, "systems": rows}}}],
            [{"path": "a", "sheets": {"weave": {"threads": empty}}}],
            [{"path": "a", "sheets": {"weave": {"threads": wide}}}],
            [{"path": "a"}] * 10000,
            [{"path": "a", "messages": [{"severity": "error", "text": "x"}] * 3000}],
        ):
            self.path.write_text(json.dumps({"inputs": content}))
            page = self.folder / "page.html"
            self.succeeds("report", "html", self.path, "-o", page, "--no-pictures")
            self.assertLess(page.stat().st_size, 50 * self.path.stat().st_size)
            if "sheets" in content[0] and content[0]["sheets"]["weave"]["threads"] is not empty:
                self.assertRegex(page.read_text(), r"\d+ further figures left out")

    def test_a_pipe(self):
        pipe = self.folder / "pipe.json"
        os.mkfifo(pipe)
        writer = threading.Thread(target=lambda: pipe.write_text('{"inputs": [{"path": "a", "ok": null}]}'))
        writer.start()
        self.assertRegex(self.fails(1, "report", "merge", pipe, "-o", "-"), r"inputs\[0\]\.ok is null")
        writer.join()


if __name__ == "__main__":
    unittest.main()
