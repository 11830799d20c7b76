"""Errors of recorded runs."""

from kapitsa_ros.errors import KapitsaError


class BagError(KapitsaError):
    """A bag cannot be written or read; the message names it and how to correct it."""
