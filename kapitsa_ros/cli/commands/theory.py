"""`kapitsa theory`: what theory says of this rod."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros._api.theory import theory as call
from kapitsa_ros.cli.options import json_option, plant_options, print_json
from kapitsa_ros.cli.progress import shown_stages
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.cli.written import WRITTEN_ANGLE, WRITTEN_SPEED
from kapitsa_ros.reporting.plant_sentence import plant_sentence
from kapitsa_ros.reporting.theory_text import comparison_table, critical_speeds_table, speeds_table, theory_conclusion
from kapitsa_ros.units import RPM, in_rpm

if TYPE_CHECKING:
    from kapitsa_ros._api.theory import Theory
    from kapitsa_ros.cli.written import Written
    from kapitsa_ros.physics.plant import Plant


@click.command()
@plant_options
@click.option('--speed', 'speeds', type=WRITTEN_SPEED, multiple=True, help='a forcing speed (several may be given)')
@click.option('--release', type=WRITTEN_ANGLE, help='also compare the theories for a swing released at this θ')
@json_option
def theory(plant: Plant, speeds: tuple[Written, ...], release: Written | None, *, as_json: bool) -> None:
    """Say what theory predicts: critical speeds, and what the rod does at given ones."""
    # One call a speed: each that has no answer is an error here.
    angle = None if release is None else release.value
    with shown_stages('working out the theories'):
        found = [call(plant, speed=speed.value, release=angle) for speed in speeds]
        rod = found[0] if found else call(plant)
    for warning in rod.warnings:
        click.echo(f'kapitsa: warning: {warning}', err=True)
    answer: dict[str, Any] = {
        'mathieu_q': rod.mathieu_q,
        'omega_crit_averaged_rpm': in_rpm(rod.omega_crit_averaged),
        'omega_crit_exact_rpm': in_rpm(rod.omega_crit),
        'omega_crit_upper_rpm': in_rpm(rod.omega_crit_upper),
        'speeds': [_at(one) for one in found],
    }
    if as_json:
        print_json(answer)
        return
    rows = [(row, speed.text) for row, speed in zip(answer['speeds'], speeds, strict=True)]
    say([plant_sentence(plant) + f". Mathieu's q = {answer['mathieu_q']:.4f}."])
    show_table(critical_speeds_table(answer, speeds[0].text if speeds else _in_rpm))
    if rows:
        show_table(speeds_table(rows))
    for row, as_typed in rows:
        if release is not None:
            show_table(comparison_table(row, as_typed, release.text()))
    say(theory_conclusion(answer, rows))


def _in_rpm(speed: float) -> str:
    return f'{speed / RPM:.6g} RPM'


def _at(found: Theory) -> dict[str, Any]:
    answer: dict[str, Any] = {
        'speed_rpm': in_rpm(float(found.speed)),
        'mathieu_a': float(found.mathieu_a),
        'stable': bool(found.stable),
        'slow_averaged_rpm': in_rpm(float(found.slow_averaged)),
        'slow_exact_rpm': in_rpm(float(found.slow)),
        'growth_per_s': float(found.growth),
    }
    if found.comparison:
        answer['ladder'] = [
            {
                'name': each.name,
                'source': each.source,
                'slow_rpm': in_rpm(each.frequency),
                'error_rpm': in_rpm(each.error),
            }
            for each in found.comparison[0]
        ]
    return answer
