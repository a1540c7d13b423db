"""The mesh of a pore space as `selvage mesh --pores -o FILE.msh` writes it, read for scripts/permeability."""

import numpy

TETRAHEDRA = {4: 4, 11: 10}  # nodes by Gmsh's type
TRIANGLES = {2: 3, 9: 6}
# Gmsh's ten nodes in the order of scripts/cell_elements.py: the last two exchanged.
ORDER = {4: [0, 1, 2, 3], 10: [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]}


class PoreMesh:
    """`nodes`: n x 3, mm; `elements`: m x 4 or 10 indices; `patches`: of each name its nodes; `master`: of each node the one
    that it repeats, itself where it repeats none."""

    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            self._lines = iter(file.read().splitlines())
        self._names, self._of_surface, self.patches = {}, {}, {}
        self._pairs = []
        self._sections = {
            "$PhysicalNames": self._read_names,
            "$Entities": self._read_entities,
            "$Nodes": self._read_nodes,
            "$Elements": self._read_elements,
            "$Periodic": self._read_periodic,
        }
        for line in self._lines:
            if line in self._sections:
                self._sections[line]()
        self.patches = {name: numpy.unique(numpy.concatenate(parts)) for name, parts in self.patches.items()}
        self.master = numpy.arange(len(self.nodes))
        for node, other in self._pairs:
            self.master[node] = other
        while (self.master[self.master] != self.master).any():
            self.master = self.master[self.master]

    def _numbers(self):
        return [int(word) for word in next(self._lines).split()]

    def _read_names(self):
        for _ in range(int(next(self._lines))):
            dimension, tag, name = next(self._lines).split(" ", 2)
            if dimension == "2":
                self._names[int(tag)] = name[1:-1]

    def _read_entities(self):
        points, curves, surfaces, _ = self._numbers()
        for _ in range(points + curves):
            next(self._lines)
        for _ in range(surfaces):
            words = next(self._lines).split()
            self._of_surface[int(words[0])] = self._names[int(words[8])]

    def _read_nodes(self):
        blocks, count, _, _ = self._numbers()
        self.nodes = numpy.empty((count, 3))
        for _ in range(blocks):
            size = self._numbers()[3]
            numbers = [int(next(self._lines)) - 1 for _ in range(size)]
            for number in numbers:
                self.nodes[number] = [float(word) for word in next(self._lines).split()]

    def _read_elements(self):
        elements = []
        for _ in range(self._numbers()[0]):
            _, entity, kind, size = self._numbers()
            rows = [next(self._lines) for _ in range(size)]
            if kind in TETRAHEDRA or kind in TRIANGLES:
                numbers = numpy.array([row.split() for row in rows], dtype=int)[:, 1:] - 1
                if kind in TETRAHEDRA:
                    elements.append(numbers[:, ORDER[TETRAHEDRA[kind]]])
                else:
                    self.patches.setdefault(self._of_surface[entity], []).append(numbers.ravel())
        self.elements = numpy.concatenate(elements)

    def _read_periodic(self):
        for _ in range(int(next(self._lines))):
            next(self._lines)
            next(self._lines)
            for _ in range(int(next(self._lines))):
                node, other = self._numbers()
                self._pairs.append((node - 1, other - 1))
