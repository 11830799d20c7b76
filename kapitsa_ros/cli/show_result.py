"""What experiment, analyse and replay print."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.cli.options import print_json
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.reporting.allowances import allowances
from kapitsa_ros.reporting.budget_table import budget_sentences
from kapitsa_ros.reporting.conclusion import conclusion

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.physics.plant import Plant

_ALLOWED = ('assumptions', 'play_probability', 'heavy_damping_probability', 'effective_rods')


def show_result(values: Mapping[str, Any], plant: Plant, *, as_json: bool) -> None:
    """Print the runs of a plant and their reduction: one JSON object, or Tables 1 to 3 of the report."""
    from kapitsa_ros.reporting.report_tables import ends, repairs, report_tables  # noqa: PLC0415  # loads the analysis

    if as_json:
        print_json(values)
        return
    for table in report_tables(values, plant):
        show_table(table)
    say([*ends(values), *repairs(values), *allowances(*(values[name] for name in _ALLOWED))])
    if unverified := [run['bag'] for run in values['runs'] if run['digest_ok'] is None]:
        say([f'Unverified, as no digest is recorded with them: {", ".join(unverified)}.'])
    if 'budget' in values:
        show_budget(values['budget'])
    say(conclusion(values))


def show_budget(values: Mapping[str, Any]) -> None:
    """Print an uncertainty budget."""
    from kapitsa_ros.reporting.report_tables import budget_table  # noqa: PLC0415  # loads the analysis

    show_table(budget_table(values))
    say(budget_sentences(values))
