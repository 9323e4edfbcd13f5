"""What pairs of timings tell: ratios with an interval that a bootstrap over the pairs gives (Efron and Tibshirani 1993,
chapters 12 to 13; as everywhere here, of logarithms)."""

import collections
import math
import random

RESAMPLES = 4000
CONFIDENCE = 0.99
WORSE = 1.07  # a ratio whose whole interval is above this is named
SHORTEST_MS = 0.05  # stages that take less in both are not judged: a clock and a fence take as long

Ratio = collections.namedtuple("Ratio", "name old new ratio low high")


def median(values):
    ordered = sorted(values)
    middle = len(ordered) // 2
    return ordered[middle] if len(ordered) % 2 else 0.5 * (ordered[middle - 1] + ordered[middle])


def interval(logs, seed=1):
    """(low, high): percentiles of the medians of resamples. Medians, since a machine that others use has pairs in which one
    side stood still for a while."""
    source = random.Random(seed)
    medians = sorted(median(source.choices(logs, k=len(logs))) for _ in range(RESAMPLES))
    tail = int((1.0 - CONFIDENCE) / 2.0 * RESAMPLES)
    return medians[tail], medians[-1 - tail]


def ratios(pairs):
    """A Ratio for every name of the pairs [({name: ms}, {name: ms})] that is in all of them, old first."""
    names = [name for name in pairs[0][0] if all(name in old and name in new for old, new in pairs)]
    out = []
    for name in names:
        both = [(old[name], new[name]) for old, new in pairs]
        if any(a <= 0.0 or b <= 0.0 for a, b in both):
            continue
        old, new = map(median, zip(*both))
        if max(old, new) < SHORTEST_MS:
            continue
        logs = [math.log(b / a) for a, b in both]
        low, high = interval(logs)
        out.append(Ratio(name, old, new, math.exp(median(logs)), math.exp(low), math.exp(high)))
    return out


def named(found):
    """Those that have become slower, the worst first."""
    return sorted((ratio for ratio in found if ratio.low > WORSE), key=lambda ratio: -ratio.low)
