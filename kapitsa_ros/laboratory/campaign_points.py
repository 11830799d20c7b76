"""The points of a campaign: the experiments that its factors make of one."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.play import omega_crit_with_play
from kapitsa_ros.schema import describe
from kapitsa_ros.versions import versions

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kapitsa_ros.configuration.campaign_ranges import Ranges, Value

_Result = TypeVar('_Result')
_OF_PLANT = frozenset(item.name for item in describe(Plant))


@dataclass(frozen=True, kw_only=True)
class CampaignPoint:
    """One point of a campaign."""

    factors: Mapping[str, Value]
    """Their values."""
    experiment: SimulatedExperiment
    truth: float
    """Exact threshold of the plant, rad/s."""


def campaign_points(ranges: Ranges, experiment: SimulatedExperiment) -> tuple[CampaignPoint, ...]:
    """Return the points, each an experiment in which the factors have their values and the rest stays as it is.

    A preset, a set of instruments and a protocol come first; what is varied beside them replaces their values.

    Raises
    ------
    ConfigurationError
        A point is no experiment that can be; the message names it.

    """
    varied = [ranges.values(number) for number in range(len(ranges.points))]
    made = [_naming(values, _experiment_at, values, experiment) for values in varied]  # all, before any work is done
    truths: dict[Plant, float] = {}
    points = []
    for values, each in zip(varied, made, strict=True):
        if each.plant not in truths:
            truths[each.plant] = _naming(values, omega_crit_with_play, each.plant)
        points.append(CampaignPoint(factors=values, experiment=each, truth=truths[each.plant]))
    return tuple(points)


def _naming(values: Mapping[str, Value], function: Callable[..., _Result], *given: Any) -> _Result:
    """Call a function; what it refuses is told with the values of the point."""
    try:
        return function(*given)
    except KapitsaError as error:
        where = ', '.join(
            f'{name} = {value if isinstance(value, str) else f"{value:g}"}' for name, value in values.items()
        )
        raise ConfigurationError(f'{where}: {error}' if where else str(error)) from error


def _experiment_at(values: Mapping[str, Value], experiment: SimulatedExperiment) -> SimulatedExperiment:
    numbers = {name: value for name, value in values.items() if not isinstance(value, str)}
    of_plant = {name: value for name, value in numbers.items() if name in _OF_PLANT}
    of_instruments = {name: value for name, value in numbers.items() if name not in _OF_PLANT}
    plant = load_preset(str(values['preset'])) if 'preset' in values else experiment.plant
    instruments = load_instruments(str(values['instruments'])) if 'instruments' in values else experiment.instruments
    return SimulatedExperiment(
        plant=plant.replaced(of_plant),
        instruments=instruments.replaced(of_instruments),
        protocol=load_protocol(str(values['protocol'])) if 'protocol' in values else experiment.protocol,
        seed=experiment.seed,
    )


def identity_of(points: tuple[CampaignPoint, ...], experiments: int, assumptions: Mapping[str, float]) -> str:
    """Return a text that is the same for campaigns that give the same outcomes."""
    each = [(dict(point.factors), asdict(point.experiment)) for point in points]
    return repr([each, experiments, 'seeds go on from point to point', dict(assumptions), versions()])
