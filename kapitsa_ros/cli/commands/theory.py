"""`kapitsa theory`: what theory says of this rod."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros._api.theory import theory as call
from kapitsa_ros.cli.options import ANGLE, SPEED, json_option, plant_options, print_json
from kapitsa_ros.units import in_rpm

if TYPE_CHECKING:
    from kapitsa_ros._api.theory import Theory
    from kapitsa_ros.physics.plant import Plant


@click.command()
@plant_options
@click.option('--speed', 'speeds', type=SPEED, multiple=True, help='a forcing speed (several may be given)')
@click.option('--release', type=ANGLE, help='also compare the theories for a swing released at this θ')
@json_option
def theory(plant: Plant, speeds: tuple[float, ...], release: float | None, *, as_json: bool) -> None:
    """Say what theory predicts: critical speeds, and what the rod does at given ones."""
    # One call a speed: each that has no answer is an error here.
    found = [call(plant, speed=speed, release=release) for speed in speeds]
    rod = found[0] if found else call(plant)
    for warning in rod.warnings:
        click.echo(f'kapitsa: warning: {warning}', err=True)
    answer = {
        'mathieu_q': rod.mathieu_q,
        'omega_crit_averaged_rpm': in_rpm(rod.omega_crit_averaged),
        'omega_crit_exact_rpm': in_rpm(rod.omega_crit),
        'omega_crit_upper_rpm': in_rpm(rod.omega_crit_upper),
        'speeds': [_at(one) for one in found],
    }
    if as_json:
        print_json(answer)
    else:
        _print(answer)


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


def _print(answer: dict[str, Any]) -> None:
    click.echo(f'Mathieu q                 {answer["mathieu_q"]:.6f}')
    click.echo(f'critical speed, averaged  {answer["omega_crit_averaged_rpm"]:.4f} RPM')
    click.echo(f'critical speed, exact     {answer["omega_crit_exact_rpm"]:.4f} RPM')
    upper = answer['omega_crit_upper_rpm']
    click.echo('upper limit               ' + ('none' if upper is None else f'{upper:.4f} RPM'))
    if answer['speeds']:
        click.echo('\n speed RPM   stable  slow, averaged  slow, exact RPM  growth 1/s')
    for row in answer['speeds']:
        slow = [f'{row[key]:.4f}' if row[key] is not None else '-' for key in ('slow_averaged_rpm', 'slow_exact_rpm')]
        stable = 'yes' if row['stable'] else 'no'
        click.echo(f'{row["speed_rpm"]:10.2f}   {stable:6}  {slow[0]:>14}  {slow[1]:>15}  {row["growth_per_s"]:10.5f}')
    for row in answer['speeds']:
        _print_comparison(row)


def _print_comparison(row: dict[str, Any]) -> None:
    if 'ladder' not in row:
        return
    click.echo(f'\nat {row["speed_rpm"]:10.2f} RPM     source             slow RPM    error RPM')
    for each in row['ladder']:
        slow = '-' if each['slow_rpm'] is None else f'{each["slow_rpm"]:10.5f}  {each["error_rpm"]:+11.5f}'
        click.echo(f'{each["name"]:20}  {each["source"]:15}  {slow}')
