"""A watcher of the graph says what has gone wrong with it, and not something else."""

from threading import Event

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.listener_node import ListenerNode
from kapitsa_ros.ros.session_monitor import SessionMonitor


class Speaker(ListenerNode):
    """Says once that the jigsaw makes progress, as soon as somebody listens."""

    def __init__(self, domain: int) -> None:
        super().__init__('jigsaw', domain)
        self._out = self._node.create_publisher(DiagnosticArray, 'diagnostics', 10)
        self._node.create_timer(0.05, self._speak)

    def _speak(self) -> None:
        self._out.publish(DiagnosticArray(status=[DiagnosticStatus(name='jigsaw: progress')]))


def test_an_exception_in_a_callback_reaches_whoever_waits(domain: int) -> None:
    def break_off(_: dict[str, str]) -> None:
        raise ZeroDivisionError('in the callback')

    with on_loopback():
        monitor, speaker = SessionMonitor(domain, break_off), Speaker(domain)
    with speaker, pytest.raises(ZeroDivisionError, match='in the callback'), monitor:
        monitor.wait_for_end(timeout=30.0)


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
