"""The suspects: what each would make of the periods, as a function of one parameter."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from kapitsa_ros.instruments.dial_search import standing_ratios
from kapitsa_ros.instruments.perfect_timing import timed_period
from kapitsa_ros.physics.errors import PhysicsError
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.physics.plant import Plant

THREE_EIGHTHS_INCH = 0.009525
"""m; half of a ¾-in stroke."""

Periods: TypeAlias = 'Callable[[Plant, NDArray[np.float64], float], NDArray[np.float64]]'
"""Periods that would be read at speeds (rad/s) for a value of the parameter; nan where nothing could be timed."""


@dataclass(frozen=True, kw_only=True)
class Cause:
    """One suspect."""

    name: str
    parameter: str
    """What is tuned; empty where nothing is."""
    periods: Periods
    values: Callable[[Plant, Readings], NDArray[np.float64]]
    """Values to try, ascending: the only ones where `discrete`, else a grid over all that could be."""
    discrete: bool = False
    tuned: int = 1
    """Number of parameters."""
    least: float | None = None
    """Value below which there is none by its nature."""
    nominal: str | float | None = None
    """Its value where nothing is wrong: a number, or that of the plant's parameter of this name; None without one."""
    is_release: bool = False
    """Whether the parameter is the angle of the release, which a further run could choose."""

    @property
    def unit(self) -> str:
        """SI unit of the parameter; empty of a ratio."""
        return self.parameter.rpartition(', ')[2] if ', ' in self.parameter else ''

    def nominal_of(self, plant: Plant) -> float | None:
        """Return the value of the parameter where nothing is wrong with the plant."""
        return getattr(plant, self.nominal) if isinstance(self.nominal, str) else self.nominal


def small_swing(plant: Plant, speed: float) -> float:
    """Return the period of a small swing by exact linear theory, s; nan where there is none."""
    try:
        slow = slow_frequency_exact(plant, speed)
    except PhysicsError:
        return math.nan
    return 2.0 * math.pi / slow if slow else math.nan


def _wide_swing(plant: Plant, speed: float, release: float) -> float:
    try:
        return 2.0 * math.pi / slow_frequency_nonlinear(plant, speed, release)
    except PhysicsError:
        return math.nan


def _theory(plant: Plant, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([small_swing(plant, float(speed)) for speed in speeds])


def _of_plant(name: str) -> Periods:
    return lambda plant, speeds, value: _theory(replace(plant, **{name: value}), speeds)


def _of_run(name: str) -> Periods:
    return lambda plant, speeds, value: np.array(
        [timed_period(replace(plant, **{name: value}), float(speed)) for speed in speeds]
    )


def _over(low: float, high: float, count: int) -> Callable[[Plant, Readings], NDArray[np.float64]]:
    return lambda _plant, _readings: np.linspace(low, high, count)


def _strokes(plant: Plant, _readings: Readings) -> NDArray[np.float64]:
    return plant.amplitude * np.geomspace(0.3, 3.0, 60)


def _dampings(_plant: Plant, readings: Readings) -> NDArray[np.float64]:
    # three swings are seen in the report: c may not take more than 19/20 of the swing over three periods
    return np.linspace(0.0, 2.0 * math.log(20.0) / (3.0 * readings.period.max()), 20)


def _plays(plant: Plant, _readings: Readings) -> NDArray[np.float64]:
    return np.linspace(0.0, 0.1 * plant.amplitude, 9)


def _miscounts(_plant: Plant, _readings: Readings) -> NDArray[np.float64]:
    swings = np.arange(1, 11)
    return np.unique(np.concatenate(((swings + 1) / swings, swings / (swings + 1))))


def _aliases(_plant: Plant, _readings: Readings) -> NDArray[np.float64]:
    # a flash rate of r·ω, halved, reads r/2 of the speed: five images are the most that are bright enough
    return np.array([float(ratio / 2) for ratio in standing_ratios(0.5, 5.0, 5) if ratio != 2])


def _nothing(_plant: Plant, _readings: Readings) -> NDArray[np.float64]:
    return np.zeros(1)


CAUSES = (
    Cause(
        name='inertia_factor',
        parameter='κ',
        periods=_of_plant('inertia_factor'),
        values=_over(0.2, 3.0, 60),
        nominal='inertia_factor',
    ),
    Cause(
        name='large_swing',
        parameter='release angle, rad',
        periods=lambda plant, speeds, value: np.array([_wide_swing(plant, float(speed), value) for speed in speeds]),
        values=_over(0.01, 1.5, 40),
        least=0.0,
        nominal=0.0,
        is_release=True,
    ),
    Cause(name='amplitude', parameter='λ, m', periods=_of_plant('amplitude'), values=_strokes, nominal='amplitude'),
    Cause(
        name='amplitude_three_eighths_inch',
        parameter='λ, m',
        periods=_of_plant('amplitude'),
        values=lambda _plant, _readings: np.array([THREE_EIGHTHS_INCH]),
        nominal='amplitude',
        discrete=True,
        tuned=0,
    ),
    Cause(
        name='stopwatch_scale',
        parameter='displayed over true time',
        periods=lambda plant, speeds, value: value * _theory(plant, speeds),
        values=_over(0.3, 3.0, 60),
        nominal=1.0,
    ),
    Cause(
        name='stopwatch_offset',
        parameter='added to each period, s',
        periods=lambda plant, speeds, value: _theory(plant, speeds) + value,
        values=_over(-1.0, 1.0, 60),
        nominal=0.0,
    ),
    Cause(
        name='miscount',
        parameter='swings made over swings counted',
        periods=lambda plant, speeds, value: value * _theory(plant, speeds),
        values=_miscounts,
        nominal=1.0,
        discrete=True,
    ),
    Cause(
        name='strobe_alias',
        parameter='read over true speed',
        periods=lambda plant, speeds, value: _theory(plant, speeds / value),
        values=_aliases,
        nominal=1.0,
        discrete=True,
    ),
    Cause(
        name='damping', parameter='c, 1/s', periods=_of_plant('damping'), values=_dampings, least=0.0, nominal='damping'
    ),
    Cause(
        name='coulomb',
        parameter='f, rad/s²',
        periods=_of_run('coulomb'),
        values=_over(0.0, 4.0, 17),
        least=0.0,
        nominal='coulomb',
    ),
    Cause(
        name='clearance', parameter='D, m', periods=_of_run('clearance'), values=_plays, least=0.0, nominal='clearance'
    ),
    Cause(
        name='instruments',
        parameter='',
        periods=lambda plant, speeds, _value: _theory(plant, speeds),
        values=_nothing,
        discrete=True,
        tuned=0,
    ),
)
