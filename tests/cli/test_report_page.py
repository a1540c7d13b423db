"""`selvage report`: reports joined, and shown on a page, which another parser reads."""

import base64
import hashlib
import html.parser
import json
import re
import shutil
import unittest

from program import BAD, Case, GRID, PATH, RING, SAMPLES, files_below
from test_view import decode

OVERLAPPING = ("fabric 1\nthread t\n diameter 1\nend\nyarn a t\n path\n -3 0 0\n 3 0 0\n end\nend\n"
               "yarn b t\n path\n 0 -3 0.9\n 0 3 0.9\n end\nend\n")
NASTY = 'a<b onclick="alert(1)">&amp;.txt'
VOID = {"meta", "link", "input", "img", "br"}


class Page(html.parser.HTMLParser):
    """Heads and rows of the table `inputs`; each cell: tag, attributes, text, the images in it. Every address that it names."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.heads, self.rows, self.addresses, self.open, self.texts, self.buttons = [], [], [], [], {}, 0
        self.cell, self.inner = None, 0
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attributes):
        facts = dict(attributes)
        self.addresses += [value for name, value in attributes if name in ("src", "href", "action", "srcset", "data")]
        if tag not in VOID:
            self.open.append(tag)
        if tag == "table":
            self.inner += 1
        if tag == "button":
            self.buttons += 1
        if self.inner == 1 and tag == "tr" and "tbody" in self.open:
            self.rows.append([])
        if self.inner == 1 and tag in ("td", "th") and "table" in self.open:
            self.cell = {"tag": tag, "text": "", "images": [], **{f"@{name}": value for name, value in attributes}}
            (self.rows[-1] if "tbody" in self.open else self.heads).append(self.cell)
        if tag == "img" and self.cell is not None:
            self.cell["images"].append(facts)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag
        if tag == "table":
            self.inner -= 1
        if self.inner == 1 and tag in ("td", "th"):
            self.cell = None

    def handle_data(self, data):
        if self.open:
            self.texts[self.open[-1]] = self.texts.get(self.open[-1], "") + data
        if self.cell is not None and "table" in self.open:
            self.cell["text"] += data

    def column(self, name):
        return [head["text"] for head in self.heads].index(name)

    def cells(self, name):
        return [row[self.column(name)] for row in self.rows]


class Base(Case):
    def setUp(self):
        super().setUp()
        self.report = self.folder / "report.json"

    def page(self, *reports, options=()):
        target = self.folder / "page.html"
        self.succeeds("report", "html", *(reports or (self.report,)), "-o", target, *options)
        self.text = target.read_text()
        return Page(self.text)


class Pages(Base):
    def several(self, *options):
        """Well, with a defect, without a meaning, warned of, and not there."""
        folder = self.folder / "in"
        folder.mkdir()
        shutil.copy(PATH, folder / "well.txt")
        (folder / NASTY).write_text(OVERLAPPING)
        shutil.copy(BAD / "misspelt.txt", folder / "misspelt.txt")
        (folder / "warned.txt").write_text("fabric 1\nthread t\n tex 30\n density 1.52\n packing 0.75\n diameter 0.0912\nend\n"
                                           "yarn a t\n path\n 0 0 0\n 1 0 0\n end\nend\n")
        self.fails(1, "check", folder / "well.txt", folder / "warned.txt", folder / NASTY, folder / "misspelt.txt", folder / "nowhere.txt",
                   "--report", self.report, *options)
        return folder

    def test_errors_first(self):
        folder = self.several()
        page = self.page(options=("--no-pictures",))
        self.assertEqual([cell["text"] for cell in page.cells("Status")], ["failed", "failed", "defect", "warnings", "ok"])
        names = [f"{folder}/{name}" for name in ("misspelt.txt", "nowhere.txt", NASTY, "warned.txt", "well.txt")]
        self.assertEqual([cell["@data-value"] for cell in page.cells("Input")], names)
        for cell, name in zip(page.cells("Input"), names):
            self.assertTrue(cell["text"].startswith(name), cell)
            self.assertEqual((cell["tag"], cell["@scope"]), ("th", "row"))
        self.assertEqual(page.texts["h1"], "5 inputs: 2 failed, 1 with defects, 1 with warnings, 1 ok")
        self.assertEqual(page.texts["title"], page.texts["h1"])

    def test_names_and_messages_are_text(self):
        self.several()
        report = json.loads(self.report.read_text())
        report["inputs"][0]["messages"] = [{"severity": "error", "where": "<i>&", "text": "</td><script>alert(1)</script>\"'"}]
        self.report.write_text(json.dumps(report))
        page = self.page(options=("--no-pictures",))
        self.assertNotIn("<b onclick", self.text)
        self.assertEqual(self.text.count("<script>"), 1)
        self.assertIn("</td><script>alert(1)</script>\"' <i>&", page.rows[-1][page.column("Messages")]["text"])

    def test_figures_are_those_of_the_report(self):
        self.several()
        entries = {entry["path"]: entry for entry in json.loads(self.report.read_text())["inputs"]}
        page = self.page(options=("--no-pictures",))
        for row in page.rows:
            entry = entries[row[page.column("Input")]["@data-value"]]
            for head, value in (("Yarns", entry.get("yarn_count")), ("Least gap, mm", entry.get("min_gap")), ("Seconds", entry["seconds"]),
                                ("Overlaps", len(entry["overlaps"]) if "overlaps" in entry else None),
                                ("Deepest, mm", entry["overlaps"][0]["depth"] if entry.get("overlaps") else None)):
                cell = row[page.column(head)]
                if value is None:
                    self.assertEqual((cell["text"], cell.get("@data-value")), ("", None), head)
                else:
                    self.assertEqual(float(cell["@data-value"]), value, head)
                    self.assertAlmostEqual(float(cell["text"]) / value if value else 1, 1, delta=1e-3)
        misspelt = page.rows[0][page.column("Messages")]["text"]
        self.assertIn("did you mean", misspelt)
        self.assertIn("misspelt.txt:3:3", misspelt)
        # What no input has is no column.
        self.assertNotIn("Tetrahedra", [head["text"] for head in page.heads])

    def test_data_sheets(self):
        source = SAMPLES / "weave_denim.txt"
        self.succeeds("info", source, "--report", self.report)
        sheet = json.loads(self.report.read_text())["inputs"][0]["sheets"]["weave"]
        page = self.page(options=("--no-pictures",))
        row, = page.rows
        for head, value in (("Mass, g/m²", sheet["mass"]), ("Thickness, mm", sheet["thickness"]), ("Cover, %", 100 * sheet["cover"]),
                            ("Fibres fill, %", 100 * sheet["fibre_fraction"])):
            self.assertAlmostEqual(float(row[page.column(head)]["@data-value"]), value, places=9)
        text = row[page.column("Input")]["text"]
        for word in ("Data sheet", "weave", "warp", "weft", "crimp", "cover factor", "yarn fraction"):
            self.assertIn(word, text)
        self.assertIn(f"{sheet['systems']['warp']['crimp']:.4g}", text)

    def test_outputs(self):
        self.succeeds("convert", GRID, "-o", f"{self.out}/", "--report", self.report)
        page = self.page(options=("--no-pictures",))
        self.assertEqual(page.rows[0][page.column("Files")]["text"], "2")
        self.assertIn(f"{self.out}/plain4_grid.igs, {(self.out / 'plain4_grid.igs').stat().st_size} bytes", page.rows[0][page.column("Input")]["text"])

    def test_it_can_be_sorted(self):
        self.several()
        page = self.page(options=("--no-pictures",))
        self.assertEqual(page.buttons, len(page.heads))
        for head in page.heads:
            self.assertEqual((head["tag"], head["@scope"]), ("th", "col"))
        self.assertEqual([head["text"] for head in page.heads if "@aria-sort" in head], ["Status"])
        self.assertEqual([int(cell["@data-value"]) for cell in page.cells("Status")], [0, 0, 1, 2, 3])
        self.assertEqual(page.texts["caption"], "An input a row. The buttons of the head sort the rows.")
        self.assertEqual({len(row) for row in page.rows}, {len(page.heads)})

    def test_pictures(self):
        folder = self.several()
        (folder / "warned.txt").write_text((folder / "warned.txt").read_text() + "# changed\n")
        page = self.page()
        cells = [row[0] for row in page.rows]
        for cell, note in zip(cells, ("unknown|did you mean", "the file is not there", None, "the file has changed since the report", None)):
            if note:
                self.assertEqual(cell["images"], [])
                self.assertRegex(cell["text"], f"^No picture: .*({note})")
                continue
            image, = cell["images"]
            start = "data:image/png;base64,"
            self.assertTrue(image["src"].startswith(start))
            width, height, rows = decode(base64.b64decode(image["src"][len(start):], validate=True))
            self.assertEqual((width, height), (200, 150))
            self.assertGreater(sum(pixel != (255, 255, 255) for row in rows for pixel in row), 2000)
        self.assertEqual(cells[2]["images"][0]["alt"], f"{folder}/{NASTY}")

    def test_variants_are_drawn_as_they_were(self):
        self.succeeds("sweep", SAMPLES / "plain_by_params.txt", "--set", "sett=20,40", "--csv", self.folder / "x.csv", "--report", self.report,
                      "--do", "info")
        page = self.page()
        images = [row[0]["images"][0]["src"] for row in page.rows]
        self.assertEqual(len(set(images)), 2)

    def test_nothing_is_loaded(self):
        self.several()
        page = self.page()
        for address in page.addresses:
            self.assertRegex(address, r"^(data:|#)")
        for word in ("http:", "https:", "@import", "url(", "fetch(", "XMLHttpRequest", "WebSocket"):
            self.assertNotIn(word, self.text)
        self.assertIn("default-src 'none'", self.text)
        self.assertIn("prefers-color-scheme: dark", self.text)

    def test_the_same_bytes_with_any_number_of_workers(self):
        self.several()
        pages = []
        for workers in (1, 2, 4):
            self.page(options=("-j", workers))
            pages.append(self.text)
        self.assertEqual(len(set(pages)), 1)

    def test_an_empty_report(self):
        self.report.write_text('{"inputs": []}')
        page = self.page()
        self.assertEqual((page.rows, page.texts["h1"]), ([], "0 inputs"))


class Merge(Base):
    def test_shards_joined_are_the_whole(self):
        inputs = [GRID, PATH, RING]
        shards = [self.folder / f"{k}.json" for k in range(2)]
        for k, shard in enumerate(shards):
            self.succeeds("convert", *inputs, "--to", "iges", "-o", f"{self.out}/", "--shard", f"{k}/2", "--report", shard)
        self.succeeds("convert", *inputs, "--to", "iges", "-o", f"{self.out}/", "--report", self.report)
        self.succeeds("report", "merge", *shards, "-o", self.folder / "all.json")
        whole, merged = (json.loads((self.folder / name).read_text()) for name in ("report.json", "all.json"))
        self.assertEqual(list(merged), list(whole))
        for key in ("selvage", "libraries", "ok", "counts"):
            self.assertEqual(merged[key], whole[key], key)
        def without_times(report):
            return [{key: value for key, value in entry.items() if key not in ("seconds", "outputs")} for entry in report["inputs"]]
        self.assertEqual(without_times(merged), without_times(whole))
        parts = [json.loads(shard.read_text()) for shard in shards]
        self.assertAlmostEqual(merged["seconds"], sum(part["seconds"] for part in parts))
        self.assertEqual(merged["started"], min(part["started"] for part in parts))
        # A page of both is that of the whole.
        page = self.page(*shards, options=("--no-pictures",))
        self.assertEqual(len(page.rows), 3)

    def test_one_that_failed(self):
        self.succeeds("info", GRID, "--report", self.folder / "a.json")
        self.fails(1, "info", "nowhere.txt", "--report", self.folder / "b.json")
        printed = self.succeeds("report", "merge", self.folder / "a.json", self.folder / "b.json", "-o", "-").stdout
        merged = json.loads(printed)
        self.assertEqual((merged["ok"], merged["counts"]), (False, {"inputs": 2, "done": 1, "failed": 1, "skipped": 0}))


class Refusals(Base):
    def test_no_words_of_a_file_that_the_report_does_not_know(self):
        """A stranger's report may name any file."""
        secret = self.folder / "secret.txt"
        secret.write_text("confidential words\n")
        for digest, is_shown in ((None, False), ("0" * 64, False), (hashlib.sha256(secret.read_bytes()).hexdigest(), True)):
            self.report.write_text(json.dumps({"inputs": [{"path": str(secret), **({"sha256": digest} if digest else {})}]}))
            self.succeeds("report", "html", self.report, "-o", self.folder / "x.html")
            self.assertEqual("confidential" in (self.folder / "x.html").read_text(), is_shown, digest)

    def test_no_reports(self):
        for text, words in (("[1, 2]", "not a report"), ('{"a": 1}', "not a report"), ("{", "not a report"), ("", "not a report"),
                            ('{"inputs": 3}', "not a report"), ('{"inputs": [{"path": "a.txt"}, {"ok": true}]}', "its input 2 has no path"),
                            ('{"inputs": [4]}', "its input 1 has no path")):
            self.report.write_text(text)
            for action, target in (("html", "x.html"), ("merge", "x.json")):
                message = self.fails(1, "report", action, self.report, "-o", self.folder / target)
                self.assertIn(f"{self.report}: error: ", message)
                self.assertIn(words, message)
        self.assertIn("nowhere.json", self.fails(1, "report", "html", self.folder / "nowhere.json", "-o", self.folder / "x.html"))
        self.assertEqual(list(files_below(self.folder)), ["report.json"])

    def test_words(self):
        self.report.write_text('{"inputs": []}')
        self.assertIn("'pdf' is not merge or html", self.fails(2, "report", "pdf", self.report, "-o", self.folder / "x.html"))
        self.assertIn("ends with .html", self.fails(2, "report", "html", self.report, "-o", self.folder / "x.json"))
        self.assertIn("selvage report html", self.fails(2, "report", "merge", self.report, "-o", self.folder / "x.html"))
        self.assertIn("--output", self.fails(2, "report", "html", self.report))
        self.assertIn("REPORT", self.fails(2, "report", "html", "-o", self.folder / "x.html"))

    def test_the_command_is_in_the_tables(self):
        self.assertRegex(self.succeeds("--help").stdout, r"(?m)^\s+report\s")
        for form in ("man", "complete-bash", "complete-zsh", "complete-fish", "json-usage"):
            text = self.succeeds("--generate", form).stdout
            for word in ("report", "no-pictures", "section", "no-scale-bar"):
                self.assertIn(word, text.replace("\\-", "-"), form)
        self.assertIsNone(re.search("not in this version", self.fails(2, "report")))


if __name__ == "__main__":
    unittest.main()
