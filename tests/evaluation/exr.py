"""Reads and writes OpenEXR files as arrays."""

import numpy as np
import OpenImageIO as oiio


def read(path):
    """{layer: array (height, width, 3) or, for a channel alone, (height, width)}. Channels R, G, B without a layer are
    "radiance"."""
    image = oiio.ImageInput.open(str(path))
    if image is None:
        raise OSError(f"{path}: {oiio.geterror()}")
    spec = image.spec()
    values = image.read_image(oiio.FLOAT)
    image.close()
    at = {name: i for i, name in enumerate(spec.channelnames)}
    layers = {}
    for name in at:
        layer = name.rpartition(".")[0]
        if layer in layers:
            continue
        key = f"{layer}." if layer else ""
        axes = "RGB" if key + "R" in at else "XYZ"
        if all(key + axis in at for axis in axes):
            layers[layer] = values[..., [at[key + axis] for axis in axes]].astype(float)
    if "" in layers:
        layers["radiance"] = layers.pop("")
    if "object" in at:
        layers["object"] = values[..., at["object"]]
    return layers


def write(path, layers):
    """The reverse of read(); normals and positions (P, N, G) get X, Y, Z."""
    names, planes = [], []
    for layer, values in layers.items():
        if values.ndim == 2:
            names.append(layer)
            planes.append(values[..., None])
            continue
        axes = "XYZ" if layer in ("P", "N", "G") else "RGB"
        names += [axis if layer == "radiance" else f"{layer}.{axis}" for axis in axes]
        planes.append(values)
    values = np.ascontiguousarray(np.concatenate(planes, axis=2), np.float32)
    spec = oiio.ImageSpec(values.shape[1], values.shape[0], values.shape[2], oiio.FLOAT)
    spec.channelnames = names
    spec.attribute("compression", "zip")
    out = oiio.ImageOutput.create(str(path))
    if not out.open(str(path), spec) or not out.write_image(values) or not out.close():
        raise OSError(f"{path}: {out.geterror()}")
