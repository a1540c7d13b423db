"""Abaqus input deck, as the keywords manual has it."""

import pathlib

from model import Model, constants, in_space, is_isotropic, isotropic, right_handed


def blocks_of(path):
    """(keyword, parameters, data lines); a star that is not in the first column begins a keyword too."""
    blocks = []
    for line in pathlib.Path(path).read_text().splitlines():
        line = line.strip()
        if line.startswith("**") or not line:
            continue
        if line.startswith("*"):
            words = [word.strip() for word in line[1:].split(",")]
            parameters = dict(
                (part.strip().upper(), value.strip()) for part, _, value in (word.partition("=") for word in words[1:])
            )
            blocks.append((words[0].upper(), parameters, []))
        else:
            blocks[-1][2].append([field.strip() for field in line.split(",")])
    return blocks


def numbers(rows):
    return [int(field) for row in rows for field in row if field]


def read(path):
    model = Model()
    materials, material, sections, distributions, orientations = {}, None, [], {}, {}
    step = None
    driver = {}
    for keyword, parameters, rows in blocks_of(path):
        if keyword == "NODE":
            for row in rows:
                model.nodes[int(row[0])] = tuple(map(float, row[1:4]))
            if "NSET" in parameters:
                model.node_sets[parameters["NSET"].upper()] = sorted(int(row[0]) for row in rows)
        elif keyword == "ELEMENT":
            for row in rows:
                model.elements[int(row[0])] = tuple(map(int, row[1:]))
            model.element_sets[parameters["ELSET"].upper()] = sorted(int(row[0]) for row in rows)
        elif keyword in ("NSET", "ELSET"):
            sets = model.node_sets if keyword == "NSET" else model.element_sets
            members = []
            if "GENERATE" in parameters:
                first, last, step_size = map(int, rows[0])
                members, rows = list(range(first, last + 1, step_size)), []
            for field in (field for row in rows for field in row if field):
                members += [int(field)] if field.isdigit() else sets[field.upper()]
            sets[parameters[keyword].upper()] = sorted(members)
        elif keyword == "MATERIAL":
            material = materials.setdefault(parameters["NAME"].upper(), {})
        elif keyword == "ELASTIC":
            material["type"] = parameters.get("TYPE", "ISOTROPIC").upper()
            material["elastic"] = [float(field) for row in rows for field in row if field]
        elif keyword == "DENSITY":
            material["density"] = float(rows[0][0])
        elif keyword == "EXPANSION":
            values = tuple(map(float, rows[0]))
            assert len(values) == {"ISO": 1, "ORTHO": 3}[parameters.get("TYPE", "ISO").upper()]
            material["expansion"] = in_space(values, material.get("type") == "ISOTROPIC")
        elif keyword == "DISTRIBUTION":
            distributions[parameters["NAME"].upper()] = rows
        elif keyword == "ORIENTATION":
            orientations[parameters["NAME"].upper()] = rows[0][0].upper()
        elif keyword == "SOLID SECTION":
            sections.append(parameters)
        elif keyword == "EQUATION":
            at = 0
            while at < len(rows):
                count, fields = int(rows[at][0]), []
                at += 1
                while len(fields) < 3 * count:
                    fields += [field for field in rows[at] if field]
                    at += 1
                model.equations.append(
                    [(int(fields[i]), int(fields[i + 1]), float(fields[i + 2])) for i in range(0, 3 * count, 3)]
                )
        elif keyword == "STEP":
            step = ({}, [0.0])
            driver = {
                name: members[0] for name, members in model.node_sets.items() if "DRIVER" in name and len(members) == 1
            }
        elif keyword == "BOUNDARY" and step:
            for row in rows:
                if row[0].upper() in driver and row[1] == "1":
                    step[0][driver[row[0].upper()]] = float(row[3]) if len(row) > 3 and row[3] else 0.0
        elif keyword == "TEMPERATURE" and step:
            step[1][0] = float(rows[0][1])
        elif keyword == "END STEP":
            model.loads.append((step[0], step[1][0]))
    known = {}
    for name, material in materials.items():
        if "elastic" not in material:
            continue
        make = isotropic if material["type"] == "ISOTROPIC" else constants
        known[name] = make(*material["elastic"], material.get("density"), material.get("expansion"))
    for section in sections:
        for element in model.element_sets[section["ELSET"].upper()]:
            model.material[element] = known[section["MATERIAL"].upper()]
        if "ORIENTATION" not in section or is_isotropic(known[section["MATERIAL"].upper()]):
            continue
        rows = distributions[orientations[section["ORIENTATION"].upper()]]
        axes = {
            int(row[0]): right_handed(list(map(float, row[1:4])), list(map(float, row[4:7]))) for row in rows if row[0]
        }
        for element in model.element_sets[section["ELSET"].upper()]:
            model.axes[element] = axes[element]
    return model
