"""What every test stands on: loopback only, no domain of the user's, no log files in the user's home, signals heard.

Besides, the command line as users run it, and what graphs of processes need.
"""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

sys.path.insert(0, str(Path(__file__).parent))  # for command_server.py

from command_server import CommandServer

from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.fork_server_process import fork_server
from kapitsa_ros.ros.session_monitor import SessionMonitor

settings.register_profile('at any speed', deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile('at any speed')
PATIENCE = 120.0
READ_WHEN_USED = {'COLUMNS', 'ROS_DOMAIN_ID'}
"""Variables that no module reads as it is loaded."""


@pytest.fixture(scope='session', autouse=True)
def ros_at_home() -> Iterator[None]:
    with tempfile.TemporaryDirectory() as folder:
        os.environ.pop('ROS_DOMAIN_ID', None)
        os.environ |= {'ROS_LOG_DIR': folder, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
        yield


@pytest.fixture(scope='session', autouse=True)
def signals_heard() -> None:
    """A suite in the background of a shell, or under nohup, would have its processes ignore what they are sent."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


@dataclass(frozen=True)
class Answer:
    status: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        assert self.status == 0, self.err
        return json.loads(self.out)


@pytest.fixture(scope='session')
def command_server(signals_heard: None) -> Iterator[CommandServer]:  # noqa: ARG001  # signals are inherited
    server = CommandServer()
    yield server
    server.close()


@pytest.fixture(scope='session')
def kapitsa(command_server: CommandServer) -> Callable[..., Answer]:
    """Run `kapitsa` with arguments; in a new interpreter where modules may read the environment as they load."""

    def run(*arguments: object, env: dict[str, str] | None = None) -> Answer:
        given, encoding = env or {}, (env or {}).get('PYTHONIOENCODING', 'utf-8')
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            if given.keys() - READ_WHEN_USED:
                command = [sys.executable, '-m', 'kapitsa_ros', *map(str, arguments)]
                done = subprocess.run(
                    command, env=os.environ | given, stdout=out, stderr=err, timeout=PATIENCE, check=False
                )
                status = done.returncode
            else:
                status = command_server.run([*map(str, arguments)], os.environ | given, out, err, PATIENCE)
            for file in (out, err):
                file.seek(0)
            said = [file.read().decode(encoding).replace('\r\n', '\n') for file in (out, err)]
        return Answer(status, *said)

    return run


@pytest.fixture(scope='session')
def recorded(kapitsa: Callable[..., Answer], tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """An experiment on the ideal plant with the instruments of 1997, seed 1: its folder and its JSON."""
    bags = tmp_path_factory.mktemp('recorded') / 'A'
    return bags, kapitsa('experiment', '--preset', 'ideal', '--seed', 1, '--bags', bags, '--json').json


@pytest.fixture
def domain() -> Iterator[int]:
    with reserved_domain() as number:
        yield number


@pytest.fixture
def observer(domain: int) -> Iterator[SessionMonitor]:
    with on_loopback():
        listening = SessionMonitor(domain)
    with listening:
        yield listening


@pytest.fixture(scope='session', autouse=True)
def one_fork_server(signals_heard: None) -> Iterator[None]:  # noqa: ARG001  # signals are inherited
    """Let the rigs of all tests in this process fork their nodes from one."""
    with fork_server():
        yield


@pytest.fixture(scope='session')
def processes_of() -> Callable[[int], dict[str, int]]:
    """Return what a rig has started, by process id of the rig: the nodes by role, and what they were forked from."""

    def children(pid: int) -> list[int]:
        tasks = Path(f'/proc/{pid}/task').iterdir()
        return [int(child) for task in tasks for child in (task / 'children').read_text().split()]

    def find(rig: int) -> dict[str, int]:
        [server] = children(rig)
        nodes = children(server)
        return {Path(f'/proc/{pid}/comm').read_text().strip(): pid for pid in nodes} | {'fork_server': server}

    return find


@pytest.fixture(scope='session')
def shared_memory_of() -> Callable[[Iterable[int]], set[Path]]:
    """Return the files of the shared memory that DDS has made for processes, by their ids."""

    def find(pids: Iterable[int]) -> set[Path]:
        maps = [Path(f'/proc/{pid}/maps').read_text() for pid in pids]
        return {Path(found) for text in maps for found in re.findall(r'/\S+/fastrtps_[0-9a-f]{16}', text)}

    return find


@pytest.fixture(scope='session')
def eventually() -> Callable[[Callable[[], Any]], None]:
    """Wait for something that discovery, in its own time, makes true, and tells nobody."""

    def wait(true: Callable[[], Any]) -> None:
        deadline = time.monotonic() + 180.0
        while not true():
            assert time.monotonic() < deadline
            time.sleep(0.01)

    return wait


@pytest.fixture
def busy() -> Iterator[None]:
    """Keep both cores busy with something else."""
    spinners = [subprocess.Popen([sys.executable, '-S', '-E', '-c', 'while True: pass']) for _ in range(2)]
    yield
    for spinner in spinners:
        spinner.kill()
        spinner.wait()
