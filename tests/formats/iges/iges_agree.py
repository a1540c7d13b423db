#!/usr/bin/env python3
"""Do two readers agree about an IGES file? Ours, as dumped by dump_cad.cpp, and the one of iges_model.py, which shares no
code with it and knows curves and surfaces by their formulas, not as B-splines.

    iges_agree.py FILE.igs DUMP.json     prints every disagreement (exit code 1), or one line of counts
    iges_agree.py FILE.igs               prints what the second reader sees, as JSON

B-splines (126, 128) are compared at equal parameters, and number for number where nothing moves them; the others by
distance, both ways: our points against the formula, the formula's points against our surface.
"""

import json
import re
import sys

import shapes
from any_iges import Fault
from iges_model import Model
from shapes import cross, dot, minus, norm, times

CLOSE = 1e-12  # of the model's size, B-splines
FORMULA = 1e-9  # of the model's size, by Gauss-Newton with differences
APPROXIMATE = {130: 1e-3, 140: 1e-3}  # no B-splines: our reader fits them
MILLIMETRES = {"m": 1000.0, "cm": 10.0, "mm": 1.0, "um": 1e-3, "inch": 25.4}


def ours_curve(d, factor=1.0):
    points = [times(p, factor) for p in d["points"]]
    n, degree, knots = len(points), d["degree"], d["knots"]
    weights = d["weights"] or [1.0] * n
    return shapes.spline_curve(degree, knots, weights, points, knots[degree], knots[n])


def ours_surface(d, factor):
    (du, dv), (nu, nv) = d["degrees"], d["counts"]
    ku, kv = d["knots_u"], d["knots_v"]
    points = [times(p, factor) for p in d["points"]]
    return shapes.spline_surface(
        du, dv, nu, nv, ku, kv, d["weights"] or [1.0] * len(points), points, (ku[du], ku[nu], kv[dv], kv[nv])
    )


def de_of(entity):
    found = re.search(r"D(\d+)", entity)
    return int(found.group(1)) if found else 0


class Comparison:
    def __init__(self, model, dump):
        self.model, self.dump, self.faults = model, dump, []
        f = model.file
        # Ours in the units of the file's own numbers.
        self.factor = MILLIMETRES[dump["units"]] / (f.millimetres / f.scale)
        self.size = max(
            [1e-300]
            + [
                abs(x) * self.factor
                for p in dump["parts"]
                for face in p["faces"]
                for q in face["surface"]["points"]
                for x in q
            ]
            + [abs(x) * self.factor for c in dump["curves"] for q in c["curve"]["points"] for x in q]
        )
        self.checked = {"faces": 0, "curves": 0, "loops": 0}

    def say(self, text, *values):
        self.faults.append(text.format(*values))

    def near(self, what, distance, share=CLOSE):
        if not distance <= share * self.size:
            self.say("{}: {:.3g} apart, the size is {:.3g}", what, distance, self.size)

    # ---- curves

    def curve(self, what, own, other, share=FORMULA):
        """`other` by the standard, `own` ours."""
        if other.spline and self.same_basis(own, other):
            for i in range(9):
                t = own.t0 + (own.t1 - own.t0) * i / 8
                self.near("%s at %g" % (what, t), norm(minus(own.at(t), other.at(t))))
            return
        self.near(what + ": first point", norm(minus(own.at(own.t0), other.at(other.t0))), share)
        self.near(what + ": last point", norm(minus(own.at(own.t1), other.at(other.t1))), share)
        self.near(what + ": our points", max(other.off(p) for p in own.samples(7)), share)
        self.near(what + ": points", max(own.off(p) for p in other.samples(7)), share)

    @staticmethod
    def same_basis(own, other):
        return own.spline.d == other.spline.d and (own.t0, own.t1) == (other.t0, other.t1)

    def chain(self, what, own, other, share=FORMULA):
        if len(own) == len(other):
            for i, (a, b) in enumerate(zip(own, other)):
                self.curve("%s edge %d" % (what, i), a, b, share)
            return
        own_points = [p for c in own for p in c.samples(5)]
        other_points = [p for c in other for p in c.samples(5)]
        if not own_points or not other_points:
            self.say("{}: {} edges, {} by the standard", what, len(own), len(other))
            return
        self.near(what + ": our points", max(min(c.off(p) for c in other) for p in own_points), share)
        self.near(what + ": points", max(min(c.off(p) for c in own) for p in other_points), share)

    # ---- surfaces

    def surface(self, what, own, samples, other, loops, share):
        for u, v, *rest in samples:
            p = times(rest[:3], self.factor)
            self.near("%s: evaluated at %g, %g" % (what, u, v), norm(minus(p, own.at(u, v))))
        if other.spline:
            self.spline_surface(what, own, samples, other)
            return
        self.near(what + ": our points", max(other.off(times(s[2:5], self.factor)) for s in samples), share)
        if other.is_bounded():
            u0, u1, v0, v1 = other.range
            points = [other.at(u0 + (u1 - u0) * i / 4, v0 + (v1 - v0) * j / 3) for i in range(5) for j in range(4)]
            where = "points"
        else:
            points = [p for loop in loops for c in loop for p in c.samples(4)]
            where = "points of its loops"
        self.near("%s: %s" % (what, where), max([own.nearest(p, 16)[0] for p in points] or [0.0]), share)

    def spline_surface(self, what, own, samples, other):
        a, b = own.spline, other.spline
        if (a.du, a.dv) != (b.du, b.dv) or any(
            abs(x - y) > CLOSE * (1 + abs(y)) for x, y in zip(own.range, other.range)
        ):
            self.say(
                "{}: degrees or range {} {} instead of {} {}", what, (a.du, a.dv), own.range, (b.du, b.dv), other.range
            )
            return
        for u, v, *_ in samples:
            self.near("%s at %g, %g" % (what, u, v), norm(minus(own.at(u, v), other.at(u, v))))
        whole = other.range == (b.ku[b.du], b.ku[b.nu], b.kv[b.dv], b.kv[b.nv])
        if whole and (a.ku, a.kv) != (b.ku, b.kv):
            self.say("{}: other knots", what)
        elif whole and other.place.is_identity() and self.factor == 1 and a.points != b.points:
            self.say("{}: other control points", what)
        elif whole and len(set(b.weights)) > 1 and a.weights != b.weights:
            self.say("{}: other weights", what)

    # ---- faces

    def face(self, own_face, other):
        what = own_face["entity"]
        own = ours_surface(own_face["surface"], self.factor)
        kind = self.model.entities[other.chain[-1]].type
        share = APPROXIMATE.get(kind, FORMULA)
        if kind == 118 and self.model.entities[other.chain[-1]].form == 0:
            share = 1e-6  # by chords, here
        self.surface(what, own, own_face["surface"]["samples"], other.surface, other.loops, share)
        self.side(what, own_face, other)
        loops = own_face["loops"]
        if other.loops and not loops:
            self.natural(what, own, other.loops)
        elif other.outer_is_border and loops:
            self.natural(what, own, [[ours_curve(e["curve"], self.factor) for e in loops[0] if e["curve"]]])
            loops = loops[1:]
        if loops and len(loops) != len(other.loops):
            self.say("{}: {} loops, {} by the standard", what, len(loops), len(other.loops))
        for i, (loop, space) in enumerate(zip(loops, other.loops)):
            name = "%s loop %d" % (what, i)
            curves = [ours_curve(e["curve"], self.factor) for e in loop if e["curve"]]
            if space and curves:
                self.chain(name, curves, space)
            self.flats(name, own, kind, loop, other.flats[i])
            self.closed(name, curves)
            self.checked["loops"] += 1
        self.looks(what, own_face, other)
        self.checked["faces"] += 1

    def natural(self, what, own, loops):
        """Ours says that the loops are no more than the border of the whole surface."""
        u0, u1, v0, v1 = own.range
        sides = [shapes.Curve(lambda t, u=u: own.at(u, t), v0, v1) for u in (u0, u1)]
        sides += [shapes.Curve(lambda t, v=v: own.at(t, v), u0, u1) for v in (v0, v1)]
        curves = [c for loop in loops for c in loop]
        near = max(1e-5 * self.size, self.model.file.resolution)
        for p in (p for c in curves for p in c.samples(7)):
            if min(side.off(p) for side in sides) > near:
                self.say("{}: a loop inside the surface is missing", what)
                return
        for i, side in enumerate(sides):
            points = side.samples(7)
            partner = sides[i ^ 1].samples(7)
            is_seam = max(norm(minus(p, q)) for p, q in zip(points, partner)) <= near
            is_pole = max(norm(minus(p, points[0])) for p in points) <= near
            if not is_seam and not is_pole and max(min(c.off(p) for c in curves) for p in points) > near:
                self.say("{}: a side of the surface is no border of the face", what)

    def closed(self, what, curves):
        for a, b in zip(curves, curves[1:] + curves[:1]):
            gap = norm(minus(a.at(a.t1), b.at(b.t0)))
            if gap > max(1e-6 * self.size, 2 * self.model.file.resolution):
                self.say("{}: edges that do not meet by {:.3g}", what, gap)

    def flats(self, what, own, kind, loop, flats):
        u0, u1, v0, v1 = own.range
        for i, e in enumerate(loop):
            if not e["flat"]:
                continue
            flat = ours_curve(e["flat"])
            places = [flat.at(flat.t0 + (flat.t1 - flat.t0) * k / 6) for k in range(7)]
            width = max(u1 - u0, v1 - v0)
            if any(
                not (u0 - 1e-6 * width <= u <= u1 + 1e-6 * width and v0 - 1e-6 * width <= v <= v1 + 1e-6 * width)
                for u, v, _ in places
            ):
                self.say("{} edge {}: its parameters leave the surface", what, i)
                continue
            if e["curve"]:
                space = ours_curve(e["curve"], self.factor)
                ends = (space.at(space.t0), space.at(space.t1))
                for p, (u, v, _) in zip(ends, (places[0], places[-1])):
                    gap = norm(minus(p, own.at(min(max(u, u0), u1), min(max(v, v0), v1))))
                    if gap > max(1e-4 * self.size, self.model.file.resolution):
                        self.say("{} edge {}: the curves in space and parameters end {:.3g} apart", what, i, gap)
        if flats and kind == 128 and all(e["flat"] for e in loop) and len(flats) == len(loop):
            for i, (e, flat) in enumerate(zip(loop, flats)):
                ours = ours_curve(e["flat"])
                for t in (0, 0.5, 1) if flat.spline else (0, 1):
                    a = ours.at(ours.t0 + (ours.t1 - ours.t0) * t)
                    b = flat.at(flat.t0 + (flat.t1 - flat.t0) * t)
                    if norm(minus(a[:2], b[:2])) > 1e-9 * (1 + norm(b[:2])):
                        self.say("{} edge {}: parameters {} instead of {}", what, i, a[:2], b[:2])

    def side(self, what, own_face, other):
        """Do the outsides agree?"""
        for s in own_face["surface"]["samples"][5:]:
            p, n = times(s[2:5], self.factor), s[5:8]
            m = cross(*other.surface.slopes(s[0], s[1])) if other.surface.spline else other.surface.normal(p)
            if norm(n) < 1e-9 * self.size * self.size or norm(m) < 1e-12:
                continue
            if (dot(n, m) < 0) != (own_face["reversed"] != other.reversed):
                self.say("{}: outside and inside are exchanged", what)
            return

    # ---- names, colours, levels, groups

    def looks(self, what, own, other):
        model, e = self.model, other.entity
        chain = [model.entities[de] for de in other.chain]
        name = model.name(e)
        names = {model.name(c) for c in chain} | {model.label(c) for c in chain} | {c.label for c in chain} | {""}
        names |= {model.name(g) for g, members in model.groups() if e.de in members}
        if (name and own["name"] != name) or own["name"] not in names:
            self.say("{}: name {!r} instead of {!r}", what, own["name"], name)
        colors = [model.color(c) for c in [e, *chain]]
        colors = [c for c in colors if c]
        wanted = [round(2.55 * p) for p in colors[0]] if colors else None
        mine = own["color"]
        if (mine is None) != (wanted is None) or (mine and max(abs(a - b) for a, b in zip(mine, wanted)) > 1):
            if model.color(e) or mine is not None:
                self.say("{}: colour {} instead of {}", what, mine, wanted)
        if own["level"] not in {model.level(c) for c in [e, *chain]}:
            self.say("{}: level {} instead of {}", what, own["level"], model.level(e))

    def parts(self):
        """Every face of theirs is one of ours, in parts of the same kind."""
        left = [(f, part) for part in self.model.parts for f in part.faces]
        for own_part in self.dump["parts"]:
            found = []
            for own in own_part["faces"]:
                de = de_of(own["entity"])
                fits = [x for x in left if de in x[0].chain or de == x[0].entity.de]
                if not fits:
                    self.say("{}: a face that is not in the file, or there twice", own["entity"])
                    continue
                best = fits[0] if len(fits) == 1 else min(fits, key=lambda x: self.misfit(own, x[0]))
                left.remove(best)
                self.face(own, best[0])
                found.append(best[1])
            self.part(own_part, found)
        for f, _ in left:
            self.say("{}: a face that ours has not", f.entity.what)

    def misfit(self, own, other):
        samples = own["surface"]["samples"]
        if other.surface.is_bounded() and other.surface.spline:
            return sum(norm(minus(times(s[2:5], self.factor), other.surface.at(s[0], s[1]))) for s in samples[6:9])
        return sum(other.surface.off(times(s[2:5], self.factor)) for s in samples[6:9])

    def part(self, own, found):
        if not found:
            return
        if {p.kind for p in found} != {own["kind"]}:
            self.say("{}: a part of kind {} instead of {}", own["entity"], own["kind"], {p.kind for p in found})
        home = found[0].entity
        if own["kind"] == "surfaces" and (len(found) > 1 or de_of(own["entity"]) != home.de):
            members = {p.entity.de for p in found}
            groups = [g for g, m in self.model.groups() if members <= set(m)]
            if not groups:
                self.say("{}: a part of faces that no group of the file holds", own["entity"])
                return
            home = groups[0]
        elif len({id(p) for p in found}) != 1:
            self.say("{}: faces of several solids or shells", own["entity"])
        if de_of(own["entity"]) != home.de:
            self.say("{}: a part that is {}", own["entity"], home.what)
        self.own_looks(own, home)

    def own_looks(self, own, e):
        """What the entity itself says of its name, colour and level."""
        name, color = self.model.name(e), self.model.color(e)
        if name and own["name"] != name:
            self.say("{}: name {!r} instead of {!r}", own["entity"], own["name"], name)
        if color and (not own["color"] or max(abs(a - 2.55 * b) for a, b in zip(own["color"], color)) > 1):
            self.say("{}: colour {} instead of {}", own["entity"], own["color"], color)
        if own["level"] != self.model.level(e):
            self.say("{}: level {} instead of {}", own["entity"], own["level"], self.model.level(e))

    def curves(self):
        left = list(self.model.curves)
        own_left = []
        for own in self.dump["curves"]:
            de = de_of(own["entity"])
            mine = ours_curve(own["curve"], self.factor)
            fits = [c for c in left if c.entity.de == de]
            if not fits:
                own_left.append(own["entity"])
                continue
            other = min(fits, key=lambda c: norm(minus(c.at(c.t0), mine.at(mine.t0))))
            if len(fits) > 1 and other.entity.type == 102 and self.is_joined(mine, fits):
                for c in fits:
                    left.remove(c)
            else:
                left.remove(other)
                self.curve(own["entity"], mine, other, APPROXIMATE.get(other.entity.type, FORMULA))
            self.own_looks(own, other.entity)
            self.checked["curves"] += 1
        for entity in own_left:
            self.say("{}: a curve that is not in the file, or there twice", entity)
        for c in left:
            self.say("{}: a curve that ours has not", c.entity.what)

    def is_joined(self, mine, pieces):
        """A composite as one B-spline."""
        if len([c for c in self.dump["curves"] if de_of(c["entity"]) == pieces[0].entity.de]) > 1:
            return False
        self.near("%s: points" % pieces[0].entity.what, max(mine.off(p) for c in pieces for p in c.samples(5)), FORMULA)
        self.near(
            "%s: our points" % pieces[0].entity.what,
            max(min(c.off(p) for c in pieces) for p in mine.samples(9)),
            FORMULA,
        )
        return True

    def header(self):
        f = self.model.file
        if self.dump["date"] and f.date[-15:] != self.dump["date"] and f.date[-13:] != self.dump["date"][2:]:
            self.say("date {!r} instead of {!r}", self.dump["date"], f.date)
        counts = {int(re.match(r"\d+", k).group()): v for k, v in self.dump["entities"].items()}
        if counts != self.model.counts():
            self.say("entities {} instead of {}", counts, self.model.counts())

    def run(self):
        self.header()
        self.parts()
        self.curves()
        return self.faults


def seen(model):
    """What the second reader sees, as plain data."""

    def curve(c):
        return {"samples": c.samples(5)}

    def face(f):
        s = f.surface
        u0, u1, v0, v1 = s.range
        return {
            "chain": f.chain,
            "range": s.range,
            "reversed": f.reversed,
            "name": model.name(f.entity),
            "color": model.color(f.entity),
            "level": model.level(f.entity),
            "samples": [s.at(u0 + (u1 - u0) * i / 4, v0 + (v1 - v0) * j / 3) for i in range(5) for j in range(4)]
            if s.is_bounded()
            else [],
            "loops": [[curve(c) for c in loop] for loop in f.loops],
        }

    return {
        "unit_mm": model.file.millimetres,
        "scale": model.file.scale,
        "entities": model.counts(),
        "parts": [{"kind": p.kind, "de": p.entity.de, "faces": [face(f) for f in p.faces]} for p in model.parts],
        "curves": [{"de": c.entity.de, **curve(c)} for c in model.curves],
        "groups": [{"de": g.de, "name": model.name(g), "members": m} for g, m in model.groups()],
    }


def main():
    try:
        with open(sys.argv[1], "rb") as file:
            model = Model(file.read())
    except Fault as fault:
        print("%s: %s" % (sys.argv[1], fault))
        return 2
    if len(sys.argv) < 3:
        json.dump(seen(model), sys.stdout, indent=1)
        print()
        return 0
    with open(sys.argv[2], encoding="utf-8") as file:
        comparison = Comparison(model, json.load(file))
    faults = comparison.run()
    for fault in faults:
        print(fault)
    if not faults:
        print("%s: agreed; %s" % (sys.argv[1], ", ".join("%d %s" % (n, k) for k, n in comparison.checked.items())))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
