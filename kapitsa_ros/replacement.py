"""Files written as a whole or not at all."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a path to write to; what is written there takes the place of a file when the context is left.

    An error in the context leaves the file, if there is one, as it was. Where the path leads to something else than a
    file, as /dev/stdout does, that is yielded.

    Raises
    ------
    OSError
        The file or its folder cannot be written.

    """
    path = path.resolve()
    if path.exists() and not path.is_file():
        yield path
        return
    if path.exists() and not os.access(path, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    # A folder beside the file, and the file's own name in it: writers look at suffixes, and umask sets the mode.
    with tempfile.TemporaryDirectory(prefix='.', dir=path.parent) as folder:
        draft = Path(folder) / path.name
        yield draft
        if path.exists():
            shutil.copymode(path, draft)
        draft.replace(path)
