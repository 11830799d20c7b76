"""A watcher of the graph says what has gone wrong with it, and not something else."""

from collections.abc import Callable
from contextlib import ExitStack
from threading import Event
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from kapitsa_ros.network.cdr import encode_header
from kapitsa_ros.network.registry import RESULT
from kapitsa_ros.network.step_clock import DAY
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.listener_node import ListenerNode
from kapitsa_ros.ros.qos import STREAM, message_class
from kapitsa_ros.ros.session_monitor import SessionMonitor

REPORT = {'run': '1', 'simulated_s': '0.5', 'realtime_factor': '2.0', 'session_over': 'False'}


class Speaker(ListenerNode):
    """Says once that the jigsaw makes progress, as soon as somebody listens."""

    def __init__(self, domain: int, *reports: dict[str, str]) -> None:
        self._reports = reports or (REPORT,)
        super().__init__('jigsaw', domain)
        self._out = self._node.create_publisher(DiagnosticArray, 'diagnostics', 10)
        self._node.create_timer(0.05, self._speak)

    def _speak(self) -> None:
        for report in self._reports:
            values = [KeyValue(key=key, value=value) for key, value in report.items()]
            self._out.publish(DiagnosticArray(status=[DiagnosticStatus(name='jigsaw: progress', values=values)]))


class Writer(ListenerNode):
    """Says results."""

    def __init__(self, name: str, domain: int) -> None:
        super().__init__(name, domain)
        self._out = self._node.create_publisher(message_class(RESULT.type), RESULT.name, STREAM)

    @property
    def is_heard(self) -> bool:
        return self._out.get_subscription_count() > 0

    def say(self, raw: bytes) -> None:
        self._out.publish(raw)
        assert self._out.wait_for_all_acked()


def test_an_exception_in_a_callback_reaches_whoever_waits(domain: int) -> None:
    def break_off(_: dict[str, str]) -> None:
        raise ZeroDivisionError('in the callback')

    with on_loopback():
        monitor, speaker = SessionMonitor(domain, break_off), Speaker(domain)
    with speaker, pytest.raises(ZeroDivisionError, match='in the callback'), monitor:
        monitor.wait_for_end(timeout=180)


def test_an_exception_in_a_callback_is_raised_on_leaving_where_nobody_waited(domain: int) -> None:
    called = Event()

    def break_off(_: dict[str, str]) -> None:
        called.set()
        raise ZeroDivisionError('in the callback')

    def listen() -> None:
        with monitor:
            assert called.wait(30.0)

    with on_loopback():
        monitor, speaker = SessionMonitor(domain, break_off), Speaker(domain)
    with speaker, pytest.raises(ZeroDivisionError, match='in the callback'):
        listen()


def test_an_error_of_the_body_is_not_replaced_by_that_of_a_callback(domain: int) -> None:
    called = Event()

    def break_off(_: dict[str, str]) -> None:
        called.set()
        raise ZeroDivisionError

    def listen() -> None:
        with monitor:
            assert called.wait(30.0)
            raise KeyError('of the body')

    with on_loopback():
        monitor, speaker = SessionMonitor(domain, break_off), Speaker(domain)
    with speaker, pytest.raises(KeyError, match='of the body'):
        listen()


@pytest.mark.parametrize('forged', [b'', b'\xff' * 64], ids=['well formed', 'nonsense'])
def test_a_result_that_two_have_said_is_disputed(
    domain: int, eventually: Callable[[Callable[[], Any]], None], forged: bytes
) -> None:
    """A stranger's came first, in the second in which the analyser was at work on its own, and was believed."""
    with on_loopback():
        monitor, analyser = SessionMonitor(domain), Writer('analyser', domain)
    with monitor, analyser, ExitStack() as later:
        eventually(lambda: analyser.is_heard)
        analyser.say(RESULT.codec.encode_silence(DAY, StepId(1, 0)))
        eventually(lambda: monitor.has_one_source)
        with on_loopback():
            stranger = later.enter_context(Writer('stranger', domain))
        eventually(lambda: stranger.is_heard and monitor._results.strangers() == ['stranger'])  # its name comes last
        stranger.say(b'')  # its next is the second, as the next of the analyser
        end = StepId(1, 1, end=True)
        stranger.say(encode_header(DAY, end) + forged if forged else RESULT.encode(DAY, end, {'run 1': {}}))
        analyser.say(RESULT.encode(DAY, end, {'run 1': {'fell': True}}))
        with pytest.raises(NodeError, match=r'^analyser/result has a second writer, stranger: .*ROS_DOMAIN_ID'):
            monitor.wait_for_end(timeout=180)


def test_what_is_no_report_of_progress_is_passed_over(domain: int) -> None:
    """Anybody may speak on `diagnostics`; three such messages ended the watcher with a traceback."""
    runs = ['x', '-' + '9' * 300, '9' * 300, '\n\n1\n\n', '\u0661', '+1', '1_0']
    numbers = ['nan', 'inf', '1e308', '-0.5', '1_0.0', ' 2.0', '\u0662.0']
    nonsense = [
        {},
        {'run': '1'},
        *(REPORT | {'run': run} for run in runs),
        *(REPORT | {name: number} for name in ('simulated_s', 'realtime_factor') for number in numbers),
        REPORT | {'session_over': 'x' * 10**6},
        REPORT | {'step': 'x' * 10**6},
        REPORT | {'x' * 10**6: '1'},
    ]
    told, seen = [], Event()

    def take(values: dict[str, str]) -> None:
        told.append(values)
        seen.set()

    with on_loopback():
        monitor, speaker = SessionMonitor(domain, take), Speaker(domain, *nonsense, REPORT)
    with speaker, monitor:
        assert seen.wait(30.0)
    assert all(values == REPORT for values in told)
    assert monitor.realtime_factor == 0.0  # a number that is printed comes from the steps
    assert not monitor.session_over
