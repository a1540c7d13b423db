"""The ABD matrix of a plate's unit cell from nodes, elements and materials of its Abaqus deck alone: elements, conditions and
solver are written anew here, with numpy, and nothing of the deck's equations, drivers or steps is looked at."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "formats" / "decks"))
import inp

from unit_cell import EDGES, shape_slopes

VOIGT = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
# Four points, as Abaqus and CalculiX integrate a C3D10.
A, B = (5 + 3 * 5**0.5) / 20, (5 - 5**0.5) / 20
FOUR = [((B, B, B), 1 / 24), ((A, B, B), 1 / 24), ((B, A, B), 1 / 24), ((B, B, A), 1 / 24)]


def strains_of(slopes):
    """Engineering strains by nodal displacements: elements x 6 x (3 nodes), from elements x nodes x 3."""
    count, nodes, _ = slopes.shape
    b = np.zeros((count, 6, nodes, 3))
    for row, (i, j) in enumerate(VOIGT):
        b[:, row, :, i] += slopes[:, :, j]
        if i != j:
            b[:, row, :, j] += slopes[:, :, i]
    return b.reshape(count, 6, 3 * nodes)


def points_of_elements(places):
    """Of each integration point: strains by displacements, places, weights."""
    if places.shape[1] == 4:
        rule = [((0.25, 0.25, 0.25), 1 / 6)]
    else:
        rule = FOUR
    for at, weight in rule:
        x, y, z = at
        shares = np.array([1 - x - y - z, x, y, z])
        if places.shape[1] == 4:
            slope = np.array([[-1, -1, -1], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
            values = shares
        else:
            slope = shape_slopes(*at)
            values = np.concatenate([shares * (2 * shares - 1), [4 * shares[a] * shares[b] for a, b in EDGES]])
        frame = np.einsum("ai,nac->nic", slope, places)  # rows: the place by each coordinate of the element
        yield (
            strains_of(np.einsum("nci,ai->nac", np.linalg.inv(frame), slope)),
            np.einsum("a,nac->nc", values, places),
            weight * np.linalg.det(frame),
        )


def stiffness_in_space(model, numbers):
    """6 x 6 of each element, engineering strains xx yy zz xy xz yz."""
    inverse = {}
    result = np.empty((len(numbers), 6, 6))
    for k, number in enumerate(numbers):
        compliance = model.material[number][0]
        local = inverse.setdefault(id(compliance), np.linalg.inv(compliance))
        if number not in model.axes:
            result[k] = local
            continue
        r = model.axes[number]
        # The tensor of fourth order in full, turned.
        tensor = np.empty((3, 3, 3, 3))
        for a, (i, j) in enumerate(VOIGT):
            for b, (p, q) in enumerate(VOIGT):
                tensor[i, j, p, q] = tensor[j, i, p, q] = tensor[i, j, q, p] = tensor[j, i, q, p] = local[a, b]
        turned = tensor
        for _ in range(4):  # each axis in turn comes first and is put last
            turned = np.tensordot(turned, r, axes=(0, 0))
        for a, (i, j) in enumerate(VOIGT):
            for b, (p, q) in enumerate(VOIGT):
                result[k, a, b] = turned[i, j, p, q]
    return result


def displacements_of_plate(p):
    """Kirchhoff's at places from the middle: places x 3 x (xx yy xy kxx kyy kxy)."""
    x, y, z = p.T
    u = np.zeros((len(p), 3, 6))
    u[:, 0, 0], u[:, 1, 1] = x, y
    u[:, 0, 2], u[:, 1, 2] = y / 2, x / 2
    u[:, 0, 3], u[:, 2, 3] = z * x, -x * x / 2
    u[:, 1, 4], u[:, 2, 4] = z * y, -y * y / 2
    u[:, 0, 5], u[:, 1, 5], u[:, 2, 5] = z * y / 2, z * x / 2, -x * y / 2
    return u


def strains_of_plate(p):
    """Their strains: places x 6 x 6."""
    z = p[:, 2]
    e = np.zeros((len(p), 6, 6))
    for row, column in ((0, 0), (1, 1), (3, 2)):
        e[:, row, column], e[:, row, column + 3] = 1, z
    return e


def classes_over(places, low, high):
    """Of each node the number of its kind: opposite nodes of x and y are one."""
    size = (high - low).max()
    folded = np.round((places - low) / size, 9)
    for axis in (0, 1):
        folded[folded[:, axis] >= np.round((high[axis] - low[axis]) / size, 9), axis] = 0
    kinds, of_node, counts = np.unique(folded, axis=0, return_inverse=True, return_counts=True)
    on_sides = ((places[:, :2] == low[:2]) | (places[:, :2] == high[:2])).sum(axis=1)
    assert (counts[of_node] == 2**on_sides).all(), "opposite nodes do not match"
    return of_node, len(kinds)


class Scatter:
    """Adds rows to the rows of the same number."""

    def __init__(self, numbers, count):
        self.order = np.argsort(numbers, kind="stable")
        ordered = numbers[self.order]
        self.starts = np.flatnonzero(np.r_[True, ordered[1:] != ordered[:-1]])
        assert len(self.starts) == count

    def __call__(self, rows):
        return np.add.reduceat(rows[self.order], self.starts, axis=0)


def solve(multiply, precondition, right, residual):
    """Conjugate gradients, each column for itself; ends when all residuals are as small as that, of the right side."""
    x, r = np.zeros_like(right), right.copy()
    z = precondition(r)
    p, old = z.copy(), (r * z).sum(axis=0)
    first = np.sqrt((right**2).sum(axis=0)) + 1e-300
    for count in range(20_000):
        if (np.sqrt((r**2).sum(axis=0)) <= residual * first).all():
            return x, count
        q = multiply(p)
        length = old / np.maximum((p * q).sum(axis=0), 1e-300)
        x += length * p
        r -= length * q
        z = precondition(r)
        new = (r * z).sum(axis=0)
        p = z + new / np.maximum(old, 1e-300) * p
        old = new
    raise AssertionError("no convergence")


def plate(path, exact_field=False, residual=1e-8, say=lambda text: None):
    """ABD (N/mm, N, N mm). The displacement is Kirchhoff's + what repeats; Kirchhoff's is interpolated by the elements, or,
    `exact_field`, its strains are taken as they are at the integration points."""
    model = inp.read(path)
    numbers = sorted(model.elements)
    elements = np.array([model.elements[n] for n in numbers])
    used, elements = np.unique(elements, return_inverse=True)
    elements = elements.reshape(len(numbers), -1)
    places = np.array([model.nodes[n] for n in used])
    low, high = places.min(axis=0), places.max(axis=0)
    of_node, kinds = classes_over(places, low, high)
    places = places - (low + high) / 2
    stiffness = stiffness_in_space(model, numbers)
    count = elements.shape[1]
    of_elements = np.zeros((len(numbers), 3 * count, 3 * count))
    forces = np.zeros((len(numbers), 3 * count, 6))  # of the field without what repeats
    energy = np.zeros((6, 6))
    field = displacements_of_plate(places)[elements].reshape(len(numbers), 3 * count, 6)
    for b, at, weights in points_of_elements(places[elements]):
        cb = np.einsum("nij,njk,n->nik", stiffness, b, weights, optimize=True)
        of_elements += np.einsum("nia,nib->nab", b, cb, optimize=True)
        if exact_field:
            strain = strains_of_plate(at)
        else:
            strain = b @ field
        forces += np.einsum("nia,nib->nab", cb, strain, optimize=True)
        energy += np.einsum("nia,nij,njb,n->ab", strain, stiffness, strain, weights, optimize=True)
    unknowns = (3 * of_node[elements][:, :, None] + np.arange(3)).reshape(len(numbers), 3 * count)
    add = Scatter(unknowns.ravel(), 3 * kinds)
    blocks = np.zeros((kinds, 3, 3))
    for a in range(count):
        part = of_elements[:, 3 * a : 3 * a + 3, 3 * a : 3 * a + 3]
        np.add.at(blocks, of_node[elements[:, a]], part)
    blocks = np.linalg.inv(blocks)

    def multiply(x):
        return add((of_elements @ x[unknowns]).reshape(-1, x.shape[1]))

    def precondition(x):
        return (blocks @ x.reshape(kinds, 3, -1)).reshape(x.shape)

    right = -add(forces.reshape(-1, 6))
    x, steps = solve(multiply, precondition, right, residual)
    say(f"{len(numbers)} elements, {3 * kinds} unknowns, {steps} steps")
    # The energy of the sum: what the rest of the residual errs by is of second order.
    total = energy - right.T @ x - x.T @ right + x.T @ multiply(x)
    return total / ((high - low)[0] * (high - low)[1])


if __name__ == "__main__":
    np.set_printoptions(linewidth=150, precision=8)
    print(plate(sys.argv[1], "exact" in sys.argv[2:], say=print))
