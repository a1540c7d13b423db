"""Plies and filaments from outside: `--detail`, and the groups in which IGES and STEP hold them."""

import json
import re
import unittest

from program import Case, SAMPLES

CABLED = SAMPLES / "cabled.txt"
PLIES = ["cord.ply1", "cord.ply2"]
FILAMENTS = [f"{ply}.f{k}" for ply in PLIES for k in range(1, 8)]


def step_tree(text):
    """Product name of each part: the name of the assembly that it stands in."""
    entities = {
        number: re.sub(r"\n\s*", "", body)
        for number, body in re.findall(r"^#(\d+) = (.*?);$", text, re.MULTILINE | re.DOTALL)
    }

    def product(definition):
        formation = re.match(r"PRODUCT_DEFINITION\('[^']*','[^']*',#(\d+)", entities[definition])[1]
        which = re.match(r"PRODUCT_DEFINITION_FORMATION\('[^']*','[^']*',#(\d+)", entities[formation])[1]
        return re.match(r"PRODUCT\(\s*'([^']*)'", entities[which])[1]

    uses = (
        re.match(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('[^']*','[^']*','[^']*',#(\d+),#(\d+)", body)
        for body in entities.values()
    )
    return {product(use[2]): product(use[1]) for use in uses if use}


def iges_groups(text):
    """Name of each 402 form 7: the names of its members that are such groups, too."""
    directory, parameters = {}, {}
    lines = text.splitlines()
    entries = [line for line in lines if line[72] == "D"]
    for first, second in zip(entries[::2], entries[1::2]):
        directory[int(first[73:])] = (int(first[:8]), int(second[32:40]))
    for line in lines:
        if line[72] == "P":
            parameters.setdefault(int(line[64:72]), []).append(line[:64].rstrip())
    value = {pointer: "".join(part).rstrip(";").split(",") for pointer, part in parameters.items()}
    groups = {pointer: value[pointer] for pointer, kind in directory.items() if kind == (402, 7)}
    names = {}
    for pointer, fields in groups.items():
        name = value[int(fields[-1])]  # the last pointer is the property with the name
        names[pointer] = re.match(r"\d+H(.*)", ",".join(name[2:]))[1]
    return {
        names[pointer]: [names[int(m)] for m in fields[2 : 2 + int(fields[1])] if int(m) in groups]
        for pointer, fields in groups.items()
    }


class Parts(Case):
    def converted(self, detail):
        report = self.folder / "report.json"
        self.succeeds("convert", CABLED, "--detail", detail, "-o", self.out, "--report", report, "--quiet")
        names = [yarn["name"] for yarn in json.loads(report.read_text())["inputs"][0]["yarns"]]
        return (
            names,
            step_tree((self.out / "cabled.stp").read_text()),
            iges_groups((self.out / "cabled.igs").read_text()),
        )

    def test_filaments_stand_in_a_group_of_their_yarn(self):
        names, step, iges = self.converted("filaments")
        self.assertEqual(names, FILAMENTS)
        self.assertEqual({part: step[part] for part in FILAMENTS}, dict.fromkeys(FILAMENTS, "cord"))
        self.assertEqual(iges, {**dict.fromkeys(FILAMENTS, []), "cord": FILAMENTS})
        self.assertEqual(len(step), len(FILAMENTS) + 1)

    def test_plies(self):
        names, step, iges = self.converted("plies")
        self.assertEqual(names, PLIES)
        self.assertEqual({part: step[part] for part in PLIES}, dict.fromkeys(PLIES, "cord"))
        self.assertEqual(iges, {**dict.fromkeys(PLIES, []), "cord": PLIES})

    def test_the_plain_yarn_has_no_group(self):
        names, step, iges = self.converted("yarn")
        self.assertEqual(names, ["cord"])
        self.assertEqual(len(step), 1)
        self.assertEqual(iges, {"cord": []})

    def test_info_says_what_was_taken_apart(self):
        self.assertIn("cord (14 parts)", self.succeeds("info", CABLED).stdout)
        self.assertNotIn("parts)", self.succeeds("info", CABLED, "--detail", "yarn").stdout)

    def test_solids_of_iges_are_grouped(self):
        self.succeeds("convert", CABLED, "--to", "iges", "--iges-solid", "--detail", "plies", "-o", self.out / "s.igs")
        self.assertEqual(list(iges_groups((self.out / "s.igs").read_text())), ["cord"])

    def test_a_detail_that_is_none(self):
        self.assertIn("--detail", self.fails(2, "convert", CABLED, "--detail", "fibres", "-o", self.out))

    def test_resume_does_a_changed_detail_again(self):
        report = self.folder / "report.json"
        for detail in ("yarn", "plies"):
            self.succeeds(
                "convert",
                CABLED,
                "--detail",
                detail,
                "-o",
                self.folder / "cord.igs",
                "--resume",
                "--report",
                report,
                "--quiet",
            )
        self.assertEqual(iges_groups((self.folder / "cord.igs").read_text())["cord"], PLIES)


if __name__ == "__main__":
    unittest.main()
