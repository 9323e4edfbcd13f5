"""What the name of a value tells: errors, bytes and counts are judged, times are shown, the rest is context."""

TIMES = {"seconds": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
ERRORS = {"l2", "nrmse", "flip", "error", "worst"}
NAMED = {"log_ratio_p95": "error", "share_over_10_percent": "error", "points_outside_the_grid": "count"}
NOISE, SPREAD = "_of_reference", "_se"

JUDGED = ("error", "bytes", "count")
ROUNDING = 1e-6  # of an error: what another order of the same sums makes
PIXELS_BY_CHANCE = 1.5  # a pixel that is 10 % off but for rounding may be on either side

TITLES = {"raw_l2": "raw L2", "nrmse": "NRMSE", "raw_l2_shadowed": "shadowed raw L2", "nrmse_shadowed": "shadowed NRMSE",
          "log_ratio_p95": "p95 of |ln|", "share_over_10_percent": "more than 10 % off", "hdr_flip": "FLIP"}


def kind(name):
    """"error", "bytes", "count" or "time"; None for what is neither judged nor a time."""
    if name.endswith(NOISE) or name.endswith(SPREAD):
        return None
    if name in NAMED:
        return NAMED[name]
    words = name.split("_")
    if words[-1] in TIMES:
        return "time"
    if "bytes" in words:
        return "bytes"
    if words[-1] == "count":
        return "count"
    return "error" if ERRORS & set(words) else None


def seconds(name, value):
    return value * TIMES[name.split("_")[-1]]


def title(name):
    return TITLES.get(name, name.replace("_", " "))


def noise(values, name):
    """What the reference's own error makes of this figure; None where it is not known."""
    own = values.get(name + NOISE)
    if own is not None or name not in ("raw_l2", "raw_l2_shadowed"):
        return own
    # Relative L2 and NRMSE differ by the truth's root mean square over its mean, for noise as for errors.
    other = name.replace("raw_l2", "nrmse")
    of_nrmse, nrmse, l2 = values.get(other + NOISE), values.get(other), values.get(name)
    return of_nrmse * l2 / nrmse if of_nrmse is not None and nrmse and l2 is not None else None


def threshold(old, new, name):
    """By how much the value has to grow to be named: 1 % of it, the reference's noise, or rounding, the largest."""
    least = [0.01 * abs(old[name])]
    if kind(name) == "error":
        least += [ROUNDING, noise(old, name) or 0.0, noise(new, name) or 0.0]
    if name == "share_over_10_percent":
        least += [PIXELS_BY_CHANCE / values["pixels"] for values in (old, new) if values.get("pixels")]
    return max(least)
