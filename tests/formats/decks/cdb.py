"""ANSYS archive (CDREAD): NBLOCK, EBLOCK and CMBLOCK by their columns, the rest as commands."""

import re

import numpy as np

from model import Model, constants, in_space, isotropic


def fields_of(line, width, count):
    line = line.rstrip("\n")
    return [line[i * width : (i + 1) * width] for i in range(count) if line[i * width : (i + 1) * width].strip()]


def axes_of(xy, yz, zx):
    """LOCAL: turns about z, then the new x, then the new y; columns of the product are the axes."""
    a, b, c = np.radians([xy, yz, zx])
    about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    about_x = np.array([[1, 0, 0], [0, np.cos(b), -np.sin(b)], [0, np.sin(b), np.cos(b)]])
    about_y = np.array([[np.cos(c), 0, np.sin(c)], [0, 1, 0], [-np.sin(c), 0, np.cos(c)]])
    return (about_z @ about_x @ about_y).T


def read(path):
    model = Model()
    lines = open(path).read().split("\n")
    materials, locals_, types, of_element, equations = {}, {}, {}, {}, {}
    at = 0
    while at < len(lines):
        line = lines[at].split("!")[0].strip()
        words = [word.strip() for word in line.split(",")]
        command = words[0].upper()
        at += 1
        if command == "NBLOCK":
            integers, width, real = map(int, re.fullmatch(r"\((\d+)i(\d+),6e(\d+)\.13e3\)", lines[at].strip()).groups())
            at += 1
            while not lines[at].startswith("N,R5.3,LOC"):
                row = lines[at]
                number = int(row[:width])
                start = integers * width
                model.nodes[number] = tuple(float(row[start + k * real : start + (k + 1) * real]) for k in range(3))
                at += 1
            assert len(model.nodes) == int(words[4]) and max(model.nodes) == int(words[3])
        elif command == "EBLOCK":
            assert lines[at].strip() == "(19i10)"
            at += 1
            count = 0
            while lines[at].strip() != "-1":
                head = [int(field) for field in fields_of(lines[at], 10, 19)]
                at += 1
                nodes = head[11:]
                if len(nodes) < head[8]:
                    nodes += [int(field) for field in fields_of(lines[at], 10, 19)]
                    at += 1
                assert len(nodes) == head[8]
                count += 1
                if types[head[1]] != 21:
                    model.elements[head[10]] = tuple(nodes)
                    of_element[head[10]] = (head[0], head[4])
            assert count == int(words[4])
        elif command == "CMBLOCK":
            assert lines[at].strip() == "(8i10)" and words[1].upper() != "ALL" and len(words[1]) <= 32
            at += 1
            members = []
            while len(members) < int(words[3]):
                members += [int(field) for field in fields_of(lines[at], 10, 8)]
                at += 1
            sets = model.node_sets if words[2].startswith("NODE") else model.element_sets
            sets["ALL" if words[1].upper() == "ALLELEMENTS" else words[1].upper()] = sorted(members)
        elif command == "ET":
            types[int(words[1])] = int(words[2])
        elif command == "MP":
            materials.setdefault(int(words[2]), {})[words[1].upper()] = float(words[3])
        elif command == "LOCAL":
            locals_[int(words[1])] = axes_of(*map(float, words[6:9]))
        elif command == "CE":
            terms = equations.setdefault(int(words[1]), [])
            assert float(words[2]) == 0 and len(words) <= 12
            for k in range(3, len(words), 3):
                terms.append((int(words[k]), 1 + ["UX", "UY", "UZ"].index(words[k + 1]), float(words[k + 2])))
    model.equations = [equations[number] for number in sorted(equations)]
    known = {}
    for number, m in materials.items():
        expansion = (
            in_space(tuple(m[name] for name in ("ALPX", "ALPY", "ALPZ") if name in m), "EY" not in m)
            if "ALPX" in m
            else None
        )
        if "EY" in m:
            known[number] = constants(
                m["EX"],
                m["EY"],
                m["EZ"],
                m["PRXY"],
                m["PRXZ"],
                m["PRYZ"],
                m["GXY"],
                m["GXZ"],
                m["GYZ"],
                m.get("DENS"),
                expansion,
            )
        else:
            known[number] = isotropic(m["EX"], m["PRXY"], m.get("DENS"), expansion)
    for element, (material, system) in of_element.items():
        model.material[element] = known[material]
        if system:
            model.axes[element] = locals_[system]
    return model


def read_macro(path):
    """The load cases of the macro: displacements UX of nodes and the uniform temperature at each SOLVE."""
    loads, values, temperature = [], {}, 0.0
    for line in open(path):
        words = [word.strip() for word in line.split("!")[0].split(",")]
        if words[0] == "D" and words[2] == "UX" and len(words) == 4:
            values[int(words[1])] = float(words[3])
        elif words[0] == "DDELE":
            values.pop(int(words[1]), None)
        elif words[0] == "TUNIF":
            temperature = float(words[1])
        elif words[0] == "SOLVE":
            loads.append((dict(values), temperature))
    return loads
