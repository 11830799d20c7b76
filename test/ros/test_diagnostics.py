"""What is said on /diagnostics: under which name, and how grave it is."""

from types import SimpleNamespace
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.ros.diagnostics import failure_message, health_message
from kapitsa_ros.ros.progress_reporter import ProgressReporter
from kapitsa_ros.ros.real_time_pacer import RealTimePacer


def reporter(namespace: str, pace: RealTimePacer) -> tuple[ProgressReporter, list[DiagnosticArray]]:
    said: list[DiagnosticArray] = []
    full = f'{namespace.rstrip("/")}/jigsaw'
    node: Any = SimpleNamespace(
        get_name=lambda: 'jigsaw',
        get_namespace=lambda: namespace,
        get_fully_qualified_name=lambda: full,
        diagnostics=SimpleNamespace(publish=said.append),
    )
    return ProgressReporter(node, pace), said


@pytest.mark.parametrize(
    ('namespace', 'name'), [('/', 'jigsaw: progress'), ('/lab/left', '/lab/left/jigsaw: progress')]
)
def test_a_namespace_is_in_the_name(namespace: str, name: str) -> None:
    report, said = reporter(namespace, RealTimePacer(1.0))
    report.tell(StepId(2, 7), 172_800_700_000_000)
    [status] = said[0].status
    assert status.name == name
    assert (said[0].header.stamp.sec, said[0].header.stamp.nanosec) == (172_800, 700_000_000)


def test_lost_time_is_a_warning_once() -> None:
    pace = RealTimePacer(1.0)
    report, said = reporter('/', pace)
    for misses in (0, 2, 2):
        pace.misses = misses
        report.tell(StepId(1, 5, end=True), 0)  # the end of a run is always told
    assert [array.status[0].level for array in said] == [
        DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.OK,
    ]  # fmt: skip


def test_how_grave_it_is() -> None:
    messages = [health_message('x', 0, 0, 0), health_message('x', 0, 1, 0), failure_message('x', 0, 'why')]
    assert [message.status[0].level for message in messages] == [
        DiagnosticStatus.OK, DiagnosticStatus.WARN, DiagnosticStatus.ERROR,
    ]  # fmt: skip
