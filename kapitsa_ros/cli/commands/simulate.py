"""`kapitsa simulate`: one run without the graph."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from kapitsa_ros.cli.options import ANGLE, FREQUENCY, SPEED, json_option, plant_options, print_json
from kapitsa_ros.cli.output_files import SUFFIXES, check_table_output, write_table
from kapitsa_ros.physics.flexible_rod import BendingMode, FlexibleTrajectory, simulate_flexible
from kapitsa_ros.physics.release import Release, Trajectory
from kapitsa_ros.physics.run_summary import summarise_run
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant


@click.command()
@plant_options
@click.option('--speed', type=SPEED, required=True, help='forcing speed ω')
@click.option('--release', type=ANGLE, required=True, help='θ at rest at time 0')
@click.option('--phase', type=ANGLE, default=0.0, show_default=True, help='p: 0 starts the pivot at the bottom')
@click.option('--duration', type=float, required=True, help='seconds')
@click.option('--linear', is_flag=True, help='θ for sin θ')
@click.option('--bending-frequency', type=FREQUENCY, help="of the rod's first bending mode (Hz); rigid where not given")
@click.option('--bending-damping', type=float, help='of that mode, a share of critical  [default: 0]')
@click.option('--output', type=click.Path(path_type=Path, dir_okay=False), help=f'file for the motion: {SUFFIXES}')
@click.option('--sample-rate', type=float, default=1000.0, show_default=True, help='Hz')
@json_option
def simulate(
    *,
    plant: Plant,
    speed: float,
    release: float,
    phase: float,
    duration: float,
    output: Path | None,
    sample_rate: float,
    linear: bool,
    bending_frequency: float | None,
    bending_damping: float | None,
    as_json: bool,
) -> None:
    """Release the rod at rest on a shaking pivot and say what becomes of it."""
    if output is not None:
        check_table_output(output)
    run = Release(plant=plant, speed=speed, angle=release, phase=phase, linear=linear)
    bending = _bending(bending_frequency, bending_damping)
    motion = (
        run.sampled(duration, sample_rate)
        if bending is None
        else simulate_flexible(run, bending, duration, sample_rate)
    )
    slow = summarise_run(run, duration, bending)
    if output is not None:
        pivot = -plant.amplitude * np.cos(speed * motion.time + phase)
        columns = {'time_s': motion.time, 'angle_rad': motion.angle, 'rate_rad_s': motion.rate, 'pivot_m': pivot}
        if isinstance(motion, FlexibleTrajectory):
            columns['deflection_m'] = motion.deflection
        write_table(output, columns)
    answer = {
        'slow_rpm': None if slow.frequency is None else slow.frequency / RPM,
        'growth_per_s': slow.growth,
        'max_angle_rad': float(np.abs(motion.angle).max()),
        'fell': motion.fell,
        'final_angle_rad': float(motion.angle[-1]),
        'stuck': isinstance(motion, Trajectory) and motion.stuck,
        'periods': slow.periods,
    }
    if as_json:
        print_json(answer)
    else:
        for name, value in answer.items():
            click.echo(f'{name:16} {value}')


def _bending(frequency: float | None, damping: float | None) -> BendingMode | None:
    if frequency is not None:
        return BendingMode(frequency=frequency, damping=damping or 0.0)
    if damping is not None:
        raise UsageError('--bending-damping: a rigid rod has none, give --bending-frequency too')
    return None
