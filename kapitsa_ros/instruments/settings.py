"""What the instruments and the person who reads them are like."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_settings import StrobeSettings

if TYPE_CHECKING:
    from collections.abc import Mapping


@dataclass(frozen=True, kw_only=True)
class Instruments:
    """A set of instruments."""

    strobe: StrobeSettings
    stopwatch: StopwatchSettings
    name: str = field(default='', compare=False)
    """Of the set, for people."""

    @classmethod
    def of(cls, parameters: Mapping[str, Any], name: str = '') -> Instruments:
        """Sort a flat mapping of parameters, as ROS holds them, into the instruments they belong to.

        Raises
        ------
        SettingsError
            A name belongs to no instrument, or a value is out of its range.

        """
        return cls(strobe=StrobeSettings(), stopwatch=StopwatchSettings(), name=name).replaced(parameters)

    def replaced(self, parameters: Mapping[str, Any]) -> Instruments:
        """Return the set with some parameters replaced.

        Raises
        ------
        SettingsError
            A name belongs to no instrument, or a value is out of its range.

        """
        kinds = {'strobe': StrobeSettings, 'stopwatch': StopwatchSettings}
        owner = {item.name: instrument for instrument, kind in kinds.items() for item in fields(kind)}
        if surplus := sorted(set(parameters) - set(owner)):
            raise SettingsError(f'no instrument has a parameter {", ".join(surplus)}: give some of {", ".join(owner)}')
        parts: dict[str, Any] = {
            instrument: getattr(self, instrument).replaced(
                {name: value for name, value in parameters.items() if owner[name] == instrument}
            )
            for instrument in kinds
        }
        return Instruments(**parts, name=self.name)
