"""scripts/odb_stiffness.py, which Abaqus' Python runs, on results that CalculiX found of the same deck, through a module that gives
them as Abaqus does. Abaqus itself is not here."""

import ast
import json
import os
import re
import subprocess
import sys
import unittest

import numpy

from program import Case, ROOT, SAMPLES

sys.path.insert(0, str(ROOT / "tests" / "formats" / "decks"))
import inp

SCRIPT = ROOT / "scripts" / "odb_stiffness.py"
ODB = """
import json

class Value:
    def __init__(self, precision, data):
        self.precision, self._data = precision, data
    @property
    def data(self):
        assert self.precision == "SINGLE"
        return self._data
    @property
    def dataDouble(self):
        assert self.precision == "DOUBLE"
        return self._data

class Values:
    def __init__(self, values):
        self.values = values

class Field:
    def __init__(self, precision, of_set):
        self.precision, self.of_set = precision, of_set
    def getSubset(self, region):
        return Values([Value(self.precision, (self.of_set[region], 7.0, 7.0))])

class Frame:
    def __init__(self, fields):
        self.fieldOutputs = fields

class Step:
    def __init__(self, number, said):
        self.number, self.name = number, "Step-%d" % number
        self.frames = [Frame({}), Frame({key: Field(said["precision"], said[key]) for key in ("U", "RF") if key in said})]

class Owner:
    def __init__(self, sets, instances=()):
        self.nodeSets, self.instances = sets, dict(instances)

class Odb:
    def __init__(self, said):
        part = Owner({name: name for name in said["sets"]})
        self.rootAssembly = Owner({}, {"PART-1-1": part})
        self.steps = {step.name: step for step in reversed([Step(k + 1, one) for k, one in enumerate(said["steps"])])}
    def close(self):
        pass

def openOdb(path, readOnly):
    assert readOnly
    with open(path) as file:
        return Odb(json.load(file))
"""


class Odb(Case):
    def setUp(self):
        super().setUp()
        self.modules = self.folder / "modules"
        self.modules.mkdir()
        (self.modules / "odbAccess.py").write_text(ODB)
        (self.modules / "abaqusConstants.py").write_text('SINGLE_PRECISION, DOUBLE_PRECISION = "SINGLE", "DOUBLE"\n')

    def cell(self, sample, *options):
        source = self.folder / "oblique.txt"
        if sample == source.name:
            upright = (SAMPLES / "cell_straight.txt").read_text()
            source.write_text(upright.replace("cell 0 0 0  1 1 0.7", "cell vectors 1 0 0  0.3 1 0  0 0 0.7 at 0 0 0"))
        else:
            source = SAMPLES / sample
        self.succeeds("mesh", source, "--periodic", *options, "-o", self.folder / "cell.inp")
        return self.folder / "cell.inp"

    def solved(self, deck, precision="SINGLE"):
        """The results as an .odb's stand-in: forces on drivers by the work of the nodes that depend on them."""
        done = subprocess.run(["ccx", deck.stem], cwd=self.folder, text=True, capture_output=True, check=False)
        self.assertIn("Job finished", done.stdout)
        model, steps, current = inp.read(deck), [], {}
        for line in deck.with_suffix(".dat").read_text().splitlines():
            words = line.split()
            if " for set " in line:
                kind = "U" if line.startswith(" displacements") else "RF"
                if kind == "U":
                    steps.append({})
                current = steps[-1].setdefault(kind, {})
            elif len(words) == 4:
                current[int(words[0])] = [float(word) for word in words[1:]]
        driver = {members[0]: name for name, members in model.node_sets.items() if re.search(r"DRIVER\d$", name)}
        said = {"sets": list(driver.values()), "steps": []}
        for step in steps:
            force = dict.fromkeys(driver.values(), 0.0)
            for (node, direction, factor), *others in model.equations:
                for number, _, weight in others:
                    if number in driver:
                        force[driver[number]] -= step["RF"][node][direction - 1] * weight / factor
            moved = {name: step["U"][number][0] for number, name in driver.items()}
            said["steps"].append({"precision": precision, "U": moved, "RF": force})
        return said

    def reads(self, said, *options, code=0, name="cell.odb"):
        (self.folder / name).write_text(json.dumps(said))
        environment = {**os.environ, "PYTHONPATH": str(self.modules)}
        done = subprocess.run(
            [sys.executable, SCRIPT, self.folder / name, *options],
            env=environment,
            text=True,
            capture_output=True,
            check=False,
        )
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def compare(self, sample, *options, precision="SINGLE", dry=False):
        deck = self.cell(sample, *options)
        said = self.solved(deck, precision)
        found, expected = self.folder / "found.json", self.folder / "expected.json"
        done = self.reads(said, "--json", found)
        solver = "direct" if dry else "iterative"  # as far as it can be another one than that of the forces
        subprocess.run(
            [sys.executable, ROOT / "scripts" / "homogenize.py", deck, "--solver", solver, "--json", expected],
            check=True,
            capture_output=True,
        )
        found, expected = json.loads(found.read_text()), json.loads(expected.read_text())
        size = numpy.abs(expected["stiffness"]).max(axis=0)
        numpy.testing.assert_allclose(found["stiffness"] / size, expected["stiffness"] / size, atol=1e-5)
        thermal = expected.get("thermal_stress", expected.get("thermal_force"))
        numpy.testing.assert_allclose(found["thermal_stress"], thermal, atol=1e-4 * numpy.abs(thermal).max())
        self.assertEqual(found["kind"], expected["kind"])
        return done.stdout, said

    def test_block(self):
        output, said = self.compare("cell_straight.txt", "--matrix", "--voxel", "8")
        self.assertIn("stiffness of a block (MPa)", output)
        said["steps"].pop()
        self.assertIn("6 steps, and the deck 7: did the job end?", self.reads(said, code=1).stderr)
        for step in said["steps"]:
            del step["RF"]
        self.assertIn("has no U and RF", self.reads(said, code=1).stderr)

    def test_oblique_block_in_double_precision(self):
        self.compare("oblique.txt", "--matrix", "--voxel", "8", precision="DOUBLE")

    def test_plate(self):
        output, _ = self.compare("cell_plain.txt", "--matrix", "--voxel", "8")
        self.assertIn("N/mm, N, N mm", output)

    def test_beam(self):
        output, _ = self.compare("cell_rope.txt", "--order", "1", "--size", "0.4", dry=True)
        self.assertIn("bending", output)

    def test_what_is_missing(self):
        deck = self.cell("cell_straight.txt", "--matrix", "--voxel", "4")
        self.assertIn("other.inp: no such file", self.reads({}, code=1, name="other.odb").stderr)
        done = subprocess.run([sys.executable, SCRIPT, deck], text=True, capture_output=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("abaqus python odb_stiffness.py", done.stderr)
        other = self.folder / "other.inp"
        other.write_text("*HEADING\n")
        self.assertIn("no deck of a unit cell", self.reads({}, "--deck", other, code=1).stderr)
        self.assertIn("no driver nodes", self.reads({"sets": [], "steps": []}, code=1).stderr)

    def test_python_2_reads_it(self):
        """Nothing that the Python 2.7 of Abaqus before 2024 does not know."""
        tree = ast.parse(SCRIPT.read_text())
        later = (
            ast.JoinedStr,
            ast.Starred,
            ast.AnnAssign,
            ast.Nonlocal,
            ast.NamedExpr,
            ast.YieldFrom,
            ast.AsyncFunctionDef,
        )
        for node in ast.walk(tree):
            self.assertNotIsInstance(node, later)
            if isinstance(node, ast.FunctionDef):
                self.assertFalse(node.args.kwonlyargs or node.returns)
            if isinstance(node, ast.Raise):
                self.assertIsNone(node.cause)
        self.assertTrue(SCRIPT.read_text().isascii())


if __name__ == "__main__":
    unittest.main()
