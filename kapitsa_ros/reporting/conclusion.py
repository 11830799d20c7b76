"""What a result means, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.units import interval_text, is_within

if TYPE_CHECKING:
    from collections.abc import Mapping


def conclusion(values: Mapping[str, Any]) -> list[str]:
    """Return what the numbers of an experiment come to, a sentence each."""
    if values['omega_crit_rpm'] is None:
        return ['No swing was timed, so there is no critical speed: ask for a higher speed, or let go from closer.']
    low, high = values['omega_crit_interval_rpm']
    if low is None and high is None:
        return ['These readings bound the critical speed on neither side: time more swings, at several speeds.']
    interval = interval_text((low, high), '{:.0f}'.format)
    said = [f'The critical speed is {values["omega_crit_rpm"]:.0f} RPM by these readings, {interval} RPM (95 %).']
    predicted = values['predicted_rpm']
    if is_within(predicted, (low, high)):
        said.append(f'The {predicted:.0f} RPM that theory predicts for the ideal rod agree with that.')
    else:
        side = 'below' if low is not None and predicted < low else 'above'
        said.append(
            f'Theory predicts {predicted:.0f} RPM for the ideal rod, {side} that: the rod, or the way it was timed, '
            'is not what theory takes it for.'
        )
    if values['inverse_rpm'] is not None:
        said.append(
            f'The fit of 1997 gives {values["inverse_rpm"]:.0f} RPM; it extrapolates far beyond the readings and '
            'scatters with them, so that its error alone says little (`kapitsa report` tells how much).'
        )
    return said
