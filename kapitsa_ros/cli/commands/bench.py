"""`kapitsa bench`."""

from __future__ import annotations

from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import click

from kapitsa_ros.cli.node_server import node_server
from kapitsa_ros.cli.options import SEED, composed_option, instrument_options, plant_options, real_time_option
from kapitsa_ros.cli.server_options import server_options
from kapitsa_ros.extras import import_of_extra

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
@composed_option
@click.option('--web', is_flag=True, help='in a browser: prints the link, and serves until Ctrl-C')
@server_options('of --web: ')
def bench(
    *,
    plant: Plant,
    instruments: Instruments,
    seed: int,
    bags: Path | None,
    table: Path | None,
    rate: float,
    composed: bool,
    web: bool,
    host: str,
    port: int | None,
    open_page: bool,
) -> None:
    """Turn the knobs yourself: a screen for the terminal, with lamp, stopwatch and a table of your own.

    Press ? there for the keys. What you write down goes to a CSV file that `kapitsa reduce` takes; the runs go to bags,
    with what the rig's own strobe and stopwatch read. With --web, the same bench is a page in a browser.
    """
    folder = bags or _free_folder(table)
    book = table or folder.with_name(f'{folder.name}.csv')
    if web:
        with node_server(loads_first=False):  # what nodes need is loaded beside what the page needs
            session = import_of_extra('kapitsa_ros.web.session', 'the bench in a browser', 'web')
            of_page = {'host': host, 'port': port, 'open_page': open_page}
            session.serve_bench(plant, instruments, seed, rate, folder, book, composed=composed, **of_page)
    else:
        work_at_bench = import_of_extra('kapitsa_ros.bench.session', 'the bench', 'bench').work_at_bench
        work_at_bench(plant, instruments, seed, rate, folder, book, composed=composed)


def _free_folder(table: Path | None) -> Path:
    names = (Path(f'bench_{number:02d}') for number in count(1))
    return next(name for name in names if not name.exists() and (table or not name.with_suffix('.csv').exists()))
