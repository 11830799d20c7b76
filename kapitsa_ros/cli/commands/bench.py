"""`kapitsa bench`."""

from __future__ import annotations

from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import click

from kapitsa_ros.cli.options import SEED, instrument_options, plant_options, real_time_option
from kapitsa_ros.rig.errors import RigError

if TYPE_CHECKING:
    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.physics.plant import Plant


@click.command()
@plant_options
@instrument_options
@click.option('--seed', type=SEED, default=1, show_default=True, help='of all chance')
@click.option(
    '--bags', type=click.Path(path_type=Path), help='folder for the runs  [default: bench_01, or the next that is free]'
)
@click.option(
    '--table', type=click.Path(path_type=Path), help='CSV file for your readings  [default: named like the folder]'
)
@real_time_option
def bench(
    *, plant: Plant, instruments: Instruments, seed: int, bags: Path | None, table: Path | None, rate: float
) -> None:
    """Turn the knobs yourself: a screen for the terminal, with lamp, stopwatch and a table of your own.

    Press ? there for the keys. What you write down goes to a CSV file that `kapitsa reduce` takes; the runs go to bags,
    with what the rig's own strobe and stopwatch read.
    """
    try:
        from kapitsa_ros.bench.session import work_at_bench  # noqa: PLC0415  # textual is an extra
    except ModuleNotFoundError as error:
        raise RigError(
            f'the bench needs {error.name}: run `make setup`, or pip install "kapitsa_ros[bench]"'
        ) from error
    folder = bags or _free_folder(table)
    work_at_bench(plant, instruments, seed, rate, folder, table or folder.with_name(f'{folder.name}.csv'))


def _free_folder(table: Path | None) -> Path:
    names = (Path(f'bench_{number:02d}') for number in count(1))
    return next(name for name in names if not name.exists() and (table or not name.with_suffix('.csv').exists()))
