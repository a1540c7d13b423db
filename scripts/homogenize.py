"""Stiffness and thermal expansion of a unit cell, or the conductivity of one whose deck conducts: see scripts/homogenize, which calls this.

The deck of `selvage mesh` has a step for each strain of the cell and one for its temperature. CalculiX runs it.

direct:    the deck as it is, by factorization. The force on each driver follows from the reactions of the nodes that
           depend on it (virtual work: CalculiX prints none at a node that no element has), and is the stress times the
           cell's volume (of a plate: force and moment a length times its area). So are the fluxes of a deck that conducts.
iterative: the same elements and conditions without CalculiX, by conjugate gradients over all steps at once
           (scripts/cell_elements.py): in minutes what a factorization in every step does in hours. (Those of CalculiX end
           at a residual of 1e-4, which left up to 4e-3 of the bending and coupling terms.)
"""

import argparse
import json
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import time

try:
    import numpy
except ModuleNotFoundError:
    sys.exit("homogenize: NumPy is not installed: apt-get install python3-numpy")

import cell_cohesive
import cell_conduction as conduction
import cell_strength as strength
from cell_deck import WRONG_NUMBERS, BadDeck, Deck, ForeignElement, reason
from cell_elements import Cell, NotSolved

BLOCK = ["xx", "yy", "zz", "xy", "xz", "yz"]


UNITS = {  # of forces and moments, in the order of `order`
    "block": ["MPa"] * 6,
    "plate": ["N/mm"] * 3 + ["N"] * 3,
    "beam": ["N"] + ["N mm"] * 3,
}


class Failure(Exception):
    pass


MOST_SECONDS = 3600  # of CalculiX, where --timeout says nothing


def limit_memory(megabytes):
    """Of this process and those that it starts; where none is said, what the machine has free."""
    if megabytes is None:
        free = [line.split()[1] for line in pathlib.Path("/proc/meminfo").read_text().splitlines() if line.startswith("MemAvailable:")]
        megabytes = int(free[0]) / 1024 if free else None
    if megabytes is None:
        return
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    wanted = int(megabytes * 2**20)
    resource.setrlimit(resource.RLIMIT_AS, (wanted if hard == resource.RLIM_INFINITY else min(wanted, hard), hard))


def run_ccx(program, folder, name, seconds):
    if shutil.which(program) is None:
        raise Failure(f"{program} is not installed: apt-get install calculix-ccx, or say --ccx PROGRAM")
    # One thread: the same digits on every machine.
    try:
        run = subprocess.run([program, name], cwd=folder, text=True, errors="replace", capture_output=True, check=False,
                             timeout=seconds)
    except subprocess.TimeoutExpired as failure:
        raise Failure(f"CalculiX was stopped: not done within its {seconds:g} s; --timeout gives it more") from failure
    except OSError as failure:
        raise Failure(f"{program} cannot be started: {failure.strerror}") from failure
    text = run.stdout + run.stderr
    errors = [line.strip() for line in text.splitlines() if "*ERROR" in line]
    if errors or run.returncode != 0 or "Job finished" not in text:
        (folder / "ccx.log").write_text(text)
        tail = errors[:3] or text.strip().splitlines()[-3:]
        raise Failure("CalculiX stopped: " + " / ".join(tail))
    return [line.strip() for line in text.splitlines() if "*WARNING" in line]


def printed(path, deck, what, nodes):
    """Of each step what was printed of a set of nodes: number -> one value a direction."""
    steps, current, directions = [], None, deck.directions
    with path.open() as file:
        for line in file:
            if " for set " in line:
                current = None
                if line.startswith(what) and f" {nodes} " in line.upper():
                    current = {}
                    steps.append(current)
            elif current is not None:
                words = line.split()
                if len(words) == 1 + directions:
                    current[int(words[0])] = [float(word) for word in words[1:]]
    if len(steps) != len(deck.steps):
        raise Failure(f"CalculiX printed{what[0]} of {len(steps)} steps, not of {len(deck.steps)}")
    return steps


def reactions(path, deck):
    """Of each step the forces of the dependent nodes, or the fluxes into them."""
    return printed(path, deck, (" forces (fx,fy,fz)", " heat generation"), "DEPENDENT")


def displacements(path, deck, drivers):
    """Of every node, where each driver is 1 (nodes x 3 x drivers)."""
    fields = numpy.zeros((max(deck.nodes) + 1, 3, len(drivers)))
    for step, moved in zip(deck.steps, printed(path, deck, (" displacements",), "ALLNODES")):
        for k, name in enumerate(drivers):
            if step["drivers"].get(name):
                fields[list(moved), :, k] = numpy.array(list(moved.values())) / step["drivers"][name]
    return fields


def driver_forces(deck, drivers, forces):
    """The work that the dependent nodes' forces do when each driver moves by one."""
    index = {node: k for k, node in enumerate(drivers.values())}
    result = numpy.zeros(len(drivers))
    for first, *others in deck.equations:
        force = forces[first[0]][first[1]]
        for node, _, factor in others:
            if node in index:
                result[index[node]] -= force * factor / first[2]
    return result


def stiffness_from_steps(deck, drivers, forces):
    names = list(drivers)
    matrix = numpy.full((len(names), len(names)), numpy.nan)
    thermal = numpy.zeros(len(names))
    for step, printed in zip(deck.steps, forces):
        stress = driver_forces(deck, drivers, printed)
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
    volume_of_cell, h = deck.cell.volume, deck.cell.height
    shares = {}
    strain, stress = numpy.zeros((3, 6, 6)), numpy.zeros((3, 6, 6))  # by power of z
    for name, volume, first, second, stiffness in deck.pieces():
        shares[name] = shares.get(name, 0) + volume.sum() / volume_of_cell
        compliance = numpy.linalg.inv(stiffness)
        for power, weight in enumerate((volume, first, second)):
            strain[power] += numpy.einsum("n,nij->ij", weight, stiffness)
            stress[power] += numpy.einsum("n,nij->ij", weight, compliance)
    for *weights, compliance in cell_cohesive.compliances(deck):
        for power, weight in enumerate(weights):
            stress[power] += numpy.einsum("n,nij->ij", weight, compliance)
    if not plate:
        return strain[0] / volume_of_cell, numpy.linalg.inv(stress[0] / volume_of_cell), shares
    area = volume_of_cell / h
    both = numpy.block([[strain[0], strain[1]], [strain[1], strain[2]]]) / area
    level, across = [0, 1, 3, 6, 7, 9], [2, 4, 5, 8, 10, 11]
    mixed = both[numpy.ix_(level, across)]
    voigt = both[numpy.ix_(level, level)] - mixed @ numpy.linalg.solve(both[numpy.ix_(across, across)], mixed.T)
    flat = [matrix[numpy.ix_([0, 1, 3], [0, 1, 3])] / area for matrix in stress]
    soft = numpy.block([[flat[0] / h**2, 12 * flat[1] / h**4], [12 * flat[1] / h**4, 144 * flat[2] / h**6]])
    return voigt, numpy.linalg.inv(soft), shares


DISCRETISATION = 0.01  # up to which elements are allowed to be too stiff where a bound is exact (a homogeneous plate)


TINY = 1e-6  # what solvers leave


def excess(upper, lower):
    """By what share the lower one is above the upper one, in the direction where it is most; negative: nowhere. Entries of
    different units are scaled first."""
    scale = 1 / numpy.sqrt(numpy.diag(upper))
    return -numpy.linalg.eigvalsh((upper - lower) * numpy.outer(scale, scale)).min()


LARGEST_DIRECT = 3_000  # nodes; beyond, seven factorizations take minutes and gigabytes
LARGEST_DIRECT_BEAM = 200_000  # slender: factorized in seconds, and conjugate gradients take minutes


def is_beam(drivers):
    return any(name.startswith("Beam") for name in drivers)


def check_bounds(matrix, voigt, reuss, plate):
    """Nothing is told of a stiffness that cannot be."""
    for name, upper, lower in (("Voigt", voigt, matrix), ("Reuss", matrix, reuss)):
        if excess(upper, lower) < DISCRETISATION:
            continue
        remedy = "mesh it finer" + (", or with --order 2, the default of plates" if plate else "")
        raise Failure(
            f"the stiffness that was found is {'above' if name == 'Voigt' else 'below'} {name}'s bound, which no cell of "
            f"these materials is: its elements are too coarse{' for bending' if plate else ''}; {remedy}"
        )


def fluxes_of_drivers(deck, drivers, given_solver, ccx, folder, seconds):
    """The matrix of the drivers' forces (fluxes) a unit of their strains (gradients), and the forces of one degree; the nodes'
    displacements where materials have strengths; warnings of CalculiX and how it was done."""
    solver = given_solver
    if solver == "auto":
        largest = LARGEST_DIRECT_BEAM if is_beam(drivers) else LARGEST_DIRECT
        solver = "direct" if len(deck.nodes) <= largest and not deck.wedges else "iterative"
    if solver == "direct" and deck.wedges:
        raise Failure("CalculiX has no cohesive elements: leave out --solver direct")
    started = time.monotonic()
    warnings, fields, breaks = [], None, strength.has_strengths(deck)
    if solver == "direct":
        name = "homogenize"  # not the name of a deck that is kept beside it
        lines = "\n".join(deck.lines) + "\n"
        if breaks:
            lines = lines.replace("*END STEP", "*NODE PRINT, NSET=AllNodes\nU\n*END STEP")
        (folder / f"{name}.inp").write_text(lines)
        warnings = run_ccx(ccx, folder, name, seconds)
        results = folder / f"{name}.dat"
        matrix, thermal = stiffness_from_steps(deck, drivers, reactions(results, deck))
        if breaks:
            fields = displacements(results, deck, drivers)
    else:
        cell = Cell(deck, drivers, conduction.matrices(deck) if deck.physics else deck.matrices())
        matrix, thermal = cell.stiffness()
        if breaks:
            fields = cell.displacements()
    return matrix, thermal, fields, {"solver": solver, "warnings": warnings, "seconds": time.monotonic() - started}


def homogenize(path, ccx, folder, with_bounds=False, solver="auto", seconds=MOST_SECONDS):
    try:
        deck = Deck(path)
    except ForeignElement as failure:
        raise Failure(f"{path}: {failure}, which this script does not know: mesh it without --tetrahedron and --elements") from failure
    drivers = deck.drivers()
    if not drivers or not deck.steps:
        raise Failure(f"{path}: no unit cell with load cases (mesh it with --matrix --periodic; where it is periodic along one axis, --periodic will do)")
    if deck.cell is None:
        raise Failure(f"{path}: the deck does not say its cell")
    matrix, thermal, fields, facts = fluxes_of_drivers(deck, drivers, solver, ccx, folder, seconds)
    if not (numpy.isfinite(matrix).all() and numpy.isfinite(thermal).all()):
        raise Failure(f"{path}: what was found are no numbers: the deck's do not fit together")
    facts |= {
        "file": str(path),
        "cell": numpy.linalg.norm(deck.cell.edges, axis=1).tolist(),
        "nodes": len(deck.nodes),
        "elements": len(deck.elements),
        "asymmetry": abs(matrix - matrix.T).max() / abs(matrix).max(),
        "notes": [],
    }
    matrix = (matrix + matrix.T) / 2
    if deck.physics:
        return facts | conducting(deck, matrix / deck.cell.volume)
    if is_beam(drivers):
        if with_bounds:
            raise Failure("bounds are known of blocks and plates; leave out --bounds: this cell is periodic along one axis, a beam")
        result = facts | beam(deck, matrix, thermal)
    else:
        plate = any(name.startswith("Curvature") for name in drivers)
        measure = deck.cell.volume / (deck.cell.height if plate else 1)
        result = facts | elastic(deck, matrix / measure, thermal / measure, plate, with_bounds)
    if fields is not None:
        result["first_failure"] = strength.first_failure(deck, fields, numpy.array(result["stiffness"]), result["order"])
    return result


def elastic(deck, matrix, thermal, plate, with_bounds):
    constants, expansion = (
        engineering_plate(matrix, thermal, deck.cell.height) if plate else engineering_block(matrix, thermal)
    )
    voigt, reuss, shares = bounds(deck, plate)
    check_bounds(matrix, voigt, reuss, plate)
    result = {
        "kind": "plate" if plate else "block",
        "order": ["xx", "yy", "xy", "kxx", "kyy", "kxy"] if plate else BLOCK,
        "stiffness": matrix.tolist(),
        "engineering": constants,
        "thermal_stress": thermal.tolist(),
        "expansion": expansion,
    }
    if plate and any(len(nodes) in (4, 8) for nodes in deck.elements.values()):
        result["notes"] = [
            "elements of four or eight nodes are too stiff in bending (tetrahedra of usual sizes by a third): the entries of "
            "kxx, kyy, kxy are upper bounds; mesh with --order 2"
        ]
    if with_bounds:
        result |= {"volume_fractions": shares, "voigt": voigt.tolist(), "reuss": reuss.tolist()}
    return result


def beam(deck, matrix, thermal):
    """Forces and moments of a cell that is periodic along one axis, about the middle of the cell: N (N), torque and bending
    moments (N mm)."""
    order = [step["name"].split()[-1] for step in deck.steps[:4]]  # x, x, xy, xz
    axis = "xyz".index(order[0])
    length = deck.cell.edges[axis, axis]
    matrix, thermal = matrix / length, thermal / length
    alone = numpy.linalg.inv(matrix)
    free = -alone @ thermal
    across = [name[-1] for name in order[2:]]
    names = ["EA", "GJ", *(f"EI_{name}" for name in across)]
    free_names = ["alpha", "twist", *(f"curvature_{name}" for name in across)]
    notes = [
        f"periodic along {order[0]}; about its middle, ({', '.join(f'{x:.6g}' for x in deck.cell.center)}); EI_{across[0]} is of the bending in "
        f"which the strain grows along {across[0]}"
    ]
    if any(len(nodes) in (4, 8) for nodes in deck.elements.values()):
        notes.append(
            "elements of four or eight nodes are too stiff where they bend or twist: these are upper bounds, the worse the "
            "more slender the yarns; mesh with --order 2"
        )
    return {
        "kind": "beam",
        "axis": order[0],
        "length": length,
        "middle": deck.cell.center.tolist(),
        "order": ["stretch", "twist", *(f"bending_{name}" for name in across)],
        "stiffness": matrix.tolist(),
        "held": dict(zip(names, numpy.diag(matrix).tolist())),
        "free": dict(zip(names, (1 / numpy.diag(alone)).tolist())),
        "thermal_force": thermal.tolist(),
        "expansion": dict(zip(free_names, free.tolist())),
        "notes": notes,
    }


def conducting(deck, tensor):
    """The tensor with its principal values and bounds; outside of these is an error of the mesh."""
    prop, unit = conduction.LAWS[deck.physics]
    parallel, series, shares = conduction.means(deck)
    lower, upper = conduction.wiener(parallel, series, shares, len(tensor))
    outside = [
        ("above Wiener's (phases in parallel)", excess(upper, tensor)),
        ("below Wiener's (in series)", excess(tensor, lower)),
    ]
    values, directions = numpy.linalg.eigh(tensor)
    result = {
        "kind": "plate" if len(tensor) == 2 else "block",
        "physics": deck.physics,
        "property": prop,
        "unit": unit,
        "order": conduction.AXES[: len(tensor)],
        "tensor": tensor.tolist(),
        "principal": values[::-1].tolist(),
        "directions": directions.T[::-1].tolist(),
        "volume_fractions": shares,
        "wiener": {"lower": lower.tolist(), "upper": upper.tolist()},
    }
    phases = conduction.isotropic_phases(deck, shares)
    if phases and len(phases) > 1 and deck.is_periodic and len(tensor) == 3:
        least, most = conduction.hashin_shtrikman(phases)
        from_below, from_above = (conduction.as_isotropic(tensor, k) for k in (min(phases), max(phases)))
        result["hashin_shtrikman"] = {
            "lower": least,
            "upper": most,
            "mean": values.mean(),
            "from_below": from_below,
            "from_above": from_above,
        }
        outside += [("below Hashin's and Shtrikman's", least / from_below - 1 if from_below else 0)]
        outside += [("above Hashin's and Shtrikman's", from_above / most - 1 if from_above else 0)]
    name, most = max(outside, key=lambda pair: pair[1])
    result["outside"] = max(most, 0.0)
    if most > DISCRETISATION:
        raise Failure(
            f"the {prop} that was found is {name} bound, by {100 * most:.2g} %, which no cell of these materials is: its "
            "elements are too coarse; mesh it finer, or with --order 2"
        )
    if most > TINY:
        result["notes"] = [f"the {prop} is {name} bound, by {100 * most:.2g} %: the elements are coarse"]
    return result


def show_tensor(name, rows):
    print(name)
    for row in rows:
        print("  " + " ".join(f"{value:13.6g}" for value in row))


def show_conduction(result):
    unit = result["unit"]
    show_tensor(f"{result['property']} ({unit}) - {' '.join(result['order'])}", result["tensor"])
    print(f"asymmetry {result['asymmetry']:.1e} of the largest entry")
    for value, direction in zip(result["principal"], result["directions"]):
        print(f"  principal    {value:12.6g} {unit} along {' '.join(f'{x:.4f}' for x in direction)}")
    for name, share in result["volume_fractions"].items():
        print(f"  share of {name:12} {share:.5f}")
    show_tensor("Wiener's bounds: in series", result["wiener"]["lower"])
    show_tensor("in parallel", result["wiener"]["upper"])
    theirs = result.get("hashin_shtrikman")
    if theirs:
        print(
            f"Hashin's and Shtrikman's bounds of an isotropic cell {theirs['lower']:.6g} to {theirs['upper']:.6g}; the mean of "
            f"the principal values is {theirs['mean']:.6g}"
        )


def show(result):
    plate = result["kind"] == "plate"
    print(f"{result['file']}: {result['kind']}, {result['elements']} elements, {result['solver']} solver {result['seconds']:.1f} s")
    if "physics" in result:
        show_conduction(result)
    elif result["kind"] == "beam":
        show_beam(result)
    else:
        show_elastic(result, plate)
    if "first_failure" in result:
        strength.show(result["first_failure"], UNITS[result["kind"]])
    for warning in result["warnings"] + result["notes"]:
        print(warning)


def show_beam(result):
    show_tensor(f"beam stiffness (N, N mm, N mm2) - {' '.join(result['order'])}", result["stiffness"])
    print(f"asymmetry {result['asymmetry']:.1e} of the largest entry")
    print("stiffness with the other three strains held, and with their forces free")
    for name, value in result["held"].items():
        print(f"  {name:12} {value:12.6g} {result['free'][name]:12.6g} {'N' if name == 'EA' else 'N mm2'}")
    print("thermal expansion (1/K; of twist and curvature 1/(mm K))")
    for name, value in result["expansion"].items():
        print(f"  {name:12} {value:12.5g}")


def show_elastic(result, plate):
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


def main():
    parser = argparse.ArgumentParser(
        prog="homogenize",
        description="Stiffness (C of a block, ABD of a plate, that of a beam periodic along one axis), engineering constants and thermal expansion of a unit "
        "cell, or the conductivity (diffusivity, permittivity) of one whose deck conducts, from its deck: by CalculiX, or by "
        "conjugate gradients where it is large. Where materials have strengths: what breaks first, too.",
        epilog="Options that are not known here are those of `selvage mesh`: --size, --voxel, --order, ...",
    )
    parser.add_argument("file", help="deck of `selvage mesh` (.inp), or any input of it with a cell")
    parser.add_argument("--json", metavar="FILE", help="write the results there too ('-': standard output, alone)")
    parser.add_argument("--dry", action="store_true", help="mesh the yarns alone, without a matrix: ropes, dry braids (periodic along one axis)")
    parser.add_argument("--bounds", action="store_true", help="of a stiffness: with volume fractions and the bounds of Voigt and Reuss (which are checked always)")
    parser.add_argument("--keep", metavar="DIR", help="keep the deck and what CalculiX wrote")
    parser.add_argument(
        "--solver",
        choices=["auto", "direct", "iterative"],
        default="auto",
        help=f"CalculiX's factorization, or conjugate gradients without it (default: direct up to {LARGEST_DIRECT:,} nodes, of beams {LARGEST_DIRECT_BEAM:,})",
    )
    parser.add_argument("--timeout", type=float, metavar="S", help=f"seconds that the mesh, and CalculiX, may take each (default: of CalculiX {MOST_SECONDS})")
    parser.add_argument("--memory", type=float, metavar="MB", help="memory that the mesh, CalculiX and this script may take each (default: what is free)")
    parser.add_argument("--ccx", default="ccx", help="the program (default: ccx)")
    parser.add_argument("--selvage", default="selvage", help=argparse.SUPPRESS)
    given, others = parser.parse_known_args()
    path = pathlib.Path(given.file)
    limits = [word for name in ("timeout", "memory") if getattr(given, name) for word in (f"--{name}", f"{getattr(given, name):g}")]
    limit_memory(given.memory)
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(given.keep or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        try:
            if not path.is_file():
                raise Failure(f"{path}: no such file")
            if path.suffix != ".inp":
                deck = folder / (path.stem + ".inp")
                command = [given.selvage, "mesh", str(path), "-o", str(deck), "--periodic", *([] if given.dry else ["--matrix"]), *limits, *others]
                if subprocess.run(command, stdout=sys.stderr, check=False).returncode != 0:
                    raise Failure(f"{path}: it could not be meshed")
                path = deck
            elif given.dry:
                raise Failure("--dry is of what is meshed here, and this is a deck: leave it out")
            elif others:
                raise Failure(f"unknown options: {' '.join(others)}")
            result = homogenize(path, given.ccx, folder, given.bounds, given.solver, given.timeout or MOST_SECONDS)
        except (Failure, NotSolved, BadDeck) as failure:
            print(f"homogenize: {failure}", file=sys.stderr)
            return 1
        except WRONG_NUMBERS as failure:  # a deck that no program wrote
            print(f"homogenize: {path}: what the deck says does not fit together: {reason(failure)}", file=sys.stderr)
            return 1
        except MemoryError:
            print(f"homogenize: {path}: needs more memory than there is, or than --memory gives", file=sys.stderr)
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
