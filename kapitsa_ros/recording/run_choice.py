"""Which run of a recording is meant, and whether it is one of this rig."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.network.registry import COMMAND, READINGS, RIG_ROLES, described_by, writer_of
from kapitsa_ros.network.settings import settings_topic
from kapitsa_ros.recording.errors import BagError, printable
from kapitsa_ros.recording.joint_samples import joint_names
from kapitsa_ros.recording.writer import FORMAT, FORMAT_KEY

if TYPE_CHECKING:
    from pathlib import Path

    from kapitsa_ros.recording.recording import Recording
    from kapitsa_ros.recording.run_index import RunIndex

RUN_TOPICS = (COMMAND, *READINGS)
"""Those that make a run."""
_MOST_NAMED = 3
_DIGITS = 10
"""Of a format that are read; what has more is of the future in any case."""
REQUIRED_ROLES = [role for role in RIG_ROLES if not role.optional]


def format_of(recording: Recording) -> int:
    """Return the format that a bag states, 0 where it states none."""
    text = recording.promise.custom.get(FORMAT_KEY, '0')
    return int(text[:_DIGITS]) if text.isdecimal() else 0


def begun_runs(recording: Recording) -> list[int]:
    """Return the numbers of the runs that have a step; of one that was never begun there are commands only."""
    return sorted(number for number, index in recording.runs.items() if index.last >= 0)


def chosen_run(path: Path, recording: Recording, run: int | None) -> RunIndex:
    """Return the run with a number, or the only one.

    Raises
    ------
    BagError
        There is no such run, no run of this rig, or several and none is named.

    """
    _refuse_others(path, recording)
    numbers = begun_runs(recording) or sorted(recording.runs)
    if not numbers:
        raise BagError(f'{path} holds no step of a run')
    if run is None and len(numbers) == 1:
        return recording.runs[numbers[0]]
    if run in recording.runs:
        return recording.runs[run]
    raise BagError(
        f'{path} holds runs {", ".join(map(str, numbers))}'
        + (': take it apart by open_runs, or give the number of one' if run is None else f', not {run}')
    )


def _refuse_others(path: Path, recording: Recording) -> None:
    stated = format_of(recording)
    if stated > FORMAT:
        raise BagError(f'{path} has format {stated}, this version reads up to {FORMAT}: install a newer kapitsa_ros')
    if not recording.topics:
        damage = f'is damaged: {recording.damages[0]}' if recording.damages else 'is empty: the run was never begun'
        raise BagError(f'{path} {damage}')
    if len(recording.namespaces) > 1:
        there = ', '.join(f'/{printable(each)}' for each in recording.namespaces)
        raise BagError(f'{path} holds the rigs of {there}: record, or convert to a bag of its own, the topics of one')
    needed = [topic.name for topic in RUN_TOPICS if not writer_of(topic).optional]
    needed += map(settings_topic, described_by(REQUIRED_ROLES))
    missing = [name for name in needed if name not in recording.topics]
    wrong = [recording.wrong_types[name] for name in needed if name in recording.wrong_types]
    if missing or wrong:
        lacks = [f'it lacks {", ".join(missing)}'] if missing else []
        joints = joint_names(path)[:_MOST_NAMED]
        mend = (
            f'; joint {" or ".join(map(printable, joints))} in it is analysed by '
            f'`kapitsa analyse {path} --joint NAME --speed RPM`, which is all that can be done with a bag of others'
        )
        why = '; '.join([*lacks, *(wrong[:1] or recording.damages[:1])])  # what is damaged may be what it lacks
        raise BagError(f'{path} is no run of this rig: {why}{mend * bool(joints)}')
