"""How kernels are compiled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numba

from kapitsa_ros.physics.kernels.kernel_cache import KernelCache, warn_of_no_cache

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


def kernel(function: Callable[_P, _R], *, parallel: bool = False) -> Callable[_P, _R]:
    """Compile on first call and keep the machine code on disk; products and sums may fuse, nothing is reordered.

    It is kept in NUMBA_CACHE_DIR, beside the source or in the user's cache folder: the first of them that can be
    written. Where none can, each process compiles for itself, and a line on stderr says so.
    """
    njit = numba.njit(fastmath={'contract'}, error_model='numpy', parallel=parallel)
    return _kept(njit(function), function)


def in_place_kernel(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Compile like a kernel what makes no array: references to those it is given are not counted.

    To count them took as long as the arithmetic where a function works on a few dozen numbers. Numba refuses to compile
    such a function if it does make an array.
    """
    return _kept(numba.njit(fastmath={'contract'}, error_model='numpy', _nrt=False)(function), function)


def _kept(compiled: Any, function: Callable[_P, _R]) -> Callable[_P, _R]:
    if compiled is not function:  # as NUMBA_DISABLE_JIT leaves it
        try:
            compiled._cache = KernelCache(function)  # noqa: SLF001  # Numba has no other place for a cache of ours
        except RuntimeError:  # numba finds no folder that it can write
            warn_of_no_cache()
    return compiled  # type: ignore[no-any-return]
