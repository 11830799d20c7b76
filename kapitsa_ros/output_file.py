"""Output files: checked before the work, written as a whole or not at all."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from kapitsa_ros.errors import OPTION, OutputError

if TYPE_CHECKING:
    from collections.abc import Iterator


def check_output(path: Path, option: str = 'output', *, overwrite: bool = False) -> None:
    """Check that a file can be written, to which the user has given a path by an option of this name.

    Raises
    ------
    OutputError
        Its folder is not there, it cannot be written, or it holds something and is not to be overwritten.

    """
    if not overwrite and path.is_file() and path.stat().st_size > 0:
        raise OutputError(
            f'{OPTION}: is there already; give another name, or --overwrite to replace it', option=option, value=path
        )
    if path.is_dir():
        raise OutputError(f'{OPTION}: is a folder; give the name of a file', option=option, value=path)
    folder = path.resolve().parent
    if not folder.is_dir():
        raise OutputError(f'{OPTION}: there is no directory {path.parent}: make it first', option=option, value=path)
    is_special = path.exists() and not path.is_file()
    if not os.access(path if path.exists() else folder, os.W_OK) or not (is_special or os.access(folder, os.W_OK)):
        raise OutputError(f'{OPTION}: cannot be written; give a file you can write', option=option, value=path)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a path to write to; what is written there takes the place of a file when the context is left.

    An error in the context leaves the file, if there is one, as it was. Where the path leads to something else than a
    file, as /dev/stdout does, it gets from beginning to end what was written.

    Raises
    ------
    OSError
        The file or its folder cannot be written.

    """
    if path.exists() and not path.is_file():  # before its links are followed: a pipe has no path in the end
        with open(os.memfd_create('draft'), 'rb') as memory, _naming(path):  # noqa: PTH123
            yield Path(f'/proc/self/fd/{memory.fileno()}')
            with path.open('wb') as file:  # once: whoever reads a pipe leaves where it is closed
                shutil.copyfileobj(memory, file)
        return
    path = path.resolve()
    if path.exists() and not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    # A folder beside the file, and the file's own name in it: writers look at suffixes, and umask sets the mode.
    with tempfile.TemporaryDirectory(prefix='.', dir=path.parent) as folder:
        draft = Path(folder) / path.name
        with _naming(path):
            yield draft
        if path.exists():
            shutil.copymode(path, draft)
        draft.replace(path)


@contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Let an error of the system tell the file, which it does not know while it is written."""
    try:
        yield
    except OSError as error:
        if error.errno is None or error.filename is not None:
            raise
        raise OSError(error.errno, os.strerror(error.errno), str(path)) from error
