"""What a deck says, whatever its format: filled by the readers beside this file, each written from the documented layout of its
format alone."""

import numpy as np


class Model:
    def __init__(self):
        self.nodes = {}  # number: coordinates
        self.elements = {}  # number: nodes, in the order of Abaqus
        self.material = {}  # element: constants of its material, see `constants`
        self.axes = {}  # element: 3 x 3, rows are the axes 1, 2, 3; those of isotropic materials are left out
        self.node_sets = {}  # name in capitals: sorted numbers
        self.element_sets = {}
        self.equations = []  # lists of (node, direction 1..3, factor)
        self.loads = []  # each load case: ({node: displacement along x of a driver}, temperature)


def constants(e1, e2, e3, nu12, nu13, nu23, g12, g13, g23, density, expansion):
    """The compliance of Voigt's vector 11 22 33 12 13 23, density and expansion, as one tuple."""
    s = np.zeros((6, 6))
    s[:3, :3] = [[1 / e1, -nu12 / e1, -nu13 / e1], [-nu12 / e1, 1 / e2, -nu23 / e2], [-nu13 / e1, -nu23 / e2, 1 / e3]]
    s[3, 3], s[4, 4], s[5, 5] = 1 / g12, 1 / g13, 1 / g23
    return s, density, expansion


def isotropic(e, nu, density, expansion):
    g = e / (2 * (1 + nu))
    return constants(e, e, e, nu, nu, nu, g, g, g, density, expansion)


def is_isotropic(material):
    s = material[0]
    return np.allclose(s, isotropic(1 / s[0, 0], -s[0, 1] / s[0, 0], None, None)[0], rtol=1e-9, atol=0)


def in_space(values, isotropic_elasticity):
    """Three coefficients of expansion from one or three; of what is isotropic a deck has one, so that it needs no axes."""
    if len(values) == 1:
        return values * 3
    assert not isotropic_elasticity or len(set(values)) > 1, "an isotropic material expands by direction"
    return values


def right_handed(first, second):
    first = np.array(first) / np.linalg.norm(first)
    third = np.cross(first, second)
    third /= np.linalg.norm(third)
    return np.array([first, np.cross(third, first), third])
