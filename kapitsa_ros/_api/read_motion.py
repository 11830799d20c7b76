"""`read_motion`: θ(t) of a recorded run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.recording.sealed_motion import read_motion as read

if TYPE_CHECKING:
    from pathlib import Path

    from kapitsa_ros.recording.motion import Motion


def read_motion(path: str | Path, run: int | None = None) -> Motion:
    """Read the motion of a recorded run, checked, several times as fast as with all the rest of it.

    Parameters
    ----------
    path
        Folder of the bag, or a storage file (.mcap, .db3) of it.
    run
        Number of the run, where the bag holds several.

    Returns
    -------
    Motion
        `.stamps_ns`, `.angle` (rad) and `.rate` (rad/s) of shape (N,), as `read_bag(path, run).motion` has them.

    Raises
    ------
    KapitsaError
        There is no bag, it is not one of this rig, or its motion was changed.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> kr.read_motion('bags/run_01_2240rpm').gaps
    0

    """
    return read(path, run)
