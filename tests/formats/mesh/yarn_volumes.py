"""Reads a VTU mesh of ten-node tetrahedra with meshio, and prints for every yarn their volume, and the smallest one's."""

import sys

import meshio
import numpy as np

from tetrahedra import volumes_of

mesh = meshio.read(sys.argv[1])
volumes, yarns = [], []
for block, yarn in zip(mesh.cells, mesh.cell_data["yarn"]):
    if block.type in ("tetra", "tetra10"):
        volumes.append(volumes_of(mesh.points, block.data))
        yarns.append(np.asarray(yarn).ravel())
volumes, yarns = np.concatenate(volumes), np.concatenate(yarns)
for yarn in np.unique(yarns):
    own = volumes[yarns == yarn]
    print(repr(float(own.sum())), repr(float(own.min())))
