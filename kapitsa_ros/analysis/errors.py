"""Errors of the analysis room."""


class AnalysisError(ValueError):
    """Readings from which the asked quantity cannot be had; the message names the mend."""


class TableError(AnalysisError):
    """A table of readings cannot be used: missing columns, text, units mixed up, or too few different speeds."""


class RunError(AnalysisError):
    """A run cannot be analysed: readings or settings are missing, or contradict each other."""
