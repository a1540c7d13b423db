"""Pages of `selvage view` in a real browser, a Chromium without a screen and without a network, opened as files.

Runs every night, and by hand: chromium, ccx, python3-numpy and python3-pil have to be there, then
  SELVAGE=build/bin/selvage /usr/bin/python3 tests/page/test_browser.py
SELVAGE_SCREENSHOTS=FOLDER keeps the pictures that were taken, to be looked at.
"""

import io
import json
import os
import pathlib
import subprocess
import sys
import unittest

import numpy as np
from PIL import Image

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "cli"))

from browser import NO_WEBGL, Browser
from program import SAMPLES, Case, environment

CLOTHS = [
    "weave_denim.txt",
    "weave_orthogonal.txt",
    "jersey.txt",
    "warpknit_tricot.txt",
    "braid_triaxial.txt",
    "ply2_plain.txt",
]
KEPT = os.environ.get("SELVAGE_SCREENSHOTS")
CROSS = "fabric 1\nunits mm\nthread rod\n  diameter 0.4\nend\n" + "".join(
    f"yarn {name} rod\n  path chord\n    {a}\n    {b}\n  end\nend\n"
    for name, a, b in (
        ('"<b onclick=alert(1)>a</b>"', "-2 0 0", "2 0 0"),
        ("b", "0 -2 0.35", "0 2 0.35"),
        ("c", "-1 -2 -0.41", "-1 2 -0.41"),
    )
)
JERSEY = "fabric 1\nthread y\n tex 30\n density 1.52\n packing 0.75\nend\nknit jersey\n thread y\n courses {0}\n wales {0}\nend\n"


class Pages(Case):
    @classmethod
    def setUpClass(cls):
        cls.browser = Browser(width=1200, height=800)

    @classmethod
    def tearDownClass(cls):
        cls.browser.close()

    def source(self, text, name="cloth.txt"):
        (self.folder / name).write_text(text)
        return self.folder / name

    def open(self, source, *options, browser=None):
        page = self.folder / f"{pathlib.Path(source).stem}.html"
        self.succeeds("view", source, "-o", page, *options)
        (browser or self.browser).open(page)
        self.page = page
        return page

    def assert_quiet(self, browser=None):
        """Nothing on the console, and nothing asked for but the page itself."""
        browser = browser or self.browser
        self.assertEqual(browser.messages, [])
        self.assertEqual(
            [url for url in browser.requests if not url.startswith("data:")], [self.page.resolve().as_uri()]
        )

    def picture(self, name=None, browser=None):
        """The canvas as it is on the screen, height x width x 3."""
        browser = browser or self.browser
        browser.until("!selvage.scene.asked && !selvage.scene.eye.moving")
        browser.settle()
        shot = browser.screenshot()
        if KEPT and name:
            pathlib.Path(KEPT).mkdir(parents=True, exist_ok=True)
            (pathlib.Path(KEPT) / f"{name}.png").write_bytes(shot)
        left, top, right, bottom = browser.run(
            "(() => { const b = document.getElementById('stage').getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; })()"
        )
        image = np.asarray(Image.open(io.BytesIO(shot)).convert("RGB")).astype(int)
        return image[round(top) : round(bottom), round(left) : round(right)]

    def drawn(self, image):
        """Where something is: what differs from the ground, but for the labels in the corners."""
        ground = image[5, image.shape[1] // 2]
        found = np.abs(image - ground).max(axis=2) > 12
        found[:48, :460] = found[-56:, :] = False
        return found

    def only(self, index):
        self.browser.run(f"selvage.panel.isolate({index})")

    def test_six_cloths(self):
        for name in CLOTHS:
            with self.subTest(cloth=name):
                self.open(SAMPLES / name)
                names = self.browser.run("selvage.model.names")
                facts = json.loads(self.succeeds("info", SAMPLES / name, "--json").stdout)["inputs"][0]
                self.assertEqual(names, [yarn["name"] for yarn in facts["yarns"]])
                stem = pathlib.Path(name).stem
                whole = self.drawn(self.picture(stem))
                self.assertGreater(whole.mean(), 0.03)
                # Each yarn by itself: it is drawn, and where it is something was drawn before.
                for index in range(0, len(names), max(1, len(names) // 24)):
                    self.only(index)
                    alone = self.drawn(self.picture())
                    self.assertGreater(alone.sum(), 60, names[index])
                    self.assertGreater((whole & alone).sum() / alone.sum(), 0.97, names[index])
                # One hidden by its box in the list: what only it covered is ground now.
                self.browser.run("selvage.panel.showAll()")
                self.browser.run("document.querySelector('ul.list input').click()")
                hidden = self.drawn(self.picture())
                self.assertLess(hidden.sum(), whole.sum())
                self.browser.run("selvage.panel.showAll()")
                self.assertEqual(self.drawn(self.picture()).sum(), whole.sum())
                # The section moves: the more is cut away the less is there, and what was cut is filled.
                self.browser.run("axis.value = 'x'; axis.dispatchEvent(new Event('change'))")
                left = []
                for place in (900, 500, 100):
                    self.browser.run(
                        "(() => { const s = document.querySelector('#panel input[type=range]'); "
                        f"s.value = {place}; s.dispatchEvent(new Event('input')); }})()"
                    )
                    left.append(self.drawn(self.picture(f"{stem}-section" if place == 500 else None)).sum())
                self.assertTrue(whole.sum() > left[0] > left[1] > left[2] > 0, left)
                self.assert_quiet()

    def test_overlaps_are_listed_and_gone_to(self):
        source = self.source(CROSS)
        self.open(source)
        rows = self.browser.run(
            "[...document.querySelectorAll('#panel ul.list')].slice(1).map((l) => [...l.children].map((r) => r.textContent))"
        )
        self.assertEqual(len(rows), 2, rows)
        self.assertEqual(len(rows[0]), 1)
        self.assertIn("<b onclick=alert(1)>a</b>, b", rows[0][0])
        self.assertRegex(rows[0][0], r"0\.0(49|50)\d* mm deep")
        self.assertRegex(rows[1][0], r"0\.0(09|10)\d* mm apart")
        self.assertEqual(self.browser.run("document.querySelectorAll('main b').length"), 0)
        before = self.picture("overlap")
        pink = lambda image: ((image[..., 0] > 150) & (image[..., 1] < 110) & (image[..., 2] > 90)).sum()
        self.assertGreater(pink(before), 10)
        self.browser.run("document.querySelectorAll('#panel ul.list')[1].querySelector('button').click()")
        self.browser.until("!selvage.scene.eye.moving")
        near = self.picture("overlap-near")
        self.assertGreater(self.drawn(near).sum(), 2 * self.drawn(before).sum())
        self.assertEqual(self.browser.run("document.querySelectorAll('#overlay .ring').length"), 1)
        self.assertIn("deep, at", self.browser.run("document.getElementById('status').textContent"))
        # As published the stitch overlaps: as many as check finds.
        self.open(SAMPLES / "jersey.txt", "--as-published")
        report = self.folder / "r.json"
        self.fails(3, "check", SAMPLES / "jersey.txt", "--as-published", "--report", report)
        count = len(json.loads(report.read_text())["inputs"][0]["overlaps"])
        self.assertGreater(count, 0)
        self.assertEqual(self.browser.run("Number(document.querySelector('[data-count]').dataset.count)"), count)
        self.picture("overlaps-published")
        self.assert_quiet()

    def test_hover_and_measure(self):
        self.open(self.source(CROSS))
        self.browser.click("[data-view=top]")
        self.browser.until("!selvage.scene.eye.moving")

        def at(x, y, z):
            place = self.browser.run(
                f"(() => {{ const s = selvage.scene, p = s.eye.target.clone().set({x}, {y}, {z});"
                f" p.x -= selvage.data.centre[0]; p.y -= selvage.data.centre[1]; p.z -= selvage.data.centre[2];"
                " const b = s.canvas.getBoundingClientRect(), q = s.project(p); return [b.left + q.x, b.top + q.y]; })()"
            )
            return place

        x, y = at(-1.5, 0, 0.2)
        self.browser.mouse("mouseMoved", x, y)
        self.browser.until("readout.textContent.includes('onclick')")
        said = self.browser.run("readout.textContent")
        self.assertRegex(said, r"-?−1\.\d+, −?0\.\d+, 0\.\d+ mm")
        self.browser.click("#measure")
        for x, y in (at(-1.5, 0, 0.2), at(1.5, 0, 0.2)):
            self.browser.mouse("mouseMoved", x, y)
            self.browser.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
            self.browser.mouse("mouseReleased", x, y, button="left", clickCount=1)
        self.browser.until("selvage.measure.points.length === 2")
        distance = self.browser.run("selvage.measure.points[0].distanceTo(selvage.measure.points[1])")
        self.assertAlmostEqual(distance, 3, delta=0.03)
        self.assertIn("Distance", self.browser.run("document.getElementById('status').textContent"))
        self.picture("measure")
        # A click without it chooses the yarn, in the list too.
        self.browser.click("#measure")
        self.browser.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        self.browser.mouse("mouseReleased", x, y, button="left", clickCount=1)
        self.browser.until("selvage.model.selected === 0")
        self.assertEqual(self.browser.run("document.querySelectorAll('li.chosen').length"), 1)
        self.assert_quiet()

    def test_keys_and_screen_readers(self):
        self.open(SAMPLES / "jersey.txt")
        browser = self.browser
        browser.run("document.getElementById('canvas').focus()")
        before = self.picture()
        for _ in range(4):
            browser.key("ArrowRight")
        turned = self.picture()
        self.assertGreater(np.abs(turned - before).max(axis=2).astype(bool).mean(), 0.02)
        browser.key("+")
        self.assertGreater(self.drawn(self.picture()).sum(), self.drawn(turned).sum())
        browser.key("1")
        browser.until("!selvage.scene.eye.moving")
        self.assertAlmostEqual(browser.run("selvage.scene.eye.tilt"), np.pi / 2, delta=1e-6)
        browser.key("m")
        browser.key("Enter")
        self.assertRegex(
            browser.run("document.getElementById('status').textContent"), "First point on|nothing at this point"
        )
        browser.key("Escape")
        # All that can be used is reached by the tabulator, shows that, and has a name.
        browser.run(
            "document.querySelector('.skip').focus(); window.reached = []; document.addEventListener('focusin', (e) => reached.push(e.target))"
        )
        for _ in range(60):
            browser.key("Tab")
        self.assertTrue(
            browser.run(
                "[...document.querySelectorAll('.tools button, #colors, #axis, ul.list button, #panel input[type=search]')]"
                ".slice(0, 25).every((e) => reached.includes(e))"
            )
        )
        outline = browser.run("getComputedStyle(document.activeElement).outlineStyle")
        self.assertEqual(outline, "solid")
        tree = browser.call("Accessibility.getFullAXTree")["nodes"]
        for node in tree:
            if node.get("ignored") or node.get("role", {}).get("value") not in (
                "button",
                "checkbox",
                "combobox",
                "slider",
                "searchbox",
                "spinbutton",
                "application",
                "list",
            ):
                continue
            self.assertTrue(node.get("name", {}).get("value"), node)
        self.assert_quiet()

    def test_light_dark_and_still(self):
        def luminance(color):
            parts = [int(part) / 255 for part in color[color.index("(") + 1 : -1].split(",")[:3]]
            linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
            return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

        for scheme in ("light", "dark"):
            self.browser.call(
                "Emulation.setEmulatedMedia",
                features=[
                    {"name": "prefers-color-scheme", "value": scheme},
                    {"name": "prefers-reduced-motion", "value": "reduce"},
                ],
            )
            self.open(self.source(CROSS))
            grounds = self.browser.run(
                "['header', '#panel'].map((s) => getComputedStyle(document.querySelector(s)).backgroundColor)"
            )
            self.assertEqual(luminance(grounds[0]) > 0.5, scheme == "light")
            for where in ("h1", "#facts", "h2", ".note", "h3.overlap", "h3.near", ".number", "button"):
                text, own = self.browser.run(
                    f"(() => {{ const s = getComputedStyle(document.querySelector({where!r})); return [s.color, s.backgroundColor]; }})()"
                )
                ground = own if "rgba" not in own else grounds[1]
                dark, light = sorted((luminance(text), luminance(ground)))
                self.assertGreaterEqual((light + 0.05) / (dark + 0.05), 4.5, (scheme, where, text, ground))
            # Without motion the eye is there at once.
            self.browser.run("document.querySelector('[data-view=side]').click()")
            self.assertFalse(self.browser.run("selvage.scene.eye.moving"))
            self.picture(scheme)
            self.assert_quiet()
        self.browser.call("Emulation.setEmulatedMedia", features=[])

    def test_a_narrow_window(self):
        self.browser.call(
            "Emulation.setDeviceMetricsOverride", width=420, height=800, deviceScaleFactor=1, mobile=False
        )
        self.addCleanup(
            lambda: self.browser.call(
                "Emulation.setDeviceMetricsOverride", width=1200, height=800, deviceScaleFactor=1, mobile=False
            )
        )
        self.open(SAMPLES / "jersey.txt")
        self.assertGreater(self.drawn(self.picture("narrow")).sum(), 5000)
        self.assertLessEqual(self.browser.run("document.documentElement.scrollWidth"), 420)

    def test_meshes(self):
        mesh = self.folder / "plain.vtu"
        self.succeeds("mesh", SAMPLES / "plain4_path.txt", "-o", mesh)
        self.open(mesh)
        whole = self.drawn(self.picture("mesh"))
        self.assertGreater(whole.mean(), 0.03)
        for region in range(4):
            self.only(region)
            alone = self.drawn(self.picture())
            self.assertGreater(alone.sum(), 500)
            self.assertGreater((whole & alone).sum() / alone.sum(), 0.97)
        self.browser.run("selvage.panel.showAll()")
        self.assertEqual(self.browser.run("document.querySelectorAll('svg.bars').length"), 3)
        self.browser.run(
            "field.value = [...field.options].find((o) => o.textContent === 'min_dihedral').value; field.dispatchEvent(new Event('change'))"
        )
        low, high = self.browser.run("selvage.model.uniforms.range.value.toArray()")
        self.assertTrue(0 < low < high < 75)
        self.picture("mesh-field")
        self.assert_quiet()

    def test_results(self):
        self.succeeds(
            "mesh",
            SAMPLES / "cell_straight.txt",
            "--matrix",
            "--periodic",
            "--voxel",
            8,
            "-o",
            self.folder / "cell.inp",
        )
        subprocess.run(
            ["ccx", "-i", "cell"],
            cwd=self.folder,
            check=True,
            capture_output=True,
            env=environment(OMP_NUM_THREADS="1"),
        )
        self.open(self.folder / "cell.frd")
        names = self.browser.run("selvage.model.names")
        self.assertEqual(sorted(names), ["Matrix", "tow"])
        before = self.picture("results-regions")
        self.browser.run(
            "field.value = [...field.options].find((o) => o.textContent === 'STRESS').value; field.dispatchEvent(new Event('change'))"
        )
        first = self.browser.run("selvage.model.uniforms.range.value.toArray()")
        self.browser.run("step.value = '2'; step.dispatchEvent(new Event('change'))")
        self.assertNotEqual(self.browser.run("selvage.model.uniforms.range.value.toArray()"), first)
        colored = self.picture("results-stress")
        self.assertGreater(np.abs(colored - before).max(axis=2).astype(bool).mean(), 0.05)
        self.browser.run("moved.value = 'DISP'; moved.dispatchEvent(new Event('change'))")
        self.assertGreater(np.abs(self.picture("results-moved") - colored).max(axis=2).astype(bool).mean(), 0.01)
        self.browser.mouse("mouseMoved", 450, 420)
        self.browser.until("/STRESS/.test(readout.textContent)")
        self.assert_quiet()

    def test_without_webgl(self):
        with Browser(NO_WEBGL) as browser:
            self.open(SAMPLES / "jersey.txt", browser=browser)
            self.assertIn("no WebGL", browser.run("document.querySelector('[role=alert]').textContent"))
            browser.until("document.querySelector('img.fallback').naturalWidth > 300")
            if KEPT:
                (pathlib.Path(KEPT) / "without-webgl.png").write_bytes(browser.screenshot())
            self.assert_quiet(browser)

    def test_many_loops(self):
        """50 x 50 in full, 641 x 641 and a million by what can be seen of them."""
        for side, most in ((50, 1_500_000), (641, 4_000_000), (1000, 10_000_000)):
            with self.subTest(side=side):
                self.open(self.source(JERSEY.format(side), f"jersey{side}.txt"))
                self.assertEqual(self.browser.run("selvage.model.count"), side)
                self.assertLess(self.browser.run("selvage.model.triangles"), most)
                self.assertGreater(self.drawn(self.picture(f"jersey{side}")).mean(), 0.2)
                # Near, it is drawn in full, and what is not seen is left out.
                self.browser.run(f"selvage.scene.eye.zoom({8 / side})")
                self.assertGreater(self.drawn(self.picture(f"jersey{side}-near")).mean(), 0.4)
                self.assertLess(self.browser.run("selvage.model.triangles"), 1_500_000)
                self.assert_quiet()

    def test_a_page_of_a_report(self):
        report, source = self.folder / "r.json", self.source(CROSS)
        self.fails(
            1,
            "check",
            SAMPLES / "plain4_path.txt",
            source,
            SAMPLES / "ring.txt",
            SAMPLES / "bad/misspelt.txt",
            "--report",
            report,
        )
        self.page = self.folder / "r.html"
        self.succeeds("report", "html", report, "-o", self.page)
        browser = self.browser
        for scheme in ("dark", "light"):
            browser.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
            browser.open(self.page, "document.readyState === 'complete'")
            if KEPT:
                pathlib.Path(KEPT).mkdir(parents=True, exist_ok=True)
                (pathlib.Path(KEPT) / f"report-{scheme}.png").write_bytes(browser.screenshot())
            (red,) = browser.run(
                "[getComputedStyle(document.querySelector('.wide')).backgroundColor.match(/[0-9]+/)[0]]"
            )
            self.assertEqual(int(red) > 128, scheme == "light")
        browser.call("Emulation.setEmulatedMedia", features=[])

        def names():
            return browser.run(
                "[...document.querySelectorAll('#inputs > tbody > tr > th')].map((cell) => cell.dataset.value.split('/').pop())"
            )

        def sort(head, *keys):
            browser.run(
                f"[...document.querySelectorAll('#inputs thead button')].find((one) => one.textContent === {head!r}).focus()"
            )
            for key in keys:
                browser.key(key)
            browser.settle()
            return names(), browser.run(
                "[...document.querySelectorAll('[aria-sort]')].map((one) => [one.textContent, one.getAttribute('aria-sort')])"
            )

        self.assertEqual(names(), ["misspelt.txt", "cloth.txt", "plain4_path.txt", "ring.txt"])
        self.assertEqual(
            sort("Input", "Enter"),
            (["cloth.txt", "misspelt.txt", "plain4_path.txt", "ring.txt"], [["Input", "ascending"]]),
        )
        # Without a value at the end, upwards and downwards.
        self.assertEqual(
            sort("Yarns", "Enter"),
            (["ring.txt", "cloth.txt", "plain4_path.txt", "misspelt.txt"], [["Yarns", "ascending"]]),
        )
        self.assertEqual(
            sort("Yarns", "Enter"),
            (["plain4_path.txt", "cloth.txt", "ring.txt", "misspelt.txt"], [["Yarns", "descending"]]),
        )
        browser.run(
            "document.getElementById('find').value = 'did you mean'; document.getElementById('find').dispatchEvent(new Event('input'))"
        )
        self.assertEqual(
            browser.run("[...document.querySelectorAll('#inputs > tbody > tr:not([hidden]) > th')].length"), 1
        )
        self.assertEqual(browser.run("found.textContent"), "1 of 4")
        browser.run(
            "document.getElementById('find').value = ''; document.getElementById('find').dispatchEvent(new Event('input'))"
        )
        self.assertTrue(
            browser.run(
                "[...document.images].every((image) => image.naturalWidth === 200) && document.images.length === 3"
            )
        )
        self.assert_quiet()


if __name__ == "__main__":
    unittest.main()
