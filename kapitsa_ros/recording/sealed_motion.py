"""The motion of a run alone, at the speed at which its bytes can be checked and unpacked."""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.network.cdr import NUMBER_LENGTH_AT, decode_blocks, read_step_id
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import MOTION
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.motion import Motion, is_motion
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.storage.bag_files import METADATA, storage_files
from kapitsa_ros.recording.storage.mcap_file import McapFile
from kapitsa_ros.recording.storage.stored_message import StoredTable

if TYPE_CHECKING:
    from collections.abc import Iterator
    from os import PathLike

    from kapitsa_ros.network.cdr import Blocks

_BATCH = 12
"""Chunks that are decoded at once: few enough for the processor's cache."""
_FIRST = 2**16
"""Samples that there is room for at first."""
_LARGEST = 2**22
"""Bytes of a `metadata.yaml`."""


def read_motion(path: str | PathLike[str], run: int | None = None) -> Motion:
    """Return the pendulum's motion in a bag: that of `RunBag`, without the rest of it.

    The recorder gives the motion chunks of its own and states their SHA-256 in `metadata.yaml`. Where they match, they
    are as they were written, whatever became of the rest, and nothing else is read. Everything else goes through
    `RunBag`: other bags, damaged ones, runs with gaps.

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


def _sealed_motion(folder: Path) -> Motion | None:
    """Return the motion if its chunks are those that the recorder has sealed, and it has no gap."""
    try:
        [path] = storage_files(folder)
        with (folder / METADATA).open('rb') as metadata:
            stated = metadata.read(_LARGEST)
        file = McapFile(path)
        seal = sha256()
        try:
            motion = _joined(_blocks(file, seal))
        finally:
            file.close()
    except (BagError, WireError, OSError, ValueError):
        return None
    # No other bytes have this digest, so it does not matter where in the text it stands.
    return motion if seal.hexdigest().encode() in stated else None


def _blocks(file: McapFile, seal: Any) -> Iterator[Blocks]:
    batch: list[bytes] = []
    for packed, content in file.chunks_of(MOTION.name):
        seal.update(packed)
        batch.append(content)
        if len(batch) == _BATCH:
            yield from _decoded(file, b''.join(batch))
            batch.clear()
    yield from _decoded(file, b''.join(batch))


def _decoded(file: McapFile, content: bytes) -> Iterator[Blocks]:
    for piece in file.messages_in(content) if content else ():
        rows = piece.data if isinstance(piece, StoredTable) else np.frombuffer(piece.data, np.uint8)[None]
        if rows.shape[1] <= NUMBER_LENGTH_AT:
            raise WireError('a message is too short')
        # Where numbers get a digit more, messages of one size are not laid out alike.
        lengths = rows[:, NUMBER_LENGTH_AT]
        parts = [rows] if (lengths == lengths[0]).all() else np.split(rows, np.flatnonzero(np.diff(lengths)) + 1)
        for part in parts:
            if (blocks := decode_blocks(part)) is not None:
                yield blocks
            elif len(part) > 1 or not read_step_id(part.tobytes()).end:
                raise WireError('a block is laid out otherwise')


def _joined(pieces: Iterator[Blocks]) -> Motion | None:
    """Return the motion of blocks that follow one another; None where they do not, or are none.

    A block begins with the sample at which the one before ended.
    """
    angle, rate, size = np.empty(_FIRST), np.empty(_FIRST), 0
    begin = last = period = 0
    for blocks in pieces:
        stamps, times = blocks.stamps_ns, blocks.times_ns
        if not size:
            period, begin, last = int(times[1:2].sum()), int(stamps[0]), int(stamps[0] - times[-1])
        in_line = (np.diff(stamps, prepend=last) == times[-1]).all()
        if period <= 0 or not in_line or not np.array_equal(times, np.arange(times.size) * period):
            return None
        last, more = int(stamps[-1]), blocks.position[:, 1:].size
        while size + more + 1 > angle.size:
            for series in (angle, rate):
                series.resize(2 * series.size, refcheck=False)  # nobody else has seen it
        for series, values in ((angle, blocks.position), (rate, blocks.rate)):
            if not size:
                series[0] = values[0, 0]
            series[1 + size : 1 + size + more].reshape(len(stamps), -1)[:] = values[:, 1:]
        size += more
    angle, rate = angle[: size + 1], rate[: size + 1]
    if not size or not is_motion(angle, rate):
        return None
    return Motion(np.arange(begin, begin + (size + 1) * period, period), angle, rate, 0, 0.0)
