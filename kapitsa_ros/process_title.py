"""How a process is shown by `ps`."""

from __future__ import annotations

import sys

import setproctitle


def show_as(module: str, *arguments: str) -> None:
    """Show this process as one that runs a module, however it came to that: forked, or by a line of Python."""
    setproctitle.setproctitle(' '.join([sys.executable, '-m', module, *arguments]))
