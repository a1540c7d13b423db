"""Points and derivatives of B-spline curves and surfaces by de Boor's triangle in homogeneous coordinates,
and what can be measured with them. For iges_oracle.py; the standard library only."""

import math


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def clamped(knots, degree):
    return len(set(knots[: degree + 1])) == 1 and len(set(knots[-degree - 1 :])) == 1


def span_of(knots, degree, count, t):
    """The k with knots[k] <= t < knots[k + 1]; the last span at the end of the domain."""
    low, high = degree, count - 1
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if knots[middle] <= t else (low, middle - 1)
    while knots[low] == knots[low + 1]:
        low -= 1
    return low


def de_boor(knots, degree, span, control, t):
    """Value and first derivative from the degree + 1 control tuples that matter on a span."""
    d = before = control
    for level in range(1, degree + 1):
        before = d
        d = d[:]
        for i in range(degree, level - 1, -1):
            low, high = knots[span - degree + i], knots[span + 1 + i - level]
            a = (t - low) / (high - low)
            d[i] = tuple((1 - a) * x + a * y for x, y in zip(before[i - 1], before[i]))
    width = knots[span + 1] - knots[span]
    slope = tuple(degree * (y - x) / width for x, y in zip(before[degree - 1], before[degree]))
    return d[degree], slope


def lift(points, weights):
    return [(x * w, y * w, z * w, w) for (x, y, z), w in zip(points, weights)]


def project(value, slope):
    point = tuple(x / value[3] for x in value[:3])
    return point, tuple((dx - slope[3] * p) / value[3] for dx, p in zip(slope[:3], point))


class Curve:
    def at(self, t):
        k = span_of(self.k, self.d, self.n, t)
        part = slice(k - self.d, k + 1)
        return project(*de_boor(self.k, self.d, k, lift(self.points[part], self.weights[part]), t))

    def low(self):
        return self.k[self.d]

    def high(self):
        return self.k[self.n]

    def sides(self):
        return spans(self.k, self.d, self.n)


class Surface:
    def at(self, u, v):
        k, m = span_of(self.ku, self.du, self.nu, u), span_of(self.kv, self.dv, self.nv, v)
        across = []
        for j in range(m - self.dv, m + 1):
            part = slice(j * self.nu + k - self.du, j * self.nu + k + 1)
            across.append(de_boor(self.ku, self.du, k, lift(self.points[part], self.weights[part]), u))
        value, dv = de_boor(self.kv, self.dv, m, [a[0] for a in across], v)
        du, _ = de_boor(self.kv, self.dv, m, [a[1] for a in across], v)
        point, s_u = project(value, du)
        return point, s_u, project(value, dv)[1]

    def size(self):
        return max(max(map(abs, p)) for p in self.points)


def spans(knots, degree, count):
    values = sorted(set(knots[degree : count + 1]))
    return list(zip(values, values[1:]))


GAUSS = [
    (-0.9061798459386640, 0.2369268850561891),
    (-0.5384693101056831, 0.4786286704993665),
    (0.0, 0.5688888888888889),
    (0.5384693101056831, 0.4786286704993665),
    (0.9061798459386640, 0.2369268850561891),
]


def flux(surface):
    """A third of the integral of S . (S_u x S_v): the volume between an outward face and the origin."""
    total = 0.0
    for u0, u1 in spans(surface.ku, surface.du, surface.nu):
        for v0, v1 in spans(surface.kv, surface.dv, surface.nv):
            for x, a in GAUSS:
                for y, b in GAUSS:
                    u, v = (u0 + u1) / 2 + x * (u1 - u0) / 2, (v0 + v1) / 2 + y * (v1 - v0) / 2
                    p, s_u, s_v = surface.at(u, v)
                    total += a * b * (u1 - u0) * (v1 - v0) / 4 * dot(p, cross(s_u, s_v))
    return total / 3


def planar_flux(curve, normal):
    """The same for the plane region inside a closed curve that runs counter-clockwise about `normal`."""
    area = [0.0, 0.0, 0.0]
    for t0, t1 in curve.sides():
        for x, a in GAUSS:
            p, d = curve.at((t0 + t1) / 2 + x * (t1 - t0) / 2)
            area = [s + a * (t1 - t0) / 4 * c for s, c in zip(area, cross(p, d))]
    return dot(curve.points[0], normal) * dot(area, normal) / 3


def distance_to(surface, point):
    """Distance to the surface: Newton from the best of a grid of places."""
    u0, u1 = surface.ku[surface.du], surface.ku[surface.nu]
    v0, v1 = surface.kv[surface.dv], surface.kv[surface.nv]
    best = None
    for i in range(25):
        for j in range(25):
            u, v = u0 + (u1 - u0) * i / 24, v0 + (v1 - v0) * j / 24
            gap = minus(surface.at(u, v)[0], point)
            if best is None or dot(gap, gap) < best[0]:
                best = (dot(gap, gap), u, v)
    _, u, v = best
    for _ in range(60):
        p, a, b = surface.at(u, v)
        gap = minus(point, p)
        aa, ab, bb, ga, gb = dot(a, a), dot(a, b), dot(b, b), dot(gap, a), dot(gap, b)
        determinant = aa * bb - ab * ab
        if determinant <= 1e-14 * aa * bb:
            break
        u = min(max(u + (ga * bb - gb * ab) / determinant, u0), u1)
        v = min(max(v + (gb * aa - ga * ab) / determinant, v0), v1)
    return math.hypot(*minus(surface.at(u, v)[0], point))
