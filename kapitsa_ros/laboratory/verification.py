"""Whether a recorded run can be had again from its settings and seed: message by message, to the last bit."""

from __future__ import annotations

from dataclasses import dataclass, fields, is_dataclass
from hashlib import sha256
from itertools import groupby
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.laboratory.recomputed_run import COMPUTED, RecomputedRun, padded
from kapitsa_ros.network.cdr import read_step_id, stamp_of
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import COMMAND, REPLAYED
from kapitsa_ros.operator.command import Command
from kapitsa_ros.recording.digest import message_digest
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.writer import FORMAT

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.network.topic import Topic
    from kapitsa_ros.recording.reader import RunBag

_NAMES = [topic.name for topic in REPLAYED]


@dataclass(frozen=True, kw_only=True)
class Difference:
    """Where a recorded message is not the one that was computed again."""

    topic: str
    run: int
    step: int
    field: str
    recorded: Any
    recomputed: Any


@dataclass(kw_only=True)
class Verification:
    """What a recorded run is worth."""

    digest: str = ''
    """SHA-256 over the run as it was computed again; see `RunBag.digest`."""
    first_difference: Difference | None = None
    largest_ulp: int = 0
    """Of all floating-point values that differ, in units of the last place."""
    as_asked: bool = True
    """Whether the digest is the one that was asked for."""

    @property
    def identical(self) -> bool:
        """Whether every message is the same."""
        return self.as_asked and self.first_difference is None


def verify_run(bag: RunBag, digest: str | None = None) -> Verification:
    """Compute a run again from its recorded commands, settings and seed, and compare.

    The bytes are compared; where a bag was written in another layout, the decoded values, bit by bit.

    Parameters
    ----------
    bag
        The run.
    digest
        What the digest of the run has to be; None: the recorded messages say.

    Raises
    ------
    BagError
        It cannot be read, a step is missing, or its settings are not those of this version.

    """
    again = RecomputedRun(bag.run)
    return compare_run(
        bag, lambda step_id, command: again.end(step_id) if step_id.end else again.step(step_id, command), digest
    )


def compare_run(
    bag: RunBag, computed_again: Callable[[StepId, Command], Mapping[Topic[Any], bytes]], digest: str | None = None
) -> Verification:
    """Compare a run with what its commands come to once more; see `verify_run`.

    Parameters
    ----------
    bag
        The run.
    computed_again
        Returns the messages of a step to which its number and command lead.
    digest
        What the digest of the run has to be; None: the recorded messages say.

    """
    bag.refuse_gaps()
    if bag.absent:
        raise BagError(f'{bag.path} has no message on {", ".join(bag.absent)}: what is not there cannot be compared')
    found, whole = Verification(), sha256()
    try:
        for step_id, step in groupby(bag.raw(*_NAMES), key=lambda message: read_step_id(message[2])):
            recorded = {topic: raw for topic, _, raw in step}
            command = Command(0.0, None, end=True) if step_id.end else COMMAND.decode(recorded[COMMAND.name])
            computed = dict(computed_again(step_id, command))
            if not step_id.end:
                computed.setdefault(COMMAND, recorded[COMMAND.name])
            _note_missing(found, step_id, [topic for topic in COMPUTED if topic not in computed])
            for topic in REPLAYED:
                if topic in computed:
                    whole.update(message_digest(computed[topic]))
                    if topic.name in recorded and padded(recorded[topic.name]) != computed[topic]:
                        _compare(found, topic, recorded[topic.name], computed[topic], to_the_byte=bag.format == FORMAT)
    except (WireError, KeyError) as error:
        raise BagError(f'{bag.path} is damaged: {error}') from error
    found.digest = whole.hexdigest()
    found.as_asked = digest is None or found.digest == digest.lower()
    return found


def _note_missing(found: Verification, step_id: StepId, topics: list[Topic[Any]]) -> None:
    if topics and found.first_difference is None:
        found.first_difference = Difference(
            topic=topics[0].name,
            run=step_id.run,
            step=step_id.step,
            field='message',
            recorded='there',
            recomputed=None,
        )


def _compare(found: Verification, topic: Topic[Any], recorded: bytes, computed: bytes, *, to_the_byte: bool) -> None:
    differing = []
    for (name, left), (_, right) in zip(_fields(topic, recorded), _fields(topic, computed), strict=False):
        at = _differing(left, right)
        if at is not None:
            one, other = (value if np.ndim(value) == 0 else value[at] for value in (left, right))
            differing.append((name if np.ndim(left) == 0 else f'{name}[{at}]', _plain(one), _plain(other)))
            found.largest_ulp = max(found.largest_ulp, _ulp(left, right))
    if not differing and to_the_byte:
        differing.append(('bytes', recorded.hex(), computed.hex()))
    if differing and found.first_difference is None:
        step_id, (field, left, right) = read_step_id(recorded), differing[0]
        found.first_difference = Difference(
            topic=topic.name, run=step_id.run, step=step_id.step, field=field, recorded=left, recomputed=right
        )


def _fields(topic: Topic[Any], raw: bytes) -> list[tuple[str, Any]]:
    """Return names and values of what a message says: its stamp, and of a reading whether there is one."""
    value = None if read_step_id(raw).end else topic.decode(raw)
    named = [('reading', value is not None), ('stamp', stamp_of(raw))]
    if is_dataclass(value):
        named += [(item.name, getattr(value, item.name)) for item in fields(value)]
    return named


def _differing(left: Any, right: Any) -> int | None:
    """Return the place of the first difference, 0 for plain values; None where there is none."""
    if np.shape(left) != np.shape(right):
        return 0
    if np.ndim(left):
        places = np.flatnonzero(np.asarray(left).view(np.int64) != np.asarray(right).view(np.int64))
        return int(places[0]) if places.size else None
    return None if left == right else 0


def _ulp(left: Any, right: Any) -> int:
    one, other = np.atleast_1d(left), np.atleast_1d(right)
    if one.dtype != np.float64 or other.dtype != np.float64 or one.shape != other.shape:
        return 0
    steps = [np.where(bits < 0, np.int64(-(2**63)) - bits, bits) for bits in (one.view(np.int64), other.view(np.int64))]
    return max(abs(int(a) - int(b)) for a, b in zip(*steps, strict=True))


def _plain(value: Any) -> Any:
    return value.item() if hasattr(value, 'item') else value
