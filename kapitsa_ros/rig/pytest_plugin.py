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


@pytest.fixture
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    """All nodes of the laboratory, in a domain of their own; `@pytest.mark.rig(...)` says what they are made of."""
    from kapitsa_ros.rig.environment import on_loopback  # noqa: PLC0415  # every run of pytest imports this file
    from kapitsa_ros.rig.harness import Rig  # noqa: PLC0415

    marker = request.node.get_closest_marker('rig')
    # The test's own nodes keep to this machine, too.
    with on_loopback(), Rig(**({'bags': tmp_path / 'bags'} | (marker.kwargs if marker else {}))) as started:
        yield started
