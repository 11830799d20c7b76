"""Errors of the bench in a browser."""

from __future__ import annotations

from kapitsa_ros.errors import KapitsaError


class PageRequestError(KapitsaError):
    """A page asked for something that cannot be understood or done."""
