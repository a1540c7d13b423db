"""read_all.py STEM: the .inp as our own parser has it against meshio's reading of the .inp, .msh, .vtu and .bdf, and gmsh's of the
.unv: nodes, elements, sets, materials' groups. Prints the differences, or `equal`."""

import sys

import gmsh
import meshio
import numpy as np

import inp

stem = sys.argv[1]
NAME = "WARP__1_"  # of the yarn, as the deck has it
reference = inp.read(stem + ".inp")
faults = []
numbers = sorted(reference.nodes)
points = np.array([reference.nodes[n] for n in numbers])
elements = sorted(tuple(nodes) for nodes in reference.elements.values())
yarn = {tuple(reference.elements[e]) for e in reference.element_sets[NAME]}


def check(what, good):
    print(what, "right" if good else "wrong")
    if not good:
        faults.append(what)


def solids(mesh):
    """Blocks of the solids in meshio's order of nodes, which is VTK's and Abaqus's, as node numbers of ours."""
    return [
        (i, block.data + 1) for i, block in enumerate(mesh.cells) if block.type in ("tetra", "tetra10", "hexahedron")
    ]


def by_place(found):
    """Our numbers for the points of a file that may have them in another order."""
    order = {tuple(p): n for n, p in zip(numbers, points)}
    return np.array([0] + [order[tuple(p)] for p in found])


for extension in (".inp", ".vtu", ".bdf", ".msh"):
    mesh = meshio.read(stem + extension)
    count = len(points) if extension in (".inp", ".bdf") else len(points) - 6  # without the drivers
    check(
        extension + " nodes",
        len(mesh.points) == count and all(tuple(p) in set(map(tuple, points)) for p in mesh.points)
        if extension != ".bdf"
        else np.abs(mesh.points - points).max() < 1e-12,
    )
    if extension == ".bdf":
        number = np.arange(len(points) + 1)
    else:
        number = by_place(mesh.points)
    blocks = [(i, number[data]) for i, data in solids(mesh)]
    found = sorted(tuple(row) for _, data in blocks for row in data.tolist())
    check(extension + " elements", found == elements)
    if extension == ".inp":
        for name, members in reference.node_sets.items():
            key = next(k for k in mesh.point_sets if k.upper() == name)
            check("inp set " + name, sorted(number[np.array(mesh.point_sets[key]) + 1].tolist()) == members)
        cells = set()
        for (i, data), part in zip(
            blocks, [mesh.cell_sets[next(k for k in mesh.cell_sets if k.upper() == NAME)][i] for i, _ in blocks]
        ):
            cells |= {tuple(row) for row in data[np.asarray(part, int)].tolist()}
        check("inp yarn", cells == yarn)
    if extension == ".vtu":
        cells = {tuple(row) for i, data in blocks for row, y in zip(data.tolist(), mesh.cell_data["yarn"][i]) if y == 0}
        check("vtu yarn", cells == yarn)
        fractions = np.concatenate([mesh.cell_data["fibre_fraction"][i] for i, _ in blocks])
        check("vtu fibre fraction", fractions.max() > 0.7 and fractions.min() == 0)
        vtu_rows = [row for _, data in blocks for row in data.tolist()]
        along = np.vstack([mesh.cell_data["along"][i] for i, _ in blocks])
        rows = [row for _, data in blocks for row in data.tolist()]
        element_of = {nodes: e for e, nodes in reference.elements.items()}
        check(
            "vtu along",
            all(
                np.abs(reference.axes[element_of[tuple(row)]][0] - a).max() < 1e-12
                for row, a in zip(rows, along)
                if element_of[tuple(row)] in reference.axes
            ),
        )
    if extension == ".msh":
        tag = mesh.field_data["warp '1'"][0]
        cells = {
            tuple(row)
            for i, data in blocks
            for row, t in zip(data.tolist(), mesh.cell_data["gmsh:physical"][i])
            if t == tag
        }
        check("msh yarn", cells == yarn)
        for name in ("FaceA", "FaceB", "FaceC", "FaceD", "FaceE", "FaceF", "warp '1'_side", "matrix"):
            check("msh group " + name, name in mesh.field_data)
        on_face = {
            n
            for i, block in enumerate(mesh.cells)
            if block.type.startswith(("triangle", "quad"))
            for row, t in zip(block.data, mesh.cell_data["gmsh:physical"][i])
            if t == mesh.field_data["FaceA"][0]
            for n in number[row + 1].tolist()
        }
        check(
            "msh face",
            set(reference.node_sets["FACEA"]) <= on_face
            and all(reference.nodes[n][0] == points[: len(points) - 6, 0].max() for n in on_face),
        )
    if extension == ".msh":
        # The shares that VTU has; a triangle has that of a solid with its corners, a point that of one at it.
        share_of = {nodes: share for nodes, share in zip(map(tuple, vtu_rows), fractions)}
        own = {
            tuple(row): share
            for (i, data) in blocks
            for row, share in zip(data.tolist(), mesh.cell_data["fibre_fraction"][i])
        }
        check("msh fibre fraction", own == share_of)
        solids_at = {}
        for nodes in share_of:
            for node in nodes:
                solids_at.setdefault(node, []).append(nodes)
        check(
            "msh fibre fraction beside",
            all(
                share == max(share_of[solid] for solid in solids_at[row[0]] if set(row) <= set(solid))
                for i, block in enumerate(mesh.cells)
                if block.type not in ("tetra", "tetra10", "hexahedron")
                for row, share in zip(number[block.data + 1].tolist(), mesh.cell_data["fibre_fraction"][i])
            ),
        )
    if extension == ".bdf":
        refs = np.concatenate([mesh.cell_data["nastran:ref"][i] for i, _ in blocks])
        check("bdf properties", len(np.unique(refs)) > 1)

gmsh.initialize()
gmsh.option.setNumber("General.Verbosity", 2)
gmsh.open(stem + ".unv")
tags, coordinates, _ = gmsh.model.mesh.getNodes()
place = dict(zip(tags.tolist(), coordinates.reshape(-1, 3)))
check(
    "unv nodes",
    len(place) == len(points) - 6 and all(np.abs(place[n] - reference.nodes[n]).max() == 0 for n in numbers[:-6]),
)
found = []
for _, entity in gmsh.model.getEntities(3):
    types, _, node_tags = gmsh.model.mesh.getElements(3, entity)
    for kind, nodes in zip(types, node_tags):
        rows = nodes.reshape(-1, {4: 4, 11: 10, 5: 8}[kind])
        if kind == 11:
            rows = rows[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]]
        found += [tuple(row) for row in rows.tolist()]
check("unv elements", sorted(found) == elements)
gmsh.finalize()
print("\n".join(faults))
print("\nequal" if not faults else "different")
