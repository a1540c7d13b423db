"""Files of triangles, read by the words of their formats alone: what the program wrote is judged by this and by other programs."""

import base64
import json
import pathlib
import re
import struct

import numpy as np


class Mesh:
    """A yarn: points n x 3, triangles m x 3 (of points' numbers), name and colour (three of 0-255, or none)."""

    def __init__(self, name, points, triangles, color=None):
        self.name, self.points, self.triangles, self.color = name, np.asarray(points), np.asarray(triangles, int), color

    def corners(self):
        return self.points[self.triangles]

    def volume(self):
        a, b, c = np.moveaxis(self.corners().astype(float) - self.points[0].astype(float), 1, 0)
        return float(np.sum(a * np.cross(b, c)) / 6)

    def areas(self):
        a, b, c = np.moveaxis(self.corners().astype(float), 1, 0)
        return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2

    def unpaired(self):
        """Directed edges that are there more often than the other way: none of a closed mesh, even where it is pinched."""
        t = self.triangles
        edges = np.vstack([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
        low, high = edges.min(axis=1), edges.max(axis=1)
        _, numbers = np.unique(low * len(self.points) + high, return_inverse=True)
        return int(np.count_nonzero(np.bincount(numbers, np.where(edges[:, 0] == low, 1, -1))))

    def bad_edges(self):
        """Directed edges that do not stand once each way."""
        t = self.triangles
        edges = np.vstack([t[:, [0, 1]], t[:, [1, 2]], t[:, [2, 0]]])
        count = len(self.points)
        there, numbers = np.unique(edges[:, 0] * count + edges[:, 1], return_counts=True)
        back = np.unique(edges[:, 1] * count + edges[:, 0])
        return int(np.sum(numbers > 1)) + len(np.setxor1d(there, back))


def welded(name, corners):
    """Of corners m x 3 x 3: those of the very same numbers are one point."""
    points, numbers = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return Mesh(name, points, numbers.reshape(-1, 3))


FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl(path):
    """All yarns of a binary file as one mesh, and the facets as they stand."""
    data = pathlib.Path(path).read_bytes()
    assert not data.startswith(b"solid"), "looks like text"
    (count,) = struct.unpack("<I", data[80:84])
    assert len(data) == 84 + 50 * count, (len(data), count)
    facets = np.frombuffer(data, FACET, count, 84)
    return welded("", facets["corners"]), facets


def stl_text(path):
    """A mesh a solid."""
    text = pathlib.Path(path).read_text()
    meshes = []
    for name, body in re.findall(r"^solid (.*)\n((?:.*\n)*?)endsolid \1\n", text, re.MULTILINE):
        rows = re.findall(r"^vertex (\S+) (\S+) (\S+)$", body, re.MULTILINE)
        assert len(rows) == 3 * body.count("facet normal") == 3 * body.count("endfacet")
        meshes.append(welded(name, np.array(rows, dtype=np.float32).reshape(-1, 3, 3)))
    assert len(meshes) == text.count("endsolid")
    return meshes


def obj(path):
    """A mesh an object; colours from the library of materials that it names."""
    path = pathlib.Path(path)
    colors, points, meshes, first = {}, [], [], 0
    for line in path.read_text().splitlines():
        word, _, rest = line.partition(" ")
        if word == "mtllib":
            for name, values in re.findall(r"^newmtl (\S+)\nKd (.*)$", (path.parent / rest).read_text(), re.MULTILINE):
                assert name not in colors
                colors[name] = tuple(round(255 * float(value)) for value in values.split())
        elif word == "o":
            first = len(points)
            meshes.append(Mesh(rest, [], np.zeros((0, 3))))
            meshes[-1].rows = []
        elif word == "usemtl":
            meshes[-1].color = colors[rest]
        elif word == "v":
            points.append([float(value) for value in rest.split()])
            assert len(points[-1]) == 3
        elif word == "f":
            meshes[-1].rows.append([int(value) - 1 - first for value in rest.split()])
        else:
            assert word in ("#", "g"), line
    starts = np.cumsum([0] + [max(map(max, mesh.rows)) + 1 for mesh in meshes])
    assert starts[-1] == len(points)
    return [
        Mesh(mesh.name, points[begin:end], mesh.rows, mesh.color)
        for mesh, begin, end in zip(meshes, starts, starts[1:])
    ]


def ply(path):
    """A mesh a yarn, and the header's lines."""
    data = pathlib.Path(path).read_bytes()
    head, _, rest = data.partition(b"end_header\n")
    lines = head.decode().splitlines()
    counts = {words[1]: int(words[2]) for words in map(str.split, lines) if words[0] == "element"}
    properties = [line for line in lines if line.startswith("property")]
    assert properties == [
        "property double x",
        "property double y",
        "property double z",
        "property uchar red",
        "property uchar green",
        "property uchar blue",
        "property int yarn",
        "property list uchar int vertex_indices",
    ], properties
    vertex = np.dtype([("p", "<f8", 3), ("color", "u1", 3), ("yarn", "<i4")])
    face = np.dtype([("count", "u1"), ("corners", "<i4", 3)])
    assert len(rest) == counts["vertex"] * vertex.itemsize + counts["face"] * face.itemsize
    vertices = np.frombuffer(rest, vertex, counts["vertex"])
    faces = np.frombuffer(rest, face, counts["face"], counts["vertex"] * vertex.itemsize)
    assert np.all(faces["count"] == 3)
    names = dict(re.findall(r"^comment yarn (\d+): (.*)$", head.decode(), re.MULTILINE))
    meshes = []
    yarns = vertices["yarn"][faces["corners"]]
    assert np.all(yarns == yarns[:, :1]), "a triangle of two yarns"
    for number in sorted(set(yarns[:, 0])):
        own = faces["corners"][yarns[:, 0] == number]
        used, numbers = np.unique(own, return_inverse=True)
        colors = np.unique(vertices["color"][used], axis=0)
        assert len(colors) == 1
        meshes.append(
            Mesh(names[str(number)], vertices["p"][used], numbers.reshape(-1, 3), tuple(int(c) for c in colors[0]))
        )
    assert sum(len(mesh.points) for mesh in meshes) == counts["vertex"], "a vertex of no face"
    return meshes, lines


def gltf_parts(path):
    """The JSON text as an object, and the buffer's bytes."""
    data = pathlib.Path(path).read_bytes()
    if not data.startswith(b"glTF"):
        document = json.loads(data.decode())
        kind, _, letters = document["buffers"][0]["uri"].partition(",")
        assert kind == "data:application/octet-stream;base64"
        return document, base64.b64decode(letters, validate=True)
    version, total, length, kind = struct.unpack("<III4s", data[4:20])
    assert (version, total, kind, length % 4) == (2, len(data), b"JSON", 0)
    document = json.loads(data[20 : 20 + length].decode())
    size, kind = struct.unpack("<I4s", data[20 + length : 28 + length])
    assert kind == b"BIN\0" and size % 4 == 0 and 28 + length + size == total
    assert "uri" not in document["buffers"][0]
    return document, data[28 + length :]


COMPONENTS = {5126: "<f4", 5125: "<u4"}
WIDTHS = {"VEC3": 3, "SCALAR": 1}


def accessor(document, data, number):
    """Its numbers; what it says of them holds."""
    entry = document["accessors"][number]
    view = document["bufferViews"][entry["bufferView"]]
    kind, width = np.dtype(COMPONENTS[entry["componentType"]]), WIDTHS[entry["type"]]
    assert view["byteOffset"] % kind.itemsize == 0 and "byteStride" not in view
    assert view["byteLength"] == entry["count"] * width * kind.itemsize
    assert view["byteOffset"] + view["byteLength"] <= document["buffers"][0]["byteLength"] == len(data)
    values = np.frombuffer(data, kind, entry["count"] * width, view["byteOffset"]).reshape(-1, width)
    assert entry["count"] > 0 and np.all(np.isfinite(values))
    for word, own in (("min", values.min(axis=0)), ("max", values.max(axis=0))):
        if word in entry:
            assert np.array_equal(np.float32(entry[word]), own), (word, entry[word], own)
    return values, view["target"]


def matrix_of(node):
    matrix = np.eye(4)
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return np.array(node["matrix"]).reshape(4, 4).T if "matrix" in node else matrix


def gltf(path, in_metres=False):
    """A mesh a node, where it stands: in the file's unit, or in metres with y up."""
    document, data = gltf_parts(path)
    assert document["asset"]["version"] == "2.0"
    nodes = document["nodes"]
    (root,) = document["scenes"][document["scene"]]["nodes"]
    assert sorted(nodes[root]["children"]) == [k for k in range(len(nodes)) if k != root]
    covered = sorted((view["byteOffset"], view["byteLength"]) for view in document["bufferViews"])
    assert [begin for begin, _ in covered] == [0, *np.cumsum([length for _, length in covered])[:-1]]
    meshes = []
    for k in nodes[root]["children"]:
        (primitive,) = document["meshes"][nodes[k]["mesh"]]["primitives"]
        points, target = accessor(document, data, primitive["attributes"]["POSITION"])
        assert target == 34962 and {"min", "max"} <= set(document["accessors"][primitive["attributes"]["POSITION"]])
        indices, target = accessor(document, data, primitive["indices"])
        assert target == 34963 and indices.max() < len(points)
        factor = document["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorFactor"]
        light = np.array(factor[:3])
        shares = np.where(light <= 0.0031308, light * 12.92, 1.055 * light ** (1 / 2.4) - 0.055)
        matrix = matrix_of(nodes[k])
        if in_metres:
            matrix = matrix_of(nodes[root]) @ matrix
        assert np.allclose(matrix[3], [0, 0, 0, 1])
        if not np.array_equal(matrix, np.eye(4)):
            points = points.astype(float) @ matrix[:3, :3].T + matrix[:3, 3]
        meshes.append(
            Mesh(nodes[k]["name"], points, indices.reshape(-1, 3), tuple(int(c) for c in np.round(255 * shares)))
        )
    return meshes
