"""`kapitsa study`: whether the divergence of 1997 is the pendulum's or the solver's."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from kapitsa_ros.cli.options import ANGLE, SPEED, json_option, plant_options, print_json
from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.solver_comparison import compare_solvers
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


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
def study(plant: Plant, speed: float, release: float, duration: float, cycles: int, *, as_json: bool) -> None:
    """Integrate the frictionless pendulum with the solvers people use and show the growth of its slow amplitude."""
    run = Release(plant=plant, speed=speed, angle=release)
    results = []
    click.echo(
        f'A frictionless rod at {speed / RPM:.0f} RPM, released at {release:g} rad, as solvers see it\n'
        f'{"solver":26} {"followed":>9} {"growth 1/s":>11} {"amplitude":>11} {"fell at":>9} {"CPU s":>7}',
        err=as_json,
    )
    for result in compare_solvers(run, duration=duration, cycles=cycles):
        results.append(asdict(result))
        fell = '-' if result.fell_at is None else f'{result.fell_at:.0f} s'
        click.echo(
            f'{result.solver:26} {result.duration:7.0f} s {result.growth:11.2e} × {result.amplitude_ratio:9.5f} '
            f'{fell:>9} {result.cpu:7.2f}',
            err=as_json,
        )
    rates = [result['growth'] for result in results]
    click.echo(
        f'The growth runs from {min(rates):.1e} to {max(rates):.1e} 1/s with the solver. Ours over {cycles} cycles: '
        f"{rates[-1]:.0e} 1/s.\nA growth that depends on the solver is not the rod's.",
        err=as_json,
    )
    if as_json:
        print_json({'verdicts': results})
