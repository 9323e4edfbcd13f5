"""What a case is, and the points, rooms and lamps that several share.

Coordinates are the standard's: x across the room, y from the facade inwards, z up, metres.
"""

import dataclasses
import math

import numpy as np

import formulas
import meshes

TO_X, TO_Y, TO_Z = np.eye(3)
WALL_HEIGHTS = (2.75, 2.25, 1.75, 1.25, 0.75, 0.25)  # A to F
DEPTHS = tuple(0.25 + 0.5 * i for i in range(8))  # G to N
BLACK = (0.0, 0.0, 0.0)


@dataclasses.dataclass
class Case:
    """Points of one scene and what the formulas say of them."""

    name: str
    says: str  # what is compared
    labels: list
    points: np.ndarray
    normals: np.ndarray
    truth: np.ndarray  # at the points; one number, of their weighted sum, where there are weights
    weights: np.ndarray = None
    looked_up: np.ndarray = None  # what CAP makes of the exact moments at the points

    def __post_init__(self):
        self.truth = np.atleast_1d(self.truth)


@dataclasses.dataclass
class Scene:
    name: str
    geometry: str
    build: object  # adds lights and surfaces to a gltf.Scene
    cases: list
    reflectance: float = 0.0
    bounces: int = 0
    open_air: bool = False  # nothing casts a shadow: PROPAGATE is asked, too
    flags: str = ""  # of `lpvctl session create`


def rectangle(origin, along, across):
    """Corners, counter-clockwise seen from along x across."""
    origin, along, across = (np.asarray(v, float) for v in (origin, along, across))
    return np.array([origin, origin + along, origin + along + across, origin + across])


def mesh(*polygons):
    """Quadrangles as one mesh of two triangles each."""
    vertices = np.concatenate(polygons)
    return vertices, np.concatenate([[[i, i + 1, i + 2], [i, i + 2, i + 3]] for i in range(0, len(vertices), 4)])


def grey(value):
    return (value,) * 3


def at(labels, points, normal):
    points = np.array(points, float)
    return list(labels), points, np.broadcast_to(normal, points.shape)


def joined(*parts):
    labels, points, normals = zip(*parts)
    return sum(labels, []), np.concatenate(points), np.concatenate(normals)


def wall_points(y=0.0, normal=TO_Y):
    return at("ABCDEF", [(2, y, z) for z in WALL_HEIGHTS], normal)


def floor_points(depths=DEPTHS):
    return at("GHIJKLMN", [(2, y, 0) for y in depths], TO_Z)


def case(name, says, where, truth):
    """`truth`: of one receiver and normal."""
    labels, points, normals = where
    return Case(name, says, labels, points, normals, np.array([truth(p, n) for p, n in zip(points, normals)]))


def one_polygon(name, says, where, polygon, radiance):
    """The case of one luminous polygon with nothing in its way."""
    out = case(name, says, where, lambda p, n: radiance * formulas.irradiance(p, n, polygon))
    out.looked_up = np.array([radiance * formulas.cap_lookup(*formulas.moments(p, polygon), n) for p, n in zip(out.points, out.normals)])
    return out


ROOM = ((0, 0, 0), (4, 4, 3))
PANEL = rectangle((1.5, 1.5, 3), (0, 1, 0), (1, 0, 0))
ROOM_POINTS = joined(wall_points(), floor_points())


def ball(centre, radius, power):
    """A sphere that sends so many watts, and its radiance."""
    vertices, triangles = meshes.sphere(centre, radius)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    return (vertices, triangles), power / (math.pi * area)


def black_room(scene, size=ROOM):
    scene.surface("room", meshes.flat(meshes.box(*size, inward=True)), BLACK)


def inside(size, count):
    """Gauss points on the six faces of a box, normals inwards, weights that sum to its area: labels are empty."""
    low, high = (np.asarray(v, float) for v in size)
    nodes, gauss = np.polynomial.legendre.leggauss(count)
    s, gauss = (nodes + 1) / 2, gauss / 2
    points, normals, weights = [], [], []
    for axis in range(3):
        u, v = (i for i in range(3) if i != axis)
        for end, sign in ((low[axis], 1.0), (high[axis], -1.0)):
            p = np.zeros((count, count, 3))
            p[..., u] = low[u] + s[:, None] * (high - low)[u]
            p[..., v] = low[v] + s[None, :] * (high - low)[v]
            p[..., axis] = end
            points.append(p.reshape(-1, 3))
            normals.append(np.broadcast_to(sign * np.eye(3)[axis], (count * count, 3)))
            weights.append(np.outer(gauss, gauss).reshape(-1) * (high - low)[u] * (high - low)[v])
    return np.concatenate(points), np.concatenate(normals), np.concatenate(weights)
