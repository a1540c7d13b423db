"""What gmsh knows of a periodic mesh after opening it, one fact a line."""

import sys

import gmsh
import numpy as np

gmsh.initialize()
gmsh.option.setNumber("General.Verbosity", 2)
gmsh.open(sys.argv[1])
mesh = gmsh.model.mesh
tags, coordinates, _ = mesh.getNodes()
place = dict(zip(tags, coordinates.reshape(-1, 3)))
names = {0: "points", 1: "curves", 2: "surfaces"}
miss, with_image = 0.0, set()
for dimension in (0, 1, 2):
    count = 0
    for _, tag in gmsh.model.getEntities(dimension):
        master, nodes, masters, affine = mesh.getPeriodicNodes(dimension, tag, True)
        if master == tag or not len(nodes):
            continue
        count += 1
        affine = np.array(affine).reshape(4, 4)
        for node, image in zip(nodes, masters):
            there = affine @ np.append(place[image], 1)
            miss = max(miss, float(np.abs(there[:3] - place[node]).max()))
            with_image.add(node)
    print("periodic", names[dimension], count)
high = coordinates.reshape(-1, 3).max(axis=0)
print("largest miss", miss)
print("nodes on high faces", sum(bool((p == high).any()) for p in place.values()))
print("nodes with an image", len(with_image))
print("volumes", len(gmsh.model.getEntities(3)))
gmsh.finalize()
