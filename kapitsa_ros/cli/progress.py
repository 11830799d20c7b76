"""Progress on stderr, where stderr is a terminal; a line a run where it is not."""

from __future__ import annotations

import sys
import threading
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING, TypeVar

from rich.console import Console
from rich.progress import track
from rich.status import Status

from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from contextlib import AbstractContextManager

_Counted = TypeVar('_Counted')


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

    with _shown(status, console):
        yield take


@contextmanager
def shown_stages(first: str = 'starting') -> Iterator[Callable[[str], None]]:
    """Show what long work is at, where stderr is a terminal; yield what takes it."""
    console = Console(file=sys.stderr)
    status = Status(first, console=console)
    with _shown(status, console):
        yield status.update


def counted_off(stream: Iterator[_Counted], what: str, total: int) -> Iterable[_Counted]:
    """Show how many of a stream have come, where stderr is a terminal."""
    console = Console(file=sys.stderr)
    return track(stream, what, total, console=console, transient=True) if _can_show(console) else stream


def _shown(status: Status, console: Console) -> AbstractContextManager[object]:
    return status if _can_show(console) else nullcontext()


def _can_show(console: Console) -> bool:
    """Whether there is a terminal, and a thread for what moves on it: no work fails for want of that."""
    if not console.is_terminal:
        return False
    thread = threading.Thread(target=lambda: None)
    try:
        thread.start()
    except RuntimeError:  # the system has none left
        return False
    thread.join()
    return True
