"""`read_bag`: a recorded run."""

from __future__ import annotations

from pathlib import Path

from kapitsa_ros.recording.reader import RunBag


def read_bag(path: str | Path, run: int | None = None) -> RunBag:
    """Read a recorded run.

    Parameters
    ----------
    path
        Folder of the bag, or a storage file (.mcap, .db3) of it.
    run
        Number of the run, where the bag holds several.

    Returns
    -------
    RunBag
        `.run` holds what was read and commanded, `.motion` the recorded motion, with `.to_pandas()`, `.defects`
        what is missing or damaged.

    Raises
    ------
    KapitsaError
        There is no bag, or it is not one of this rig.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> kr.read_bag('bags/run_01_2240rpm').motion.to_pandas().columns.tolist()
    ['time_s', 'angle_rad', 'rate_rad_s']

    """
    return RunBag(Path(path), run)
