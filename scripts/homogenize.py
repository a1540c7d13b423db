"""Stiffness and thermal expansion of a unit cell: see scripts/homogenize, which calls this.

The deck of `selvage mesh` has a step for each strain of the cell and one for its temperature. CalculiX runs it.

direct:    the deck as it is, by factorization. The force on each driver follows from the reactions of the nodes that
           depend on it (virtual work: CalculiX prints none at a node that no element has), and is the stress times the
           cell's volume (of a plate: force and moment a length times its area).
iterative: the same elements and conditions without CalculiX, by conjugate gradients over all steps at once
           (scripts/cell_elements.py): in minutes what a factorization in every step does in hours. (Those of CalculiX end
           at a residual of 1e-4, which left up to 4e-3 of the bending and coupling terms.)
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

from cell_elements import EDGES, PAIRS, Cell, NotSolved, tetrahedron_shapes

BLOCK = ["xx", "yy", "zz", "xy", "xz", "yz"]


class Failure(Exception):
    pass


class Deck:
    """What of a deck of ours is needed: nodes, elements, materials, conditions, steps."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.lines = self._with_included(self.path)
        self.nodes, self.sets, self.elements, self.element_sets = {}, {}, {}, {}
        self.equations, self.materials, self.sections = [], {}, []
        self.axes, self.steps, self.held = {}, [], []
        self.cell = None
        self.first_step = len(self.lines)
        self._read()

    def _with_included(self, path):
        """The lines of a deck, with those of the mesh that it includes (--split-deck)."""
        lines = []
        for line in path.read_text().splitlines():
            found = re.fullmatch(r"\*INCLUDE\s*,\s*INPUT\s*=\s*(.*\S)\s*", line, re.IGNORECASE)
            lines += self._with_included(path.parent / found[1]) if found else [line]
        return lines

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

    def parts(self, chunk=20_000):
        """Of all elements, some at a time: their numbers, places of their nodes, stiffness matrices and expansion (engineering
        strains a degree) in space, order xx yy zz xy xz yz."""
        for name, material, oriented in self.sections:
            local = self.materials[material]["stiffness"]
            expands = numpy.array([*self.materials[material].get("expansion", (0, 0, 0)), 0, 0, 0])
            numbers = self.element_sets[name]
            for k in range(0, len(numbers), chunk):
                part = numbers[k : k + chunk]
                stiffness = numpy.broadcast_to(local, (len(part), 6, 6))
                expansion = numpy.broadcast_to(expands, (len(part), 6))
                if oriented:
                    turn = turned(numpy.array([self.axes[e] for e in part]))
                    stiffness = numpy.einsum("nai,ab,nbj->nij", turn, local, turn, optimize=True)
                    # Stresses turn by the transposed matrix, and strains of the material into space as work asks for.
                    expansion = numpy.linalg.solve(turn, expansion[:, :, None])[:, :, 0]
                yield part, numpy.array([[self.nodes[n] for n in self.elements[e]] for e in part]), stiffness, expansion

    def pieces(self):
        """Of all elements, some at a time: section, volumes, first and second moments of their heights about the middle
        of the cell, stiffness matrices in space (order xx yy zz xy xz yz)."""
        middle = self.cell[:, 2].mean()
        name_of = {e: name for name, _, _ in self.sections for e in self.element_sets[name]}
        for part, p, stiffness, _ in self.parts():
            p[:, :, 2] -= middle
            moments = moments_of_boxes(p) if p.shape[1] == 8 else moments_of_tetrahedra(p)
            yield name_of[part[0]], *moments, stiffness


def moments_of_boxes(p):
    """Volumes and the integrals of z and z^2 of bricks along the axes (n x 8 x 3 nodes)."""
    z = p[:, :, 2]
    volume = numpy.prod(p[:, 6] - p[:, 0], axis=1)
    return volume, volume * z.mean(axis=1), volume * (z.mean(axis=1) ** 2 + (z[:, 6] - z[:, 0]) ** 2 / 12)


def moments_of_tetrahedra(p):
    """The same of tetrahedra of four or ten nodes (n x 4 or 10 x 3); curved ones by quadrature."""
    z = p[:, :4, 2]
    volume = numpy.einsum("ni,ni->n", numpy.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6
    moments = [volume, volume * z.mean(axis=1), volume * ((z**2).sum(axis=1) + z.sum(axis=1) ** 2) / 20]
    if p.shape[1] == 4:
        return moments
    chords = numpy.stack([(p[:, a] + p[:, b]) / 2 for a, b in EDGES], axis=1)
    size = numpy.abs(p[:, 1:4] - p[:, :1]).max(axis=(1, 2))
    curved = numpy.flatnonzero(numpy.abs(p[:, 4:] - chords).max(axis=(1, 2)) > 1e-9 * size)
    values, slopes, weights = tetrahedron_rule()
    for rows in numpy.array_split(curved, len(curved) // 5000 + 1):
        frames = numpy.einsum("qai,nac->nqic", slopes, p[rows])
        parts = weights * numpy.linalg.det(frames)
        height = numpy.einsum("qa,na->nq", values, p[rows][:, :, 2])
        for power in range(3):
            moments[power][rows] = (parts * height**power).sum(axis=1)
    return moments


def tetrahedron_rule(count=5):
    """Values and slopes of the ten shape functions at the points of a rule for tetrahedra, and its weights: Gauss's of a
    cube that is drawn together to a tetrahedron, exact to degree 2 count - 3."""
    at, weight = numpy.polynomial.legendre.leggauss(count)
    at, weight = (at + 1) / 2, weight / 2
    a, b, c = (grid.ravel() for grid in numpy.meshgrid(at, at, at, indexing="ij"))
    weights = numpy.einsum("i,j,k->ijk", weight, weight, weight).ravel() * (1 - a) ** 2 * (1 - b)
    at = numpy.stack([a, b * (1 - a), c * (1 - a) * (1 - b)], axis=1)
    return *tetrahedron_shapes(at, 10), weights


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


def turned(axes):
    """What makes strains along axes from those in space (n x 6 x 6, engineering): rows of axis 1 and of a second one across it."""
    first = axes[:, :3] / numpy.linalg.norm(axes[:, :3], axis=1)[:, None]
    second = axes[:, 3:] - first * (first * axes[:, 3:]).sum(axis=1)[:, None]
    second /= numpy.linalg.norm(second, axis=1)[:, None]
    r = numpy.stack([first, second, numpy.cross(first, second)], axis=1)
    strain = numpy.zeros((len(axes), 6, 6))  
    for a, (i, j) in enumerate(PAIRS):
        for b, (k, l) in enumerate(PAIRS):
            value = r[:, i, k] * r[:, j, l] + (r[:, i, l] * r[:, j, k] if k != l else 0)
            strain[:, a, b] = value * (1 if i == j else 2) * (1 if k == l else 0.5)
    return strain


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


def bounds(deck, plate):
    """Voigt's and Reuss's matrices, and the volume of each section over the cell's.

    Of a plate: the energies of the strains that are linear in z (those across the thickness as they cost least), and of
    the stresses that are linear in z and leave its faces free.
    """
    sides = deck.cell[1] - deck.cell[0]
    shares = {}
    strain, stress = numpy.zeros((3, 6, 6)), numpy.zeros((3, 6, 6))  # by power of z
    for name, volume, first, second, stiffness in deck.pieces():
        shares[name] = shares.get(name, 0) + volume.sum() / numpy.prod(sides)
        compliance = numpy.linalg.inv(stiffness)
        for power, weight in enumerate((volume, first, second)):
            strain[power] += numpy.einsum("n,nij->ij", weight, stiffness)
            stress[power] += numpy.einsum("n,nij->ij", weight, compliance)
    if not plate:
        return strain[0] / numpy.prod(sides), numpy.linalg.inv(stress[0] / numpy.prod(sides)), shares
    area, h = sides[0] * sides[1], sides[2]
    both = numpy.block([[strain[0], strain[1]], [strain[1], strain[2]]]) / area
    level, across = [0, 1, 3, 6, 7, 9], [2, 4, 5, 8, 10, 11]
    mixed = both[numpy.ix_(level, across)]
    voigt = both[numpy.ix_(level, level)] - mixed @ numpy.linalg.solve(both[numpy.ix_(across, across)], mixed.T)
    flat = [matrix[numpy.ix_([0, 1, 3], [0, 1, 3])] / area for matrix in stress]
    soft = numpy.block([[flat[0] / h**2, 12 * flat[1] / h**4], [12 * flat[1] / h**4, 144 * flat[2] / h**6]])
    return voigt, numpy.linalg.inv(soft), shares


DISCRETISATION = 0.01  # up to which elements are allowed to be too stiff where a bound is exact (a homogeneous plate)


def is_not_below(upper, lower):
    """Is the difference positive semidefinite, but for that? Entries of different units are scaled first."""
    scale = 1 / numpy.sqrt(numpy.diag(upper))
    return bool(numpy.linalg.eigvalsh((upper - lower) * numpy.outer(scale, scale)).min() > -DISCRETISATION)


LARGEST_DIRECT = 3_000  # nodes; beyond, seven factorizations take minutes and gigabytes


def check_bounds(matrix, voigt, reuss, plate):
    """Nothing is told of a stiffness that cannot be."""
    for name, upper, lower in (("Voigt", voigt, matrix), ("Reuss", matrix, reuss)):
        if is_not_below(upper, lower):
            continue
        remedy = "mesh it finer" + (", or with --order 2, the default of plates" if plate else "")
        raise Failure(
            f"the stiffness that was found is {'above' if name == 'Voigt' else 'below'} {name}'s bound, which no cell of "
            f"these materials is: its elements are too coarse{' for bending' if plate else ''}; {remedy}"
        )


def homogenize(path, ccx, folder, with_bounds=False, solver="auto"):
    deck = Deck(path)
    drivers = deck.drivers()
    if not drivers or not deck.steps:
        raise Failure(f"{path}: no unit cell with load cases (mesh it with --matrix --periodic)")
    if deck.cell is None:
        raise Failure(f"{path}: the deck does not say its cell")
    sides = deck.cell[1] - deck.cell[0]
    plate = any(name.startswith("Curvature") for name in drivers)
    measure = sides[0] * sides[1] if plate else numpy.prod(sides)
    if solver == "auto":
        solver = "direct" if len(deck.nodes) <= LARGEST_DIRECT else "iterative"
    started = time.monotonic()
    if solver == "direct":
        name = "homogenize"  # not the name of a deck that is kept beside it
        (folder / f"{name}.inp").write_text("\n".join(deck.lines) + "\n")
        warnings = run_ccx(ccx, folder, name)
        forces = reactions(folder / f"{name}.dat", len(deck.steps))
        matrix, thermal = stiffness_from_steps(deck, drivers, forces, measure)
    else:
        warnings = []
        matrix, thermal = (total / measure for total in Cell(deck, drivers, deck.parts()).stiffness())
    seconds = time.monotonic() - started
    asymmetry = abs(matrix - matrix.T).max() / abs(matrix).max()
    matrix = (matrix + matrix.T) / 2
    constants, expansion = (
        engineering_plate(matrix, thermal, sides[2]) if plate else engineering_block(matrix, thermal)
    )
    voigt, reuss, shares = bounds(deck, plate)
    check_bounds(matrix, voigt, reuss, plate)
    notes = []
    if plate and any(len(nodes) in (4, 8) for nodes in deck.elements.values()):
        notes.append(
            "elements of four or eight nodes are too stiff in bending (tetrahedra of usual sizes by a third): the entries of "
            "kxx, kyy, kxy are upper bounds; mesh with --order 2"
        )
    result = {
        "file": str(path),
        "kind": "plate" if plate else "block",
        "solver": solver,
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
        "notes": notes,
        "seconds": seconds,
    }
    if with_bounds:
        result |= {"volume_fractions": shares, "voigt": voigt.tolist(), "reuss": reuss.tolist()}
    return result


def show(result):
    plate = result["kind"] == "plate"
    print(f"{result['file']}: {result['kind']}, {result['elements']} elements, {result['solver']} solver {result['seconds']:.1f} s")
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
    for name in ("voigt", "reuss"):
        if name in result:
            print(f"{name.capitalize()}'s bound")
            for row in result[name]:
                print("  " + " ".join(f"{value:13.6g}" for value in row))
    for warning in result["warnings"] + result["notes"]:
        print(warning)


def main():
    parser = argparse.ArgumentParser(
        prog="homogenize",
        description="Stiffness (C of a block, ABD of a plate), engineering constants and thermal expansion of a unit "
        "cell, from its deck: by CalculiX, or by conjugate gradients where it is large.",
        epilog="Options that are not known here are those of `selvage mesh`: --size, --voxel, --order, ...",
    )
    parser.add_argument("file", help="deck of `selvage mesh` (.inp), or any input of it with a cell")
    parser.add_argument("--json", metavar="FILE", help="write the results there too ('-': standard output, alone)")
    parser.add_argument("--bounds", action="store_true", help="with volume fractions and the bounds of Voigt and Reuss (which are checked always)")
    parser.add_argument("--keep", metavar="DIR", help="keep the deck and what CalculiX wrote")
    parser.add_argument(
        "--solver",
        choices=["auto", "direct", "iterative"],
        default="auto",
        help=f"CalculiX's factorization, or conjugate gradients without it (default: direct up to {LARGEST_DIRECT} nodes)",
    )
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
            result = homogenize(path, given.ccx, folder, given.bounds, given.solver)
        except (Failure, NotSolved) as failure:
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
