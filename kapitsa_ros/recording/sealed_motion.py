"""The motion of a run alone, at the speed at which it can be unpacked and checked."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from kapitsa_ros.network.cdr import POINT_SIZE, RATE_AT, block_layout, decode_block, read_step_id, stamp_of
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import MOTION
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.motion import Motion, is_motion
from kapitsa_ros.recording.motion_digest import motion_digest
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.storage.bag_files import METADATA, storage_files
from kapitsa_ros.recording.storage.mcap_file import McapFile
from kapitsa_ros.recording.storage.mcap_records import messages_in

if TYPE_CHECKING:
    from os import PathLike

    from numpy.typing import NDArray

_FIRST = 2**17
"""Samples that there is room for at first."""
_LARGEST = 2**22
"""Bytes of a `metadata.yaml`."""


def read_motion(path: str | PathLike[str], run: int | None = None) -> Motion:
    """Return the pendulum's motion in a bag: that of `RunBag`, without the rest of it.

    The recorder gives the motion chunks of its own in MCAP and states its digest in `metadata.yaml`, see
    `MotionDigest`. Where what is found in these chunks has it, it is the motion that was written, whatever became of
    the rest, and nothing else is read. Everything else goes through `RunBag`: other bags, damaged ones, runs with gaps.

    Parameters
    ----------
    path
        Folder of the bag, or a storage file of it.
    run
        Number of the run, where the bag holds several.

    Raises
    ------
    BagError
        See `RunBag`.

    """
    motion = _sealed_motion(Path(path)) if run is None else None
    return RunBag(path, run).motion if motion is None else motion


class _Blocks(NamedTuple):
    """Where blocks of one size lie side by side in a chunk."""

    message: slice
    """The first of them."""
    points: int
    """Place of its first position."""
    stride: int
    """From one block to the next, bytes."""
    number: int
    samples: int
    """Of a block, both ends included."""


def _sealed_motion(folder: Path) -> Motion | None:
    """Return the motion if it is the one whose digest the recorder has stated."""
    try:
        [path] = storage_files(folder)
        with (folder / METADATA).open('rb') as metadata:
            stated = metadata.read(_LARGEST)
        file = McapFile(path)
        try:
            begin, period, (angle, rate) = _found(file)
        finally:
            file.close()
    except (BagError, WireError, OSError, ValueError):
        return None
    # No other motion has this digest, so it does not matter where in the text it stands.
    if motion_digest(begin, period, angle, rate).encode() not in stated or not is_motion(angle, rate):
        return None
    return Motion(np.arange(begin, begin + period * angle.size, period), angle, rate, 0, 0.0)


def _found(file: McapFile) -> tuple[int, int, NDArray[np.float64]]:
    """Return stamp of the first sample, period (ns), angle and rate (shape (2, N)) of what seems to be the motion.

    Chunks of one size are taken to be laid out alike, and blocks to follow one another: the digest tells whether they
    do. A block begins with the sample at which the one before ended.
    """
    series, size = np.empty((2, _FIRST)), 0
    begin = period = 0
    layouts: dict[int, list[_Blocks]] = {}
    for content in file.chunks_of(MOTION.name):
        if len(content) not in layouts:
            layouts[len(content)] = _layout(bytes(content))
        for blocks in layouts[len(content)]:
            if not size:
                begin, period = _times(bytes(content[blocks.message]))
                series[:, 0] = np.ndarray(2, '<f8', content, blocks.points, RATE_AT)
                size = 1
            shape = (2, blocks.number, blocks.samples - 1)
            more = shape[1] * shape[2]
            if size + more > series.shape[1]:
                series, old = np.empty((2, 2 * (size + more))), series
                series[:, :size] = old[:, :size]
            values = np.ndarray(shape, '<f8', content, blocks.points + POINT_SIZE, (RATE_AT, blocks.stride, POINT_SIZE))
            series[:, size : size + more].reshape(shape)[:] = values
            size += more
    if not size:
        raise WireError('no motion is there')
    return begin, period, series[:, :size]


def _layout(content: bytes) -> list[_Blocks]:
    """Return where the blocks in a chunk lie; the end of a run has none."""
    found: list[_Blocks] = []
    for message in messages_in(content):
        raw = content[message]
        layout = block_layout(raw)
        if layout is None and read_step_id(raw).end:
            continue
        if layout is None or layout[2] == 1:
            raise WireError('a block is laid out otherwise, or has one sample')
        _, at, samples = layout
        new = _Blocks(message, message.start + at, 0, 1, samples)
        last = found[-1] if found else new
        stride = new.points - last.points - (last.number - 1) * last.stride
        if found and samples == last.samples and stride in (last.stride, last.stride or stride):
            found[-1] = last._replace(stride=stride, number=last.number + 1)
        else:
            found.append(new)
    return found


def _times(raw: bytes) -> tuple[int, int]:
    """Return stamp and distance of the samples of a block, ns."""
    block = decode_block(raw)
    period = 0 if block is None else int(block.times_ns[1])
    if not 0 < period < SECOND:
        raise WireError('the samples of a block are not a motion')
    return stamp_of(raw), period
