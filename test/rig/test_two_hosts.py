"""The graph on two hosts: network namespaces with a cable between them, from which nothing leads anywhere else."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
import yaml

from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.rig.environment import node_environment

TOOLS = {name: shutil.which(name) for name in ('ip', 'nsenter', 'unshare', 'sleep', 'true')}
PATIENCE = 180.0
DOMAIN = 5  # of hosts of their own
RUNNING = 0x40
"""Flag of an interface that is ready, of <linux/if.h>."""
LIFE = '300'
"""Seconds after which a host is gone, whatever becomes of this process."""


class Host:
    """A network namespace, which lives as long as a process in it."""

    def __init__(self, number: int) -> None:
        self.address, self.card = f'10.77.0.{number}', f'kapitsa{number}'
        self.process = subprocess.Popen([TOOLS['unshare'], '--net', TOOLS['sleep'], LIFE])

    def has_own_network(self) -> bool:
        own, theirs = (Path(f'/proc/{pid}/ns/net').readlink() for pid in ('self', self.process.pid))
        return own != theirs

    def command(self, *command: str) -> list[str]:
        return [TOOLS['nsenter'], '--target', str(self.process.pid), '--net', *command]

    def ip(self, *arguments: str) -> None:
        subprocess.run(self.command(TOOLS['ip'], *arguments), check=True, capture_output=True)

    def start(self, other: 'Host', *arguments: str) -> subprocess.Popen[str]:
        command = self.command(sys.executable, '-m', 'kapitsa_ros', 'node', 'composed', *arguments)
        environment = {
            name: value for name, value in node_environment(DOMAIN).items() if name != 'FASTRTPS_DEFAULT_PROFILES_FILE'
        }
        return subprocess.Popen(
            command, env=environment | {'ROS_STATIC_PEERS': other.address}, stderr=subprocess.PIPE, text=True
        )


@pytest.fixture
def hosts(eventually: Callable[[Callable[[], bool]], None]) -> Iterator[tuple[Host, Host]]:
    if missing := [name for name, path in TOOLS.items() if path is None]:
        pytest.skip(f'makes networks, for which it needs {", ".join(missing)}')
    if subprocess.run([TOOLS['unshare'], '--net', TOOLS['true']], capture_output=True, check=False).returncode:
        pytest.skip('makes networks, for which it has to be root')
    with ExitStack() as stack:
        first, second = Host(1), Host(2)
        for host in (first, second):
            stack.callback(host.process.wait)
            stack.callback(host.process.kill)
            eventually(host.has_own_network)
        peer = ('peer', 'name', second.card, 'netns', str(second.process.pid))
        first.ip('link', 'add', first.card, 'type', 'veth', *peer)
        for host in (first, second):
            host.ip('addr', 'add', f'{host.address}/24', 'dev', host.card)
            for card in ('lo', host.card):
                host.ip('link', 'set', card, 'up')
        yield first, second


def split(hosts: tuple[Host, Host], bags: Path, *parameters: str) -> list[subprocess.Popen[str]]:
    """Start jigsaw and pendulum on one host, the other nodes on the other."""
    one, other = hosts
    told = [word for parameter in parameters for word in ('-p', parameter)]
    rest = ('strobe', 'stopwatch', 'operator', 'analyser', 'recorder')
    return [
        one.start(other, 'jigsaw', 'pendulum', '--ros-args', *told),
        other.start(one, *rest, '--ros-args', '-p', f'bags:={bags}', *told),
    ]


def ends(processes: list[subprocess.Popen[str]]) -> list[tuple[int, str]]:
    """Return how the processes end, and what they have said; one that does not end is killed."""
    deadline = time.monotonic() + PATIENCE
    said = []
    try:
        for process in processes:
            try:
                said.append(process.communicate(timeout=max(0.0, deadline - time.monotonic()))[1])
            except subprocess.TimeoutExpired:
                process.kill()
                said.append(process.communicate()[1])
    finally:
        for process in processes:
            process.kill()
            process.wait()
    return [(process.returncode, text) for process, text in zip(processes, said, strict=True)]


def files(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob('*')) if path.is_file()}


@pytest.mark.xdist_group('processes')
def test_two_hosts_record_what_one_does(
    hosts: tuple[Host, Host], recorded: tuple[Path, dict[str, Any]], tmp_path: Path
) -> None:
    processes = split(hosts, tmp_path / 'A')
    ended = ends(processes)
    assert [status for status, _ in ended] == [0, 0], ended
    assert files(tmp_path / 'A') == files(recorded[0])


READY = """
from kapitsa_ros.ros import network_interfaces
print(flush=True), input()
network_interfaces.wait_for_network_interfaces()
print(*(flags for _, flags in network_interfaces.interface_flags()))
"""


def flags_after_connecting(host: Host, other: Host) -> tuple[list[int], str]:
    """Connect a host's interface while a program waits to look; return what flags it sees, and what it says."""
    with subprocess.Popen(
        host.command(sys.executable, '-c', READY),
        env=os.environ | {'ROS_STATIC_PEERS': other.address},
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        process.stdout.readline()
        for state in ('down', 'up'):
            host.ip('link', 'set', host.card, state)
        told, said = process.communicate('\n', timeout=PATIENCE)
    flags = [int(word) for word in told.split()]
    assert len(flags) >= 4  # of the loopback interface and of the other one, each with an address and without
    return flags, said


def test_an_interface_that_has_just_been_connected_is_waited_for(hosts: tuple[Host, Host]) -> None:
    """Linux calls it ready up to a second later; DDS leaves out what is not, and the other host was never found."""
    for host, other in (hosts, hosts[::-1]):
        flags, said = flags_after_connecting(host, other)
        assert all(each & RUNNING for each in flags)
        assert said == ''


def test_an_interface_that_does_not_become_ready_is_named(hosts: tuple[Host, Host]) -> None:
    """As one on which somebody has to log in first."""
    hosts[0].ip('link', 'set', hosts[0].card, 'mode', 'dormant')
    flags, said = flags_after_connecting(*hosts)
    assert not all(each & RUNNING for each in flags)
    assert said.startswith(f'kapitsa: warning: the network interface {hosts[0].card} is connected and not ready')
    assert said.count('\n') == 1


@pytest.fixture
def one_speed(tmp_path: Path) -> Path:
    path = tmp_path / 'one.yaml'
    path.write_text(yaml.safe_dump({'speeds': ['2640 rpm'], 'swings': 3, 'repeats': 4}), encoding='utf-8')
    assert len(load_protocol(str(path)).runs) == 1
    return path


def cut(host: Host, seconds: float) -> None:
    host.ip('link', 'set', host.card, 'down')
    time.sleep(seconds)  # what is tested, not a wait for something
    host.ip('link', 'set', host.card, 'up')


@pytest.mark.slow
def test_a_link_that_is_cut_for_five_seconds_loses_nothing(
    hosts: tuple[Host, Host], one_speed: Path, tmp_path: Path, eventually: Callable[[Callable[[], bool]], None]
) -> None:
    folders = tmp_path / 'A', tmp_path / 'B'
    for folder in folders:
        processes = split(hosts, folder, f'protocol:={one_speed}', 'rate:=5.0')
        if folder is folders[1]:
            eventually(lambda: any(folders[1].glob('*/*.mcap')))
            cut(hosts[0], 5.0)
        ended = ends(processes)
        assert [status for status, _ in ended] == [0, 0], ended
    assert files(folders[0]) == files(folders[1])


@pytest.mark.slow
def test_a_longer_cut_ends_the_run_with_a_line(
    hosts: tuple[Host, Host], one_speed: Path, tmp_path: Path, eventually: Callable[[Callable[[], bool]], None]
) -> None:
    processes = split(hosts, tmp_path / 'A', f'protocol:={one_speed}', 'rate:=1.0')
    eventually(lambda: any((tmp_path / 'A').glob('*/*.mcap')))
    hosts[0].ip('link', 'set', hosts[0].card, 'down')
    for status, text in ends(processes):
        assert status == 1
        assert text.count('left in mid-session, or cannot be reached any more') == 1, text
        assert 'Traceback' not in text
