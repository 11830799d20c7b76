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


def cpu(work: Callable[[], object], repeats: int = REPEATS) -> float:
    """Return the median CPU time of some work, all threads counted, s; it is done once before, unmeasured."""
    work()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return statistics.median(times)
