"""scripts/reference-cells: the errors that it states, on sequences made for it; the cells of samples/benchmark mesh; the smallest one
by the whole way, against the closed forms; the committed table."""

import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import unittest

import numpy as np

from program import Case, PROGRAM, ROOT, environment

SCRIPTS = ROOT / "scripts"
sys.path.insert(0, str(SCRIPTS))
import array_flow
import cell_elements
import convergence
import homogenize
import reference_cells
from array_conduction import array_of_cylinders

BENCHMARK = ROOT / "samples" / "benchmark"
BELIEVED = (2.0, 5.0)
EDGES = (0.2, 0.14, 0.1)


def record(**changed):
    """One that agrees: of second order, tending to 5, at edges of 2 and 1."""
    return {
        "cell": "a",
        "property": "stiffness",
        "quantity": "C",
        "unit": "MPa",
        "method": "tetrahedra",
        "level": ["coarse", "medium"],
        "size": [2, 1],
        "elements": [1, 8],
        "value": [5.4, 5.1],
        "error": [1.2, 0.3],
        "limit": 5.1,
        "order": None,
        "exact": None,
        **changed,
    }


class Errors(unittest.TestCase):
    def test_of_a_known_order(self):
        """Values 7 + c h^p tend to 7; every error holds, the fine one is a quarter larger than the truth."""
        for order in (2.1, 3.0, 4.4):
            for factor in (0.3, -0.3):
                values = [7 + factor * h**order for h in EDGES]
                limit, errors, shown = convergence.stated(EDGES, values, BELIEVED)
                self.assertAlmostEqual(
                    limit, 7, delta=2e-3 * abs(values[-1] - 7)
                )  # orders are tried in steps of a hundredth
                self.assertAlmostEqual(shown, order, delta=0.011)
                self.assertAlmostEqual(errors[2] / (1.25 * abs(values[2] - 7)), 1, delta=2e-3)
                for value, error in zip(values, errors):
                    self.assertGreater(error, abs(value - 7))

    def test_of_two_meshes(self):
        """Three and four times their change, by hand."""
        limit, errors, shown = convergence.stated((2, 1), (5.4, 5.1), BELIEVED)
        self.assertEqual((limit, shown), (5.1, None))
        np.testing.assert_allclose(errors, (1.2, 0.9))

    def test_a_mesh_says_nothing_that_a_finer_one_knows(self):
        errors = [convergence.stated(EDGES, (3.0, 2.9, last), BELIEVED)[1][:2] for last in (2.89, 2.2)]
        self.assertEqual(*errors)
        limit, two, _ = convergence.stated(EDGES, (3.0, 2.9, 2.2), BELIEVED)
        self.assertGreater(abs(2.9 - limit), two[1])  # what comes out last contradicts the medium one

    def test_oscillating(self):
        limit, errors, shown = convergence.stated(EDGES, (1.0, 0.8, 0.9), BELIEVED)
        self.assertEqual((limit, shown), (0.9, None))
        self.assertAlmostEqual(errors[2], 0.6)

    def test_no_order_that_is_believed(self):
        """Faster than believed: three times the last change. Slower: three times the range, which may be less than the truth; a closed form
        finds that out."""
        values = [1 + h**7 for h in EDGES]
        _, errors, shown = convergence.stated(EDGES, values, BELIEVED)
        self.assertIsNone(shown)
        self.assertAlmostEqual(errors[2], 3 * (values[1] - values[2]))
        values = [1 + h**0.1 for h in EDGES]
        limit, errors, shown = convergence.stated(EDGES, values, BELIEVED)
        self.assertEqual((limit, shown), (values[2], None))
        self.assertAlmostEqual(errors[2], 3 * (values[0] - values[2]))
        one = record(level=list(reference_cells.LEVELS), value=values, error=errors, limit=limit, exact=1.0)
        self.assertIn("from the exact", "".join(reference_cells.faults_of([one])))

    def test_of_a_tensor(self):
        """Two equal values are no precision where another entry changes."""
        found = convergence.of_tensor((2, 1), [[5.0, 5.0], [10.0, 11.0]], BELIEVED)
        np.testing.assert_allclose([errors for _, errors, _ in found], [[5 * 0.4, 5 * 3 / 11], [4, 3]])

    def test_converged_to_rounding(self):
        limit, errors, _ = convergence.stated(EDGES, (4.0, 4.0, 4.0), BELIEVED)
        self.assertEqual(limit, 4.0)
        np.testing.assert_allclose(errors, 4e-6)

    def test_meshes_that_are_equally_fine(self):
        with self.assertRaisesRegex(ValueError, "coarsest first"):
            convergence.stated((0.1, 0.1), (1.0, 2.0), BELIEVED)


class Agreement(unittest.TestCase):
    def test_what_agrees(self):
        voxels = record(method="voxels", value=[6.0, 5.5], error=[1.5, 0.75], limit=5.5)
        self.assertEqual(reference_cells.faults_of([record(), voxels]), [])

    def test_what_does_not(self):
        apart = record(method="voxels", value=[6.0, 5.9], error=[1.5, 0.2], limit=5.9)
        for records, wanted in (
            ([record(), apart], "a, C: no value lies within the errors of all meshes; 0.3 MPa are missing"),
            ([record(limit=5.5)], "a, C, tetrahedra, medium: 5.1 is 0.4 from the limit 5.5, and states 0.3"),
            ([record(exact=4.7)], "medium: 5.1 is 0.4 from the exact 4.7"),
        ):
            faults = reference_cells.faults_of(records)
            self.assertEqual(len(faults), 1, faults)
            self.assertIn(wanted, faults[0])


class Committed(Case):
    def test_table_and_page(self):
        """They are each other's, and every mesh agrees; what is changed by hand is found."""
        self.assertEqual(reference_cells.check(BENCHMARK), [])
        changes = (
            ("RESULTS.md", r"± \d", "± 99"),
            ("results.json", r'"value": \[\d', '"value": [9'),
            ("results.json", r'"limit": \d', '"limit": 9'),
            ("results.json", r'"exact": 0\.\d', '"exact": 0.9'),
        )
        for number, (name, old, new) in enumerate(changes):
            folder = pathlib.Path(shutil.copytree(BENCHMARK, self.folder / str(number)))
            path = folder / name
            text = path.read_text()
            path.write_text(re.sub(old, new, text, count=1))
            self.assertNotEqual(path.read_text(), text)
            self.assertNotEqual(reference_cells.check(folder), [])

    def test_all_cells_are_there(self):
        self.assertEqual(sorted(reference_cells.CELLS), sorted(path.stem for path in BENCHMARK.glob("*.txt")))
        for name in reference_cells.CELLS:
            text = (BENCHMARK / f"{name}.txt").read_text()
            self.assertTrue(text.startswith("# Round numbers"), name)
            self.assertEqual(len(re.findall(r"^  (?:elastic|expansion|conductivity) ", text, re.M)), 6, name)
            self.assertIn("  periodic x y z\n", text)

    def test_they_mesh(self):
        """The coarsest meshes of all; their yarns have the volume of their sections to two per cent."""
        for name in reference_cells.CELLS:
            with self.subTest(name):
                coarse = reference_cells.Run(name, "stiffness", "tetrahedra", 0)
                report = self.folder / "report.json"
                self.succeeds(
                    "mesh",
                    BENCHMARK / f"{name}.txt",
                    "--matrix",
                    "--periodic",
                    "--size",
                    coarse.size,
                    "--order",
                    "2",
                    "-o",
                    self.folder / "cell.inp",
                    "--report",
                    report,
                )
                facts = json.loads(report.read_text())["inputs"][0]["mesh"]
                self.assertGreater(facts["tets"], 100)


class Command(Case):
    def command(self, *more):
        return [
            sys.executable,
            SCRIPTS / "reference_cells.py",
            "--selvage",
            PROGRAM,
            "--out",
            self.folder / "out",
            *more,
        ]

    def run_script(self, *more):
        return subprocess.run(self.command(*more), capture_output=True, text=True, env=environment(), check=False)

    def test_smallest_cell(self):
        """Two sizes of all, twice; the values against closed forms, by the errors that are stated."""
        first = self.run_script("--cells", "fibres_square", "--quick")
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertIn("[10/10] fibres_square, conductivity, voxels, medium: 7776 elements, ", first.stderr)
        again = self.run_script("--cells", "fibres_square", "--quick")
        self.assertEqual(again.stderr.count(" elements, kept"), 10)
        self.assertEqual(again.stdout, first.stdout)
        self.assertIn("| [`fibres_hexagonal`](fibres_hexagonal.txt) | not run |", first.stdout)
        records = {
            (one["quantity"], one["method"]): one
            for one in json.loads((self.folder / "out" / "results.json").read_text())
        }
        pitch = 0.012533141
        exact = {
            "k x": 0.75,
            "k y": 0.2 * array_of_cylinders("square", 0.5, 6.5),
            "K x": pitch**2 * array_flow.along("square", 0.5),
            "K z": pitch**2 * array_flow.across("square", 0.5),
        }
        for name, wanted in exact.items():
            found = records[name, "tetrahedra"]
            self.assertAlmostEqual(found["exact"] / wanted, 1, delta=1e-6)
            for value, error in zip(found["value"], found["error"]):
                self.assertLess(abs(value - wanted), error)
            self.assertLess(found["error"][-1], 0.02 * wanted)
        # The matrix of the fibres' stiffness is that of squares.
        stiffness = {name: one["value"][-1] for (name, method), one in records.items() if method == "tetrahedra"}
        for one, other in (("C yy,yy", "C zz,zz"), ("C xx,yy", "C xx,zz"), ("C xy,xy", "C xz,xz")):
            self.assertAlmostEqual(stiffness[one] / stiffness[other], 1, delta=1e-3)

    def test_a_changed_text_is_computed_again(self):
        folder = shutil.copytree(BENCHMARK, self.folder / "benchmark")
        run = reference_cells.Run("fibres_square", "conductivity", "tetrahedra", 0)
        kept, reference_cells.FOLDER = reference_cells.FOLDER, folder
        self.addCleanup(setattr, reference_cells, "FOLDER", kept)
        store = reference_cells.Store(self.folder / "out", PROGRAM)
        store.path(run).parent.mkdir(parents=True)
        store.path(run).write_text(json.dumps({"key": store.key(run), "result": {"elements": 1}}))
        self.assertEqual(store.find(run), {"elements": 1})
        text = folder / "fibres_square.txt"
        text.write_text(text.read_text().replace("conductivity 1.3", "conductivity 1.4"))
        self.assertIsNone(store.find(run))

    def test_stopped(self):
        """By Ctrl-C: what was done is kept, nothing half done is."""
        running = subprocess.Popen(
            self.command("--cells", "fibres_hexagonal", "--only", "stiffness"),
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env=environment(),
        )
        self.assertIn("[1/6] fibres_hexagonal", running.stderr.readline())
        os.killpg(running.pid, signal.SIGINT)
        _, rest = running.communicate()
        self.assertEqual(running.returncode, 130, rest)
        self.assertIn("stopped; what was done is kept", rest)
        self.assertNotIn("Traceback", rest)
        self.assertEqual(
            [path.name for path in (self.folder / "out").rglob("*.json")], ["stiffness_tetrahedra_coarse.json"]
        )
        self.assertEqual(list((self.folder / "out").rglob("*.part")), [])

    def test_errors(self):
        told = self.run_script("--cells", "plain")
        self.assertEqual(told.returncode, 2)
        self.assertIn("'plain' is none of fibres_square, ", told.stderr)
        for words in (["--write", "--check"], ["--write", "--quick"]):
            told = self.run_script(*words)
            self.assertEqual(told.returncode, 2)
            self.assertIn("--write", told.stderr)

    def test_a_run_that_fails(self):
        """A program that meshes nothing: each run says so, and no cell agrees."""
        program = self.folder / "selvage"
        program.write_text("#!/bin/sh\necho 'selvage 0'\n[ \"$1\" = --version ] || { echo 'error: no' >&2; exit 1; }\n")
        program.chmod(0o755)
        told = subprocess.run(
            [
                sys.executable,
                SCRIPTS / "reference_cells.py",
                "--selvage",
                program,
                "--out",
                self.folder / "out",
                "--cells",
                "fibres_square",
                "--only",
                "permeability",
            ],
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(told.returncode, 1)
        self.assertIn("[3/3] fibres_square, permeability, tetrahedra, fine: failed", told.stderr)
        self.assertIn("could not be meshed", told.stderr)
        self.assertIn("| [`fibres_square`](fibres_square.txt) | not run | not run | not run | not run |", told.stdout)


class Solver(Case):
    def test_with_and_without_scipy(self):
        """The iterative solver puts its matrix together where SciPy is there: the same stiffness."""
        deck, found = self.folder / "cell.inp", []
        self.succeeds(
            "mesh",
            BENCHMARK / "fibres_square.txt",
            "--matrix",
            "--periodic",
            "--size",
            "0.003",
            "--order",
            "2",
            "-o",
            deck,
            "--quiet",
        )
        kept = cell_elements.sparse
        self.addCleanup(setattr, cell_elements, "sparse", kept)
        for module in (kept, None):
            cell_elements.sparse = module
            found.append(np.array(homogenize.homogenize(deck, "ccx", self.folder, solver="iterative")["stiffness"]))
        np.testing.assert_allclose(*found, rtol=0, atol=1e-8 * found[0].max())


if __name__ == "__main__":
    unittest.main()
