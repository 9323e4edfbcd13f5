#!/usr/bin/python3
"""Writes the scenes of the evaluation.

usage: tests/evaluation/scenes/generate.py FOLDER [--data DIR]

Writes one .glb per scene into FOLDER, and scenes.json: name, file, what it tests, cameras ("" is the view that the
server chooses), flags of `lpvctl session create` that belong to it, and the picture of its sky. With --data, statues are Stanford's Lucy and bunny from DIR/meshes, and the Cornell box and the living
room of DIR are listed too; without, a sphere with waves stands in for the statues. The same arguments write the same
bytes.
"""

import argparse
import json
import pathlib
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent))
import numpy as np  # noqa: E402

import gltf  # noqa: E402
from meshes import (box, flat, grid_quad, knot, lathe, panel_down, pot, quad, quad_uvs, read_ply, sphere, standing, tube,  # noqa: E402
                    turned)

ROOM = ((-2.5, 0.0, -2.0), (2.5, 3.0, 2.0))  # metres
CORNER_VIEW = {"eye": [1.9, 1.6, 2.6], "target": [-0.6, 0.8, -1.2], "fov": 60}
ROOM_VIEW = {"eye": [-2.2, 1.7, 1.75], "target": [1.0, 0.8, -0.9], "fov": 65}


def two_boxes(scene, data):
    scene.surface("floor", quad((0, 0, 0), (6, 0, 0), (0, 0, -6)))
    scene.surface("tall box", flat(box((-1.1, 0, -0.9), (-0.3, 1.4, -0.1))), (0.7, 0.3, 0.2))
    scene.surface("low box", flat(box((0.3, 0, 0.1), (1.2, 0.6, 0.9))), (0.2, 0.4, 0.7))
    scene.light("panel", panel_down((0, 2.5, 0), 1.0, 1.0), (12, 12, 12))


def lamp_over_floor(scene, data):
    scene.surface("floor", quad((0, 0, 0), (200, 0, 0), (0, 0, -200)))
    scene.light("lamp", panel_down((0, 3, 0), 0.2, 0.2), (500, 450, 400))


def furnished(scene):
    """Its walls are the content's bounds, on which a fitted grid would lie but for its free cells."""
    scene.surface("walls", flat(box(*ROOM, inward=True)), (0.7, 0.68, 0.62))
    scene.surface("table", flat(box((-0.2, 0.65, -1.0), (1.2, 0.72, 0.0))), (0.45, 0.3, 0.2))
    scene.surface("cupboard", flat(box((1.9, 0.0, -1.6), (2.45, 1.9, -0.4))), (0.3, 0.45, 0.5))
    scene.surface("ball", sphere((-1.2, 0.4, -1.0), 0.4), (0.8, 0.8, 0.8))


def room(count):
    def build(scene, data):
        furnished(scene)
        random = np.random.default_rng(20)
        colours = [(1, 1, 1), (1, 0.8, 0.6), (0.6, 0.8, 1), (1, 0.5, 0.4), (0.5, 1, 0.6)]
        power = 20.0 / count ** 0.5
        for i in range(count):
            colour = tuple(power * c for c in colours[i % len(colours)])
            size = 0.6 if count < 3 else 0.25
            if count < 3 or i % 2 == 0:
                few = {1: [(0.0, 0.0)], 2: [(-1.2, 0.6), (1.2, -0.6)]}
                x, z = few[count][i] if count in few else (random.uniform(-2, 2), random.uniform(-1.6, 1.6))
                scene.light(f"panel {i}", panel_down((x, 2.95, z), size, size), colour)
            else:
                x, y = random.uniform(-2, 1.6), random.uniform(1.0, 2.6)
                scene.light(f"sconce {i}", quad((x, y, -1.95), (size, 0, 0), (0, size, 0)), colour)
    return build


def picture(width=96, height=54):
    """What the television shows: bars, a bright disc, a dark half."""
    y, x = np.mgrid[0:height, 0:width] / np.array([height, width]).reshape(2, 1, 1)
    bars = np.stack([np.where(np.floor(7 * x).astype(int) >> bit & 1, 200, 30) for bit in range(3)], axis=-1)
    out = np.where((y < 0.5)[..., None], bars, 12)
    disc = (x - 0.75) ** 2 * (width / height) ** 2 + (y - 0.75) ** 2 < 0.03
    return np.where(disc[..., None], np.array([255, 240, 200]), out).astype(np.uint8)


def television(scene, data):
    furnished(scene)
    scene.light("screen", quad((-2.45, 1.3, 0.2), (0, 0, -1.6), (0, 0.9, 0)), (30, 30, 30), quad_uvs(), picture())


def boards(scene, data):
    """A floor and a wall of narrow boards, seen along both: far ones are many to a pixel, in one direction more than in
    the other."""
    wood = np.random.default_rng(7).uniform(0.35, 1.0, (16, 4)).repeat(8, axis=0).repeat(64, axis=1)
    wood[::8] = wood[:, ::64] = 0.08  # the joints
    picture = (255 * wood[..., None] * np.array([1.0, 0.85, 0.65])).astype(np.uint8)
    scene.surface("floor", quad((0, 0, -12), (8, 0, 0), (0, 0, -32)), (0.9, 0.9, 0.9), quad_uvs() * (8, 32), picture)
    scene.surface("wall", quad((-4, 1.5, -12), (0, 0, -32), (0, 3, 0)), (0.9, 0.9, 0.9), quad_uvs() * (32, 3), picture)
    for i in range(4):
        scene.light(f"panel {i}", panel_down((0, 3, -8 * i), 2.0, 2.0), (10, 10, 10))


def thin_tube(scene, data):
    scene.surface("floor", quad((0, 0, 0), (14, 0, 0), (0, 0, -6)))
    scene.surface("wall", quad((0, 2, -3), (14, 0, 0), (0, 4, 0)))
    scene.light("tube", tube((-5, 1.5, -1.2), (5, 1.5, -1.2), 0.004), (400, 400, 400))


def statue_of(data, name="lucy"):
    files = {"lucy": "stanford_lucy_33446.ply", "bunny": "stanford_bunny_69451.ply"}
    path = data / "meshes" / files[name] if data else None
    if path is None or not path.exists():
        return sphere((0, 0, 0), 1.0, 96, 64, wave=0.2)
    return read_ply(path)


def statue(foot):
    def build(scene, data):
        scene.surface("floor", quad((0, 0, 0), (4, 0, 0), (0, 0, -4)))
        scene.surface("back wall", quad((0, 1.5, -2), (4, 0, 0), (0, 3, 0)))
        scene.surface("side wall", quad((-2, 1.5, 0), (0, 0, -4), (0, 3, 0)))
        scene.light("statue", standing(statue_of(data, "bunny"), foot, 1.0), (4, 4, 3.5))
    return build


def beside_walls(mesh_of):
    """A light that hides much of itself, above a floor and between two walls."""
    def build(scene, data):
        scene.surface("floor", quad((0, 0, 0), (4, 0, 0), (0, 0, -4)))
        scene.surface("back wall", quad((0, 1.5, -2), (4, 0, 0), (0, 3, 0)))
        scene.surface("side wall", quad((-2, 1.5, 0), (0, 0, -4), (0, 3, 0)))
        scene.light("light", standing(mesh_of(data), (-0.6, 0.4, -0.8), 1.2), (4, 4, 3.5))
    return build


def chair(scene, data):
    """Thin things: legs of 3 cm, a back of rods, a grille of bars of 5 cm before the light of a window."""
    scene.surface("walls", flat(box(*ROOM, inward=True)), (0.7, 0.68, 0.62))
    wood = (0.45, 0.3, 0.2)
    for i, (x, z) in enumerate(((0.0, 0.0), (0.45, 0.0), (0.0, -0.45), (0.45, -0.45))):
        scene.surface(f"leg {i}", flat(box((x, 0.0, z - 0.03), (x + 0.03, 0.45, z))), wood)
    scene.surface("seat", flat(box((0.0, 0.45, -0.48), (0.48, 0.48, 0.0))), wood)
    for i in range(5):
        scene.surface(f"rod {i}", flat(box((0.02 + 0.1 * i, 0.48, -0.47), (0.04 + 0.1 * i, 0.95, -0.45))), wood)
    for i in range(7):
        scene.surface(f"bar {i}", flat(box((-2.3, 0.6, -0.95 + 0.2 * i), (-2.25, 2.4, -0.9 + 0.2 * i))), (0.3, 0.3, 0.3))
    scene.light("window", quad((-2.49, 1.5, -0.3), (0, 0, -1.2), (0, 1.6, 0)), (8, 9, 10))
    scene.light("lamp", panel_down((0.8, 2.9, 0.4), 0.4, 0.4), (20, 18, 15))


def hall(scene, data):
    scene.surface("walls", flat(box((-10, 0, -2.5), (10, 5, 2.5), inward=True)), (0.6, 0.6, 0.58))
    for i, x in enumerate((-7.5, -2.5, 2.5, 7.5)):
        scene.surface(f"pillar {i}", flat(box((x - 0.25, 0, -1.9), (x + 0.25, 5, -1.4))), (0.5, 0.4, 0.35))
    for i, (x, z, colour) in enumerate(((-5, 1.2, (6, 4, 2)), (0.5, -1.7, (2, 4, 6)), (5.5, 0.8, (5, 5, 5)))):
        scene.light(f"statue {i}", standing(statue_of(data), (x, 0.02, z), 1.8), colour)


def corridor(two_sided):
    """12 m, four discs 2 cm below the ceiling that shine at it, or down as well: what is above a disc is seen by it alone."""
    def build(scene, data):
        scene.surface("walls", flat(box((-6, 0, -0.8), (6, 2.4, 0.8), inward=True)), (0.75, 0.75, 0.72))
        for i in range(5):
            x = -5 + 2.2 * i
            scene.surface(f"frame {i}", flat(box((x, 0, -0.8), (x + 0.1, 2.1, -0.7))), (0.4, 0.3, 0.2))
        for i in range(4):
            disc = lathe([(0.15, 0.0), (1e-4, 0.0)], 24, (-4.5 + 3 * i, 2.38, 0.0))
            scene.light(f"disc {i}", disc, (30, 28, 25), two_sided=two_sided)
    return build


def bulbs(scene, data):
    """Sixteen of them on a ring."""
    furnished(scene)
    for i in range(16):
        angle = 2 * np.pi * i / 16
        scene.light(f"bulb {i}", sphere((0.5 + 0.35 * np.cos(angle), 1.9, -0.5 + 0.35 * np.sin(angle)), 0.03, 16, 8), (60, 55, 45))
    scene.surface("ring", lathe([(0.33, 1.84), (0.37, 1.84), (0.37, 1.86), (0.33, 1.86), (0.33, 1.84)], 32, (0.5, 0, -0.5)), (0.6, 0.5, 0.2))
    scene.surface("stem", tube((0.5, 1.85, -0.5), (0.5, 3.0, -0.5), 0.02), (0.2, 0.2, 0.2))


def desk_lamp(scene, data):
    """A bulb in a shade."""
    furnished(scene)
    scene.surface("shade", lathe([(0.16, 0.0), (0.06, 0.16)], 32, (0.6, 1.1, -0.5)), (0.8, 0.75, 0.6))
    scene.surface("foot", flat(box((0.54, 0.72, -0.56), (0.66, 0.75, -0.44))), (0.2, 0.2, 0.2))
    scene.surface("stem", tube((0.6, 0.75, -0.5), (0.6, 1.12, -0.5), 0.02), (0.2, 0.2, 0.2))
    scene.light("bulb", sphere((0.6, 1.18, -0.5), 0.035, 24, 12), (400, 360, 280))


def refrigerator(scene, data):
    """Ajar, and lit inside."""
    furnished(scene)
    for name, low, high in (("back", (-2.48, 0, -1.9), (-2.42, 1.8, -1.2)), ("left", (-2.48, 0, -1.9), (-1.9, 1.8, -1.86)),
                            ("right", (-2.48, 0, -1.24), (-1.9, 1.8, -1.2)), ("top", (-2.48, 1.76, -1.9), (-1.9, 1.8, -1.2)),
                            ("bottom", (-2.48, 0, -1.9), (-1.9, 0.06, -1.2)), ("low shelf", (-2.42, 0.6, -1.86), (-1.95, 0.62, -1.24)),
                            ("high shelf", (-2.42, 1.1, -1.86), (-1.95, 1.12, -1.24))):
        scene.surface(name, flat(box(low, high)), (0.85, 0.85, 0.85))
    door = turned(box((-1.9, 0, -1.24), (-1.86, 1.8, -0.55)), 30, (-1.9, 0, -1.24))
    scene.surface("door", flat(door), (0.85, 0.85, 0.85))
    scene.surface("jar", sphere((-2.15, 0.7, -1.5), 0.08, 24, 12), (0.6, 0.2, 0.2))
    scene.light("lamp", panel_down((-2.2, 1.755, -1.55), 0.15, 0.1), (200, 200, 190))


def door_ajar(scene, data):
    """A dark room beside a lit one."""
    scene.surface("walls", flat(box((-4, 0, -2), (4, 2.6, 2), inward=True)), (0.7, 0.68, 0.62))
    for name, low, high in (("left of the door", (-0.06, 0, -2), (0.06, 2.6, -0.45)), ("right of it", (-0.06, 0, 0.45), (0.06, 2.6, 2)),
                            ("above it", (-0.06, 2.05, -0.45), (0.06, 2.6, 0.45))):
        scene.surface(name, flat(box(low, high)), (0.7, 0.68, 0.62))
    leaf = turned(box((-0.02, 0.005, -0.44), (0.02, 2.04, 0.44)), 35, (0, 0, -0.44))
    scene.surface("leaf", flat(leaf), (0.5, 0.35, 0.2))
    scene.surface("chest", flat(box((-3.9, 0, -1.9), (-3.4, 1.0, -0.5))), (0.3, 0.4, 0.5))
    scene.surface("stool", flat(box((-1.6, 0, 0.2), (-1.2, 0.5, 0.6))), (0.6, 0.3, 0.3))
    scene.light("lamp", panel_down((2.2, 2.55, 0.3), 0.6, 0.6), (30, 28, 24))


def tessellated(n):
    def build(scene, data):
        scene.surface("floor", quad((0, 0, 0), (4, 0, 0), (0, 0, -4)))
        scene.surface("wall", quad((0, 1.25, -2), (4, 0, 0), (0, 2.5, 0)), (0.6, 0.6, 0.7))
        scene.light("panel", grid_quad((0, 1.2, 0), (1.4, 0, 0), (0, -0.3, 1.0), n), (5, 5, 5))
    return build


ROUGHNESSES = (0.0, 0.1, 0.3, 0.6, 1.0)


def strips(scene):
    """A floor in strips, metal on the left, black dielectric on the right, from smooth to rough; what stands behind it is
    in all of them. Black and rough is matte, so that strip is nearly as rough."""
    for row, roughness in enumerate(ROUGHNESSES):
        z = 1.0 - 0.5 * row
        scene.surface(f"metal {roughness}", quad((-0.8, 0, z), (1.6, 0, 0), (0, 0, -0.5)), (0.9, 0.9, 0.9),
                      roughness=roughness, metalness=1.0)
        scene.surface(f"dielectric {roughness}", quad((0.8, 0, z), (1.6, 0, 0), (0, 0, -0.5)), (0.0, 0.0, 0.0),
                      roughness=min(roughness, 0.99))


def gloss_quad(scene, data):
    strips(scene)
    scene.light("panel", quad((0, 0.65, -1.6), (2.4, 0, 0), (0, 1.2, 0)), (5, 5, 5))


def gloss_screen(scene, data):
    strips(scene)
    scene.light("screen", quad((0, 0.7, -1.6), (2.4, 0, 0), (0, 1.35, 0)), (10, 10, 10), quad_uvs(), picture())


def gloss_statue(scene, data):
    strips(scene)
    scene.light("statue", standing(statue_of(data), (0, 0.05, -1.6), 1.3), (4, 4, 4))


def gloss_ball(roughness):
    """A metal ball in a box of 2 m with a red, a green and a white side, under a lamp."""
    def build(scene, data):
        scene.surface("floor", quad((0, 0, 0), (2, 0, 0), (0, 0, -2)), (0.73, 0.73, 0.73))
        scene.surface("ceiling", quad((0, 2, 0), (2, 0, 0), (0, 0, 2)), (0.73, 0.73, 0.73))
        scene.surface("back", quad((0, 1, -1), (2, 0, 0), (0, 2, 0)), (0.73, 0.73, 0.73))
        scene.surface("left", quad((-1, 1, 0), (0, 0, -2), (0, 2, 0)), (0.65, 0.06, 0.05))
        scene.surface("right", quad((1, 1, 0), (0, 0, 2), (0, 2, 0)), (0.12, 0.45, 0.09))
        centre, radius = np.array((0.25, 0.5, -0.1)), 0.45
        ball = sphere(tuple(centre), radius, 64, 32)
        normals = (np.asarray(ball[0]) - centre) / radius
        scene.surface("ball", ball, (0.9, 0.85, 0.7), roughness=roughness, metalness=1.0, normals=normals)
        scene.light("lamp", panel_down((0, 1.98, 0), 0.6, 0.6), (14, 13, 11))
    return build


def daylit(scene, data):
    """A room with a window of 1.8 x 1.5 m in its left wall, in which nothing glows."""
    walls, (x0, y0, z0), (x1, y1, z1) = (0.7, 0.68, 0.62), *ROOM
    left, right, sill, top = 0.7, -1.1, 0.8, 2.3  # of the window: along z, along y
    scene.surface("floor", quad((0, y0, 0), (x1 - x0, 0, 0), (0, 0, z0 - z1)), (0.5, 0.4, 0.3))
    scene.surface("ceiling", quad((0, y1, 0), (x1 - x0, 0, 0), (0, 0, z1 - z0)), (0.8, 0.8, 0.8))
    scene.surface("back", quad((0, y1 / 2, z0), (x1 - x0, 0, 0), (0, y1, 0)), walls)
    scene.surface("front", quad((0, y1 / 2, z1), (x0 - x1, 0, 0), (0, y1, 0)), walls)
    scene.surface("right", quad((x1, y1 / 2, 0), (0, 0, z1 - z0), (0, y1, 0)), walls)
    for name, near, far, low, high in (("beside", z1, left, y0, y1), ("beyond", right, z0, y0, y1), ("below", left, right, y0, sill),
                                       ("above", left, right, top, y1)):
        # Walls are .2 m thick, so that the window has a reveal.
        scene.surface(f"wall {name}", flat(box((x0 - 0.2, low, far), (x0, high, near))), walls)
    scene.surface("table", flat(box((-0.9, 0.65, -1.0), (0.5, 0.72, 0.0))), (0.45, 0.3, 0.2))
    scene.surface("cupboard", flat(box((1.9, 0.0, -1.6), (2.45, 1.9, -0.4))), (0.3, 0.45, 0.5))
    scene.surface("ball", sphere((0.6, 0.4, -1.2), 0.4), (0.8, 0.8, 0.8))


def sky_picture(sun, width=512):
    """An equirectangular sky over a meadow, its middle towards +x: blue, brighter towards the horizon, and with a sun of 3
    degrees at 30 degrees above -x, from which a plane that faces it gets about as much as from all of the sky."""
    height = width // 2
    v, u = np.mgrid[0:height, 0:width] + 0.5
    azimuth, polar = 2 * np.pi * (u / width - 0.5), np.pi * v / height
    towards = np.stack([np.sin(polar) * np.cos(azimuth), np.cos(polar), np.sin(polar) * np.sin(azimuth)], axis=-1)
    high = np.clip(towards[..., 1:2], 0, 1)
    blue, haze, meadow = np.array([1.6, 3.2, 7.0]), np.array([6.0, 6.4, 6.8]), np.array([0.5, 0.7, 0.3])
    out = np.where(towards[..., 1:2] > 0, haze + (blue - haze) * np.sqrt(high), meadow)
    at = np.array([-np.cos(np.radians(30.0)) * np.cos(0.3), np.sin(np.radians(30.0)), np.cos(np.radians(30.0)) * np.sin(0.3)])
    disc = (towards @ at > np.cos(np.radians(1.5)))[..., None]
    return np.where(disc & sun, np.array([9000.0, 8000.0, 6500.0]), out)


SKIES = {"daylight": True, "overcast": False}  # scenes: whether there is a sun

STRIPS_VIEW = {"eye": [0.0, 0.9, 3.0], "target": [0.0, 0.1, -0.1], "fov": 45}
DAYLIT_VIEW = {"eye": [2.2, 1.7, 1.75], "target": [-1.2, 0.7, -0.9], "fov": 65}
CORRIDOR_VIEW = {"eye": [-5.7, 1.6, 0.4], "target": [0, 1.0, -0.1], "fov": 65}
BALL_VIEW = {"eye": [0.0, 1.0, 3.4], "target": [0.0, 1.0, 0.0], "fov": 42}

SCENES = {
    "two_boxes": (two_boxes, "shadows of two boxes on a floor under a square",
                  {"": None, "near": {"eye": [2.6, 2.0, 3.2], "target": [0, 0.4, 0], "fov": 50}}),
    "lamp_over_floor": (lamp_over_floor, "a lamp of .2 m over a floor of 200 m",
                        {"": None, "near": {"eye": [0, 4, 9], "target": [0, 0.5, 0], "fov": 50}}),
    "room_1": (room(1), "walls on the bounds, one light", {"view": ROOM_VIEW}),
    "room_2": (room(2), "walls on the bounds, two lights", {"view": ROOM_VIEW}),
    "room_8": (room(8), "walls on the bounds, eight lights", {"view": ROOM_VIEW}),
    "room_20": (room(20), "walls on the bounds, twenty lights", {"view": ROOM_VIEW}),
    "room_64": (room(64), "walls on the bounds, 64 lights", {"view": ROOM_VIEW}),
    "television": (television, "a textured screen in a room", {"view": {"eye": [2.3, 1.7, 1.75], "target": [-1.5, 0.8, -0.8], "fov": 65}}),
    "thin_tube": (thin_tube, "a tube of 10 m and 4 mm", {"view": {"eye": [0, 2.5, 5.5], "target": [0, 1.0, -2], "fov": 60}}),
    "statue_near_wall": (statue((0.3, 0.001, -1.5)), "a statue that glows near a wall",
                         {"view": {"eye": [1.9, 1.6, 2.6], "target": [-0.3, 0.6, -1.2], "fov": 50}}),
    "statue_in_corner": (statue((-1.5, 0.001, -1.5)), "a statue that glows in a corner",
                         {"view": {"eye": [1.9, 1.6, 2.6], "target": [-0.6, 0.6, -1.2], "fov": 50}}),
    "statue_half_outside": (statue((1.0, 0.001, -1.0)), "a statue across the grid's bounds",
                            {"view": {"eye": [0.6, 1.6, 3.2], "target": [0.2, 0.6, -1.2], "fov": 50}}),
    "knot": (beside_walls(lambda data: knot()), "a light that folds over itself, beside walls", {"view": CORNER_VIEW}),
    "pot": (beside_walls(lambda data: pot()), "a vessel with two walls that glows", {"view": CORNER_VIEW}),
    "lucy": (beside_walls(statue_of), "Lucy, glowing, beside walls", {"view": CORNER_VIEW}),
    "chair": (chair, "a chair's legs and rods, a grille before a window", {"view": ROOM_VIEW}),
    "hall": (hall, "a hall of 4:1:1 with three statues that glow", {"view": {"eye": [-9.7, 2.2, 1.9], "target": [2, 1.2, -0.6], "fov": 65}}),
    "corridor": (corridor(True), "lamps of both sides close below a ceiling", {"view": CORRIDOR_VIEW}),
    "uplights": (corridor(False), "lamps that shine at a ceiling close to them", {"view": CORRIDOR_VIEW}),
    "bulbs": (bulbs, "sixteen bulbs on a ring", {"view": ROOM_VIEW}),
    "desk_lamp": (desk_lamp, "a bulb in a shade", {"view": ROOM_VIEW}),
    "refrigerator": (refrigerator, "a refrigerator ajar, lit inside", {"view": {"eye": [1.8, 1.7, 1.7], "target": [-1.5, 0.8, -1.2], "fov": 65}}),
    "door_ajar": (door_ajar, "a dark room beside a lit one", {"view": {"eye": [-3.7, 1.6, 1.6], "target": [-0.6, 0.8, -0.4], "fov": 65}}),
    "gloss_quad": (gloss_quad, "glossy strips before a square", {"view": STRIPS_VIEW}),
    "gloss_screen": (gloss_screen, "the same before a textured screen", {"view": STRIPS_VIEW}),
    "gloss_statue": (gloss_statue, "the same before Lucy, glowing", {"view": STRIPS_VIEW}),
    "gloss_ball_0": (gloss_ball(0.0), "a mirror of a ball in a box", {"view": BALL_VIEW}),
    "gloss_ball_3": (gloss_ball(0.3), "the same of roughness .3", {"view": BALL_VIEW}),
    "gloss_ball_6": (gloss_ball(0.6), "the same of roughness .6", {"view": BALL_VIEW}),
    "boards": (boards, "narrow boards, seen along them", {"view": {"eye": [0.5, 0.6, 3.5], "target": [-0.6, 0.4, -20], "fov": 45}}),
    "daylight": (daylit, "a room with a window, the sun in it", {"view": DAYLIT_VIEW}),
    "overcast": (daylit, "the same by the sky alone", {"view": DAYLIT_VIEW}),
    "quad_2": (tessellated(1), "a square of 2 triangles", {"": None}),
    "quad_200": (tessellated(10), "the same of 200", {"": None}),
    "quad_20000": (tessellated(100), "the same of 20,000", {"": None}),
}
FLAGS = {"statue_half_outside": "--bounds=-2,0,-2,1,3,2",
         **{name: "--gloss on" for name in SCENES if name.startswith("gloss_")}}  # of `lpvctl session create`
FILES = {  # of --data
    "cornell_box": ("cornell_box/CornellBox-Original.obj", "the Cornell box", {"": None}),
    "living_room": ("scenes/living_room.glb", "a furnished room, windows as lights",
                    {"": None, "bay": {"eye": [-1.6, 1.6, 7.2], "target": [0.5, 0.95, 2], "fov": 52}}),
}


def write_hdr(path, picture):
    """Linear (height, width, 3) as Radiance's RGBE, without runs."""
    largest = picture.max(axis=-1, keepdims=True)
    mantissa, exponent = np.frexp(np.maximum(largest, 1e-30))
    colours = picture * (mantissa * 256 / np.maximum(largest, 1e-30))
    texels = np.concatenate([np.minimum(colours, 255), exponent + 128], axis=-1).astype(np.uint8)
    height, width = picture.shape[:2]
    path.write_bytes(f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n".encode() + texels.tobytes())


def generate(folder, data=None):
    """The rows of scenes.json, of which every file has been written."""
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for name, (build, what, cameras) in SCENES.items():
        scene = gltf.Scene()
        build(scene, data)
        scene.write(folder / f"{name}.glb")
        rows.append({"name": name, "file": f"{name}.glb", "what": what, "cameras": cameras,
                     "flags": FLAGS.get(name, "")})
        if name in SKIES:
            rows[-1]["sky"] = f"{name}.hdr"
            write_hdr(folder / rows[-1]["sky"], sky_picture(SKIES[name]))
    for name, (file, what, cameras) in FILES.items() if data else ():
        if (data / file).exists():
            rows.append({"name": name, "file": str((data / file).resolve()), "what": what, "cameras": cameras,
                         "flags": ""})
    (folder / "scenes.json").write_text(json.dumps(rows, indent=1) + "\n")
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--data", type=pathlib.Path)
    options = parser.parse_args()
    for row in generate(options.folder, options.data):
        print(f"{row['name']:18} {row['what']}")


if __name__ == "__main__":
    main()
