"""How kernels are compiled."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numba

if TYPE_CHECKING:
    from collections.abc import Callable

_P = ParamSpec('_P')
_R = TypeVar('_R')


def kernel(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Compile on first call and keep the machine code on disk.

    Products and sums must not fuse: code from the disk and code just compiled would round differently.
    """
    compiled: Any = numba.njit(cache=True, error_model='numpy')(function)
    return compiled  # type: ignore[no-any-return]
