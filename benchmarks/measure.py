"""How benchmarks measure: CPU time, medians, and one JSON object a claim."""

from __future__ import annotations

import json
import os
import resource
import statistics
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import yaml

if TYPE_CHECKING:
    from collections.abc import Callable

REPEATS = 5
REPETITIONS = (1, 25)
"""Of the timings of 1997 in a shorter protocol and in a longer: the difference is without the start."""


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


def cpu_of_children() -> float:
    """Return the CPU time of all processes that this one has started and that have ended, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def cpu_of(pid: int) -> float:
    """Return the CPU time of a process so far, s."""
    fields = Path(f'/proc/{pid}/stat').read_text(encoding='utf-8').rpartition(')')[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


def memory_of(pid: int) -> float:
    """Return what a process takes of memory, shared pages by their share, MB."""
    lines = Path(f'/proc/{pid}/smaps_rollup').read_text(encoding='utf-8').splitlines()
    return sum(int(line.split()[1]) for line in lines if line.startswith('Pss:')) / 1024


def write_protocol(folder: str, repetitions: int) -> str:
    """Write the protocol of 1997 with so many timings a speed; return the path."""
    protocol = Path(folder, f'protocol_{repetitions}.yaml')
    speeds = ['2240 rpm', '2640 rpm', '2780 rpm']
    protocol.write_text(yaml.safe_dump({'speeds': speeds, 'swings': 3, 'repeats': repetitions}), encoding='utf-8')
    return str(protocol)
