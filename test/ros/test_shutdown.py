"""A node leaves also where DDS hangs, and a listener not while others do."""

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
    assert subprocess.run(command, timeout=30, check=False).returncode == status


@pytest.mark.usefixtures('observer')
def test_who_hears_a_domain_is_found(domain: int) -> None:
    """By the names that Fast DDS gives its threads."""
    assert len(listeners(domain)) >= 2  # discovery, and what is said
    assert not listeners(101)  # which no test is given
