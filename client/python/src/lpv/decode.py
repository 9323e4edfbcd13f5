"""Volumes from their parts: half floats, floats and COMPACT, plain or in zstd frames, whole or relative to a base. What
comes from the server is checked; a part that does not fit its header is compact.Malformed and never a wrong picture."""

from __future__ import annotations

import dataclasses
import itertools
from typing import Any, Iterator

import numpy as np
import xxhash
import zstandard
from numpy.typing import NDArray

from lpv import compact
from lpv.compact import Malformed
from lpv.v1 import volume_pb2

EDGE = 8
PER_CELL = 12  # colours x coefficients
MOST_PAYLOAD = 1 << 20
MOST_CELLS = 128 + 2
MOST_LAYERS = 8
HALF, FLOAT, COMPACT = (volume_pb2.VOLUME_FORMAT_HALF_FLOAT, volume_pb2.VOLUME_FORMAT_FLOAT,
                        volume_pb2.VOLUME_FORMAT_COMPACT)
_WORDS: dict[int, np.dtype[Any]] = {HALF: np.dtype("<u2"), FLOAT: np.dtype("<u4"), COMPACT: np.dtype("<i2")}


@dataclasses.dataclass(frozen=True)
class Shape:
    """What a volume and its base have in common."""

    format: int
    dims: tuple[int, int, int]  # x, y, z; with guard cells
    origin: tuple[float, float, float]
    cell: float
    stage: int
    groups: tuple[str, ...]
    scales: tuple[float, ...]

    @staticmethod
    def of(header: volume_pb2.VolumeHeader) -> Shape:
        guard, grid = header.guard_cells, header.grid
        if header.coefficients != 4 or header.brick_edge != EDGE or guard not in (0, 1):
            raise Malformed(f"a volume of {header.coefficients} coefficients in bricks of {header.brick_edge} with "
                            f"{guard} guard cells; this client reads 4, 8, and 0 or 1")
        if any(layer.HasField("grid") and layer.grid != grid for layer in header.layers):
            raise Malformed("a volume of several grids; this client reads one")
        dims = (grid.dims.x + 2 * guard, grid.dims.y + 2 * guard, grid.dims.z + 2 * guard)
        if not all(1 <= cells <= MOST_CELLS for cells in dims) or not 1 <= len(header.layers) <= MOST_LAYERS:
            raise Malformed(f"a volume of {dims} cells in {len(header.layers)} layers")
        kind = header.format or HALF
        if kind not in _WORDS:
            raise Malformed(f"a volume in format {kind}, which this client does not know")
        scales = tuple(1.0 if kind == FLOAT else layer.scale for layer in header.layers)
        if not all(0.0 < scale < np.inf for scale in scales):
            raise Malformed(f"a volume with the scales {scales}")
        origin = tuple(at - guard * grid.cell_size for at in (grid.origin.x, grid.origin.y, grid.origin.z))
        return Shape(kind, dims, (origin[0], origin[1], origin[2]), grid.cell_size, header.stage,
                     tuple(layer.group for layer in header.layers), scales)

    def boxes(self) -> list[tuple[slice, slice, slice]]:
        """Of each brick its cells, as z, y, x of an array."""
        x, y, z = ([slice(at, min(at + EDGE, cells)) for at in range(0, cells, EDGE)] for cells in self.dims)
        return [(depth, height, width) for depth, height, width in itertools.product(z, y, x)]


def cells_of(box: tuple[slice, slice, slice]) -> tuple[int, int, int]:
    return (box[0].stop - box[0].start, box[1].stop - box[1].start, box[2].stop - box[2].start)


@dataclasses.dataclass(frozen=True)
class State:
    """A volume as the server published it, bit for bit. Nobody changes it."""

    shape: Shape
    elements: NDArray[Any]  # (layers, z, y, x, colour, coefficient), of the format's type on the wire
    coefficients: dict[int, NDArray[np.int32]]  # COMPACT: of each brick that has come, (layers, 12, 512)

    def checksum(self) -> int:
        return int(xxhash.xxh64_intdigest(self.elements.tobytes()))

    def floats(self) -> NDArray[np.float32]:
        """SH coefficients in the unit of the volume's stage."""
        if self.shape.format == COMPACT:
            layers = [compact.floats_from(one, scale) for one, scale in zip(self.elements, self.shape.scales)]
            return np.stack(layers)
        kind = "<f2" if self.shape.format == HALF else "<f4"
        scales = np.array(self.shape.scales, np.float32).reshape(-1, 1, 1, 1, 1, 1)
        return self.elements.view(kind).astype(np.float32) * scales


class Decoder:
    """One volume, from its parts in order."""

    def __init__(self, header: volume_pb2.VolumeHeader, base: State | None) -> None:
        self.header = header
        self.shape = Shape.of(header)
        if base is not None and base.shape != self.shape:
            raise Malformed("a volume of another grid, stage, format, layers or scale than its base")
        self.zstd = header.compression == volume_pb2.PAYLOAD_COMPRESSION_ZSTD
        self._boxes = self.shape.boxes()
        self._came: set[int] = set()
        x, y, z = self.shape.dims
        self._elements: NDArray[Any] = (
            base.elements.copy() if base is not None else
            np.zeros((len(self.shape.groups), z, y, x, 3, 4), _WORDS[self.shape.format]))
        self._coefficients = dict(base.coefficients) if base is not None else {}

    def add(self, part: volume_pb2.VolumePart) -> None:
        bricks = list(self._claim(part))
        if not bricks:
            if part.payload:
                raise Malformed("a part with a payload and no bricks")
            return
        body = _unpacked(part.payload) if self.zstd else part.payload
        if self.shape.format == COMPACT:
            self._add_compact(bricks, body)
        else:
            self._add_words(bricks, body)

    def finish(self) -> State:
        """The volume. Malformed where the server meant another, for example because the base was another."""
        self._elements.flags.writeable = False
        state = State(self.shape, self._elements, self._coefficients)
        if state.checksum() != self.header.result.checksum:
            raise Malformed("a volume whose bricks do not give the checksum sent with it")
        return state

    def _claim(self, part: volume_pb2.VolumePart) -> Iterator[int]:
        for run in part.bricks:
            if run.first < 0 or run.count < 1 or run.first + run.count > len(self._boxes):
                raise Malformed(f"bricks {run.first} + {run.count} of {len(self._boxes)}")
            for brick in range(run.first, run.first + run.count):
                if brick in self._came:
                    raise Malformed(f"brick {brick} twice")
                self._came.add(brick)
                yield brick

    def _add_compact(self, bricks: list[int], body: bytes) -> None:
        layers = len(self.shape.groups)
        none = np.zeros((layers, compact.CHANNELS, compact.CELLS), np.int32)
        held = np.stack([self._coefficients.get(brick, none) for brick in bricks])
        compact.add_body(body, held)
        cubes = compact.elements_from(held.reshape(-1, compact.CHANNELS, compact.CELLS))
        cubes = cubes.reshape(-1, layers, EDGE, EDGE, EDGE, 3, 4)
        for brick, coefficients, cube in zip(bricks, held, cubes):
            box = self._boxes[brick]
            depth, height, width = cells_of(box)
            self._coefficients[brick] = coefficients
            self._elements[(slice(None), *box)] = cube[:, :depth, :height, :width]

    def _add_words(self, bricks: list[int], body: bytes) -> None:
        word = _WORDS[self.shape.format]
        layers = len(self.shape.groups)
        sizes = [cells_of(self._boxes[brick]) for brick in bricks]
        counts = [layers * depth * height * width for depth, height, width in sizes]
        if len(body) != sum(counts) * PER_CELL * word.itemsize:
            raise Malformed(f"a payload of {len(body)} bytes for {sum(counts)} cells")
        if self.zstd:
            kinds = _words_of_planes(body, word)
        else:
            kinds = np.frombuffer(body, word).reshape(-1, PER_CELL).T
        at = 0
        for brick, size, count in zip(bricks, sizes, counts):
            block = kinds[:, at:at + count].reshape(PER_CELL, layers, *size)
            at += count
            if self.zstd:
                block = _unpredicted(block)
            cells = np.moveaxis(block, 0, -1).reshape(layers, *size, 3, 4)
            where = (slice(None), *self._boxes[brick])
            self._elements[where] = self._elements[where] + cells if self.zstd else cells


def _unpacked(payload: bytes) -> bytes:
    try:
        size = zstandard.frame_content_size(payload)
        if not 0 <= size <= MOST_PAYLOAD:
            raise Malformed(f"a zstd frame that announces {size} bytes; the limit is {MOST_PAYLOAD}")
        body = zstandard.ZstdDecompressor().decompress(payload)
    except zstandard.ZstdError as error:
        raise Malformed(f"a zstd frame that is damaged: {error}") from None
    if len(body) != size:
        raise Malformed(f"a zstd frame of {len(body)} bytes that announces {size}")
    return body


def _words_of_planes(body: bytes, word: np.dtype[Any]) -> NDArray[Any]:
    """Byte planes to (12, cells) words, zigzag undone (VolumePart.payload)."""
    planes = np.frombuffer(body, np.uint8).reshape(PER_CELL, word.itemsize, -1)
    zigzag = np.ascontiguousarray(planes.transpose(0, 2, 1)).view(word)[..., 0]
    one = word.type(1)
    return (zigzag >> one) ^ (~(zigzag & one) + one)


def _unpredicted(block: NDArray[Any]) -> NDArray[Any]:
    """(12, layers, z, y, x) differences to the cell before: along x, of a row's first cell along y, of a slice's first
    along z, modulo the word."""
    out = block.copy()
    out[..., 0, 0] = np.cumsum(out[..., 0, 0], axis=-1, dtype=out.dtype)
    out[..., 0] = np.cumsum(out[..., 0], axis=-1, dtype=out.dtype)
    return np.cumsum(out, axis=-1, dtype=out.dtype)
