"""The fixture `rig` for everybody's tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kapitsa_ros.rig.harness import Rig


def pytest_configure(config: pytest.Config) -> None:
    """Describe the marker."""
    config.addinivalue_line('markers', 'rig(preset=..., nodes=..., ...): arguments of Rig for the fixture `rig`')


@pytest.fixture(scope='session')
def rig_fork_server() -> Iterator[None]:
    """Let the rigs of all tests fork their nodes from one process: the second is up in less than a second."""
    from kapitsa_ros.rig.fork_server_process import fork_server  # noqa: PLC0415  # every run of pytest imports this file

    with fork_server():
        yield


@pytest.fixture
def rig(request: pytest.FixtureRequest, rig_fork_server: None, tmp_path: Path) -> Iterator[Rig]:  # noqa: ARG001
    """All nodes of the laboratory, in a domain of their own; `@pytest.mark.rig(...)` says what they are made of."""
    from kapitsa_ros.rig.environment import on_loopback  # noqa: PLC0415  # every run of pytest imports this file
    from kapitsa_ros.rig.harness import Rig  # noqa: PLC0415

    marker = request.node.get_closest_marker('rig')
    # The test's own nodes keep to this machine, too.
    with on_loopback(), Rig(**({'bags': tmp_path / 'bags'} | (marker.kwargs if marker else {}))) as started:
        yield started
