"""Permeability of a unit cell, the space between its yarns filled with a creeping fluid: see scripts/permeability, which calls this.

The cell is meshed several times (`selvage mesh --pores --periodic`), each time finer. A force of the same size everywhere
drives the fluid along x, then y, then z; the mean velocity over the whole cell is the permeability's row (Darcy's law: velocity =
permeability / viscosity times force). From the meshes follow the value on an infinitely fine one and the error.

own:      Taylor and Hood's curved tetrahedra, no inertia (scripts/pore_flow.py).
openfoam: simpleFoam on flat tetrahedra, at a Reynolds number of next to nothing (scripts/pore_case.py).

Along an axis that is not periodic (z of a plate) the faces are open: the permeability is that of the cell between two reservoirs. For
flow along the other axes these faces are mirrors.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy
    import scipy  # noqa: F401 (that it is there)
except ModuleNotFoundError:
    sys.exit("permeability: NumPy and SciPy are not installed: apt-get install python3-numpy python3-scipy")

import pore_case
from convergence import extrapolated
from pore_flow import NotSolved, PoreFlow
from pore_mesh import PoreMesh

AXES = "xyz"
SQUARE_METRES = 1e-6  # a mm2
# Between which an order of convergence is believed: meshes that are not similar have noise, too.
ORDERS = {"own": (2.0, 5.0), "openfoam": (1.0, 3.0)}


class Failure(Exception):
    pass


def make_mesh(given, size, others, folder):
    """The pores of one size in a file, and what the report says of them."""
    openfoam = given.solver == "openfoam"
    name = folder / f"pores_{size}{'.foam' if openfoam else '.msh'}"
    report = folder / "report.json"
    command = [
        given.selvage,
        "mesh",
        given.file,
        "-o",
        str(name),
        "--pores",
        "--periodic",
        "--order",
        "1" if openfoam else "2",
        "--size" if given.size else "--segments",
        size,
        "--report",
        str(report),
        *others,
    ]
    run = subprocess.run(command, stdout=subprocess.PIPE, stderr=sys.stderr, text=True, check=False)
    if run.returncode != 0 or not name.exists():
        raise Failure(f"{given.file}: it could not be meshed")
    return name, json.loads(report.read_text())["inputs"][0]["mesh"]


def open_axes(facts):
    return [axis for axis in range(3) if AXES[axis] not in facts["periodic"].split()]


def held_patches(facts, axis):
    """For flow along `axis`: for each direction the patches on which the velocity along it is zero."""
    walls = [patch["name"] for patch in facts["patches"] if patch["kind"] == "wall"]
    mirrors = [other for other in open_axes(facts) if other != axis]
    return [walls + [f"{end}_{AXES[k]}" for end in ("inlet", "outlet") if k in mirrors] for k in range(3)]


def tensor_of(given, path, facts):
    """The permeability on one mesh, mm2: row i the mean velocity along i, column j for a force along j; nan: not known."""
    whole = facts["volume"] / facts["porosity"]
    is_open = open_axes(facts)
    tensor, steps = numpy.zeros((3, 3)), []
    flow = PoreFlow(PoreMesh(path)) if given.solver == "own" else pore_case.Case(path, facts)
    for axis in range(3):
        if AXES[axis] not in facts["passages"]["along"]:
            continue
        velocity, count = flow.solve(axis, held_patches(facts, axis))
        tensor[:, axis] = velocity / whole
        steps.append(count)
    for axis in is_open:  # it is known along it alone
        for other in range(3):
            if other != axis:
                tensor[axis, other] = tensor[other, axis] = numpy.nan
    return tensor, steps


def known(tensor):
    """Rows of numbers, None where there is none: JSON has no other word for it."""
    return [[None if numpy.isnan(value) else value for value in row] for row in tensor.tolist()]


def study(given, others, folder):
    words = (given.size or given.segments).split(",")
    meshes = []
    for word in words:
        path, facts = make_mesh(given, word, others, folder)
        tensor, steps = tensor_of(given, path, facts)
        edge = (facts["volume"] / facts["tets"]) ** (1 / 3)
        meshes.append(
            {
                "size": word,
                "tets": facts["tets"],
                "edge": edge,
                "porosity": facts["porosity"],
                "permeability": known(tensor),
                "steps": steps,
                "facts": facts,
            }
        )
        print(
            f"{'size' if given.size else 'segments'} {word}: {facts['tets']} tetrahedra, K (mm2) along x, y, z: "
            + ", ".join(f"{tensor[k, k]:.5g}" for k in range(3)),
            file=sys.stderr,
        )
    meshes.sort(key=lambda mesh: -mesh["edge"])
    edges = [mesh["edge"] for mesh in meshes]
    values = numpy.array([mesh["permeability"] for mesh in meshes], dtype=float)
    limit, error, order = numpy.full((3, 3), numpy.nan), numpy.full((3, 3), numpy.nan), [None] * 3
    for i in range(3):
        limit[i, i], wrong, order[i] = extrapolated(edges, values[:, i, i], ORDERS[given.solver])
        error[i, i] = numpy.nan if wrong is None else wrong
        for j in range(3):
            if i != j:  # next to the others small, and not known better than from mesh to mesh
                limit[i, j] = values[-1, i, j]
                error[i, j] = abs(values[:, i, j] - limit[i, j])[-3:].max() if len(values) > 1 else numpy.nan
    facts = [mesh.pop("facts") for mesh in meshes][-1]
    last = values[-1]
    is_known = ~numpy.isnan(last)
    skew = abs(last - last.T)[is_known & is_known.T].max() / max(numpy.diag(last).max(), 1e-300)
    return {
        "solver": given.solver,
        "periodic": facts["periodic"],
        "passages": facts["passages"]["along"],
        "meshes": meshes,
        "permeability_mm2": known(limit),
        "error_mm2": known(error),
        "order": order,
        "asymmetry": skew,
    }


def show(result):
    limit, error = (numpy.array(result[name], dtype=float) for name in ("permeability_mm2", "error_mm2"))
    is_one = len(result["meshes"]) == 1
    print(
        f"solver: {result['solver']}; {len(result['meshes'])} mesh{'' if is_one else 'es'}, the finest has "
        f"{result['meshes'][-1]['tets']} tetrahedra"
    )
    print(
        "permeability, m2"
        + (" (one mesh: nothing is known of the error)" if is_one else ", extrapolated along x, y, z:")
    )
    for row in SQUARE_METRES * limit:
        print("  " + "  ".join("          -" if numpy.isnan(value) else f"{value:11.4e}" for value in row))
    for k in range(3):
        name = f"K{AXES[k]}{AXES[k]} = {limit[k, k]:.5g} mm2"
        if AXES[k] not in result["passages"]:
            print(f"  {name}: the pores have no passage along {AXES[k]}")
        elif not is_one:
            order = result["order"][k]
            how = f"order {order:.1f}" if order else "no clear order of convergence: the finest mesh's value"
            print(f"  {name}, discretisation error {100 * error[k, k] / limit[k, k]:.2g} % ({how})")
    print(f"asymmetry: {100 * result['asymmetry']:.2g} % of the largest")
    if result["solver"] == "openfoam":
        print(
            "simpleFoam's viscous stress on tetrahedra keeps an error of some per cent, up to about a tenth, whatever the mesh: it is not in "
            "these errors. --layers 3 makes it smaller; the own solver does not have it"
        )
    for axis in AXES:
        if axis not in result["periodic"].split():
            print(
                f"the cell is not periodic along {axis}: K{axis}{axis} is that of the cell between two reservoirs; for the others its "
                f"faces across {axis} are mirrors"
            )


def main():
    parser = argparse.ArgumentParser(
        prog="permeability",
        description="Permeability of a unit cell's pore space, with a study of the mesh.",
        epilog="Other options are those of `selvage mesh`.",
    )
    parser.add_argument("file", help="a text with a `cell`")
    sizes = parser.add_mutually_exclusive_group()
    sizes.add_argument(
        "--segments",
        default="10,14,20",
        metavar="N,..",
        help="edges round each yarn, one mesh for each number (default: 10,14,20)",
    )
    sizes.add_argument("--size", metavar="H,..", help="edge lengths in the input's unit instead")
    parser.add_argument(
        "--solver",
        choices=["own", "openfoam"],
        default="own",
        help="own: curved elements of second order (default); openfoam: simpleFoam",
    )
    parser.add_argument("--json", metavar="FILE", help="the result as JSON; - is standard output")
    parser.add_argument("--keep", metavar="FOLDER", help="keep meshes and cases there")
    parser.add_argument("--selvage", default="selvage", help=argparse.SUPPRESS)
    given, others = parser.parse_known_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(given.keep or temporary)
        folder.mkdir(parents=True, exist_ok=True)
        try:
            if not pathlib.Path(given.file).is_file():
                raise Failure(f"{given.file}: no such file")
            if given.solver == "openfoam":
                pore_case.check_installed()
            elif any(word.startswith("--layer") for word in others):
                raise Failure(
                    "--layers is for --solver openfoam: our own solver has curved elements of second order, which need none"
                )
            result = study(given, others, folder)
        except (Failure, NotSolved, pore_case.Failure) as failure:
            print(f"permeability: {failure}", file=sys.stderr)
            return 1
    if given.json and given.json != "-":
        pathlib.Path(given.json).write_text(json.dumps(result, indent=1, allow_nan=False) + "\n")
    if given.json == "-":
        print(json.dumps(result, indent=1, allow_nan=False))
    else:
        show(result)
    return 0


if __name__ == "__main__":
    sys.exit(main())
