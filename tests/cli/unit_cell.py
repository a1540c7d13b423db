"""A unit cell's mesh as its Abaqus deck has it, read and measured without the program: numpy only."""

import re

import numpy as np

EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]  # under the middle nodes of a C3D10
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def box_of(sample):
    """Low and high corner of the `cell` of a Fabric TXT."""
    for line in sample.read_text().splitlines():
        words = line.split("#")[0].split()
        if words and words[0].lower() == "cell":
            numbers = np.array([float(word) for word in words[1:7]]).reshape(2, 3)
            return numbers.min(axis=0), numbers.max(axis=0)
    raise ValueError(f"{sample} has no cell")


def rows_of(lines):
    """Numbers between commas, as many in each line."""
    return np.fromstring("".join(lines).replace("\n", ","), sep=",").reshape(len(lines), -1)


class Deck:
    """Nodes by number and elements by set."""

    def __init__(self, path):
        self.sets, self.types = {}, set()
        blocks, elements, block = [], {}, []  # lines of numbers: of nodes, of elements by set
        with open(path, encoding="utf-8") as deck:
            for line in deck:
                if not line.startswith("*"):
                    block.append(line)
                elif not line.startswith("**"):
                    keyword = line.split(",")[0].strip().upper()
                    options = dict(part.strip().upper().split("=", 1) for part in line.split(",")[1:] if "=" in part)
                    block = []
                    if keyword == "*NODE":
                        blocks.append(block)
                    elif keyword == "*ELEMENT":
                        self.types.add(options["TYPE"])
                        elements.setdefault(re.search(r"ELSET=([\w-]+)", line, re.I).group(1), []).append(block)
        nodes = np.concatenate([rows_of(block) for block in blocks])
        self.points = nodes[:, 1:]
        numbers = nodes[:, 0].astype(int)
        index = np.full(numbers.max() + 1, -1)
        index[numbers] = np.arange(len(numbers))
        for name, own in elements.items():
            self.sets[name] = index[np.concatenate([rows_of(block) for block in own])[:, 1:].astype(int)]
            assert (self.sets[name] >= 0).all(), f"{name}: an element has a node that is not there"

    def all_elements(self):
        return np.concatenate(list(self.sets.values()))

    def used(self):
        """Nodes of elements (drivers are in none)."""
        return np.unique(self.all_elements())


def corner_volumes(points, cells):
    p = points[cells[:, :4]]
    return np.einsum("ij,ij->i", np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6


def shape_slopes(x, y, z):
    """Derivatives of the ten shape functions by the three coordinates at a point of the unit tetrahedron."""
    linear = np.array([1 - x - y - z, x, y, z])
    d = np.array([[-1, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
    rows = [(4 * linear[i] - 1) * d[i] for i in range(4)]
    rows += [4 * (linear[a] * d[b] + linear[b] * d[a]) for a, b in EDGES]
    return np.array(rows)


def jacobians(points, cells, at):
    slopes = shape_slopes(*at)
    return np.linalg.det(np.einsum("eni,nj->eij", points[cells], slopes))


CORNERS_AND_MIDDLES = [
    (0, 0, 0),
    (1, 0, 0),
    (0, 1, 0),
    (0, 0, 1),
    (0.5, 0, 0),
    (0.5, 0.5, 0),
    (0, 0.5, 0),
    (0, 0, 0.5),
    (0.5, 0, 0.5),
    (0, 0.5, 0.5),
    (0.25, 0.25, 0.25),
]
A, B = (5 + 3 * 5**0.5) / 20, (5 - 5**0.5) / 20
# The determinant is a cubic: the rule of degree three with five points.
DEGREE_3 = [((0.25, 0.25, 0.25), -4 / 5)] + [
    (p, 9 / 20) for p in ((0.5, 1 / 6, 1 / 6), (1 / 6, 0.5, 1 / 6), (1 / 6, 1 / 6, 0.5), (1 / 6, 1 / 6, 1 / 6))
]


def volumes(points, cells):
    if cells.shape[1] == 4:
        return corner_volumes(points, cells)
    return sum(weight * jacobians(points, cells, at) for at, weight in DEGREE_3) / 6


def smallest_jacobian(points, cells):
    """Over nodes and middle, as a share of the straight element's."""
    if cells.shape[1] == 4:
        return 1.0 if corner_volumes(points, cells).min() > 0 else -1.0
    straight = 6 * corner_volumes(points, cells)
    return min((jacobians(points, cells, at) / straight).min() for at in CORNERS_AND_MIDDLES)


def dihedral_angles(points, cells):
    """Six a tetrahedron, degrees."""
    p = points[cells[:, :4]]
    normals = [np.cross(p[:, b] - p[:, a], p[:, c] - p[:, a]) for a, b, c in FACES]  # outward
    normals = [n / np.linalg.norm(n, axis=1, keepdims=True) for n in normals]
    angles = [
        180 - np.degrees(np.arccos(np.clip(np.einsum("ij,ij->i", normals[a], normals[b]), -1, 1)))
        for a in range(4)
        for b in range(a)
    ]
    return np.array(angles).T


def outer_faces(cells):
    """Corner nodes of the faces that only one element has. A face that three have is an error."""
    faces = np.sort(np.concatenate([cells[:, list(face)] for face in FACES]), axis=1)
    unique, counts = np.unique(faces, axis=0, return_counts=True)
    assert counts.max() <= 2, "a face belongs to three elements"
    return unique[counts == 1]


def face_areas(points, faces):
    p = points[faces]
    return np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1) / 2


def on_plane(points, axis, value):
    return np.flatnonzero(points[:, axis] == value)


def opposite_miss(points, low, high, axis):
    """The largest difference of the nodes of two opposite faces; infinity where their numbers differ."""
    others = [k for k in range(3) if k != axis]
    a, b = points[points[:, axis] == low[axis]][:, others], points[points[:, axis] == high[axis]][:, others]
    if len(a) != len(b) or len(a) == 0:
        return np.inf
    grid = 1e-7 * (high - low).max()

    def ordered(p):
        return p[np.lexsort(np.round(p / grid).T)]

    return np.abs(ordered(a) - ordered(b)).max()
