"""Conductivity of arrays of cylinders in squares and hexagons, on no mesh: the series of Rayleigh (W. T. Perrins, D. R. McKenzie,
R. C. McPhedran, Proc. R. Soc. Lond. A 369 (1979) 207-225)."""

import math

import numpy as np

HEXAGON = math.sqrt(3)  # the rectangle of two cylinders of a hexagonal array is so high


def eisenstein(n, tau):
    """The sum of z^-n over the lattice 1, tau without its origin, n even and more than 2 (real for tau of ours)."""
    q = np.exp(2j * np.pi * tau)
    zeta = sum(k**-n for k in range(1, 2000)) if n < 8 else sum(k ** -float(n) for k in range(1, 100))
    factor = (2j * np.pi) ** n / math.factorial(n - 1)
    terms = sum(sum(d ** (n - 1) for d in range(1, m + 1) if m % d == 0) * q**m for m in range(1, 60))
    return (2 * zeta + 2 * factor * terms).real


def array_of_cylinders(kind, share, contrast, order=24):
    """Conductivity across the cylinders over that of the matrix: Rayleigh's multipoles, as many odd ones as `order`. One cell
    a lattice point; the field that reaches a cylinder is the mean one and that of all others' multipoles."""
    tau, area = (1j, 1.0) if kind == "square" else (np.exp(1j * np.pi / 3), HEXAGON / 2)
    radius = math.sqrt(share * area / math.pi)
    sums = {n: eisenstein(n, tau) for n in range(4, 4 * order, 2) if n % (4 if kind == "square" else 6) == 0}
    sums[2] = math.pi / area  # of a sample that is long along the field
    odd = range(1, 2 * order, 2)
    t = (1 + contrast) / (1 - contrast)
    system = np.array([[math.comb(m + n - 1, n) * sums.get(m + n, 0.0) * radius ** (m + n) for m in odd] for n in odd])
    right = np.zeros(order)
    right[0] = radius
    multipoles = np.linalg.solve(system + t * np.eye(order), right)
    return 1 - 2 * math.pi * radius * multipoles[0] / area
