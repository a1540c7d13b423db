"""What values on several meshes tend to, and how far each of them is off: for scripts/permeability and scripts/reference-cells.

P. J. Roache, J. Fluids Eng. 116 (1994) 405-413: Richardson's extrapolation, and its change times a factor of safety as the error.
L. Eça, M. Hoekstra, J. Comput. Phys. 262 (2014) 104-130: where no order of convergence shows, three times the range of the values.
"""

import numpy

SAFETY = 1.25  # of a change to an extrapolated value
SAFETY_OF_RANGE = 3.0  # of one between meshes
ROUNDING = 1e-6  # of the value: what iterative solvers leave


def extrapolated(sizes, values, believed):
    """What values on meshes of these edge lengths tend to, the error of the last one, and the order: Richardson's with the
    order that three meshes show. Where they show none between those that are believed (a pair), the last value, and the largest
    difference from the others."""
    if len(values) == 1:
        return values[0], None, None
    (b, y), (c, z) = list(zip(sizes, values))[-2:]
    if len(values) > 2:
        a, x = sizes[-3], values[-3]
        orders = numpy.linspace(*believed, 301)
        misfit = abs((x - y) * (b**orders - c**orders) - (y - z) * (a**orders - b**orders))
        order = float(orders[misfit.argmin()])
        if (x - y) * (y - z) > 0 and believed[0] < order < believed[1]:
            change = (z - y) * c**order / (b**order - c**order)
            return z + change, SAFETY * abs(change), order
        return z, max(abs(x - z), abs(y - z)), None
    return z, abs(y - z), None


def stated(sizes, values, believed):
    """The error that each of two or three meshes, coarsest first, may state of its own value, with the limit and the order.

    A mesh knows itself and the coarser ones; nothing finer enters what it says. The second has one difference, and says three
    times that. The first, which has nothing coarser, says how far the second one is, and that one's error. The third has the
    order that all three show. Where they show none that is believed it says three times the last change, if the changes shrink
    even faster than is believed, and else three times the range of all values.
    """
    if not all(a > b for a, b in zip(sizes, sizes[1:])):
        raise ValueError("meshes have to come coarsest first, each finer than the one before")
    x, y, *finest = values
    errors = [(1 + SAFETY_OF_RANGE) * abs(x - y), SAFETY_OF_RANGE * abs(x - y)]
    limit, error, order = extrapolated(sizes, values, believed)
    if finest:
        a, b, c = (size ** believed[1] for size in sizes)
        shrinking = (x - y) * (y - limit) >= 0 and abs(y - limit) * (a - b) <= abs(x - y) * (b - c)
        if order is None:
            error = SAFETY_OF_RANGE * (abs(y - limit) if shrinking else max(values) - min(values))
        errors.append(error)
    return limit, [max(e, ROUNDING * abs(v)) for e, v in zip(errors, values)], order


def of_tensor(sizes, rows, believed):
    """`stated` of several numbers that are found together, the entries of a tensor (rows of values by mesh): every entry of a mesh has
    the relative error of its worst one, so that no coincidence is taken for precision."""
    found = [stated(sizes, values, believed) for values in rows]
    shares = [max(errors[k] / abs(values[k]) for (_, errors, _), values in zip(found, rows)) for k in range(len(sizes))]
    return [
        (limit, [share * abs(value) for share, value in zip(shares, values)], order)
        for (limit, _, order), values in zip(found, rows)
    ]


def apart(intervals):
    """By how much (value, error) pairs leave no value that lies in all of them; not positive: there is one."""
    return max(value - error for value, error in intervals) - min(value + error for value, error in intervals)
