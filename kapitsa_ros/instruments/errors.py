"""Errors of the instruments."""

from kapitsa_ros.errors import KapitsaError


class InstrumentError(KapitsaError, ValueError):
    """An instrument cannot be used as requested; the message names the quantity and how to correct it."""


class SettingsError(InstrumentError):
    """An instrument set is unknown, or a parameter of it is missing, surplus or out of its range."""
