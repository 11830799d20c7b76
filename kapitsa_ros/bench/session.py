"""One bench session: start the rig, show the screen, list the files that were written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.bench.app import BenchApp
from kapitsa_ros.bench.bench_files import print_what_is_left, refuse_old_runs
from kapitsa_ros.bench.bench_state import BenchState
from kapitsa_ros.bench.notebook import Notebook
from kapitsa_ros.bench.terminal import own_terminal, require_terminal
from kapitsa_ros.operator.protocol import MANUAL
from kapitsa_ros.rig.errors import RigError
from kapitsa_ros.rig.harness import Rig
from kapitsa_ros.rig.preflight import make_writable

if TYPE_CHECKING:
    from pathlib import Path

    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.physics.plant import Plant


def work_at_bench(  # noqa: PLR0917  # the command's options
    plant: Plant, instruments: Instruments, seed: int, rate: float, bags: Path, table: Path, *, composed: bool = False
) -> None:
    """Start a rig, let a person work it until they leave, and say where things are.

    Raises
    ------
    UsageError
        There is no terminal; the folder cannot be written; the table is there already.
    BagError
        The folder holds runs of another sitting.
    RigError
        A node died.

    """
    refuse_old_runs(bags)
    state = BenchState(plant, instruments, Notebook(table), rate)
    require_terminal()
    make_writable(bags)
    with Rig(plant, instruments, seed, rate, bags=bags, protocol=MANUAL, composed=composed) as rig, own_terminal():
        screen = BenchApp(rig, state, f'kapitsa bench · instruments {instruments.name}')
        error = screen.run(mouse=False)
    if error is not None:
        raise error
    if screen.return_code:
        raise RigError('the screen broke off')
    if not screen.hung_up:
        print_what_is_left([bags], state.notebook, plant)
