"""What campaigns begin with: small files, since an execution costs what its bytes cost. Files of exchange formats are cut: each
entity with all that it refers to becomes a file of its own."""

import re

EXTENSIONS = {".igs": {".igs", ".iges"}, ".stp": {".stp", ".step"}, ".knitout": {".knitout", ".k"}}
# IGES: these many of the first entities stay in every part, so that small numbers that are no pointers keep their meaning.
FIRST = 2


def closure(of, references):
    needed, todo = set(), [of]
    while todo:
        if (number := todo.pop()) not in needed:
            needed.add(number)
            todo += references(number)
    return sorted(needed)


def cut_step(text):
    """(kind, part)"""
    head, _, data = text.partition("DATA;")
    statements = dict(re.findall(r"(?s)#(\d+)\s*=\s*(.*?);\s*(?=#\d+\s*=|ENDSEC)", data))
    for number, body in statements.items():
        kept = closure(number, lambda n: [r for r in re.findall(r"#(\d+)", statements[n]) if r in statements])
        lines = "".join(f"#{n}={re.sub(chr(10) + ' *', '', statements[n])};\n" for n in sorted(kept, key=int))
        kind = re.match(r"\(?\s*(\w*)", body)[1]
        yield kind, f"{head}DATA;\n{lines}ENDSEC;\nEND-ISO-10303-21;\n"


def cut_iges(text):
    """(kind, part). Whole numbers that are odd and not too large are taken for pointers."""
    section = {letter: [line[:72] for line in text.splitlines() if line[72:73] == letter] for letter in "SGDP"}
    entities = []
    for one, two in zip(section["D"][::2], section["D"][1::2]):
        first, count = int(one[8:16]), int(two[24:32])
        entities.append((one, two, [line[:64] for line in section["P"][first - 1 : first - 1 + count]]))

    def is_pointer(word):
        return word.strip().lstrip("-").isdigit() and 0 < abs(int(word)) < 2 * len(entities) and int(word) % 2 == 1

    def fields(line):
        return [line[i : i + 8] for i in range(0, 72, 8)]

    def references(index):
        one, two, lines = entities[index]
        directory = [word for i, word in enumerate(fields(one)) if i in (2, 4, 6, 7)] + [fields(two)[2]]
        words = directory + re.findall(r"(?<=,)\s*-?\d+\s*(?=[,;])", "".join(lines))
        return [abs(int(word)) // 2 for word in words if is_pointer(word)]

    for index, (one, _, _) in enumerate(entities):
        kept = sorted(
            {n for start in [*range(FIRST), index] if start < len(entities) for n in closure(start, references)}
        )
        place = {2 * old + 1: 2 * new + 1 for new, old in enumerate(kept)}

        def moved(match):
            word = match[0]
            if not is_pointer(word) or abs(int(word)) not in place:
                return word
            return f"{place[abs(int(word))] * (-1 if int(word) < 0 else 1):{len(word)}}"

        directory, parameters = [], []
        for old in kept:
            a, b, lines = entities[old]
            a, b = fields(a), fields(b)
            for i in (2, 4, 6, 7):
                a[i] = re.sub(r".*", moved, a[i], count=1)
            b[2] = re.sub(r".*", moved, b[2], count=1)
            a[1] = f"{len(parameters) + 1:8}"
            directory += ["".join(a), "".join(b)]
            parameters += [
                f"{re.sub(r'(?<=,)-?[0-9]+(?=[,;])', moved, line):64}{place[2 * old + 1]:8}" for line in lines
            ]
        lines = [
            f"{line:72}{letter}{number:7}\n"
            for letter, all_lines in (("S", section["S"]), ("G", section["G"]), ("D", directory), ("P", parameters))
            for number, line in enumerate(all_lines, 1)
        ]
        counts = f"S{len(section['S']):7}G{len(section['G']):7}D{len(directory):7}P{len(parameters):7}"
        yield one[:8].strip(), "".join(lines) + f"{counts:72}T{1:7}\n"


CUTTERS = {".igs": cut_iges, ".stp": cut_step}


def write_seeds(folders, own, seeds, most, corpus):
    """Files of `folders` with the extension `seeds` of up to `most` bytes, their parts, and all of the folders `own`."""
    files = [
        path
        for folder in folders
        for path in sorted(folder.rglob("*"))
        if path.suffix.lower() in EXTENSIONS.get(seeds, {seeds} - {""}) and path.name != "CMakeLists.txt"
    ]
    for path in files:
        if path.stat().st_size <= most:
            (corpus / f"seed_{path.parent.name}_{path.name}").write_bytes(path.read_bytes())
        if seeds in CUTTERS:
            try:
                parts = list(CUTTERS[seeds](path.read_bytes().decode("latin-1")))
            except ValueError:  # spoilt on purpose
                continue
            smallest = {}
            for kind, part in parts:
                if len(part) <= most and len(part) < len(smallest.get(kind, part + " ")):
                    smallest[kind] = part
            for kind, part in smallest.items():
                (corpus / f"seed_{path.stem}_{kind}").write_bytes(part.encode("latin-1"))
    for folder in own:
        for path in folder.glob("*"):
            (corpus / f"seed_{folder.parent.name}_{path.name}").write_bytes(path.read_bytes())
