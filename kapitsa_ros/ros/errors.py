"""Errors of the nodes."""

from kapitsa_ros.errors import FAILED, WRONG_INPUT, KapitsaError


class NodeError(KapitsaError):
    """A node cannot go on; the message is the one line its user sees."""

    exit_status = FAILED


class SettingError(NodeError):
    """A parameter is wrong; the message names it and how to mend it."""

    exit_status = WRONG_INPUT
