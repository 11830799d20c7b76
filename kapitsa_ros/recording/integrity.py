"""Whether the messages of a run are those that were written; what is not is left out."""

from __future__ import annotations

from dataclasses import dataclass, field
from hashlib import sha256
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.network.registry import RECORDED, REPLAYED
from kapitsa_ros.recording.digest import DIGEST_KEY, LAST_GROUP_KEY, Group, digest_of
from kapitsa_ros.recording.run_index import all_steps, in_ranges, steps_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import NDArray

    from kapitsa_ros.recording.message_table import MessageTable
    from kapitsa_ros.recording.run_index import RunIndex

_SPLICED = 'its parts are of several recordings: give the bags that it was put together from'


@dataclass
class Integrity:
    """What the digests of a bag say of a run in it."""

    ok: bool | None = None
    """None: it carries no digests."""
    defects: list[str] = field(default_factory=list)
    refusal: str | None = None
    """Why nothing may be read from it, as it would be wrong; None: it may."""


def run_digest(index: RunIndex, table: MessageTable) -> str:
    """Return the digest of a run as it stands in a bag: see `RunDigest.value`."""
    whole = sha256()
    for step_id in index.ids([topic.name for topic in REPLAYED]):
        for topic in REPLAYED:
            message = index.find(topic.name, step_id)
            if message is not None:
                whole.update(table.digest(message))
    return whole.hexdigest()


def leave_out_damaged(index: RunIndex, table: MessageTable, promised: Mapping[str, str]) -> Integrity:
    """Check a run by its digests, and leave out the steps that are not as they were written.

    Parameters
    ----------
    index
        The run; the damaged steps are dropped from it.
    table
        Of its bag.
    promised
        The recorder's own words in the metadata, by their keys.

    """
    found = Integrity()
    if index.groups:
        found.ok = True
        _check_groups(index, table, found)
        _check_order(index.groups, found)
    elif index.conflicts:
        topic, step = min(index.conflicts)
        found.refusal = (
            f'step {step} of {topic} stands there twice with different content: '
            f'several runs of the number {index.number} were put together; give their bags one by one'
        )
    if not promised.keys().isdisjoint((DIGEST_KEY, LAST_GROUP_KEY)) and found.refusal is None:
        _check_promise(index, table, promised, found)
    return found


def _check_promise(index: RunIndex, table: MessageTable, promised: Mapping[str, str], found: Integrity) -> None:
    """Check by what the metadata state: every bag that states the digest of its run has digests of its steps."""
    has_messages = run_digest(index, table) == promised.get(DIGEST_KEY)
    found.ok = has_messages and _last_group(index) == promised.get(LAST_GROUP_KEY)
    if found.ok or found.defects:
        return
    if has_messages and not index.groups:
        found.defects.append(
            f'the digests of the steps of run {index.number} were taken out, though its metadata state them: '
            'nothing tells whether its settings are those that were recorded'
        )
    elif not index.groups or index.end is not None:
        found.refusal = 'its messages are not those whose digest its metadata states: files were exchanged'


def _last_group(index: RunIndex) -> str:
    """Return the digest of the last message about a group, as the metadata of a bag has it."""
    return max(index.groups, key=lambda group: group.last).own if index.groups else ''


def _check_groups(index: RunIndex, table: MessageTable, found: Integrity) -> None:
    kept: list[tuple[int, int]] = []
    wrong: set[str] = set()
    for group in index.groups:
        damaged = _damaged_topics(group, index, table)
        wrong |= damaged
        if not damaged:
            kept.append((group.first, group.last))
    topics = [*index.steps, *(set(index.ends) - set(index.steps))]
    there = all_steps(each[topic] for topic in topics for each in (index.steps, index.ends))
    for first, last in (lost := in_ranges(map(int, there[~_within(there, kept)]))):
        for topic in topics:
            index.drop(topic, first, last)
    if lost:
        what = ', '.join(sorted(wrong)) or 'whose digests are not there'
        found.defects.append(f'{steps_text(lost)} of run {index.number} are damaged ({what}) and left out')
    found.ok = not lost and not wrong


def _within(steps: NDArray[np.int64], ranges: list[tuple[int, int]]) -> NDArray[np.bool_]:
    """Return which steps lie in one of several ranges, of which first and last are given."""
    firsts, lasts = np.array([(-1, -1), *sorted(ranges)], np.int64).T
    return np.maximum.accumulate(lasts)[np.searchsorted(firsts, steps, 'right') - 1] >= steps


def _damaged_topics(group: Group, index: RunIndex, table: MessageTable) -> set[str]:
    span = range(group.first, group.last + 1)
    if len(span) > 10 * sum(map(len, index.steps.values())) + 10:
        return {'recorder/digest'}
    damaged = {topic for topic, step in index.conflicts if step in span}
    for topic in {topic.name for topic in RECORDED} | set(group.topics):
        numbers = [each[topic].get(step) for each in (index.steps, index.ends) for step in span]
        messages = [table.digest(number) for number in numbers if number is not None]
        if digest_of(messages) != group.digest(topic):
            damaged.add(topic)
    return damaged


def _check_order(groups: Iterable[Group], found: Integrity) -> None:
    """Refuse what was put together from several recordings."""
    ordered = sorted({group.own: group for group in groups}.values(), key=lambda group: (group.first, group.last))
    if any(left.settings != right.settings for left, right in pairwise(ordered)):
        found.refusal = _SPLICED
    for left, right in pairwise(ordered):
        if right.first == left.last + 1 and right.previous != left.own:
            found.refusal = _SPLICED
    if ordered and ordered[0].first == 0 and ordered[0].previous:
        found.refusal = _SPLICED
