"""Stiffness and thermal expansion of a unit cell: see scripts/homogenize, which calls this.

The deck of `selvage mesh` has a step for each strain of the cell and one for its temperature. CalculiX runs it; the
force on each driver follows from the reactions of the nodes that depend on it (virtual work: CalculiX prints none at a
node that no element has), and is the stress times the cell's volume (of a plate: force and moment a length times its
area).
"""

import argparse
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import numpy

BLOCK = ["xx", "yy", "zz", "xy", "xz", "yz"]


class Failure(Exception):
    pass


class Deck:
    """What of a deck of ours is needed: nodes, elements, materials, conditions, steps."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.lines = self.path.read_text().splitlines()
        self.nodes, self.sets, self.elements, self.element_sets = {}, {}, {}, {}
        self.equations, self.materials, self.sections = [], {}, []
        self.axes, self.steps, self.held = {}, [], []
        self.cell = None
        self.first_step = len(self.lines)
        self._read()

    def _blocks(self):
        """Keyword, parameters, data lines, line number, last comment before the keyword."""
        keyword, options, data, start, comment, last = None, {}, [], 0, "", ""
        for number, line in enumerate(self.lines):
            if line.startswith("**"):
                last = line[2:].strip()
                found = re.fullmatch(r"Cell: (.*)", last)
                if found:
                    self.cell = numpy.array([float(v) for v in found[1].split()]).reshape(2, 3)
                continue
            if line.startswith("*"):
                if keyword:
                    yield keyword, options, data, start, comment
                words = [word.strip() for word in line[1:].split(",")]
                keyword, data, start, comment = words[0].upper(), [], number, last
                options = {k.strip().upper(): v.strip() for k, _, v in (word.partition("=") for word in words[1:])}
            elif line.strip():
                data.append(line)
        if keyword:
            yield keyword, options, data, start, comment

    def _read(self):
        material, step = None, None
        for keyword, options, data, start, comment in self._blocks():
            rows = [[word.strip() for word in line.split(",")] for line in data]
            if keyword == "NODE":
                numbers = [int(row[0]) for row in rows]
                self.nodes.update((int(row[0]), tuple(map(float, row[1:4]))) for row in rows)
                if "NSET" in options:
                    self.sets.setdefault(options["NSET"], []).extend(numbers)
            elif keyword == "NSET":
                words = [word for row in rows for word in row if word]
                names = self.sets.setdefault(options["NSET"], [])
                for word in words:
                    names.extend([int(word)] if word.isdigit() else self.sets.get(word, []))
            elif keyword == "ELEMENT":
                self._add_elements(options, rows)
            elif keyword == "ELSET":
                names = self.element_sets.setdefault(options["ELSET"], [])
                for word in (word for row in rows for word in row if word):
                    names.extend([int(word)] if word.isdigit() else self.element_sets.get(word, []))
            elif keyword == "EQUATION":
                self._add_equations(rows)
            elif keyword == "MATERIAL":
                material = self.materials.setdefault(options["NAME"], {})
            elif keyword == "ELASTIC":
                values = [float(word) for row in rows for word in row if word]
                material["stiffness"] = stiffness_of(values)
            elif keyword == "EXPANSION":
                values = [float(word) for row in rows for word in row if word]
                material["expansion"] = values if len(values) > 1 else values * 3
            elif keyword == "SOLID SECTION":
                self.sections.append((options["ELSET"], options["MATERIAL"], "ORIENTATION" in options))
            elif keyword == "DISTRIBUTION":
                for row in rows:
                    if row[0]:
                        self.axes[int(row[0])] = [float(v) for v in row[1:7]]
            elif keyword == "STEP":
                self.first_step = min(self.first_step, start)
                step = {"name": comment, "drivers": {}, "temperature": 0.0}
                self.steps.append(step)
            elif keyword == "BOUNDARY" and step is not None:
                for row in rows:
                    if len(row) > 3 and row[3]:
                        step["drivers"][row[0]] = float(row[3])
                    elif row[0].isdigit():
                        self.held = row
            elif keyword == "TEMPERATURE" and step is not None:
                step["temperature"] = float(rows[0][1])

    def _add_elements(self, options, rows):
        names = self.element_sets.setdefault(options.get("ELSET", "All"), [])
        count = {"C3D4": 4, "C3D10": 10, "C3D8": 8}.get(options["TYPE"].upper())
        if count is None:
            return
        words = [int(word) for row in rows for word in row if word]
        for k in range(0, len(words), count + 1):
            self.elements[words[k]] = words[k + 1 : k + 1 + count]
            names.append(words[k])

    def _add_equations(self, rows):
        words = [word for row in rows for word in row if word]
        k = 0
        while k < len(words):
            count = int(words[k])
            terms = words[k + 1 : k + 1 + 3 * count]
            self.equations.append(
                [(int(terms[3 * i]), int(terms[3 * i + 1]), float(terms[3 * i + 2])) for i in range(count)]
            )
            k += 1 + 3 * count

    def drivers(self):
        names = [name for name in self.sets if re.fullmatch(r"(Constraints|Curvature)Driver\d", name)]
        return {name: self.sets[name][0] for name in names}

    def volumes_and_stiffness(self):
        """Of each element: volume (corners only) and its stiffness matrix (6 x 6, order xx yy zz xy xz yz) in space."""
        result = {}
        for name, material, oriented in self.sections:
            local = self.materials[material]["stiffness"]
            for number in self.element_sets[name]:
                p = numpy.array([self.nodes[n] for n in self.elements[number][:8]])
                if len(self.elements[number]) == 8:
                    volume = numpy.prod(p[6] - p[0])
                else:
                    volume = numpy.dot(numpy.cross(p[1] - p[0], p[2] - p[0]), p[3] - p[0]) / 6
                axes = self.axes.get(number) if oriented else None
                result[number] = (volume, rotated(local, axes) if axes else local)
        return result


def stiffness_of(values):
    """6 x 6 in the material's axes from E, nu or nine engineering constants."""
    if len(values) == 2:
        e, nu = values
        values = [e] * 3 + [nu] * 3 + [e / (2 * (1 + nu))] * 3
    e1, e2, e3, nu12, nu13, nu23, g12, g13, g23 = values[:9]
    s = numpy.zeros((6, 6))
    s[:3, :3] = [
        [1 / e1, -nu12 / e1, -nu13 / e1],
        [-nu12 / e1, 1 / e2, -nu23 / e2],
        [-nu13 / e1, -nu23 / e2, 1 / e3],
    ]
    s[3, 3], s[4, 4], s[5, 5] = 1 / g12, 1 / g13, 1 / g23
    return numpy.linalg.inv(s)


PAIRS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]


def rotated(local, axes):
    """The stiffness in space of a material whose axis 1 is the first three numbers, 2 across it."""
    first = numpy.array(axes[:3]) / numpy.linalg.norm(axes[:3])
    second = numpy.array(axes[3:])
    second = second - first * first.dot(second)
    second /= numpy.linalg.norm(second)
    r = numpy.array([first, second, numpy.cross(first, second)])
    strain = numpy.zeros((6, 6))  # engineering strains in the material's axes from those in space
    for a, (i, j) in enumerate(PAIRS):
        for b, (k, l) in enumerate(PAIRS):
            value = r[i, k] * r[j, l] + (r[i, l] * r[j, k] if k != l else 0)
            strain[a, b] = value * (1 if i == j else 2) * (1 if k == l else 0.5)
    return strain.T @ local @ strain


def run_ccx(program, folder, name):
    if shutil.which(program) is None:
        raise Failure(f"{program} is not installed: apt-get install calculix-ccx, or say --ccx PROGRAM")
    # One thread: the same digits on every machine.
    run = subprocess.run([program, name], cwd=folder, text=True, capture_output=True, check=False)
    text = run.stdout + run.stderr
    errors = [line.strip() for line in text.splitlines() if "*ERROR" in line]
    if errors or run.returncode != 0 or "Job finished" not in text:
        (folder / "ccx.log").write_text(text)
        tail = errors[:3] or text.strip().splitlines()[-3:]
        raise Failure("CalculiX stopped: " + " / ".join(tail))
    return [line.strip() for line in text.splitlines() if "*WARNING" in line]


def reactions(path, count):
    """Of each step the printed forces of all nodes: number -> (x, y, z)."""
    steps, current = [], None
    with path.open() as file:
        for line in file:
            if line.startswith(" forces (fx,fy,fz) for set"):
                if "DEPENDENT" in line.upper():
                    current = {}
                    steps.append(current)
                else:
                    current = None
            elif line.startswith(" displacements"):
                current = None
            elif current is not None:
                words = line.split()
                if len(words) == 4:
                    current[int(words[0])] = [float(word) for word in words[1:]]
    if len(steps) != count:
        raise Failure(f"CalculiX printed the forces of {len(steps)} steps, not of {count}")
    return steps


def driver_forces(deck, drivers, forces):
    """The work that the dependent nodes' forces do when each driver moves by one."""
    index = {node: k for k, node in enumerate(drivers.values())}
    result = numpy.zeros(len(drivers))
    for first, *others in deck.equations:
        force = forces[first[0]][first[1] - 1]
        for node, _, factor in others:
            if node in index:
                result[index[node]] -= force * factor / first[2]
    return result


def stiffness_from_steps(deck, drivers, forces, measure):
    names = list(drivers)
    matrix = numpy.full((len(names), len(names)), numpy.nan)
    thermal = numpy.zeros(len(names))
    for step, printed in zip(deck.steps, forces):
        stress = driver_forces(deck, drivers, printed) / measure
        moved = [name for name in names if step["drivers"].get(name)]
        if len(moved) == 1:
            matrix[:, names.index(moved[0])] = stress / step["drivers"][moved[0]]
        elif not moved and step["temperature"]:
            thermal = stress / step["temperature"]
    if numpy.isnan(matrix).any():
        raise Failure("the deck has no step for each driver")
    return matrix, thermal


def engineering_block(matrix, thermal):
    s = numpy.linalg.inv(matrix)
    alpha = -s @ thermal
    return {
        "E1": 1 / s[0, 0],
        "E2": 1 / s[1, 1],
        "E3": 1 / s[2, 2],
        "nu12": -s[1, 0] / s[0, 0],
        "nu13": -s[2, 0] / s[0, 0],
        "nu23": -s[2, 1] / s[1, 1],
        "G12": 1 / s[3, 3],
        "G13": 1 / s[4, 4],
        "G23": 1 / s[5, 5],
    }, {f"alpha_{name}": value for name, value in zip(BLOCK, alpha)}


def engineering_plate(matrix, thermal, height):
    s = numpy.linalg.inv(matrix)
    free = -s @ thermal
    names = ["xx", "yy", "xy"]
    constants = {
        "E1": 1 / (s[0, 0] * height),
        "E2": 1 / (s[1, 1] * height),
        "nu12": -s[1, 0] / s[0, 0],
        "G12": 1 / (s[2, 2] * height),
        "E1_bending": 12 / (s[3, 3] * height**3),
        "E2_bending": 12 / (s[4, 4] * height**3),
        "G12_bending": 12 / (s[5, 5] * height**3),
    }
    expansion = {f"alpha_{name}": value for name, value in zip(names, free[:3])}
    expansion |= {f"curvature_{name}": value for name, value in zip(names, free[3:])}
    return constants, expansion


def bounds(deck, measure):
    """Voigt's and Reuss's matrices of a block, and the volume of each section, all over the cell's volume."""
    voigt, reuss, shares = numpy.zeros((6, 6)), numpy.zeros((6, 6)), {}
    inverses = {}
    table = deck.volumes_and_stiffness()
    for name, _, _ in deck.sections:
        for number in deck.element_sets[name]:
            volume, stiffness = table[number]
            key = stiffness.tobytes()
            if key not in inverses:
                inverses[key] = numpy.linalg.inv(stiffness)
            voigt += volume * stiffness
            reuss += volume * inverses[key]
            shares[name] = shares.get(name, 0) + volume / measure
    total = sum(volume for volume, _ in table.values())
    return voigt / total, numpy.linalg.inv(reuss / total), shares


def homogenize(path, ccx, folder, with_bounds=False):
    deck = Deck(path)
    drivers = deck.drivers()
    if not drivers or not deck.steps:
        raise Failure(f"{path}: no unit cell with load cases (mesh it with --matrix --periodic)")
    if deck.cell is None:
        raise Failure(f"{path}: the deck does not say its cell")
    sides = deck.cell[1] - deck.cell[0]
    plate = any(name.startswith("Curvature") for name in drivers)
    measure = sides[0] * sides[1] if plate else numpy.prod(sides)
    shutil.copy(path, folder / "cell.inp")
    started = time.monotonic()
    warnings = run_ccx(ccx, folder, "cell")
    seconds = time.monotonic() - started
    forces = reactions(folder / "cell.dat", len(deck.steps))
    matrix, thermal = stiffness_from_steps(deck, drivers, forces, measure)
    asymmetry = abs(matrix - matrix.T).max() / abs(matrix).max()
    matrix = (matrix + matrix.T) / 2
    constants, expansion = (
        engineering_plate(matrix, thermal, sides[2]) if plate else engineering_block(matrix, thermal)
    )
    result = {
        "file": str(path),
        "kind": "plate" if plate else "block",
        "cell": sides.tolist(),
        "nodes": len(deck.nodes),
        "elements": len(deck.elements),
        "order": ["xx", "yy", "xy", "kxx", "kyy", "kxy"] if plate else BLOCK,
        "stiffness": matrix.tolist(),
        "asymmetry": asymmetry,
        "engineering": constants,
        "thermal_stress": thermal.tolist(),
        "expansion": expansion,
        "warnings": warnings,
        "seconds": seconds,
    }
    if with_bounds:
        voigt, reuss, shares = bounds(deck, measure)
        result["volume_fractions"] = shares
        if not plate:
            result |= {"voigt": voigt.tolist(), "reuss": reuss.tolist()}
            # Positive definite differences, but for rounding.
            least = [numpy.linalg.eigvalsh(a - b).min() / abs(matrix).max() for a, b in ((voigt, matrix), (matrix, reuss))]
            result["inside_bounds"] = bool(min(least) > -1e-6)
    return result


def show(result):
    plate = result["kind"] == "plate"
    print(f"{result['file']}: {result['kind']}, {result['elements']} elements, {result['seconds']:.1f} s")
    print("ABD matrix (N/mm, N, N mm)" if plate else "stiffness C (MPa)", "-", " ".join(result["order"]))
    for row in result["stiffness"]:
        print("  " + " ".join(f"{value:13.6g}" for value in row))
    print(f"asymmetry {result['asymmetry']:.1e} of the largest entry")
    for name, value in result["engineering"].items():
        print(f"  {name:12} {value:12.6g}" + ("" if name.startswith("nu") else " MPa"))
    print("thermal expansion (1/K; of curvature 1/(mm K))" if plate else "thermal expansion (1/K)")
    for name, value in result["expansion"].items():
        print(f"  {name:12} {value:12.5g}")
    for name, share in result.get("volume_fractions", {}).items():
        print(f"  share of {name:12} {share:.5f}")
    if "inside_bounds" in result:
        print("inside the bounds of Voigt and Reuss:", "yes" if result["inside_bounds"] else "NO")
    for warning in result["warnings"]:
        print(warning)


def main():
    parser = argparse.ArgumentParser(
        prog="homogenize",
        description="Stiffness (C of a block, ABD of a plate), engineering constants and thermal expansion of a unit "
        "cell, by CalculiX.",
        epilog="Options that are not known here are those of `selvage mesh`: --size, --voxel, --order, ...",
    )
    parser.add_argument("file", help="deck of `selvage mesh` (.inp), or any input of it with a cell")
    parser.add_argument("--json", metavar="FILE", help="write the results there too ('-': standard output, alone)")
    parser.add_argument("--bounds", action="store_true", help="with volume fractions and the bounds of Voigt and Reuss")
    parser.add_argument("--keep", metavar="DIR", help="keep the deck and what CalculiX wrote")
    parser.add_argument("--ccx", default="ccx", help="the program (default: ccx)")
    parser.add_argument("--selvage", default="selvage", help=argparse.SUPPRESS)
    given, others = parser.parse_known_args()
    path = pathlib.Path(given.file)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(given.keep or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        try:
            if not path.is_file():
                raise Failure(f"{path}: no such file")
            if path.suffix != ".inp":
                deck = folder / (path.stem + ".inp")
                command = [given.selvage, "mesh", str(path), "-o", str(deck), "--matrix", "--periodic", *others]
                if subprocess.run(command, stdout=sys.stderr, check=False).returncode != 0:
                    raise Failure(f"{path}: it could not be meshed")
                path = deck
            elif others:
                raise Failure(f"unknown options: {' '.join(others)}")
            result = homogenize(path, given.ccx, folder, given.bounds)
        except Failure as failure:
            print(f"homogenize: {failure}", file=sys.stderr)
            return 1
    if given.json and given.json != "-":
        pathlib.Path(given.json).write_text(json.dumps(result, indent=1) + "\n")
    if given.json == "-":
        print(json.dumps(result, indent=1))
    else:
        show(result)
    return 0


if __name__ == "__main__":
    sys.exit(main())
