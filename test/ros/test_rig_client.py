"""A client that cannot be made leaves no descriptor open."""

from pathlib import Path

import pytest

from kapitsa_ros.ros.rig_client import RigClient


def eventfds() -> int:
    return sum('eventfd' in str(path.readlink()) for path in Path('/proc/self/fd').iterdir() if path.is_symlink())


def test_a_client_that_cannot_be_made_leaves_no_descriptor() -> None:
    before = eventfds()
    with pytest.raises(RuntimeError, match='Domain id'):
        RigClient(-5)
    assert eventfds() == before
