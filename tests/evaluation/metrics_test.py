#!/usr/bin/python3
"""Tests of metrics.py. usage: tests/evaluation/metrics_test.py"""

import math
import sys
import unittest

sys.dont_write_bytecode = True
import numpy as np  # noqa: E402

import metrics  # noqa: E402


def random_picture(seed=1, size=(24, 40)):
    return np.random.default_rng(seed).random((*size, 3))


class Numbers(unittest.TestCase):
    # E = 1.2 and 2.2 where the truth is 1 and 2 (MATHS.md 8).
    ours = np.array([[1.2] * 3, [2.2] * 3])
    truth = np.array([[1.0] * 3, [2.0] * 3])

    def test_raw_l2_is_that_of_the_worked_example(self):
        self.assertAlmostEqual(metrics.relative_l2(self.ours, self.truth), 0.126491106407, 12)

    # Broken by: the root of the mean truth's square in the denominator.
    def test_nrmse_divides_by_the_mean(self):
        self.assertAlmostEqual(metrics.nrmse(self.ours, self.truth), 0.2 / 1.5, 12)

    # Broken by: the 95th percentile of the signed logarithm; no floor.
    def test_ratios_count_both_ways_and_are_floored(self):
        truth = np.ones((100, 3))
        ours = np.ones((100, 3))
        ours[:10] = 0.5
        self.assertAlmostEqual(metrics.log_ratio_p95(ours, truth), math.log(2), 12)
        ours[:10] = 2.0
        self.assertAlmostEqual(metrics.log_ratio_p95(ours, truth), math.log(2), 12)
        ours[:10] = 0.0
        self.assertAlmostEqual(metrics.log_ratio_p95(ours, truth), math.log(100), 12)
        self.assertEqual(metrics.log_ratio_p95(truth, truth), 0.0)

    # Broken by: more than 10 % of the mean instead of the pixel's own value.
    def test_the_share_of_pixels_off_is_relative_to_each(self):
        truth = np.repeat(np.linspace(1, 10, 100)[:, None], 3, axis=1)
        ours = truth.copy()
        ours[:25] *= 1.11
        ours[25:50] *= 1.09
        ours[50:75] *= 0.89
        self.assertAlmostEqual(metrics.share_off(ours, truth), 0.5, 12)

    def test_shadow_is_less_than_95_percent_of_what_would_arrive(self):
        unoccluded = np.ones((4, 3))
        direct = np.array([1.0, 0.951, 0.949, 0.0])[:, None] * unoccluded
        self.assertEqual(list(metrics.shadowed(direct, unoccluded)), [False, False, True, True])

    # Broken by: pixels in the umbra left out of those that are lit.
    def test_a_pixel_in_the_umbra_counts_as_lit(self):
        surface = np.array([True, True, False, True])
        black, one = np.zeros((4, 3)), np.ones((4, 3))
        unoccluded = np.array([1.0, 0.0, 1.0, 1.0])[:, None] * one
        self.assertEqual(list(metrics.lit(surface, black, unoccluded, black)), [True, False, False, True])

    def test_compare_separates_shadow_and_noise(self):
        truth = np.array([[1.0] * 3, [1.0] * 3, [0.5] * 3, [0.5] * 3])
        ours = np.array([[1.0] * 3, [1.0] * 3, [1.0] * 3, [1.0] * 3])
        out = metrics.compare(ours, truth, [False, False, True, True], 0.1 * truth)
        self.assertAlmostEqual(out["raw_l2_shadowed"], 1.0, 12)
        self.assertAlmostEqual(out["nrmse"], math.sqrt(0.125) / 0.75, 12)
        self.assertAlmostEqual(out["nrmse_of_reference"], math.sqrt((0.01 + 0.0025) / 2) / 0.75, 12)
        self.assertEqual(out["shadowed_pixels"], 2)
        self.assertAlmostEqual(out["nrmse_shadowed_of_reference"], 0.1, 12)

    # Luminance of noise of .05 in each colour has a standard deviation of .05 |LUMINANCE| = .0375: 95 % are within 1.96 of
    # them, and .77 % beyond .1, 2.67 of them. Broken by: the same noise in all colours.
    def test_noise_of_the_reference_makes_ratios_and_shares(self):
        truth = np.ones((20000, 3))
        out = metrics.of_reference(truth, 0.05 * truth)
        self.assertAlmostEqual(out["log_ratio_p95_of_reference"], 1.96 * 0.0375, delta=0.002)
        self.assertAlmostEqual(out["share_over_10_percent_of_reference"], 0.0077, delta=0.002)
        self.assertNotIn("nrmse_shadowed_of_reference", out)
        self.assertEqual(out, metrics.of_reference(truth, 0.05 * truth))
        self.assertEqual(metrics.of_reference(truth, 0 * truth)["log_ratio_p95_of_reference"], 0)


class Blocks(unittest.TestCase):
    def test_are_means_and_leave_a_rest_out(self):
        image = np.zeros((5, 6, 3))
        image[:2, 2:4] = [[[1, 2, 3], [3, 2, 1]], [[0, 0, 0], [4, 0, 0]]]
        image[4] = 100
        out = metrics.blocks(image, 2)
        self.assertEqual(out.shape, (2, 3, 3))
        np.testing.assert_allclose(out[0, 1], [2, 1, 1])
        self.assertEqual(out.sum(), 4)


class Bootstrap(unittest.TestCase):
    # The NRMSE of errors of one size hardly depends on the points; that of a single large error does by half.
    # Broken by: the same points in every resample; the standard error of the mean of the resamples.
    def test_few_large_errors_make_it_large(self):
        truth = np.ones((1000, 3))
        even = truth + 0.1 * np.random.default_rng(2).choice([-1, 1], (1000, 1))
        single = truth.copy()
        single[17] += 3
        self.assertLess(metrics.bootstrap(metrics.nrmse, even, truth), 1e-9)
        se = metrics.bootstrap(metrics.nrmse, single, truth)
        self.assertGreater(se, 0.4 * metrics.nrmse(single, truth))
        self.assertLess(se, 1.0 * metrics.nrmse(single, truth))
        self.assertTrue(math.isnan(metrics.bootstrap(metrics.nrmse, truth[:1], truth[:1])))


class Flip(unittest.TestCase):
    def test_the_same_picture_has_none(self):
        a = random_picture()
        self.assertLess(metrics.hdr_flip(100 * a, 100 * a).max(), 1e-12)

    # The metric is scaled so that 1 is the distance of the two colours farthest apart, green and blue.
    # Broken by: chroma without Hunt's adjustment on one side; a cut that is not continuous.
    def test_green_against_blue_is_one(self):
        green, blue = np.zeros((2, 32, 32, 3))
        green[..., 1], blue[..., 2] = 1, 1
        self.assertAlmostEqual(metrics.flip_of_linear(green, blue).mean(), 1.0, 9)

    def test_ldr_flip_is_symmetric(self):
        a, b = random_picture(1), random_picture(2)
        np.testing.assert_allclose(metrics.flip_of_linear(a, b), metrics.flip_of_linear(b, a), atol=1e-12)

    # Broken by: an exposure range taken from ours.
    def test_the_exposures_follow_the_truth_alone(self):
        truth = random_picture(3)
        self.assertEqual(list(metrics.exposures(truth)), list(metrics.exposures(truth.copy())))
        np.testing.assert_allclose(metrics.exposures(8 * truth), metrics.exposures(truth) - 3, atol=1e-9)

    def test_the_first_exposure_brings_the_brightest_to_the_target(self):
        truth = random_picture(4)
        stops = metrics.exposures(truth)
        y = metrics.luminance(truth)
        self.assertAlmostEqual(metrics.tone_mapped(y.max() * 2 ** stops[0]), metrics.BRIGHT, 9)
        self.assertAlmostEqual(metrics.tone_mapped(np.median(y) * 2 ** stops[-1]), metrics.BRIGHT, 9)

    def test_does_not_depend_on_the_scale_of_both(self):
        a, b = random_picture(5), random_picture(6)
        np.testing.assert_allclose(metrics.hdr_flip(a, b), metrics.hdr_flip(1000 * a, 1000 * b), atol=1e-9)

    def test_grows_with_the_error(self):
        truth = random_picture(7)
        means = [metrics.hdr_flip(truth * (1 + e), truth).mean() for e in (0, 0.02, 0.1, 0.5, 2)]
        self.assertEqual(means, sorted(means))
        self.assertGreater(means[-1], 10 * means[1])
        self.assertLessEqual(means[-1], 1)

    # An edge that is not there weighs more than the same difference of colour without an edge.
    # Broken by: the feature difference left out of the exponent.
    def test_a_missing_edge_counts_for_more(self):
        flat = np.full((64, 64, 3), 0.25)
        line = flat.copy()
        line[:, 32] = 0.75
        feature_free = metrics.colour_difference(metrics.opponent(line), metrics.opponent(flat), metrics.PIXELS_PER_DEGREE)
        self.assertGreater(metrics.flip_of_linear(line, flat)[32, 32], 1.3 * feature_free[32, 32])

    def test_colours_survive_the_opponent_space(self):
        a = random_picture(8)
        np.testing.assert_allclose(metrics.rgb_of_opponent(metrics.opponent(a)), a, atol=1e-12)

    def test_a_grey_picture_has_no_chroma(self):
        grey = np.full((4, 4, 3), 0.3)
        self.assertLess(np.abs(metrics.opponent(grey)[..., 1:]).max(), 1e-9)
        self.assertLess(np.abs(metrics.hunt_lab(grey)[..., 1:]).max(), 1e-9)

    # CIELAB of sRGB's blue under D65 is 32.30, 79.19, -107.86.
    # Broken by: twice Hunt's factor.
    def test_chroma_is_scaled_by_lightness(self):
        blue = metrics.hunt_lab(np.array([0.0, 0, 1]))
        np.testing.assert_allclose(blue, [32.30, 0.3230 * 79.19, 0.3230 * -107.86], atol=0.02)

    # Broken by: only the first exposure looked at.
    def test_errors_in_the_dark_show_at_a_later_exposure(self):
        truth = random_picture(9) + 0.5
        truth[0, 0] = 1000
        ours = truth.copy()
        ours[10:, 20:] *= 2
        first = metrics.exposures(truth)[0]
        at_first = metrics.flip_of_linear(*(metrics.tone_mapped(x * 2 ** first) for x in (ours, truth)))
        self.assertGreater(metrics.hdr_flip(ours, truth)[15, 30], 5 * at_first[15, 30])

    def test_blurring_keeps_a_constant_picture(self):
        constant = metrics.opponent(np.full((40, 40, 3), [0.2, 0.5, 0.7]))
        np.testing.assert_allclose(metrics.blurred(constant, metrics.PIXELS_PER_DEGREE), constant, atol=1e-9)


if __name__ == "__main__":
    unittest.main()
