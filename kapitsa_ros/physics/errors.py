"""Errors of the physics."""

from kapitsa_ros.errors import KapitsaError


class PhysicsError(KapitsaError, ValueError):
    """A question to which the physics has no answer; the message names the quantity and how to correct it."""


class ParameterError(PhysicsError):
    """A parameter is not finite or out of its range."""


class MotionError(PhysicsError):
    """A sampled motion cannot be used: gaps, reversed time, unequal sizes, or samples too far apart."""
