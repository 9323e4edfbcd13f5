"""Light through openings, from a uniform sky: 5.9 in the roof, 5.11 in the facade, 5.13 and 5.14 with masks."""

import math

import numpy as np

import formulas
import meshes
from case import (BLACK, PANEL, ROOM, ROOM_POINTS, TO_Y, Scene, black_room, case, floor_points, grey, joined, mesh, one_polygon, rectangle,
                  wall_points)

SKY = 100 / math.pi  # a horizontal plane in the open gets 100: irradiance is the sky component in percent
ROOF = {"1 x 1": PANEL, "4 x 4": rectangle((0, 0, 3), (0, 4, 0), (4, 0, 0))}
FACADE = {"2 x 1": rectangle((1, 0, 1), (0, 0, 1), (2, 0, 0)), "4 x 3": rectangle((0, 0, 0), (0, 0, 3), (4, 0, 0))}
DEEP_POINTS = joined(wall_points(4.0, -TO_Y), floor_points())


def luminous():
    """A uniform sky seen through an opening is an opening of the sky's radiance."""
    for number, openings, where in (("5.9", ROOF, ROOM_POINTS), ("5.11", FACADE, DEEP_POINTS)):
        for size, opening in openings.items():
            def build(scene, opening=opening):
                black_room(scene)
                scene.light("opening", mesh(opening), grey(SKY))

            yield Scene(f"{number} {size}", f"a room of 4 x 4 x 3 m, an opening of {size} m in its {'roof' if number == '5.9' else 'facade'}, "
                        "luminous as a uniform sky", build,
                        [one_polygon(f"{number} {size}", "sky component, %", where, opening, SKY)], open_air=True)


def frame(opening, low, high):
    """The rest of the rectangle low..high, of opposite corners, around a rectangular opening in it: four quadrangles."""
    axis = int(np.argmin(np.ptp(opening, axis=0)))
    u, v = (i for i in range(3) if i != axis)
    (a, b), (c, d) = opening[:, [u, v]].min(axis=0), opening[:, [u, v]].max(axis=0)

    def part(u0, v0, u1, v1):
        corners = np.zeros((4, 3))
        corners[:, u], corners[:, v], corners[:, axis] = (u0, u1, u1, u0), (v0, v0, v1, v1), opening[0, axis]
        return corners

    parts = (part(low[u], low[v], high[u], b), part(low[u], d, high[u], high[v]), part(low[u], b, a, d), part(c, b, high[u], d))
    return [p for p in parts if formulas.area_of(p) > 0]


def open_room(scene, opening):
    """The black room without the face that the opening is in, and that face about it."""
    low, high = (np.array(v, float) for v in ROOM)
    vertices, triangles = meshes.flat(meshes.box(low, high, inward=True))
    axis = int(np.argmin(np.ptp(opening, axis=0)))
    there = np.all(vertices[triangles][:, :, axis] == opening[0, axis], axis=1)
    scene.surface("room", (vertices, triangles[~there]), BLACK)
    parts = frame(opening, low, high)
    if parts:
        scene.surface("frame", mesh(*parts), BLACK)


def skies():
    """Skies of one light, and of 8 x 8, each of which has shadows of its own points."""
    over = rectangle((-2, -2, 5), (0, 8, 0), (8, 0, 0))
    before = rectangle((-4, -4, 0), (0, 0, 12), (12, 0, 0))
    far = rectangle((-6, -8, 0), (0, 0, 12), (16, 0, 0))
    above = rectangle((-8, -1, 3), (20, 0, 0), (0, 1, 0))
    opposite = rectangle((-8, -6, 0), (20, 0, 0), (0, 0, 3))
    for name, what, opening, sky, mask, where in (
            ("5.9 1 x 1 sky", "a sky of 8 x 8 m 2 m over the roof's opening of 1 x 1 m", ROOF["1 x 1"], over, None, ROOM_POINTS),
            ("5.11 2 x 1 sky", "a sky of 12 x 12 m 4 m before the facade's opening of 2 x 1 m", FACADE["2 x 1"], before, None, DEEP_POINTS),
            ("5.13 sky", "the same sky before an open facade of 4 x 3 m, a black mask of 1 m over it", FACADE["4 x 3"], before, above,
             DEEP_POINTS),
            ("5.14 sky", "a sky of 16 x 12 m 8 m before an open facade, a black wall of 3 m height 6 m before it", FACADE["4 x 3"], far,
             opposite, DEEP_POINTS)):
        for lights in (1, 8):
            yield one_sky(name if lights == 1 else f"{name}, {lights * lights} lights", what, opening, sky, mask, where, lights)


def one_sky(name, what, opening, sky, mask, where, lights):
    def build(scene):
        open_room(scene, opening)
        for i, part in enumerate(formulas.pieces(sky, lights)):
            scene.light(f"sky {i}", mesh(part), grey(SKY))
        if mask is not None:
            scene.surface("mask", mesh(mask), BLACK)

    return Scene(name, what, build, [case(name, "E", where, lambda p, n: SKY * formulas.seen(p, n, sky, opening, mask))])
