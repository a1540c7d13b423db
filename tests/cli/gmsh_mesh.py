"""A mesh file of gmsh (format 2), read for the tests."""

TRIANGLE, TETRAHEDRON = "2", "4"
CORNERS = {TRIANGLE: 3, TETRAHEDRON: 4}


def elements(path, kind):
    """The elements of one kind: (number of the geometry's entity, corners) each."""
    nodes = {}
    with open(path) as file:
        lines = iter(file)
        for line in lines:
            if line.startswith("$Nodes"):
                for _ in range(int(next(lines))):
                    number, *xyz = next(lines).split()
                    nodes[number] = tuple(map(float, xyz))
            elif line.startswith("$Elements"):
                for _ in range(int(next(lines))):
                    words = next(lines).split()
                    if words[1] == kind:
                        first = 3 + int(words[2])
                        yield words[4], [nodes[n] for n in words[first : first + CORNERS[kind]]]
