"""What the stopwatch, and the eye and the thumb of the person who holds it, are like."""

from __future__ import annotations

from dataclasses import dataclass

from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.schema import ParameterSet, quantity


@dataclass(frozen=True, kw_only=True)
class StopwatchSettings(ParameterSet):
    """The stopwatch, and the eye and the thumb of the person who holds it.

    Raises
    ------
    SettingsError
        A value is no finite number or out of its range.

    """

    error = SettingsError

    reaction_time: float = quantity(0.0, 's', 0.0, 1.0, description='mean delay of a press')
    reaction_jitter: float = quantity(0.0, 's', 0.0, 1.0, description='standard deviation of a press')
    anticipation: float = quantity(
        0.0, '', 0.0, 1.0, description='share of the delay gone once the rhythm is known: the last press'
    )
    miscount_probability: float = quantity(
        0.0, '', 0.0, 1.0, description='chance that the swings are counted one wrong'
    )
    rate_error: float = quantity(0.0, '', -0.9, 9.0, description='the display runs (1 + rate_error) times too fast')
    display_resolution: float = quantity(0.0, 's', 0.0, 1.0, description='last digit of the display; 0 shows all')
    persistence: float = quantity(
        0.03, 's', 0.0, 0.2, description="the eye's blur (standard deviation): it follows the slow swing"
    )
