"""The terminal, kept to the screen alone while it lasts."""

from __future__ import annotations

import io
import os
import sys
import tempfile
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from kapitsa_ros.rig.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Iterator


class _Screen(io.TextIOWrapper):
    """A terminal that may be closed at any time: what is written after that is lost without an error."""

    def write(self, text: str) -> int:
        with suppress(OSError):
            super().write(text)
        return len(text)

    def flush(self) -> None:
        with suppress(OSError):
            super().flush()


def require_terminal() -> None:
    """Refuse to draw where nobody sees it.

    Raises
    ------
    UsageError
        An end of this process is no terminal.

    """
    if not all(stream is not None and stream.isatty() for stream in (sys.stdin, sys.stdout, sys.stderr)):
        raise UsageError(
            'the bench needs a terminal; without one, drive the rig with kapitsa_ros.rig.Rig or ros2 topic pub'
        )


@contextmanager
def own_terminal() -> Iterator[None]:
    """Give the terminal to the screen: whatever else goes to stderr, from C too, is held back until the end."""
    sys.stderr.flush()
    interpreters = sys.__stderr__
    screen = _Screen(open(os.dup(2), 'wb'), encoding='utf-8', errors='replace', write_through=False)  # noqa: PTH123, SIM115
    with tempfile.TemporaryFile() as held:
        os.dup2(held.fileno(), 2)
        sys.__stderr__ = screen  # type: ignore[misc]  # where Textual draws
        try:
            yield
        finally:
            sys.__stderr__ = interpreters  # type: ignore[misc]
            screen.flush()
            sys.stderr.flush()
            os.dup2(screen.fileno(), 2)
            with suppress(OSError):
                screen.close()
            held.seek(0)
            with suppress(OSError):
                os.write(2, held.read())
