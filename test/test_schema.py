"""Quantities: what is accepted, what is refused, and what is derived from them."""

from dataclasses import dataclass, fields, replace
from fractions import Fraction

import numpy as np
import pytest

from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.physics.errors import ParameterError
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.schema import describe


@dataclass(frozen=True)
class Foreign:
    """A quantity of some library of units; its factors are to SI."""

    value: float
    units: str

    def to(self, unit: str) -> 'Foreign':
        factors = {('inch', 'm'): 0.0254, ('rpm', 'rad/s'): 2 * np.pi / 60, ('hertz', 'rad/s'): 1.0}
        if (self.units, unit) not in factors:
            raise TypeError('dimensions')
        return Foreign(self.value * factors[self.units, unit], unit)

    @property
    def magnitude(self) -> float:
        return self.value


@pytest.mark.parametrize(
    'kind', [Plant, StrobeSettings, StopwatchSettings, JigsawParameters, RigParameters], ids=lambda kind: kind.__name__
)
def test_ranges_are_finite(kind: type) -> None:
    """So what lies in one is: a plain number is looked at no further."""
    for item in describe(kind):
        assert np.isfinite([item.low, item.high]).all(), item.name
        for value in (np.inf, -np.inf, np.nan):
            assert not item.holds(value)


@pytest.mark.parametrize(
    ('given', 'held'),
    [
        (1, 1.0),
        (np.float64(0.25), 0.25),
        (np.float32(0.25), 0.25),
        (np.int64(2), 2.0),
        (np.array(0.25), 0.25),
        (Fraction(1, 4), 0.25),
        ('0.25', 0.25),
        ('9.75in', 0.24765),
        ('200 mm', 0.2),
        (Foreign(10.0, 'inch'), 0.254),
    ],
)
def test_what_is_a_length_becomes_a_plain_float(given, held):
    length = Plant(length=given).length
    assert type(length) is float
    assert length == pytest.approx(held, rel=1e-15)


def test_a_text_of_the_report_is_the_report_exactly():
    assert Plant(length='9.75in', amplitude='0.5in') == Plant()


@pytest.mark.parametrize(
    'given',
    [True, np.True_, None, [0.25], np.array([0.25]), 'long', '0.2 kg', '3 rpm', 1j, Foreign(1.0, 'kg'), float('nan'),
     float('inf'), '1e999 m', 10**400, -0.2, 0, 1e9],
)  # fmt: skip
def test_what_is_no_length_of_a_rod_is_refused_by_name(given):
    with pytest.raises(ParameterError, match=r'^length is .*(above 0, at most 1000)'):
        Plant(length=given)


def test_an_error_tells_value_range_and_unit():
    with pytest.raises(SettingsError, match=r'^reaction_time is 2 min \(120 s\): it must lie in \[0, 1\] s$'):
        StopwatchSettings(reaction_time='2 min')


def test_a_shaft_at_one_hertz_makes_one_turn_a_second():
    """Pint would say 1 rad/s."""
    assert StrobeSettings(dial_end='10 Hz').dial_end == pytest.approx(20 * np.pi)
    assert StrobeSettings(dial_end=Foreign(10.0, 'hertz')).dial_end == pytest.approx(20 * np.pi)
    assert JigsawParameters(max_speed=Foreign(600.0, 'rpm')).max_speed == pytest.approx(20 * np.pi)


def test_quantities_of_pint_are_recognised():
    registry = pytest.importorskip('pint').UnitRegistry()
    assert Plant(length=registry.Quantity(9.75, 'inch')).length == pytest.approx(0.24765)
    assert Plant(gravity=registry.Quantity(1, 'standard_gravity')).gravity == pytest.approx(9.80665)
    assert JigsawParameters(max_speed=registry.Quantity(50, 'Hz')).max_speed == pytest.approx(100 * np.pi)
    with pytest.raises(ParameterError, match=r'length is .*second'):
        Plant(length=registry.Quantity(3, 'second'))


@pytest.mark.parametrize('given', [3, np.int64(3), np.uint8(3), '3'])
def test_whole_numbers(given):
    seed = RigParameters(seed=given).seed
    assert (type(seed), seed) == (int, 3)


@pytest.mark.parametrize('given', [True, 3.0, '3.5', -1, 2**63, None])
def test_what_is_no_seed_is_refused(given):
    with pytest.raises(KapitsaError, match=r'^seed is '):
        RigParameters(seed=given)


def test_an_unknown_name_is_refused_with_those_there_are():
    with pytest.raises(ParameterError, match='no parameter lenght: give some of length, amplitude'):
        Plant.of({'lenght': 1.0})
    with pytest.raises(ParameterError, match='no parameter lenght'):
        Plant().replaced({'lenght': 1.0})


@pytest.mark.parametrize('kind', [Plant, JigsawParameters, StrobeSettings, StopwatchSettings, RigParameters])
def test_every_field_is_described_and_its_default_within_its_range(kind):
    assert [item.name for item in describe(kind)] == [field.name for field in fields(kind)]
    for item in describe(kind):
        assert item.description
        assert item.check(item.default, KapitsaError) == getattr(kind(), item.name)


def test_the_ends_of_a_range_belong_to_it_unless_it_says_above():
    assert Plant(restitution=1).restitution == 1.0
    assert JigsawParameters(spin_up=0.1).spin_up == 0.1
    with pytest.raises(ParameterError, match=r'gravity is 0\.0: it must be above 0'):
        Plant(gravity=0.0)


LOSSES = {'damping': 0.1, 'coulomb': 0.1, 'clearance': 1e-4}


@pytest.mark.parametrize('name', LOSSES)
def test_one_loss_is_enough_to_be_no_longer_conservative(name):
    plant = Plant(length=0.2, **{name: LOSSES[name]})
    assert not plant.conservative
    assert plant.linearly_damped == (name == 'damping')
    assert plant.without_losses() == Plant(length=0.2)


def test_what_takes_no_energy_by_itself_is_no_loss():
    plant = Plant(restitution=0.5, wear=0.1, inertia_factor=0.7)
    assert plant.conservative
    assert replace(plant, **LOSSES).without_losses() == plant
