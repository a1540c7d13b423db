"""The deck of a unit cell as `selvage mesh` writes it, read for scripts/homogenize: nodes, elements with their materials,
conditions and steps. It may come from anyone: nothing beside it is read but the mesh that it includes."""

import math
import pathlib
import re

import numpy

import cell_cohesive
from cell_elements import EDGES, PAIRS, frames, matrices, tetrahedron_shapes


class BadDeck(Exception):
    """It cannot be used, for what the text says."""


class ForeignElement(Exception):
    """One that nothing is known of here."""


# What wrong words and numbers of a deck lead to while it is read and computed with.
WRONG_NUMBERS = (ValueError, LookupError, TypeError, ArithmeticError, numpy.linalg.LinAlgError)

LARGEST = 1 << 30  # bytes, with what it includes
LARGEST_SET = 100_000_000
MOST_INCLUDED = 8

# Without blanks, as CalculiX reads them. Others may open files or load libraries.
KEYWORDS = set(
    "HEADING NODE NSET ELEMENT ELSET MATERIAL ELASTIC EXPANSION DENSITY CONDUCTIVITY SPECIFICHEAT ORIENTATION DISTRIBUTION "
    "DISTRIBUTIONTABLE SOLIDSECTION COHESIVESECTION SURFACE TIE EQUATION BOUNDARY INITIALCONDITIONS AMPLITUDE TRANSFORM "
    "DAMAGEINITIATION DAMAGEEVOLUTION STEP ENDSTEP STATIC HEATTRANSFER TEMPERATURE NODEFILE ELFILE NODEPRINT ELPRINT OUTPUT "
    "NODEOUTPUT ELEMENTOUTPUT ENERGYOUTPUT".split()
)


def reason(failure):
    return f"{failure} is missing" if isinstance(failure, KeyError) else str(failure)


def grow(names, others):
    """Sets of sets may double with every line."""
    if len(names) + len(others) > LARGEST_SET:
        raise ValueError(f"a set of more than {LARGEST_SET} numbers")
    names.extend(others)


def finite(word):
    value = float(word)
    if not math.isfinite(value):
        raise ValueError(f"{word} is no number")
    return value


def check_keyword(line, place):
    """CalculiX passes over blanks and the case of letters."""
    words = "".join(line.split()).upper().split(",")
    if not words[0].startswith("*") or words[0].startswith("**"):
        return
    if words[0][1:] not in KEYWORDS:
        raise BadDeck(f"{place}: {words[0][:40]} is no keyword of a deck of a unit cell")
    for word in words[1:]:
        name, _, value = word.partition("=")
        if name in ("INPUT", "FILE") or value.startswith("@"):
            raise BadDeck(f"{place}: {word[:40]} names another file")


class Parallelepiped:
    """A unit cell: a corner and three edges, of which the last is along z."""

    def __init__(self, corner, edges):
        self.edges, self.volume = edges, numpy.linalg.det(edges)
        self.low, self.high = corner[2], corner[2] + edges[2, 2]
        self.height, self.middle = self.high - self.low, (self.low + self.high) / 2
        self.center = corner + edges.sum(axis=0) / 2


def cell_of(rows):
    """Of two opposite corners, or of a corner and three edges."""
    return Parallelepiped(rows[0], numpy.diag(rows[1] - rows[0]) if len(rows) == 2 else rows[1:])


class Deck:
    """What of a deck of ours is needed: nodes, elements, materials, conditions, steps. Raises ForeignElement, BadDeck."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.places, self.included, self.bytes = [], set(), 0
        self.lines = self._with_included(self.path)
        self.nodes, self.sets, self.elements, self.element_sets = {}, {}, {}, {}
        self.equations, self.materials, self.sections = [], {}, []
        self.axes, self.steps, self.held = {}, [], []
        self.wedges, self.layers, self.surfaces, self.ties = {}, [], {}, []  # of interfaces: see cell_cohesive
        self.cell, self.physics = None, None
        self.first_step = len(self.lines)
        self._read()

    def _with_included(self, path):
        """The lines of a deck, with those of the mesh that it includes (--split-deck), which stands beside it."""
        lines = []
        try:
            if not path.is_file():
                raise BadDeck(f"{path}: no regular file")
            self.bytes += path.stat().st_size
            if self.bytes > LARGEST:
                raise BadDeck(f"{self.path}: more than {LARGEST} bytes, with what it includes")
            text = path.read_text()
        except OSError as failure:
            raise BadDeck(f"{path}: cannot be read: {failure.strerror}") from failure
        except UnicodeDecodeError as failure:
            raise BadDeck(f"{path}: no text: byte {failure.start} is not UTF-8") from failure
        self.included.add(path.resolve())
        for number, line in enumerate(text.splitlines(), 1):
            place = f"{path}:{number}"
            found = re.fullmatch(r"\s*\*INCLUDE\s*,\s*INPUT\s*=\s*(.*\S)\s*", line, re.IGNORECASE)
            if found:
                lines += self._with_included(self._beside(found[1], place))
                continue
            check_keyword(line, place)
            lines.append(line)
            self.places.append(place)
        return lines

    def _beside(self, name, place):
        """The path of a file that is included: in the deck's folder, links followed, and once."""
        path = self.path.parent / name
        try:
            target, folder = path.resolve(), self.path.parent.resolve()
        except (OSError, RuntimeError, ValueError) as failure:  # loops of links, zero bytes
            raise BadDeck(f"{place}: no such file") from failure
        if folder not in target.parents:
            raise BadDeck(f"{place}: the file that it includes is not in the folder of the deck: put it there")
        if target in self.included or len(self.included) > MOST_INCLUDED:
            raise BadDeck(f"{place}: the file that it includes is included already, or the last of more than {MOST_INCLUDED}")
        return path

    def _blocks(self):
        """Keyword, parameters, data lines, line number, last comment before the keyword."""
        keyword, options, data, start, comment, last = None, {}, [], 0, "", ""
        for number, line in enumerate(self.lines):
            if line.startswith("**"):
                last = line[2:].strip()
                found = re.fullmatch(r"Cell: (.*)", last)
                if found:
                    self.cell = cell_of(numpy.array([finite(v) for v in found[1].split()]).reshape(-1, 3))
                found = re.fullmatch(r"Physics: (\w+)", last)
                if found:
                    self.physics = found[1]
                found = re.fullmatch(r"Strength: (\w+) (.*)", last)
                if found:  # of the material that it stands in
                    options["STRENGTH"] = (found[1], [finite(v) for v in found[2].split()])
                continue
            if line.startswith("*"):
                if keyword:
                    yield keyword, options, data, start, comment
                words = [word.strip() for word in line[1:].split(",")]
                keyword, data, start, comment = words[0].upper(), [], number, last
                options = {k.strip().upper(): v.strip() for k, _, v in (word.partition("=") for word in words[1:])}
            elif line.strip():
                data.append(line)
        if keyword:
            yield keyword, options, data, start, comment

    def _read(self):
        self.material, self.step = None, None
        block = ("HEADING", None, None, 0, None)
        try:
            for block in self._blocks():
                self._take(*block)
        except WRONG_NUMBERS as failure:
            place = self.places[block[3]] if self.places else self.path
            raise BadDeck(f"{place}: *{block[0][:40]}, or what follows it, cannot be read: {reason(failure)}") from failure

    def _take(self, keyword, options, data, start, comment):
        rows = [[word.strip() for word in line.split(",")] for line in data]
        if keyword == "NODE":
            numbers = [int(row[0]) for row in rows]
            self.nodes.update((int(row[0]), tuple(finite(word) for word in (row[1:4] + 3 * ["0"])[:3])) for row in rows)
            if "NSET" in options:
                self.sets.setdefault(options["NSET"], []).extend(numbers)
        elif keyword == "NSET":
            words = [word for row in rows for word in row if word]
            names = self.sets.setdefault(options["NSET"], [])
            for word in words:
                grow(names, [int(word)] if word.isdigit() else self.sets.get(word, []))
        elif keyword == "ELEMENT":
            self._add_elements(options, rows)
        elif keyword == "ELSET":
            names = self.element_sets.setdefault(options["ELSET"], [])
            for word in (word for row in rows for word in row if word):
                grow(names, [int(word)] if word.isdigit() else self.element_sets.get(word, []))
        elif keyword == "EQUATION":
            self._add_equations(rows)
        elif keyword == "MATERIAL":
            self.material = self.materials.setdefault(options["NAME"], {})
            if "STRENGTH" in options:
                self.material["strength"] = options["STRENGTH"]
        elif keyword == "ELASTIC":
            values = [finite(word) for row in rows for word in row if word]
            if options.get("TYPE") == "TRACTION":
                self.material["traction"] = values
            else:
                self.material["stiffness"] = stiffness_of(values)
        elif keyword == "EXPANSION":
            values = [finite(word) for row in rows for word in row if word]
            self.material["expansion"] = values if len(values) > 1 else values * 3
        elif keyword == "CONDUCTIVITY":
            values = [finite(word) for word in rows[0] if word]
            self.material["conductivity"] = values if len(values) > 1 else values * 3
        elif keyword == "SOLID SECTION":
            self.sections.append((options["ELSET"], options["MATERIAL"], "ORIENTATION" in options))
        elif keyword == "COHESIVE SECTION":
            self.layers.append((options["ELSET"], options["MATERIAL"]))
        elif keyword == "SURFACE":
            self.surfaces[options["NAME"]] = (options.get("TYPE"), rows)
        elif keyword == "TIE":
            self.ties.append(rows[0])
        elif keyword == "DISTRIBUTION":
            for row in rows:
                if row[0]:
                    self.axes[int(row[0])] = [finite(v) for v in row[1:7]]
        elif keyword == "STEP":
            self.first_step = min(self.first_step, start)
            self.step = {"name": comment, "drivers": {}, "temperature": 0.0}
            self.steps.append(self.step)
        elif keyword == "BOUNDARY" and self.step is not None:
            for row in rows:
                if len(row) > 3 and row[3]:
                    self.step["drivers"][row[0]] = finite(row[3])
                elif row[0].isdigit() and row[0] not in self.held:
                    self._hold(row)
        elif keyword == "TEMPERATURE" and self.step is not None:
            self.step["temperature"] = finite(rows[0][1])

    def _hold(self, row):
        """A node all of whose unknowns are zero. (Others only keep a beam from turning, which no force does.)"""
        if self.physics or int(row[2]) - int(row[1]) == 2:
            self.held.append(row[0])

    def _add_elements(self, options, rows):
        names = self.element_sets.setdefault(options.get("ELSET", "All"), [])
        count = {"C3D4": 4, "C3D10": 10, "C3D8": 8, "COH3D6": 6}.get(options["TYPE"].upper().removeprefix("D"))
        if count is None:
            raise ForeignElement(f"elements of type {options['TYPE']}")
        elements = self.wedges if count == 6 else self.elements
        words = [int(word) for row in rows for word in row if word]
        if len(words) % (count + 1) != 0:
            raise ValueError(f"an element of {count} nodes has other than {count} numbers")
        for k in range(0, len(words), count + 1):
            elements[words[k]] = words[k + 1 : k + 1 + count]
            names.append(words[k])

    @property
    def directions(self):
        """How many unknowns a node has: displacements, or a potential."""
        return 1 if self.physics else 3

    def _add_equations(self, rows):
        """Lists of node, direction (from 0) and factor."""
        first = 11 if self.physics else 1  # degree of freedom
        words = [word for row in rows for word in row if word]
        k = 0
        while k < len(words):
            count = int(words[k])
            if not 0 < count <= (len(words) - k) // 3:
                raise ValueError(f"an equation of {count} terms")
            terms = words[k + 1 : k + 1 + 3 * count]
            self.equations.append(
                [(int(terms[3 * i]), int(terms[3 * i + 1]) - first, finite(terms[3 * i + 2])) for i in range(count)]
            )
            k += 1 + 3 * count

    def drivers(self):
        names = [name for name in self.sets if re.fullmatch(r"(Constraints|Curvature|Beam|Gradient)Driver\d", name)]
        return {name: self.sets[name][0] for name in names}

    def parts(self, chunk=20_000):
        """Of all elements, some at a time: their numbers, places of their nodes, stiffness matrices and expansion (engineering
        strains a degree) in space, order xx yy zz xy xz yz."""
        for name, material, oriented in self.sections:
            local = self.materials[material]["stiffness"]
            expands = numpy.array([*self.materials[material].get("expansion", (0, 0, 0)), 0, 0, 0])
            numbers = self.element_sets[name]
            for k in range(0, len(numbers), chunk):
                part = numbers[k : k + chunk]
                stiffness = numpy.broadcast_to(local, (len(part), 6, 6))
                expansion = numpy.broadcast_to(expands, (len(part), 6))
                if oriented:
                    turn = turned(numpy.array([self.axes[e] for e in part]))
                    stiffness = numpy.einsum("nai,ab,nbj->nij", turn, local, turn, optimize=True)
                    # Stresses turn by the transposed matrix, and strains of the material into space as work asks for.
                    expansion = numpy.linalg.solve(turn, expansion[:, :, None])[:, :, 0]
                yield part, numpy.array([[self.nodes[n] for n in self.elements[e]] for e in part]), stiffness, expansion

    @property
    def is_periodic(self):
        """Are nodes tied to opposite ones? (Those of a cell without that follow the drivers alone.)"""
        drivers = self.drivers().values()
        return any(node not in drivers for _, *others in self.equations for node, _, _ in others)

    def matrices(self):
        """Of all elements, some at a time: their numbers, stiffness matrices, and the forces of one degree."""
        for part, places, stiffness, expansion in self.parts():
            yield part, *matrices(places, stiffness, expansion)
        yield from cell_cohesive.matrices(self)

    def nodes_of(self, element):
        return self.wedges.get(element) or self.elements[element]

    def pieces(self):
        """Of all elements, some at a time: section, volumes, first and second moments of their heights about the middle
        of the cell, stiffness matrices in space (order xx yy zz xy xz yz)."""
        middle = self.cell.middle
        name_of = {e: name for name, _, _ in self.sections for e in self.element_sets[name]}
        for part, p, stiffness, _ in self.parts():
            p[:, :, 2] -= middle
            moments = moments_of_boxes(p) if p.shape[1] == 8 else moments_of_tetrahedra(p)
            yield name_of[part[0]], *moments, stiffness


def moments_of_boxes(p):
    """Volumes and the integrals of z and z^2 of parallelepipeds with level floors (n x 8 x 3 nodes)."""
    z = p[:, :, 2]
    volume = numpy.linalg.det(p[:, [1, 3, 4]] - p[:, :1])
    return volume, volume * z.mean(axis=1), volume * (z.mean(axis=1) ** 2 + (z[:, 6] - z[:, 0]) ** 2 / 12)


def moments_of_tetrahedra(p):
    """The same of tetrahedra of four or ten nodes (n x 4 or 10 x 3); curved ones by quadrature."""
    z = p[:, :4, 2]
    volume = numpy.einsum("ni,ni->n", numpy.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), p[:, 3] - p[:, 0]) / 6
    moments = [volume, volume * z.mean(axis=1), volume * ((z**2).sum(axis=1) + z.sum(axis=1) ** 2) / 20]
    if p.shape[1] == 4:
        return moments
    chords = numpy.stack([(p[:, a] + p[:, b]) / 2 for a, b in EDGES], axis=1)
    size = numpy.abs(p[:, 1:4] - p[:, :1]).max(axis=(1, 2))
    curved = numpy.flatnonzero(numpy.abs(p[:, 4:] - chords).max(axis=(1, 2)) > 1e-9 * size)
    values, slopes, weights = tetrahedron_rule()
    for rows in numpy.array_split(curved, len(curved) // 5000 + 1):
        frames = numpy.einsum("qai,nac->nqic", slopes, p[rows])
        parts = weights * numpy.linalg.det(frames)
        height = numpy.einsum("qa,na->nq", values, p[rows][:, :, 2])
        for power in range(3):
            moments[power][rows] = (parts * height**power).sum(axis=1)
    return moments


def tetrahedron_rule(count=5):
    """Values and slopes of the ten shape functions at the points of a rule for tetrahedra, and its weights: Gauss's of a
    cube that is drawn together to a tetrahedron, exact to degree 2 count - 3."""
    at, weight = numpy.polynomial.legendre.leggauss(count)
    at, weight = (at + 1) / 2, weight / 2
    a, b, c = (grid.ravel() for grid in numpy.meshgrid(at, at, at, indexing="ij"))
    weights = numpy.einsum("i,j,k->ijk", weight, weight, weight).ravel() * (1 - a) ** 2 * (1 - b)
    at = numpy.stack([a, b * (1 - a), c * (1 - a) * (1 - b)], axis=1)
    return *tetrahedron_shapes(at, 10), weights


def stiffness_of(values):
    """6 x 6 in the material's axes from E, nu or nine engineering constants."""
    if len(values) == 2:
        e, nu = values
        values = [e] * 3 + [nu] * 3 + [e / (2 * (1 + nu))] * 3
    e1, e2, e3, nu12, nu13, nu23, g12, g13, g23 = values[:9]
    s = numpy.zeros((6, 6))
    s[:3, :3] = [
        [1 / e1, -nu12 / e1, -nu13 / e1],
        [-nu12 / e1, 1 / e2, -nu23 / e2],
        [-nu13 / e1, -nu23 / e2, 1 / e3],
    ]
    s[3, 3], s[4, 4], s[5, 5] = 1 / g12, 1 / g13, 1 / g23
    return numpy.linalg.inv(s)


def turned(axes):
    """What makes strains along axes from those in space (n x 6 x 6, engineering): rows of axis 1 and of a second one across it."""
    r = frames(axes)
    strain = numpy.zeros((len(axes), 6, 6))  
    for a, (i, j) in enumerate(PAIRS):
        for b, (k, l) in enumerate(PAIRS):
            value = r[:, i, k] * r[:, j, l] + (r[:, i, l] * r[:, j, k] if k != l else 0)
            strain[:, a, b] = value * (1 if i == j else 2) * (1 if k == l else 0.5)
    return strain
