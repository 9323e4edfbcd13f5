"""Pictures for people: ours, the reference, and where they differ, with a colour bar and numbers, and each alone."""

import collections

import numpy as np
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import metrics  # noqa: E402

Scale = collections.namedtuple("Scale", "colours least most")
DIFFERENCE, FLIP = Scale("RdBu_r", -1, 1), Scale("magma", 0, 1)
NOWHERE = "0.6"  # where no surface is


def displayed(rgb, white):
    """sRGB of linear radiance, `white` shown as white."""
    x = np.clip(np.asarray(rgb, float) / white, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def white_of(truth, surface):
    """The exposure of both pictures: a value that shows the surfaces of the reference well."""
    values = metrics.luminance(truth)[surface]
    values = values[values > 0]
    return 1.6 * float(np.percentile(values, 95)) if values.size else 1.0


def relative_difference(ours, truth, surface):
    """(ours - truth) / truth of the luminances of surfaces, the truth not below the floor; nan elsewhere."""
    a, b = metrics.luminance(ours), metrics.luminance(truth)
    mean = b[surface].mean() if surface.any() else 0.0
    out = np.full(b.shape, np.nan)
    if mean > 0:
        out[surface] = (a - b)[surface] / np.maximum(b[surface], metrics.FLOOR * mean)
    return out


def comparison(path, title, ours, truth, surface, numbers, flip=None):
    """Writes a PNG: ours, the reference, their relative difference (and FLIP), with `numbers`, a line of text, below."""
    white = white_of(truth, surface)
    panels = 3 if flip is None else 4
    height, width = surface.shape
    figure, axes = plt.subplots(1, panels, figsize=(4.2 * panels, 4.2 * height / width + 0.95), dpi=100)
    for axis in axes:
        axis.set_xticks([])
        axis.set_yticks([])
    axes[0].imshow(displayed(ours, white), interpolation="nearest")
    axes[0].set_title("ours", fontsize=9)
    axes[1].imshow(displayed(truth, white), interpolation="nearest")
    axes[1].set_title("reference", fontsize=9)
    difference = relative_difference(ours, truth, surface)
    shown = axes[2].imshow(difference, cmap=DIFFERENCE.colours, vmin=DIFFERENCE.least, vmax=DIFFERENCE.most, interpolation="nearest")
    axes[2].set_facecolor(NOWHERE)
    axes[2].set_title("(ours - reference) / reference", fontsize=9)
    figure.colorbar(shown, ax=axes[2], fraction=0.03, pad=0.02, extend="both").ax.tick_params(labelsize=7)
    if flip is not None:
        shown = axes[3].imshow(flip, cmap=FLIP.colours, vmin=FLIP.least, vmax=FLIP.most, interpolation="nearest")
        axes[3].set_title(f"HDR-FLIP, mean {flip.mean():.3f}", fontsize=9)
        figure.colorbar(shown, ax=axes[3], fraction=0.03, pad=0.02).ax.tick_params(labelsize=7)
    figure.suptitle(title, fontsize=10, y=0.99)
    figure.text(0.5, 0.02, numbers, ha="center", fontsize=8, family="monospace")
    figure.subplots_adjust(left=0.01, right=0.97, top=0.86, bottom=0.1, wspace=0.12)
    figure.savefig(path)
    plt.close(figure)


def coloured(values, scale):
    """RGB of a plane of numbers; nan is grey."""
    colours = matplotlib.colormaps[scale.colours].copy()
    colours.set_bad(NOWHERE)
    return colours(np.ma.masked_invalid((values - scale.least) / (scale.most - scale.least)))[..., :3]


def separate(folder, ours, truth, surface, flip=None):
    """Writes PNGs of a pixel for each of the frame's, what the panels of `comparison` are made of. Their paths by name."""
    white = white_of(truth, surface)
    shown = {"ours": displayed(ours, white), "reference": displayed(truth, white),
             "difference": coloured(relative_difference(ours, truth, surface), DIFFERENCE)}
    if flip is not None:
        shown["flip"] = coloured(flip, FLIP)
    folder.mkdir(parents=True, exist_ok=True)
    paths = {name: folder / f"{name}.png" for name in shown}
    for name, rgb in shown.items():
        plt.imsave(paths[name], rgb, metadata={"Software": None})
    return paths
