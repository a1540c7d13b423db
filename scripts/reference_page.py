"""The page of scripts/reference-cells: what was computed of the cells of samples/benchmark, as tables."""

LEVELS = ("coarse", "medium", "fine")
PROPERTIES = ("stiffness", "conductivity", "permeability")

METHOD = """Unit cells for whoever has a program of their own: texts, meshes by one command, and what comes out, with errors. All cells repeat along x, y
and z. C is the stiffness in MPa (xy,xy is a shear modulus), k the conductivity in W/(m K), K the permeability of the pores in mm2.

Tetrahedra have ten nodes (the flow's are Taylor and Hood's), voxels eight. The table says the values by size and, behind each, the
error that is stated of it, in per cent. How it is found, after Roache 1994, with the cube root of the number of elements as the fineness:

- A mesh knows itself and coarser ones. Medium: three times the change from the coarse one, over r^p - 1, with the least order p that is
  believed (2 of tetrahedra, 1 of voxels); r is the ratio of the finenesses. Coarse: the same change, that times r^p.
- Fine: 1.25 times the change to the extrapolated value, by the order that the three show; where they show none (they are not monotone, or
  it is not between 2 and 5, of voxels 1 and 3), the spread of the three, and the fine value stands for the extrapolated one.

They agree when each value is as near to the extrapolated one of its kind, and to the closed form where there is one, as it states, and when
one value lies within the errors of all meshes of both kinds. Nothing in the definition makes this so.

Closed forms of arrays: Rayleigh's series of the conductivity (Perrins, McKenzie, McPhedran 1979), and a plane solution without a mesh of the
flow, which has the values of Sangani and Acrivos 1982 and of Drummond and Tahir 1984."""


def rows_of(header, rows):
    lines = ["| " + " | ".join(row) + " |" for row in (header, ["---"] * len(header), *rows)]
    return "\n".join(lines) + "\n"


def with_error(value, error):
    return f"{value:.5g} ± {100 * error / abs(value):.2g} %"


def summary_row(cell, records, faults):
    own = [record for record in records if record["cell"] == cell]
    row = [f"[`{cell}`]({cell}.txt)"]
    for prop in PROPERTIES:
        of_one = [record for record in own if record["property"] == prop and record["method"] == "tetrahedra" and len(record["value"]) == len(LEVELS)]
        shares = [record["error"][-1] / abs(record["value"][-1]) for record in of_one]
        row.append(f"{of_one[0]['elements'][-1]}; {100 * max(shares):.2g} %" if of_one else "not run")
    if not own:
        return [*row, "not run"]
    count = sum(fault.startswith(f"{cell},") for fault in faults)
    return [*row, f"{count} times not" if count else "yes"]


def cell_table(records):
    header = ["", "by", *LEVELS, "extrapolated", "order", "closed form"]
    rows = []
    for record in records:
        by_level = dict(zip(record["level"], zip(record["value"], record["error"])))
        cells = [with_error(*by_level[level]) if level in by_level else "not run" for level in LEVELS]
        order, exact = record["order"], record["exact"]
        rows.append([record["quantity"], record["method"], *cells, f"{record['limit']:.5g}", f"{order:.1f}" if order else "-",
                     "" if exact is None else f"{exact:.5g}"])
    return rows_of(header, rows)


def meshes_table(records):
    rows = []
    for key in dict.fromkeys((record["property"], record["method"]) for record in records):
        record = next(one for one in records if (one["property"], one["method"]) == key)
        unit = "" if record["method"] == "voxels" else " mm"
        by_level = dict(zip(record["level"], zip(record["size"], record["elements"])))
        rows.append([*key, *(f"{by_level[level][0]:g}{unit}; {by_level[level][1]}" if level in by_level else "not run" for level in LEVELS)])
    return rows_of(["", "size (voxels along the longest side); elements", *LEVELS], rows)


def page(first, cells, records, faults):
    parts = ["# Results of the reference cells\n", first + "\n", METHOD + "\n",
             "Elements of the finest mesh of tetrahedra, and the largest error that is stated of a value on it:\n",
             rows_of(["cell", *PROPERTIES, "do all meshes agree?"], [summary_row(cell, records, faults) for cell in cells])]
    if faults:
        parts += ["Where they do not agree:\n", "".join(f"- {fault}\n" for fault in faults)]
    for cell in cells:
        own = [record for record in records if record["cell"] == cell]
        if own:
            parts += [f"## {cell}\n", meshes_table(own), cell_table(own)]
    return "\n".join(parts)
