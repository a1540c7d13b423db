"""Reads a mesh with meshio and prints what it holds, one fact a line: the volume by its own integration over the elements,
their orientations, the named groups."""

import sys

import meshio
import numpy as np

from tetrahedra import volumes_of

mesh = meshio.read(sys.argv[1])
tets = [(i, block) for i, block in enumerate(mesh.cells) if block.type in ("tetra", "tetra10")]
parts = [volumes_of(mesh.points, block.data) for _, block in tets]
print("nodes", len(mesh.points))
print("tets", sum(len(block.data) for _, block in tets))
print("triangles", sum(len(block.data) for block in mesh.cells if block.type.startswith("triangle")))
print("volume", repr(float(sum(part.sum() for part in parts))))
print("smallest", repr(float(min(part.min() for part in parts))))
if "along" in mesh.cell_data:
    along = np.vstack([mesh.cell_data["along"][i] for i, _ in tets])
    across = np.vstack([mesh.cell_data["across"][i] for i, _ in tets])
    print("along_x", repr(float(np.abs(along[:, 0]).min())))
    print("along_across", repr(float(np.abs((along * across).sum(axis=1)).max())))
    print("yarns", len(np.unique(np.concatenate([mesh.cell_data["yarn"][i] for i, _ in tets]))))
    print("jacobian", repr(float(min(mesh.cell_data["scaled_jacobian"][i].min() for i, _ in tets))))
for name, nodes in sorted(mesh.point_sets.items()):
    print("set", name, len(nodes))
for name in sorted(mesh.field_data):
    print("group", name, mesh.field_data[name][1])
