"""Errors of recorded runs."""

from __future__ import annotations

from kapitsa_ros.errors import KapitsaError


class BagError(KapitsaError):
    """A bag cannot be written or read; the message names it and how to correct it."""

    def __init__(self, message: str = '', *, option: str | None = None, value: object = None) -> None:
        super().__init__(printable(message), option=option, value=value)


def printable(text: str) -> str:
    """Return a text in one line, for it may hold names out of a damaged file."""
    return ''.join(sign if sign.isprintable() else '?' for sign in text)
