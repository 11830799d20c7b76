"""What the strobe lamp, its dial and the eye that watches the marks are like."""

from __future__ import annotations

from dataclasses import dataclass

from kapitsa_ros.schema import Checked, quantity


@dataclass(frozen=True, kw_only=True)
class StrobeSettings(Checked):
    """The strobe lamp, its dial, and the eye that watches the marks.

    Every field is also a parameter of the node; the metadata give its range (`low`, `high`) and its `description`.

    Raises
    ------
    SettingsError
        A value is no finite number or out of its range.

    """

    dial_resolution: float = quantity(0.0, 0.0, 100.0, 'graduation of the dial, rad/s of flashes; 0 reads exactly')
    dial_error: float = quantity(0.0, -0.5, 0.5, 'calibration: the dial shows (1 + dial_error) times the flash rate')
    dial_end: float = quantity(2618.0, 10.0, 1e5, 'fastest flash rate of the lamp, rad/s (25,000 flashes a minute)')
    drift_limit: float = quantity(0.0, 0.0, 100.0, 'a slower drift of the marks, rad/s of the shaft, looks like none')
    mark_width: float = quantity(0.0, 0.0, 0.5, 'images closer than this share of the stroke look like one')
    contrast_limit: float = quantity(0.2, 0.02, 0.5, 'an image lit by a smaller share of the flashes is not seen')
    guess_error: float = quantity(0.0, 0.0, 0.3, 'relative standard deviation of the guess at which the search starts')
    look_time: float = quantity(0.3, 0.0, 10.0, 'time to judge a standing picture, s')
    sweep_time: float = quantity(1.0, 0.0, 60.0, 'time to turn the dial up by the speed of the shaft, s')
