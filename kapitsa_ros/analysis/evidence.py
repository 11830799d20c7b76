"""What a blind analyst has in hand: readings with their errors, and falls."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.table import Readings

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from kapitsa_ros.analysis.timing_row import TimingRow


@dataclass(frozen=True, kw_only=True)
class Bound:
    """A release that fell or stayed up, and so bounds the critical speed."""

    speed: float
    """ω, rad/s."""
    sigma: float
    """Its standard uncertainty, rad/s."""
    release: float
    """θ at which the pendulum was let go, rad."""


@dataclass(frozen=True, kw_only=True)
class Stop:
    """A swing that friction stopped before it was timed: it tells how much friction there is."""

    speed: float
    """ω, rad/s."""
    release: float
    """|θ| at which the pendulum was let go, rad."""
    swings: int
    """Full swings seen before the end."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Evidence:
    """What the timings of one plant say, SI units."""

    timed: Readings
    """A row for each speed that was read and timed at: timings that share a reading of the dial are one row."""
    release: NDArray[np.float64]
    """|θ| at which the pendulum was let go, rad, shape (N,)."""
    swings: NDArray[np.float64]
    """Full swings of a timing, shape (N,)."""
    fell: tuple[Bound, ...] = ()
    """Releases after which the pendulum fell over."""
    stood: tuple[Bound, ...] = ()
    """Releases after which it stayed up, though its swings were not timed to the end."""
    stops: tuple[Stop, ...] = ()
    """The swings that stopped, all of which the release is known."""


def evidence_of(rows: Sequence[TimingRow]) -> Evidence:
    """Gather what timings say; those that are marked as unused say nothing.

    Timings of a run that share a reading of the dial err with it together. They become one row: the mean of their
    periods, weighted by their errors, which is the fit of one period to all their displays. Of falls that share one
    counts that from the smallest angle, which says most, and of swings that stopped one.

    Raises
    ------
    TableError
        The values are none that runs can have.

    """
    bounds: dict[str, dict[object, Bound]] = {'fell': {}, 'stopped': {}}
    for number, row in enumerate(rows):
        if row.unused is not None or row.speed is None:
            continue
        if row.kind != 'timed':
            bound = Bound(speed=row.speed, sigma=row.speed_sigma, release=abs(row.release or 0.0))
            key = _reading_of(number, row)
            known = bounds[row.kind].setdefault(key, bound)
            bounds[row.kind][key] = min(known, bound, key=lambda each: each.release)
    columns = np.array([_together(timings) for timings in by_reading(rows)], dtype=np.float64).reshape(-1, 6).T
    return Evidence(
        timed=Readings(*columns[:4]),
        release=columns[4],
        swings=columns[5],
        fell=tuple(bounds['fell'].values()),
        stood=tuple(bounds['stopped'].values()),
        stops=tuple(
            Stop(speed=row.speed, release=abs(row.release), swings=row.swings)
            for row in rows
            if row.kind == 'stopped' and row.unused is None and row.speed and row.release and row.swings is not None
        ),
    )


def by_reading(rows: Sequence[TimingRow]) -> list[list[TimingRow]]:
    """Return the timings that count, those together that share a reading of the dial."""
    shared: dict[object, list[TimingRow]] = {}
    for number, row in enumerate(rows):
        if row.kind == 'timed' and row.unused is None and row.speed is not None:
            shared.setdefault(_reading_of(number, row), []).append(row)
    return list(shared.values())


def _reading_of(number: int, row: TimingRow) -> object:
    return number if row.run is None else (row.run, row.speed_asked, row.speed_reading, row.speed)


def _together(rows: Sequence[TimingRow]) -> tuple[float, ...]:
    """Return speed, period, their errors, release and swings of timings at one reading of the dial."""
    sigma = np.array([row.period_sigma for row in rows])
    weight = sigma**-2 if (sigma > 0.0).all() else np.ones_like(sigma)
    weight /= weight.sum()
    period = np.array([row.period for row in rows], dtype=np.float64)
    release = np.array([row.release or 0.0 for row in rows])
    swings = np.array([row.swings_taken or row.swings or 1.0 for row in rows])
    return (
        rows[0].speed or math.nan,
        float(weight @ period),
        rows[0].speed_sigma,
        float(np.sqrt(weight**2 @ sigma**2)),
        float(np.sqrt(weight @ release**2)),  # a swing is slower by the square of its width
        float(weight @ swings),
    )
