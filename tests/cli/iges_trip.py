"""IGES to IGES and IGES to TXT to IGES: the same bytes.

An IGES file holds every control point, knot and weight of body and end faces in the shortest text that reads back to the same
double (the second reader of tests/formats/iges proves that), so equal files are equal models, bit for bit.
"""

from program import Case, run


def undated(path):
    """The lines but those that say when the file was written, and the name that a text does not keep."""
    return [line for line in path.read_bytes().split(b"\n") if line[72:73] not in (b"G", b"S")]


class IgesTrip(Case):
    def convert(self, source, target, *options):
        result = run("convert", source, "-o", target, "--quiet", *options)
        self.assertEqual(result.returncode, 0, f"{source} {options}: {result.stderr}")
        self.assertTrue(target.exists(), f"{source} {options}: {target.name} is missing")

    def expect_same_after_trip(self, iges, *options):
        """`options`: those that the IGES file was written with."""
        # The file's name is in its header.
        again, back = self.folder / "again" / iges.name, self.folder / "back" / iges.name
        text = (self.folder / "back" / iges.name).with_suffix(".txt")
        for path in (again, back):
            path.parent.mkdir(exist_ok=True)
        with self.subTest(file=iges.name, options=options, trip="IGES, IGES"):
            self.convert(iges, again)
            self.assertTrue(iges.read_bytes() == again.read_bytes(), "the IGES file changed")
        with self.subTest(file=iges.name, options=options, trip="IGES, TXT, IGES"):
            self.convert(iges, text)
            self.convert(text, back, *[option for option in options if option == "--iges-solid"])
            self.assertEqual(undated(iges), undated(back), "control points, knots, weights or names changed")
