"""What can be wrong with a unit cell: each is refused at its place, with the remedy, before anything is meshed."""

import json
import pathlib
import re
import signal
import time
import unittest

from program import Case, SAMPLES, children_of, environment, files_below, run, start

MATERIALS = """fabric 1
material fibre
  elastic isotropic 70000 0.2
end
material resin
  elastic isotropic 3000 0.35
end
thread T
  diameter 0.3
  material fibre
end
"""
PLAIN = MATERIALS + "weave\n  warp T 2 pitch 1.5\n  weft T 2 pitch 1.5\n  draft plain\n  profile peirce\nend\n"
CELL_LINE = 1 + PLAIN.count("\n")


def straight(*ways):
    return MATERIALS + "".join(
        f"yarn y{k} T\n  path\n    {a}\n    {b}\n  end\nend\n" for k, (a, b) in enumerate(ways, 1)
    )


def cell(corners, rest="  matrix resin\n  periodic x y\n"):
    return f"cell {corners}\n{rest}end\n"


class CellInput(Case):
    def refuses(self, text, *options, code=1):
        """The message of `mesh --matrix --periodic`; nothing is written."""
        message = self.fails(
            code,
            "mesh",
            self.written(text),
            "--matrix",
            "--periodic",
            "-o",
            self.folder / "out.inp",
            "--no-progress",
            *options,
        )
        self.assertFalse((self.folder / "out.inp").exists())
        return message

    def meshes(self, text, *options):
        """What it says on standard error, but for the last line."""
        done = self.succeeds(
            "mesh",
            self.written(text),
            "--matrix",
            "--periodic",
            "-o",
            self.folder / "out.inp",
            "--no-progress",
            *options,
        )
        (self.folder / "out.inp").unlink()
        return "".join(line for line in done.stderr.splitlines() if not line.startswith("selvage: "))

    def written(self, text):
        source = self.folder / "cell.txt"
        source.write_text(text)
        return source

    def at_cell(self, message, text):
        """It stands at the cell's statement."""
        line = 1 + text[: text.index("\ncell ") + 1].count("\n")
        self.assertRegex(message, rf"cell\.txt:{line}:1: error: ")

    def test_a_cell_is_needed(self):
        self.assertIn("there is no unit cell in this input", self.refuses(PLAIN))

    def test_a_matrix_is_needed(self):
        text = PLAIN + cell("0 0 -0.35 3 3 0.35", "  periodic x y\n")
        message = self.refuses(text)
        self.at_cell(message, text)
        self.assertIn("names no matrix: add the line `matrix NAME`", message)
        self.assertIn("'resin'", message)

    def test_a_matrix_of_the_command_line(self):
        """Of a cell that names none: by a name, or by modulus and Poisson's ratio."""
        path = self.folder / "cell.txt"
        path.write_text(PLAIN + cell("0 0 -0.35 3 3 0.35", "  periodic x y\n"))
        for given, modulus in (("resin", None), ("3400,0.35", "3400")):
            deck = self.folder / "cell.inp"
            self.succeeds("mesh", path, "--matrix", "--voxel", 6, "--matrix-material", given, "-o", deck)
            self.assertTrue(modulus is None or re.search(rf"(?m)^{modulus}(\.0*)?, *0\.35$", deck.read_text()))
        for given in ("resinn", "3400", "-1,0.3", "3400,0.6"):
            done = self.fails(1, "mesh", path, "--matrix", "--voxel", 6, "--matrix-material", given, "-o", deck)
            self.assertIn("is no material of this input", done)
            self.assertIn("'resin'", done)

    def test_no_yarn_enters(self):
        text = PLAIN + cell("0 0 5 3 3 6")
        message = self.refuses(text)
        self.at_cell(message, text)
        self.assertIn("no yarn enters this cell: the yarns lie within", message)

    def test_a_cell_smaller_than_a_repeat(self):
        text = PLAIN + cell("0 0 -0.35 3 1.5 0.35")
        message = self.refuses(text)
        self.at_cell(message, text)
        self.assertIn("1.5 mm long along y, which is no whole number of repeats", message)
        self.assertIn("its yarns repeat after 3 mm", message)
        # Along x alone it is one; a whole repeat is fine (it fails only where its size is looked at).
        self.assertNotIn("along x", message)
        whole = PLAIN.replace("T 2", "T 4") + cell("0 3 -0.35 6 6 0.35")
        self.meshes(whole, "--size", "1")

    def test_the_repeat_of_every_construction(self):
        for statement, wrong, repeats in (
            (
                "weave\n  warp T 5 pitch 1\n  weft T 5 pitch 1\n  draft satin 5/2\nend\n",
                "0 0 -0.4 4 5 0.4",
                "x.* repeat after 5 mm",
            ),
            ("knit jersey\n  thread T\n  courses 2\n  wales 2\nend\n", "0 0 -1 1.2 1.5 1", "y.* repeat after 1.05 mm"),
            (
                "warpknit tricot\n  thread T\n  wales 4 pitch 2\n  courses 4 pitch 2\nend\n",
                "2 0 -1 4 2 1",
                "y.* repeat after 4 mm",
            ),
        ):
            with self.subTest(statement=statement):
                text = MATERIALS + statement + cell(wrong)
                message = self.refuses(text)
                self.at_cell(message, text)
                self.assertRegex(message, repeats)

    def test_beyond_the_cloth(self):
        text = PLAIN + cell("3 0 -0.35 6 3 0.35", "  matrix resin\n")
        message = self.refuses(text)
        self.at_cell(message, text)
        self.assertIn("reaches beyond the cloth, whose 2 wefts lie within x = 0 .. 3", message)

        text = (
            MATERIALS
            + "warpknit tricot\n  thread T\n  wales 4 pitch 2\n  courses 4 pitch 2\nend\n"
            + cell("8 0 -1 10 4 1")
        )
        message = self.refuses(text)
        self.at_cell(message, text)
        self.assertIn("reaches beyond the cloth, whose 4 guides a bar do not reach all needles in it", message)

    def voxels(self, text, count="24"):
        """How many voxels each part of the cell has, by its yarn's name where that is told; and the messages."""
        source, deck = self.written(text), self.folder / "voxels.inp"
        done = self.succeeds("mesh", source, "--matrix", "--periodic", "--voxel", count, "-o", deck, "--no-progress")
        parts, names, part = {}, {}, None
        for line in deck.read_text().splitlines():
            if named := re.match(r"\*\* (\S+) is yarn '(.*)'", line):
                names[named[1]] = named[2]
            elif line.startswith("*"):
                found = re.match(r"\*ELEMENT, TYPE=\w+, ELSET=(\S+)", line)
                part = names.get(found[1], found[1]) if found else None
            elif part:
                parts[part] = parts.get(part, 0) + 1
        return parts, done.stderr

    def test_a_weave_goes_on_beyond_its_edges_where_a_cell_is_periodic(self):
        """The construction repeats without end: a cell anywhere is the cell inside, moved."""
        inside, _ = self.voxels(PLAIN + cell("0 0 -0.36 3 3 0.36"))
        for corners in ("3 0 -0.36 6 3 0.36", "-6 3 -0.36 -3 6 0.36"):
            with self.subTest(corners):
                beyond, _ = self.voxels(PLAIN + cell(corners))
                self.assertEqual(sorted(beyond.values()), sorted(inside.values()))

    def test_yarns_in_the_faces_are_there(self):
        """Four warps have three gaps; the fourth lies in both faces of the cell, half of its binder in each."""
        bound = MATERIALS + (
            "thread s\n  section racetrack 1.3 0.35\n  material fibre\nend\nthread b\n  section ellipse 0.45 0.18\n"
            "  material fibre\nend\nweave\n  warp s 4 pitch 2.1\n  weft s 6 pitch 2.5\n  profile straight\n  layers 2\n"
            "  binder b every 2 levels 0 1 2 3 2 1\n  binder b every 2 first 2 levels 3 2 1 0 1 2\nend\n"
        )

        def binders(corners):
            parts, _ = self.voxels(bound + cell(corners), "60")
            return sum(count for name, count in parts.items() if "binder" in name)

        at_faces, inside = binders("0 0 -1.2 15 8.4 1.2"), binders("0 1.05 -1.2 15 9.45 1.2")
        self.assertGreater(inside, 0)
        self.assertLess(abs(at_faces - inside), 0.15 * inside)  # a quarter of the binders was missing

    def test_a_cell_that_is_nearly_a_repeat_becomes_one(self):
        exact, _ = self.voxels(PLAIN + cell("0 0 -0.36 3 3 0.36"))
        nearly, messages = self.voxels(PLAIN + cell("0 0 -0.36 2.9983 3.0002 0.36"))
        self.assertEqual(nearly, exact)
        self.assertRegex(
            messages,
            r"warning: this cell is 2\.9983 mm long along x, nearly 1 repeat of its yarns: it is made 3 mm long, "
            r"its high face lies at x = 3 mm",
        )
        self.assertIn("this cell is 3.0002 mm long along y", messages)
        self.assertIn("no whole number of repeats", self.refuses(PLAIN + cell("0 0 -0.36 2.99 3 0.36")))

    def test_advice_on_lengths_works(self):
        """A cell as long as a message says passes the check that gave the message."""
        braid = "braid\n  thread T\n  carriers 5\n  pattern 1/1\n  flat 6\n  angle 43.7\n  length 20\nend\n"
        message = self.refuses(MATERIALS + braid + cell("0 -4 -1 11 4 1", "  matrix resin\n  periodic x\n"))
        length = re.search(r"a periodic cell is (\S+) mm long", message)[1]
        followed = self.refuses(MATERIALS + braid + cell(f"0 -3 -1 {length} 3 1", "  matrix resin\n  periodic x\n"))
        self.assertNotIn("no whole number of repeats", followed)
        self.assertRegex(
            followed, r"yarn 'braider_\d' (goes beyond|runs through|touches) the \w+ face of this cell, y = "
        )
        reach = re.search(r"with a tenth of its thickness beyond, ends at y = (\S+)", followed)[1].lstrip("-")
        # With its free faces there it passes all checks of the cell but the last, of what it may conduct.
        followed = self.refuses(
            MATERIALS + braid + cell(f"0 -{reach} -1 {length} {reach} 1", "  matrix resin\n  periodic x\n"),
            "--physics",
            "conduction",
        )
        self.assertIn("this cell is periodic along x only, a beam", followed)
        self.assertIn("name more axes, or leave out --physics", followed)

    def test_free_faces_of_a_beam(self):
        """Of ends that are said, and of yarns that leave a cell elsewhere."""
        along = ("-1 0.5 0.5", "3 0.5 0.5")
        through = straight(along, ("0.5 0.1 0.17", "0.5 3 0.17")) + cell(
            "0 0 0 1 1 1", "  matrix resin\n  periodic x\n"
        )
        self.assertIn("yarn 'y2' runs through the high face of this cell, y = 1", self.refuses(through))
        beside = straight(along) + cell("0 0.4 0 1 1 1", "  matrix resin\n  periodic x\n")
        self.assertRegex(
            self.refuses(beside),
            r"yarn 'y1' goes beyond the low face of this cell, y = 0\.4: it reaches to y = 0\.3[45]",
        )
        across = straight(along) + cell("0 0 0 1 1 1", "  matrix resin\n  periodic y\n")
        self.assertIn("yarn 'y1' runs through the high face of this cell, x = 1", self.refuses(across))
        short = straight(("0.5 0.5 0.5", "3 0.5 0.5")) + cell("0 0 0 1 1 1", "  matrix resin\n  periodic x\n")
        self.assertIn(
            "not periodic along x: yarn 'y1' runs through its high face, and none comes in opposite",
            self.refuses(short),
        )
        two = straight(along) + cell("0 0 0 1 1 1", "  matrix resin\n  periodic x z\n")
        self.assertIn(
            "not periodic along",
            self.refuses(
                straight(along, ("0.5 0.1 -1", "0.5 0.1 0.5")) + cell("0 0 0 1 1 1", "  matrix resin\n  periodic z\n")
            ),
        )
        self.assertIn("this cell is periodic along x and z only", self.refuses(two))
        self.assertIn("or along one axis (a beam)", self.refuses(two))

    def test_one_axis_has_to_be_meant(self):
        """Where neither the text nor a construction says that there is one axis only, it may be a mistake."""
        text = straight(
            ("-1 0.5 0.5", "3 0.5 0.5"), ("0.5 -1 0.15", "0.5 0.8 0.15"), ("0.2 0.15 0.8", "0.2 0.15 2")
        ) + cell("0 0 0 1 1 1", "  matrix resin\n")
        message = self.refuses(text)
        self.assertIn("or along one axis (a beam), which `periodic x` says", message)
        self.assertIn("without --periodic it is meshed as a piece cut out", message)

    def test_yarns_by_hand_tell_their_repeat(self):
        wave = "".join(f"    {k / 8} 0.5 {0.2 * (k % 16 < 8) - 0.1}\n" for k in range(0, 97, 8))
        text = (
            MATERIALS
            + f"yarn wave T\n  path\n{wave}  end\nend\n"
            + cell("4.5 0 -0.4 5.5 1 0.4", "  matrix resin\n  periodic x y\n")
        )
        message = self.refuses(text)
        self.at_cell(message, text)
        self.assertIn("yarn 'wave' runs through its low face, and none comes in opposite", message)
        self.assertRegex(message, r"its yarns repeat after (2|1\.99\d+|2\.00\d+) mm")

    def test_the_fabric_ends_along_z(self):
        text = straight(("0.5 0.5 0.5", "0.5 0.5 2")) + cell("0 0 0 1 1 1", "  matrix resin\n  periodic x y z\n")
        message = self.refuses(text)
        self.at_cell(message, text)
        self.assertIn("not periodic along z: yarn 'y1' runs through its high face", message)
        self.assertIn("the fabric ends there", message)

    def test_top_and_bottom(self):
        for corners, side in (("0 0 -0.35 3 3 0.3", "top"), ("0 0 -0.3 3 3 0.35", "bottom")):
            text = PLAIN + cell(corners)
            message = self.refuses(text)
            self.at_cell(message, text)
            self.assertRegex(message, f"yarn 'w..._1' goes beyond the {side} of this cell")
            self.assertRegex(
                message, r"a cell that holds it, with a tenth of its thickness beyond, ends at z = -?0\.3[34]"
            )
        text = straight(("-1 0.5 0.15", "2 0.5 0.15")) + cell("0 0 0 1 1 1")
        self.assertIn("yarn 'y1' touches the bottom of this cell", self.refuses(text))
        text = straight(("-1 0.5 0.5", "2 0.5 0.5"), ("0.2 0.15 -1", "0.2 0.15 2")) + cell("0 0 0 1 1 1")
        self.assertIn("yarn 'y2' runs through the top of this cell", self.refuses(text))

    def test_overlapping_yarns(self):
        text = straight(("-1 0.5 0.5", "2 0.5 0.5"), ("0.5 -1 0.7", "0.5 2 0.7")) + cell("0 0 0 1 1 1.2")
        message = self.refuses(text)
        self.assertRegex(message, r"yarns 'y1' and 'y2' overlap, 0\.(1|099)\d* mm deep; --relax moves them apart")
        # Outside of the cell it is nobody's business.
        apart = text.replace("0.5 -1 0.7", "1.4 -1 0.7").replace("0.5 2 0.7", "1.4 2 0.7")
        self.meshes(apart, "--size", "0.4")

    def test_yarns_that_nearly_touch(self):
        text = straight(("-1 0.5 0.5", "2 0.5 0.5"), ("0.5 -1 0.801", "0.5 2 0.801")) + cell("0 0 0 1 1 1.2")
        message = self.refuses(text)
        self.assertRegex(message, r"yarns 'y1' and 'y2' are 0\.00(1|08)\d* mm apart, less than 1 % of their thickness")
        self.assertIn("--relax --gap 0.015 moves them apart", message)

    def test_a_size_coarser_than_a_yarn(self):
        """Of as much as the yarn's thickness, and more: edges on yarns are as long as these are thick."""
        text = PLAIN + cell("0 0 -0.35 3 3 0.35")
        self.assertEqual(self.meshes(text, "--size", "0.3"), "")  # volumes are right, too
        self.assertRegex(
            self.meshes(text, "--size", "0.8"),
            r"warning: 4 yarns are thinner than these edges are long: .* \('w..._\d': 0\.(3|299) mm\)",
        )

    def test_a_size_of_a_thousand_million_tetrahedra(self):
        text = PLAIN + cell("0 0 -0.35 3 3 0.35")
        message = self.refuses(text, "--size", "0.0042")
        found = re.search(
            r"edges of 0\.0042 mm on the yarns make about (\S+) tetrahedra in this cell, more than 1e\+08: --size (\S+) makes ten million, --force goes on",
            message,
        )
        self.assertIsNotNone(found, message)
        self.assertLess(abs(float(found[1]) - 1e9), 0.1e9)
        self.assertLess(abs((0.0042 / float(found[2])) ** 3 - 1e7 / float(found[1])), 0.2e-2)
        self.at_cell(message, text)

        # --force goes on, into the limits.
        forced = self.refuses(text, "--size", "0.0042", "--force", "--memory", "1000", "--timeout", "60")
        self.assertNotIn("--force", forced)
        self.assertRegex(forced, "memory|seconds")

    def test_a_cell_a_thousand_times_too_large(self):
        """The yarns alone are meshed as in any box round them: their mesh does not know the space between."""
        counts = []
        for side in (10, 5000):
            source = self.written(
                straight(("0 0 0", "3 0 0"), ("0 1 0", "3 1 0.5")) + cell(f"1 {-side} {-side} {side} {side} {side}")
            )
            self.succeeds(
                "mesh", source, "--cut", "-o", self.folder / "cut.vtu", "--report", self.folder / "report.json"
            )
            counts.append(json.loads((self.folder / "report.json").read_text())["inputs"][0]["mesh"]["tets"])
        self.assertAlmostEqual(counts[0] / counts[1], 1, delta=1e-3)
        message = self.fails(
            1, "mesh", source, "--matrix", "--matrix-size", "1", "-o", self.folder / "out.inp", "--no-progress"
        )
        self.assertRegex(
            message, r"cell\.txt:\d+:1: error: edges .* make about \S+ tetrahedra in this cell, more than 1e\+08"
        )

    def test_a_face_along_a_yarn(self):
        # Tangent to the yarn from inside, and a hair beyond its surface: nothing but slivers would fit between.
        for y in ("0.15", "0.1502"):
            text = straight((f"-1 {y} 0.5", f"2 {y} 0.5")) + cell("0 0 0 1 1 1")
            message = self.refuses(text)
            self.at_cell(message, text)
            self.assertIn("yarn 'y1' grazes the y low face of this cell, y = 0: its surface runs along it", message)
        # The next yarn of the repeat at the distance that yarns may have, the face in the middle: no matter.
        text = straight(("-1 0.16 0.5", "2 0.16 0.5")) + cell("0 0 0 1 1 1")
        self.meshes(text, "--size", "0.4")
        # What is cut askew is no wedge either.
        text = straight(("-1 -1 0.5", "2 2 0.5"), ("-1 0 0.5", "1 2 0.5"), ("0 -1 0.5", "2 1 0.5")) + cell(
            "0 0 0 1 1 1"
        )
        self.succeeds(
            "mesh", self.written(text), "--matrix", "-o", self.folder / "askew.inp", "--size", "0.1", "--quiet"
        )

    def test_a_cell_inside_a_yarn(self):
        text = straight(("-5 0.5 0.5", "6 0.5 0.5")).replace("diameter 0.3", "diameter 4") + cell(
            "0 0 0 1 1 1", "  matrix resin\n  periodic x y z\n"
        )
        message = self.refuses(text)
        self.at_cell(message, text)
        self.assertIn(
            "no yarn's surface goes through the cell: it lies beside all of them, or whole inside one", message
        )

    def test_edges_of_the_matrix_finer_than_on_the_yarns(self):
        message = self.refuses(PLAIN + cell("0 0 -0.35 3 3 0.35"), "--matrix-size", "0.01")
        self.assertRegex(message, r"--matrix-size is 0\.01, .* but these are 0\.0\d+ mm long: --size makes them finer")

    def test_a_garment_piece_beside_the_yarns(self):
        text = (
            PLAIN
            + "piece back\n  line a 0 0 1 0\n  line b 1 0 0 1\n  line c 0 1 0 0\nend\n"
            + cell("0 0 -0.35 3 3 0.35")
        )
        self.assertIn("piece 'back' is a flat face", self.refuses(text))

    def test_a_gap_asks_for_a_cell_or_relaxation(self):
        self.assertIn(
            "--gap says how yarns are moved apart",
            self.fails(2, "mesh", SAMPLES / "ring.txt", "--gap", "0.1", "-o", self.out),
        )


class Interrupted(Case):
    def below(self, pid):
        """All processes that `pid` has started, and theirs."""
        found = children_of(pid)
        return found + [each for child in found for each in self.below(child)]

    def test_nothing_is_left(self):
        scratch, out = self.folder / "scratch", self.folder / "out"
        for folder in (scratch, out):
            folder.mkdir()
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(number.name):
                process = start(
                    "mesh",
                    SAMPLES / "cell_plain.txt",
                    "--matrix",
                    "--periodic",
                    "--size",
                    "0.05",
                    "--to",
                    "inp,vtu",
                    "-o",
                    out,
                    "--no-progress",
                    env={**environment(), "TMPDIR": str(scratch)},
                )
                while len(started := self.below(process.pid)) < 2:  # the job, and TetGen's worker
                    self.assertIsNone(process.poll(), "it ended before its worker was seen")
                    time.sleep(0.002)
                process.send_signal(number)
                _, message = process.communicate()
                self.assertEqual(process.returncode, 130, message)
                self.assertIn("interrupted", message)
                self.assertEqual([*files_below(out), *files_below(scratch)], [])
                self.gone(started)

    def gone(self, processes):
        """They end; what nobody has buried yet does not count."""
        for pid in processes:
            while True:
                try:
                    if pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z":
                        break
                except (FileNotFoundError, ProcessLookupError):
                    break
                time.sleep(0.002)


class CellMesh(Case):
    def test_voxels_and_their_report(self):
        report = self.folder / "report.json"
        self.succeeds(
            "mesh",
            SAMPLES / "cell_plain.txt",
            "--matrix",
            "--periodic",
            "--voxel",
            "20",
            "-o",
            self.folder / "plain.inp",
            "--report",
            report,
            "--quiet",
        )
        mesh = json.loads(report.read_text())["inputs"][0]["mesh"]
        self.assertEqual(mesh["hexahedra"], 20 * 20 * 5)
        self.assertEqual(mesh["nodes"], 21 * 21 * 6)
        self.assertEqual(mesh["tets"], 0)
        self.assertEqual(mesh["periodic"], "x y")
        self.assertEqual(mesh["load_cases"], 7)
        self.assertLess(abs(mesh["volume"] - 3 * 3 * 0.72), 1e-9)
        # Four elliptic tows of 1.1 x 0.3, a little longer than the cell.
        self.assertLess(abs(mesh["yarn_share"] - 4 * 3.06 * 0.25 * 3.14159 * 1.1 * 0.3 / (9 * 0.72)), 0.03)
        self.assertGreater(mesh["equations"], 0)

    def test_gaps_of_constructions(self):
        # --voxel with --gap: the yarns are that far apart; the report tells what was found where tetrahedra are made.
        source = SAMPLES / "cell_plain.txt"
        message = run("mesh", source, "--matrix", "--periodic", "--gap", "0.05", "--size", "0.5", "-o", self.out).stderr
        self.assertIn("on them edges are as long as they are thick", message)


if __name__ == "__main__":
    unittest.main()
