"""The elements of a unit cell's deck, its conditions, and conjugate gradients over all load cases at once: for scripts/homogenize,
where a factorization would take too long."""

import numpy

try:
    from scipy import sparse
except ModuleNotFoundError:
    sparse = None

import cell_cohesive

EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]  # of which the fifth to the tenth node is the middle
CORNERS = numpy.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
BRICK = numpy.array([[x, y, z] for z in (-1.0, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
PAIRS = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
RESIDUAL = 1e-7  # of the right sides; the stiffness errs by the square of what that leaves
MOST_STEPS = 20_000
AT_ONCE = 5_000  # elements that are added to the matrix together
COARSE = 500  # places of the coarse grid; at least NODES nodes for each of them
NODES = 10


class NotSolved(Exception):
    pass


def tetrahedron_shapes(at, nodes):
    """Values and slopes of the four or ten shape functions at places of the unit tetrahedron (n x 3)."""
    shares = numpy.concatenate([1 - at.sum(axis=1, keepdims=True), at], axis=1)
    slope = numpy.vstack([-numpy.ones(3), numpy.eye(3)])
    if nodes == 4:
        return shares, numpy.broadcast_to(slope, (len(at), 4, 3))
    values = numpy.empty((len(at), 10))
    slopes = numpy.empty((len(at), 10, 3))
    for i in range(4):
        values[:, i] = shares[:, i] * (2 * shares[:, i] - 1)
        slopes[:, i] = (4 * shares[:, i, None] - 1) * slope[i]
    for k, (i, j) in enumerate(EDGES):
        values[:, 4 + k] = 4 * shares[:, i] * shares[:, j]
        slopes[:, 4 + k] = 4 * (shares[:, i, None] * slope[j] + shares[:, j, None] * slope[i])
    return values, slopes


def rule(nodes):
    """Slopes and weights at the points that CalculiX integrates C3D4, C3D10 and C3D8 by (and those of heat transfer)."""
    if nodes == 8:
        at = BRICK / 3**0.5
        factors = (1 + at[:, None, :] * BRICK) / 2
        slopes = numpy.stack(
            [BRICK[:, k] / 2 * numpy.delete(factors, k, axis=2).prod(axis=2) for k in range(3)], axis=2
        )
        return slopes, numpy.ones(8)
    near = (5 - 5**0.5) / 20
    at = numpy.full((1, 3), 0.25) if nodes == 4 else near + (1 - 4 * near) * CORNERS
    return tetrahedron_shapes(at, nodes)[1], numpy.full(len(at), 1 / (6 * len(at)))


def points(places):
    """At each point that elements (n x nodes x 3) are integrated by: slopes of the shape functions in space (n x nodes x 3),
    and the volume that belongs to it."""
    for slope, weight in zip(*rule(places.shape[1])):
        frame = numpy.einsum("ai,nac->nic", slope, places)
        yield numpy.einsum("nci,ai->nac", numpy.linalg.inv(frame), slope), weight * numpy.linalg.det(frame)


def frames(axes):
    """Axes 1, 2, 3 as rows (n x 3 x 3), of axis 1 and a second one across it (n x 6)."""
    first = axes[:, :3] / numpy.linalg.norm(axes[:, :3], axis=1)[:, None]
    second = axes[:, 3:] - first * (first * axes[:, 3:]).sum(axis=1)[:, None]
    second /= numpy.linalg.norm(second, axis=1)[:, None]
    return numpy.stack([first, second, numpy.cross(first, second)], axis=1)


def matrices(places, stiffness, expansion):
    """Stiffness of elements (n x 3 nodes x 3 nodes), and the forces of one degree: places n x nodes x 3."""
    count, nodes, _ = places.shape
    result = numpy.zeros((count, 3 * nodes, 3 * nodes))
    forces = numpy.zeros((count, 3 * nodes))
    stress = numpy.einsum("nij,nj->ni", stiffness, expansion)
    for slopes, size in points(places):
        b = numpy.zeros((count, 6, nodes, 3))
        for row, (i, j) in enumerate(PAIRS):
            b[:, row, :, i] += slopes[:, :, j]
            if i != j:
                b[:, row, :, j] += slopes[:, :, i]
        b = b.reshape(count, 6, 3 * nodes)
        turned = b.transpose(0, 2, 1)
        result += turned @ (stiffness @ b * size[:, None, None])
        forces += (turned @ stress[:, :, None])[:, :, 0] * size[:, None]
    return result, forces


class Conditions:
    """Which unknown each node's displacement or potential is (-1: none), and what the drivers add to it (nodes x directions x
    drivers)."""

    def __init__(self, deck, drivers):
        count = max(deck.nodes) + 1
        index = {node: k for k, node in enumerate(drivers.values())}
        master = numpy.arange(count)
        self.driven = numpy.zeros((count, deck.directions, len(drivers)))
        for first, *others in deck.equations:
            node, direction, factor = first
            free = [(n, d, f) for n, d, f in others if n not in index]
            if free and (len(free) > 1 or free[0][1] != direction or free[0][2] != -factor):
                raise NotSolved("an equation ties more than two nodes")
            master[node] = free[0][0] if free else -1
            for n, _, f in others:
                if n in index:
                    self.driven[node, direction, index[n]] = -f / factor
        for node, other in cell_cohesive.tied(deck).items():
            master[master == node] = master[other]
        for node in deck.held:
            master[master == int(master[int(node)])] = -1
        used = numpy.unique(numpy.concatenate([numpy.unique(rows) for rows in element_rows(deck)]))
        kept = numpy.unique(master[used])
        kept = kept[kept >= 0]
        number = numpy.full(count, -1)
        number[kept] = numpy.arange(len(kept))
        self.unknown = numpy.where(master >= 0, number[master], -1)
        self.count = len(kept)


def element_rows(deck):
    for name, _, _ in deck.sections:
        yield numpy.array([deck.elements[e] for e in deck.element_sets[name]])


class Cell:
    """All elements of a deck. Where SciPy is there, their matrices are put together, which makes a step cheaper, and a
    coarse grid saves most of the steps."""

    def __init__(self, deck, drivers, pieces):
        """`pieces`: of some elements at a time their numbers, matrices, and forces of one degree."""
        self.conditions = Conditions(deck, drivers)
        self.directions = deck.directions
        count = self.conditions.count
        self.rows = self.directions * (count + 1)
        by_size = {}
        for numbers, some, force in pieces:
            nodes = numpy.array([deck.nodes_of(e) for e in numbers])
            by_size.setdefault(nodes.shape[1], []).append((nodes, some, force))
        self.kinds = [Kind(*map(numpy.concatenate, zip(*of_size)), self.conditions) for of_size in by_size.values()]
        blocks = sum(kind.blocks() for kind in self.kinds)
        self.inverse = numpy.linalg.inv(blocks[:count])
        self.matrix = sum(kind.assembled() for kind in self.kinds) if sparse else None
        self.coarse = CoarseGrid(deck, self.conditions, self.matrix) if sparse and count >= 8 * NODES else None
        self.groups, self.of_groups = None, None
        if deck.wedges:
            self._group(deck, blocks)

    def _group(self, deck, blocks):
        """Nodes between which interfaces lie, as one each: these hardly part, and what moves them together would converge slowly
        where interfaces are stiff. (What an interface adds to a group is nothing.)"""
        count = self.conditions.count
        group = numpy.arange(count + 1)
        pairs = (
            self.conditions.unknown[numpy.array(list(deck.wedges.values()))]
            .reshape(-1, 2, 3)
            .transpose(0, 2, 1)
            .reshape(-1, 2)
        )
        pairs = pairs[(pairs >= 0).all(axis=1)]
        while (group[pairs[:, 0]] != group[pairs[:, 1]]).any():
            least = group[pairs].min(axis=1)
            for side in (0, 1):
                numpy.minimum.at(group, group[pairs[:, side]], least)
            group = group[group]
        solids = sum(kind.blocks() for kind in self.kinds if kind.nodes.shape[1] != 6)
        shared = numpy.zeros_like(blocks)
        numpy.add.at(shared, group, solids)
        used, self.groups = numpy.unique(group[:count], return_inverse=True)
        self.of_groups = numpy.linalg.inv(shared[used])

    def precondition(self, x):
        result = numpy.zeros_like(x)
        used = self.directions * len(self.inverse)
        nodes = x[:used].reshape(len(self.inverse), self.directions, -1)
        moved = self.inverse @ nodes
        if self.groups is not None:
            together = numpy.zeros((len(self.of_groups), *nodes.shape[1:]))
            numpy.add.at(together, self.groups, nodes)
            moved += (self.of_groups @ together)[self.groups]
        result[:used] = moved.reshape(used, -1)
        if self.coarse is not None:
            result += self.coarse(x)
        return result

    def forces(self, way):
        if self.matrix is not None:
            result = self.matrix @ way
            result[-self.directions :] = 0
            return result
        return sum(kind.gather(kind.matrices @ way[kind.unknown]) for kind in self.kinds)

    def solve(self, right):
        """Conjugate gradients, each case for itself."""
        x, rest = numpy.zeros_like(right), right.copy()
        z = self.precondition(rest)
        way, old = z.copy(), (rest * z).sum(axis=0)
        tiny = numpy.finfo(float).tiny
        wanted = RESIDUAL * numpy.sqrt((right**2).sum(axis=0))
        for _ in range(MOST_STEPS):
            if (numpy.sqrt((rest**2).sum(axis=0)) <= wanted).all():
                return x
            forces = self.forces(way)
            length = old / numpy.maximum((way * forces).sum(axis=0), tiny)
            x += length * way
            rest -= length * forces
            z = self.precondition(rest)
            new = (rest * z).sum(axis=0)
            way = z + new / numpy.maximum(old, tiny) * way
            old = new
        raise NotSolved(f"conjugate gradients came to no end in {MOST_STEPS} steps")

    def stiffness(self):
        """Work of each driver's displacements against every driver's forces, and against those of one degree with all
        drivers held: errs by the product of both errors only."""
        self.solved = self.solve(-sum(kind.gather(kind.given()) for kind in self.kinds))
        work = sum(kind.work(self.solved) for kind in self.kinds)
        return work[:, :-1], work[:, -1]

    def displacements(self):
        """Of every node, where each driver is 1 (nodes x directions x drivers); after `stiffness`."""
        unknown = numpy.where(self.conditions.unknown < 0, self.conditions.count, self.conditions.unknown)
        solved = self.solved.reshape(self.conditions.count + 1, self.directions, -1)
        return solved[unknown][:, :, :-1] + self.conditions.driven


class CoarseGrid:
    """What moves far parts of a cell against each other, by trilinear functions on a grid of it that goes round: the second level
    of an additive Schwarz method (B. Smith, P. Bjorstad, W. Gropp, Domain Decomposition (1996), 3). Any grid does; one that
    suits the cell badly only costs steps."""

    def __init__(self, deck, conditions, matrix):
        place = numpy.zeros((conditions.count, 3))
        for node, unknown in enumerate(conditions.unknown):
            if unknown >= 0:
                place[unknown] = deck.nodes[node]
        edges = deck.cell.edges
        lengths = numpy.linalg.norm(edges, axis=1)
        places = min(COARSE, conditions.count // NODES)
        counts = numpy.maximum(1, (lengths * (places / lengths.prod()) ** (1 / 3)).astype(int))
        hats = sparse.kron(self._hats(place @ numpy.linalg.inv(edges), counts), sparse.identity(deck.directions))
        self.hats = sparse.vstack([hats, sparse.csr_matrix((matrix.shape[0] - hats.shape[0], hats.shape[1]))]).tocsr()
        self.turned = self.hats.T.tocsr()
        coarse = (self.turned @ matrix @ self.hats).toarray()
        coarse += 1e-8 * coarse.diagonal().max() * numpy.eye(len(coarse))  # hats that no node tells apart
        self.inverse = numpy.linalg.inv(coarse)

    @staticmethod
    def _hats(at, counts):
        """Values of the grid's functions at places in parts of the edges, a row each."""
        low = numpy.floor(at * counts)
        rest, rows, columns, values = at * counts - low, [], [], []
        for corner in numpy.ndindex(2, 2, 2):
            index = (low.astype(int) + corner) % counts
            rows.append(numpy.arange(len(at)))
            columns.append((index[:, 0] * counts[1] + index[:, 1]) * counts[2] + index[:, 2])
            values.append(numpy.where(corner, rest, 1 - rest).prod(axis=1))
        values, *places = map(numpy.concatenate, (values, rows, columns))
        return sparse.csr_matrix((values, places), shape=(len(at), counts.prod()))

    def __call__(self, x):
        return self.hats @ (self.inverse @ (self.turned @ x))


class Kind:
    """Elements of one number of nodes: their nodes, matrices, and forces of one degree."""

    def __init__(self, nodes, matrices, heated, conditions):
        self.nodes, self.matrices, self.heated = nodes, matrices, heated
        directions = conditions.driven.shape[1]
        self.directions = directions
        self.at = conditions.unknown[nodes]
        self.at[self.at < 0] = conditions.count  # one more, which stays at zero
        self.unknown = (directions * self.at[:, :, None] + numpy.arange(directions)).reshape(len(nodes), -1)
        flat = self.unknown.ravel()
        self.order = numpy.argsort(flat, kind="stable")
        ordered = flat[self.order]
        self.starts = numpy.flatnonzero(numpy.r_[True, ordered[1:] != ordered[:-1]])
        self.rows = directions * (conditions.count + 1)
        self.places = ordered[self.starts]
        driven = conditions.driven[nodes]
        self.driven = driven.reshape(len(nodes), -1, driven.shape[3])

    def blocks(self):
        """What the matrices have at each node, of all elements."""
        blocks = numpy.zeros((self.rows // self.directions, self.directions, self.directions))
        for a in range(self.at.shape[1]):
            own = slice(self.directions * a, self.directions * (a + 1))
            numpy.add.at(blocks, self.at[:, a], self.matrices[:, own, own])
        return blocks

    def assembled(self):
        """The matrix of the unknowns (SciPy's)."""
        result, size = sparse.csr_matrix((self.rows, self.rows)), self.unknown.shape[1]
        for first in range(0, len(self.unknown), AT_ONCE):
            some = self.unknown[first : first + AT_ONCE]
            places = numpy.repeat(some, size, axis=1).ravel(), numpy.tile(some, (1, size)).ravel()
            result += sparse.csr_matrix((self.matrices[first : first + AT_ONCE].ravel(), places), shape=result.shape)
        return result

    def gather(self, rows):
        """Forces of elements (n x 3 nodes x cases) at the unknowns."""
        result = numpy.zeros((self.rows, rows.shape[2]))
        result[self.places] = numpy.add.reduceat(rows.reshape(-1, rows.shape[2])[self.order], self.starts, axis=0)
        result[-self.directions :] = 0
        return result

    def given(self):
        """Forces of each driver, and of one degree."""
        return numpy.concatenate([self.matrices @ self.driven, -self.heated[:, :, None]], axis=2)

    def work(self, solved):
        moved = solved[self.unknown]
        moved[:, :, :-1] += self.driven
        forces = self.matrices @ moved
        forces[:, :, -1] -= self.heated
        return numpy.einsum("nak,nal->kl", moved[:, :, :-1], forces, optimize=True)
