"""Text of the screen's panels, made from the state of the bench."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich.text import Text

from kapitsa_ros.bench.drawing import draw_dial, draw_marks, draw_rod, draw_ruler
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.bench.bench_state import BenchState
    from kapitsa_ros.instruments.stopwatch import StopwatchReading

    Panel = Callable[[BenchState, float, int, int], Text]

_REACH = 0.2
"""rad; the ruler behind the tip reaches this far, or as far as the release."""
_GUIDE = 3
"""Characters beside the mark: the guide of the blade."""
_ENDS = {'fell': 'fell', 'stopped': 'stopped swinging'}


def rod(state: BenchState, now: float, width: int, height: int) -> Text:
    """Draw the pendulum, and the ruler behind its tip."""
    angle = state.angle(now)
    if math.isnan(angle):
        return Text('the nodes are starting …', style='dim')
    reach = max(_REACH, 1.25 * abs(state.release))
    text = Text('\n'.join(draw_rod(angle, width, height - 2)), style='bold')
    text.append(f'\n{draw_ruler(angle, reach, width)}', 'cyan')
    text.append(f'\n{-reach:<{width // 2}.3g}{reach:>{width - width // 2 - 1}.3g}', 'dim')
    return text


def marks(state: BenchState, now: float, width: int, height: int) -> Text:
    """Draw the mark in the light of the lamp."""
    if not state.dial:
        return Text('the lamp is off:\nd sets its dial', style='dim')
    text = Text()
    inner = width - 2 * (_GUIDE + 1)
    for line, bright in draw_marks(*state.picture(now), state.faintest, inner, height):
        text.append(' ' * _GUIDE + '│', 'dim')
        text.append(line, 'bold yellow' if bright else 'dim')
        text.append('│\n', 'dim')
    text.rstrip()
    return text


def knobs(state: BenchState, now: float, width: int, height: int) -> Text:  # noqa: ARG001
    """Say where the knobs stand and what the stopwatch shows."""
    text = Text()

    def line(name: str, value: str, style: str = 'bold') -> None:
        text.append(f'{name:<15}')
        text.append(f'{value}\n', style)

    line('speed asked', f'{state.speed:.6g} RPM')
    line('release angle', f'{state.release:.4g} rad')
    line('lamp dial', f'{state.dial_reading:.{0 if state.lamp_dial.graduation else 1}f} /min', 'bold yellow')
    if state.lamp_dial.graduation:
        for part in draw_dial(state.dial, state.lamp_dial.graduation, min(width - 2, 33)):
            text.append(f'{part}\n', 'dim')
    line(f'images  {state.images}', f'→ shaft {state.forcing:.6g} RPM')
    line('stopwatch', f'{state.watch.shown(now):.2f} s{"  runs" if state.watch.runs else ""}', 'bold green')
    period = '' if state.watch.runs or not state.watch.shown(now) else f'→ period {state.period(now):.3f} s'
    line(f'swings  {state.swings}', period)
    text.rstrip()
    return text


def own_readings(state: BenchState, now: float, width: int, height: int) -> Text:  # noqa: ARG001
    """List what the person has written down, the newest last."""
    rows = state.notebook.rows
    if not rows:
        return Text('nothing yet: count the images, time a swing,\nthen w writes both down', style='dim')
    text = Text(f'{"":>3}{"run":>5}{"RPM":>10}{"period, s":>12}\n', style='dim')
    for number, row in list(enumerate(rows, start=1))[-(height - 1) :]:
        text.append(f'{number:>3}{row.run:>5}{row.forcing_rpm:>10.6g}{row.period_s:>12.3f}\n', 'default not dim')
    text.rstrip()
    return text


def rig_readings(state: BenchState, now: float, width: int, height: int) -> Text:  # noqa: ARG001
    """List what the instruments of the rig read, the newest last."""
    text = Text()
    for run, reading in list(state.rig_readings)[-height:]:
        text.append(f'run {run}  ', 'dim')
        text.append(f'{_reading_text(reading)}\n')
    text.rstrip()
    return text or Text('nothing yet: they read when the shaft is steady,\nand after a release', style='dim')


def _reading_text(reading: StrobeReading | StopwatchReading) -> str:
    if isinstance(reading, StrobeReading):
        return f'{reading.time:6.1f} s  strobe {reading.speed / RPM:.6g} RPM'
    if reading.kind != 'timed':
        return f'{reading.pressed_at:6.1f} s  the pendulum {_ENDS[reading.kind]}'
    period = reading.displayed / reading.swings
    return f'{reading.pressed_at:6.1f} s  {reading.swings} swings {reading.displayed:.2f} s → {period:.3f} s'


def messages(state: BenchState, now: float, width: int, height: int) -> Text:  # noqa: ARG001
    """Repeat the newest messages."""
    return Text('\n'.join(list(state.messages)[-height:]), no_wrap=True, overflow='ellipsis')


def status(state: BenchState, title: str, now: float, wall: float) -> Text:
    """Say which run it is, what time it is, and how fast it goes."""
    text = Text(no_wrap=True)
    text.append(f' {title}', 'bold')
    if state.run:
        text.append(f'   run {state.run}   {now:7.1f} s   ')
        requested = 'as fast as it can' if state.clock.rate == 0 else f'× {state.clock.rate:g}'
        measured = state.clock.measured_rate(wall)
        text.append(requested if math.isnan(measured) or state.paused else f'{requested} (is {measured:.2f})')
        if state.paused:
            text.append('   PAUSED', 'bold reverse')
    return text


PANELS: dict[str, Panel] = {
    'rod': rod,
    'marks': marks,
    'knobs': knobs,
    'own-readings': own_readings,
    'rig-readings': rig_readings,
    'messages': messages,
}
"""By widget id."""
