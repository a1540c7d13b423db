"""Pictures of meshes of unit cells, from their VTU files: see scripts/pictures."""

import meshio
import numpy
from PIL import Image, ImageDraw

YARN_COLORS = numpy.array(
    [
        (214, 90, 70),
        (70, 130, 200),
        (230, 170, 60),
        (90, 170, 110),
        (150, 110, 190),
        (200, 120, 150),
        (120, 190, 190),
        (170, 150, 110),
    ]
)
MATRIX_COLOR = numpy.array((225, 225, 215))
EDGE_COLOR = (70, 70, 70)
AZIMUTH, ELEVATION = numpy.radians((-60.0, 30.0))
SMOOTHING = 3  # drawn so many times larger, then shrunk


def skin(cells, colors):
    """The triangles that tetrahedra have alone, seen from outside, and the colour of each."""
    faces = numpy.concatenate([cells[:, [0, 2, 1]], cells[:, [0, 1, 3]], cells[:, [1, 2, 3]], cells[:, [0, 3, 2]]])
    _, first, count = numpy.unique(numpy.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    alone = numpy.sort(first[count == 1])
    return faces[alone], numpy.tile(colors, (4, 1))[alone]


def visible_cells(mesh):
    """Each yarn by itself, and the half of the matrix behind the diagonal of the cell."""
    cells, yarns = mesh.cells[0].data[:, :4], numpy.asarray(mesh.cell_data["yarn"][0]).ravel().astype(int)
    is_matrix = yarns < 0
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    middles = (mesh.points[cells].mean(axis=1) - low) / (high - low)
    behind = is_matrix & (middles[:, 1] > middles[:, 0])
    groups = [(behind, MATRIX_COLOR)]
    groups += [
        ((yarns == yarn) & ~is_matrix, YARN_COLORS[k % len(YARN_COLORS)])
        for k, yarn in enumerate(numpy.unique(yarns[~is_matrix]))
    ]
    return [skin(cells[chosen], numpy.tile(color, (chosen.sum(), 1))) for chosen, color in groups]


def draw(vtu, path, size):
    """A picture of the mesh, from above, the front and the right: the farthest triangles first."""
    mesh = meshio.read(vtu)
    parts = visible_cells(mesh)
    triangles, colors = (numpy.concatenate(lists) for lists in zip(*parts))
    right = numpy.array((-numpy.sin(AZIMUTH), numpy.cos(AZIMUTH), 0))
    eye = numpy.array(
        (numpy.cos(ELEVATION) * numpy.cos(AZIMUTH), numpy.cos(ELEVATION) * numpy.sin(AZIMUTH), numpy.sin(ELEVATION))
    )
    up = numpy.cross(eye, right)
    corners = mesh.points[triangles]
    normals = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= numpy.linalg.norm(normals, axis=1)[:, None]
    seen = normals @ eye > 0
    corners, normals, colors = corners[seen], normals[seen], colors[seen]
    flat = numpy.stack([corners @ right, -(corners @ up)], axis=2)
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    pixels = numpy.array(size) * SMOOTHING
    scale = 0.97 * (pixels / (high - low)).min()
    flat = (flat - (low + high) / 2) * scale + pixels / 2
    light = 0.4 * right + 0.5 * up + 0.8 * eye
    shades = 0.35 + 0.65 * numpy.clip(normals @ light / numpy.linalg.norm(light), 0, 1)
    image = Image.new("RGB", tuple(pixels), "white")
    pen = ImageDraw.Draw(image)
    for k in numpy.argsort((corners @ eye).mean(axis=1), kind="stable"):
        points = [tuple(point) for point in flat[k]]
        pen.polygon(points, fill=tuple((colors[k] * shades[k]).astype(int)))
        pen.line([*points, points[0]], fill=EDGE_COLOR, width=SMOOTHING // 2)
    image.resize(size, Image.LANCZOS).save(path)
