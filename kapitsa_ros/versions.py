"""The versions on which the numbers of a run depend."""

from __future__ import annotations

import platform
from importlib.metadata import version

from kapitsa_ros import __version__


def versions() -> dict[str, str]:
    """Return them by name, Python's own too."""
    own = {'python': platform.python_version(), 'kapitsa_ros': __version__}  # also where it is on the path alone
    return own | {name: version(name) for name in ('numpy', 'scipy', 'numba')}
