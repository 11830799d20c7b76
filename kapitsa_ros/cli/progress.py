"""Progress on stderr, where stderr is a terminal; a line a run where it is not."""

from __future__ import annotations

import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rich.console import Console
from rich.status import Status

from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator


@contextmanager
def shown_progress(runs: int) -> Iterator[Callable[[dict[str, str]], None]]:
    """Show how far the graph is; yield what takes the reports."""
    console = Console(file=sys.stderr)
    status = Status(f'starting the graph for {counted(runs, "run")}', console=console)
    printed: set[int] = set()

    def take(values: dict[str, str]) -> None:
        run, simulated, factor = int(values['run']), float(values['simulated_s']), float(values['realtime_factor'])
        if not 0 < run <= runs:
            return
        text = f'run {run} of {runs}: {simulated:.0f} s simulated, {factor:.0f} times real time'
        status.update(text)
        if not console.is_terminal and run not in printed:
            printed.add(run)
            console.print(text, highlight=False)

    with status:
        yield take


@contextmanager
def shown_stages(first: str = 'starting') -> Iterator[Callable[[str], None]]:
    """Show what long work is at, where stderr is a terminal; yield what takes it."""
    with Status(first, console=Console(file=sys.stderr)) as status:
        yield status.update
