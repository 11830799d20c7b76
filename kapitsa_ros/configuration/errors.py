"""Errors of the configuration."""

from kapitsa_ros.errors import KapitsaError


class ConfigurationError(KapitsaError, ValueError):
    """A parameter of the rig or of its steps is out of its range, or an assignment is none."""
