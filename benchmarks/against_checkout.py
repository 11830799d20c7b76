"""The graph against another checkout of this package, whose path is the argument and whose environment is set up there.

The two take turns, so that what else the machine does falls on both; ratios hold on any machine, seconds on this one.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from measure import REPEATS, REPETITIONS, Claim, cpu_of_children, write_protocol

HERE = Path(__file__).resolve().parents[1]
START = """
import json, sys, time
from kapitsa_ros.rig import Rig
begin = time.perf_counter()
with Rig(**json.loads(sys.argv[1])) as rig:
    rig.wait_for('pendulum/motion')
    started = time.perf_counter()
print(json.dumps([started - begin, time.perf_counter() - started]))
"""
TARGETS = {
    'kapitsa experiment, protocol of 1997, wall time': 2.6,
    'kapitsa experiment, protocol of 1997, CPU time': 2.9,
    'a simulated second at 1 kHz with the recorder, wall time': 1.9,
    'a step of the graph, CPU time of all': 2.1,
    'Rig entered to first step, wall time': 3.3,
    'Rig left, wall time': 2.0,
}
"""How many times cheaper than 1912ea9 each is to be, as processes."""


@dataclass(frozen=True)
class Checkout:
    """A checkout, and how its nodes are run."""

    folder: Path
    composed: bool = False

    def measured(self) -> dict[str, float]:
        """Return seconds by work."""
        with tempfile.TemporaryDirectory() as folder:
            wall, cpu, _ = self._experiment(Path(folder, 'bags'))
            found = []
            for repeats in REPETITIONS:
                bags = Path(folder, f'bags_{repeats}')
                _, used, answer = self._experiment(bags, '--protocol', write_protocol(folder, repeats))
                found.append((used, steps_in(bags), answer['realtime_factor']))
        (short_cpu, short_steps, _), (long_cpu, long_steps, factor) = found
        how = json.dumps({'composed': True} if self.composed else {})
        start = self._output('python', '-c', START, how)
        step = (long_cpu - short_cpu) / (long_steps - short_steps)
        return dict(zip(TARGETS, (wall, cpu, 1.0 / factor, step, *json.loads(start)), strict=True))

    def _experiment(self, bags: Path, *arguments: str) -> tuple[float, float, dict[str, Any]]:
        """Carry out an experiment; return wall and CPU time, and the answer."""
        how = ['--composed'] if self.composed else []
        begin, before = time.perf_counter(), cpu_of_children()
        output = self._output('kapitsa', 'experiment', '--json', '--bags', str(bags), *arguments, *how)
        return time.perf_counter() - begin, cpu_of_children() - before, json.loads(output)

    def _output(self, program: str, *arguments: str) -> bytes:
        command = [str(self.folder / '.venv' / 'bin' / program), *arguments]
        return subprocess.run(command, cwd=self.folder, check=True, stdout=subprocess.PIPE).stdout  # noqa: S603


def steps_in(bags: Path) -> int:
    """Return how many steps were recorded: no topic has more messages than one a step."""
    files = [yaml.safe_load(path.read_text('utf-8'))['rosbag2_bagfile_information'] for path in bags.rglob('*.yaml')]
    return sum(max(topic['message_count'] for topic in file['topics_with_message_count']) for file in files)


def main() -> None:
    """Print the claims as JSON."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('checkout', type=Path)
    parser.add_argument('--repeats', type=int, default=REPEATS)
    arguments = parser.parse_args()
    other = arguments.checkout.resolve()
    commit = subprocess.check_output(['/usr/bin/git', 'rev-parse', '--short', 'HEAD'], cwd=other, text=True).strip()
    checkouts = {'peer': Checkout(other), '': Checkout(HERE), ', composed': Checkout(HERE, composed=True)}
    found: dict[str, list[dict[str, float]]] = {name: [] for name in checkouts}
    for _ in range(arguments.repeats):
        for name, checkout in checkouts.items():
            found[name].append(checkout.measured())
    for name in ('', ', composed'):
        for work, target in TARGETS.items():
            ours, peer = (statistics.median(each[work] for each in found[which]) for which in (name, 'peer'))
            Claim(
                work=work + name,
                peer=f'the same at {commit}, as processes',
                target='' if name else f'>= {target}',
                ours_s=ours,
                peer_s=peer,
                ours_error=None,
                peer_error=None,
            ).show()


if __name__ == '__main__':
    main()
