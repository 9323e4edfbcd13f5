#!/usr/bin/python3
"""What pairs of timings tell, on timings made up: what is slower is named, what is not is not, however noisy."""

import pathlib
import random
import sys
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import pairs  # noqa: E402


def made(factor, noise, count=15, seed=1):
    """Pairs of a stage that takes `factor` as long as before, on a machine whose speed drifts, with noise of its own."""
    source = random.Random(seed)
    out = []
    for i in range(count):
        drift = 10.0 * (1.0 + 0.5 * source.random())
        out.append(({"a: stage": drift * source.lognormvariate(0, noise)}, {"a: stage": factor * drift * source.lognormvariate(0, noise)}))
    return out


class Ratios(unittest.TestCase):
    def test_a_fifth_more_work_is_named_nearly_always(self):  # broken by: percentiles of the raw times, which drift hides
        found = sum(bool(pairs.named(pairs.ratios(made(1.2, 0.02, seed=seed)))) for seed in range(40))
        self.assertGreaterEqual(found, 38)

    def test_the_same_work_is_never_named(self):  # broken by: naming what lies above 1 instead of 1.07
        for noise in (0.01, 0.05):
            found = sum(bool(pairs.named(pairs.ratios(made(1.0, noise, seed=seed)))) for seed in range(100))
            self.assertEqual(found, 0, noise)

    def test_pairs_in_which_one_side_stood_still_do_not_hide_it(self):  # broken by: means in the place of medians
        stood = made(1.2, 0.02)
        for i, longer in ((2, 3.0), (7, 2.0), (11, 4.0)):
            stood[i][0]["a: stage"] *= longer
        self.assertEqual(len(pairs.named(pairs.ratios(stood))), 1)

    def test_little_more_work_is_not_named(self):
        found = sum(bool(pairs.named(pairs.ratios(made(1.03, 0.02, seed=seed)))) for seed in range(40))
        self.assertEqual(found, 0)

    def test_the_interval_holds_the_ratio(self):  # broken by: swapped tails
        (ratio,) = pairs.ratios(made(1.5, 0.02))
        self.assertLess(ratio.low, 1.5)
        self.assertGreater(ratio.high, 1.5)
        self.assertLess(ratio.high / ratio.low, 1.15)

    def test_what_is_shorter_than_a_fence_is_not_judged(self):
        short = [({"a": 0.01}, {"a": 0.04}) for _ in range(9)]
        self.assertEqual(pairs.ratios(short), [])

    def test_stages_of_one_side_are_not_compared(self):
        self.assertEqual(pairs.ratios([({"a": 1.0}, {"b": 1.0})] * 9), [])

    def test_equal_pairs_have_no_width(self):  # broken by: dividing by a deviation of nothing
        (ratio,) = pairs.ratios([({"a": 1.0}, {"a": 1.1})] * 9)
        self.assertAlmostEqual(ratio.low, ratio.high)


if __name__ == "__main__":
    unittest.main()
