"""The uncertainty budget against GTC, against Monte Carlo, and against the interval it stands beside."""

import math

import pytest
from GTC import ureal

from kapitsa_ros.analysis.assumptions import Assumptions
from kapitsa_ros.analysis.critical_speed import Ruler, evidence_of, uncertainty_budget
from kapitsa_ros.analysis.critical_speed.direct_fit import CurveFit
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.timing_row import TimingRow
from kapitsa_ros.units import RPM, digits_of

G = 9.80665
ONLY_READINGS = Assumptions(
    play_probability=0.0, heavy_damping_probability=0.0, coulomb_probability=0.0, light_damping=1e-3
)


def timed(*periods, sigma=0.02, speed_sigma=0.5):
    """Return timings at 2240, 2440, ... RPM."""
    return evidence_of(
        [
            TimingRow(
                kind='timed',
                speed=(2240.0 + 200.0 * index) * RPM,
                speed_sigma=speed_sigma,
                period=period,
                period_sigma=sigma,
            )
            for index, period in enumerate(periods)
        ]
    )


def test_one_timing_against_gtc():
    """Of one timing the fit is the root of Ω² = k²λ²ω²/2 − kg, which GTC propagates itself."""
    found = uncertainty_budget(timed(0.62), Ruler(amplitude=12.7e-3, sigma=1.25e-4), G, ONLY_READINGS)
    period, speed, amplitude = ureal(0.62, 0.02), ureal(2240.0 * RPM, 0.5), ureal(12.7e-3, 1.25e-4)
    slow = 2.0 * math.pi / period
    a = (amplitude * speed) ** 2 / 2.0
    k = (G + (G * G + 4.0 * a * slow * slow) ** 0.5) / (2.0 * a)
    critical = (2.0 * G / k) ** 0.5 / amplitude
    assert found.value == pytest.approx(critical.x, rel=0.01)  # averaged theory against Mathieu's
    assert found.u == pytest.approx(critical.u, rel=0.03)
    by_name = {row.name: row.contribution for row in found.rows}
    for name, source in (('period T', period), ('speed ω', speed), ('amplitude λ', amplitude)):
        (ours,) = (value for key, value in by_name.items() if key.startswith(name))
        assert ours == pytest.approx(abs(critical.sensitivity(source)) * source.u, rel=0.03), name


def test_degrees_of_freedom_are_those_of_gtc():
    """Welch and Satterthwaite, with scatter of type A beyond the stated errors."""
    found = uncertainty_budget(
        timed(0.62, 0.46, 0.46, 0.36, sigma=0.003), Ruler(amplitude=12.7e-3, sigma=1.25e-4), G, ONLY_READINGS
    )
    assert {row.kind for row in found.rows} == {'A', 'B'}
    terms = [ureal(0.0, row.contribution, df=row.freedom) for row in found.rows]
    together = sum(terms[1:], terms[0])
    assert found.freedom == pytest.approx(together.df, rel=1e-6)
    assert found.u == pytest.approx(together.u, rel=1e-3)
    assert found.k > 2.0


@pytest.mark.parametrize('assumptions', [ONLY_READINGS, Assumptions()])
def test_budget_is_that_of_monte_carlo_or_says_that_it_is_not(assumptions):
    evidence, ruler = timed(0.62, 0.53, 0.46), Ruler(amplitude=12.7e-3, sigma=1.25e-4)
    found = uncertainty_budget(evidence, ruler, G, assumptions)
    assert found.is_linear == (abs(found.u / found.monte_carlo_u - 1.0) <= 0.05)
    # the interval that is printed is another way to the same: weights of rods instead of draws
    fit = CurveFit(evidence, ruler, G, assumptions)
    low, high = (fit.posterior().quantile(share) for share in (0.025, 0.975))
    assert found.monte_carlo_interval == pytest.approx((low, high), rel=0.01)


def test_what_is_known_better_contributes_less():
    ruler = Ruler(amplitude=12.7e-3, sigma=1.25e-4)
    coarse, fine = (uncertainty_budget(timed(0.62, 0.53, 0.46, sigma=sigma), ruler) for sigma in (0.05, 0.01))
    assert fine.u < coarse.u
    assert any(
        row.name == 'rate of the stopwatch'
        for row in uncertainty_budget(timed(0.62, 0.53), ruler, G, Assumptions(stopwatch_rate_u=0.02)).rows
    )


@pytest.mark.parametrize(('u', 'digits'), [(24.5, 0), (2.45, 1), (0.245, 2), (0.00999, 4), (0.0, 0), (math.inf, 0)])
def test_digits_follow_from_the_uncertainty(u, digits):
    assert digits_of(u) == digits


def test_commands_print_the_budget(kapitsa):
    budget = kapitsa('reduce', '--budget', '--json').json['budget']
    of_inputs = sum(row['contribution_rpm'] ** 2 for row in budget['inputs'])
    assert budget['u_rpm'] ** 2 == pytest.approx(of_inputs, rel=0.1)  # but for correlations
    text = ' '.join(kapitsa('reduce', '--budget').out.split())
    assert f'u_c = {budget["u_rpm"]:.0f} RPM' in text
    refused = kapitsa('analyse', '--motion', '--budget', 'bags/run_01_2240rpm')
    assert refused.status == 2
    assert 'a budget is of what was read' in refused.err


def test_runs_that_contradict_one_another_have_no_budget():
    with pytest.raises(AnalysisError, match='contradict one another'):
        uncertainty_budget(timed(0.9, 0.3, 0.9, sigma=0.001), Ruler(amplitude=12.7e-3))
