"""`kapitsa reduce`: the critical speed from a table of readings."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from kapitsa_ros._api.reduce import reduce as call
from kapitsa_ros.analysis.critical_speed.ruler import RULER_SIGMA
from kapitsa_ros.analysis.results import budget_values
from kapitsa_ros.cli.options import LENGTH, assumption_option, budget_option, json_option, plant_options, print_json
from kapitsa_ros.cli.show_result import show_budget
from kapitsa_ros.cli.table_argument import table_argument
from kapitsa_ros.reporting.allowances import allowances
from kapitsa_ros.units import RPM, in_rpm, interval_text

if TYPE_CHECKING:
    from kapitsa_ros.analysis.critical_speed.assumptions import Assumptions
    from kapitsa_ros.configuration.tables import TimingTable
    from kapitsa_ros.physics.plant import Plant


@click.command()
@table_argument
@plant_options
@click.option(
    '--amplitude-sigma',
    type=LENGTH,
    default=RULER_SIGMA,
    show_default='0.125mm',
    help='standard error of the amplitude, for the exact curve',
)
@assumption_option
@budget_option
@json_option
def reduce(
    table: TimingTable,
    plant: Plant,
    *,
    amplitude_sigma: float,
    assumptions: Assumptions,
    with_budget: bool,
    as_json: bool,
) -> None:
    """Reduce TABLE (by default that of 1997) to the critical speed, by the exact curve and by three lines.

    TABLE is CSV with the columns forcing_rpm, period_s and, where known, forcing_sigma_rpm and period_sigma_s (0 and
    0.05 s where not given), release_rad and swings, kind (timed, fell or stopped) and run, as `kapitsa analyse --table`
    writes it. The plant's options say what theory predicts, and what a ruler says of the amplitude.
    """
    found = call(table, plant, amplitude_sigma=amplitude_sigma, assumptions=assumptions)
    for warning in found.warnings:
        click.echo(f'kapitsa: warning: {warning}', err=True)
    low, high = (in_rpm(end) for end in found.eiv_interval)
    interval = interval_text((low, high), '{:.2f} RPM'.format)
    curve = tuple(in_rpm(end) for end in found.omega_crit_interval)
    budget = budget_values(found.budget()) if with_budget else None
    if as_json:
        print_json(
            {
                'omega_crit_rpm': in_rpm(found.omega_crit),
                'omega_crit_interval_rpm': list(curve),
                'play_probability': found.play_probability,
                'heavy_damping_probability': found.heavy_damping_probability,
                'effective_rods': found.effective_rods,
                'assumptions': asdict(found.assumptions),
                'discrepancy_percent': None if found.discrepancy is None else 100.0 * found.discrepancy,
                'ols_rpm': in_rpm(found.ols),
                'inverse_rpm': in_rpm(found.inverse_ols),
                'eiv_rpm': in_rpm(found.eiv),
                'eiv_interval_rpm': [low, high],
                'eiv_discrepancy_percent': None if found.eiv_discrepancy is None else 100.0 * found.eiv_discrepancy,
                'slope_ratio': found.slope_ratio,
                'predicted_rpm': found.predicted / RPM,
                'error_percent': found.error_percent,
            }
            | ({} if budget is None else {'budget': budget})
        )
        return
    of_curve = interval_text((curve[0], curve[1]), '{:.2f} RPM'.format)
    click.echo(f'exact curve              {_text(in_rpm(found.omega_crit))}   95 %: {of_curve}')
    click.echo(f'ordinary least squares   {_text(in_rpm(found.ols))}')
    click.echo(f'inverse least squares    {_text(in_rpm(found.inverse_ols))}   (the fit of the report)')
    click.echo(f'errors in variables      {_text(in_rpm(found.eiv))}   95 %: {interval}')
    click.echo(f'predicted (eq. 8)        {_text(found.predicted / RPM)}')
    if found.slope_ratio is not None:
        click.echo(f'slope over theory        {found.slope_ratio:.4f}')
    if found.error_percent is not None:
        click.echo(f'error of the inverse fit {found.error_percent:+.1f} %')
    assumed = asdict(found.assumptions)
    seen = found.play_probability, found.heavy_damping_probability, found.effective_rods
    for sentence in allowances(assumed, *seen):
        click.echo(sentence)
    if budget is not None:
        show_budget(budget)


def _text(rpm: float | None) -> str:
    return 'none' if rpm is None else f'{rpm:.2f} RPM'
