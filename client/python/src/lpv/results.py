"""What clients see: volumes, frames and probes, as numpy arrays and, in a notebook, as pictures."""

from __future__ import annotations

import dataclasses
import functools
import io

import numpy as np
import PIL.Image
import xxhash
from numpy.typing import NDArray

from lpv.compact import Malformed
from lpv.decode import Decoder, State
from lpv.v1 import result_pb2, volume_pb2

_MOST_HELD = 3  # the base of two results in flight, and those two
_MOST_FRAME_BYTES = 512 << 20
_FLUENCE = np.float32(np.sqrt(4.0 * np.pi))  # of an L00 of 1: the integral of what it stands for over all directions


@dataclasses.dataclass(frozen=True)
class Volume:
    """A volume whose checksum was compared. `coefficients` is (layers, z, y, x, colour, coefficient): real SH of bands
    0 and 1, L00, L1-1, L10, L11, of each layer, cell and colour (r, g, b), in the unit of header.stage."""

    header: volume_pb2.VolumeHeader
    state: State = dataclasses.field(repr=False)
    received_bytes: int = 0

    @property
    def revision(self) -> int:
        return self.header.result.revision

    @property
    def result_id(self) -> int:
        return self.header.result.result_id

    @property
    def groups(self) -> tuple[str, ...]:
        return self.state.shape.groups

    @functools.cached_property
    def coefficients(self) -> NDArray[np.float32]:
        return self.state.floats()

    def fluence(self) -> NDArray[np.float32]:
        """Of all layers, (z, y, x, colour): the light that arrives from all directions, W/m^2."""
        light: NDArray[np.float32] = self.coefficients[..., 0].sum(axis=0) * _FLUENCE
        return light

    def centres(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """World x, y and z of the cells' centres, metres."""
        shape = self.state.shape
        x, y, z = (origin + shape.cell * (np.arange(cells) + 0.5) for origin, cells in zip(shape.origin, shape.dims))
        return x, y, z

    def picture(self, height: int = 240) -> PIL.Image.Image:
        """The fluence in the middle planes, seen along z, y and x, side by side; 99 % of it below white."""
        light = np.clip(self.fluence(), 0.0, None)
        z, y, x = (count // 2 for count in light.shape[:3])
        planes = [light[z, ::-1], light[:, y], np.swapaxes(light[:, ::-1, x], 0, 1)]
        white = max(float(np.quantile(light, 0.99)), 1e-30)
        shown = []
        for plane in planes:
            bytes_ = (255.0 * np.clip(plane / white, 0.0, 1.0) ** (1 / 2.2)).astype(np.uint8)
            image = PIL.Image.fromarray(bytes_, "RGB")
            shown.append(image.resize((max(1, height * image.width // image.height), height), PIL.Image.NEAREST))
        gap = 8
        out = PIL.Image.new("RGB", (sum(image.width + gap for image in shown) - gap, height), (255, 255, 255))
        at = 0
        for image in shown:
            out.paste(image, (at, 0))
            at += image.width + gap
        return out

    def _repr_png_(self) -> bytes:
        return _png(self.picture())


@dataclasses.dataclass(frozen=True)
class Frame:
    """A picture whose checksum was compared. `file` is the JPEG, PNG or EXR file as the server made it."""

    header: result_pb2.FrameHeader
    file: bytes = dataclasses.field(repr=False)

    @property
    def revision(self) -> int:
        return self.header.result.revision

    @functools.cached_property
    def array(self) -> NDArray[np.uint8]:
        """(height, width, colour), as shown. Of JPEG and PNG; an EXR's linear radiance is for readers of EXR."""
        if self.header.format == result_pb2.FRAME_FORMAT_EXR:
            raise ValueError("a frame in EXR is not read here: write Frame.file to a file, or ask for \"png\"")
        return np.asarray(PIL.Image.open(io.BytesIO(self.file)).convert("RGB"))

    def _repr_png_(self) -> bytes | None:
        if self.header.format == result_pb2.FRAME_FORMAT_EXR:
            return None
        return self.file if self.header.format == result_pb2.FRAME_FORMAT_PNG else _png(PIL.Image.fromarray(self.array))


@dataclasses.dataclass(frozen=True)
class Probe:
    """Irradiance at points, W/m^2: (n, colour), and whether the volume could tell."""

    info: volume_pb2.ResultInfo
    irradiance: NDArray[np.float64]
    valid: NDArray[np.bool_]
    #: with around=True: what ProbeResponse.harmonics says, (n, coefficient, colour)
    harmonics: NDArray[np.float32] | None = None
    #: unit vectors towards the main light, (n, 3), and its irradiance on what faces it, (n, colour)
    main_direction: NDArray[np.float64] | None = None
    main_irradiance: NDArray[np.float64] | None = None
    #: of 64 rays from each point, those that meet the back of a surface
    back_faces: NDArray[np.uint8] | None = None


def _png(image: PIL.Image.Image) -> bytes:
    out = io.BytesIO()
    image.save(out, "PNG")
    return out.getvalue()


class VolumeParts:
    """Parts to volumes, with the bases that deltas refer to."""

    def __init__(self) -> None:
        self._held: dict[int, State] = {}
        self._decoder: Decoder | None = None
        self._next = self._bytes = 0
        #: what comes now is a key frame, complete by itself
        self.whole = False

    def add(self, part: volume_pb2.VolumePart) -> Volume | None:
        """The volume where this was its last part. Malformed where the result is of no use: ask for a key frame, unless
        it was one."""
        try:
            return self._add(part)
        except Malformed:
            self._decoder = None  # its later parts are passed over
            raise

    def _add(self, part: volume_pb2.VolumePart) -> Volume | None:
        if part.HasField("header"):
            self.whole = part.header.base_result_id == 0
            self._decoder = Decoder(part.header, self._base(part.header.base_result_id))
            self._next = self._bytes = 0
        decoder = self._decoder
        if decoder is None:
            return None
        _check_part(part.index, self._next, part.result_id, decoder.header.result.result_id)
        decoder.add(part)
        self._next += 1
        self._bytes += len(part.payload)
        if self._next < decoder.header.part_count:
            return None
        self._decoder = None
        state = decoder.finish()
        self._hold(decoder.header, state)
        return Volume(decoder.header, state, self._bytes)

    def _base(self, result_id: int) -> State | None:
        if result_id == 0:
            return None
        if result_id not in self._held:
            raise Malformed(f"a volume relative to result {result_id}, which this client does not hold")
        return self._held[result_id]

    def _hold(self, header: volume_pb2.VolumeHeader, state: State) -> None:
        """Bases only move forward."""
        kept = {one: held for one, held in self._held.items() if one >= header.base_result_id}
        kept[header.result.result_id] = state
        self._held = dict(sorted(kept.items())[-_MOST_HELD:])


class FrameParts:
    """Parts to frames."""

    def __init__(self) -> None:
        self._header: result_pb2.FrameHeader | None = None
        self._file = bytearray()
        self._next = 0

    def add(self, part: result_pb2.FramePart) -> Frame | None:
        if part.HasField("header"):
            self._header, self._file, self._next = part.header, bytearray(), 0
        header = self._header
        if header is None:
            return None
        self._header = None
        _check_part(part.index, self._next, part.result_id, header.result.result_id)
        self._file += part.payload
        self._next += 1
        if len(self._file) > min(header.size, _MOST_FRAME_BYTES):
            raise Malformed(f"more bytes of a frame than the {header.size} that its header announced")
        if self._next < header.part_count:
            self._header = header
            return None
        if xxhash.xxh64_intdigest(bytes(self._file)) != header.result.checksum:
            raise Malformed("a frame whose bytes do not give the checksum sent with it")
        return Frame(header, bytes(self._file))


def _check_part(index: int, wanted: int, result_id: int, wanted_id: int) -> None:
    if index != wanted or result_id != wanted_id:
        raise Malformed(f"part {index} of result {result_id} in place of part {wanted} of result {wanted_id}")
