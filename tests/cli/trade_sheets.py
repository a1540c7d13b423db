"""Cloths of the trade against their sheets: samples/trade/sheets.csv has what is published, and here is what is built, by the
points that `convert --lines` writes: lengths between places that are alike, and how high the sections reach. As a
program (scripts/trade) it makes the table of samples/trade/README.md."""

import csv
import dataclasses
import math
import pathlib
import re
import sys
import tempfile

from program import SAMPLES, run

TRADE = SAMPLES / "trade"
# How far what is built may be from what is published (issue of the real cloths): shares, and points of crimp.
BOUNDS = {"thickness": 0.15, "mass": 0.05, "warp crimp": 3.0, "weft crimp": 3.0}
TEX = {"tex": lambda v: v, "denier": lambda v: v / 9, "Ne": lambda v: 590.5412 / v}


def sheets():
    with open(TRADE / "sheets.csv", newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def text_of(sheet):
    return (TRADE / f"{sheet['cloth']}.txt").read_text(encoding="utf-8")


def published(sheet):
    columns = {"thickness": "thickness_mm", "mass": "mass_g_m2", "warp crimp": "warp_crimp", "weft crimp": "weft_crimp"}
    return {what: float(sheet[column]) for what, column in columns.items() if sheet[column]}


def yarns_of(words):
    """`tex 68`, or several in turn: `tex 83, tex 55`."""
    return words.split(", ")


def tex_of(yarn):
    """`tex 68`, `Ne 30`, or a wire's diameter and density, `0.2 mm 7.85`. Of several in turn their mean."""
    if len(yarns_of(yarn)) > 1:
        return sum(map(tex_of, yarns_of(yarn))) / len(yarns_of(yarn))
    if match := re.fullmatch(r"([\d.]+) mm ([\d.]+)", yarn):
        return 1000 * float(match[2]) * math.pi / 4 * float(match[1]) ** 2
    word, value = yarn.split()
    return TEX[word](float(value))


def pitch_of(words):
    """mm, of `44/in`, `20/cm`, `208/10cm` or a distance."""
    number, _, unit = words.partition("/")
    return {"": float(number), "in": 25.4 / float(number), "cm": 10 / float(number), "10cm": 100 / float(number)}[unit]


def straight_mass(sheet):
    """g/m2 of the threads without any crimp."""
    return tex_of(sheet["warp"]) / pitch_of(sheet["ends"]) + tex_of(sheet["weft"]) / pitch_of(sheet["picks"])


@dataclasses.dataclass
class Point:
    position: tuple
    tangent: tuple
    top: float  # how high the section reaches above the axis


def lines_of(path, *options):
    """The points of each yarn, as written."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "lines.csv"
        done = run("convert", path, "--lines", "--to", "csv", "-o", out, *options)
        if done.returncode != 0:
            raise RuntimeError(done.stderr)
        yarns = {}
        with open(out, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                number = {key: float(value) for key, value in row.items() if key not in ("yarn", "point")}
                across = number["side_z"] * number["width_mm"] / 2
                up = number["up_z"] * number["height_mm"] / 2
                yarns.setdefault(row["yarn"], []).append(
                    Point(
                        tuple(number[f"{axis}_mm"] for axis in "xyz"),
                        tuple(number[f"tangent_{axis}"] for axis in "xyz"),
                        math.hypot(across, up),
                    )
                )
        return yarns


def length(points):
    """Of the arcs that leave one point and reach the next one in their tangents' directions."""
    total = 0.0
    for a, b in zip(points, points[1:]):
        chord = math.dist(a.position, b.position)
        half = math.asin(min(1.0, math.dist(a.tangent, b.tangent) / 2))
        total += chord * (half / math.sin(half) if half > 1e-9 else 1.0)
    return total


def crossing(points, axis, place):
    """The yarn's level piece at a crossing, cut there."""
    for a, b in zip(points, points[1:]):
        if a.position[axis] <= place <= b.position[axis]:
            share = (place - a.position[axis]) / (b.position[axis] - a.position[axis])
            at = tuple(p + share * (q - p) for p, q in zip(a.position, b.position))
            return Point(at, a.tangent, a.top)
    raise ValueError(place)


def crimp(points, axis, pitch, crossings):
    """Of a thread over half of the cloth, from the middle of one crossing to that of another: its ends, which are level,
    have no say. Half of the cloth is a whole number of repeats."""
    first, last = 1.5 * pitch, (1.5 + crossings / 2) * pitch
    inside = [p for p in points if first < p.position[axis] < last]
    piece = [crossing(points, axis, first), *inside, crossing(points, axis, last)]
    return length(piece) / (last - first) - 1


def measured(sheet, path=None):
    yarns = lines_of(path or TRADE / f"{sheet['cloth']}.txt")
    tops = [p.position[2] + p.top for points in yarns.values() for p in points]
    bottoms = [p.position[2] - p.top for points in yarns.values() for p in points]
    built = {"thickness": max(tops) - min(bottoms)}
    ends, picks = pitch_of(sheet["ends"]), pitch_of(sheet["picks"])
    if "knit" in text_of(sheet):
        courses = [points for name, points in yarns.items() if name.startswith("course_")]
        wales = int(re.search(r"wales (\d+)", text_of(sheet))[1])
        loop = sum(map(length, courses)) / (len(courses) * wales)
        built["mass"] = tex_of(sheet["weft"]) * loop / (ends * picks)
        return built
    mass = 0.0
    for system, axis, pitch, own in (("warp", 0, picks, ends), ("weft", 1, ends, picks)):
        threads = [points for name, points in yarns.items() if name.startswith(f"{system}_")]
        shares = [crimp(points, axis, pitch, len(threads)) for points in threads]
        built[f"{system} crimp"] = 100 * sum(shares) / len(shares)
        yarns_in_turn = yarns_of(sheet[system])
        mass += sum(
            tex_of(yarns_in_turn[i % len(yarns_in_turn)]) * (1 + share) / (own * len(shares))
            for i, share in enumerate(shares)
        )
    built["mass"] = mass
    return built


def is_within(what, built, wanted):
    bound = BOUNDS[what]
    return abs(built - wanted) <= (bound if "crimp" in what else bound * wanted)


def outside(sheet, built):
    return sorted(what for what, wanted in published(sheet).items() if not is_within(what, built[what], wanted))


def is_asked(sheet):
    return re.search(r"^  thickness", text_of(sheet), re.MULTILINE) is not None


def unasked(sheet):
    """The thickness of the same cloth where the text does not ask for it."""
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "unasked.txt"
        path.write_text(re.sub(r"^  thickness.*\n", "", text_of(sheet), flags=re.MULTILINE))
        return measured(sheet, path)["thickness"]


def shown(value):
    return f"{value:.3g}" if value < 100 else f"{value:.0f}"


def table():
    rows = [
        "| cloth | from | thickness, mm | mass, g/m2 | warp crimp, % | weft crimp, % | straight, g/m2 | unasked, mm | outside |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for sheet in sheets():
        built, wanted = measured(sheet), published(sheet)
        cells = [f"`{sheet['cloth']}`", sheet["kind"]]
        for what in BOUNDS:
            have = shown(built[what]) if what in built else ""
            cells.append(f"{have} ({shown(wanted[what])})" if what in wanted else have)
        cells.append(shown(straight_mass(sheet)) if sheet["warp"] else "")
        cells.append(shown(unasked(sheet)) if is_asked(sheet) else "")
        cells.append(", ".join(outside(sheet, built)))
        rows.append("| " + " | ".join(cells) + " |")
    return rows


def is_of_table(line):
    return line.startswith(("| cloth", "|---|---|---|---|---|---|---|", "| `"))


def write_table():
    page = TRADE / "README.md"
    lines = page.read_text(encoding="utf-8").splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("| cloth"))
    after = next(i for i in range(first, len(lines) + 1) if i == len(lines) or not is_of_table(lines[i]))
    lines[first:after] = table()
    page.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    if sys.argv[1:] == ["--write"]:
        write_table()
    else:
        print("\n".join(table()))
