"""Curves and surfaces of IGES by the formulas of the standard (not as B-splines, but for 126 and 128), with a placement
each. For iges_model.py; the standard library only.

Every curve has `at(t)` and a range `t0, t1`; every surface `at(u, v)` and `u0, u1, v0, v1`, None where it has no end. Both
give placed points. `off(p)`: how far a point is from it, exactly for the unbounded ones, else by Gauss-Newton."""

import heapq
import math

from bspline import Curve as SplineCurve, Surface as SplineSurface, cross, dot, minus


def plus(a, b, f=1.0):
    return tuple(x + f * y for x, y in zip(a, b))


def times(a, f):
    return tuple(x * f for x in a)


def unit(a):
    length = math.sqrt(dot(a, a))
    return times(a, 1 / length)


def norm(a):
    return math.sqrt(dot(a, a))


class Place:
    """x -> R x + t."""

    def __init__(self, rows=((1, 0, 0), (0, 1, 0), (0, 0, 1)), shift=(0, 0, 0)):
        self.rows, self.shift = rows, shift

    def __call__(self, p):
        return tuple(dot(row, p) + s for row, s in zip(self.rows, self.shift))

    def turn(self, d):
        return tuple(dot(row, d) for row in self.rows)

    def after(self, inner):
        """First `inner`, then this."""
        columns = list(zip(*inner.rows))
        return Place(tuple(tuple(dot(row, c) for c in columns) for row in self.rows), self(inner.shift))

    def mirrors(self):
        return dot(self.rows[0], cross(self.rows[1], self.rows[2])) < 0

    def is_identity(self):
        return self.rows == ((1, 0, 0), (0, 1, 0), (0, 0, 1)) and tuple(self.shift) == (0, 0, 0)


# ---- curves -----------------------------------------------------------------------------------------------


class Curve:
    spline = None  # the bspline.Curve where it is one, as in the file

    def __init__(self, formula, t0, t1, corners=()):
        self.formula, self.t0, self.t1, self.place = formula, t0, t1, Place()
        self.corners = list(corners)  # parameters where it is not smooth
        self.grid = None

    def at(self, t):
        return self.place(self.formula(t))

    def placed(self, place):
        other = Curve(self.formula, self.t0, self.t1, self.corners)
        other.spline, other.place = self.spline, place.after(self.place)
        return other

    def backwards(self):
        a, b, formula = self.t0, self.t1, self.formula
        other = Curve(lambda t: formula(a + b - t), a, b, [a + b - c for c in reversed(self.corners)])
        other.place = self.place
        return other

    def samples(self, count=9):
        """Evenly in the parameter, from the first to the last."""
        return [self.at(self.t0 + (self.t1 - self.t0) * i / (count - 1)) for i in range(count)]

    def slope(self, t):
        h = 1e-6 * (self.t1 - self.t0)
        a, b = max(t - h, self.t0), min(t + h, self.t1)
        return times(minus(self.at(b), self.at(a)), 1 / (b - a))

    def off(self, p):
        return nearest_on_curve(self, p)[0]


def grid_of(curve):
    """[(a, b, [(parameter, point)])] of its smooth parts."""
    stops = [curve.t0, *curve.corners, curve.t1]
    steps = max(4, 96 // (len(stops) - 1))
    return [
        (a, b, [(t, curve.at(t)) for t in (a + (b - a) * i / steps for i in range(steps + 1))])
        for a, b in zip(stops, stops[1:])
        if b > a
    ]


def nearest_on_curve(curve, p):
    """(distance, parameter)."""
    curve.grid = curve.grid or grid_of(curve)
    found = [(min((norm(minus(point, p)), t) for t, point in points), a, b) for a, b, points in curve.grid]
    found.sort()
    result = found[0][0]
    for (_, t), a, b in found[:4]:
        for _ in range(40):
            h = 1e-6 * (b - a)
            low, high = max(t - h, a), min(t + h, b)
            d = times(minus(curve.at(high), curve.at(low)), 1 / (high - low))
            if dot(d, d) == 0:
                break
            step = dot(minus(p, curve.at(t)), d) / dot(d, d)
            moved = min(max(t + step, a), b)
            if moved == t:
                break
            t = moved
            result = min(result, (norm(minus(curve.at(t), p)), t))
    return result


def line(a, b):
    return Curve(lambda t: plus(times(a, 1 - t), b, t), 0.0, 1.0)


def polyline(points):
    def at(t):
        i = min(int(t), len(points) - 2)
        return plus(times(points[i], 1 - (t - i)), points[i + 1], t - i)

    return Curve(at, 0.0, float(len(points) - 1), [float(i) for i in range(1, len(points) - 1)])


def arc(z, centre, start, end):
    """Counter-clockwise about +z; a whole circle where both ends are one point."""
    radius = math.hypot(start[0] - centre[0], start[1] - centre[1])
    a = math.atan2(start[1] - centre[1], start[0] - centre[0])
    b = math.atan2(end[1] - centre[1], end[0] - centre[0])
    if start == end or b <= a:
        b += 2 * math.pi
    return Curve(lambda t: (centre[0] + radius * math.cos(t), centre[1] + radius * math.sin(t), z), a, b)


def conic(A, B, C, D, E, F, z, start, end):
    """A x^2 + B x y + C y^2 + D x + E y + F = 0 in the plane z, from start to end: an ellipse counter-clockwise, the
    others the way between the two."""
    discriminant = B * B - 4 * A * C
    angle = 0.5 * math.atan2(B, A - C)
    c, s = math.cos(angle), math.sin(angle)

    def turned(p):
        return c * p[0] + s * p[1], -s * p[0] + c * p[1]

    # In axes along the conic's own: a x^2 + b y^2 + d x + e y + f = 0.
    a, b = A * c * c + B * c * s + C * s * s, A * s * s - B * c * s + C * c * c
    d, e, f = D * c + E * s, -D * s + E * c, F
    p, q = turned(start), turned(end)

    def back(x, y):
        return (c * x - s * y, s * x + c * y, z)

    largest = max(abs(A), abs(B), abs(C))
    if abs(discriminant) <= 1e-12 * largest * largest:  # a parabola: a function of one coordinate
        if abs(a) >= abs(b):
            return Curve(lambda t: back(t, -(a * t * t + d * t + f) / e), p[0], q[0])
        return Curve(lambda t: back(-(b * t * t + e * t + f) / d, t), p[1], q[1])
    x0, y0 = -d / (2 * a), -e / (2 * b)
    k = a * x0 * x0 + b * y0 * y0 - f
    if discriminant < 0:
        ra, rb = math.sqrt(k / a), math.sqrt(k / b)
        t0, t1 = (math.atan2((y - y0) / rb, (x - x0) / ra) for x, y in (p, q))
        if start == end or t1 <= t0:
            t1 += 2 * math.pi
        return Curve(lambda t: back(x0 + ra * math.cos(t), y0 + rb * math.sin(t)), t0, t1)
    if k / a > 0:
        ra, rb = math.sqrt(k / a), math.sqrt(-k / b)
        side = math.copysign(1.0, p[0] - x0)
        t0, t1 = (math.asinh((y - y0) / rb) for _, y in (p, q))
        return Curve(lambda t: back(x0 + side * ra * math.cosh(t), y0 + rb * math.sinh(t)), t0, t1)
    ra, rb = math.sqrt(-k / a), math.sqrt(k / b)
    side = math.copysign(1.0, p[1] - y0)
    t0, t1 = (math.asinh((x - x0) / ra) for x, _ in (p, q))
    return Curve(lambda t: back(x0 + ra * math.sinh(t), y0 + side * rb * math.cosh(t)), t0, t1)


def spline_curve(degree, knots, weights, points, t0, t1):
    s = SplineCurve()
    s.d, s.n, s.k, s.weights, s.points = degree, len(points), knots, weights, points
    curve = Curve(lambda t: s.at(t)[0], t0, t1, inner(knots, t0, t1))
    curve.spline = s
    return curve


def inner(knots, t0, t1):
    return sorted({k for k in knots if t0 < k < t1})


def power_curve(breaks, segments):
    """112: per segment (ax, bx, cx, dx), (ay, ...), (az, ...) in t - T(i)."""

    def at(t):
        i = 0
        while i + 1 < len(segments) and t >= breaks[i + 1]:
            i += 1
        s = t - breaks[i]
        return tuple(k[0] + s * (k[1] + s * (k[2] + s * k[3])) for k in segments[i])

    return Curve(at, breaks[0], breaks[-1], breaks[1:-1])


def offset_curve(base, distance, normal, t0, t1):
    """130 with one distance: to the side of V x T."""

    def at(t):
        return plus(base.at(t), times(unit(cross(normal, base.slope(t))), distance))

    return Curve(at, t0, t1, [c for c in base.corners if t0 < c < t1])


# ---- surfaces ---------------------------------------------------------------------------------------------


class Surface:
    spline = None
    off_formula = None  # of an unbounded analytic surface: a point before the placement -> distance

    def __init__(self, formula, u0=None, u1=None, v0=None, v1=None, normal=None):
        self.formula, self.place = formula, Place()
        self.range = (u0, u1, v0, v1)
        self.normal_formula = normal
        self.grids = {}

    def placed(self, place):
        other = Surface(self.formula, *self.range, self.normal_formula)
        other.spline, other.off_formula = self.spline, self.off_formula
        other.place = place.after(self.place)
        return other

    def is_bounded(self):
        return None not in self.range

    def at(self, u, v):
        return self.place(self.formula(u, v))

    def slopes(self, u, v):
        u0, u1, v0, v1 = self.range
        h, k = 1e-6 * (u1 - u0), 1e-6 * (v1 - v0)
        a, b, c, d = max(u - h, u0), min(u + h, u1), max(v - k, v0), min(v + k, v1)
        return (
            times(minus(self.at(b, v), self.at(a, v)), 1 / (b - a)),
            times(minus(self.at(u, d), self.at(u, c)), 1 / (d - c)),
        )

    def back(self, p):
        """The point before the placement, whose matrix is orthogonal up to one factor."""
        columns = list(zip(*self.place.rows))
        factor = dot(columns[0], columns[0])
        q = minus(p, self.place.shift)
        return tuple(dot(c, q) / factor for c in columns), math.sqrt(factor)

    def off(self, p):
        if self.off_formula:
            q, factor = self.back(p)
            return abs(self.off_formula(q)) * factor
        return self.nearest(p)[0]

    def places(self, grid):
        """Points of a grid of so many steps each way, with their parameters."""
        if grid not in self.grids:
            u0, u1, v0, v1 = self.range
            pairs = [
                (u0 + (u1 - u0) * i / grid, v0 + (v1 - v0) * j / grid) for i in range(grid + 1) for j in range(grid + 1)
            ]
            self.grids[grid] = [(self.at(u, v), u, v) for u, v in pairs]
        return self.grids[grid]

    def nearest(self, p, grid=24):
        u0, u1, v0, v1 = self.range
        best = heapq.nsmallest(3, ((math.dist(point, p), u, v) for point, u, v in self.places(grid)))
        result = best[0]
        for _, u, v in best:
            for _ in range(30):
                gap = minus(p, self.at(u, v))
                a, b = self.slopes(u, v)
                aa, ab, bb, ga, gb = dot(a, a), dot(a, b), dot(b, b), dot(gap, a), dot(gap, b)
                determinant = aa * bb - ab * ab
                if determinant <= 1e-14 * aa * bb:
                    du, dv = (ga / aa if aa else 0), (gb / bb if bb else 0)
                else:
                    du, dv = (ga * bb - gb * ab) / determinant, (gb * aa - ga * ab) / determinant
                moved = min(max(u + du, u0), u1), min(max(v + dv, v0), v1)
                if moved == (u, v):
                    break
                u, v = moved
                result = min(result, (norm(minus(self.at(u, v), p)), u, v))
            if result[0] < 1e-13 * (1 + norm(p)):
                break
        return result

    def normal(self, p):
        """S_u x S_v near a point of the surface, of whatever length."""
        if self.normal_formula:
            q, _ = self.back(p)
            n = self.place.turn(self.normal_formula(q))
            return times(n, -1) if self.place.mirrors() else n  # as S_u x S_v of the placed surface
        _, u, v = self.nearest(p)
        a, b = self.slopes(u, v)
        return cross(a, b)


def spline_surface(du, dv, nu, nv, ku, kv, weights, points, area):
    s = SplineSurface()
    s.du, s.dv, s.nu, s.nv, s.ku, s.kv, s.weights, s.points = du, dv, nu, nv, ku, kv, weights, points
    surface = Surface(lambda u, v: s.at(u, v)[0], *area)
    surface.spline = s
    return surface


def power_surface(breaks_u, breaks_v, patches):
    """114: patches[i][j][axis][power of t][power of s]."""

    def at(u, v):
        i = j = 0
        while i + 2 < len(breaks_u) and u >= breaks_u[i + 1]:
            i += 1
        while j + 2 < len(breaks_v) and v >= breaks_v[j + 1]:
            j += 1
        s, t = u - breaks_u[i], v - breaks_v[j]
        return tuple(sum(k[n][m] * s**m * t**n for n in range(4) for m in range(4)) for k in patches[i][j])

    return Surface(at, breaks_u[0], breaks_u[-1], breaks_v[0], breaks_v[-1])


def ruled(first, second, by_length, backwards):
    """118: both curves over [0, 1], by their parameters or by their lengths."""
    a, b = (length_map(first), length_map(second)) if by_length else (even_map(first), even_map(second))

    def at(u, v):
        return plus(times(first.at(a(u)), 1 - v), second.at(b(1 - u if backwards else u)), v)

    return Surface(at, 0.0, 1.0, 0.0, 1.0)


def even_map(curve):
    return lambda u: curve.t0 + u * (curve.t1 - curve.t0)


def length_map(curve, steps=2000):
    """Parameter at a share of the length; by chords, good to some 1e-7."""
    ts = [curve.t0 + (curve.t1 - curve.t0) * i / steps for i in range(steps + 1)]
    points = [curve.at(t) for t in ts]
    sums = [0.0]
    for p, q in zip(points, points[1:]):
        sums.append(sums[-1] + norm(minus(q, p)))

    def at(u):
        wanted, low, high = u * sums[-1], 0, steps
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if sums[middle] <= wanted else (low, middle)
        share = (wanted - sums[low]) / (sums[high] - sums[low]) if sums[high] > sums[low] else 0
        return ts[low] + share * (ts[high] - ts[low])

    return at


def revolution(foot, direction, generatrix, start, end):
    """120: the generatrix turned about the axis by start..end (radians, right hand)."""
    axis = unit(direction)

    def at(u, v):
        p = minus(generatrix.at(u), foot)
        along = dot(p, axis)
        flat = plus(p, axis, -along)
        side = cross(axis, flat)
        turned = plus(times(flat, math.cos(v)), side, math.sin(v))
        return plus(plus(foot, axis, along), turned)

    return Surface(at, generatrix.t0, generatrix.t1, start, end)


def extrusion(directrix, end):
    """122: from the directrix, whose first point is carried to `end`."""
    shift = minus(end, directrix.at(directrix.t0))
    return Surface(lambda u, v: plus(directrix.at(u), shift, v), directrix.t0, directrix.t1, 0.0, 1.0)


def offset_surface(base, side, distance):
    """140, along the base's normal, on the side of the normal that the file gives for its first corner."""
    if dot(cross(*base.slopes(base.range[0], base.range[2])), side) < 0:
        distance = -distance

    def at(u, v):
        a, b = base.slopes(u, v)
        return plus(base.at(u, v), times(unit(cross(a, b)), distance))

    return Surface(at, *base.range)


def frame_of(axis, reference):
    """x, y, z of an analytic surface; x by the file's reference direction, else any."""
    z = unit(axis)
    if reference is None or norm(cross(z, reference)) < 1e-12:
        reference = (1, 0, 0) if abs(z[0]) < 0.9 else (0, 1, 0)
    x = unit(plus(reference, z, -dot(reference, z)))
    return x, cross(z, x), z


def analytic(kind, centre, axis, reference, *sizes):
    """190 plane, 192 cylinder (r), 194 cone (r, half angle), 196 sphere (r), 198 torus (R, r)."""
    x, y, z = frame_of(axis, reference)

    def local(p):
        q = minus(p, centre)
        return dot(q, x), dot(q, y), dot(q, z)

    def radial(p):
        a, b, h = local(p)
        return math.hypot(a, b), h, plus(times(x, a), y, b)

    def world(a, b, c):
        return plus(plus(plus(centre, x, a), y, b), z, c)

    if kind == 190:
        off, normal = (lambda p: local(p)[2]), (lambda p: z)
        formula = lambda u, v: world(u, v, 0)
    elif kind == 192:
        (r,) = sizes
        off, normal = (lambda p: radial(p)[0] - r), (lambda p: radial(p)[2])
        formula = lambda u, v: world(r * math.cos(u), r * math.sin(u), v)
    elif kind == 194:
        r, half = sizes
        c, s = math.cos(half), math.sin(half)

        def off(p):
            rho, h, _ = radial(p)
            return (rho - r) * c - h * s

        def normal(p):
            rho, _, out = radial(p)
            return plus(times(unit(out), c), z, -s) if rho else z

        formula = lambda u, v: world((r + v * s) * math.cos(u), (r + v * s) * math.sin(u), v * c)
    elif kind == 196:
        (r,) = sizes
        off, normal = (lambda p: norm(minus(p, centre)) - r), (lambda p: minus(p, centre))
        formula = lambda u, v: world(r * math.cos(v) * math.cos(u), r * math.cos(v) * math.sin(u), r * math.sin(v))
    else:
        big, small = sizes

        def off(p):
            rho, h, _ = radial(p)
            return math.hypot(rho - big, h) - small

        def normal(p):
            rho, h, out = radial(p)
            return plus(times(unit(out), rho - big), z, h)

        formula = lambda u, v: world(
            (big + small * math.cos(v)) * math.cos(u), (big + small * math.cos(v)) * math.sin(u), small * math.sin(v)
        )
    whole = {196: (0.0, 2 * math.pi, -math.pi / 2, math.pi / 2), 198: (0.0, 2 * math.pi, 0.0, 2 * math.pi)}
    surface = Surface(formula, *whole.get(kind, (None,) * 4), normal)
    surface.off_formula = off
    return surface
