"""OpenFOAM's polyMesh, read by its description (OpenFOAM User Guide, 4.1) and no code of ours."""

import re

import numpy as np


def items(path):
    """What stands in the list of a file, as texts."""
    text = re.sub(r"FoamFile\s*\{.*?\}", "", path.read_text(), flags=re.DOTALL)
    count, body = re.match(r"\s*(\d+)\s*\(\n(.*)\n\)\s*$", text, re.DOTALL).groups()
    rows = body.split("\n")
    assert len(rows) == int(count), f"{path}: {len(rows)} items, not {count}"
    return rows


class PolyMesh:
    def __init__(self, case):
        folder = case / "constant" / "polyMesh"
        self.points = np.array([row.strip("()").split() for row in items(folder / "points")], dtype=float)
        # Four corners; of a triangle the last one is repeated.
        rows = [re.fullmatch(r"([34])\(([\d ]+)\)", row).groups() for row in items(folder / "faces")]
        corners = [words.split() for _, words in rows]
        assert [len(nodes) for nodes in corners] == [int(count) for count, _ in rows]
        self.faces = np.array([nodes + nodes[2:] if len(nodes) == 3 else nodes for nodes in corners], dtype=int)
        self.is_triangle = self.faces[:, 2] == self.faces[:, 3]
        self.owner = np.array(items(folder / "owner"), dtype=int)
        self.neighbour = np.array(items(folder / "neighbour"), dtype=int)
        self.cells = max(self.owner.max(), self.neighbour.max()) + 1
        self.patches = {}
        text = (folder / "boundary").read_text()
        for name, body in re.findall(r"^    (\w+)\n    \{\n(.*?)\n    \}$", text, re.MULTILINE | re.DOTALL):
            self.patches[name] = dict(re.findall(r"^ +(\w+) +(\S+?);$", body, re.MULTILINE))
        corners = self.points[self.faces]
        self.areas = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
        self.middles = np.where(self.is_triangle[:, None], corners[:, :3].mean(axis=1), corners.mean(axis=1))

    def of_patch(self, name):
        start = int(self.patches[name]["startFace"])
        return slice(start, start + int(self.patches[name]["nFaces"]))

    def sums(self, of_faces):
        """Over the faces of each cell, those of its neighbours' side with the other sign."""
        result = np.zeros((self.cells, *of_faces.shape[1:]))
        np.add.at(result, self.owner, of_faces)
        np.subtract.at(result, self.neighbour, of_faces[: len(self.neighbour)])
        return result

    def volumes(self):
        return self.sums((self.areas * self.middles).sum(axis=1)) / 3

    def faults(self, wedges=0):
        """What is wrong with it, in words. So many wedges are its last cells, the others are tetrahedra."""
        found = []
        inner = len(self.neighbour)
        if not (self.owner[:inner] < self.neighbour).all():
            found.append("an owner is not below its neighbour")
        order = list(zip(self.owner[:inner], self.neighbour))
        if order != sorted(order):
            found.append("the faces are not in upper triangular order")
        if np.abs(self.sums(self.areas)).max() > 1e-12 * np.abs(self.areas).max():
            found.append("a cell is open")
        if self.volumes().min() <= 0:
            found.append("a cell has no volume")
        if (
            np.bincount(np.concatenate([self.owner, self.neighbour])).tolist()
            != [4] * (self.cells - wedges) + [5] * wedges
        ):
            found.append("a cell has not as many faces as it should")
        if set(self.faces.ravel()) != set(range(len(self.points))):
            found.append("a point is in no face")
        end = inner
        for name, patch in self.patches.items():
            if int(patch["startFace"]) != end:
                found.append(f"patch {name} does not begin where the last one ends")
            end += int(patch["nFaces"])
            if patch["type"] == "cyclic":
                found += self._faults_of_pair(name, patch["neighbourPatch"])
        if end != len(self.faces):
            found.append("the patches are not all faces at the boundary")
        return found

    def _faults_of_pair(self, name, other):
        if self.patches[other].get("neighbourPatch") != name:
            return [f"{name} and {other} do not name each other"]
        here, there = self.of_patch(name), self.of_patch(other)
        if here.stop - here.start != there.stop - there.start:
            return [f"{name} and {other} differ in faces"]
        step = self.middles[there][0] - self.middles[here][0]
        near = 1e-12 * np.abs(self.points).max()
        if np.abs(self.middles[there] - self.middles[here] - step).max() > near:
            return [f"{name} and {other} are not in the same order"]
        # The first corners are opposite each other, the others run the other way round.
        moved = self.points[self.faces[here]] + step
        turned = np.where(
            self.is_triangle[there][:, None], self.faces[there][:, [0, 2, 1, 1]], self.faces[there][:, [0, 3, 2, 1]]
        )
        if np.abs(self.points[turned] - moved).max() > near:
            return [f"{name} and {other} do not begin at the same corners"]
        return []
