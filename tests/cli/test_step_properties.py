"""STEP files of yarns: Part 21 and the schema to the letter, and what a file says of volumes, areas, centres and densities against
the same computed anew from its entities."""

import json
import unittest

import numpy as np

import part21
import step_solids
from program import Case, SAMPLES

TOLERANCE = 1e-9
VALIDATION = "geometric validation property"
SCHEMAS = {
    "AP242": "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }",
    "AP214": "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
}


class StepProperties(Case):
    def products(self, source, *options):
        path = self.folder / "fabric.stp"
        report = self.folder / "report.json"
        self.succeeds("convert", source, "-o", path, "--report", report, *options)
        self.report = json.loads(report.read_text())["inputs"][0]
        self.file = part21.File(path.read_text("ascii"))
        part21.check(self.file)
        return step_solids.Products(self.file)

    def compare(self, products, definition):
        said, measured = products.said[definition], products.measure(definition)
        name = products.name(definition)
        area = said[VALIDATION, "surface area measure"]
        self.assertEqual(area[0], "AREA_MEASURE")
        self.assertLess(abs(area[1] / measured.area - 1), TOLERANCE, name)
        if not measured.is_closed:
            self.assertEqual(list(said), [(VALIDATION, "surface area measure")], name)
            return
        volume = said[VALIDATION, "volume measure"]
        self.assertEqual(volume[0], "VOLUME_MEASURE")
        self.assertLess(abs(volume[1] / measured.volume - 1), TOLERANCE, name)
        centre = np.array(said[VALIDATION, "centre point"])
        self.assertLess(np.linalg.norm(centre - measured.centre), TOLERANCE * np.sqrt(measured.area), name)

    def agrees(self, source, *options):
        """Every part and assembly; gives how many solids there are."""
        products = self.products(source, *options)
        for definition in products.representation:
            self.compare(products, definition)
        (root,) = (
            d
            for d in products.representation
            if not any(d == part for parts in products.components.values() for part, _ in parts)
        )
        self.assertEqual(len(products.components[root]) > 0, True)
        return products

    def test_samples(self):
        for sample in (
            "weave_plain",
            "jersey",
            "ring",
            "sections",
            "braid_tape",
            "ply3_z",
            "plain4_grid",
            "weave_racetrack",
        ):
            with self.subTest(sample=sample):
                products = self.agrees(SAMPLES / (sample + ".txt"))
                parts = [d for d in products.representation if products.solid(d) is not None]
                self.assertEqual(len(parts), len(self.report["yarns"]))
                names = {products.name(part): part for part in parts}
                for yarn in self.report["yarns"]:  # of the program's own reckoning
                    volume = products.measure(names[yarn["name"]]).volume
                    self.assertLess(abs(volume / yarn["volume"] - 1), TOLERANCE, yarn["name"])

    def test_ends(self):
        for style in ("patch", "fan", "planar"):
            with self.subTest(ends=style):
                self.agrees(SAMPLES / "plain4_path.txt", "--ends", style)

    def test_open_yarns(self):
        products = self.agrees(SAMPLES / "plain4_path.txt", "--ends", "none")
        self.assertFalse(any(name == "volume measure" for said in products.said.values() for _, name in said))

    def test_units_and_schemas(self):
        for schema, name in SCHEMAS.items():
            for unit in ("m", "inch"):
                with self.subTest(schema=schema, unit=unit):
                    self.agrees(SAMPLES / "plain4_path.txt", "--step-schema", schema, "--units", unit)
                    self.assertEqual(self.file.header["FILE_SCHEMA"], [[name]])

    def test_instances(self):
        products = self.agrees(SAMPLES / "weave_plain.txt", "--instances")
        parts = [d for d in products.representation if products.solid(d) is not None]
        self.assertLess(len(parts), len(self.report["yarns"]))

    def test_densities(self):
        """The mass of a yarn is its linear density by its length."""
        products = self.agrees(SAMPLES / "jersey.txt")
        names = {products.name(d): d for d in products.representation}
        for yarn in self.report["yarns"]:
            said = products.said[names[yarn["name"]]]
            kind, density = said["material property", "density measure"]
            self.assertEqual(kind, "POSITIVE_RATIO_MEASURE")
            grams = density * yarn["volume"] / 1000
            self.assertLess(abs(grams / (30e-6 * yarn["length"]) - 1), TOLERANCE)

    def test_layers(self):
        self.products(SAMPLES / "weave_plain.txt")
        layers = {}
        for number in self.file.all("PRESENTATION_LAYER_ASSIGNMENT"):
            name, _, items = self.file.one(number, "PRESENTATION_LAYER_ASSIGNMENT")
            layers[name] = {self.file.entities[item]["MANIFOLD_SOLID_BREP"][0] for item in items}
        names = {yarn["name"] for yarn in self.report["yarns"]}
        self.assertEqual(layers, {role: {name for name in names if name.startswith(role)} for role in ("warp", "weft")})

    def test_a_strict_reader(self):
        """What the reader of these tests takes for wrong."""
        self.products(SAMPLES / "ring.txt")
        text = (self.folder / "fabric.stp").read_text("ascii")
        for old, new in (
            ("ENDSEC;\nDATA;", "DATA;"),
            ("'volume measure'", "'volume\nmeasure'"),
            (" = EDGE_LOOP", " = EDGE_LOP"),
            ("CLOSED_SHELL('',", "CLOSED_SHELL("),
            (",.T.);\n", ",.T);\n"),
            ("LENGTH_UNIT() NAMED_UNIT(*)", "NAMED_UNIT(*) LENGTH_UNIT()"),
            ("DIRECTION('',(0.,0.,1.)", "DIRECTION('',(0,0.,1.)"),
            ("VERTEX_POINT('',#", "VERTEX_POINT('',#9999"),
            ("\nEND-ISO", "\n#1 = PLANE();\nEND-ISO"),
        ):
            with self.subTest(change=new):
                self.assertIn(old, text)
                with self.assertRaises(part21.Wrong):
                    part21.check(part21.File(text.replace(old, new, 1)))


if __name__ == "__main__":
    unittest.main()
