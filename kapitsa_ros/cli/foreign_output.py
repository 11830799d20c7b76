"""What C libraries write to stdout, as Fast DDS does with its complaints."""

from __future__ import annotations

import errno
import os
import sys
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

_STDOUT, _STDERR = 1, 2


@contextmanager
def foreign_output_on_stderr() -> Iterator[Callable[[], AbstractContextManager[None]]]:
    """Send to stderr what is written to stdout in the context: stdout is for the result.

    Yields a context in which stdout is stdout again, for a result that comes earlier.
    """
    try:
        stdout = os.dup(_STDOUT)
    except OSError as error:
        if error.errno != errno.EBADF:  # no file descriptor is left: the result could not be kept apart
            raise
        # Closed: nobody gets anything.
        yield nullcontext
        return
    try:
        with suppress(OSError):
            os.dup2(_STDERR, _STDOUT)
        yield partial(_with_stdout, stdout)
    finally:
        os.dup2(stdout, _STDOUT)
        os.close(stdout)


@contextmanager
def _with_stdout(stdout: int) -> Iterator[None]:
    os.dup2(stdout, _STDOUT)
    try:
        yield
        sys.stdout.flush()
    finally:
        with suppress(OSError):
            os.dup2(_STDERR, _STDOUT)
