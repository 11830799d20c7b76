"""What each request of a page does at the bench."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.bench.notebook import WrittenRow
from kapitsa_ros.errors import KapitsaError, said_of
from kapitsa_ros.message import Message
from kapitsa_ros.units import RPM, parse_angle, parse_speed
from kapitsa_ros.web.errors import PageRequestError

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.bench.bench_controls import BenchControls
    from kapitsa_ros.web.protocol import PageRequest
    from kapitsa_ros.web.web_bench import WebBench

MOST_LINES = 500
"""Of the book, notes not counted."""
_MOST_SWINGS, _MOST_IMAGES = 999, 9
_LOOKED = Message('run {run}, {time:.1f} s: the plot of the angle is looked at')


async def carry_out(bench: WebBench, request: PageRequest) -> None:
    """Do what a page asks for.

    Raises
    ------
    PageRequestError
        It cannot be done; the message says why.

    """
    if request.name == 'repair':
        await bench.repair()
        return
    if request.name == 'hand-in':
        bench.hand_in(request.value)
        return
    if bench.failure is not None:
        raise PageRequestError('there is no rig: begin the next run')
    if bench.controls is None:
        raise PageRequestError('the nodes are starting: a moment')
    try:
        _ACTIONS[request.name](bench, bench.controls, request.value)
    except KapitsaError as error:
        raise PageRequestError(error.said.template, **error.said.values) from error
    bench.changed()


def _set_speed(bench: WebBench, controls: BenchControls, value: Any) -> None:  # noqa: ARG001
    controls.set_speed(parse_speed(value) / RPM)


def _turn_dial(bench: WebBench, controls: BenchControls, value: Any) -> None:  # noqa: ARG001
    bench.state.turn_dial(parse_speed(value) / RPM)


def _touch_dial(bench: WebBench, controls: BenchControls, value: float) -> None:  # noqa: ARG001
    bench.state.turn_dial(bench.state.dial + value * bench.state.lamp_dial.touch)


def _set_angle(bench: WebBench, controls: BenchControls, value: Any) -> None:  # noqa: ARG001
    bench.state.set_release(parse_angle(value))


def _release(bench: WebBench, controls: BenchControls, value: None) -> None:  # noqa: ARG001
    controls.release()


def _count_images(bench: WebBench, controls: BenchControls, value: int) -> None:  # noqa: ARG001
    bench.state.images = _within(value, _MOST_IMAGES)


def _count_swings(bench: WebBench, controls: BenchControls, value: int) -> None:  # noqa: ARG001
    bench.state.swings = _within(value, _MOST_SWINGS)


def _press_watch(bench: WebBench, controls: BenchControls, value: float) -> None:  # noqa: ARG001
    bench.press_watch(value)


def _clear_watch(bench: WebBench, controls: BenchControls, value: None) -> None:  # noqa: ARG001
    bench.state.watch.clear()


def _write_down(bench: WebBench, controls: BenchControls, value: None) -> None:  # noqa: ARG001
    if sum(isinstance(line, WrittenRow) for line in bench.state.notebook.lines) >= MOST_LINES:
        raise PageRequestError('the book is full: it has {most} lines', most=MOST_LINES)
    bench.state.write_down(bench.now())
    _fit(bench)


def _strike_out(bench: WebBench, controls: BenchControls, value: int) -> None:  # noqa: ARG001
    bench.state.strike_out(value or None)
    _fit(bench)


def _pause(bench: WebBench, controls: BenchControls, value: None) -> None:  # noqa: ARG001
    controls.toggle_pause()


def _step(bench: WebBench, controls: BenchControls, value: None) -> None:  # noqa: ARG001
    controls.step()


def _set_pace(bench: WebBench, controls: BenchControls, value: float) -> None:
    controls.set_pace(min(value, bench.setup.fastest_rate))


def _begin_run(bench: WebBench, controls: BenchControls, value: None) -> None:  # noqa: ARG001
    controls.begin_run()


def _show_rig_readings(bench: WebBench, controls: BenchControls, value: None) -> None:  # noqa: ARG001
    bench.rig_readings_seen = not bench.rig_readings_seen


def _look_at_plot(bench: WebBench, controls: BenchControls, value: None) -> None:  # noqa: ARG001
    run = bench.state.run
    if not bench.plot_seen and bench.plot_noted_in != run:
        try:
            bench.state.notebook.note(Message(_LOOKED, run=run, time=bench.now()))
        except OSError as error:
            raise PageRequestError('the book cannot note that: {why}', why=said_of(error)) from error
        bench.plot_noted_in = run
    bench.plot_seen_in = None if bench.plot_seen else run


_ACTIONS: dict[str, Callable[[WebBench, BenchControls, Any], None]] = {
    'speed': _set_speed,
    'dial': _turn_dial,
    'touch': _touch_dial,
    'angle': _set_angle,
    'release': _release,
    'images': _count_images,
    'swings': _count_swings,
    'watch': _press_watch,
    'clear': _clear_watch,
    'write': _write_down,
    'strike': _strike_out,
    'pause': _pause,
    'step': _step,
    'pace': _set_pace,
    'next-run': _begin_run,
    'rig-readings': _show_rig_readings,
    'look': _look_at_plot,
}


def _within(value: int, most: int) -> int:
    if not 1 <= value <= most:
        raise PageRequestError('a count from 1 to {most}', most=most)
    return value


def _fit(bench: WebBench) -> None:
    book = bench.state.notebook
    bench.fit.begin(book.path, len(book.rows))
