"""What breaks first in a unit cell, for scripts/homogenize: of each load of the whole, the largest one that nothing in the cell
fails at, by the linear stresses at the points that elements are integrated by.

Yarns (strength transverse; axis 1 along them): Z. Hashin, Failure criteria for unidirectional fiber composites, J. Appl. Mech. 47
(1980) 329-334, in three dimensions. A mode begins where its sum is 1:
  fibre tension      s11 > 0         (s11/XT)^2 + (s12^2 + s13^2)/S12^2
  fibre compression  s11 < 0         -s11/XC
  matrix tension     s22 + s33 > 0   ((s22 + s33)/YT)^2 + (s23^2 - s22 s33)/S23^2 + (s12^2 + s13^2)/S12^2
  matrix compression s22 + s33 < 0   ((YC/2S23)^2 - 1)(s22 + s33)/YC + ((s22 + s33)/2S23)^2 + (s23^2 - s22 s33)/S23^2
                                     + (s12^2 + s13^2)/S12^2
Where nothing is known across the yarn: s11/XT and -s11/XC alone.
Else (strength isotropic): the largest principal stress by T, the smallest by -C, and half their difference by S where that is known.

Every sum is a L + b L^2 of the load L, so the load at which it is 1 has a closed form.
"""

import re

import numpy

from cell_deck import turned
from cell_elements import PAIRS, points

SHARE = 0.01  # of a region's volume
AT_ONCE = 20_000  # elements


def has_strengths(deck):
    return any("strength" in material for material in deck.materials.values())


def load_at(linear, square):
    """The least L > 0 with linear L + square L^2 = 1; infinite: none."""
    with numpy.errstate(divide="ignore", invalid="ignore"):
        bottom = linear + numpy.sqrt(linear**2 + 4 * square)
        return numpy.where(bottom > 0, 2 / bottom, numpy.inf)


def hashin(stress, strength):
    """Modes and their loads (each of the shape of the stresses without their first axis: 11 22 33 12 13 23)."""
    s11, s22, s33, s12, s13, s23 = stress
    xt, xc, *rest = strength
    if not rest:
        yield "fibre tension", load_at(s11.clip(min=0) / xt, 0)
        yield "fibre compression", load_at((-s11).clip(min=0) / xc, 0)
        return
    yt, yc, along, across = rest
    sliding, sums = (s12**2 + s13**2) / along**2, s22 + s33
    is_pressed = sums < -1e-6 * numpy.abs(stress).max(axis=0)  # in pure shear both modes are one
    turning = (s23**2 - s22 * s33) / across**2 + sliding

    def where(asked, loads):
        return numpy.where(asked, loads, numpy.inf)

    yield "fibre tension", where(s11 > 0, load_at(0, (s11 / xt) ** 2 + sliding))
    yield "fibre compression", where(s11 < 0, load_at(-s11 / xc, 0))
    yield "matrix tension", where(~is_pressed, load_at(0, (sums / yt) ** 2 + turning))
    pressed = load_at(((yc / (2 * across)) ** 2 - 1) * sums / yc, (sums / (2 * across)) ** 2 + turning)
    yield "matrix compression", where(is_pressed, pressed)


def largest_stresses(stress, strength):
    tensor = numpy.empty((*stress.shape[1:], 3, 3))
    for value, (i, j) in zip(stress, PAIRS):
        tensor[..., i, j] = tensor[..., j, i] = value
    principal = numpy.linalg.eigvalsh(tensor)
    least, most = principal[..., 0], principal[..., 2]
    for name, value, limit in zip(("tension", "compression", "shear"), (most, -least, (most - least) / 2), strength):
        yield name, load_at(value.clip(min=0) / limit, 0)


def region_of(deck, section):
    """The yarn (or matrix) that a section is part of."""
    whole = re.sub(r"_Section\d+$", "", section)
    return whole if whole in deck.element_sets else section


def stresses(deck, section, fields):
    """Of a section, some elements and one point of each at a time: volumes, and stresses in the material's axes (6 x n x cases)."""
    name, material, oriented = section
    local, numbers = deck.materials[material]["stiffness"], deck.element_sets[name]
    for k in range(0, len(numbers), AT_ONCE):
        part = numbers[k : k + AT_ONCE]
        nodes = numpy.array([deck.elements[e] for e in part])
        moved = fields[nodes]
        turn = turned(numpy.array([deck.axes[e] for e in part])) if oriented else None
        for slopes, volume in points(numpy.array([[deck.nodes[n] for n in row] for row in nodes])):
            gradient = numpy.einsum("naj,naic->nijc", slopes, moved)
            strain = numpy.stack([gradient[:, i, j] + (gradient[:, j, i] if i != j else 0) for i, j in PAIRS], axis=1)
            if turn is not None:
                strain = turn @ strain
            yield volume, numpy.einsum("ij,njc->inc", local, strain)


class Worst:
    """Of one region and load, the points' loads with their modes."""

    def __init__(self):
        self.loads, self.modes, self.volumes = [], [], []

    def add(self, loads, modes, volumes):
        self.loads.append(loads.astype(numpy.float32))
        self.modes.append(modes.astype(numpy.int8))
        self.volumes.append(volumes)

    def close(self):
        """Load and mode of the first point, and where a share of the volume has failed."""
        loads, modes, volumes = map(numpy.concatenate, (self.loads, self.modes, self.volumes))
        order = numpy.argsort(loads, kind="stable")
        failed = numpy.cumsum(volumes[order])
        later = order[numpy.searchsorted(failed, SHARE * failed[-1])]
        return [(float(loads[k]), int(modes[k])) for k in (order[0], later)]


def first_failure(deck, fields, stiffness, loads):
    """`fields`: displacements of the nodes where each driver is 1 (nodes x 3 x drivers); `stiffness`: the forces of the whole by
    these (any unit); `loads`: the forces' names. Each load alone, in both directions. Raises nothing."""
    per_load = numpy.linalg.inv(stiffness)
    modes, found, without, along = [], {}, set(), set()
    for section in deck.sections:
        region, (kind, strength) = region_of(deck, section[0]), deck.materials[section[1]].get("strength", (None, None))
        if kind is None:
            without.add(region)
            continue
        if kind == "transverse" and len(strength) == 2:
            along.add(region)
        criterion = hashin if kind == "transverse" else largest_stresses
        for volume, unit in stresses(deck, section, fields):
            one_way = unit @ per_load
            stress = numpy.concatenate([one_way, -one_way], axis=2)
            names, values = zip(*criterion(stress, strength))
            modes += [name for name in names if name not in modes]
            values = numpy.stack(values)
            least = values.argmin(axis=0)
            which = numpy.array([modes.index(name) for name in names])[least]
            for load in range(stress.shape[2]):
                found.setdefault((region, load), Worst()).add(values.min(axis=0)[:, load], which[:, load], volume)
    ends = {key: worst.close() for key, worst in found.items()}
    result = []
    for load, name in enumerate([*loads, *loads]):
        entry = {"load": name, "direction": "+" if load < len(loads) else "-"}
        for place, key in enumerate(("first", "one_percent")):
            some = [(*values[place], region) for (region, of), values in ends.items() if of == load]
            value, mode, region = min(some)
            entry[key] = {"value": value, "region": region, "mode": modes[mode]} if numpy.isfinite(value) else None
        result.append(entry)
    return {"loads": result, "not_judged": sorted(without), "judged_along_alone": sorted(along)}


def show(failure, units):
    """`units`: of the loads, in their order."""
    print("first failure of the linear cell, each load alone (Hashin 1980 in yarns, largest stresses elsewhere)")
    print(f"  {'load':12} {'at one point':47} in {100 * SHARE:g} % of a region")
    for entry, unit in zip(failure["loads"], [*units, *units]):
        texts = []
        for key in ("first", "one_percent"):
            one = entry[key]
            texts.append(f"{entry['direction']}{one['value']:<9.4g} {one['region']}, {one['mode']}" if one else "never")
        print(f"  {entry['load']:6}{unit:6} {texts[0]:47} {texts[1]}")
    if failure["not_judged"]:
        print(f"  not judged, for their materials have no strength: {', '.join(failure['not_judged'])}")
    if failure["judged_along_alone"]:
        print(
            f"  judged along their fibres alone, for nothing is said across: {', '.join(failure['judged_along_alone'])}"
        )
    print(
        "  without stresses of curing or cooling; at one point the less, the finer the mesh is where yarns have edges"
    )
