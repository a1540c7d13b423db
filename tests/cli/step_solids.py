"""Areas, volumes and centres of the solids of a STEP file, from its entities by Gauss's rule and the divergence theorem: all with
numpy and nothing of the program. Faces are B-splines over all of their parameters, or planes inside their edges."""

import numpy as np

from part21 import Wrong

NODES = 10


class Sums:
    """Area, and of the volume: itself, and its first moments."""

    def __init__(self, area=0.0, volume=0.0, first=np.zeros(3), is_closed=True):
        self.area, self.volume, self.first, self.is_closed = area, volume, np.array(first, float), is_closed

    def add(self, other, rotation=np.eye(3), offset=np.zeros(3)):
        self.area += other.area
        self.volume += other.volume
        self.first = self.first + rotation @ other.first + other.volume * offset
        self.is_closed = self.is_closed and other.is_closed

    @property
    def centre(self):
        return self.first / self.volume


def basis(knots, degree, ts):
    """Values of all basis functions: rows of ts, by the recursion of Cox and de Boor, inside the spans."""
    columns = ((knots[:-1] <= ts[:, None]) & (ts[:, None] < knots[1:])).astype(float)
    for p in range(1, degree + 1):
        raised = np.zeros((len(ts), len(knots) - 1 - p))
        for i in range(raised.shape[1]):
            left, right = knots[i + p] - knots[i], knots[i + p + 1] - knots[i + 1]
            if left > 0:
                raised[:, i] += (ts - knots[i]) / left * columns[:, i]
            if right > 0:
                raised[:, i] += (knots[i + p + 1] - ts) / right * columns[:, i + 1]
        columns = raised
    return columns


def slopes(knots, degree, ts):
    lower = basis(knots, degree - 1, ts)
    result = np.zeros((len(ts), lower.shape[1] - 1))
    for i in range(result.shape[1]):
        left, right = knots[i + degree] - knots[i], knots[i + degree + 1] - knots[i + 1]
        if left > 0:
            result[:, i] += degree / left * lower[:, i]
        if right > 0:
            result[:, i] -= degree / right * lower[:, i + 1]
    return result


def nodes(knots, parts=1):
    """Places and weights of Gauss's rule on every one of the equal parts of every span."""
    places, weights = np.polynomial.legendre.leggauss(NODES)
    breaks = np.unique(knots)
    ends = np.concatenate([a + (b - a) * np.arange(parts) / parts for a, b in zip(breaks, breaks[1:])] + [breaks[-1:]])
    half = np.diff(ends) / 2
    return ((ends[:-1] + half)[:, None] + half[:, None] * places).ravel(), (half[:, None] * weights).ravel()


def full(multiplicities, values, degree, count):
    if any(b <= a for a, b in zip(values, values[1:])) or len(values) != len(multiplicities):
        raise Wrong(f"knots {values}")
    knots = np.repeat(values, multiplicities)
    if len(knots) != count + degree + 1 or multiplicities[0] != degree + 1 or multiplicities[-1] != degree + 1:
        raise Wrong(f"{len(knots)} knots of {count} points of degree {degree}")
    return knots


class Shapes:
    def __init__(self, file):
        self.file = file

    def point(self, ref):
        return np.array(self.file.one(ref, "CARTESIAN_POINT")[1])

    def curve(self, ref):
        """Points at nodes, weighted derivatives there, both ends."""
        parts = self.file.entities[ref]
        if len(parts) == 1:
            _, degree, points, _, _, _, multiplicities, values, _ = parts["B_SPLINE_CURVE_WITH_KNOTS"]
            weights = np.ones(len(points))
        else:
            degree, points, *_ = parts["B_SPLINE_CURVE"]
            multiplicities, values, _ = parts["B_SPLINE_CURVE_WITH_KNOTS"]
            weights = np.array(parts["RATIONAL_B_SPLINE_CURVE"][0])
        knots = full(multiplicities, values, degree, len(points))
        polygon = np.array([self.point(p) for p in points])
        net = np.column_stack([weights[:, None] * polygon, weights])
        ts, rule = nodes(knots)
        h, dh = basis(knots, degree, ts) @ net, slopes(knots, degree, ts) @ net
        p = h[:, :3] / h[:, 3:]
        return p, (dh[:, :3] - dh[:, 3:] * p) / h[:, 3:] * rule[:, None], polygon[0], polygon[-1]

    def spline_face(self, parts):
        if len(parts) == 1:
            _, degree_u, degree_v, rows, _, _, _, _, many_u, many_v, values_u, values_v, _ = parts[
                "B_SPLINE_SURFACE_WITH_KNOTS"
            ]
            weights = np.ones((len(rows), len(rows[0])))
        else:
            degree_u, degree_v, rows, *_ = parts["B_SPLINE_SURFACE"]
            many_u, many_v, values_u, values_v, _ = parts["B_SPLINE_SURFACE_WITH_KNOTS"]
            weights = np.array(parts["RATIONAL_B_SPLINE_SURFACE"][0])
        u = full(many_u, values_u, degree_u, len(rows))
        v = full(many_v, values_v, degree_v, len(rows[0]))
        net = np.array([[self.point(p) for p in row] for row in rows])
        net = np.concatenate([weights[..., None] * net, weights[..., None]], axis=2)
        breaks_u, breaks_v = np.unique(u), np.unique(v)

        def over(ends_u, ends_v, finer):
            """Sums, area vector and the areas of all spans between these ends, each in finer x finer parts."""
            us, rule_u = nodes(ends_u, finer)
            vs, rule_v = nodes(ends_v, finer)
            bu, bv = basis(u, degree_u, us), basis(v, degree_v, vs)
            at = lambda of_u, of_v: np.einsum("ai,ijk,bj->abk", of_u, net, of_v, optimize=True)
            h, hu, hv = at(bu, bv), at(slopes(u, degree_u, us), bv), at(bu, slopes(v, degree_v, vs))
            p, dw = h[..., :3] / h[..., 3:], h[..., 3:]
            normals = np.cross((hu[..., :3] - hu[..., 3:] * p) / dw, (hv[..., :3] - hv[..., 3:] * p) / dw)
            normals *= (rule_u[:, None] * rule_v)[..., None]
            flux = np.einsum("abk,abk->ab", p, normals)
            areas = np.linalg.norm(normals, axis=2)
            spans = areas.reshape(len(ends_u) - 1, NODES * finer, len(ends_v) - 1, NODES * finer).sum((1, 3))
            return Sums(areas.sum(), flux.sum() / 3, np.einsum("ab,abk->k", flux, p) / 4), normals.sum((0, 1)), spans

        coarse = over(breaks_u, breaks_v, 1)[2]
        sums, vector, areas = over(breaks_u, breaks_v, 2)
        # Where a surface has a crease inside a span, its area converges slowly: parts of that span are halved until it stands.
        enough = 1e-11 * sums.area
        for i, j in np.argwhere(np.abs(areas - coarse) > enough):
            area, finer, change = areas[i, j], 2, np.inf
            while change > enough:
                finer *= 2
                if finer > 64:
                    raise Wrong("the area of a face does not converge")
                before, area = area, over(breaks_u[i : i + 2], breaks_v[j : j + 2], finer)[0].area
                change = abs(area - before)
            areas[i, j] = area
        sums.area = areas.sum()
        return sums, vector

    def plane_face(self, plane, loop):
        """A fan from a point of the plane to the outline; positive where that runs counter-clockwise."""
        _, origin, axis, _ = self.file.one(plane, "AXIS2_PLACEMENT_3D")
        origin, normal = self.point(origin), np.array(self.file.one(axis, "DIRECTION")[1])
        area, middle, vector = 0.0, np.zeros(3), np.zeros(3)
        for edge, is_forward in loop:
            p, dp, *_ = self.curve(self.file.one(edge, "EDGE_CURVE")[3])
            if np.abs((p - origin) @ normal).max() > 1e-7:
                raise Wrong(f"#{edge} is not in its plane")
            crosses = (1 if is_forward else -1) * np.cross(p - origin, dp) / 2
            vector += crosses.sum(0)
            area += (crosses @ normal).sum()
            middle += ((crosses @ normal)[:, None] * (origin + (p - origin) * 2 / 3)).sum(0)
        if area <= 0:
            raise Wrong("the outline of a plane face runs clockwise")
        height = origin @ normal
        return Sums(area, height * area / 3, height * middle / 4), vector

    def shell(self, ref, uses):
        total, vector = Sums(), np.zeros(3)
        for face in self.file.one(ref, "CLOSED_SHELL", "OPEN_SHELL")[1]:
            _, bounds, surface, sense = self.file.one(face, "ADVANCED_FACE")
            loop = []
            for bound in bounds:
                _, edges, along = self.file.one(bound, "FACE_OUTER_BOUND")
                for oriented in self.file.one(edges, "EDGE_LOOP")[1]:
                    _, _, _, edge, forward = self.file.one(oriented, "ORIENTED_EDGE")
                    loop.append((int(edge), (forward == ".T.") == (along == ".T.")))
            ends = []
            for edge, is_forward in loop:
                _, first, last, curve, same = self.file.one(edge, "EDGE_CURVE")
                _, _, start, end = self.curve(curve)
                gaps = [
                    np.linalg.norm(self.point(self.file.one(vertex, "VERTEX_POINT")[1]) - at)
                    for vertex, at in ((first, start), (last, end))
                ]
                if same != ".T." or max(gaps) > 1e-13 * np.abs(start).max():
                    raise Wrong(f"#{edge}: its vertices are not its ends, by {max(gaps)}")
                ends.append((first, last) if is_forward else (last, first))
            if self.file.one(bounds[0], "FACE_OUTER_BOUND")[2] == ".F.":  # run backwards
                loop, ends = loop[::-1], ends[::-1]
            if any(end != start for (_, end), (start, _) in zip(ends, ends[1:] + ends[:1])):
                raise Wrong(f"#{face}: its edges are no loop")
            for edge, is_forward in loop:
                uses.setdefault(edge, []).append(is_forward)
            turned = -1 if sense == ".F." else 1
            parts = self.file.entities[surface]
            sums, normal = self.plane_face(parts["PLANE"][1], loop) if "PLANE" in parts else self.spline_face(parts)
            total.add(Sums(sums.area, turned * sums.volume, turned * sums.first))
            vector += turned * normal
        return total, vector

    def of(self, ref):
        """What a MANIFOLD_SOLID_BREP or SHELL_BASED_SURFACE_MODEL measures."""
        parts, uses = self.file.entities[ref], {}
        if "MANIFOLD_SOLID_BREP" not in parts:
            total = Sums(is_closed=False)
            for shell in parts["SHELL_BASED_SURFACE_MODEL"][1]:
                total.area += self.shell(shell, uses)[0].area
            return total
        total, vector = self.shell(parts["MANIFOLD_SOLID_BREP"][1], uses)
        if np.linalg.norm(vector) > 1e-6 * total.area:
            raise Wrong(f"#{ref}: its faces do not close it")
        if any(sorted(use) != [False, True] for use in uses.values()):
            raise Wrong(f"#{ref}: an edge is not used once in each direction: {uses}")
        return total


class Products:
    """The parts and assemblies of a file: what is said of them, and what they measure."""

    def __init__(self, file):
        self.file, self.shapes = file, Shapes(file)
        self.of_shape, self.representation, self.components, self.said = {}, {}, {}, {}
        self.measured = {}
        for number in file.all("PRODUCT_DEFINITION_SHAPE"):
            self.of_shape[number] = file.one(number, "PRODUCT_DEFINITION_SHAPE")[2]
        for number in file.all("SHAPE_DEFINITION_REPRESENTATION"):
            shape, representation = file.one(number, "SHAPE_DEFINITION_REPRESENTATION")
            self.representation[self.of_shape[shape]] = representation
        for number in file.all("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"):
            relation, shape = file.one(number, "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION")
            _, _, _, whole, part, _ = file.one(self.of_shape[shape], "NEXT_ASSEMBLY_USAGE_OCCURRENCE")
            _, _, child, parent = file.one(relation, "REPRESENTATION_RELATIONSHIP")
            if (self.representation[part], self.representation[whole]) != (child, parent):
                raise Wrong(f"#{number}: its representations are not those of its products")
            motion = file.one(relation, "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION")[0]
            self.components.setdefault(whole, []).append((part, self.motion(motion)))
        for number in file.all("PROPERTY_DEFINITION_REPRESENTATION"):
            definition, representation = file.one(number, "PROPERTY_DEFINITION_REPRESENTATION")
            kind, _, target = file.one(definition, "PROPERTY_DEFINITION")
            for item in file.one(representation, "REPRESENTATION")[1]:
                parts = file.entities[item]
                ((name, *values),) = parts.values()
                self.said.setdefault(self.of_shape.get(target, target), {})[kind, name] = values[0]

    def motion(self, ref):
        _, _, first, second = self.file.one(ref, "ITEM_DEFINED_TRANSFORMATION")
        places = []
        for place in (first, second):
            _, origin, z, x = self.file.one(place, "AXIS2_PLACEMENT_3D")
            z, x = (np.array(self.file.one(d, "DIRECTION")[1]) for d in (z, x))
            places.append((np.column_stack([x, np.cross(z, x), z]), self.shapes.point(origin)))
        (from_axes, from_origin), (to_axes, to_origin) = places
        rotation = to_axes @ np.linalg.inv(from_axes)
        return rotation, to_origin - rotation @ from_origin

    def name(self, definition):
        formation = self.file.one(definition, "PRODUCT_DEFINITION")[2]
        return self.file.one(self.file.one(formation, "PRODUCT_DEFINITION_FORMATION")[2], "PRODUCT")[1]

    def solid(self, definition):
        """The item of a part; none of an assembly."""
        ((_, items, _),) = self.file.entities[self.representation[definition]].values()
        shapes = [i for i in items if "AXIS2_PLACEMENT_3D" not in self.file.entities[i]]
        return shapes[0] if shapes else None

    def measure(self, definition):
        if definition not in self.measured:
            solid = self.solid(definition)
            if solid is not None:
                sums = self.shapes.of(solid)
            else:
                sums = Sums()
                for part, (rotation, offset) in self.components[definition]:
                    sums.add(self.measure(part), rotation, offset)
            self.measured[definition] = sums
        return self.measured[definition]
