"""Errors of the rig."""

from kapitsa_ros.errors import FAILED, WRONG_INPUT, KapitsaError


class RigError(KapitsaError):
    """The rig cannot start or go on; the message is the one line its user sees."""

    exit_status = FAILED


class UsageError(RigError):
    """An argument or option cannot be used; the message names it and how to mend it."""

    exit_status = WRONG_INPUT
