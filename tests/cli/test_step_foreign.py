"""Solids of another program (gmsh, which writes by OpenCASCADE) through STEP: what is written is the solid that was read, by
OpenCASCADE's own reading of both files, or it is refused with a reason and there is no file. Names come back as they were."""

import json
import math
import os
import re
import shutil
import subprocess
import unittest

from program import Case, run

TOTALS = os.environ.get("OCCT_TOTALS", "build/bin/occt_totals")
GMSH = shutil.which("gmsh") or "gmsh"
CUT = "BooleanDifference{ Volume{1}; Delete; }{ Volume{2}; Delete; }"
SPHERE = 4 * math.pi / 3
# Each with its volume.
SOLIDS = {
    "fillet": (
        "Box(1) = {0,0,0, 3,2,1}; Fillet{1}{1:12}{0.2}",
        2.6 * 1.6 * 0.6 + 0.4 * (2.6 * 1.6 + 2.6 * 0.6 + 1.6 * 0.6) + math.pi * 0.04 * 4.8 + SPHERE * 0.008,
    ),
    "hole": ("Box(1) = {0,0,0, 3,2,1}; Cylinder(2) = {1,1,-1, 0,0,3, 0.4};" + CUT, 6 - 0.16 * math.pi),
    "void": ("Box(1) = {0,0,0, 3,2,1}; Box(2) = {1,0.5,0.25, 0.5,0.5,0.5};" + CUT, 5.875),
    "hollow_sphere": ("Sphere(1) = {0,0,0, 2}; Sphere(2) = {0,0,0, 1};" + CUT, 7 * SPHERE),
    "sphere": ("Sphere(1) = {0,0,0, 1};", SPHERE),
    "torus": ("Torus(1) = {0,0,0, 3, 1, 2*Pi};", 6 * math.pi**2),
    "torus_part": ("Torus(1) = {0,0,0, 3, 1, 1.5};", 4.5 * math.pi),
    "cone": ("Cone(1) = {0,0,0, 0,0,2, 1, 0};", 2 * math.pi / 3),
    "frustum": ("Cone(1) = {0,0,0, 0,0,2, 1, 0.5};", 1.75 * 2 * math.pi / 3),
    "cone_cut": ("Cone(1) = {0,0,0, 0,0,2, 1, 0}; Box(2) = {-2,-2,0.5, 4,2.3,0.6};" + CUT, 1.541663044),
    "sphere_hole": ("Sphere(1) = {0,0,0, 1}; Cylinder(2) = {0,0,-2, 0,0,4, 0.4};" + CUT, SPHERE * 0.84**1.5),
    "cylinder": ("Cylinder(1) = {0,0,0, 0,0,3, 0.5};", 0.75 * math.pi),
    "wedge": ("Wedge(1) = {0,0,0, 2,2,2, 1};", 6),
}
# An assembly of one part that stands in a file of its own.
OUTSIDE = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('all.step','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('automotive design');
#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2001,#1);
#3=PRODUCT_CONTEXT('',#1,'mechanical');
#4=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'');
#10=PRODUCT('all','all','',(#3));
#11=PRODUCT_DEFINITION_FORMATION('','',#10);
#12=PRODUCT_DEFINITION('','',#11,#4);
#13=PRODUCT_DEFINITION_SHAPE('','',#12);
#14=SHAPE_REPRESENTATION('',(#50,#51),#60);
#15=SHAPE_DEFINITION_REPRESENTATION(#13,#14);
#20=PRODUCT('part','part','',(#3));
#21=PRODUCT_DEFINITION_FORMATION('','',#20);
#22=PRODUCT_DEFINITION('','',#21,#4);
#23=PRODUCT_DEFINITION_SHAPE('','',#22);
#24=SHAPE_REPRESENTATION('',(#50),#60);
#25=SHAPE_DEFINITION_REPRESENTATION(#23,#24);
#30=NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','1','',#12,#22,$);
#31=PRODUCT_DEFINITION_SHAPE('','',#30);
#32=ITEM_DEFINED_TRANSFORMATION('','',#50,#51);
#33=(REPRESENTATION_RELATIONSHIP('','',#24,#14)REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#32)SHAPE_REPRESENTATION_RELATIONSHIP());
#34=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#33,#31);
#40=DOCUMENT_TYPE('geometry');
#41=DOCUMENT_FILE('part.step','','',#40,'',$);
#42=DOCUMENT_REPRESENTATION_TYPE('digital',#41);
#43=APPLIED_DOCUMENT_REFERENCE(#41,'',(#22));
#44=IDENTIFICATION_ROLE('external document id and location',$);
#45=EXTERNAL_SOURCE(IDENTIFIER(''));
#46=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('part.step',#44,#45,(#41));
#47=PROPERTY_DEFINITION('external definition','',#41);
#48=PROPERTY_DEFINITION_REPRESENTATION(#47,#24);
#50=AXIS2_PLACEMENT_3D('',#52,#53,#54);
#51=AXIS2_PLACEMENT_3D('',#55,#53,#54);
#52=CARTESIAN_POINT('',(0.,0.,0.));
#53=DIRECTION('',(0.,0.,1.));
#54=DIRECTION('',(1.,0.,0.));
#55=CARTESIAN_POINT('',(10.,0.,0.));
#60=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#61,#62,#63))REPRESENTATION_CONTEXT('',''));
#61=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#62=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#63=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
ENDSEC;
END-ISO-10303-21;
"""


class Foreign(Case):
    def totals(self, path):
        return subprocess.run([TOTALS, str(path)], capture_output=True, text=True, check=True).stdout

    def solid(self, name):
        """A STEP file of gmsh with this solid."""
        source, geo = (self.folder / f"{name}{end}" for end in (".step", ".geo"))
        geo.write_text(f'SetFactory("OpenCASCADE");\n{SOLIDS[name][0]}\nSave "{source}";\n')
        subprocess.run([GMSH, "-0", str(geo)], capture_output=True, cwd=self.folder, timeout=300)
        self.assertTrue(source.is_file(), name)
        return source

    def test_solids_stay_solids_in_iges(self):
        for name, (_, volume) in SOLIDS.items():
            with self.subTest(solid=name):
                path = self.folder / f"{name}.igs"
                done = run("convert", self.solid(name), "-o", path, "--quiet")
                self.assertEqual((done.returncode, done.stderr), (0, ""))
                # Also what could be a yarn: a rod, a ring.
                report = json.loads(run("info", path, "--json").stdout)["inputs"][0]
                self.assertEqual(report["entities"].get("186"), 1)
                after = json.loads(self.totals(path))
                self.assertEqual((after["solids"], after["valid"]), (1, 1))
                self.assertAlmostEqual(after["volume"] / volume, 1, delta=0.03)

    def test_flat_ends_are_as_round_as_they_were(self):
        """A rod is read as a yarn; OpenCASCADE's own projection of its circles would be off by 2e-6."""
        path = self.folder / "rod.igs"
        self.assertEqual(run("convert", self.solid("cylinder"), "-o", path).returncode, 0)
        self.assertAlmostEqual(json.loads(self.totals(path))["volume"] / SOLIDS["cylinder"][1], 1, delta=5e-7)

    def test_solids_stay_what_they_are_or_are_refused(self):
        written = 0
        for name, (_, volume) in SOLIDS.items():
            source, path = self.solid(name), self.folder / f"{name}.stp"
            done = run("convert", source, "-o", path)
            with self.subTest(solid=name):
                if done.returncode != 0:
                    self.assertEqual(done.returncode, 1)
                    self.assertRegex(
                        done.stderr, rf"{name}.step:\d+:\d+: error: .* cannot be written as STEP: .*--to iges"
                    )
                    self.assertFalse(path.exists())
                    self.assertEqual(run("convert", source, "-o", self.folder / f"{name}.igs").returncode, 0)
                    continue
                written += 1
                after = json.loads(self.totals(path))
                self.assertEqual((after["solids"], after["valid"]), (1, 1))
                # OpenCASCADE's quadrature of rational surfaces is good for about a percent.
                self.assertAlmostEqual(after["volume"] / volume, 1, delta=0.03)
        self.assertGreaterEqual(written, 10)

    def with_statements(self, name, statements):
        """That solid's file with more statements; `{SHELL}`, `{CONTEXT}`, `{REPRESENTATION}`, `{FACE}` are its own."""
        text = self.solid(name).read_text()
        for word, type_name in (
            ("SHELL", "CLOSED_SHELL"),
            ("CONTEXT", "\\( ?GEOMETRIC_REPRESENTATION_CONTEXT"),
            ("REPRESENTATION", "ADVANCED_BREP_SHAPE_REPRESENTATION"),
            ("FACE", "ADVANCED_FACE"),
        ):
            statements = statements.replace("{" + word + "}", re.search(rf"(#\d+) ?= ?{type_name}", text)[1])
        path = self.folder / f"{name}_more.step"
        path.write_text(text.replace("ENDSEC;\nEND-ISO", statements + "\nENDSEC;\nEND-ISO"))
        return path

    def test_what_no_shape_depends_on_is_left_out(self):
        path = self.with_statements(
            "hole",
            "#9001=PRESENTATION_STYLE_ASSIGNMENT($);\n#9002=STYLED_ITEM('',(#9001),{FACE});\n"
            "#9003=REPRESENTATION('density',(#9003),{CONTEXT});\n#9004=OVER_RIDING_STYLED_ITEM('',(),{FACE},$);\n"
            "#9005=DESCRIPTIVE_REPRESENTATION_ITEM('steel');\n#9006=REPRESENTATION('material',(#9005),{CONTEXT});",
        )
        done = run("convert", path, "-o", self.folder / "out.stp")
        self.assertEqual(done.returncode, 0, done.stderr)
        for number in (9001, 9003, 9004, 9005):
            self.assertRegex(
                done.stderr,
                rf"hole_more.step:\d+:\d+: warning: #{number}.*; it is left out, since no shape depends on it",
            )
        after = json.loads(self.totals(self.folder / "out.stp"))
        self.assertEqual((after["solids"], after["valid"]), (1, 1))
        # Of a face it is an error.
        path = self.with_statements("hole", "#9001=ADVANCED_FACE('',$,$,.T.);")
        self.assertRegex(
            run("convert", path, "-o", self.folder / "no.stp").stderr,
            r": error: #9001: attribute 2 of ADVANCED_FACE is '\$'",
        )

    def test_two_representations_of_one_shape_are_no_faces_twice(self):
        path = self.with_statements(
            "hole",
            "#9001=SHELL_BASED_SURFACE_MODEL('',({SHELL}));\n"
            "#9002=MANIFOLD_SURFACE_SHAPE_REPRESENTATION('',(#9001),{CONTEXT});\n"
            "#9003=SHAPE_REPRESENTATION_RELATIONSHIP('','',{REPRESENTATION},#9002);",
        )
        done = run("check", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("14", done.stdout)  # faces: each of the seven is read twice
        self.assertNotIn("the same face", done.stderr)

    def test_parts_beside_the_assembly_are_found_from_anywhere(self):
        folder = self.folder / "below"
        folder.mkdir()
        shutil.copy(self.solid("void"), folder / "part.step")
        (folder / "all.step").write_text(OUTSIDE)
        for place, name in ((folder, "all.step"), (self.folder, "below/all.step"), (self.folder, folder / "all.step")):
            out = self.folder / "all.stp"
            done = run("convert", name, "-o", out, cwd=place)
            self.assertEqual(done.returncode, 0, done.stderr)
            after = json.loads(self.totals(out))
            self.assertEqual((after["solids"], after["valid"]), (1, 1))
            self.assertAlmostEqual(after["volume"], SOLIDS["void"][1], delta=1e-6)
            (part,) = json.loads(run("info", out, "--json").stdout)["inputs"][0]["parts"]
            self.assertAlmostEqual(part["box"][0][0], 10, delta=1e-6)  # where it is placed
            out.unlink()

    def test_iges_states_no_coarser_resolution_than_edges_need(self):
        """A file that calls 0.01 mm one point and whose edges all meet: receivers would bend them by so much."""
        source = self.solid("hole")
        text, count = re.subn(
            r"(UNCERTAINTY_MEASURE_WITH_UNIT\(LENGTH_MEASURE\()[^)]*", r"\g<1>1.E-02", source.read_text()
        )
        self.assertGreater(count, 0)
        source.write_text(text)
        run("convert", source, "-o", self.folder / "out.igs")
        stated = {
            path: float(re.search(r"resolution (\S+)", run("info", path).stdout)[1])
            for path in (source, self.folder / "out.igs")
        }
        self.assertEqual(stated[source], 0.01)
        self.assertLess(stated[self.folder / "out.igs"], 2e-5)

    def test_backslashes_come_back(self):
        name = r"a\X2\0041\X0\b"
        text = self.folder / "bs.txt"
        text.write_text(
            f'fabric 1\ntolerance 0.05\nyarn "{name}"\n diameter 0.4\n path polyline\n 0 0 0\n 0 1 0\n end\nend\n'
        )
        for end in (".stp", ".igs"):
            path = self.folder / f"bs{end}"
            self.succeeds("convert", text, "-o", path)
            self.assertIn(name, self.succeeds("info", path).stdout)
        # Of OpenCASCADE's own reader; the names there are not escaped.
        self.assertIn(f'["{name}"', self.totals(self.folder / "bs.stp"))


if __name__ == "__main__":
    unittest.main()
