"""What the instruments and the person who reads them are like, and the sets that are shipped."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import yaml

from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.resources import resource_path

if TYPE_CHECKING:
    from collections.abc import Mapping

INSTRUMENT_SETS = ('1997', 'ideal')


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
    document = yaml.safe_load(resource_path('config', 'instruments', f'{name}.yaml').read_text(encoding='utf-8'))
    return instruments_from({**document['/**']['ros__parameters'], **(overrides or {})})
