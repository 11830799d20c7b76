"""A decaying swing with its sidebands, fitted to all samples: as near the statistical limit as can be."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate
from kapitsa_ros.analysis.slow_frequency.matrix_pencil import strongest_pole
from kapitsa_ros.analysis.slow_frequency.softening import refuse_wide, softening_error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.slow_frequency.estimate import SwingRecord

_PASSES = 3  # of the amplitude that softens the swing
_BEGINNING = 20  # slow periods: the matrix pencil knows the phase over them
_ITERATIONS = 50
_TOLERANCE = 1e-12
_PIECE = 16384  # samples taken at a time: memory does not grow with what a fit needs for each
_LINES = 8
_NO_SWING = 'no decaying swing can be fitted to the motion: take another estimator, or the readings'

# of the slow line, both sidebands and the third harmonic
_SLOW_PHASES = np.array([[1.0], [-1.0], [1.0], [3.0]])
_ENVELOPES = np.array([[1.0], [1.0], [1.0], [3.0]])


def sinusoid_fit_frequency(record: SwingRecord, softening: float = 0.0) -> SlowEstimate:
    """Fit θ = e^(−γt) (slow line at Ω, sidebands at ω ± Ω, third harmonic) by variable projection.

    The lines are those of the Floquet solution, so nothing of the record is filtered away; the matrix pencil on the
    drive-nulled record gives the first Ω and γ. With white noise least squares is maximum likelihood, and its error
    attains the Cramér-Rao bound.

    Parameters
    ----------
    record
        The free swing, a period of it or more.
    softening
        s of `softening`. With 0 the result is the frequency at the amplitude swung, otherwise that of a small swing.

    Raises
    ------
    AnalysisError
        Less than one period of an oscillation, too wide a one, or nothing that the lines can be fitted to.

    """
    beginning = record.beginning(_BEGINNING)
    times, means = beginning.drive_nulled()
    pole = strongest_pole(means, times[1] - times[0])
    span = beginning.angle.size * record.period
    if not 2.0 * math.pi / span < pole.imag < record.forcing / 2.0:
        raise AnalysisError('the record does not show a whole slow period: record for longer')
    start = np.array([pole.imag, -pole.real])
    amplitude_squared, shift = float(np.max(means**2)), 0.0
    sizes = _sizes(beginning.angle.size, record.angle.size)
    for _ in range(_PASSES if softening else 1):
        before, shift = shift, softening * amplitude_squared
        refuse_wide(shift)
        # The phase at the end must not jump with the shift: the fit would catch on to a wrong number of swings.
        last = (sizes[0] - 1) * record.period
        start[0] *= _slowing(last, start[1], before) / _slowing(last, start[1], shift)
        for size in sizes:
            fit = _fit(replace(record, angle=record.angle[:size]), start, shift)
            start = fit.parameters
        sizes = sizes[-1:]
        amplitude_squared = float(fit.weights[0] ** 2 + fit.weights[_LINES // 2] ** 2)
    left_out = softening_error(softening * amplitude_squared)
    return SlowEstimate(value=float(start[0]), sigma=math.hypot(fit.sigma, start[0] * left_out), decay=float(start[1]))


def _sizes(beginning: int, whole: int) -> list[int]:
    """Return how many samples are fitted in turn: what a part tells of the phase holds for twice as long."""
    sizes = [beginning]
    while sizes[-1] < whole:
        sizes.append(min(2 * sizes[-1], whole))
    return sizes


@dataclass(frozen=True, kw_only=True, eq=False)
class _Fit:
    parameters: NDArray[np.float64]
    """Ω in rad/s and γ in 1/s."""
    weights: NDArray[np.float64]
    """Of the cosines and the sines of each line, shape (8,)."""
    sigma: float
    """Standard uncertainty of Ω, rad/s."""


def _fit(record: SwingRecord, start: NDArray[np.float64], shift: float) -> _Fit:
    """Minimise the misfit by Gauss and Newton's method in the variable projection of Kaufman, BIT 15, 49 (1975).

    Raises
    ------
    AnalysisError
        It does not settle.

    """
    model = _Model(record=record, shift=shift)
    parameters, step, least = start, np.zeros(2), math.inf
    triangle = model.triangle(parameters, np.zeros(_LINES))
    if not np.isfinite(triangle).all():
        raise AnalysisError(_NO_SWING)
    weights = _solve(triangle, _LINES)
    for _ in range(_ITERATIONS):
        tried = model.triangle(parameters + step, weights)
        misfit = float(np.linalg.norm(tried[_LINES:, -1]))
        if misfit <= least * (1.0 + _TOLERANCE):
            parameters, least, triangle = parameters + step, misfit, tried
            solution = _solve(triangle, _LINES + 2)
            weights, step = solution[:_LINES], solution[_LINES:] / model.span
        else:
            step *= 0.5
        to_gain = float(np.linalg.norm(triangle[_LINES:-1, -1]))
        if to_gain**2 <= _TOLERANCE * least**2 or np.abs(step).max() <= _TOLERANCE * parameters[0]:
            noise = triangle[-1, -1] ** 2 / (record.angle.size - _LINES - 2)
            slopes = triangle[_LINES:-1, _LINES:-1]
            variance = noise * np.linalg.inv(slopes.T @ slopes)[0, 0]
            return _Fit(parameters=parameters + step, weights=weights, sigma=math.sqrt(variance) / model.span)
    raise AnalysisError(_NO_SWING)


def _solve(triangle: NDArray[np.float64], columns: int) -> NDArray[np.float64]:
    return np.asarray(np.linalg.lstsq(triangle[:columns, :columns], triangle[:columns, -1], rcond=None)[0])


@dataclass(frozen=True, kw_only=True, eq=False)
class _Model:
    """The lines of a swing that starts with a given softening."""

    record: SwingRecord
    shift: float
    """s·A² at the start."""

    @property
    def span(self) -> float:
        """Seconds of the record."""
        return self.record.angle.size * self.record.period

    def triangle(self, parameters: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return R of the QR decomposition of lines, their changes with the parameters, and the angle, shape (11, 11).

        Its last column has the misfit: below row 8 that of the lines alone. Not finite where the lines are not.
        """
        triangle = np.zeros((0, _LINES + 3))
        for begin in range(0, self.record.angle.size, _PIECE):
            angle = self.record.angle[begin : begin + _PIECE]
            times = np.arange(begin, begin + angle.size, dtype=np.float64) * self.record.period
            with np.errstate(over='ignore', invalid='ignore'):
                columns = self._columns(times, parameters, weights)
            if not np.isfinite(columns).all():
                return np.full((_LINES + 3, _LINES + 3), np.nan)
            piece = np.vstack((columns, angle)).T
            triangle = np.asarray(np.linalg.qr(np.vstack((triangle, piece)), mode='r'))
        return triangle

    def _columns(
        self, times: NDArray[np.float64], parameters: NDArray[np.float64], weights: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return time courses: of the lines, and of their changes with Ω and γ times the span, shape (10, N)."""
        slow, decay = parameters
        softened = times - self.shift * _softened(times, decay)
        swing = np.exp(-decay * times + 1j * slow * softened)
        drive = np.exp(1j * self.record.forcing * times)
        lines = np.stack((swing, drive * swing.conj(), drive * swing, swing**3))
        cosines, sines = lines.real, lines.imag
        of_cosine, of_sine = weights.reshape(2, -1, 1)
        turned = (_SLOW_PHASES * (of_sine * cosines - of_cosine * sines)).sum(axis=0)
        grown = (_ENVELOPES * (of_cosine * cosines + of_sine * sines)).sum(axis=0)
        by_slow = softened * turned
        by_decay = -times * grown - slow * self.shift * _softened_by_decay(times, decay) * turned
        return np.vstack((cosines, sines, by_slow / self.span, by_decay / self.span))


def _slowing(time: float, decay: float, shift: float) -> float:
    """Return the mean frequency from the start to this time, over that of a small swing."""
    return 1.0 - shift * float(_softened(np.array([time]), decay)[0]) / time


def _softened(times: NDArray[np.float64], decay: float) -> NDArray[np.float64]:
    """Return the integral of A²/A₀² from the start."""
    return np.asarray(-np.expm1(-2.0 * decay * times) / (2.0 * decay) if decay else times)


def _softened_by_decay(times: NDArray[np.float64], decay: float) -> NDArray[np.float64]:
    """Return its derivative by γ."""
    decayed = 2.0 * decay * times
    near = np.abs(decayed) < 1e-4  # where the difference below would have few digits
    divisor = np.where(near, 1.0, decayed)
    far = (np.exp(-divisor) * (divisor + 1.0) - 1.0) / divisor**2
    return np.asarray(2.0 * times**2 * np.where(near, decayed / 3.0 - 0.5, far))
