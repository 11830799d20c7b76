"""Errors of the rig."""


class RigError(Exception):
    """The rig cannot start or go on; the message is the one line its user sees."""


class UsageError(RigError):
    """What was asked for cannot be; the message names the option and the mend."""
