"""Solids of another program (gmsh, which writes by OpenCASCADE) through STEP: what is written is the solid that was read, by
OpenCASCADE's own reading of both files, or it is refused with a reason and there is no file. Names come back as they were."""

import json
import math
import os
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
    "fillet": ("Box(1) = {0,0,0, 3,2,1}; Fillet{1}{1:12}{0.2}",
               2.6 * 1.6 * 0.6 + 0.4 * (2.6 * 1.6 + 2.6 * 0.6 + 1.6 * 0.6) + math.pi * 0.04 * 4.8 + SPHERE * 0.008),
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

    def test_solids_stay_what_they_are_or_are_refused(self):
        written = 0
        for name, (_, volume) in SOLIDS.items():
            source, path = self.solid(name), self.folder / f"{name}.stp"
            done = run("convert", source, "-o", path)
            with self.subTest(solid=name):
                if done.returncode != 0:
                    self.assertEqual(done.returncode, 1)
                    self.assertRegex(done.stderr, rf"{name}.step:\d+:\d+: error: .* cannot be written as STEP: .*--to iges")
                    self.assertFalse(path.exists())
                    self.assertEqual(run("convert", source, "-o", self.folder / f"{name}.igs").returncode, 0)
                    continue
                written += 1
                after = json.loads(self.totals(path))
                self.assertEqual((after["solids"], after["valid"]), (1, 1))
                # OpenCASCADE's quadrature of rational surfaces is good for about a percent.
                self.assertAlmostEqual(after["volume"] / volume, 1, delta=0.03)
        self.assertGreaterEqual(written, 10)

    def test_backslashes_come_back(self):
        name = r"a\X2\0041\X0\b"
        text = self.folder / "bs.txt"
        text.write_text(f'fabric 1\ntolerance 0.05\nyarn "{name}"\n diameter 0.4\n path polyline\n 0 0 0\n 0 1 0\n end\nend\n')
        for end in (".stp", ".igs"):
            path = self.folder / f"bs{end}"
            self.succeeds("convert", text, "-o", path)
            self.assertIn(name, self.succeeds("info", path).stdout)
        # Of OpenCASCADE's own reader; the names there are not escaped.
        self.assertIn(f'["{name}"', self.totals(self.folder / "bs.stp"))


if __name__ == "__main__":
    unittest.main()
