"""A long session: CPU time of each node, its memory at the beginning and at the end, missed deadlines and gaps.

Prints a JSON object a node, and one of the session.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from contextlib import suppress
from pathlib import Path

from measure import cpu_of, memory_of, write_protocol

from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.fork_server_process import fork_server
from kapitsa_ros.rig.session import watch
from kapitsa_ros.rig.setup import Setup, parameters

TIMING = 9.0
"""Simulated seconds that the timings of 1997 take on the mean, three speeds together."""
SETTLED = 10.0
"""Simulated seconds after which all that is loaded once is loaded."""


def nodes_of(server: int) -> dict[str, int]:
    """Return the processes that were forked from a server, by the role that is their name."""
    children = Path(f'/proc/{server}/task/{server}/children').read_text(encoding='utf-8').split()
    return {Path(f'/proc/{pid}/comm').read_text(encoding='utf-8').strip(): int(pid) for pid in children}


def main() -> None:
    """Print what a session of some length takes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--rate', type=float, default=1.0, help='simulated over wall seconds; 0: as fast as it can')
    parser.add_argument('--simulated', type=float, default=600.0, help='seconds, roughly')
    arguments = parser.parse_args()
    usages: list[tuple[float, dict[str, tuple[float, float]]]] = []
    said: dict[str, str] = {}
    with tempfile.TemporaryDirectory() as folder, fork_server() as server:

        def look(progress: dict[str, str]) -> None:
            said.update(progress)
            simulated = float(progress['simulated_s'])
            if simulated < SETTLED or progress['session_over'] == 'True':
                return
            with suppress(OSError):  # the nodes are leaving: the look before was the last
                nodes = nodes_of(server.pid)
                usages.append((simulated, {role: (cpu_of(pid), memory_of(pid)) for role, pid in nodes.items()}))

        protocol = write_protocol(folder, max(1, round(arguments.simulated / TIMING)))
        setup = Setup(protocol=protocol, rate=arguments.rate, bags=Path(folder, 'bags'))
        began = time.monotonic()
        watch(ROLE_NAMES, parameters(setup), look)
        wall = time.monotonic() - began
        counts = [RunBag(bag).motion_counts for bag in setup.bags.iterdir()]
        whole = [(at, usage) for at, usage in usages if usage.keys() == set(ROLE_NAMES)]
        (first, before), (last, after) = whole[0], whole[-1]
        for role in ROLE_NAMES:
            (cpu, memory), (cpu_then, memory_then) = before[role], after[role]
            each = 1e3 * (cpu_then - cpu) / (last - first)
            taken = {'node': role, 'cpu_ms_a_simulated_s': each, 'memory_mb': [memory, memory_then]}
            print(json.dumps(taken), flush=True)
    print(
        json.dumps(
            {
                'simulated_s': float(said['simulated_s']),
                'wall_s': wall,
                'deadline_misses': int(said['deadline_misses']),
                'samples': sum(samples for samples, _ in counts),
                'gaps': sum(gaps for _, gaps in counts),
            }
        )
    )


if __name__ == '__main__':
    main()
