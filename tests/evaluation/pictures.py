"""Pictures for people: ours, the reference, and where they differ, with a colour bar and numbers."""

import numpy as np
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

import metrics  # noqa: E402


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
    shown = axes[2].imshow(difference, cmap="RdBu_r", vmin=-1, vmax=1, interpolation="nearest")
    axes[2].set_facecolor("0.6")
    axes[2].set_title("(ours - reference) / reference", fontsize=9)
    figure.colorbar(shown, ax=axes[2], fraction=0.03, pad=0.02, extend="both").ax.tick_params(labelsize=7)
    if flip is not None:
        shown = axes[3].imshow(flip, cmap="magma", vmin=0, vmax=1, interpolation="nearest")
        axes[3].set_title(f"HDR-FLIP, mean {flip.mean():.3f}", fontsize=9)
        figure.colorbar(shown, ax=axes[3], fraction=0.03, pad=0.02).ax.tick_params(labelsize=7)
    figure.suptitle(title, fontsize=10, y=0.99)
    figure.text(0.5, 0.02, numbers, ha="center", fontsize=8, family="monospace")
    figure.subplots_adjust(left=0.01, right=0.97, top=0.86, bottom=0.1, wspace=0.12)
    figure.savefig(path)
    plt.close(figure)
