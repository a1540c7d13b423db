"""What values on several meshes tend to, and how far each of them is off: for scripts/permeability and scripts/reference-cells.

P. J. Roache, J. Fluids Eng. 116 (1994) 405-413: Richardson's extrapolation, and its change times a factor of safety as the error, 1.25
where three meshes show the order of convergence, 3 where it is assumed.
"""

import numpy

SAFETY = 1.25  # of three meshes
SAFETY_OF_TWO = 3.0
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

    A mesh knows itself and the coarser ones; nothing finer enters what it says. The second has one difference, and the least
    order that is believed; so has the first, which has nothing coarser, with the error of a mesh so much coarser. The third
    has the order that all three show, or where they show none the spread of the three.
    """
    if not all(a > b for a, b in zip(sizes, sizes[1:])):
        raise ValueError("meshes have to come coarsest first, each finer than the one before")
    (a, x), (b, y) = list(zip(sizes, values))[:2]
    order = believed[0]
    unit = SAFETY_OF_TWO * abs(x - y) / (a**order - b**order)
    errors = [unit * a**order, unit * b**order]
    limit, error, shown = extrapolated(sizes, values, believed)
    if len(values) > 2:
        errors.append(error)
    return limit, [max(e, ROUNDING * abs(v)) for e, v in zip(errors, values)], shown


def apart(intervals):
    """By how much (value, error) pairs leave no value that lies in all of them; not positive: there is one."""
    return max(value - error for value, error in intervals) - min(value + error for value, error in intervals)
