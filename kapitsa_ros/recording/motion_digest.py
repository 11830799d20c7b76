"""The digest of a motion: over its values, whatever storage, compression and layout they stand in.

It is the SHA-256 of 88 bytes, in hexadecimal: stamp of the first sample and distance of the samples (ns, int64), their
number (uint64), the SHA-256 of all θ and that of all θ′ (float64 each, in order; the sample that two blocks share
counts once). All numbers are little-endian. So it can be recomputed from arrays alone.
"""

from __future__ import annotations

import struct
from hashlib import sha256
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.network.cdr import decode_block, stamp_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

_COUNTS = struct.Struct('<qqQ')


def motion_digest(begin_ns: int, period_ns: int, angle: NDArray[np.float64], rate: NDArray[np.float64]) -> str:
    """Return the digest of a motion without gaps; angle (rad) and rate (rad/s) are contiguous, of shape (N,)."""
    return _joined(begin_ns, period_ns, angle.size, sha256(angle.data).digest(), sha256(rate.data).digest())


class MotionDigest:
    """Digests a motion as it is written."""

    def __init__(self) -> None:
        self._angle, self._rate = sha256(), sha256()
        self._times: NDArray[np.int64] | None = None
        self._begin = self._end = self._period = self._size = 0
        self._even = True

    def add(self, raw: bytes) -> None:
        """Take in the message with the next block."""
        if not self._even:
            return
        block, stamp = decode_block(raw), stamp_of(raw)
        if block is None:
            self._even = False
            return
        if self._times is None:
            self._begin = self._end = stamp
            self._period, self._size = int(block.times_ns[1:2].sum()), 1
            self._angle.update(block.position[:1].data)
            self._rate.update(block.rate[:1].data)
        # Blocks of equal times have them in the same array.
        if block.times_ns is not self._times:
            self._times = block.times_ns
            self._even = self._period > 0 and np.array_equal(self._times, np.arange(self._times.size) * self._period)
        self._even = self._even and stamp == self._end
        self._end = stamp + int(self._times[-1])
        self._size += self._times.size - 1
        self._angle.update(block.position[1:].data)
        self._rate.update(block.rate[1:].data)

    @property
    def value(self) -> str | None:
        """Of the motion so far; None where it has no sample, or they are not equally far apart."""
        if self._times is None or not self._even:
            return None
        return _joined(self._begin, self._period, self._size, self._angle.digest(), self._rate.digest())


def _joined(begin_ns: int, period_ns: int, size: int, angle: bytes, rate: bytes) -> str:
    return sha256(_COUNTS.pack(begin_ns, period_ns, size) + angle + rate).hexdigest()
