"""Ctrl-C, SIGTERM and a closed terminal stop everything in order, at whatever moment they come."""

import os
import pty
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path

import pytest

from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.rig.environment import node_environment
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import Setup, parameters
from kapitsa_ros.ros.session_monitor import SessionMonitor

PATIENCE = 180.0
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
EXPERIMENT = [sys.executable, '-m', 'kapitsa_ros', 'experiment', '--rate', '1', '--bags']
pytestmark = pytest.mark.xdist_group('processes')


def has_begun(pid: int) -> bool:
    """Return whether a node has taken its signals over from Python; SIGHUP is the last of them."""
    status = Path(f'/proc/{pid}/status').read_text()
    caught = next(line.split()[1] for line in status.splitlines() if line.startswith('SigCgt'))
    return bool(int(caught, 16) >> (signal.SIGHUP - 1) & 1)


Leaving = Callable[[int], AbstractContextManager[None]]


@pytest.fixture
def leaving_nothing(
    processes_of: Callable[[int], dict[str, int]], shared_memory_of: Callable[..., set[Path]]
) -> Leaving:
    @contextmanager
    def leaving(rig: int) -> Iterator[None]:
        """Within, a rig is stopped: on the way out its processes must have ended, their shared memory must be gone."""
        pids = processes_of(rig)
        assert len(pids) == len(ROLE_NAMES) + 1
        watches = [os.pidfd_open(pid) for pid in pids.values()]
        shared = shared_memory_of([rig, *pids.values()])
        assert shared
        yield
        assert all(map(has_ended, watches))
        assert not [segment for segment in shared if segment.exists()]
        for watch in watches:
            os.close(watch)

    return leaving


def has_ended(watch: int) -> bool:
    return bool(select.select([watch], [], [], PATIENCE)[0])


@pytest.mark.parametrize('number', SIGNALS)
def test_a_signal_ends_every_node_of_a_run_with_status_0(
    number: signal.Signals, domain: int, observer: SessionMonitor, tmp_path: Path
) -> None:
    slower_than_patience = Setup(bags=tmp_path, rate=0.3)
    with NodeGroup(ROLE_NAMES, parameters(slower_than_patience), domain) as nodes:
        observer.wait_for_progress(PATIENCE)
        for role in ROLE_NAMES:
            nodes[role].end(number)
        assert all(has_ended(nodes[role].sentinel) for role in ROLE_NAMES)
        ends = {role: (nodes[role].status(), nodes[role].last_error_lines()) for role in ROLE_NAMES}
    assert all(status == 0 and 'Traceback' not in words for status, words in ends.values()), ends


@pytest.mark.parametrize('number', SIGNALS)
def test_a_signal_ends_a_node_that_is_not_ready_yet(number: signal.Signals, domain: int) -> None:
    """Each of seven nodes at another moment, from the first imports to looking for its peers."""
    nodes = [
        subprocess.Popen(
            [sys.executable, '-m', 'kapitsa_ros.nodes', role],
            env=node_environment(domain), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
        )
        for role in ROLE_NAMES
    ]  # fmt: skip
    try:
        for moment, node in enumerate(nodes):
            while not has_begun(node.pid):
                assert node.poll() is None
            time.sleep(0.1 * moment)  # not for anything to happen: it is the moment that matters
            node.send_signal(number)
        said = [node.communicate(timeout=PATIENCE)[1] for node in nodes]
    finally:
        for node in nodes:
            node.kill()
            node.wait()
    assert not [words for words in said if 'Traceback' in words]
    assert [node.returncode for node in nodes] == [0] * len(ROLE_NAMES)


FULL_DISK = """
import sys
import kapitsa_ros.nodes.recorder as recorder
from kapitsa_ros.nodes.__main__ import main
from kapitsa_ros.recording.errors import BagError

class Full(recorder.RecorderNode):
    def close(self):
        raise BagError('cannot finish run_01: no space left')

recorder.create = Full
sys.exit(main(['recorder']))
"""


def test_what_goes_wrong_after_a_signal_is_said_in_one_line(domain: int) -> None:
    node = subprocess.Popen(
        [sys.executable, '-c', FULL_DISK], env=node_environment(domain), stderr=subprocess.PIPE, text=True
    )
    assert node.stderr is not None
    assert next(line for line in node.stderr if 'joins domain' in line)
    node.send_signal(signal.SIGINT)
    _, err = node.communicate(timeout=PATIENCE)
    assert [line for line in err.splitlines() if 'INFO' not in line] == [
        'recorder: error: cannot finish run_01: no space left'
    ]
    assert node.returncode == 1


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_experiment_leaves_nothing_running(
    number: signal.Signals, leaving_nothing: Leaving, tmp_path: Path
) -> None:
    process = subprocess.Popen([*EXPERIMENT, tmp_path], stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    assert next(line for line in process.stderr if 'run 1 of 3' in line)
    with leaving_nothing(process.pid):
        process.send_signal(number)
        _, err = process.communicate(timeout=PATIENCE)
    assert process.returncode == 128 + number
    assert err.strip() == 'kapitsa: error: interrupted'
    assert all("complete: 'false'" in metadata.read_text() for metadata in tmp_path.glob('*/metadata.yaml'))


def test_a_closed_terminal_stops_the_experiment(leaving_nothing: Leaving, tmp_path: Path) -> None:
    terminal, its_side = pty.openpty()
    process = subprocess.Popen(
        ['/usr/bin/setsid', '--ctty', *EXPERIMENT, tmp_path],
        stdin=its_side, stdout=its_side, stderr=its_side,
    )  # fmt: skip
    os.close(its_side)
    seen = b''
    while b'run 1 of 3' not in seen:
        assert select.select([terminal], [], [], PATIENCE)[0]
        seen += os.read(terminal, 4096)
    with leaving_nothing(process.pid):
        os.close(terminal)
        assert process.wait(PATIENCE) == 128 + signal.SIGHUP
