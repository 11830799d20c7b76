"""`kapitsa reduce`: the critical speed from a table of readings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from kapitsa_ros.analysis.critical_speed import errors_in_variables
from kapitsa_ros.analysis.line_fit import inverse, ordinary, slope_ratio
from kapitsa_ros.cli.options import json_option, plant_options, print_json
from kapitsa_ros.cli.table_argument import table_argument
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.analysis.table import Readings
    from kapitsa_ros.physics.plant import Plant


@click.command()
@table_argument
@plant_options
@json_option
def reduce(readings: Readings, plant: Plant, *, as_json: bool) -> None:
    """Reduce TABLE (by default that of 1997) to the critical speed, in the three ways a line can be drawn.

    TABLE is CSV with the columns forcing_rpm, period_s and, where known, forcing_sigma_rpm and period_sigma_s (0 and
    0.05 s where not given). The plant's options say what theory predicts.
    """
    forward, backward, weighed = ordinary(readings), inverse(readings), errors_in_variables(readings)
    for warning in _warnings(weighed.discrepancy):
        click.echo(f'kapitsa: warning: {warning}', err=True)
    predicted = omega_crit_averaged(plant)
    low, high = (_rpm(end) for end in weighed.interval)
    ratio = slope_ratio(forward, plant)
    error = None if backward.omega_crit is None else 100.0 * (backward.omega_crit / predicted - 1.0)
    if as_json:
        print_json(
            {
                'ols_rpm': _rpm(forward.omega_crit),
                'inverse_rpm': _rpm(backward.omega_crit),
                'eiv_rpm': _rpm(weighed.omega_crit),
                'eiv_interval_rpm': [low, high],
                'eiv_discrepancy_percent': None if weighed.discrepancy is None else 100.0 * weighed.discrepancy,
                'slope_ratio': ratio,
                'predicted_rpm': predicted / RPM,
                'error_percent': error,
            }
        )
        return
    click.echo(f'ordinary least squares   {_text(_rpm(forward.omega_crit))}')
    click.echo(f'inverse least squares    {_text(_rpm(backward.omega_crit))}   (the fit of the report)')
    click.echo(f'errors in variables      {_text(_rpm(weighed.omega_crit))}   95 %: {_end(low)} to {_end(high)}')
    click.echo(f'predicted (eq. 8)        {_text(predicted / RPM)}')
    click.echo(f'slope over theory        {ratio:.4f}')
    if error is not None:
        click.echo(f'error of the inverse fit {error:+.1f} %')


def _warnings(discrepancy: float | None) -> list[str]:
    if discrepancy == 0.0:
        return []
    finding = 'the readings lie farther from any line than their errors allow'
    if discrepancy is None:
        return [f'{finding}: they contradict one another, and bound nothing']
    return [f'{finding}: {100.0 * discrepancy:.2g} % of each period is added to its error']


def _rpm(speed: float | None) -> float | None:
    return None if speed is None else speed / RPM


def _text(rpm: float | None) -> str:
    return 'none: the line meets the axis at no real speed' if rpm is None else f'{rpm:.2f} RPM'


def _end(rpm: float | None) -> str:
    return 'unbounded' if rpm is None else f'{rpm:.2f} RPM'
