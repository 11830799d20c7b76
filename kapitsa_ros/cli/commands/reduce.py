"""`kapitsa reduce`: the critical speed from a table of readings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from kapitsa_ros._api.reduce import reduce as call
from kapitsa_ros.cli.options import json_option, plant_options, print_json
from kapitsa_ros.cli.table_argument import table_argument
from kapitsa_ros.units import RPM, in_rpm, interval_text

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
    found = call(readings, plant)
    for warning in found.warnings:
        click.echo(f'kapitsa: warning: {warning}', err=True)
    low, high = (in_rpm(end) for end in found.eiv_interval)
    interval = interval_text((low, high), '{:.2f} RPM'.format)
    if as_json:
        print_json(
            {
                'ols_rpm': in_rpm(found.ols),
                'inverse_rpm': in_rpm(found.inverse_ols),
                'eiv_rpm': in_rpm(found.eiv),
                'eiv_interval_rpm': [low, high],
                'eiv_discrepancy_percent': None if found.eiv_discrepancy is None else 100.0 * found.eiv_discrepancy,
                'slope_ratio': found.slope_ratio,
                'predicted_rpm': found.predicted / RPM,
                'error_percent': found.error_percent,
            }
        )
        return
    click.echo(f'ordinary least squares   {_text(in_rpm(found.ols))}')
    click.echo(f'inverse least squares    {_text(in_rpm(found.inverse_ols))}   (the fit of the report)')
    click.echo(f'errors in variables      {_text(in_rpm(found.eiv))}   95 %: {interval}')
    click.echo(f'predicted (eq. 8)        {_text(found.predicted / RPM)}')
    click.echo(f'slope over theory        {found.slope_ratio:.4f}')
    if found.error_percent is not None:
        click.echo(f'error of the inverse fit {found.error_percent:+.1f} %')


def _text(rpm: float | None) -> str:
    return 'none: the line meets the axis at no real speed' if rpm is None else f'{rpm:.2f} RPM'
