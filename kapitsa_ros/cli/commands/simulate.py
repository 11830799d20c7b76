"""`kapitsa simulate`: one run without the graph."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import numpy as np

from kapitsa_ros._api.simulate import simulate as call
from kapitsa_ros.cli.options import ANGLE, FREQUENCY, json_option, overwrite_option, plant_options, print_json
from kapitsa_ros.cli.output_files import SUFFIXES, check_table_output, write_table
from kapitsa_ros.cli.progress import shown_stages
from kapitsa_ros.cli.terminal import say, show_table
from kapitsa_ros.cli.written import WRITTEN_ANGLE, WRITTEN_SPEED
from kapitsa_ros.reporting.plant_sentence import plant_sentence
from kapitsa_ros.reporting.simulation_text import simulation_conclusion, simulation_table
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.cli.written import Written
    from kapitsa_ros.physics.plant import Plant


@click.command()
@plant_options
@click.option('--speed', type=WRITTEN_SPEED, required=True, help='forcing speed ω')
@click.option('--release', type=WRITTEN_ANGLE, required=True, help='θ at rest at time 0')
@click.option('--phase', type=ANGLE, default=0.0, show_default=True, help='p: 0 starts the pivot at the bottom')
@click.option('--duration', type=float, required=True, help='seconds')
@click.option('--linear', is_flag=True, help='θ for sin θ')
@click.option('--bending-frequency', type=FREQUENCY, help="of the rod's first bending mode (Hz); rigid where not given")
@click.option('--bending-damping', type=float, help='of that mode, a share of critical  [default: 0]')
@click.option('--output', type=click.Path(path_type=Path, dir_okay=False), help=f'file for the motion: {SUFFIXES}')
@overwrite_option
@click.option('--sample-rate', type=float, default=1000.0, show_default=True, help='Hz')
@json_option
def simulate(
    *,
    plant: Plant,
    speed: Written,
    release: Written,
    phase: float,
    duration: float,
    output: Path | None,
    overwrite: bool,
    sample_rate: float,
    linear: bool,
    bending_frequency: float | None,
    bending_damping: float | None,
    as_json: bool,
) -> None:
    """Release the rod at rest on a shaking pivot and say what becomes of it."""
    if output is not None:
        check_table_output(output, overwrite=overwrite)
    if bending_damping is not None and bending_frequency is None:
        raise UsageError('--bending-damping: a rigid rod has none, give --bending-frequency too')
    with shown_stages(f'following the rod for {duration:g} s'):
        run = call(
            plant,
            speed=speed.value,
            release=release.value,
            duration=duration,
            phase=phase,
            linear=linear,
            bending_frequency=bending_frequency,
            bending_damping=bending_damping,
            sample_rate=sample_rate,
        )
        if output is not None:
            write_table(output, run.columns)
    answer: dict[str, Any] = {
        'slow_rpm': None if run.slow is None else run.slow / RPM,
        'growth_per_s': run.growth,
        'max_angle_rad': float(np.abs(run.angle).max()),
        'fell': run.fell,
        'final_angle_rad': float(run.angle[-1]),
        'stuck': run.stuck,
        'periods': run.periods,
    }
    if as_json:
        print_json(answer)
        return
    say(
        [f'{plant_sentence(plant)}. Shaken at {speed.text()}, let go at {release.text()}, followed for {duration:g} s.']
    )
    show_table(simulation_table(answer, speed.text, lambda angle: release.text(angle, 4)))
    say(simulation_conclusion(answer, falls=run.falls, end=release.text(answer['final_angle_rad'], 3)))
    if output is not None:
        click.echo(f'{output}')
