"""Pictures of what tests/bench/paper_bench wrote as floats: each injection beside the truth, and how far dense samples are
from COUNT, as the paper tells it."""

import pathlib

import numpy as np

import metrics
import pictures

SIZE = (90, 160)  # rows and columns, as the bench has them
OURS = "COUNT"  # the paper's own method


def frame(folder, light, method):
    return np.fromfile(folder / light / f"{method}.f32", dtype="<f4").reshape(*SIZE, 3).astype(float)


def with_pictures(rows, folder):
    """The rows with mse_to_ours, HDR-FLIP and their pictures' paths."""
    everywhere = np.ones(SIZE, bool)
    out = []
    for row in rows:
        light, method = row["case"], row["settings"]["method"]
        seen, truth, ours = (frame(folder / "floats", light, name) for name in (method, "truth", OURS))
        white = pictures.white_of(ours, everywhere)
        apart = pictures.displayed(seen, white) - pictures.displayed(ours, white)
        flip = metrics.hdr_flip(seen, truth)
        values = {**row["values"], "mse_to_ours": float((apart ** 2).mean()), "hdr_flip": float(flip.mean())}
        paths = pictures.separate(folder / "pictures" / f"{light}, {method}", seen, truth, everywhere, flip)
        out.append({**row, "values": values,
                    "images": {name: str(pathlib.Path(path).relative_to(folder)) for name, path in paths.items()}})
    return out
