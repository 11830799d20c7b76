"""The versions on which the numbers of a run depend."""

from __future__ import annotations

import platform
from importlib.metadata import version


def versions() -> dict[str, str]:
    """Return them by name, Python's own too."""
    names = ('kapitsa_ros', 'numpy', 'scipy', 'numba')
    return {'python': platform.python_version()} | {name: version(name) for name in names}
