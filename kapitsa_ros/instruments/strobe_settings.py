"""What the strobe lamp, its dial and the eye that watches the marks are like."""

from __future__ import annotations

from dataclasses import dataclass

from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.schema import ParameterSet, quantity


@dataclass(frozen=True, kw_only=True)
class StrobeSettings(ParameterSet):
    """The strobe lamp, its dial, and the eye that watches the marks.

    Raises
    ------
    SettingsError
        A value is no finite number or out of its range.

    """

    error = SettingsError

    dial_resolution: float = quantity(
        0.0, 'rad/s', 0.0, 100.0, description='graduation of the dial, of flashes; 0 reads exactly'
    )
    dial_error: float = quantity(
        0.0, '', -0.5, 0.5, description='calibration: the dial shows (1 + dial_error) times the flash rate'
    )
    dial_end: float = quantity(
        2618.0, 'rad/s', 10.0, 1e5, description='fastest flash rate of the lamp (25,000 flashes a minute)'
    )
    drift_limit: float = quantity(
        0.0, 'rad/s', 0.0, 100.0, description='a slower drift of the marks, of the shaft, looks like none'
    )
    mark_width: float = quantity(
        0.0, '', 0.0, 0.5, description='images closer than this share of the stroke look like one'
    )
    contrast_limit: float = quantity(
        0.2, '', 0.02, 0.5, description='an image lit by a smaller share of the flashes is not seen'
    )
    guess_error: float = quantity(
        0.0, '', 0.0, 0.3, description='relative standard deviation of the guess at which the search starts'
    )
    look_time: float = quantity(0.3, 's', 0.0, 10.0, description='time to judge a standing picture')
    sweep_time: float = quantity(1.0, 's', 0.0, 60.0, description='time to turn the dial up by the speed of the shaft')
