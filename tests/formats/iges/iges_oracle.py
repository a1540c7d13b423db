#!/usr/bin/env python3
"""An independent judge of IGES 5.3 files: its own parser (iges_file.py) and its own B-spline evaluator
(bspline.py), in the standard library only. It shares nothing with the program that it judges.

    iges_oracle.py FILE.igs [MODEL]

checks everything that the file says about itself (lines, sequence numbers, counts, pointers, strings, flags,
topology) and, with MODEL (written by files.cpp from the geometry in memory), that the file says the same
as the model, with numbers equal to the last bit. Prints one line and exits with 0, or names the first
fault and exits with 1.
"""

import math
import sys

from bspline import cross, distance_to, flux, minus, planar_flux
from iges_file import UNITS, Fault, check_pointers, curves_of, need, parse_directory, parse_global, read_entity
from iges_file import split_sections

FEW_ULPS = 64 * 2.0**-52
ROLES = ["warp", "weft", "wale", "course", "braider", "axial", "binder", "other"]
PIECE_LEVEL = len(ROLES) + 1


# ---- what the entities say together -----------------------------------------------------------------------


def check_trimmed(e, entities):
    boundary = entities[e.outer]
    flats, spaces = (curves_of(entities[of], entities) for of in (boundary.flat, boundary.space))
    need(boundary.on == e.on, "{}: bounded by a curve on another surface", e.what)
    need(len(flats) == len(spaces), "{}: boundaries of {} and {} parts", e.what, len(flats), len(spaces))
    for curves in (flats, spaces):
        need(curves[0].points[0] == curves[-1].points[-1], "{}: boundary is open", e.what)
    for flat, space in zip(flats, spaces):
        check_flat(e, entities[e.on], flat, space)


def check_flat(e, on, flat, space):
    """A curve in a surface's parameters is the one in space, with the same parameter, inside the surface."""
    u0, u1, v0, v1 = on.range
    for i in range(33):
        t = flat.low() + (flat.high() - flat.low()) * i / 32
        x, y, z = flat.at(t)[0]
        need(z == 0, "{}: parameter curve leaves its plane", e.what)
        need(u0 < x < u1 and v0 < y < v1, "{}: parameter curve leaves the surface", e.what)
        gap = math.hypot(*minus(on.surface.at(x, y)[0], space.at(t)[0]))
        need(gap <= FEW_ULPS * space_size(space), "{}: the two boundary curves are {} apart", e.what, gap)


def check_piece(group, entities):
    """A garment piece: one trimmed plane, then the curves of its outline, each with a name of its own."""
    face, *edges = [entities[m] for m in group.members]
    need(face.type == 144 and all(e.type == 126 for e in edges), "{}: members", group.what)
    outline = curves_of(entities[entities[face.outer].space], entities)
    need([e.curve.points for e in edges] == [c.points for c in outline], "{}: curves beside the outline", group.what)
    need(group.level == PIECE_LEVEL and all(e.level == PIECE_LEVEL for e in edges), "{}: level", group.what)
    for e in edges:
        need(len(e.properties) == 1 and entities[e.properties[0]].form == 15, "{}: name", e.what)
        need(e.label == entities[e.properties[0]].name[:8].strip(), "{}: label", e.what)


def space_size(curve):
    return max(max(map(abs, p)) for p in curve.points)


def check_solid(solid, entities):
    """Closed loops; every edge twice, once each way; edges on their surfaces. Returns the volume."""
    shell = entities[solid.shell]
    used, vertices, volume = {}, set(), 0.0
    for face_pointer, outward in shell.faces:
        face = entities[face_pointer]
        loop = entities[face.loop]
        surface = entities[face.on].surface
        chain, outlines = [], []
        for kind, list_pointer, index, forward in loop.uses:
            if kind == 1:
                vertices.add((list_pointer, index))
                chain.append(((list_pointer, index),) * 2)
                continue
            edges = entities[list_pointer].edges
            need(1 <= index <= len(edges), "{}: edge {}", loop.what, index)
            curve, a, b = edges[index - 1]
            chain.append((a, b) if forward else (b, a))
            vertices.update((a, b))
            used.setdefault((list_pointer, index), []).append(forward == outward)
            outlines.append(entities[curve].curve)
        need((surface.du, surface.dv) == (1, 1) or not any(loop.flats), "{}: curves in parameters", loop.what)
        for (_, a), (b, _) in zip(chain, chain[1:] + chain[:1]):
            need(a == b, "{}: the loop is not closed", loop.what)
        for curve in outlines:
            for i in (1, 3, 7):
                t = curve.low() + (curve.high() - curve.low()) * i / 8
                gap = distance_to(surface, curve.at(t)[0])
                need(gap <= 1e-9 * surface.size(), "{}: an edge is {} off its surface", face.what, gap)
        if (surface.du, surface.dv) == (1, 1):
            _, s_u, s_v = surface.at(surface.ku[1], surface.kv[1])
            normal = cross(s_u, s_v)
            length = math.hypot(*normal)
            need(len(outlines) == 1, "{}: plane with {} edges", face.what, len(outlines))
            need(
                len(loop.flats[0]) == 1 and loop.uses[0][3] == 1,
                "{}: plane without a curve in its parameters",
                face.what,
            )
            check_flat(loop, entities[face.on], entities[loop.flats[0][0]].curve, outlines[0])
            part = planar_flux(outlines[0], tuple(x / length for x in normal))
        else:
            part = flux(surface)
        volume += part if outward else -part
    lists = {pointer for pointer, _ in used}
    count = sum(len(entities[p].edges) for p in lists)
    need(len(used) == count, "{}: edges that no loop uses", solid.what)
    for (list_pointer, index), ways in used.items():
        need(sorted(ways) == [False, True], "{}: edge {} is used {} times", solid.what, index, ways)
        curve, *ends = entities[list_pointer].edges[index - 1]
        c = entities[curve].curve
        for (vertex_list, v), t in zip(ends, (c.low(), c.high())):
            points = entities[vertex_list].vertices
            need(1 <= v <= len(points), "{}: vertex {}", solid.what, v)
            gap = math.hypot(*minus(points[v - 1], c.at(t)[0]))
            need(gap <= FEW_ULPS * space_size(c), "{}: a vertex is {} off its edge", solid.what, gap)
    need(all(len(entities[p].vertices) <= len(vertices) for p, _ in vertices), "{}: stray vertices", solid.what)
    ring = len(shell.faces) == 1
    need(len(vertices) - count + len(shell.faces) == (0 if ring else 2), "{}: Euler's number", solid.what)
    return volume


# ---- the model --------------------------------------------------------------------------------------------


def read_model(path):
    model = {"bodies": []}
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            word, _, rest = line.rstrip("\n").partition(" ")
            parts = rest.split()
            if word in ("file", "title", "units", "time"):
                model[word] = rest
            elif word in ("solid", "largest"):
                model[word] = float.fromhex(rest)
            elif word == "body":
                body = {"name": rest, "surfaces": [], "outlines": []}
                model["bodies"].append(body)
            elif word in ("role", "start", "end"):
                body[word] = rest
            elif word == "color":
                body[word] = [int(p) for p in parts]
            elif word in ("ring", "inward"):
                body[word] = rest == "1"
            elif word == "volume":
                body[word] = float.fromhex(rest)
            elif word == "surface":
                shape = {"kind": parts[0], "counts": [int(p) for p in parts[1:]], "samples": []}
                body["surfaces"].append(shape)
            elif word == "outline":
                shape = {"counts": [int(p) for p in parts], "samples": []}
                body["outlines"].append(shape)
            elif word == "sample":
                shape["samples"].append([float.fromhex(p) for p in parts])
            else:
                shape[word] = [float.fromhex(p) for p in parts]
    return model


def bits(values):
    return [v.hex() for v in values]


def compare_shape(what, own, shape, keys):
    """Counts, knots, weights and points of an entity against the model's, to the last bit, signs of 0 too."""
    counts, knots = keys
    need(counts == shape["counts"], "{}: counts {} instead of {}", what, counts, shape["counts"])
    for name, values in knots.items():
        need(bits(values) == bits(shape[name]), "{}: {} differ from the model's", what, name)
    need(bits(own.weights) == bits(shape["weights"] or [1.0] * len(own.weights)), "{}: weights differ", what)
    flat = [x for p in own.points for x in p]
    for i, (a, b) in enumerate(zip(bits(flat), bits(shape["points"]))):
        need(a == b, "{}: coordinate {} of point {} is {} instead of {}", what, i % 3, i // 3, a, b)
    need(len(flat) == len(shape["points"]), "{}: number of points", what)
    for *place, x, y, z in shape["samples"]:
        gap = math.hypot(*minus(own.at(*place)[0], (x, y, z)))
        size = max(map(abs, shape["points"]))
        need(gap <= FEW_ULPS * size, "{}: at {} evaluated {} away from the model", what, place, gap)


def compare_surface(e, shape):
    s = e.surface
    compare_shape(e.what, s, shape, ([s.du, s.dv, s.nu, s.nv], {"knots_u": s.ku, "knots_v": s.kv}))


def compare_curve(e, shape):
    c = e.curve
    compare_shape(e.what, c, shape, ([c.d, c.n], {"knots": c.k}))


def compare_faces(body, faces, entities):
    """The yarn's faces in their order: body, start, end."""
    surfaces, outlines = iter(body["surfaces"]), iter(body["outlines"])
    compare_surface(faces[0], next(surfaces))
    at = 1
    for style in () if body["ring"] else (body["start"], body["end"]):
        if style == "none":
            continue
        face = faces[at]
        at += 1
        if style == "planar":
            outline = next(outlines)
            if face.type == 144:
                compare_curve(entities[entities[face.outer].space], outline)
        else:
            need(face.type == 128, "{}: a {} end is not a 128", face.what, style)
            compare_surface(face, next(surfaces))
    need(at == len(faces), "{} faces instead of {}", len(faces), at)


def without_unicode(text):
    return "".join(c if " " <= c <= "~" else "_" for c in text)


def compare_look(e, body, entities):
    for sub, de in (("name", e.properties),):
        need(len(de) == 1 and entities[de[0]].form == 15, "{}: {} property", e.what, sub)
    name = without_unicode(body["name"])
    need(entities[e.properties[0]].name == name, "{}: name {!r}", e.what, entities[e.properties[0]].name)
    need(e.label == name[:8].strip(), "{}: label {!r}", e.what, e.label)
    color = [round(p * 2.55) for p in entities[-e.color].percent]
    need(color == body["color"], "{}: colour {}", e.what, color)
    need(e.level == ROLES.index(body["role"]) + 1, "{}: level {}", e.what, e.level)


def compare(entities, g, sections, model):
    need((g["flag"], g["units"]) == UNITS[model["units"]], "units {}", g["units"])
    need(g["time"] == g["changed"] == model["time"], "time {}", g["time"])
    need(g["file"] == without_unicode(model["file"]), "file name {!r}", g["file"])
    title = without_unicode(model["title"])
    need(g["product"] == g["receiver"] == (title or g["file"]), "product {!r}", g["product"])
    need(title in "".join(line[:72] for line in sections["S"]), "the title is not in the start section")
    need(g["largest"] >= model["largest"], "a coordinate passes the bound {}", g["largest"])
    need(g["largest"] <= model["largest"] * 1.5, "the bound {} is far from the truth", g["largest"])
    colors = [tuple(e.percent) for e in entities.values() if e.type == 314]
    need(len(set(colors)) == len(colors), "a colour is there twice")
    levels = {e.level: e.name for e in entities.values() if (e.type, e.form) == (406, 3)}
    need(all(ROLES[level - 1] == name for level, name in levels.items()), "levels {}", levels)
    roles = {b["role"] for b in model["bodies"]}
    need({levels.get(ROLES.index(role) + 1) for role in roles} == roles, "levels without a name")
    heads = [e for e in entities.values() if e.type == (186 if model["solid"] else 402)]
    need(len(heads) == len(model["bodies"]), "{} yarns instead of {}", len(heads), len(model["bodies"]))
    for head, body in zip(heads, model["bodies"]):
        compare_look(head, body, entities)
        if model["solid"]:
            shell = entities[head.shell]
            faces = [entities[entities[f].on] for f, _ in shell.faces]
            compare_faces(body, faces, entities)
            volume = check_solid(head, entities)
            # Gauss's rule is exact for the polynomial surfaces only.
            close = 1e-9 if all(f.flags[2] == 1 for f in faces) else 1e-6
            need(
                abs(volume - body["volume"]) <= close * body["volume"],
                "{}: volume {} of {}",
                head.what,
                volume,
                body["volume"],
            )
        else:
            # The entities' own order, not the group's.
            faces = [entities[m] for m in sorted(head.members)]
            need(len(set(head.members)) == len(head.members), "{}: a member twice", head.what)
            for face in faces:
                compare_look(face, body, entities)
            compare_faces(body, faces, entities)
    if not model["solid"]:
        grouped = [m for h in heads for m in h.members]
        alone = [e.de for e in entities.values() if e.type in (128, 144) and e.status[2:4] == "00"]
        need(sorted(grouped) == alone, "faces outside the groups")


def check(path, model_path=None):
    with open(path, "rb") as file:
        sections = split_sections(file.read())
    g = parse_global(sections["G"])
    entities = parse_directory(sections)
    for e in entities.values():
        read_entity(e)
    check_pointers(entities)
    for e in entities.values():
        if e.type == 144:
            check_trimmed(e, entities)
        if e.type == 402 and any(entities[m].type == 126 for m in e.members):
            check_piece(e, entities)
    points = [x for e in entities.values() if e.type == 128 for p in e.surface.points for x in p]
    need(all(abs(x) <= g["largest"] for x in points), "a coordinate passes the bound {}", g["largest"])
    if model_path:
        compare(entities, g, sections, read_model(model_path))
    elif any(e.type == 186 for e in entities.values()):
        for e in entities.values():
            if e.type == 186:
                need(check_solid(e, entities) > 0, "{}: inside out", e.what)
    return entities


def main():
    try:
        entities = check(*sys.argv[1:3])
    except Fault as fault:
        print("%s: %s" % (sys.argv[1], fault))
        return 1
    counts = {}
    for e in entities.values():
        counts[e.type] = counts.get(e.type, 0) + 1
    print("%s: right; %s" % (sys.argv[1], ", ".join("%d x %d" % (n, t) for t, n in sorted(counts.items()))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
