"""Small TexGen models: volumes against those of an oracle and of formulas, copies in a domain, bad input."""

import json
import math
import pathlib
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cli"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from oracle import Model
from program import Case

ELLIPSE = '<Section type="CSectionEllipse" Width="2" Height="1"/>'
LENS = '<Section type="CSectionLenticular" Width="2" Height="0.8" Distortion="0.1"/>'
BOX = '<Section type="CSectionRectangle" Width="2" Height="1"/>'
DOMAIN = """<Domain type="CDomainPlanes"><Plane Normal="1,0,0" d="0"/><Plane Normal="-1,0,0" d="-20"/>
<Plane Normal="0,1,0" d="-2"/><Plane Normal="0,-1,0" d="-7"/><Plane Normal="0,0,1" d="-2"/><Plane Normal="0,0,-1" d="-4"/></Domain>"""


def model(sections, form="Cubic", height=2, domain="", version="3.13.2", attributes='type="CYarnSectionConstant"'):
    return f"""<?xml version="1.0"?>
<TexGenModel version="{version}"><Textile name="t" type="CTextile">{domain}
<Yarn index="0"><Interpolation Periodic="1" type="CInterpolation{form}"/>
<YarnSection {attributes}>{sections}</YarnSection>
<Repeat value="10,0,0"/><Repeat value="0,5,0"/>
<MasterNode Position="0,0,0" Up="0,0,1"/><MasterNode Position="5,0,{height}" Up="0,0,1"/><MasterNode Position="10,0,0" Up="0,0,1"/>
</Yarn></Textile></TexGenModel>
"""


# The x, z of a binder's nodes as TexGen 3.13.2 stores them of the weave below, by the type of the textile, with the
# numbers of the nodes whose `Up` is -x and x.
STORED = {
    "Orthogonal": (
        [
            (0.075, 0.05),
            (0.119577393482, 0.000285067835),
            (0.17639320225, -0.011349732191),
            (0.264885899083, -0.019029584903),
            (0.37639320225, -0.02351698445),
            (0.5, -0.025),
            (0.62360679775, -0.02351698445),
            (0.735114100917, -0.019029584903),
            (0.82360679775, -0.011349732191),
            (0.880422606518, 0.000285067835),
            (0.925, 0.05),
            (1.075, 0.25),
            (1.119577393482, 0.299714932165),
            (1.17639320225, 0.311349732191),
            (1.264885899083, 0.319029584903),
            (1.37639320225, 0.32351698445),
            (1.5, 0.325),
            (1.62360679775, 0.32351698445),
            (1.735114100917, 0.319029584903),
            (1.82360679775, 0.311349732191),
            (1.880422606518, 0.299714932165),
            (1.925, 0.25),
            (2.075, 0.05),
        ],
        (5, 16),
        (10, 11),
        (0, 21, 22),
    ),
    "AngleInterlock": (
        [
            (0.119577393, 0.375285068),
            (0.176393202, 0.363650268),
            (0.264885899, 0.355970415),
            (0.5, 0.35),
            (0.735114101, 0.355970415),
            (0.823606798, 0.363650268),
            (0.880422607, 0.375285068),
            (1.119577393, 0.524714932),
            (1.176393202, 0.536349732),
            (1.5, 0.55),
            (1.823606798, 0.563650268),
            (1.880422607, 0.575285068),
            (2.119577393, 0.724714932),
            (2.176393202, 0.736349732),
            (2.264885899, 0.744029585),
            (2.5, 0.75),
            (2.735114101, 0.744029585),
            (2.823606798, 0.736349732),
            (2.880422607, 0.724714932),
            (3.119577393, 0.575285068),
            (3.176393202, 0.563650268),
            (3.5, 0.55),
            (3.823606798, 0.536349732),
            (3.880422607, 0.524714932),
            (4.119577393, 0.375285068),
        ],
        (3, 9, 15, 21),
        (),
        (),
    ),
}


def weave(kind, rows, binder, more=""):
    """A weave of x yarns of 0.8 x 0.1 and `binder` (width, height, power) beside y yarns of 0.8 x 0.1; rows of levels, from y = 0."""
    cells = "".join(
        f'<PatternCell x="{x}" y="{y}">'
        + "".join(f'<PatternElement value="{level}"/>' for level in levels)
        + "</PatternCell>"
        for y, row in enumerate(rows)
        for x, levels in enumerate(row)
    )
    sizes = [(0.8, 0.1), binder[:2]]
    xs = "".join(f'<XYarnData Width="{w}" Height="{h}" Spacing="1"/>' for w, h in sizes)
    return f"""<TexGenModel version="3.13.2"><Textile name="t" type="CTextile{kind}" NumXYarns="2" NumYYarns="{len(rows[0])}" GapSize="0"
WarpRatio="1" BinderRatio="1" WarpPower="0.6" WeftPower="0.6" BinderPower="{binder[2]}" {more}>
{cells}{xs}{'<YYarnData Width="0.8" Height="0.1" Spacing="1"/>' * len(rows[0])}</Textile></TexGenModel>
"""


ORTHOGONAL = weave("Orthogonal", [["20102", "20102"], ["10202", "20201"]], (0.4, 0.05, 0.6))
ANGLE = weave(
    "AngleInterlock", [["201010102"] * 4, ["202010202", "202020102", "202020201", "202020102"]], (0.4, 0.1, 0.8)
)
LAYERS = weave(
    "LayerToLayer", [["201010102"] * 4, ["202020101", "202010102", "101020202", "201010202"]], (0.5, 0.05, 0.5)
)


class Tg3(Case):
    def file(self, text):
        path = self.folder / "x.tg3"
        path.write_text(text)
        return path

    def yarns(self, text):
        done = self.succeeds("info", "--json", self.file(text))
        return json.loads(done.stdout)["inputs"][0]["yarns"]

    def test_straight_yarns_have_their_sections_area(self):
        for section, area in ((ELLIPSE, math.pi / 2), (BOX, 2)):
            with self.subTest(section):
                self.assertAlmostEqual(self.yarns(model(section, height=0))[0]["volume"], 10 * area, delta=1e-5)

    def test_volumes_are_those_of_the_oracle(self):
        blended = "".join(
            f'<PositionSection t="{t}">{section}</PositionSection>' for t, section in ((0, ELLIPSE), (0.4, LENS))
        )
        attributes = 'type="CYarnSectionInterpPosition" Ramped="1" Polar="0"'
        for form in ("Cubic", "Bezier", "Linear"):
            for text in (model(LENS, form), model(blended, form, attributes=attributes)):
                with self.subTest(text):
                    expected = Model(self.file(text)).yarns[0].volume()
                    self.assertAlmostEqual(self.yarns(text)[0]["volume"] / expected, 1, delta=5e-4)

    def test_units_of_a_domain_are_one_yarn(self):
        text = model(ELLIPSE, domain=DOMAIN)
        once, yarns = self.yarns(model(ELLIPSE))[0]["volume"], self.yarns(text)
        self.assertEqual(len(yarns), 2)
        parsed = Model(self.file(text))
        self.assertEqual(parsed.copies(parsed.yarns[0]), 4)
        for yarn in yarns:
            self.assertAlmostEqual(yarn["volume"], 2 * once, delta=1e-6)

    def test_sections_of_straight_yarns_have_the_area_of_formulas(self):
        def points(name, *pairs):
            return "".join(f'<{name} value="{x},{y}"/>' for x, y in pairs)

        polygon = points("PolygonPoint", (1, 0), (1, 0.5), (0, 1), (-1, 0), (0, -1))
        # Of a quarter (1,0) (1,k) (k,1) (0,1) the area about the origin is that below, by integration.
        k = 0.5
        bezier = points(
            "BezierPoint",
            (1, 0),
            (1, k),
            (k, 1),
            (0, 1),
            (-k, 1),
            (-1, k),
            (-1, 0),
            (-1, -k),
            (-k, -1),
            (0, -1),
            (k, -1),
            (1, -k),
        )
        circle = '<Section type="CSectionEllipse" Width="2" Height="2"/>'
        for text, area in (
            (f'<Section type="CSectionPolygon" RetainPoints="0">{polygon}</Section>', 2.25),
            (f'<Section type="CSectionPolygon" RetainPoints="1">{polygon}</Section>', 2.25),
            (f'<Section type="CSectionBezier">{bezier}</Section>', 4 * (0.5 + 0.6 * k - 0.15 * k * k)),
            (
                f'<Section type="CSectionHybrid"><Division Value="0"/><Division Value="0.5"/>{ELLIPSE}{circle}</Section>',
                math.pi / 4 + math.pi / 2,
            ),
            (f'<Section type="CSectionRotated" Angle="0.34">{ELLIPSE}</Section>', math.pi / 2),
            (f'<Section type="CSectionScaled" Scale="2,1.5">{ELLIPSE}</Section>', 1.5 * math.pi),
        ):
            with self.subTest(text):
                self.assertAlmostEqual(self.yarns(model(text, height=0))[0]["volume"] / (10 * area), 1, delta=1e-5)

    def test_binders_have_the_nodes_that_texgen_stores(self):
        for text, kind, width, height, power, warps, y_yarns in (
            (ORTHOGONAL, "Orthogonal", 0.4, 0.05, 0.6, 1, 2),
            (ANGLE, "AngleInterlock", 0.4, 0.1, 0.8, 3, 4),
        ):
            nodes, along, behind, ahead = STORED[kind]
            rows = ""
            for number, (x, z) in enumerate(nodes):
                up = "-1,0,0" if number in behind else "1,0,0" if number in ahead else "0,0,1"
                rows += f'<MasterNode Position="{x},1.5,{z}" Tangent="{int(number in along)},0,0" Up="{up}"/>\n'
            stored = self.folder / "stored.tg3"
            stored.write_text(
                f"""<TexGenModel version="3.13.2"><Textile name="t" type="CTextile"><Yarn index="0">
<Interpolation Periodic="1" type="CInterpolationBezier"/><YarnSection type="CYarnSectionConstant">
<Section type="CSectionPowerEllipse" Width="{width}" Height="{height}" Power="{power}" XOffset="0"/></YarnSection>{rows}</Yarn></Textile></TexGenModel>
"""
            )
            with self.subTest(kind):
                done = self.succeeds("info", "--json", stored)
                expected = json.loads(done.stdout)["inputs"][0]["yarns"][0]
                yarns = self.yarns(text)
                self.assertEqual(len(yarns), warps + 1 + y_yarns * (warps + 1))
                for what in ("length", "volume"):
                    self.assertAlmostEqual(yarns[warps][what] / expected[what], 1, delta=1e-7)

    def test_binders_of_layers_are_alike(self):
        yarns = self.yarns(LAYERS)
        self.assertEqual(len(yarns), 3 + 2 + 4 * 4)
        self.assertAlmostEqual(yarns[3]["volume"], yarns[4]["volume"], delta=1e-9)
        self.assertGreater(yarns[3]["length"], 4)

    def test_a_million_slave_nodes_are_passed_by(self):
        text = model(ELLIPSE)
        slave = '<SlaveNode Position="0,0,0" Tangent="1,0,0" Up="0,0,1" Side="0,1,0"/>\n'
        self.assertEqual(self.yarns(text.replace("</Yarn>", slave * 1_000_000 + "</Yarn>")), self.yarns(text))

    def test_files_that_are_too_large_are_refused_before_they_are_parsed(self):
        for size in (300 << 20, 2 << 30):
            path = self.file(model(ELLIPSE))
            with path.open("r+b") as file:
                file.truncate(size)  # takes no room on the disk
            with self.subTest(size):
                said = self.fails(1, "info", path)
                self.assertIn(f"the file has {size >> 20} MB", said)
                self.assertIn("save it without what TexGen computes", said)
            path.unlink()

    def test_adjusted_sections_have_the_volumes_of_the_oracle(self):
        """Outlines that are shifted, more and more along the first span, and less and less along the second one."""
        shift = '<AdjustmentPerimeter T="{}" Vector="{},{}"/>'

        def span(*places):
            return "".join(
                f'<AdjustmentSection T="{t}">'
                + "".join(
                    shift.format(u, x * by, y * by)
                    for u, x, y in ((0, 0.2, 0), (0.3, 0, 0.3), (0.7, -0.1, 0), (1, 0.2, 0))
                )
                + "</AdjustmentSection>"
                for t, by in places
            )

        first, second = span((0, 0), (0.5, 0.2), (1, 1)), span((0.3, 1), (0.9, 0))
        for section in (ELLIPSE, LENS, BOX):
            adjusted = (
                f'<Adjustment index="0">{first}</Adjustment><Adjustment index="1">{second}</Adjustment>'
                f'<YarnSection type="CYarnSectionConstant">{section}</YarnSection>'
            )
            text = model(adjusted, attributes='type="CYarnSectionAdjusted"')
            with self.subTest(section):
                plain = self.yarns(model(section))[0]["volume"]
                expected = Model(self.file(text)).yarns[0].volume()
                self.assertGreater(abs(expected / plain - 1), 0.01)
                self.assertAlmostEqual(self.yarns(text)[0]["volume"] / expected, 1, delta=5e-4)

    def test_equal_points_of_a_polygon_are_left_out(self):
        corners = ["1,-0.5", "1,0.5", "1,0.5", "1,0.5", "-1,0.5", "-1,-0.5"]
        rows = "".join(f'<PolygonPoint value="{corner}"/>' for corner in corners)
        text = model(f'<Section type="CSectionPolygon">{rows}</Section>', height=0)
        self.assertAlmostEqual(self.yarns(text)[0]["volume"], 20, delta=1e-9)
        self.assertIn(
            "warning: 2 of the 6 points of this polygon equal the point before them",
            self.succeeds("info", self.file(text)).stderr,
        )

    def test_up_along_the_line_is_taken_across_it(self):
        """A vertical yarn, with and without `Up`, and one that turns from x to z: its sections do not turn about it."""
        upright = model(ELLIPSE, "Linear").replace("5,0,2", "0,0,5").replace("10,0,0", "0,0,10", 1)
        upright = upright.replace('Position="10,0,0"', 'Position="0,0,10"').replace('value="0,0,10"', 'value="10,0,0"')
        for text in (upright, upright.replace('0,0,1"', '0,0,0"')):
            yarn = self.yarns(text)[0]
            self.assertAlmostEqual(yarn["volume"], 10 * math.pi / 2, delta=1e-5)
            self.assertIn("lies along the line at 3 of the 3 nodes", self.succeeds("info", self.file(text)).stderr)
        bent = (
            model(ELLIPSE, "Bezier")
            .replace('Periodic="1"', 'Periodic="0"')
            .replace('Position="10,0,0"', 'Position="5,0,12" Tangent="0,0,1"')
        )
        good = bent.replace('Tangent="0,0,1" Up="0,0,1"', 'Tangent="0,0,1" Up="-1,0,0"')
        self.assertIn("at 1 of the 3 nodes", self.succeeds("info", self.file(bent)).stderr)
        self.assertAlmostEqual(self.yarns(bent)[0]["volume"] / self.yarns(good)[0]["volume"], 1, delta=1e-2)

    def test_a_domain_without_volume_is_left_out(self):
        text = model(ELLIPSE, domain=DOMAIN.replace('"-1,0,0" d="-20"', '"-1,0,0" d="20"'))
        self.assertEqual(len(self.yarns(text)), 1)
        self.assertIn(
            "warning: the planes of this domain enclose no volume", self.succeeds("info", self.file(text)).stderr
        )

    def test_measured_sections_are_fitted(self):
        """Polygons whose corners stand at different places: less than half of the points, and the oracle's volume. The
        tolerance that the warning names gives about ten times the bytes."""
        sections = ""
        for k in range(24):
            turns = [2 * math.pi * (i + 0.3 * math.sin(7 * i + 3 * k)) / 40 for i in range(40)]
            rows = "".join(
                f'<PolygonPoint value="{1.2 * math.cos(a):.6f},{0.4 * math.sin(a):.6f}"/>' for a in sorted(turns)
            )
            sections += (
                f'<PositionSection t="{k / 24}"><Section type="CSectionPolygon">{rows}</Section></PositionSection>'
            )
        text = model(sections, attributes='type="CYarnSectionInterpPosition" Ramped="0" Polar="0"')
        path = self.file(text)
        done = self.succeeds("info", "--json", path)
        fitted = r"fitted to within (\S+) mm of their sections, with (\d+) control points instead of (\d+)"
        found = re.search(f"warning: the surfaces are {fitted}", done.stderr)
        self.assertLess(float(found[1]), 1e-3 * 0.8)
        self.assertLess(int(found[2]), int(found[3]) / 2)
        volume = json.loads(done.stdout)["inputs"][0]["yarns"][0]["volume"]
        exact = Model(path).yarns[0].volume()
        self.assertAlmostEqual(volume / exact, 1, delta=1e-3)
        tolerance = re.search(r"; --tolerance (\S+) gives", done.stderr)[1]
        iges = self.folder / "fitted.igs"
        done = self.succeeds("convert", path, "--tolerance", tolerance, "-o", iges, "-v")
        found = re.search(f"note: the surfaces are {fitted}", done.stderr)
        self.assertLess(float(found[1]), float(tolerance))
        self.assertNotIn("--tolerance", done.stderr)
        self.assertLess(iges.stat().st_size, 12 * path.stat().st_size)
        yarn = json.loads(self.succeeds("info", "--json", path, "--tolerance", tolerance).stdout)["inputs"][0]["yarns"][
            0
        ]
        self.assertAlmostEqual(yarn["volume"] / exact, 1, delta=2 * float(tolerance) / 0.4)

    def test_bad_input(self):
        whole = model(ELLIPSE)
        laughs = (
            '<!DOCTYPE x [<!ENTITY a0 "ha">'
            + "".join(f'<!ENTITY a{k + 1} "{f"&a{k};" * 10}">' for k in range(20))
            + "]>\n"
        )
        without = whole[: whole.index("<YarnSection")] + whole[whole.index("<Repeat") :]
        for text, said in (
            (
                whole.replace("<TexGen", laughs + "<TexGen").replace('name="t"', 'name="&a20;"'),
                "error: the file has a document type",
            ),
            (model(ELLIPSE, version="2.9"), "error: the model has the version '2.9': 3 is read"),
            (whole.replace(' version="3.13.2"', ""), "error: the model has the version ''"),
            (without, "YarnSection"),
            (ORTHOGONAL.replace('value="2"', 'value="3"', 1), "value"),
            (
                ORTHOGONAL.replace('<PatternElement value="2"/></PatternCell>', "</PatternCell>", 1),
                "levels, at the first one",
            ),
            (ORTHOGONAL.replace('WarpPower="0.6"', 'WarpPower="0"'), "error: the power 0 of a section"),
            (ORTHOGONAL.replace('WarpRatio="1" BinderRatio="1"', 'WarpRatio="0" BinderRatio="0"'), "are both 0"),
            (ANGLE.replace("AngleInterlock", "OffsetAngleInterlock"), "is not built from its parameters"),
        ):
            with self.subTest(said):
                self.assertIn(said, self.fails(1, "info", self.file(text)))

    def test_bad_models(self):
        whole = model(ELLIPSE)
        for text, said in (
            (model(ELLIPSE, version="4.0"), ":2:1: error: the model has the version '4.0'"),
            (whole[:300], "error: this is no whole XML text"),
            (whole.replace(ELLIPSE, ""), "error: this <YarnSection> has no <Section>"),
            (
                whole.replace("<TexGen", '<!DOCTYPE x [<!ENTITY a "b">]>\n<TexGen'),
                "error: the file has a document type",
            ),
            (whole.replace("5,0,2", "5,0"), "error: the Position of <MasterNode> is '5,0'"),
        ):
            with self.subTest(said):
                self.assertIn(said, self.fails(1, "info", self.file(text)))


if __name__ == "__main__":
    unittest.main()
