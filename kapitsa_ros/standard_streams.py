"""Standard streams that are closed, or take nothing."""

from __future__ import annotations

import io
import os
import sys

STDERR = 2


class _Forgiving(io.FileIO):
    """A file whose complaints are lost where the disk is full or nobody reads: what is said there is no work."""

    def write(self, data: bytes | memoryview) -> int:  # type: ignore[override]
        try:
            return super().write(data)
        except OSError:
            return len(data)


def keep_streams_open() -> None:
    """Let nothing else take the place of a stream that is closed, and no work fail of what is said on stderr."""
    while (descriptor := os.open(os.devnull, os.O_RDWR)) <= STDERR:
        os.set_inheritable(descriptor, True)  # noqa: FBT003  # it takes no name; processes started here need it too
    os.close(descriptor)
    given = sys.stderr
    sys.stderr = io.TextIOWrapper(
        _Forgiving(STDERR, 'w', closefd=False),
        encoding=given.encoding if given is not None else 'utf-8',
        errors='backslashreplace',
        line_buffering=True,
    )
