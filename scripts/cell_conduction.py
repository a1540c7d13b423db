"""Conduction of a unit cell's deck, for scripts/homogenize: the elements' matrices, and the bounds of the cell's tensor.
Of heat; diffusion and the electric displacement have the same equation.

Bounds (div K grad u = 0, periodic cell, any structure):
Wiener 1912: the tensor lies between the means of the phases in series and in parallel, as matrices.
Hashin, Shtrikman, J. Appl. Phys. 33 (1962) 3125-3131, of isotropic phases: where the cell is isotropic, between theirs.
Where it is not, the same variational principle bounds a trace: with k the conductivity of the worst phase, 3 over the
trace of the inverse of (tensor - k) is not below (theirs - k), and with k that of the best phase the like from above
(Murat, Tartar 1985 and Milton, Kohn, J. Mech. Phys. Solids 36 (1988) 597-629). An isotropic cell reaches what they say;
the mean of the three principal conductivities lies between the bounds, too.
"""

import numpy

from cell_elements import frames, points

LAWS = {  # by the deck's word: the property, its unit
    "conduction": ("conductivity", "W/(m K)"),
    "diffusion": ("diffusivity", "mm2/s"),
    "permittivity": ("permittivity", "relative"),
}
AXES = ["x", "y", "z"]


def parts(deck, chunk=20_000):
    """Of all elements, some at a time: their numbers, places of their nodes, and conductivities in space (n x 3 x 3)."""
    for name, material, oriented in deck.sections:
        local = deck.materials[material]["conductivity"]
        numbers = deck.element_sets[name]
        for k in range(0, len(numbers), chunk):
            some = numbers[k : k + chunk]
            tensor = numpy.broadcast_to(numpy.diag(local), (len(some), 3, 3))
            if oriented:
                turn = frames(numpy.array([deck.axes[e] for e in some]))
                tensor = numpy.einsum("nai,a,naj->nij", turn, local, turn)
            yield some, numpy.array([[deck.nodes[n] for n in deck.elements[e]] for e in some]), tensor


def matrices(deck):
    """For cell_elements.Cell: numbers of elements, their matrices (n x nodes x nodes), and no forces of their own."""
    for numbers, places, tensor in parts(deck):
        result = numpy.zeros((len(numbers), places.shape[1], places.shape[1]))
        for slopes, size in points(places):
            result += slopes @ (tensor * size[:, None, None]) @ slopes.transpose(0, 2, 1)
        yield numbers, result, numpy.zeros(result.shape[:2])


def means(deck):
    """The cell's mean of the elements' conductivities and of their inverses, and the share of each section; integrated as
    the elements are."""
    volume = deck.cell.volume
    parallel, series, shares = numpy.zeros((3, 3)), numpy.zeros((3, 3)), {}
    name_of = {e: name for name, _, _ in deck.sections for e in deck.element_sets[name]}
    for numbers, places, tensor in parts(deck):
        size = sum(size for _, size in points(places))
        parallel += numpy.einsum("n,nij->ij", size, tensor) / volume
        series += numpy.einsum("n,nij->ij", size, numpy.linalg.inv(tensor)) / volume
        shares[name_of[numbers[0]]] = shares.get(name_of[numbers[0]], 0) + size.sum() / volume
    return parallel, series, shares


def is_full(shares):
    """No part of the cell is empty."""
    return abs(sum(shares.values()) - 1) < 1e-6


def wiener(parallel, series, shares, axes):
    """Lower and upper bound along the first `axes` axes (of a plate, whose faces let nothing through, two)."""
    lower = numpy.linalg.inv(series[:axes, :axes]) if is_full(shares) else numpy.zeros((axes, axes))
    return lower, parallel[:axes, :axes]


def isotropic_phases(deck, shares):
    """Conductivities and shares of what is isotropic; none where something is not, or part of the cell is empty."""
    phases = {}
    for name, material, _ in deck.sections:
        along, *across = deck.materials[material]["conductivity"]
        if any(value != along for value in across):
            return None
        phases[along] = phases.get(along, 0) + shares[name]
    return phases if is_full(shares) else None


def hashin_shtrikman(phases):
    """Lower and upper bound of a cell that is isotropic."""
    total = sum(phases.values())
    return tuple(
        1 / sum(share / total / (k + 2 * worst) for k, share in phases.items()) - 2 * worst
        for worst in (min(phases), max(phases))
    )


def as_isotropic(tensor, k):
    """What the trace bound of a phase compares with Hashin's and Shtrikman's: of an isotropic tensor that itself. None
    beyond the phase, where there is no such bound."""
    above = numpy.linalg.eigvalsh(tensor) - k
    if (above > 0).all() or (above < 0).all():
        return k + len(above) / (1 / above).sum()
    return None
