"""Keys that steer a replay, where stdin is a terminal: those of `ros2 bag play`."""

from __future__ import annotations

import os
import select
import sys
import termios
import threading
import tty
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kapitsa_ros.ros.time_control_client import TimeControlClient

HELP = 'space: pause and resume; →: one step; ↑ ↓: faster and slower by 10 %'
_SPACE, _RIGHT, _UP, _DOWN = b' ', b'\x1b[C', b'\x1b[A', b'\x1b[B'
_FASTER = 1.1


@contextmanager
def replay_keys(control: TimeControlClient, rate: float) -> Iterator[None]:
    """Take keys while the context lasts.

    Parameters
    ----------
    control
        Of the player.
    rate
        At which it begins; from 0, as fast as it can, keys lead to real time.

    """
    if not sys.stdin.isatty():
        yield
        return
    click.echo(HELP, err=True)
    file = sys.stdin.fileno()
    before = termios.tcgetattr(file)
    leave, left = os.pipe()
    thread = threading.Thread(target=_take_keys, args=(file, leave, control, rate), daemon=True)
    tty.setcbreak(file)
    try:
        thread.start()
        yield
    finally:
        os.close(left)
        thread.join()
        os.close(leave)
        termios.tcsetattr(file, termios.TCSADRAIN, before)


def _take_keys(file: int, leave: int, control: TimeControlClient, rate: float) -> None:
    while leave not in (ready := select.select([file, leave], [], [])[0]) and file in ready:
        typed = os.read(file, 64)
        if not typed:  # the terminal is gone
            return
        if not control.is_served():
            continue
        for key in _split(typed):
            if key == _SPACE:
                control.call('toggle_paused')
            elif key == _RIGHT:
                control.call('step')
            elif key in {_UP, _DOWN}:
                rate = (rate or 1.0) * (_FASTER if key == _UP else 1.0 / _FASTER)
                control.set_parameters(rate=rate)


def _split(typed: bytes) -> list[bytes]:
    """Return the keys of what was typed; arrows take three bytes."""
    keys = []
    while typed:
        length = 3 if typed.startswith(b'\x1b[') else 1
        keys.append(typed[:length])
        typed = typed[length:]
    return keys
