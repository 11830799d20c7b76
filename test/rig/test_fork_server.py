"""Nodes are forked from one process: what it may hold, how nodes are known, what happens where it is killed."""

import os
import select
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig import Rig, RigError, fork_server_process
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.file_in_memory import file_in_memory
from kapitsa_ros.rig.fork_server_process import ForkServerProcess, fork_server
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.node_process import NodeProcess

PATIENCE = 180.0
pytestmark = pytest.mark.xdist_group('harness')


@pytest.fixture
def own_server() -> Iterator[ForkServerProcess]:
    """Give a server to be killed: a new one, where the tests of this process share another."""
    with fork_server() as shared:
        with closing(os.fdopen(os.pidfd_open(shared.pid))) as watch:
            os.kill(shared.pid, signal.SIGKILL)
            assert select.select([watch], [], [], PATIENCE)[0]
        assert shared.has_ended()
        with fork_server() as server:
            assert server.pid != shared.pid
            yield server


def test_before_a_fork_there_is_nothing_of_dds(domain: int, shared_memory_of: Callable[..., set[Path]]) -> None:
    with fork_server() as server, NodeGroup(['strobe'], {}, domain) as nodes:
        assert nodes['strobe'].wait_for_line('joins domain', PATIENCE)
        assert shared_memory_of([nodes['strobe'].pid])
        assert not shared_memory_of([server.pid])
        assert not udp_sockets(server.pid)


def test_before_a_fork_only_that_is_loaded_which_the_node_needs(own_server: ForkServerProcess, domain: int) -> None:
    def loaded_for(role: str) -> set[str]:
        with NodeGroup([role], {}, domain) as nodes:
            assert nodes[role].wait_for_line('joins domain', PATIENCE)
        maps = Path(f'/proc/{own_server.pid}/maps').read_text()
        of_much = ('llvmlite', 'numba', 'scipy/special', 'scipy/optimize', 'pandas', 'matplotlib')
        return {name for name in of_much if name in maps}

    assert loaded_for('strobe') == set()
    assert loaded_for('pendulum') == {'llvmlite'}


def udp_sockets(pid: int) -> set[str]:
    links = {str(link.readlink()) for link in Path(f'/proc/{pid}/fd').iterdir()}
    return links & {f'socket:[{line.split()[9]}]' for line in Path('/proc/net/udp').read_text().splitlines()[1:]}


def children(pid: int) -> list[int]:
    return [int(child) for child in Path(f'/proc/{pid}/task/{pid}/children').read_text().split()]


def test_the_command_line_forks_nodes_from_itself(tmp_path: Path, eventually: Callable[..., None]) -> None:
    """Nothing of it goes on in the copy, and it says so where the copy is killed."""
    command = [sys.executable, '-m', 'kapitsa_ros', 'experiment', '--rate', '1', '--bags', str(tmp_path / 'bags')]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as program:
        eventually(lambda: (tmp_path / 'bags').is_dir() and list((tmp_path / 'bags').iterdir()))
        [server] = children(program.pid)
        shown = Path(f'/proc/{server}/cmdline').read_text().rstrip('\0')
        assert ' -m kapitsa_ros.rig.fork_server ' in shown
        assert {Path(f'/proc/{node}/comm').read_text().strip() for node in children(server)} == set(ROLE_NAMES)
        assert udp_sockets(program.pid)
        assert not udp_sockets(server)
        watches = [os.pidfd_open(node) for node in children(server)]
        os.kill(server, signal.SIGKILL)
        said, complaint = program.communicate(timeout=PATIENCE)
        assert (program.returncode, said) == (1, '')
        assert (
            complaint.rstrip()
            .splitlines()[-1]
            .startswith('kapitsa: error: the process that the nodes were forked from')
        )
        for watch in watches:
            assert select.select([watch], [], [], PATIENCE)[0]
            os.close(watch)


def test_a_node_is_known_by_its_role_and_has_its_own_domain() -> None:
    with fork_server():
        for role in ('strobe', 'analyser'):
            with reserved_domain() as domain, NodeGroup([role], {}, domain) as nodes:
                assert nodes[role].wait_for_line(f'joins domain {domain}', PATIENCE)
                process = Path(f'/proc/{nodes[role].pid}')
                assert (process / 'comm').read_text().strip() == role
                assert f' -m kapitsa_ros.nodes {role} ' in (process / 'cmdline').read_text()


def test_a_killed_server_ends_the_rig_and_its_nodes_in_order(
    own_server: ForkServerProcess, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    with Rig(rate=1) as rig:
        eventually(lambda: list(rig.bags.iterdir()))
        watches = [os.pidfd_open(process.pid) for process in rig.processes.values()]
        assert len(watches) == len(ROLE_NAMES)
        os.kill(own_server.pid, signal.SIGKILL)
        with pytest.raises(RigError, match='forked from was killed'):
            rig.wait_for('stopwatch/reading', timeout=PATIENCE)
        for watch in watches:
            assert select.select([watch], [], [], PATIENCE)[0]
            os.close(watch)
        [bag] = rig.bags.iterdir()
        assert not RunBag(bag).complete
    with Rig() as rig:
        rig.wait_for('pendulum/motion', timeout=PATIENCE)


def test_a_node_whose_start_was_interrupted_leaves(
    domain: int, eventually: Callable[[Callable[[], Any]], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """As by Ctrl-C before its process id was heard, while other rigs go on to use the server."""

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    with fork_server() as server:
        with monkeypatch.context() as patch:
            patch.setattr(fork_server_process, 'ForkedProcess', interrupt)
            for _ in range(5):  # a signal that came between the fork and Python's own part of it was lost
                with pytest.raises(KeyboardInterrupt):
                    NodeGroup(['strobe'], {}, domain)
        with NodeGroup(['stopwatch'], {}, domain) as nodes:  # forked after the others
            children = Path(f'/proc/{server.pid}/task/{server.pid}/children')
            eventually(lambda: children.read_text().split() == [str(nodes['stopwatch'].pid)])


def test_a_node_that_nobody_reads_ends_where_it_cannot_say_why(
    domain: int, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    with fork_server() as server:
        pipe, stderr = os.pipe()
        os.close(pipe)
        with file_in_memory('/**: {ros__parameters: {length: -1.0}}') as parameters:
            node = server.start(['pendulum'], parameters.fileno(), stderr, domain)
        os.close(stderr)
        eventually(lambda: node.status() is not None)
        node.close()


def test_files_in_the_current_folder_are_no_modules_of_a_server(
    domain: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ('json', 'socket', 'yaml', 'rclpy'):
        Path(f'{name}.py').write_text('raise ImportError("of the user")', encoding='utf-8')
    with closing(ForkServerProcess()) as server, closing(NodeProcess(server, ['strobe'], {}, domain)) as node:
        assert node.wait_for_line('joins domain', PATIENCE)
        node.end(signal.SIGKILL)


def test_the_end_of_a_node_is_told_where_a_program_ignores_those_of_its_children() -> None:
    """As one that was started by a program which does."""
    program = f"""if True:
        import select, signal
        signal.signal(signal.SIGCHLD, signal.SIG_IGN)
        from kapitsa_ros.rig.domain import reserved_domain
        from kapitsa_ros.rig.fork_server_process import fork_server
        from kapitsa_ros.rig.node_group import NodeGroup
        with fork_server() as server:
            with reserved_domain() as domain, NodeGroup(['strobe'], {{}}, domain) as nodes:
                assert nodes['strobe'].wait_for_line('joins domain', {PATIENCE})
                nodes['strobe'].end(signal.SIGKILL)
                select.select([nodes['strobe'].sentinel], [], [], {PATIENCE})
                print(nodes['strobe'].status(), server.has_ended())
    """
    done = subprocess.run(
        [sys.executable, '-c', program], capture_output=True, text=True, timeout=PATIENCE, check=False
    )
    assert (done.stdout, done.stderr) == (f'{-signal.SIGKILL} False\n', '')


def test_a_server_that_is_gone_is_named(own_server: ForkServerProcess, domain: int) -> None:
    os.kill(own_server.pid, signal.SIGKILL)
    with open(os.devnull) as null, pytest.raises(RigError, match=f'pendulum cannot be started: .* {own_server.pid}'):  # noqa: PTH123
        own_server.start(['pendulum'], null.fileno(), null.fileno(), domain)
