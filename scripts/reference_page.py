"""The page of scripts/reference-cells: what was computed of the cells of samples/benchmark, as tables."""

LEVELS = ("coarse", "medium", "fine")
COLUMNS = (
    ("stiffness", "tetrahedra"),
    ("stiffness", "voxels"),
    ("conductivity", "tetrahedra"),
    ("conductivity", "voxels"),
    ("permeability", "tetrahedra"),
)

METHOD = """Unit cells for whoever has a program of their own: texts, meshes by one command, and what comes out, with errors. All cells repeat along x, y
and z. C is the stiffness in MPa (xy,xy is a shear modulus), k the conductivity in W/(m K), K the permeability of the pores in mm2.
Yarns keep 16 % of the thickness of the thinnest one apart, or more: across a gap that is thinner than a voxel yarns touch, and the cell comes out too
stiff (a jersey with gaps of 5 % by 4 %). Tetrahedra have ten nodes (the flow's are Taylor and Hood's), voxels eight. `results.json` has
all of it for programs, with more digits.

The error that is stated of a mesh (after Roache, J. Fluids Eng. 116 (1994) 405-413, and Eça, Hoekstra, J. Comput. Phys. 262 (2014)
104-130; the fineness is the cube root of the number of elements):

- Coarse and medium know the change from one to the other. The medium mesh states three times that, the coarse one four times: how far the medium
  one is, and that one's error.
- Fine: 1.25 times the change to the extrapolated value, by the order of convergence that the three show, where it is one that is believed (of
  tetrahedra 2 to 4, of flow to 5; of voxels 1 to 3). Else three times the last change, where changes shrink even faster, or three times the range of all
  three; the fine value stands for the extrapolated one then.
- Each entry of a tensor has the relative error of its worst one, so that no coincidence is taken for precision.

Meshes agree when each value is as near to the extrapolated one of its kind, and to the closed form where there is one, as it states, and when
some value lies within the errors of all meshes of both kinds. By definition only the fine mesh meets its own extrapolated value.

Closed forms of arrays: Rayleigh's series of the conductivity (Perrins, McKenzie, McPhedran 1979), and a plane solution without a mesh of the
flow, which has the values of Sangani and Acrivos 1982 and of Drummond and Tahir 1984."""


def rows_of(header, rows):
    lines = ["| " + " | ".join(row) + " |" for row in (header, ["---"] * len(header), *rows)]
    return "\n".join(lines) + "\n"


def percent(record, level):
    """The error that is stated of a mesh."""
    return f"{100 * record['error'][level] / abs(record['value'][level]):.2g} %"


def summary_row(cell, records, faults):
    own = [record for record in records if record["cell"] == cell]
    row = [f"[`{cell}`]({cell}.txt)"]
    for prop, method in COLUMNS:
        of_one = [
            record
            for record in own
            if (record["property"], record["method"]) == (prop, method) and len(record["value"]) == len(LEVELS)
        ]
        row.append(f"{percent(of_one[0], -1)} ({of_one[0]['elements'][-1]})" if of_one else "not run")
    if not own:
        return [*row, "not run"]
    count = sum(fault.startswith(f"{cell},") for fault in faults)
    return [*row, f"not {count} times" if count else "yes"]


def meshes_table(records):
    rows = []
    for key in dict.fromkeys((record["property"], record["method"]) for record in records):
        record = next(one for one in records if (one["property"], one["method"]) == key)
        size = "{:g} along the longest side" if record["method"] == "voxels" else "{:g} mm"
        told = {
            level: f"{size.format(record['size'][k])}, {record['elements'][k]} elements, ± {percent(record, k)}"
            for k, level in enumerate(record["level"])
        }
        rows.append([*key, *(told.get(level, "not run") for level in LEVELS)])
    return rows_of(["property", "by", *LEVELS], rows)


def cell_table(records):
    rows = []
    for record in records:
        by_level = dict(zip(record["level"], record["value"]))
        order, exact = record["order"], record["exact"]
        rows.append(
            [
                record["quantity"],
                record["method"],
                *(f"{by_level[level]:.5g}" if level in by_level else "not run" for level in LEVELS),
                f"{record['limit']:.5g}",
                f"{order:.1f}" if order else "-",
                "" if exact is None else f"{exact:.5g}",
            ]
        )
    return rows_of(["value", "by", *LEVELS, "extrapolated", "order", "closed form"], rows)


def page(first, cells, records, faults):
    parts = [
        "# Results of the reference cells\n",
        first + "\n",
        METHOD + "\n",
        "What the finest meshes state, and in brackets their elements:\n",
        rows_of(
            ["cell", *(", ".join(column) for column in COLUMNS), "do all meshes agree?"],
            [summary_row(cell, records, faults) for cell in cells],
        ),
    ]
    if faults:
        parts += ["Where they do not agree:\n", "".join(f"- {fault}\n" for fault in faults)]
    for cell in cells:
        own = [record for record in records if record["cell"] == cell]
        if own:
            parts += [f"## {cell}\n", meshes_table(own), cell_table(own)]
    return "\n".join(parts)
