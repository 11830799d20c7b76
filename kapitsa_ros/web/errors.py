"""Errors of the bench in a browser."""

from __future__ import annotations

from typing import Any

from kapitsa_ros.bench.message import Message
from kapitsa_ros.errors import KapitsaError


class PageRequestError(KapitsaError):
    """A page asked for something that cannot be understood or done.

    Parameters
    ----------
    template
        Of the sentence that says why; it is what a catalogue of another language is asked for.
    values
        What it is filled with.

    """

    def __init__(self, template: str, **values: Any) -> None:
        self.said = Message(template, **values)
        super().__init__(self.said)
