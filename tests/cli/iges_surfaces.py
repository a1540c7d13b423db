"""Entities 128 of an IGES file, evaluated: read here by the rules of the standard, with nothing of the program."""

import numpy as np


def parameters_of(path):
    """The parameters of each entity of the file, by its directory entry, in the order of the file."""
    texts = {}
    with open(path, encoding="ascii") as file:
        for line in file:
            if line[72] == "P":
                texts.setdefault(int(line[64:72]), []).append(line[:64])
    for entry, lines in texts.items():
        yield entry, "".join(lines).replace(" ", "").split(";")[0].split(",")


def basis(knots, degree, places):
    """Cox and de Boor: for each place the first control point that counts there, and what each of degree + 1 does."""
    count = len(knots) - degree - 1
    spans = np.clip(np.searchsorted(knots, places, side="right") - 1, degree, count - 1)
    values = np.ones((len(places), 1))
    for k in range(1, degree + 1):
        more = np.zeros((len(places), k + 1))
        for i in range(k):
            low, high = knots[spans - k + 1 + i], knots[spans + 1 + i]
            share = (places - low) / (high - low)
            more[:, i] += (1 - share) * values[:, i]
            more[:, i + 1] += share * values[:, i]
        values = more
    return spans - degree, values


def combined(knots, degree, places, points):
    """Curves over the first index of the points."""
    first, shares = basis(knots, degree, places)
    return sum(shares[:, k].reshape(-1, 1, 1) * points[first + k] for k in range(degree + 1))


def places(knots, degree, each):
    breaks = np.unique(knots[degree : len(knots) - degree])
    return np.concatenate([np.linspace(a, b, each, endpoint=False) for a, b in zip(breaks, breaks[1:])] + [breaks[-1:]])


def surfaces(path, each_u=32, each_v=12):
    """The points of each 128, so many a knot span: v (along a yarn), u (round it), xyz."""
    for _, words in parameters_of(path):
        if words[0] != "128":
            continue
        k1, k2, m1, m2 = map(int, words[1:5])
        numbers = np.array([float(word.replace("D", "E")) for word in words[10:]])
        cuts = np.cumsum([k1 + m1 + 2, k2 + m2 + 2, (k1 + 1) * (k2 + 1), 3 * (k1 + 1) * (k2 + 1)])
        knots_u, knots_v, weights, points = np.split(numbers[: cuts[-1]], cuts[:-1])
        weights = weights.reshape(k2 + 1, k1 + 1, 1)
        homogeneous = np.concatenate([points.reshape(k2 + 1, k1 + 1, 3) * weights, weights], axis=2)
        rows = combined(knots_v, m2, places(knots_v, m2, each_v), homogeneous)
        grid = combined(knots_u, m1, places(knots_u, m1, each_u), rows.transpose(1, 0, 2)).transpose(1, 0, 2)
        yield grid[:, :, :3] / grid[:, :, 3:]


class Tube:
    """A surface round a path: the middles of its sections, and how large these are."""

    def __init__(self, grid):
        self.grid = grid
        mean = grid[:, :-1].mean(axis=1, keepdims=True)
        rays = grid - mean
        doubled = np.cross(rays[:, :-1], rays[:, 1:])  # of the triangles between the middle and the outline
        normal = doubled.sum(axis=1)
        share = np.einsum("vuk,vk->vu", doubled, normal) / np.einsum("vk,vk->v", normal, normal)[:, None]
        self.areas = normal / 2  # by their normals: sections need not stand across the path
        self.middles = mean[:, 0] + np.einsum("vu,vuk->vk", share, rays[:, :-1] + rays[:, 1:]) / 3
        moves = np.diff(self.middles, axis=0)
        self.steps = np.linalg.norm(moves, axis=1)
        self.volumes = np.abs(np.einsum("vk,vk->v", moves, (self.areas[1:] + self.areas[:-1]) / 2))  # Pappus

    def between(self, axis, low, high):
        """From the first crossing of the plane at `low` to that at `high`: length, volume, start, rows."""
        ends = []
        for plane in (low, high):
            x = self.middles[:, axis]
            k = int(np.argmax(x >= plane))
            if k == 0:
                return None
            ends.append(k - 1 + (plane - x[k - 1]) / (x[k] - x[k - 1]))
        at = np.arange(len(self.middles))
        whole = np.concatenate([[0], np.cumsum(self.steps)])
        filled = np.concatenate([[0], np.cumsum(self.volumes)])
        length, volume = (np.diff(np.interp(ends, at, sums))[0] for sums in (whole, filled))
        start = np.array([np.interp(ends[0], at, self.middles[:, k]) for k in range(3)])
        return length, volume, start, slice(int(ends[0]), int(ends[1]) + 2)
