#!/usr/bin/python3
"""Tests of the formulas and cases of cie171. usage: tests/evaluation/cie171_test.py

Closed forms are compared with sums over small pieces, which know nothing of edges, horizons or outlines.
"""

import math
import pathlib
import sys
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "scenes"), str(HERE / "cie")]
import numpy as np  # noqa: E402

import case  # noqa: E402
import cases  # noqa: E402
import cube  # noqa: E402
import direct  # noqa: E402
import formulas  # noqa: E402
import openings  # noqa: E402
import reflection  # noqa: E402
import report  # noqa: E402
import results  # noqa: E402

TO_X, TO_Y, TO_Z = np.eye(3)


def samples(quad, n):
    """Middles of n x n pieces of a parallelogram, and the area of one."""
    s = (np.arange(n) + 0.5) / n
    u, v = (x.reshape(-1, 1) for x in np.meshgrid(s, s))
    return quad[0] + u * (quad[1] - quad[0]) + v * (quad[3] - quad[0]), formulas.area_of(quad) / n ** 2


def kernel(receiver, normal, points, front):
    """cos cos / d^2 of points that emit to the side of `front`."""
    d = points - receiver
    square = np.sum(d * d, axis=1)
    return np.maximum(d @ normal, 0) * np.maximum(-(d @ front), 0) / square ** 2


def summed(receiver, normal, quad, n=800, visible=None):
    """Irradiance of a parallelogram of radiance 1 by its pieces' middles; `visible`: of them, true or false."""
    points, area = samples(quad, n)
    weights = kernel(receiver, normal, points, formulas.normal_of(quad))
    return float(np.sum(weights if visible is None else weights * visible(points)) * area)


def passes(receiver, points, opening):
    """Whether the way to each point goes through a parallelogram."""
    normal = formulas.normal_of(opening)
    t = ((opening[0] - receiver) @ normal) / ((points - receiver) @ normal)
    at = receiver + t[:, None] * (points - receiver) - opening[0]
    u, v = opening[1] - opening[0], opening[3] - opening[0]
    return (t > 0) & (t < 1) & (at @ u >= 0) & (at @ u <= u @ u) & (at @ v >= 0) & (at @ v <= v @ v)


def meets_box(receiver, points, low, high):
    """Whether the way to each point meets a box."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.stack([(np.asarray(end, float) - receiver) / (points - receiver) for end in (low, high)])
    near, far = ends.min(axis=0).max(axis=1), ends.max(axis=0).min(axis=1)
    return (near < far) & (far > 0) & (near < 1)


class Recorder:
    """Stands in for a gltf.Scene: the vertices of what was added."""

    def __init__(self):
        self.surfaces, self.lights = {}, []

    def surface(self, name, mesh, *_, **__):
        self.surfaces[name] = mesh[0]

    def light(self, name, mesh, *_):
        self.lights.append(mesh[0])


class Polygons(unittest.TestCase):
    # Broken by: the factor 1/2 left out.
    def test_the_unit_square_is_that_of_the_worked_numbers(self):
        square = case.rectangle((-0.5, -0.5, 1), (0, 1, 0), (1, 0, 0))
        self.assertAlmostEqual(formulas.irradiance(np.zeros(3), TO_Z, square), 0.7522746884541, 12)

    # Broken by: no cut at the horizon; the back sending, too.
    def test_polygons_are_what_their_pieces_sum_to(self):
        quad = case.rectangle((0.3, -0.4, 1.1), (-0.2, 1.2, 0.3), (0.9, 0.1, 0.4))
        receiver = np.array([0.4, 0.1, 0.0])
        for normal in ((0, 0, 1), (0.6, 0, 0.8), (0, -0.8, 0.6), (1, 0, 0), (0, 1, 0), (0, 0, -1)):
            normal = np.array(normal, float)
            self.assertAlmostEqual(formulas.irradiance(receiver, normal, quad), summed(receiver, normal, quad), 4)
            self.assertEqual(formulas.irradiance(receiver, normal, quad[::-1]), 0)

    # Broken by: planes turned to the wrong side for openings that are wound the other way.
    def test_through_an_opening_is_what_its_ways_sum_to(self):
        sky = case.rectangle((-2, -2, 5), (0, 8, 0), (8, 0, 0))
        for opening in (case.PANEL, case.PANEL[::-1]):
            for receiver, normal in (((2, 0.25, 0), TO_Z), ((2, 0, 1.25), TO_Y), ((1.2, 3.1, 0.4), TO_Z)):
                receiver = np.array(receiver, float)
                brute = summed(receiver, normal, sky, 1500, lambda p: passes(receiver, p, opening))
                self.assertAlmostEqual(formulas.seen(receiver, normal, sky, opening) / brute, 1, 2)

    # Through an opening that a large sky fills, the opening is what is seen. Broken by: a sky that is not cut.
    def test_an_opening_that_is_filled_is_luminous(self):
        sky = case.rectangle((-98, -98, 5), (0, 200, 0), (200, 0, 0))
        for receiver, normal in (((2, 0.25, 0), TO_Z), ((2, 0, 1.25), TO_Y)):
            receiver = np.array(receiver, float)
            self.assertAlmostEqual(formulas.seen(receiver, normal, sky, case.PANEL), formulas.irradiance(receiver, normal, case.PANEL), 12)

    # Broken by: what is hidden added instead of taken away.
    def test_a_mask_hides_what_its_ways_sum_to(self):
        sky = case.rectangle((-4, -4, 0), (0, 0, 12), (12, 0, 0))
        mask = case.rectangle((-8, -1, 3), (20, 0, 0), (0, 1, 0))
        opening = openings.FACADE["4 x 3"]
        for y in (0.75, 2.25):
            receiver = np.array([2, y, 0])
            brute = summed(receiver, TO_Z, sky, 1000, lambda p: passes(receiver, p, opening) & ~passes(receiver, p, mask))
            self.assertAlmostEqual(formulas.seen(receiver, TO_Z, sky, opening, mask) / brute, 1, 2)

    # Broken by: a triangle left out.
    def test_moments_are_integrals_over_directions(self):
        quad = case.rectangle((0.3, -0.4, 0.3), (-0.2, 1.2, 0.1), (0.9, 0.1, 0.2))
        receiver = np.array([0.5, 0.1, 0.0])
        points, area = samples(quad, 800)
        d = points - receiver
        r = np.linalg.norm(d, axis=1)
        solid = np.maximum(-(d @ formulas.normal_of(quad)), 0) / r ** 3 * area
        fluence, vector = formulas.moments(receiver, quad)
        self.assertAlmostEqual(fluence, solid.sum(), 4)
        np.testing.assert_allclose(vector, (solid / r) @ d, atol=1e-4)

    # MATHS.md 8, Lookup. Broken by: the branch of broad light for all.
    def test_cap_is_that_of_the_worked_numbers(self):
        for share, degrees, value in ((0.75, 0, 0.75), (0.75, 60, 0.41961222745), (0.75, 90, 0.19550110948), (0.75, 120, 0.04461222745), (0.3, 0, 0.4)):
            normal = np.array([math.sin(math.radians(degrees)), 0, math.cos(math.radians(degrees))])
            self.assertAlmostEqual(formulas.cap_lookup(1.0, share * TO_Z, normal), value, 10)


class Sources(unittest.TestCase):
    # Broken by: the square of the distance for its cube.
    def test_a_small_square_is_a_lambertian_point(self):
        receivers = np.array([[0, 0, 0], [1.5, 1, 0], [1.5, 1.5, 0.0]])
        normals = np.broadcast_to(TO_Z, receivers.shape)
        square = case.rectangle((-0.005, -0.005, 3), (0, 0.01, 0), (0.01, 0, 0))
        point = formulas.lambertian_point(receivers, normals, (0, 0, 3), -TO_Z, 0.01 ** 2)
        for receiver, expected in zip(receivers, point):
            self.assertAlmostEqual(formulas.irradiance(receiver, TO_Z, square) / expected, 1, 5)

    # The sphere's triangles sum to the point that it stands for. Broken by: pi left out of its radiance.
    def test_a_small_sphere_is_an_isotropic_point(self):
        (vertices, triangles), radiance = case.ball((0, 0, 3), 0.02, 4 * math.pi)
        for receiver in np.array([[0, 0, 0], [1.0, 0.5, 0], [1.5, 1.5, 0]]):
            ours = radiance * sum(formulas.irradiance(receiver, TO_Z, vertices[t]) for t in triangles)
            expected = formulas.point_source(receiver[None], TO_Z[None], (0, 0, 3), 1.0)[0]
            self.assertLess(abs(ours / expected - 1), 0.002)

    # Broken by: u along the other edge; a picture upside down.
    def test_a_texture_lies_as_the_uvs_of_the_quad_say(self):
        texels = direct.linear(direct.PICTURE[..., 0])
        uvs = direct.meshes.quad_uvs()
        for receiver, normal in ((np.array([2, 0.25, 0]), TO_Z), (np.array([0.5, 3.75, 0]), TO_Z), (np.array([2, 0, 1.25]), TO_Y)):
            s = (np.arange(600) + 0.5) / 600
            a, b = (x.reshape(-1, 1) for x in np.meshgrid(s, s))
            points = case.PANEL[0] + a * (case.PANEL[1] - case.PANEL[0]) + b * (case.PANEL[3] - case.PANEL[0])
            uv = uvs[0] + a * (uvs[1] - uvs[0]) + b * (uvs[3] - uvs[0])
            brute = 1000 * kernel(receiver, normal, points, -TO_Z) @ formulas.bilinear(texels, uv[:, 0], uv[:, 1]) / 600 ** 2
            self.assertAlmostEqual(direct.textured_panel(receiver, normal) / brute, 1, 4)

    # A texel has its value in its middle and the mean of two on the border between, across the repeat too.
    # Broken by: texels at their corners.
    def test_bilinear_textures_repeat(self):
        texels = np.array([[1.0, 3.0], [5.0, 7.0]])
        at = formulas.bilinear(texels, np.array([0.25, 0.75, 0.5, 0.0]), np.array([0.25, 0.75, 0.25, 0.25]))
        np.testing.assert_allclose(at, [1, 7, 2, 2])


class Reflection(unittest.TestCase):
    # Broken by: the part of the floor behind the wall's points kept; the reflectance not divided by pi.
    def test_a_lit_floor_is_what_its_pieces_sum_to(self):
        quad = case.rectangle((0, -1, 0), (4, 0, 0), (0, 5, 0))
        got = lambda p: 100 + 7 * p[:, 0] - 3 * p[:, 1]
        for receiver, normal in ((np.array([2, 0, 0.75]), TO_Y), (np.array([2, 0.25, 3]), -TO_Z)):
            points, area = samples(quad, 1000)
            brute = 0.3 / math.pi * area * kernel(receiver, normal, points, TO_Z) @ got(points)
            self.assertAlmostEqual(formulas.reflected(receiver, normal, quad, 0.3, got, 64) / brute, 1, 4)

    # Broken by: the outline of the box's near face alone; one that leaves corners out.
    def test_a_box_hides_what_its_ways_sum_to(self):
        quad = case.rectangle((0, 4, 0), (4, 0, 0), (0, 0, 3))
        got = lambda p: 100 + 0 * p[:, 0]
        corners = case.meshes.box(*reflection.BOX)[0]
        points, area = samples(quad, 1000)
        for receiver, normal in ((np.array([2, 0, 1.75]), TO_Y), (np.array([1.3, 0, 0.25]), TO_Y), (np.array([2, 0.75, 0]), TO_Z)):
            clear = ~meets_box(receiver, points, *reflection.BOX)
            brute = 0.6 / math.pi * area * 100 * np.sum(kernel(receiver, normal, points, -TO_Y) * clear)
            self.assertAlmostEqual(formulas.reflected(receiver, normal, quad, 0.6, got, 8, corners) / brute, 1, 2)

    # Values that published validations print as corrections of the standard's table of this case.
    # Broken by: the box .2 m nearer.
    def test_the_obstruction_has_the_corrected_values(self):
        truth = next(reflection.obstruction()).cases[0].truth
        published = [16.07, 16.33, 15.40, 13.32, 10.32, 7.08, 3.38, 3.63, 3.01, 0, 0]
        np.testing.assert_allclose(truth, published, atol=0.006)

    # Measuring points get nothing from the lamps, and the lit surface gets all of it.
    # Broken by: a lamp on the points' side; one so low that the box shades the wall.
    def test_lamps_shine_on_one_surface_alone(self):
        for scene in (*reflection.one_surface(), *reflection.obstruction()):
            parts = Recorder()
            scene.build(parts)
            for point, normal in zip(scene.cases[0].points, scene.cases[0].normals):
                self.assertEqual(formulas.irradiance(point, normal, parts.lights[0]), 0)
            for point in samples(parts.surfaces["S2"], 10)[0]:
                self.assertGreater(formulas.irradiance(point, formulas.normal_of(parts.surfaces["S2"]), parts.lights[0]), 0)
                self.assertFalse("box" in parts.surfaces and meets_box(point, parts.lights[0], *reflection.BOX).any())


class ClosedCube(unittest.TestCase):
    def mean(self, reflectance, bounces, n=12):
        s, weights = np.polynomial.legendre.leggauss(12)
        wall = np.array([(2 + 2 * a, 2 + 2 * b, 0) for a in s for b in s])
        return np.outer(weights, weights).reshape(-1) / 4 @ cube.irradiances(wall, 4.0, 9600, reflectance, bounces, n)

    # No light is lost: the mean is the flux over the area times the series. Broken by: rows and columns not scaled.
    def test_the_mean_is_that_of_the_flux(self):
        for reflectance, bounces in ((0.5, 0), (0.5, 1), (0.8, 4), (0.95, 32), (0.95, None)):
            self.assertAlmostEqual(self.mean(reflectance, bounces) / (100 * formulas.series(reflectance, bounces)), 1, 4)

    # One bounce is an integral of known light over the five other walls.
    # Broken by: a wall wound the other way.
    def test_one_bounce_is_what_the_walls_sum_to(self):
        for receiver in np.array([[2, 2, 0], [0.75, 1.25, 0], [0.25, 0.25, 0.0]]):
            total = formulas.point_source(receiver[None], TO_Z[None], (2, 2, 2), 9600 / (4 * math.pi))[0]
            for origin, along, across in cube.OTHERS:
                quad = 4 * case.rectangle(origin, along, across)
                points, area = samples(quad, 400)
                normals = np.broadcast_to(formulas.normal_of(quad), points.shape)
                got = formulas.point_source(points, normals, (2, 2, 2), 9600 / (4 * math.pi))
                total += 0.7 / math.pi * area * kernel(receiver, TO_Z, points, normals[0]) @ got
            self.assertAlmostEqual(cube.irradiances(receiver[None], 4.0, 9600, 0.7, 1)[0] / total, 1, 3)

    # Broken by: the square of the cube's edge left out. The cube of 1 m has 16 times the irradiance.
    def test_irradiance_goes_with_the_area(self):
        large = cube.irradiances([[1.0, 2, 0]], 4.0, 100, 0.5, 3, 8)
        np.testing.assert_allclose(cube.irradiances([[0.25, 0.5, 0]], 1.0, 100, 0.5, 3, 8), 16 * large)

    # Broken by: patches looked at from their corners instead of their middles.
    def test_the_points_at_the_walls_are_converged(self):
        wall = reflection.cube_points()[2]
        coarse, fine = (cube.irradiances(wall, 4.0, 10000, 0.9, 32, n) for n in (16, 20))
        self.assertLess(np.abs(coarse / fine - 1).max(), 5e-4)


class Cases(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scenes = list(cases.all_scenes())

    def test_points_face_into_their_scene(self):
        for scene in self.scenes:
            for each in scene.cases:
                self.assertEqual(each.points.shape, each.normals.shape)
                self.assertEqual(len(each.truth), len(each.points) if each.weights is None else 1)
                self.assertTrue(np.isfinite(each.truth).all() and (each.truth >= 0).all() and each.truth.max() > 0)
                np.testing.assert_allclose(np.linalg.norm(each.normals, axis=1), 1)

    # Broken by: one edge of a face left out.
    def test_weights_sum_to_the_area(self):
        self.assertAlmostEqual(case.inside(case.ROOM, 5)[2].sum(), 80, 10)
        for scene in self.scenes:
            for each in scene.cases:
                if each.weights is not None and scene.name.startswith("5.8"):
                    self.assertAlmostEqual(each.weights.sum(), 1, 10)

    # Gauss points on every wall of a closed room get all that a panel sends. Broken by: a normal outwards.
    def test_all_faces_get_the_flux(self):
        points, normals, weights = case.inside(case.ROOM, 16)
        total = weights @ [formulas.irradiance(p, n, case.PANEL) for p, n in zip(points, normals)]
        self.assertAlmostEqual(total / math.pi, 1, 4)

    # Broken by: a part that covers the opening.
    def test_frames_are_the_face_without_the_opening(self):
        for opening, face in ((case.PANEL, 16), (openings.FACADE["2 x 1"], 12), (openings.FACADE["4 x 3"], 12)):
            parts = openings.frame(opening, np.zeros(3), np.array([4.0, 4, 3]))
            self.assertAlmostEqual(sum(map(formulas.area_of, parts)), face - formulas.area_of(opening), 12)
            for part in parts:
                outside = opening.mean(axis=0) - part.mean(axis=0)
                self.assertGreater(np.abs(outside).max(), 0.4)

    # Broken by: no smallest value.
    def test_errors_of_dark_points_are_those_of_a_hundredth(self):
        np.testing.assert_allclose(report.errors(np.array([110, 0.5, 0]), np.array([100, 0.0, 0])), [0.1, 0.5, 0])

    def test_rows_are_as_the_schema_says(self):
        scene = next(s for s in self.scenes if s.name == "5.3")
        answers = scene.cases[0].truth * 1.01
        rows = report.rows_of(scene, scene.cases[0], answers, "DIRECT", {"flags": ""})
        content = results.document("cie171", {"choice": "software", "driver": ""}, rows)
        self.assertEqual(results.check(content), [])
        self.assertAlmostEqual(rows[0]["values"]["relative_worst"], 0.01, 12)
        self.assertEqual(len(rows), 15)
        text = (HERE / "results.schema.md").read_text()
        for row in rows:
            for name in row["values"]:
                self.assertIn(f"`{name}`", text)


if __name__ == "__main__":
    unittest.main()
