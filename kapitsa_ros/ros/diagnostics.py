"""How far the rig is and how its nodes are, for whoever watches `/diagnostics`; all stamps are simulated time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from std_msgs.msg import Header

from kapitsa_ros.network.step_id import ends_session
from kapitsa_ros.ros.clock_publisher import to_time

if TYPE_CHECKING:
    from rclpy.node import Node

    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.ros.real_time_pacer import RealTimePacer


def reporter_name(node: Node) -> str:
    """Return the name under which a node reports: in a namespace with it, for `/diagnostics` is everybody's."""
    return node.get_name() if node.get_namespace() == '/' else node.get_fully_qualified_name()


def progress_message(
    node: str,
    step_id: StepId,
    stamp_ns: int,
    pace: RealTimePacer,
    *,
    is_late: bool = False,
    paused: bool | None = None,
) -> DiagnosticArray:
    """Return the state of the node that owns time; a warning where it has given up time since the last report.

    Whether it stands still (`paused`) can say who reports even then.
    """
    values = {
        'run': step_id.run,
        'step': step_id.step,
        'simulated_s': pace.simulated,
        'realtime_factor': pace.realtime_factor,
        'step_rate_hz': pace.step_rate,
        'deadline_misses': pace.misses,
        'session_over': ends_session(step_id),
        **({} if paused is None else {'paused': paused}),
    }
    level, text = (DiagnosticStatus.WARN, f'{step_id}, late') if is_late else (DiagnosticStatus.OK, str(step_id))
    return _array(f'{node}: progress', stamp_ns, level, text, values)


def health_message(node: str, stamp_ns: int, refused: int, held_up: int) -> DiagnosticArray:
    """Return what has gone wrong around a node that goes on: input it refused, and readers that held it up."""
    values = {'refused': refused, 'held_up': held_up}
    level, text = (DiagnosticStatus.WARN, 'see the log') if refused or held_up else (DiagnosticStatus.OK, 'well')
    return _array(f'{node}: health', stamp_ns, level, text, values)


def failure_message(node: str, stamp_ns: int, why: str) -> DiagnosticArray:
    """Return why a node ends; a gap in its input is such a reason."""
    return _array(f'{node}: health', stamp_ns, DiagnosticStatus.ERROR, why, {})


def _array(name: str, stamp_ns: int, level: bytes, text: str, values: dict[str, Any]) -> DiagnosticArray:
    pairs = [KeyValue(key=key, value=str(value)) for key, value in values.items()]
    status = DiagnosticStatus(level=level, name=name, message=text, hardware_id='kapitsa_ros', values=pairs)
    return DiagnosticArray(header=Header(stamp=to_time(stamp_ns)), status=[status])
