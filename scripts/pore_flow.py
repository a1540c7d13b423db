"""Creeping flow through the pore space of a unit cell, for scripts/permeability: -laplace(u) + grad(p) = f, div(u) = 0 (viscosity
and force 1), u = 0 on the yarns.

Taylor and Hood's tetrahedra: velocity by ten nodes, pressure by the four corners, the geometry by ten nodes, too, so that
yarns are curved (C. Taylor, P. Hood, Computers & Fluids 1 (1973) 73-100). MINRES solves the saddle point problem; its
preconditioner is the mass of the pressure, and for each direction of the velocity a cycle of two levels: Chebyshev's polynomial in
Jacobi's iteration about a factorization on the corners alone (H. Elman, D. Silvester, A. Wathen, Finite Elements and Fast
Iterative Solvers (2014), 4.2)."""

import numpy
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg

from cell_elements import EDGES, tetrahedron_shapes

RESIDUAL = 1e-8  # of the right side; the diagonal of the permeability errs by the square of what that leaves
MOST_STEPS = 5000
AT_ONCE = 20_000  # elements


class NotSolved(Exception):
    pass


def rule(points=3):
    """Places and weights in the unit tetrahedron, exact for polynomials of degree 2 points - 1 - 2: a product of Gauss's, folded."""
    x, w = numpy.polynomial.legendre.leggauss(points + 1)
    x, w = (x + 1) / 2, w / 2
    a, b, c = (axis.ravel() for axis in numpy.meshgrid(x, x, x, indexing="ij"))
    weights = (w[:, None, None] * w[None, :, None] * w[None, None, :]).ravel() * (1 - a) ** 2 * (1 - b)
    return numpy.stack([a, b * (1 - a), c * (1 - a) * (1 - b)], axis=1), weights


class PoreFlow:
    """The matrices of a mesh of ten nodes, its nodes numbered with their like on opposite faces."""

    def __init__(self, mesh):
        self.mesh = mesh
        elements = mesh.master[mesh.elements]
        used, numbers = numpy.unique(elements, return_inverse=True)
        self.rows = numbers.reshape(elements.shape)
        self.count = len(used)
        self.number = numpy.full(len(mesh.nodes), -1)
        self.number[used] = numpy.arange(self.count)
        self.number = self.number[mesh.master]
        corners, numbers = numpy.unique(self.rows[:, :4], return_inverse=True)
        self.pressure_rows = numbers.reshape(-1, 4)
        self.pressures = len(corners)
        self.corners = corners
        self._assemble()

    def _assemble(self):
        laplace, mass, divergence, load, self.volume = [], [], [], numpy.zeros(self.count), 0.0
        for first in range(0, len(self.rows), AT_ONCE):
            part = slice(first, first + AT_ONCE)
            places = self.mesh.nodes[self.mesh.elements[part]]
            count = len(places)
            a, m, b, f = (
                numpy.zeros((count, 10, 10)),
                numpy.zeros((count, 4, 4)),
                numpy.zeros((3, count, 4, 10)),
                numpy.zeros((count, 10)),
            )
            at, weights = rule()
            values, slopes = tetrahedron_shapes(at, 10)
            shares, _ = tetrahedron_shapes(at, 4)
            for k, weight in enumerate(weights):
                frame = numpy.einsum("ai,nac->nic", slopes[k], places)
                size = weight * numpy.linalg.det(frame)
                if (size <= 0).any():
                    raise NotSolved("an element of the mesh is turned inside out: another --size helps")
                slope = numpy.einsum("nci,ai->nac", numpy.linalg.inv(frame), slopes[k])
                a += numpy.einsum("nac,nbc,n->nab", slope, slope, size, optimize=True)
                m += shares[k][:, None] * shares[k][None, :] * size[:, None, None]
                for axis in range(3):
                    b[axis] -= shares[k][None, :, None] * slope[:, None, :, axis] * size[:, None, None]
                f += values[k] * size[:, None]
                self.volume += size.sum()
            rows, corners = self.rows[part], self.pressure_rows[part]
            laplace.append(self._matrix(a, rows, rows, self.count, self.count))
            mass.append(self._matrix(m, corners, corners, self.pressures, self.pressures))
            divergence.append([self._matrix(b[axis], corners, rows, self.pressures, self.count) for axis in range(3)])
            numpy.add.at(load, rows, f)
        self.laplace, self.mass = sum(laplace), sum(mass)
        self.divergence = [sum(parts[axis] for parts in divergence) for axis in range(3)]
        self.load = load

    @staticmethod
    def _matrix(blocks, rows, columns, height, width):
        i = numpy.repeat(rows, columns.shape[1], axis=1).ravel()
        j = numpy.tile(columns, (1, rows.shape[1])).ravel()
        return sparse.csr_matrix((blocks.ravel(), (i, j)), shape=(height, width))

    def _interpolation(self):
        """Values at all nodes from those at the corners."""
        number = numpy.full(self.count, -1)
        number[self.corners] = numpy.arange(self.pressures)
        middles = numpy.concatenate([self.rows[:, [4 + k, i, j]] for k, (i, j) in enumerate(EDGES)])
        _, first = numpy.unique(middles[:, 0], return_index=True)
        middles = middles[first]
        i = numpy.concatenate([self.corners, middles[:, 0], middles[:, 0]])
        j = number[numpy.concatenate([self.corners, middles[:, 1], middles[:, 2]])]
        values = numpy.concatenate([numpy.ones(self.pressures), numpy.full(2 * len(middles), 0.5)])
        return sparse.csr_matrix((values, (i, j)), shape=(self.count, self.pressures))

    def nodes_of(self, names):
        return (
            numpy.unique(numpy.concatenate([self.number[self.mesh.patches[name]] for name in names])) if names else []
        )

    def solve(self, axis, held):
        """The integral of the velocity over the pores when the force is 1 along `axis`, and how many steps it took. `held`: for
        each direction the patches on which the velocity along it is zero."""
        free = []
        for names in held:
            mask = numpy.ones(self.count, dtype=bool)
            mask[self.nodes_of(names)] = False
            free.append(numpy.flatnonzero(mask))
        ends = numpy.cumsum([0] + [len(one) for one in free])
        total = ends[3] + self.pressures
        laplace = [self.laplace[one][:, one] for one in free]
        divergence = sparse.hstack([self.divergence[k][:, free[k]] for k in range(3)], format="csr")
        system = sparse.bmat([[sparse.block_diag(laplace), divergence.T], [divergence, None]], format="csr")
        cycles = self._cycles(laplace, free)
        weight = 1 / self.mass.diagonal()

        def precondition(vector):
            parts = [cycles[k](vector[ends[k] : ends[k + 1]]) for k in range(3)]
            return numpy.concatenate([*parts, weight * vector[ends[3] :]])

        right = numpy.zeros(total)
        right[ends[axis] : ends[axis + 1]] = self.load[free[axis]]
        steps = [0]

        def count(_):
            steps[0] += 1

        solution, failed = linalg.minres(
            system,
            right,
            M=linalg.LinearOperator((total, total), precondition),
            tol=RESIDUAL,
            maxiter=MOST_STEPS,
            callback=count,
        )
        if failed:
            raise NotSolved(f"the flow is not found after {MOST_STEPS} steps")
        return numpy.array([self.load[free[k]] @ solution[ends[k] : ends[k + 1]] for k in range(3)]), steps[0]

    def _cycles(self, laplace, free):
        known, interpolation = {}, self._interpolation()
        for matrix, one in zip(laplace, free):
            key = one.tobytes()
            if key not in known:
                known[key] = two_levels(matrix, interpolation[one])
        return [known[one.tobytes()] for one in free]


def two_levels(matrix, interpolation, degree=3):
    """A symmetric approximate inverse of a Laplacian: smoothing, correction on the coarse level, smoothing."""
    used = numpy.flatnonzero(numpy.asarray(abs(interpolation).sum(axis=0)).ravel())
    interpolation = interpolation[:, used]
    coarse = (interpolation.T @ matrix @ interpolation).tocsc()
    factor = linalg.splu(coarse, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    weight = 1 / matrix.diagonal()
    largest = (
        1.1
        * linalg.eigsh(
            sparse.diags(weight**0.5) @ matrix @ sparse.diags(weight**0.5),
            k=1,
            which="LA",
            tol=1e-2,
            v0=numpy.ones(matrix.shape[0]),
            return_eigenvectors=False,
        )[0]
    )
    centre, half = largest * (1 + 0.1) / 2, largest * (1 - 0.1) / 2

    def smooth(right, start):
        """Chebyshev's iteration for eigenvalues from a tenth of the largest on."""
        solution, rho = start.copy(), half / centre
        step = weight * (right - matrix @ solution) / centre
        solution += step
        for _ in range(degree - 1):
            new = 1 / (2 * centre / half - rho)
            step = new * rho * step + 2 * new / half * weight * (right - matrix @ solution)
            solution += step
            rho = new
        return solution

    def cycle(right):
        solution = smooth(right, numpy.zeros_like(right))
        solution += interpolation @ factor.solve(interpolation.T @ (right - matrix @ solution))
        return smooth(right, solution)

    return cycle
