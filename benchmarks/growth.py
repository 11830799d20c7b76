"""How cost grows: with simulated time, with samples and with experiments, each against a tenth or a half of it."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys

from measure import REPEATS, cpu

import kapitsa_ros as kr
from kapitsa_ros.physics.jigsaw import Jigsaw
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM

CAMPAIGN = """
import os, resource, sys
import kapitsa_ros as kr
if __name__ == '__main__':
    found = kr.campaign('ideal', experiments=int(sys.argv[1]))
    seconds = found.efficiency * found.wall * len(os.sched_getaffinity(0))
    print(seconds, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""
SPEED = 2500 * RPM


def main() -> None:
    """Print the claims as JSON."""
    one, ten = cpu(lambda: simulate(60.0), lambda: simulate(600.0))
    tell('CPU time of a simulated second, 600 s over 60 s', '<= 1.1', ten / one / 10)
    one, ten = cpu(lambda: advance(100), lambda: advance(1000))
    tell('CPU time of a sample, blocks of 1000 over blocks of 100', '<= 1.1', ten / one / 10)
    few, many = ([campaign(count) for _ in range(REPEATS)] for count in (100, 1000))
    seconds = statistics.median(s for s, _ in many) / statistics.median(s for s, _ in few) / 10
    tell('time of an experiment, campaign of 1000 over 100', '<= 1.1', seconds)
    each = statistics.median(s for s, _ in many) / 1000
    print(json.dumps({'work': 'an experiment of a campaign of 1000, CPU time', 'target': '<= 30 ms', 'ours_s': each}))
    grown = statistics.median(size for _, size in many) - statistics.median(size for _, size in few)
    print(json.dumps({'work': 'memory of a campaign of 1000 over one of 100', 'target': '<= 1 MB', 'megabytes': grown}))


def tell(work: str, target: str, ratio: float) -> None:
    """Print one claim."""
    print(json.dumps({'work': work, 'target': target, 'ratio': ratio}), flush=True)


def simulate(duration: float) -> None:
    """Let a rod swing."""
    kr.simulate('ideal', speed=SPEED, release=0.12, duration=duration)


def advance(samples: int) -> None:
    """Carry a rod through two hundred blocks of 0.1 s with so many samples."""
    plant = Plant()
    jigsaw, pendulum = Jigsaw(amplitude=plant.amplitude), Pendulum(plant)
    pendulum.hold(0.12)
    pendulum.release()
    for _ in range(200):
        pendulum.advance(jigsaw.advance(SPEED, 0.1, samples))


def campaign(experiments: int) -> tuple[float, float]:
    """Return the seconds of computing over those of a worker, and the memory of the program, MB."""
    command = [sys.executable, '-c', CAMPAIGN, str(experiments)]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)  # noqa: S603
    seconds, megabytes = map(float, done.stdout.split())
    return seconds, megabytes


if __name__ == '__main__':
    main()
