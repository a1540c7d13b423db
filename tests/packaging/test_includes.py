"""The folders of src and formats: what includes what, in the order of the table in src/README.md, and how many files each has."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = re.compile(r'^#include "([\w./]+)"', re.MULTILINE)
MOST_FILES = 45
# Folders that are not divided yet, with what they have: no more may come.
LARGE = {"src/pipeline": 98, "src/core": 85, "src/cad": 51, "src/contact": 46, "formats/iges": 55}


def order():
    """The first column of the table: each folder knows those before it."""
    return re.findall(r"^\| `(?:\.\./)?(\w+)` \|", (ROOT / "src/README.md").read_text(), re.MULTILINE)


def sources():
    return [p for top in ("src", "formats") for p in sorted((ROOT / top).rglob("*")) if p.suffix in (".h", ".cpp")]


class Includes(unittest.TestCase):
    def test_go_only_down(self):
        rank = {room: number for number, room in enumerate(order())}
        for path in sources():
            parts = path.relative_to(ROOT).parts
            own = parts[1] if parts[0] == "src" else "formats"
            self.assertIn(own, rank, "a folder that is not in src/README.md")
            for name in INCLUDE.findall(path.read_text()):
                other = name.split("/")
                if len(other) == 1:
                    continue  # made by the build
                place = f"{'/'.join(parts)} includes {name}"
                self.assertIn(other[0], rank, place)
                self.assertLessEqual(rank[other[0]], rank[own], place)
                if len(parts) > 2 and own == other[0] == "formats" and len(other) > 2:
                    self.assertEqual(parts[1], other[1], f"a format knows no other one: {place}")

    def test_no_folder_is_large(self):
        count = {}
        for path in sources():
            folder = str(path.parent.relative_to(ROOT))
            count[folder] = count.get(folder, 0) + 1
        large = {folder: number for folder, number in count.items() if number > MOST_FILES}
        self.assertEqual(sorted(large), sorted(LARGE))
        for folder, number in large.items():
            self.assertLessEqual(number, LARGE[folder], folder)

    def test_all_folders_are_there(self):
        there = {path.name for path in (ROOT / "src").iterdir() if path.is_dir()} | {"formats"}
        self.assertEqual(sorted(order()), sorted(there))


if __name__ == "__main__":
    unittest.main()
