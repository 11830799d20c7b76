"""Experiments that share what is the same in all of them are those that share nothing."""

import pytest

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.laboratory import apparatus as module
from kapitsa_ros.laboratory.apparatus import apparatus
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.operator.command import Command
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.units import RPM

PROTOCOL = Protocol(speeds=(2240 * RPM, 2640 * RPM), sweep=True, swings=2, repeats=2)


def readings(seed, preset='bearing'):
    experiment = SimulatedExperiment(
        plant=load_preset(preset), instruments=load_instruments('1997'), protocol=PROTOCOL, seed=seed
    )
    return [run.readings for run in experiment.runs()]


@pytest.fixture
def anew():
    """Nothing is kept of what was simulated before or is now."""
    module._apparatus.cache_clear()
    yield module._apparatus.cache_clear
    module._apparatus.cache_clear()


def test_what_was_simulated_before_changes_no_reading(anew):
    shared = [readings(1), readings(2), readings(1), readings(1, 'ideal'), readings(2)]
    alone = []
    for seed, preset in [(1, 'bearing'), (2, 'bearing'), (1, 'ideal')]:
        anew()
        alone.append(readings(seed, preset))
    assert shared == [alone[0], alone[1], alone[0], alone[2], alone[1]]
    assert alone[0] != alone[1]


def test_no_more_steps_are_kept_than_memory_was_promised_for(anew, monkeypatch):
    free = readings(1)
    anew()
    monkeypatch.setattr(module, 'MOST_KEPT', 50)
    assert [readings(1), readings(1)] == [free, free]
    start = apparatus(load_preset('bearing'), load_instruments('1997'))
    step, kept = start, 0
    while (following := step.after(Command(2240 * RPM, PROTOCOL.release))) is step.after(
        Command(2240 * RPM, PROTOCOL.release)
    ):
        step, kept = following, kept + 1
    assert 0 < kept <= 50
