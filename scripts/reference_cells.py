"""The unit cells of samples/benchmark on three meshes each, with the error of each: see scripts/reference-cells, which calls this.

Every run is a command that anyone can give (scripts/homogenize, scripts/permeability); what it found is kept in the output folder with its mesh, and is
not computed again while the cell's text, the options, the program and the scripts are the same.
"""

import argparse
import dataclasses
import datetime
import functools
import hashlib
import json
import math
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests/cli"))  # the closed forms

import array_conduction
import array_flow
import convergence
import reference_page

FOLDER = ROOT / "samples" / "benchmark"
SOLVERS = ("homogenize.py", "cell_*.py", "permeability.py", "pore_*.py")  # what a result depends on beside the program
LEVELS = ("coarse", "medium", "fine")
# Orders of convergence that are believed, by property and method: of the energies of ten-node tetrahedra up to the formal one, twice their
# degree; of flow those of scripts/permeability.
ORDERS = {
    ("stiffness", "tetrahedra"): (2.0, 4.0),
    ("conductivity", "tetrahedra"): (2.0, 4.0),
    ("permeability", "tetrahedra"): (2.0, 5.0),
    ("stiffness", "voxels"): (1.0, 3.0),
    ("conductivity", "voxels"): (1.0, 3.0),
}
STIFFNESS = ["xx,xx", "yy,yy", "zz,zz", "xx,yy", "xx,zz", "yy,zz", "xy,xy", "xz,xz", "yz,yz"]
UNITS = {"stiffness": "MPa", "conductivity": "W/(m K)", "permeability": "mm2"}


@dataclasses.dataclass(frozen=True)
class Sizes:
    """Of a cell: the thickness of its thinnest yarn, mm; edges of tetrahedra as shares of that; voxels along the longest side."""

    thickness: float
    shares: tuple
    voxels: tuple


CELLS = {
    "fibres_square": Sizes(0.01, (0.2, 0.14, 0.1), (24, 36, 54)),
    "fibres_hexagonal": Sizes(0.01, (0.2, 0.14, 0.1), (40, 60, 90)),
    "plain_glass": Sizes(0.3, (0.9, 0.6, 0.4), (28, 42, 63)),
    "twill_carbon": Sizes(0.3, (0.9, 0.6, 0.4), (48, 72, 100)),
    "satin_carbon": Sizes(0.3, (0.9, 0.6, 0.4), (60, 84, 118)),
    "orthogonal_glass": Sizes(0.3, (0.9, 0.6, 0.4), (28, 40, 56)),
    "jersey_glass": Sizes(0.16, (0.6, 0.42, 0.28), (20, 28, 40)),
    "braid_carbon": Sizes(0.4, (0.9, 0.6, 0.4), (36, 50, 70)),
}


class Failure(Exception):
    pass


@dataclasses.dataclass(frozen=True)
class Run:
    """One mesh of a cell, for one property."""

    cell: str
    property: str
    method: str
    level: int

    @property
    def name(self):
        return f"{self.property}_{self.method}_{LEVELS[self.level]}"

    @property
    def size(self):
        sizes = CELLS[self.cell]
        return (
            sizes.voxels[self.level]
            if self.method == "voxels"
            else round(sizes.thickness * sizes.shares[self.level], 9)
        )

    def command(self, selvage, folder, result):
        script = "permeability.py" if self.property == "permeability" else "homogenize.py"
        words = ["--voxel" if self.method == "voxels" else "--size", str(self.size)]
        if self.property != "permeability":
            words += ["--solver", "iterative", "--periodic"]
            words += ["--order", "2"] if self.method == "tetrahedra" else []
            words += ["--physics", "conduction"] if self.property == "conductivity" else []
        return [
            sys.executable,
            f"scripts/{script}",
            f"samples/benchmark/{self.cell}.txt",
            *words,
            "--selvage",
            selvage,
            "--keep",
            str(folder),
            "--json",
            str(result),
        ]


def all_runs(cells, properties, levels):
    return [
        Run(cell, *key, level) for cell in cells for key in ORDERS if key[0] in properties for level in range(levels)
    ]


class Store:
    """What was computed, in a folder for each cell: NAME.json with the result, NAME/ with the mesh."""

    def __init__(self, folder, selvage):
        self.folder, self.selvage = folder, selvage
        parts = [pathlib.Path(selvage), *sorted(pathlib.Path(selvage).parent.glob("*tetgen*"))]
        parts += sorted(path for pattern in SOLVERS for path in (ROOT / "scripts").glob(pattern))
        self.version = hashlib.sha256(b"".join(path.read_bytes() for path in parts)).hexdigest()

    def key(self, run):
        text = (FOLDER / f"{run.cell}.txt").read_text()
        return hashlib.sha256(repr((self.version, text, run.command("", "", ""))).encode()).hexdigest()

    def path(self, run):
        return self.folder / run.cell / f"{run.name}.json"

    def find(self, run):
        """The result, or None where it is to be computed."""
        path = self.path(run)
        if not path.exists():
            return None
        kept = json.loads(path.read_text())
        return kept["result"] if kept["key"] == self.key(run) else None

    def compute(self, run):
        path = self.path(run)
        meshes, found = path.with_suffix(""), path.with_suffix(".part")
        meshes.mkdir(parents=True, exist_ok=True)
        started = time.monotonic()
        try:
            done = subprocess.run(
                run.command(self.selvage, meshes, found), cwd=ROOT, capture_output=True, text=True, check=False
            )
            if done.returncode != 0:
                raise Failure(f"{run.cell}, {run.name}: " + done.stderr.strip()[-2000:])
            result = json.loads(found.read_text())
            found.write_text(
                json.dumps({"key": self.key(run), "seconds": time.monotonic() - started, "result": result})
            )
            found.replace(path)
        finally:
            found.unlink(missing_ok=True)
        return result


def elements_of(run, result):
    return result["meshes"][0]["tets"] if run.property == "permeability" else result["elements"]


def quantities_of(run, result):
    """Name -> value of what is compared."""
    if run.property == "stiffness":
        index = {name: k for k, name in enumerate(result["order"])}
        pairs = [(name, name.split(",")) for name in STIFFNESS]
        return {f"C {name}": result["stiffness"][index[a]][index[b]] for name, (a, b) in pairs}
    tensor = result["tensor"] if run.property == "conductivity" else result["permeability_mm2"]
    letter = "k" if run.property == "conductivity" else "K"
    return {f"{letter} {axis}": tensor[k][k] for k, axis in enumerate("xyz")}


@functools.cache
def closed_forms(cell):
    """Name -> value of what is known without a mesh: of arrays of cylinders along x."""
    if not cell.startswith("fibres_"):
        return {}
    text, kind = (FOLDER / f"{cell}.txt").read_text(), cell.removeprefix("fibres_")
    diameter = float(re.search(r"^  diameter (\S+)", text, re.M)[1])
    pitch = float(re.search(r"^cell 0 0 0  \S+ (\S+)", text, re.M)[1])
    inner, outer = (float(word) for word in re.findall(r"^  conductivity (\S+)", text, re.M))
    share = math.pi / 4 * (diameter / pitch) ** 2 / array_flow.HEIGHT[kind]
    across = outer * array_conduction.array_of_cylinders(kind, share, inner / outer)
    flow = pitch**2 * array_flow.across(kind, share)
    return {
        "k x": share * inner + (1 - share) * outer,
        "k y": across,
        "k z": across,
        "K x": pitch**2 * array_flow.along(kind, share),
        "K y": flow,
        "K z": flow,
    }


def errors_of(elements, rows, believed):
    """Limits, errors and orders of a tensor's entries; the fineness is the cube root of the number of elements."""
    try:
        return convergence.of_tensor([count ** (-1 / 3) for count in elements], rows, believed)
    except ValueError as error:
        raise Failure(f"{error}; elements: {elements}") from error


def records_of(cell, results):
    """Of a cell's results (Run -> result) a record for each quantity and method: values and errors by size, and their limit."""
    exact, records = closed_forms(cell), []
    for (prop, method), believed in ORDERS.items():
        found = sorted(
            ((run, result) for run, result in results.items() if (run.property, run.method) == (prop, method)),
            key=lambda one: one[0].level,
        )
        if len(found) < 2:
            continue
        elements = [elements_of(*one) for one in found]
        values = [quantities_of(*one) for one in found]
        rows = {name: [of_mesh[name] for of_mesh in values] for name in values[0]}
        for (name, numbers), (limit, errors, order) in zip(
            rows.items(), errors_of(elements, list(rows.values()), believed)
        ):
            records.append(
                {
                    "cell": cell,
                    "property": prop,
                    "quantity": name,
                    "unit": UNITS[prop],
                    "method": method,
                    "level": [LEVELS[run.level] for run, _ in found],
                    "size": [run.size for run, _ in found],
                    "elements": elements,
                    "value": numbers,
                    "error": errors,
                    "limit": limit,
                    "order": order,
                    "exact": exact.get(name),
                }
            )
    return records


def faults_of(records):
    """Where a stated error does not hold: sentences."""
    faults = []
    for record in records:
        where = f"{record['cell']}, {record['quantity']}, {record['method']}"
        for level, value, error in zip(record["level"], record["value"], record["error"]):
            for name in ("limit", "exact"):
                if record[name] is not None and abs(value - record[name]) > error:
                    faults.append(
                        f"{where}, {level}: {value:.6g} is {abs(value - record[name]):.2g} from the {name} {record[name]:.6g}, and states {error:.2g}"
                    )
    for cell, quantity in dict.fromkeys((record["cell"], record["quantity"]) for record in records):
        of_one = [record for record in records if (record["cell"], record["quantity"]) == (cell, quantity)]
        intervals = [pair for record in of_one for pair in zip(record["value"], record["error"])]
        if (gap := convergence.apart(intervals)) > 0:
            faults.append(
                f"{cell}, {quantity}: no value lies within the errors of all meshes; {gap:.2g} {of_one[0]['unit']} are missing"
            )
    return faults


def table(records):
    """The records as JSON, one a line."""
    return "[\n" + ",\n".join(json.dumps(record) for record in records) + "\n]\n"


def heading(selvage):
    version = subprocess.run([selvage, "--version"], capture_output=True, text=True, check=True).stdout.splitlines()[0]
    commit = subprocess.run(
        ["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=False
    ).stdout.strip()
    return f"Generated by `scripts/reference-cells --write` on {datetime.date.today()}, {version}, commit {commit or 'unknown'}."


def say(text):
    print(text, file=sys.stderr, flush=True)


def compute_all(store, runs):
    """Computes what is not there; says how far it is. Returns what went wrong."""
    wrong = []
    for number, run in enumerate(runs, 1):
        started = time.monotonic()
        was_there = store.find(run) is not None
        label = f"[{number}/{len(runs)}] {run.cell}, {run.property}, {run.method}, {LEVELS[run.level]}"
        try:
            result = store.find(run) if was_there else store.compute(run)
        except Failure as failure:
            wrong.append(str(failure))
            say(f"{label}: failed")
            continue
        say(
            f"{label}: {elements_of(run, result)} elements, "
            + ("kept" if was_there else f"{time.monotonic() - started:.0f} s")
        )
    return wrong


def is_near(one, other):
    """The same but for what another machine's libraries round."""
    return len(one) == len(other) and all(math.isclose(a, b, rel_tol=1e-7) for a, b in zip(one, other))


def check(folder):
    """Are the committed table and page what each other and the errors' definition say?"""
    try:
        records, page = json.loads((folder / "results.json").read_text()), (folder / "RESULTS.md").read_text()
    except FileNotFoundError as error:
        raise Failure(f"{error.filename} is not there: --write makes it") from error
    wrong = []
    for cell, prop, method in dict.fromkeys(
        (record["cell"], record["property"], record["method"]) for record in records
    ):
        own = [
            record
            for record in records
            if (record["cell"], record["property"], record["method"]) == (cell, prop, method)
        ]
        again = errors_of(own[0]["elements"], [record["value"] for record in own], ORDERS[prop, method])
        if not all(
            is_near([record["limit"], *record["error"]], [limit, *errors])
            for record, (limit, errors, _) in zip(own, again)
        ):
            wrong.append(f"{cell}, {prop}, {method}: limits and errors are not those of the values")
        exact = closed_forms(cell)
        if not all(is_near([record["exact"] or 0], [exact.get(record["quantity"], 0)]) for record in own):
            wrong.append(f"{cell}, {prop}, {method}: closed forms are others")
    faults = faults_of(records)
    first = next(line for line in page.splitlines() if line.startswith("Generated by"))
    if reference_page.page(first, list(CELLS), records, faults) != page:
        wrong.append("RESULTS.md is not the page of results.json")
    return wrong + faults


def words(allowed):
    def parse(text):
        given = text.split(",")
        for word in given:
            if word not in allowed:
                raise argparse.ArgumentTypeError(f"'{word}' is none of {', '.join(allowed)}")
        return given

    return parse


def arguments():
    properties = list(UNITS)
    parser = argparse.ArgumentParser(
        prog="reference-cells",
        description="Stiffness, conductivity and permeability of the unit cells of samples/benchmark on three meshes of tetrahedra and on three of "
        "voxels, each with its discretisation error; fails where two do not agree within what they state.",
        epilog="What is computed already is kept in the output folder, and not computed again; Ctrl-C loses one run.",
    )
    parser.add_argument(
        "--cells",
        type=words(list(CELLS)),
        default=list(CELLS),
        metavar="NAME,..",
        help="these alone: " + ", ".join(CELLS),
    )
    parser.add_argument(
        "--only",
        type=words(properties),
        default=properties,
        metavar="PROPERTY,..",
        help="these alone: " + ", ".join(properties),
    )
    parser.add_argument("--quick", action="store_true", help="without the finest meshes")
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=ROOT / "build" / "reference-cells",
        metavar="FOLDER",
        help="for meshes, results.json and RESULTS.md (default: build/reference-cells)",
    )
    action = parser.add_mutually_exclusive_group()
    action.add_argument(
        "--write",
        action="store_true",
        help="renew samples/benchmark/RESULTS.md and results.json, too; what was never computed is `not run` there",
    )
    action.add_argument(
        "--check", action="store_true", help="compute nothing: do the committed values agree, and is the page theirs?"
    )
    parser.add_argument("--selvage", default="selvage", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.quick and given.write:
        parser.error("--write takes all three sizes: leave out --quick")
    return given


def main():
    given = arguments()
    if given.check:
        wrong = check(FOLDER)
    else:
        store = Store(given.out.resolve(), str(pathlib.Path(given.selvage).resolve()))
        levels = 2 if given.quick else 3
        wrong = compute_all(store, all_runs(given.cells, given.only, levels))
        records = []
        for cell in CELLS:
            results = {run: store.find(run) for run in all_runs([cell], list(UNITS), levels)}
            records += records_of(cell, {run: result for run, result in results.items() if result is not None})
        faults = faults_of(records)
        page = reference_page.page(heading(given.selvage), list(CELLS), records, faults)
        for folder in [given.out, *([FOLDER] if given.write else [])]:
            (folder / "results.json").write_text(table(records))
            (folder / "RESULTS.md").write_text(page)
        print(page)
        wrong += faults
    for text in wrong:
        say(f"reference-cells: {text}")
    return 1 if wrong else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failure as failure:
        sys.exit(f"reference-cells: {failure}")
    except KeyboardInterrupt:
        say("reference-cells: stopped; what was done is kept")
        sys.exit(130)
