"""Errors of the instruments room."""


class InstrumentError(ValueError):
    """An instrument cannot be set or used like this; the message names the setting and the mend."""


class ProtocolError(ValueError):
    """A protocol says something no operator can do; the message names the entry and the mend."""
