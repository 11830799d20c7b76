"""The messages of a topic by step, in four bytes each."""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_NONE = -1
_LONGEST_GAP = 1000
"""Steps that may be missing before the next without it being kept apart; one that lies far beyond is damage."""


class StepMap:
    """Numbers of messages by step."""

    def __init__(self) -> None:
        self._near = array('i')
        """By step; `_NONE` where there is none."""
        self._far: dict[int, int] = {}
        self._size = 0

    def __len__(self) -> int:
        return self._size

    def get(self, step: int) -> int | None:
        """Return the number of the message of a step; None where there is none."""
        if step < len(self._near) and self._near[step] != _NONE:
            return self._near[step]
        return self._far.get(step)

    def put(self, step: int, message: int) -> None:
        """Note the message of a step that has none yet."""
        self._size += 1
        missing = step - len(self._near)
        if missing > _LONGEST_GAP:
            self._far[step] = message
            return
        if missing >= 0:
            self._near.extend([_NONE] * (missing + 1))
        self._near[step] = message

    def drop(self, first: int, last: int) -> None:
        """Leave out the messages from a step to another."""
        for step in range(first, min(last + 1, len(self._near))):
            self._size -= self._near[step] != _NONE
            self._near[step] = _NONE
        for step in [step for step in self._far if first <= step <= last]:
            del self._far[step]
            self._size -= 1

    def steps(self) -> NDArray[np.int64]:
        """Return the steps that have a message, in order."""
        near: NDArray[Any] = np.flatnonzero(np.array(self._near, np.int32) != _NONE)
        return np.concatenate((near, np.array(sorted(self._far), np.int64))).astype(np.int64, copy=False)
