"""How far off a stream's frame is: what `service_bench --still` leaves, against a path-traced reference."""

import json
import math
import pathlib
import sys

import numpy as np

import exr
import metrics

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "scenes"))
import gltf  # noqa: E402  (beside it)

UNSAID = (0.8, 0.8, 0.8)  # a surface's albedo unless it is said
SAMPLES = 64  # paths per pixel: noise that is larger than the error, but known


def scene_file(folder, base):
    """The scene of a still as a .glb in its folder. `base`: the file that the bench loaded, or None."""
    said = json.loads((folder / "scene.json").read_text())
    mesh = {name: (np.array(part["positions"]).reshape(-1, 3), np.array(part["indices"]).reshape(-1, 3))
            for name, part in said.items()}
    scene = gltf.Scene.opened(base) if base else gltf.Scene()
    if "room" in mesh:
        scene.surface("room", mesh["room"], UNSAID)
    scene.light("bench", mesh["light"], (said["light"]["radiance"],) * 3)
    path = folder / "scene.glb"
    scene.write(path)
    return path


def errors(folder, base, view, embree):
    """NRMSE over the surfaces of the frame, against all bounces, with the reference's noise and what is left without it:
    both are of independent errors, whose squares add up. `view`: None for the server's choice."""
    ours = exr.read(folder / "frame.exr")["radiance"]
    size = (ours.shape[1], ours.shape[0])
    file = scene_file(folder, base)
    truths, _, _ = embree.pictures(file, view or embree.default_view(file, size), size, SAMPLES, ["all"])
    truth = truths["all"]
    surface = (metrics.luminance(truth["A"]) > 0) & (truth["object"] > 0)
    found = metrics.compare(ours[surface], truth["radiance"][surface], None, (truth["A"] * truth["Ese"] / np.pi)[surface])
    noisy, noise = found["nrmse"], found["nrmse_of_reference"]
    return {"nrmse": math.sqrt(max(noisy * noisy - noise * noise, 0.0)), "nrmse_with_noise": noisy}
