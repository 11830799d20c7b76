"""Digests of the messages of a run: for every few steps as the bag grows, and one of the run.

They are over the messages, by topic and in the order of their numbers, and not over the file: so they hold for every
storage, compression and order. That of the run is over what the player puts back; settings and results, which name
versions, are in the digests of the groups only.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.registry import RECORDED, REPLAYED
from kapitsa_ros.network.settings import decode_settings, encode_settings

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kapitsa_ros.network.step_id import StepId

DIGEST_TOPIC = 'recorder/digest'
"""std_msgs/String, JSON: what the group of steps before it comes to."""
DIGEST_KEY, LAST_GROUP_KEY = 'digest', 'last_group'
"""Keys of the bag's custom data: digest of the run, and of the last message about a group, to which the others lead."""
MOTION_KEY = 'motion_digest'
"""Key of the digest of the motion, see `MotionDigest`; where no step of the run is missing."""
MOST_STEPS = 10**12
"""Larger numbers are damage: simulated time would not hold them."""
SIZE = 16
"""Bytes of the digest of a message."""
_TOPICS = [(topic.name, topic in REPLAYED) for topic in RECORDED]
"""Names of what is recorded, and whether the player puts it back."""


def message_digest(raw: bytes) -> bytes:
    """Return the digest of one message: the first half of its SHA-256."""
    return sha256(raw).digest()[:SIZE]


@dataclass(frozen=True, kw_only=True, slots=True)
class Group:
    """What was written with a few steps; a long run has many."""

    run: int
    first: int
    last: int
    """Step of the last message: with `end`, that of the end of the run."""
    end: bool
    topics: tuple[str, ...]
    digests: bytes
    """Of the messages on each topic, of those steps that have one."""
    settings: Mapping[str, str]
    """Digest of the settings by role."""
    previous: str
    """Digest of the message about the group before; empty at the first."""
    own: str
    """Digest of the message about this one."""

    def digest(self, topic: str) -> str:
        """Return the digest of the messages on a topic."""
        if topic not in self.topics:
            return digest_of(())
        at = SIZE * self.topics.index(topic)
        return self.digests[at : at + SIZE].hex()


def digest_of(messages: Iterable[bytes]) -> str:
    """Return the digest of several messages, whose own are given."""
    return sha256(b''.join(messages)).hexdigest()[: 2 * SIZE]


def parse_group(raw: bytes) -> Group | None:
    """Read a message about a group; None where it is none."""
    try:
        values: Any = json.loads(decode_settings(raw))
        group = Group(
            run=values['run'],
            first=values['first'],
            last=values['last'],
            end=values['end'],
            topics=_shared(tuple(values['topics'])),
            digests=b''.join(map(_from_hexadecimal, values['topics'].values())),
            settings=_shared_settings(tuple(values['settings'].items())),
            previous=values['previous'],
            own=message_digest(raw).hex(),
        )
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        return None
    numbers = all(isinstance(each, int) for each in (group.run, group.first, group.last))
    return group if numbers and 0 <= group.first <= group.last <= MOST_STEPS else None


def _from_hexadecimal(text: str) -> bytes:
    digest = bytes.fromhex(text)
    if len(digest) != SIZE:
        raise ValueError(f'{text!r} is no digest')
    return digest


@lru_cache(maxsize=8)
def _shared(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return equal names as one object: one group has those of the other."""
    return names


@lru_cache(maxsize=8)
def _shared_settings(items: tuple[tuple[str, str], ...]) -> dict[str, str]:
    return dict(items)


class RunDigest:
    """Digests a run as it is written.

    Parameters
    ----------
    settings
        JSON text by role.

    """

    def __init__(self, settings: Mapping[str, str]) -> None:
        self._settings = {role: message_digest(encode_settings(text)).hex() for role, text in sorted(settings.items())}
        self._whole = sha256()
        self._group: dict[str, list[bytes]] = {}
        self._ids: list[StepId] = []
        self.last_group = ''
        """Digest of the last message about a group."""

    def add(self, step_id: StepId, messages: Mapping[str, bytes]) -> None:
        """Take in the messages of a step, by topic."""
        self._ids.append(step_id)
        for name, replayed in _TOPICS:
            if name in messages:
                digest = message_digest(messages[name])
                self._group.setdefault(name, []).append(digest)
                if replayed:
                    self._whole.update(digest)

    def close_group(self) -> bytes | None:
        """Return the message about the steps since the last; None where there were none."""
        if not self._ids:
            return None
        values = {
            'run': self._ids[-1].run,
            'first': self._ids[0].step,
            'last': self._ids[-1].step,
            'end': self._ids[-1].end,
            'topics': {name: digest_of(found) for name, found in self._group.items()},
            'settings': self._settings,
            'previous': self.last_group,
        }
        raw = encode_settings(json.dumps(values))
        self.last_group = message_digest(raw).hex()
        self._group, self._ids = {}, []
        return raw

    @property
    def value(self) -> str:
        """Of the run so far, in hexadecimal."""
        return self._whole.hexdigest()
