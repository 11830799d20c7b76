"""A watcher of the graph says what has gone wrong with it, and not something else."""

from threading import Event

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.listener_node import ListenerNode
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
