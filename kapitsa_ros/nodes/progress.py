"""How far the rig is, for whoever watches `diagnostics`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from std_msgs.msg import Header

from kapitsa_ros.nodes.view import to_time
from kapitsa_ros.physics.steps import ends_session

if TYPE_CHECKING:
    from kapitsa_ros.nodes.pace import Pace
    from kapitsa_ros.physics.steps import Tick


def progress_message(node: str, tick: Tick, stamp_ns: int, pace: Pace) -> DiagnosticArray:
    """Return the state of the node that owns time."""
    values = {
        'run': tick.run,
        'step': tick.step,
        'simulated_s': pace.simulated,
        'realtime_factor': pace.realtime_factor,
        'deadline_misses': pace.misses,
        'session_over': ends_session(tick),
    }
    status = DiagnosticStatus(
        level=DiagnosticStatus.OK,
        name=f'{node}: progress',
        message=str(tick),
        hardware_id='kapitsa_ros',
        values=[KeyValue(key=key, value=str(value)) for key, value in values.items()],
    )
    return DiagnosticArray(header=Header(stamp=to_time(stamp_ns)), status=[status])
