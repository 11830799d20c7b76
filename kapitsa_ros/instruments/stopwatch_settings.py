"""What the stopwatch, and the eye and the thumb of the person who holds it, are like."""

from __future__ import annotations

from dataclasses import dataclass

from kapitsa_ros.schema import Checked, quantity


@dataclass(frozen=True, kw_only=True)
class StopwatchSettings(Checked):
    """The stopwatch, and the eye and the thumb of the person who holds it.

    Every field is also a parameter of the node; the metadata give its range (`low`, `high`) and its `description`.

    Raises
    ------
    SettingsError
        A value is no finite number or out of its range.

    """

    reaction_time: float = quantity(0.0, 0.0, 1.0, 'mean delay of a press, s')
    reaction_jitter: float = quantity(0.0, 0.0, 1.0, 'standard deviation of a press, s')
    anticipation: float = quantity(0.0, 0.0, 1.0, 'share of the delay gone once the rhythm is known: the last press')
    miscount_probability: float = quantity(0.0, 0.0, 1.0, 'chance that the swings are counted one wrong')
    rate_error: float = quantity(0.0, -0.9, 9.0, 'the display runs (1 + rate_error) times too fast')
    display_resolution: float = quantity(0.0, 0.0, 1.0, 'last digit of the display, s; 0 shows all')
    persistence: float = quantity(0.03, 0.0, 0.2, "the eye's blur, s (standard deviation): it follows the slow swing")
