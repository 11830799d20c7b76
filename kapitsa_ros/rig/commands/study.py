"""`kapitsa study`: whether the divergence of 1997 is the pendulum's or the solver's."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from kapitsa_ros.physics.simulation import Release
from kapitsa_ros.physics.study import study as follow
from kapitsa_ros.rig.options import ANGLE, SPEED, json_option, plant_options, print_json

if TYPE_CHECKING:
    from kapitsa_ros.physics.parameters import PlantParameters


@click.command()
@plant_options
@click.option('--speed', type=SPEED, default=2500, show_default=True, help='forcing speed ω')
@click.option('--release', type=ANGLE, default=0.12, show_default=True, help='θ at rest at time 0')
@click.option(
    '--duration', type=click.FloatRange(1.0), default=300.0, show_default=True, help='seconds for each solver'
)
@click.option(
    '--cycles', type=click.IntRange(100), default=1_000_000, show_default=True, help='forcing cycles with ours'
)
@json_option
def study(plant: PlantParameters, speed: float, release: float, duration: float, cycles: int, *, as_json: bool) -> None:
    """Integrate the frictionless pendulum with the solvers people use and show the growth of its slow amplitude."""
    run = Release(plant=plant, speed=speed, angle=release)
    verdicts = []
    click.echo(f'{"solver":24} {"growth 1/s":>11} {"amplitude":>10} {"fell at":>9} {"CPU s":>7}', err=as_json)
    for verdict in follow(run, duration=duration, cycles=cycles):
        verdicts.append(asdict(verdict))
        fell = '-' if verdict.fell_at is None else f'{verdict.fell_at:.0f} s'
        click.echo(
            f'{verdict.solver:24} {verdict.growth:11.2e} x {verdict.amplitude_ratio:8.5f} {fell:>9} {verdict.cpu:7.2f}',
            err=as_json,
        )
    if as_json:
        print_json({'verdicts': verdicts})
