"""Our files in gmsh: every yarn of every sample becomes a volume of our size, filled with tetrahedra, and the mesh's volume
converges to ours with the second order that flat facets have.

gmsh exits with 0 when it made nothing: its tetrahedra are counted, and measured, here.
"""

import json
import math
import os
import re
import shutil
import subprocess
import unittest

import gmsh_mesh
from program import EVERYTHING, Case, GRID, PATH, RING

GMSH = os.environ.get("SELVAGE_GMSH") or shutil.which("gmsh")
# Edge lengths; every night a third one.
SIZES = (0.05, 0.035, 0.025) if EVERYTHING else (0.05, 0.035)
SEW = ["-setnumber", "Geometry.OCCSewFaces", "1", "-setnumber", "Geometry.OCCMakeSolids", "1"]


def tetrahedra_by_volume(path):
    """{volume: (tetrahedra, their volume)} of a mesh."""
    found = {}
    for entity, (a, b, c, d) in gmsh_mesh.elements(path, gmsh_mesh.TETRAHEDRON):
        u, v, w = ([q[k] - a[k] for k in range(3)] for q in (b, c, d))
        six = (
            u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0])
        )
        count, volume = found.get(entity, (0, 0.0))
        found[entity] = (count + 1, volume + six / 6)
    return found


class Gmsh(Case):
    def gmsh(self, *arguments):
        run = subprocess.run([GMSH, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True, timeout=600)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return run.stdout

    def names_of_volumes(self, file):
        """As gmsh shows them: what OpenCASCADE's documents (FreeCAD's, too) call the solids of the file."""
        program = (
            "import gmsh, sys\ngmsh.initialize()\ngmsh.option.setNumber('General.Terminal', 0)\n"
            "gmsh.option.setNumber('Geometry.OCCImportLabels', 1)\n"
            "for tag in gmsh.model.occ.importShapes(sys.argv[1]):\n"
            "    gmsh.model.occ.synchronize()\n    print('NAME', gmsh.model.getEntityName(*tag))\n"
        )
        run = subprocess.run(["/usr/bin/python3", "-c", program, file], capture_output=True, text=True, timeout=600)
        self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
        return [line[5:].rsplit("/", 1)[-1] for line in run.stdout.splitlines() if line.startswith("NAME ")]

    def test_solids_have_the_names_of_their_yarns(self):
        for to, options in (("iges", ["--iges-solid"]), ("step", [])):
            file = self.folder / f"named.{to}"
            self.succeeds("convert", GRID, "--to", to, *options, "-o", file)
            names = [
                yarn["name"] for yarn in json.loads(self.succeeds("info", "--json", GRID).stdout)["inputs"][0]["yarns"]
            ]
            self.assertGreater(len(names), 1)
            self.assertEqual(self.names_of_volumes(file), names, to)

    def script(self, file, how):
        """A gmsh script that reads the file. how: "solid" as it is; "sew"; "loop": gmsh's sewing makes no shell, so no
        solid, of one single face, not even of one that is closed: it is told that the ring's surface bounds a volume.
        """
        path = self.folder / "fabric.geo"
        path.write_text(
            'SetFactory("OpenCASCADE");\n'
            + ("Geometry.OCCSewFaces = 1;\nGeometry.OCCMakeSolids = 1;\n" if how == "sew" else "")
            + f'v() = ShapeFromFile("{file.name}");\n'
            + ("Surface Loop(1) = {1};\nVolume(1) = {1};\n" if how == "loop" else "")
            + 'w() = Volume{:};\nFor i In {0:#w()-1}\nm() = Mass Volume{w(i)};\nPrintf("mass %.16g", m(0));\nEndFor\n'
        )
        return path

    def cad_volumes(self, file, how):
        text = self.gmsh(self.script(file, how).name, "-parse_and_exit")
        return [float(m) for m in re.findall(r"mass (\S+)", text)]

    def convert(self, sample, suffix, *options):
        file = self.folder / ("fabric" + suffix)
        report = self.folder / "report.json"
        self.succeeds("convert", sample, "-o", file, "--report", report, *options)
        yarns = json.loads(report.read_text())["inputs"][0]["yarns"]
        return file, [yarn["volume"] for yarn in yarns]

    def judge(self, sample, suffix, sizes, *options, how):
        file, ours = self.convert(sample, suffix, *options)
        cad = self.cad_volumes(file, how)
        self.assertEqual(len(cad), len(ours), "one CAD volume a yarn")
        for a, b in zip(sorted(cad), sorted(ours)):
            self.assertLess(abs(a / b - 1), 1e-3, f"{file.name}: CAD volume {a} against {b}")
        errors = []
        for size in sizes:
            mesh = self.folder / "fabric.msh"
            self.gmsh(
                "fabric.geo" if how == "loop" else file.name,
                "-3",
                *(SEW if how == "sew" else []),
                "-format",
                "msh2",
                "-save_all",
                "-clmax",
                size,
                "-clmin",
                size,
                "-o",
                mesh.name,
            )
            filled = tetrahedra_by_volume(mesh)
            self.assertEqual(len(filled), len(ours), f"{file.name} at {size}: {filled}")
            for count, _ in filled.values():
                self.assertGreater(count, 0)
            errors.append(abs(sum(v for _, v in filled.values()) / sum(ours) - 1))
        order = math.log(errors[0] / errors[-1]) / math.log(sizes[0] / sizes[-1])
        print(
            f"{os.path.basename(str(sample))} {suffix} {' '.join(options)}: relative volume errors {errors}, order {order:.2f}",
            flush=True,
        )
        self.assertGreaterEqual(order, 1.8, errors)

    def every_form(self, sample, sizes, surfaces="sew"):
        for suffix, options, how in (
            (".igs", (), surfaces),
            (".igs", ("--iges-solid",), "solid"),
            (".stp", (), "solid"),
        ):
            with self.subTest(suffix=suffix, options=options):
                self.judge(sample, suffix, sizes, *options, how=how)

    def test_plain4_grid(self):
        self.every_form(GRID, SIZES)

    def test_plain4_path(self):
        self.every_form(PATH, SIZES)

    def test_ring(self):
        self.every_form(RING, [10 * size for size in SIZES], surfaces="loop")


if __name__ == "__main__":
    unittest.main()
