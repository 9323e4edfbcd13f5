"""Light that surfaces reflect: 5.6 one surface, 5.7 one surface behind an obstruction, 5.8 a closed cube."""

import math

import numpy as np

import cube
import formulas
import meshes
from case import (BLACK, DEPTHS, TO_X, TO_Y, TO_Z, WALL_HEIGHTS, Case, Scene, at, ball, case, floor_points, grey, inside, joined, mesh, rectangle,
                  wall_points)

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


def one_surface():
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

    corners = meshes.box(*BOX)[0]
    where = joined(wall_points(), floor_points(DEPTHS[:5]))
    what = "a wall of 4 x 3 m at y = 4, lit alone; a black box of 4 x .2 x 1 m at y = 2.5; points at y = 0 and on the floor"
    finer = "; one-sided surfaces, --quality accurate: four times as many patches"
    for name, more, one_sided, flags in (("5.7", "", False, ""), ("5.7 accurate", finer, True, " --quality accurate")):
        def build(scene, one_sided=one_sided):
            scene.surface("S2", mesh(quad), grey(0.6), one_sided=one_sided)
            scene.surface("box", meshes.flat(meshes.box(*BOX)), BLACK, one_sided=one_sided)
            scene.light("lamp", mesh(lamp), grey(radiance))

        yield Scene(name, what + more, build,
                    [case(name, "E / (E_v rho), %", where, lambda p, n: formulas.reflected(p, n, quad, 0.6, got, 8, corners))],
                    0.6, 1, flags="--bounds=-1,-1,-1,5,5,4" + flags)


REFLECTANCES = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95)
MOST_BOUNCES = 32  # of `lpvctl session create`
CUBE = ((0, 0, 0), (4, 4, 4))


MIDDLE = np.array([2.0, 2, 2])


def cube_points():
    """Points .5 m apart on all six walls and normals inwards; those of the first wall, z = 0, alone."""
    wall = np.array([(x, y, 0) for y in DEPTHS for x in DEPTHS])
    both = np.concatenate([wall, wall * (1, 1, 0) + (0, 0, 4)])
    facing = np.repeat([TO_Z, -TO_Z], len(wall), axis=0)
    return tuple(np.concatenate([np.roll(v, shift, axis=1) for shift in range(3)]) for v in (both, facing)) + (wall,)


def closed_cube():
    """5.8. The mean is that of the flux, whatever the lamp."""
    gauss = inside(CUBE, 12)
    points, normals, wall = cube_points()
    what = "a closed cube of 4 m, a sphere of 4 cm and 10 kW in its middle"
    for reflectance in REFLECTANCES:
        name = f"5.8 rho {reflectance:g}"
        each = np.tile(cube.irradiances(wall, 4.0, 10000, reflectance, MOST_BOUNCES), 6)
        cases = [*means(name, gauss, reflectance), Case(name, f"E, {MOST_BOUNCES} bounces", [], points, normals, each)]
        yield Scene(name, what + "; 12 x 12 Gauss points for means, 8 x 8 even points, on each wall", cube_with_lamp(MIDDLE, reflectance),
                    cases, reflectance, MOST_BOUNCES)
    for reflectance in (0.9, 0.95):
        name = f"5.8 rho {reflectance:g} about 0"
        yield Scene(name, "the same with the middle at the origin, where single precision is finer", cube_with_lamp(0 * MIDDLE, reflectance),
                    means(name, (gauss[0] - MIDDLE, *gauss[1:]), reflectance), reflectance, MOST_BOUNCES)


def means(name, gauss, reflectance):
    points, normals, weights = gauss
    return [Case(name, says, [], points, normals, 10000 / 96 * formulas.series(reflectance, bounces), weights / 96)
            for says, bounces in (("mean E, all bounces", None), (f"mean E, {MOST_BOUNCES} bounces", MOST_BOUNCES))]


def cube_with_lamp(middle, reflectance):
    def build(scene):
        scene.surface("cube", meshes.flat(meshes.box(middle - 2, middle + 2, inward=True)), grey(reflectance))
        lamp, radiance = ball(middle, 0.02, 10000)
        scene.light("lamp", lamp, grey(radiance))
    return build
