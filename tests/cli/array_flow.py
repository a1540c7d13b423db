"""Creeping flow in plane arrays of cylinders, on no mesh: complex functions about one cylinder, whose coefficients make the fluid stop
at it and repeat over the edges of the lattice's cell (by least squares). For tests of permeability. Viscosity 1, pitch 1."""

import math

import numpy as np

MISFIT = 1e-4  # of the conditions, whose right sides are 1
HEIGHT = {"square": 1.0, "hexagonal": math.sqrt(3) / 2}  # area of the cell of one cylinder


def edges(kind):
    """Of each pair of opposite edges of the cell about a cylinder: places on one, and the step from there to the other."""
    if kind == "square":
        steps, half = [1, 1j], 0.5
    else:
        steps, half = [np.exp(1j * np.pi * k / 3) for k in range(3)], 0.5 / math.sqrt(3)
    along = half * np.cos(np.pi * (np.arange(60) + 0.5) / 60)
    return [(-step / 2 + 1j * step * along, step) for step in steps]


def radius_of(kind, share):
    return math.sqrt(share * HEIGHT[kind] / math.pi)


def area_points(kind, radius):
    """Places and weights over the fluid in the cell."""
    sides = 4 if kind == "square" else 6
    x, w = np.polynomial.legendre.leggauss(40)
    places, weights = [], []
    for side in range(sides):
        turn = np.pi / sides * x
        far = 0.5 / np.cos(turn)  # the edge seen from the centre
        for angle, end, weight in zip(turn + 2 * np.pi * side / sides, far, np.pi / sides * w):
            r = radius + (end - radius) * (x + 1) / 2
            places.append(r * np.exp(1j * angle))
            weights.append(weight * (end - radius) / 2 * w * r)
    return np.concatenate(places), np.concatenate(weights)


def powers(z, radius, order, derivative):
    """z^n and its derivatives, n from -order to order without 0, of a size near 1 in the cell."""
    columns = []
    for n in [*range(-order, 0), *range(1, order + 1)]:
        scale = radius**-n if n < 0 else 0.7**-n
        factor = math.prod(n - k for k in range(derivative))
        columns.append(factor * scale * z ** (n - derivative))
    return np.array(columns).T


def with_both_parts(columns):
    """Unknowns are the real and imaginary parts of coefficients."""
    return np.concatenate([columns, 1j * columns], axis=1)


def along(kind, share, order=40):
    """Permeability along the cylinders: w = Re f(z) - |z|^2 / 4."""
    radius = radius_of(kind, share)

    def terms(z, derivative):
        f = [with_both_parts(powers(z, radius, order, derivative))]
        if derivative == 0:
            f += [np.log(z)[:, None], np.ones((len(z), 1))]
        else:
            f += [(1 / z)[:, None], np.zeros((len(z), 1))]
        return np.concatenate(f, axis=1)

    wall = radius * np.exp(2j * np.pi * np.arange(240) / 240)
    rows, right = [terms(wall, 0).real], [np.full(240, radius**2 / 4)]
    for places, step in edges(kind):
        rows.append((terms(places + step, 0) - terms(places, 0)).real)
        right.append((abs(places + step) ** 2 - abs(places) ** 2) / 4)
        slope = terms(places + step, 1) - terms(places, 1)  # of w: conj(f'), and -z / 2
        for part, wanted in ((slope.real, step.real / 2), (-slope.imag, step.imag / 2)):
            rows.append(part)
            right.append(np.full(len(places), wanted))
    solution = solved(rows, right)
    z, weights = area_points(kind, radius)
    return weights @ (terms(z, 0).real @ solution - abs(z) ** 2 / 4) / HEIGHT[kind]


def solved(rows, right):
    matrix, right = np.concatenate(rows), np.concatenate(right)
    scale = np.abs(matrix).max(axis=0)
    scale[scale == 0] = 1
    solution, *_ = np.linalg.lstsq(matrix / scale, right, rcond=1e-14)
    misfit = np.abs(matrix / scale @ solution - right).max()
    assert misfit < MISFIT, misfit
    return solution / scale


def across(kind, share, order=40):
    """Permeability across: velocity u + i v = -i (phi + z conj(phi') + conj(chi)), pressure -4 Im phi' - G x (G = 1), of functions that
    are phi, chi = sums of powers, log z and a constant. The force on the fluid is the gradient G."""
    radius = radius_of(kind, share)
    count = 4 * order

    def parts(z, derivative):
        return with_both_parts(powers(z, radius, order, derivative))

    def terms(z):
        """Columns of the velocity, its two slopes, and the periodic pressure."""
        phi, phi1, phi2 = (parts(z, k) for k in range(3))
        chi, chi1 = parts(z, 0), parts(z, 1)
        zc = z[:, None]
        # Single valued with logarithms: phi = c log z, chi = conj(c) log z.
        logs = [np.ones(1), 1j * np.ones(1)]
        none = np.zeros((len(z), 1))
        velocity = [-1j * (phi + zc * phi1.conj()), -1j * chi.conj()]
        by_z = [-1j * (phi1 + phi1.conj()), np.zeros_like(chi)]
        by_conj = [-1j * zc * phi2.conj(), -1j * chi1.conj()]
        pressure = [-4 * phi1.imag, np.zeros(chi.shape)]
        for c in logs:
            velocity.append(-1j * (2 * c * np.log(abs(zc)) + zc * np.conj(c / zc)))
            by_z.append(-1j * (c / zc + np.conj(c / zc)))
            by_conj.append(-1j * (zc * np.conj(-c / zc**2) + np.conj(np.conj(c) / zc)))
            pressure.append(-4 * (c / zc).imag)
        for c in logs:  # a constant velocity
            velocity.append(c * np.ones((len(z), 1)))
            by_z.append(none)
            by_conj.append(none)
            pressure.append(none)
        u, dz, dc, p = (np.concatenate(one, axis=1) for one in (velocity, by_z, by_conj, pressure))
        return u, dz + dc, 1j * (dz - dc), p

    assert count * 2 + 4 == terms(np.array([0.3 + 0.1j]))[0].shape[1]
    wall = radius * np.exp(2j * np.pi * np.arange(240) / 240)
    u = terms(wall)[0]
    rows, right = [u.real, u.imag], [np.zeros(240)] * 2
    for places, step in edges(kind):
        low, high = terms(places), terms(places + step)
        for before, after in zip(low[:3], high[:3]):
            change = after - before
            rows += [change.real, change.imag]
            right += [np.zeros(len(places))] * 2
        rows.append((high[3] - low[3]).real)
        right.append(np.full(len(places), -step.real))  # the pressure falls by 1 a length along x
    solution = solved(rows, right)
    z, weights = area_points(kind, radius)
    return weights @ (terms(z)[0] @ solution).real / HEIGHT[kind]
