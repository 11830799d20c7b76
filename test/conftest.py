"""What every test stands on: loopback only, no domain of the user's, no log files in the user's home."""

import os
import tempfile
from collections.abc import Iterator

import pytest


@pytest.fixture(scope='session', autouse=True)
def ros_at_home() -> Iterator[None]:
    with tempfile.TemporaryDirectory() as folder:
        os.environ.pop('ROS_DOMAIN_ID', None)
        os.environ |= {'ROS_LOG_DIR': folder, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
        yield
