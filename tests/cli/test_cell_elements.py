"""What elements cost a unit cell: the order that it gets by itself, and the warnings of what is too stiff, locks, or has moduli in GPa."""

import json
import unittest

from program import Case, run

TEXT = """fabric 1
material fibre
  elastic {fibre}
end
material resin
  elastic {resin}
end
thread t
  diameter 0.6
  material fibre
end
yarn a t
  path
    -1 0.5 0.5
    2 0.5 0.5
  end
end
cell 0 0 0  1 1 1
  matrix resin
  periodic {axes}
end
"""
GLASS, RESIN = "isotropic 70000 0.2", "isotropic 3000 0.35"


class CellElements(Case):
    def mesh(self, *options, fibre=GLASS, resin=RESIN, axes="x y z"):
        """(The mesh's facts, what was said)."""
        source, report = self.folder / "cell.txt", self.folder / "report.json"
        source.write_text(TEXT.format(fibre=fibre, resin=resin, axes=axes))
        done = run(
            "mesh",
            source,
            "--matrix",
            "--periodic",
            "--size",
            "0.3",
            "-o",
            self.folder / "c.inp",
            "--report",
            report,
            *options,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(report.read_text())["inputs"][0]["mesh"], done.stderr

    def nodes_of_an_element(self):
        text = (self.folder / "c.inp").read_text()
        return text.split("*ELEMENT, TYPE=")[1].split(",")[0].split("\n")[0]

    def test_order(self):
        for axes in ("x y z", "x y", "x"):
            with self.subTest(axes):
                _, said = self.mesh(axes=axes)
                self.assertEqual(self.nodes_of_an_element(), "C3D10")
                self.assertNotIn("too stiff", said)
                _, said = self.mesh("--order", "1", axes=axes)
                self.assertEqual(self.nodes_of_an_element(), "C3D4")
                self.assertRegex(said, "warning: tetrahedra of four nodes make a (cell|plate|beam) too stiff")

    def test_other_physics_has_no_such_cost(self):
        source = self.folder / "cell.txt"
        text = TEXT.format(fibre=GLASS, resin=RESIN, axes="x y z").replace("  elastic", "  conductivity 1\n  elastic")
        source.write_text(text)
        done = run("mesh", source, "--matrix", "--periodic", "--physics", "conduction", "-o", self.folder / "c.inp")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("too stiff", done.stderr)

    def test_volume_that_is_kept(self):
        for options, locks in ((("--order", "1"), True), (("--order", "2"), False), (("--voxel", "8"), True)):
            with self.subTest(options):
                source = self.folder / "cell.txt"
                source.write_text(TEXT.format(fibre=GLASS, resin="isotropic 3 0.4999", axes="x y z"))
                done = run("mesh", source, "--matrix", "--periodic", *options, "-o", self.folder / "c.inp")
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual("lock from 0.49" in done.stderr, locks, done.stderr)
                self.assertNotIn("GPa", done.stderr)  # rubber

    def test_gigapascals(self):
        for fibre, resin, words in (
            (
                GLASS,
                "isotropic 3.4 0.35",
                "'resin' has E = 3.4 MPa: moduli are in MPa; if 3.4 GPa is meant, write 3400",
            ),
            (
                "isotropic 72.4 0.2",
                RESIN,
                "'fibre' has E = 72.4 MPa: moduli are in MPa; if 72.4 GPa is meant, write 72400",
            ),
            ("isotropic 200 0.4", RESIN, None),  # of polyethylene
            (
                "transverse 51.5 17.5 0.26 5.8 0.31",
                RESIN,
                "'fibre' has E1 = 51.5 MPa: moduli are in MPa; if 51.5 GPa is",
            ),
            ("transverse 51500 17500 0.26 5800 0.31", RESIN, None),
        ):
            with self.subTest(f"{fibre}, {resin}"):
                _, said = self.mesh(fibre=fibre, resin=resin)
                if words:
                    self.assertRegex(said, r"cell.txt:\d+:\d+: warning: material ")
                    self.assertIn(words, said)
                else:
                    self.assertNotIn("GPa", said)

    def test_twist_of_beams(self):
        """The angle of the outside: the tangent is the circumference by the length of a turn."""
        source = self.folder / "rod.txt"
        source.write_text(
            "fabric 1\nmaterial m\n  elastic transverse 230000 15000 0.2 9000 0.4\nend\nthread t\n  diameter 2\n  material m\n"
            "  twist 50 Z\nend\nyarn r t\n  path\n    0 0 0\n    20 0 0\n  end\nend\n"
        )
        for elements in ("beam", "truss"):
            for options, words in (
                ((), "the fibres of yarn 'r' lie at 17.4 degrees on its outside"),
                (("--twist", "ignore"), None),
            ):
                said = self.succeeds(
                    "mesh", source, "--elements", elements, "-o", self.folder / "rod.inp", *options
                ).stderr
                if words:
                    self.assertIn(words, said)
                else:
                    self.assertNotIn("fibres", said)


if __name__ == "__main__":
    unittest.main()
