"""Whatever is killed, and whenever: half a simulated second is lost at most, and every bag opens."""

import os
import random
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from kapitsa_ros.laboratory.bag_analysis import analyse_bags
from kapitsa_ros.network.registry import CLIENT, ROLE_NAMES, WRITTEN
from kapitsa_ros.operator.protocol import MANUAL
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.recover import recover
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import Setup, parameters
from kapitsa_ros.ros.rig_client import RigClient

pytestmark = pytest.mark.xdist_group('harness')
TARGETS = {'recorder': ['recorder'], 'pendulum': ['pendulum'], 'group': list(ROLE_NAMES)}
PATIENCE = 180.0


def kill(folder: Path, storage: str, rate: float, roles: list[str], at_step: int) -> tuple[Path, int]:
    """Kill nodes of a rig once a step has been written; return the bag, and how many steps were acknowledged."""
    setup = Setup(bags=folder, storage=storage, rate=rate, protocol=MANUAL)  # goes on until somebody ends it
    values = parameters(setup)
    with on_loopback(), reserved_domain() as domain:
        client = RigClient(domain)
        with client, NodeGroup(ROLE_NAMES, values | {'expect': [*values['expect'], CLIENT.name]}, domain) as nodes:

            def written() -> int:
                seen = client.seen[WRITTEN.name]
                return 0 if seen is None else seen.step + 1

            deadline = time.monotonic() + PATIENCE
            while written() < at_step:
                assert time.monotonic() < deadline
                nodes.wait(0.005, client.news)
                client.clear_news()
            for role in roles:
                os.kill(nodes[role].pid, signal.SIGKILL)
            for role in roles:
                while nodes[role].status is None:
                    assert time.monotonic() < deadline
            acknowledged = written()
    [bag] = folder.iterdir()
    return bag, acknowledged


def check(bag: Path, acknowledged: int, *, recorder_lives: bool) -> int:
    """Return how many steps are lost of a bag that must open all the same."""
    opened = RunBag(bag)
    assert not opened.complete
    assert opened.integrity.ok
    assert opened.motion.gaps == 0
    assert opened.finished == recorder_lives
    assert analyse_bags([bag])['runs'][0]['defects'] == list(opened.defects)
    steps = opened.steps
    assert recover(bag)[0].steps == steps
    assert RunBag(bag).is_whole
    return max(acknowledged - steps, 0)


@pytest.mark.parametrize('target', ['recorder', 'group'])
def test_a_kill_costs_half_a_second_at_most(tmp_path: Path, target: str) -> None:
    bag, acknowledged = kill(tmp_path, 'mcap' if target == 'recorder' else 'sqlite3', 0.0, TARGETS[target], 23)
    assert check(bag, acknowledged, recorder_lives=False) <= 5


@pytest.mark.slow
@pytest.mark.parametrize('target', TARGETS)
@pytest.mark.parametrize('rate', [0.0, 1.0])
@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_two_hundred_kills(
    tmp_path: Path, storage: str, rate: float, target: str, record_property: Callable[[str, object], None]
) -> None:
    chance = random.Random(f'{storage} {rate} {target}')
    lost = []
    for number in range(int(os.environ.get('KAPITSA_KILLS', '17'))):
        folder = tmp_path / str(number)
        folder.mkdir()
        bag, acknowledged = kill(folder, storage, rate, TARGETS[target], chance.randrange(6, 60 if rate == 0 else 25))
        lost.append(check(bag, acknowledged, recorder_lives=target == 'pendulum'))
    record_property('steps lost', lost)
    assert max(lost) <= (0 if target == 'pendulum' else 5)
