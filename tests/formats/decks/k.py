"""LS-DYNA keyword file in standard format: columns of 8, 10 and 16."""

from model import Model, constants, in_space, isotropic, right_handed


IN_CASES = ("*BOUNDARY_SPC_NODE", "*BOUNDARY_PRESCRIBED_MOTION_NODE", "*DEFINE_CURVE", "*LOAD_THERMAL_LOAD_CURVE")


def columns(line, *widths):
    fields, at = [], 0
    for width in widths:
        fields.append(line[at : at + width].strip())
        at += width
    assert not line[at:].strip(), line
    return fields


def read(path):
    model = Model()
    blocks = []
    for line in open(path):
        line = line.rstrip("\n")
        if line.startswith("$"):
            continue
        if line.startswith("*"):
            blocks.append((line.strip(), []))
        else:
            blocks[-1][1].append(line)
    materials, parts, expansions, part_of = {}, {}, {}, {}
    part_sets = {}
    cases, open_case, curves = (
        {},
        None,
        {},
    )  # cases: of each number its drivers' values and the end of its curve of temperature
    for keyword, rows in blocks:
        assert open_case is None or keyword in IN_CASES or keyword == f"*CASE_END_{open_case}", keyword
        if keyword == "*NODE":
            for row in rows:
                number, *at = columns(row, 8, 16, 16, 16)
                model.nodes[int(number)] = tuple(map(float, at))
        elif keyword == "*PART":
            part, _, material = map(int, columns(rows[1], 10, 10, 10))
            parts[part] = material
        elif keyword == "*MAT_ELASTIC_TITLE":
            number, density, e, nu = columns(rows[1], 10, 10, 10, 10)
            materials[int(number)] = ("isotropic", float(density), float(e), float(nu))
        elif keyword == "*MAT_ORTHOTROPIC_ELASTIC_TITLE":
            number, density, ea, eb, ec, ba, ca, cb = columns(rows[1], *[10] * 8)
            ab, bc, ca_shear, choice = map(float, columns(rows[2], *[10] * 4))
            assert choice == 2
            ea, eb, ec, ba, ca, cb = map(float, (ea, eb, ec, ba, ca, cb))
            materials[int(number)] = (
                "orthotropic",
                float(density),
                ea,
                eb,
                ec,
                ba * ea / eb,
                ca * ea / ec,
                cb * eb / ec,
                ab,
                ca_shear,
                bc,
            )
        elif keyword == "*MAT_ADD_THERMAL_EXPANSION":
            fields = columns(rows[0], *[10] * 7)
            expansions[int(fields[0])] = tuple(float(fields[k]) for k in (2, 4, 6) if fields[k].strip())
        elif keyword in ("*ELEMENT_SOLID", "*ELEMENT_SOLID_ORTHO"):
            at = 0
            while at < len(rows):
                head = [int(field) for field in columns(rows[at], *[8] * 10) if field]
                at += 1
                if len(head) == 2:  # two lines: the nodes on their own
                    nodes = [int(field) for field in columns(rows[at], *[8] * 10)]
                    at += 1
                else:
                    nodes = head[2:]
                    if nodes[3] == nodes[7]:
                        assert len(set(nodes[3:])) == 1
                        nodes = nodes[:4]
                model.elements[head[0]] = tuple(nodes)
                part_of[head[0]] = head[1]
                if keyword.endswith("ORTHO"):
                    a, d = ([float(field) for field in columns(rows[at + k], 16, 16, 16)] for k in (0, 1))
                    model.axes[head[0]] = right_handed(a, d)
                    at += 2
        elif keyword in ("*SET_NODE_LIST_TITLE", "*SET_PART_LIST_TITLE"):
            members = [int(field) for row in rows[2:] for field in columns(row, *[10] * 8) if field]
            (part_sets if "PART" in keyword else model.node_sets)[rows[0].strip().upper()] = sorted(members)
        elif keyword == "*CASE":
            number, name = columns(rows[0], 10, 10)
            assert name == f"case{number}" and rows[1:] == [
                "",
                f"{number:>10}",
            ]  # no commands of its own; the one identifier
            cases[int(number)] = ({}, 0.0)
        elif keyword.startswith("*CASE_BEGIN_"):
            open_case = int(keyword.rpartition("_")[2])
            assert open_case in cases
        elif keyword.startswith("*CASE_END_"):
            open_case = None
        elif keyword == "*DEFINE_CURVE":
            points = [tuple(map(float, columns(row, 20, 20))) for row in rows[1:]]
            assert int(rows[0]) not in curves and points[0] == (0, 0) and points[-1][0] == 1
            curves[int(rows[0])] = points[-1][1]
        elif open_case and keyword == "*BOUNDARY_SPC_NODE":
            for row in rows:
                node, system, *held = map(int, columns(row, *[10] * 8))
                assert (system, held) == (0, [1, 0, 0, 0, 0, 0])
                cases[open_case][0][node] = 0.0
        elif keyword == "*BOUNDARY_PRESCRIBED_MOTION_NODE":
            for row in rows:
                node, direction, kind, curve, scale = columns(row, *[10] * 5)
                assert (direction, kind) == ("1", "2") and curves[int(curve)] == 1 and float(scale) != 0
                cases[open_case][0][int(node)] = float(scale)
        elif keyword == "*LOAD_THERMAL_LOAD_CURVE":
            cases[open_case] = (cases[open_case][0], curves[int(rows[0])])
        elif keyword == "*CONSTRAINED_MULTIPLE_GLOBAL":
            at = 1
            while at < len(rows):
                count = int(rows[at])
                model.equations.append(
                    [
                        (int(n), int(d), float(f))
                        for n, d, f in (columns(row, 10, 10, 10) for row in rows[at + 1 : at + 1 + count])
                    ]
                )
                at += 1 + count
    for name, members in part_sets.items():
        model.element_sets[name] = sorted(e for e, part in part_of.items() if part in members)
    for element, part in part_of.items():
        kind, density, *rest = materials[parts[part]]
        make = isotropic if kind == "isotropic" else constants
        expansion = in_space(expansions[part], kind == "isotropic") if part in expansions else None
        model.material[element] = make(*rest, density if density != 1e-9 else None, expansion)
    model.loads = [cases[number] for number in sorted(cases)]
    return model
