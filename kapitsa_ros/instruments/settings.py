"""What the instruments and the person who reads them are like, and the sets that are shipped."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import yaml

from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.share import share_path

if TYPE_CHECKING:
    from collections.abc import Mapping

INSTRUMENT_SETS = ('1997', 'ideal')


def _quantity(default: float, low: float, high: float, description: str) -> Any:
    return field(default=default, metadata={'low': low, 'high': high, 'description': description})


class _Checked:
    """A dataclass of quantities that lie within the ranges of their metadata."""

    def __post_init__(self) -> None:
        for quantity in fields(self):  # type: ignore[arg-type]
            value = getattr(self, quantity.name)
            low, high = quantity.metadata['low'], quantity.metadata['high']
            if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
                raise SettingsError(f'{quantity.name} is {value!r}: give a finite number')
            if not low <= value <= high:
                raise SettingsError(f'{quantity.name} is {value}: it must lie in [{low}, {high}]')


@dataclass(frozen=True, kw_only=True)
class StrobeSettings(_Checked):
    """The strobe lamp, its dial, and the eye that watches the marks.

    Every field is also a parameter of the node; the metadata give its range (`low`, `high`) and its `description`.

    Raises
    ------
    SettingsError
        A value is no finite number or out of its range.

    """

    dial_resolution: float = _quantity(0.0, 0.0, 100.0, 'graduation of the dial, rad/s of flashes; 0 reads exactly')
    dial_error: float = _quantity(0.0, -0.5, 0.5, 'calibration: the dial shows (1 + dial_error) times the flash rate')
    dial_end: float = _quantity(2618.0, 10.0, 1e5, 'fastest flash rate of the lamp, rad/s (25,000 flashes a minute)')
    drift_limit: float = _quantity(0.0, 0.0, 100.0, 'a slower drift of the marks, rad/s of the shaft, looks like none')
    mark_width: float = _quantity(0.0, 0.0, 0.5, 'images closer than this share of the stroke look like one')
    contrast_limit: float = _quantity(0.2, 0.02, 0.5, 'an image lit by a smaller share of the flashes is not seen')
    guess_error: float = _quantity(0.0, 0.0, 0.3, 'relative standard deviation of the guess at which the search starts')
    look_time: float = _quantity(0.3, 0.0, 10.0, 'time to judge a standing picture, s')
    sweep_time: float = _quantity(1.0, 0.0, 60.0, 'time to turn the dial up by the speed of the shaft, s')


@dataclass(frozen=True, kw_only=True)
class StopwatchSettings(_Checked):
    """The stopwatch, and the eye and the thumb of the person who holds it.

    Every field is also a parameter of the node; the metadata give its range (`low`, `high`) and its `description`.

    Raises
    ------
    SettingsError
        A value is no finite number or out of its range.

    """

    reaction_time: float = _quantity(0.0, 0.0, 1.0, 'mean delay of a press, s')
    reaction_jitter: float = _quantity(0.0, 0.0, 1.0, 'standard deviation of a press, s')
    anticipation: float = _quantity(0.0, 0.0, 1.0, 'share of the delay gone once the rhythm is known: the last press')
    miscount_probability: float = _quantity(0.0, 0.0, 1.0, 'chance that the swings are counted one wrong')
    rate_error: float = _quantity(0.0, -0.9, 9.0, 'the display runs (1 + rate_error) times too fast')
    display_resolution: float = _quantity(0.0, 0.0, 1.0, 'last digit of the display, s; 0 shows all')
    persistence: float = _quantity(0.03, 0.0, 0.2, "the eye's blur, s (standard deviation): it follows the slow swing")


@dataclass(frozen=True, kw_only=True)
class Instruments:
    """A set of instruments."""

    strobe: StrobeSettings
    stopwatch: StopwatchSettings


def instruments_from(parameters: Mapping[str, Any]) -> Instruments:
    """Sort a flat mapping of parameters, as ROS holds them, into the instruments they belong to.

    Raises
    ------
    SettingsError
        A name belongs to no instrument, or a value is out of its range.

    """
    names = {kind: {quantity.name for quantity in fields(kind)} for kind in (StrobeSettings, StopwatchSettings)}
    surplus = sorted(set(parameters) - set().union(*names.values()))
    if surplus:
        raise SettingsError(f'no instrument has a parameter {", ".join(surplus)}: check the spelling')
    strobe = {name: value for name, value in parameters.items() if name in names[StrobeSettings]}
    stopwatch = {name: value for name, value in parameters.items() if name in names[StopwatchSettings]}
    return Instruments(strobe=StrobeSettings(**strobe), stopwatch=StopwatchSettings(**stopwatch))


def load_instruments(name: str, overrides: Mapping[str, float] | None = None) -> Instruments:
    """Read a set from config/instruments and replace the given parameters.

    Raises
    ------
    SettingsError
        There is no such set, or a parameter of it is unknown or out of its range.

    """
    if name not in INSTRUMENT_SETS:
        raise SettingsError(f'unknown instruments {name!r}: choose one of {", ".join(INSTRUMENT_SETS)}')
    document = yaml.safe_load(share_path('config', 'instruments', f'{name}.yaml').read_text(encoding='utf-8'))
    return instruments_from({**document['/**']['ros__parameters'], **(overrides or {})})
