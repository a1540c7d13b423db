"""What the tables of RESULTS.md say of those before: rows that became worse, exponents of growth, plots.

A table's first columns name the row; the figures begin with the first column of FIGURES. Where a row names a size (512, or 50 x 50),
rows that agree in all else are one curve.
"""

import math
import re
import statistics

import plots

LESS, MORE = "less", "more"
# Columns of our own figures, and what is better.
FIGURES = [
    (
        re.compile(r"of them until|SparseLU of|published|CGAL, s|of that tessellation"),
        None,
    ),  # a peer's, or a part of one that is there
    (re.compile(r"^(\w+, )?(ms|s|us|ns)$|, (ms|s)$|processor's s|^(ms|us|ns) a |^s a |memory, MiB|^MB$"), LESS),
    (re.compile(r"^times the (bare loop's time|first)$|^to the first$|^to 50 x 50$"), LESS),
    (re.compile(r"^(MB|yarns|128s|million doubles|tetrahedra)/s$|^times .*'s speed$"), MORE),
]
# How a row stands to the smallest one: no loss where all that the row itself takes became less.
GROWTH = re.compile(r"^to the first$|^to 50 x 50$")
# Which of them follow the machine's speed.
TIMES, RATES = re.compile(r"(^|, )(ms|s|us|ns)$|processor's s|^(ms|us|ns|s) a |^processor s a "), re.compile(r"/s$")
PEERS = re.compile(r"^(bare loop|OpenCASCADE|gmsh.*|a C\+\+ program .*)$")
# A row is worse that needs more than this share more.
BOUND = 0.10
SIZE = re.compile(r"(?:^|(?<= ))(\d+)(?: x (\d+))?$")


def better(head):
    """LESS or MORE; None: no figure of ours."""
    for pattern, direction in FIGURES:
        if pattern.search(head):
            return direction
    return None


class Table:
    def __init__(self, section, heads):
        self.section, self.heads, self.rows = section, heads, []
        figures = [k for k, head in enumerate(heads) if better(head)]
        self.key_columns = figures[0] if figures else len(heads)

    def size_column(self):
        """None where no column says how large the rows are."""
        sizes = [k for k in range(self.key_columns) if self.rows and all(SIZE.search(row[k]) for row in self.rows)]
        return sizes[0] if sizes else None

    def words(self, row):
        """{column: cell} of what the row is of, but for its size. Other numbers are what the run found."""
        size = self.size_column()
        return {
            k: cell if self.heads[k] != "threads" else f"threads {cell}"
            for k, cell in enumerate(row[: self.key_columns])
            if k != size and (self.heads[k] in ("threads", "size, mm") or not re.fullmatch(r"[\d.]*", cell))
        }

    def key(self, row):
        """By which a row is found on another page. Where an edge length is given, how many triangles that made is what the run found."""
        size = self.size_column()
        return (*self.words(row).values(), *([] if size is None or "size, mm" in self.heads else [row[size]]))

    def name(self, row):
        """The same of all sizes."""
        cells = [
            (cell if cell.startswith("threads ") else SIZE.sub("", cell).strip())
            for k, cell in self.words(row).items()
            if self.heads[k] not in ("size, mm",)
        ]
        cells += [] if self.size_column() is None else [SIZE.sub("", row[self.size_column()]).strip()]
        return ", ".join(cell for cell in cells if cell)

    def is_ours(self, row):
        return not any(PEERS.match(cell) for cell in self.key(row))

    def figures(self, row):
        """{head: number} of ours. Two columns of one name are told apart by what stands before them."""
        found, before = {}, ""
        for head, cell in list(zip(self.heads, row))[self.key_columns :]:
            name = head if head not in found else f"{head} ({before})"
            if head.endswith((", s", ", ms")):
                before = head
            if better(head) and re.fullmatch(r"\d+(\.\d+)?", cell):
                found[name] = float(cell)
        return found


def cells_of(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def tables_of(text):
    tables, section, lines = [], "", text.splitlines()
    for k, line in enumerate(lines):
        if line.startswith("## "):
            section = line[3:]
        elif line.startswith("|---"):
            tables.append(Table(section, cells_of(lines[k - 1])))
        elif line.startswith("| ") and not (k + 1 < len(lines) and lines[k + 1].startswith("|---")):
            tables[-1].rows.append(cells_of(line))
    return tables


def rows_of(text, ours):
    """{(section, key): (figures, the cells before them)} of our rows, or of the peers'."""
    return {
        (table.section.split(":")[0], table.key(row)): (table.figures(row), tuple(row[: table.key_columns]))
        for table in tables_of(text)
        for row in table.rows
        if table.is_ours(row) == ours
    }


def name_of(head):
    return head.split(" (")[0]


def slowness(before, now):
    """How many times as long peers took as before, on the same tasks: the median of their first times, and how many those are."""
    old, shares = rows_of(before, False), []
    for place, (figures, task) in rows_of(now, False).items():
        known, its_task = old.get(place, ({}, None))
        times = [head for head in figures if TIMES.search(name_of(head)) and known.get(head) and figures[head]]
        if times and task == its_task:
            shares.append(figures[times[0]] / known[times[0]])
    return (statistics.median(shares), len(shares)) if shares else (1.0, 0)


def lost_rows(before, now):
    """(section, key) of our rows before that are on the page no more."""
    return sorted(rows_of(before, True).keys() - rows_of(now, True).keys())


def worse_rows(before, now):
    """(section, row, figure, before, now) of every row of both texts that became worse by more than BOUND, by its worst figure; times
    and speeds count by what they are beyond the peers' slowness()."""
    known, (slow, _) = rows_of(before, True), slowness(before, now)
    found, compared = [], 0
    for table in tables_of(now):
        for row in table.rows:
            old, _ = known.get((table.section.split(":")[0], table.key(row)), (None, None))
            if old is None or not table.is_ours(row):
                continue
            compared += 1
            worst = None
            shares = {
                name: value / old[name] if better(name_of(name)) == LESS else old[name] / value
                for name, value in table.figures(row).items()
                if old.get(name) and value
            }
            shares = {
                name: share / slow if TIMES.search(name_of(name)) or RATES.search(name_of(name)) else share
                for name, share in shares.items()
            }
            growing = {name for name in shares if GROWTH.match(name_of(name))}
            gains = len(shares) > len(growing) and all(shares[name] < 1 for name in shares.keys() - growing)
            for name, share in shares.items():
                if gains and name in growing:
                    continue
                value = table.figures(row)[name]
                if share > 1 + BOUND and (worst is None or share > worst[0]):
                    worst = (share, name, old[name], value)
            if worst:
                found.append((table.section, table.key(row), *worst[1:]))
    return found, compared


def curves(text):
    """(section, what, [(size, time)]) of our rows that differ in their size alone."""
    found = {}
    for table in tables_of(text):
        times = [k for k, head in enumerate(table.heads) if re.search(r"(^|, )(s|ms)$", head) and better(head) == LESS]
        size = table.size_column()
        # Where fewer are built than there are, times do not grow.
        if not times or size is None or "loops built" in table.heads:
            continue
        for row in filter(table.is_ours, table.rows):
            width, height = SIZE.search(row[size]).groups()
            for time in times:
                what = ", ".join(word for word in (table.name(row), table.heads[time]) if word)
                if re.fullmatch(r"\d+(\.\d+)?", row[time]) and float(row[time]) > 0:
                    found.setdefault((table.section, what), []).append(
                        (int(width) * int(height or 1), float(row[time]))
                    )
    return [
        (section, what, sorted(points)) for (section, what), points in found.items() if len({n for n, _ in points}) > 1
    ]


def exponent(points):
    """Of the power that fits the times best: 1 where the time of one of many stays the same."""
    x, y = [math.log(n) for n, _ in points], [math.log(t) for _, t in points]
    return statistics.linear_regression(x, y).slope


def summary(before, commit, now):
    """The part of the page that nobody can overlook: it comes first."""
    lines = []
    if before:
        found, compared = worse_rows(before, now)
        slow, peers = slowness(before, now)
        lines.append(
            f"Peers on the same tasks took {slow:.2f} times as long as in {commit} (the median of {peers} rows): times and speeds count by "
            "what they are beyond that."
            if peers
            else "No peer has the same task as before: times are compared as they are."
        )
        lines.append("")
        lines.append(
            f"{len(found)} of {compared} rows are worse than in {commit} by more than {BOUND:.0%}"
            + (":" if found else ".")
        )
        lines.append("")
        lines += [
            f"- **{section.split(':')[0]}**, {', '.join(key)}: {figure} {old:g} -> {value:g}"
            for section, key, figure, old, value in found
        ]
        lost = lost_rows(before, now)
        if lost:
            lines += ["", f"Rows of {commit} that are here no more:", ""]
            lines += [f"- **{section}**, {', '.join(key)}" for section, key in lost]
    else:
        lines.append("There are no results to compare with.")
    lines += ["", "Exponents of growth (1: the time of one of many stays the same), plotted in RESULTS.svg:", ""]
    lines += [f"- {section.split(':')[0]}, {what}: {exponent(points):.2f}" for section, what, points in curves(now)]
    return "\n".join(lines).replace("\n\n\n", "\n\n") + "\n"


def plot(text):
    """An SVG file of every curve of growth, a panel for each section."""
    sections = {}
    for section, what, points in curves(text):
        sections.setdefault(section.split(":")[0], []).append((f"{what} ({exponent(points):.2f})", points))
    return plots.page(sections)
