"""Cells whose regions share no nodes, read from their Abaqus deck and judged without the program: numpy and scipy only."""

import numpy as np
import scipy.sparse
import scipy.sparse.linalg

TETRAHEDRON_FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]  # S1 .. S4


class Deck:
    """Everything by its number in the file."""

    def __init__(self, path):
        self.nodes, self.solids, self.wedges = {}, {}, {}  # elements: number -> nodes
        self.regions, self.layers = {}, {}  # name -> numbers of solids, of wedges
        self.equations, self.sets, self.surfaces, self.ties = [], {}, {}, []
        self.materials, self.sections, self.layer_sections, self.axes = {}, [], [], {}
        self.cell, self.held = None, None
        keyword, options, material = "", {}, None
        for line in path.read_text().splitlines():
            if line.startswith("** Cell:"):
                self.cell = np.array([float(word) for word in line[8:].split()]).reshape(2, 3)
            if line.startswith("**") or not line.strip():
                continue
            words = [word.strip() for word in line.split(",")]
            if line.startswith("*"):
                keyword = words[0].upper()
                options = dict(word.split("=", 1) for word in words[1:] if "=" in word)
                if keyword == "*MATERIAL":
                    material = self.materials.setdefault(options["NAME"], {})
                if keyword == "*SOLID SECTION":
                    self.sections.append((options["ELSET"], options["MATERIAL"], "ORIENTATION" in options))
                if keyword == "*COHESIVE SECTION":
                    self.layer_sections.append((options["ELSET"], options["MATERIAL"]))
                continue
            self.take(keyword, options, words, material)
        self.terms()
        # Places by which nodes are compared.
        self.at = dict(zip(self.nodes, map(tuple, (np.round(list(self.nodes.values()), 9) + 0.0).tolist())))

    def take(self, keyword, options, words, material):
        if keyword == "*NODE":
            self.nodes[int(words[0])] = np.array([float(word) for word in words[1:4]])
        elif keyword == "*ELEMENT":
            number, *nodes = (int(word) for word in words)
            is_wedge = options["TYPE"] == "COH3D6"
            (self.wedges if is_wedge else self.solids)[number] = nodes
            (self.layers if is_wedge else self.regions).setdefault(options["ELSET"], []).append(number)
        elif keyword == "*NSET":
            own = self.sets.setdefault(options["NSET"], [])
            own += [int(word) for word in words if word.isdigit()]
        elif keyword == "*EQUATION":
            self.equations += [word for word in words if word]
        elif keyword == "*SURFACE":
            self.surfaces.setdefault(options["NAME"], []).append(tuple(words))
        elif keyword == "*TIE":
            self.ties.append(words)
        elif keyword in ("*ELASTIC", "*DAMAGE INITIATION", "*DAMAGE EVOLUTION"):
            key = "traction" if options.get("TYPE") == "TRACTION" else keyword[1:].lower()
            material.setdefault(key, []).extend(float(word) for word in words if word)
        elif keyword == "*DISTRIBUTION" and words[0]:
            self.axes[int(words[0])] = np.array([float(word) for word in words[1:7]])
        elif keyword == "*BOUNDARY" and words[0].isdigit() and self.held is None:
            self.held = int(words[0])

    def terms(self):
        """Equations as lists of (node, direction from 0, factor)."""
        words, self.equations = self.equations, []
        while words:
            count = int(words[0])
            rows = np.array(words[1 : 1 + 3 * count]).reshape(-1, 3)
            self.equations.append([(int(n), int(d) - 1, float(f)) for n, d, f in rows])
            words = words[1 + 3 * count :] if count else words[1:]

    def drivers(self):
        return [self.sets[name][0] for name in self.sets if "Driver" in name and name != "Drivers"]

    def region_of_nodes(self):
        """Region of each node; a node of two regions is an error."""
        of_node = {}
        for name, numbers in self.regions.items():
            for number in numbers:
                for node in self.solids[number]:
                    assert of_node.setdefault(node, name) == name, f"node {node} is one of {name} and {of_node[node]}"
        return of_node


def faces_of(deck, numbers):
    """Sorted nodes of every face of these solids -> (nodes, seen from outside counter-clockwise; the node opposite)."""
    found = {}
    for number in numbers:
        nodes = deck.solids[number]
        for k, face in enumerate(TETRAHEDRON_FACES):
            corners = tuple(nodes[i] for i in face)
            opposite = next(n for n in nodes[:4] if n not in corners)
            found.setdefault(tuple(sorted(corners)), []).append((corners, opposite, number, k))
    return found


def modes(point, cell, count):
    """What each driver displaces at a place: 3 x 6; of a plate strains xx, yy, xy and curvatures xx, yy, xy."""
    x, y, z = point - cell.mean(axis=0)
    if count == "block":
        return np.array([[x, 0, 0, y / 2, z / 2, 0], [0, y, 0, x / 2, 0, z / 2], [0, 0, z, 0, x / 2, y / 2]])
    return np.array(
        [
            [x, 0, y / 2, z * x, 0, z * y / 2],
            [0, y, x / 2, 0, z * y, z * x / 2],
            [0, 0, 0, -x * x / 2, -y * y / 2, -x * y / 2],
        ]
    )


# --- stiffness of the whole, put together here: C3D4 and COH3D6


PAIRS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]


def elasticity(values):
    if len(values) == 2:
        e, nu = values
        values = [e] * 3 + [nu] * 3 + [e / (2 * (1 + nu))] * 3
    e1, e2, e3, n12, n13, n23, g12, g13, g23 = values
    compliance = np.diag([1 / e1, 1 / e2, 1 / e3, 1 / g12, 1 / g13, 1 / g23])
    for (i, j), value in {(0, 1): -n12 / e1, (0, 2): -n13 / e1, (1, 2): -n23 / e2}.items():
        compliance[i, j] = compliance[j, i] = value
    c = np.zeros((3, 3, 3, 3))
    stiff = np.linalg.inv(compliance)
    for a, (i, j) in enumerate(PAIRS):
        for b, (k, l) in enumerate(PAIRS):
            c[i, j, k, l] = c[j, i, k, l] = c[i, j, l, k] = c[j, i, l, k] = stiff[a, b]
    return c


def solid_matrices(deck, numbers, material, is_oriented):
    p = np.array([[deck.nodes[n] for n in deck.solids[e][:4]] for e in numbers])
    edges = p[:, 1:] - p[:, :1]
    volume = np.linalg.det(edges) / 6
    assert volume.min() > 0
    inner = np.linalg.inv(edges).transpose(0, 2, 1)  # gradients of nodes 1..3
    slopes = np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1)
    c = np.broadcast_to(elasticity(material), (len(numbers), 3, 3, 3, 3))
    if is_oriented:
        axes = np.array([deck.axes[e] for e in numbers])
        first = axes[:, :3] / np.linalg.norm(axes[:, :3], axis=1)[:, None]
        third = np.cross(first, axes[:, 3:])
        third /= np.linalg.norm(third, axis=1)[:, None]
        r = np.stack([first, np.cross(third, first), third], axis=1)
        c = np.einsum("nai,nbj,nck,ndl,nabcd->nijkl", r, r, r, r, c, optimize=True)
    return np.einsum("naj,nijkl,nbl,n->naibk", slopes, c, slopes, volume, optimize=True).reshape(len(numbers), 12, 12)


def wedge_matrices(deck, numbers, across, along):
    """Integrated at the middles of the three edges, which is exact."""
    p = np.array([[deck.nodes[n] for n in deck.wedges[e]] for e in numbers])
    normal = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    area = np.linalg.norm(normal, axis=1) / 2
    normal /= 2 * area[:, None]
    result = np.zeros((len(numbers), 18, 18))
    traction = along * np.eye(3) + (across - along) * normal[:, :, None] * normal[:, None, :]
    for share in ([0.5, 0.5, 0], [0, 0.5, 0.5], [0.5, 0, 0.5]):
        jump = np.kron(np.concatenate([-np.array(share), share]), np.eye(3))  # 3 x 18: second side less first
        result += np.einsum("ia,nij,jb,n->nab", jump, traction, jump, area / 3, optimize=True)
    return result


class Solved:
    """Displacements of a deck's elements for each driver, and the stiffness of the whole: by factorization."""

    def __init__(self, deck):
        self.deck, drivers = deck, deck.drivers()
        count = max(deck.nodes) + 1
        rows, columns, values = [], [], []

        def add(numbers, elements, matrices):
            nodes = np.array([elements[e] for e in numbers])
            dof = (3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), -1)
            rows.append(np.repeat(dof, dof.shape[1], axis=1).ravel())
            columns.append(np.tile(dof, dof.shape[1]).ravel())
            values.append(matrices.ravel())

        for name, material, is_oriented in deck.sections:
            numbers = deck.regions[name]
            add(numbers, deck.solids, solid_matrices(deck, numbers, deck.materials[material]["elastic"], is_oriented))
        for name, material in deck.layer_sections:
            across, along, _ = deck.materials[material]["traction"]
            add(deck.layers[name], deck.wedges, wedge_matrices(deck, deck.layers[name], across, along))
        whole = scipy.sparse.coo_matrix(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(3 * count, 3 * count)
        ).tocsr()
        keep, given = self.conditions(count, drivers)
        free = (keep.T @ whole @ keep).tocsc()
        used = np.flatnonzero(np.abs(free.diagonal()) > 0)
        solved = np.zeros((free.shape[0], len(drivers)))
        right = -(keep.T @ (whole @ given))
        right = np.asarray(right.todense()) if scipy.sparse.issparse(right) else right
        solved[used] = scipy.sparse.linalg.splu(free[used][:, used]).solve(right[used])
        self.moved = keep @ solved + given  # 3 times the node's number, plus the direction; by driver
        self.stiffness = self.moved.T @ (whole @ self.moved)

    def conditions(self, count, drivers):
        """Of all displacements what the free ones make (sparse), and what each driver makes."""
        index = {node: k for k, node in enumerate(drivers)}
        target = np.arange(3 * count)
        given = np.zeros((3 * count, len(drivers)))
        for first, *others in self.deck.equations:
            row = 3 * first[0] + first[1]
            target[row] = -1
            for node, direction, factor in others:
                if node in index:
                    given[row, index[node]] = -factor / first[2]
                else:
                    assert factor == -first[2]
                    target[row] = 3 * node + direction
        if self.deck.held:
            for k in range(3):
                target[target == 3 * self.deck.held + k] = -1
        rows = np.flatnonzero(target >= 0)
        keep = scipy.sparse.coo_matrix((np.ones(len(rows)), (rows, target[rows])), shape=(3 * count, 3 * count)).tocsr()
        return keep, given
