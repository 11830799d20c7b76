"""The graph at full speed, as processes and composed: CPU time a step and simulated over wall seconds.

CPU time is of the nodes alone, and of what they are forked from; the start is taken off by a shorter protocol. The peer
is what others would do: one JointState a sample, through as many nodes, as processes or in one.
"""

from __future__ import annotations

import json
import statistics
import tempfile
from pathlib import Path

import joint_state_peer
from measure import REPEATS, REPETITIONS, Claim, cpu_of_children, write_protocol

from kapitsa_ros.network.registry import PIVOT, ROLE_NAMES
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.fork_server_process import fork_server
from kapitsa_ros.rig.session import watch
from kapitsa_ros.rig.setup import Setup, parameters

SAMPLES_A_STEP = 100


def main() -> None:
    """Print the claims as JSON."""
    found: dict[bool, list[tuple[float, float]]] = {False: [], True: []}
    for _ in range(REPEATS):
        for composed, record in found.items():
            (short_cpu, short_steps, _), (cpu, steps, factor) = (measured(n, composed=composed) for n in REPETITIONS)
            record.append(((cpu - short_cpu) / (steps - short_steps), factor))
    processes, composed_cpu = (statistics.median(cpu for cpu, _ in found[composed]) for composed in (False, True))
    peers = {
        'as processes': (processes, joint_state_peer.as_processes),
        'composed': (composed_cpu, joint_state_peer.composed),
    }
    for work, (ours, measure_peer) in peers.items():
        peer = statistics.median(measure_peer() for _ in range(REPEATS))
        Claim(
            work=f'a step of the graph at 1 kHz with the recorder, {work}, CPU time of all nodes',
            peer=f'one JointState a sample through as many nodes, {work}',
            target='<= 1.5 ms, ratio >= 30',
            ours_s=ours,
            peer_s=SAMPLES_A_STEP * peer,
            ours_error=None,
            peer_error=None,
        ).show()
    for work, composed, target in (('as processes', False, '>= 120'), ('composed', True, '>= 100')):
        factor = statistics.median(factor for _, factor in found[composed])
        print(json.dumps({'work': f'the graph {work}, simulated over wall seconds', 'target': target, 'ratio': factor}))


def measured(repetitions: int, *, composed: bool) -> tuple[float, int, float]:
    """Carry out the protocol of 1997 with so many timings a speed; return CPU time, steps and the real-time factor."""
    before = cpu_of_children()
    with tempfile.TemporaryDirectory() as folder:
        setup = Setup(protocol=write_protocol(folder, repetitions), bags=Path(folder, 'bags'))
        with fork_server():
            monitor, _ = watch(ROLE_NAMES, parameters(setup), lambda _: None, composed=composed)
        cpu = cpu_of_children() - before
        steps = sum(len(list(RunBag(bag).raw(PIVOT.name))) for bag in setup.bags.iterdir())
    return cpu, steps, monitor.realtime_factor


if __name__ == '__main__':
    main()
