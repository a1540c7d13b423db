"""Nastran bulk data: small fields of 8 columns, large ones of 16, and the sets and subcases of the case control."""

import re

import numpy as np

from model import Model, isotropic


def real(field):
    """A point is there, a letter before the exponent need not be."""
    assert "." in field, field
    return float(re.sub(r"(?<=[0-9.])([+-])", r"e\1", field))


def cards_of(lines):
    cards = []
    for line in lines:
        if line.startswith("$") or not line.strip():
            continue
        name = line[:8].strip()
        wide = name.endswith("*")
        width, count = (16, 4) if wide else (8, 8)
        assert line[8 + width * count :].strip() in ("", "+"), line
        fields = [line[8 + k * width : 8 + (k + 1) * width].strip() for k in range(count)]
        if name in ("", "*", "+"):
            cards[-1][1].extend(fields)
        else:
            cards.append((name.rstrip("*"), fields))
    return cards


def read(path):
    model = Model()
    lines = open(path).read().split("\n")
    bulk = lines.index("BEGIN BULK")
    names, sets, subcases = {}, {}, []
    held, kind = "", None
    for line in lines[:bulk]:
        assert len(line) <= 80
        if line in ("$ Of elements:", "$ Of nodes:"):
            kind = model.element_sets if "elements" in line else model.node_sets
        if line.startswith("$ SET"):
            _, _, number, _, name = line.split(maxsplit=4)
            names[int(number)] = (name, kind)
            continue
        line = held + line.strip()
        held = line if line.endswith(",") else ""
        if held:
            continue
        words = line.replace("=", " ").split()
        if line.startswith("SET "):
            _, _, members = line.partition("=")
            if "THRU" in members:
                low, high = map(int, members.split("THRU"))
                sets[int(words[1])] = list(range(low, high + 1))
            else:
                sets[int(words[1])] = sorted(map(int, members.split(",")))
        elif line.startswith("SUBCASE"):
            subcases.append({})
        elif line.startswith("SPC ") or line.startswith("TEMPERATURE(LOAD)"):
            subcases[-1][words[0]] = int(words[1])
    materials, properties, systems, prop_of = {}, {}, {}, {}
    spcs, temperatures = {}, {}
    for name, fields in cards_of(lines[bulk + 1 :]):
        if name == "GRID":
            model.nodes[int(fields[0])] = tuple(map(real, fields[2:5]))
        elif name in ("CTETRA", "CHEXA"):
            model.elements[int(fields[0])] = tuple(int(field) for field in fields[2:] if field)
            prop_of[int(fields[0])] = int(fields[1])
        elif name == "PSOLID":
            properties[int(fields[0])] = (int(fields[1]), int(fields[2]))
        elif name == "CORD2R":
            origin, on_z, in_xz = (np.array(list(map(real, fields[k : k + 3]))) for k in (2, 5, 8))
            z = (on_z - origin) / np.linalg.norm(on_z - origin)
            y = np.cross(z, in_xz - origin)
            y /= np.linalg.norm(y)
            systems[int(fields[0])] = np.array([np.cross(y, z), y, z])
        elif name == "MAT1":
            fields += [""] * 8
            expansion = (real(fields[5]),) * 3 if fields[5] else None
            materials[int(fields[0])] = isotropic(
                real(fields[1]), real(fields[3]), real(fields[4]) if fields[4] else None, expansion
            )
        elif name == "MAT9":
            g = np.zeros((6, 6))
            g[np.triu_indices(6)] = list(map(real, fields[1:22]))
            g = g + g.T - np.diag(np.diag(g))
            order = [0, 1, 2, 3, 5, 4]  # from xx yy zz xy yz zx
            expansion = tuple(map(real, fields[23:26]))
            materials[int(fields[0])] = (
                np.linalg.inv(g)[np.ix_(order, order)],
                real(fields[22]) if fields[22] else None,
                expansion,
            )
        elif name == "MPC":
            terms, at = [], 1
            while at < len(fields):
                for k in (at, at + 3):
                    if k < len(fields) and fields[k]:
                        terms.append((int(fields[k]), int(fields[k + 1]), real(fields[k + 2])))
                at += 8
            model.equations.append(terms)
        elif name == "SPC":
            spcs.setdefault(int(fields[0]), {})[int(fields[1])] = real(fields[3])
        elif name == "TEMPD":
            temperatures[int(fields[0])] = real(fields[1])
    for element, prop in prop_of.items():
        material, system = properties[prop]
        model.material[element] = materials[material]
        if system:
            model.axes[element] = systems[system]
    for number, members in sets.items():
        name, kind = names[number]
        if name != "the drivers":
            kind[name.upper()] = members
    model.loads = [(spcs[case["SPC"]], temperatures.get(case.get("TEMPERATURE(LOAD)"), 0.0)) for case in subcases]
    return model
