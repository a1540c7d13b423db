"""The pore space of unit cells, `mesh --pores`, and scripts/permeability: the files read by other programs or by their description,
and the flow against arrays of cylinders that are solved without a mesh (array_flow.py)."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
import unittest

import gmsh
import meshio
import numpy as np

import array_flow
from poly_mesh import PolyMesh
from program import Case, ROOT, run

SCRIPTS = ROOT / "scripts"
# SELVAGE_TABLE: all arrays and both solvers, some minutes.
IS_LONG = bool(os.environ.get("SELVAGE_TABLE"))
SHARES = {"square": (0.2, 0.4, 0.6), "hexagonal": (0.2, 0.4, 0.6)}
# F / (mu U) of square arrays across, from the table of A. S. Sangani, A. Acrivos, Int. J. Multiphase Flow 8 (1982) 193-206.
PUBLISHED = {0.05: 15.56, 0.1: 24.83, 0.2: 51.53, 0.3: 102.90, 0.4: 217.89, 0.5: 532.55, 0.6: 1763.0}
LENGTH = 0.3  # of the arrays' cells along the cylinders; the pitch is 1


def text_of(yarns, box, section, periodic="x y z", names=None):
    """Straight yarns along x, by their places across it."""
    rows = "".join(
        f"yarn {names[k] if names else f'rod_{k}'} rod\n  path\n    -1 {y!r} {z!r}\n    {box[0] + 1!r} {y!r} {z!r}\n  end\nend\n"
        for k, (y, z) in enumerate(yarns)
    )
    return (
        f"fabric 1\nunits mm\ntolerance 1e-5\nthread rod\n  section {section}\nend\n{rows}"
        f"cell 0 0 0  {box[0]!r} {box[1]!r} {box[2]!r}\n  periodic {periodic}\nend\n"
    )


def array(kind, share):
    """A cell of cylinders, one in its middle; of the hexagonal array also quarters at the edges."""
    section = f"circle {2 * array_flow.radius_of(kind, share)!r}"
    if kind == "square":
        return text_of([(0.5, 0.5)], (LENGTH, 1.0, 1.0), section)
    height = math.sqrt(3)
    corners = [(y, z) for y in (0.0, 1.0) for z in (0.0, height)]
    return text_of([(0.5, height / 2), *corners], (LENGTH, 1.0, height), section)


class Pores(Case):
    def mesh(self, text, *options, to=".foam"):
        """The pores of a text in a file, what the console says, and the report of the mesh."""
        cell, report = self.folder / "cell.txt", self.folder / "report.json"
        cell.write_text(text)
        name = self.folder / f"pores{to}"
        done = self.succeeds("mesh", cell, "--pores", *options, "-o", name, "--report", report)
        return name, done.stdout + done.stderr, json.loads(report.read_text())["inputs"][0]["mesh"]

    def test_a_case_of_openfoam(self):
        radius, box = 0.35, (0.3, 1.0, 0.9)
        text = text_of([(0.5, 0.45)], box, f"circle {2 * radius!r}", names=['"warp 1"'])
        case, said, facts = self.mesh(text, "--periodic", "--size", "0.15")
        mesh = PolyMesh(case)
        self.assertEqual(mesh.faults(), [])
        self.assertEqual(list(mesh.patches), ["warp_1", "x_low", "x_high", "y_low", "y_high", "z_low", "z_high"])
        self.assertEqual([patch["type"] for patch in mesh.patches.values()], ["wall"] + 6 * ["cyclic"])
        exact = 1e-9 * box[0] * (box[1] * box[2] - math.pi * radius**2)
        self.assertAlmostEqual(mesh.volumes().sum() / exact, 1, delta=1e-3)
        wall = mesh.points[np.unique(mesh.faces[mesh.of_patch("warp_1")])]
        distance = np.hypot(wall[:, 1] - 0.5e-3, wall[:, 2] - 0.45e-3)
        self.assertLess(np.abs(distance / (1e-3 * radius) - 1).max(), 0.03)
        for axis, name in enumerate("xyz"):
            for end, place in (("low", 0.0), ("high", 1e-3 * box[axis])):
                faces = mesh.of_patch(f"{name}_{end}")
                self.assertTrue(np.allclose(mesh.middles[faces][:, axis], place, atol=1e-15))
                outward = mesh.areas[faces][:, axis] * (1 if end == "high" else -1)
                self.assertGreater(outward.min(), 0)
        self.assertIn("passages along x, y, z", said)
        self.assertAlmostEqual(facts["porosity"], 1e9 * mesh.volumes().sum() / math.prod(box), places=9)
        self.check_by_openfoam(case)

    def check_by_openfoam(self, case):
        if shutil.which("checkMesh") is None:
            return
        settings = {"WM_PROJECT_DIR": "/usr/share/openfoam", **os.environ}
        done = subprocess.run(["checkMesh", "-case", case], capture_output=True, text=True, env=settings, check=False)
        self.assertIn("Mesh OK", done.stdout, done.stdout[-2000:])

    def test_open_faces_and_names(self):
        """Two yarns whose names become the same word; faces across z, which the text does not name, are open."""
        text = text_of([(0.25, 0.5), (0.75, 0.5)], (0.3, 1.0, 1.0), "circle 0.3", "x y", names=['"a b"', "a_b"])
        case, said, _ = self.mesh(text, "--periodic", "--size", "0.15")
        mesh = PolyMesh(case)
        self.assertEqual(mesh.faults(), [])
        walls = [name for name, patch in mesh.patches.items() if patch["type"] == "wall"]
        self.assertEqual(len(set(walls)), 2)
        self.assertIn("a_b", walls)
        self.assertEqual(list(mesh.patches)[-2:], ["inlet_z", "outlet_z"])
        self.assertEqual(mesh.patches["inlet_z"]["type"], "patch")
        self.assertLess(mesh.middles[mesh.of_patch("inlet_z")][:, 2].max(), 1e-15)
        self.check_by_openfoam(case)

    def test_other_formats_hold_the_same(self):
        cell = self.folder / "cell.txt"
        cell.write_text(array("square", 0.4))
        self.succeeds("mesh", cell, "--pores", "--periodic", "--to", "foam,msh,cdb,vtu", "-o", self.folder)
        foam, msh, vtu = (
            PolyMesh(self.folder / "cell.foam"),
            meshio.read(self.folder / "cell.msh"),
            meshio.read(self.folder / "cell.vtu"),
        )
        places = np.unique(np.round(1e3 * foam.points, 9), axis=0)
        for mesh in (msh, vtu):  # Gmsh's file has them in another order
            self.assertTrue(np.array_equal(np.unique(np.round(mesh.points, 9), axis=0), places))
            tetrahedra = np.concatenate([block.data for block in mesh.cells if block.type == "tetra"])
            self.assertEqual(len(tetrahedra), foam.cells)
        for name in foam.patches:
            tag = msh.field_data[name][0]
            found = sum(
                (msh.cell_data["gmsh:physical"][k] == tag).sum()
                for k, block in enumerate(msh.cells)
                if block.type == "triangle"
            )
            self.assertEqual(found, int(foam.patches[name]["nFaces"]), name)
        self.assertIn("pores", msh.field_data)
        archive = (self.folder / "cell.cdb").read_text()
        for name in foam.patches:
            count, body = re.search(
                rf"^CMBLOCK,{name},NODE,\s*(\d+)\n\(8i10\)\n((?:[ \d]+\n)+)", archive, re.MULTILINE
            ).groups()
            nodes = np.unique(foam.faces[foam.of_patch(name)]) + 1
            self.assertEqual([int(word) for word in body.split()], nodes.tolist())
            self.assertEqual(int(count), len(nodes))
        self.assertIn("ET,1,200\nKEYOPT,1,1,8\n", archive)

    def test_curved_ones(self):
        """Of order 2 midside nodes stand on the cylinder."""
        path, _, facts = self.mesh(array("square", 0.4), "--periodic", "--order", "2", "--to", "msh", to=".msh")
        mesh = meshio.read(path)
        self.assertEqual({block.type for block in mesh.cells}, {"vertex", "line3", "triangle6", "tetra10"})
        self.assertAlmostEqual(facts["porosity"], 0.6, delta=1e-4)

    def test_layers(self):
        """Three layers, each 1.2 times as thick as the one before it: where their nodes stand round a cylinder, what they fill, and
        that elements are as positive for Gmsh as for OpenFOAM."""
        radius, thickness, count = array_flow.radius_of("square", 0.4), 0.03, 3
        plain = PolyMesh(self.mesh(array("square", 0.4), "--periodic", "--segments", "20")[0])
        case, said, facts = self.mesh(
            array("square", 0.4),
            "--periodic",
            "--segments",
            "20",
            "--layers",
            str(count),
            "--layer-thickness",
            str(thickness),
        )
        mesh, wedges = PolyMesh(case), facts["layers"]["wedges"]
        self.assertEqual(mesh.faults(wedges), [])
        self.assertEqual(mesh.cells - wedges, plain.cells)
        self.assertEqual(wedges, count * int(plain.patches["rod_0"]["nFaces"]))
        self.assertAlmostEqual(mesh.volumes().sum() / plain.volumes().sum(), 1, places=12)
        self.assertIn(f"{wedges} wedges in 3 layers along the walls, 0.03 mm thick on average", said)
        # From the wall: the nodes of faces of wedges alone lie at these distances.
        is_wedge = mesh.owner >= plain.cells
        is_wedge[: len(mesh.neighbour)] &= mesh.neighbour >= plain.cells
        nodes = np.unique(mesh.faces[is_wedge])
        distances = np.hypot(1e3 * mesh.points[nodes, 1] - 0.5, 1e3 * mesh.points[nodes, 2] - 0.5)
        wall = np.hypot(*(1e3 * mesh.points[np.unique(mesh.faces[mesh.of_patch("rod_0")])][:, 1:] - 0.5).T)
        rises = np.cumsum([0] + [1.2**k for k in range(count)]) / sum(1.2**k for k in range(count)) * thickness
        off = np.abs(distances[:, None] - wall.mean() - rises).min(axis=1)
        # Nodes of the wall are not all equally far out, and of a chord's normal the mean is taken.
        self.assertLess(off.max(), 2 * np.abs(wall - wall.mean()).max() + 0.02 * thickness)
        self.assertEqual(len(nodes), (count + 1) * len(wall))
        self.assertLess(np.abs(wall - radius).max(), 0.02 * radius)
        self.check_by_openfoam(case)

    def test_layers_in_other_formats(self):
        cell = self.folder / "cell.txt"
        cell.write_text(array("square", 0.4))
        self.succeeds("mesh", cell, "--pores", "--periodic", "--layers", "2", "--to", "foam,msh,vtu", "-o", self.folder)
        foam = PolyMesh(self.folder / "cell.foam")
        places = np.unique(np.round(1e3 * foam.points, 9), axis=0)
        for name in ("cell.msh", "cell.vtu"):
            mesh = meshio.read(self.folder / name)
            self.assertTrue(np.array_equal(np.unique(np.round(mesh.points, 9), axis=0), places))
            count = {
                kind: sum(len(block.data) for block in mesh.cells if block.type == kind) for kind in ("tetra", "wedge")
            }
            self.assertEqual(count["tetra"] + count["wedge"], foam.cells)
            self.assertEqual(foam.faults(count["wedge"]), [])
        gmsh.initialize(["gmsh", "-v", "1"])
        try:
            gmsh.open(str(self.folder / "cell.msh"))
            quads = {
                gmsh.model.getPhysicalName(2, tag): sum(
                    len(gmsh.model.mesh.getElementsByType(3, entity)[0])
                    for entity in gmsh.model.getEntitiesForPhysicalGroup(2, tag)
                )
                for _, tag in gmsh.model.getPhysicalGroups(2)
            }
            volume = 0
            for kind in (4, 6):
                points, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss4")
                _, determinants, _ = gmsh.model.mesh.getJacobians(kind, points)
                self.assertGreater(determinants.min(), 0)
                volume += (determinants.reshape(-1, len(weights)) @ weights).sum()
            links = {tag: len(gmsh.model.mesh.getPeriodicNodes(2, tag)[1]) for _, tag in gmsh.model.getEntities(2)}
        finally:
            gmsh.finalize()
        self.assertAlmostEqual(volume / (1e9 * foam.volumes().sum()), 1, places=9)
        for name, patch in foam.patches.items():
            faces = foam.faces[foam.of_patch(name)]
            self.assertEqual(quads[name], (faces[:, 2] != faces[:, 3]).sum())
        for high in ("x_high", "y_high", "z_high"):
            self.assertIn(len(np.unique(foam.faces[foam.of_patch(high)])), links.values())

    def test_layers_over_open_and_oblique_faces(self):
        """An oblique cell of a weave, stacked, whose yarns cross its faces at any angle; and one with open faces."""
        text = (ROOT / "samples" / "cell_twill.txt").read_text()
        for periodic in ("x y", "x y z"):
            given = text.replace("  periodic x y\n", f"  periodic {periodic}\n")
            if periodic == "x y z":
                given = given.replace("-1.2 1.2 0", "-1.2 1.2 0  0 0 1.2").replace("ellipse 0.8 0.3", "ellipse 0.8 0.5")
            case, said, facts = self.mesh(given, "--periodic", "--size", "0.4", "--layers", "2")
            mesh = PolyMesh(case)
            self.assertEqual(mesh.faults(facts["layers"]["wedges"]), [])
            self.assertGreater(facts["layers"]["min_scaled_jacobian"], 0)
            self.assertIn("neighbours are in the way", said)
            self.assertGreater(facts["layers"]["thinned"], 0)
            self.assertAlmostEqual(1e9 * mesh.volumes().sum() / facts["volume"], 1, places=9)

    def test_what_is_shut_is_said(self):
        """A wall across z, from end to end of the cell along x and y: periodic, and with open faces."""
        section = "polygon\n    -1 -0.15\n    1 -0.15\n    1 0.15\n    -1 0.15\n  end"
        for periodic in ("x y z", "x y"):
            text = text_of([(0.5, 0.5)], (0.3, 1.0, 1.0), section, periodic)
            case, said, facts = self.mesh(text, "--periodic", "--size", "0.15")
            self.assertEqual(PolyMesh(case).faults(), [])
            self.assertEqual(facts["passages"]["along"], "x, y")
            self.assertIn("nothing can flow along z", said)

    def test_errors(self):
        cell = self.folder / "cell.txt"
        cell.write_text(array("square", 0.4))
        for words, wanted in (
            (["--pores", "--matrix", "-o", "x.msh"], "--pores is the space that the yarns leave"),
            (
                ["--pores", "--to", "inp"],
                "inp does not hold --pores: write them with --to cdb --to msh --to vtu --to foam",
            ),
            (["--pores", "--order", "2", "--to", "foam"], "or with --order 1"),
            (["--periodic", "--to", "foam"], "add --pores"),
            (["--pores", "--to", "foam", "-o", "-"], "foam is a folder"),
            (["--pores", "--voxel", "5", "--to", "vtu"], "--pores is the space that the yarns leave"),
            (
                ["--pores", "--layers", "3", "--to", "cdb"],
                "cdb does not hold --layers: write them with --to msh --to vtu --to foam",
            ),
            (
                ["--pores", "--layers", "3", "--order", "2", "--to", "msh"],
                "--layers is of tetrahedra and wedges with straight edges",
            ),
            (["--matrix", "--layers", "3", "--to", "msh"], "--layers is of walls round a fluid"),
            (["--pores", "--layer-thickness", "0.1", "--to", "msh"], "--layer-thickness is of layers along walls"),
        ):
            done = run("mesh", cell, *words, cwd=self.folder)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(wanted, done.stderr)
        self.assertFalse((self.folder / "cell.foam").exists())


class Permeability(Case):
    def permeability(self, text, *options):
        cell, result = self.folder / "cell.txt", self.folder / "result.json"
        cell.write_text(text)
        done = subprocess.run(
            [SCRIPTS / "permeability", cell, "--json", result, *options], capture_output=True, text=True, check=False
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(result.read_text(), parse_constant=self.fail), done.stdout  # NaN is no JSON

    def check_array(self, kind, share, *options, within=0.02):
        result, _ = self.permeability(array(kind, share), *options)
        tensor = np.array(result["permeability_mm2"])
        wanted = [array_flow.along(kind, share)] + 2 * [array_flow.across(kind, share)]
        off = np.diag(tensor) / wanted - 1
        if IS_LONG:
            errors = [round(100 * result["error_mm2"][k][k] / tensor[k, k], 2) for k in range(3)]
            print(
                f"{kind} {share} {result['solver']}: off by {np.round(100 * off, 2)} %, error said {errors} %, asymmetry {result['asymmetry']:.1e}",
                flush=True,
            )
        self.assertLess(np.abs(off).max(), within, f"{kind} {share}")
        self.assertLess(result["asymmetry"], 0.01 if result["solver"] == "own" else 0.05)

    def test_series(self):
        """The plane solution has the published values."""
        for share, force in PUBLISHED.items():
            if IS_LONG or share in (0.2, 0.6):
                self.assertAlmostEqual(1 / array_flow.across("square", share) / force, 1, delta=4e-4)
        # Drummond and Tahir, Int. J. Multiphase Flow 10 (1984) 515-540, at low shares: K over the radius squared.
        for kind, constant in (("square", 1.476335), ("hexagonal", 1.497505)):
            share = 0.05
            low = (
                (-math.log(share) - constant + 2 * share - share**2 / 2)
                / (4 * share)
                * array_flow.radius_of(kind, share) ** 2
            )
            self.assertAlmostEqual(array_flow.along(kind, share) / low, 1, delta=1e-4)

    def test_an_array(self):
        self.check_array("square", 0.4, "--segments", "10,12,16")

    def test_an_oblique_cell(self):
        """Upright cylinders in hexagons by their smallest repeat; each node of a face is its vector away from its like."""
        share, step = 0.4, np.array([[1, 0, 0], [0.5, math.sqrt(3) / 2, 0], [0, 0, LENGTH]])
        middle = step[:2].sum(axis=0) / 2
        text = (
            f"fabric 1\nunits mm\ntolerance 1e-5\nthread rod\n  section circle {2 * array_flow.radius_of('hexagonal', share)!r}\nend\n"
            f"yarn a rod\n  path\n    {middle[0]} {middle[1]!r} -1\n    {middle[0]} {middle[1]!r} 1\n  end\nend\n"
            f"cell vectors {' '.join(str(x) for x in step.ravel())}  at 0 0 0\n  periodic x y z\nend\n"
        )
        result, _ = self.permeability(text, "--segments", "16", "--keep", self.folder / "kept")
        tensor = np.array(result["permeability_mm2"])
        across = array_flow.across("hexagonal", share)
        np.testing.assert_allclose(
            tensor, np.diag([across, across, array_flow.along("hexagonal", share)]), rtol=0.01, atol=0.002 * across
        )
        self.check_links(self.folder / "kept" / "pores_16.msh", step)

    def check_links(self, path, step):
        """Gmsh's own view of what repeats what."""
        gmsh.initialize()
        self.addCleanup(gmsh.finalize)
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(path))
        shifts = []
        for dimension, tag in gmsh.model.getEntities():
            if dimension == 3:
                continue
            original, nodes, others, affine = gmsh.model.mesh.getPeriodicNodes(
                dimension, tag, includeHighOrderNodes=True
            )
            if original == tag:
                continue
            shift = np.array(affine).reshape(4, 4)[:3, 3]
            moved = [gmsh.model.mesh.getNode(a)[0] - gmsh.model.mesh.getNode(b)[0] for a, b in zip(nodes, others)]
            np.testing.assert_allclose(moved, np.broadcast_to(shift, (len(nodes), 3)), atol=1e-12)
            if dimension == 2:
                shifts.append(shift)
        np.testing.assert_allclose(sorted(map(tuple, shifts)), sorted(map(tuple, step)), atol=1e-12)

    def test_a_cell_between_two_reservoirs(self):
        """Along z it is open: of the tensor what couples z with the others is not known, and null."""
        text = text_of(
            [(0.5, 0.5)], (LENGTH, 1.0, 1.0), f"circle {2 * array_flow.radius_of('square', 0.4)!r}", periodic="x y"
        )
        result, said = self.permeability(text, "--segments", "10")
        tensor = result["permeability_mm2"]
        self.assertEqual(
            [[value is None for value in row] for row in tensor],
            [[i != j and 2 in (i, j) for j in range(3)] for i in range(3)],
        )
        self.assertTrue(all(value is None for row in result["error_mm2"] for value in row))
        self.assertIn("the cell is not periodic along z", said)
        # Mirrors are what periods are to rods that are symmetric, along them.
        self.assertAlmostEqual(tensor[0][0] / array_flow.along("square", 0.4), 1, delta=0.02)

    def test_another_solver(self):
        """simpleFoam, on flat tetrahedra."""
        if shutil.which("simpleFoam") is None:
            self.skipTest("OpenFOAM is not installed")
        self.check_array("square", 0.4, "--solver", "openfoam", "--segments", "20", within=0.1)
        self.check_array("square", 0.4, "--solver", "openfoam", "--segments", "20", "--layers", "3", within=0.04)

    def test_openfoam_not_there(self):
        cell = self.folder / "cell.txt"
        cell.write_text(array("square", 0.2))
        done = subprocess.run(
            [sys.executable, SCRIPTS / "permeability.py", cell, "--solver", "openfoam"],
            capture_output=True,
            text=True,
            env={"PATH": "/nowhere"},
            check=False,
        )
        self.assertEqual(done.returncode, 1)
        self.assertIn("apt-get install openfoam", done.stderr)

    def test_all_arrays(self):
        if not IS_LONG:
            self.skipTest("SELVAGE_TABLE is not set")
        for kind, shares in SHARES.items():
            for share in shares:
                self.check_array(kind, share)


if __name__ == "__main__":
    unittest.main()
