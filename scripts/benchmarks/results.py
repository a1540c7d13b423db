"""Runs the benchmark programs and whole processes of selvage, and writes their figures as tables. Called by scripts/bench."""

import argparse
import datetime
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile
import time

import trend

ROOT = pathlib.Path(__file__).resolve().parents[2]
GRID = ROOT / "samples" / "plain4_grid.txt"

# What a whole process is compared with: nothing but its version.
VERSION_PROGRAM = '#include <iostream>\nint main() { std::cout << "version 0.1.0\\n"; }\n'


def seconds(command):
    """Wall time of one process from start to end, its output thrown away."""
    quiet = [(os.POSIX_SPAWN_OPEN, 1, "/dev/null", os.O_WRONLY, 0)]
    begin = time.perf_counter()
    pid = os.posix_spawn(command[0], command, os.environ, file_actions=quiet)
    status = os.waitpid(pid, 0)[1]
    took = time.perf_counter() - begin
    if status != 0:
        sys.exit(f"failed: {command}")
    return took


def interleaved(commands, repeats):
    """Times of each command, taken in turns so that a busy moment of the machine hits all alike."""
    times = [[] for _ in commands]
    for _ in range(repeats):
        for command, list_ in zip(commands, times):
            list_.append(seconds(command))
    return times


def table(heads, rows):
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def iges_write(bin_folder, folder, quick):
    command = [f"{bin_folder}/iges_write", "--folder", folder] + (
        ["--repeats", "3", "--sizes", "8,64"] if quick else []
    )
    rows = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["rows"]
    number = lambda row, key, form: format(row[key], form) if key in row else ""
    return table(
        [
            "writer",
            "yarns",
            "ms",
            "MB/s",
            "yarns/s",
            "million doubles/s",
            "memory, MiB",
            "times the bare loop's time",
            "times OpenCASCADE's speed",
        ],
        [
            [
                row["writer"],
                str(row["yarns"]),
                f"{1e3 * row['seconds']:.2f}",
                f"{row['mb_per_s']:.0f}",
                f"{row['yarns_per_s']:.0f}",
                f"{row['doubles_per_s'] / 1e6:.1f}",
                f"{row['peak_rss_growth_mib']:.1f}",
                number(row, "time_to_bare_loop", ".2f"),
                number(row, "times_occt", ".0f"),
            ]
            for row in rows
        ],
    )


def iges_read(bin_folder, folder, quick):
    command = [f"{bin_folder}/iges_read", "--folder", folder] + (["--repeats", "3", "--sizes", "8,64"] if quick else [])
    rows = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["rows"]
    number = lambda row, key, form, factor=1: format(factor * row[key], form) if key in row else ""
    return table(
        [
            "reader",
            "yarns",
            "ms",
            "of them until the entities are there, ms",
            "MB/s",
            "128s/s",
            "memory, MiB",
            "times the bare loop's time",
            "times OpenCASCADE's speed",
        ],
        [
            [
                row["reader"],
                str(row["yarns"]),
                f"{1e3 * row['seconds']:.2f}",
                number(row, "parsing_seconds", ".2f", 1e3),
                f"{row['mb_per_s']:.0f}",
                f"{row['surfaces_per_s']:.0f}",
                f"{row['peak_rss_growth_mib']:.1f}",
                number(row, "time_to_bare_loop", ".2f"),
                number(row, "times_occt", ".0f"),
            ]
            for row in rows
        ],
    )


def whole_process(bin_folder, folder, quick):
    source, program = f"{folder}/version.cpp", f"{folder}/version"
    pathlib.Path(source).write_text(VERSION_PROGRAM)
    subprocess.run(["c++", "-O2", source, "-o", program], check=True)
    selvage = f"{bin_folder}/selvage"
    commands = [
        [program],
        [selvage, "--version"],
        [selvage, "convert", str(GRID), "-o", f"{folder}/x.igs", "--quiet"],
        [selvage, "convert", str(GRID), "-o", f"{folder}/x.stp", "--quiet"],
    ]
    names = [
        "a C++ program that prints its version",
        "selvage --version",
        "plain4_grid.txt to IGES",
        "plain4_grid.txt to STEP",
    ]
    times = interleaved(commands, 30 if quick else 300)
    least = statistics.median(times[0])
    return table(
        ["process", "median, ms", "fastest, ms", "times the first"],
        [
            [name, f"{1e3 * statistics.median(t):.2f}", f"{1e3 * min(t):.2f}", f"{statistics.median(t) / least:.1f}"]
            for name, t in zip(names, times)
        ],
    )


def step_write(bin_folder, folder, quick):
    command = [f"{bin_folder}/step_write", "--folder", folder] + (["--repeats", "1"] if quick else [])
    command += ["--sizes", "64,512" if quick else "64,512,2048"]
    rows = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["rows"]
    return table(
        ["writer", "yarns", "s", "processor's s", "ms a yarn", "MB", "memory, MiB", "times OpenCASCADE's speed"],
        [
            [
                row["writer"],
                str(row["yarns"]),
                f"{row['seconds']:.3f}",
                f"{row['cpu_seconds']:.3f}",
                f"{1e3 * row['seconds'] / row['yarns']:.2f}",
                f"{row['bytes'] / 1e6:.1f}",
                f"{row['peak_rss_growth_mib']:.1f}",
                f"{row['times_occt']:.0f}" if "times_occt" in row else "",
            ]
            for row in rows
        ],
    )


# Chang et al. (methods.md, 1): mean time of one drawing of the centre lines of 50 x 50 loops, s. On their machine, with its
# drawing: a published constant, shown beside our time and not a ratio that says much.
PUBLISHED_JERSEY = 0.307


def knit_build(bin_folder, folder, quick):
    command = [f"{bin_folder}/knit_build", "--folder", folder] + (
        ["--repeats", "5", "--sizes", "50,158"] if quick else []
    )
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    first = {row["method"]: row["seconds_a_loop"] for row in reversed(found["lines"])}
    lines = table(
        [
            "jersey",
            "parameters",
            "centre lines, ms",
            "published, ms",
            "ns a loop",
            "to 50 x 50",
            "SparseLU of the same systems, ms",
            "times SparseLU's speed",
        ],
        [
            [
                f"{row['size']} x {row['size']}",
                row["method"],
                f"{1e3 * row['seconds']:.2f}",
                f"{1e3 * PUBLISHED_JERSEY:.0f}" if row["size"] == 50 else "",
                f"{1e9 * row['seconds_a_loop']:.0f}",
                f"{row['seconds_a_loop'] / first[row['method']]:.2f}",
                f"{1e3 * row['peer_seconds']:.2f}",
                f"{row['times_peer']:.1f}",
            ]
            for row in found["lines"]
        ],
    )
    least = found["bodies"][0]
    bodies = table(
        [
            "jersey",
            "loops built",
            "tubes, s",
            "us a loop",
            "to the first",
            "IGES, s",
            "us a loop",
            "to the first",
            "MB",
        ],
        [
            [
                f"{row['size']} x {row['size']}",
                str(row["loops"]),
                f"{row['tube_seconds']:.2f}",
                f"{1e6 * row['tube_seconds_a_loop']:.1f}",
                f"{row['tube_seconds_a_loop'] / least['tube_seconds_a_loop']:.2f}",
                f"{row['iges_seconds']:.2f}",
                f"{1e6 * row['iges_seconds_a_loop']:.1f}",
                f"{row['iges_seconds_a_loop'] / least['iges_seconds_a_loop']:.2f}",
                f"{row['bytes'] / 1e6:.0f}",
            ]
            for row in found["bodies"]
        ],
    )
    return lines + "\n" + bodies


def compare(bin_folder, folder, quick):
    command = [f"{bin_folder}/compare"] + (["--repeats", "1", "--sizes", "125,250,500,1000"] if quick else [])
    rows = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["rows"]
    first = {row["pair"]: row["microseconds_a_yarn"] for row in reversed(rows)}
    return table(
        ["pair", "yarns", "s", "us a yarn", "to the first"],
        [
            [
                row["pair"],
                str(row["yarns"]),
                f"{row['seconds']:.3f}",
                f"{row['microseconds_a_yarn']:.1f}",
                f"{row['microseconds_a_yarn'] / first[row['pair']]:.2f}",
            ]
            for row in rows
        ],
    )


def relax(bin_folder, folder, quick):
    command = [f"{bin_folder}/relax"] + (["--sizes", "4,6,8,12"] if quick else [])
    rows = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["rows"]
    first = rows[0]["milliseconds_a_loop"]
    percent = lambda value: f"{100 * value:.2g} %"
    return table(
        [
            "jersey",
            "overlaps",
            "deepest, mm",
            "s",
            "ms a loop",
            "to the first",
            "steps",
            "area",
            "length",
            "volume",
            "peak memory, MiB",
        ],
        [
            [
                f"{row['size']} x {row['size']}",
                str(row["overlaps"]),
                f"{row['depth']:.4f}",
                f"{row['seconds']:.2f}",
                f"{row['milliseconds_a_loop']:.1f}",
                f"{row['milliseconds_a_loop'] / first:.2f}",
                str(row["steps"]),
                percent(row["area"]),
                percent(row["length"]),
                percent(row["volume"]),
                f"{row['peak_rss_mib']:.0f}",
            ]
            for row in rows
        ],
    )


def contact(bin_folder, folder, quick):
    command = [f"{bin_folder}/contact"]
    command += ["--jersey", "4,6,8,12", "--weave", "4,6,8,12", "--peer-limit", "10"] if quick else []
    rows = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["rows"]
    first = {row["cloth"]: row["milliseconds_a_unit"] for row in reversed(rows)}
    # Figures of a peer that was stopped are marked.
    about = lambda row: "" if row["peer_share"] == 1 else "~"
    share = (
        lambda row: ""
        if row["peer_share"] == 1
        else f" ({100 * row['peer_share']:.2g} % of {row['peer_candidates']} pairs)"
    )
    return table(
        [
            "cloth",
            "loops or crossings",
            "overlaps found",
            "ours, s",
            "ms a loop or crossing",
            "to the first",
            "CGAL, s",
            "of that tessellation, s",
            "triangles",
            "pairs CGAL found",
            "times CGAL's speed",
        ],
        [
            [
                f"{row['cloth']} {row['size']} x {row['size']}",
                str(row["size"] ** 2),
                str(row["contacts"]),
                f"{row['seconds']:.2f}",
                f"{row['milliseconds_a_unit']:.2f}",
                f"{row['milliseconds_a_unit'] / first[row['cloth']]:.2f}",
                f"{about(row)}{row['peer_seconds']:.3g}{share(row)}",
                f"{row['peer_tessellation_seconds']:.2f}",
                str(row["triangles"]),
                str(row["peer_pairs"]),
                f"{about(row)}{row['times_peer']:.1f}",
            ]
            for row in rows
        ],
    )


def angles_of(path):
    """Number of tetrahedra in a Gmsh 2.2 file, the smallest of their smallest dihedral angles and the first percentile, degrees."""
    import numpy

    with open(path) as file:
        lines = iter(file)
        while next(lines).strip() != "$Nodes":
            pass
        nodes = numpy.array([next(lines).split() for _ in range(int(next(lines)))], dtype=float)
        while next(lines).strip() != "$Elements":
            pass
        cells = [line[-4:] for line in (next(lines).split() for _ in range(int(next(lines)))) if line[1] == "4"]
    if not cells:
        return 0, (0.0, 0.0)
    place = numpy.full(int(nodes[:, 0].max()) + 1, -1)
    place[nodes[:, 0].astype(int)] = numpy.arange(len(nodes))
    corners = nodes[:, 1:][place[numpy.array(cells, dtype=int)]]
    normals = [
        numpy.cross(corners[:, b] - corners[:, a], corners[:, c] - corners[:, a])
        for a, b, c in ((1, 2, 3), (0, 3, 2), (0, 1, 3), (0, 2, 1))
    ]
    least = numpy.full(len(cells), 180.0)
    for i in range(4):
        for j in range(i):
            sine = numpy.linalg.norm(numpy.cross(normals[i], normals[j]), axis=1)
            angles = numpy.degrees(numpy.arctan2(sine, -numpy.einsum("ij,ij->i", normals[i], normals[j])))
            least = numpy.minimum(least, angles)
    return len(cells), (float(least.min()), float(numpy.partition(least, len(least) // 100)[len(least) // 100]))


# What gmsh says of its own time: the volume's mesh, and the optimization that belongs to it.
GMSH_TIME = re.compile(r"Done (?:meshing 3D|optimizing mesh) \(Wall ([0-9.e+-]+)s, CPU ([0-9.e+-]+)s")


def gmsh_tetrahedra(geo, algorithm, threads, out, wanted):
    """Number of tetrahedra, their angles, wall and processor time: with edges inside the volumes scaled until there are about as many
    as wanted."""
    scale = 1.0
    for _ in range(3):
        result = gmsh_mesh(geo, algorithm, threads, out, scale)
        if result[0] == 0 or abs(result[0] / wanted - 1) < 0.02:
            break
        scale *= (result[0] / wanted) ** (1 / 3)
    return result


def gmsh_mesh(geo, algorithm, threads, out, scale):
    pathlib.Path(out).unlink(missing_ok=True)
    words = subprocess.run(
        [
            "gmsh",
            geo,
            "-3",
            "-algo",
            algorithm,
            "-nt",
            str(threads),
            "-clscale",
            f"{scale:.6f}",
            "-format",
            "msh22",
            "-o",
            out,
        ],
        capture_output=True,
        text=True,
        timeout=3600,
    ).stdout
    tets, angles = angles_of(out) if os.path.exists(out) else (0, (0.0, 0.0))
    times = [[float(x) for x in pair] for pair in GMSH_TIME.findall(words)]
    return tets, angles, sum(t[0] for t in times), sum(t[1] for t in times)


def tetrahedra(bin_folder, folder, quick):
    command = [
        f"{bin_folder}/tetrahedra",
        "--sample",
        str(ROOT / "samples" / "cell_plain.txt"),
        "--folder",
        folder,
        "--targets",
        "12,15",
        "--threads",
        "1,2",
        "--sizes",
        "0.2,0.15" if quick else "0.15,0.075,0.05",
    ]
    rows = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["rows"]
    cells = []

    def add(row, name, threads, tets, angles, seconds, processor):
        figures = (
            [
                f"{seconds:.2f}",
                f"{tets / seconds:.0f}",
                f"{1e6 * seconds / tets:.2f}",
                f"{processor:.2f}",
                f"{1e6 * processor / tets:.2f}",
                *(f"{angle:.2f}" for angle in angles),
            ]
            if tets
            else ["", "", "", "", "", "no mesh", ""]
        )
        cells.append([f"{row['size']:g}", f"{row['triangles']}", name, str(threads), str(tets), *figures])

    for k, row in enumerate(rows):
        add(
            row,
            f"selvage, to {row['target']:g} degrees",
            row["threads"],
            row["tets"],
            (row["min_dihedral"], row["first_percentile"]),
            row["seconds"],
            row["processor_seconds"],
        )
        if k + 1 < len(rows) and rows[k + 1]["size"] == row["size"]:
            continue
        for name, algorithm, threads in (
            ("gmsh, HXT", "hxt", 1),
            ("gmsh, HXT", "hxt", 2),
            ("gmsh, Delaunay", "del3d", 1),
        ):
            add(row, name, threads, *gmsh_tetrahedra(row["geo"], algorithm, threads, f"{folder}/gmsh.msh", row["tets"]))
    return table(
        [
            "size, mm",
            "triangles",
            "mesher",
            "threads",
            "tetrahedra",
            "s",
            "tetrahedra/s",
            "s a million",
            "processor, s",
            "processor s a million",
            "smallest angle, degrees",
            "first percentile, degrees",
        ],
        cells,
    )


def straight(name, along, place, height, length):
    """A yarn of Fabric TXT, straight along x (0) or y (1)."""
    ends = [(-1.0, place, height), (length, place, height)]
    lines = "".join("    " + " ".join(f"{c:g}" for c in (p if along == 0 else (p[1], p[0], p[2]))) + "\n" for p in ends)
    return f"yarn {name} t\n  path chord\n{lines}  end\nend\n"


def lattice(count, apart):
    """Straight yarns that cross, half of them `apart` above the others: about `count` crossings."""
    side = round(count**0.5)
    yarns = "".join(
        straight(f"{'ab'[along]}{k}", along, k, along * apart, side) for k in range(side) for along in (0, 1)
    )
    return f"fabric 1\nunits mm\nthread t\n  tex 100\n  density 1.5\n  section circle 0.3\nend\n{yarns}"


def rods(count):
    """Short yarns side by side."""
    yarns = "".join(straight(f"y{k}", 0, k, 0.0, 1) for k in range(count))
    return f"fabric 1\nunits mm\nthread t\n  tex 100\n  density 1.5\n  section circle 0.3\nend\n{yarns}"


def jersey(count):
    """So many loops, of a loop's repeat."""
    side = round(count**0.5)
    return f"fabric 1\nunits mm\nthread t\n  section circle 0.2\nend\nknit jersey\n  thread t\n  courses {side}\n  wales {side}\nend\n"


def draft(count):
    """A weave of so many crossings of a draft of 16 shafts, which repeats nowhere along its yarns."""
    side, heads = round(count**0.5), []
    for pick in range(16):
        heads.append(
            "".join("1" if (end * end + 3 * pick * end + pick) % 5 < 2 else "0" for end in range(min(side, 97)))
        )
    rows = "".join(f"    {row}\n" for row in heads)
    return (
        "fabric 1\nunits mm\nthread t\n  section circle 0.3\nend\n"
        f"weave\n  warp t {side} pitch 1\n  weft t {side} pitch 1\n  draft\n{rows}  end\nend\n"
    )


def edited(count):
    """The same, each one edited by its name."""
    return rods(count) + "".join(f"edit y{k} point 2 to 1 {k} 0.1\n" for k in reversed(range(count)))


# Where work once grew with the square: what is counted, the numbers, the text, the format that it is converted to first, the command.
GROWING = [
    ("overlaps, `check`", (16, 64, 256), lambda n: lattice(n, 0.1), None, ["check"]),
    ("crossings without contact, `check`", (16, 64, 256), lambda n: lattice(n, 1), None, ["check"]),
    ("loops of a jersey, `convert` to IGES", (2500, 10000, 40000), jersey, None, ["convert", "--to", "iges"]),
    ("loops of a jersey, `check`", (100, 400, 1600), jersey, None, ["check"]),
    ("crossings of a draft, `info`", (4096, 16384, 65536), draft, None, ["info"]),
    (
        "crossings of a draft, `convert --instances` to IGES",
        (4096, 16384, 65536),
        draft,
        None,
        ["convert", "--instances", "--to", "iges"],
    ),
    ("yarns edited by name, `convert` to IGES", (256, 1024, 4096), edited, None, ["convert", "--to", "iges"]),
    ("yarns of an IGES file, `check`", (64, 256, 1024), rods, "igs", ["check"]),
    ("yarns of a STEP file, `info`", (64, 256, 1024), rods, "stp", ["info"]),
    ("dry yarns of a deck with contact, `mesh`", (64, 256, 1024), rods, None, ["mesh", "--to", "inp", "--size", "0.3"]),
]


def processor_seconds(command):
    """Of a process and those that it waited for; its output thrown away. 3: it found defects."""
    pid = os.posix_spawn(
        command[0],
        command,
        os.environ,
        file_actions=[(os.POSIX_SPAWN_OPEN, k, "/dev/null", os.O_WRONLY, 0) for k in (1, 2)],
    )
    _, status, used = os.wait4(pid, 0)
    if os.waitstatus_to_exitcode(status) not in (0, 3):
        sys.exit(f"failed: {command}")
    return used.ru_utime + used.ru_stime


def growth(bin_folder, folder, quick):
    rows = []
    for name, counts, text, extension, words in GROWING:
        first = None
        for count in counts[:2] if quick else counts:
            source = pathlib.Path(folder) / f"growth{count}.txt"
            source.write_text(text(count))
            if extension:
                made = source.with_suffix(f".{extension}")
                processor_seconds([f"{bin_folder}/selvage", "convert", str(source), "-o", str(made), "--quiet"])
                source = made
            out = [] if words[0] in ("check", "info") else ["-o", f"{folder}/grown/"]
            took = processor_seconds([f"{bin_folder}/selvage", *words, str(source), *out, "--quiet"])
            first = first or took / count
            rows.append([name, str(count), f"{took:.2f}", f"{1e3 * took / count:.2f}", f"{took / count / first:.2f}"])
    return table(["what", "number", "processor, s", "ms each", "to the first"], rows)


def machine():
    model = next(
        (line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "unknown"
    )
    return f"{model}, {os.cpu_count()} cores"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("--quick", action="store_true", help="fewer repeats and sizes")
    given = parser.parse_args()
    commit = subprocess.run(
        ["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True
    ).stdout.strip()
    with tempfile.TemporaryDirectory(prefix="selvage-bench-") as folder:
        text = (
            f"# Benchmarks\n\nGenerated by `scripts/bench`{' --quick' if given.quick else ''} on {datetime.date.today()}, commit "
            f"{commit or 'unknown'}, {machine()}.\n\n"
            "## Writing IGES: yarns of 18 x 16 control points, three surfaces each\n\n"
            "The bare loop sends the same values through `to_chars` and the same buffered write; OpenCASCADE writes about ten "
            "digits, selvage all of them.\n\n"
            + iges_write(given.bin, folder, given.quick)
            + "\n## Reading IGES: the same yarns\n\n"
            "A file in the system's cache to a model of surfaces, yarns grouped and named. The bare loop is `from_chars` on every "
            "number of the same parameter lines, added up; OpenCASCADE makes its entities of the file and then its shapes of "
            "them.\n\n"
            + iges_read(given.bin, folder, given.quick)
            + "\n## Whole processes\n\n"
            + whole_process(given.bin, folder, given.quick)
            + "\n## Writing STEP: the time a yarn stays the same\n\n"
            + step_write(given.bin, folder, given.quick)
            + "\n## Jersey: centre lines, tubes and the IGES file; the cost of a loop stays the same\n\n"
            "SparseLU is Eigen's general sparse solver on the systems of all courses, in the same run and in turns with ours. The "
            "published time is a constant from another machine, drawing included. Tubes and file are those of as many "
            "whole courses as have 5,000 loops.\n\n"
            + knit_build(given.bin, folder, given.quick)
            + "\n## Large inputs: the time of one of many stays the same\n\n"
            "Whole processes, processor time.\n\n"
            + growth(given.bin, folder, given.quick)
            + "\n## Comparing two cloths in memory, two threads: the time a yarn stays the same\n\n"
            + compare(given.bin, folder, given.quick)
            + "\n## Moving the loops of the published jersey apart, two threads: the time a loop stays the same\n\n"
            "Yarn of 0.2 mm, to gaps of 1 % of that; with the exact search for overlaps before and after. Area, length and volume: the "
            "largest changes.\n\n"
            + relax(given.bin, folder, given.quick)
            + "\n## Finding the overlaps of a cloth, two threads: the time a loop or a crossing stays the same\n\n"
            "Published jerseys, whose loops overlap, and plain weaves that are free of overlap; round yarns. CGAL: `do_intersect` of "
            "all pairs of yarns whose boxes meet, on two threads too, of the triangles that `check` makes (chord 1/200 of the thinnest "
            "section); the time of making them is part of its time. It says only that two yarns meet: nothing of the loops of one "
            "yarn, of depths or places. Every pair that it finds is among ours (or nearer than the chords' error). Marked ~: it was "
            "stopped after a minute (quick: 10 s), and its time is extrapolated from the share of the pairs that it did.\n\n"
            + contact(given.bin, folder, given.quick)
            + "\n## Tetrahedra of a unit cell: the plain weave of samples/cell_plain.txt with its matrix\n\n"
            "Its yarns keep the gap that `mesh` has them keep, 5 % of their thickness. The surfaces are the same for all: those that selvage made; "
            "gmsh's edges inside the volumes are scaled until it makes about as many tetrahedra. The time of selvage is that of TetGen in its "
            "worker, of the checks of what came back, of the points put in and of the improvement to 12 degrees "
            "or 15, as far as it gets; gmsh's is what it says of its own meshing and optimizing of the volumes, as it does both by itself. Processor "
            "time is that of all threads and of the worker.\n\n" + tetrahedra(given.bin, folder, given.quick)
        )
    # The committed page, against which a row may not have become worse unseen.
    page = pathlib.Path(given.out)
    shown = subprocess.run(
        ["git", "-C", ROOT, "show", f"HEAD:./{page.resolve().relative_to(ROOT)}"], capture_output=True, text=True
    )
    before = shown.stdout if shown.returncode == 0 else ""
    of = re.search(r"commit (\w+)", before)
    title, rest = text.split("\n\n## ", 1)
    summary = trend.summary(before, of[1] if of else "", text)
    text = f"{title}\n\n{summary}\n## {rest}"
    page.write_text(text)
    page.with_suffix(".svg").write_text(trend.plot(text))
    print(text)
    print(summary)


if __name__ == "__main__":
    main()
