"""`kapitsa plan`: the cheapest protocol for an aim, and the measurement that decides."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from kapitsa_ros._api.plan import plan as call
from kapitsa_ros.analysis.explain import CAUSES
from kapitsa_ros.analysis.plan.cheapest import FASTEST
from kapitsa_ros.cli.options import (
    SPEED,
    assumption_option,
    instrument_options,
    json_option,
    plant_options,
    print_json,
)
from kapitsa_ros.cli.progress import shown_stages
from kapitsa_ros.cli.table_argument import table_argument
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.cli.written import WRITTEN_ANGLE
from kapitsa_ros.reporting.plan_text import plan_sentences, plan_table, separation_sentence
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.cli.written import Written
    from kapitsa_ros.configuration.tables import TimingTable
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.physics.plant import Plant

_NAMES = click.Choice([cause.name for cause in CAUSES])


@click.command()
@table_argument
@click.option('--target', type=float, required=True, help='half the width of the 95 % interval wanted, per cent')
@click.option(
    '--release', type=WRITTEN_ANGLE, default=0.12, show_default=True, help='angle at which the pendulum is let go, rad'
)
@click.option('--max-speed', type=SPEED, default=FASTEST / RPM, show_default=True, help='fastest the jigsaw may turn')
@click.option(
    '--between',
    type=(_NAMES, _NAMES),
    default=('inertia_factor', 'large_swing'),
    show_default=True,
    help='two explanations of TABLE to tell apart',
)
@plant_options
@instrument_options
@assumption_option
@json_option
def plan(
    table: TimingTable,
    *,
    target: float,
    release: Written,
    max_speed: float,
    between: tuple[str, str],
    plant: Plant,
    instruments: Instruments,
    assumptions: Assumptions,
    as_json: bool,
) -> None:
    """Find the cheapest protocol whose 95 % interval is within ±TARGET per cent of the critical speed.

    It has to allow for what the readings would not show, such as play: --assume play_probability=0 for a pivot that is
    known to have none. Beside it stands the one measurement that best tells two explanations of TABLE (by default that
    of 1997) apart.
    """
    with shown_stages('trying protocols'):
        found = call(
            plant,
            target=target,
            release=release.value,
            max_speed=max_speed,
            between=between,
            readings=table,
            instruments=instruments,
            assumptions=assumptions,
        )
    deciding = found.separation
    if as_json:
        print_json(
            {
                'speeds_rpm': [speed / RPM for speed in found.speeds],
                'periods': found.swings,
                'repeats': found.repeats,
                'expected_percent': found.expected_percent,
                'bench_s': found.seconds,
                'separation': {
                    'between': deciding.between,
                    'speed_rpm': deciding.speed / RPM,
                    'release_rad': deciding.release,
                    'periods_s': deciding.periods,
                    'sigmas': deciding.sigmas,
                },
            }
        )
        return
    speeds = found.speeds.tolist()
    show_table(plan_table(speeds, found.swings, found.repeats))
    say(
        plan_sentences(
            speeds,
            found.swings,
            found.repeats,
            expected_percent=found.expected_percent,
            seconds=found.seconds,
            release=release.text(),
        )
    )
    say([separation_sentence(deciding)])
