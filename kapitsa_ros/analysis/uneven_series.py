"""Samples at uneven times, with gaps and repetitions, made a series at equal times; what was done is said."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from numpy.typing import NDArray

_GAP = 1.5
"""Periods from one sample to the next beyond which one is missing."""
_UNEVEN = 1e-6
"""Of a period: less is rounding of stamps."""
_FEWEST = 8
_SWAPS = 4
"""Changes between parts of a record that one late sample, or a late lot of them, makes when all are put in order."""
_RATIO = 0.1
"""By how much the ratio of velocities to the changes of the positions may differ from 1."""
_WIDEST = 1e6
"""rad: what turns more often is no angle of a pendulum."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EvenSeries:
    """A series at equal times."""

    time: NDArray[np.float64]
    """Seconds from its first sample, shape (N,)."""
    value: NDArray[np.float64]
    """Shape (N,)."""
    gaps: int
    """Places where samples were missing, in all that was recorded."""
    defects: tuple[str, ...]
    """What was found and how it was survived, a sentence each."""


def even_series(
    time: NDArray[np.float64], value: NDArray[np.float64], rate: NDArray[np.float64] | None, widest_gap: float
) -> EvenSeries:
    """Return samples at equal times: the longest stretch in which no gap is too wide to be interpolated.

    Parameters
    ----------
    time
        Seconds, in any order, shape (N,).
    value
        Shape (N,).
    rate
        Its derivative where that was recorded, shape (N,); taken where it is one.
    widest_gap
        Seconds that are interpolated at most.

    Raises
    ------
    AnalysisError
        Too few samples are left.

    """
    kept, defects = _usable(time, value)
    time, value = time[kept], value[kept]
    periods = np.diff(time)
    period = float(np.median(periods))
    missing = periods > _GAP * period
    if missing.any():
        seconds = float((periods[missing] - period).sum())
        defects.append(f'{int(missing.sum())} gaps, in which {seconds:.4g} s are missing')
    begin, end = _longest(periods > max(widest_gap, _GAP * period))
    if end - begin < time.size:
        defects.append(
            f'analysed is the longest stretch without a gap too wide to be interpolated: '
            f'{time[end - 1] - time[begin]:.4g} s of {time[-1] - time[0]:.4g} s'
        )
    if end - begin < _FEWEST:
        raise AnalysisError('it is all gaps: no stretch of it is long enough')
    span = slice(begin, end)
    uneven = np.abs(periods[begin : end - 1] - period)
    if uneven.max() <= _UNEVEN * period:
        return EvenSeries(
            time=time[span] - time[begin], value=value[span], gaps=int(missing.sum()), defects=tuple(defects)
        )
    defects.append(
        f'times are uneven (by {1e3 * float(np.std(periods[begin : end - 1][~missing[begin : end - 1]])):.3g} ms): '
        f'interpolated every {1e3 * period:.4g} ms'
    )
    at = np.arange(time[begin], time[end - 1], period)
    slopes = None if rate is None else rate[kept][span]
    if slopes is not None and (why := _no_rate(time[span], value[span], slopes)):
        defects.append(f'{why}: positions alone are taken')
        slopes = None
    if slopes is None:
        curve = CubicSpline(time[span], value[span])
    else:
        curve = CubicHermiteSpline(time[span], value[span], slopes)
    return EvenSeries(time=at - at[0], value=curve(at), gaps=int(missing.sum()), defects=tuple(defects))


def _usable(time: NDArray[np.float64], value: NDArray[np.float64]) -> tuple[NDArray[np.int64], list[str]]:
    """Return the places of the samples that count, in the order of their times, and why others do not."""
    defects = []
    finite = np.isfinite(time) & np.isfinite(value) & (np.abs(value) < _WIDEST)
    if lost := int((~finite).sum()):
        defects.append(f'{lost} samples are not finite, and left out')
    there = np.flatnonzero(finite)
    begin, end, parts = _longest_part(time[there], value[there])
    if parts > 1:
        defects.append(
            f'the clock of the samples was set back {counted(parts - 1, "time")}: '
            f'analysed is the longest part, {end - begin} of {there.size} samples'
        )
        there = there[begin:end]
    if (disorder := int((np.diff(time[there]) < 0).sum())) > 0:
        defects.append(f'{disorder} samples are out of order, and put in that of their times')
    order = there[np.argsort(time[there], kind='stable')]
    first = np.concatenate(([True], np.diff(time[order]) > 0)) if order.size else np.zeros(0, bool)
    if repeated := int((~first).sum()):
        defects.append(f'{repeated} samples have the time of another, and are left out')
    kept = order[first]
    if kept.size < _FEWEST:
        why = f' ({"; ".join(defects)})' if defects else ''
        raise AnalysisError(f'{kept.size} samples are no motion: record for longer{why}')
    return kept, defects


def _longest_part(time: NDArray[np.float64], value: NDArray[np.float64]) -> tuple[int, int, int]:
    """Return begin and end of the longest part of a record in which the clock was not set back, and how many there are.

    A clock that is set back, or a simulation that begins anew, has times that were there before, with other values; to
    put all in one order would mix two motions. Samples that are late, or stand twice, do not.
    """
    late = np.flatnonzero(np.diff(time) < 0) + 1
    if not late.size:
        return 0, time.size, 1
    order = np.lexsort((value, time))
    ordered, values = time[order], value[order]
    fresh = np.concatenate(([True], (np.diff(ordered) > 0) | (np.diff(values) != 0)))
    part = np.searchsorted(late, order[fresh], 'right')
    if int((np.diff(part) != 0).sum()) <= _SWAPS * (late.size + 1):
        return 0, time.size, 1
    begins, highest, looked = [0], time[0], 0
    for at in late.tolist():
        highest = max(highest, float(time[looked:at].max()))
        looked = at
        if (time[at : at + _FEWEST] < highest).all():
            begins.append(at)
            highest = float(time[at])
    edges = np.array([*begins, time.size])
    longest = int(np.argmax(np.diff(edges)))
    return int(edges[longest]), int(edges[longest + 1]), len(begins)


def _no_rate(time: NDArray[np.float64], value: NDArray[np.float64], rate: NDArray[np.float64]) -> str | None:
    """Return why values recorded beside positions are not their velocities; None where they are.

    Drivers that know no velocity write 0 or nan, others degrees; what sums up to the positions is one.
    """
    if not np.isfinite(rate).all():
        return 'some velocities are not finite'
    travelled = np.concatenate(([0.0], np.cumsum((rate[1:] + rate[:-1]) / 2.0 * np.diff(time))))
    columns = np.column_stack((travelled, time - time[0], np.ones_like(time)))
    ratio = float(np.linalg.lstsq(columns, value, rcond=None)[0][0])
    if abs(ratio - 1.0) > _RATIO:
        return f'the velocities are not those of the positions (these change by {ratio:.3g} times as much)'
    return None


def _longest(breaks: NDArray[np.bool_]) -> tuple[int, int]:
    """Return begin and end of the longest stretch of samples with no break between them."""
    edges = np.concatenate(([0], np.flatnonzero(breaks) + 1, [breaks.size + 1]))
    longest = int(np.argmax(np.diff(edges)))
    return int(edges[longest]), int(edges[longest + 1])
