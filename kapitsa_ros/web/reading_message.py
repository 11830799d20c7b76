"""What the rig's own instruments read, as a sentence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.message import Message
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.instruments.stopwatch import StopwatchReading

_ENDS = {
    'fell': 'run {run}, {time:.1f} s: the pendulum fell',
    'stopped': 'run {run}, {time:.1f} s: the pendulum stopped swinging',
}


def reading_message(run: int, reading: StrobeReading | StopwatchReading) -> Message:
    """Return what an instrument of the rig read in a run."""
    if isinstance(reading, StrobeReading):
        return Message(
            'run {run}, {time:.1f} s: strobe {rpm:.6g} RPM', run=run, time=reading.time, rpm=reading.speed / RPM
        )
    if reading.kind != 'timed':
        return Message(_ENDS[reading.kind], run=run, time=reading.pressed_at)
    return Message(
        'run {run}, {time:.1f} s: {swings} swings in {shown:.2f} s, a period of {period:.3f} s',
        run=run,
        time=reading.pressed_at,
        swings=reading.swings,
        shown=reading.displayed,
        period=reading.displayed / reading.swings,
    )
