"""What decks call yarns: the rules of the solvers, as their manuals have them, and the comments that say whose name is whose."""

import pathlib
import re

LONGEST = {"inp": 80, "cdb": 32, "k": 70, "bdf": 48, "unv": 24}
MARKS = {"inp": "**", "cdb": "!", "k": "$", "bdf": "$"}


def faults_of(names, kind):
    """What a solver would not take: names in a deck of this kind, all of one sort."""
    faults = []
    for name in names:
        if kind == "k":  # a title: text
            legal = name.strip() == name and name.isprintable() and not re.search(r"[*$,&]", name) and name
        else:
            legal = re.fullmatch(r"[A-Za-z][A-Za-z0-9_" + ("-" if kind in ("inp", "bdf") else "") + "]*", name)
        if not legal or len(name.encode()) > LONGEST[kind]:
            faults.append(f"{name!r} is no name")
        if kind == "cdb" and name.upper() in ("ALL", "STAT", "DEFA"):
            faults.append(f"{name!r} is a word of ANSYS")
    if len({name.upper() for name in names}) < len(names):
        faults.append(f"not unique: {sorted(names)}")
    return faults


def yarns_of(path):
    """Deck's name: yarn's own, of those that differ."""
    mark = MARKS[path.rpartition(".")[2]]
    yarns, name = {}, None
    for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines():
        comment = line[len(mark) :].strip() if line.startswith(mark) else ""
        begun = re.fullmatch(r"(.*) is yarn(?: '(.*)')?", comment)
        if begun:
            name, yarns[begun[1]] = begun[1], begun[2] or ""
            if begun[2] is not None:
                name = None
        elif name and re.fullmatch("'.*'", comment):
            yarns[name] += comment[1:-1]
        else:
            name = None
    return yarns


def by_yarns(sets, yarns):
    """The sets of a deck by the yarns' own names, in capitals."""
    named = {}
    for name, members in sets.items():
        for deck_name in sorted(yarns, key=len, reverse=True):
            if name.upper() == deck_name.upper() or name.upper().startswith(deck_name.upper() + "_"):
                name = yarns[deck_name] + name[len(deck_name) :]
                break
        named[name.upper()] = members
    return named
