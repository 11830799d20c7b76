"""Errors of the instruments room."""


class InstrumentError(ValueError):
    """An instrument cannot be used as asked; the message names the quantity and the mend."""


class SettingsError(InstrumentError):
    """An instrument set is unknown, or a parameter of it is missing, surplus or out of its range."""


class ProtocolError(ValueError):
    """A protocol says something no operator can do; the message names the entry and the mend."""


class RequestError(InstrumentError):
    """A person asks the operator for what cannot be; the message names the range."""
