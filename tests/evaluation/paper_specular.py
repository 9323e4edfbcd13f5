"""What surfaces reflect by the paper's way: of the four numbers that its volume has at a place (COUNT, PROPAGATE), the radiance
from where the lobe points. The paper gives no formula, and calls the result not of good quality (section 5)."""

import numpy as np

FLAGS = ("--transport", "propagate", "--injection", "count", "--grid", "32", "--visibility", "off", "--bounces", "0",
         "--gloss", "off")
METAL, DIELECTRIC = 0.9, 0.04  # reflectance along the normal, of the strips of scenes/generate.py
Y0, Y1 = np.sqrt(1 / (4 * np.pi)), np.sqrt(3 / (4 * np.pi))
COSINES, SAMPLES = 32, 1024


def unit(v):
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), 1e-12)


def lobe(roughness, front):
    """(all, mean cosine) by the view's cosine, i / (COSINES - 1): what a GGX lobe reflects of even light, with Schlick's Fresnel and
    the energy that Turquin (2019) gives back, and the mean cosine between it and the mirror's direction."""
    alpha = max(roughness ** 2, 1e-3)
    u = (np.arange(SAMPLES) + 0.5) / SAMPLES
    phi = 2 * np.pi * (0.618033988749895 * np.arange(SAMPLES) % 1)
    c2 = (1 - u) / (1 + (alpha ** 2 - 1) * u)
    h = np.stack([np.sqrt(1 - c2) * np.cos(phi), np.sqrt(1 - c2) * np.sin(phi), np.sqrt(c2)], axis=-1)
    out = []
    for i in range(COSINES):
        mu = max(i / (COSINES - 1), 1e-3)
        v = np.array([np.sqrt(1 - mu * mu), 0, mu])
        vh = h @ v
        l = 2 * vh[:, None] * h - v
        up = (l[:, 2] > 0) & (vh > 0)
        l, vh, hz = l[up], vh[up], h[up, 2]
        smith = [x * np.sqrt(alpha ** 2 + (1 - alpha ** 2) * y * y) for x, y in ((l[:, 2], mu), (mu, l[:, 2]))]
        weight = 2 * l[:, 2] * vh / np.maximum((smith[0] + smith[1]) * hz, 1e-12)
        fresnel = front + (1 - front) * (1 - vh) ** 5
        white = weight.sum() / SAMPLES
        mirror = np.array([-v[0], 0, mu])
        out.append(((weight * fresnel).sum() / SAMPLES * (1 + front * (1 - white) / max(white, 1e-6)),
                    (weight * (l @ mirror)).sum() / max(weight.sum(), 1e-12)))
    return np.array(out)


def looked_up(volume, grid, places):
    """Trilinear, (n, 3 colours, 4), of a volume with one cell more on each side."""
    at = (places - grid["origin"]) / grid["cell"] + 0.5  # in cells from the middle of the first
    dims = np.array(volume.shape[2::-1])
    at = np.clip(at, 0, dims - 1.000001)
    low = np.floor(at).astype(int)
    share, sum_ = at - low, 0
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, share, 1 - share), axis=-1)
        x, y, z = (low + corner).T
        sum_ = sum_ + weight[:, None, None] * volume[z, y, x]
    return sum_


def radiance(volume, grid, base, kinds, eye):
    """Of the pixels of these kinds, {name: mask}; 0 elsewhere. `base`: layers of a reference, `grid`: origin and cell, metres."""
    out = np.zeros(base["P"].shape)
    for mask in kinds.values():
        roughness, metalness = base["M"][mask][0, :2]
        places, n = base["P"][mask], unit(base["N"][mask])
        v = unit(np.asarray(eye) - places)
        cosine = np.clip((v * n).sum(axis=-1), 0, 1)
        mirror = 2 * cosine[:, None] * n - v
        table = lobe(roughness, METAL if metalness > 0 else DIELECTRIC)
        everything, along = (np.interp(cosine, np.arange(COSINES) / (COSINES - 1), table[:, i]) for i in (0, 1))
        c = looked_up(volume, grid, places)
        towards = Y1 * along[:, None] * (c[..., 1] * mirror[:, 1:2] + c[..., 2] * mirror[:, 2:3] + c[..., 3] * mirror[:, 0:1])
        out[mask] = everything[:, None] * np.maximum(Y0 * c[..., 0] + towards, 0)
    return out
