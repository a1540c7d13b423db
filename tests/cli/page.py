"""What a page of `selvage view` holds, decoded by the page's description alone (src/view/page/page.h, shape.h)."""

import base64
import html.parser
import json
import pathlib

import numpy as np


class Elements(html.parser.HTMLParser):
    """Start tags with their attributes, and the texts of scripts by their id."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.scripts, self.title, self.inside = [], {}, "", None
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        self.inside = (tag, dict(attributes).get("id", ""))

    def handle_endtag(self, tag):
        self.inside = None

    def handle_data(self, data):
        if self.inside and self.inside[0] == "script":
            self.scripts[self.inside[1]] = self.scripts.get(self.inside[1], "") + data
        elif self.inside and self.inside[0] == "title":
            self.title += data


class Tube:
    """A part of a yarn: points and normals of its grid, rows x columns x 3, in the file's coordinates."""

    def __init__(self, points, normals, ends):
        self.points, self.normals, self.ends = points, normals, ends


class Page:
    def __init__(self, path):
        self.text = pathlib.Path(path).read_text()
        self.elements = Elements(self.text)
        self.data = json.loads(self.elements.scripts["data"])
        self.binary = base64.b64decode(self.elements.scripts["binary"], validate=True)
        self.centre = np.array(self.data["centre"])
        yarns = self.data.get("yarns")
        if yarns:
            self.names, count = yarns["names"], yarns["count"]
            self.shape_of = self.numbers("<u4", yarns["shape_of"], count)
            self.motions = self.numbers("<f4", yarns["motions"], 12 * count).reshape(count, 3, 4).astype(float)
            self.looks = self.numbers("u1", yarns["looks"], 4 * count).reshape(count, 4)
            self.measures = self.numbers("<f4", yarns["measures"], 2 * count).reshape(count, 2)

    def numbers(self, kind, at, count):
        return np.frombuffer(self.binary, kind, count, at)

    def shape(self, yarn):
        return self.data["shapes"][self.shape_of[yarn]]

    def place(self, yarn, points):
        motion = self.motions[yarn]
        return points @ motion[:, :3].T + motion[:, 3] + self.centre

    def tubes(self, yarn, level):
        shape = self.shape(yarn)
        step, description = shape["step"], shape["levels"][level]
        assert description["tube"]
        columns, tubes = description["columns"], []
        for at, rows, has_start, has_end, *origin in description["parts"]:
            grid = rows * columns
            count = grid + (has_start + has_end) * (columns + 1)
            points = (self.numbers("<u2", at, 3 * count).reshape(count, 3) + np.array(origin)) * step
            normals = self.numbers("i1", at + 6 * count, 3 * count).reshape(count, 3) / 127
            points = self.place(yarn, points)
            tubes.append(
                Tube(
                    points[:grid].reshape(rows, columns, 3),
                    (normals[:grid] @ self.motions[yarn][:, :3].T).reshape(rows, columns, 3),
                    points[grid:],
                )
            )
        return tubes

    def ribbons(self, yarn, level):
        """Of each part: points, half the width and half the height as vectors."""
        description, parts = self.shape(yarn)["levels"][level], []
        assert not description["tube"]
        for at, rows in description["parts"]:
            values = self.numbers("<f4", at, 9 * rows).reshape(rows, 3, 3).astype(float)
            turn = self.motions[yarn][:, :3].T
            parts.append((self.place(yarn, values[:, 0]), values[:, 1] @ turn, values[:, 2] @ turn))
        return parts

    def skin(self):
        """Points, triangles, and the region of each triangle."""
        skin = self.data["skin"]
        points = self.numbers("<f4", skin["points"], 3 * skin["point_count"]).reshape(-1, 3) + self.centre
        return (
            points,
            self.numbers("<u4", skin["triangles"], 3 * skin["triangle_count"]).reshape(-1, 3),
            self.numbers("<u4", skin["region_of"], skin["triangle_count"]),
        )

    def field(self, name, step=None):
        """Of the first step that has it, or of this one."""
        skin = self.data["skin"]
        field = next(one for one in skin["fields"] if one["name"] == name and step in (None, one["step"]))
        count = skin["point_count"] if field["of_points"] else skin["triangle_count"]
        return self.numbers("<f4", field["values"], field["components"] * count).reshape(count, field["components"])
