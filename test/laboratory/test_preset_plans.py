"""The plans that are shipped are those that planning gives."""

from dataclasses import replace

import pytest

from kapitsa_ros.laboratory.preset_plans import plan_with_1997, shipped_plans
from kapitsa_ros.laboratory.preset_trials import trial_plants


@pytest.mark.parametrize('name', trial_plants())
def test_a_shipped_plan_is_what_planning_gives(name: str) -> None:
    plant = trial_plants()[name]
    found, shipped = plan_with_1997(plant), shipped_plans()[plant]
    assert found is not None
    assert shipped is not None
    assert shipped.expected_percent == pytest.approx(found.expected_percent, rel=1e-5), 'make trials'
    assert shipped.seconds == pytest.approx(found.seconds, rel=1e-6), 'make trials'
    assert shipped.speeds == pytest.approx(found.speeds, rel=1e-9), 'make trials'
    assert replace(shipped, speeds=(), expected_percent=0, seconds=0) == replace(
        found, speeds=(), expected_percent=0, seconds=0
    )
