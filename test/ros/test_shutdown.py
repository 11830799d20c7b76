"""A node leaves also where DDS hangs, and a listener not while others do."""

import signal
import subprocess
import sys

import pytest

from kapitsa_ros.ros.shutdown import listeners

HANGS = """
from kapitsa_ros.ros.shutdown import ShutdownWatchdog
ShutdownWatchdog(0.2, {status})
sum(iter(int, 1))  # for ever, in C and with the interpreter's lock
"""


@pytest.mark.parametrize('status', [0, 1])
def test_a_process_that_hangs_with_the_interpreters_lock_ends(status: int) -> None:
    command = [sys.executable, '-c', HANGS.format(status=status)]
    assert subprocess.run(command, timeout=180, check=False).returncode == status


ABORTS = """
import ctypes, threading
from kapitsa_ros.ros.shutdown import ShutdownWatchdog
watchdog = ShutdownWatchdog({seconds}, {status})
if '{where}' == 'main':
    ctypes.PyDLL(None).abort()
threading.Thread(target=ctypes.CDLL(None).abort).start()
ctypes.{library}(None).sleep(30)  # PyDLL keeps the interpreter's lock
"""


@pytest.mark.parametrize('status', [0, 1])
@pytest.mark.parametrize(
    ('where', 'library', 'seconds'), [('main', 'CDLL', 30), ('other', 'CDLL', 30), ('other', 'PyDLL', 0.5)]
)
def test_a_process_in_which_c_aborts_ends_as_if_it_had_not(
    status: int, where: str, library: str, seconds: float
) -> None:
    """In the main thread, and in one of a library, whether the main thread holds the interpreter's lock or not."""
    command = [sys.executable, '-c', ABORTS.format(status=status, where=where, library=library, seconds=seconds)]
    assert subprocess.run(command, timeout=20, check=False).returncode == status


def test_an_abort_after_the_shutdown_is_one() -> None:
    code = 'import os, kapitsa_ros.ros.shutdown as shutdown; shutdown.ShutdownWatchdog(9, 0).disarm(); os.abort()'
    assert subprocess.run([sys.executable, '-c', code], timeout=20, check=False).returncode == -signal.SIGABRT


@pytest.mark.usefixtures('observer')
def test_who_hears_a_domain_is_found(domain: int) -> None:
    """By the names that Fast DDS gives its threads."""
    assert len(listeners(domain)) >= 2  # discovery, and what is said
    assert not listeners(101)  # which no test is given
