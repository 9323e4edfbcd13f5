"""The cases of CIE 171:2006 that apply: scenes, points and what formulas say of them.

Coordinates are the standard's: x across the room, y from the facade inwards, z up, metres. Values are derived here; where a
source's or a sky's radiance is free it is chosen so that irradiance has the numbers that validations print.
"""

import dataclasses
import math

import numpy as np

import cube
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


# Direct light -----------------------------------------------------------------------------------------------------------

PLANE = at("ABCDEFGHIJ", [(x, y, 0) for x, y in ((0, 0), (.5, 0), (1, 0), (1.5, 0), (.5, .5), (1, .5), (1.5, .5), (1, 1), (1.5, 1),
                                                 (1.5, 1.5))], TO_Z)
ROOM = ((0, 0, 0), (4, 4, 3))
PANEL = rectangle((1.5, 1.5, 3), (0, 1, 0), (1, 0, 0))
ROOM_POINTS = joined(wall_points(), floor_points())


def ball(centre, radius, power):
    """A sphere that sends so many watts, and its radiance."""
    vertices, triangles = meshes.sphere(centre, radius, 96, 48)
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()
    return (vertices, triangles), power / (math.pi * area)


def black_room(scene, size=ROOM):
    scene.surface("room", meshes.flat(meshes.box(*size, inward=True)), BLACK)


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
                [case("5.3", "E", ROOM_POINTS, lambda p, n: 1000 * formulas.irradiance(p, n, PANEL))], open_air=True)
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


# Diffuse reflection -----------------------------------------------------------------------------------------------------

FAR = 10_000.0  # metres to the lamp that lights one surface alone


def far_lamp(target, towards):
    """A square that faces the target from a direction, a fiftieth as large as far."""
    towards = np.asarray(towards, float) / np.linalg.norm(towards)
    across = np.cross(towards, TO_X)
    edge = FAR / 50
    return rectangle(np.asarray(target, float) + FAR * towards - 0.5 * edge * (TO_X + across), edge * TO_X, edge * across)[::-1]


def lit_surface(quad, towards, reflectance):
    """The lamp of a quadrangle, its radiance, and the irradiance of points of it: 100 / reflectance in the middle, so that
    what the surface reflects is in percent of what it gets, times the reflectance."""
    normal, middle = formulas.normal_of(quad), quad.mean(axis=0)
    lamp = far_lamp(middle, towards)
    radiance = 100 / reflectance / formulas.irradiance(middle, normal, lamp)
    return lamp, radiance, lambda points: radiance * formulas.unclipped(points, np.broadcast_to(normal, points.shape), lamp[None])[:, 0]


def reflection():
    """5.6: no measuring plane is there, and the lamp is behind the wall's points and above the ceiling's."""
    where = joined(at("FEDCBA", [(2, 0, z) for z in WALL_HEIGHTS], TO_Y), at("GHIJKLMN", [(2, y, 3) for y in DEPTHS], -TO_Z))
    towards = (0, -math.cos(math.radians(60)), math.sin(math.radians(60)))
    for number, size, pieces in ((1, 0.5, 8), (2, 4.0, 16), (3, 500.0, 400)):
        quad = rectangle((2 - size / 2, 2 - size / 2, 0), (size, 0, 0), (0, size, 0))
        lamp, radiance, got = lit_surface(quad, towards, 0.3)

        def build(scene, quad=quad, lamp=lamp, radiance=radiance):
            scene.surface("S2", mesh(quad), grey(0.3))
            scene.light("lamp", mesh(lamp), grey(radiance))

        yield Scene(f"5.6 ({number})", f"a floor of {size:g} x {size:g} m about (2, 2), lit alone; wall points at y = 0, ceiling points at z = 3",
                    build, [case(f"5.6 ({number})", "E / (E_hz rho), %", where,
                                 lambda p, n, quad=quad, got=got, pieces=pieces: formulas.reflected(p, n, quad, 0.3, got, pieces))],
                    0.3, 1, flags="--bounds=-1,-1,-1,5,5,4")


BOX = ((0, 2.5, 0), (4, 2.7, 1))  # the obstruction of 5.7


def obstruction():
    """5.7: the lamp shines from below the floor's points, past the box."""
    quad = rectangle((0, 4, 0), (4, 0, 0), (0, 0, 3))
    lamp, radiance, got = lit_surface(quad, (0, -math.cos(math.radians(72)), -math.sin(math.radians(72))), 0.6)

    def build(scene):
        scene.surface("S2", mesh(quad), grey(0.6))
        scene.surface("box", meshes.flat(meshes.box(*BOX)), BLACK)
        scene.light("lamp", mesh(lamp), grey(radiance))

    corners = meshes.box(*BOX)[0]
    where = joined(wall_points(), floor_points(DEPTHS[:5]))
    yield Scene("5.7", "a wall of 4 x 3 m at y = 4, lit alone; a black box of 4 x .2 x 1 m at y = 2.5; points at y = 0 and on the floor",
                build, [case("5.7", "E / (E_v rho), %", where,
                             lambda p, n: formulas.reflected(p, n, quad, 0.6, got, 8, corners))],
                0.6, 1, flags="--bounds=-1,-1,-1,5,5,4")


REFLECTANCES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
MOST_BOUNCES = 32  # of `lpvctl session create`
CUBE = ((0, 0, 0), (4, 4, 4))


def closed_cube():
    points, normals, weights = inside(CUBE, 12)
    s = np.array(DEPTHS)
    wall = np.array([(x, y, 0) for y in s for x in s])
    even = np.concatenate([wall, wall * (1, 1, 0) + (0, 0, 4)])
    even = np.concatenate([np.roll(even, shift, axis=1) for shift in range(3)])
    facing = np.repeat(np.concatenate([np.roll(sign * TO_Z, shift)[None] for shift in range(3) for sign in (1, -1)]), len(wall), axis=0)
    lamp, radiance = ball((2, 2, 2), 0.02, 10000)
    for reflectance in REFLECTANCES:
        def build(scene, reflectance=reflectance):
            scene.surface("cube", meshes.flat(meshes.box(*CUBE, inward=True)), grey(reflectance))
            scene.light("lamp", lamp, grey(radiance))

        truth = np.tile(cube.irradiances(wall, 4.0, 10000, reflectance, MOST_BOUNCES), 6)
        name = f"5.8 rho {reflectance:g}"
        yield Scene(name, "a closed cube of 4 m, a sphere of 4 cm and 10 kW in its middle; means of 12 x 12 Gauss points and 8 x 8 even points on each wall",
                    build, [Case(name, "mean E", [], points, normals, 10000 / 96 * formulas.series(reflectance, None), weights / 96),
                            Case(name, f"mean E, {MOST_BOUNCES} bounces", [], points, normals,
                                 10000 / 96 * formulas.series(reflectance, MOST_BOUNCES), weights / 96),
                            Case(name, f"E, {MOST_BOUNCES} bounces", [], even, facing, truth)],
                    reflectance, MOST_BOUNCES, open_air=False)


# Openings ---------------------------------------------------------------------------------------------------------------

SKY = 100 / math.pi  # a horizontal plane in the open gets 100: irradiance is the sky component in percent
ROOF = {"1 x 1": PANEL, "4 x 4": rectangle((0, 0, 3), (0, 4, 0), (4, 0, 0))}
FACADE = {"2 x 1": rectangle((1, 0, 1), (0, 0, 1), (2, 0, 0)), "4 x 3": rectangle((0, 0, 0), (0, 0, 3), (4, 0, 0))}
DEEP_POINTS = joined(wall_points(4.0, -TO_Y), floor_points())


def luminous_openings():
    """A uniform sky seen through an opening is an opening of the sky's radiance."""
    for number, openings, where in (("5.9", ROOF, ROOM_POINTS), ("5.11", FACADE, DEEP_POINTS)):
        for size, opening in openings.items():
            def build(scene, opening=opening):
                black_room(scene)
                scene.light("opening", mesh(opening), grey(SKY))

            yield Scene(f"{number} {size}", f"a room of 4 x 4 x 3 m, an opening of {size} m in its {'roof' if number == '5.9' else 'facade'}, "
                        "luminous as a uniform sky", build,
                        [case(f"{number} {size}", "sky component, %", where,
                              lambda p, n, opening=opening: SKY * formulas.irradiance(p, n, opening))], open_air=True)


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


def skies_behind():
    over = rectangle((-2, -2, 5), (0, 8, 0), (8, 0, 0))
    before = rectangle((-4, -4, 0), (0, 0, 12), (12, 0, 0))
    far = rectangle((-6, -8, 0), (0, 0, 12), (16, 0, 0))
    above = rectangle((-8, -1, 3), (20, 0, 0), (0, 1, 0))
    opposite = rectangle((-8, -6, 0), (20, 0, 0), (0, 0, 3))
    for name, what, opening, sky, mask, where in (
            ("5.9 1 x 1, sky", "a sky of 8 x 8 m 2 m over the roof's opening of 1 x 1 m", ROOF["1 x 1"], over, None, ROOM_POINTS),
            ("5.11 2 x 1, sky", "a sky of 12 x 12 m 4 m before the facade's opening of 2 x 1 m", FACADE["2 x 1"], before, None, DEEP_POINTS),
            ("5.13, sky", "the same sky before an open facade of 4 x 3 m, a black mask of 1 m over it", FACADE["4 x 3"], before, above, DEEP_POINTS),
            ("5.14, sky", "a sky of 16 x 12 m 8 m before an open facade, a black wall of 3 m height 6 m before it", FACADE["4 x 3"], far, opposite,
             DEEP_POINTS)):
        def build(scene, opening=opening, sky=sky, mask=mask):
            open_room(scene, opening)
            scene.light("sky", mesh(sky), grey(SKY))
            if mask is not None:
                scene.surface("mask", mesh(mask), BLACK)

        yield Scene(name, what, build,
                    [case(name, "E", where, lambda p, n, opening=opening, sky=sky, mask=mask: SKY * formulas.seen(p, n, sky, opening, mask))])


SKIPPED = (
    ("4.1 to 4.6", "The experimental cases compare with measurements of rooms and luminaires that are not free."),
    ("5.2, 5.3 asymmetrical", "Lights are Lambertian: there are no tables of intensity by direction."),
    ("5.5, 5.10, 5.12", "Panes let a share through that does not depend on the angle, so glass by direction has no counterpart."),
    ("5.9 to 5.14, CIE skies but the uniform one", "There is no sky whose radiance depends on direction; a uniform one is a luminous opening or plane."),
    ("5.11 to 5.14, externally reflected component", "Ground and masks are black here, so that what is left is a closed form."),
    ("6", "The additional cases ask for specular, glossy or spectral surfaces; every surface is Lambertian in three colours."),
)


def all_scenes():
    for family in (point_sources, area_sources, flux, reflection, obstruction, closed_cube, luminous_openings, skies_behind):
        yield from family()
