"""Errors of the physics room."""


class PhysicsError(ValueError):
    """A quantity the physics has no answer for; the message names it and the mend."""


class ParameterError(PhysicsError):
    """A parameter is not finite or out of its range."""


class PivotError(PhysicsError):
    """A record of the pivot's motion cannot be used: gaps, reversed time, wrong sizes, or too coarse."""
