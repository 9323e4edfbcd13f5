"""Triangle meshes: (vertices (n, 3) in metres, triangles (m, 3)), counter-clockwise seen from outside."""

import math

import numpy as np


def quad(centre, right, up):
    """A rectangle spanned by the two edge vectors, front towards right x up; its uvs are in quad_uvs()."""
    centre, right, up = (np.asarray(v, float) for v in (centre, right, up))
    corners = [centre + 0.5 * (a * right + b * up) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return np.array(corners), np.array([[0, 1, 2], [0, 2, 3]])


def quad_uvs():
    """(0, 0) is the picture's upper left corner."""
    return np.array([[0, 1], [1, 1], [1, 0], [0, 0]], float)


def panel_down(centre, width, depth):
    """A horizontal rectangle that faces down."""
    return quad(centre, (width, 0, 0), (0, 0, depth))


def grid_quad(centre, right, up, n):
    """The rectangle as 2 n^2 triangles."""
    centre, right, up = (np.asarray(v, float) for v in (centre, right, up))
    s = np.linspace(-0.5, 0.5, n + 1)
    vertices = np.array([centre + a * right + b * up for b in s for a in s])
    triangles = []
    for j in range(n):
        for i in range(n):
            a = j * (n + 1) + i
            triangles += [[a, a + 1, a + n + 2], [a, a + n + 2, a + n + 1]]
    return vertices, np.array(triangles)


def box(low, high, inward=False):
    low, high = np.asarray(low, float), np.asarray(high, float)
    vertices = np.array([[(high if i >> axis & 1 else low)[axis] for axis in range(3)] for i in range(8)])
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    triangles = []
    for a, b, c, d in faces:
        triangles += [[a, b, c], [a, c, d]]
    triangles = np.array(triangles)
    return vertices, triangles[:, ::-1] if inward else triangles


def flat(mesh):
    """Every triangle with vertices of its own, so that readers give it its own normal."""
    vertices, triangles = mesh
    return vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def tube(start, end, diameter, sides=6):
    """Open ends."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    axis = (end - start) / np.linalg.norm(end - start)
    across = np.cross(axis, (0, 1, 0) if abs(axis[1]) < 0.9 else (1, 0, 0))
    across /= np.linalg.norm(across)
    other = np.cross(axis, across)
    angles = 2 * math.pi * np.arange(sides) / sides
    ring = 0.5 * diameter * (np.outer(np.cos(angles), across) + np.outer(np.sin(angles), other))
    triangles = []
    for i in range(sides):
        j = (i + 1) % sides
        triangles += [[i, j, sides + j], [i, sides + j, sides + i]]
    return np.concatenate([start + ring, end + ring]), np.array(triangles)


def sphere(centre, radius, slices=48, stacks=24, wave=0.0):
    """Latitudes and longitudes; `wave`: relative height of waves on it, for a statue where there is none."""
    vertices, triangles = [], []
    for j in range(stacks + 1):
        theta = math.pi * j / stacks
        for i in range(slices):
            phi = 2 * math.pi * i / slices
            r = radius * (1 + wave * math.sin(7 * phi) * math.sin(5 * theta) ** 2)
            vertices.append([r * math.sin(theta) * math.cos(phi), r * math.cos(theta), r * math.sin(theta) * math.sin(phi)])
    for j in range(stacks):
        for i in range(slices):
            a, b = j * slices + i, j * slices + (i + 1) % slices
            if j > 0:
                triangles.append([a, b, b + slices])
            if j < stacks - 1:
                triangles.append([a, b + slices, a + slices])
    return np.array(vertices) + np.asarray(centre, float), np.array(triangles)


def rings(points, closed):
    """Quads between rings of vertices (n, m, 3), each ring closed in itself; `closed`: the last ring meets the first."""
    count, sides = points.shape[:2]
    triangles = []
    for i in range(count if closed else count - 1):
        for j in range(sides):
            a, b = i * sides + j, i * sides + (j + 1) % sides
            c, d = (i + 1) % count * sides + j, (i + 1) % count * sides + (j + 1) % sides
            triangles += [[a, b, d], [a, d, c]]
    return points.reshape(-1, 3), np.array(triangles)


def knot(turns=240, sides=24, thickness=0.34):
    """A thick tube along a knot (2, 5) on a torus: it folds over itself, and hides much of its own light."""
    def path(t):
        r = 1 + 0.45 * np.cos(5 * t)
        return np.stack([r * np.cos(2 * t), 0.8 * np.sin(5 * t), r * np.sin(2 * t)], axis=-1)

    t = 2 * math.pi * np.arange(turns) / turns
    along = path(t + 1e-4) - path(t - 1e-4)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = path(t) - along * np.sum(path(t) * along, axis=1, keepdims=True)
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    side = np.cross(along, out)
    angles = 2 * math.pi * np.arange(sides) / sides
    circle = np.cos(angles)[None, :, None] * out[:, None] + np.sin(angles)[None, :, None] * side[:, None]
    return rings(path(t)[:, None] + thickness * circle, True)


def pot(sides=64):
    """An open vessel with an inner and an outer wall, 1 high."""
    profile = [(0.0, 0.0), (0.34, 0.0), (0.46, 0.12), (0.5, 0.4), (0.42, 0.75), (0.33, 0.9), (0.36, 1.0),  # outside, upwards
               (0.32, 1.0), (0.29, 0.9), (0.38, 0.74), (0.46, 0.4), (0.42, 0.14), (0.32, 0.04), (0.0, 0.04)]  # inside, down
    return lathe(profile, sides)


def lathe(profile, sides=32, centre=(0, 0, 0)):
    """A profile of (radius, height) turned about the vertical through `centre`; what goes upwards faces outwards."""
    angles = 2 * math.pi * np.arange(sides) / sides
    circle = np.stack([np.cos(angles), np.zeros(sides), np.sin(angles)], axis=1)
    points = np.array([r * circle + (0, y, 0) for r, y in profile])
    vertices, triangles = rings(points, False)
    return vertices + np.asarray(centre, float), triangles[:, ::-1]


def turned(mesh, degrees, about):
    """The mesh turned about the vertical through a point."""
    vertices, triangles = mesh
    angle = math.radians(degrees)
    turn = np.array([[math.cos(angle), 0, math.sin(angle)], [0, 1, 0], [-math.sin(angle), 0, math.cos(angle)]])
    return (np.asarray(vertices) - about) @ turn.T + about, triangles


def read_ply(path):
    """Vertices and triangles of a binary little-endian PLY whose faces are triangles."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    types = {"float": "<f4", "float32": "<f4", "double": "<f8", "uchar": "u1", "uint8": "u1", "int": "<i4", "int32": "<i4",
             "uint": "<u4", "short": "<i2", "ushort": "<u2"}
    elements = []
    for line in data[:end].decode("ascii").splitlines():
        words = line.split()
        if words[0] == "format" and words[1] != "binary_little_endian":
            raise ValueError(f"{path}: only binary little-endian PLY is read")
        if words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property" and words[1] == "list":
            elements[-1][2].extend([("count", types[words[2]]), ("indices", types[words[3]], 3)])
        elif words[0] == "property":
            elements[-1][2].append((words[2], types[words[1]]))
    arrays, at = {}, end
    for name, count, fields in elements:
        arrays[name] = np.frombuffer(data, np.dtype(fields), count, at)
        at += arrays[name].nbytes
    if (arrays["face"]["count"] != 3).any():
        raise ValueError(f"{path}: a face is no triangle")
    vertices = np.stack([arrays["vertex"][axis] for axis in "xyz"], axis=1).astype(float)
    return vertices, arrays["face"]["indices"].astype(int)


def standing(mesh, foot, height):
    """The mesh scaled to a height and stood on a point."""
    vertices, triangles = mesh
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    centre = np.array([(low[0] + high[0]) / 2, low[1], (low[2] + high[2]) / 2])
    return (vertices - centre) * (height / (high[1] - low[1])) + np.asarray(foot, float), triangles
