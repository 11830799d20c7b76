"""Settings of Numba in the environment by which kernels are compiled in another way, to other last digits."""

from __future__ import annotations

import os

from kapitsa_ros.file_name_text import shown_name

_AS_IT_IS = {
    'NUMBA_BOUNDSCHECK': '0',
    'NUMBA_CPU_FEATURES': None,  # empty: none
    'NUMBA_CPU_NAME': None,
    'NUMBA_DEBUGINFO': '0',
    'NUMBA_DISABLE_INTEL_SVML': '0',
    'NUMBA_DISABLE_JIT': '0',
    'NUMBA_ENABLE_AVX': '1',
    'NUMBA_LOOP_VECTORIZE': '1',
    'NUMBA_OPT': '3',
    'NUMBA_SLP_VECTORIZE': '0',
}
"""What says the same as nothing."""


def numba_settings() -> tuple[str, ...]:
    """Return those in force, as `NUMBA_OPT=0`; none as a rule."""
    given = {name: os.environ.get(name) for name in _AS_IT_IS}
    return tuple(
        f'{name}={shown_name(value)}' for name, value in given.items() if value is not None and value != _AS_IT_IS[name]
    )
