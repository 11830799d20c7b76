"""The critical speed as a function of all that goes into it: the measurement function of the GUM (4.1)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.theory.play import play_amplitude_ratio

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.analysis.critical_speed.direct_fit import CurveFit

    Array = NDArray[np.float64]

_STEPS = 8  # of Gauss and Newton; each makes the error some ten times smaller
_SLIGHT = 1e-5  # relative step of a difference quotient


@dataclass(frozen=True, kw_only=True, eq=False)
class Inputs:
    """M sets of what goes into the critical speed; arrays of shape (M,), or (M, N) with a column a timing."""

    period: Array
    """As the stopwatch showed it, s, shape (M, N)."""
    forcing: Array
    """As the dial showed it, rad/s, shape (M, N)."""
    amplitude: Array
    """λ as the ruler showed it, m."""
    play: Array
    """D, m."""
    damping: Array
    """c, 1/s."""
    coulomb: Array
    """f, rad/s²."""
    stopwatch_rate: Array
    """Relative error of the stopwatch."""
    dial: Array
    """Relative error of the dial."""
    of_periods: Array
    """Relative error of each period beyond the stated ones, shape (M, N)."""


class MeasurementFunction:
    """The critical speed of the rod that fits M sets of inputs best, M at once.

    It is the estimator of `CurveFit`, the weights held at what they are at its best fit; play, damping and friction,
    which it fits or leaves out, are inputs here.
    """

    def __init__(self, fit: CurveFit) -> None:
        self._likelihood = fit.likelihood
        self._start = fit.best
        threshold, amplitude, damping = (np.array([value]) for value in fit.best)
        _, doubt = fit.likelihood.model.periods(threshold, amplitude, damping, np.zeros(1))
        self._sigma = fit.likelihood.sigma(threshold, amplitude, doubt)[0]
        self._amplitude_sigma = fit.amplitude_sigma

    def __call__(self, inputs: Inputs) -> Array:
        """Return the exact critical speed, rad/s, shape (M,)."""
        seen = play_amplitude_ratio(inputs.play / inputs.amplitude) * inputs.amplitude
        period = inputs.period * (1.0 - inputs.of_periods) / (1.0 + inputs.stopwatch_rate[:, None])
        forcing = inputs.forcing / (1.0 + inputs.dial[:, None])
        threshold, amplitude = np.full(seen.shape, self._start[0]), seen.copy()

        def residuals(threshold: Array, amplitude: Array) -> Array:
            model, _ = self._likelihood.model.periods(threshold, amplitude, inputs.damping, inputs.coulomb, forcing)
            bounds = np.sqrt(-2.0 * self._likelihood.bounds(threshold, amplitude, inputs.damping))
            ruled = (amplitude - seen) / self._amplitude_sigma
            return np.column_stack(((model - period) / self._sigma, ruled, bounds))

        top = 0.9999 * forcing.min(axis=1)
        for _ in range(_STEPS):
            here = residuals(threshold, amplitude)
            step = np.stack((_SLIGHT * threshold, _SLIGHT * amplitude))
            of_threshold = (residuals(threshold + step[0], amplitude) - here) / step[0][:, None]
            of_amplitude = (residuals(threshold, amplitude + step[1]) - here) / step[1][:, None]
            move = _solved(of_threshold, of_amplitude, here)
            threshold = np.minimum(threshold - np.clip(move[0], -0.1 * threshold, 0.1 * threshold), top)
            amplitude = amplitude - np.clip(move[1], -0.1 * amplitude, 0.1 * amplitude)
        return self._likelihood.exact_threshold(threshold, amplitude, inputs.damping)


def _solved(one: Array, other: Array, residuals: Array) -> tuple[Array, Array]:
    """Solve the normal equations of two parameters for M sets of residuals, shape (M, rows)."""
    a, b, c = (one * one).sum(axis=1), (one * other).sum(axis=1), (other * other).sum(axis=1)
    first, second = (one * residuals).sum(axis=1), (other * residuals).sum(axis=1)
    determinant = a * c - b * b
    return (c * first - b * second) / determinant, (a * second - b * first) / determinant
