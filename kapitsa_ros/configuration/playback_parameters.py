"""Which part of recorded runs is played."""

from __future__ import annotations

from dataclasses import dataclass

from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.schema import ParameterSet, quantity

LONGEST = 1e7
"""s; longer than any recording."""


@dataclass(frozen=True, kw_only=True)
class PlaybackParameters(ParameterSet):
    """The part of recorded runs that is played, in seconds of the runs laid end to end.

    Raises
    ------
    ConfigurationError
        A value is no finite number or out of its range, or the end is not after the start.

    """

    error = ConfigurationError

    start: float = quantity(0.0, 's', 0.0, LONGEST, description='where to begin')
    end: float = quantity(LONGEST, 's', 0.0, LONGEST, description='where to end, if the runs last that long')

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.end <= self.start:
            raise ConfigurationError(f'the end, {self.end:g} s, is not after the start, {self.start:g} s')
