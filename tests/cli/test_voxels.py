"""Unit cells on voxels, as HDF5 and NumPy's archives: read by h5py and numpy, held against the volumes of B-splines."""

import json
import re
import subprocess
import unittest

import h5py
import numpy as np

from program import Case, SAMPLES, run

FIELDS = {
    "phase": (np.uint16, ()),
    "yarn_fraction": (np.float32, ()),
    "fibre_fraction": (np.float32, ()),
    "orientation": (np.float32, (3,)),
}


class Voxels(Case):
    def made(self, sample, count, *more, names=("cell.h5", "cell.npz")):
        """The cell in both formats, and what the report says of it."""
        report = self.folder / "report.json"
        for name in names:
            self.succeeds("mesh", sample, "--voxel", count, *more, "-o", self.folder / name, "--report", report)
        return *[self.folder / name for name in names], json.loads(report.read_text())["inputs"][0]

    def test_both_say_the_same(self):
        h5, npz, report = self.made(SAMPLES / "cell_satin5.txt", 40)
        voxels = report["voxels"]
        shape = tuple(reversed(voxels["count"]))
        with h5py.File(h5) as file, np.load(npz, allow_pickle=False) as arrays:
            for name, (kind, components) in FIELDS.items():
                self.assertEqual(file[name].dtype, kind)
                self.assertEqual(file[name].shape, shape + components)
                order = file[name].attrs.get_id("permute_order")
                self.assertTrue(order.get_type().is_variable_str())  # as FANS reads it
                self.assertEqual(file[name].attrs["permute_order"], "zyx")
                self.assertEqual(arrays[name].dtype, kind)
                np.testing.assert_array_equal(file[name][...], arrays[name])
            names = [text.decode() for text in file["phase_names"]]
            self.assertEqual(names, list(arrays["phase_names"]))
            self.assertEqual(names, [phase["name"] for phase in voxels["phases"]])
            self.assertEqual(names[0], "matrix")
            self.assertEqual([text.decode() for text in file["phase_materials"]], list(arrays["phase_materials"]))
            np.testing.assert_array_equal(file["phase_fractions"], arrays["phase_fractions"])
            np.testing.assert_array_equal(file["origin"], arrays["origin"])
            np.testing.assert_allclose(file["lengths"], voxels["lengths"])
            np.testing.assert_array_equal(file["vectors"], arrays["vectors"])
            np.testing.assert_allclose(arrays["vectors"], np.diag(voxels["lengths"]), atol=1e-15)
            self.assertEqual(file["title"][0].decode(), str(arrays["title"][0]))
            self.assertEqual(set(np.unique(arrays["phase"])), set(range(len(names))))
            self.assertAlmostEqual(arrays["yarn_fraction"].mean(dtype=float), voxels["yarn_fraction"], delta=1e-6)

    def test_the_same_bytes_again(self):
        paths = self.made(SAMPLES / "cell_plain.txt", 24, names=("a.h5", "b.h5", "a.npz", "b.npz"))
        for a, b in (paths[:2], paths[2:4]):
            self.assertEqual(a.read_bytes(), b.read_bytes())

    def test_other_programs_read_them(self):
        h5, npz, _ = self.made(SAMPLES / "cell_plain.txt", 24)
        self.assertEqual(subprocess.run(["python3", "-m", "zipfile", "-t", npz], capture_output=True).returncode, 0)
        with h5py.File(h5) as file:
            self.assertEqual(len(file), len(FIELDS) + 7)

    def test_fractions_are_those_of_the_volumes(self):
        """Of each yarn, to 1e-3 of its volume, those that the faces of the cell cut, too (`convert --cut`: OpenCASCADE's solids)."""
        for name, count in (
            ("cell_plain", 30),
            ("cell_satin5", 64),
            ("cell_orthogonal", 50),
            ("cell_jersey", 40),
            ("twill_cell", 64),
        ):
            sample = SAMPLES / (name + ".txt")
            # The same yarns: by default constructions leave a gap between theirs where they are cut, and none on voxels.
            *_, report = self.made(sample, count, "--gap", "0.02", names=("cell.npz",))
            self.succeeds("convert", sample, "--gap", "0.02", "--cut", "-o", self.folder / "cut.step")
            volumes = {}
            for part in json.loads(self.succeeds("info", "--json", self.folder / "cut.step").stdout)["inputs"][0][
                "parts"
            ]:
                name_of_yarn = part["name"].split(".part")[0]
                volumes[name_of_yarn] = volumes.get(name_of_yarn, 0) + part["volume"]
            size = np.prod(report["voxels"]["lengths"])
            for phase in report["voxels"]["phases"][1:]:
                exact = volumes.pop(phase["name"])
                self.assertAlmostEqual(phase["fraction"] * size / exact, 1, delta=1e-3, msg=f"{name} {phase['name']}")
            self.assertFalse(volumes)

    def test_too_few_voxels(self):
        """Hexahedra of flat tows, one over their thickness: the share of the cell is that of OpenCASCADE's solids, and the count that
        the warning names is enough. A yarn between the middles of all voxels is named, with a count that has it."""
        text = self.folder / "flat.txt"
        text.write_text(
            "fabric 1\nmaterial glass\n  density 2.54\n  elastic isotropic 72000 0.2\nend\n"
            "material resin\n  elastic isotropic 3000 0.35\nend\n"
            "thread tow\n  section racetrack 2.2 0.13\n  material glass\nend\n"
            "weave\n  warp tow 2 pitch 2.5\n  weft tow 2 pitch 2.5\n  draft plain\nend\n"
            "cell repeat\n  margin 0.006\n  matrix resin\n  periodic x y\nend\n"
        )

        gap = ("--gap", "0.0065")  # voxels and solids have another one by default

        def shares(*options):
            result = run("mesh", text, "--matrix", "--periodic", *gap, *options, "-o", self.folder / "flat.vtu")
            self.assertEqual(result.returncode, 0, result.stderr)
            filled = re.search(r"yarns fill ([0-9.]+) % of the cell \(wanted: ([0-9.]+) %\)", result.stdout)
            return float(filled[1]), float(filled[2]), result.stderr

        filled, wanted, said = shares("--voxel", "20")
        self.succeeds("convert", text, *gap, "--cut", "-o", self.folder / "cut.step")
        parts = json.loads(self.succeeds("info", "--json", self.folder / "cut.step").stdout)["inputs"][0]["parts"]
        with np.load(self.made(text, 20, *gap, names=("flat.npz",))[0]) as arrays:
            size = np.prod(np.diag(arrays["vectors"]))
        self.assertAlmostEqual(wanted, 100 * sum(part["volume"] for part in parts) / size, delta=0.05)
        self.assertGreater(abs(filled - wanted), 0.05 * wanted)
        remedy = re.search(r"--voxel (\d+) fills ([0-9.]+) %", said)
        filled, wanted, said = shares("--voxel", remedy[1])
        self.assertLess(abs(filled - wanted), 0.05 * wanted)
        self.assertAlmostEqual(filled, float(remedy[2]), delta=0.06)
        self.assertNotIn("too coarse", said)

        text.write_text(
            "fabric 1\nmaterial glass\n  elastic isotropic 72000 0.2\nend\n"
            "thread thick\n  section ellipse 1 1\n  material glass\nend\n"
            "thread thin\n  section ellipse 0.09 0.09\n  material glass\nend\n"
            "yarn a thick\n  path chord\n    -1 0.7 0.7\n    3 0.7 0.7\n  end\nend\n"
            "yarn b thin\n  path chord\n    -1 1.5 1.5\n    3 1.5 1.5\n  end\nend\n"
            "cell 0 0 0  2 2 2\nend\n"
        )
        said = self.succeeds("mesh", text, "--voxel", "20", "-o", self.folder / "thin.vtu").stderr
        remedy = re.search(r"no voxel has its middle in yarn 'b': --voxel (\d+) or more", said)
        said = self.succeeds("mesh", text, "--voxel", remedy[1], "-o", self.folder / "thin.vtu").stderr
        self.assertNotIn("no voxel", said)

    def test_an_oblique_cell(self):
        """Straight elliptic tows along the sum of both vectors of a rhombic cell, where its lattice repeats one: their share by hand,
        their direction in space, and the voxels that have their middles in the ellipses."""
        places_across = (-0.9, 0.1, 1.1)
        text = self.folder / "rhomb.txt"
        text.write_text(
            "fabric 1\ntolerance 1e-4\nthread tow\n  section ellipse 0.6 0.4\nend\n"
            + "".join(
                f"yarn y{n} tow\n  path chord\n    -3 {y} 0.3\n    6 {y} 0.3\n  end\nend\n"
                for n, y in enumerate(places_across)
            )
            + "cell vectors 2 -1 0  2 1 0  0 0 0.6 at -0.5 0 0\n  periodic x y\nend\n"
        )
        h5, npz, report = self.made(text, 48)
        with np.load(npz) as arrays, h5py.File(h5) as file:
            np.testing.assert_array_equal(file["vectors"], arrays["vectors"])
            np.testing.assert_allclose(arrays["vectors"], [[2, -1, 0], [2, 1, 0], [0, 0, 0.6]], atol=1e-12)
            np.testing.assert_allclose(arrays["origin"], [-0.5, 0, 0], atol=1e-12)
            shares, phase = arrays["yarn_fraction"], arrays["phase"]
            self.assertAlmostEqual(shares.mean(dtype=float) * 4 * 0.6, 4 * np.pi * 0.3 * 0.2, delta=4e-4)
            k, j, i = np.indices(shares.shape)
            places = arrays["origin"] + sum(
                (index + 0.5)[..., None] / size * vector
                for index, size, vector in zip((i, j, k), reversed(shares.shape), arrays["vectors"])
            )
            for n, y in enumerate(places_across, 1):
                radius = np.hypot((places[..., 1] - y) / 0.3, (places[..., 2] - 0.3) / 0.2)
                self.assertTrue((phase[radius < 0.85] == n).all())
                self.assertFalse((phase[radius > 1.15] == n).any())
            along = arrays["orientation"][shares > 0]
            np.testing.assert_allclose(np.abs(along), np.broadcast_to([1, 0, 0], along.shape), atol=1e-6)
        np.testing.assert_allclose(report["voxels"]["lengths"], [5**0.5, 5**0.5, 0.6])

    def test_the_yarns_run_as_they_run(self):
        _, npz, _ = self.made(SAMPLES / "cell_plain.txt", 40)
        with np.load(npz) as arrays:
            length = np.linalg.norm(arrays["orientation"], axis=-1)
            inside = arrays["yarn_fraction"] > 1e-5
            np.testing.assert_allclose(length[inside], 1, atol=1e-6)
            np.testing.assert_array_equal(length[arrays["yarn_fraction"] == 0], 0)
            for number, name in enumerate(arrays["phase_names"]):
                if name == "matrix":
                    continue
                mean = np.abs(arrays["orientation"][arrays["phase"] == number]).mean(axis=0)
                # A plain weave: two systems at a right angle in the plane, with some crimp.
                self.assertGreater(max(mean[0], mean[1]), 0.9)
                self.assertLess(min(mean[0], mean[1]), 1e-3)

    def test_fibres_follow_the_twist(self):
        """A straight yarn along x: away from its middle they are inclined by the radius times the turns."""
        text = (
            "fabric 1\nmaterial m\n  elastic isotropic 3000 0.35\nend\nthread t\n  diameter 0.8\n  twist 400 {}\n  material m\nend\n"
            "yarn a t\n  path\n    -0.5 0.5 0.5\n    1.5 0.5 0.5\n  end\nend\ncell 0 0 0  1 1 1\n  matrix m\nend\n"
        )
        source = self.folder / "twisted.txt"
        for hand, sign, options in (("Z", 1, ()), ("S", -1, ()), ("Z", 0, ("--twist", "ignore"))):
            source.write_text(text.format(hand))
            npz = self.folder / "twisted.npz"
            self.succeeds("mesh", source, "--voxel", "20", "-o", npz, *options)
            with np.load(npz) as arrays:
                inside = arrays["yarn_fraction"] > 0.99
                k, j, _ = np.indices(inside.shape)
                y, z = (j + 0.5) / 20 - 0.5, (k + 0.5) / 20 - 0.5
                turn = sign * 2 * np.pi * 0.4
                wanted = np.stack([np.ones_like(y), -turn * z, turn * y], axis=-1)
                wanted /= np.linalg.norm(wanted, axis=-1)[..., None]
                np.testing.assert_allclose(arrays["orientation"][inside], wanted[inside], atol=1e-4)

    def test_beside_a_mesh(self):
        self.succeeds("mesh", SAMPLES / "cell_plain.txt", "--voxel", "12", "--to", "hdf5,vtu", "-o", f"{self.out}/")
        self.assertEqual(sorted(path.suffix for path in self.out.iterdir()), [".h5", ".vtu"])

    def test_what_is_told(self):
        message = self.fails(2, "mesh", SAMPLES / "cell_plain.txt", "-o", self.folder / "cell.h5")
        self.assertIn("--voxel N", message)
        message = self.fails(2, "convert", SAMPLES / "cell_plain.txt", "-o", self.folder / "cell.npz")
        self.assertIn("selvage mesh --voxel N", message)
        message = self.fails(1, "mesh", SAMPLES / "cell_plain.txt", "--voxel", "9000", "-o", self.folder / "cell.h5")
        self.assertIn("--voxel", message)
        self.assertEqual(list(self.folder.iterdir()), [])
        done = run("mesh", SAMPLES / "cell_plain.txt", "--voxel", "20", "-o", self.folder / "cell.h5")
        self.assertRegex(done.stdout, r"20 x \d+ x \d+ voxels; yarns fill \d\d\.\d\d % of the cell")


if __name__ == "__main__":
    unittest.main()
