"""A rig that cannot form says who waits for whom, and soon."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.rig import formation
from kapitsa_ros.rig.errors import RigError
from kapitsa_ros.rig.formation import PATIENCE, Formation
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import Setup, parameters

pytestmark = pytest.mark.xdist_group('processes')


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    clock = SimpleNamespace(now=0.0)
    clock.monotonic = lambda: clock.now
    monkeypatch.setattr(formation, 'time', clock)
    return clock


def test_nodes_that_are_still_starting_are_waited_for(clock: SimpleNamespace) -> None:
    """As where kernels are compiled for the first time."""
    nodes = SimpleNamespace(joined=False, have_joined=lambda: nodes.joined, who_waits=lambda: 'all wait for all')
    forming = Formation(nodes)
    forming.check()
    clock.now = 1000.0
    forming.check()
    nodes.joined = True
    forming.check()
    clock.now += PATIENCE - 1.0
    forming.check()
    clock.now += 2.0
    with pytest.raises(RigError, match='do not find one another: all wait for all; does a firewall'):
        forming.check()


def test_who_waits_for_whom_is_told_by_the_nodes(clock: SimpleNamespace, domain: int, tmp_path: Path) -> None:
    without = [role for role in ROLE_NAMES if role not in {'recorder', 'operator', 'jigsaw'}]
    with NodeGroup(without, parameters(Setup(bags=tmp_path)), domain) as nodes:
        for role in without:
            assert nodes[role].wait_for_line('waiting for', 60.0)
        forming = Formation(nodes)
        forming.check()
        clock.now += PATIENCE + 1.0
        with pytest.raises(RigError, match=r'strobe waits for jigsaw, operator, recorder(;|$)'):
            forming.check()


def test_nodes_that_have_found_one_another_late_are_not_held_to_be_lost(
    clock: SimpleNamespace, domain: int, tmp_path: Path
) -> None:
    early = [role for role in ROLE_NAMES if role != 'stopwatch']
    told = parameters(Setup(bags=tmp_path, rate=1.0))
    with NodeGroup(early, told, domain) as nodes:
        for role in ('pendulum', 'operator'):
            assert nodes[role].wait_for_line('waiting for', 60.0)
        forming = Formation(nodes)
        forming.check()
        assert 'pendulum waits for stopwatch' in nodes.who_waits()
        with NodeGroup(['stopwatch'], told, domain):
            for role in ('pendulum', 'operator'):
                assert nodes[role].wait_for_line('waits for nobody any more', 60.0)
            clock.now += PATIENCE + 1.0
            assert not [role for role in ('pendulum', 'operator') if f'{role} waits' in nodes.who_waits()]


def test_a_discovery_server_that_is_asked_for_is_suspected(
    clock: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv('ROS_DISCOVERY_SERVER', '127.0.0.1:11811')
    forming = Formation(SimpleNamespace(have_joined=lambda: True, who_waits=lambda: 'x waits for y'))
    forming.check()
    clock.now += PATIENCE + 1.0
    with pytest.raises(RigError, match=r'ROS_DISCOVERY_SERVER is 127.0.0.1:11811: start that server, or unset it'):
        forming.check()
