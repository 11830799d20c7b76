"""Errors of the recording room."""


class WireError(ValueError):
    """A message is not what its topic promises."""


class BagError(Exception):
    """A bag cannot be written or read; the message names it and the mend."""
