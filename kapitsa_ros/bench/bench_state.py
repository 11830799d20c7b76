"""State of the bench: knobs, what the graph has published, readings written down."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.bench.bench_clock import BenchClock
from kapitsa_ros.bench.lamp_dial import LampDial
from kapitsa_ros.bench.notebook import Row
from kapitsa_ros.bench.stopwatch import HandStopwatch
from kapitsa_ros.errors import said_of
from kapitsa_ros.instruments.dial_search import graduation
from kapitsa_ros.instruments.errors import InstrumentError
from kapitsa_ros.instruments.lamp import Lamp
from kapitsa_ros.message import Message
from kapitsa_ros.network.registry import MOTION, PIVOT, RESULT, STOPWATCH_READING, STROBE_READING
from kapitsa_ros.operator.requests import check_release, check_speed
from kapitsa_ros.physics.jigsaw_parameters import MAX_SPEED
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from kapitsa_ros.bench.notebook import Notebook
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.instruments.stopwatch import StopwatchReading
    from kapitsa_ros.instruments.strobe import StrobeReading
    from kapitsa_ros.physics.plant import Plant
    from kapitsa_ros.physics.sampled_motion import SampledMotion
    from kapitsa_ros.ros.rig_client import News

FASTEST = round(MAX_SPEED / RPM)
"""RPM."""
_BLOCKS = 20
"""Blocks of the motion that are kept to look at."""
_MESSAGES_KEPT = 50
_READINGS_KEPT = 50
_FALLEN = 1.5
"""rad; it lies."""


class BenchState:
    """State of the bench, without processes and without a screen.

    Simulated time is in seconds of the run, wall time in seconds of a monotonic clock.

    Parameters
    ----------
    plant
        Its stroke says how the mark moves.
    instruments
        What lamp and stopwatch are like.
    notebook
        Where the person's readings go.
    rate
        Simulated over wall seconds.

    """

    def __init__(self, plant: Plant, instruments: Instruments, notebook: Notebook, rate: float) -> None:
        self.plant = plant
        self._settings = instruments.strobe
        self.lamp_dial = LampDial(instruments.strobe)
        self.notebook = notebook
        self.clock = BenchClock(rate)
        self.lamp = Lamp(instruments.strobe, plant.amplitude)
        self.watch = HandStopwatch(instruments.stopwatch)
        self.run = 0
        """Number of the run; 0: the nodes are not ready yet."""
        self.runs_before = 0
        """Runs of a rig that died before this one: the numbers go on."""
        self.speed = 0.0
        """Requested, RPM."""
        self.release = 0.12
        """Angle of the next release, rad."""
        self._released = math.nan
        self.images = 2
        """How many the person counts: the dial is divided by them."""
        self.swings = 3
        """Full swings that the person times."""
        self.paused = False
        self.dial = 0.0
        """Where the lamp's dial points, flashes a minute."""
        self.rig_readings: deque[tuple[int, StrobeReading | StopwatchReading]] = deque(maxlen=_READINGS_KEPT)
        """What the instruments of the rig read, and in which run."""
        self.messages: deque[Message] = deque(maxlen=_MESSAGES_KEPT)
        """Messages, the newest last."""
        self._motion: deque[tuple[float, SampledMotion]] = deque(maxlen=_BLOCKS)
        self._lies = False

    def notify(self, template: str, **values: Any) -> None:
        """Tell the person something: see `Message`."""
        self.messages.append(Message(template, **values))

    def receive(self, news: list[News], wall: float) -> None:
        """Take messages of the graph that came at a wall time."""
        for topic, step_id, value in news:
            run = self.runs_before + step_id.run
            if topic == RESULT.name:
                self._receive_result(value)
                continue
            if run > self.run:
                self._begin(run)
            if run < self.run:
                continue
            if topic == PIVOT.name:
                self.lamp.shine(step_id.step * value.duration, value)
            elif topic == MOTION.name:
                start = step_id.step * value.duration
                self._motion.append((start, value))
                self.clock.follow(wall, start, start + value.duration)
            elif topic in (STROBE_READING.name, STOPWATCH_READING.name):
                self.rig_readings.append((run, value))

    def set_speed(self, rpm: float) -> None:
        """Note the requested speed.

        Raises
        ------
        RequestError
            The jigsaw cannot turn so.

        """
        check_speed(rpm * RPM, MAX_SPEED)
        self.speed = rpm

    def set_release(self, angle: float) -> None:
        """Note from what angle the pendulum is to be released, rad.

        Raises
        ------
        RequestError
            The angle is not within a quarter turn of upright.

        """
        check_release(angle)
        self.release = angle

    def note_release(self, angle: float) -> None:
        """Note that the pendulum was asked to be let go from an angle, rad."""
        self._released = angle
        self.notify('released from {angle:.4g} rad', angle=angle)

    def set_paused(self, *, paused: bool) -> None:
        """Note whether time stands still."""
        self.paused = self.clock.standing = paused
        self.clock.measure_anew()

    def turn_dial(self, dial: float) -> None:
        """Let the dial of the lamp point at a number of flashes a minute; its ends stop it.

        Raises
        ------
        InstrumentError
            It is no number.

        """
        if math.isnan(dial):
            raise InstrumentError('the dial of the lamp shows flashes a minute: give a number')
        self.dial = min(max(dial, 0.0), self.lamp_dial.end)
        self.lamp.turn(self.dial * RPM)

    @property
    def dial_reading(self) -> float:
        """What is read off the dial, flashes a minute."""
        return graduation(self.lamp.flash_rate, self._settings) / RPM

    @property
    def forcing(self) -> float:
        """The shaft's speed by lamp and count, RPM."""
        return self.dial_reading / self.images

    def period(self, now: float) -> float:
        """Return the period by stopwatch and count, s."""
        return self.watch.shown(now) / self.swings

    def angle(self, now: float) -> float:
        """Return the angle of the rod, rad; NaN before anything is known."""
        for start, motion in reversed(self._motion):
            if start <= now:
                at = min((now - start) / motion.period, motion.position.size - 1.0)
                before = min(int(at), motion.position.size - 2)
                low, high = motion.position[before : before + 2].tolist()
                return float(low + (at - before) * (high - low))
        return float(self._motion[0][1].position[0]) if self._motion else math.nan

    def picture(self, now: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return heights and shares of the images under the lamp."""
        return self.lamp.picture(now)

    @property
    def faintest(self) -> float:
        """Share of the flashes below which an image is only a glimmer."""
        return self._settings.contrast_limit

    def check_fall(self, now: float) -> None:
        """Say so when the rod has fallen over."""
        lies = abs(self.angle(now)) > _FALLEN  # not before anything is known
        if lies and not self._lies:
            self.notify('the pendulum fell: r sets it up again')
        self._lies = lies

    def press_watch(self, now: float) -> None:
        """Start or stop the stopwatch, at a simulated time, s.

        Raises
        ------
        InstrumentError
            It runs, and was started after that.

        """
        self.watch.press(now)

    def write_down(self, now: float) -> None:
        """Write forcing speed and period into the table, or notify the person why not."""
        if self.watch.runs:
            self.notify('not written down: stop the watch first (space)')
            return
        row = Row(
            run=self.run,
            forcing_rpm=self.forcing,
            period_s=self.period(now),
            display_s=self.watch.shown(now),
            swings=self.swings,
            release_rad=self._released,
        )
        try:
            self.notebook.write_down(row)
        except (TableError, OSError) as error:
            self.notify('not written down: {why}', why=said_of(error))
        else:
            self.notify('written down: {rpm:.6g} RPM, {period:.3f} s', rpm=row.forcing_rpm, period=row.period_s)
            self.watch.clear()

    def strike_out(self, number: int | None = None) -> None:
        """Strike out a line of the table, by its number from 1; None: the last that is not struck out yet."""
        try:
            row = self.notebook.strike_out(number)
        except (TableError, OSError) as error:
            self.notify('not struck out: {why}', why=said_of(error))
            return
        if row is None:
            self.notify('nothing is written down yet')
        else:
            self.notify('struck out: {rpm:.6g} RPM', rpm=row.forcing_rpm)

    def _begin(self, run: int) -> None:
        self.run = run
        self.clock.restart()
        self.watch.clear()
        self._motion.clear()
        self._lies = False
        self.notify('run {run}: the shaft is at rest, the pendulum is held', run=run)

    def _receive_result(self, result: dict[str, dict[str, float | None]]) -> None:
        for name, values in result.items():
            if name.startswith('run '):
                speed, period = values['speed_reading_rpm'], values['period_s']
                self.notify(
                    READ_BY_RIG[speed is not None, period is not None],
                    run=int(name.removeprefix('run ')) + self.runs_before,
                    rpm=speed,
                    period=period,
                )


READ_BY_RIG = {
    (True, True): 'run {run} is over; the rig read {rpm:.6g} RPM, a period of {period:.3f} s',
    (True, False): 'run {run} is over; the rig read {rpm:.6g} RPM, no swing',
    (False, True): 'run {run} is over; the rig read no speed, a period of {period:.3f} s',
    (False, False): 'run {run} is over; the rig read no speed, no swing',
}
"""What the instruments of the rig read in a run, by whether a speed and a period were read."""
