"""What must not change when yarns are moved apart, measured on the control grids alone, without the program."""

import pathlib
import re

import numpy as np


def basis(knots, degree, parameters):
    """The B-spline basis functions (columns) at parameters (rows), by the recursion of Cox and de Boor."""
    knots, t = np.asarray(knots, float), np.asarray(parameters, float)
    count = len(knots) - degree - 1
    last = np.flatnonzero(knots < knots[count])[-1]  # the last span takes its right end, too
    at = np.minimum(np.searchsorted(knots, t, side="right") - 1, last)
    values = np.zeros((len(t), len(knots) - 1))
    values[np.arange(len(t)), at] = 1
    for p in range(1, degree + 1):
        width = knots[p:] - knots[:-p]
        share = np.divide(1, width, out=np.zeros_like(width), where=width > 0)
        rising, falling = (t[:, None] - knots[:-p]) * share, (knots[p:] - t[:, None]) * share
        values = rising[:, :-1] * values[:, :-1] + falling[:, 1:] * values[:, 1:]
    return values


class Yarn:
    """One `grid` of a Fabric TXT file: its points (sections x round x 3), weights, knots and statements."""

    def __init__(self, block):
        self.name = re.match(r'yarn\s+("[^"]*"|\S+)', block)[1].strip('"')
        self.statements = {
            line.split()[0]: line.strip()
            for line in block.splitlines()[1:]
            if line.startswith("  ") and line[2].isalpha() and line.split()[0] not in ("grid", "end")
        }
        body = block[block.index("  grid") :].splitlines()
        sections, count = map(int, body[0].split()[1:3])
        degree = {"along": min(3, sections - 1), "round": 2}
        knots = {}
        is_open = is_ring = False
        rows = []
        for line in body[1:]:
            words = line.split()
            if not words or words[0] in ("corners", "centre"):
                continue
            if words[0] == "end":
                break
            if words[0] == "degree":
                degree[words[2]] = int(words[1])
            elif words[0] == "knots":
                knots[words[1]] = list(map(float, words[2:]))
            elif words[0] == "open":
                is_open = True
            elif words[0] == "closed":
                is_ring = True
            else:
                rows.append(list(map(float, words)) + [1.0] * (4 - len(words)))
        rows = np.array(rows).reshape(sections, count, 4)
        self.points, self.weights = rows[:, :, :3], rows[:, :, 3]
        self.degree_v, self.degree_u = degree["along"], degree["round"]
        if is_ring and "along" not in knots:  # the closed form along: its sections go on
            self.points = np.concatenate([self.points, self.points[: self.degree_v]])
            self.weights = np.concatenate([self.weights, self.weights[: self.degree_v]])
            knots["along"] = list(map(float, range(sections + 2 * self.degree_v + 1)))
        self.knots_v = (
            knots.get("along")
            or [0.0] * self.degree_v
            + list(range(sections - self.degree_v + 1))
            + [float(sections - self.degree_v)] * self.degree_v
        )
        if is_open:
            self.knots_u = (
                knots.get("round")
                or [0.0] * self.degree_u + list(np.linspace(0, 1, count - self.degree_u + 1)) + [1.0] * self.degree_u
            )
        else:  # the closed quadratic: its control points go on round
            self.points = np.concatenate([self.points, self.points[:, : self.degree_u]], axis=1)
            self.weights = np.concatenate([self.weights, self.weights[:, : self.degree_u]], axis=1)
            self.knots_u = list(range(count + 2 * self.degree_u + 1))

    def domain(self, knots, degree):
        return knots[degree], knots[len(knots) - degree - 1]

    def sections_at(self, parameters, around=96):
        """Points on the sections at these parameters along: parameters x around x 3."""
        low, high = self.domain(self.knots_u, self.degree_u)
        u = np.linspace(low, high, around, endpoint=False)
        along, round_ = basis(self.knots_v, self.degree_v, parameters), basis(self.knots_u, self.degree_u, u)
        weights = along @ self.weights @ round_.T
        points = [along @ (self.points[:, :, d] * self.weights) @ round_.T / weights for d in range(3)]
        return np.stack(points, axis=2)


def grids_of(path):
    """The yarns of a Fabric TXT file whose yarns are all grids, by name."""
    text = pathlib.Path(path).read_text(encoding="utf-8")
    blocks = re.findall(r"^yarn .*?^end$", text, re.MULTILINE | re.DOTALL)
    return {yarn.name: yarn for yarn in map(Yarn, blocks)}


def samples(yarn, other, fine=3):
    """Parameters along, the same for both: in every span of either."""
    low, high = yarn.domain(yarn.knots_v, yarn.degree_v)
    breaks = np.unique(np.concatenate([yarn.knots_v, other.knots_v]))
    breaks = breaks[(breaks >= low) & (breaks <= high)]
    steps = np.arange(fine) / fine
    return np.append((breaks[:-1, None] + np.diff(breaks)[:, None] * steps).ravel(), breaks[-1])


def area_vectors(sections):
    centred = sections - sections.mean(axis=1, keepdims=True)
    return 0.5 * np.cross(centred, np.roll(centred, -1, axis=1)).sum(axis=1)


def volume(sections):
    """Inside the quadrangles between sections and two fans at the ends, by the divergence theorem."""
    origin = sections[0].mean(axis=0)
    s = sections - origin
    a, b = s[:-1], s[1:]
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    side = np.einsum("ijk,ijk->", a, np.cross(b, c)) + np.einsum("ijk,ijk->", a, np.cross(c, d))
    # Each edge is run through both ways: the fan of the start goes with its ring, that of the end against it.
    start, end = (np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0) @ ring.mean(axis=0) for ring in (s[0], s[-1]))
    return abs(side + start - end) / 6


def length(sections):
    return np.linalg.norm(np.diff(sections.mean(axis=1), axis=0), axis=1).sum()


def turning(sections, normals):
    """The least sine of the angle by which each section turns from side to side: not below 0 where it is convex."""
    sides = np.roll(sections, -1, axis=1) - sections
    sides /= np.linalg.norm(sides, axis=2, keepdims=True)
    sines = np.einsum("ijk,ik->ij", np.cross(sides, np.roll(sides, -1, axis=1)), normals)
    return sines.min(axis=1)


class Change:
    """How two states of one yarn differ."""

    def __init__(self, before, after):
        t = samples(before, after)
        a, b = before.sections_at(t), after.sections_at(t)
        areas_a, areas_b = area_vectors(a), area_vectors(b)
        sizes_a, sizes_b = np.linalg.norm(areas_a, axis=1), np.linalg.norm(areas_b, axis=1)
        self.area = np.abs(sizes_b / sizes_a - 1).max()
        self.volume = abs(volume(b) / volume(a) - 1)
        self.length = abs(length(b) / length(a) - 1)
        self.move = np.linalg.norm(a.mean(axis=1) - b.mean(axis=1), axis=1).max()
        self.size = np.sqrt(sizes_a.min())
        self.out_of_plane = 0.0
        for end in (0, -1):
            middle, normal = a[end].mean(axis=0), areas_a[end] / sizes_a[end]
            flatness = np.abs((a[end] - middle) @ normal).max()
            self.out_of_plane = max(self.out_of_plane, np.abs((b[end] - middle) @ normal).max() - flatness)
        convex = turning(a, areas_a / sizes_a[:, None]) > -1e-6
        self.dents = int((turning(b, areas_b / sizes_b[:, None])[convex] < -1e-3).sum())


def crossings(p, q, same=False, apart=0.0):
    """The crossings of two lines seen along z, one a row: x, y, the sign, and 1 where p is above (-1: q). `same`: of one
    line with itself, places nearer along it than `apart` left out."""
    along = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(p, axis=0), axis=1))])
    found = []
    for i, k in near_blocks(p, q):
        p0, p1, q0, q1 = (
            p[i : i + BLOCK, None],
            p[i + 1 : i + BLOCK + 1, None],
            q[None, k : k + BLOCK],
            q[None, k + 1 : k + BLOCK + 1],
        )
        p0, q0 = p0[: p1.shape[0]], q0[:, : q1.shape[1]]
        d, e, r = p1 - p0, q1 - q0, q0 - p0
        turn = d[..., 0] * e[..., 1] - d[..., 1] * e[..., 0]
        with np.errstate(divide="ignore", invalid="ignore"):
            s = (r[..., 0] * e[..., 1] - r[..., 1] * e[..., 0]) / turn
            u = (r[..., 0] * d[..., 1] - r[..., 1] * d[..., 0]) / turn
        hit = (s >= 0) & (s < 1) & (u >= 0) & (u < 1)
        if same:
            hit &= along[None, k : k + hit.shape[1]] - along[i : i + hit.shape[0], None] > apart
        for m, n in np.argwhere(hit):
            on_p, on_q = p0[m, 0] + s[m, n] * d[m, 0], q0[0, n] + u[m, n] * e[0, n]
            found.append((on_p[0], on_p[1], np.sign(turn[m, n]), np.sign(on_p[2] - on_q[2])))
    return np.array(found).reshape(-1, 4)


BLOCK = 32


def near_blocks(p, q):
    """The starts of runs of BLOCK sides of two lines whose boxes meet seen along z."""
    boxes = []
    for line in (p, q):
        starts = range(0, len(line) - 1, BLOCK)
        boxes.append(
            (
                np.array([line[k : k + BLOCK + 1, :2].min(axis=0) for k in starts]),
                np.array([line[k : k + BLOCK + 1, :2].max(axis=0) for k in starts]),
            )
        )
    (low_p, high_p), (low_q, high_q) = boxes
    meet = ((low_p[:, None] <= high_q[None]) & (low_q[None] <= high_p[:, None])).all(axis=2)
    return np.argwhere(meet) * BLOCK


def same_crossings(before, after, near):
    """Each crossing before has its like after: at most `near` away, with the same sign, the same line above. What has
    none came or went in a pair that cancels (Reidemeister's second move): equal above, opposite signs. Where two lines meet
    (above: 0) either may become the upper one."""
    left = list(range(len(after)))
    over = {1: 0, -1: 0, 0: 0}
    for x, y, sign, above in before:
        candidates = [k for k in left if after[k][2] == sign and np.hypot(after[k][0] - x, after[k][1] - y) < near]
        if not candidates:
            over[above] += sign
            continue
        best = min(candidates, key=lambda k: np.hypot(after[k][0] - x, after[k][1] - y))
        if above != 0 and after[best][3] != above:
            return False
        left.remove(best)
    for k in left:
        over[after[k][3]] -= after[k][2]
    return over[1] == over[-1] == 0


def as_lines(yarns, others, tube):
    """Their middles, at the parameters of both states. `tube`: unrolled about z, the outside above."""
    lines = {}
    for name, yarn in yarns.items():
        line = yarn.sections_at(samples(yarn, others[name], 2), 24).mean(axis=1)
        if tube:
            angle, radius = np.unwrap(np.arctan2(line[:, 1], line[:, 0])), np.hypot(line[:, 0], line[:, 1])
            line = np.stack([angle, line[:, 2], radius], axis=1)
        lines[name] = line
    return lines


def interlacing_changes(before, after, tube=False):
    """(pairs of yarns that are interlaced in another way than before, crossings looked at)."""
    lines, moved = as_lines(before, after, tube), as_lines(after, before, tube)
    width = max(np.ptp(yarn.points[0], axis=0).max() for yarn in before.values())
    near = width / 2
    if tube:
        radius = np.mean([line[:, 2].mean() for line in lines.values()])
        for line in [*lines.values(), *moved.values()]:
            line[:, 0] *= radius
    for line in [*lines.values(), *moved.values()]:
        line[:, :2] += line[:, 2:] * [0.11, 0.07]  # seen a little from the side: yarns lie straight above each other
    names, changed, count = sorted(lines), [], 0
    for i, a in enumerate(names):
        for b in names[i:]:
            turns = [2 * np.pi * radius * k for k in range(-4, 5)] if tube else [0.0]
            found = [
                np.concatenate(
                    [
                        crossings(state[a], state[b] + [turn, 0, 0], a == b and turn == 0.0, 1.5 * width)
                        for turn in turns
                    ]
                )
                for state in (lines, moved)
            ]
            count += len(found[0])
            if not same_crossings(*found, near):
                changed.append((a, b))
    return changed, count
