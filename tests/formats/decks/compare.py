"""compare.py REFERENCE.inp OTHER [digits]: every number of one deck against the other's. Prints what was compared, one fact a line,
then `equal` or the first differences."""

import importlib
import os
import sys

import numpy as np

import inp
from names import by_yarns, yarns_of

reference = inp.read(sys.argv[1])
path = sys.argv[2]
tolerance = 10.0 ** -float(sys.argv[3])
reader = importlib.import_module(os.path.splitext(path)[1][1:])
other = reader.read(path)
for model, file in ((reference, sys.argv[1]), (other, path)):
    model.node_sets, model.element_sets = by_yarns(model.node_sets, yarns_of(file)), by_yarns(
        model.element_sets, yarns_of(file)
    )
faults = []


def same(what, a, b):
    if a != b:
        faults.append(f"{what}: {str(a)[:200]} against {str(b)[:200]}")


def near(what, a, b, scale):
    difference = float(np.abs(np.asarray(a, float) - np.asarray(b, float)).max()) / scale if np.size(a) else 0.0
    if not difference <= tolerance:
        faults.append(f"{what}: {difference}")
    return difference


same("node numbers", sorted(reference.nodes), sorted(other.nodes))
same("elements", reference.elements, other.elements)
if not faults:
    numbers = sorted(reference.nodes)
    a, b = ([model.nodes[n] for n in numbers] for model in (reference, other))
    print("coordinates", near("coordinates", a, b, np.abs(a).max()))
    compared = set()
    for element in reference.elements:
        s, density, expansion = first = reference.material[element]
        s2, density2, expansion2 = second = other.material[element]
        if (id(first), id(second)) in compared:
            continue
        compared.add((id(first), id(second)))
        near(f"compliance of {element}", s, s2, np.abs(s).max())
        for k in range(6):
            near(f"modulus {k} of {element}", s[k, k], s2[k, k], s[k, k])
        same(f"has density of {element}", density is None, density2 is None)
        if density is not None:
            near(f"density of {element}", density, density2, density)
        near(f"expansion of {element}", expansion or (0, 0, 0), expansion2 or (0, 0, 0), max(expansion or (1,)))
    same("elements with axes", sorted(reference.axes), sorted(other.axes))
    if not faults and reference.axes:
        print(
            "axes differ by",
            near(
                "axes",
                [reference.axes[e] for e in sorted(reference.axes)],
                [other.axes[e] for e in sorted(other.axes)],
                1,
            ),
        )
    same(
        "node sets",
        {k: v for k, v in reference.node_sets.items() if k not in ("ALLNODES", "DRIVERS") and k in other.node_sets},
        other.node_sets,
    )
    cell_sets = {k for k in reference.node_sets if k.startswith(("FACE", "EDGE", "CORNER"))}
    same("sets of the cell", sorted(cell_sets - set(other.node_sets)), [])
    wanted = {k: v for k, v in reference.element_sets.items() if k in other.element_sets}
    same("element sets", wanted, other.element_sets)
    same(
        "element sets that are missing",
        [k for k in reference.element_sets if k not in wanted and "_SECTION" not in k and k != "ALL"],
        [],
    )
    same("number of equations", len(reference.equations), len(other.equations))
    for a, b in zip(reference.equations, other.equations):
        same("equation", [term[:2] for term in a], [term[:2] for term in b])
        near("factors", [term[2] for term in a], [term[2] for term in b], 1)
loads = other.loads
if path.endswith(".cdb"):
    loads = reader.read_macro(path[:-4] + ".mac") if os.path.exists(path[:-4] + ".mac") else []
if reference.equations:
    same("load cases", reference.loads, loads)
print("nodes", len(other.nodes))
print("elements", len(other.elements))
print("axes", len(other.axes))
print("sets", len(other.node_sets) + len(other.element_sets))
print("equations", len(other.equations))
print("loads", len(loads))
print("\n".join(faults[:20]) if faults else "equal")
sys.exit(1 if faults else 0)
