"""Errors of the operator."""

from kapitsa_ros.errors import KapitsaError


class ProtocolError(KapitsaError, ValueError):
    """A protocol holds something no operator can do; the message names the entry and how to correct it."""


class RequestError(KapitsaError, ValueError):
    """A request to the operator is out of range; the message names the range."""
