"""VOLUME_FORMAT_COMPACT from bytes to elements and to floats: proto/wire/COMPACT.md, whose sections are named here."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CHANNELS = 12  # section 3: element x colour component
CELLS = 512
MOST = 1 << 22  # magnitude of a coefficient
MOST_SHIFT = 22
MOST_VALUE_BYTES = 4
SKIP, END = 254, 255

# Section 3. Rows of M are components, columns colours; rows of B are frequencies, columns cells.
_M = np.array([[2, 2, 2], [2, 0, -2], [1, -2, 1]], np.float64)
_B = np.array([[64, 64, 64, 64, 64, 64, 64, 64],
               [89, 75, 50, 18, -18, -50, -75, -89],
               [83, 36, -36, -83, -83, -36, 36, 83],
               [75, -18, -89, -50, 50, 89, 18, -75],
               [64, -64, -64, 64, 64, -64, -64, 64],
               [50, -89, 18, 75, -75, -18, 89, -50],
               [36, -83, 83, -36, -36, 83, -83, 36],
               [18, -50, 75, -89, 89, -75, 50, -18]], np.float64)


def _scan() -> NDArray[np.intp]:
    w, v, u = np.unravel_index(np.arange(CELLS), (8, 8, 8))
    return np.lexsort((u, v, w, u + v + w))


SCAN = _scan()  # section 5: where in a channel its places lie


class Malformed(ValueError):
    """Bytes that no server of this protocol sends."""


def _values(section: NDArray[np.uint8]) -> NDArray[np.int64]:
    """All values of the second section."""
    if section.size == 0:
        return np.zeros(0, np.int64)
    ends = np.flatnonzero(section < 0x80)
    if ends.size == 0 or ends[-1] != section.size - 1:
        raise Malformed("the payload ends within a value")
    begins = np.append(np.zeros(1, ends.dtype), ends[:-1] + 1)
    if int((ends - begins).max()) >= MOST_VALUE_BYTES:
        raise Malformed(f"a value has more than {MOST_VALUE_BYTES} bytes")
    which = np.repeat(np.arange(ends.size), ends - begins + 1)
    shifts = 7 * (np.arange(section.size) - begins[which])
    zigzag = np.bincount(which, weights=((section & 0x7F).astype(np.int64) << shifts).astype(np.float64))
    whole = zigzag.astype(np.int64)
    return (whole >> 1) ^ -(whole & 1)


class _Runs:
    """The first section: where values stand."""

    def __init__(self, section: bytes) -> None:
        self.section, self.at = section, 0

    def take(self) -> int:
        if self.at == len(self.section):
            raise Malformed("the payload ends within a brick")
        self.at += 1
        return self.section[self.at - 1]

    def channel(self, first: int, places: list[int]) -> None:
        """Appends the places of one channel's values, counted from `first`."""
        at = 0
        while at < CELLS:
            run = self.take()
            if run == END:
                return
            at += run
            if run == SKIP:
                continue
            if at >= CELLS:
                raise Malformed("a value lies beyond its channel")
            places.append(first + int(SCAN[at]))
            at += 1


def add_body(body: bytes, coefficients: NDArray[np.int32]) -> None:
    """Adds the differences of a message's body (section 5) to the coefficients: (bricks, layers, 12, 512)."""
    if len(body) < 4:
        raise Malformed(f"the payload has {len(body)} bytes, and begins with 4")
    length = int.from_bytes(body[:4], "little")
    if length > len(body) - 4:
        raise Malformed(f"the payload has {len(body) - 4} bytes behind its length, but a first section of {length}")
    runs = _Runs(body[4:4 + length])
    values = _values(np.frombuffer(body, np.uint8, offset=4 + length))
    bricks, layers = coefficients.shape[:2]
    blocks = coefficients.reshape(bricks * layers, CHANNELS * CELLS)
    taken = 0
    for block in blocks:
        shift = runs.take()
        if shift > MOST_SHIFT:
            raise Malformed(f"a brick's shift is {shift}; allowed are 0 to {MOST_SHIFT}")
        places: list[int] = []
        for channel in range(CHANNELS):
            runs.channel(channel * CELLS, places)
        if taken + len(places) > values.size:
            raise Malformed("the payload ends within a brick")
        sums = block[places] + (values[taken:taken + len(places)] << shift)
        if sums.size and int(np.abs(sums).max()) > MOST:
            raise Malformed(f"a coefficient is beyond +-{MOST}")
        block[places] = sums
        taken += len(places)
    if runs.at != length or taken != values.size:
        raise Malformed("the payload has bytes left over after its bricks")


def elements_from(coefficients: NDArray[np.int32]) -> NDArray[np.int16]:
    """Section 3, of (n, 12, 512) coefficients: (n, z, y, x, colour, element), all 8 x 8 x 8 cells. The sums are whole
    numbers below 2^53, so doubles hold them exactly, in whatever order they are made."""
    cubes = coefficients.reshape(-1, 4, 3, 8, 8, 8).astype(np.float64)
    cubes = np.einsum("nekwvu,kc->necwvu", cubes, _M)
    cubes = cubes @ _B  # u to x
    cubes = np.swapaxes(np.swapaxes(cubes, -1, -2) @ _B, -1, -2)  # v to y
    cubes = np.swapaxes(np.swapaxes(cubes, -1, -3) @ _B, -1, -3)  # w to z
    rounded = np.rint(cubes * 2.0**-23)
    rounded[:, 0] = np.clip(rounded[:, 0], 0, 32767)
    rounded[:, 1:] = np.clip(rounded[:, 1:], -4096, 4096)
    return np.ascontiguousarray(rounded.transpose(0, 3, 4, 5, 2, 1).astype(np.int16))


def floats_from(elements: NDArray[np.int16], scale: float) -> NDArray[np.float32]:
    """Section 1, of (..., 4) elements: L00, L1-1, L10, L11."""
    light = np.float32(scale) * np.exp2(elements[..., 0].astype(np.float32) * np.float32(1 / 1440))
    out = elements.astype(np.float32) * (light * np.float32(np.sqrt(3) / 2048))[..., None]
    out[..., 0] = light - np.float32(scale)
    return out
