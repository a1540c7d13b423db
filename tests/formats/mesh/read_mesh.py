"""Reads a mesh with meshio and prints what it holds, one fact a line: the volume by its own integration over the elements,
their orientations, the named groups."""

import sys

import meshio
import numpy as np

# Points and weights of the rule of degree 3 over a tetrahedron, and the edges of VTK's ten nodes (meshio's order).
BARY = np.vstack([np.full((1, 4), 0.25), np.full((4, 4), 1 / 6) + np.eye(4) / 3])
WEIGHTS = np.array([-0.8, 0.45, 0.45, 0.45, 0.45])
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]


def volumes(points, cells):
    x = points[cells]
    if cells.shape[1] == 4:
        return np.linalg.det(x[:, 1:] - x[:, :1]) / 6
    total = np.zeros(len(cells))
    for bary, weight in zip(BARY, WEIGHTS):
        slope = np.zeros((10, 4))
        for i in range(4):
            slope[i, i] = 4 * bary[i] - 1
        for k, (a, b) in enumerate(EDGES):
            slope[4 + k, a] += 4 * bary[b]
            slope[4 + k, b] += 4 * bary[a]
        jacobian = np.einsum("enk,nj->ejk", x, slope[:, 1:] - slope[:, :1])
        total += weight * np.linalg.det(jacobian) / 6
    return total


mesh = meshio.read(sys.argv[1])
tets = [(i, block) for i, block in enumerate(mesh.cells) if block.type in ("tetra", "tetra10")]
parts = [volumes(mesh.points, block.data) for _, block in tets]
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
