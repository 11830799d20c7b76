"""How benchmarks measure: CPU time, medians, and one JSON object a claim."""

from __future__ import annotations

import json
import statistics
import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

REPEATS = 5


@dataclass(frozen=True, kw_only=True)
class Claim:
    """Ours against one peer at one piece of work."""

    work: str
    peer: str
    target: str
    ours_s: float
    peer_s: float
    ours_error: float | None
    peer_error: float | None
    unit: str = 'rad'
    """Of the errors."""

    @property
    def ratio(self) -> float:
        """How many times cheaper ours is."""
        return self.peer_s / self.ours_s

    def show(self) -> None:
        """Print the claim as a line of JSON."""
        print(json.dumps({**asdict(self), 'ratio': self.ratio}), flush=True)


def cpu(*works: Callable[[], object]) -> list[float]:
    """Return the median CPU times of some works, all threads counted, s.

    They take turns, so that what else the machine does falls on all alike; each is done once before, unmeasured.
    """
    times: list[list[float]] = [[] for _ in works]
    for work in works:
        work()
    for _ in range(REPEATS):
        for work, record in zip(works, times, strict=True):
            start = time.process_time()
            work()
            record.append(time.process_time() - start)
    return [statistics.median(record) for record in times]
