"""Decks as solvers take them: names of sets by the rules of each solver, a deck in two files, fibre fractions in Gmsh's format."""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

import gmsh
import meshio
import numpy as np

from program import Case, PATH, ROOT, SAMPLES

sys.path.insert(0, str(ROOT / "tests" / "formats" / "decks"))
import inp
import names

LONG = "x" * 99
AWKWARD = ["a b", "a_b", "A", "a", LONG + "1", LONG + "2", "7", "all", "*$,&", "Ähre", "a_b_Start", "E1", "d2", "inf"]

# A yarn that is thinner in its middle: its fibres are packed more closely there.
CELL = """fabric 1
material glass
  density 2.5
  elastic isotropic 72000 0.22
end
material resin
  density 1.2
  elastic isotropic 3400 0.35
end
thread t
  tex 300
  density 2.5
  section ellipse 0.8 0.4
  material glass
end
yarn "warp 1" t
  path
    -0.5 0.5 0.5  0.8 0.4
    0 0.5 0.5  0.8 0.4
    0.5 0.5 0.5  0.6 0.3
    1 0.5 0.5  0.8 0.4
    1.5 0.5 0.5  0.8 0.4
  end
end
cell 0 0 0  1 1 1
  matrix resin
  periodic x y z
end
"""


def yarns(own):
    text = "fabric 1\nthread t\n  diameter 0.5\nend\n"
    return text + "".join(
        f'yarn "{name}" t\n  path\n    0 {2 * i} 0\n    {1 + 0.25 * i} {2 * i} 0\n  end\nend\n'
        for i, name in enumerate(own)
    )


def sets_of(path):
    """Names in a deck by what they are names of: element sets and so on; of element sets of yarns how many elements they have."""
    kind, found, sizes, current = path.suffix[1:], {}, {}, None
    lines = path.read_text(encoding="utf-8").splitlines()
    if kind == "inp":
        for line in lines:
            if match := re.match(r"\*(ELEMENT|NSET|ELSET|SURFACE|NODE),.*\b(ELSET|NSET|NAME)=([^,]+)", line):
                current = match[3] if match[1] == "ELEMENT" else None
                found.setdefault(
                    "ELSET" if match[1] == "ELEMENT" else "NSET" if match[1] == "NODE" else match[1], []
                ).append(match[3])
            elif line.startswith("*"):
                current = None
            elif current:
                sizes[current] = sizes.get(current, 0) + 1
    elif kind == "cdb":
        for line in lines:
            if match := re.match(r"CMBLOCK,([^,]+),(\w+), *(\d+)", line):
                found.setdefault("components", []).append(match[1])  # of nodes and elements in one list
                if match[2] == "ELEM":
                    sizes[match[1]] = int(match[3])
    elif kind == "k":
        titles = {}  # of parts
        for number, line in enumerate(lines):
            if line == "*PART":
                found.setdefault("parts", []).append(lines[number + 1])
                titles[int(lines[number + 2][:10])] = lines[number + 1]
            elif line.startswith("*SET_PART_LIST"):
                found.setdefault("part sets", []).append(lines[number + 1])
            elif line.startswith("*SET_NODE_LIST"):
                found.setdefault("node sets", []).append(lines[number + 1])
            if line.startswith("*"):
                current = line
            elif current == "*ELEMENT_SOLID" and not line.startswith("$"):
                part = titles[int(line[8:16])]
                sizes[part] = sizes.get(part, 0) + 1
    elif kind == "bdf":
        for number, line in enumerate(lines):
            if match := re.match(r"\$ SET \d+ is (\S+)$", line):
                found.setdefault("sets", []).append(match[1])
                if range_ := re.match(r"SET \d+ = (\d+) THRU (\d+)", lines[number + 1]):
                    sizes[match[1]] = int(range_[2]) - int(range_[1]) + 1
    elif kind == "unv":
        at = next(k for k in range(len(lines)) if lines[k].strip() == "2467") + 1
        while lines[at].strip() != "-1":
            count = int(lines[at][70:80])
            found.setdefault("groups", []).append(lines[at + 1])
            if lines[at + 2][:10].strip() == "8":
                sizes[lines[at + 1]] = count
            at += 2 + (count + 1) // 2
    return found, sizes


def solved(folder, name):
    done = subprocess.run(["ccx", name], cwd=folder, capture_output=True, text=True)
    words = done.stdout + done.stderr
    assert "Job finished" in words and "*ERROR" not in words and "*WARNING" not in words, words
    return [
        [float(word) for word in line.split()]
        for line in (folder / f"{name}.dat").read_text().splitlines()
        if re.fullmatch(r"[\s\dE.+-]+", line) and line.strip()
    ]


class Names(Case):
    def mesh(self, source, *options):
        """The decks of all formats, and how many elements each yarn has, by the report."""
        report = self.folder / "report.json"
        self.succeeds(
            "mesh", source, *options, "--to", "inp,cdb,k,bdf,unv", "-o", self.folder, "--report", report, "-q"
        )
        return [self.folder / f"{pathlib.Path(source).stem}.{kind}" for kind in ("inp", "cdb", "k", "bdf", "unv")]

    def test_awkward_names(self):
        source = self.folder / "awkward.txt"
        source.write_text(yarns(AWKWARD), encoding="utf-8")
        wanted = None
        for deck in self.mesh(source, "--size", "0.3"):
            kind = deck.suffix[1:]
            with self.subTest(kind):
                found, sizes = sets_of(deck)
                self.assertTrue(found)
                for listed in found.values():
                    self.assertEqual(names.faults_of(listed, kind), [])
                if kind == "unv":  # has no comments
                    continue
                own = names.yarns_of(str(deck))
                by_own = {own.get(name, name): size for name, size in sizes.items() if own.get(name, name) in AWKWARD}
                wanted = wanted or by_own
                self.assertEqual(sorted(by_own), sorted(AWKWARD))
                self.assertEqual(by_own, wanted)
                # Those that may, stay as they are.
                for name in ("a_b", "A", *(("a b", "Ähre") if kind == "k" else ())):
                    self.assertNotIn(name, own)
                    self.assertIn(name, sizes)
                    self.assertNotIn(name, own.values())
                self.assertLess(max(map(len, deck.read_text(encoding="utf-8").splitlines())), 160)

    def test_the_same_again(self):
        source = self.folder / "awkward.txt"
        source.write_text(yarns(AWKWARD), encoding="utf-8")
        first = [deck.read_bytes() for deck in self.mesh(source, "--size", "0.3")]
        self.assertEqual(first, [deck.read_bytes() for deck in self.mesh(source, "--size", "0.3", "-j", "2")])

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed")
    def test_calculix_takes_them(self):
        source = self.folder / "awkward.txt"
        source.write_text(yarns(AWKWARD), encoding="utf-8")
        solved(self.folder, self.mesh(source, "--size", "0.3")[0].stem)

    def test_sections_of_a_cell(self):
        """Stiffness by fibre fraction: several sections a yarn, whose names are theirs."""
        source = self.folder / "cell.txt"
        source.write_text(CELL)
        for deck in self.mesh(source, "--matrix", "--periodic", "--voxel", "16", "--yarn-stiffness", "chamis"):
            with self.subTest(deck.suffix):
                found, _ = sets_of(deck)
                for listed in found.values():
                    self.assertEqual(names.faults_of(listed, deck.suffix[1:]), [])
                everything = {name for listed in found.values() for name in listed}
                self.assertIn("warp 1_Section2" if deck.suffix == ".k" else "warp_1_Section2", everything)
                self.assertIn("Matrix", everything)
                self.assertIn("FaceA", everything)


class Split(Case):
    def write(self, source, *options):
        """One deck and two files of the same mesh."""
        for name, more in (("one", ()), ("two", ("--split-deck",))):
            self.succeeds("mesh", source, *options, *more, "-o", self.folder / f"{name}.inp", "-q")
        return (self.folder / name for name in ("one.inp", "two.inp", "two_mesh.inp"))

    def keywords(self, deck):
        return {
            line.strip()[1:].split(",")[0].upper()
            for line in deck.read_text().splitlines()
            if line.strip().startswith("*") and not line.startswith("**")
        }

    def test_what_is_where(self):
        for source, options in (
            (PATH, ("--size", "0.2")),
            (SAMPLES / "cell_plain.txt", ("--matrix", "--periodic", "--voxel", "8")),
        ):
            with self.subTest(source):
                one, two, mesh = self.write(source, *options)
                self.assertLessEqual(
                    self.keywords(mesh), {"NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "DISTRIBUTION"}
                )
                self.assertEqual(self.keywords(mesh) & self.keywords(two), set())
                self.assertEqual(self.keywords(mesh) | self.keywords(two), self.keywords(one) | {"INCLUDE"})
                self.assertIn("\n*INCLUDE, INPUT=two_mesh.inp\n", two.read_text())
                # Put in where it is included it is the one deck, but for comments.
                whole = two.read_text().replace("*INCLUDE, INPUT=two_mesh.inp\n", mesh.read_text())
                cards = [
                    [line for line in text.splitlines() if not line.startswith("**")]
                    for text in (whole, one.read_text())
                ]
                self.assertEqual(*cards)
                self.assertEqual(len(meshio.read(two).points), len(inp.read(one).nodes))

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed")
    def test_calculix_has_the_same_results(self):
        for source, options in (
            (PATH, ("--size", "0.2")),
            (SAMPLES / "cell_plain.txt", ("--matrix", "--periodic", "--voxel", "6")),
        ):
            with self.subTest(source):
                self.write(source, *options)
                first, second = solved(self.folder, "one"), solved(self.folder, "two")
                self.assertGreater(len(first), 50)
                self.assertEqual([len(row) for row in first], [len(row) for row in second])
                for a, b in zip(first, second):
                    np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12)

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed")
    def test_homogenize_reads_both(self):
        self.write(SAMPLES / "cell_fibre.txt", "--matrix", "--periodic", "--voxel", "6")
        found = []
        for name in ("one", "two"):
            for solver in ("direct", "iterative"):
                result = self.folder / "result.json"
                done = subprocess.run(
                    [
                        sys.executable,
                        ROOT / "scripts" / "homogenize.py",
                        self.folder / f"{name}.inp",
                        "--solver",
                        solver,
                        "--json",
                        result,
                    ],
                    capture_output=True,
                    text=True,
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                found.append(json.loads(result.read_text())["stiffness"])
        self.assertEqual(found[0], found[2])
        self.assertEqual(found[1], found[3])

    def test_both_or_none(self):
        """They appear together, the report has both, and a run that goes on from it wants both."""
        report = self.folder / "report.json"
        arguments = (
            "mesh",
            PATH,
            "--size",
            "0.3",
            "--split-deck",
            "-o",
            self.folder / "d.inp",
            "--report",
            report,
            "-q",
        )
        self.succeeds(*arguments)
        entry = json.loads(report.read_text())["inputs"][0]
        self.assertEqual([pathlib.Path(output["path"]).name for output in entry["outputs"]], ["d.inp", "d_mesh.inp"])
        self.assertEqual(entry["outputs"][1]["entities"]["nodes"], len(inp.read(self.folder / "d_mesh.inp").nodes))
        before = (self.folder / "d_mesh.inp").read_bytes()
        (self.folder / "d_mesh.inp").unlink()
        self.succeeds(*arguments, "--resume")
        self.assertEqual((self.folder / "d_mesh.inp").read_bytes(), before)
        # One that cannot be written keeps the other one away.
        (self.folder / "e_mesh.inp").mkdir()
        self.fails(1, "mesh", PATH, "--size", "0.3", "--split-deck", "-o", self.folder / "e.inp")
        self.assertFalse((self.folder / "e.inp").exists())

    def test_refusals(self):
        message = self.fails(2, "mesh", PATH, "--to", "vtu", "--split-deck", "-o", self.folder)
        self.assertIn("--split-deck is an option of inp, and nothing is written as that", message)
        message = self.fails(2, "mesh", PATH, "--to", "inp", "--split-deck", "-o", "-")
        self.assertIn("--split-deck makes two files, and standard output takes one", message)
        message = self.fails(1, "mesh", PATH, "--size", "0.3", "--split-deck", "-o", self.folder / "a b.inp")
        self.assertIn("'a b_mesh.inp'", message)
        self.assertFalse((self.folder / "a b.inp").exists())
        message = self.fails(1, "mesh", PATH, "--size", "0.3", "--split-deck", "-o", self.folder / f"{'y' * 130}.inp")
        self.assertIn("more than 124 bytes", message)
        # The mesh of one would replace the deck of the other.
        for name in ("p.txt", "p_mesh.txt"):
            shutil.copy(PATH, self.folder / name)
        message = self.fails(
            2, "mesh", self.folder / "p.txt", self.folder / "p_mesh.txt", "--split-deck", "-o", self.folder / "out/"
        )
        self.assertIn("p_mesh.inp", message)
        self.succeeds("mesh", PATH, "--size", "0.3", "--to", "inp,vtu", "--split-deck", "-o", self.folder, "-q")

    @unittest.skipUnless(shutil.which("ccx"), "CalculiX is not installed")
    def test_the_longest_name_that_is_taken(self):
        stem = "y" * (124 - len("_mesh.inp"))
        self.succeeds("mesh", PATH, "--size", "0.3", "--split-deck", "-o", self.folder / f"{stem}.inp", "-q")
        shutil.copy(self.folder / f"{stem}.inp", self.folder / "short.inp")
        solved(self.folder, "short")


class Fractions(Case):
    def test_gmsh_has_what_vtu_has(self):
        (self.folder / "cell.txt").write_text(CELL)
        for options in ((), ("--order", "2"), ("--voxel", "16")):
            with self.subTest(options):
                self.compare(*options)

    def compare(self, *options):
        self.succeeds(
            "mesh",
            self.folder / "cell.txt",
            "--matrix",
            "--periodic",
            *options,
            "--to",
            "msh,vtu",
            "-o",
            self.folder,
            "-q",
        )
        wanted = np.concatenate(meshio.read(self.folder / "cell.vtu").cell_data["fibre_fraction"])
        own = meshio.read(self.folder / "cell.msh")
        solid = [i for i, block in enumerate(own.cells) if block.type in ("tetra", "tetra10", "hexahedron")]
        found = np.concatenate([own.cell_data["fibre_fraction"][i] for i in solid])
        self.assertEqual(wanted.min(), 0)
        # At the thinnest place: 300 tex of 2.5 g/cm3 in an ellipse of 0.6 x 0.3 mm.
        self.assertAlmostEqual(wanted.max(), 0.12 / (np.pi / 4 * 0.6 * 0.3), delta=0.02)
        np.testing.assert_array_equal(found, wanted)
        gmsh.initialize()
        try:
            gmsh.option.setNumber("General.Verbosity", 1)
            gmsh.open(str(self.folder / "cell.msh"))
            (tag,) = gmsh.view.getTags()
            kind, elements, values, _, components = gmsh.view.getModelData(tag, 0)
            self.assertEqual((kind, components), ("ElementData", 1))
            share = dict(zip(elements, (value[0] for value in values)))
            total = sum(map(len, gmsh.model.mesh.getElements()[1]))
            self.assertEqual(len(share), total)
            self.assertEqual([share[e] for e in range(total - len(wanted) + 1, total + 1)], wanted.tolist())
        finally:
            gmsh.finalize()


class ModifiedTetrahedra(Case):
    """`--tetrahedron C3D10M`: another element on the same nodes, of Abaqus alone."""

    def test_only_the_element_is_another_one(self):
        for name, options in (("usual", ()), ("modified", ("--tetrahedron", "C3D10M"))):
            self.succeeds("mesh", PATH, "--size", "0.3", "--order", "2", *options, "-o", self.folder / f"{name}.inp")
        modified = (self.folder / "modified.inp").read_text()
        self.assertEqual(modified.count("TYPE=C3D10M,"), 4)  # a yarn each
        self.assertEqual(modified.replace("TYPE=C3D10M,", "TYPE=C3D10,"), (self.folder / "usual.inp").read_text())

    def test_refusals(self):
        deck = self.folder / "deck.inp"
        asked = ("mesh", PATH, "--size", "0.3", "--tetrahedron", "C3D10M", "-o", deck)
        self.assertIn(
            "that Abaqus has and CalculiX has not", self.fails(2, *asked, "--order", "2", "--solver", "calculix")
        )
        self.assertIn("it goes with --order", self.fails(2, *asked))
        self.assertIn(
            "has ten nodes, and this mesh has four a tetrahedron: say --order 2", self.fails(1, *asked, "--order", "1")
        )
        self.assertFalse(deck.exists())
        self.succeeds(
            "mesh",
            SAMPLES / "cell_fibre.txt",
            "--matrix",
            "--periodic",
            "--order",
            "2",
            "--tetrahedron",
            "C3D10M",
            "-o",
            deck,
        )
        done = subprocess.run(
            [sys.executable, ROOT / "scripts" / "homogenize.py", deck], capture_output=True, text=True
        )
        self.assertEqual(done.returncode, 1)
        self.assertIn("elements of type C3D10M, which this script does not know", done.stderr)


if __name__ == "__main__":
    unittest.main()
