"""What a result means, in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.analysis.experiment import ideal_rod
from kapitsa_ros.laboratory.preset_trials import shipped_outcomes
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.floquet import slow_frequency_exact
from kapitsa_ros.units import RPM, decimals_within, interval_text, is_within

if TYPE_CHECKING:
    from collections.abc import Mapping


def conclusion(values: Mapping[str, Any]) -> list[str]:
    """Return what the numbers of an experiment come to, a sentence each."""
    if values['omega_crit_rpm'] is None:
        return ['No swing was timed, so there is no critical speed: ask for a higher speed, or let go from closer.']
    low, high = values['omega_crit_interval_rpm']
    if low is None and high is None:
        return ['These readings bound the critical speed on neither side: time more swings, at several speeds.']
    form = f'{{:.{decimals_within((low, high))}f}}'
    interval = interval_text((low, high), form.format)
    said = [
        f'The critical speed is {form.format(values["omega_crit_rpm"])} RPM by these readings, {interval} RPM (95 %).'
    ]
    predicted = values['predicted_rpm']
    if is_within(predicted, (low, high)):
        said.append(f'The {predicted:.0f} RPM that theory predicts for the ideal rod agree with that.')
    else:
        side = 'below' if low is not None and predicted < low else 'above'
        said.append(
            f'Theory predicts {predicted:.0f} RPM for the ideal rod, {side} that: the rod, or the way it was timed, '
            'is not what theory takes it for.'
        )
        said += _of_the_periods(values)
    if values['inverse_rpm'] is not None:
        said.append(_of_the_fit(values['inverse_rpm']))
    return said


def _of_the_periods(values: Mapping[str, Any]) -> list[str]:
    """Return what was read beside what theory has, where the values tell both; what is said of the rod rests on it."""
    timed = [row for row in values.get('timings', ()) if row['kind'] == 'timed' and row['unused'] is None]
    timed = [row for row in timed if row['swings'] and row['display_s'] and row['speed_taken_rpm']]
    if not timed:
        return []
    rod = ideal_rod(Plant(**values['plant']))
    slow = [slow_frequency_exact(rod, row['speed_taken_rpm'] * RPM) for row in timed]
    theory = ', '.join('none' if each is None else f'{2.0 * math.pi / each:.2f}' for each in slow)
    read = ', '.join(f'{row["display_s"] / row["swings"]:.2f}' for row in timed)
    asked = 'Which causes do that, and which of them such readings cannot tell apart, says `kapitsa explain`'
    decides = '`kapitsa plan` names the timing that would decide'
    return [f'A swing took {read} s, where theory has {theory} s. {asked}; {decides}.']


def _of_the_fit(rpm: float) -> str:
    """Return what the line of 1997 is worth: what it makes of an ideal rod, with the instruments of 1997."""
    lines = [each.inverse_ols / RPM for each in shipped_outcomes()['ideal'] if each.inverse_ols is not None]
    low, high = np.quantile(lines, (0.16, 0.84)).tolist()
    verdict = 'its deviation from theory alone says nothing' if low <= rpm <= high else 'this one lies outside of that'
    return (
        f'The fit of 1997 gives {rpm:.0f} RPM. It extrapolates far beyond the readings and scatters with them: on an '
        f'ideal rod, with the instruments and speeds of 1997, it gives {low:.0f} to {high:.0f} RPM (16 to 84 % of '
        f'the {len(lines)} experiments that give a line), so {verdict}.'
    )
