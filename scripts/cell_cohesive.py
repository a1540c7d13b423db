"""Interfaces of a unit cell's deck, for scripts/homogenize: cohesive elements (COH3D6, of which CalculiX has none) as long as
nothing breaks, and the nodes that ties join."""

import numpy

WEIGHTS = (
    numpy.ones((3, 3)) + numpy.eye(3)
) / 12  # integrals of products of two corners' shares of a triangle of area 1


def sides(deck, numbers):
    """Places of the nodes of the first side (n x 3 nodes x 3), areas, and unit normals from the first side to the second."""
    p = numpy.array([[deck.nodes[n] for n in deck.wedges[e][:3]] for e in numbers])
    normal = numpy.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    twice = numpy.linalg.norm(normal, axis=1)
    return p, twice / 2, normal / twice[:, None]


def parts(deck, chunk=20_000):
    """Of all cohesive elements, some at a time: their numbers, and stiffness across and along the interface."""
    for name, material in deck.layers:
        numbers = deck.element_sets[name]
        for k in range(0, len(numbers), chunk):
            yield numbers[k : k + chunk], *deck.materials[material]["traction"][:2]


def matrices(deck):
    """For cell_elements.Cell: numbers, stiffness matrices (n x 18 x 18), and no forces of their own."""
    opening = numpy.kron([[1, -1], [-1, 1]], WEIGHTS)
    for numbers, across, along in parts(deck):
        _, area, n = sides(deck, numbers)
        traction = along * numpy.eye(3) + (across - along) * n[:, :, None] * n[:, None, :]
        matrix = numpy.einsum("n,ab,nij->naibj", area, opening, traction).reshape(len(numbers), 18, 18)
        yield numbers, matrix, numpy.zeros((len(numbers), 18))


def compliances(deck):
    """What interfaces yield to a stress that is the same on both sides (order xx yy zz xy xz yz): some at a time, their areas,
    first and second moments of their heights about the middle of the cell, and matrices (n x 6 x 6)."""
    middle = deck.cell.middle
    stresses = numpy.zeros((6, 3, 3))
    for k, (i, j) in enumerate([(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]):
        stresses[k, i, j] = stresses[k, j, i] = 1
    for numbers, across, along in parts(deck):
        p, area, n = sides(deck, numbers)
        z = p[:, :, 2] - middle
        tractions = numpy.einsum("kij,nj->nki", stresses, n)
        yields = numpy.eye(3) / along + (1 / across - 1 / along) * n[:, :, None] * n[:, None, :]
        matrix = numpy.einsum("nki,nij,nlj->nkl", tractions, yields, tractions)
        yield area, area * z.mean(axis=1), area * numpy.einsum("na,ab,nb->n", z, WEIGHTS, z), matrix


def tied(deck):
    """Which node each tied node goes with: the one at its place on the other surface."""
    masters = {}
    for slave, master in deck.ties:
        at = {deck.nodes[n]: n for n in surface_nodes(deck, master)}
        masters |= {node: at[deck.nodes[node]] for node in surface_nodes(deck, slave)}
    return masters


SIDES = {"S1": (0, 1, 2, 4, 5, 6), "S2": (0, 1, 3, 4, 8, 7), "S3": (1, 2, 3, 5, 9, 8), "S4": (0, 2, 3, 6, 9, 7)}


def surface_nodes(deck, name):
    kind, rows = deck.surfaces[name]
    if kind == "NODE":
        return [node for row in rows for node in deck.sets[row[0]]]
    return {deck.elements[int(e)][k] for e, side in rows for k in SIDES[side] if k < len(deck.elements[int(e)])}
