"""What proto/wire/COMPACT.md states, for tests."""

import pathlib

import numpy as np

from lpv.v1 import volume_pb2

PAGE = pathlib.Path(__file__).resolve().parents[3] / "proto" / "wire" / "COMPACT.md"


def fenced(name):
    """The words of each line between the fence of that name and the next."""
    lines = PAGE.read_text(encoding="utf-8").split("\n")
    first = lines.index(f"```{name}") + 1
    return [line.split() for line in lines[first:lines.index("```", first)] if line.strip()]


class Result:
    def __init__(self, scales):
        self.scales = scales
        self.bricks = []
        self.payload = b""
        self.elements, self.decoded = {}, {}  # (layer, z, y, x) to (colour, coefficient)
        self.checksum = 0

    def take(self, word, rest, layered):
        if word == "scale":
            self.scales = [float(rest[0])]
        elif word == "bricks":
            self.bricks.append((int(rest[0]), int(rest[1])))
        elif word in ("length", "runs", "values"):
            self.payload += bytes.fromhex("".join(rest))
        elif word in ("element", "decoded"):
            layer, place = (int(rest[0]), rest[1:]) if layered else (0, rest)
            x, y, z = map(int, place[:3])
            numbers = np.array(place[3:], float).reshape(3, 4)
            (self.elements if word == "element" else self.decoded)[layer, z, y, x] = numbers
        elif word == "checksum":
            self.checksum = int(rest[0], 16)

    def header(self, dims, base):
        out = volume_pb2.VolumeHeader(coefficients=4, format=volume_pb2.VOLUME_FORMAT_COMPACT, brick_edge=8,
                                      part_count=1, compression=volume_pb2.PAYLOAD_COMPRESSION_NONE,
                                      base_result_id=base)
        out.grid.dims.x, out.grid.dims.y, out.grid.dims.z = dims
        out.grid.cell_size = 1.0
        for scale in self.scales:
            out.layers.add(scale=scale)
        out.result.result_id, out.result.checksum = base + 1, self.checksum
        return out

    def part(self):
        out = volume_pb2.VolumePart(payload=self.payload)
        for first, count in self.bricks or [(0, 1)]:
            out.bricks.add(first=first, count=count)
        return out


def example(name):
    """The grid and the results of "compact-example" or "compact-vector"."""
    dims, scales, results = None, [], []
    for word, *rest in fenced(name):
        if word == "grid":
            dims = tuple(map(int, rest))
        elif word == "scales":
            scales = [float(one) for one in rest]
        elif word == "result":
            results.append(Result(scales))
        elif results:
            results[-1].take(word, rest, name == "compact-vector")
    return dims, results
