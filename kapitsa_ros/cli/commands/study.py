"""`kapitsa study`: whether the divergence of 1997 is the pendulum's or the solver's."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

import click

from kapitsa_ros.cli.options import ANGLE, SPEED, json_option, plant_options, print_json
from kapitsa_ros.cli.progress import shown_stages
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.physics.release import Release
from kapitsa_ros.physics.solver_comparison import compare_solvers
from kapitsa_ros.reporting.plant_sentence import plant_sentence
from kapitsa_ros.reporting.study_text import solvers_table
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
    with shown_stages('following the rod with each solver') as on_progress:
        for result in compare_solvers(run, duration=duration, cycles=cycles):
            results.append(result)
            on_progress(f'{result.solver} has followed it; the next solver')
    if as_json:
        print_json({'verdicts': [asdict(result) for result in results]})
        return
    say([f'{plant_sentence(plant)}. At {speed / RPM:.0f} RPM, let go at {release:g} rad.'])
    show_table(solvers_table(results))
    rates = [result.growth for result in results]
    ours = f'Ours over {cycles} cycles: {rates[-1]:.0e} 1/s.'
    say([f'The growth runs from {min(rates):.1e} to {max(rates):.1e} 1/s with the solver. {ours}'])
    say(["A growth that depends on the solver is not the rod's."])
