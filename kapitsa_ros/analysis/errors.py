"""Errors of the analysis."""

from kapitsa_ros.errors import KapitsaError


class AnalysisError(KapitsaError, ValueError):
    """Readings from which the requested quantity cannot be had; the message says how to correct it."""


class TableError(AnalysisError):
    """A table of readings cannot be used: missing columns, text, units mixed up, or too few different speeds."""


class NothingTimedError(AnalysisError):
    """No run was timed, so there is no critical speed: a value that does not exist, not a mistake."""

    def __init__(self) -> None:
        super().__init__('no swing was timed in any run: time one')
