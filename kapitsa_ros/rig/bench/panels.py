"""What the panels of the screen say, from what lies on the desk."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich.text import Text

from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.rig.bench.drawing import draw_dial, draw_marks, draw_rod, draw_ruler
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.rig.bench.desk import Desk

    Panel = Callable[[Desk, float, int, int], Text]

_REACH = 0.2
"""rad; the ruler behind the tip reaches this far, or as far as the release."""
_GUIDE = 3
"""Characters beside the mark: the guide of the blade."""
_ENDS = {'fell': 'fell', 'stopped': 'stopped swinging'}


def rod(desk: Desk, now: float, width: int, height: int) -> Text:
    """Draw the pendulum, and the ruler behind its tip."""
    angle = desk.angle(now)
    if math.isnan(angle):
        return Text('the nodes are starting …', style='dim')
    reach = max(_REACH, 1.25 * abs(desk.release))
    text = Text('\n'.join(draw_rod(angle, width, height - 2)), style='bold')
    text.append(f'\n{draw_ruler(angle, reach, width)}', 'cyan')
    text.append(f'\n{-reach:<{width // 2}.3g}{reach:>{width - width // 2 - 1}.3g}', 'dim')
    return text


def marks(desk: Desk, now: float, width: int, height: int) -> Text:
    """Draw the mark in the light of the lamp."""
    if not desk.dial:
        return Text('the lamp is off:\nd sets its dial', style='dim')
    text = Text()
    inner = width - 2 * (_GUIDE + 1)
    for line, bright in draw_marks(*desk.picture(now), desk.faintest, inner, height):
        text.append(' ' * _GUIDE + '│', 'dim')
        text.append(line, 'bold yellow' if bright else 'dim')
        text.append('│\n', 'dim')
    text.rstrip()
    return text


def knobs(desk: Desk, now: float, width: int, height: int) -> Text:  # noqa: ARG001
    """Say where the knobs stand and what the stopwatch shows."""
    text = Text()

    def line(name: str, value: str, style: str = 'bold') -> None:
        text.append(f'{name:<15}')
        text.append(f'{value}\n', style)

    line('speed asked', f'{desk.speed:.6g} RPM')
    line('release angle', f'{desk.release:.4g} rad')
    line('lamp dial', f'{desk.dial_reading:.{0 if desk.graduation else 1}f} /min', 'bold yellow')
    if desk.graduation:
        for part in draw_dial(desk.dial, desk.graduation, min(width - 2, 33)):
            text.append(f'{part}\n', 'dim')
    line(f'images  {desk.images}', f'→ shaft {desk.forcing:.6g} RPM')
    line('stopwatch', f'{desk.watch.shown(now):.2f} s{"  runs" if desk.watch.runs else ""}', 'bold green')
    period = '' if desk.watch.runs or not desk.watch.shown(now) else f'→ period {desk.period(now):.3f} s'
    line(f'swings  {desk.swings}', period)
    text.rstrip()
    return text


def mine(desk: Desk, now: float, width: int, height: int) -> Text:  # noqa: ARG001
    """List what the person has written down, the newest last."""
    rows = desk.notebook.rows
    if not rows:
        return Text('nothing yet: count the images, time a swing,\nthen w writes both down', style='dim')
    text = Text(f'{"":>3}{"run":>5}{"RPM":>10}{"period, s":>12}\n', style='dim')
    for number, row in list(enumerate(rows, start=1))[-(height - 1) :]:
        text.append(f'{number:>3}{row.run:>5}{row.forcing_rpm:>10.6g}{row.period_s:>12.3f}\n', 'default not dim')
    text.rstrip()
    return text


def crew(desk: Desk, now: float, width: int, height: int) -> Text:  # noqa: ARG001
    """List what the instruments of the rig read, the newest last."""
    text = Text()
    for run, reading in list(desk.crew)[-height:]:
        text.append(f'run {run}  ', 'dim')
        text.append(f'{_crew_reading(reading)}\n')
    text.rstrip()
    return text or Text('nothing yet: they read when the shaft is steady,\nand after a release', style='dim')


def _crew_reading(reading: StrobeReading | StopwatchReading) -> str:
    if isinstance(reading, StrobeReading):
        return f'{reading.time:6.1f} s  strobe {reading.speed / RPM:.6g} RPM'
    if reading.kind != 'timed':
        return f'{reading.pressed_at:6.1f} s  the pendulum {_ENDS[reading.kind]}'
    period = reading.displayed / reading.swings
    return f'{reading.pressed_at:6.1f} s  {reading.swings} swings {reading.displayed:.2f} s → {period:.3f} s'


def messages(desk: Desk, now: float, width: int, height: int) -> Text:  # noqa: ARG001
    """Repeat the newest messages."""
    return Text('\n'.join(list(desk.spoken)[-height:]), no_wrap=True, overflow='ellipsis')


def status(desk: Desk, title: str, now: float, wall: float) -> Text:
    """Say which run it is, what time it is, and how fast it goes."""
    text = Text(no_wrap=True)
    text.append(f' {title}', 'bold')
    if desk.run:
        text.append(f'   run {desk.run}   {now:7.1f} s   ')
        asked = 'as fast as it can' if desk.clock.rate == 0 else f'× {desk.clock.rate:g}'
        measured = desk.clock.measured_rate(wall)
        text.append(asked if math.isnan(measured) or desk.paused else f'{asked} (is {measured:.2f})')
        if desk.paused:
            text.append('   PAUSED', 'bold reverse')
    return text


PANELS: dict[str, Panel] = {
    'rod': rod,
    'marks': marks,
    'knobs': knobs,
    'mine': mine,
    'crew': crew,
    'messages': messages,
}
"""By name on the screen."""
