"""What of a processor can change the last digits of a computation: which instructions numeric libraries use of it."""

from __future__ import annotations

import json
import platform
from typing import Any

import numpy as np

from kapitsa_ros.numba_settings import numba_settings

PROCESSOR_KEY = 'processor'
"""Key of the bag's custom data, beside the digest."""


def processor() -> tuple[str, ...]:
    """Return the architecture, the extensions that numpy finds, and what is set for numba: `x86_64`, `X86_V3`, ..."""
    found: Any = np.show_config(mode='dicts')['SIMD Extensions']
    return (platform.machine(), *found.get('baseline', ()), *found.get('found', ()), *numba_settings())


def processor_text() -> str:
    """Return the same as it stands in a bag."""
    return json.dumps(processor())


def parse_processor(text: str | None) -> tuple[str, ...] | None:
    """Read it from a bag; None where it is not there, or is none."""
    try:
        found = json.loads(text or '')
    except (ValueError, RecursionError):
        return None
    is_one = isinstance(found, list) and all(isinstance(each, str) and each.isprintable() for each in found)
    return tuple(found) if is_one else None
