"""Errors of what the nodes exchange."""

from kapitsa_ros.errors import FAILED, KapitsaError


class WireError(KapitsaError, ValueError):
    """A message is not what its topic promises."""


class SequenceError(KapitsaError):
    """Steps came out of order, twice or not at all."""

    exit_status = FAILED


class RunError(KapitsaError, ValueError):
    """A run's settings do not describe it, or several runs do not belong together."""
