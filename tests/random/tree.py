"""A text of the input language as a tree of statements, and how it is made smaller."""

import re

NUMBER = re.compile(r"(?<![\w.\"-])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.\"])")


def parse(text):
    """[[line, rows or None], ...] by indentation; `end` closes what stands less deep."""
    lines = [line for line in text.splitlines() if line.strip() and not line.strip().startswith("#")]
    at = 0

    def depth(line):
        return len(line) - len(line.lstrip())

    def block(level):
        nonlocal at
        found = []
        while at < len(lines) and depth(lines[at]) >= level:
            line = lines[at].strip()
            if line == "end":
                break
            at += 1
            rows = None
            if at < len(lines) and depth(lines[at]) > level:
                rows = block(depth(lines[at]))
            if at < len(lines) and lines[at].strip() == "end" and depth(lines[at]) == level:
                at += 1
                rows = rows or []
            found.append([line, rows])
        return found

    return block(0)


def render(tree, indent=""):
    out = ""
    for line, rows in tree:
        out += f"{indent}{line}\n"
        if rows is not None:
            out += render(rows, indent + "  ") + f"{indent}end\n"
    return out


def blocks(tree, keyword):
    return [(line, rows or []) for line, rows in tree if line.split()[0] == keyword]


def places(tree, path=()):
    """The path of every statement, outer ones first."""
    level = [(*path, i) for i in range(len(tree))]
    for place, (_, rows) in zip(list(level), tree):
        if rows:
            level += places(rows, place)
    return level


def without(tree, gone, path=()):
    return [
        [line, without(rows, gone, (*path, i)) if rows is not None else None]
        for i, (line, rows) in enumerate(tree)
        if (*path, i) not in gone
    ]


def replaced(tree, place, line):
    if len(place) == 1:
        return [[line, rows] if i == place[0] else [old, rows] for i, (old, rows) in enumerate(tree)]
    return [
        [old, replaced(rows, place[1:], line)] if i == place[0] else [old, rows] for i, (old, rows) in enumerate(tree)
    ]


def line_at(tree, place):
    for i in place[:-1]:
        tree = tree[i][1]
    return tree[place[-1]][0]


def removals(tree):
    """Sets of statements to leave out: large pieces first."""
    every = [p for p in places(tree) if p != (0,)]
    by_depth = {}
    for place in every:
        by_depth.setdefault(place[:-1], []).append(place)
    for siblings in by_depth.values():
        size = len(siblings)
        while size > 1:
            size = (size + 1) // 2
            for k in range(0, len(siblings), size):
                if size > 1 or len(siblings) == 1:
                    yield set(siblings[k : k + size])
    for place in every:
        yield {place}


def simpler_numbers(word):
    """Simpler texts of a number."""
    if re.fullmatch(r"[-+]?\d+", word):
        value = int(word)
        return [str(v) for v in dict.fromkeys((0, 1, value // 2, value - 1)) if abs(v) < abs(value)]
    value = float(word)
    tries = ["0", f"{value:.0f}", f"{value:.1g}", f"{value:.2g}", f"{value:.3g}"]
    return [t for t in dict.fromkeys(tries) if len(t) < len(word) and not t.startswith("-0")]


def simplifications(tree):
    """Trees with simpler numbers: all at once, then one after the other."""

    def rounded(digits):
        return lambda m: f"{float(m[0]):.{digits}g}" if "." in m[0] or "e" in m[0] else m[0]

    def everywhere(rows, change):
        return [
            [NUMBER.sub(change, line), everywhere(inner, change) if inner is not None else None] for line, inner in rows
        ]

    for digits in (1, 2, 3, 4):
        yield everywhere(tree, rounded(digits))
    for place in places(tree):
        line = line_at(tree, place)
        if line.startswith(("fabric", "title")):
            continue
        for match in NUMBER.finditer(line):
            for word in simpler_numbers(match[0]):
                yield replaced(tree, place, line[: match.start()] + word + line[match.end() :])


def shrunk(text, still_fails, effort=40, width=12):
    """The smallest text found that still fails. `still_fails(texts)` judges several at once and gives a list of bools;
    it is asked at most `effort` times."""
    tree = parse(text)
    assert parse(render(tree)) == tree
    asked = 0

    def first(candidates):
        nonlocal asked
        seen, batch = {render(tree)}, []

        def ask():
            nonlocal asked
            asked += 1
            verdicts = still_fails([render(c) for c in batch])
            return next((c for c, bad in zip(batch, verdicts) if bad), None)

        for candidate in candidates:
            told = render(candidate)
            if told in seen:
                continue
            seen.add(told)
            batch.append(candidate)
            if len(batch) == width:
                found = ask()
                if found or asked >= effort:
                    return found
                batch = []
        return ask() if batch and asked < effort else None

    for steps in (lambda: (without(tree, gone) for gone in removals(tree)), lambda: simplifications(tree)):
        while asked < effort:
            smaller = first(steps())
            if smaller is None:
                break
            tree = smaller
    return render(tree)
