"""What the oracles measure themselves, with numpy alone: volumes of tubes as control grids, areas of sections, places inside."""

import math
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))
import relaxed  # the second evaluator of control grids

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "um": 0.001, "inch": 25.4}
GAUSS = np.polynomial.legendre.leggauss(9)  # exact for the volume where all weights are one, to degree 6
GAUSS_RATIONAL = np.polynomial.legendre.leggauss(24)


def slope_basis(knots, degree, t):
    """Derivatives of the basis functions (columns) at t (rows)."""
    knots = np.asarray(knots, float)
    lower = relaxed.basis(knots, degree - 1, t)
    width = knots[degree:] - knots[:-degree]
    slopes = lower * np.divide(degree, width, out=np.zeros_like(width), where=width > 0)
    return slopes[:, :-1] - slopes[:, 1:]


def gauss_places(knots, low, high, rule=GAUSS):
    """Parameters and weights of the rule in every span."""
    breaks = np.unique([k for k in knots if low <= k <= high])
    middle, half = (breaks[1:] + breaks[:-1]) / 2, (breaks[1:] - breaks[:-1]) / 2
    return (middle[:, None] + half[:, None] * rule[0]).ravel(), (half[:, None] * rule[1]).ravel()


class Measured:
    """Volume, the length of the line through the sections' middles, and how flat its ends are. Units of the file."""

    def __init__(self, grid):
        u0, u1 = grid.domain(grid.knots_u, grid.degree_u)
        v0, v1 = grid.domain(grid.knots_v, grid.degree_v)
        rule = GAUSS if np.ptp(grid.weights) == 0 else GAUSS_RATIONAL
        u, wu = gauss_places(grid.knots_u, u0, u1, rule)
        v, wv = gauss_places(grid.knots_v, v0, v1, rule)
        point, along_u, along_v = surface(grid, u, v)
        self.origin = point.reshape(-1, 3).mean(axis=0)
        point = point - self.origin
        body = np.einsum("vuk,vuk,u,v->", point, np.cross(along_u, along_v), wu, wv) / 3
        ends, self.flatness = 0.0, 0.0
        size = np.linalg.norm(np.ptp(point[0], axis=0))
        closed = np.abs(surface(grid, u, [v0])[0] - surface(grid, u, [v1])[0]).max() < 1e-9 * size
        for at, sign in () if closed else ((v0, 1), (v1, -1)):
            ring, turn, _ = surface(grid, u, [at])
            ring, turn = ring[0] - self.origin, turn[0]
            area = np.einsum("uk,u->k", np.cross(ring, turn), wu) / 2
            middle = ring.mean(axis=0)
            normal = area / np.linalg.norm(area)
            self.flatness = max(self.flatness, np.abs((ring - middle) @ normal).max() / size)
            ends -= sign * area @ middle / 3
        self.volume = abs(body + ends)
        self.length = length_of_middles(grid, u, wu, v)


def surface(grid, u, v):
    """Points and both derivatives, v x u x 3."""
    u, v = np.asarray(u, float), np.asarray(v, float)
    bu, bv = relaxed.basis(grid.knots_u, grid.degree_u, u), relaxed.basis(grid.knots_v, grid.degree_v, v)
    du, dv = slope_basis(grid.knots_u, grid.degree_u, u), slope_basis(grid.knots_v, grid.degree_v, v)
    lifted = np.concatenate([grid.points * grid.weights[:, :, None], grid.weights[:, :, None]], axis=2)
    value, su, sv = (
        np.einsum("va,aik,ui->vuk", a, lifted, b, optimize=True) for a, b in ((bv, bu), (bv, du), (dv, bu))
    )
    point = value[:, :, :3] / value[:, :, 3:]
    return point, *((s[:, :, :3] - s[:, :, 3:] * point) / value[:, :, 3:] for s in (su, sv))


def length_of_middles(grid, u, wu, v):
    """Of the line of the centroids of the sections (as plane regions)."""
    breaks = np.unique(np.concatenate([v, grid.domain(grid.knots_v, grid.degree_v)]))
    point, turn, _ = surface(grid, u, breaks)
    middle = point.mean(axis=1, keepdims=True)
    r = point - middle
    part = np.cross(r, turn)
    area = np.einsum("vuk,u->vk", part, wu)
    size = np.linalg.norm(area, axis=1)
    share = np.einsum("vuk,vk->vu", part, area / size[:, None])
    centroid = middle[:, 0] + 2 / 3 * np.einsum("vuk,vu,u->vk", r, share, wu) / size[:, None]
    return np.linalg.norm(np.diff(centroid, axis=0), axis=1).sum()


# ---- areas of sections as a text states them


def polygon_area(corners):
    x, y = np.asarray(corners, float).T
    return abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def section_area(words, corners):
    """Area by `section` WORDS (the size always stated), and the least width. None where it is not closed form here."""
    form, numbers = words[0], [float(w) for w in words[1:]]
    if form == "circle" and numbers:
        return math.pi * numbers[0] ** 2 / 4, numbers[0]
    if form == "polygon":
        spread = np.ptp(np.asarray(corners), axis=0)
        return polygon_area(corners), float(spread.min())
    if len(numbers) < 2:
        return None
    w, h = numbers[:2]
    if form == "ellipse":
        return math.pi * w * h / 4, min(w, h)
    if form == "racetrack":
        low, high = min(w, h), max(w, h)
        return (high - low) * low + math.pi * low**2 / 4, low
    if form == "power":
        a = np.linspace(0, math.pi / 2, 20001)
        x, y = w / 2 * np.cos(a), h / 2 * np.sin(a) ** numbers[2]
        return 4 * float(np.sum((y[1:] + y[:-1]) / 2 * -np.diff(x))), min(w, h)
    if form == "lenticular" and h <= w:
        r = (w * w + h * h) / (4 * h)
        half = math.asin(min(1.0, w / 2 / r))
        return 2 * (half * r * r - w / 2 * (r - h / 2)), h
    return None


def thread_area(lines):
    """(area, thickness) of a thread's section, in the file's unit; None where this does not know."""
    words = {line[0].split()[0]: line for line in lines}
    if "plies" in words or "filaments" in words:
        return None
    if "section" in words and words["section"][0].split()[1:] != ["circle"]:
        statement, rows = words["section"]
        return section_area(statement.split()[1:], [[float(w) for w in row[0].split()] for row in rows or []])
    if "diameter" in words:
        d = float(words["diameter"][0].split()[1])
        return math.pi * d * d / 4, d
    return None


# ---- what lies inside what


def coarse(grid, around=24, most=160, finest=6):
    """Sections of the yarn, about `most` of them at most, and `finest` in a span."""
    v0, v1 = grid.domain(grid.knots_v, grid.degree_v)
    breaks = np.unique([k for k in grid.knots_v if v0 <= k <= v1])
    fine = max(2, min(finest, most // max(1, len(breaks))))
    v = np.unique(np.concatenate([np.linspace(a, b, fine + 1) for a, b in zip(breaks, breaks[1:])]))
    return grid.sections_at(v, around)


def deepest_shared(a, b):
    """How deep a point of a's sections lies within b, measured in b's section there; 0 where none does."""
    points = a.reshape(-1, 3)
    low, high = b.reshape(-1, 3).min(axis=0), b.reshape(-1, 3).max(axis=0)
    points = points[((points > low) & (points < high)).all(axis=1)]
    middles = b.mean(axis=1)
    reach = np.linalg.norm(b - middles[:, None], axis=2).max()
    if len(points) == 0:
        return 0.0
    nearest = ((middles**2).sum(axis=1) - 2 * points @ middles.T).argmin(axis=1)  # by the squares of the distances
    near = (
        np.linalg.norm(points - middles[nearest], axis=1)
        < reach + np.linalg.norm(np.diff(middles, axis=0), axis=1).max()
    )
    points, nearest = points[near], nearest[near]
    normals = relaxed.area_vectors(b)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    deepest = 0.0
    for shift in (-1, 0):  # the piece before the nearest section and the one after it
        k = nearest + shift
        inside = (k >= 0) & (k + 1 < len(b))
        p, k = points[inside], k[inside]
        before = np.einsum("ij,ij->i", p - middles[k], normals[k])
        after = np.einsum("ij,ij->i", p - middles[k + 1], normals[k + 1])
        between = before * after < 0
        p, k, t = p[between], k[between], (before / (before - after))[between]
        ring = b[k] + t[:, None, None] * (b[k + 1] - b[k])
        normal = normals[k] + t[:, None] * (normals[k + 1] - normals[k])
        deepest = max(deepest, depth_in_rings(p, ring, normal))
    return deepest


def depth_in_rings(points, rings, normals):
    """The largest distance of a point to the border of its ring, seen along its normal, of those inside; 0 without one."""
    if len(points) == 0:
        return 0.0
    x = rings[:, 0] - rings.mean(axis=1)
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    x -= np.einsum("ij,ij->i", x, normals)[:, None] * normals
    x /= np.linalg.norm(x, axis=1)[:, None]
    y = np.cross(normals, x)
    flat = np.stack([np.einsum("ijk,ik->ij", rings - points[:, None], axis) for axis in (x, y)], axis=2)
    side = np.roll(flat, -1, axis=1) - flat
    crosses = (flat[:, :, 1] > 0) != (np.roll(flat, -1, axis=1)[:, :, 1] > 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        hit = flat[:, :, 0] - flat[:, :, 1] * side[:, :, 0] / side[:, :, 1] > 0
    inside = (crosses & hit).sum(axis=1) % 2 == 1
    t = np.clip(-np.einsum("ijk,ijk->ij", flat, side) / np.maximum(np.einsum("ijk,ijk->ij", side, side), 1e-300), 0, 1)
    border = np.linalg.norm(flat + t[:, :, None] * side, axis=2).min(axis=1)
    return float(border[inside].max(initial=0.0))
