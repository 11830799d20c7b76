import numpy as np
import pytest

pytest.importorskip('matplotlib')

from kapitsa_ros.physics import theory
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.release import Release
from kapitsa_ros.reporting import figures
from kapitsa_ros.reporting.figures.spectrum import amplitudes, blackman_harris
from kapitsa_ros.units import RPM

PLANT = Plant()
SPEED = 2500 * RPM


def test_spectrum_has_lines_at_the_slow_frequency_and_its_sidebands_and_none_between():
    """Their heights are those of the Floquet solution."""
    motion = Release(plant=PLANT, speed=SPEED, angle=1e-3).sampled(60.0)
    rpm, height = amplitudes(motion.angle[:-1], 1000.0)

    def line(at):
        return height[np.abs(rpm - at) < 3].max()

    slow = theory.slow_frequency_exact(PLANT, SPEED) / RPM
    lower, upper = theory.sidebands(PLANT, SPEED)
    # The window is flat to 1 % between bins.
    assert line(2500 - slow) / line(slow) == pytest.approx(lower, rel=0.2)
    assert line(2500 + slow) / line(slow) == pytest.approx(upper, rel=0.2)
    assert line(2500) < 1e-6 * line(slow)


@pytest.mark.parametrize('size', [2, 8, 2001])
def test_the_window_is_that_of_scipy(size):
    from scipy.signal import get_window

    np.testing.assert_array_equal(blackman_harris(size), get_window('blackmanharris', size))


def test_time_history_is_the_motion():
    (axes,) = figures.time_history(PLANT, SPEED).axes
    (curve,) = axes.lines
    motion = Release(plant=PLANT, speed=SPEED, angle=0.12).sampled(5.0)
    np.testing.assert_array_equal(curve.get_xydata(), np.column_stack((motion.time, motion.angle)))
    assert axes.get_xlim() == (0, 5)


def test_spectrum_names_its_lines():
    (axes,) = figures.power_spectrum(PLANT, SPEED).axes
    assert [text.get_text().split('\n')[0] for text in axes.texts] == [
        'Ω',
        'ω − Ω',
        'ω + Ω',
        '3Ω',
        'ω − 3Ω',
        'ω + 3Ω',
        'ω: no line',
    ]


def test_sweep_has_simulation_theories_and_measured_points():
    (axes,) = figures.frequency_sweep(PLANT, [(2240 * RPM, 60 * RPM)]).axes
    exact, averaged, simulated, measured = (line.get_xydata() for line in axes.lines)
    standing = simulated[np.isfinite(simulated[:, 1])]
    assert standing[0, 0] == 1400
    assert np.interp(2500, *exact.T) == pytest.approx(114.816, abs=0.01)
    assert np.interp(2500, *averaged.T) == pytest.approx(114.344, abs=0.01)
    assert np.interp(2500, *standing.T) == pytest.approx(114.174, abs=0.001)
    np.testing.assert_allclose(measured, [[2240, 60]])


def test_stability_shows_the_operating_points_above_both_lower_edges():
    chart, bench = figures.stability_boundaries(PLANT, [2240 * RPM, 2780 * RPM]).axes
    runs = next(line for line in chart.lines if line.get_label() == 'the runs').get_xydata()
    assert np.all(runs[:, 1] > theory.characteristic_a0(runs[0, 0]))
    np.testing.assert_allclose(bench.lines[-1].get_xydata(), [[2240, 0.0127 / 0.24765], [2780, 0.0127 / 0.24765]])
