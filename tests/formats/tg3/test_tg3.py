"""Small TexGen models: volumes against those of an oracle and of formulas, copies in a domain, bad input."""

import json
import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cli"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from oracle import Model  # noqa: E402
from program import Case  # noqa: E402

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
        blended = "".join(f'<PositionSection t="{t}">{section}</PositionSection>' for t, section in ((0, ELLIPSE), (0.4, LENS)))
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

    def test_bad_input(self):
        whole = model(ELLIPSE)
        for text, said in ((model(ELLIPSE, version="4.0"), ":2:1: error: the model has the version '4.0'"),
                           (whole[:300], "error: this is no whole XML text"),
                           (whole.replace(ELLIPSE, ""), "error: this <YarnSection> has no <Section>"),
                           (whole.replace("<TexGen", '<!DOCTYPE x [<!ENTITY a "b">]>\n<TexGen'), "error: the file has a document type"),
                           (whole.replace("5,0,2", "5,0"), "error: the Position of <MasterNode> is '5,0'")):
            with self.subTest(said):
                self.assertIn(said, self.fails(1, "info", self.file(text)))


if __name__ == "__main__":
    unittest.main()
