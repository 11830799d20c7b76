"""How far the rig is and how its nodes are, for whoever watches `/diagnostics`; all stamps are simulated time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from std_msgs.msg import Header

from kapitsa_ros.network.step_id import ends_session, is_count
from kapitsa_ros.ros.clock_publisher import to_time

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rclpy.node import Node

    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.ros.real_time_pacer import RealTimePacer

_LARGEST = 1e10
"""Of a number in a report of progress; a larger one is nobody's who keeps time."""
_COUNTS = ('run', 'step', 'deadline_misses')
_NUMBERS = ('simulated_s', 'realtime_factor', 'step_rate_hz')
_ANSWERS = ('session_over', 'paused')
_NEEDED = frozenset(('run', 'simulated_s', 'realtime_factor', 'session_over'))


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


def is_progress(values: Mapping[str, str]) -> bool:
    """Whether these are values that `progress_message` could have: anybody may speak on `/diagnostics`."""
    return values.keys() >= _NEEDED and all(_could_be(name, text) for name, text in values.items())


def _could_be(name: str, text: str) -> bool:
    if name in _COUNTS:
        return is_count(text)
    if name in _ANSWERS:
        return text in {'True', 'False'}
    try:
        return name in _NUMBERS and str(float(text)) == text and 0.0 <= float(text) <= _LARGEST
    except ValueError:
        return False


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
