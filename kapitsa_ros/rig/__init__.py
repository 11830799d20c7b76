"""Start, drive and stop the graph as processes; the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kapitsa_ros.rig.harness import Rig

__all__ = ['Rig', 'RigError']

from kapitsa_ros.rig.errors import RigError


def __getattr__(name: str) -> Any:
    """Import the harness when it is asked for: rclpy takes its time, and the command line can do without."""
    if name == 'Rig':
        from kapitsa_ros.rig.harness import Rig  # noqa: PLC0415

        return Rig
    raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
