"""What every test stands on: loopback only, no domain of the user's, no log files in the user's home, signals heard."""

import os
import signal
import tempfile
from collections.abc import Iterator

import pytest


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
