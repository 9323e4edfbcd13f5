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


def interval(logs, seed=1):
    """(low, high): the interval of the mean of `logs`, by Student's t of each resample, which is wider than percentiles
    are where there are few pairs."""
    n = len(logs)
    mean = sum(logs) / n
    deviation = math.sqrt(sum((x - mean) ** 2 for x in logs) / (n - 1)) / math.sqrt(n)
    if deviation == 0.0:
        return mean, mean
    source = random.Random(seed)
    studentised = []
    for _ in range(RESAMPLES):
        drawn = [logs[source.randrange(n)] for _ in range(n)]
        own = sum(drawn) / n
        spread = math.sqrt(sum((x - own) ** 2 for x in drawn) / (n - 1)) / math.sqrt(n)
        if spread > 0.0:
            studentised.append((own - mean) / spread)
    studentised.sort()
    tail = int((1.0 - CONFIDENCE) / 2.0 * len(studentised))
    return mean - deviation * studentised[-1 - tail], mean - deviation * studentised[tail]


def ratios(pairs):
    """A Ratio for every name of the pairs [({name: ms}, {name: ms})] that is in all of them, old first."""
    names = [name for name in pairs[0][0] if all(name in old and name in new for old, new in pairs)]
    out = []
    for name in names:
        both = [(old[name], new[name]) for old, new in pairs]
        if any(a <= 0.0 or b <= 0.0 for a, b in both):
            continue
        old, new = (sorted(values)[len(values) // 2] for values in zip(*both))
        if max(old, new) < SHORTEST_MS:
            continue
        logs = [math.log(b / a) for a, b in both]
        low, high = interval(logs)
        out.append(Ratio(name, old, new, math.exp(sum(logs) / len(logs)), math.exp(low), math.exp(high)))
    return out


def named(found):
    """Those that have become slower, the worst first."""
    return sorted((ratio for ratio in found if ratio.low > WORSE), key=lambda ratio: -ratio.low)
