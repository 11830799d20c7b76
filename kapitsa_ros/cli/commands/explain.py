"""`kapitsa explain`: which causes fit a table of readings."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from kapitsa_ros._api.explain import explain as call
from kapitsa_ros.cli.options import json_option, plant_options, print_json
from kapitsa_ros.cli.progress import shown_stages
from kapitsa_ros.cli.table_argument import table_argument
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.reporting.explanation import error_sentences, explanation_conclusion, explanation_table, unit_of

if TYPE_CHECKING:
    from kapitsa_ros.analysis.explain import Explanation
    from kapitsa_ros.configuration.tables import TimingTable
    from kapitsa_ros.physics.plant import Plant


@click.command()
@table_argument
@plant_options
@json_option
def explain(table: TimingTable, plant: Plant, *, as_json: bool) -> None:
    """Rank the causes that could have made the periods of TABLE (by default that of 1997) what they are.

    The plant's options say what it should have been.
    """
    with shown_stages('trying causes'):
        verdict = call(table, plant)
    for warning in verdict.warnings:
        click.echo(f'kapitsa: warning: {warning}', err=True)
    if as_json:
        explanations = [_values(explanation) for explanation in verdict.explanations]
        print_json(
            {
                'explanations': explanations,
                'indistinguishable': verdict.indistinguishable,
                'period_sigma_s': verdict.period_sigma,
                'with_other_errors': [asdict(each) for each in verdict.with_other_errors],
                'warnings': verdict.warnings,
            }
        )
        return
    show_table(explanation_table(verdict.explanations, plant))
    say(error_sentences(verdict.period_sigma, verdict.with_other_errors))
    say(explanation_conclusion(verdict.explanations, verdict.indistinguishable))


def _values(explanation: Explanation) -> dict[str, object]:
    values = asdict(explanation)
    values['rms_misfit_s'] = values.pop('rms_misfit')
    values['parameter'] = values['parameter'] or None
    values['unit'] = unit_of(explanation)
    return values
