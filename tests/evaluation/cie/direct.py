"""Direct light: 5.2 point sources, 5.3 area sources, 5.4 flux."""

import math

import numpy as np

import formulas
import meshes
from case import (BLACK, PANEL, ROOM, ROOM_POINTS, TO_Z, Case, Scene, at, ball, black_room, case, grey, inside, mesh, one_polygon, rectangle)

PLANE = at("ABCDEFGHIJ", [(x, y, 0) for x, y in ((0, 0), (.5, 0), (1, 0), (1.5, 0), (.5, .5), (1, .5), (1.5, .5), (1, 1), (1.5, 1),
                                                 (1.5, 1.5))], TO_Z)


def point_sources():
    floor = rectangle((-2, -2, 0), (4, 0, 0), (0, 4, 0))

    def patch(scene):
        scene.surface("floor", mesh(floor), BLACK)
        scene.light("source", mesh(rectangle((-0.01, -0.01, 3), (0, 0.02, 0), (0.02, 0, 0))), grey(1000 / 0.02 ** 2))

    def sphere(scene):
        scene.surface("floor", mesh(floor), BLACK)
        source, radiance = ball((0, 0, 3), 0.02, 4000 * math.pi)
        scene.light("source", source, grey(radiance))

    labels, points, normals = PLANE
    diffuse = formulas.lambertian_point(points, normals, (0, 0, 3), -TO_Z, 1000)
    even = formulas.point_source(points, normals, (0, 0, 3), 1000)
    what = "a source of 1000 W/sr 3 m over a plane of 4 x 4 m, points .5 m apart; "
    yield Scene("5.2 diffuse", what + "the point is a square of 2 cm", patch,
                [Case("5.2 diffuse", "E", labels, points, normals, diffuse)], open_air=True)
    yield Scene("5.2 isotropic", what + "the point is a sphere of 4 cm", sphere,
                [Case("5.2 isotropic", "E", labels, points, normals, even)], open_air=True)


def area_sources():
    def panel(scene):
        black_room(scene)
        scene.light("panel", mesh(PANEL), grey(1000))

    plate = rectangle((1.5, 0.5, 1.5), (1, 0, 0), (0, 1, 0))

    def shaded(scene):
        panel(scene)
        scene.surface("plate", mesh(plate), BLACK)

    def textured(scene):
        black_room(scene)
        scene.light("panel", mesh(PANEL), grey(1000), meshes.quad_uvs(), PICTURE)

    yield Scene("5.3", "a panel of 1 x 1 m, 1000 W/(sr m^2), in the ceiling of a room of 4 x 4 x 3 m; wall and floor", panel,
                [one_polygon("5.3", "E", ROOM_POINTS, PANEL, 1000)], open_air=True)
    yield Scene("5.3 plate", "the same with a plate of 1 x 1 m at half height between panel and floor", shaded,
                [case("5.3 plate", "E", ROOM_POINTS, lambda p, n: 1000 * formulas.seen(p, n, PANEL, hidden_by=plate))])
    yield Scene("5.3 texture", "the panel of 5.3 with a texture of 8 x 8 texels from dark to bright, bilinear and repeated",
                textured, [case("5.3 texture", "E", ROOM_POINTS, textured_panel)], open_air=True)


PICTURE = np.repeat(np.broadcast_to((40 + 25 * np.arange(8))[None, :, None], (8, 8, 1)), 3, axis=2).astype(np.uint8)


def linear(srgb):
    c = srgb / 255.0
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def textured_panel(receiver, normal, n=64):
    """In n x n pieces, each as bright as the texture at its middle. The corners of PANEL have the uvs of meshes.quad_uvs."""
    parts = formulas.pieces(formulas.cut(PANEL, receiver, normal), n)
    s = (np.arange(n) + 0.5) / n
    u, v = (x.reshape(-1) for x in np.meshgrid(s, 1 - s))
    return float(1000 * formulas.bilinear(linear(PICTURE[..., 0]), u, v) @ formulas.unclipped(receiver[None], normal[None], parts)[0])


def flux():
    points, normals, weights = inside(ROOM, 16)

    def sphere(scene):
        black_room(scene)
        source, radiance = ball((2, 2, 1.5), 0.02, 10000)
        scene.light("source", source, grey(radiance))

    def panel(scene):
        black_room(scene)
        scene.light("panel", mesh(PANEL), grey(1000))

    def one(name, what, build, power):
        return Scene(name, what + "; 16 x 16 Gauss points on each face", build,
                     [Case(name, "power on all faces", [], points, normals, power, weights)], open_air=True)

    yield one("5.4 point", "a sphere of 4 cm, 10 kW, in the middle of a black room of 4 x 4 x 3 m", sphere, 10000.0)
    yield one("5.4 area", "the panel of 5.3 in the same room", panel, 1000 * math.pi)
