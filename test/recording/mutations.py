"""Bags with something wrong in their bytes, and what reading them comes to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.sealed_motion import read_motion

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kapitsa_ros.recording.motion import Motion

SAME, SAID, REFUSED, SILENT = 'same', 'said', 'refused', 'silent'


def meaning(bag: RunBag) -> Any:
    """Return all that a bag says of its run."""
    run, motion = bag.run, bag.motion
    plain = (run.number, run.settings, run.speed_asked, run.release, run.readings, run.timings, run.complete)
    return plain, *numbers(motion)


def numbers(motion: Motion) -> tuple[Any, ...]:
    """Return all that a motion is."""
    return motion.stamps_ns.tobytes(), motion.angle.tobytes(), motion.rate.tobytes(), motion.gaps, motion.lost


def outcome(path: Path, right: Any) -> str:
    """Return what reading a bag comes to that ought to mean what is right."""
    try:
        bag = RunBag(path)
        found = meaning(bag)
        if numbers(read_motion(path)) not in (found[1:], right[1:]):
            return 'other numbers than all of it gives'
    except KapitsaError as error:
        return REFUSED if '\n' not in str(error) else f'more than a line: {error}'
    if found == right and not bag.defects:
        return SAME
    return SAID if bag.defects or bag.integrity.ok is False else SILENT


def mutants(raw: bytes, other: bytes, count: int, seed: int) -> Iterator[tuple[str, bytes]]:
    """Yield so many files that are not what they were, and how they differ; `other` is a file of the same kind."""
    chance = np.random.default_rng(seed)
    kinds = ('flip', 'byte', 'cut', 'zeros', 'page', 'splice', 'doubled', 'lost')
    for number in range(count):
        kind = kinds[number % len(kinds)]
        at, size = int(chance.integers(len(raw))), int(chance.integers(1, 600))
        bent = bytearray(raw)
        if kind == 'flip':
            bent[at] ^= 1 << int(chance.integers(8))
        elif kind == 'byte':
            bent[at] = int(chance.integers(256))
        elif kind == 'cut':
            del bent[at:]
        elif kind == 'zeros':
            bent[at:] = bytes(len(raw) - at)
        elif kind == 'page':
            bent[at : at + size] = bytes(len(bent[at : at + size]))
        elif kind == 'splice':
            bent = bytearray(raw[:at] + other[at:])
        elif kind == 'doubled':
            bent[at:at] = raw[at : at + size]
        else:
            del bent[at : at + size]
        yield f'{kind} at {at}', bytes(bent)
