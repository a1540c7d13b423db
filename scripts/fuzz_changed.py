"""The fuzz targets whose reader differs from a commit, one a line: see scripts/fuzz --changed. A reader is its folder in formats/ (of
targets that are no format the sources below); what all readers share changes all of them."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
SHARED = re.compile(
    r"src/core/(base64|csv|number_text|source|text_\w+|words|xml_text)\.|formats/format\.h|tests/fuzz/(fuzzer|targets)\.(cpp|h)"
)
# Targets that are no format, and the sources that they read with; meshes and placings take too long for a few seconds.
OTHERS = {
    "results": r"formats/(frd|inp)/|src/results/solved_deck|tests/fuzz/field_mesh",
    "report": r"src/pipeline/(report|junit)|tests/fuzz/reports",
    "lists": r"src/pipeline/(inputs|parts)",
    "use": r"formats/(txt|wif|csv)/|src/pipeline/named_files|tests/fuzz/several_files",
    "expressions": r"formats/txt/|tests/fuzz/expression_text",
}
# What makes inputs for one reader.
MUTATIONS = {"txt": "|tests/fuzz/fabric_text", "iges": "|tests/fuzz/iges_mutation"}


def git(*arguments):
    return subprocess.run(["git", *arguments], cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()


def main():
    base = sys.argv[1]
    changed = git("diff", "--name-only", base) + git("ls-files", "--others", "--exclude-standard")
    is_reader = re.compile(r"\.read_(fabric|model|points|mesh|deck) =")
    readers = {path.parent.name for path in (ROOT / "formats").glob("*/*.cpp") if is_reader.search(path.read_text())}
    patterns = {**{name: f"formats/{name}/" + MUTATIONS.get(name, "") for name in readers}, **OTHERS}
    everything = any(SHARED.match(path) for path in changed)
    for name, pattern in sorted(patterns.items()):
        if everything or any(re.match(pattern, path) for path in changed):
            print(name)


if __name__ == "__main__":
    main()
