"""Errors of the nodes."""


class NodeError(Exception):
    """A node cannot go on; the message is the one line its user sees."""


class SettingError(NodeError):
    """A parameter is wrong; the message names it and the mend."""


class SequenceError(NodeError):
    """Steps came out of order, twice or not at all."""
