"""Figure 5: the spectrum of the angle, its lines named."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.run_summary import summarise_run
from kapitsa_ros.reporting.figures.canvas import BLUE, INK, blank, write_powers
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from kapitsa_ros.physics.plant import Plant

RATE = 1000.0
DURATION = 60.0
_BLACKMAN_HARRIS = (0.35875, 0.48829, 0.14128, 0.01168)  # F. J. Harris, Proc. IEEE 66, 51 (1978): 4 terms, −92 dB


def power_spectrum(plant: Plant, speed: float, release: float = 0.12) -> Figure:
    """Draw the amplitude spectrum of θ and name its lines: Ω and ω ± Ω, their thirds, none at ω (speed in rad/s)."""
    run = Release(plant=plant, speed=speed, angle=release)
    rpm, amplitude = amplitudes(run.sampled(DURATION, RATE).angle[:-1], RATE)
    figure = blank(f'Figure 5: spectrum of θ at {speed / RPM:.0f} RPM, released at {release:g} rad')
    (axes,) = figure.axes
    shown = rpm <= 1.25 * speed / RPM
    axes.semilogy(rpm[shown], amplitude[shown], color=BLUE, linewidth=0.7)
    write_powers(axes)
    slow, fast = (summarise_run(run, DURATION).frequency or 0.0) / RPM, speed / RPM
    lines = (('Ω', slow, 'left'), ('ω − Ω', fast - slow, 'right'), ('ω + Ω', fast + slow, 'left'))
    for name, at, side in lines:
        height = amplitude[np.argmin(np.abs(rpm - at))]
        axes.annotate(f'{name}\n{at:.1f}', (at, height), (at, 2.0 * height), ha=side, fontsize=8, color=INK)
    for name, at in (('3Ω', 3.0 * slow), ('ω − 3Ω', fast - 3.0 * slow), ('ω + 3Ω', fast + 3.0 * slow)):
        height = amplitude[np.argmin(np.abs(rpm - at))]
        axes.annotate(name, (at, height), (at, 2.0 * height), ha='center', fontsize=7, color=INK)
    axes.axvline(fast, color=INK, linewidth=0.6, linestyle=':')
    axes.text(fast, 0.5, 'ω: no line', ha='center', fontsize=8, color=INK, backgroundcolor='white')
    axes.set(xlabel='frequency (RPM)', ylabel='amplitude (rad)', xlim=(0.0, 1.25 * fast), ylim=(1e-8, 2.0))
    return figure


def amplitudes(angle: NDArray[np.float64], rate: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return frequencies (RPM) and the amplitude a line there would have; the window's leakage lies below 1e-4."""
    window = blackman_harris(angle.size)
    spectrum = np.abs(np.fft.rfft(angle * window)) * 2.0 / window.sum()
    return np.asarray(60.0 * np.fft.rfftfreq(angle.size, 1.0 / rate), dtype=float), np.asarray(spectrum, dtype=float)


def blackman_harris(size: int) -> NDArray[np.float64]:
    """Return the periodic window, shape (size,): that of scipy.signal, which takes longer to import than to use."""
    phase = np.linspace(-np.pi, np.pi, size + 1)[:-1]
    return sum((weight * np.cos(n * phase) for n, weight in enumerate(_BLACKMAN_HARRIS)), np.zeros(size))
