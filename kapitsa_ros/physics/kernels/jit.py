"""How kernels are compiled, and when what was compiled is out of date."""

from __future__ import annotations

import functools
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numba

if TYPE_CHECKING:
    from collections.abc import Callable

_P = ParamSpec('_P')
_R = TypeVar('_R')


def _load_without_linear_algebra() -> None:
    """Load what all kernels need of Numba, which would load SciPy's linear algebra to see that there is a BLAS.

    It is there, as SciPy is required; to load it takes as long as the kernels themselves, which use none.
    """
    from numba.np import linalg  # noqa: PLC0415

    ensure_blas = getattr(linalg, 'ensure_blas', None)
    if ensure_blas is None:  # another version, which asks in another way
        return
    linalg.ensure_blas = lambda: None
    try:
        from numba.np import arraymath  # noqa: PLC0415
    finally:
        linalg.ensure_blas = ensure_blas
    arraymath.ensure_blas = ensure_blas


_load_without_linear_algebra()


def _stamp() -> tuple[tuple[str, int, int], ...]:
    """Return what tells one state of all kernels' sources from another."""
    files = sorted(Path(__file__).parent.glob('*.py'))
    return tuple((file.name, file.stat().st_mtime_ns, file.stat().st_size) for file in files)


_SOURCES = _stamp()


def kernel(function: Callable[_P, _R], *, parallel: bool = False) -> Callable[_P, _R]:
    """Compile on first call and keep the machine code on disk; products and sums may fuse, nothing is reordered.

    It is kept in NUMBA_CACHE_DIR, beside the source or in the user's cache folder: the first of them that can be
    written. Where none can, each process compiles for itself, and a line on stderr says so.
    """
    njit = functools.partial(numba.njit, fastmath={'contract'}, error_model='numpy', parallel=parallel)
    try:
        compiled: Any = njit(cache=True)(function)
    except RuntimeError:  # numba finds no folder that it can write
        _warn_of_no_cache()
        return njit()(function)  # type: ignore[no-any-return]
    # Numba asks only whether the function's own file has changed, but kernels are compiled into one another.
    cache: Any = getattr(compiled, '_cache', None)
    if hasattr(cache, '_cache_file'):
        cache._cache_file._source_stamp = _SOURCES  # noqa: SLF001
    return compiled  # type: ignore[no-any-return]


@functools.cache
def _warn_of_no_cache() -> None:
    sys.stderr.write(
        'kapitsa: warning: no folder for compiled kernels can be written, each process compiles them again: '
        'set NUMBA_CACHE_DIR to a folder you can write to\n'
    )
