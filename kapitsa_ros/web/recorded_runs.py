"""Recorded runs, in the pieces in which a page asks for them."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros._api.reduce import Reduction, reduce
from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.experiment import plant_of
from kapitsa_ros.analysis.results import run_values
from kapitsa_ros.analysis.ruler import ruler_of
from kapitsa_ros.analysis.timing_row import timing_rows
from kapitsa_ros.bench.lamp_dial import LampDial
from kapitsa_ros.configuration.tables import TimingTable
from kapitsa_ros.instruments.lamp import AFTERIMAGE, Lamp, mark_heights
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.network.step_clock import DAY, SECOND
from kapitsa_ros.recording.reader import runs_of
from kapitsa_ros.units import RPM
from kapitsa_ros.web.errors import PageRequestError
from kapitsa_ros.web.motion_frame import encode_motion
from kapitsa_ros.web.reading_message import reading_message

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from kapitsa_ros.physics.sampled_motion import SampledMotion
    from kapitsa_ros.recording.reader import RunBag

MOST_STEPS = 100
"""That are given at once."""
_PARTS = 600
"""Of a run, in which its motion is told by the ends of its range."""


class RecordedRuns:
    """Runs in bags; asked from any thread.

    Parameters
    ----------
    paths
        Of the bags.

    Raises
    ------
    BagError
        One of them is no bag, has no run of this rig in it, or holds what no rig can have said.
    RunError
        The settings in one do not describe a plant.

    """

    def __init__(self, paths: Sequence[Path]) -> None:
        self.bags = runs_of(paths)
        for bag in self.bags:
            _, _ = bag.run.plant, bag.motion  # what cannot be shown is refused before there is a page
        self._lock = threading.Lock()
        self._lamps = [_lamp_settings(bag) for bag in self.bags]

    def defects(self) -> list[str]:
        """Return what is missing or damaged in the bags, a sentence each, with its path."""
        return list(dict.fromkeys(f'{bag.path}: {defect}' for bag in self.bags for defect in bag.defects))

    def listed(self, words: dict[str, str]) -> list[dict[str, Any]]:
        """Return what each run is, what was asked and read in it, and what its bag lacks; SI, speeds in RPM."""
        with self._lock:
            return [self._told(bag, lamp, words) for bag, lamp in zip(self.bags, self._lamps, strict=True)]

    def motion(self, number: int, begin: int, count: int, dial: float) -> bytes:
        """Return the steps of a run that are there, as frames of `encode_motion` one after the other.

        Parameters
        ----------
        number
            Place of the run among all, from 0.
        begin, count
            First step, and how many.
        dial
            Of the lamp, flashes a minute; 0: it is off.

        Raises
        ------
        PageRequestError
            There is no such run, or too much is asked for.
        InstrumentError
            The dial does not go so far.

        """
        if not 0 <= number < len(self.bags):
            raise PageRequestError('there is no run {number}', number=number)
        if not (begin >= 0 and 1 <= count <= MOST_STEPS):
            raise PageRequestError('from step 0 on, {most} steps at most', most=MOST_STEPS)
        bag = self.bags[number]
        lamp = Lamp(self._lamps[number], bag.run.plant.amplitude)
        lamp.turn(dial * RPM)
        with self._lock:
            return b''.join(
                encode_motion(
                    bag.number, start, pendulum, pivot, _flashes(lamp.flash_rate, start, pivot, bag.run.plant.amplitude)
                )
                for start, pendulum, pivot in bag.motions(begin, begin + count)
            )

    def reduction(self) -> Reduction:
        """Return the critical speed by what was read in all runs, as `kapitsa analyse` finds it.

        Raises
        ------
        KapitsaError
            The runs are of different plants, or nothing was timed.

        """
        with self._lock:
            runs = [bag.run for bag in self.bags]
            plant, ruler = plant_of(runs), ruler_of(*runs)
            table = TimingTable(rows=tuple(timing_rows(runs, DEFAULT_ASSUMPTIONS.dial_u)))
        return reduce(table, plant.replaced({'amplitude': ruler.amplitude}), amplitude_sigma=ruler.sigma)

    def _told(self, bag: RunBag, lamp: StrobeSettings, words: dict[str, str]) -> dict[str, Any]:
        plant, dial = bag.run.plant, LampDial(lamp)
        first = next(bag.motions(0, 2**53), None)
        begin = (bag.motion.stamps_ns[:1].tolist() or [bag.number * DAY])[0] / SECOND - bag.number * DAY / SECOND
        times = begin + (bag.motion.stamps_ns - bag.motion.stamps_ns[:1]) / SECOND
        duration = float(times[-1]) if times.size else 0.0
        readings = sorted(
            (time, reading_message(bag.number, reading).said_by(words))
            for each in bag.run.readings.values()
            for reading in each
            for time in [getattr(reading, 'time', None) or reading.pressed_at]
        )
        return {
            'name': bag.name,
            'number': bag.number,
            'complete': bag.complete,
            'defects': list(bag.defects),
            'unverified': bag.integrity.ok is None,
            'duration': duration,
            'step': first[1].duration if first else None,
            'length': plant.length,
            'amplitude': plant.amplitude,
            'afterimage': AFTERIMAGE,
            'mark_width': lamp.mark_width,
            'dial_end': dial.end,
            'graduation': dial.graduation,
            'touch': dial.touch,
            'asked_rpm': [[begin + time, speed / RPM] for time, speed in bag.recorded.asked],
            'readings': [text for _, text in readings],
            'range_rad': _ranges(times, bag.motion.angle, duration),
            **run_values(bag.run),
        }


def _lamp_settings(bag: RunBag) -> StrobeSettings:
    """Return the lamp that a run was lit by; of a rig whose driver tells of none, the usual one."""
    told = bag.run.settings.get('strobe', {}).get('instrument')
    return StrobeSettings.of(told) if isinstance(told, dict) else StrobeSettings()


def _flashes(
    rate: float, start: float, pivot: SampledMotion, amplitude: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the flashes of a step: their phase is that of a lamp lit since the beginning of the run."""
    if rate == 0.0:
        return np.empty(0), np.empty(0)
    period = 2.0 * np.pi / rate
    times: Any = period * np.arange(np.ceil(start / period), np.ceil((start + pivot.duration) / period))
    return times, mark_heights(pivot, times - start) / amplitude


def _ranges(times: NDArray[np.float64], angle: NDArray[np.float64], duration: float) -> list[list[float] | None]:
    """Return least and largest angle in each part of a run, rad; None where nothing was recorded."""
    if not times.size:
        return []
    part = np.minimum((times / max(duration, 1e-9) * _PARTS).astype(int), _PARTS - 1)
    there, begins = np.unique(part, return_index=True)
    low, high = np.minimum.reduceat(angle, begins), np.maximum.reduceat(angle, begins)
    found: list[list[float] | None] = [None] * _PARTS
    for place, *ends in zip(there.tolist(), low.tolist(), high.tolist(), strict=True):
        found[place] = [round(end, 4) for end in ends]
    return found
