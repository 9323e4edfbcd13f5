#!/usr/bin/python3
"""Tests of the evaluation's files, scenes and cache. usage: tests/evaluation/evaluation_test.py"""

import importlib.machinery
import importlib.util
import json
import math
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "scenes")]
import numpy as np  # noqa: E402

import exr  # noqa: E402
import generate  # noqa: E402
import meshes  # noqa: E402
import metrics  # noqa: E402
import paper_specular  # noqa: E402
import references  # noqa: E402
import results  # noqa: E402

loader = importlib.machinery.SourceFileLoader("evaluate", str(HERE / "evaluate"))
evaluate = importlib.util.module_from_spec(importlib.util.spec_from_loader("evaluate", loader))
loader.exec_module(evaluate)


class PapersGloss(unittest.TestCase):
    def base(self, n=(0.0, 1.0, 0.0), roughness=0.0, metalness=1.0):
        return {"P": np.array([[[0.5, 0.5, 0.5]]]), "N": np.array([[n]]), "M": np.array([[[roughness, metalness, 1.0]]])}

    def seen(self, volume, base, eye=(0.5, 2.5, 0.5)):
        grid = {"origin": np.zeros(3), "cell": 0.25}
        return paper_specular.radiance(volume, grid, base, metrics.kinds_of_gloss(base["M"]), np.array(eye))[0, 0]

    # Broken by: a volume without its guard, whose middles are half a cell off.
    def test_a_volume_is_looked_up_between_middles(self):
        z, y, x = np.mgrid[0:6, 0:6, 0:6]
        volume = np.zeros((6, 6, 6, 3, 4))
        volume[..., 0] = ((x - 0.5) * 0.25)[..., None]  # the place's x
        got = paper_specular.looked_up(volume, {"origin": np.zeros(3), "cell": 0.25}, np.array([[0.3, 0.5, 0.7], [0.9, 0.2, 0.4]]))
        np.testing.assert_allclose(got[:, :, 0], [[0.3] * 3, [0.9] * 3], rtol=1e-12)

    # Even light of radiance 1: what a metal reflects of it; of what is reflected twice the metal keeps some.
    # Broken by: a band without its constant.
    def test_even_light_is_reflected_by_the_reflectance(self):
        volume = np.zeros((6, 6, 6, 3, 4))
        volume[..., 0] = 1 / paper_specular.Y0
        for roughness in (0.0, 0.3, 1.0):
            np.testing.assert_allclose(self.seen(volume, self.base(roughness=roughness)), 0.9, rtol=0.07)

    # Broken by: coefficients in another order; the direction of travel for that of where light comes from.
    def test_light_comes_from_where_the_mirror_points(self):
        volume = np.zeros((6, 6, 6, 3, 4))
        volume[..., 0], volume[..., 3] = 1.0, 0.5  # L11: from +x
        left, right = (self.seen(volume, self.base(), (0.5 + side, 1.5, 0.5))[0] for side in (-1, 1))  # of the place
        self.assertGreater(left, 1.5 * right)


class Files(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    # Broken by: layers of X, Y, Z read in the file's order, which is alphabetical.
    def test_layers_survive_an_exr(self):
        random = np.random.default_rng(1)
        layers = {"radiance": random.random((4, 5, 3)), "E": random.random((4, 5, 3)), "P": random.random((4, 5, 3)),
                  "object": np.arange(20.0).reshape(4, 5)}
        exr.write(self.folder / "a.exr", layers)
        read = exr.read(self.folder / "a.exr")
        self.assertEqual(set(read), set(layers))
        for name, values in layers.items():
            np.testing.assert_allclose(read[name], values, rtol=1e-6)

    def test_results_are_as_the_schema_says(self):
        row = {"case": "a", "quantity": "pixels", "settings": {"flags": ""}, "values": {"nrmse": math.nan, "pixels": 3}}
        content = results.document("evaluation", {"choice": "software", "driver": ""}, [row])
        self.assertEqual(results.check(content), [])
        results.write(self.folder, content)
        read = json.loads((self.folder / "results.json").read_text())
        self.assertIsNone(read["rows"][0]["values"]["nrmse"])
        self.assertEqual(results.check(read), [])
        lines = (self.folder / "results.csv").read_text().splitlines()
        self.assertEqual(lines[0], "case,quantity,settings.flags,values.nrmse,values.pixels")

    def test_what_is_not_as_the_schema_says_is_named(self):
        content = results.document("evaluation", {}, [{"case": "a", "values": {"nrmse": "large"}}])
        wrong = " ".join(results.check(content))
        self.assertIn("rows[0].quantity", wrong)
        self.assertIn("values.nrmse is no number", wrong)

    # Broken by: the schema's document and the metrics drifting apart.
    def test_every_value_stands_in_the_schema(self):
        text = (HERE / "results.schema.md").read_text()
        truth = np.ones((3, 3))
        values = metrics.compare(truth, truth, [True, False, False], truth)
        for name in [*values, "hdr_flip", "hdr_flip_of_reference", "raw_l2_se", "nrmse_se", "points_outside_the_grid", "frame_seconds"]:
            self.assertIn(f"`{name}`", text)


class Cache(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)
        (self.folder / "renderer").write_text("")
        self.embree = references.Embree(self.folder / "renderer", self.folder / "cache")

    def key(self, name="a.glb", view=None, size=(8, 4), samples=16, kind="centre"):
        return self.embree.key(self.folder / name, view or {"eye": [0, 0, 1]}, size, samples, kind)

    # Broken by: any of them left out of the key.
    def test_the_key_depends_on_everything_that_a_reference_does(self):
        scene = self.folder / "a.glb"
        scene.write_bytes(b"one")
        first = self.key()
        self.assertEqual(first, self.key())
        others = [self.key(view={"eye": [0, 0, 2]}), self.key(size=(8, 5)), self.key(samples=17), self.key(kind="box")]
        self.embree.version = "another"
        others.append(self.key())
        self.embree.version = references.Embree(self.folder / "renderer", "cache").version
        scene.write_bytes(b"two")
        others.append(self.key())
        self.assertEqual(len({first, *others}), 7)

    # Broken by: only the .obj's own bytes in the key.
    def test_an_obj_depends_on_its_materials(self):
        inner = self.folder / "scene"
        inner.mkdir()
        (inner / "a.obj").write_text("mtllib a.mtl")
        (inner / "a.mtl").write_text("Kd 1 1 1")
        first = self.key("scene/a.obj")
        (inner / "a.mtl").write_text("Kd 0 1 1")
        self.assertNotEqual(first, self.key("scene/a.obj"))

    # Every source that the program is built from is part of its version.
    def test_the_version_covers_all_sources(self):
        renderer = {p for p in (HERE / "renderer").iterdir() if "test" not in p.stem}
        self.assertLessEqual(renderer, set(references.sources()))
        self.assertIn("scene_file.cpp", [p.name for p in references.sources()])


class Scenes(unittest.TestCase):
    def test_the_same_bytes_every_time(self):
        with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
            rows = generate.generate(pathlib.Path(first))
            generate.generate(pathlib.Path(second))
            self.assertGreaterEqual(len(rows), 12)
            for row in rows:
                self.assertEqual((pathlib.Path(first) / row["file"]).read_bytes(),
                                 (pathlib.Path(second) / row["file"]).read_bytes())

    # Broken by: a face of the box wound the other way.
    def test_closed_meshes_face_outwards(self):
        for vertices, triangles in (meshes.box((0, 0, 0), (1, 2, 3)), meshes.sphere((1, 2, 3), 0.5)):
            a, b, c = (vertices[triangles[:, i]] for i in range(3))
            outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), (a + b + c) / 3 - vertices.mean(axis=0))
            self.assertTrue((outward > 0).all())

    def test_panels_face_down_and_tubes_outwards(self):
        vertices, triangles = meshes.panel_down((0, 3, 0), 1, 2)
        normal = np.cross(vertices[triangles[0][1]] - vertices[triangles[0][0]], vertices[triangles[0][2]] - vertices[triangles[0][0]])
        self.assertLess(normal[1], 0)
        vertices, triangles = meshes.tube((-1, 0, 0), (1, 0, 0), 0.1)
        a, b, c = (vertices[triangles[:, i]] for i in range(3))
        axis = (a + b + c) / 3 * (0, 1, 1)
        self.assertTrue((np.einsum("ij,ij->i", np.cross(b - a, c - a), axis) > 0).all())


class Views(unittest.TestCase):
    """What evaluate makes of one camera: two pixels of a surface, one in shadow, a light, a black surface."""

    def setUp(self):
        one = np.ones((1, 4, 3))
        base = {"A": one * [[[0.5], [0.5], [0], [0]]], "object": np.array([[2, 2, 1, 3]]), "U": one * [[[4], [4], [0], [4]]],
                "Use": 0 * one, "D": one * [[[4], [1], [0], [4]]], "E": one * [[[4], [1], [0], [4]]], "Ese": 0 * one,
                "P": 0 * one, "N": one}
        base["radiance"] = base["A"] * base["E"] / np.pi + one * [[[0], [0], [7], [0]]]
        unshadowed = base["A"] * base["U"] / np.pi + one * [[[0], [0], [7], [0]]]
        self.view = evaluate.View({"0": base}, unshadowed, np.array([[4.0] * 3, [4.0] * 3]), np.array([0, 1]))

    def rows(self):
        return {(name, quantity): values for name, quantity, values, _, _ in self.view.rows()}

    # Broken by: black surfaces counted; U compared with what has shadows.
    def test_a_product_without_shadows_is_right_against_unoccluded_alone(self):
        rows = self.rows()
        for quantity in ("pixels", "irradiance"):
            self.assertAlmostEqual(rows["unoccluded", quantity]["nrmse"], 0, 12)
            self.assertAlmostEqual(rows["0", quantity]["raw_l2"], 3 / math.sqrt(17), 12)
            self.assertAlmostEqual(rows["0", quantity]["raw_l2_shadowed"], 3, 12)
            self.assertEqual(rows["0", quantity]["pixels"], 2)

    # Broken by: no noise added.
    def test_flip_of_noise_grows_with_the_error_of_the_reference(self):
        self.assertEqual(self.rows()["0", "pixels"]["hdr_flip_of_reference"], 0)
        self.view.base["Ese"] = 0.1 * self.view.base["E"]
        small = self.rows()["0", "pixels"]["hdr_flip_of_reference"]
        self.view.base["Ese"] = 0.5 * self.view.base["E"]
        self.assertGreater(self.rows()["0", "pixels"]["hdr_flip_of_reference"], small)
        self.assertGreater(small, 0)

    # Broken by: matte pixels counted; kinds not told apart.
    def test_surfaces_with_lobes_are_compared_kind_by_kind(self):
        self.assertFalse([key for key in self.rows() if key[1].startswith("gloss")])
        base = self.view.base
        base["M"] = np.array([[[0.3, 0, 1], [1, 0, 0], [0, 0, 0], [0.3, 1, 1]]])
        base["se"] = 0 * base["radiance"]
        base["radiance"][0, 3] = 1.0
        rows = self.rows()
        self.assertEqual(rows["0", "gloss, all"]["pixels"], 2)
        self.assertEqual(rows["0", "gloss, roughness 0.3, metalness 1"]["pixels"], 1)
        self.assertAlmostEqual(rows["0", "gloss, roughness 0.3, metalness 1"]["raw_l2"], 1, 12)
        self.assertAlmostEqual(rows["0", "gloss, roughness 0.3, metalness 0"]["raw_l2"], 0, 12)
        self.assertFalse([quantity for _, quantity in rows if quantity.startswith("the paper's")])
        self.view.papers = base["radiance"] + 1.0
        self.assertGreater(self.rows()["0", "the paper's gloss, roughness 0.3, metalness 1"]["raw_l2"], 0.5)

    # Broken by: nan answers kept among the figures.
    def test_points_outside_the_grid_are_counted(self):
        self.view.answers[1] = math.nan
        values = self.rows()["0", "irradiance"]
        self.assertEqual(values["points_outside_the_grid"], 1)
        self.assertEqual(values["raw_l2"], 0)

    def test_points_are_spread_over_the_surfaces(self):
        surface = np.zeros((40, 50), bool)
        surface[10:, 20:] = True
        picked = evaluate.probed_pixels(surface, 300)
        self.assertEqual(list(picked), list(evaluate.probed_pixels(surface, 300)))
        self.assertEqual(len(set(picked)), 300)
        self.assertTrue(surface.reshape(-1)[picked].all())
        self.assertEqual(len(set(picked % 50)), 30)
        self.assertEqual(len(set(picked // 50)), 30)
        self.assertEqual(len(evaluate.probed_pixels(np.zeros((2, 2), bool), 3)), 0)


if __name__ == "__main__":
    unittest.main()
