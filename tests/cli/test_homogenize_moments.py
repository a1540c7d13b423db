"""Volumes and moments of elements in scripts/homogenize, against integrals by hand."""

import pathlib
import sys
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "scripts"))
import cell_deck


def ten_nodes(corners):
    return np.vstack([corners] + [[(corners[a] + corners[b]) / 2] for a, b in cell_deck.EDGES])


class Moments(unittest.TestCase):
    unit = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])

    def check(self, nodes, expected):
        np.testing.assert_allclose([m[0] for m in cell_deck.moments_of_tetrahedra(nodes[None])], expected, rtol=1e-13)

    def test_straight(self):
        """The integral of x^a y^b z^c over the unit tetrahedron is a! b! c! / (a + b + c + 3)!."""
        self.check(self.unit, [1 / 6, 1 / 24, 1 / 60])
        self.check(ten_nodes(self.unit), [1 / 6, 1 / 24, 1 / 60])

    def test_bent(self):
        """z + x y instead of z keeps every volume; the integral of its square is that of z^2 + 2 x y z + x^2 y^2."""
        nodes = ten_nodes(self.unit)
        nodes[:, 2] += nodes[:, 0] * nodes[:, 1]
        self.check(nodes, [1 / 6, 1 / 24 + 1 / 120, 1 / 60 + 2 / 720 + 4 / 5040])

    def test_brick(self):
        brick = np.array([[x, y, z] for z in (1.0, 3.0) for x, y in ((0, 0), (2, 0), (2, 5), (0, 5))])
        np.testing.assert_allclose([m[0] for m in cell_deck.moments_of_boxes(brick[None])], [20, 40, 10 * 26 / 3])


if __name__ == "__main__":
    unittest.main()
