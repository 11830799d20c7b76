"""What keeps nodes apart is said before one starts, where the environment shows it."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from kapitsa_ros.ros.errors import NodeError, SettingError
from kapitsa_ros.ros.log_files import without_log_files
from kapitsa_ros.ros.log_output import SWITCHES, refuse_unknown_switches
from kapitsa_ros.ros.middleware import refuse_missing_middleware
from kapitsa_ros.ros.reachability import refuse_unreachable
from kapitsa_ros.ros.shared_memory import refuse_full_shared_memory


@pytest.mark.parametrize(
    ('name', 'value', 'words'),
    [
        ('ROS_AUTOMATIC_DISCOVERY_RANGE', 'OFF', 'ROS_AUTOMATIC_DISCOVERY_RANGE is OFF'),
        ('ROS_AUTOMATIC_DISCOVERY_RANGE', 'HOME', 'give one of LOCALHOST, SUBNET, SYSTEM_DEFAULT'),
        ('ROS_DOMAIN_ID', '233', 'ROS_DOMAIN_ID is 233: give a number from 0 to 232'),
        ('ROS_DOMAIN_ID', '-1', 'ROS_DOMAIN_ID is -1'),
        ('ROS_DOMAIN_ID', 'x', 'ROS_DOMAIN_ID is x'),
        ('ROS_DOMAIN_ID', '\u0667', 'give a number from 0 to 232'),
        ('FASTRTPS_DEFAULT_PROFILES_FILE', '/nowhere.xml', 'names /nowhere.xml, which is not there'),
    ],
)
def test_an_environment_that_keeps_nodes_apart_is_refused(
    monkeypatch: pytest.MonkeyPatch, name: str, value: str, words: str
) -> None:
    refuse_unreachable()
    monkeypatch.setenv(name, value)
    with pytest.raises(SettingError, match=words):
        refuse_unreachable()


@pytest.mark.parametrize('name', SWITCHES)
def test_a_switch_of_the_log_that_rcl_does_not_know_is_refused(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    monkeypatch.setenv(name, '1')
    refuse_unknown_switches()
    monkeypatch.setenv(name, '7')
    with pytest.raises(SettingError, match=f'{name} is 7: give 0 or 1'):
        refuse_unknown_switches()


def test_a_node_in_a_domain_without_a_port_says_so_in_one_line() -> None:
    """Fast DDS would end the process itself, with a word on stdout."""
    done = subprocess.run(
        [sys.executable, '-m', 'kapitsa_ros.nodes', 'jigsaw'],
        env=os.environ | {'ROS_DOMAIN_ID': '500'}, capture_output=True, text=True, timeout=180, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (2, '')
    assert done.stderr == 'jigsaw: error: ROS_DOMAIN_ID is 500: give a number from 0 to 232\n'


def test_a_peer_without_an_address_is_told_with_the_variable_that_names_it() -> None:
    # no resolver asks anybody for a name with an empty part
    done = subprocess.run(
        [sys.executable, '-m', 'kapitsa_ros.nodes', 'jigsaw'],
        env=os.environ | {'ROS_STATIC_PEERS': 'a..b'}, capture_output=True, text=True, timeout=180, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (2, '')
    line = done.stderr.splitlines()[-1]
    assert line.startswith('jigsaw: error: no node can be made, ROS_STATIC_PEERS is a..b: ')
    assert line.endswith('Unable to resolve peer a..b: give addresses or names of hosts, ; in between')


def test_a_middleware_that_is_not_installed_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv('RMW_IMPLEMENTATION', 'rmw_of_nobody_cpp')
    with pytest.raises(SettingError, match=r'RMW_IMPLEMENTATION is rmw_of_nobody_cpp.*: unset it, or install'):
        refuse_missing_middleware()
    monkeypatch.setenv('RMW_IMPLEMENTATION', 'rmw_fastrtps_cpp')
    refuse_missing_middleware()


@pytest.mark.parametrize(
    'start',
    [
        ['-m', 'kapitsa_ros.nodes', 'jigsaw'],
        ['-m', 'kapitsa_ros', 'replay', 'bags/run_01_2240rpm'],
    ],
)
def test_without_the_middleware_nothing_starts(start: list[str]) -> None:
    """To import rclpy would end the process with status 102."""
    done = subprocess.run(
        [sys.executable, *start],
        env=os.environ | {'RMW_IMPLEMENTATION': 'rmw_of_nobody_cpp'},
        capture_output=True, text=True, timeout=180, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (2, '')
    [line] = done.stderr.splitlines()
    assert line.startswith('kapitsa: error: RMW_IMPLEMENTATION is rmw_of_nobody_cpp')


def test_without_the_middleware_other_tests_run(tmp_path: Path) -> None:
    tests = tmp_path / 'test_mine.py'
    tests.write_text('def test_one(): pass\ndef test_rig(rig): pass\ndef test_three(): pass\n')
    done = subprocess.run(
        [sys.executable, '-m', 'pytest', '-q', tests, '--rootdir', tmp_path, '-p', 'no:cacheprovider'],
        # In PYTEST_ADDOPTS colcon has options that are of this suite.
        env=os.environ | {'RMW_IMPLEMENTATION': 'rmw_of_nobody_cpp', 'PYTEST_ADDOPTS': ''},
        capture_output=True, text=True, timeout=180, check=False,
    )  # fmt: skip
    assert '2 passed' in done.stdout
    assert '1 error' in done.stdout
    assert 'RMW_IMPLEMENTATION is rmw_of_nobody_cpp' in done.stdout


@pytest.mark.parametrize(
    ('environment', 'may_log'),
    [({}, False), ({'HOME': '/proc/nowhere'}, False), ({'ROS_LOG_DIR': '/proc/nowhere', 'HOME': '{}'}, False),
     ({'HOME': '{}'}, True), ({'ROS_HOME': '{}'}, True), ({'ROS_LOG_DIR': '{}'}, True)],
)  # fmt: skip
def test_log_files_are_kept_where_they_can_be(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, environment: dict[str, str], *, may_log: bool
) -> None:
    for name in ('HOME', 'ROS_HOME', 'ROS_LOG_DIR'):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value.format(tmp_path))
    assert (without_log_files() == []) is may_log


@pytest.mark.skipif(os.geteuid() != 0, reason='to mount a file system wants root')
def test_a_full_shared_memory_is_said_before_a_signal_kills_the_process() -> None:
    """LTTng, which rclpy brings, maps a page there, and Fast DDS its segments."""
    mount = 'mount -t tmpfs -o size=64k shm /dev/shm; head -c 65536 /dev/zero > /dev/shm/full; exec "$@"'
    done = subprocess.run(
        ['/usr/bin/unshare', '-m', 'sh', '-c', mount, '-', sys.executable, '-m', 'kapitsa_ros.nodes', 'jigsaw'],
        capture_output=True, text=True, timeout=180, check=False,
    )  # fmt: skip
    if 'unshare:' in done.stderr or 'mount:' in done.stderr:
        pytest.skip('no mount namespaces here')
    assert done.returncode == 1
    assert done.stderr.startswith('kapitsa: error: /dev/shm has 0.0 MB left')


def test_without_shared_memory_there_is_nothing_to_fill(tmp_path: Path) -> None:
    refuse_full_shared_memory(tmp_path / 'nowhere')
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, 'statvfs', lambda _: SimpleNamespace(f_bavail=1, f_frsize=4096))
        with pytest.raises(NodeError, match=r'0\.0 MB left'):
            refuse_full_shared_memory(tmp_path)
        patch.setattr(os, 'access', lambda *_: False)  # a read-only file system
        refuse_full_shared_memory(tmp_path)
