"""A closed cube with a lamp in its middle: the irradiance of its walls, by the radiosity series.

All six walls are alike and each is like itself under the symmetries of a square, so one wall is solved: n x n patches of
one radiance each, whose mean irradiance is that of their middles.
"""

import functools

import numpy as np

import formulas

# The other walls of the cube (0..1)^3, counter-clockwise from inside, as seen from the wall z = 0: origin and the edges that
# the wall's own coordinates (u, v) run along.
OTHERS = (((0, 0, 1), (0, 1, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0), (0, 0, 1)), ((1, 0, 0), (0, 0, 1), (0, 1, 0)),
          ((0, 0, 0), (0, 0, 1), (1, 0, 0)), ((0, 1, 0), (1, 0, 0), (0, 0, 1)))
UP = np.array([0.0, 0, 1])


def patches(n):
    """Middles (n^2, 3) of the wall's patches, u fastest, and of each other wall the patches (n^2, 4, 3) in that order."""
    s = (np.arange(n) + 0.5) / n
    u, v = (x.reshape(-1) for x in np.meshgrid(s, s))
    middles = np.stack([u, v, 0 * u], axis=1)
    walls = []
    for origin, along, across in (tuple(np.array(x, float) for x in wall) for wall in OTHERS):
        low = origin + (u - 0.5 / n)[:, None] * along + (v - 0.5 / n)[:, None] * across
        walls.append(np.stack([low, low + along / n, low + (along + across) / n, low + across / n], axis=1))
    return middles, walls


def exchange(receivers, n):
    """What receivers on the wall (m, 3) get from patches of radiance 1, all five walls together: (m, n^2). Patches that a
    square's symmetries make one another have one radiance, so each stands for the mean of the eight."""
    _, walls = patches(n)
    normals = np.broadcast_to(UP, receivers.shape)
    matrix = sum(np.concatenate([formulas.unclipped(part, normals[:len(part)], wall)
                                 for part in np.array_split(receivers, max(1, len(receivers) * n * n // 200_000))])
                 for wall in walls).reshape(-1, n, n)
    matrix = matrix + matrix[:, ::-1]
    matrix = matrix + matrix[:, :, ::-1]
    return (matrix + matrix.transpose(0, 2, 1)).reshape(-1, n * n) / 8


@functools.lru_cache(maxsize=2)
def own_exchange(n):
    """Between the patches themselves: each sends and gets all that it can, so rows and columns sum to pi (Sinkhorn 1967)
    and no light is lost or made."""
    matrix = exchange(patches(n)[0], n)
    for _ in range(50):
        matrix *= np.pi / matrix.sum(axis=0)
        matrix *= np.pi / matrix.sum(axis=1, keepdims=True)
    return matrix


def irradiances(receivers, side, power, reflectance, bounces, n=24):
    """At points (m, 3) of the wall z = 0 of a cube of an edge `side`, of a lamp of so many watts in its middle; `bounces`:
    None is all of them."""
    receivers = np.asarray(receivers, float) / side
    lamp = lambda points: formulas.point_source(points, np.broadcast_to(UP, points.shape), (0.5, 0.5, 0.5),
                                                power / (4 * np.pi)) / side ** 2
    direct = lamp(patches(n)[0])
    direct *= power / (6 * side ** 2) / direct.mean()
    if bounces == 0 or reflectance == 0:
        return lamp(receivers)
    step = reflectance / np.pi * own_exchange(n)
    if bounces is None:
        mean = np.linalg.solve(np.eye(n * n) - step, direct)
    else:
        mean = direct.copy()
        for _ in range(bounces - 1):
            mean = direct + step @ mean
    return lamp(receivers) + reflectance / np.pi * exchange(receivers, n) @ mean
