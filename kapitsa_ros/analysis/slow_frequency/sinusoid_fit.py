"""A decaying swing with its sidebands, fitted to all samples: as near the statistical limit as can be."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import least_squares

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.slow_frequency.estimate import SlowEstimate
from kapitsa_ros.analysis.slow_frequency.matrix_pencil import strongest_pole
from kapitsa_ros.analysis.slow_frequency.softening import refuse_wide, softening_error

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.slow_frequency.estimate import SwingRecord

_PASSES = 3  # of the amplitude that softens the swing


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
        Less than one period of an oscillation, or too wide a one.

    """
    times, means = record.drive_nulled()
    pole = strongest_pole(means, times[1] - times[0])
    span = record.angle.size * record.period
    if not 2.0 * math.pi / span < pole.imag < record.forcing / 2.0:
        raise AnalysisError('the record does not show a whole slow period: record for longer')
    start = np.array([pole.imag, -pole.real])
    amplitude_squared, slowed = float(np.max(means**2)), 1.0
    for _ in range(_PASSES if softening else 1):
        shift = softening * amplitude_squared
        refuse_wide(shift)
        # The phase at the end must not jump with the shift: the fit would catch on to a wrong number of swings.
        slowing = 1.0 - shift * float(_softened(record.times[-1:], start[1])[0]) / record.times[-1]
        start[0] *= slowed / slowing
        slowed = slowing

        def misfit(parameters: NDArray[np.float64], shift: float = shift) -> NDArray[np.float64]:
            lines = _lines(record, parameters, shift)
            return np.asarray(record.angle - lines @ np.linalg.lstsq(lines, record.angle, rcond=None)[0])

        found = least_squares(misfit, start, x_scale=[1.0 / span, 1.0 / span], method='lm', xtol=1e-12, ftol=1e-12)
        start = found.x
        lines = _lines(record, start, shift)
        weights = np.linalg.lstsq(lines, record.angle, rcond=None)[0]
        amplitude_squared = float(weights[0] ** 2 + weights[1] ** 2)
    noise = found.fun @ found.fun / (record.angle.size - lines.shape[1] - 2)
    variance = noise * np.linalg.inv(found.jac.T @ found.jac)[0, 0]
    left_out = softening_error(softening * amplitude_squared)
    return SlowEstimate(
        value=float(start[0]), sigma=math.hypot(math.sqrt(variance), start[0] * left_out), decay=float(start[1])
    )


def _lines(record: SwingRecord, parameters: NDArray[np.float64], shift: float) -> NDArray[np.float64]:
    """Return the lines' time courses, shape (N, 8); `shift` is s·A² at the start."""
    slow, decay = parameters
    times = record.times
    phase = slow * (times - shift * _softened(times, decay))
    drive = record.forcing * times
    envelope = np.exp(-decay * times)
    phases = np.stack((phase, drive - phase, drive + phase, 3.0 * phase))
    envelopes = np.stack((envelope, envelope, envelope, envelope**3))
    columns = np.stack((envelopes * np.cos(phases), envelopes * np.sin(phases)), axis=1)
    return columns.reshape(-1, times.size).T


def _softened(times: NDArray[np.float64], decay: float) -> NDArray[np.float64]:
    """Return the integral of A²/A₀² from the start."""
    return np.asarray(-np.expm1(-2.0 * decay * times) / (2.0 * decay) if decay else times)
