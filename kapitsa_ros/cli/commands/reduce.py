"""`kapitsa reduce`: the critical speed from a table of readings."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from kapitsa_ros._api.reduce import reduce as call
from kapitsa_ros.analysis.results import budget_values
from kapitsa_ros.analysis.ruler import RULER_SIGMA
from kapitsa_ros.analysis.timing_row import untold_releases
from kapitsa_ros.cli.options import LENGTH, assumption_option, budget_option, json_option, plant_options, print_json
from kapitsa_ros.cli.progress import shown_stages
from kapitsa_ros.cli.show_result import show_budget
from kapitsa_ros.cli.table_argument import table_argument
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.reporting.allowances import allowances
from kapitsa_ros.reporting.conclusion import conclusion
from kapitsa_ros.reporting.reduction_text import reduction_sentences, reduction_table
from kapitsa_ros.units import RPM, in_rpm

if TYPE_CHECKING:
    from kapitsa_ros.analysis.assumptions import Assumptions
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
    help='standard uncertainty of the amplitude, for the exact curve',
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
    with shown_stages('fitting the readings') as on_progress:
        found = call(table, plant, amplitude_sigma=amplitude_sigma, assumptions=assumptions)
        on_progress('working out the budget')
        budget = budget_values(found.budget()) if with_budget else None
    for warning in found.warnings:
        click.echo(f'kapitsa: warning: {warning}', err=True)
    values = {
        'omega_crit_rpm': in_rpm(found.omega_crit),
        'omega_crit_interval_rpm': [in_rpm(end) for end in found.omega_crit_interval],
        'play_probability': found.play_probability,
        'heavy_damping_probability': found.heavy_damping_probability,
        'effective_rods': found.effective_rods,
        'assumptions': asdict(found.assumptions),
        'discrepancy_percent': None if found.discrepancy is None else 100.0 * found.discrepancy,
        'ols_rpm': in_rpm(found.ols),
        'inverse_rpm': in_rpm(found.inverse_ols),
        'eiv_rpm': in_rpm(found.eiv),
        'eiv_interval_rpm': [in_rpm(end) for end in found.eiv_interval],
        'eiv_discrepancy_percent': None if found.eiv_discrepancy is None else 100.0 * found.eiv_discrepancy,
        'slope_ratio': found.slope_ratio,
        'predicted_rpm': found.predicted / RPM,
        'error_percent': found.error_percent,
    }
    if as_json:
        print_json(values | ({} if budget is None else {'budget': budget}))
        return
    show_table(reduction_table(values))
    said = reduction_sentences(values, untold_releases=untold_releases(table.rows))
    seen = found.play_probability, found.heavy_damping_probability, found.effective_rods
    say([*said, *allowances(asdict(found.assumptions), *seen)])
    if budget is not None:
        show_budget(budget)
    say(conclusion(values))
