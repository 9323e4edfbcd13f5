"""Errors of light against a reference: relative L2, NRMSE, ratios, and HDR-FLIP.

Arrays are float, of shape (pixels, 3) or (height, width, 3), linear Rec. 709. `truth` is the reference.

The floor of ratios is 1 % of the truth's mean luminance, so that a pixel in the dark does not count for more than its
light. Luminance decides where a pixel counts as one value (ratios, share of pixels); sums run over all three colours.
"""

import math

import numpy as np

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
FLOOR = 0.01  # of the mean
SHADOWED = 0.95  # of what would arrive with nothing in the way


def luminance(rgb):
    return np.asarray(rgb, float) @ LUMINANCE


def relative_l2(ours, truth):
    """|ours - truth| / |truth| over all values; nan where the truth is 0."""
    norm = np.linalg.norm(truth)
    return float(np.linalg.norm(np.asarray(ours) - truth) / norm) if norm > 0 else math.nan


def nrmse(ours, truth):
    """sqrt(mean (ours - truth)^2) / mean truth over all values; nan where the truth is 0."""
    truth = np.asarray(truth, float)
    mean = truth.mean() if truth.size else 0.0
    return float(np.sqrt(np.mean((np.asarray(ours) - truth) ** 2)) / mean) if mean > 0 else math.nan


def blocks(image, edge=8):
    """Means over squares of `edge` pixels; a rest at the right and lower edges is left out."""
    height, width = (n // edge * edge for n in image.shape[:2])
    return image[:height, :width].reshape(height // edge, edge, width // edge, edge, 3).mean(axis=(1, 3))


def kinds_of_gloss(material):
    """{name: mask} of what has a lobe, by roughness and metalness; `material`: layer M of a reference."""
    glossy = material[..., 2] > 0
    kinds = np.unique(np.round(material[glossy][:, :2], 4), axis=0)
    return {f"roughness {r:g}, metalness {m:g}": glossy & np.isclose(material[..., 0], r) & np.isclose(material[..., 1], m)
            for r, m in kinds}


def floored(ours, truth):
    """Luminances of both, not below the floor."""
    a, b = luminance(ours), luminance(truth)
    floor = FLOOR * b.mean() if b.size else 0.0
    return np.maximum(a, floor), np.maximum(b, floor)


def log_ratio_p95(ours, truth):
    """95th percentile of |ln(ours / truth)|."""
    a, b = floored(ours, truth)
    return float(np.percentile(np.abs(np.log(a / b)), 95)) if b.size and b.min() > 0 else math.nan


def share_off(ours, truth, by=0.1):
    """Share of the pixels whose luminance is off by more than `by` of the truth's (not below the floor)."""
    b = luminance(truth)
    if b.size == 0 or b.mean() <= 0:
        return math.nan
    return float(np.mean(np.abs(luminance(ours) - b) > by * np.maximum(b, FLOOR * b.mean())))


def lit(surface, direct, unoccluded, truth):
    """Pixels that show a surface to which light comes, or would with nothing in the way."""
    return surface & ((luminance(unoccluded) > 0) | (luminance(direct) > 0) | (luminance(truth) > 0))


def shadowed(direct, unoccluded):
    """Pixels of which something keeps more than a twentieth of the direct light."""
    return luminance(direct) < SHADOWED * luminance(unoccluded)


def bootstrap(metric, ours, truth, resamples=200, seed=11):
    """Standard error of a metric over points that were chosen at random (Efron 1979); nan for fewer than two."""
    if len(truth) < 2:
        return math.nan
    random = np.random.default_rng(seed)
    values = []
    for _ in range(resamples):
        chosen = random.integers(0, len(truth), len(truth))
        values.append(metric(ours[chosen], truth[chosen]))
    return float(np.std(values))


def compare(ours, truth, in_shadow=None, error=None):
    """All but FLIP, over pixels of shape (n, 3), as a dictionary of numbers. `in_shadow`: which of them are in shadow;
    `error`: the truth's standard error, which is what of these figures may be noise of the reference."""
    ours, truth = np.asarray(ours, float), np.asarray(truth, float)
    out = {
        "pixels": int(len(truth)),
        "mean_truth": float(luminance(truth).mean()) if len(truth) else math.nan,
        "mean_ours": float(luminance(ours).mean()) if len(truth) else math.nan,
        "raw_l2": relative_l2(ours, truth),
        "nrmse": nrmse(ours, truth),
        "log_ratio_p95": log_ratio_p95(ours, truth),
        "share_over_10_percent": share_off(ours, truth),
    }
    if in_shadow is not None:
        dark = np.asarray(in_shadow, bool)
        out["shadowed_pixels"] = int(dark.sum())
        # Relative to the shadow's own light where it has any, so a shadow that is missing has a large error.
        out["raw_l2_shadowed"] = relative_l2(ours[dark], truth[dark])
        out["nrmse_shadowed"] = nrmse(ours[dark], truth[dark])
    if error is not None:
        out.update(of_reference(truth, np.asarray(error), in_shadow))
    return out


def of_reference(truth, error, in_shadow=None):
    """What the truth's standard error makes of the figures. NRMSE is a closed form; percentiles and shares are those of
    the truth with noise of that error against itself."""
    out = {"nrmse_of_reference": nrmse(truth + error, truth)}
    if in_shadow is not None:
        dark = np.asarray(in_shadow, bool)
        out["nrmse_shadowed_of_reference"] = nrmse((truth + error)[dark], truth[dark])
    noisy = truth + error * np.random.default_rng(5).standard_normal(truth.shape)
    out["log_ratio_p95_of_reference"] = log_ratio_p95(noisy, truth)
    out["share_over_10_percent_of_reference"] = share_off(noisy, truth)
    return out


# --- FLIP (Andersson et al. 2020), HDR-FLIP (Andersson et al. 2021) ----------------------------------------------------

PIXELS_PER_DEGREE = 0.7 * (3840 / 0.7) * math.pi / 180  # a display of .7 m and 3840 pixels, from .7 m
RGB_TO_XYZ = np.array([[10135552 / 24577794, 8788810 / 24577794, 4435075 / 24577794],
                       [2613072 / 12288897, 8788810 / 12288897, 887015 / 12288897],
                       [1425312 / 73733382, 8788810 / 73733382, 70074185 / 73733382]])
WHITE = RGB_TO_XYZ.sum(axis=1)
# Contrast sensitivity as sums of two Gaussians a sqrt(pi / b) exp(-pi^2 x^2 / b), x in degrees: achromatic, red-green,
# blue-yellow.
SENSITIVITY = [((1.0, 0.0047), (0.0, 1e-5)), ((1.0, 0.0053), (0.0, 1e-5)), ((34.1, 0.04), (13.5, 0.025))]
COLOUR_EXPONENT, COLOUR_CUT, COLOUR_SHARE = 0.7, 0.4, 0.95
FEATURE_DEGREES, FEATURE_EXPONENT = 0.082, 0.5
ACES = (0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.0, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14)  # (k0 x2 + k1 x + k2) / (k3 x2 + ...)
BRIGHT = 0.85  # tone-mapped value that the brightest and the median pixel are brought to


def opponent(rgb):
    """Linear RGB to YCxCz."""
    x, y, z = np.moveaxis(rgb @ RGB_TO_XYZ.T / WHITE, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def rgb_of_opponent(ycc):
    y = (ycc[..., 0] + 16) / 116
    xyz = np.stack([ycc[..., 1] / 500 + y, y, y - ycc[..., 2] / 200], axis=-1) * WHITE
    return xyz @ np.linalg.inv(RGB_TO_XYZ).T


def hunt_lab(rgb):
    """Linear RGB to CIELAB with chroma scaled by lightness, after Hunt."""
    t = rgb @ RGB_TO_XYZ.T / WHITE
    delta = 6 / 29
    f = np.where(t > delta ** 3, np.cbrt(t), t / (3 * delta ** 2) + 4 / 29)
    lightness = 116 * f[..., 1] - 16
    return np.stack([lightness, 0.01 * lightness * 500 * (f[..., 0] - f[..., 1]),
                     0.01 * lightness * 200 * (f[..., 1] - f[..., 2])], axis=-1)


def along(image, kernel, axis):
    """Convolution (correlation) of a plane with a kernel of odd length along one axis; borders are repeated."""
    radius = len(kernel) // 2
    pad = [(0, 0)] * image.ndim
    pad[axis] = (radius, radius)
    padded = np.pad(image, pad, mode="edge")
    size = image.shape[axis]
    out = np.zeros_like(image)
    for i, weight in enumerate(kernel):
        out += weight * np.take(padded, range(i, i + size), axis=axis)
    return out


def blurred(ycc, per_degree):
    """YCxCz through the eye's contrast sensitivity."""
    widest = max(b for terms in SENSITIVITY for _, b in terms)
    radius = math.ceil(3 * math.sqrt(widest / (2 * math.pi ** 2)) * per_degree)
    x = np.arange(-radius, radius + 1) / per_degree
    out = np.empty_like(ycc)
    for channel, terms in enumerate(SENSITIVITY):
        total, plane = 0.0, 0.0
        for a, b in terms:
            if a == 0:
                continue
            kernel = np.exp(-math.pi ** 2 * x ** 2 / b)
            weight = a * math.sqrt(math.pi / b)
            total += weight * kernel.sum() ** 2
            plane = plane + weight * along(along(ycc[..., channel], kernel, 0), kernel, 1)
        out[..., channel] = plane / total
    return out


def hyab(a, b):
    return np.abs(a[..., 0] - b[..., 0]) + np.hypot(a[..., 1] - b[..., 1], a[..., 2] - b[..., 2])


def colour_difference(ycc_a, ycc_b, per_degree):
    """0..1 per pixel."""
    labs = [hunt_lab(np.clip(rgb_of_opponent(blurred(ycc, per_degree)), 0, 1)) for ycc in (ycc_a, ycc_b)]
    distance = hyab(*labs) ** COLOUR_EXPONENT
    green, blue = hunt_lab(np.array([[0.0, 1, 0], [0, 0, 1]]))
    largest = hyab(green, blue) ** COLOUR_EXPONENT
    cut = COLOUR_CUT * largest
    return np.where(distance < cut, COLOUR_SHARE / cut * distance,
                    COLOUR_SHARE + (distance - cut) / (largest - cut) * (1 - COLOUR_SHARE))


def features(ycc, per_degree):
    """Strength of edges and of points in the achromatic channel."""
    y = (ycc[..., 0] + 16) / 116
    sigma = 0.5 * FEATURE_DEGREES * per_degree
    radius = math.ceil(3 * sigma)
    x = np.arange(-radius, radius + 1)
    gauss = np.exp(-x ** 2 / (2 * sigma ** 2))
    strengths = []
    for shape in (-x * gauss, (x ** 2 / sigma ** 2 - 1) * gauss):
        kernel = shape.astype(float)
        kernel[shape > 0] /= shape[shape > 0].sum()
        kernel[shape < 0] /= -shape[shape < 0].sum()
        smooth = gauss / gauss.sum()
        strengths.append(np.hypot(along(along(y, kernel, 1), smooth, 0), along(along(y, kernel, 0), smooth, 1)))
    return strengths


def flip_of_linear(ours, truth, per_degree=PIXELS_PER_DEGREE):
    """FLIP per pixel of two pictures of linear RGB in 0..1."""
    a, b = opponent(ours), opponent(truth)
    colour = colour_difference(a, b, per_degree)
    edges, points = zip(features(a, per_degree), features(b, per_degree))
    feature = (np.maximum(np.abs(edges[0] - edges[1]), np.abs(points[0] - points[1])) / math.sqrt(2)) ** FEATURE_EXPONENT
    return colour ** (1 - np.clip(feature, 0, 1))


def tone_mapped(rgb):
    k = ACES
    return np.clip((k[0] * rgb ** 2 + k[1] * rgb + k[2]) / (k[3] * rgb ** 2 + k[4] * rgb + k[5]), 0, 1)


def exposures(truth):
    """Stops from where the brightest pixel of the truth is BRIGHT to where its median is (the median of the pixels that
    are not black, where most are)."""
    y = luminance(truth)
    if y.max() <= 0:
        return np.array([0.0])
    median = np.median(y)
    if median <= 0:
        median = np.median(y[y > 0])
    k, t = ACES, BRIGHT
    a, b, c = k[0] - t * k[3], k[1] - t * k[4], k[2] - t * k[5]
    x = (-b + math.sqrt(b * b - 4 * a * c)) / (2 * a)
    first, last = math.log2(x / y.max()), math.log2(x / median)
    return np.linspace(first, last, max(2, math.ceil(last - first)))


def hdr_flip(ours, truth, per_degree=PIXELS_PER_DEGREE):
    """HDR-FLIP per pixel: the largest FLIP over the exposures that the truth asks for."""
    ours, truth = np.maximum(np.asarray(ours, float), 0), np.maximum(np.asarray(truth, float), 0)
    out = np.zeros(truth.shape[:2])
    for stop in exposures(truth):
        out = np.maximum(out, flip_of_linear(tone_mapped(ours * 2 ** stop), tone_mapped(truth * 2 ** stop), per_degree))
    return out
