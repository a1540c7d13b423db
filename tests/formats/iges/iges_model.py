"""What an IGES file holds by the standard: faces with their loops, curves, names, colours, levels and groups, everything
placed (124, 408). Built on any_iges.py and shapes.py; shares nothing with the program's reader."""

import shapes
from any_iges import File, Values, need
from shapes import Place

STANDARD_COLORS = {
    1: (0, 0, 0),
    2: (100, 0, 0),
    3: (0, 100, 0),
    4: (0, 0, 100),
    5: (100, 100, 0),
    6: (100, 0, 100),
    7: (0, 100, 100),
    8: (100, 100, 100),
}
CURVES = {100, 102, 104, 106, 110, 112, 126, 130}
COPIOUS_CURVES = {11, 12, 13, 63}
SURFACES = {108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198}
DEPTH = 50


class Face:
    """surface, loops (lists of curves in space, in order), flats (the same in parameters, or None each), reversed,
    chain (the directory pointers from the part down to the surface), entity (whose name and colour it has).
    outer_is_border: the outer loop is the border of the surface, and not among the loops."""

    outer_is_border = False


class Part:
    """kind, faces, entity, groups (402s that hold it)."""


class Model:
    def __init__(self, data):
        self.file = File(data)
        self.entities = self.file.entities
        self.cache = {}
        self.group_names = {}
        self.children = self.find_children()
        self.parts, self.curves, self.points = [], [], []
        self.build()

    # ---- who belongs to whom

    def find_children(self):
        """Entities that another one is made of: they do not stand for themselves."""
        children = set()
        for e in self.entities.values():
            if e.type == 402:
                continue
            for de in self.pointers(e):
                if de in self.entities:
                    children.add(de)
        return children

    def pointers(self, e):
        v = Values(e.values, e.what)
        t = e.type
        if t == 102 or t == 514:
            n = v.integer()
            return [p for p in (v.integers(n) if t == 102 else v.integers(2 * n)[::2])]
        if t == 108:
            v.reals(4)
            return [v.integer()] if e.form else []
        if t == 118:
            return v.integers(2)
        if t == 120:
            return v.integers(2)
        if t == 122:
            return v.integers(1)
        if t == 130:
            return v.integers(1)
        if t == 140:
            v.reals(4)
            return v.integers(1)
        if t == 141:
            v.integer(), v.integer()
            found = [v.integer()]
            for _ in range(v.integer()):
                found.append(v.integer())
                v.integer()
                found += v.integers(v.integer())
            return found
        if t == 142:
            v.integer()
            return [abs(p) for p in v.integers(3)]
        if t == 143:
            v.integer()
            found = [v.integer()]
            return found + v.integers(v.integer())
        if t == 144:
            found, outer, holes = [v.integer()], v.integer(), v.integer()
            found.append(v.integer() if outer else (v.integer(), 0)[1])
            return [p for p in found + v.integers(holes) if p]
        if t in (190, 192, 194, 196, 198):
            return self.analytic_pointers(e)
        if t == 186:
            found = [v.integer()]
            v.integer()
            return found + v.integers(2 * v.integer())[::2]
        if t == 510:
            found, n = [v.integer()], v.integer()
            v.integer()
            return found + v.integers(n)
        if t == 508:
            found = []
            for _ in range(v.integer()):
                v.integer()
                found.append(v.integer())
                v.integer(), v.integer()
                for _ in range(v.integer()):
                    v.integer()
                    found.append(v.integer())
            return found
        if t == 504:
            found = []
            for _ in range(v.integer()):
                curve, start, _, end, _ = v.integers(5)
                found += [curve, start, end]
            return found
        if t == 308:
            v.integer(), v.take()
            return v.integers(v.integer())
        if t == 408:
            return v.integers(1)
        return []

    def analytic_pointers(self, e):
        v = Values(e.values, e.what)
        # Behind the place: pointers, reals, pointers.
        before, reals, behind = {190: (2, 0, 0), 192: (1, 1, 1), 194: (1, 2, 1), 196: (0, 1, 2), 198: (1, 2, 1)}[e.type]
        found = v.integers(1) + v.integers(before)
        v.reals(reals)
        found += v.integers(behind)
        return [p for p in found if p]

    def target(self, de, e, *types):
        need(de in self.entities, "{}: points to {}", e.what, de)
        other = self.entities[de]
        need(not types or other.type in types, "{}: points to a {}", e.what, other.type)
        return other

    # ---- placement

    def own_place(self, e, depth=0):
        if not e.matrix:
            return Place()
        need(depth < DEPTH, "{}: matrices in a circle", e.what)
        m = self.target(e.matrix, e, 124)
        r = Values(m.values, m.what).reals(12)
        own = Place(tuple(tuple(r[4 * i : 4 * i + 3]) for i in range(3)), (r[3], r[7], r[11]))
        return self.own_place(m, depth + 1).after(own)

    # ---- curves

    def curve(self, de, parent, depth=0):
        """In the space of the entity's parent: a list of smooth pieces in order."""
        need(depth < DEPTH, "{}: curves in a circle", parent.what)
        e = self.target(de, parent, *CURVES)
        if de not in self.cache:
            self.cache[de] = [c.placed(self.own_place(e)) for c in self.plain_curve(e, depth)]
        return self.cache[de]

    def one_curve(self, de, parent):
        pieces = self.curve(de, parent)
        if len(pieces) == 1:
            return pieces[0]

        # A composite is one curve: each piece over its own range, one after the other.
        starts, total = [], 0.0
        for p in pieces:
            starts.append(total)
            total += p.t1 - p.t0

        def at(t):
            i = len(pieces) - 1
            while i > 0 and t < starts[i]:
                i -= 1
            return pieces[i].at(min(pieces[i].t0 + t - starts[i], pieces[i].t1))

        return shapes.Curve(at, 0.0, total, starts[1:])

    def plain_curve(self, e, depth):
        v = Values(e.values, e.what)
        if e.type == 102:
            return [c for de in v.integers(v.integer()) for c in self.curve(de, e, depth + 1)]
        if e.type == 100:
            z = v.real()
            return [shapes.arc(z, *[tuple(v.reals(2)) for _ in range(3)])]
        if e.type == 104:
            k = v.reals(7)
            return [shapes.conic(*k[:6], k[6], tuple(v.reals(2)), tuple(v.reals(2)))]
        if e.type == 106:
            return [shapes.polyline(self.copious(e))]
        if e.type == 110:
            return [shapes.line(v.point(), v.point())]
        if e.type == 112:
            v.integer(), v.integer(), v.integer()
            n = v.integer()
            breaks = v.reals(n + 1)
            return [shapes.power_curve(breaks, [[v.reals(4) for _ in range(3)] for _ in range(n)])]
        if e.type == 126:
            k, degree = v.integer(), v.integer()
            v.integers(4)
            knots, weights, points = v.reals(k + degree + 2), v.reals(k + 1), v.points(k + 1)
            t0, t1 = v.real(knots[degree]), v.real(knots[k + 1])
            return [shapes.spline_curve(degree, knots, weights, points, t0, t1)]
        if e.type == 130:
            base = self.one_curve(v.integer(), e)
            need(v.integer() == 1, "{}: an offset that varies", e.what)
            v.integers(3)
            distance = v.real()
            v.reals(3)
            return [shapes.offset_curve(base, distance, v.point(), v.real(), v.real())]
        need(False, "{}: no curve", e.what)

    def copious(self, e):
        v = Values(e.values, e.what)
        kind, n = v.integer(), v.integer()
        z = v.real() if kind == 1 else 0.0
        points = []
        for _ in range(n):
            points.append((*v.reals(2), z) if kind == 1 else v.point())
            if kind == 3:
                v.reals(3)
        return points

    # ---- surfaces

    def surface(self, de, parent):
        e = self.target(de, parent, *SURFACES)
        return self.plain_surface(e).placed(self.own_place(e))

    def point_of(self, de, e):
        v = self.target(de, e, 116)
        return self.own_place(v)(Values(v.values, v.what).point())

    def direction_of(self, de, e):
        v = self.target(de, e, 123)
        return self.own_place(v).turn(Values(v.values, v.what).point())

    def plain_surface(self, e):
        v = Values(e.values, e.what)
        if e.type == 128:
            nu, nv = v.integer() + 1, v.integer() + 1
            du, dv = v.integer(), v.integer()
            v.integers(5)
            ku, kv = v.reals(nu + du + 1), v.reals(nv + dv + 1)
            weights, points = v.reals(nu * nv), v.points(nu * nv)
            area = (v.real(ku[du]), v.real(ku[nu]), v.real(kv[dv]), v.real(kv[nv]))
            return shapes.spline_surface(du, dv, nu, nv, ku, kv, weights, points, area)
        if e.type == 108:
            a, b, c, d = v.reals(4)
            n = (a, b, c)
            return shapes.analytic(190, shapes.times(n, d / shapes.dot(n, n)), n, None)
        if e.type == 114:
            v.integer(), v.integer()
            m, n = v.integer(), v.integer()
            breaks_u, breaks_v = v.reals(m + 1), v.reals(n + 1)
            patches = [[[[v.reals(4) for _ in range(4)] for _ in range(3)] for _ in range(n + 1)] for _ in range(m)]
            return shapes.power_surface(breaks_u, breaks_v, patches)
        if e.type == 118:
            first, second = self.one_curve(v.integer(), e), self.one_curve(v.integer(), e)
            return shapes.ruled(first, second, e.form == 0, v.integer() == 1)
        if e.type == 120:
            axis, generatrix = self.curve(v.integer(), e)[0], self.one_curve(v.integer(), e)
            a, b = axis.at(axis.t0), axis.at(axis.t1)
            return shapes.revolution(a, shapes.minus(b, a), generatrix, v.real(), v.real())
        if e.type == 122:
            return shapes.extrusion(self.one_curve(v.integer(), e), v.point())
        if e.type == 140:
            side, distance = v.point(), v.real()
            return shapes.offset_surface(self.surface(v.integer(), e), side, distance)
        return self.analytic(e, v)

    def analytic(self, e, v):
        centre = self.point_of(v.integer(), e)
        if e.type == 196:
            r = v.real()
            axis = self.direction_of(v.integer(), e) if e.form == 1 else (0, 0, 1)
            reference = self.direction_of(v.integer(), e) if e.form == 1 else (1, 0, 0)
            return shapes.analytic(196, centre, axis, reference, r)
        axis = self.direction_of(v.integer(), e)
        sizes = v.reals({190: 0, 192: 1, 194: 2, 198: 2}[e.type])
        if e.type == 194:
            sizes[1] *= shapes.math.pi / 180
        reference = self.direction_of(v.integer(), e) if e.form == 1 else None
        return shapes.analytic(e.type, centre, axis, reference, *sizes)

    # ---- faces and parts

    def face(self, surface, chain, entity, place, loops=(), reversed=False):
        f = Face()
        f.surface, f.chain, f.entity, f.reversed = surface.placed(place), chain, entity, reversed
        f.loops = [[c.placed(place) for c in space] for space, _ in loops]
        f.flats = [flat for _, flat in loops]
        return f

    def boundary_142(self, de, e, place):
        b = self.target(de, e, 142)
        v = Values(b.values, b.what)
        v.integers(2)
        flat, space = v.integer(), v.integer()
        own = self.own_place(b)
        return ([c.placed(own) for c in self.curve(space, b)] if space else [], self.curve(flat, b) if flat else None)

    def boundary_141(self, de, e):
        b = self.target(de, e, 141)
        v = Values(b.values, b.what)
        v.integers(3)
        space, flats = [], []
        for _ in range(v.integer()):
            curve, sense = v.integer(), v.integer()
            pieces = self.curve(curve, b)
            space += pieces if sense != 2 else [c.backwards() for c in reversed(pieces)]
            flats += [c for p in v.integers(v.integer()) for c in self.curve(p, b)]
        own = self.own_place(b)
        return [c.placed(own) for c in space], flats or None

    def trimmed(self, e, place):
        v = Values(e.values, e.what)
        place = place.after(self.own_place(e))
        if e.type == 143:
            _, surface = v.integer(), v.integer()
            loops = [self.boundary_141(p, e) for p in v.integers(v.integer())]
        else:
            surface, outer, holes, first = v.integer(), v.integer(), v.integer(), v.integer()
            loops = [self.boundary_142(first, e, place)] if outer else []
            loops += [self.boundary_142(p, e, place) for p in v.integers(holes)]
        face = self.face(self.surface(surface, e), [e.de, surface], e, place, loops)
        face.outer_is_border = e.type == 144 and not outer and bool(loops)
        return face

    def plane_108(self, e, place):
        v = Values(e.values, e.what)
        v.reals(4)
        loops = [(self.curve(v.integer(), e), None)] if e.form else []
        return self.face(self.surface(e.de, e), [e.de], e, place, loops)

    def loop_508(self, de, e):
        b = self.target(de, e, 508)
        v = Values(b.values, b.what)
        space, flats = [], []
        for _ in range(v.integer()):
            kind, where, index, forward = v.integers(4)
            for _ in range(v.integer()):
                v.integer()
                flats.append(v.integer())
            if kind == 1:
                continue
            edges = self.target(where, b, 504)
            w = Values(edges.values, edges.what)
            n = w.integer()
            need(1 <= index <= n, "{}: edge {}", b.what, index)
            pieces = self.curve(w.integers(5 * n)[5 * (index - 1)], edges)
            space += pieces if forward else [c.backwards() for c in reversed(pieces)]
        return space, None

    def face_510(self, de, parent, place, turned):
        e = self.target(de, parent, 510)
        v = Values(e.values, e.what)
        surface, n = v.integer(), v.integer()
        v.integer()
        loops = [self.loop_508(p, e) for p in v.integers(n)]
        place = place.after(self.own_place(e))
        # A mirror image of a solid has its outside outside.
        return self.face(
            self.surface(surface, e), [parent.de, e.de, surface], e, place, loops, turned != place.mirrors()
        )

    def shell_514(self, de, parent, place, turned=False):
        e = self.target(de, parent, 514)
        place = place.after(self.own_place(e)) if e is not parent else place
        v = Values(e.values, e.what)
        flags = [v.integers(2) for _ in range(v.integer())]
        return [self.face_510(p, e, place, turned != (forward == 0)) for p, forward in flags]

    def solid_186(self, e, place):
        v = Values(e.values, e.what)
        place = place.after(self.own_place(e))
        faces = self.shell_514(v.integer(), e, place, v.integer() == 0)
        for _ in range(v.integer()):
            shell, flag = v.integers(2)
            faces += self.shell_514(shell, e, place, flag == 0)
        for f in faces:
            f.chain = [e.de, *f.chain]
        return faces

    def instance(self, e, place, depth, trail):
        need(depth < DEPTH, "{}: subfigures in a circle", e.what)
        v = Values(e.values, e.what)
        definition = self.target(v.integer(), e, 308)
        shift = v.point()
        scale = v.real(1.0)
        own = Place(((scale, 0, 0), (0, scale, 0), (0, 0, scale)), shift)
        place = place.after(self.own_place(e)).after(own)
        d = Values(definition.values, definition.what)
        d.integer(), d.take()
        for p in d.integers(d.integer()):
            self.add(self.target(p, definition), place, depth + 1, [*trail, e])

    def add(self, e, place, depth=0, trail=()):
        """As a thing that stands for itself."""
        if e.type == 408:
            self.instance(e, place, depth, trail)
            return
        faces, kind = None, "surfaces"
        if e.type in (143, 144):
            faces = [self.trimmed(e, place)]
        elif e.type == 186:
            faces, kind = self.solid_186(e, place), "solid"
        elif e.type == 514:
            faces, kind = self.shell_514(e.de, e, place.after(self.own_place(e))), "shell"
        elif e.type == 510:
            faces = [self.face_510(e.de, e, place, False)]
        elif e.type == 108:
            faces = [self.plane_108(e, place)]
        elif e.type in SURFACES:
            faces = [self.face(self.surface(e.de, e), [e.de], e, place)]
        elif e.type in CURVES and (e.type != 106 or e.form in COPIOUS_CURVES):
            for c in self.curve(e.de, e):
                curve = c.placed(place)
                curve.entity, curve.trail = e, list(trail)
                self.curves.append(curve)
        elif e.type == 116:
            self.points.append(place.after(self.own_place(e))(Values(e.values, e.what).point()))
        if faces is not None:
            part = Part()
            part.kind, part.faces, part.entity, part.trail = kind, faces, e, list(trail)
            self.parts.append(part)

    def build(self):
        for e in self.entities.values():
            if e.de not in self.children:
                self.add(e, Place())

    # ---- how it looks

    def own_count(self, e):
        """How many values are the entity's own; pointers to associativities and properties may follow."""
        v = Values(e.values, e.what)
        t = e.type
        if t == 128:
            nu, nv, du, dv = v.integers(4)
            return 9 + nu + du + 2 + nv + dv + 2 + 4 * (nu + 1) * (nv + 1) + 4
        if t == 126:
            k, m = v.integers(2)
            return 6 + k + m + 2 + 4 * (k + 1) + 2 + 3
        if t in (102, 502, 504, 514, 402):
            return 1 + v.integer() * {102: 1, 502: 3, 504: 5, 514: 2, 402: 1}[t]
        if t == 106:
            kind, n = v.integers(2)
            return 2 + (1 if kind == 1 else 0) + n * {1: 2, 2: 3, 3: 6}[kind]
        if t == 112:
            v.integers(3)
            return 4 + 13 * v.integer() + 1 + 12
        if t == 114:
            v.integers(2)
            m, n = v.integers(2)
            return 4 + m + 1 + n + 1 + 48 * (m + 1) * (n + 1)
        if t == 142 or t == 100:
            return {142: 5, 100: 7}[t]
        if t == 143:
            v.integers(2)
            return 3 + v.integer()
        if t == 144:
            v.integers(2)
            return 4 + v.integer()
        if t == 186:
            v.integers(2)
            return 3 + 2 * v.integer()
        if t == 510:
            v.integer()
            return 3 + v.integer()
        if t == 308:
            v.integer(), v.take()
            return 3 + v.integer()
        if t == 408:
            return 5
        fixed = {104: 11, 108: 9, 110: 6, 116: 4, 118: 4, 120: 4, 122: 4, 130: 14, 140: 5}
        if t in fixed:
            return fixed[t]
        analytic = {190: (2, 3), 192: (3, 4), 194: (4, 5), 196: (2, 4), 198: (4, 5)}
        return analytic[t][e.form] if t in analytic else len(e.values)

    def properties(self, e):
        v = Values(e.values, e.what)
        v.at = self.own_count(e)
        v.integers(v.integer())
        return [self.entities[p] for p in v.integers(v.integer()) if p in self.entities]

    def name(self, e):
        for p in self.properties(e):
            if (p.type, p.form) == (406, 15):
                v = Values(p.values, p.what)
                v.integer()
                return v.string()
        return ""

    def label(self, e):
        return e.label + e.subscript if e.label and e.subscript not in ("", "0") else e.label

    def color(self, e):
        """Percent of red, green, blue; None where the entity has no colour."""
        if e.color < 0:
            return tuple(Values(self.target(-e.color, e, 314).values, "314").reals(3))
        return STANDARD_COLORS.get(e.color)

    def level(self, e):
        """Of several (406 form 1) the first."""
        if e.level >= 0:
            return e.level
        v = Values(self.target(-e.level, e, 406).values, "406")
        v.integer()
        return v.integer()

    def groups(self):
        """402s that collect, with their members."""
        found = []
        for e in self.entities.values():
            if e.type == 402 and e.form in (1, 7, 14, 15):
                v = Values(e.values, e.what)
                found.append((e, v.integers(v.integer())))
        return found

    def counts(self):
        counts = {}
        for e in self.entities.values():
            counts[e.type] = counts.get(e.type, 0) + 1
        return counts
