"""The files of a sitting at the bench: what must not be there before, and what is left after it."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

import click

from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.schema import describe
from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kapitsa_ros.bench.notebook import Notebook


def refuse_old_runs(bags: Path) -> None:
    """Check that a folder holds no runs of another sitting.

    Raises
    ------
    BagError
        It does.

    """
    if old := sorted(bags.glob('run_*_0rpm')):
        raise BagError(f'{old[0]} exists: runs are never overwritten, give another --bags or move it away')


def print_what_is_left(folders: Sequence[Path], notebook: Notebook, plant: Plant) -> None:
    """Say where runs and readings of a plant are."""
    recorded = {folder: sorted(folder.glob('run_*')) for folder in folders}
    for folder, runs in recorded.items():
        if runs:
            click.echo(f'{counted(len(runs), "run")} in {folder}: kapitsa analyse {folder}/*')
    if not any(recorded.values()):
        click.echo('no run was recorded')
    if rows := notebook.rows:
        click.echo(
            f'{counted(len(rows), "reading")} of yours in {notebook.path}: {_reduce_command(notebook.path, plant)}'
        )


def _reduce_command(table: Path, plant: Plant) -> str:
    """Return the command that reduces a table for a plant, which the table does not tell."""
    assumed = Plant()
    options = [
        f'--{item.name.replace("_", "-")}={getattr(plant, item.name)!r}'
        for item in describe(Plant)
        if getattr(plant, item.name) != getattr(assumed, item.name)
    ]
    return shlex.join(['kapitsa', 'reduce', str(table), *options])
