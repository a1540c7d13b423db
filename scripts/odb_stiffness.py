"""odb_stiffness.py JOB.odb [--deck FILE.inp] [--json FILE]: the stiffness of a unit cell from the results of its deck in Abaqus.

    abaqus python odb_stiffness.py cell.odb

The deck of `selvage mesh --matrix --periodic` has a step for each strain of the cell (of a plate: and curvature; of a beam:
stretch, twist, bendings), in which one driver node moves, and one for its temperature. The force on a driver is the stress of
the cell times its volume (of a plate: a force or moment a length times its area; of a beam: a force or moment times its length).
The deck itself says the cell and the temperature; it is looked for beside the results (--deck).

It runs in Abaqus' own Python, 2.7 or 3, without NumPy. Everything that knows of Abaqus is in `read_steps`.
"""

from __future__ import print_function

import argparse
import io
import json
import os
import sys

KINDS = (("Constraints", 6), ("Curvature", 3), ("Beam", 4))
NAMES = [kind + "Driver" + str(k) for kind, count in KINDS for k in range(count)]


class Failure(Exception):
    pass


def read_steps(path):
    """Of each step, in its order, the displacement along x of every driver node and the force on it, at its end."""
    from abaqusConstants import DOUBLE_PRECISION
    from odbAccess import openOdb

    def first(field, region):
        value = field.getSubset(region=region).values[0]
        return float((value.dataDouble if value.precision == DOUBLE_PRECISION else value.data)[0])

    odb = openOdb(path, readOnly=True)
    try:
        sets = {}
        for owner in [odb.rootAssembly] + list(odb.rootAssembly.instances.values()):
            for name in owner.nodeSets.keys():
                sets.setdefault(name.upper(), owner.nodeSets[name])
        drivers = [name for name in NAMES if name.upper() in sets]
        steps = []
        for step in sorted(odb.steps.values(), key=lambda one: one.number):
            if len(step.frames) == 0:
                continue
            fields = step.frames[-1].fieldOutputs
            if "U" not in fields.keys() or "RF" not in fields.keys():
                raise Failure(
                    "step '" + step.name + "' has no U and RF: leave Abaqus' preselected output on, or ask for both"
                )
            regions = [sets[name.upper()] for name in drivers]
            steps.append(
                {name: (first(fields["U"], at), first(fields["RF"], at)) for name, at in zip(drivers, regions)}
            )
        return drivers, steps
    finally:
        odb.close()


def read_deck(path):
    """The cell's edges, and of each step its comment and temperature."""
    edges, steps, comment, keyword = None, [], "", ""
    with io.open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            line = line.strip()
            if line.startswith("**"):
                comment = line[2:].strip()
                if comment.startswith("Cell: "):
                    v = [float(word) for word in comment[6:].split()]
                    edges = (
                        [v[3:6], v[6:9], v[9:12]]
                        if len(v) == 12
                        else [[v[3] - v[0], 0, 0], [0, v[4] - v[1], 0], [0, 0, v[5] - v[2]]]
                    )
            elif line.startswith("*"):
                keyword = line.split(",")[0].upper()
                if keyword == "*STEP":
                    steps.append([comment, 0.0])
            elif keyword == "*TEMPERATURE" and steps:
                steps[-1][1] = float(line.split(",")[1])
    if edges is None or not steps:
        raise Failure(path + ": no deck of a unit cell with load cases")
    return edges, steps


def volume_of(edges):
    (a, b, c), (d, e, f), (g, h, i) = edges
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def measure_of(drivers, edges, steps):
    """What forces on drivers are divided by, and what the quotient is."""
    if drivers[0].startswith("Beam"):
        axis = "xyz".index(steps[0][0].split()[-1])  # stretch x
        return edges[axis][axis], "beam", "N, N mm, N mm2"
    if any(name.startswith("Curvature") for name in drivers):
        return volume_of(edges) / edges[2][2], "plate", "N/mm, N, N mm"
    return volume_of(edges), "block", "MPa"


def stiffness(drivers, results, edges, steps):
    """Columns of the stiffness, a row a driver, and what one degree makes of the cell that is held."""
    if not drivers:
        raise Failure("the results have no driver nodes (ConstraintsDriver0, ..)")
    if len(results) != len(steps):
        raise Failure(
            "the results have " + str(len(results)) + " steps, and the deck " + str(len(steps)) + ": did the job end?"
        )
    measure, kind, unit = measure_of(drivers, edges, steps)
    columns, comments, thermal = {}, {}, None
    for result, (comment, temperature) in zip(results, steps):
        moved = [name for name in drivers if result[name][0] != 0]
        if len(moved) == 1:
            comments[moved[0]] = comment
            columns[moved[0]] = [result[name][1] / result[moved[0]][0] / measure for name in drivers]
        elif not moved and temperature:
            thermal = [result[name][1] / temperature / measure for name in drivers]
    without = [name for name in drivers if name not in columns]
    if without:
        raise Failure("no step moves " + ", ".join(without) + " alone")
    matrix = [[columns[name][row] for name in drivers] for row in range(len(drivers))]
    return {
        "kind": kind,
        "unit": unit,
        "order": [comments[name] for name in drivers],
        "stiffness": matrix,
        "thermal_stress": thermal,
    }


def show(result):
    print("stiffness of a " + result["kind"] + " (" + result["unit"] + ") - " + ", ".join(result["order"]))
    for row in result["stiffness"]:
        print("  " + " ".join("%13.6g" % value for value in row))
    if result["thermal_stress"]:
        print("a degree, with all strains held")
        print("  " + " ".join("%13.6g" % value for value in result["thermal_stress"]))


def main():
    parser = argparse.ArgumentParser(
        prog="odb_stiffness.py",
        description="The stiffness of a unit cell from Abaqus' results: run by `abaqus python`.",
    )
    parser.add_argument("odb", help="results of the deck of `selvage mesh --matrix --periodic`")
    parser.add_argument("--deck", help="the deck (default: that of the results' name beside them)")
    parser.add_argument("--json", metavar="FILE", help="write the results there too")
    given = parser.parse_args()
    deck = given.deck or os.path.splitext(given.odb)[0] + ".inp"
    try:
        for path in (given.odb, deck):
            if not os.path.isfile(path):
                raise Failure(path + ": no such file")
        edges, steps = read_deck(deck)
        drivers, results = read_steps(given.odb)
        result = stiffness(drivers, results, edges, steps)
    except ImportError:
        print(
            "odb_stiffness.py: Abaqus' Python is needed: abaqus python odb_stiffness.py " + given.odb, file=sys.stderr
        )
        return 1
    except Failure as failure:
        print("odb_stiffness.py: " + str(failure), file=sys.stderr)
        return 1
    show(result)
    if given.json:
        with open(given.json, "w") as file:
            json.dump(result, file, indent=1)
            file.write("\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
