"""Errors of the bench in a browser."""

from kapitsa_ros.errors import KapitsaError


class PageRequestError(KapitsaError):
    """A page asked for something that cannot be understood or done."""
