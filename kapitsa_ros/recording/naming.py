"""Names of runs on disk: number and speed, no date, so that equal experiments have equal names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.errors import OPTION
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.storage.bag_files import in_order, is_bag
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path


def run_name(number: int, speed: float) -> str:
    """Return the name of a run's bag; the speed is that of its first command, rad/s."""
    return f'run_{number:02d}_{round(speed / RPM)}rpm'


def name_of(path: Path) -> str:
    """Return the name of a file or folder, of `.` and `..` too."""
    return path.name if path.name not in {'', '..'} else path.resolve().name


def run_number(bag: Path) -> int:
    """Return the number in the name of a run's bag."""
    return int(bag.name.split('_')[1])


def refuse_existing(bags: Path, speeds: Sequence[float]) -> None:
    """Check that none of an experiment's runs is there already.

    Raises
    ------
    BagError
        One is.

    """
    for number, speed in enumerate(speeds, start=1):
        path = bags / run_name(number, speed)
        try:
            there = path.exists()
        except OSError as error:
            raise BagError(
                f'{OPTION}: cannot be looked into ({error.strerror}); give another folder', option='bags', value=bags
            ) from error
        if there:
            raise BagError(
                f'{path} exists: runs are never overwritten, give another {OPTION} or move it away', option='bags'
            )


def run_folders(paths: Iterable[Path]) -> tuple[Path, ...]:
    """Return the bags that paths lead to: a folder of bags stands for those in it, in the order of their numbers."""
    found: list[Path] = []
    for path in paths:
        try:
            runs = [] if is_bag(path) or not path.is_dir() else [each for each in path.iterdir() if is_bag(each)]
        except OSError:
            runs = []  # whoever opens it says why it cannot be
        found += sorted(runs, key=in_order) or [path]
    return tuple(found)


def repeats(bags: Sequence[Path]) -> tuple[str, ...]:
    """Return a warning for each bag that is given twice: its readings count twice, and the interval is too narrow."""
    places = [path.resolve() for path in bags]
    return tuple(
        f'{place.name} is given more than once: its readings count each time, which makes the interval too narrow'
        for place in sorted({place for place in places if places.count(place) > 1})
    )
