"""Whole bags of what is left of others."""

from __future__ import annotations

import json
import shutil
import tempfile
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING

from kapitsa_ros.errors import OPTION
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.registry import RECORDED
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.naming import name_of
from kapitsa_ros.recording.reader import open_runs
from kapitsa_ros.recording.storage.bag_files import METADATA
from kapitsa_ros.recording.storage_control import is_being_recorded
from kapitsa_ros.recording.writer import RunWriter

if TYPE_CHECKING:
    from kapitsa_ros.recording.reader import RunBag

_STEPS_A_CHUNK = 5
_TOPICS = [topic.name for topic in RECORDED]


@dataclass(frozen=True, kw_only=True)
class Recovered:
    """A bag that was made whole."""

    bag: Path
    steps: int
    """How many it holds."""
    lost: float
    """Seconds of motion that are missing in it; what the run did after its last step nobody knows."""
    reason: str
    """Why the run ended where it does."""
    defects: tuple[str, ...]
    """What is missing or damaged, a sentence each."""


def recover(path: Path, output: Path | None = None) -> list[Recovered]:
    """Make whole bags of the runs in a bag that was never closed, or was damaged.

    Parameters
    ----------
    path
        Folder of the bag, or a storage file.
    output
        Folder for the new bags; None: the new bag takes the place of the old one, where nothing is lost by it.

    Raises
    ------
    BagError
        Nothing can be read, something would be lost, or the disk does not take the new bag.

    """
    runs = open_runs(path)
    if output is None:
        (run,) = _in_place(path, runs)
        about = _about(run, path)  # now: it reads the old bag
        if run.is_whole:
            return [about]
        # Beside the old one: on the same disk, a folder takes the place of another in one step. A link stays one.
        place = path.resolve()
        with _folder_beside(place) as folder:
            made = Path(folder) / place.name
            _write(run, made)
            old = Path(folder) / f'{place.name}.old'
            place.rename(old)
            try:
                made.rename(place)
            except BaseException:  # else the old one would go with the folder
                old.rename(place)
                raise
        return [about]
    found, stem = [], Path(name_of(path)).stem
    for run in runs:
        target = output / (f'{stem}_run_{run.number:02d}' if run.several else stem)
        _write(run, target)
        found.append(_about(run, target))
    return found


def _in_place(path: Path, runs: tuple[RunBag, ...]) -> tuple[RunBag, ...]:
    if not path.is_dir():
        raise BagError(f'{path} is a file: say by {OPTION} in which folder the bag is to be', option='output')
    if is_being_recorded(path):
        raise BagError(f'{path} is being recorded: end the run first')
    lost = [f'topics of others ({", ".join(sorted(others))})' for run in runs[:1] if (others := run.foreign_topics)]
    lost += [defect for run in runs[:1] for defect in run.damages]
    if len(runs) > 1:
        lost.append(f'{len(runs)} runs in one bag')
    if lost:
        raise BagError(
            f'{path} holds more than one whole bag can take over: {"; ".join(lost)}; give {OPTION}', option='output'
        )
    return runs


def _folder_beside(path: Path) -> tempfile.TemporaryDirectory[str]:
    try:
        return tempfile.TemporaryDirectory(prefix='.', dir=path.parent)
    except OSError as error:
        raise BagError(f'{path.parent} cannot be written ({error.strerror}): give {OPTION}', option='output') from error


def _write(run: RunBag, path: Path) -> None:
    _ = run.run  # what is no run is refused before anything is written
    processor = '' if run.processor is None else json.dumps(run.processor)
    writer = RunWriter(path, run.storage, run.settings_texts, _STEPS_A_CHUNK, processor=processor)
    try:
        for _, step in groupby(run.raw(*_TOPICS), key=lambda message: read_step_id(message[2])):
            messages = list(step)
            writer.write_step(messages[0][1], {topic: raw for topic, _, raw in messages})
        writer.close(complete=run.complete)
    except BaseException:
        writer.abort()
        shutil.rmtree(path, ignore_errors=True)
        raise


def _about(run: RunBag, path: Path) -> Recovered:
    if run.complete:
        reason = 'it came to its end'
    elif run.finished:
        reason = 'it was interrupted: the recorder was told to leave before its end'
    else:
        reason = f'the recorder was killed, or the machine stopped, before it could write {METADATA}'
    return Recovered(bag=path, steps=run.steps, lost=run.motion.lost, reason=reason, defects=run.defects)
