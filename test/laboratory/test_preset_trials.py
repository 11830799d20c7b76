"""The outcomes that are shipped are those that these plants, instruments and fits give."""

from itertools import islice

import pytest

from kapitsa_ros.laboratory.campaign import perform
from kapitsa_ros.laboratory.preset_trials import EXPERIMENTS, shipped_outcomes, trial_experiment, trial_plants
from kapitsa_ros.units import RPM

WRITTEN = 2e-6 * RPM  # the last digit in the file, and what other processors make of it


def assert_shipped(count: int) -> None:
    shipped = shipped_outcomes()
    assert list(shipped) == list(trial_plants())
    for name, plant in trial_plants().items():
        assert [each.seed for each in shipped[name]] == list(range(1, EXPERIMENTS + 1))
        for each in islice(shipped[name], count):
            found = perform(trial_experiment(plant), each.seed)
            assert found.omega_crit == pytest.approx(each.omega_crit, abs=WRITTEN), 'make trials'
            assert found.interval == pytest.approx(each.interval, abs=WRITTEN), 'make trials'
            assert (found.ols, found.inverse_ols) == pytest.approx((each.ols, each.inverse_ols), abs=WRITTEN)


def test_the_first_experiment_on_each_plant_gives_what_is_shipped() -> None:
    assert_shipped(1)


@pytest.mark.slow
def test_all_experiments_give_what_is_shipped() -> None:
    assert_shipped(EXPERIMENTS)
